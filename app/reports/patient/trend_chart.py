"""One measure over a patient's visits, dates to scale; whiskers of half an error, gaps if not reported."""

import datetime
import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from app.charts.drawing import COLOURS, DASHES, MM, Drawing, Picture
from app.summary.numbers_in_words import fixed
from app.summary.trend_lines import TrendValue
from app.theme.colours import PAPER
from app.wording.body import side_name
from app.wording.dates import short_date
from app.wording.translation import capitalised, tr
from core.body import Side

WIDTH, HEIGHT = 85.5 * MM, 60 * MM
LEFT_EDGE, RIGHT_EDGE, TOP, FOOT = 28.0, 10.0, 16.0, 26.0  # points around the plot
OF_GOALS = 10.0  # points for a line of words
APART = 22.0  # points between two dates that are written
NEAR = 3.0  # points that the legs stand aside of a date, so that neither covers the other
TICKS = 4


def trend_chart(
    title: str,
    decimals: int,
    days: Sequence[datetime.date],
    lines: Mapping[Side | None, Sequence[TrendValue]],
    *,
    is_simulated: bool,
    goals: Sequence[tuple[float, str]] = (),
    least_span: float = 0.0,
) -> Picture:
    """Draw a line per leg, or one for both, over visits from 1; the axis spans at least `least_span`."""
    reported = [one for values in lines.values() for one in values if math.isfinite(one.value)]
    reach = [
        one.value + sign * (one.whisker if math.isfinite(one.whisker) else 0.0) for one in reported for sign in (-1, 1)
    ]
    reach += [value for value, _ in goals]
    middle, half = 0.5 * (min(reach) + max(reach)), 0.5 * max(max(reach) - min(reach), least_span)
    low, high, step = _axis(middle - half, middle + half) if least_span else _axis(min(reach), max(reach))
    agreed = "; ".join(words for _, words in goals)
    right, bottom, top = WIDTH - RIGHT_EDGE, HEIGHT - FOOT, TOP + OF_GOALS * len(goals)
    first, last = days[0].toordinal(), days[-1].toordinal()

    def x(visit: int) -> float:
        share = (days[visit].toordinal() - first) / (last - first) if last > first else visit / max(len(days) - 1, 1)
        return LEFT_EDGE + 12 + (right - LEFT_EDGE - 24) * share

    def y(value: float) -> float:
        return bottom - (bottom - top) * (value - low) / (high - low)

    draw = Drawing()
    draw.text(0, 8, title, 7.6, weight=600)
    for value in np.arange(low, high + step / 2, step):
        draw.line(LEFT_EDGE, y(value), right, y(value), PAPER.ink if value == low else PAPER.grid, 0.5)
        draw.text(LEFT_EDGE - 5, y(value) + 2.4, fixed(float(value), _decimals(step)), 6.8, anchor="end")
    for value, _ in goals:
        draw.line(LEFT_EDGE, y(value), right, y(value), PAPER.ink, 1.1, "1.4 2")
    for number, (_, words) in enumerate(goals):
        draw.text(right, 17 + OF_GOALS * number, f"· · · {words}", 6.4, anchor="end")
    written = -math.inf
    for visit, day in enumerate(days):
        draw.line(x(visit), bottom, x(visit), bottom + 3, PAPER.ink, 0.6)
        if x(visit) - written >= APART:
            draw.text(x(visit), bottom + 11, str(visit + 1), 7, anchor="middle", weight=600)
            draw.text(x(visit), bottom + 20, short_date(day), 6.4, anchor="middle", fill=PAPER.note)
            written = x(visit)
    stated = []
    for side, values in lines.items():
        aside = {Side.LEFT: -NEAR, Side.RIGHT: NEAR, None: 0.0}[side] if len(lines) > 1 else 0.0
        _draw_line(draw, side, values, x, y, aside, bottom)
        each = ", ".join(f"{one.visit + 1}: {fixed(one.value, decimals)}" for one in values)
        stated.append(f"{capitalised(side_name(side))}: {each}." if side is not None else f"{each}.")
    if is_simulated:
        draw.text(right, 8, tr("SIMULATED"), 6.6, anchor="end", weight=600)
    if agreed:
        stated.append(f"{agreed}.")
    return draw.picture(WIDTH, HEIGHT, " ".join([tr("SIMULATED.")] * is_simulated + [f"{title}.", *stated]))


def _draw_line(
    draw: Drawing,
    side: Side | None,
    values: Sequence[TrendValue],
    x: Callable[[int], float],
    y: Callable[[float], float],
    aside: float,
    bottom: float,
) -> None:
    """A leg's values, joined where every visit between them is reported, each with its whisker."""
    colour, dash = (COLOURS[side], DASHES[side]) if side is not None else (PAPER.ink, "")
    for one, other in pairwise(values):
        if math.isfinite(one.value) and math.isfinite(other.value):
            draw.line(x(one.visit) + aside, y(one.value), x(other.visit) + aside, y(other.value), colour, 1.2, dash)
    for one in values:
        at = x(one.visit) + aside
        if not math.isfinite(one.value):
            draw.text(at, bottom - 4, tr("not reported"), 6.4, anchor="middle", fill=PAPER.note)
            continue
        if math.isfinite(one.whisker):
            ends = y(one.value - one.whisker), y(one.value + one.whisker)
            draw.line(at, ends[0], at, ends[1], PAPER.ink, 0.8)
            for end in ends:
                draw.line(at - 2.4, end, at + 2.4, end, PAPER.ink, 0.8)
        if side is None:
            height = y(one.value)
            corners = ((at, height - 4), (at + 4, height), (at, height + 4), (at - 4, height))
            draw.polygon(corners, PAPER.ink)
        else:
            draw.badge(at, y(one.value), side.letter, side, colour, 7.6)


def _axis(low: float, high: float) -> tuple[float, float, float]:
    """Round ends of an axis about all that is drawn on it, and its step."""
    span = max(high - low, 1e-3)
    size = 10.0 ** math.floor(math.log10(span / TICKS))
    step = next(size * k for k in (1, 2, 2.5, 5, 10) if size * k * TICKS >= span)
    return step * math.floor(low / step), step * math.ceil(high / step), step


def _decimals(step: float) -> int:
    """How many decimals a step's multiples need."""
    return next(count for count in range(6) if math.isclose(step, round(step, count), rel_tol=1e-6))

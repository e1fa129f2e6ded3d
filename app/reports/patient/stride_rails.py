"""The range of every stride in true time, and on a rail below it the strides that were left out, by their reasons."""

import math

import numpy as np

from app.charts.cycles import is_spread_enough
from app.charts.drawing import COLOURS, DASHES, MM, Drawing, Picture
from app.summary.facts import Facts, joint_of
from app.summary.numbers_in_words import fixed
from app.theme.colours import PAPER
from app.wording.body import side_name
from app.wording.findings import NAMES
from app.wording.translation import capitalised, tr
from core.body import Side
from core.gait.strides import Reason
from core.verdicts.quantities import values_of

WIDTH, HEIGHT = 175 * MM, 33 * MM
LEFT_EDGE, RIGHT_EDGE, TOP, FOOT = 24.0, 78.0, 14.0, 22.0  # points around the plot
LEAST_SPAN_DEG, TICK_DEG = 20.0, 10.0
LETTERS = {  # on the rail; each is described in words under the heading
    Reason.TURN: "t",
    Reason.START: "b",
    Reason.STOP: "s",
    Reason.PAUSE: "p",
    Reason.GAP: "g",
    Reason.DOUBT: "d",
    Reason.OUTLIER: "u",
    Reason.SLIPPED: "x",
    Reason.BY_HAND: "h",
    Reason.STAIRS_UP: "↑",
    Reason.STAIRS_DOWN: "↓",
}


def reasons_in_words(facts: Facts) -> str:
    """What the letters of strides that were left out stand for; empty where none was."""
    found = {reason for gait in facts.gait.values() for reason in gait.strides.reason if reason is not Reason.USED}
    if not found:
        return ""
    each = ", ".join(f"{LETTERS[one]} {tr(NAMES['reason'][one])}" for one in LETTERS if one in found)
    return tr("Excluded strides are on the line “excl.”: {each}.").format(each=each)


def stride_rail(facts: Facts, kind: str) -> Picture:
    """One joint's range in every stride of both legs."""
    column = f"{kind}_range_deg"
    values = {
        side: values_of(facts.walk, side, column) for side in facts.gait if facts.is_measured(joint_of(kind, side))
    }
    used = {side: facts.gait[side].strides.is_used for side in values}
    shown = np.concatenate([values[side][used[side]] for side in values])
    shown = shown[np.isfinite(shown)]
    low, high = _limits(shown)
    starts = [facts.gait[side].strides.start_s for side in values if len(facts.gait[side].strides)]
    first_s = min((float(one.min()) for one in starts), default=0.0)
    last_s = max((float(one.max()) for one in starts), default=1.0)
    right, bottom = WIDTH - RIGHT_EDGE, HEIGHT - FOOT

    def x(at_s: float) -> float:
        return LEFT_EDGE + 6 + (right - LEFT_EDGE - 12) * (at_s - first_s) / max(last_s - first_s, 1e-6)

    def y(value: float) -> float:
        return bottom - (bottom - TOP) * (value - low) / (high - low)

    titles = {
        "hip": tr("Hip range of motion per stride, °"),
        "knee": tr("Knee range of motion per stride, °"),
        "ankle": tr("Ankle range of motion per stride, °"),
    }
    title = titles[kind]
    draw = Drawing()
    draw.text(0, 8, title, 7.6, weight=600)
    for value in np.arange(low, high + 1, TICK_DEG):
        draw.line(LEFT_EDGE, y(value), right, y(value), PAPER.ink if value == low else PAPER.grid, 0.5)
        draw.text(LEFT_EDGE - 5, y(value) + 2.4, fixed(float(value), 0), 6.8, anchor="end")
    draw.text(LEFT_EDGE - 5, bottom + 10.5, tr("excl."), 6.6, anchor="end", fill=PAPER.note)
    draw.text(right, bottom + 19, f"{fixed(last_s - first_s, 0)} s", 6.6, anchor="end", fill=PAPER.note)
    stated, ends = [], []
    for side, each in values.items():
        strides = facts.gait[side].strides
        for at_s, value, is_used, reason in zip(strides.start_s, each, used[side], strides.reason, strict=True):
            if is_used and math.isfinite(value):
                _draw_mark(draw, x(float(at_s)), y(float(value)), side)
            elif not is_used:
                down = 8.5 if side is Side.LEFT else 14.5
                draw.text(
                    x(float(at_s)), bottom + down, LETTERS[reason], 6.6, anchor="middle", weight=600, fill=COLOURS[side]
                )
        known = used[side] & np.isfinite(each)
        count = int(known.sum())
        if not count:
            continue
        words = tr("{side}: {count} strides, {low}° to {high}°.")
        stated.append(
            words.format(
                side=capitalised(side_name(side)),
                count=count,
                low=fixed(float(each[known].min()), 0),
                high=fixed(float(each[known].max()), 0),
            )
        )
        if is_spread_enough(count):
            halves = np.array_split(np.flatnonzero(known), 2)
            means = [float(each[half].mean()) for half in halves]
            for half, mean in zip(halves, means, strict=True):
                ends_x = x(float(strides.start_s[half[0]])) - 4, x(float(strides.start_s[half[-1]])) + 4
                draw.line(ends_x[0], y(mean), ends_x[1], y(mean), PAPER.ink, 0.9, DASHES[side])
            ends.append((y(means[1]), side, f"{fixed(means[0], 1)} → {fixed(means[1], 1)}°"))
    for height, side, words in _apart(ends):
        draw.badge(right + 10, height, side.letter, side, COLOURS[side])
        draw.text(right + 18, height + 2.4, words, 6.8)
    if facts.is_simulated:
        draw.text(right, 8, tr("SIMULATED"), 6.6, anchor="end", weight=600)
    alt = " ".join([tr("SIMULATED.")] * facts.is_simulated + [f"{title}.", *(stated or [tr("No strides used.")])])
    return draw.picture(WIDTH, HEIGHT, alt)


def _draw_mark(draw: Drawing, x: float, y: float, side: Side) -> None:
    if side is Side.LEFT:
        draw.circle(x, y, 2.2, COLOURS[side], PAPER.paper, 0.5)
    else:
        draw.box(x - 2, y - 2, 4, 4, PAPER.paper, COLOURS[side], 1.1)


def _limits(shown_deg: np.ndarray) -> tuple[float, float]:
    """Round degrees that hold all values, with room for an error about them."""
    if not len(shown_deg):
        return 0.0, LEAST_SPAN_DEG
    low = TICK_DEG * math.floor((float(shown_deg.min()) - 2) / TICK_DEG)
    high = TICK_DEG * math.ceil((float(shown_deg.max()) + 2) / TICK_DEG)
    while high - low < LEAST_SPAN_DEG:
        low, high = (low - TICK_DEG, high) if low >= TICK_DEG else (low, high + TICK_DEG)
    return max(low, 0.0), high


def _apart(ends: list[tuple[float, Side, str]]) -> list[tuple[float, Side, str]]:
    """The same from above to below, so far apart that words do not lie on words."""
    found: list[tuple[float, Side, str]] = []
    for height, side, words in sorted(ends):
        above = found[-1][0] + 11 if found else -math.inf
        found.append((max(height, above), side, words))
    return found

"""How does a joint move over the stride? Curves on axes that are the same in every report: one picture to learn."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from app.charts.cycles import PERCENT
from app.charts.drawing import (
    BADGE,
    BAND_MEAN,
    COLOURS,
    DASHES,
    GREY,
    GRID,
    INK,
    INNER,
    INNER_EDGE,
    OUTER,
    OUTER_EDGE,
    WHITE,
    Picture,
    area,
    badge,
    box,
    curve,
    line,
    marker,
    picture,
    text,
)
from app.reports.patient_report.numbers_in_words import fixed
from app.wording import tr
from core.body import Side
from core.gait.cycles import POINTS
from core.samples import FloatArray

LEFT_MARGIN, RIGHT_MARGIN, TOP, TOP_LABELS, FOOT = 27.0, 9.0, 13.0, 14.0, 30.0
SPAN_HEIGHT, SPAN_ROW = 9.0, 11.0
MIN_BADGE_DISTANCE = 14.0


@dataclass(frozen=True, slots=True)
class Axis:
    """Degrees from bottom to top, a label every so many, and words for the two directions."""

    low: float
    high: float
    label_every: float
    tick_every: float
    up: str
    down: str


@dataclass(frozen=True, slots=True)
class Mark:
    """A peak: where in the stride, percent, its mean and SD, degrees."""

    percent: float
    mean_deg: float
    sd_deg: float


@dataclass(frozen=True, slots=True)
class Line:
    """One leg in one condition; `angle_deg` (101,), NaN where it is not known."""

    letter: str
    side: Side
    colour: str
    width: float
    dash: str
    casing: float
    angle_deg: FloatArray
    toe_off_percent: float
    toe_off_sd: float = float("nan")
    toe_off_label: str = ""
    peaks: tuple[Mark, ...] = ()
    strides_deg: FloatArray = field(default_factory=lambda: np.empty((0, POINTS)))


@dataclass(frozen=True, slots=True)
class Span:
    """Where in the stride, percent, the highest or the lowest angle is looked for."""

    name: str
    first: float
    last: float
    is_maximum: bool


@dataclass(frozen=True, slots=True)
class Chart:
    """One panel; `band` mean and SD (101,) each, degrees; `ticks` percent and side of the other foot's events.

    `spans` stand above the frame, where toe-off is named otherwise.
    """

    title: str
    axis: Axis
    lines: tuple[Line, ...]
    band: tuple[FloatArray, FloatArray] | None
    plot_width: float
    is_simulated: bool
    ticks: tuple[tuple[float, Side], ...] = ()
    spans: tuple[Span, ...] = ()
    alt: str = ""


class _Frame:
    """Where percent and degrees lie on the paper."""

    def __init__(self, chart: Chart) -> None:
        self.left, self.top = LEFT_MARGIN, TOP + (2 * SPAN_ROW if chart.spans else TOP_LABELS)
        self.width, self.height = chart.plot_width, 0.75 * chart.plot_width
        self.right, self.bottom = self.left + self.width, self.top + self.height
        self._axis = chart.axis

    def x(self, percent: FloatArray | float) -> FloatArray:
        return np.asarray(self.left + self.width * np.asarray(percent) / 100)

    def y(self, degrees: FloatArray | float) -> FloatArray:
        """What lies beyond the axis is drawn at its edge."""
        clipped = np.clip(np.asarray(degrees, dtype=np.float64), self._axis.low, self._axis.high)
        return np.asarray(self.bottom - self.height * (clipped - self._axis.low) / (self._axis.high - self._axis.low))


def draw(chart: Chart) -> Picture:
    """Draw one panel: band, grid, curves and what names them."""
    frame = _Frame(chart)
    parts = [text(0, 8, chart.title, 7.6, weight=600)]
    if chart.band is not None:
        parts += _band(frame, *chart.band)
    parts += _axes(frame, chart.axis)
    parts += _spans(frame, chart) if chart.spans else _toe_offs(frame, chart.lines)
    for one in chart.lines:
        thin = 0.32 if np.isfinite(one.angle_deg).any() else 0.8
        parts += [curve(frame.x(PERCENT), frame.y(stride), one.colour, thin) for stride in one.strides_deg]
    for one in chart.lines:
        x, y = frame.x(PERCENT), frame.y(one.angle_deg)
        parts += [curve(x, y, WHITE, one.width + one.casing), curve(x, y, one.colour, one.width, one.dash)]
        parts += _beyond(frame, chart.axis, one)
    for one in chart.lines:
        parts += _peaks(frame, one)
    parts += _ticks(frame, chart.ticks)
    parts += _words(frame, chart)
    parts += _badges(frame, chart.lines)
    return picture(parts, frame.right + RIGHT_MARGIN, frame.bottom + FOOT, chart.alt)


def _band(frame: _Frame, mean: FloatArray, sd: FloatArray) -> list[str]:
    x = frame.x(PERCENT)
    return [
        area(x, frame.y(mean - 2 * sd), frame.y(mean + 2 * sd), OUTER, OUTER_EDGE, 0.35),
        area(x, frame.y(mean - sd), frame.y(mean + sd), INNER, INNER_EDGE, 0.35),
        curve(x, frame.y(mean), BAND_MEAN, 0.6),
    ]


def _axes(frame: _Frame, axis: Axis) -> list[str]:
    parts = []
    for percent in range(0, 101, 10):
        x = float(frame.x(percent))
        is_labelled = percent % 20 == 0
        if is_labelled and 0 < percent < 100:
            parts.append(line(x, frame.top, x, frame.bottom, GRID, 0.25))
        parts.append(line(x, frame.bottom, x, frame.bottom + (4 if is_labelled else 2.5), INK, 0.6))
        if is_labelled:
            parts.append(text(x, frame.bottom + 12, str(percent), 7, anchor="middle"))
    for degrees in np.arange(axis.low, axis.high + 1, axis.tick_every):
        y = float(frame.y(degrees))
        is_labelled = degrees % axis.label_every == 0
        if is_labelled and axis.low < degrees < axis.high:
            width, colour = (0.55, INK) if degrees == 0 else (0.25, GRID)
            parts.append(line(frame.left, y, frame.right, y, colour, width))
        parts.append(line(frame.left - (4 if is_labelled else 2.5), y, frame.left, y, INK, 0.6))
        if is_labelled:
            label = fixed(float(degrees), 0)
            parts.append(text(frame.left - 6, y + 2.5, label, 7, anchor="end"))
    middle = (frame.left + frame.right) / 2
    said = tr("Stride, % (0 and 100 = initial contact of the same foot)")
    parts.append(text(middle, frame.bottom + 22, said, 7, anchor="middle"))
    parts.append(box(frame.left, frame.top, frame.width, frame.height, "none", INK, 0.7))
    return parts


def _spans(frame: _Frame, chart: Chart) -> list[str]:
    """A row of boxes for the highest, one for the lowest, and a dotted line down to each peak that was found."""
    parts = []
    for row, said in ((0, tr("max")), (1, tr("min"))):
        y = TOP + SPAN_ROW * row
        parts.append(text(frame.left - 4, y + 6.8, said, 6.6, anchor="end", fill=GREY))
        for span in chart.spans:
            if span.is_maximum is (row == 0):
                left, right = float(frame.x(span.first)), float(frame.x(span.last))
                parts.append(box(left, y, right - left, SPAN_HEIGHT, OUTER, OUTER_EDGE, 0.5))
                parts.append(text((left + right) / 2, y + 6.8, span.name, 6.6, anchor="middle"))
    for one in chart.lines:
        for peak in one.peaks:
            x, y, top = float(frame.x(peak.percent)), float(frame.y(peak.mean_deg)), frame.top + 12.5  # below the words
            parts += [line(x, top, x, y, GREY, 0.5, "0.8 1.6")] if y > top else []
    return parts


def _toe_offs(frame: _Frame, lines: Sequence[Line]) -> list[str]:
    known = sorted((one for one in lines if np.isfinite(one.toe_off_percent)), key=lambda one: one.toe_off_percent)
    parts = []
    is_many = len(known) > 2 or any(len(one.toe_off_label) == 1 for one in known)
    for k, one in enumerate(known):
        x = float(frame.x(one.toe_off_percent))
        parts.append(line(x, frame.top, x, frame.bottom, one.colour, 0.55 if is_many else 0.9, one.dash))
        if np.isfinite(one.toe_off_sd):
            reach = frame.width * one.toe_off_sd / 100
            parts.append(line(x - reach, frame.top, x + reach, frame.top, INK, 1.4))
        if is_many:
            spread = float(frame.x(sum(each.toe_off_percent for each in known) / len(known)))
            at = spread + 10 * (k - (len(known) - 1) / 2)
            parts.append(line(x, frame.top, at, frame.top - 4.5, INK, 0.4))
            parts.append(text(at, frame.top - 6.5, one.toe_off_label, 7, anchor="middle", weight=600))
            if k == 0:
                parts.append(text(at - 7, frame.top - 6.5, tr("toe-off"), 7, anchor="end"))
        else:
            is_earlier = k == 0 and len(known) == 2
            at, anchor = (x - 3, "end") if is_earlier else (x + 3, "start")
            parts.append(text(at, frame.top - 4.5, one.toe_off_label, 7, anchor=anchor))
    return parts


def _peaks(frame: _Frame, one: Line) -> list[str]:
    parts = []
    for peak in one.peaks:
        x, y = float(frame.x(peak.percent)), float(frame.y(peak.mean_deg))
        if np.isfinite(peak.sd_deg):
            low, high = (float(frame.y(peak.mean_deg + sign * peak.sd_deg)) for sign in (-1, 1))
            parts.append(line(x, low, x, high, INK, 0.8))
            parts += [line(x - 2.2, end, x + 2.2, end, INK, 0.8) for end in (low, high)]
        parts.append(marker(x, y, one.side))
    return parts


def _beyond(frame: _Frame, axis: Axis, one: Line) -> list[str]:
    """A small arrow in the middle of each stretch that leaves the axes."""
    parts = []
    for is_out, y, step in (
        (one.angle_deg > axis.high, frame.top, -5.0),
        (one.angle_deg < axis.low, frame.bottom, 5.0),
    ):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], is_out.astype(int), [0]])))
        for first, last in zip(edges[::2], edges[1::2], strict=True):
            x = float(frame.x((first + last - 1) / 2))
            tip = f"{x:.2f},{y + step:.2f} {x - 2.6:.2f},{y:.2f} {x + 2.6:.2f},{y:.2f}"
            parts.append(f'<polygon points="{tip}" fill="{one.colour}"/>')
    return parts


def _ticks(frame: _Frame, ticks: Sequence[tuple[float, Side]]) -> list[str]:
    parts = []
    for percent, side in ticks:
        low = frame.bottom if side is Side.LEFT else frame.bottom - 8
        x = float(frame.x(percent))
        dash = "1.6 0.8" if DASHES[side] else ""
        parts.append(line(x, low, x, low - 7, COLOURS[side], 1.1, dash))
    return parts


def _words(frame: _Frame, chart: Chart) -> list[str]:
    parts = [
        text(frame.left + 4, frame.top + 9.5, f"↑ {chart.axis.up}", 6.6, fill=GREY),
        text(frame.right - 4, frame.bottom - 4.5, f"↓ {chart.axis.down}", 6.6, anchor="end", fill=GREY),
    ]
    if chart.is_simulated:
        parts.append(text(frame.right - 4, frame.top + 9.5, tr("SIMULATED"), 6.6, anchor="end", weight=600))
    return parts


def _badges(frame: _Frame, lines: Sequence[Line]) -> list[str]:
    """Two letters on every line, where it lies farthest from the others and from the letters there already."""
    drawn = [one for one in lines if np.isfinite(one.angle_deg).any()]
    x = frame.x(PERCENT)
    heights = [frame.y(one.angle_deg) for one in drawn]
    taken = [(float(frame.x(p.percent)), float(frame.y(p.mean_deg))) for one in drawn for p in one.peaks]
    parts = []
    for half in (range(7, 49), range(52, 94)):
        for one, y in zip(drawn, heights, strict=True):
            others = [other for other in heights if other is not y]
            at = _best_place(half, x, y, others, taken, frame)
            if at is not None:
                taken.append((float(x[at]), float(y[at])))
                parts.append(badge(float(x[at]), float(y[at]), one.letter, one.side, one.colour))
    return parts


def _best_place(
    half: range,
    x: FloatArray,
    y: FloatArray,
    others: Sequence[FloatArray],
    taken: Sequence[tuple[float, float]],
    frame: _Frame,
) -> int | None:
    best, best_score = None, -np.inf
    for k in half:
        is_inside = frame.top + BADGE < y[k] < frame.bottom - BADGE
        distances = [float(np.hypot(x[k] - a, y[k] - b)) for a, b in taken]
        if not np.isfinite(y[k]) or not is_inside or min(distances, default=np.inf) < MIN_BADGE_DISTANCE:
            continue
        apart = [float(np.nanmin(np.hypot(x - x[k], other - y[k]))) for other in others if np.isfinite(other).any()]
        centre = 0.02 * abs(k - (half.start + half.stop) / 2)
        score = min([*apart, 20.0]) + 0.05 * min([*distances, 60.0]) - centre
        if score > best_score:
            best, best_score = k, score
    return best

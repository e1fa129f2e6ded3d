"""Painting on paper: a chart of the stride as SVG, 4:3, one unit a point.

The charts of page one are `joint_on_paper`'s; brackets and values are theirs alone.
"""

from collections.abc import Sequence
from textwrap import wrap

import numpy as np

from app.charts.axes import angle_in_words
from app.charts.cycles import PERCENT, Band
from app.charts.drawing import BADGE, COLOURS, DASHES, MM, Drawing, Picture, mixed
from app.charts.frame import Frame
from app.charts.marks import stretches
from app.charts.stride_chart import Axis, StrideChart, StrideCurve, toe_offs_in_order
from app.theme.colours import PAPER
from app.wording.translation import tr
from app.wording.verdicts import verdict_alone
from core.body import Side
from core.gait.cycles import POINTS
from core.samples import FloatArray
from core.verdicts.model import Verdict

LEFT_MARGIN, RIGHT_MARGIN, TOP, TOP_LABELS, FOOT = 27.0, 9.0, 13.0, 14.0, 30.0
MIN_BADGE_DISTANCE = 14.0
PLAIN, FINE = 1.9, 1.4
LONG_DASHES = "6 1.6"  # of the right leg's mean over its single strides
STRIDE, ONLY_STRIDES = 0.32, 0.8

LETTERS_FROM, LETTERS_APART = 24, 44  # percent of the stride
NARROWEST = 27 * MM  # narrower, fewer labels fit below it
NARROW, NARROW_FOOT = 60 * MM, 17.0  # narrower, the name of the axis has no room, and is above the charts
HATCH_APART, LINE_OF_WORDS = 6.0, 8.6
BELOW_MARK = 11.0  # of a plot's top, so that why it is not reported does not run into "SIMULATED"
SIZE_OF_WORDS, PER_LETTER = 7.0, 0.6  # a letter's width on its height; an SVG cannot be asked


class PaperFrame(Frame):
    """What lies beyond the axis is drawn at its edge."""

    def y(self, angle_deg: FloatArray | float) -> FloatArray:
        return super().y(np.clip(np.asarray(angle_deg, dtype=np.float64), self.low_deg, self.high_deg))


def frame_of(chart: StrideChart, plot_width: float) -> Frame:
    """Where the chart's plot lies on its picture, points."""
    return PaperFrame(LEFT_MARGIN, TOP + TOP_LABELS, plot_width, 0.75 * plot_width, chart.axis.low, chart.axis.high)


def compared_look(k: int, count: int, side: Side) -> tuple[str, float]:
    """Colour and width of condition or visit `k` of `count`: earlier is pale and thin, later plain, dark and thick."""
    pale, plain, dark = mixed(COLOURS[side], PAPER.paper, 0.42), COLOURS[side], mixed(COLOURS[side], PAPER.ink, 0.45)
    if count == 2:
        return ((pale, 1.0), (plain, PLAIN))[k]
    return ((pale, 0.95), (plain, FINE), (dark, 2.1))[k]


def _look(one: StrideCurve) -> tuple[str, float]:
    if one.order is not None:
        return compared_look(*one.order, one.side)
    return COLOURS[one.side], PLAIN


def _dash(one: StrideCurve) -> str:
    return LONG_DASHES if DASHES[one.side] and one.is_known and len(one.strides_deg) else DASHES[one.side]


def draw(chart: StrideChart, plot_width: float) -> Picture:
    """Draw one panel: band, grid, curves and what names them."""
    frame = frame_of(chart, plot_width)
    is_narrow = plot_width < NARROW
    foot = NARROW_FOOT if is_narrow else FOOT
    pen = Drawing()
    pen.text(0, 8, chart.title, 7.6, weight=600)
    if chart.not_reported:
        draw_hatches(pen, frame)
        _draw_axes(pen, frame, chart.axis, is_narrow=is_narrow)
        _draw_why_not_reported(pen, frame, chart)
        alt = " ".join(filter(None, [chart.alt, f"{_not_reported_word()}. {chart.not_reported}"]))
        return pen.picture(frame.right + RIGHT_MARGIN, frame.bottom + foot, alt)
    if chart.band is not None:
        draw_band(pen, frame, chart.band)
    _draw_axes(pen, frame, chart.axis, is_narrow=is_narrow)
    drawn = [one for one in chart.curves if not one.is_bare]
    _draw_toe_offs(pen, frame, drawn, is_narrow=is_narrow)
    for one in chart.curves:
        thin = STRIDE if one.is_known else ONLY_STRIDES
        for stride in one.strides_deg:
            pen.curve(frame.x(PERCENT), frame.y(stride), _look(one)[0], thin)
        if not one.is_known:
            _draw_letters_of_strides(pen, frame, one)
    for one in drawn:
        x, y = frame.x(PERCENT), frame.y(one.angle_deg)
        colour, width = _look(one)
        casing = 0.9 if one.order is not None else 1.7
        pen.curve(x, y, PAPER.paper, width + casing)
        pen.curve(x, y, colour, width, _dash(one))
        _draw_beyond(pen, frame, chart.axis, one)
    if drawn:
        pen.text(frame.left + 4, frame.top + 9.5, f"↑ {chart.axis.up}", 6.6, fill=PAPER.note)
        down = f"↓ {chart.axis.down}"
        pen.text(frame.right - 4, frame.bottom - 4.5, down, 6.6, anchor="end", fill=PAPER.note)
    _draw_simulated(pen, frame, chart)
    _draw_badges(pen, frame, drawn)
    return pen.picture(frame.right + RIGHT_MARGIN, frame.bottom + foot, chart.alt)


def draw_band(draw: Drawing, frame: Frame, band: Band) -> None:
    """Mean, 1 and 2 SD, with edges that survive a photocopier."""
    x, mean, sd = frame.x(PERCENT), band.mean_deg, band.sd_deg
    draw.area(x, frame.y(mean - 2 * sd), frame.y(mean + 2 * sd), PAPER.band_2sd, PAPER.band_2sd_edge, 0.35)
    draw.area(x, frame.y(mean - sd), frame.y(mean + sd), PAPER.band_1sd, PAPER.band_1sd_edge, 0.35)
    draw.curve(x, frame.y(mean), PAPER.band_mean, 0.6)


def _not_reported_word() -> str:
    return verdict_alone(Verdict.NOT_REPORTED)


def draw_hatches(draw: Drawing, frame: Frame) -> None:
    """Hatching over the whole plot, so that nobody takes it for a curve."""
    for along in np.arange(-frame.height, frame.width, HATCH_APART):
        first, last = max(along, 0.0), min(along + frame.height, frame.width)  # of the width, from bottom to top
        ends = [(frame.left + x, frame.bottom - (x - along)) for x in (first, last)]
        draw.line(*ends[0], *ends[1], PAPER.grid, 0.35)


def _draw_why_not_reported(draw: Drawing, frame: Frame, chart: StrideChart) -> None:
    lines = wrap(chart.not_reported, int(0.8 * frame.width / (PER_LETTER * SIZE_OF_WORDS)))
    middle, height = (frame.top + frame.bottom) / 2, 16 + LINE_OF_WORDS * len(lines)
    top, x = max(middle - height / 2, frame.top + BELOW_MARK), (frame.left + frame.right) / 2
    draw.box(frame.left + 0.08 * frame.width, top, 0.84 * frame.width, height, PAPER.paper)
    draw.text(x, top + 10, _not_reported_word(), 8.6, anchor="middle", weight=600)
    for k, words in enumerate(lines):
        draw.text(x, top + 12 + LINE_OF_WORDS * (k + 0.8), words, SIZE_OF_WORDS, anchor="middle")
    _draw_simulated(draw, frame, chart)


def _draw_axes(draw: Drawing, frame: Frame, axis: Axis, *, is_narrow: bool) -> None:
    for percent in range(0, 101, 10):
        x = float(frame.x(percent))
        is_labelled = percent % (20 if frame.width >= NARROWEST else 50) == 0
        if is_labelled and 0 < percent < 100:
            draw.line(x, frame.top, x, frame.bottom, PAPER.grid, 0.25)
        draw.line(x, frame.bottom, x, frame.bottom + (4 if is_labelled else 2.5), PAPER.ink, 0.6)
        if is_labelled:
            stated = f"{percent} %" if is_narrow and percent == 100 else str(percent)
            draw.text(x, frame.bottom + 12, stated, 7, anchor="middle")
    for degrees in np.arange(axis.low, axis.high + 1, axis.tick_every):
        y = float(frame.y(degrees))
        is_labelled = degrees % axis.label_every == 0
        if is_labelled and axis.low < degrees < axis.high:
            width, colour = (0.55, PAPER.ink) if degrees == 0 else (0.25, PAPER.grid)
            draw.line(frame.left, y, frame.right, y, colour, width)
        draw.line(frame.left - (4 if is_labelled else 2.5), y, frame.left, y, PAPER.ink, 0.6)
        if is_labelled:
            draw.text(frame.left - 6, y + 2.5, angle_in_words(float(degrees)), 7, anchor="end")
    if not is_narrow:
        middle, stated = (
            (frame.left + frame.right) / 2,
            tr("Gait cycle, % (0 and 100 = initial contact of the same foot)"),
        )
        draw.text(middle, frame.bottom + 22, stated, 7, anchor="middle")
    draw.box(frame.left, frame.top, frame.width, frame.height, "none", PAPER.ink, 0.7)


def _draw_letters_of_strides(draw: Drawing, frame: Frame, one: StrideCurve) -> None:
    """A letter on each of few strides, which no mean names, each farther along so that none covers another."""
    for number, stride in enumerate(one.strides_deg):
        at = int(LETTERS_FROM + number * LETTERS_APART) % POINTS
        x, y = float(frame.x(at)), float(frame.y(float(stride[at])))
        draw.badge(x, y, one.letter, one.side, _look(one)[0])


def _draw_toe_offs(draw: Drawing, frame: Frame, curves: Sequence[StrideCurve], *, is_narrow: bool) -> None:
    known = toe_offs_in_order(curves, 1)
    is_many = any(one.order is not None for one in known)
    for k, one in enumerate(known):
        x = float(frame.x(one.toe_off_percent))
        draw.line(x, frame.top, x, frame.bottom, _look(one)[0], 0.55 if is_many else 0.9, _dash(one))
        if np.isfinite(one.toe_off_sd):
            reach = frame.width * one.toe_off_sd / 100
            draw.line(x - reach, frame.top, x + reach, frame.top, PAPER.ink, 1.4)
        if is_many:
            spread = float(frame.x(sum(each.toe_off_percent for each in known) / len(known)))
            at = spread + 10 * (k - (len(known) - 1) / 2)
            draw.line(x, frame.top, at, frame.top - 4.5, PAPER.ink, 0.4)
            draw.text(at, frame.top - 6.5, one.toe_off_label, 7, anchor="middle", weight=600)
            if k == 0:
                draw.text(at - 7, frame.top - 6.5, tr("toe-off"), 7, anchor="end")
        else:
            is_earlier = k == 0 and len(known) == 2
            at, anchor = (x - 3, "end") if is_earlier else (x + 3, "start")
            if is_narrow and len(known) == 1:
                at, anchor = x, "middle"  # beside the line there is no room
            draw.text(at, frame.top - 4.5, one.toe_off_label, 7, anchor=anchor)


def _draw_beyond(draw: Drawing, frame: Frame, axis: Axis, one: StrideCurve) -> None:
    """A small arrow in the middle of each stretch that leaves the axes."""
    for is_out, y, step in (
        (one.angle_deg > axis.high, frame.top, -5.0),
        (one.angle_deg < axis.low, frame.bottom, 5.0),
    ):
        for first, last in stretches(is_out):
            x = float(frame.x((first + last) / 2))
            draw.polygon([(x, y + step), (x - 2.6, y), (x + 2.6, y)], _look(one)[0])


def _draw_simulated(draw: Drawing, frame: Frame, chart: StrideChart) -> None:
    if chart.is_simulated:
        draw.text(frame.right - 4, frame.top + 9.5, tr("SIMULATED"), 6.6, anchor="end", weight=600)


def _draw_badges(draw: Drawing, frame: Frame, curves: Sequence[StrideCurve]) -> None:
    """Two letters on every line, where it lies farthest from the others and the letters there already."""
    drawn = [one for one in curves if one.is_known]
    x = frame.x(PERCENT)
    heights = [frame.y(one.angle_deg) for one in drawn]
    taken: list[tuple[float, float]] = []
    for half in (range(7, 49), range(52, 94)):
        for one, y in zip(drawn, heights, strict=True):
            others = [other for other in heights if other is not y]
            at = _best_place(half, x, y, others, taken, frame)
            if at is not None:
                taken.append((float(x[at]), float(y[at])))
                draw.badge(float(x[at]), float(y[at]), one.letter, one.side, _look(one)[0])


def _best_place(
    half: range,
    x: FloatArray,
    y: FloatArray,
    others: Sequence[FloatArray],
    taken: Sequence[tuple[float, float]],
    frame: Frame,
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

"""Painting on paper: a joint of both legs over the stride as SVG, one unit a point, its values on the curves.

The same chart as the screen's, letters no smaller than nine points.
"""

from collections.abc import Sequence

import numpy as np

from app.charts.axes import angle_in_words
from app.charts.cycles import PERCENT
from app.charts.drawing import Picture, box, curve, line, picture, text
from app.charts.frame import Frame
from app.charts.marks import CurveLabel, Deviation, HiddenCurve, Point
from app.charts.on_paper import PaperFrame, band_on_paper, hatches
from app.charts.places import Box, Layout, MarkPlace, Size, Sizes, ground_of, layout_of
from app.charts.stride_chart import StrideChart, StrideCurve, toe_off_labels, toe_offs_in_order
from app.theme.colours import LIGHT, PAPER
from app.wording.translation import tr
from app.wording.verdicts import verdict_alone
from core.body import Side
from core.verdicts.model import Verdict

LEFT, RIGHT, TOP, FOOT = 26.0, 25.0, 40.0, 27.0
SMALL, WORDS, TITLE = 9.0, 9.5, 10.5  # sizes of letters
PER_LETTER = 0.58  # a letter's width on its height; an SVG cannot be asked
LINE, DASH, CASING, THIN, TOE_OFF = 1.65, "5.6 3.1", 1.4, 0.8, 0.8
BAR, LEADER, HALO = 1.5, 0.7, 2.6
DOT, DOT_EDGE = 2.6, 1.3
CHIP, KEY_LINE, KEY_GAP, KEY_APART = 13.0, 15.0, 8.0, 4.0
SWATCH: Size = (12.0, 7.0)
LINE_HEIGHT = 11.5
HIDDEN_HEIGHT, HIDDEN_PADDING = 30.0, 6.0
CURVES = {Side.LEFT: LIGHT.left, Side.RIGHT: LIGHT.right}
LETTERS = {Side.LEFT: LIGHT.left_text, Side.RIGHT: LIGHT.right_text}


def draw_joint(chart: StrideChart, width: float, height: float) -> Picture:
    """Draw a chart of this size: title and key above, then axes, curves, and what is read on them."""
    frame = PaperFrame(LEFT, TOP, width - LEFT - RIGHT, height - TOP - FOOT, chart.axis.low, chart.axis.high)
    layout = layout_of(ground_of(frame, chart), chart, Sizes(_label, _bracket, _hidden, DOT + DOT_EDGE))
    parts = [
        text(0, 11, chart.title, TITLE, weight=600),
        text(0, 28, chart.sign, SMALL, fill=PAPER.note),
        *_key(chart, width),
    ]
    if chart.band is not None:
        parts += band_on_paper(frame, chart.band)
    parts += _axes(frame, chart) + _toe_offs(frame, chart)
    for one in chart.beside:
        parts.append(_path(frame, one, LETTERS[one.side], THIN))
    for one in sorted(chart.curves, key=lambda curve: curve.side, reverse=True):
        for stride in one.strides_deg:
            parts.append(curve(frame.x(PERCENT), frame.y(stride), CURVES[one.side], THIN, _dash(one.side)))
        if one.is_known:
            parts.append(curve(frame.x(PERCENT), frame.y(one.angle_deg), PAPER.paper, LINE + CASING))
            parts.append(_path(frame, one, CURVES[one.side], LINE))
    parts += _words(frame, layout)
    if chart.is_simulated:
        parts.append(_simulated(frame, width))
    alt = " ".join(filter(None, [chart.alt, *(bracket.in_words() for bracket in chart.deviations)]))
    return picture(parts, width, height, alt)


def _path(frame: Frame, one: StrideCurve, colour: str, width: float) -> str:
    return curve(frame.x(PERCENT), frame.y(one.angle_deg), colour, width, _dash(one.side))


def _dash(side: Side) -> str:
    return DASH if side is Side.RIGHT else ""


def _width(words: str, size: float) -> float:
    return PER_LETTER * size * len(words)


def _label(label: CurveLabel) -> Size:
    return _width(label.text, WORDS) + HALO, LINE_HEIGHT


def _bracket(bracket: Deviation) -> Sequence[Size]:
    first, more = _width(bracket.words, WORDS), _width(bracket.more, SMALL)
    return [(first, LINE_HEIGHT), (max(first, more), 2 * LINE_HEIGHT)] if bracket.more else [(first, LINE_HEIGHT)]


def _hidden(hidden: HiddenCurve) -> Size:
    words = max(_width(_not_reported(), WORDS), _width(hidden.reason, SMALL))
    return 3 * HIDDEN_PADDING + CHIP + words, HIDDEN_HEIGHT


def _not_reported() -> str:
    return verdict_alone(Verdict.NOT_REPORTED)


def _axes(frame: Frame, chart: StrideChart) -> list[str]:
    axis = chart.axis
    parts = [line(frame.left, float(frame.y(0)), frame.right, float(frame.y(0)), PAPER.note, 0.5)]
    parts.append(line(frame.left, frame.top, frame.left, frame.bottom, PAPER.note, 0.6))
    parts.append(line(frame.left, frame.bottom, frame.right, frame.bottom, PAPER.note, 0.6))
    first = np.ceil(axis.low / axis.label_every) * axis.label_every
    for degrees in np.arange(first, axis.high + 1, axis.label_every):
        y = float(frame.y(degrees))
        parts.append(line(frame.left - 3, y, frame.left, y, PAPER.note, 0.6))
        parts.append(
            text(frame.left - 6, y + 3.2, angle_in_words(float(degrees)), SMALL, anchor="end", fill=PAPER.note)
        )
    for percent in range(0, 101, 20):
        x = float(frame.x(percent))
        parts.append(line(x, frame.bottom, x, frame.bottom + 3, PAPER.note, 0.6))
        stated = f"{percent}" if percent < 100 else "100 %"
        parts.append(text(x, frame.bottom + 12.5, stated, SMALL, anchor="middle", fill=PAPER.note))
    middle = (frame.left + frame.right) / 2
    parts.append(text(middle, frame.bottom + 24.5, tr("Gait cycle"), SMALL, anchor="middle", fill=PAPER.note))
    return parts


def _toe_offs(frame: Frame, chart: StrideChart) -> list[str]:
    """Each line with its words above the plot, the earlier at the left of its line."""
    parts, labels = [], toe_off_labels(chart.curves)
    for k, one in enumerate(toe_offs_in_order(chart.curves, 0)):
        x = float(frame.x(one.toe_off_percent))
        dash = "2.6 1.7" if one.side is Side.RIGHT else ""
        parts.append(line(x, frame.top - 9, x, frame.bottom, CURVES[one.side], TOE_OFF, dash))
        at, anchor = (x - 3, "end") if k == 0 else (x + 3, "start")
        parts.append(
            text(at, frame.top - 3, labels[one.side], SMALL, anchor=anchor, weight=500, fill=LETTERS[one.side])
        )
    return parts


def _key(chart: StrideChart, width: float) -> list[str]:
    """At the right of the title: each leg's chip and line, the thin line with its date, the reference's swatch."""
    parts, right, y = [], width - 1, 7.5
    legs = [one for one in chart.curves if one.is_known]
    if chart.band is not None:
        words, (swatch, high) = tr("Reference"), SWATCH
        needed = len(legs) * (CHIP + KEY_APART + KEY_LINE + KEY_GAP) + swatch + _width(words, SMALL) + KEY_APART
        if chart.beside:
            needed += KEY_GAP + KEY_LINE + KEY_APART + _width(chart.beside[0].letter, SMALL)
        if _width(chart.title, TITLE) + KEY_GAP + needed <= width:  # else its swatch alone has room
            parts.append(text(right, y + 3.2, words, SMALL, anchor="end", fill=PAPER.note))
            right -= _width(words, SMALL) + KEY_APART
        right -= swatch
        parts.append(box(right, y - high / 2, swatch, high, PAPER.band_2sd, PAPER.band_2sd_edge, 0.35))
        parts.append(box(right, y - high / 4, swatch, high / 2, PAPER.band_1sd))
        right -= KEY_GAP
    if chart.beside:
        parts.append(text(right, y + 3.2, chart.beside[0].letter, SMALL, anchor="end", fill=PAPER.note))
        right -= _width(chart.beside[0].letter, SMALL) + KEY_APART + KEY_LINE
        colour = LETTERS[chart.beside[0].side] if len(chart.beside) == 1 else PAPER.note
        parts.append(line(right, y, right + KEY_LINE, y, colour, THIN))
        right -= KEY_GAP
    for one in reversed(legs):
        right -= KEY_LINE
        parts.append(line(right, y, right + KEY_LINE, y, CURVES[one.side], LINE, _dash(one.side)))
        right -= KEY_APART + CHIP
        parts.append(chip(right, y - CHIP / 2, one.side))
        right -= KEY_GAP
    return parts


def chip(x: float, y: float, side: Side, size: float = CHIP) -> str:
    """The letter of a leg in its frame, L filled, R outlined and dashed; `x`, `y` are its corner."""
    is_left = side is Side.LEFT
    place = f'x="{x + 0.5:.2f}" y="{y + 0.5:.2f}" width="{size - 1:.2f}" height="{size - 1:.2f}" rx="2.4"'
    look = f'fill="{LETTERS[side]}"' if is_left else f'fill="none" stroke="{LETTERS[side]}" stroke-dasharray="2 1.2"'
    fill = PAPER.paper if is_left else LETTERS[side]
    letter = text(x + size / 2, y + size / 2 + 3.2, side.letter, SMALL, anchor="middle", weight=600, fill=fill)
    return f"<rect {place} {look}/>{letter}"


def chip_picture(side: Side, size: float, words: str = "") -> Picture:
    """The same by itself; without words it is decoration."""
    return picture([chip(0, 0, side, size)], size, size, words)


def _words(frame: Frame, layout: Layout) -> list[str]:
    parts = []
    for hidden, room in layout.hidden:
        parts += _paint_hidden(hidden, room)
    for bracket, place in layout.brackets:
        parts += _paint_bracket(frame, bracket, place)
    for label, _ in layout.labels:
        parts.append(_dot(frame, label.point))
    for label, found in layout.labels:
        if found is not None:
            x, y = (found.left + found.right) / 2, (found.top + found.bottom) / 2
            parts.append(_haloed(x, y, label.text, WORDS, "middle", LETTERS[label.side], 600))
    return parts


def _paint_hidden(hidden: HiddenCurve, room: Box) -> list[str]:
    place = f'x="{room.left:.2f}" y="{room.top:.2f}" width="{room.right - room.left:.2f}" height="{HIDDEN_HEIGHT}"'
    edge = f'stroke="{PAPER.note}" stroke-width="0.6" stroke-dasharray="3 2"'
    inner = Frame(room.left, room.top, room.right - room.left, HIDDEN_HEIGHT, 0, 1)
    middle, left = (room.top + room.bottom) / 2, room.left + 2 * HIDDEN_PADDING + CHIP
    lines = [words for words in (_not_reported(), hidden.reason) if words]
    first = middle - LINE_HEIGHT * (len(lines) - 1) / 2
    return [
        f'<rect {place} rx="3" fill="{PAPER.paper}"/>',
        *hatches(inner),
        f'<rect {place} rx="3" fill="none" {edge}/>',
        box(room.left + HIDDEN_PADDING, middle - CHIP / 2, CHIP, CHIP, PAPER.paper),
        chip(room.left + HIDDEN_PADDING, middle - CHIP / 2, hidden.side),
        *(
            _haloed(left, first + k * LINE_HEIGHT, words, (WORDS, SMALL)[k], "start", PAPER.ink, (600, 400)[k])
            for k, words in enumerate(lines)
        ),
    ]


def _paint_bracket(frame: Frame, bracket: Deviation, place: MarkPlace) -> list[str]:
    parts = []
    for point in bracket.points:
        y = float(frame.y(point.angle_deg))
        parts.append(line(float(frame.x(point.percent)), y, place.bar_x, y, PAPER.ink, LEADER))
    parts.append(line(place.bar_x, place.top, place.bar_x, place.bottom, PAPER.ink, BAR))
    parts += [_dot(frame, point) for point in bracket.points]
    if place.words is not None:
        at, anchor = (place.words.left, "start") if place.are_words_at_right else (place.words.right, "end")
        rows = ((bracket.words, WORDS, PAPER.ink, 600), (bracket.more, SMALL, PAPER.note, 400))[: place.lines]
        for k, (words, size, colour, weight) in enumerate(rows):
            y = place.words.top + (k + 0.5) * LINE_HEIGHT
            parts.append(_haloed(at, y, words, size, anchor, colour, weight))
    return parts


def _dot(frame: Frame, point: Point) -> str:
    """Left filled, right outlined."""
    side = point.joint.side
    x, y = float(frame.x(point.percent)), float(frame.y(point.angle_deg))
    fill, edge = (CURVES[side], PAPER.paper) if side is Side.LEFT else (PAPER.paper, CURVES[side])
    return f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{DOT}" fill="{fill}" stroke="{edge}" stroke-width="{DOT_EDGE}"/>'


def _haloed(x: float, middle: float, words: str, size: float, anchor: str, colour: str, weight: int) -> str:
    """Words that are read over curves, for what is about them is the paper's white."""
    stated = text(x, middle + 0.35 * size, words, size, anchor=anchor, weight=weight, fill=colour)
    halo = f'<text paint-order="stroke" stroke="{PAPER.paper}" stroke-width="{HALO}" stroke-linejoin="round"'
    return stated.replace("<text", halo, 1)


def _simulated(frame: Frame, width: float) -> str:
    """Turned, at the right edge."""
    x, y = width - 3, (frame.top + frame.bottom) / 2
    stated = text(0, 0, tr("SIMULATED"), SMALL, anchor="middle", weight=600, fill=PAPER.note)
    return f'<g transform="translate({x:.2f} {y:.2f}) rotate(-90)">{stated}</g>'

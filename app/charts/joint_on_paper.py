"""Painting on paper: a joint of both legs over the stride as SVG, one unit a point, its values on the curves.

The same chart as the screen's, letters no smaller than nine points.
"""

from app.charts.canvas import Anchor, Lengths, Tone
from app.charts.cycles import PERCENT
from app.charts.drawing import Picture, box, circle, curve, line, picture, text
from app.charts.frame import Frame
from app.charts.on_paper import PaperFrame, band_on_paper, hatches
from app.charts.places import Size, layout_of
from app.charts.stride_chart import StrideChart, StrideCurve, toe_off_labels, toe_offs_in_order
from app.charts.stride_drawing import draw_axes, draw_marks
from app.theme.colours import LIGHT, PAPER
from app.wording.translation import tr
from core.body import Side

LEFT, RIGHT, TOP, FOOT = 26.0, 25.0, 40.0, 27.0
SMALL, WORDS, TITLE = 9.0, 9.5, 10.5  # sizes of letters
PER_LETTER = 0.58  # a letter's width on its height; an SVG cannot be asked
LINE, DASH, CASING, THIN, TOE_OFF = 1.65, "5.6 3.1", 1.4, 0.8, 0.8
BAR = 1.5
DOT, DOT_EDGE = 2.6, 1.3
CHIP, KEY_LINE, KEY_GAP, KEY_APART = 13.0, 15.0, 8.0, 4.0
SWATCH: Size = (12.0, 7.0)
DROP = 3.2  # from the middle of small letters to the line that they stand on
LENGTHS = Lengths(
    *(3.0, 6.0, 12.5 - DROP, 0.5, 0.6),
    *(BAR, 0.7, DOT + DOT_EDGE, 2.6, 11.5),
    *(CHIP, 6.0, 3 * 6.0 + CHIP, 30.0),
)
CURVES = {Side.LEFT: LIGHT.left, Side.RIGHT: LIGHT.right}
LETTERS = {Side.LEFT: LIGHT.left_text, Side.RIGHT: LIGHT.right_text}
TONES = {Tone.INK: PAPER.ink, Tone.NOTE: PAPER.note, Tone.AXIS: PAPER.note, Tone.INSIDE_ERROR: PAPER.ink}


class PaperCanvas:
    """Gathers the elements of an SVG, one unit a point."""

    lengths = LENGTHS

    def __init__(self) -> None:
        self.parts: list[str] = []

    def line(self, start: tuple[float, float], end: tuple[float, float], tone: Tone, width: float) -> None:
        self.parts.append(line(*start, *end, TONES[tone], width))

    def text(self, x: float, middle: float, stated: str, anchor: Anchor) -> None:
        self.parts.append(text(x, middle + DROP, stated, SMALL, anchor=anchor, fill=PAPER.note))

    def words(self, x: float, middle: float, stated: str, anchor: Anchor, tone: Tone | Side, *, is_first: bool) -> None:
        size, weight = (WORDS, 600) if is_first else (SMALL, 400)
        fill = LETTERS[tone] if isinstance(tone, Side) else TONES[tone]
        svg = text(x, middle + 0.35 * size, stated, size, anchor=anchor, weight=weight, fill=fill)
        halo = f'paint-order="stroke" stroke="{PAPER.paper}" stroke-width="{LENGTHS.halo}" stroke-linejoin="round"'
        self.parts.append(svg.replace("<text", f"<text {halo}", 1))

    def width_of(self, stated: str, *, is_first: bool) -> float:
        return _width(stated, WORDS if is_first else SMALL)

    def dot(self, x: float, y: float, side: Side) -> None:
        fill, edge = (CURVES[side], PAPER.paper) if side is Side.LEFT else (PAPER.paper, CURVES[side])
        self.parts.append(circle(x, y, DOT, fill, edge, DOT_EDGE))

    def chip(self, left: float, middle: float, side: Side) -> None:
        self.parts += [box(left, middle - CHIP / 2, CHIP, CHIP, PAPER.paper), chip(left, middle - CHIP / 2, side)]

    def hatched_box(self, left: float, top: float, width: float, height: float) -> None:
        place = f'x="{left:.2f}" y="{top:.2f}" width="{width:.2f}" height="{height}" rx="3"'
        edge = f'fill="none" stroke="{PAPER.note}" stroke-width="0.6" stroke-dasharray="3 2"'
        inner = hatches(Frame(left, top, width, height, 0, 1))
        self.parts += [f'<rect {place} fill="{PAPER.paper}"/>', *inner, f"<rect {place} {edge}/>"]


def draw_joint(chart: StrideChart, width: float, height: float) -> Picture:
    """Draw a chart of this size: title and key above, then axes, curves, and what is read on them."""
    frame = PaperFrame(LEFT, TOP, width - LEFT - RIGHT, height - TOP - FOOT, chart.axis.low, chart.axis.high)
    canvas = PaperCanvas()
    layout, parts = layout_of(canvas, frame, chart), canvas.parts
    parts += [
        text(0, 11, chart.title, TITLE, weight=600),
        text(0, 28, chart.sign, SMALL, fill=PAPER.note),
        *_key(chart, width),
    ]
    if chart.band is not None:
        parts += band_on_paper(frame, chart.band)
    draw_axes(canvas, frame, chart.axis)
    middle = (frame.left + frame.right) / 2
    parts.append(text(middle, frame.bottom + 24.5, tr("Gait cycle"), SMALL, anchor="middle", fill=PAPER.note))
    parts += _toe_offs(frame, chart)
    for one in chart.beside:
        parts.append(_path(frame, one, LETTERS[one.side], THIN))
    for one in sorted(chart.curves, key=lambda curve: curve.side, reverse=True):
        for stride in one.strides_deg:
            parts.append(curve(frame.x(PERCENT), frame.y(stride), CURVES[one.side], THIN, _dash(one.side)))
        if one.is_known:
            parts.append(curve(frame.x(PERCENT), frame.y(one.angle_deg), PAPER.paper, LINE + CASING))
            parts.append(_path(frame, one, CURVES[one.side], LINE))
    draw_marks(canvas, frame, layout)
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


def _simulated(frame: Frame, width: float) -> str:
    """Turned, at the right edge."""
    x, y = width - 3, (frame.top + frame.bottom) / 2
    stated = text(0, 0, tr("SIMULATED"), SMALL, anchor="middle", weight=600, fill=PAPER.note)
    return f'<g transform="translate({x:.2f} {y:.2f}) rotate(-90)">{stated}</g>'

"""Painting on paper: a joint of both legs over the stride as SVG, one unit a point, its values on the curves.

The same chart as the screen's, letters no smaller than nine points.
"""

from app.charts.canvas import Anchor, Lengths, Tone
from app.charts.cycles import PERCENT
from app.charts.drawing import Drawing, Picture
from app.charts.frame import Frame
from app.charts.on_paper import PaperFrame, draw_band, draw_hatches
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
HIDDEN_PADDING = 6.0
LENGTHS = Lengths(
    tick=3.0,
    label_apart=6.0,
    percents_below=12.5 - DROP,
    zero=0.5,
    axis=0.6,
    bar=BAR,
    leader=0.7,
    dot=DOT + DOT_EDGE,
    halo=2.6,
    line=11.5,
    chip=CHIP,
    hidden_padding=HIDDEN_PADDING,
    hidden_margins=3 * HIDDEN_PADDING + CHIP,
    hidden_height=30.0,
)
CURVES = {Side.LEFT: LIGHT.left, Side.RIGHT: LIGHT.right}
LETTERS = {Side.LEFT: LIGHT.left_text, Side.RIGHT: LIGHT.right_text}
TONES = {Tone.INK: PAPER.ink, Tone.NOTE: PAPER.note, Tone.AXIS: PAPER.note, Tone.INSIDE_ERROR: PAPER.ink}


class PaperCanvas(Drawing):
    """What screen and paper draw alike, as paper has it."""

    lengths = LENGTHS

    def stroke(self, start: tuple[float, float], end: tuple[float, float], tone: Tone, width: float) -> None:
        self.line(*start, *end, TONES[tone], width)

    def label(self, x: float, middle: float, stated: str, anchor: Anchor) -> None:
        self.text(x, middle + DROP, stated, SMALL, anchor=anchor, fill=PAPER.note)

    def words(self, x: float, middle: float, stated: str, anchor: Anchor, tone: Tone | Side, *, is_first: bool) -> None:
        size, weight = (WORDS, 600) if is_first else (SMALL, 400)
        fill, y = LETTERS[tone] if isinstance(tone, Side) else TONES[tone], middle + 0.35 * size
        self.text(x, y, stated, size, anchor=anchor, weight=weight, fill=fill, halo=LENGTHS.halo)

    def width_of(self, stated: str, *, is_first: bool) -> float:
        return _width(stated, WORDS if is_first else SMALL)

    def dot(self, x: float, y: float, side: Side) -> None:
        fill, edge = (CURVES[side], PAPER.paper) if side is Side.LEFT else (PAPER.paper, CURVES[side])
        self.circle(x, y, DOT, fill, edge, DOT_EDGE)

    def chip(self, left: float, middle: float, side: Side) -> None:
        self.box(left, middle - CHIP / 2, CHIP, CHIP, PAPER.paper)
        draw_chip(self, left, middle - CHIP / 2, side)

    def hatched_box(self, left: float, top: float, width: float, height: float) -> None:
        place = f'x="{left:.2f}" y="{top:.2f}" width="{width:.2f}" height="{height}" rx="3"'
        edge = f'fill="none" stroke="{PAPER.note}" stroke-width="0.6" stroke-dasharray="3 2"'
        self.parts.append(f'<rect {place} fill="{PAPER.paper}"/>')
        draw_hatches(self, Frame(left, top, width, height, 0, 1))
        self.parts.append(f"<rect {place} {edge}/>")


def draw_joint(chart: StrideChart, width: float, height: float) -> Picture:
    """Draw a chart of this size: title and key above, then axes, curves, and what is read on them."""
    frame = PaperFrame(LEFT, TOP, width - LEFT - RIGHT, height - TOP - FOOT, chart.axis.low, chart.axis.high)
    draw = PaperCanvas()
    layout = layout_of(draw, frame, chart)
    draw.text(0, 11, chart.title, TITLE, weight=600)
    draw.text(0, 28, chart.sign, SMALL, fill=PAPER.note)
    _draw_key(draw, chart, width)
    if chart.band is not None:
        draw_band(draw, frame, chart.band)
    draw_axes(draw, frame, chart.axis)
    middle = (frame.left + frame.right) / 2
    draw.text(middle, frame.bottom + 24.5, tr("Gait cycle"), SMALL, anchor="middle", fill=PAPER.note)
    _draw_toe_offs(draw, frame, chart)
    for one in chart.beside:
        _draw_curve(draw, frame, one, LETTERS[one.side], THIN)
    for one in sorted(chart.curves, key=lambda curve: curve.side, reverse=True):
        for stride in one.strides_deg:
            draw.curve(frame.x(PERCENT), frame.y(stride), CURVES[one.side], THIN, _dash(one.side))
        if one.is_known:
            draw.curve(frame.x(PERCENT), frame.y(one.angle_deg), PAPER.paper, LINE + CASING)
            _draw_curve(draw, frame, one, CURVES[one.side], LINE)
    draw_marks(draw, frame, layout)
    if chart.is_simulated:
        _draw_simulated(draw, frame, width)
    alt = " ".join(filter(None, [chart.alt, *(bracket.in_words() for bracket in chart.deviations)]))
    return draw.picture(width, height, alt)


def _draw_curve(draw: Drawing, frame: Frame, one: StrideCurve, colour: str, width: float) -> None:
    draw.curve(frame.x(PERCENT), frame.y(one.angle_deg), colour, width, _dash(one.side))


def _dash(side: Side) -> str:
    return DASH if side is Side.RIGHT else ""


def _width(words: str, size: float) -> float:
    return PER_LETTER * size * len(words)


def _draw_toe_offs(draw: Drawing, frame: Frame, chart: StrideChart) -> None:
    """Each line with its words above the plot, the earlier at the left of its line."""
    labels = toe_off_labels(chart.curves)
    for k, one in enumerate(toe_offs_in_order(chart.curves, 0)):
        x = float(frame.x(one.toe_off_percent))
        dash = "2.6 1.7" if one.side is Side.RIGHT else ""
        draw.line(x, frame.top - 9, x, frame.bottom, CURVES[one.side], TOE_OFF, dash)
        at, anchor = (x - 3, "end") if k == 0 else (x + 3, "start")
        draw.text(at, frame.top - 3, labels[one.side], SMALL, anchor=anchor, weight=500, fill=LETTERS[one.side])


def _draw_key(draw: Drawing, chart: StrideChart, width: float) -> None:
    """At the right of the title: each leg's chip and line, the thin line with its date, the reference's swatch."""
    right, y = width - 1, 7.5
    legs = [one for one in chart.curves if one.is_known]
    if chart.band is not None:
        words, (swatch, high) = tr("Reference"), SWATCH
        needed = len(legs) * (CHIP + KEY_APART + KEY_LINE + KEY_GAP) + swatch + _width(words, SMALL) + KEY_APART
        if chart.beside:
            needed += KEY_GAP + KEY_LINE + KEY_APART + _width(chart.beside[0].letter, SMALL)
        if _width(chart.title, TITLE) + KEY_GAP + needed <= width:  # else its swatch alone has room
            draw.text(right, y + 3.2, words, SMALL, anchor="end", fill=PAPER.note)
            right -= _width(words, SMALL) + KEY_APART
        right -= swatch
        draw.box(right, y - high / 2, swatch, high, PAPER.band_2sd, PAPER.band_2sd_edge, 0.35)
        draw.box(right, y - high / 4, swatch, high / 2, PAPER.band_1sd)
        right -= KEY_GAP
    if chart.beside:
        draw.text(right, y + 3.2, chart.beside[0].letter, SMALL, anchor="end", fill=PAPER.note)
        right -= _width(chart.beside[0].letter, SMALL) + KEY_APART + KEY_LINE
        colour = LETTERS[chart.beside[0].side] if len(chart.beside) == 1 else PAPER.note
        draw.line(right, y, right + KEY_LINE, y, colour, THIN)
        right -= KEY_GAP
    for one in reversed(legs):
        right -= KEY_LINE
        draw.line(right, y, right + KEY_LINE, y, CURVES[one.side], LINE, _dash(one.side))
        right -= KEY_APART + CHIP
        draw_chip(draw, right, y - CHIP / 2, one.side)
        right -= KEY_GAP


def draw_chip(draw: Drawing, x: float, y: float, side: Side, size: float = CHIP) -> None:
    """The letter of a leg in its frame, L filled, R outlined and dashed; `x`, `y` are its corner."""
    is_left = side is Side.LEFT
    place = f'x="{x + 0.5:.2f}" y="{y + 0.5:.2f}" width="{size - 1:.2f}" height="{size - 1:.2f}" rx="2.4"'
    look = f'fill="{LETTERS[side]}"' if is_left else f'fill="none" stroke="{LETTERS[side]}" stroke-dasharray="2 1.2"'
    fill = PAPER.paper if is_left else LETTERS[side]
    draw.parts.append(f"<rect {place} {look}/>")
    draw.text(x + size / 2, y + size / 2 + DROP, side.letter, SMALL, anchor="middle", weight=600, fill=fill)


def chip_picture(side: Side, size: float, words: str = "") -> Picture:
    """The same by itself; without words it is decoration."""
    draw = Drawing()
    draw_chip(draw, 0, 0, side, size)
    return draw.picture(size, size, words)


def _draw_simulated(draw: Drawing, frame: Frame, width: float) -> None:
    """Turned, at the right edge."""
    x, y = width - 3, (frame.top + frame.bottom) / 2
    draw.parts.append(f'<g transform="translate({x:.2f} {y:.2f}) rotate(-90)">')
    draw.text(0, 0, tr("SIMULATED"), SMALL, anchor="middle", weight=600, fill=PAPER.note)
    draw.parts.append("</g>")

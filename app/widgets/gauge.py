"""Gauge of how well a joint is known from the motion so far.

Its rings close as what motion can still reduce goes down.
"""

import math
from dataclasses import dataclass
from enum import Enum, auto

from PySide6.QtCore import QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QAccessible, QColor, QFont, QFontMetrics, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme.current import current_theme, px, scaled
from app.theme.icons import Icon, paint_icon
from app.theme.leg_chip import paint_chip
from app.theme.theme import CARD_RADIUS
from app.widgets.text import MEDIUM, REGULAR, SEMIBOLD
from app.wording.body import joint_name, name_of
from app.wording.translation import capitalised, figure_text, tr
from core.body import Joint, Side
from core.calibration.certainty import AXIS_FLOOR_HUMAN_RAD
from core.live.excitation import ExcitationState, Required

AXIS_FROM_DEG, CENTRE_FROM_MM = 30.0, 120.0  # where the rings begin
UNKNOWN = "\N{EN DASH}"
STEPS = 360  # of a ring: finer ones nobody sees
DASHES, DASH = 40, 0.62  # of the right leg's rings
CARD = QSize(400, 210)
COMPACT_CARD = QSize(340, 130)
RING, CLOSED_RING = 174, 166
OUTER, INNER, CLOSED_OUTER, CLOSED_INNER = 14.0, 6.0, 7.0, 3.0
RING_GAP = 5.0
VALUE, LARGEST_VALUE = 56, 72
CHIP = 28
PADDING, MARGIN = 22, 18  # beside the words; round the ring
MIDDLE = 108  # of the ring, from the edge of its side
# of the words: name, two rows, a rule, the state, from the top of the block, which is as high as all of them
ROWS_FROM, ROW, ROW_EVERY, RULE, STATE_FROM, BLOCK = 46, 26, 28, 110, 120, 166
LEAST_ROUND = 6  # above and below the block
STATE_SIZES = (15, 14, 13, 12)
STATE_FLAGS = int(Qt.AlignmentFlag.AlignVCenter) | int(Qt.TextFlag.TextWordWrap)
WIDEST = 240  # of the words: a figure and the one required are read together


class GaugeState(Enum):
    OPEN = auto()
    NOW = auto()  # the joint whose motion helps most
    ENOUGH = auto()  # motion, for axis and centre
    CENTRE = auto()  # motion for the centre of an ankle, whose axis is found while walking
    PLATEAU = auto()  # as good as this motion gives
    LOOSE = auto()  # of a prosthesis, and turns as no hinge does
    NEEDS = auto()  # a sensor that moves like another place's
    ABSENT = auto()  # nothing to find, or nothing to find it with


CLOSED = (GaugeState.ENOUGH, GaugeState.CENTRE)  # all that free motion can find of the joint is found


@dataclass(frozen=True, slots=True)
class GaugeMeasure:
    """One figure of a joint: as it is read, what is required, and how far its ring is closed (0 to 1)."""

    figure: str
    unit: str
    required: str
    share: float
    is_met: bool


@dataclass(frozen=True, slots=True)
class GaugeFace:
    """`axis` is None where it is not asked for: walking finds an ankle's. `note` states why there is no figure."""

    state: GaugeState = GaugeState.OPEN
    axis: GaugeMeasure | None = None
    centre: GaugeMeasure | None = None
    note: str = ""


def gauge_face(joint: Joint, found: ExcitationState | None, required: Required, is_now: bool) -> GaugeFace:
    """Read a gauge off the excitation, without the floors that no motion reduces; None: no samples yet."""
    is_closed = found is not None and found.is_closed
    axis_deg = math.degrees(found.axis_sd_rad) if found is not None else math.inf
    centre_mm = 1000 * found.centre_sd_m if found is not None else math.inf
    axis_required, centre_required = math.degrees(required.axis_rad), 1000 * required.centre_m
    axis = gauge_measure(axis_deg, axis_required, AXIS_FROM_DEG, "°", is_closed) if joint.is_knee else None
    centre = gauge_measure(centre_mm, centre_required, CENTRE_FROM_MM, "mm", is_closed)
    if found is None:
        return GaugeFace(GaugeState.NOW if is_now else GaugeState.OPEN, axis, centre)
    if _is_loose(joint, found, required) and (is_closed or found.is_plateau):
        state = GaugeState.LOOSE
    elif is_closed:
        state = GaugeState.ENOUGH if joint.is_knee else GaugeState.CENTRE
    elif found.is_plateau and not is_now:
        state = GaugeState.PLATEAU
    else:
        state = GaugeState.NOW if is_now else GaugeState.OPEN
    return GaugeFace(state, axis, centre)


def _is_loose(joint: Joint, found: ExcitationState, required: Required) -> bool:
    """Check whether a knee that is one axis by construction turns across it as much as a human knee does."""
    floor_rad = math.sqrt(max(found.axis_sd_with_floor_rad**2 - found.axis_sd_rad**2, 0.0))
    return required.is_hinge and joint.is_knee and floor_rad > AXIS_FLOOR_HUMAN_RAD


def _words(face: GaugeFace) -> tuple[object, ...]:
    """All of a face but its ring and the figures in it."""
    measures = (face.axis, face.centre)
    return face.state, face.note, [(one.required, one.is_met) if one is not None else None for one in measures]


def two_digits(value: float, required: float = math.inf) -> str:
    """Write a certainty as it is shown: 0.8, 2.4, 11. One not yet as required never reads as if it were."""
    decimals = 1 if round(value, 1) < 10 else 0
    if value > required >= round(value, decimals):
        return figure_text(required + 0.1, ".1f") if required < 9.9 else f"{required + 1:.0f}"
    return figure_text(value, f".{decimals}f")


def gauge_measure(value: float, required: float, begins: float, unit: str, is_closed: bool) -> GaugeMeasure:
    """Read a figure. A ring is logarithmic: each halving of what is uncertain closes as much of it."""
    share = math.log(begins / value) / math.log(begins / required) if 0 < value < math.inf else 0.0
    is_met = is_closed or value <= required
    share = 1.0 if is_met else min(max(share, 0.0), 1.0 - 1 / STEPS)
    figure = two_digits(value, math.inf if is_met else required) if value < begins else UNKNOWN
    space = "" if unit == "°" else " "
    return GaugeMeasure(figure, unit, figure_text(required, "g") + space + unit, _steps(share), is_met)


def _steps(share: float) -> float:
    return round(share * STEPS) / STEPS


class Gauge(QWidget):
    """One joint's card. The ring lies on the side of the figure: a right leg's at the right."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, joint: Joint) -> None:
        super().__init__()
        self._joint = joint
        self._face = GaugeFace()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._name()
        self.set_compact(is_compact=False)

    @property
    def face(self) -> GaugeFace:
        return self._face

    def show_face(self, face: GaugeFace) -> None:
        """Show it; painted again only if it reads otherwise than before."""
        if face == self._face:
            return
        before, self._face = self._face, face
        self._name()
        if self.is_brief or _words(before) != _words(face):
            self.update()
        else:
            self.update(self._ring().toAlignedRect().adjusted(-1, -1, 1, 1))

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        scaled(self.setMinimumSize, 300 if is_compact else 330, 112)
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        return (COMPACT_CARD if self._is_compact else CARD) * current_theme().scale

    @property
    def is_brief(self) -> bool:
        """Whether it is compact, or too low for all of its words under each other, as below a banner."""
        if self._is_compact:
            return True
        if self.height() < px(BLOCK + 2 * LEAST_ROUND):
            return True
        width = self._words_box(self._ring()).width()
        words = {self._state_words, *map(state_word, GaugeState)}
        return any(self._lines(one, self._state_font(one, width), width) > px(BLOCK - STATE_FROM) for one in words)

    def paintEvent(self, event: QPaintEvent) -> None:
        theme, face = current_theme(), self._face
        c = theme.colours
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        is_now, is_absent = face.state is GaugeState.NOW, face.state is GaugeState.ABSENT
        pen = theme.pen(c.ink if is_now else c.control if is_absent else c.line, 2.5 if is_now else 1)
        if is_absent:
            pen.setDashPattern([3.0, 3.0])
        painter.setPen(pen)
        painter.setBrush(Qt.BrushStyle.NoBrush if is_absent else QColor(c.surface))
        half, radius = pen.widthF() / 2, CARD_RADIUS * theme.scale
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(half, half, -half, -half), radius, radius)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if is_absent:
            self._paint_absent(painter)
        elif self.is_brief:
            self._paint_compact(painter)
        else:
            self._paint_full(painter, event.rect())

    # the parts of a card

    def _ring(self) -> QRectF:
        """The square of the ring on a full card."""
        grow = min(self.width() / px(CARD.width()), self.height() / px(CARD.height()))
        middle = px(MIDDLE) * min(max(grow, 0.8), 1.3)
        room = min(self.height() - 2 * px(MARGIN), 2 * middle - 2 * px(MARGIN))
        ring = QRectF(0, 0, room, room)
        ring.moveCenter(QPointF(self.width() - middle if self._joint.side is Side.RIGHT else middle, self.height() / 2))
        return ring

    def _words_box(self, ring: QRectF) -> QRectF:
        """Where the words of a full card are, beside its ring."""
        words = QRectF(px(PADDING), (self.height() - px(BLOCK - 4)) / 2, self.width() - 2 * px(PADDING), px(BLOCK))
        if self._joint.side is Side.RIGHT:
            words.setRight(min(ring.left() - px(16), words.left() + px(WIDEST)))
        else:
            words.setLeft(ring.right() + px(16))
            words.setRight(min(words.right(), words.left() + px(WIDEST)))
        return words

    @property
    def _state_words(self) -> str:
        return self._face.note if self._face.state is GaugeState.NEEDS else state_word(self._face.state)

    def _state_font(self, words: str, width: float) -> QFont:
        """The largest in which the words have two lines' room; every state in semibold but the quiet ones."""
        theme = current_theme()
        is_quiet = self._face.state in (GaugeState.OPEN, GaugeState.NEEDS)
        fonts = [theme.font(size, REGULAR if is_quiet else SEMIBOLD) for size in STATE_SIZES]
        room = theme.px(BLOCK - STATE_FROM)
        return next((font for font in fonts if self._lines(words, font, width) <= room), fonts[-1])

    def _lines(self, words: str, font: QFont, width: float) -> int:
        """How high the words are in their lines, beside the largest mark of a state."""
        room = QRect(0, 0, round(width) - px(38), 1000)
        return QFontMetrics(font).boundingRect(room, STATE_FLAGS, words).height()

    def _paint_full(self, painter: QPainter, part: QRect) -> None:
        ring = self._ring()
        self._paint_rings(painter, ring)
        self._paint_value(painter, ring)
        if ring.adjusted(-2, -2, 2, 2).contains(QRectF(part)):
            return  # words are dear, and as they were
        words = self._words_box(ring)
        self._paint_name(painter, words)
        self._paint_rows(painter, words)
        self._paint_state(painter, words)

    def _paint_compact(self, painter: QPainter) -> None:
        theme, face = current_theme(), self._face
        c, px = theme.colours, theme.px
        room = min(self.height() - px(24), px(118))
        ring = QRectF(px(14), (self.height() - room) / 2, room, room)
        self._paint_rings(painter, ring)
        icon = _ICONS[face.state]
        if icon is not None:
            mark = QRectF(0, 0, px(32), px(32))
            mark.moveCenter(ring.center())
            paint_icon(painter, icon, mark, c.ink)
        words = QRectF(self.rect()).adjusted(px(14) + room + px(20), px(10), -px(18), -px(8))
        name_width = self._paint_name(painter, words.adjusted(0, 0, -0.38 * words.width(), 0))
        left = words.left() + name_width + px(12)
        beside = QRectF(left, words.top(), words.right() - left, words.height() - px(36))
        self._paint_state_word(painter, beside)
        main, second = self._figures()
        painter.setPen(QColor(c.ink))
        painter.setFont(theme.font(VALUE, SEMIBOLD))
        bottom = Qt.AlignmentFlag.AlignBottom
        painter.drawText(words, bottom | Qt.AlignmentFlag.AlignLeft, main)
        beside_main = painter.fontMetrics().horizontalAdvance(main) + px(8)
        painter.setPen(QColor(c.ink2))
        painter.setFont(theme.font(20, MEDIUM))
        is_unit = face.axis is None  # it is beside its figure; a second figure is apart
        line = words.adjusted(beside_main if is_unit else 0, 0, 0, -px(10))
        painter.drawText(
            line, bottom | (Qt.AlignmentFlag.AlignLeft if is_unit else Qt.AlignmentFlag.AlignRight), second
        )

    def _paint_absent(self, painter: QPainter) -> None:
        theme = current_theme()
        px = theme.px
        words = QRectF(self.rect()).adjusted(px(PADDING), px(24), -px(PADDING), -px(10))
        if self.is_brief:
            words.adjust(0, -px(8), 0, 0)
        self._paint_name(painter, words)
        painter.setPen(QColor(theme.colours.ink2))
        painter.setFont(theme.font(14 if self.is_brief else 16))
        note = words.adjusted(0, px(CHIP + 14), 0, 0)
        painter.drawText(note, Qt.TextFlag.TextWordWrap, self._face.note)

    def _paint_rings(self, painter: QPainter, room: QRectF) -> None:
        face, unit = self._face, room.width() / RING
        is_thin = face.state in CLOSED
        outer, inner = (CLOSED_OUTER, CLOSED_INNER) if is_thin else (OUTER, INNER)
        back = (RING - CLOSED_RING) / 2 * unit if is_thin else 0.0
        first, second = (face.axis, face.centre) if face.axis is not None else (face.centre, None)
        box = room.adjusted(back, back, -back, -back)
        for measure, width in ((first, outer * unit), (second, inner * unit)):
            if measure is None:
                continue
            half = width / 2
            self._paint_ring(painter, box.adjusted(half, half, -half, -half), width, measure.share)
            step = width + RING_GAP * unit
            box.adjust(step, step, -step, -step)

    def _paint_ring(self, painter: QPainter, box: QRectF, width: float, share: float) -> None:
        theme, side = current_theme(), self._joint.side
        pen = theme.pen(theme.colours.track, 1)
        pen.setWidthF(width)
        pen.setCapStyle(Qt.PenCapStyle.FlatCap)
        if share < 1.0:
            painter.setPen(pen)
            painter.drawEllipse(box)
        if share <= 0.0:
            return
        pen.setColor(theme.curve(side))
        if side is Side.RIGHT:
            pitch = math.pi * box.width() / DASHES / width  # in widths of the pen, as Qt counts
            pen.setDashPattern([DASH * pitch, (1 - DASH) * pitch])
        painter.setPen(pen)
        painter.drawArc(box, 90 * 16, -round(share * 360 * 16))

    def _paint_value(self, painter: QPainter, ring: QRectF) -> None:
        theme, middle = current_theme(), Qt.AlignmentFlag.AlignCenter
        grow = ring.width() / RING / theme.scale
        size, second_size = min(LARGEST_VALUE, VALUE * grow), max(14.0, 20 * min(grow, 1.2))
        main, second = self._figures()
        px = theme.px
        painter.setPen(QColor(theme.colours.ink))
        painter.setFont(theme.font(size, SEMIBOLD))
        centre = ring.center()
        figure = QRectF(ring.left(), centre.y() - px(size) * 0.72, ring.width(), px(size) * 1.12)
        if main.endswith("°"):  # a degree sign is light: the digits stand in the middle
            figure.translate(painter.fontMetrics().horizontalAdvance("°") * 0.16, 0)
        painter.drawText(figure, middle, main)
        painter.setPen(QColor(theme.colours.ink2))
        painter.setFont(theme.font(second_size, MEDIUM))
        below = QRectF(ring.left(), centre.y() + px(size) * 0.36, ring.width(), px(second_size) * 1.4)
        painter.drawText(below, middle, second)

    def _paint_name(self, painter: QPainter, words: QRectF) -> float:
        theme = current_theme()
        chip = theme.px(CHIP)
        paint_chip(painter, QRectF(words.left(), words.top(), chip, chip), self._joint.side, theme)
        painter.setPen(QColor(theme.colours.ink))
        name = joint_name(self._joint)
        left = words.left() + chip + theme.px(10)
        painter.setFont(self._fitting(name, 22, words.right() - left))
        painter.drawText(QRectF(left, words.top(), words.right() - left, chip), Qt.AlignmentFlag.AlignVCenter, name)
        return chip + theme.px(10) + painter.fontMetrics().horizontalAdvance(name)

    def _paint_rows(self, painter: QPainter, words: QRectF) -> None:
        """What is asked for, and whether it is met: in words, for rings are read by nobody at once."""
        theme, face = current_theme(), self._face
        c, px = theme.colours, theme.px
        top = words.top() + px(ROWS_FROM)
        for name, measure in ((tr("Axis"), face.axis), (tr("Centre"), face.centre)):
            line = QRectF(words.left(), top, words.width(), px(ROW))
            mark = QRectF(line.left(), line.center().y() - px(8), px(16), px(16))
            is_met = measure is not None and measure.is_met
            paint_icon(painter, Icon.CHECK if is_met else Icon.UNCHECKED, mark, c.ink)
            painter.setPen(QColor(c.ink))
            painter.setFont(theme.font(14, MEDIUM))
            painter.drawText(line.adjusted(px(24), 0, 0, 0), Qt.AlignmentFlag.AlignVCenter, name)
            room = line.width() - px(24 + 6) - painter.fontMetrics().horizontalAdvance(name)
            painter.setPen(QColor(c.ink2))
            painter.setFont(theme.font(14))
            required, short = tr("while walking"), tr("later")  # an ankle's axis
            if measure is not None:
                required, short = tr("under {limit}").format(limit=measure.required), f"< {measure.required}"
            if painter.fontMetrics().horizontalAdvance(required) > room:
                required = short
                painter.setFont(self._fitting(short, 14, room, REGULAR))
            painter.drawText(line, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignRight, required)
            top += px(ROW_EVERY)
        painter.setPen(theme.pen(c.line, 1))
        rule = words.top() + px(RULE)
        painter.drawLine(QPointF(words.left(), rule), QPointF(words.right(), rule))

    def _paint_state(self, painter: QPainter, words: QRectF) -> None:
        theme, face = current_theme(), self._face
        c, px = theme.colours, theme.px
        word, icon = self._state_words, _ICONS[face.state]
        line = words.adjusted(0, px(STATE_FROM), 0, 0)
        x = line.left()
        if icon is not None:
            side = px(28) if face.state in CLOSED else px(20)
            mark = QRectF(x, line.center().y() - side / 2, side, side)
            if face.state in CLOSED:
                painter.setPen(Qt.PenStyle.NoPen)
                painter.setBrush(QColor(c.inv))
                painter.drawEllipse(mark)
                painter.setBrush(Qt.BrushStyle.NoBrush)
                paint_icon(painter, icon, mark.adjusted(px(5), px(5), -px(5), -px(5)), c.inv_ink)
            else:
                paint_icon(painter, icon, mark.translated(-px(4) if face.state is GaugeState.NOW else 0, 0), c.ink)
            x += side + (px(10) if face.state in CLOSED else px(6))
        painter.setPen(QColor(c.ink2 if face.state in (GaugeState.OPEN, GaugeState.NEEDS) else c.ink))
        painter.setFont(self._state_font(word, words.width()))
        painter.drawText(QRectF(x, line.top(), line.right() - x + 1, line.height()), STATE_FLAGS, word)

    def _paint_state_word(self, painter: QPainter, place: QRectF) -> None:
        theme, state = current_theme(), self._face.state
        word, is_open = self._state_words, state in (GaugeState.OPEN, GaugeState.NEEDS)
        is_short = state in (GaugeState.NOW, GaugeState.OPEN)
        painter.setPen(QColor(theme.colours.ink2 if is_open else theme.colours.ink))
        longest = word if is_short else max(word.split(), key=len, default="")
        painter.setFont(self._fitting(longest, 18 if is_short else 14, place.width(), REGULAR if is_open else SEMIBOLD))
        flags = int(Qt.AlignmentFlag.AlignRight) | int(Qt.TextFlag.TextWordWrap)
        painter.drawText(place.adjusted(0, theme.px(3), 0, 0), flags, word)

    def _figures(self) -> tuple[str, str]:
        """The main figure, and the second one or the main one's unit."""
        axis, centre = self._face.axis, self._face.centre
        if centre is None:
            return UNKNOWN, ""
        is_known = centre.figure != UNKNOWN
        if axis is None:
            return centre.figure, centre.unit if is_known else ""
        degree = axis.unit if axis.figure != UNKNOWN else ""
        return f"{axis.figure}{degree}", f"{centre.figure} {centre.unit}" if is_known else ""

    def _fitting(self, text: str, size: float, width: float, weight: QFont.Weight = SEMIBOLD) -> QFont:
        """The font of `size`, or of the largest below in which the text has its room."""
        font = current_theme().font(size, weight)
        wide = QFontMetrics(font).horizontalAdvance(text)
        return font if wide <= width else current_theme().font(max(12.0, size * width / wide - 0.5), weight)

    def _name(self) -> None:
        """Left knee, axis 11°, under 1.5° needed, centre 34 mm, under 10 mm needed, move now."""
        face = self._face
        parts = [capitalised(name_of(self._joint))]
        if face.axis is None and face.centre is not None:
            parts.append(tr("axis found while walking"))
        for name, measure in ((tr("axis"), face.axis), (tr("centre"), face.centre)):
            if measure is not None:
                space = "" if measure.unit == "°" else " "
                known = f"{measure.figure}{space}{measure.unit}" if measure.figure != UNKNOWN else tr("unknown")
                parts.append(f"{name} {known}")
                parts.append(tr("under {limit} required").format(limit=measure.required))
        parts.append(face.note or (tr("move now") if face.state is GaugeState.NOW else state_word(face.state)))
        self.setAccessibleName(", ".join(parts))


_ICONS: dict[GaugeState, Icon | None] = {
    GaugeState.OPEN: None,
    GaugeState.NOW: Icon.NEXT,
    GaugeState.ENOUGH: Icon.CHECK,
    GaugeState.CENTRE: Icon.CHECK,
    GaugeState.PLATEAU: Icon.INFO,
    GaugeState.LOOSE: Icon.WARNING,
    GaugeState.NEEDS: Icon.INFO,
    GaugeState.ABSENT: None,
}


def state_word(state: GaugeState) -> str:
    """Say a state as the gauge does."""
    return {
        GaugeState.OPEN: tr("To do"),
        GaugeState.NOW: tr("Now"),
        GaugeState.ENOUGH: tr("Enough movement"),
        GaugeState.CENTRE: tr("Enough movement for the centre"),
        GaugeState.PLATEAU: tr("uncertainty no longer falls"),
        GaugeState.LOOSE: tr("not a hinge"),
        GaugeState.NEEDS: "",
        GaugeState.ABSENT: "",
    }[state]

"""Gauge of how well a hip is known from the motion so far.

It is a slim card: nothing waits for it, and a walk shows it as well.
"""

import math
from dataclasses import dataclass

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QAccessible, QColor, QFontMetrics, QPainter
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, px, scaled
from app.theme.icons import Icon, paint_icon
from app.theme.leg_chip import paint_chip
from app.theme.theme import CARD_RADIUS
from app.widgets.gauge import DASH, DASHES, UNKNOWN, GaugeMeasure, gauge_measure
from app.widgets.painted import Painted
from app.widgets.painted_text import RIGHT, PaintedText, height_for
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wording.body import joint_name, name_of
from app.wording.translation import capitalised, tr
from core.body import Joint, Side
from core.hip.measure import MAX_3D_SD_RAD
from core.live.hip_heading import HipHeadingState

HEADING_FROM_DEG = 60.0  # where the ring begins
HEIGHT, COMPACT_HEIGHT, LEAST_HEIGHT = 64, 52, 20
RING = 40
WIDTH = 7.0  # of the ring
CHIP = 24
VALUE = 30
LOW_BELOW = 40  # without a ring, in small letters
LOW_CHIP, LOW_VALUE = 16, 14


@dataclass(frozen=True, slots=True)
class HipFace:
    """`heading` states how surely pelvis and thigh face each other; `note` states why there is nothing to find."""

    heading: GaugeMeasure | None = None
    is_now: bool = False
    note: str = ""

    @property
    def is_met(self) -> bool:
        return self.heading is not None and self.heading.is_met


def hip_face(found: HipHeadingState | None, is_now: bool = False) -> HipFace:
    """Read a gauge off what is known of the heading; None: no samples yet."""
    sd_deg = math.degrees(found.sd_rad) if found is not None and found.is_trusted else math.inf
    is_sure = found is not None and found.is_sure
    required_deg = round(math.degrees(MAX_3D_SD_RAD))
    return HipFace(gauge_measure(sd_deg, required_deg, HEADING_FROM_DEG, "°", is_sure), is_now and not is_sure)


class HipGauge(Painted):
    """One hip's card: its ring at the left, what would show it in the middle, the figure at the right."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, joint: Joint) -> None:
        super().__init__()
        self._joint = joint
        self._face = HipFace()
        self._is_compact = False
        scaled(self.setMinimumSize, 300, LEAST_HEIGHT)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Maximum)
        self._name()

    @property
    def face(self) -> HipFace:
        return self._face

    def show_face(self, face: HipFace) -> None:
        """Show it; painted again only if it reads otherwise than before."""
        if face != self._face:
            self._face = face
            self._name()
            self.update()

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(px(300), px(COMPACT_HEIGHT if self._is_compact else HEIGHT))

    @property
    def _is_low(self) -> bool:
        return self.height() < px(LOW_BELOW)

    @property
    def _chip(self) -> int:
        return px(LOW_CHIP if self._is_low else CHIP)

    def painted_texts(self) -> list[PaintedText]:
        """Give what is painted now, each in its box."""
        theme, face = current_theme(), self._face
        px = theme.px
        box = QRectF(self.rect()).adjusted(px(14), 0, -px(14), 0)
        left = self._chip_left() + self._chip + px(8)
        name = theme.font(14 if self._is_low else 18, SEMIBOLD)
        value = theme.font(LOW_VALUE if self._is_low else VALUE, SEMIBOLD)
        name_width = QFontMetrics(name).horizontalAdvance(joint_name(self._joint)) + px(2)
        texts = [PaintedText(joint_name(self._joint), QRectF(left, 0, name_width, box.height()), name, "ink")]
        words_left, words_right = left + name_width + px(12), box.right()
        if face.heading is not None and not face.note:
            figure = face.heading.figure + (face.heading.unit if face.heading.figure != UNKNOWN else "")
            width = max(map(QFontMetrics(value).horizontalAdvance, ("88°", "8.8°"))) + px(2)
            at = QRectF(box.right() - width, 0, width, box.height())
            texts.append(PaintedText(figure, at, value, "ink", RIGHT))
            words_right = at.left() - px(10)
        weight = SEMIBOLD if face.is_met or face.is_now else MEDIUM
        words, room = theme.font(12 if self._is_low else 14, weight), words_right - words_left
        stated = self.stated
        height = height_for(stated, words, round(room))
        at = QRectF(words_left, (box.height() - height) / 2, room, height)
        return [*texts, PaintedText(stated, at, words, "ink" if face.is_met or face.is_now else "ink2", wraps=True)]

    @property
    def stated(self) -> str:
        """What would show the hip, or that it is shown."""
        return self._face.note or (
            tr("Enough movement") if self._face.is_met else tr("Walk 15 s with a turn, or lunge")
        )

    def draw(self, painter: QPainter) -> None:
        theme, face = current_theme(), self._face
        c = theme.colours
        pen = theme.pen(c.ink if face.is_now else c.control if face.note else c.line, 2.5 if face.is_now else 1)
        if face.note:
            pen.setDashPattern([3.0, 3.0])
        painter.setPen(pen)
        painter.setBrush(Qt.BrushStyle.NoBrush if face.note else QColor(c.surface))
        half, radius = pen.widthF() / 2, CARD_RADIUS * theme.scale
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(half, half, -half, -half), radius, radius)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if not self._is_low:
            self._paint_ring(painter, self._ring())
        chip = self._chip
        paint_chip(painter, QRectF(self._chip_left(), (self.height() - chip) / 2, chip, chip), self._joint.side, theme)

    def _ring(self) -> QRectF:
        side = min(px(RING), self.height() - px(16))
        return QRectF(px(14), (self.height() - side) / 2, side, side)

    def _chip_left(self) -> float:
        return px(14) if self._is_low else self._ring().right() + px(12)

    def _paint_ring(self, painter: QPainter, room: QRectF) -> None:
        theme, face, side = current_theme(), self._face, self._joint.side
        width = theme.px(WIDTH)
        box = room.adjusted(width / 2, width / 2, -width / 2, -width / 2)
        pen = theme.pen(theme.colours.track, 1)
        pen.setWidthF(width)
        pen.setCapStyle(Qt.PenCapStyle.FlatCap)
        share = face.heading.share if face.heading is not None and not face.note else 0.0
        if share < 1.0:
            painter.setPen(pen)
            painter.drawEllipse(box)
        if share > 0.0:
            pen.setColor(theme.curve(side))
            if side is Side.RIGHT:
                pitch = math.pi * box.width() / (DASHES / 2) / width
                pen.setDashPattern([DASH * pitch, (1 - DASH) * pitch])
            painter.setPen(pen)
            painter.drawArc(box, 90 * 16, -round(share * 360 * 16))
        if face.is_met:
            mark = QRectF(0, 0, theme.px(18), theme.px(18))
            mark.moveCenter(room.center())
            paint_icon(painter, Icon.CHECK, mark, theme.colours.ink)

    def _name(self) -> None:
        """Left hip, heading 11°, under 6° needed, walk 15 s with a turn, or lunge."""
        face = self._face
        parts = [capitalised(name_of(self._joint))]
        if face.heading is not None and not face.note:
            is_known = face.heading.figure != UNKNOWN
            figure = f"{face.heading.figure}{face.heading.unit}" if is_known else tr("unknown")
            parts += [f"{tr('heading')} {figure}", tr("under {limit} required").format(limit=face.heading.required)]
        self.setAccessibleName(", ".join([*parts, self.stated]))

"""The legs at one percent of the gait cycle, from the side: each leg at that percent of its own cycle, on one hip."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QAccessible, QColor, QFontMetrics, QHideEvent, QKeyEvent, QMouseEvent, QPainter
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy

from app.summary.drawn_legs import HALF_WIDTHS_M
from app.summary.mean_legs import MeanLegs, ThinBend, bent_by
from app.theme.current import current_theme, px
from app.theme.leg_chip import paint_chip
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.limb import limb_outline
from app.widgets.painted import Painted
from app.widgets.painted_text import LEFT, PaintedText
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.numbers import MINUS
from app.wording.translation import later, tr
from core.body import Side
from core.samples import FloatArray

LEAST_PICTURE = (112, 96)
CHIP, ROW, CHIP_GAP = 18, 26, 8
SMALL = 12
FRAME_MS = 33
PLAYED_CYCLE_S = 2.4  # half as fast as people walk
STEP, LONG_STEP = 1.0, 10.0  # percent
PELVIS_M, PELVIS_HALF_M = 0.14, 0.08  # as large as it looks right
NO_LEGS = later("To draw legs, data of a thigh sensor and an absolute knee angle are needed.")
DRAWN = later(
    "Each leg is at this percent of its own gait cycle. Drawn from joint angles and thigh inclination; the position "
    "is not measured."
)
GHOST = later("Thin: shank and foot at the angles of the thin line.")


class StrideLegs(Card):
    """`moved` gives the percent of the gait cycle that the cursor is at, whoever moved it. Space plays and stops."""

    accessible_role = QAccessible.Role.Chart

    moved = Signal(float)

    def __init__(self) -> None:
        super().__init__(padding=12, spacing=4)
        self.percent = 0.0
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self._where = Text(size=12, tone="ink2")
        head = lay_out(QHBoxLayout(), Text(tr("Legs"), size=16, weight=SEMIBOLD), 1, self._where)
        self.picture = _Picture()
        self.note = Text(tr(NO_LEGS), size=12, tone="ink2", wraps=True)
        lay_out(self.column, head, self.note, (self.picture, 1))
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        self._timer = QTimer(self)
        self._timer.setInterval(FRAME_MS)
        self._timer.timeout.connect(self._on_beat)
        self.setAccessibleName(tr("Legs"))
        self.show_legs(None, {})

    @property
    def least_width(self) -> int:
        """What its words need, whether there are legs or not."""
        margins = self.column.contentsMargins()
        return margins.left() + self.picture.minimumSizeHint().width() + margins.right()

    @property
    def is_playing(self) -> bool:
        return self._timer.isActive()

    def show_legs(
        self,
        legs: MeanLegs | None,
        knee_deg: Mapping[Side, FloatArray | None],
        thin: Mapping[Side, ThinBend] | None = None,
    ) -> None:
        """Show another walk's legs at the cursor's place; `knee_deg`: (101,) by side, None where not reported."""
        self.stop()
        self.picture.legs, self.picture.thin = legs, thin or {}
        self.picture.sides = [side for side in Side if side in knee_deg]
        self.picture.knee_deg = {side: curve for side, curve in knee_deg.items() if curve is not None}
        self.note.setVisible(legs is None)
        self.picture.setVisible(legs is not None)
        notes = [tr(NO_LEGS)] if legs is None else [tr(DRAWN), *([tr(GHOST)] if thin else [])]
        self.setToolTip(" ".join(notes))
        self.show_percent(self.percent)

    def show_percent(self, percent: float) -> None:
        """Put the cursor to a place of the gait cycle."""
        self.percent = percent % 100.0 if percent != 100.0 else 100.0
        self._where.setText(tr("{percent:.0f} %").format(percent=self.percent))
        self._where.setMinimumWidth(
            self._where.fontMetrics().horizontalAdvance(tr("{percent:.0f} %").format(percent=100))
        )
        self.picture.percent = self.percent
        self.picture.update()
        reported = [self._where.text(), *self.picture.readings().values()] if self.picture.legs is not None else []
        self.setAccessibleDescription(", ".join(reported) or self.note.text())
        self.moved.emit(self.percent)

    def turn(self) -> None:
        """Play, or stop."""
        if self.is_playing:
            self.stop()
        elif self.picture.legs is not None:
            self._timer.start()

    def stop(self) -> None:
        self._timer.stop()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        steps = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}
        if event.key() in steps:
            is_long = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
            self.show_percent(self.percent + steps[Qt.Key(event.key())] * (LONG_STEP if is_long else STEP))
        elif event.key() == Qt.Key.Key_Space:
            self.turn()
        else:
            super().keyPressEvent(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() is Qt.MouseButton.LeftButton:
            self.turn()
        super().mousePressEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:
        self.stop()
        super().hideEvent(event)

    def _on_beat(self) -> None:
        self.show_percent(self.percent + 100.0 * FRAME_MS / 1000.0 / PLAYED_CYCLE_S)


class _Picture(Painted):
    """Left filled, right outlined and dashed on top; the thin line's shank and foot in a line alone."""

    def __init__(self) -> None:
        super().__init__()
        self.legs: MeanLegs | None = None
        self.knee_deg: Mapping[Side, FloatArray] = {}
        self.thin: Mapping[Side, ThinBend] = {}
        self.sides: Sequence[Side] = ()
        self.percent = 0.0
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def minimumSizeHint(self) -> QSize:
        words = QFontMetrics(current_theme().font(SMALL)).horizontalAdvance(tr("not reported"))
        return QSize(max(px(LEAST_PICTURE[0]), px(CHIP + CHIP_GAP) + words + 1), px(LEAST_PICTURE[1]))

    def readings(self) -> dict[Side, str]:
        """Each knee's angle at the cursor."""
        found = {}
        for side in Side:
            curve = self.knee_deg.get(side)
            if curve is None or not np.isfinite(curve).all():
                continue
            angle = float(np.interp(self.percent, np.arange(len(curve)), curve))
            found[side] = tr("knee {angle:.0f}°").format(angle=angle).replace("-", MINUS)
        return found

    def draw(self, painter: QPainter) -> None:
        if self.legs is None:
            return
        rows = px(ROW) * len(self.sides)
        self._paint_legs(painter, self.legs, QRectF(0, 0, self.width(), self.height() - rows))
        for number, side in enumerate(self.sides):
            top = self.height() - rows + number * px(ROW) + px((ROW - CHIP) / 2)
            paint_chip(painter, QRectF(0, top, px(CHIP), px(CHIP)), side, current_theme())

    def painted_texts(self) -> list[PaintedText]:
        """What is beneath the legs: each measured knee at the cursor."""
        if self.legs is None:
            return []
        px, readings = current_theme().px, self.readings()
        left, first = px(CHIP) + px(CHIP_GAP), self.height() - px(ROW) * len(self.sides)
        found = []
        for number, side in enumerate(self.sides):
            words = readings.get(side, tr("not reported"))
            font = current_theme().font(13, MEDIUM) if side in readings else current_theme().font(SMALL)
            box = QRectF(left, first + number * px(ROW), self.width() - left, px(ROW))
            found.append(PaintedText(words, box, font, "ink" if side in readings else "ink2", LEFT))
        return found

    def _paint_legs(self, painter: QPainter, legs: MeanLegs, room: QRectF) -> None:
        theme = current_theme()
        poses = {side: legs.pose_m(side, self.percent) for side in legs.points_m}
        points = np.concatenate([points_m.reshape(-1, 2) for points_m in legs.points_m.values()])
        above = 0.0 if legs.tilt_rad is None else PELVIS_M + PELVIS_HALF_M
        low, high = float(np.nanmin(points[:, 1])), max(float(np.nanmax(points[:, 1])), above)
        behind, ahead = float(np.nanmin(points[:, 0])), float(np.nanmax(points[:, 0]))
        margin = px(4)
        scale = min((room.height() - 4 * margin) / (high - low), (room.width() - 2 * margin) / (ahead - behind))
        spare = room.height() - 4 * margin - scale * (high - low)
        floor = room.bottom() - px(6) - spare / 2
        hip_x = room.center().x() - scale * (ahead + behind) / 2

        def at(point: FloatArray) -> QPointF:
            return QPointF(hip_x + scale * float(point[0]), floor - scale * (float(point[1]) - low))

        painter.setPen(theme.pen(theme.colours.control, 1))
        painter.drawLine(QPointF(room.left(), floor), QPointF(room.right(), floor))
        if (tilt_rad := legs.pelvis_tilt_rad(self.percent)) is not None:
            self._paint_pelvis(painter, at(np.zeros(2)), tilt_rad, scale)
        for side in Side:
            if side in poses:
                self._paint_thin(painter, side, poses[side], at)
                self._paint_leg(painter, side, [at(point) for point in poses[side]], scale)

    def _paint_thin(
        self, painter: QPainter, side: Side, pose_m: FloatArray, at: Callable[[FloatArray], QPointF]
    ) -> None:
        """Shank and foot as they were bent then, on the same thigh."""
        if side not in self.thin:
            return
        bend = self.thin[side]
        knee, ankle = (
            float(np.interp(self.percent, np.arange(len(one)), one)) for one in (bend.knee_deg, bend.ankle_deg)
        )
        then = bent_by(pose_m, knee, 0.0 if math.isnan(ankle) else ankle)
        painter.setPen(current_theme().pen(current_theme().text(side), 1.25))
        ends = [at(point) for point in (then[:3] if math.isnan(ankle) else then) if np.isfinite(point).all()]
        for first, last in pairwise(ends):
            painter.drawLine(first, last)

    def _paint_pelvis(self, painter: QPainter, hip: QPointF, tilt_rad: float, scale: float) -> None:
        """From the hips up, leaning as it is tilted from standing; behind the legs, for it is no leg's."""
        theme = current_theme()
        up = scale * PELVIS_M
        top = QPointF(hip.x() + up * math.sin(tilt_rad), hip.y() - up * math.cos(tilt_rad))
        painter.setPen(theme.pen(theme.colours.control, 2))
        painter.setBrush(QColor(theme.colours.track))
        painter.drawPolygon(limb_outline(hip, top, scale * PELVIS_HALF_M, scale * PELVIS_HALF_M))

    def _paint_leg(self, painter: QPainter, side: Side, points: list[QPointF], scale: float) -> None:
        theme = current_theme()
        painter.setPen(theme.side_pen(side, 1.5))
        painter.setBrush(theme.pale(side) if side is Side.LEFT else Qt.BrushStyle.NoBrush)
        for k, (first, last) in enumerate(HALF_WIDTHS_M):
            if all(math.isfinite(one.x()) for one in points[k : k + 2]):
                painter.drawPolygon(limb_outline(points[k], points[k + 1], scale * first, scale * last))
        painter.setBrush(QColor(theme.colours.surface))
        for joint in points[1:3]:
            if math.isfinite(joint.x()):
                painter.drawEllipse(joint, theme.px(3), theme.px(3))

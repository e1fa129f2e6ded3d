"""The legs over a mean stride, from the side, in step with the cursor in the curves."""

import math

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QAccessible, QColor, QHideEvent, QKeyEvent, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy

from app.summary.drawn_legs import HALF_WIDTHS_M
from app.summary.mean_legs import MeanLegs
from app.theme.icons import Icon
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.notifier import ThemeNotifier
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.limb import limb_outline
from app.widgets.segmented import Segmented
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.widgets.themed import Themed
from app.wording.body import side_name
from app.wording.translation import later, tr
from core.body import Side

LEAST_SIZE = (300, 136)
BESIDE_FROM = 2.4  # times as wide as high: legs and lanes stand side by side
FRAME_MS = 33
STEP, LONG_STEP = 1.0, 10.0  # percent
SPEEDS = (
    ("quarter", "\N{VULGAR FRACTION ONE QUARTER}", 0.25),
    ("half", "\N{VULGAR FRACTION ONE HALF}", 0.5),
    ("one", "1\u00a0\N{MULTIPLICATION SIGN}", 1.0),
)
PELVIS_M, PELVIS_HALF_M = 0.14, 0.08  # as large as it looks right
LANE, LANE_GAP, LANES_HEIGHT = 18, 8, 84
NO_LEGS = later("To draw legs, data of a thigh sensor and an absolute knee angle are needed.")
APART = later("Left and right sensors are not synchronised: legs are drawn half a gait cycle apart.")
DRAWN = later("The legs are drawn from joint angles and thigh inclination. Their position is not measured.")
DRAWN_WITH_PELVIS = later(
    "The legs are drawn from joint angles and the inclination of thighs and pelvis. Their position is not measured."
)


class MovingLegs(Card):
    """`moved` gives where in the reference leg's stride the cursor is, percent, whoever moved it."""

    accessible_role = QAccessible.Role.Chart

    moved = Signal(float)

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__(look, padding=16)
        self._legs: MeanLegs | None = None
        self._is_brief = False
        self.percent = 0.0
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        head = QHBoxLayout()
        head.setSpacing(8)
        head.addWidget(Text(look, tr("Legs"), size=16, weight=SEMIBOLD))
        head.addWidget(Text(look, tr("side view"), size=12, tone="ink2"))
        self.picture = _LegsPicture(look)
        self.picture.pointed.connect(self.show_percent)
        self.play = Button(look, "", ButtonKind.SECONDARY, Icon.PLAY, height=40)
        self.speed = Segmented(look, tr("Speed"), [(key, word, "") for key, word, _ in SPEEDS])
        self.where = Text(look, weight=SEMIBOLD)
        self.where.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.note = Text(look, size=12, tone="ink2", wraps=True)
        foot = QHBoxLayout()
        foot.setSpacing(12)
        foot.addWidget(self.play)
        foot.addWidget(self.speed)
        foot.addStretch(1)
        head.addWidget(self.where, 1, Qt.AlignmentFlag.AlignRight)  # in the foot it would make the card too wide
        self.column.addLayout(head)
        self.column.addWidget(self.picture, 1)
        self.column.addLayout(foot)
        self.column.addWidget(self.note)
        self._timer = QTimer(self)
        self._timer.setInterval(FRAME_MS)
        self._timer.timeout.connect(self._on_beat)
        self.play.clicked.connect(self.turn)
        self._show_message()

    @property
    def is_playing(self) -> bool:
        return self._timer.isActive()

    @property
    def places(self) -> dict[Side, float]:
        """Where each leg is on its own stride, percent."""
        legs = self._legs
        return {side: legs.percent_of(side, self.percent) for side in legs.legs} if legs is not None else {}

    def set_brief(self, is_brief: bool) -> None:
        """Leave out the note, where there is little room."""
        self._is_brief = is_brief
        self.note.setVisible(not is_brief or self._legs is None)

    def show_legs(self, legs: MeanLegs | None) -> None:
        """Show the legs of another walk, where the cursor was."""
        self._legs = legs
        self.stop()
        has_pelvis = legs is not None and legs.tilt_rad is not None
        notes = [tr(NO_LEGS) if legs is None else tr(DRAWN_WITH_PELVIS) if has_pelvis else tr(DRAWN)]
        if legs is not None and len(legs.legs) == len(Side) and not legs.is_together:
            notes.append(tr(APART))
        self.note.setText(" ".join(notes))
        for part in (self.play, self.speed, self.where):
            part.setVisible(legs is not None)
        self.set_brief(self._is_brief)
        self.show_percent(self.percent)

    def show_percent(self, percent: float) -> None:
        """Put the cursor to a place of the reference leg's stride."""
        self.percent = percent % 100.0
        self.picture.show_legs(self._legs, self.percent)
        if self._legs is not None:
            stated = tr("{percent:.0f} % of the {side} gait cycle")
            side = side_name(self._legs.reference)
            self.where.setText(stated.format(percent=self.percent, side=side))
            widest = self.where.fontMetrics().horizontalAdvance(stated.format(percent=100.0, side=side))
            self.where.setMinimumWidth(widest)  # else the card would grow while it plays
        self.setAccessibleName(tr("Legs"))
        self.setAccessibleDescription(self.where.text() if self._legs is not None else self.note.text())
        self.moved.emit(self.percent)

    def turn(self) -> None:
        """Play, or stop."""
        if self.is_playing:
            self.stop()
        elif self._legs is not None:
            self._timer.start()
            self._show_message()

    def stop(self) -> None:
        self._timer.stop()
        self._show_message()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        steps = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}
        if event.key() in steps:
            is_long = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
            self.show_percent(self.percent + steps[Qt.Key(event.key())] * (LONG_STEP if is_long else STEP))
        elif event.key() == Qt.Key.Key_Space:
            self.turn()
        else:
            super().keyPressEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:
        self.stop()
        super().hideEvent(event)

    def _on_beat(self) -> None:
        assert self._legs is not None
        factor = next(value for key, _, value in SPEEDS if key == self.speed.choice)
        stride_s = self._legs.legs[self._legs.reference].stride_s
        self.show_percent(self.percent + 100.0 * FRAME_MS / 1000.0 * factor / stride_s)

    def _show_message(self) -> None:
        self.play.setText(tr("Stop") if self.is_playing else tr("Play"))
        self.play.setAccessibleName(self.play.text())
        self.play.set_face(icon=Icon.STOP if self.is_playing else Icon.PLAY)


class _LegsPicture(Themed):
    """The legs over the floor, and below them when each foot is on the floor in one stride of the reference leg."""

    pointed = Signal(float)

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self._legs: MeanLegs | None = None
        self._percent = 0.0
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def show_legs(self, legs: MeanLegs | None, percent: float) -> None:
        self._legs, self._percent = legs, percent
        self.update()

    def sizeHint(self) -> QSize:
        px = self._look.theme.px
        return QSize(px(LEAST_SIZE[0]), px(LEAST_SIZE[1]))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._point(event.position())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        self._point(event.position())

    def _point(self, at: QPointF) -> None:
        lanes = self._lanes()
        if self._legs is not None and at.y() >= lanes.top() and lanes.left() <= at.x() <= lanes.right():
            self.pointed.emit(min(100 * (at.x() - lanes.left()) / lanes.width(), 99.99))

    def paintEvent(self, _event: QPaintEvent) -> None:
        if self._legs is None:
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_legs(painter, self._legs)
        self._paint_lanes(painter, self._legs)

    def _paint_legs(self, painter: QPainter, legs: MeanLegs) -> None:
        """Right nearer than left, as the patient walks to the right; the standing foot is on the floor."""
        theme, px = self._look.theme, self._look.theme.px
        poses = {side: legs.pose_m(side, legs.percent_of(side, self._percent)) for side in legs.legs}
        below = px(6) if self._is_wide else px(LANES_HEIGHT + 12)
        width = self._lanes().left() - px(CHIP + 24) if self._is_wide else self.width()
        room = QRectF(0, px(8), width, self.height() - px(8) - below)
        reach = max(float(-np.nanmin(leg.points_m[..., 1])) for leg in legs.legs.values())
        tilt_rad = legs.pelvis_tilt_rad(self._percent)
        above = 0.0 if tilt_rad is None else PELVIS_M + PELVIS_HALF_M
        scale = (room.height() - px(10)) / (1.08 * reach + above)
        standing = [side for side in poses if legs.is_standing(side, self._percent)] or list(poses)
        lowest = min(float(np.nanmin(poses[side][:, 1])) for side in standing)
        floor = room.bottom() - px(10)  # a swinging foot, drawn from its angle, may reach a little below it

        def at(point: np.ndarray) -> QPointF:
            return QPointF(room.center().x() + scale * float(point[0]), floor - scale * (float(point[1]) - lowest))

        painter.setPen(theme.pen(theme.colours.control, 1))
        painter.drawLine(QPointF(room.left(), floor), QPointF(room.right(), floor))
        if tilt_rad is not None:
            self._paint_pelvis(painter, at(np.zeros(2)), tilt_rad, scale)
        for side in (Side.LEFT, Side.RIGHT):
            if side in poses:
                self._paint_leg(painter, side, [at(point) for point in poses[side]], scale)

    def _paint_pelvis(self, painter: QPainter, hip: QPointF, tilt_rad: float, scale: float) -> None:
        """From the hips up, leaning as it is tilted from standing; behind the legs, for it is no leg's."""
        theme = self._look.theme
        up = scale * PELVIS_M
        top = QPointF(hip.x() + up * math.sin(tilt_rad), hip.y() - up * math.cos(tilt_rad))
        painter.setPen(theme.pen(theme.colours.control, 2))
        painter.setBrush(QColor(theme.colours.track))
        painter.drawPolygon(limb_outline(hip, top, scale * PELVIS_HALF_M, scale * PELVIS_HALF_M))

    def _paint_leg(self, painter: QPainter, side: Side, points: list[QPointF], scale: float) -> None:
        theme = self._look.theme
        painter.setPen(theme.side_pen(side, 2))
        painter.setBrush(theme.pale(side))
        for k, (first, last) in enumerate(HALF_WIDTHS_M):
            if all(math.isfinite(one.x()) for one in points[k : k + 2]):
                painter.drawPolygon(limb_outline(points[k], points[k + 1], scale * first, scale * last))
        painter.setBrush(QColor(theme.colours.surface))
        for joint in points[:3]:
            if math.isfinite(joint.x()):
                painter.drawEllipse(joint, theme.px(5), theme.px(5))
        ends = [point for point in points if math.isfinite(point.x())]
        painter.setFont(theme.font(14, SEMIBOLD))
        painter.setPen(theme.text(side))
        painter.drawText(ends[-1] + QPointF(theme.px(8), -theme.px(2)), side.letter)

    def _paint_lanes(self, painter: QPainter, legs: MeanLegs) -> None:
        """Each foot's stance within one stride of the reference leg, and the cursor."""
        theme, px, lanes = self._look.theme, self._look.theme.px, self._lanes()
        reference = legs.legs[legs.reference]
        for number, side in enumerate(side for side in Side if side in legs.legs):
            top = lanes.top() + number * px(LANE + LANE_GAP)
            chip = px(CHIP)
            box = QRectF(lanes.left() - px(12) - chip, top + (px(LANE) - chip) / 2, chip, chip)
            paint_chip(painter, box, side, theme)
            leg = legs.legs[side]
            ratio = leg.stride_s / reference.stride_s
            begins = 0.0 if side is legs.reference else legs.other_contact_percent
            painter.setPen(theme.side_pen(side, 1.5))
            painter.drawLine(QPointF(lanes.left(), top + px(LANE)), QPointF(lanes.right(), top + px(LANE)))
            if math.isfinite(leg.toe_off_percent):
                length = leg.toe_off_percent * ratio
                for begin in (begins - 100.0 * ratio, begins):
                    low, high = max(begin, 0.0), min(begin + length, 100.0)
                    if high > low:
                        left = lanes.left() + lanes.width() * low / 100
                        stance = QRectF(left, top, lanes.width() * (high - low) / 100, px(LANE))
                        painter.setBrush(theme.soft(side))  # too faint on its ground without the edge
                        painter.drawRect(stance)
        painter.setFont(theme.font(12, MEDIUM))
        painter.setPen(QColor(theme.colours.ink2))
        words = QRectF(lanes.left(), lanes.bottom() - px(20), lanes.width(), px(20))
        stated = tr("one {side} stride, {time:.2f} s").format(side=side_name(legs.reference), time=reference.stride_s)
        painter.drawText(words, Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignVCenter, stated)
        painter.drawText(words, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, "0")
        painter.drawText(words, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, "100\u00a0%")
        x = lanes.left() + lanes.width() * self._percent / 100
        painter.setPen(theme.pen(theme.colours.ink, 2))
        painter.drawLine(QPointF(x, lanes.top() - px(6)), QPointF(x, lanes.bottom() - px(22)))

    @property
    def _is_wide(self) -> bool:
        return self.width() > BESIDE_FROM * self.height()

    def _lanes(self) -> QRectF:
        px = self._look.theme.px
        left = px(CHIP) + px(12) + (round(0.4 * self.width()) if self._is_wide else 0)
        return QRectF(left, self.height() - px(LANES_HEIGHT) + px(8), self.width() - left, px(LANES_HEIGHT) - px(8))

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.update()

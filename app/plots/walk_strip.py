"""A walk as a whole in one strip: both feet on the floor, excluded strides hatched, and the part that is in sight."""

from collections.abc import Mapping

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QAccessible, QColor, QMouseEvent, QPainter, QPixmap
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QVBoxLayout

from app.plots.phase_lanes import LEAST_PHASE_PX, Lane, paint_phase
from app.theme.current import current_theme, px
from app.theme.leg_chip import CHIP, paint_chip
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.painted_text import CENTRE, PaintedText
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import figure_text, tr, tr_n
from core.body import Side
from core.gait.phases import PHASES, Phase
from core.results import RecordingAnalysis, SideGait
from core.samples import FloatArray

LANE, BETWEEN, TIMES = 16, 6, 16  # px high
LEFT, RIGHT = CHIP + 12, 12
HATCH = 5
TICKS_S = (1, 2, 5, 10, 20, 30, 60, 120, 300, 600)
TICK_APART = 64  # px


class WalkStrip(Card):
    """`pointed` gives the time under the mouse, pressed or drawn along."""

    def __init__(self) -> None:
        super().__init__(padding=12)
        self.lanes = StripLanes()
        self.pointed = self.lanes.pointed
        self._length = Text(size=12, tone="ink2")
        self._words = lay_out(
            QVBoxLayout(), 1, Text(tr("Whole walk"), size=13, weight=SEMIBOLD), self._length, 1, spacing=0
        )
        lay_out(self.column, lay_out(QHBoxLayout(), self._words, (self.lanes, 1), spacing=12))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def show_walk(self, recording: RecordingAnalysis) -> None:
        self.lanes.show_walk(recording)
        length = float(np.ptp(recording.time_s)) if len(recording.time_s) else 0.0
        self._length.setText(tr("{length} s").format(length=figure_text(length, ".1f")))


class StripLanes(Painted):
    """Left above right. It takes no focus: arrows move the cursor wherever it is shown."""

    accessible_role = QAccessible.Role.Chart

    pointed = Signal(float)

    def __init__(self) -> None:
        super().__init__()
        self._lanes: Mapping[Side, Lane] = {}
        self.excluded_s: Mapping[Side, FloatArray] = {}
        self._used_s: Mapping[Side, FloatArray] = {}
        self._whole_s = (0.0, 1.0)
        self._kept: tuple[object, QPixmap] | None = None
        self.window_s: tuple[float, float] | None = None
        self.cursor_s: float | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(tr("Gait phases of the whole walk"))

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()

    def minimumSizeHint(self) -> QSize:
        lanes = max(len(self._lanes), 1)
        return QSize(px(200), lanes * px(LANE) + (lanes - 1) * px(BETWEEN) + px(TIMES) + 2)

    def show_walk(self, recording: RecordingAnalysis) -> None:
        time_s = recording.time_s
        sides = [side for side in Side if side in recording.gait]
        self._kept = None
        self._lanes = {side: Lane.of(time_s, recording.gait[side]) for side in sides}
        self.excluded_s = {side: _spans(recording.gait[side], is_used=False) for side in sides}
        self._used_s = {side: _spans(recording.gait[side], is_used=True) for side in sides}
        self._whole_s = (float(time_s[0]), float(time_s[-1])) if len(time_s) > 1 else (0.0, 1.0)
        self.window_s = self.cursor_s = None
        counts = (sum(map(len, spans.values())) for spans in (self._used_s, self.excluded_s))
        used, excluded = (int(count) for count in counts)
        stated = [
            tr_n("{count} stride used", "{count} strides used", used).format(count=used),
            tr_n("{count} excluded", "{count} excluded", excluded).format(count=excluded),
        ]
        self.setAccessibleDescription(", ".join(stated))
        self.updateGeometry()
        self.update()

    def show_cursor(self, cursor_s: float | None, window_s: tuple[float, float] | None) -> None:
        if (cursor_s, window_s) != (self.cursor_s, self.window_s):
            self.cursor_s, self.window_s = cursor_s, window_s
            self.update()

    def x_of(self, time_s: float) -> float:
        first, last = self._whole_s
        return px(LEFT) + (self.width() - px(LEFT) - px(RIGHT)) * (time_s - first) / (last - first)

    def time_of(self, x: float) -> float:
        """The time at a place, the nearest one beside the strip."""
        first, last = self._whole_s
        share = (x - px(LEFT)) / max(self.width() - px(LEFT) - px(RIGHT), 1)
        return first + (last - first) * min(max(share, 0.0), 1.0)

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        painter.drawPixmap(0, 0, self._painted_lanes())
        bottom = self._lanes_bottom
        if self.window_s is not None:
            left, right = (self.x_of(time_s) for time_s in self.window_s)
            theme.paint_box(painter, QRectF(left, 0.5, right - left, bottom), None, theme.colours.ink, 1.75, 4)
        if self.cursor_s is not None:
            painter.setPen(theme.pen(theme.colours.ink, 1.5))
            x = self.x_of(self.cursor_s)
            painter.drawLine(QPointF(x, 0), QPointF(x, bottom))

    def painted_texts(self) -> list[PaintedText]:
        first, last = self._whole_s
        most = max((self.width() - px(LEFT) - px(RIGHT)) / px(TICK_APART), 1)
        step = next((one for one in TICKS_S if (last - first) / one <= most), TICKS_S[-1])
        found = []
        for time_s in np.arange(np.ceil(first / step) * step, last, step):
            x, half = self.x_of(float(time_s)), px(TICK_APART) / 2
            box = QRectF(x - half, self._lanes_bottom, 2 * half, px(TIMES))
            if x - half >= px(LEFT) and x + half <= self.width():
                words = tr("{length} s").format(length=f"{time_s:.0f}")
                found.append(PaintedText(words, box, current_theme().font(12), "ink2", CENTRE))
        return found

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() is Qt.MouseButton.LeftButton:
            self.pointed.emit(self.time_of(event.position().x()))
        event.ignore()  # the page takes the focus

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if event.buttons() & Qt.MouseButton.LeftButton:
            self.pointed.emit(self.time_of(event.position().x()))

    @property
    def _lanes_bottom(self) -> float:
        return float(self.height() - px(TIMES) - 1)

    def _painted_lanes(self) -> QPixmap:
        """All but cursor and window, which move thirty times a second."""
        drawn_for = (self.size(), current_theme(), self.devicePixelRatioF())
        if self._kept is None or self._kept[0] != drawn_for:
            kept = QPixmap(self.size() * self.devicePixelRatioF())
            kept.setDevicePixelRatio(self.devicePixelRatioF())
            kept.fill(QColor(current_theme().colours.surface))
            painter = QPainter(kept)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            for number, (side, lane) in enumerate(self._lanes.items()):
                top, chip = 1 + number * (px(LANE) + px(BETWEEN)), px(LANE)
                paint_chip(painter, QRectF(0, top, chip, chip), side, current_theme())
                area = QRectF(px(LEFT), top, self.width() - px(LEFT) - px(RIGHT), px(LANE))
                self._paint_lane(painter, side, lane, area)
            painter.end()
            self._kept = drawn_for, kept
        return self._kept[1]

    def _paint_lane(self, painter: QPainter, side: Side, lane: Lane, area: QRectF) -> None:
        theme = current_theme()
        full, pale = theme.curve(side), theme.soft(side)
        phases = [PHASES[k] for k in lane.run_phase]
        spans = [(self.x_of(a), self.x_of(b)) for a, b in zip(lane.start_s.tolist(), lane.end_s.tolist(), strict=True)]
        known = [span for span, phase in zip(spans, phases, strict=True) if phase is not Phase.UNKNOWN]
        if known and float(np.mean([b - a for a, b in known])) >= LEAST_PHASE_PX * theme.scale:
            for phase, (left, right) in zip(phases, spans, strict=True):
                shown = Phase.FOOT_FLAT if phase is Phase.PRE_SWING else phase  # too low for its hatching
                box = QRectF(left + 0.5, area.top(), max(right - left - 1, 1.0), area.height())
                paint_phase(painter, shown, box, full, pale, theme)
        else:  # nobody can distinguish its phases
            for left_s, right_s in self._used_s[side].tolist():
                box = QRectF(self.x_of(left_s), area.top(), self.x_of(right_s) - self.x_of(left_s), area.height())
                painter.fillRect(box, pale)
        for left_s, right_s in self.excluded_s[side].tolist():
            left, right = self.x_of(left_s), self.x_of(right_s)
            self._paint_excluded(painter, QRectF(left, area.top(), max(right - left, 1.0), area.height()))

    def _paint_excluded(self, painter: QPainter, box: QRectF) -> None:
        theme = current_theme()
        painter.save()
        painter.fillRect(box, QColor(theme.colours.surface))
        painter.setClipRect(box, Qt.ClipOperation.IntersectClip)
        painter.setPen(theme.pen(theme.colours.control, 1))
        step = px(HATCH)
        # hatched by the place on the strip, so that adjacent strides are one
        first = int(box.left() / step) - 1
        for k in range(first, int((box.right() + box.height()) / step) + 2):
            painter.drawLine(QPointF(k * step, box.top()), QPointF(k * step - box.height(), box.bottom()))
        painter.restore()


def _spans(gait: SideGait, *, is_used: bool) -> FloatArray:
    """Start and end of the strides that are used, or of those that are not, (k, 2)."""
    strides = gait.strides
    chosen = strides.is_used if is_used else ~strides.is_used
    return np.stack([strides.start_s[chosen], strides.end_s[chosen]], axis=1)

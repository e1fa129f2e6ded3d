"""Times at which each foot is on the floor. One lane per leg under the curves, on the same time.

Loading is full, foot flat pale, pre-swing hatched, swing empty on a base line: four looks that hold in grey. Where the
phase is not known nothing is drawn. Each border is an event; the reading line names it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QAccessible, QColor, QMouseEvent, QPainter, QWheelEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QSizePolicy

from app.charts.axes import AXIS_WIDTH, RIGHT_MARGIN
from app.charts.marks import stretches
from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.theme import Theme
from app.widgets.card import Card
from app.widgets.chip import Chip
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.translation import joined, later, tr, tr_n
from core.body import Side
from core.gait.phases import PHASES, Phase
from core.results import SideGait
from core.samples import FloatArray, IntArray

LANE, BETWEEN = 26, 8
GAP_PX = 1.5  # of surface between two phases
HATCH_PX = 4.5
LEAST_PHASE_PX = 5.0  # on the average in sight; narrower, nobody can distinguish them
ZOOM_IN = later("Zoom in to see the phases")
WHEEL_ZOOM = 1.02 ** (-1 / 8)  # per unit of the wheel, as the curves do

PHASE_WORDS = {
    Phase.UNKNOWN: later("not known"),
    Phase.LOADING: later("loading"),
    Phase.FOOT_FLAT: later("foot flat"),
    Phase.PRE_SWING: later("pre-swing"),
    Phase.SWING: later("swing"),
}
EVENT_WORDS = {"initial_contact": later("initial contact"), "toe_off": later("toe-off")}  # the borders of swing
LEGEND = (
    (Phase.LOADING, later("Loading")),
    (Phase.FOOT_FLAT, later("Foot flat")),
    (Phase.PRE_SWING, later("Pre-swing")),
    (Phase.SWING, later("Swing")),
)


@dataclass(frozen=True, slots=True)
class Lane:
    """The phases of one leg as runs (r,): where each begins and ends, and its index into PHASES; and its events."""

    phase: IntArray
    start_s: FloatArray
    end_s: FloatArray
    run_phase: IntArray
    event_rows: Mapping[int, str]

    @classmethod
    def of(cls, time_s: FloatArray, gait: SideGait) -> "Lane":
        """From the gait of one leg on the recording's clock (n,)."""
        if not len(time_s):
            return cls(gait.phase, np.zeros(0), np.zeros(0), np.zeros(0, dtype=np.int64), {})
        borders = np.flatnonzero(np.diff(gait.phase)) + 1
        first = np.concatenate([[0], borders]).astype(np.int64)
        end_s = np.concatenate([time_s[borders], time_s[-1:]])
        rows: dict[int, str] = {}
        for events in gait.events:
            for event in EVENT_WORDS:
                at = _nearest(time_s, getattr(events, f"{event}_s"))
                rows.update(dict.fromkeys(at.tolist(), event))
        return cls(gait.phase, time_s[first], end_s, gait.phase[first], rows)

    def in_words(self, row: int) -> str:
        """Name the event at a sample, or else its phase."""
        event = self.event_rows.get(row)
        return tr(EVENT_WORDS[event] if event is not None else PHASE_WORDS[PHASES[self.phase[row]]])


class PhaseFrame(Card):
    """Both lanes with their legend, and what is shown at the reading line."""

    def __init__(self) -> None:
        super().__init__(spacing=6)
        self.lanes = PhaseLanes()
        self.simulated = Text(tr("SIMULATED"), size=12, weight=SEMIBOLD)
        self._chips = {side: Chip(side) for side in Side}
        self.readings = {side: Text(size=14, weight=MEDIUM, tone=f"{side}_text") for side in Side}
        legend = (part for phase, word in LEGEND for part in (Swatch(phase), Text(tr(word), size=12, tone="ink2")))
        title = Text(tr("Gait phases"), size=14, weight=SEMIBOLD)
        self._title = lay_out(QHBoxLayout(), title, self.simulated, spacing=8)
        self._legend = lay_out(QHBoxLayout(), *legend, 1, spacing=8)
        self._reading = lay_out(QHBoxLayout(), 1, spacing=8)
        self._head = QGridLayout()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        for side in Side:
            policy = self._chips[side].sizePolicy()
            policy.setRetainSizeWhenHidden(True)  # nothing may jump when the line comes
            self._chips[side].setSizePolicy(policy)
            lay_out(self._reading, self._chips[side], self.readings[side])
        lay_out(self.column, self._head, self.lanes)
        scaled(self._head.setHorizontalSpacing, 12)
        scaled(self._head.setVerticalSpacing, 4)
        self.set_narrow(is_narrow=False)
        on_theme(self._reserve_room)

    def does_fit(self, width: int) -> bool:
        """Whether title, legend and reading have room beside each other in `width` px."""
        parts = (self._title, self._legend, self._reading)
        margins = self.column.contentsMargins()
        beside = 2 * self._head.horizontalSpacing() + margins.left() + margins.right()
        return sum(part.sizeHint().width() for part in parts) + beside <= width

    def set_narrow(self, is_narrow: bool) -> None:
        """Put the legend under title and reading where it does not fit between them."""
        for part in (self._title, self._legend, self._reading):
            self._head.removeItem(part)
        self._head.addLayout(self._title, 0, 0)
        self._head.addLayout(self._reading, 0, 2)
        if is_narrow:
            self._head.addLayout(self._legend, 1, 0, 1, 3)
        else:
            self._head.addLayout(self._legend, 0, 1)
        self._head.setColumnStretch(1, 1)
        hear_as_laid_out(self)

    def show_gait(self, time_s: FloatArray, gait: Mapping[Side, SideGait], is_simulated: bool) -> None:
        self.lanes.show_lanes({side: Lane.of(time_s, gait[side]) for side in Side if side in gait})
        self.simulated.setVisible(is_simulated)
        for side in Side:
            self._chips[side].hide()
            self.readings[side].setVisible(side in gait)
        self.lanes.setAccessibleName(tr("Gait phases during the recording"))
        self.lanes.setAccessibleDescription(self.in_words())
        self.setVisible(bool(gait))
        self._reserve_room()

    def read(self, row: int | None, time_s: float | None) -> None:
        """Name what each foot does at sample `row`."""
        for side, lane in self.lanes.lanes.items():
            self.readings[side].setText("" if row is None else lane.in_words(row))
            self._chips[side].setVisible(row is not None)
        self._reserve_room()
        self.lanes.set_cursor(time_s)

    def reading_in_words(self) -> str:
        return " ".join(f"{_foot_name(side)}: {self.readings[side].text()}." for side in self.lanes.lanes)

    def in_words(self) -> str:
        """Say how often each foot landed and left, for who cannot see the lanes."""
        stated = []
        for side, lane in self.lanes.lanes.items():
            events = list(lane.event_rows.values())
            known = lane.run_phase != PHASES.index(Phase.UNKNOWN)
            part = _foot_name(side)
            if known.any():
                first, last = lane.start_s[known][0], lane.end_s[known][-1]
                contacts, toe_offs = (events.count(event) for event in EVENT_WORDS)
                counts = [
                    tr_n("{count} initial contact", "{count} initial contacts", contacts).format(count=contacts),
                    tr_n("{count} toe-off", "{count} toe-offs", toe_offs).format(count=toe_offs),
                ]
                reported = tr("{part}: {events}, phases from {first:.1f} to {last:.1f} s.")
                stated.append(reported.format(part=part, events=joined(counts), first=first, last=last))
            else:
                stated.append(tr("{part}: phases not known.").format(part=part))
        return " ".join(stated)

    def _reserve_room(self) -> None:
        for side, label in self.readings.items():
            widest = max(
                label.fontMetrics().horizontalAdvance(tr(word))
                for word in (*PHASE_WORDS.values(), *EVENT_WORDS.values())
            )
            label.setMinimumWidth(widest if side in self.lanes.lanes else 0)


class PhaseLanes(Painted):
    """Left above right, as wide as the curves above it. The mouse acts as on the curves."""

    accessible_role = QAccessible.Role.Chart

    pointed = Signal(float)  # at a time
    zoomed = Signal(float)  # share of the time in sight to keep
    dragged = Signal(float)  # share of the time in sight to go on by

    def __init__(self) -> None:
        super().__init__()
        self.lanes: Mapping[Side, Lane] = {}
        self._visible_s = (0.0, 1.0)
        self.cursor_s: float | None = None
        self._held_x: float | None = None
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def show_lanes(self, lanes: Mapping[Side, Lane]) -> None:
        self.lanes = lanes
        self.updateGeometry()
        self.update()

    def see(self, first_s: float, last_s: float) -> None:
        self._visible_s = (first_s, last_s)
        self.update()

    def set_cursor(self, time_s: float | None) -> None:
        self.cursor_s = time_s
        self.update()

    def minimumSizeHint(self) -> QSize:
        px, count = current_theme().px, max(len(self.lanes), 1)
        return QSize(px(320), count * px(LANE) + (count - 1) * px(BETWEEN))

    def area(self, side: Side) -> QRectF:
        """The lane of a leg in px of the widget."""
        top = list(self.lanes).index(side) * (px(LANE) + px(BETWEEN))
        return QRectF(px(AXIS_WIDTH), top, self.width() - px(AXIS_WIDTH) - px(RIGHT_MARGIN), px(LANE))

    def x_of(self, time_s: FloatArray) -> FloatArray:
        first, last = self._visible_s
        width = self.width() - px(AXIS_WIDTH) - px(RIGHT_MARGIN)
        return px(AXIS_WIDTH) + width * (time_s - first) / (last - first)

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        for side, lane in self.lanes.items():
            area, chip = self.area(side), theme.px(CHIP)
            paint_chip(painter, QRectF(0, area.center().y() - chip / 2, chip, chip), side, theme)
            painter.save()
            painter.setClipRect(area.adjusted(-0.5, 0, 0.5, 0))
            self._paint_lane(painter, lane, area, theme.curve(side), theme.soft(side))
            painter.restore()
        if self.cursor_s is not None and self._visible_s[0] <= self.cursor_s <= self._visible_s[1]:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
            painter.setPen(QColor(theme.colours.ink))
            x = float(self.x_of(np.array(self.cursor_s)))
            painter.drawLine(QPointF(x, 0), QPointF(x, self.height()))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._held_x = event.position().x() if event.button() is Qt.MouseButton.LeftButton else None

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:
        self._held_x = None

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        x, px = event.position().x(), current_theme().px
        width = self.width() - px(AXIS_WIDTH) - px(RIGHT_MARGIN)
        if self._held_x is not None:
            self.dragged.emit((self._held_x - x) / width)
            self._held_x = x
        share = (x - px(AXIS_WIDTH)) / width
        if 0 <= share <= 1:
            self.pointed.emit(self._visible_s[0] + share * (self._visible_s[1] - self._visible_s[0]))

    def wheelEvent(self, event: QWheelEvent) -> None:
        self.zoomed.emit(WHEEL_ZOOM ** event.angleDelta().y())
        event.accept()

    def _paint_lane(self, painter: QPainter, lane: Lane, area: QRectF, full: QColor, pale: QColor) -> None:
        first, last = self._visible_s
        shown = slice(int(np.searchsorted(lane.end_s, first)), int(np.searchsorted(lane.start_s, last)))
        left, right = self.x_of(lane.start_s[shown]), self.x_of(lane.end_s[shown])
        phases = [PHASES[k] for k in lane.run_phase[shown]]
        known = [phase is not Phase.UNKNOWN for phase in phases]
        if any(known) and float(np.mean((right - left)[known])) < LEAST_PHASE_PX * current_theme().scale:
            self._paint_too_narrow(painter, left, right, known, area)
            return
        gap = GAP_PX * current_theme().scale / 2
        for phase, x0, x1 in zip(phases, left.tolist(), right.tolist(), strict=True):
            box = QRectF(x0 + gap, area.top(), max(x1 - x0 - 2 * gap, 1.0), area.height())
            paint_phase(painter, phase, box, full, pale, current_theme())

    def _paint_too_narrow(
        self, painter: QPainter, left: FloatArray, right: FloatArray, known: list[bool], area: QRectF
    ) -> None:
        """Where the phases are known, in one piece each, with what to do."""
        theme = current_theme()
        painter.setFont(theme.font(12))
        for start, last in stretches(known):
            box = QRectF(left[start], area.top(), right[last] - left[start], area.height())
            painter.fillRect(box, QColor(theme.colours.sunken))
            seen = box.intersected(area)
            painter.setPen(QColor(theme.colours.ink2))
            if painter.fontMetrics().horizontalAdvance(tr(ZOOM_IN)) + theme.px(16) < seen.width():
                painter.drawText(seen, Qt.AlignmentFlag.AlignCenter, tr(ZOOM_IN))


class Swatch(Painted):
    """How one phase looks, in grey."""

    def __init__(self, phase: Phase) -> None:
        super().__init__()
        self._phase = phase
        scaled(self.setFixedSize, 22, 12)

    def draw(self, painter: QPainter) -> None:
        c = current_theme().colours
        paint_phase(painter, self._phase, QRectF(self.rect()), QColor(c.ink2), QColor(c.band_1sd), current_theme())


def paint_phase(painter: QPainter, phase: Phase, box: QRectF, full: QColor, pale: QColor, theme: Theme) -> None:
    match phase:
        case Phase.LOADING:
            painter.fillRect(box, full)
        case Phase.FOOT_FLAT:
            painter.fillRect(box, pale)
        case Phase.PRE_SWING:
            painter.save()
            painter.setClipRect(box, Qt.ClipOperation.IntersectClip)
            painter.setPen(theme.pen(full, 1.25))
            step = HATCH_PX * theme.scale
            for k in range(int((box.width() + box.height()) / step) + 1):
                foot = box.left() + k * step
                painter.drawLine(QPointF(foot, box.top()), QPointF(foot - box.height(), box.bottom()))
            painter.restore()
        case Phase.SWING:
            height = 1.5 * theme.scale
            painter.fillRect(QRectF(box.left(), box.bottom() - height, box.width(), height), full)


def _foot_name(side: Side) -> str:
    return tr("Left foot") if side is Side.LEFT else tr("Right foot")


def _nearest(time_s: FloatArray, at_s: FloatArray) -> IntArray:
    """Index of the sample nearest to each instant."""
    after = np.clip(np.searchsorted(time_s, at_s), 1, max(len(time_s) - 1, 1))
    is_before = at_s - time_s[after - 1] < time_s[np.minimum(after, len(time_s) - 1)] - at_s
    return np.asarray(after - is_before, dtype=np.int64)

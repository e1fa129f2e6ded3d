"""A patient's course: lanes over the dates of the visits, with what has changed beside them."""

from collections.abc import Sequence

from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QKeyEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.plots.lane_plot import DateAxis, DatedPlot, LanePlot
from app.summary.course_lanes import CourseLane, CourseVisit, LaneChange, LaneKind, lane_kinds
from app.summary.course_words import (
    change_in_words,
    day_of,
    key_in_words,
    lane_in_words,
    lane_name,
    last_in_words,
    nothing_between,
    unit_beside,
    visit_in_words,
)
from app.summary.progress_words import arrow_of
from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.change_arrow import ChangeArrow
from app.widgets.chip import Chip
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, REGULAR, SEMIBOLD, Text
from app.wording.translation import tr
from core.verdicts.model import Verdict

LABELS, CHANGES = 166, 196  # px: the columns of words beside the lanes
NARROW_BELOW = 560  # words stand over the lanes instead
ROW = 60
VALUE, VALUE_OF_TWO = 28, 22
WIDEST = 16_777_215  # Qt's own


class CourseCard(Card):
    """Passive. The arrow keys and the mouse go from visit to visit, Enter and a click open one."""

    accessible_role = QAccessible.Role.Chart

    visit_opened = Signal(object)  # the id of its session
    computing_requested = Signal()  # the visits that have no figures yet are to be evaluated

    def __init__(self) -> None:
        super().__init__(spacing=0.5)  # a pixel, at any size
        self._grid = QGridLayout()
        self.rows: dict[LaneKind, LaneRow] = {}
        self._is_narrow: bool | None = None
        self.visits: tuple[CourseVisit, ...] = ()
        self.lanes: tuple[CourseLane, ...] = ()
        self.number: int | None = None
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.axis = DateAxis()
        self.method = Text(size=12, tone="ink2", wraps=True)
        self.note = Text(size=12, tone="ink2", wraps=True)
        self.compute = Button(tr("Calculate"), ButtonKind.SECONDARY, height=36)
        self.info = Button("", ButtonKind.QUIET, Icon.INFO, height=36)
        self.info.setAccessibleName(tr("Method"))
        self.info.setCheckable(True)
        self._grid_room = QWidget()
        self._grid_room.setLayout(self._grid)
        self.head = lay_out(QHBoxLayout(), self.info, spacing=8)
        foot = lay_out(QHBoxLayout(), (self.note, 1), self.compute, margins=(0, 0, 8, 0), spacing=12)
        lay_out(self.column, self.head, self._grid_room, self.method, foot, margins=(16, 4, 8, 4))
        scaled(self._grid.setContentsMargins, 0, 2, 8, 0)
        scaled(self._grid.setHorizontalSpacing, 8)
        scaled(self._grid.setVerticalSpacing, 2)
        self._join(self.axis)
        self._show_kinds(lane_kinds())
        on_theme(self._keep_heights)
        self.compute.clicked.connect(self.computing_requested)
        self.info.toggled.connect(self.method.setVisible)
        self.method.hide()
        self.set_room(NARROW_BELOW)

    def show_course(self, visits: Sequence[CourseVisit], lanes: Sequence[CourseLane]) -> None:
        """Show lanes over visits, which are in order of time."""
        self.visits, self.lanes, self.number = tuple(visits), tuple(lanes), None
        self._show_kinds([lane.kind for lane in lanes])
        for lane in lanes:
            self.rows[lane.kind].show_lane(lane, visits)
        self.axis.show_visits(visits)
        self._grid_room.setVisible(any(lane.lines for lane in lanes))
        self.method.setText(key_in_words(lanes))
        self.note.setText(nothing_between(visits))
        self.note.setVisible(bool(self.note.text()))
        self.compute.setVisible(any(visit.course is None for visit in visits))
        self.setAccessibleName(tr("Progress across visits"))
        self.setAccessibleDescription(
            " ".join(filter(None, [*(lane_in_words(lane, visits) for lane in lanes), self.note.text()]))
        )

    def point_at(self, number: int) -> None:
        """Mark a visit in all lanes."""
        self.number = number
        for plot in (*(row.plot for row in self.rows.values()), self.axis):
            plot.point_at(number)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        steps = {Qt.Key.Key_Right: 1, Qt.Key.Key_Left: -1}
        key = Qt.Key(event.key())
        if key in steps and self.visits:
            last = len(self.visits) - 1
            before = self.number if self.number is not None else (last + 1 if steps[key] < 0 else -1)
            self.point_at(min(max(before + steps[key], 0), last))
            stated = visit_in_words(self.number or 0, self.lanes, self.visits)
            QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, stated))
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.number is not None:
            self._open(self.number)
        else:
            super().keyPressEvent(event)

    def _show_kinds(self, kinds: Sequence[LaneKind]) -> None:
        """Have a row for each lane, in their order; those that stay keep their place on the screen."""
        if list(kinds) == list(self.rows):
            return
        for row in self.rows.values():
            for part in row.parts:
                self._grid.removeWidget(part)
        for kind in [kind for kind in self.rows if kind not in kinds]:
            for part in self.rows.pop(kind).parts:
                part.hide()
                part.deleteLater()
        for kind in [kind for kind in kinds if kind not in self.rows]:
            self.rows[kind] = LaneRow(kind)
            self._join(self.rows[kind].plot)
        self.rows = {kind: self.rows[kind] for kind in kinds}
        self._lay()

    def _join(self, plot: DatedPlot) -> None:
        plot.pointed.connect(self.point_at)
        plot.opened.connect(self._open)

    def _open(self, number: int) -> None:
        self.visit_opened.emit(self.visits[number].id)

    def set_room(self, width: float) -> None:
        """Put words beside the lanes, or over them where there is little width, in px of the design."""
        is_narrow = width < NARROW_BELOW
        if is_narrow == self._is_narrow:
            return
        self._is_narrow = is_narrow
        self._lay()

    def _lay(self) -> None:
        """Put the rows into the grid, and the axis under them."""
        is_narrow = bool(self._is_narrow)
        for number, row in enumerate(self.rows.values()):
            at = 2 * number
            row.set_narrow(is_narrow)
            self._grid.addWidget(row.label, at, 0)
            self._grid.addWidget(row.changes, at, 1 if is_narrow else 2)
            self._grid.addWidget(row.plot, at + 1 if is_narrow else at, 0 if is_narrow else 1, 1, 2 if is_narrow else 1)
        self._grid.removeWidget(self.axis)
        self._grid.addWidget(self.axis, 2 * len(self.rows), 0 if is_narrow else 1, 1, 2 if is_narrow else 1)
        self._grid.setColumnStretch(0, 1 if is_narrow else 0)
        self._grid.setColumnStretch(1, 0 if is_narrow else 1)
        hear_as_laid_out(self._grid_room)
        self._keep_heights()

    def paintEvent(self, event: QPaintEvent) -> None:
        """A hairline over every row."""
        super().paintEvent(event)
        if self._grid_room.isHidden():
            return
        painter, side = QPainter(self), px(16)
        painter.setPen(current_theme().pen(current_theme().colours.line, 1))
        for row in self.rows.values():
            top = self._grid_room.y() + min(row.plot.y(), row.label.y()) - 1.5
            painter.drawLine(QPointF(side, top), QPointF(self.width() - side, top))

    def _keep_heights(self) -> None:
        for at in range(self._grid.rowCount()):
            is_row = at % 2 == 0 and at < 2 * len(self.rows) and not self._is_narrow
            self._grid.setRowMinimumHeight(at, px(ROW) if is_row else 0)


class LaneRow:
    """The three parts of a lane: its name, its plot, and its last value with what has changed."""

    def __init__(self, kind: LaneKind) -> None:
        self.kind = kind
        self.label = _Words(LABELS)
        self.plot = LanePlot()
        self.changes = _Words(CHANGES)

    @property
    def parts(self) -> tuple[QWidget, ...]:
        return self.label, self.plot, self.changes

    def set_narrow(self, is_narrow: bool) -> None:
        self.label.set_wide(is_narrow)
        self.changes.set_wide(is_narrow)

    def show_lane(self, lane: CourseLane, visits: Sequence[CourseVisit]) -> None:
        self.plot.show_lane(lane, visits)
        self.label.clear()
        sides = [one.line.side for one in lane.changes if one.line.side is not None]
        name = Text(lane_name(self.kind), weight=MEDIUM, wraps=True)
        self.label.add(self._beside(name, *(Chip(side) for side in sides if len(sides) == 1), wide=name))
        self.changes.clear()
        values: list[QWidget] = []
        for one in lane.changes:
            if len(sides) > 1 and one.line.side is not None:
                values.append(Chip(one.line.side))
            values += self._value(lane, one, VALUE if len(lane.changes) == 1 else VALUE_OF_TWO)
        self.changes.add(self._beside(*values))
        for one in lane.changes:
            self._add_change(lane, one, visits, has_sides=len(sides) > 1)

    def _value(self, lane: CourseLane, one: LaneChange, size: float) -> list[QWidget]:
        """Type follows trust: bold what is read, regular what is to be read with care, small what cannot be."""
        last, words = one.line.points[-1], last_in_words(lane, one)
        if not last.is_reported:
            return [Text(words, size=12, tone="ink2")]
        value = Text(words, size=size, weight=SEMIBOLD if last.verdict is Verdict.READ else REGULAR)
        return [value, *([Text(unit, 13, tone="ink2")] if (unit := unit_beside(self.kind)) else [])]

    def _add_change(self, lane: CourseLane, one: LaneChange, visits: Sequence[CourseVisit], *, has_sides: bool) -> None:
        """Since the first visit that can be read, after its arrow; of a value that is not the last visit's, its day."""
        last, words = one.line.points[-1], change_in_words(lane, one, visits)
        if not words and last.visit != len(visits) - 1:
            words = tr("on {day}").format(day=day_of(last.visit, visits))
        if not words:
            return
        arrow, who = arrow_of(lane, one.since_first), ""
        if has_sides and one.line.side is not None:
            who = f"{one.line.side.letter} "
        text = Text(who + words, 13, MEDIUM if arrow is not None and arrow.is_filled else REGULAR, wraps=True)
        before = [ChangeArrow(arrow)] if arrow is not None else []
        self.changes.add(self._beside(*before, text, wide=text))

    def _beside(self, *parts: QWidget, wide: QWidget | None = None) -> QWidget:
        """Parts in a row; `wide` takes what the others leave."""
        room = QWidget()
        row = lay_out(QHBoxLayout(room), *((part, int(part is wide)) for part in parts), margins=0, spacing=6)
        if wide is None:
            row.addStretch(1)
        return room


class _Words(QWidget):
    """Rows of words under one another, in the middle of the height that there is."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self._width, self._is_wide = width, False
        self._parts: list[QWidget] = []
        self._column = lay_out(QVBoxLayout(self), 1, 1, margins=0, spacing=0)
        on_theme(self._fit)

    def clear(self) -> None:
        for part in self._parts:
            self._column.removeWidget(part)
            part.hide()
            part.deleteLater()
        self._parts = []

    def add(self, part: QWidget) -> None:
        self._column.insertWidget(self._column.count() - 1, part)
        self._parts.append(part)
        part.show()

    def set_wide(self, is_wide: bool) -> None:
        """Take all the width there is, in place of a column's."""
        self._is_wide = is_wide
        self._fit()

    def _fit(self) -> None:
        width = px(self._width)
        self.setMinimumWidth(0 if self._is_wide else width)
        self.setMaximumWidth(WIDEST if self._is_wide else width)

"""A patient's course: lanes over the dates of the visits, with what has changed beside them."""

import math
from collections.abc import Mapping, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QKeyEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.plots.lane_plot import ConditionMark, DateAxis, DatedPlot, LanePlot
from app.summary.course_lanes import CourseLane, CourseVisit, LaneChange, LaneKind, lane_kinds
from app.summary.course_words import (
    change_in_words,
    day_of,
    judged_in_words,
    key_in_words,
    lane_in_words,
    last_in_words,
    nothing_between,
    reported_goals,
    since_last_in_words,
    visit_in_words,
)
from app.summary.goals import brief_standing, goal_mark
from app.summary.visits import condition_in_words
from app.theme.icons import Icon
from app.theme.notifier import ThemeNotifier
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.chip import Chip
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.icons import IconMark
from app.widgets.text import REGULAR, SEMIBOLD, Text
from app.widgets.themed import Themed
from app.wording.measures import measure_name, unit_name
from app.wording.translation import tr
from core.verdicts.model import Verdict

LABELS, CHANGES = 148, 172  # px: the columns of words beside the lanes
NARROW_BELOW = 560  # words stand over the lanes instead
VALUE = 22
WIDEST = 16_777_215  # Qt's own


class CourseCard(Card):
    """Passive. The arrow keys and the mouse go from visit to visit, Enter and a click open one.

    Signals
    -------
    visit_opened
        The id of its session.
    computing_requested
        The visits that have no figures yet are to be evaluated.
    """

    accessible_role = QAccessible.Role.Chart

    visit_opened = Signal(object)
    computing_requested = Signal()

    def __init__(self, look: ThemeNotifier) -> None:
        self._grid, self._legend, self._foot = QGridLayout(), QHBoxLayout(), QHBoxLayout()
        super().__init__(look, padding=16, spacing=4)
        self.visits: tuple[CourseVisit, ...] = ()
        self.lanes: tuple[CourseLane, ...] = ()
        self.number: int | None = None
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.rows: dict[LaneKind, LaneRow] = {}
        self.axis = DateAxis(look)
        self.note = Text(look, size=12, tone="ink2", wraps=True)
        self.compute = Button(look, tr("Calculate"), ButtonKind.SECONDARY, height=36)
        self._grid_room, self._legend_room = QWidget(), QWidget()
        self._is_narrow: bool | None = None
        self._foot.addWidget(self.note, 1)
        self._foot.addWidget(self.compute)
        for room, layout, stretch in ((self._legend_room, self._legend, 0), (self._grid_room, self._grid, 1)):
            layout.setContentsMargins(0, 0, 0, 0)
            room.setLayout(layout)
            self.column.addWidget(room, stretch)
        self.column.addLayout(self._foot)
        self._join(self.axis)
        self._show_kinds(lane_kinds())
        self.compute.clicked.connect(self.computing_requested)
        self.set_room(NARROW_BELOW)

    def show_course(
        self, visits: Sequence[CourseVisit], lanes: Sequence[CourseLane], conditions: Sequence[str]
    ) -> None:
        """Show lanes over visits, which are in order of time; `conditions` in the order of their marks."""
        self.visits, self.lanes, self.number = tuple(visits), tuple(lanes), None
        self._show_kinds([lane.kind for lane in lanes])
        for lane in lanes:
            self.rows[lane.kind].show_lane(lane, visits, conditions)
        self.axis.show_visits(visits)
        drawn = {line.condition for lane in lanes for line in lane.lines}
        self._show_legend({mark: name for mark, name in enumerate(conditions) if name in drawn})
        self._grid_room.setVisible(any(lane.lines for lane in lanes))
        self.note.setText(" ".join(filter(None, [nothing_between(visits), key_in_words(lanes)])))
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
            self.rows[kind] = LaneRow(self._look, kind)
            self._join(self.rows[kind].plot)
        self.rows = {kind: self.rows[kind] for kind in kinds}
        self._lay()

    def _join(self, plot: DatedPlot) -> None:
        plot.pointed.connect(self.point_at)
        plot.opened.connect(self._open)

    def _open(self, number: int) -> None:
        self.visit_opened.emit(self.visits[number].id)

    def _show_legend(self, conditions: Mapping[int, str]) -> None:
        """The conditions by their marks, where there are several."""
        while (item := self._legend.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for mark, condition in conditions.items():
            self._legend.addWidget(ConditionMark(self._look, mark))
            self._legend.addWidget(Text(self._look, condition_in_words(condition), size=12, tone="ink2", wraps=True))
        self._legend.addStretch(1)
        self._legend_room.setVisible(len(conditions) > 1)

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
        for at in range(self._grid.rowCount()):
            self._grid.setRowStretch(at, 0)
        for number, row in enumerate(self.rows.values()):
            at = 2 * number
            row.set_narrow(is_narrow)
            self._grid.addWidget(row.label, at, 0)
            self._grid.addWidget(row.changes, at, 1 if is_narrow else 2)
            self._grid.addWidget(row.plot, at + 1 if is_narrow else at, 0 if is_narrow else 1, 1, 2 if is_narrow else 1)
            self._grid.setRowStretch(at, 0 if is_narrow else 1)
            self._grid.setRowStretch(at + 1, 1 if is_narrow else 0)
        self._grid.removeWidget(self.axis)
        self._grid.addWidget(self.axis, 2 * len(self.rows), 0 if is_narrow else 1, 1, 2 if is_narrow else 1)
        self._grid.setColumnStretch(0, 1 if is_narrow else 0)
        self._grid.setColumnStretch(1, 0 if is_narrow else 1)
        hear_as_laid_out(self._grid_room)
        self._on_look_changed()

    def _on_look_changed(self) -> None:
        super()._on_look_changed()
        px = self._look.theme.px
        self._grid.setHorizontalSpacing(px(12))
        self._grid.setVerticalSpacing(px(4))
        self._legend.setSpacing(px(6))
        self._foot.setSpacing(px(12))


class LaneRow:
    """The three parts of a lane: its name, its plot, and what has changed."""

    def __init__(self, look: ThemeNotifier, kind: LaneKind) -> None:
        self.kind = kind
        self.label = _Words(look, LABELS)
        self.plot = LanePlot(look)
        self.changes = _Words(look, CHANGES)
        self._look = look

    @property
    def parts(self) -> tuple[QWidget, ...]:
        return self.label, self.plot, self.changes

    def set_narrow(self, is_narrow: bool) -> None:
        self.label.set_brief(is_narrow)
        self.changes.set_brief(is_narrow)

    def show_lane(self, lane: CourseLane, visits: Sequence[CourseVisit], conditions: Sequence[str]) -> None:
        self.plot.show_lane(lane, visits, conditions)
        self.label.clear()
        name = measure_name(self.kind.column, is_between=self.kind.is_between)
        self.label.add(Text(self._look, name, weight=SEMIBOLD, wraps=True))
        for goal in lane.goals:
            mark = Text(self._look, f"\N{MIDDLE DOT}\N{MIDDLE DOT}\N{MIDDLE DOT} {goal_mark(goal)}", 12, SEMIBOLD)
            mark.setAccessibleName(goal_mark(goal))
            self.label.add(mark, is_brief=True)
        self.label.add(Text(self._look, unit_name(self.kind.column), size=12, tone="ink2"))
        self.changes.clear()
        values = QWidget()
        row = QHBoxLayout(values)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(self._look.theme.px(6))
        for one in lane.changes:
            if one.line.side is not None:
                row.addWidget(Chip(self._look, one.line.side))
            row.addWidget(self._value(one))
        row.addStretch(1)
        self.changes.add(values)
        for one in lane.changes:
            self._add_goals(lane, one, visits)
            self._add_change(one, visits, has_sides=len(lane.changes) > 1)

    def _add_goals(self, lane: CourseLane, one: LaneChange, visits: Sequence[CourseVisit]) -> None:
        """How the last value compares with goals that were agreed before it."""
        for found in reported_goals(lane, one, visits):
            self.changes.add(Text(self._look, brief_standing(found.standing), 12, wraps=True))

    def _value(self, one: LaneChange) -> Text:
        """Type follows trust: bold what is read, regular what is to be read with care, small what cannot be."""
        last = one.line.points[-1]
        words = last_in_words(one, self.kind)
        if not last.is_reported:
            return Text(self._look, words, size=12, tone="ink2")
        return Text(self._look, words, size=VALUE, weight=SEMIBOLD if last.verdict is Verdict.READ else REGULAR)

    def _add_change(self, one: LaneChange, visits: Sequence[CourseVisit], *, has_sides: bool) -> None:
        """Since the first visit that can be read, and since the one before."""
        last = one.line.points[-1]
        if last.visit != len(visits) - 1 and not has_sides:
            self.changes.add(Text(self._look, tr("on {day}").format(day=day_of(last.visit, visits)), 12, tone="ink2"))
        found = one.since_first
        if found is None or one.first is None or not math.isfinite(found.difference):
            return
        who = f"{one.line.side.letter} " if has_sides and one.line.side is not None else ""
        stated = tr("{change} since {day}").format(
            change=who + change_in_words(found, self.kind), day=day_of(one.first, visits)
        )
        self.changes.add_marked(stated, is_marked=found.exceeds)
        self.changes.add(Text(self._look, judged_in_words(found, self.kind), 12, tone="ink2", wraps=True))
        if one.since_last is not None and not has_sides:
            self.changes.add(
                Text(self._look, since_last_in_words(one.since_last, self.kind), 12, tone="ink2", wraps=True)
            )


class _Words(Themed):
    """Words under one another; brief, only the first of them."""

    def __init__(self, look: ThemeNotifier, width: int) -> None:
        super().__init__()
        self._look, self._width, self._is_brief = look, width, False
        self._parts: list[QWidget] = []
        self._few: list[QWidget] = []
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(0)
        self._column.addStretch(1)
        self._on_look_changed()

    def clear(self) -> None:
        for part in self._parts:
            self._column.removeWidget(part)
            part.hide()
            part.deleteLater()
        self._parts, self._few = [], []

    def add(self, part: QWidget, *, is_brief: bool = False) -> None:
        """`is_brief`: it is shown where words are to be few, too, as the first one is."""
        self._column.insertWidget(self._column.count() - 1, part)
        self._parts.append(part)
        if is_brief or len(self._parts) == 1:
            self._few.append(part)
        self._show()

    def add_marked(self, words: str, *, is_marked: bool) -> None:
        """A line with arrows before it where what it states lies beyond the error."""
        line = QWidget()
        row = QHBoxLayout(line)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(self._look.theme.px(4))
        if is_marked:
            row.addWidget(IconMark(self._look, Icon.DIFFERENCE, size=16))
        row.addWidget(Text(self._look, words, 12, SEMIBOLD if is_marked else REGULAR, wraps=True), 1)
        self.add(line)

    def set_brief(self, is_brief: bool) -> None:
        self._is_brief = is_brief
        self._show()
        self._on_look_changed()

    def _show(self) -> None:
        for part in self._parts:
            part.setVisible(part in self._few or not self._is_brief)
        self._fit()

    def _on_look_changed(self) -> None:
        width = self._look.theme.px(self._width)
        self.setMinimumWidth(0 if self._is_brief else width)
        self.setMaximumWidth(WIDEST if self._is_brief else width)
        self._fit()

    def _fit(self) -> None:
        """Ask for the height that the words take in this width: a lane beside them is not to squeeze them."""
        shown = self._few if self._is_brief else self._parts
        width = self._look.theme.px(self._width)
        heights = [
            part.heightForWidth(width) if part.hasHeightForWidth() else part.sizeHint().height() for part in shown
        ]
        self.setMinimumHeight(sum(heights))

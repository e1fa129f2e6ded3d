"""What is agreed with a patient: a measure, whose it is, the value to be reached; and what was agreed before."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.theme.current import scaled
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.field import Field, NumberField
from app.widgets.lay_out import lay_out
from app.widgets.segmented import Segmented
from app.widgets.tall_page import TallPage
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.dates import date
from app.wording.measures import goal_in_words, measure_name, required, short_unit, whose_name
from app.wording.translation import tr
from core.goals import GOAL_COLUMNS, LEAST, MOST, MOST_NOTE, Goal, GoalKey, GoalOf, held, whose

MARGIN, GAP = 24, 16
NARROW_BELOW = 820  # px of the design: what was agreed is below the form
LONGEST_WEEKS = 104
AT_LEAST, AT_MOST = "least", "most"


@dataclass(frozen=True, slots=True)
class GoalDraft:
    """What is to be agreed; `weeks`: within how many, None where nothing was stated about that."""

    column: str
    of: GoalOf
    value: float
    is_at_most: bool
    weeks: int | None
    note: str


class GoalsPage(TallPage):
    """Proposes nothing: the value is typed."""

    agreed = Signal(object)  # a `GoalDraft`: it is to hold from now on
    taken_back = Signal(object)  # the key of a goal that is to hold no longer

    def __init__(self) -> None:
        super().__init__()
        self.rows: list[_GoalRow] = []
        self._title = Text(size=26, weight=SEMIBOLD)
        self._lead = Text(
            tr(
                "Agree on a goal with the patient and enter it here. Date and user are recorded. The goal "
                "appears wherever the measure is shown. At later visits, it also guides which results are "
                "shown."
            ),
            tone="ink2",
            wraps=True,
        )
        self.measure = Choice(tr("Measure"))
        for column in GOAL_COLUMNS:
            self.measure.addItem(measure_name(column), column)
        names = {GoalOf.LEFT: tr("Left"), GoalOf.RIGHT: tr("Right"), GoalOf.BETWEEN: tr("Left vs right")}
        self.whose = Segmented(tr("Side"), [(of.value, word, "") for of, word in names.items()])
        self.sense = Segmented(tr("Limit"), [(AT_LEAST, tr("At least"), ""), (AT_MOST, tr("At most"), "")])
        self.apart = Text(
            tr("The legs should differ by no more than the value entered, in either direction."), wraps=True
        )
        self.value = NumberField(tr("Value"), low=LEAST, high=1.0, decimals=2)
        self.weeks = NumberField(tr("Within"), low=1, high=LONGEST_WEEKS, unit=tr("weeks"), is_optional=True)
        self.note = Field(tr("Note"), is_optional=True, most=MOST_NOTE)
        self.none_yet = Text(tr("No goals agreed yet."), tone="ink2", wraps=True)
        self._build()
        self._connect()
        self._on_measure_chosen()
        scaled(self.column.setContentsMargins, MARGIN, 16, MARGIN, GAP)
        scaled(self.column.setSpacing, 12)
        scaled(self._columns.setSpacing, GAP)
        scaled(self._figures.setSpacing, 12)
        scaled(self._list.setSpacing, 12)

    @property
    def tab_order(self) -> list[QWidget]:
        taking_back = [row.take_back for row in self.rows if row.take_back is not None]
        form = [self.measure, *self.whose.segments, *self.sense.segments, self.value.line_edit]
        return [*form, self.weeks.line_edit, self.note.line_edit, *taking_back]

    def focus(self) -> None:
        self.measure.setFocus()

    def set_room(self, width: float) -> None:
        """Lay out for a page of this width, in px of the design."""
        is_narrow = width < NARROW_BELOW
        way = QBoxLayout.Direction.TopToBottom if is_narrow else QBoxLayout.Direction.LeftToRight
        self._columns.setDirection(way)

    def show_patient(self, code: str) -> None:
        """Begin again, for this patient."""
        self._title.setText(tr("Goals of {code}").format(code=code) if code else tr("Goals"))
        self.show_goals(())
        self._clear()
        self.measure.setCurrentIndex(0)

    def show_goals(self, goals: Sequence[Goal]) -> None:
        """Show what holds, then what ended, the latest first."""
        for row in self.rows:
            self._list.removeWidget(row)
            row.hide()
            row.deleteLater()
        ordered = [*held(goals[::-1]), *(goal for goal in goals[::-1] if not goal.is_held)]
        self.rows = [_GoalRow(goal) for goal in ordered]
        for at, row in enumerate(self.rows):
            self._list.insertWidget(at, row)
            if row.take_back is not None:
                row.taken_back.connect(self.taken_back)
        self.none_yet.setVisible(not goals)

    def show_agreed(self) -> None:
        """Clear what was typed, for it holds now."""
        self._clear()
        self.measure.setFocus()

    def submit(self) -> None:
        """Pass on what was typed, or show at its field what is missing."""
        if self.value.value is None:
            if not self.value.text.strip():
                self.value.set_wrong(tr("Enter the target value."))
            self.value.setFocus()
            return
        if self.weeks.text.strip() and self.weeks.value is None:
            self.weeks.setFocus()
            return
        of, weeks = self._of, self.weeks.value
        is_at_most = of is GoalOf.BETWEEN or self.sense.choice == AT_MOST
        note = self.note.text.strip()
        stated = GoalDraft(self._column, of, self.value.value, is_at_most, None if weeks is None else int(weeks), note)
        self.agreed.emit(stated)

    @property
    def _column(self) -> str:
        return str(self.measure.currentData())

    @property
    def _of(self) -> GoalOf:
        return GoalOf.WALK if GoalOf.WALK in whose(self._column) else GoalOf(self.whose.choice)

    def _clear(self) -> None:
        self.value.set_value(None)
        self.weeks.set_value(None)
        self.note.set_text("")

    def _build(self) -> None:
        form = self._form = Card(spacing=12)
        form.column.addWidget(Text(tr("Add a goal"), size=16, weight=SEMIBOLD))
        lay_out(form.column, Text(tr("Measure"), weight=MEDIUM), self.measure, self.whose, self.sense, self.apart)
        self._figures = QHBoxLayout()
        lay_out(self._figures, (self.value, 1, Qt.AlignmentFlag.AlignTop), (self.weeks, 1, Qt.AlignmentFlag.AlignTop))
        lay_out(form.column, self._figures, self.note, 1)
        self._held = Card()
        lay_out(self._held.column, Text(tr("Agreed"), size=16, weight=SEMIBOLD), self.none_yet)
        self._list = QVBoxLayout()
        lay_out(self._held.column, self._list, 1)
        self._columns = lay_out(QBoxLayout(QBoxLayout.Direction.LeftToRight), (self._form, 5), (self._held, 6))
        lay_out(self.column, self._title, self._lead, (self._columns, 1))

    def _connect(self) -> None:
        self.measure.currentIndexChanged.connect(self._on_measure_chosen)
        self.whose.chosen.connect(self._show_limits)
        for field in (self.value, self.weeks, self.note):
            field.line_edit.returnPressed.connect(self.submit)

    def _on_measure_chosen(self) -> None:
        """Offer whose figures the measure has; a value of another measure is no value of this one."""
        can = whose(self._column)
        self.whose.setVisible(GoalOf.WALK not in can)
        self.whose.set_offered(GoalOf.BETWEEN, GoalOf.BETWEEN in can)
        self.sense.choose(AT_MOST if self._column.endswith("_time_s") else AT_LEAST)
        self.value.set_value(None)
        self._show_limits()

    def _show_limits(self) -> None:
        is_between = self._of is GoalOf.BETWEEN
        self.sense.setVisible(not is_between)
        self.apart.setVisible(is_between)
        self.value.low, self.value.high = (0.0 if is_between else LEAST), MOST[self._column]
        self.value.set_unit(short_unit(self._column).strip())


class _GoalRow(QWidget):
    """One goal: what it asks for, who agreed on it and when, and a button to take it back while it holds."""

    taken_back = Signal(object)

    def __init__(self, goal: Goal) -> None:
        super().__init__()
        self._key = goal.key
        name = ", ".join(filter(None, [measure_name(goal.column), whose_name(goal.of)]))
        self.words = Text(name, weight=SEMIBOLD if goal.is_held else MEDIUM, wraps=True)
        if not goal.is_held:
            self.words.set_tone("ink2")
        self.limit = Text(required(goal), wraps=True, tone="ink" if goal.is_held else "ink2")
        self.about = Text(about(goal), size=12, tone="ink2", wraps=True)
        self.take_back: Button | None = None
        column = lay_out(QVBoxLayout(), self.words, self.limit, self.about, spacing=0)
        row = lay_out(QHBoxLayout(self), (column, 1), margins=0)
        if goal.is_held:
            self.take_back = Button(tr("Withdraw"), ButtonKind.QUIET, height=36)
            self.take_back.setAccessibleName(tr("Withdraw: {goal}").format(goal=goal_in_words(goal)))
            self.take_back.clicked.connect(self._on_take_back)
            row.addWidget(self.take_back, 0, Qt.AlignmentFlag.AlignTop)

    @property
    def key(self) -> GoalKey:
        return self._key

    def _on_take_back(self) -> None:
        self.taken_back.emit(self._key)


def about(goal: Goal) -> str:
    """Who agreed on a goal and when, by when it is to be reached, when it ended, and what was typed of it."""
    by = f", {goal.by}" if goal.by else ""
    stated = [tr("agreed {day}").format(day=date(goal.agreed)) + by]
    if goal.until is not None:
        stated.append(tr("by {day}").format(day=date(goal.until)))
    if goal.ended is not None:
        by = f", {goal.ended_by}" if goal.ended_by else ""
        stated.append(tr("ended {day}").format(day=date(goal.ended)) + by)
    return " · ".join([*stated, *filter(None, [goal.note])])

"""The patient who is chosen: who it is, the course over the visits, the sessions, and what is to be done next."""

from collections.abc import Sequence

from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QHBoxLayout, QMenu, QSizePolicy, QVBoxLayout, QWidget

from app.plots.course import CourseCard
from app.summary.course_lanes import (
    MOST_TOGETHER,
    CourseVisit,
    conditions_of_visits,
    kinds_of_tests,
    lanes,
    without_lane,
)
from app.summary.course_words import NextStep
from app.summary.visits import condition_in_words
from app.theme.icons import Icon
from app.theme.notifier import ThemeNotifier
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.icons import IconMark
from app.widgets.line_list import LineList, SessionLine
from app.widgets.segmented import Segmented
from app.widgets.text import SEMIBOLD, Text
from app.widgets.themed import Themed
from app.wording.measures import goal_in_words
from app.wording.translation import tr, tr_n
from core.goals import Goal, held

SESSION_ROW = 48
SESSIONS_SEEN, SESSIONS_AT_LEAST = 3, 2  # the others are scrolled to
ALL = "\N{ASTERISK}"  # no condition is called so
WALKING, TESTS = "walking", "tests"


class PatientPanel(Themed):
    """Passive: it is shown visits, lines and what is next.

    Signals
    -------
    next_requested
        The session that the next step is about.
    """

    next_requested = Signal(object)
    goals_requested = Signal()
    analysing_requested = Signal()  # again, of this patient's sessions
    delete_patient_requested = Signal()
    delete_session_requested = Signal()

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self._visits: tuple[CourseVisit, ...] = ()
        self._agreed: tuple[Goal, ...] = ()
        self._next: NextStep | None = None
        self.code = Text(look, size=26, weight=SEMIBOLD, is_code=True, wraps=True)
        self.person = Text(look, tone="ink2", wraps=True)
        self.more = Button(look, tr("More"), ButtonKind.QUIET, height=36)
        self.menu = QMenu(self)
        self.delete_patient = QAction(tr("Delete patient"), self.menu)
        self.delete_session = QAction(tr("Delete session"), self.menu)
        self.analyse_again = QAction(tr("Analyse sessions again"), self.menu)
        self.menu.addActions([self.analyse_again, self.delete_session, self.delete_patient])
        self.shown = Segmented(look, tr("Progress of"), [(WALKING, tr("Walking"), ""), (TESTS, tr("Timed tests"), "")])
        self.condition = Choice(look, tr("Condition"))
        self.count = Text(look, tone="ink2", wraps=True)
        self.goals = Button(look, tr("Goals"), ButtonKind.SECONDARY, Icon.GOAL, height=44)
        self.course = CourseCard(look)
        self.sessions = LineList(look, tr("Sessions"), is_opened_by_click=True, row=SESSION_ROW)
        self.none_yet = Text(look, tone="ink2", wraps=True)
        self.say_none_yet(is_awaited=False)
        self.next = Text(look, wraps=True)
        self.go = Button(look, "", ButtonKind.QUIET, Icon.NEXT, height=36)
        self._build()
        self._connect()
        self._on_look_changed()

    @property
    def tab_order(self) -> list[QWidget]:
        return [
            self.more,
            *self.shown.segments,
            self.condition,
            self.goals,
            self.course,
            self.course.compute,
            self.sessions,
            self.go,
        ]

    def set_room(self, width: float) -> None:
        """Lay out for this width, in px of the design."""
        self.course.set_room(width)

    def show_patient(self, code: str, person: str) -> None:
        """Say whose sessions stand here; nobody's where there is no code."""
        self.code.setText(code)
        self.person.setText(person)
        self.more.setVisible(bool(code))
        self._sessions_card.setVisible(bool(code))
        self._above.setVisible(bool(code))

    def show_sessions(self, lines: Sequence[SessionLine]) -> None:
        line = self.sessions.line  # the same patient's, read again, or none
        self.sessions.show_lines(lines, line.id if line is not None else None, stays=line is not None)
        self.sessions.setVisible(bool(lines))
        self.none_yet.setVisible(not lines)
        self.delete_session.setEnabled(self.sessions.line is not None)
        self._on_look_changed()

    def say_none_yet(self, *, is_awaited: bool) -> None:
        """What is shown in place of sessions where there are none; `is_awaited`: they come by themselves."""
        words = (
            tr("Visits of this patient are being recorded and will appear here.")
            if is_awaited
            else tr("No sessions yet.")
        )
        self.none_yet.setText(words)

    def show_course(self, visits: Sequence[CourseVisit], goals: Sequence[Goal] = ()) -> None:
        """Show the course over visits, which are in order of time; of the condition that is chosen, else of all."""
        self._visits, self._agreed = tuple(visits), tuple(goals)
        found, before = conditions_of_visits(visits), self.condition.currentData()
        self.condition.blockSignals(True)
        self.condition.clear()
        if len(found) <= MOST_TOGETHER:
            self.condition.addItem(tr("All conditions"), ALL)
        for name in found:
            self.condition.addItem(condition_in_words(name), name)
        self.condition.setCurrentIndex(max(self.condition.findData(before), 0))
        self.condition.blockSignals(False)
        self.condition.setVisible(len(found) > 1)
        self.condition.updateGeometry()
        self.shown.setVisible(bool(kinds_of_tests(visits, goals)))
        self.count.setText(_counted(found, visits, goals))
        self.course.setVisible(bool(visits))
        self._show_lanes()

    def show_next(self, step: NextStep | None) -> None:
        self._next = step
        self._next_card.setVisible(step is not None)
        if step is not None:
            self.next.setText(tr("Next: {what}").format(what=step.sentence))
            self.go.setText(step.verb)
            self.go.setAccessibleName(f"{step.verb}, {step.sentence}")
            self.go.setVisible(bool(step.verb))

    def _build(self) -> None:
        self._who = QHBoxLayout()
        self._who.addWidget(self.code)
        self._who.addWidget(self.person, 1)
        self._who.addWidget(self.more)
        self._above = QWidget()
        self._above_row = QHBoxLayout(self._above)
        self._above_row.setContentsMargins(0, 0, 0, 0)
        self._above_row.addWidget(self.shown)
        self._above_row.addWidget(self.condition)
        self._above_row.addWidget(self.count, 1)
        self._above_row.addWidget(self.goals)
        self._sessions_card = Card(self._look, padding=0)
        self._sessions_card.column.addWidget(self.sessions, 1)
        self._sessions_card.column.addWidget(self.none_yet, 0, Qt.AlignmentFlag.AlignHCenter)
        self._next_card = Card(self._look)
        self._next_row = QHBoxLayout()
        self._next_row.addWidget(IconMark(self._look, Icon.ARROW))
        self._next_row.addWidget(self.next, 1)
        self._next_row.addWidget(self.go)
        self._next_card.column.addLayout(self._next_row)
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.addLayout(self._who)
        self._column.addWidget(self._above)
        self._column.addWidget(self.course, 1)
        self._column.addWidget(self._sessions_card)
        self._column.addWidget(self._next_card)
        self._column.addStretch(0)

    def _connect(self) -> None:
        self.more.clicked.connect(self._on_more)
        self.analyse_again.triggered.connect(self.analysing_requested)
        self.delete_patient.triggered.connect(self.delete_patient_requested)
        self.delete_session.triggered.connect(self.delete_session_requested)
        self.goals.clicked.connect(self.goals_requested)
        self.condition.currentIndexChanged.connect(self._show_lanes)
        self.shown.chosen.connect(self._show_lanes)
        self.sessions.fitted.connect(self._fit_sessions)
        self.sessions.chosen.connect(self._on_session_chosen)
        self.go.clicked.connect(self._on_next)

    def _show_lanes(self) -> None:
        chosen = self.condition.currentData()
        kinds = kinds_of_tests(self._visits, self._agreed) if self.shown.choice == TESTS else ()
        shown = lanes(self._visits, None if chosen in (ALL, None) else chosen, self._agreed, kinds or None)
        self.course.show_course(self._visits, shown, list(conditions_of_visits(self._visits)))
        has_lanes = any(lane.lines for lane in shown)  # without any there is a line of words, and no room is taken
        self._column.setStretchFactor(self.course, int(has_lanes))
        self._column.setStretch(self._column.count() - 1, int(not has_lanes))
        policy = QSizePolicy.Policy.Preferred if has_lanes else QSizePolicy.Policy.Maximum
        self.course.setSizePolicy(QSizePolicy.Policy.Preferred, policy)

    def _on_more(self) -> None:
        self.menu.popup(self.more.mapToGlobal(QPoint(0, self.more.height())))

    def _on_session_chosen(self, session_id: object) -> None:
        self.delete_session.setEnabled(session_id is not None)

    def _on_next(self) -> None:
        if self._next is not None and self._next.session_id is not None:
            self.next_requested.emit(self._next.session_id)
        elif self._next is not None:
            self.goals_requested.emit()

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self._column.setSpacing(px(12))
        for row in (self._who, self._above_row, self._next_row):
            row.setSpacing(px(12))
        self.none_yet.setMinimumHeight(px(72))
        self._above.setMinimumHeight(px(48))
        self._fit_sessions()

    def _fit_sessions(self) -> None:
        """Have the first lines whole, however many rows of words each takes."""
        heights = [self.sessions.rowHeight(row) for row in range(min(len(self.sessions.lines), SESSIONS_SEEN))]
        self.sessions.setMinimumHeight(sum(heights[:SESSIONS_AT_LEAST]))
        self.sessions.setMaximumHeight(sum(heights) or self._look.theme.px(SESSION_ROW))


def _counted(found: dict[str, int], visits: Sequence[CourseVisit], goals: Sequence[Goal]) -> str:
    """How many visits there are, and of each condition but the most frequent one; goals that are not seen below."""
    stated = [tr_n("{count} visit", "{count} visits", len(visits)).format(count=len(visits))] if visits else []
    stated += [f"{condition_in_words(name)}: {count}" for name, count in list(found.items())[1:]]
    unseen = without_lane(goals) if any(visit.course is not None for visit in visits) else held(goals)
    return " · ".join([*stated, *map(goal_in_words, unseen)])

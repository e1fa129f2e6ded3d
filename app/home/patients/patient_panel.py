"""The patient who is chosen: who it is, what has changed, what is to be done next, progress, and the visits."""

from collections.abc import Sequence
from dataclasses import replace

from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QHBoxLayout, QMenu, QSizePolicy, QVBoxLayout, QWidget

from app.plots.course import CourseCard
from app.summary.course_lanes import (
    KNEE_LANE,
    SPEED_LANE,
    CourseLane,
    CourseVisit,
    conditions_of_visits,
    kinds_of_tests,
    lanes,
    usual_condition,
    without_lane,
)
from app.summary.course_words import NextKind, NextStep, value_in_words
from app.summary.progress_words import progress_words
from app.summary.visits import condition_in_words
from app.theme.current import on_theme, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.header import Tag
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.lay_out import lay_out
from app.widgets.line_list import LineList, SessionLine
from app.widgets.segmented import Segmented
from app.widgets.tall_page import TallPage
from app.widgets.text import SEMIBOLD, Text
from app.wording.measures import goal_in_words, measure_name, short_unit
from app.wording.translation import tr, tr_n
from core.body import Side
from core.goals import Goal, held
from core.parameters import SPEED

VISIT_ROW, VISIT_HEAD = 58, 38
CONDITION = 36  # high, in the head of the card
WALKING, TESTS = "walking", "tests"
ICONS = {
    NextKind.REVIEW: Icon.WARNING,
    NextKind.REPORT: Icon.EDIT,
    NextKind.GOALS: Icon.GOAL,
    NextKind.SESSION: Icon.PLAY,
}


class PatientPanel(TallPage):
    """Passive: it shows visits, lines and what is next, as high as all of them; its holder scrolls."""

    next_requested = Signal(object)  # the next step, which is to be taken

    def __init__(self) -> None:
        super().__init__()
        self._visits: tuple[CourseVisit, ...] = ()
        self._lines: tuple[SessionLine, ...] = ()
        self._agreed: tuple[Goal, ...] = ()
        self._next: NextStep | None = None
        self.code = Text(size=26, weight=SEMIBOLD, is_code=True, wraps=True)
        self.person = Text(tone="ink2", wraps=True)
        self.simulated = Tag(tr("SIMULATED"))
        self.more = Button(tr("More"), ButtonKind.QUIET, height=36)
        self.menu = QMenu(self)
        self.delete_patient = QAction(tr("Delete patient"), self.menu)
        self.delete_session = QAction(tr("Delete session"), self.menu)
        self.analyse_again = QAction(tr("Analyse sessions again"), self.menu)
        self.withdraw_video = QAction(tr("Withdraw consent to video"), self.menu)
        self.withdraw_video.setVisible(False)
        self.menu.addActions([self.analyse_again, self.withdraw_video, self.delete_session, self.delete_patient])
        self.sentence = Text(size=22, weight=SEMIBOLD, wraps=True)
        self.second = Text(tone="ink2", wraps=True)
        self.go = Button("", ButtonKind.SECONDARY, Icon.EDIT, tr("W"), height=44)
        self.reason = Text(tone="ink2", wraps=True)
        self.shown = Segmented(tr("Progress of"), [(WALKING, tr("Walking"), ""), (TESTS, tr("Timed tests"), "")])
        self.condition = Choice(tr("Condition"))
        self.condition.let_shrink(100, 200)
        self.condition.set_height(CONDITION)
        self.count = Text(size=12, tone="ink2", wraps=True)
        self.goals = Button(tr("Goals"), ButtonKind.QUIET, Icon.GOAL, height=36)
        self.course = CourseCard()
        self.sessions = LineList(tr("Visits"), is_opened_by_click=True, row=VISIT_ROW, head=VISIT_HEAD)
        self.none_yet = Text(tone="ink2", wraps=True)
        self.none_yet.setText(tr("No visit yet."))
        self._build()
        self._connect()
        on_theme(self._fit_sessions)

    @property
    def tab_order(self) -> list[QWidget]:
        return [
            self.more,
            self.go,
            *self.shown.segments,
            self.condition,
            self.goals,
            self.course.info,
            self.course,
            self.course.compute,
            self.sessions,
        ]

    def set_room(self, width: float) -> None:
        """Lay out for this width, in px of the design."""
        self.course.set_room(width)

    def show_patient(self, code: str, person: str) -> None:
        """Say whose sessions stand here; nobody's where there is no code."""
        self.code.setText(code)
        self.person.setText(person)
        self.more.setVisible(bool(code))
        self.visits_card.setVisible(bool(code))

    def show_sessions(
        self, lines: Sequence[SessionLine], *, is_simulated: bool = False, has_video_consent: bool = False
    ) -> None:
        self._lines = tuple(lines)
        self.withdraw_video.setVisible(has_video_consent)
        self.simulated.setVisible(is_simulated)
        self.sessions.setVisible(bool(lines))
        self.none_yet.setVisible(not lines)
        self.delete_session.setEnabled(self.sessions.line is not None)

    def say_none_yet(self, *, is_awaited: bool) -> None:
        """What is shown in place of visits where there are none; `is_awaited`: they come by themselves."""
        words = (
            tr("Visits of this patient are being recorded and will appear here.") if is_awaited else tr("No visit yet.")
        )
        self.none_yet.setText(words)

    def show_course(self, visits: Sequence[CourseVisit], goals: Sequence[Goal] = ()) -> None:
        """Show the course over visits, which are in order of time; of the condition that is chosen, else the usual."""
        self._visits, self._agreed = tuple(visits), tuple(goals)
        found = conditions_of_visits(visits)
        before = self.condition.currentData()
        self.condition.blockSignals(True)
        self.condition.clear()
        for name in found:
            self.condition.addItem(condition_in_words(name), name)
        self.condition.setCurrentIndex(
            max(self.condition.findData(before if before in found else usual_condition(visits)), 0)
        )
        self.condition.blockSignals(False)
        self.condition.setVisible(len(found) > 1)
        self.condition.updateGeometry()
        self.shown.setVisible(bool(kinds_of_tests(visits, goals)))
        self.course.setVisible(bool(visits or goals))
        self._show_lanes()

    def show_next(self, step: NextStep | None) -> None:
        """The next step as a button with its reason beside it; nothing where nothing is next."""
        self._next = step
        self.next_room.setVisible(step is not None)
        if step is not None:
            self.go.setText(step.verb)
            self.go.set_face(icon=ICONS[step.kind])
            self.go.setAccessibleName(f"{step.verb}, {step.reason}")
            self.reason.setText(step.reason)

    def take_next(self) -> None:
        """Take the next step, as a click on its button does."""
        if self._next is not None and self.isVisible():
            self.next_requested.emit(self._next)

    def _build(self) -> None:
        self._who = lay_out(QHBoxLayout(), self.code, (self.person, 1), self.simulated, self.more)
        self.next_room = QWidget()
        self._next_row = lay_out(QHBoxLayout(self.next_room), self.go, (self.reason, 1), margins=0)
        head = self.course.head
        title = Text(tr("Progress"), size=16, weight=SEMIBOLD)
        for number, part in enumerate((title, self.shown, self.condition, self.count, self.goals)):
            head.insertWidget(number, part, int(part is self.count))
        hear_as_laid_out(self.course)
        self.sessions.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.sessions.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.sessions.fitted.connect(self._fit_sessions)
        self.visits_card = Card(padding=0)
        lay_out(self.visits_card.column, self.sessions, (self.none_yet, 0, Qt.AlignmentFlag.AlignHCenter))
        self._statement = lay_out(QVBoxLayout(), self.sentence, self.second, spacing=2)
        self.column.addLayout(self._who)
        lay_out(self.column, self._statement, self.next_room, self.course, self.visits_card, 1, margins=0, spacing=12)
        for row in (self._who, self._next_row):
            scaled(row.setSpacing, 16)
        scaled(self.none_yet.setMinimumHeight, 72)

    def _fit_sessions(self) -> None:
        """As high as all lines are: it is the panel that scrolls."""
        rows = sum(self.sessions.rowHeight(row) for row in range(len(self.sessions.lines)))
        self.sessions.setFixedHeight(rows + self.sessions.horizontalHeader().height())

    def _connect(self) -> None:
        self.more.clicked.connect(self._on_more)
        self.condition.currentIndexChanged.connect(self._show_lanes)
        self.shown.chosen.connect(self._show_lanes)
        self.sessions.chosen.connect(self._on_session_chosen)
        self.go.clicked.connect(self.take_next)

    def _show_lanes(self) -> None:
        """All of the condition that is chosen: one value of one measure in sentence, progress and visits."""
        condition = self.condition.currentData() or usual_condition(self._visits)
        kinds = kinds_of_tests(self._visits, self._agreed) if self.shown.choice == TESTS else ()
        shown = lanes(self._visits, condition, self._agreed, kinds or None)
        self.course.show_course(self._visits, shown)
        self.count.setText(_counted(condition, self._visits, self._agreed, has_choice=self.condition.count() > 1))
        words = progress_words(self._visits, condition, self._agreed)
        self.sentence.setText(words.sentence)
        self.second.setText(words.second)
        for one in (self.sentence, self.second):
            one.setVisible(bool(one.text()))
        self._show_lines(lanes(self._visits, condition, self._agreed, (SPEED_LANE, KNEE_LANE)))

    def _show_lines(self, shown: Sequence[CourseLane]) -> None:
        """The sessions with their values under the condition that is chosen."""
        speed, knee = shown
        numbers = {visit.id: number for number, visit in enumerate(self._visits)}
        lines = [
            replace(
                line,
                speed=_values_at(numbers.get(line.id), speed, short_unit(SPEED)),
                knee=_values_at(numbers.get(line.id), knee, "°"),
            )
            for line in self._lines
        ]
        sides = [one.side for one in knee.lines if one.side is not None]
        head = {(): "", (Side.LEFT,): tr("Left knee"), (Side.RIGHT,): tr("Right knee")}.get(tuple(sides), tr("Knee"))
        table, before = self.sessions, self.sessions.line
        table.show_lines(
            lines,
            before.id if before is not None else None,
            stays=before is not None,
            head=(measure_name(SPEED) if speed.lines else "", head),
        )

    def _on_more(self) -> None:
        self.menu.popup(self.more.mapToGlobal(QPoint(0, self.more.height())))

    def _on_session_chosen(self, session_id: object) -> None:
        self.delete_session.setEnabled(session_id is not None)


def _values_at(number: int | None, lane: CourseLane, unit: str) -> str:
    """What a visit has of a lane, of both legs with their letters; empty where it has nothing."""
    points = [
        (line.side, point)
        for line in lane.lines
        for point in line.points
        if number is not None and point.visit == number
    ]
    if points and not any(point.is_reported for _, point in points):
        return tr("not reported")
    return "  ".join(
        (f"{side.letter} " if side is not None and len(points) > 1 else "")
        + (value_in_words(point.value, lane) + unit if point.is_reported else "\N{EN DASH}")
        for side, point in points
    )


def _counted(condition: str, visits: Sequence[CourseVisit], goals: Sequence[Goal], *, has_choice: bool) -> str:
    """The condition, how many visits have it, and goals that are not seen below."""
    count = conditions_of_visits(visits).get(condition, 0)
    stated = [condition_in_words(condition)] if condition and not has_choice else []
    stated += [tr_n("{count} visit", "{count} visits", count).format(count=count)] if count else []
    unseen = without_lane(goals) if any(visit.course is not None for visit in visits) else held(goals)
    return ", ".join([*stated, *map(goal_in_words, unseen)])

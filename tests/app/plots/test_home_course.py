"""The course beside the list of patients: read by keys and ears, no word cut at any size, and quiet about deleting."""

import datetime
from dataclasses import replace
from uuid import UUID

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.home.patients.home_page import PATIENT, HomePage
from app.home.patients.patient_panel import SESSION_ROW
from app.plots.course import CourseCard
from app.summary.course_lanes import CourseVisit
from app.summary.course_words import NextStep
from app.theme.notifier import ThemeNotifier
from app.widgets.text import Text
from core.goals import Goal, GoalOf
from core.timed.protocols import TimedProtocol
from tests.app.course_material import course, timed
from tests.app.home.course_library import SHOES, STICK, VISITS
from tests.app.home.patients.test_home_page import patient, session
from tests.app.room import words_cut


@pytest.fixture
def page(qtbot: QtBot, look: ThemeNotifier) -> HomePage:
    page = HomePage(look)
    page.set_room(1064)
    page.resize(1064, 728)
    qtbot.addWidget(page)
    page.show_patients([patient(158), patient(147)])
    page.show_patient("P-0158", "1961, female · left affected · left knee replaced")
    lines = [session(number, "Shoes; Shoes, stick", "report not saved") for number in range(5)]
    page.show_sessions(lines, VISITS, NextStep("write the report for 14 Nov.", "Open", UUID(int=4)))
    with qtbot.waitExposed(page):
        page.show()
    return page


def stated(card: CourseCard) -> list[str]:
    return [text.text() for text in card.findChildren(Text) if text.isVisible() and text.text()]


def test_what_has_changed_is_beside_the_lanes(page: HomePage) -> None:
    found = stated(page.panel.course)
    assert "Walking speed" in found
    assert "1.12\N{NO-BREAK SPACE}m/s" in found
    assert "+0.41 since 20 Jun" in found
    assert "beyond error (0.18)" in found
    assert "since last visit +0.06, within error" in found
    assert "49°" in found
    assert page.panel.count.text() == "5 visits · Shoes, stick: 3"
    assert page.panel.next.text() == "Next: write the report for 14 Nov."


def test_one_condition_is_shown_by_itself(page: HomePage) -> None:
    choice = page.panel.condition
    assert [choice.itemText(k) for k in range(choice.count())] == ["All conditions", SHOES, STICK]
    choice.setCurrentIndex(2)
    assert {line.condition for lane in page.panel.course.lanes for line in lane.lines} == {STICK}
    assert "on 22 Aug" in stated(page.panel.course)  # its last visit is not the patient's
    choice.setCurrentIndex(1)
    assert "on 22 Aug" not in stated(page.panel.course)


def test_keys_go_from_visit_to_visit_and_enter_opens_it(qtbot: QtBot, page: HomePage) -> None:
    card = page.panel.course
    card.setFocus()
    QTest.keyClick(card, Qt.Key.Key_Left)
    assert card.number == 4
    QTest.keyClick(card, Qt.Key.Key_Left)
    assert card.number == 3
    with qtbot.waitSignal(page.session_opened) as reported:
        QTest.keyClick(card, Qt.Key.Key_Return)
    assert reported.args == [UUID(int=3)]
    for _ in range(9):
        QTest.keyClick(card, Qt.Key.Key_Left)
    assert card.number == 0
    assert card.accessibleDescription().startswith(
        "Walking speed, Shoes: 0.71 metres per second on 20 Jun, 0.84 metres per second on 11 Jul"
    )


def test_a_click_opens_the_visit_under_it(qtbot: QtBot, page: HomePage) -> None:
    plot = next(iter(page.panel.course.rows.values())).plot
    at = QPoint(round(plot.x_of(2)), plot.height() // 2)
    with qtbot.waitSignal(page.session_opened) as reported:
        QTest.mouseClick(plot, Qt.MouseButton.LeftButton, pos=at)
    assert reported.args == [UUID(int=2)]


def test_what_is_next_is_opened(qtbot: QtBot, page: HomePage) -> None:
    with qtbot.waitSignal(page.session_opened) as reported:
        QTest.mouseClick(page.panel.go, Qt.MouseButton.LeftButton)
    assert reported.args == [UUID(int=4)]
    page.panel.show_next(NextStep("the last visit was 9 weeks ago."))
    assert not page.panel.go.isVisible()
    page.panel.show_next(None)
    assert not page.panel.next.isVisible()


def test_visits_that_are_not_computed_are_computed_on_wish(qtbot: QtBot, page: HomePage) -> None:
    card = page.panel.course
    assert not card.compute.isVisible()
    visits = [*VISITS[:-1], CourseVisit(VISITS[-1].id, VISITS[-1].day, None)]
    page.show_sessions((), visits)
    assert card.compute.isVisible()
    assert "1 visit is not calculated yet." in card.note.text()
    with qtbot.waitSignal(page.computing_requested):
        QTest.mouseClick(card.compute, Qt.MouseButton.LeftButton)


def test_without_a_visit_there_is_no_course(page: HomePage) -> None:
    page.show_sessions(())
    assert not page.panel.course.isVisible()
    assert not page.panel.condition.isVisible()


@pytest.mark.qt_log_ignore("This plugin does not support", extend=True)  # offscreen has no popups of its own
def test_deleting_is_asked_for_in_a_menu_and_by_its_key(qtbot: QtBot, page: HomePage) -> None:
    menu = page.panel.menu
    words = [action.text() for action in menu.actions()]
    assert words == ["Analyse sessions again", "Delete session", "Delete patient"]
    assert not page.panel.delete_session.isEnabled()
    page.sessions.choose(1)
    assert page.panel.delete_session.isEnabled()
    with qtbot.waitSignal(page.session_deleted) as reported:
        page.panel.delete_session.trigger()
    assert reported.args == [UUID(int=1)]
    with qtbot.waitSignal(page.patient_deleted):
        page.panel.delete_patient.trigger()
    QTest.mouseClick(page.panel.more, Qt.MouseButton.LeftButton)
    assert menu.isVisible()
    menu.close()


def test_where_there_is_little_room_the_list_or_the_patient_is_in_sight(page: HomePage) -> None:
    assert page.search.isVisible()
    assert page.panel.isVisible()
    assert not page.view.isVisible()
    page.set_room(896, is_compact=True)
    assert page.search.isVisible()
    assert not page.panel.isVisible()
    place = page.patients.visualRect(page.patients.cells.index(1, 0)).center()
    QTest.mouseClick(page.patients.viewport(), Qt.MouseButton.LeftButton, pos=place)
    assert page.panel.isVisible()
    assert not page.search.isVisible()
    assert [segment.text() for segment in page.view.segments] == ["Patients", "P-0158"]
    page.set_room(1064)
    assert page.search.isVisible()
    assert page.panel.isVisible()


@pytest.mark.parametrize(
    ("width", "height", "scale"),
    [(1064, 728, 1.0), (896, 528, 1.0), (1680, 1008, 1.0), (1792, 1056, 2.0), (520, 900, 1.0)],
)
@pytest.mark.parametrize("is_empty", [False, True])
def test_no_word_is_cut_at_any_size(
    page: HomePage, look: ThemeNotifier, qapp: QApplication, width: int, height: int, scale: float, is_empty: bool
) -> None:
    look.set_scale(scale)
    page.set_room(width / scale, is_compact=height / scale < 720)
    if is_empty:
        page.show_patients(())
    elif not page.panel.isVisible():
        page.view.choose(PATIENT)
    page.resize(width, max(height, page.minimumSizeHint().height()))
    for _ in range(3):
        qapp.processEvents()
    page.resize(width, max(height, page.minimumSizeHint().height()))
    for _ in range(3):
        qapp.processEvents()
    assert page.minimumSizeHint().width() <= width
    assert words_cut(page) == []
    look.set_scale(1.0)


def test_a_goal_is_beside_its_lane_with_how_the_last_visit_is_to_it(page: HomePage) -> None:
    early, late = (
        Goal("speed_m_s", GoalOf.WALK, 1.05, datetime.date.fromisoformat(day), "H. Keller")
        for day in ("2026-10-03", "2026-11-14")
    )
    page.panel.show_course(VISITS, [early])
    found = stated(page.panel.course)
    assert f"{3 * chr(0xB7)} goal 1.05\N{NO-BREAK SPACE}m/s" in found
    assert "reached; the difference is within measurement error" in found
    page.panel.show_course(VISITS, [late])  # agreed on the day of the last visit
    assert "reached; the difference is within measurement error" not in stated(page.panel.course)
    page.panel.show_course(VISITS, [replace(early, ended=early.agreed)])
    assert not any("goal" in one for one in stated(page.panel.course))


def test_lanes_of_other_measures_come_and_go_with_their_goals(page: HomePage, qapp: QApplication) -> None:
    card = page.panel.course
    day = datetime.date(2026, 6, 20)
    page.panel.show_course(VISITS, [Goal("stride_length_m", GoalOf.LEFT, 1.3, day)])
    qapp.processEvents()  # what is new comes with the next layout
    assert {"Stride length", "Walking speed"} <= set(stated(card))
    assert "Stance L \N{MINUS SIGN} R" not in stated(card)
    assert [row.label.y() for row in card.rows.values()] == sorted(row.label.y() for row in card.rows.values())
    assert len(card.rows) == 3
    page.panel.show_course(VISITS)
    assert "Stride length" not in stated(card)
    many = [
        Goal(column, GoalOf.LEFT, 20.0, day)
        for column in ("knee_range_deg", "knee_while_loading_deg", "ankle_push_off_deg", "ankle_rocker_deg")
    ]
    page.panel.show_course(VISITS, [*many, Goal("ankle_range_deg", GoalOf.LEFT, 25.0, day)])
    assert len(card.rows) == 4
    assert "Ankle range of motion, left: at least 25°" in page.panel.count.text()


def test_timed_tests_have_a_course_of_their_own_where_there_are_some(qtbot: QtBot, page: HomePage) -> None:
    panel = page.panel
    assert not panel.shown.isVisible()
    tests = [course((timed(TimedProtocol.UP_AND_GO, time_s=time_s), SHOES)) for time_s in (30.0, 24.0)]
    visits = [replace(one, course=found) for one, found in zip(VISITS[-2:], tests, strict=True)]
    page.show_sessions([session(0, "Shoes", "")], visits)
    assert panel.shown.isVisible()
    assert "Walking speed" in stated(panel.course)
    panel.shown.focus()
    QTest.keyClick(panel.shown.segments[0], Qt.Key.Key_Right)
    qtbot.waitUntil(lambda: "Timed Up and Go" in stated(panel.course))
    found = stated(panel.course)
    assert "24.0\N{NO-BREAK SPACE}s" in found
    assert "not judged" in found
    assert "Walking speed" not in found
    page.show_sessions([session(0, "Shoes", "")], VISITS)  # another patient, without a test
    assert not panel.shown.isVisible()
    qtbot.waitUntil(lambda: "Walking speed" in stated(panel.course))


def test_the_first_sessions_are_whole_however_many_rows_their_words_take(page: HomePage) -> None:
    long = "; ".join(f"Alignment {letter}, carbon foot" for letter in "ABCD")
    page.show_sessions([session(number, long, "report not saved") for number in range(5)], VISITS)
    heights = [page.panel.sessions.rowHeight(row) for row in range(2)]
    assert page.panel.sessions.minimumHeight() == sum(heights) > 2 * SESSION_ROW


def test_sessions_that_come_by_themselves_are_stated_to(page: HomePage) -> None:
    page.show_sessions([])
    assert page.panel.none_yet.text() == "No sessions yet."
    page.panel.say_none_yet(is_awaited=True)
    assert page.panel.none_yet.text() == "Visits of this patient are being recorded and will appear here."

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
from app.home.patients.patient_panel import VISIT_ROW
from app.plots.course import CourseCard
from app.summary.course_lanes import CourseVisit
from app.summary.course_words import NextKind, NextStep, last_in_words
from app.summary.progress_words import Arrow
from app.theme.current import set_scale
from app.widgets.change_arrow import ChangeArrow
from app.widgets.line_list import SessionLine
from app.widgets.text import Text
from core.goals import Goal, GoalOf
from core.timed.protocols import TimedProtocol
from tests.app.accessibility.accessible_tree import tab_stops, wrong_hearing
from tests.app.course_material import course, timed
from tests.app.home.course_library import SHOES, STICK, VISITS
from tests.app.home.patients.test_home_page import patient, session
from tests.app.room import settle, words_cut

STEP = NextStep(NextKind.REPORT, "Write report of 14 Nov", "Not written yet. Measured 14 Nov 2026.", VISITS[4].id)


@pytest.fixture
def page(qtbot: QtBot) -> HomePage:
    page = HomePage()
    page.set_room(1064)
    page.resize(1064, 728)
    qtbot.addWidget(page)
    page.show_patients([patient(158), patient(147)])
    page.show_patient("P-0158", "1961, female · left affected · left knee replaced")
    lines = [session(4 - number, "Shoes; Shoes, stick", "Report pending") for number in range(5)]
    page.show_sessions(lines, VISITS, STEP)
    with qtbot.waitExposed(page):
        page.show()
    return page


def stated(card: CourseCard) -> list[str]:
    return [text.text() for text in card.findChildren(Text) if text.isVisible() and text.text()]


def test_what_has_changed_is_a_sentence_and_beside_each_lane(page: HomePage) -> None:
    found = stated(page.panel.course)
    assert {"Walking speed", "Knee flexion, stance to swing", "Stance symmetry, L \N{MINUS SIGN} R"} <= set(found)
    assert {"1.12", "m/s", "+0.41 since 20 Jun", "49°", "+11° since 20 Jun", "points"} <= set(found)
    arrows = [one.arrow for one in page.panel.course.findChildren(ChangeArrow)]
    filled, outlined = Arrow(is_up=True, is_filled=True), Arrow(is_up=True, is_filled=False)
    assert arrows == [filled, filled, outlined]  # of stance within error
    assert page.panel.sentence.text() == "Since 20 June: knee +11°, speed +0.41\N{NO-BREAK SPACE}m/s."
    assert page.panel.second.text().startswith("Both beyond measurement error.")
    assert page.panel.count.text() == "5 visits"


def test_the_change_and_the_visits_are_of_the_condition_that_is_chosen(page: HomePage) -> None:
    choice = page.panel.condition
    assert [choice.itemText(k) for k in range(choice.count())] == [SHOES, STICK]
    assert [value_of(page, k) for k in range(5)] == ["1.12", "1.06", "0.97", "0.84", "0.71"]
    choice.setCurrentIndex(1)
    assert {line.condition for lane in page.panel.course.lanes for line in lane.lines} == {STICK}
    assert page.panel.sentence.text().startswith("Since 20 June: ")
    assert [value_of(page, k) for k in range(5)] == ["", "", "1.03", "0.90", "0.77"]
    assert page.panel.count.text() == "3 visits"


def test_a_visit_has_the_values_that_progress_has(page: HomePage) -> None:
    speed, knee, _ = page.panel.course.lanes
    line = page.sessions.lines[0]
    assert isinstance(line, SessionLine)
    assert line.speed == f"{last_in_words(speed, speed.changes[0])}\N{NO-BREAK SPACE}m/s"
    assert line.knee == last_in_words(knee, knee.changes[0])


def value_of(page: HomePage, row: int) -> str:
    line = page.sessions.lines[row]
    assert isinstance(line, SessionLine)
    return line.speed.removesuffix("\N{NO-BREAK SPACE}m/s")


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
        "Walking speed: 0.71 metres per second on 20 Jun, 0.84 metres per second on 11 Jul"
    )


def test_a_click_opens_the_visit_under_it(qtbot: QtBot, page: HomePage) -> None:
    plot = next(iter(page.panel.course.rows.values())).plot
    at = QPoint(round(plot.x_of(2)), plot.height() // 2)
    with qtbot.waitSignal(page.session_opened) as reported:
        QTest.mouseClick(plot, Qt.MouseButton.LeftButton, pos=at)
    assert reported.args == [UUID(int=2)]


def test_what_is_next_is_shown_with_its_reason_and_is_taken(qtbot: QtBot, page: HomePage) -> None:
    panel = page.panel
    assert (panel.go.text(), panel.go.key) == ("Write report of 14 Nov", "W")
    assert panel.go.accessibleName() == "Write report of 14 Nov, Not written yet. Measured 14 Nov 2026."
    assert panel.reason.isVisible()
    with qtbot.waitSignal(panel.next_requested) as reported:
        QTest.mouseClick(panel.go, Qt.MouseButton.LeftButton)
    assert reported.args == [STEP]
    panel.show_next(None)
    assert not panel.go.isVisible()
    assert not panel.reason.isVisible()
    with qtbot.assertNotEmitted(panel.next_requested):
        panel.take_next()


def test_visits_that_are_not_computed_are_computed_on_wish(qtbot: QtBot, page: HomePage) -> None:
    card = page.panel.course
    assert not card.compute.isVisible()
    visits = [*VISITS[:-1], CourseVisit(VISITS[-1].id, VISITS[-1].day, None)]
    page.show_sessions((), visits)
    assert card.compute.isVisible()
    assert "1 visit is not calculated yet." in card.note.text()
    with qtbot.waitSignal(page.panel.course.computing_requested):
        QTest.mouseClick(card.compute, Qt.MouseButton.LeftButton)


def test_without_a_visit_there_is_no_course(page: HomePage) -> None:
    page.show_sessions(())
    assert not page.panel.course.isVisible()
    assert not page.panel.condition.isVisible()
    assert not page.panel.sentence.isVisible()
    assert page.panel.none_yet.text() == "No visit yet."


@pytest.mark.qt_log_ignore("This plugin does not support", extend=True)  # offscreen has no popups of its own
def test_deleting_is_asked_for_in_a_menu_and_by_its_key(qtbot: QtBot, page: HomePage) -> None:
    menu = page.panel.menu
    words = [action.text() for action in menu.actions() if action.isVisible()]
    assert words == ["Analyse sessions again", "Delete session", "Delete patient"]
    assert not page.panel.delete_session.isEnabled()
    page.sessions.choose(3)
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
def test_no_word_is_cut_at_any_size(page: HomePage, qapp: QApplication, width: int, height: int, scale: float) -> None:
    set_scale(scale)
    page.set_room(width / scale, is_compact=height / scale < 720)
    for is_empty in (False, True):
        if is_empty:
            page.show_patients(())
        elif not page.panel.isVisible():
            page.view.choose(PATIENT)
        for _ in range(2):
            page.resize(width, max(height, page.minimumSizeHint().height()))
            for _ in range(3):
                qapp.processEvents()
        assert page.minimumSizeHint().width() <= width
        assert words_cut(page) == []
    set_scale(1.0)


@pytest.mark.usefixtures("pseudo_language")
def test_a_change_longer_than_its_column_wraps(page: HomePage) -> None:
    assert words_cut(page.panel.course) == []
    assert any(one.height() > 1.5 * one.fontMetrics().height() for one in changes(page) if one.text().startswith("[+"))


def test_a_change_that_has_room_stays_in_one_line(page: HomePage) -> None:
    found = [one for one in changes(page) if "since" in one.text()]
    assert found
    assert all(one.height() < 1.5 * one.fontMetrics().height() for one in found)


def changes(page: HomePage) -> list[Text]:
    settle()
    return [one for row in page.panel.course.rows.values() for one in row.changes.findChildren(Text)]


def test_tab_and_screen_readers_go_through_the_patient_as_it_is_read(qtbot: QtBot, page: HomePage) -> None:
    page.show_sessions([session(1, "Shoes")], [*VISITS, replace(VISITS[0], id=UUID(int=9), course=None)], STEP)
    page.activateWindow()
    page.search.setFocus()
    qtbot.waitUntil(page.search.hasFocus)
    settle()
    stops = tab_stops(page)
    assert stops == [widget for widget in page.tab_order if widget.isVisible()]
    assert {page.panel.condition, page.panel.course.compute} <= set(stops)
    assert wrong_hearing(page) == []


def test_a_goal_is_in_the_second_line_where_it_was_agreed_before_the_visit(page: HomePage) -> None:
    early, late = (
        Goal("speed_m_s", GoalOf.WALK, 1.05, datetime.date.fromisoformat(day), "H. Keller")
        for day in ("2026-10-03", "2026-11-14")
    )
    page.panel.show_course(VISITS, [early])
    assert page.panel.second.text().endswith(" Speed goal reached, within error.")
    page.panel.show_course(VISITS, [replace(early, value=1.2)])
    assert page.panel.second.text().endswith(" Speed 0.08\N{NO-BREAK SPACE}m/s below its goal, within error.")
    page.panel.show_course(VISITS, [late])  # agreed on the day of the last visit
    assert "goal" not in page.panel.second.text()
    assert page.panel.course.lanes[0].goals == (late,)
    page.panel.show_course(VISITS, [replace(early, ended=early.agreed)])
    assert "goal" not in page.panel.second.text()


def test_lanes_of_other_measures_come_and_go_with_their_goals(page: HomePage, qapp: QApplication) -> None:
    card = page.panel.course
    day = datetime.date(2026, 6, 20)
    page.panel.show_course(VISITS, [Goal("stride_length_m", GoalOf.LEFT, 1.3, day)])
    qapp.processEvents()  # what is new comes with the next layout
    assert {"Stride length", "Walking speed"} <= set(stated(card))
    assert "Stance symmetry, L \N{MINUS SIGN} R" not in stated(card)
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
    assert {"24.0", "s"} <= set(found)
    assert not panel.course.findChildren(ChangeArrow) or not any(
        one.isVisible() for one in panel.course.findChildren(ChangeArrow)
    )
    assert "Walking speed" not in found
    page.show_sessions([session(0, "Shoes", "")], VISITS)  # another patient, without a test
    assert not panel.shown.isVisible()
    qtbot.waitUntil(lambda: "Walking speed" in stated(panel.course))


def test_all_visits_are_whole_and_it_is_the_panel_that_scrolls(
    qtbot: QtBot, page: HomePage, qapp: QApplication
) -> None:
    long = "; ".join(f"Alignment {letter}, carbon foot" for letter in "ABCDEFGH")
    page.show_sessions([session(number, long, "Report pending") for number in range(9)], VISITS)
    for _ in range(3):
        qapp.processEvents()
    table = page.panel.sessions
    heights = [table.rowHeight(row) for row in range(9)]
    assert table.height() >= sum(heights) > 9 * VISIT_ROW
    room = page.panel.parentWidget()
    assert room is not None
    assert page.panel.height() > room.height()
    page.activateWindow()
    table.setFocus()
    qtbot.waitUntil(table.hasFocus)
    QTest.keyClick(table, Qt.Key.Key_End)
    bottom = table.viewport().mapTo(room, table.visualRect(table.currentIndex()).bottomLeft()).y()
    assert 0 < bottom <= room.height()
    assert page.search.isVisible()  # the list stays


def test_sessions_that_come_by_themselves_are_stated_to(page: HomePage) -> None:
    page.show_sessions([])
    assert page.panel.none_yet.text() == "No visit yet."
    page.panel.say_none_yet(is_awaited=True)
    assert page.panel.none_yet.text() == "Visits of this patient are being recorded and will appear here."

"""Home with a patient's course: shown without evaluating anything, computed where it is missing, and what is next."""

import datetime
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.home.patients.reading import PatientReading, compute_courses, read_patient
from app.storage.audit import REPORT_FORMAT, about
from app.storage.database.ids import uuid7
from app.storage.exchange import import_session
from app.storage.library import DEMONSTRATOR, Library
from app.storage.opened import OpenedLibrary, open_library
from app.storage.stored import Action, StoredPatient
from app.summary.course_lanes import SPEED_LANE
from app.system.progress import nobody
from app.system.settings import Settings
from app.widgets.line_list import PatientLine, SessionLine
from app.workers.library_controller import LibraryController
from core.goals import GOAL_COLUMNS, Goal, GoalOf
from core.session import Patient
from tests.app.home.course_library import PASSPHRASE, add_visit, course_of_visit, make_course_library
from tests.simulated import WALK_OF_ONE_LEG, session_of


@pytest.fixture(scope="module")
def untouched(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_course_library(tmp_path_factory.mktemp("course"), missing=frozenset({1}))


@pytest.fixture
def home(qtbot: QtBot, qapp: QApplication, controller: LibraryController, untouched: Path, tmp_path: Path) -> Home:
    settings = Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))
    home = Home(controller, settings)
    home.resize(1280, 800)
    qtbot.addWidget(home)
    home.show()
    folder = shutil.copytree(untouched, tmp_path / "library")
    with qtbot.waitSignal(controller.opened) as known:
        controller.open(lambda holder: holder.open(folder, PASSPHRASE))
    home.show_library((known.args or [])[0])
    qtbot.waitUntil(lambda: bool(home.page.sessions.lines))
    return home


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[OpenedLibrary]:
    """Of no operator's own."""
    folder = tmp_path / "opened"
    with OpenedLibrary(Library.create(folder, None, DEMONSTRATOR), folder, None) as library:
        yield library


def test_the_course_of_the_patient_who_is_chosen_is_beside_the_list_which_has_the_last_change(
    qtbot: QtBot, home: Home
) -> None:
    def stated() -> list[str]:
        return [line.last for line in home.page.patients.lines if isinstance(line, PatientLine)]

    qtbot.waitUntil(lambda: stated()[0] == "knee +11° since 20 Jun")
    assert stated()[1:] == ["0 sessions"] * 3
    card = home.page.panel.course
    assert [visit.course is not None for visit in card.visits] == [True, False, True, True, True]
    assert "Walking speed: 0.71 metres per second on 20 Jun" in card.accessibleDescription()
    assert "1 visit is not calculated yet." in card.note.text()
    lines = [line for line in home.page.sessions.lines if isinstance(line, SessionLine)]
    assert [(line.speed, line.knee, line.state) for line in lines] == [
        ("1.12\N{NO-BREAK SPACE}m/s", "49°", "Report pending"),
        ("1.06\N{NO-BREAK SPACE}m/s", "47°", "Report written"),
        ("0.97\N{NO-BREAK SPACE}m/s", "44°", "Report written"),
        ("", "", "Report written"),
        ("0.71\N{NO-BREAK SPACE}m/s", "38°", "Report written"),
    ]
    assert home.page.panel.sentence.text() == "Since 20 June: knee +11°, speed +0.41\N{NO-BREAK SPACE}m/s."
    assert home.page.panel.go.text() == "Write report of 14 Nov"
    other = next(line.id for line in home.page.patients.lines if line.id != home.page.patient_id)
    home.page.patients.choose_line(other)
    assert not card.isVisible()  # at once: nobody else's course is under this code
    qtbot.waitUntil(lambda: home.page.panel.none_yet.isVisible())
    assert not card.isVisible()


def test_w_opens_the_report_step_of_the_visit_but_in_the_search_it_is_typed(qtbot: QtBot, home: Home) -> None:
    home.activateWindow()
    qtbot.waitUntil(home.isActiveWindow)
    home.page.search.setFocus()
    latest = home.page.sessions.lines[0].id
    with qtbot.assertNotEmitted(home.report_requested):
        QTest.keyClick(home.page.search, Qt.Key.Key_W)
    assert home.page.search.text() == "w"
    home.page.search.clear()
    qtbot.waitUntil(home.page.panel.go.isVisible)
    with qtbot.waitSignal(home.report_requested) as reported:
        QTest.keyClick(home.page.search, Qt.Key.Key_W, Qt.KeyboardModifier.AltModifier)
    assert reported.args == [latest]
    home.page.patients.setFocus()
    with qtbot.waitSignal(home.report_requested) as reported:
        QTest.keyClick(home.page.patients, Qt.Key.Key_W)
    assert reported.args == [latest]


def test_nothing_of_a_course_is_left_for_whoever_comes_next(home: Home) -> None:
    home.clear()
    assert home.page.panel.course.visits == ()
    assert not home.page.panel.course.isVisible()
    assert not home.page.panel.go.isVisible()
    assert not home.page.panel.sentence.isVisible()


def test_visits_that_cannot_be_computed_are_stated_and_the_others_stay(qtbot: QtBot, home: Home) -> None:
    """Of the fixture no samples were recorded: its journal is gone."""
    home.page.panel.course.compute.click()
    assert home.current is home.working
    qtbot.waitUntil(lambda: home.current is home.page)
    assert home.banner.text.startswith("1 visit could not be calculated. Open the visit to see why.")
    qtbot.waitUntil(lambda: len(home.page.panel.course.visits) == 5)
    assert home.page.panel.course.visits[1].course is None


def test_computing_can_be_stopped(qtbot: QtBot, home: Home) -> None:
    home.page.panel.course.compute.click()
    home.working.stop.click()
    assert home.current is home.page
    assert home.banner.text.startswith("Stopped. Visits calculated so far stay in Progress.")
    qtbot.waitUntil(lambda: len(home.page.panel.course.visits) == 5)


def reading(opened: OpenedLibrary) -> PatientReading:
    (patient,) = opened.library.patients.search()
    return read_patient(opened, patient.id)


def test_a_visit_is_computed_and_a_change_takes_it_out_of_the_course(opened: OpenedLibrary) -> None:
    known = replace(session_of(WALK_OF_ONE_LEG), patient=Patient(code="DEMO-1"), started="2026-06-20T09:00:00")
    session_id = import_session(opened, known, nobody).session_id
    now = day_and_time("2026-06-25T09:00:00")
    assert [visit.course for visit in reading(opened).visits(now)] == [None]
    assert compute_courses(opened, [session_id], nobody) == 0
    (visit,) = reading(opened).visits(now)
    assert visit.course is not None
    assert visit.course.conditions[0].strides > 0
    walk = opened.library.sessions.get(session_id).recordings[1]
    opened.library.recordings.change(walk, replace(walk.details, condition="stick"))
    assert [visit.course for visit in reading(opened).visits(now)] == [None]


def test_a_session_that_is_gone_is_counted(opened: OpenedLibrary) -> None:
    assert compute_courses(opened, [uuid7()], nobody) == 1


def day_and_time(moment: str) -> datetime.datetime:
    return datetime.datetime.fromisoformat(moment).astimezone()


def test_what_is_next_of_a_patient(tmp_path: Path) -> None:
    """In the order of gravity; of the latest visit only."""
    with open_library(make_course_library(tmp_path, visits=0), PASSPHRASE) as opened:
        library = opened.library
        (patient,) = library.patients.search("P-0158")
        now = day_and_time("2026-07-12T09:00:00")

        def stated() -> str:
            step = read_patient(opened, patient.id).next_step(now)
            return f"{step.verb}: {step.reason}" if step is not None else ""

        assert stated() == ""
        first = add_visit(library, patient.id, 0, course_of_visit(0, is_knee_not_reported=True))
        assert stated() == "Review visit of 20 Jun: Left knee: not reported. Repeat at the next walk."
        second = add_visit(library, patient.id, 1, course_of_visit(1))
        assert stated() == "Write report of 11 Jul: Not written yet. Measured yesterday."
        library.audit.note(Action.EXPORT, about("session", second), format=REPORT_FORMAT, is_document=True)
        assert stated() == ""
        now = day_and_time("2026-09-12T09:00:00")
        assert stated() == "Begin next visit: Last visit 9 weeks ago."
        assert first != second


def test_a_report_is_written_once_its_export_has_ended_well(opened: OpenedLibrary) -> None:
    audit, ids = opened.library.audit, [uuid7(), uuid7()]
    subject = about("session", ids[0])
    assert audit.reported(ids) == frozenset()
    with audit.exporting(subject, format=REPORT_FORMAT, is_document=False):
        """Files only."""
    assert audit.reported(ids) == frozenset()
    with pytest.raises(OSError, match="full"), audit.exporting(subject, format=REPORT_FORMAT, is_document=True):
        raise OSError("the disk is full")
    assert audit.reported(ids) == frozenset()
    with audit.exporting(subject, format=REPORT_FORMAT, is_document=True):
        """All is well."""
    assert audit.reported(ids) == {ids[0]}
    audit.note(Action.EXPORT, about("session", ids[1]), format=REPORT_FORMAT)  # as earlier versions noted it
    audit.note(Action.EXPORT, about("session", ids[1]), format="fhir")
    assert audit.reported(ids) == set(ids)
    assert audit.reported([]) == frozenset()


def wait_for_goals(qtbot: QtBot, home: Home, count: int) -> None:
    page = home.goals.page
    qtbot.waitUntil(lambda: sum(row.take_back is not None for row in page.rows) == count)


def test_a_goal_is_agreed_by_keys_is_in_the_course_and_is_taken_back(qtbot: QtBot, home: Home) -> None:
    """From the patient's panel to the library and back; by the time it ends, the history has both."""
    panel = home.page.panel
    QTest.keyClick(panel.goals, Qt.Key.Key_Return)
    page = home.goals.page
    assert home.current is page
    for _ in range(GOAL_COLUMNS.index("speed_m_s")):
        QTest.keyClick(page.measure, Qt.Key.Key_Down)
    QTest.keyClicks(page.value.line_edit, "1.2")
    QTest.keyClick(page.value.line_edit, Qt.Key.Key_Return)
    wait_for_goals(qtbot, home, 1)
    assert page.value.text == ""
    assert page.rows[0].about.text().endswith(", H. Keller")
    home.bar.back_pressed.emit()
    qtbot.waitUntil(lambda: any(lane.goals for lane in panel.course.lanes))
    speed = panel.course.lanes[0]
    assert (speed.kind, speed.goal_values) == (SPEED_LANE, [1.2])
    assert "Goal: Walking speed: at least 1.20" in panel.course.accessibleDescription()
    panel.goals.click()
    wait_for_goals(qtbot, home, 1)
    take_back = page.rows[0].take_back
    assert take_back is not None
    QTest.keyClick(take_back, Qt.Key.Key_Return)
    wait_for_goals(qtbot, home, 0)
    assert [row.key for row in page.rows] == [("speed_m_s", GoalOf.WALK)]
    home.bar.back_pressed.emit()
    qtbot.waitUntil(lambda: not any(lane.goals for lane in panel.course.lanes))


def test_a_goal_that_another_changed_meanwhile_is_not_written_over(
    qtbot: QtBot, home: Home, controller: LibraryController
) -> None:
    panel, page = home.page.panel, home.goals.page
    panel.goals.click()
    qtbot.waitUntil(lambda: page.none_yet.isVisible())
    patient = home.patients.patient
    assert patient is not None
    theirs = Goal("speed_m_s", GoalOf.WALK, 0.9, datetime.date(2026, 1, 5), "B. Berger")

    def change(opened: OpenedLibrary) -> StoredPatient:
        held = opened.library.patients.get(patient.id)
        return opened.library.patients.change(held, replace(held.details, goals=(theirs,)))

    controller.run(change, None, None, home)
    page.measure.setCurrentIndex(GOAL_COLUMNS.index("speed_m_s"))
    QTest.keyClicks(page.value.line_edit, "1.2")
    page.submit()
    qtbot.waitUntil(lambda: home.banner.isVisible())
    assert home.banner.text.startswith("Goal, Walking speed was changed in the meantime (H. Keller, ")
    assert page.rows[0].limit.text() == "at least 0.90\N{NO-BREAK SPACE}m/s"
    assert page.value.text == "1.2"  # what was typed stays


def test_goals_of_nobody_are_left_for_whoever_comes_next(qtbot: QtBot, home: Home) -> None:
    home.page.panel.goals.click()
    assert home.current is home.goals.page
    home.clear()
    assert home.goals.page.rows == []
    assert [lane.goals for lane in home.page.panel.course.lanes if lane.goals] == []


def test_a_reached_goal_is_next_and_leads_to_the_goals(tmp_path: Path) -> None:
    """Agreed before the latest visit; one agreed on its day is not stated to be reached."""
    with open_library(make_course_library(tmp_path, visits=0), PASSPHRASE) as opened:
        library = opened.library
        (patient,) = library.patients.search("P-0158")
        visit = add_visit(library, patient.id, 1, course_of_visit(1))
        library.audit.note(Action.EXPORT, about("session", visit), format=REPORT_FORMAT, is_document=True)
        now = day_and_time("2026-07-12T09:00:00")

        def stated(agreed: str, speed_m_s: float) -> str:
            goal = Goal("speed_m_s", GoalOf.WALK, speed_m_s, datetime.date.fromisoformat(agreed))
            held = library.patients.get(patient.id)
            library.patients.change(held, replace(held.details, goals=(goal,)))
            step = read_patient(opened, patient.id).next_step(now)
            return f"{step.verb}: {step.reason}" if step is not None else ""

        assert stated("2026-07-10", 0.80).startswith("Agree next goal: Goal reached: Walking speed: at least 0.80")
        assert stated("2026-07-11", 0.80) == ""
        assert stated("2026-07-10", 0.90) == ""

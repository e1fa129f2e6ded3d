"""What came of a test at an earlier visit is named before the next one, and beside what comes of it."""

import datetime
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from uuid import UUID

import pytest
from pytestqt.qtbot import QtBot

from app.storage.opened import OpenedLibrary
from app.summary.course import Course, timed_tests_of
from app.summary.course_lanes import CourseVisit, LaneKind, lanes
from app.widgets.text import Text
from app.wizard.resuming import current_course_key
from app.wizard.visit import Visit
from app.wizard.walking.timed_chooser import TimedChooser
from app.wizard.walking.timed_control import TimedControl
from app.wizard.walking.timed_result import TimedAttempt, TimedResult, TimedResultView
from app.workers.library_controller import LibraryController
from core.alignment import AlignmentChange
from core.session import Session
from core.timed.measures import COLUMNS
from core.timed.protocols import PlannedTest, TimedProtocol
from tests.app.course_material import analysis, course, recordings, timed
from tests.app.library_answers import asked
from tests.core.timed.built_tests import built_test

SHOES, STICK = "Shoes", "Shoes, stick"
UP, TEN = TimedProtocol.UP_AND_GO, TimedProtocol.TEN_METRES


def with_visits(*days: tuple[str, float, str]) -> Callable[[OpenedLibrary], UUID]:
    """Earlier visits of DEMO-1 with an up and go, each of a day, a time and a condition; gives the latest session."""

    def add(opened: OpenedLibrary) -> UUID:
        library = opened.library
        (patient,) = [one for one in library.patients.search() if one.details.code == "DEMO-1"]
        for day, time_s, condition in days:
            visit = library.sessions.create(patient.id, Session((), started=f"{day}T09:00:00"))
            found = course((timed(UP, time_s=time_s), condition))
            library.courses.keep(visit.id, current_course_key(library.sessions.get(visit.id)), found)
        return library.sessions.create(patient.id, Session((), started="2026-11-20T09:00:00")).id

    return add


def read_control(qtbot: QtBot, visit: Visit, session_id: object) -> TimedControl:
    """Of a session that is taken up, once the earlier visits are read."""
    assert isinstance(session_id, UUID)
    with qtbot.waitSignal(visit.resumed):
        visit.resume(session_id)
    control = TimedControl(visit, visit)
    with qtbot.waitSignal(control.changed):
        control.earlier.read()
    return control


def test_the_latest_earlier_result_under_the_same_condition_is_named(
    qtbot: QtBot, controller: LibraryController, visit: Visit
) -> None:
    days = (("2026-09-01", 30.0, SHOES), ("2026-10-03", 11.4, SHOES), ("2026-10-20", 9.0, STICK))
    later = ("2026-12-01", 1.0, SHOES)
    session_id = asked(qtbot, controller, with_visits(*days, later))
    assert isinstance(session_id, UUID)
    with qtbot.waitSignal(visit.resumed):
        visit.resume(session_id)
    control = TimedControl(visit, visit)
    assert control.before(SHOES) == {}
    with qtbot.waitSignal(control.changed):
        control.earlier.read()
    assert control.before(SHOES) == {UP: "3 Oct: 11.4\N{NO-BREAK SPACE}s"}
    assert control.before(STICK) == {UP: "20 Oct: 9.0\N{NO-BREAK SPACE}s"}
    assert control.before("Barefoot") == {}


def test_the_chooser_names_it_with_its_test_and_with_no_other(qtbot: QtBot) -> None:
    chooser = TimedChooser()
    qtbot.addWidget(chooser)
    chooser.show_before({UP: "3 Oct: 11.4 s"})
    assert chooser.itemText(1 + list(TimedProtocol).index(UP)) == "Timed Up and Go · 3 Oct: 11.4 s"
    chooser.show_before({TEN: "3 Oct: 1.00 m/s"})
    assert chooser.itemText(1 + list(TimedProtocol).index(UP)) == "Timed Up and Go"


def results(*times_s: float) -> TimedResultView:
    """The result of a 10-metre walk after visits with as many."""
    view, kind = TimedResultView(), LaneKind(COLUMNS[TEN])
    visits = [
        CourseVisit(UUID(int=number), datetime.date(2026, 6 + number, 20), this_visit(time_s))
        for number, time_s in enumerate(times_s)
    ]
    (lane,) = lanes(visits, SHOES, (), (kind,))
    attempt = TimedAttempt("walk 1", PlannedTest(TEN), built_test(TEN, time_s=times_s[-1]), is_kept=True)
    view.show_state(TimedResult([attempt], ["A Shoes"], visits, lane if len(visits) > 1 else None))
    return view


def this_visit(time_s: float) -> Course:
    walk = timed(TEN, time_s=time_s)
    return Course(None, timed_tests_of(analysis(walk), recordings((walk, SHOES))))


def test_the_result_shows_what_has_changed_and_draws_it(qtbot: QtBot) -> None:
    view = results(14.1, 9.4, 8.9)
    qtbot.addWidget(view)
    view.show()
    space, error = "\N{NO-BREAK SPACE}", "error (0.18)"
    assert view.first.text() == "10-metre walk: 1.12 m/s, 8.9 s."
    assert view.then.text() == (
        f"+0.06{space}m/s since 20 Jul, within {error}. +0.41{space}m/s since 20 Jun, beyond {error}."
    )
    assert view.course.isVisible()
    assert "+0.41 since 20 Jun" in [text.text() for text in view.course.findChildren(Text)]


def test_a_test_after_the_return_to_an_alignment_is_beside_those_of_that_alignment(
    qtbot: QtBot, controller: LibraryController, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    session_id = asked(qtbot, controller, with_visits(("2026-10-03", 11.4, "Alignment A")))
    control = read_control(qtbot, visit, session_id)
    walk = timed(UP, time_s=9.0)
    again = AlignmentChange("Alignment B", (), returns_to="Alignment A")
    (stated,) = recordings((walk, "Alignment A again"))
    walked = replace(stated, alignment=again, test=PlannedTest(UP))
    monkeypatch.setattr(visit.evaluation, "analysis", analysis(walk))
    monkeypatch.setattr(visit.evaluation, "session", Session((walked,)))
    monkeypatch.setattr(visit.recordings, "every", [SimpleNamespace(details=walked)])
    result = control.result()
    assert result is not None
    assert result.lane is not None
    assert len(result.visits) == 2


def test_a_first_test_has_no_course_and_nothing_is_stated_of_a_change(qtbot: QtBot) -> None:
    view = results(8.9)
    qtbot.addWidget(view)
    view.show()
    assert not view.course.isVisible()
    assert view.then.text() == ""


def test_a_test_that_was_broken_off_is_no_earlier_result(
    qtbot: QtBot, controller: LibraryController, visit: Visit
) -> None:
    session_id = asked(qtbot, controller, with_visits(("2026-10-03", 11.4, SHOES), ("2026-10-20", float("nan"), SHOES)))
    control = read_control(qtbot, visit, session_id)
    assert control.before(SHOES) == {UP: "3 Oct: 11.4\N{NO-BREAK SPACE}s"}
    assert control.result() is None  # of a session without a walk

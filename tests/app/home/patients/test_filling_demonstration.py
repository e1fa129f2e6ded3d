"""The demonstration fills beside the screen: each visit appears once it is ready, and nothing goes on for nobody."""

import datetime
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from dataclasses import replace
from typing import Any

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.demonstration.patients import ReportedOfWalk, SimulatedPatient, SimulatedVisit
from app.home.home import Home
from app.storage.opened import OpenedLibrary
from app.system.settings import Settings
from app.workers.library_controller import LibraryController
from core.session import Patient, Session
from devices.simulation.walker import Standing, Walk, WalkerSettings
from tests.app.home.home_library import delete_patient

STARTED = datetime.datetime(2026, 11, 20, 11, 20, tzinfo=datetime.UTC)
WALKED = WalkerSettings(recordings=(Standing(), Walk(strides=5)))


def visit(code: str, days_ago: int = 0) -> SimulatedVisit:
    return SimulatedVisit(
        code, STARTED - datetime.timedelta(days=days_ago), WALKED, {"walk 1": ReportedOfWalk("Shoes")}
    )


PATIENTS = (
    SimulatedPatient(Patient(code="DEMO-A"), (visit("DEMO-A", 30), visit("DEMO-A"))),
    SimulatedPatient(Patient(code="DEMO-B"), (visit("DEMO-B", 3),)),
)


class Held(Executor):
    """Does what it is given when it is given to, here; in the place of the processes."""

    def __init__(self, _count: int, _preloaded: tuple[str, ...]) -> None:
        self.waiting: list[tuple[Future[Any], Callable[[], Any]]] = []
        self.is_stopped = False
        HELD.append(self)

    def begin(self) -> None:
        """There is nothing to start."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self.waiting.append((future, lambda: fn(*args, **kwargs)))
        return future

    def go_on(self, fault: Exception | None = None) -> None:
        """Do the next, or let it fail."""
        future, call = self.waiting.pop(0)
        if fault is not None:
            future.set_exception(fault)
            return
        try:
            future.set_result(call())
        except Exception as error:  # whoever asks for the result gets it
            future.set_exception(error)

    def stop(self) -> None:
        self.is_stopped = True


HELD: list[Held] = []


@pytest.fixture(scope="module")
def session() -> Session:
    from app.demonstration.recording import record_visit

    return record_visit(visit("DEMO-A"))


@pytest.fixture
def home(
    qtbot: QtBot,
    qapp: QApplication,
    controller: LibraryController,
    settings: Settings,
    session: Session,
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[Home]:
    """In the demonstration's library of two patients, whose processes do nothing by themselves."""
    HELD.clear()
    monkeypatch.setattr("app.home.patients.demonstration.ProcessExecutor", Held)
    monkeypatch.setattr("app.home.patients.demonstration.processors", lambda: 2)
    monkeypatch.setattr("app.demonstration.patients.simulated_patients", lambda _now: PATIENTS)
    monkeypatch.setattr(
        "app.home.patients.demonstration.record_beside",
        lambda required: replace(session, started=required.started.isoformat(timespec="seconds")),
    )
    home = Home(controller, settings)
    home.resize(1280, 800)
    qtbot.addWidget(home)
    home.show()
    with qtbot.waitSignal(controller.opened) as reported:
        controller.open_demonstration()
    home.show_library((reported.args or [])[0])
    qtbot.waitUntil(lambda: home.page.patients.line is not None)
    yield home
    home.finish()


def ready(home: Home) -> tuple[int, int]:
    return home.filling.strip.done


def finish_one(qtbot: QtBot, home: Home, then: tuple[int, int]) -> None:
    """Let one visit be recorded and analysed."""
    (held,) = HELD
    before = len(held.waiting)
    held.go_on()
    qtbot.waitUntil(lambda: len(held.waiting) == before)  # its analysis waits now
    held.waiting.insert(0, held.waiting.pop())
    held.go_on()
    qtbot.waitUntil(lambda: ready(home) == then or not home.filling.is_busy)


@pytest.mark.endurance
def test_patients_are_there_at_once_and_each_visit_once_it_is_ready(qtbot: QtBot, home: Home) -> None:
    (held,) = HELD
    assert [line.words[0] for line in home.page.patients.lines] == ["DEMO-A", "DEMO-B"]
    assert ready(home) == (0, 3)
    assert len(held.waiting) == 2, "as many as there are processes"
    qtbot.waitUntil(lambda: "being recorded" in home.page.panel.none_yet.text())
    assert home.filling.strip.isVisible()
    assert home.filling.strip.words.text().endswith("0 of 3 are ready.")
    finish_one(qtbot, home, (1, 3))
    qtbot.waitUntil(lambda: len(home.page.sessions.lines) == 1)
    card = home.page.panel.course
    qtbot.waitUntil(lambda: [one.course is not None for one in card.visits] == [True])
    finish_one(qtbot, home, (2, 3))
    finish_one(qtbot, home, (3, 3))
    assert not home.filling.is_busy
    assert held.is_stopped
    assert not home.filling.strip.isVisible()
    assert not home.banner.isVisible()
    qtbot.waitUntil(lambda: len(home.page.panel.course.visits) == 2)


@pytest.mark.endurance
def test_what_fails_is_stated_and_the_others_are_made(qtbot: QtBot, home: Home) -> None:
    (held,) = HELD
    held.go_on(RuntimeError("a process was ended"))
    qtbot.waitUntil(lambda: len(held.waiting) == 2)
    finish_one(qtbot, home, (1, 3))
    finish_one(qtbot, home, (2, 3))
    qtbot.waitUntil(home.banner.isVisible)
    assert home.banner.text.startswith("1 visit could not be simulated.")
    qtbot.waitUntil(lambda: len(home.page.sessions.lines) == 1)


@pytest.mark.endurance
def test_a_visit_of_a_patient_who_was_deleted_meanwhile_stays_out(qtbot: QtBot, home: Home) -> None:
    (held,) = HELD
    delete_patient(qtbot, home)
    qtbot.waitUntil(lambda: len(home.page.patients.lines) == 1)
    held.go_on()
    held.go_on()
    qtbot.waitUntil(lambda: len(held.waiting) == 1)
    finish_one(qtbot, home, (1, 3))
    qtbot.waitUntil(home.banner.isVisible)
    assert home.banner.text.startswith("2 visits could not be simulated.")


def test_who_leaves_the_demonstration_ends_what_goes_on_for_it(
    qtbot: QtBot, home: Home, controller: LibraryController
) -> None:
    (held,) = HELD
    late = held.waiting[0]
    home.clear()
    assert held.is_stopped
    assert not home.filling.is_busy
    late[0].set_result(late[1]())  # what comes too late is nobody's
    asked: list[object] = []
    with qtbot.waitSignal(controller.opened) as reported:
        controller.open_demonstration()
    home.show_library((reported.args or [])[0])
    qtbot.waitUntil(lambda: home.page.patients.line is not None)
    assert len(HELD) == 2
    assert home.page.sessions.lines == ()
    assert asked == []


def test_a_library_of_ones_own_is_filled_by_nobody(qtbot: QtBot, home: Home) -> None:
    home.filling.stop()
    state = home.state
    assert state is not None
    own = OpenedLibrary(state.library.library, state.library.folder, object())  # type: ignore[arg-type]  # any key will do here
    HELD.clear()
    home.filling.begin(replace(state, library=own))
    assert HELD == []
    assert not home.filling.is_busy

"""What a station's window is reported: of a server that goes and comes back, of the others, of what waits here."""

import shlex
import shutil
import subprocess
import tempfile
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QObject
from pytestqt.qtbot import QtBot

from app.storage.clinic.handing_over import count_waiting
from app.storage.clinic.joining import join
from app.storage.clinic.station import Station
from app.storage.key_change import refuse_change
from app.storage.opened import OpenedLibrary
from app.storage.stored import LibraryError
from app.workers import library_watch
from app.workers.library_controller import LibraryController
from app.workers.library_state import Unlocked
from core.session import Patient, Session
from tests.app.storage.clinic.conftest import PASSPHRASE, OpenAt
from tests.app.storage.clinic.test_stations import record

pytestmark = pytest.mark.endurance  # each starts with an empty server


class Server:
    """A PostgreSQL of these tests' own, to be stopped as by a power cut, and started again."""

    def __init__(self, folder: Path) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it minds that a machine without desktop has no folder for sockets
            pgserver = pytest.importorskip("pgserver", reason="there is no PostgreSQL for this Python")
        self.url = pgserver.get_server(folder, cleanup_mode=None).get_uri()
        self._folder = folder
        self._program = Path(pgserver.__file__).parent / "pginstall" / "bin" / "pg_ctl"

    def stop(self) -> None:
        self._run("stop", "-m", "immediate")

    def start(self) -> None:
        self._run("start", "-w", "-o", "-h ''", "-o", f"-k {self._folder}", "-l", str(self._folder / "log"))

    def _run(self, *arguments: str) -> None:
        command = [str(self._program), "-D", str(self._folder), *arguments]
        owner = self._folder.owner()
        if owner != Path.home().owner():  # it does not run as root
            command = ["su", owner, "-s", "/bin/sh", "-c", shlex.join(command)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    folder = Path(tempfile.mkdtemp(prefix="pg"))  # a socket's path has 107 letters at most
    server = Server(folder)
    yield server
    server.stop()
    shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture(scope="module")
def postgres_url(server: Server) -> str:
    return server.url.replace("postgresql://", "postgresql+psycopg://", 1)


@pytest.fixture(autouse=True)
def _listens_often(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("app.storage.root.platformdirs.user_data_path", lambda *_, **__: tmp_path / "data")
    for name in ("LISTEN_EVERY_S", "SERVER_AGAIN_S", "BRING_AGAIN_S", "LOOK_EVERY_S"):
        monkeypatch.setattr(library_watch, name, 0.1)


@pytest.fixture
def controller(qtbot: QtBot, moved: Station, folder: Path) -> Iterator[LibraryController]:
    controller = LibraryController()
    with qtbot.waitSignal(controller.opened):
        controller.open(lambda holder: holder.open(folder, PASSPHRASE, "hk"))
    yield controller
    controller.finish()


@pytest.fixture
def other(moved: Station, tmp_path: Path, open_at: OpenAt, controller: LibraryController) -> OpenedLibrary:
    join(tmp_path / "second", moved.database, moved.journals)
    return open_at(tmp_path / "second")


def opened_of(controller: LibraryController) -> OpenedLibrary:
    assert controller.state is not None
    return controller.state.library


def test_a_server_that_goes_and_comes_back_is_stated_and_nothing_freezes(
    qtbot: QtBot, controller: LibraryController, server: Server
) -> None:
    with qtbot.waitSignal(controller.gone) as stated:
        server.stop()
    what, then = stated.args or ["", ""]
    assert what == "The clinic's server does not respond."
    assert "stay on this computer" in then
    assert controller.is_gone
    with qtbot.waitSignal(controller.back) as stated:
        server.start()
    assert (stated.args or [""])[0] == "The clinic's server responds again."
    assert not controller.is_gone


def test_what_another_station_does_is_received_and_its_own_doing_is_not(
    qtbot: QtBot, controller: LibraryController, other: OpenedLibrary
) -> None:
    own = opened_of(controller)
    qtbot.wait(2000)  # until it has received how far the others are
    with qtbot.assertNotEmitted(controller.changed_elsewhere, wait=1000):
        own.library.patients.create(Patient(code="P-7"))
    with qtbot.waitSignal(controller.changed_elsewhere):
        other.library.patients.create(Patient(code="P-8"))


def test_what_was_recorded_is_handed_over_by_itself_and_trouble_is_stated_once(
    qtbot: QtBot, controller: LibraryController, shared_place: Path, other: OpenedLibrary
) -> None:
    own = opened_of(controller)
    (line,) = own.library.sessions.list()
    elsewhere = shared_place.with_name("unmounted")
    shared_place.rename(elsewhere)
    with qtbot.waitSignal(controller.refused) as stated:
        record(own, line.id, "walk 2")
    what, then = stated.args or ["", ""]
    assert what == "The place of the clinic's recordings is not there."
    assert ("Recordings made here stay on this computer and are transferred automatically as soon as possible") in then
    assert count_waiting(own) == 1
    elsewhere.rename(shared_place)
    qtbot.waitUntil(lambda: count_waiting(own) == 0)


def test_without_the_server_a_station_opens_its_own_and_brings_it_home_later(
    qtbot: QtBot, controller: LibraryController, server: Server, folder: Path, other: OpenedLibrary
) -> None:
    server.stop()
    try:
        with qtbot.waitSignals([controller.not_opened, controller.can_work_away]):
            controller.open(lambda holder: holder.open(folder, PASSPHRASE, "hk"))
        with qtbot.waitSignal(controller.opened):
            controller.open(lambda holder: holder.open_away(folder, PASSPHRASE, "hk"))
        assert controller.state is not None
        assert controller.state.is_away
        away = opened_of(controller)
        patient = away.library.patients.create(Patient(code="DEMO-9"))
        visit = away.library.sessions.create(patient.id, Session(()))
        record(away, visit.id, "walk 1")
        spy = _Received(controller)
        controller.lock()
        with qtbot.waitCallback() as unlocked:
            spy.unlock(controller, unlocked)
        assert away.data_key
        with pytest.raises(
            LibraryError, match="The key of a clinic's library cannot change while workstations share it"
        ):
            refuse_change(away)
    finally:
        server.start()
    qtbot.waitUntil(lambda: spy.count == 1)
    with qtbot.waitSignal(controller.opened):
        controller.open(lambda holder: holder.open(folder, PASSPHRASE, "hk"))
    assert controller.state is not None
    assert (controller.state.is_away, controller.state.brought_from_away) == (False, 1)
    assert len(other.library.sessions.get(visit.id).recordings) == 1
    qtbot.waitUntil(lambda: count_waiting(opened_of(controller)) == 0)
    edited = replace(patient.details, height_m=1.7)
    assert other.library.patients.change(other.library.patients.get(patient.id), edited).details.height_m == 1.7


class _Received(QObject):
    def __init__(self, controller: LibraryController) -> None:
        super().__init__()
        self.count = 0
        controller.server_back.connect(self._on_received)

    def _on_received(self) -> None:
        self.count += 1

    def unlock(self, controller: LibraryController, done: Callable[[], object]) -> None:
        self._done = done
        controller.call(lambda holder: holder.unlock("hk", PASSPHRASE, None), self._on_unlocked, self._on_refused, self)

    def _on_unlocked(self, _unlocked: Unlocked) -> None:
        self._done()

    def _on_refused(self, what: str, remedy: str) -> None:
        raise AssertionError(f"{what} {remedy}")

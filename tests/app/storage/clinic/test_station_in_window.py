"""What the window does with a server: it joins, moves its library there and brings it back, open all the while."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QObject
from pytestqt.qtbot import QtBot

from app.storage.clinic.joining import is_station
from app.storage.clinic.moving import Moved
from app.storage.clinic.station import Station
from app.storage.layout import MOVING
from app.workers.library_controller import LibraryController
from app.workers.library_state import Joined
from tests.app.storage.clinic.conftest import PASSPHRASE

pytestmark = pytest.mark.endurance  # each starts with an empty server
WAIT_MS = 60_000


class Listener(QObject):
    """Notes what it is reported."""

    def __init__(self) -> None:
        super().__init__()
        self.reported: list[object] = []
        self.refusals: list[str] = []

    def on_done(self, result: object) -> None:
        self.reported.append(result)

    def on_failed(self, what: str, _remedy: str) -> None:
        self.refusals.append(what)

    def on_progressed(self, _share: float, _what: str) -> None:
        pass


@pytest.fixture
def controller(qtbot: QtBot) -> Iterator[LibraryController]:
    controller = LibraryController()
    yield controller
    controller.finish()


def test_a_library_goes_to_the_server_and_comes_back_while_somebody_is_logged_in(
    qtbot: QtBot, controller: LibraryController, folder: Path, database_url: str, shared_place: Path
) -> None:
    listener = Listener()
    with qtbot.waitSignal(controller.opened, timeout=WAIT_MS):
        controller.open(folder, PASSPHRASE, "hk")
    controller.move_to_server(
        database_url, "", str(shared_place), listener.on_done, listener.on_failed, listener.on_progressed, listener
    )
    qtbot.waitUntil(lambda: bool(listener.reported), timeout=WAIT_MS)
    assert isinstance(listener.reported[0], Moved)
    assert controller.state is not None
    assert controller.state.library.shared is not None
    assert controller.state.operator.code == "hk"
    assert is_station(folder)
    controller.bring_back(listener.on_done, listener.on_failed, listener.on_progressed, listener)
    qtbot.waitUntil(lambda: len(listener.reported) == 2, timeout=WAIT_MS)
    assert controller.state is not None
    opened = controller.state.library
    assert opened.shared is None
    assert not is_station(folder)
    (session,) = opened.library.sessions.list()
    journals = [one for recording in opened.library.sessions.get(session.id).recordings for one in recording.journals]
    assert journals
    assert all(opened.journal_path(one).exists() for one in journals)
    assert not list(folder.parent.glob("*-back-from-the-server"))


def test_a_move_whose_place_is_missing_leaves_the_folder_to_work_with(
    qtbot: QtBot, controller: LibraryController, folder: Path, database_url: str, tmp_path: Path
) -> None:
    listener = Listener()
    with qtbot.waitSignal(controller.opened, timeout=WAIT_MS):
        controller.open(folder, PASSPHRASE, "hk")
    controller.move_to_server(
        database_url, "", str(tmp_path / "no"), listener.on_done, listener.on_failed, listener.on_progressed, listener
    )
    qtbot.waitUntil(lambda: bool(listener.refusals), timeout=WAIT_MS)
    assert "is not there" in listener.refusals[0]
    assert controller.state is not None
    assert controller.state.library.shared is None
    assert not (folder / MOVING).exists()


def test_a_station_joins_and_a_place_that_is_missing_here_is_reported_as_such(
    qtbot: QtBot, controller: LibraryController, moved: Station, tmp_path: Path
) -> None:
    listener = Listener()
    for place in (str(tmp_path / "no"), "", moved.journals):
        controller.join(tmp_path / "new", moved.database, "", place, listener.on_done, listener.on_failed, listener)
    qtbot.waitUntil(lambda: len(listener.reported) == 3, timeout=WAIT_MS)
    missing, unconfirmed, joined = listener.reported
    assert isinstance(missing, Joined)
    assert missing.is_place
    assert isinstance(unconfirmed, Joined)
    assert (unconfirmed.is_place, unconfirmed.place) == (True, moved.journals)
    assert joined == Joined(None)
    with qtbot.waitSignal(controller.opened, timeout=WAIT_MS):
        controller.open(tmp_path / "new", PASSPHRASE, "hk")

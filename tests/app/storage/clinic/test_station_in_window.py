"""What the window does with a server: it joins, moves its library there and brings it back, open all the while."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from app.storage.clinic.joining import is_station
from app.storage.clinic.moving import Moved
from app.storage.clinic.station import Station
from app.storage.layout import MOVING
from app.workers.library_controller import LibraryController
from app.workers.library_holder import LibraryHolder
from app.workers.library_state import Joined
from tests.app.library_answers import Asker, opened
from tests.app.storage.clinic.conftest import PASSPHRASE

pytestmark = pytest.mark.endurance  # each starts with an empty server


@pytest.fixture
def controller(qtbot: QtBot) -> Iterator[LibraryController]:
    controller = LibraryController()
    yield controller
    controller.finish()


def test_a_library_goes_to_the_server_and_comes_back_while_somebody_is_logged_in(
    qtbot: QtBot, controller: LibraryController, folder: Path, database_url: str, shared_place: Path
) -> None:
    asker = Asker()
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    controller.reopen(
        lambda holder, report: holder.move_to_server(database_url, "", str(shared_place), report),
        *asker.all_ears,
    )
    qtbot.waitUntil(lambda: bool(asker.results))
    assert isinstance(asker.results[0], Moved)
    assert controller.state is not None
    assert controller.state.library.shared is not None
    assert controller.state.operator.code == "hk"
    assert is_station(folder)
    controller.reopen(
        lambda holder, report: holder.bring_back(report),
        *asker.all_ears,
    )
    qtbot.waitUntil(lambda: len(asker.results) == 2)
    assert controller.state is not None
    library = controller.state.library
    assert library.shared is None
    assert not is_station(folder)
    (session,) = library.library.sessions.list()
    journals = [one for recording in library.library.sessions.get(session.id).recordings for one in recording.journals]
    assert journals
    assert all(library.journal_path(one).exists() for one in journals)
    assert not list(folder.parent.glob("*-back-from-the-server"))


def test_a_move_whose_place_is_missing_leaves_the_folder_to_work_with(
    qtbot: QtBot, controller: LibraryController, folder: Path, database_url: str, tmp_path: Path
) -> None:
    asker = Asker()
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    controller.reopen(
        lambda holder, report: holder.move_to_server(database_url, "", str(tmp_path / "no"), report),
        *asker.all_ears,
    )
    qtbot.waitUntil(lambda: bool(asker.refusals))
    assert "is not there" in asker.refusals[0][0]
    assert controller.state is not None
    assert controller.state.library.shared is None
    assert not (folder / MOVING).exists()


def test_a_station_joins_and_a_place_that_is_missing_here_is_reported_as_such(
    qtbot: QtBot, controller: LibraryController, moved: Station, tmp_path: Path
) -> None:
    asker = Asker()

    def joining(place: str) -> Callable[[LibraryHolder], Joined]:
        return lambda holder: holder.join(tmp_path / "new", moved.database, "", place)

    for place in (str(tmp_path / "no"), "", moved.journals):
        controller.call(joining(place), *asker.ears)
    qtbot.waitUntil(lambda: len(asker.results) == 3)
    missing, unconfirmed, joined = asker.results
    assert isinstance(missing, Joined)
    assert missing.is_place
    assert isinstance(unconfirmed, Joined)
    assert (unconfirmed.is_place, unconfirmed.place) == (True, moved.journals)
    assert joined == Joined(None)
    opened(qtbot, controller, tmp_path / "new", PASSPHRASE, "hk")

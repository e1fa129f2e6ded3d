"""T15: edits of two stations at once, outages of server and shared place, and moves that are killed. Small numbers."""

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from tests.safety.clinic_material import OwnServer, make_clinic, own_server
from tests.safety.moving_kills import move_killed
from tests.safety.station_edits import edit_together
from tests.safety.station_outages import live_through_outages

pytestmark = pytest.mark.endurance  # a minute in all


@pytest.fixture(scope="module")
def server() -> Iterator[OwnServer]:
    pytest.importorskip("pgserver", reason="there is no PostgreSQL for this Python")
    # pytest's own is too deep: a socket's path has 107 letters at most
    with TemporaryDirectory(prefix="t15") as folder:
        Path(folder).chmod(0o755)  # for the server's own user
        with own_server(Path(folder) / "pg") as server:
            yield server


def test_no_edit_of_two_stations_is_lost(server: OwnServer, tmp_path: Path) -> None:
    found = edit_together(make_clinic(tmp_path, server), tmp_path, 500, seed=1)
    assert found.faults == []
    assert found.count["edits taken"] == 500


def test_what_is_recorded_while_server_and_place_come_and_go_is_handed_over_once(
    server: OwnServer, tmp_path: Path
) -> None:
    found = live_through_outages(make_clinic(tmp_path, server), server, tmp_path, 8.0, seed=2)
    assert found.faults == []
    assert found.count["recordings"] > 0
    assert found.count["times the server was stopped"] > 0


def test_a_move_that_is_killed_leaves_one_end_to_write_at_and_is_finished(server: OwnServer, tmp_path: Path) -> None:
    found = move_killed(server, tmp_path, 10, seed=3)
    assert found.faults == []
    assert found.count["kills"] >= 10

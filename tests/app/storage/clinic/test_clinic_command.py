"""`gaitwright clinic` on a terminal: a library goes to the server, a station joins it, and it comes back."""

from pathlib import Path

import pytest

from app.cli.main import main
from app.storage.layout import DATABASE_VARIABLE
from app.storage.opened import open_library
from tests.app.storage.clinic.conftest import PASSPHRASE


@pytest.fixture
def key(tmp_path: Path) -> list[str]:
    file = tmp_path / "passphrase"
    file.write_text(PASSPHRASE)
    return ["--operator", "hk", "--passphrase-file", str(file)]


@pytest.mark.endurance
def test_a_library_goes_to_the_server_a_station_joins_and_it_comes_back(
    folder: Path,
    database_url: str,
    shared_place: Path,
    tmp_path: Path,
    key: list[str],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(DATABASE_VARIABLE, database_url)
    second, back = str(tmp_path / "second"), str(tmp_path / "back")
    assert main(["clinic", "prepare"]) == 0
    assert "is ready" in capsys.readouterr().out
    assert main(["clinic", "join", second]) == 2
    assert "No library was found on the clinic's server" in capsys.readouterr().err
    assert main(["clinic", "move", str(folder), *key, "--journals", str(shared_place)]) == 0
    stated = capsys.readouterr().out
    assert "1 patient, 1 session and 3 recordings are on postgresql://" in stated
    assert main(["clinic", "join", second]) == 2
    assert str(shared_place) in capsys.readouterr().err
    assert main(["clinic", "join", second, "--journals", str(shared_place)]) == 0
    assert "is a station of postgresql://" in capsys.readouterr().out
    monkeypatch.delenv(DATABASE_VARIABLE)  # from here on the station's own file names the server
    assert main(["clinic", "status", second, *key]) == 0
    assert "All recordings were transferred." in capsys.readouterr().out
    assert main(["clinic", "back", second, *key, "--out", str(tmp_path / "copy"), "--copy"]) == 0
    assert main(["clinic", "back", str(folder), *key, "--out", back]) == 0
    assert "remove its database and recordings once you are sure" in capsys.readouterr().out
    assert main(["clinic", "status", second, *key]) == 2
    assert "no longer on the clinic's server" in capsys.readouterr().err
    for place in (back, str(tmp_path / "copy")):
        with open_library(Path(place), PASSPHRASE, "hk") as opened:
            assert opened.library.patients.find("DEMO-1") is not None
    assert main(["clinic", "back", second, *key, "--give-up"]) == 0
    assert main(["clinic", "status", second, *key]) == 0


def test_a_password_on_the_command_line_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    address = "postgresql://station:hunter2@clinic.example/gaitwright"
    assert main(["clinic", "join", str(tmp_path / "station"), "--database", address]) == 2
    stated = capsys.readouterr().err
    assert "other programs" in stated
    assert "hunter2" not in stated


def test_without_an_address_it_is_stated_how_to_give_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(DATABASE_VARIABLE, raising=False)
    assert main(["clinic", "join", str(tmp_path / "station")]) == 2
    assert DATABASE_VARIABLE in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["clinic"])
    assert "ACTION" in capsys.readouterr().err

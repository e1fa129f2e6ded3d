"""Tests that `gaitwright import` takes what is stated of a table, and shows how it reads one."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from app.cli import arguments
from app.cli.main import main
from core.body import Site
from devices.drivers.csv_serial import FORCE_UNITS, RATE_UNITS
from devices.files import table_choices, text_files
from devices.files.session_folder import read_session
from tests.clock_files import ALL, TIME_S, pair, restarted, without
from tests.devices.files.test_public_layouts import LEFT, ngimu, no_header, rows_of, write, ximu

BY_HAND = ["--header-line", "0", "--acc", "2,3,4", "--gyr", "5,6,7", "--gyr-unit", "rad/s", "--time", "1"]


def test_the_words_of_the_options_are_those_of_the_tables() -> None:
    assert arguments.ENCODINGS == text_files.ENCODINGS
    assert arguments.SEPARATORS == table_choices.SEPARATORS
    assert arguments.TIME_UNITS == table_choices.TIME_UNITS
    assert tuple(FORCE_UNITS) == arguments.FORCE_UNITS
    assert tuple(RATE_UNITS) == arguments.RATE_UNITS


def test_a_table_without_names_is_read_as_stated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (path,), out = no_header(tmp_path), tmp_path / "session"
    where = ["--map", "left_shank=a", "--out", str(out)]
    assert main(["import", str(path), *where]) == 2
    assert "a.csv: the file format is not recognised; the table has no header" in capsys.readouterr().err
    assert main(["import", str(path), *where, *BY_HAND]) == 0
    block = read_session(out).recordings[0].imu[Site.LEFT_SHANK]
    np.testing.assert_allclose(block.acc_m_s2, LEFT.acc, atol=1e-5)
    np.testing.assert_allclose(block.gyr_rad_s, LEFT.gyr, atol=1e-5)


def test_a_preview_names_the_program_that_is_recognised(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    archive = tmp_path / "a.mat"
    savemat(archive, {"acc": LEFT.acc, "gyr": LEFT.gyr, "fs": 100.0})
    assert main(["import", "--preview", str(archive)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines == ["a.mat:", "  recognised as matlab, and read so unless something is stated of its columns"]
    for make, is_named in ((ximu, True), (ngimu, False)):
        assert main(["import", "--preview", str(make(tmp_path)[0])]) == 0
        assert ("recognised as ximu, and read so unless" in capsys.readouterr().out) is is_named


def test_a_preview_gives_the_options_that_read_the_table_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (path,) = no_header(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    assert main(["import", str(path), "--preview"]) == 0
    shown = capsys.readouterr().out
    assert "columns: 1 column 1, 2 column 2" in shown
    assert "--header-line 0 --separator comma --decimal point" in shown
    assert "--acc 'column 2,column 3,column 4' --acc-unit m/s2" in shown
    assert "The columns were found by their values alone: check them." in shown
    assert "sensor a: 100 Hz, 8.0 s" in shown
    assert sorted(tmp_path.rglob("*")) == before
    named = write(tmp_path / "b.csv", ["time_s,ax,ay,az,gx,gy,gz", *rows_of(LEFT.time_s, LEFT.acc, LEFT.gyr)])
    assert main(["import", str(named), "--preview"]) == 0
    assert "by their values alone" not in capsys.readouterr().out


def test_a_preview_states_why_a_table_cannot_be_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (path,) = no_header(tmp_path)
    assert main(["import", str(path), "--preview", *BY_HAND, "--acc-unit", "g"]) == 0
    assert "is labelled g, but its median of" in capsys.readouterr().out
    assert main(["import", str(write(tmp_path / "a.txt", ["Dear all"])), "--preview"]) == 0
    assert "the file is not a table of numbers" in capsys.readouterr().out


def test_without_positions_nothing_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (path,) = no_header(tmp_path)
    assert main(["import", str(path), *BY_HAND, "--out", str(tmp_path / "session")]) == 2
    assert "--map: no sensor position is given. Write the assignment as left_thigh=" in capsys.readouterr().err
    assert not (tmp_path / "session").exists()


@pytest.mark.parametrize(
    ("option", "value"),
    [("--acc", "x,y"), ("--acc", "x,,z"), ("--header-line", "-1"), ("--separator", ";"), ("--time-unit", "hours")],
)
def test_what_no_option_means_is_refused(option: str, value: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["import", "a.csv", "--preview", option, value])
    assert ended.value.code == 2
    assert option in capsys.readouterr().err


def test_a_clock_that_restarts_is_refused_with_the_place_to_split_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [str(path) for path in pair(tmp_path, (restarted(9.0), ALL), (restarted(9.0), ALL))]
    out = tmp_path / "session"
    command = ["import", *files, "--map", "left_thigh=left_thigh,left_shank=left_shank", "--out", str(out)]
    assert main(command) == 2
    assert "Split the recording there (--split-at 9.0), or export it again." in capsys.readouterr().err
    assert not out.exists()
    assert main([*command, "--split-at", "9.0"]) == 0
    stated = capsys.readouterr().out
    assert "now holds walk 1, with 2 of 6 sites" in stated
    assert "now holds walk 2, with 2 of 6 sites" in stated
    assert [len(one.imu[Site.LEFT_SHANK]) for one in read_session(out).recordings] == [900, 1100]
    assert main([*command, "--split-at", "9", "--recording", "morning"]) == 0
    assert [one.name for one in read_session(out).recordings][2:] == ["morning", "morning 2"]


def test_pauses_and_losses_are_reported_in_words_and_nothing_of_even_clocks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    place = ["--map", "left_thigh=left_thigh,left_shank=left_shank"]
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    lossy = without((6.0, 11.0), (14.0, 14.4))
    files = [str(path) for path in pair(tmp_path / "a", (TIME_S, without((6.0, 11.0))), (TIME_S, lossy))]
    assert main(["import", *files, *place, "--out", str(tmp_path / "one")]) == 0
    stated = capsys.readouterr().out
    assert "- No sensor recorded for 5.0 s, from 6.0 s on." in stated
    assert "- left_shank: samples missing for 0.42 s, after 14.0 s." in stated
    assert "left_thigh: samples" not in stated
    files = [str(path) for path in pair(tmp_path / "b")]
    assert main(["import", *files, *place, "--out", str(tmp_path / "two")]) == 0
    stated = capsys.readouterr().out
    assert "recorded for" not in stated
    assert "samples missing" not in stated
    assert "clock" not in stated

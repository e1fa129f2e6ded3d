"""Tests that `compare` and `export` report what differs and write what was asked for, or refuse in one line."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from app.cli.arguments import DIFFERENCES
from app.cli.compare import FLAGS, _table
from app.cli.main import main
from app.summary.comparison import Contrast
from app.summary.differences import Row, comparisons_of, rows_of, without_common_condition
from core.body import Side
from core.results import Analysis, ZeroKind
from core.session import Session
from core.verdicts.measurement_error import Judgement
from core.verdicts.quantities import PARAMETERS
from devices.files.session_folder import read_session, write_session
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.app.changed_analysis import recalibrated
from tests.app.exports.written_tables import csv_rows
from tests.simulated import analysis_of, session_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

Visit = tuple[Session, Analysis]
CONDITIONS = {"walk 1": "barefoot", "walk 2": "AFO"}


def walked(seed: int, *walks: str) -> Session:
    required = tuple(Walk(name=name, strides=15) for name in walks)
    session = session_of(WalkerSettings(seed=seed, recordings=(Standing(), FreeMotion(), *required)))
    recordings = tuple(replace(r, condition=CONDITIONS.get(r.name, "")) for r in session.recordings)
    return replace(session, recordings=recordings)


@pytest.fixture(scope="module")
def visits() -> list[Visit]:
    sessions = walked(5, "walk 1", "walk 2"), walked(6, "walk 2")
    return [(session, analysis_of(session)) for session in sessions]


@pytest.fixture(scope="module")
def folders(visits: list[Visit], tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("visits")
    for number, (session, _) in enumerate(visits, start=1):
        write_session(session, folder / str(number))
    return [folder / "1", folder / "2"]


def rows(visits: list[Visit]) -> list[Row]:
    return [row for comparison in comparisons_of(visits) for row in rows_of(comparison)]


def row(found: list[Row], side: Side, parameter: str) -> Row:
    (only,) = [one for one in found if (one.side, one.parameter) == (side, parameter)]
    return only


def test_conditions_are_reported_against_the_first_and_visits_by_condition(visits: list[Visit]) -> None:
    reported = [[(part.letter, part.name) for part in found.parts] for found in comparisons_of(visits)]
    assert reported == [[("1A", "barefoot"), ("1B", "AFO")], [("1B", "AFO"), ("2A", "AFO")]]
    session, analysis = visits[1]
    renamed = replace(
        session, recordings=(*session.recordings[:-1], replace(session.recordings[-1], condition="shoes"))
    )
    assert [found.kind for found in comparisons_of([visits[0], (renamed, analysis)])] == [Contrast.CONDITIONS]
    assert without_common_condition([visits[0], (renamed, analysis)]) == [2]
    assert without_common_condition(visits) == []
    assert comparisons_of(visits[1:]) == []


def test_sessions_without_a_common_condition_are_refused_and_reported(
    visits: list[Visit], folders: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    session, _ = visits[1]
    renamed = tuple(replace(one, condition="shoes") if one.condition else one for one in session.recordings)
    write_session(replace(session, recordings=renamed), tmp_path / "3")
    arguments = ["compare", str(folders[1]), str(tmp_path / "3"), "--out", str(tmp_path / "out")]
    assert main(arguments) == 2
    stated = capsys.readouterr().err
    assert "no condition in common with the first, so they are not compared" in stated
    assert "session 1: AFO. session 2: shoes." in stated
    assert not (tmp_path / "out").exists()
    assert main(["compare", str(folders[0]), *arguments[2:]]) == 0  # the first has two of its own
    assert "session 2: shoes." in capsys.readouterr().out


def test_within_a_session_the_error_is_that_of_sensors_that_stay_on(visits: list[Visit]) -> None:
    found = row(rows(visits[:1]), Side.LEFT, "knee_range_deg")
    assert min(found.value.n, found.other.n) >= 10
    assert found.difference.difference == found.value.mean - found.other.mean
    assert 2.772 < found.difference.error < 6.0  # 1.96 sqrt(2) x 1 deg from walk to walk, and the strides' own
    assert found.difference.sources == ("chance", "drift", "walk_to_walk")  # their speeds read the same
    assert found.difference.judgement == Judgement.INSIDE_ERROR
    time = row(rows(visits[:1]), Side.LEFT, "stride_time_s").difference
    assert (time.judgement, time.is_unverified) == (Judgement.INSIDE_ERROR, False)
    assert row(rows(visits[:1]), Side.LEFT, "clearance_m").difference.judgement == Judgement.NO_PUBLISHED_FIGURE


def test_between_sessions_knees_are_judged_and_ankles_with_a_dagger(visits: list[Visit]) -> None:
    found = [one for one in rows(visits) if one.part.letter == "2A"]
    knee = row(found, Side.LEFT, "knee_swing_peak_deg").difference
    is_beyond = abs(knee.difference) > knee.error
    assert 8.4 < knee.error < 9.5  # 1.96 sqrt(2) hypot(2.2, 4 % of 54 to 58 deg), and the strides' own
    assert knee.judgement == (Judgement.EXCEEDS_ERROR if is_beyond else Judgement.INSIDE_ERROR)
    ankle = row(found, Side.LEFT, "ankle_range_deg").difference
    assert 9.147 < ankle.error < 10.5  # 1.96 sqrt(2) x 3.3
    assert (ankle.is_unverified, ankle.is_worth_a_sentence) == (True, False)


def test_heights_without_a_common_zero_are_not_compared(visits: list[Visit]) -> None:
    (session, analysis) = visits[0]
    found = rows([(session, recalibrated(analysis, zero=ZeroKind.NONE))])
    assert row(found, Side.LEFT, "knee_swing_peak_deg").difference.judgement == Judgement.NOT_REPORTED
    assert not row(found, Side.LEFT, "knee_swing_peak_deg").difference.is_reported
    assert row(found, Side.LEFT, "knee_range_deg").difference.judgement == Judgement.INSIDE_ERROR
    assert not [one for one in found if "curve_difference" in one.parameter]


def test_heights_from_zeros_of_two_kinds_stand_apart_and_are_not_compared(visits: list[Visit]) -> None:
    first, (session, analysis) = visits
    by_goniometer = session, recalibrated(analysis, zero=ZeroKind.GONIOMETER)
    found = [one for one in rows([first, by_goniometer]) if one.part.letter == "2A"]
    knee = row(found, Side.LEFT, "knee_swing_peak_deg")
    assert (knee.difference.judgement, knee.difference.is_reported) == (Judgement.NOT_REPORTED, False)
    assert row(found, Side.LEFT, "knee_range_deg").difference.is_reported


def test_the_terminal_marks_errors_that_nobody_could_check_and_states_not_reported(visits: list[Visit]) -> None:
    (session, analysis) = visits[0]
    (comparison,) = comparisons_of([(session, recalibrated(analysis, zero=ZeroKind.NONE))])
    lines = {tuple(line.split()[:2]): line for line in _table(comparison, {})}
    assert re.search(r"\d† (may be|beyond) measurement error$", lines["L", "shank_heel_rocker_deg"])
    for column in ("stride_time_s", "knee_range_deg"):
        assert re.search(r"\d  (may be|beyond) measurement error$", lines["L", column])
    assert lines["L", "knee_swing_peak_deg"].split() == ["L", "knee_swing_peak_deg", "not", "reported"]


def test_the_command_writes_the_table_and_states_it(
    folders: list[Path], visits: list[Visit], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["compare", *map(str, folders), "--out", str(tmp_path / "out")]
    assert main(arguments) == 0
    stated = capsys.readouterr().out
    assert "SIMULATED. 2A AFO less 1B AFO" in stated
    assert "may be measurement error" in stated
    assert "† The error rests on a figure of which the source could not be checked." in stated
    first = (tmp_path / "out" / DIFFERENCES).read_bytes()
    reported = csv_rows(tmp_path / "out" / DIFFERENCES)
    assert len(reported) == len(rows(visits)) > 2 * len(PARAMETERS)
    assert {one["verdict"] for one in reported} <= set(FLAGS)
    knee = row(rows(visits[:1]), Side.LEFT, "knee_range_deg")
    (written,) = [
        one
        for one in reported[: len(rows(visits[:1]))]
        if (one["side"], one["parameter"]) == ("left", "knee_range_deg")
    ]
    assert written["difference"] == f"{knee.difference.difference:.5f}"
    assert main(arguments) == 0  # a comparison replaces a comparison
    assert (tmp_path / "out" / DIFFERENCES).read_bytes() == first


def test_nothing_to_compare_and_a_place_that_is_taken_are_refused(
    folders: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(folders[1]), "--out", str(tmp_path / "out")]) == 2
    assert "no two conditions" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("kept")
    assert main(["compare", str(folders[0]), "--out", str(tmp_path / "mine")]) == 2
    assert (tmp_path / "mine" / "letter.txt").read_text() == "kept"


def test_export_writes_the_formats_asked_for(
    folders: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["export", str(folders[1]), "--as", "xlsx,mot", "--out", str(out)]) == 0
    assert sorted(path.name for path in out.rglob("*") if path.is_file()) == [
        "angles.mot",
        "angles.mot",
        "gaitwright.xlsx",
    ]
    assert "3 files, pseudonymised." in capsys.readouterr().out
    assert main(["export", str(folders[1]), "--as", "mot", "--out", str(out)]) == 2
    assert "this already exists and is not an empty folder" in capsys.readouterr().err
    shutil.rmtree(out)
    assert main(["export", str(folders[1]), "--as", "mot", "--keep", "device,mood", "--out", str(out)]) == 2
    assert "mood is not among what is typed" in capsys.readouterr().err
    assert main(["export", str(folders[1]), "--as", "mot,doc", "--out", str(out)]) == 2
    assert "doc is no format" in capsys.readouterr().err
    assert not out.exists()


def test_export_states_what_would_leave_and_writes_nothing(
    folders: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stated = []
    listed = list(tmp_path.iterdir())
    for keep in ("", "conditions"):
        assert main(["export", str(folders[1]), "--as", "xlsx", "--keep", keep, "--preview"]) == 0
        stated.append(capsys.readouterr().out)
    typed = {recording.condition for recording in read_session(folders[1]).recordings} - {""}
    assert typed
    assert not [one for one in typed if one in stated[0]]
    assert all(one in stated[1] for one in typed)
    assert "Nothing was written." in stated[0]
    assert list(tmp_path.iterdir()) == listed
    assert main(["export", str(folders[1]), "--as", "xlsx", "--identified", "--preview"]) == 2
    assert "data that identify the patient are exported unchanged" in capsys.readouterr().err

"""Do `compare` and `export` say what differs and write what was asked for, or refuse in one line?"""

import csv
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from app.cli import main
from app.compare_command import DIFFERENCES, FLAGS
from app.reports.differences import NO_COMMON_ZERO, Row, comparisons_of, rows_of
from app.reports.gait_csv import PARAMETERS
from core.analysis import analyse
from core.body import Side
from core.norms import KNEE_NEW_ATTACHMENT_DEG, Verdict
from core.results import Analysis, ZeroKind
from core.samples import Session
from devices.files.session_folder import write_session
from devices.walker import FreeMotion, Standing, Walk, WalkerSettings, simulate

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

Visit = tuple[Session, Analysis]
CONDITIONS = {"walk 1": "barefoot", "walk 2": "AFO"}


def session_of(seed: int, *walks: str) -> Session:
    wanted = tuple(Walk(name=name, strides=12) for name in walks)
    session = simulate(WalkerSettings(seed=seed, recordings=(Standing(), FreeMotion(), *wanted))).session
    recordings = tuple(replace(r, condition=CONDITIONS.get(r.name, "")) for r in session.recordings)
    return replace(session, recordings=recordings)


@pytest.fixture(scope="module")
def visits() -> list[Visit]:
    sessions = session_of(5, "walk 1", "walk 2"), session_of(6, "walk 2")
    return [(session, analyse(session)) for session in sessions]


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


def test_conditions_are_told_against_the_first_and_visits_by_condition(visits: list[Visit]) -> None:
    told = [[(part.letter, part.name) for part in found.parts] for found in comparisons_of(visits)]
    assert told == [[("1A", "barefoot"), ("1B", "AFO")], [("1B", "AFO"), ("2A", "AFO")]]
    session, analysis = visits[1]
    renamed = replace(
        session, recordings=(*session.recordings[:-1], replace(session.recordings[-1], condition="shoes"))
    )
    last = comparisons_of([visits[0], (renamed, analysis)])[-1]
    assert [part.name for part in last.parts] == ["AFO", "shoes"]
    assert comparisons_of(visits[1:]) == []


def test_within_a_session_the_error_is_that_of_sensors_that_stay_on(visits: list[Visit]) -> None:
    found = row(rows(visits[:1]), Side.LEFT, "knee_range_deg")
    one, other = found.value, found.other
    assert found.difference == one.mean - other.mean
    assert found.error == pytest.approx(1.96 * (one.sd**2 / one.n + other.sd**2 / other.n) ** 0.5 + 1.0)
    assert found.verdict == Verdict.INSIDE_ERROR
    assert row(rows(visits[:1]), Side.LEFT, "stride_time_s").verdict == Verdict.NO_PUBLISHED_FIGURE


def test_between_sessions_knees_are_judged_and_ankles_are_not(visits: list[Visit]) -> None:
    found = [one for one in rows(visits) if one.part.letter == "2A"]
    knee = row(found, Side.LEFT, "knee_swing_peak_deg")
    is_beyond = abs(knee.difference) > KNEE_NEW_ATTACHMENT_DEG
    assert knee.error == KNEE_NEW_ATTACHMENT_DEG
    assert knee.verdict == (Verdict.EXCEEDS_ERROR if is_beyond else Verdict.INSIDE_ERROR)
    assert row(found, Side.LEFT, "ankle_range_deg").verdict == Verdict.NO_PUBLISHED_FIGURE


def test_heights_without_a_common_zero_are_not_compared(visits: list[Visit]) -> None:
    def without_zero(analysis: Analysis) -> Analysis:
        spans = tuple(
            replace(span, joints={j: replace(found, zero=ZeroKind.NONE) for j, found in span.joints.items()})
            for span in analysis.calibrations
        )
        return replace(analysis, calibrations=spans)

    found = rows([(visits[0][0], without_zero(visits[0][1]))])
    assert row(found, Side.LEFT, "knee_swing_peak_deg").verdict == NO_COMMON_ZERO
    assert row(found, Side.LEFT, "knee_range_deg").verdict == Verdict.INSIDE_ERROR
    assert not [one for one in found if "curve_difference" in one.parameter]


def test_the_command_writes_the_table_and_says_it(
    folders: list[Path], visits: list[Visit], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["compare", *map(str, folders), "--out", str(tmp_path / "out")]
    assert main(arguments) == 0
    said = capsys.readouterr().out
    assert "SIMULATED. 2A AFO less 1B AFO" in said
    assert "inside measurement error" in said
    first = (tmp_path / "out" / DIFFERENCES).read_bytes()
    with (tmp_path / "out" / DIFFERENCES).open(newline="") as file:
        told = list(csv.DictReader(file))
    assert len(told) == len(rows(visits)) > 2 * len(PARAMETERS)
    assert {one["verdict"] for one in told} <= set(FLAGS)
    knee = row(rows(visits[:1]), Side.LEFT, "knee_range_deg")
    (written,) = [
        one for one in told[: len(rows(visits[:1]))] if (one["side"], one["parameter"]) == ("left", "knee_range_deg")
    ]
    assert written["difference"] == f"{knee.difference:.5f}"
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
    assert "something here already" in capsys.readouterr().err
    shutil.rmtree(out)
    assert main(["export", str(folders[1]), "--as", "mot,doc", "--out", str(out)]) == 2
    assert "doc is no format" in capsys.readouterr().err
    assert not out.exists()

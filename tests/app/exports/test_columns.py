"""Tests that columns.csv describes every column of every table of a real analysis, and no other."""

import csv
import datetime
import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from syrupy.assertion import SnapshotAssertion

from app.exports.columns import COLUMNS, KNOWN, column_of
from app.exports.result_folder import TAKEN, VISITS, VISITS_CYCLES, describe_tables, write_results
from app.summary.alignments import write_alignments
from app.summary.differences import comparisons_of, rows_of, write_compared_cycles, write_differences
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Side
from core.goals import Goal, GoalOf
from core.session import Recording, RecordingKind
from core.targets import Target, TargetMeasure, TargetTally, with_tallies
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.app.exports.conftest import Visit
from tests.app.exports.written_tables import csv_rows
from tests.simulated import analysis_of, session_of

Row = dict[str, str]


@pytest.fixture(scope="module")
def visit() -> Visit:
    required = (Standing(), FreeMotion(), Walk(strides=5), Walk("walk 2", strides=5), Walk("walk 3", strides=5))
    session = session_of(WalkerSettings(seed=5, recordings=required, prosthetic_side=Side.LEFT))
    conditions = {"walk 1": "shoes", "walk 2": "barefoot", "walk 3": "barefoot"}
    note = with_tallies("", [TargetTally(Target(TargetMeasure.CADENCE, None, 110), 2, 4)])
    turned = AlignmentChange("shoes", (PartChange(ProsthesisPart.PYLON, turns=0.5, height_mm=3.0, text="=1"),))
    recordings = tuple(
        replace(
            one,
            condition=conditions.get(one.name, ""),
            note=note if one.name == "walk 2" else "",
            alignment=turned if one.name in ("walk 2", "walk 3") else None,
            test=PlannedTest(TimedProtocol.TEN_METRES) if one.name == "walk 2" else None,
        )
        for one in session.recordings
    )
    agreed = Goal("speed_m_s", GoalOf.WALK, 1.2, datetime.date(2026, 1, 5))
    patient = replace(session.patient, goals=(agreed,))
    session = replace(session, recordings=recordings, patient=patient, started="2026-02-01")
    return session, analysis_of(session)


@pytest.fixture(scope="module")
def out(visit: Visit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("out")
    write_results(*visit, folder)
    return folder


def rows_of_columns(folder: Path) -> list[Row]:
    return csv_rows(folder / COLUMNS)


def columns_in(folder: Path) -> set[tuple[str, str]]:
    found = set()
    for path in folder.rglob("*.csv"):
        if path.name != COLUMNS:
            with path.open(newline="", encoding="utf-8") as file:
                found |= {(path.name, name) for name in next(csv.reader(file))}
    return found


def test_every_column_of_every_table_is_reported_of_and_no_other(out: Path) -> None:
    reported = [(row["file"], row["column"]) for row in rows_of_columns(out)]
    assert len(reported) == len(set(reported))
    assert set(reported) == columns_in(out)
    files = {file for file, _ in reported}
    assert files == {
        *("angles.csv", "events.csv", "strides.csv", "cycles.csv"),
        *("peaks.csv", "alignments.csv", "differences.csv", "compared_cycles.csv", "sides.csv", "targets.csv"),
        *("fitting.csv", "fitting_means.csv", "goals.csv", "timed_test.csv", "set_angles.csv"),
    }
    assert (COLUMNS,) in TAKEN


def test_the_tables_of_an_earlier_visit_are_reported_of_once_they_are_there(
    visit: Visit, out: Path, tmp_path: Path
) -> None:
    shutil.copytree(out, tmp_path, dirs_exist_ok=True)
    found = comparisons_of([visit, visit])[-1]
    write_differences(rows_of(found), tmp_path / VISITS)
    write_compared_cycles(found.parts, tmp_path / VISITS_CYCLES)
    assert {row["file"] for row in rows_of_columns(tmp_path)}.isdisjoint({VISITS, VISITS_CYCLES})
    describe_tables(visit[1], tmp_path)
    reported = {(row["file"], row["column"]) for row in rows_of_columns(tmp_path)}
    assert reported == columns_in(tmp_path)
    assert {file for file, _ in reported} == set(KNOWN)


@pytest.mark.parametrize(
    ("file", "column", "unit", "sign", "needs"),
    [
        ("alignments.csv", "turns", "turns", "positive: out", ""),
        ("alignments.csv", "in_words", "", "", ""),
        ("timed_test.csv", "turn_deg", "deg", "positive: to the left", ""),
        ("timed_test.csv", "cadence_steps_min", "steps/min", "", ""),
        ("timed_test.csv", "missing", "", "", ""),
        ("angles.csv", "left_knee_deg", "deg", "flexion positive", "zero sign"),
        ("angles.csv", "right_ankle_published_deg", "deg", "dorsiflexion positive", "zero sign"),
        ("angles.csv", "left_knee_sd_deg", "deg", "", ""),
        ("angles.csv", "left_knee_status", "", "", ""),
        ("cycles.csv", "left_ankle_mean_deg", "deg", "dorsiflexion positive", "zero sign"),
        ("cycles.csv", "left_ankle_shape_deg", "deg", "dorsiflexion positive", "sign"),
        ("cycles.csv", "left_ankle_n", "", "", ""),
        ("strides.csv", "knee_range_deg", "deg", "", ""),
        ("strides.csv", "knee_swing_peak_deg", "deg", "flexion positive", "zero sign"),
        ("strides.csv", "ankle_push_off_plantarflexion_deg", "deg", "dorsiflexion positive", "zero sign"),
        ("strides.csv", "knee_swing_peak_percent", "%", "", "sign"),
        ("strides.csv", "step_time_s", "s", "", "both_clocks"),
        ("strides.csv", "stride_time_s", "s", "", ""),
        ("strides.csv", "speed_m_s", "m/s", "", ""),
        ("strides.csv", "stride_length_m", "m", "", ""),
        ("peaks.csv", "ankle_stance_dorsiflexion_percent", "%", "", "sign"),
        ("differences.csv", "against_mean", "as the parameter", "as the parameter", "parameter"),
        ("sides.csv", "right_n", "", "", ""),
        ("sides.csv", "symmetry_index_percent", "%", "", "parameter"),
    ],
)
def test_a_column_has_its_unit_its_sign_and_what_it_needs(
    out: Path, file: str, column: str, unit: str, sign: str, needs: str
) -> None:
    (row,) = [row for row in rows_of_columns(out) if (row["file"], row["column"]) == (file, column)]
    assert (row["unit"], row["sign"], row["needs"]) == (unit, sign, needs)
    assert len(row["definition"]) > 5


def test_a_column_that_nobody_described_is_an_error() -> None:
    with pytest.raises(KeyError):
        column_of("strides.csv", "left_knee_deg")
    assert column_of("compared_cycles.csv", "1A_left_knee_mean_deg").definition.endswith("of 1A")


def test_what_was_turned_is_reported_in_a_table_and_beside_its_walk(out: Path, snapshot: SnapshotAssertion) -> None:
    """The first ten columns as readers of earlier versions know them, and a text which no spreadsheet works out."""
    assert (out / "alignments.csv").read_text(encoding="utf-8").splitlines() == snapshot
    walks = json.loads((out / "summary.json").read_text(encoding="utf-8"))["walks"]
    part = {"part": "pylon", "turns": 0.5, "height_mm": 3.0, "text": "=1"}
    assert walks["walk 2"]["alignment"] == {"since": "shoes", "parts": [part]}
    assert "alignment" not in walks["walk 1"]


def test_programs_settings_and_returns_have_columns_of_their_own(tmp_path: Path) -> None:
    knee = ProsthesisPart.KNEE_UNIT
    parts = (
        PartChange(knee, program_before="Walk 1", program="=Walk 2"),
        PartChange(knee, setting="Swing flexion", setting_before=0.0, setting_value=-2.5),
    )
    walks = (
        Recording("walk 2", RecordingKind.WALKING, "2", {}, "B", alignment=AlignmentChange("A", parts)),
        Recording("walk 3", RecordingKind.WALKING, "3", {}, "A2", alignment=AlignmentChange("B", parts[:1], "A")),
    )
    write_alignments(walks, tmp_path / "alignments.csv")
    assert [tuple(row.values())[10:] for row in csv_rows(tmp_path / "alignments.csv")] == [
        ("Walk 1", "'=Walk 2", "", "", "", ""),
        ("", "", "Swing flexion", "0", "-2.5", ""),
        ("Walk 1", "'=Walk 2", "", "", "", "A"),
    ]


def test_where_nothing_was_changed_there_is_no_table_of_it(visit: Visit, tmp_path: Path) -> None:
    session, analysis = visit
    unchanged = replace(session, recordings=tuple(replace(one, alignment=None) for one in session.recordings))
    write_results(unchanged, analysis, tmp_path)
    assert not (tmp_path / "alignments.csv").exists()
    assert not (tmp_path / "set_angles.csv").exists()

"""Tests that a data frame states what the CSV files of the same session state, cell by cell."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.cli.main import main
from app.cohort.batch import analysed_folder
from app.exports.csv_report import write_angles
from app.exports.gait_csv import write_gait
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site
from core.results import Analysis, RecordingAnalysis
from core.verdicts.model import Assessment, JointVerdicts, LegVerdicts, Verdict, Verdicts
from devices.files.session_folder import read_session, write_session
from devices.simulation.walker import FreeMotion, Motion, Standing, Walk, WalkerSettings
from tests.app.exports.written_tables import csv_rows
from tests.simulated import LONG_WALK, analysis_of, session_of

HALF_A_DIGIT = 0.51e-5  # files have five decimals
WITH_PELVIS = WalkerSettings(
    seed=5,
    sites=(*LEG_SITES, Site.PELVIS),
    recordings=(
        Standing(duration_s=5.0),
        FreeMotion(name="free motion", duration_s=6.8, motion=Motion.LUNGES),
        Walk(strides=8),
    ),
)
WITHOUT_STANDING = WalkerSettings(
    seed=6,
    sites=(Site.LEFT_THIGH, Site.LEFT_SHANK, Site.RIGHT_SHANK, Site.RIGHT_FOOT),
    recordings=(FreeMotion(), Walk(strides=6)),
)
READ, CARE = Assessment(Verdict.READ), Assessment(Verdict.CARE)
NOT_REPORTED, NOT_MEASURED = Assessment(Verdict.NOT_REPORTED), Assessment(Verdict.NOT_MEASURED)
DOUBTED = {  # each word of status once
    Joint.LEFT_KNEE: JointVerdicts(READ, CARE, READ),
    Joint.LEFT_ANKLE: JointVerdicts(READ, NOT_REPORTED, READ),
    Joint.RIGHT_KNEE: JointVerdicts(READ, READ, NOT_REPORTED),
    Joint.RIGHT_ANKLE: JointVerdicts(NOT_REPORTED, NOT_REPORTED, NOT_REPORTED),
}
WORDS = {"left_knee": "care", "left_ankle": "no_zero", "right_knee": "range_only", "right_ankle": "withheld"}


def number(cell: str) -> float:
    return float(cell) if cell else math.nan


def in_frame(analysis: Analysis, table: str, recording: RecordingAnalysis) -> dict[tuple[str, str], list[list[Any]]]:
    """The rows of one recording by side and quantity."""
    frame = analysis.to_dataframe(table)
    frame = frame[frame["recording"] == recording.name]
    return {key: part.to_numpy().tolist() for key, part in frame.groupby(["side", "quantity"], sort=False)}


def assert_equal(found: list[list[Any]], place: int, cells: list[str]) -> None:
    np.testing.assert_allclose(
        [row[place] for row in found], [number(cell) for cell in cells], rtol=0, atol=HALF_A_DIGIT
    )


def hold_angles(analysis: Analysis, recording: RecordingAnalysis, path: Path) -> int:
    """Hold every column of angles.csv to the frame; how many curves there are."""
    table, found = csv_rows(path), in_frame(analysis, "angles", recording)
    columns = [name for name in table[0] if name.endswith("_deg") and not name.endswith("_sd_deg")]
    for column in columns:
        side, _, quantity = column.partition("_") if not column.startswith("pelvis") else ("", "", column)
        curve = found.pop((side, quantity))
        cells = {name: [row[name] for row in table] for name in table[0]}
        assert_equal(curve, 2, cells["time_s"])
        assert_equal(curve, 4, cells[column])
        if f"{column.removesuffix('_deg')}_sd_deg" in cells:
            assert_equal(curve, 5, cells[f"{column.removesuffix('_deg')}_sd_deg"])
        if f"{side}_{quantity.split('_')[0]}_status" in cells and "abduction" not in quantity:
            assert [row[6] for row in curve] == cells[f"{side}_{quantity.split('_')[0]}_status"]
    assert found == {}
    return len(columns)


def hold_cycles(analysis: Analysis, recording: RecordingAnalysis, path: Path) -> int:
    table, found = csv_rows(path), in_frame(analysis, "cycles", recording)
    cells = {name: [row[name] for row in table] for name in (table[0] if table else {})}
    joints = [name.removesuffix("_mean_deg") for name in cells if name.endswith("_mean_deg")]
    for joint in joints:
        side, _, kind = joint.partition("_")
        curves = {f"{kind}_deg": f"{joint}_mean_deg", f"{kind}_shape_deg": f"{joint}_shape_deg"}
        for quantity, column in curves.items():
            if column in cells:
                curve = found.pop((side, quantity))
                assert [row[2] for row in curve] == list(map(int, cells["percent"]))
                assert_equal(curve, 4, cells[column])
                assert_equal(curve, 5, cells[f"{joint}_stride_sd_deg"])
                assert [row[6] for row in curve] == cells[f"{joint}_status"]
                assert [row[7] for row in curve] == list(map(int, cells[f"{joint}_n"]))
    assert found == {}
    return len(joints)


OWN_STATUS = {"stride_time_s": "timing", "step_time_s": "between", "stride_length_m": "distance"}
OWN_STATUS |= {"knee_range_deg": "knee_shape", "ankle_swing_dorsiflexion_deg": "ankle_height"}
OWN_STATUS |= {"hip_range_deg": "hip_shape", "hip_abduction_range_deg": "hip_abduction"}


def hold_strides(analysis: Analysis, recording: RecordingAnalysis, path: Path) -> int:
    table, found, held = csv_rows(path), in_frame(analysis, "strides", recording), 0
    for (side, quantity), figures in found.items():
        mine = [row for row in table if row["side"] == side]
        assert_equal(figures, 2, [row["start_s"] for row in mine])
        assert_equal(figures, 4, [row[quantity] for row in mine])
        assert [row[7] for row in figures] == [row["used"] == "true" for row in mine]
        assert [row[8] for row in figures] == [row["reason"] for row in mine]
        if quantity in OWN_STATUS:
            assert [row[6] for row in figures] == [row[f"{OWN_STATUS[quantity]}_status"] for row in mine]
            held += 1
    return held


@pytest.mark.parametrize(("settings", "most_curves"), [(WITH_PELVIS, 19), (WITHOUT_STANDING, 6)])
def test_a_frame_states_what_the_files_of_a_session_state(
    settings: WalkerSettings, most_curves: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(analysed_folder, "analyse", lambda session, *_: analysis_of(session))
    write_session(session_of(settings), tmp_path / "session")
    out = tmp_path / "out"
    assert main(["analyse", str(tmp_path / "session"), "--out", str(out), "--no-report", "--no-rrd"]) == 0
    analysis = analysis_of(read_session(tmp_path / "session"))
    curves, cycles, strides = [], [], []
    for recording in analysis.recordings:
        folder = out / recording.folder
        curves.append(hold_angles(analysis, recording, folder / "angles.csv"))
        cycles.append(hold_cycles(analysis, recording, folder / "cycles.csv"))
        strides.append(hold_strides(analysis, recording, folder / "strides.csv"))
    assert max(curves) == most_curves
    assert max(cycles) > 0
    assert max(strides) > 0


@pytest.fixture
def doubted() -> Analysis:
    """A walk with each word of status, whose right straps slipped half way."""
    found = analysis_of(session_of(LONG_WALK))
    walk = found.recordings[-1]
    legs = {Side.LEFT: LegVerdicts(READ, NOT_REPORTED), Side.RIGHT: LegVerdicts(NOT_REPORTED, CARE)}
    verdicts = Verdicts(DOUBTED, legs, between=NOT_MEASURED)
    half_s = float(walk.time_s[len(walk.time_s) // 2])
    slipped = replace(walk, verdicts=verdicts, slipped_from_s={Side.RIGHT: half_s})
    return replace(found, recordings=(slipped,))


def test_every_word_of_status_and_a_strap_that_slipped_are_the_files(doubted: Analysis, tmp_path: Path) -> None:
    (walk,) = doubted.recordings
    write_angles(walk, tmp_path / "angles.csv")
    write_gait(walk, tmp_path)
    assert hold_angles(doubted, walk, tmp_path / "angles.csv") == 12
    assert hold_cycles(doubted, walk, tmp_path / "cycles.csv") == len(LEG_JOINTS)
    assert hold_strides(doubted, walk, tmp_path / "strides.csv") == 10
    frame = doubted.to_dataframe("angles")
    for joint, word in WORDS.items():
        side, kind = joint.split("_")
        one = frame[(frame["side"] == side) & (frame["quantity"] == f"{kind}_deg")]
        assert one["status"].iloc[0] == word
        assert one["status"].iloc[-1] == ("withheld" if side == "right" else word)


def test_a_figure_of_a_cycle_or_a_stride_that_is_not_reported_has_no_value(doubted: Analysis) -> None:
    cycles, strides = doubted.to_dataframe("cycles"), doubted.to_dataframe("strides")
    known = {key: bool(part["value"].notna().all()) for key, part in cycles.groupby(["side", "quantity"])}
    assert known == {
        ("left", "ankle_deg"): False,  # without a zero the shape alone holds
        ("left", "ankle_shape_deg"): True,
        ("left", "knee_deg"): True,
        ("left", "knee_shape_deg"): True,
        ("right", "ankle_deg"): False,
        ("right", "ankle_shape_deg"): False,
        ("right", "knee_deg"): False,
        ("right", "knee_shape_deg"): False,
    }
    is_kept = strides["status"].isin(["read", "care"])
    assert strides[~is_kept]["value"].notna().sum() == 0
    assert strides[is_kept & strides["used"]]["value"].notna().all()
    assert 0 < is_kept.sum() < len(strides)

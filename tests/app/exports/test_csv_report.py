"""Tests that angles.csv holds exactly the numbers of the analysis, in the columns that others rely on."""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.exports import csv_report
from app.exports.csv_report import write_angles
from core.body import LEG_JOINTS, Joint, Side
from core.results import JointAngle, RecordingAnalysis
from core.samples import FloatArray
from core.session import RecordingKind
from core.verdicts.model import READ, Assessment, JointVerdicts, Verdict, Verdicts
from tests.app.exports.written_tables import csv_rows

GOLDEN = Path(__file__).parents[2] / "golden"


def recording(time_s: FloatArray, joints: dict[Joint, JointAngle]) -> RecordingAnalysis:
    return RecordingAnalysis("walk 1", "walk_1", RecordingKind.WALKING, time_s, joints)


def knee_and_ankle() -> RecordingAnalysis:
    nan = np.nan
    knee = JointAngle(
        angle_rad=np.array([0.0, -1e-9, np.pi / 3, nan, 7.0]),
        sd_rad=np.array([0.03, 0.03, 0.03, nan, 0.03]),
        published_rad=np.array([0.1, nan, -0.2, 0.3, np.inf]),
        orientation_rad=None,
    )
    ankle = JointAngle(
        angle_rad=np.array([0.1, -0.1, 0.2, 0.25, 1.0]),
        sd_rad=np.full(5, 0.01),
        published_rad=np.array([0.2, -0.2, 0.4, 0.5, 2.0]),
        orientation_rad=np.full(5, -1.0),
    )
    time_s = np.array([12.3, 12.31, 0.1 + 0.2 + 13.0, 1e5 + 1 / 3, 123456789.01])
    walk = recording(time_s, {Joint.RIGHT_ANKLE: ankle, Joint.LEFT_KNEE: knee})
    stated = {
        Joint.LEFT_KNEE: JointVerdicts(READ, Assessment(Verdict.CARE), READ),
        Joint.RIGHT_ANKLE: JointVerdicts(READ, Assessment(Verdict.NOT_REPORTED), READ),
    }
    return replace(walk, verdicts=Verdicts(stated), slipped_from_s={Side.LEFT: 1000.0})


def random_walk(n: int) -> RecordingAnalysis:
    rng = np.random.default_rng(7)
    angle_rad = np.cumsum(rng.normal(scale=0.05, size=n))
    angle_rad[rng.random(n) < 0.1] = np.nan
    angle = JointAngle(angle_rad, np.abs(angle_rad), -angle_rad, angle_rad / 3)
    return recording(1000 + np.arange(n) / 100, dict.fromkeys(LEG_JOINTS, angle))


def test_angles_read_as_agreed(tmp_path: Path) -> None:
    write_angles(knee_and_ankle(), tmp_path / "angles.csv")
    assert (tmp_path / "angles.csv").read_bytes() == (GOLDEN / "angles.csv").read_bytes()


def reported(path: Path, column: str) -> list[str]:
    return [row[column] for row in csv_rows(path)]


@pytest.mark.parametrize(
    ("shape", "height", "sign", "status"),
    [
        ("read", "read", "read", "read"),
        ("care", "read", "read", "care"),
        ("read", "care", "read", "care"),
        ("read", "withheld", "read", "no_zero"),
        ("care", "withheld", "withheld", "range_only"),
        ("withheld", "withheld", "withheld", "withheld"),
        ("withheld", "read", "read", "withheld"),
        ("not_measured", "not_measured", "not_measured", ""),
    ],
)
def test_each_row_states_what_may_be_read_and_keeps_its_samples(
    tmp_path: Path, shape: str, height: str, sign: str, status: str
) -> None:
    walk, parts = random_walk(20), [Assessment(Verdict(one)) for one in (shape, height, sign)]
    walk = replace(walk, verdicts=Verdicts({Joint.LEFT_ANKLE: JointVerdicts(*parts)}))
    write_angles(walk, tmp_path / "angles.csv")
    assert reported(tmp_path / "angles.csv", "left_ankle_status") == [status] * 20
    assert reported(tmp_path / "angles.csv", "right_ankle_status") == [""] * 20
    known = [bool(cell) for cell in reported(tmp_path / "angles.csv", "left_ankle_deg")]
    assert known == np.isfinite(walk.joints[Joint.LEFT_ANKLE].angle_rad).tolist()


def test_from_where_a_strap_slipped_the_rows_of_its_leg_are_not_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(csv_report, "ROWS_PER_BLOCK", 30)
    walk = random_walk(100)
    stated = Verdicts(dict.fromkeys(LEG_JOINTS, JointVerdicts(READ, READ, READ)))
    slipped = replace(walk, verdicts=stated, slipped_from_s={Side.RIGHT: float(walk.time_s[40])})
    write_angles(slipped, tmp_path / "angles.csv")
    for joint in LEG_JOINTS:
        good = 40 if joint.side is Side.RIGHT else 100
        assert reported(tmp_path / "angles.csv", f"{joint}_status") == ["read"] * good + ["withheld"] * (100 - good)
    never = replace(slipped, slipped_from_s={Side.RIGHT: -np.inf})
    write_angles(never, tmp_path / "angles.csv")
    assert set(reported(tmp_path / "angles.csv", "right_knee_status")) == {"withheld"}


def test_a_table_without_samples_or_joints_keeps_its_heading(tmp_path: Path) -> None:
    write_angles(recording(np.empty(0), {}), tmp_path / "angles.csv")
    assert (tmp_path / "angles.csv").read_text() == "time_s,left_phase,right_phase\n"


def test_every_number_comes_back_and_every_gap_is_an_empty_cell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(csv_report, "ROWS_PER_BLOCK", 300)
    walk = random_walk(1000)
    write_angles(walk, tmp_path / "angles.csv")
    rows = csv_rows(tmp_path / "angles.csv")
    assert [float(row["time_s"]) for row in rows] == walk.time_s.tolist()
    for joint, angle in walk.joints.items():
        read = [float(row[f"{joint}_deg"] or "nan") for row in rows]
        np.testing.assert_allclose(read, np.rad2deg(angle.angle_rad), rtol=0, atol=0.5001e-5)
    assert {row["left_phase"] + row["right_phase"] for row in rows} == {""}


def test_the_size_of_a_block_does_not_show(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_angles(random_walk(1000), tmp_path / "whole.csv")
    monkeypatch.setattr(csv_report, "ROWS_PER_BLOCK", 250)
    write_angles(random_walk(1000), tmp_path / "blocks.csv")
    assert (tmp_path / "whole.csv").read_bytes() == (tmp_path / "blocks.csv").read_bytes()


def test_one_hour_of_four_joints_is_written_in_seconds(tmp_path: Path) -> None:
    hour = random_walk(360_000)
    start_s = time.process_time()
    write_angles(hour, tmp_path / "angles.csv")
    assert time.process_time() - start_s < 10  # 0.6 s on the machine it was written on
    assert (tmp_path / "angles.csv").stat().st_size > 360_000 * 60

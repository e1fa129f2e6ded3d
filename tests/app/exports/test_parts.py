"""Exports leave out what is not known without a hole, an empty file or a silence."""

from dataclasses import replace
from pathlib import Path

import ezc3d
import numpy as np
import pytest

from app.exports.c3d_angles import MOST_FRAMES, write_c3d
from app.exports.exports import Format, export_from_folder
from app.exports.opensim_motion import write_motion
from core.body import Joint
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.verdicts.model import GateReason, JointVerdicts, Verdict, assess
from devices.files.references.reading import read_reference
from tests.app.exports.conftest import Visit

KNEE = Joint.LEFT_KNEE


def missing(walk: RecordingAnalysis, *rows: slice) -> RecordingAnalysis:
    """The walk without the left knee's angle in some rows, and with no other joint."""
    angle = walk.joints[KNEE]
    angle_rad = angle.angle_rad.copy()
    for some in rows:
        angle_rad[some] = np.nan
    return replace(walk, joints={KNEE: replace(angle, angle_rad=angle_rad)})


def table_of(path: Path) -> tuple[str, FloatArray]:
    head, body = path.read_text().split("endheader\n")
    return head, np.array([[float(cell) for cell in line.split("\t")] for line in body.splitlines()[1:]])


def test_a_motion_file_ends_at_a_gap_and_another_one_begins(walk: RecordingAnalysis, tmp_path: Path) -> None:
    n = len(walk.time_s)
    assert write_motion(missing(walk, slice(0, 20), slice(300, 340), slice(n - 5, n)), False, tmp_path / "a.mot") == ""
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a_1.mot", "a_2.mot"]
    knee_deg = np.maximum(np.rad2deg(walk.joints[KNEE].angle_rad), 0.0)  # as far as the model's knee goes
    for number, rows in ((1, slice(20, 300)), (2, slice(340, n - 5))):
        head, values = table_of(tmp_path / f"a_{number}.mot")
        np.testing.assert_array_equal(values[:, 0], walk.time_s[rows])
        np.testing.assert_allclose(values[:, 1], knee_deg[rows], atol=1e-5)
        assert f"Part {number} of 2, {walk.time_s[rows][0]:.3f} to {walk.time_s[rows][-1]:.3f} s.\n" in head
        assert f"nRows={len(values)}\n" in head


def test_a_short_gap_is_bridged_and_stated(walk: RecordingAnalysis, tmp_path: Path) -> None:
    assert write_motion(missing(walk, slice(300, 309)), False, tmp_path / "a.mot") == ""
    head, values = table_of(tmp_path / "a.mot")
    assert len(values) == len(walk.time_s)
    assert np.isfinite(values).all()
    assert "knee_angle_l is interpolated over gaps of up to 0.1 s, 9 rows.\n" in head
    knee_deg = np.rad2deg(walk.joints[KNEE].angle_rad)
    np.testing.assert_allclose(values[299:310, 1], np.linspace(knee_deg[299], knee_deg[309], 11), atol=1e-4)
    write_motion(missing(walk), False, tmp_path / "whole.mot")
    assert "interpolated" not in (tmp_path / "whole.mot").read_text()
    write_motion(missing(walk, slice(300, 310)), False, tmp_path / "longer.mot")
    assert sorted(path.name for path in tmp_path.glob("longer*")) == ["longer_1.mot", "longer_2.mot"]


def test_rows_that_are_missing_for_long_end_a_motion_file_too(walk: RecordingAnalysis, tmp_path: Path) -> None:
    kept = np.setdiff1d(np.arange(len(walk.time_s)), np.arange(300, 500))
    angle = walk.joints[KNEE]
    paused = replace(walk, time_s=walk.time_s[kept], joints={KNEE: replace(angle, angle_rad=angle.angle_rad[kept])})
    write_motion(paused, False, tmp_path / "a.mot")
    assert [len(table_of(tmp_path / f"a_{number}.mot")[1]) for number in (1, 2)] == [300, len(kept) - 300]


def test_what_is_not_reported_leaves_no_empty_file_and_a_line_why(
    visit: Visit, walk: RecordingAnalysis, tmp_path: Path
) -> None:
    no_axis = assess([GateReason("axis", Verdict.NOT_REPORTED, 12.0, 9.0, "deg")])
    not_reported = dict.fromkeys(walk.joints, JointVerdicts(no_axis, no_axis, no_axis))
    recordings = tuple(
        replace(r, verdicts=replace(r.verdicts, joints=not_reported), gait={}) for r in visit[1].recordings
    )
    analysis = replace(visit[1], recordings=recordings)
    lines = export_from_folder(visit[0], analysis, [Format.C3D, Format.MOT, Format.XLSX], tmp_path)
    assert [str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*")] == ["gaitwright.xlsx"]
    why = "The calibration has an uncertainty of ±12.0° (limit ±9.0°). Record free motion, or let the "
    why += "patient move longer and in more directions."
    assert lines == [
        f"free motion, c3d: This recording has neither angles nor events to export. {why}",
        f"walk 1, c3d: This recording has neither angles nor events to export. {why}",
        f"free motion, mot: This recording has no angle to export as a pose. {why}",
        f"walk 1, mot: This recording has no angle to export as a pose. {why}",
    ]
    assert export_from_folder(*visit, [Format.C3D, Format.MOT, Format.BIDS], tmp_path) == []


def test_recordings_without_samples_are_no_set_of_data(visit: Visit, tmp_path: Path) -> None:
    bare = replace(visit[0], recordings=tuple(replace(r, is_kept=False) for r in visit[0].recordings))
    lines = export_from_folder(bare, visit[1], [Format.BIDS], tmp_path)
    assert lines == ["bids-motion: No included recording contains sensor data."]
    assert list(tmp_path.rglob("*")) == []


def longer(walk: RecordingAnalysis, frames: int) -> RecordingAnalysis:
    """The left knee's angle over and over again, 200 times a second, with its events."""
    angle = walk.joints[KNEE]
    angle_rad = np.resize(angle.angle_rad, frames)
    time_s = 3.0 + np.arange(frames) / 200.0
    return replace(walk, time_s=time_s, joints={KNEE: replace(angle, angle_rad=angle_rad)})


def angles_in(path: Path) -> FloatArray:
    return np.asarray(ezc3d.c3d(str(path))["data"]["points"][0, 0])


def test_a_c3d_that_is_too_long_goes_on_in_another_file(
    walk: RecordingAnalysis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.exports.c3d_angles.MOST_FRAMES", 700)
    long = longer(walk, 1500)
    assert write_c3d(long, False, tmp_path / "angles.c3d") == ""
    parts = [tmp_path / f"angles_{number}.c3d" for number in (1, 2, 3)]
    assert sorted(tmp_path.iterdir()) == parts
    np.testing.assert_allclose(
        np.concatenate([angles_in(path) for path in parts]), np.rad2deg(long.joints[KNEE].angle_rad), atol=1e-4
    )
    read = [ezc3d.c3d(str(path))["parameters"] for path in parts]
    assert [one["PROCESSING"]["PART_STARTS_S"]["value"][0] for one in read] == pytest.approx([0.0, 3.5, 7.0])
    write_c3d(replace(long, time_s=long.time_s[:700], joints={}), False, tmp_path / "first.c3d")
    times_s = []
    for starts_s, one in zip((0.0, 3.5, 7.0), read, strict=True):
        used = int(one["EVENT"]["USED"]["value"][0])
        if used:
            minutes, seconds = one["EVENT"]["TIMES"]["value"]
            times_s += list(starts_s + 60.0 * minutes + seconds)
    found = np.concatenate([getattr(e, f"{n}_s") for g in walk.gait.values() for e in g.events for n in NAMES])
    np.testing.assert_allclose(np.sort(times_s), np.sort(found[np.isfinite(found)]) - 3.0, atol=1e-3)


NAMES = ("initial_contact", "full_contact", "heel_rise", "toe_off")


@pytest.mark.endurance
def test_six_minutes_at_200_hz_are_whole_in_our_reader_and_in_another(walk: RecordingAnalysis, tmp_path: Path) -> None:
    long = longer(walk, 72_000)
    write_c3d(long, False, tmp_path / "angles.c3d")
    parts = [tmp_path / "angles_1.c3d", tmp_path / "angles_2.c3d"]
    assert [len(angles_in(path)) for path in parts] == [MOST_FRAMES, 72_000 - MOST_FRAMES]
    for path in parts:
        (trial,) = read_reference(path).trials
        time_s, angle_rad = trial.angles[KNEE]
        assert len(time_s) == len(angles_in(path))
        assert np.isfinite(angle_rad).all()

"""Tests that orientations leave as OpenSense takes them, in one earth, and come back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from app.exports.exports import Format, export_from_folder
from app.exports.opensim_orientations import IMUS, write_orientations
from core.body import Side, Site
from core.orientations import orientations_of
from core.samples import FloatArray
from core.verdicts.model import GateReason, JointVerdicts, Verdict, assess
from devices.files.opensim_orientations import opensim_trial
from devices.simulation.walker import RecordingTruth
from tests.app.exports.conftest import Visit
from tests.app.hip_visits import hip_analysis, hip_session

IMU_OF = {
    "left_thigh": "femur_l_imu",
    "left_shank": "tibia_l_imu",
    "left_foot": "calcn_l_imu",
    "right_thigh": "femur_r_imu",
    "right_shank": "tibia_r_imu",
    "right_foot": "calcn_r_imu",
    "pelvis": "pelvis_imu",
}


@pytest.fixture(scope="module")
def written(visit: Visit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("orientations")
    assert write_orientations(*visit, folder, "orientations.sto") == []
    return folder


def rotations(path: Path) -> tuple[FloatArray, dict[str, Rotation]]:
    """Read a table as its layout is documented; rotations earth from sensor."""
    _, body = path.read_text(encoding="ascii").split("endheader\n")
    names, *rows = (line.split("\t") for line in body.splitlines())
    assert names[0] == "time"
    found = {
        name: Rotation.from_quat([[float(one) for one in row[k].split(",")] for row in rows], scalar_first=True)
        for k, name in enumerate(names[1:], 1)
    }
    return np.array([float(row[0]) for row in rows]), found


def of_walk(written: Path) -> Path:
    (path,) = written.glob("walk*/orientations.sto")
    return path


def test_every_recording_has_a_table_whose_head_states_what_it_is(written: Path) -> None:
    assert len(list(written.glob("*/orientations.sto"))) == 3  # standing too, which places the sensors on a model
    head, body = of_walk(written).read_text(encoding="ascii").split("endheader\n")
    assert head.startswith("DataRate=100.000000\nDataType=Quaternion\nversion=3\nSIMULATED: nobody was measured.\n")
    assert "sensor_to_opensim_rotations are -1.5707963 0 0.\n" in head
    assert "Headings are not measured." in head
    legs = [name for name in IMU_OF.values() if name != "pelvis_imu"]
    assert sorted(body.split("\n")[0].split("\t")) == sorted(["time", *legs])
    assert {str(site): name for site, name in IMUS.items()} == IMU_OF


def test_what_a_thigh_and_a_shank_turn_against_each_other_is_the_patients_knee(
    written: Path, truth: RecordingTruth
) -> None:
    """From standing, about the axis to the left: flexion and dorsiflexion, without a step of our analysis."""
    _, standing = rotations(next(written.glob("standing*/orientations.sto")))
    time_s, walking = rotations(of_walk(written))
    for joint, known in truth.joints.items():
        letter = joint.side[0]
        bodies = ("femur", "tibia") if joint.is_knee else ("tibia", "calcn")
        proximal, distal = (f"{body}_{letter}_imu" for body in bodies)
        # what each segment has turned by since standing, in the earth that all share
        one, two = (walking[imu] * standing[imu][50].inv() for imu in (proximal, distal))
        turned_deg = (one.inv() * two).as_rotvec(degrees=True)[:, 1]
        true_deg = np.rad2deg(np.interp(time_s, known.time_s, known.angle_rad - known.standing_rad))
        error_deg = turned_deg - true_deg if joint.is_knee else -turned_deg - true_deg
        assert np.sqrt(np.mean(error_deg**2)) < 2.5, joint


def test_nobody_turns_about_the_vertical(written: Path) -> None:
    """Both thighs face forward throughout, whatever their filters began with."""
    _, walking = rotations(of_walk(written))
    _, standing = rotations(next(written.glob("standing*/orientations.sto")))
    for side in Side:
        imu = f"femur_{side[0]}_imu"
        turned = (walking[imu] * standing[imu][50].inv()).as_matrix()
        across = turned[:, :, 1]  # the direction that was to the left while standing
        assert np.abs(np.rad2deg(np.arctan2(across[:, 0], across[:, 1]))).max() < 12.0


def test_our_reader_takes_the_orientations_back_to_the_last_digit(visit: Visit, written: Path, tmp_path: Path) -> None:
    trial = opensim_trial([of_walk(written)])
    time_s, walking = rotations(of_walk(written))
    assert trial.is_simulated
    assert {sensor.name for sensor in trial.sensors} == set(walking)
    for sensor in trial.sensors:
        np.testing.assert_allclose(sensor.block.time_s, time_s - time_s[0], atol=1e-9)
        assert sensor.block.q_earth_from_sensor is not None
        back = Rotation.from_quat(sensor.block.q_earth_from_sensor, scalar_first=True)
        assert (back.inv() * walking[sensor.name]).magnitude().max() < 1e-7
    session, analysis = visit
    write_orientations(replace(session, is_simulated=False), analysis, tmp_path, "orientations.sto")
    assert not opensim_trial([of_walk(tmp_path)]).is_simulated


def test_a_gap_and_a_slipped_strap_end_a_table(visit: Visit, tmp_path: Path) -> None:
    session, analysis = visit
    walk = session.recordings[-1]
    block = walk.imu[Site.LEFT_SHANK]
    lost = block.select(np.r_[0:600, 700 : len(block)])
    session = replace(
        session,
        recordings=(*session.recordings[:-1], replace(walk, imu={**walk.imu, Site.LEFT_SHANK: lost})),
    )
    recordings = tuple(
        replace(one, slipped_from_s={Side.RIGHT: 10.0}) if one.name == walk.name else one for one in analysis.recordings
    )
    assert write_orientations(session, replace(analysis, recordings=recordings), tmp_path, "orientations.sto") == []
    whole, without, after, last = (
        rotations(tmp_path / walk.folder / f"orientations_{number}.sto") for number in (1, 2, 3, 4)
    )
    assert "tibia_l_imu" in whole[1]
    assert not {"tibia_l_imu", "calcn_l_imu"} & set(without[1])
    assert "tibia_l_imu" in after[1]
    assert {name.split("_")[1] for name in last[1]} == {"l"}
    assert last[0][0] == pytest.approx(10.0, abs=0.011)
    head = (tmp_path / walk.folder / "orientations_2.sto").read_text().split("endheader")[0]
    assert "tibia_l_imu is not known in this part.\n" in head


def test_what_may_be_mirrored_or_swapped_is_left_out_and_a_line_gives_the_reason(visit: Visit, tmp_path: Path) -> None:
    no_sign = assess([GateReason("sign", Verdict.NOT_REPORTED, 0.1, 0.25)])
    session, analysis = visit
    for sides, expected in (((Side.LEFT,), {"r"}), (tuple(Side), set())):
        recordings = []
        for one in analysis.recordings:
            joints = {
                joint: JointVerdicts(found.shape, no_sign, no_sign) if joint.side in sides else found
                for joint, found in one.verdicts.joints.items()
            }
            recordings.append(replace(one, verdicts=replace(one.verdicts, joints=joints)))
        folder = tmp_path / str(len(sides))
        lines = export_from_folder(
            session, replace(analysis, recordings=tuple(recordings)), [Format.STO], folder_of(folder)
        )
        found = [rotations(path)[1] for path in folder.rglob("*.sto")]
        assert {name.split("_")[1] for names in found for name in names} == expected
        why = "This recording has no orientations to export: no calibrated joint holds its sensors."
        names = ("standing 1", "free motion", "walk 1")
        assert len(lines) == (0 if expected else len(names))
        assert all(line.startswith("sto, ") and line.endswith(why) for line in lines)


def folder_of(path: Path) -> Path:
    path.mkdir()
    return path


def test_a_sensor_on_the_pelvis_is_in_the_table(tmp_path: Path) -> None:
    analysis, session = hip_analysis(), hip_session()
    write_orientations(session, analysis, tmp_path, "orientations.sto")
    _, walking = rotations(of_walk(tmp_path))
    assert "pelvis_imu" in walking
    _, standing = rotations(next(tmp_path.glob("standing*/orientations.sto")))
    # the trunk stays upright: what pointed up while standing does so within some degrees
    up = (walking["pelvis_imu"] * standing["pelvis_imu"][50].inv()).as_matrix()[:, 2, 2]
    assert np.rad2deg(np.arccos(np.clip(up, -1, 1))).max() < 15.0


def test_an_upright_axis_gives_no_direction(visit: Visit) -> None:
    """Somebody who lies on the side in the free motion: thigh and shank face nowhere then."""
    session, analysis = visit
    free = session.recordings[1]
    lying = {}
    for site, block in free.imu.items():
        calibration = analysis.calibrated_for(analysis.recordings[0])
        joint = next(joint for joint in calibration if site in (joint.proximal, joint.distal))
        known = calibration[joint]
        axis = known.axis_proximal if site is joint.proximal else known.axis_distal
        still = np.zeros_like(block.gyr_rad_s) + 1e-4 * np.random.default_rng(1).normal(size=block.gyr_rad_s.shape)
        noise = 0.01 * np.random.default_rng(2).normal(size=block.acc_m_s2.shape)
        lying[site] = replace(block, gyr_rad_s=still, acc_m_s2=9.81 * np.ones((len(block), 1)) * axis + noise)
    session = replace(session, recordings=(session.recordings[0], replace(free, imu=lying), session.recordings[2]))
    reported = {one.name: list(one.joints) for one in analysis.recordings}
    found = {recording.name: one for recording, one in orientations_of(session, analysis, reported)}[free.name]
    assert np.isnan(found.q_earth_from_sensor[Site.LEFT_THIGH]).all()

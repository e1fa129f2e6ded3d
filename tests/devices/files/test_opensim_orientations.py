"""Tests that OpenSim's tables of orientations, written as it documents them, become motion.

What they lack is reported.
"""

from pathlib import Path

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from core.analysis import analyse
from core.body import Joint, Site
from core.findings import Severity
from core.session import Recording, RecordingKind, Session
from devices.files.formats import format_of
from devices.files.opensim_orientations import opensim_trial
from devices.files.site_names import site_of_name
from tests.swinging_sensor import SwingingSensor, swinging_sensor
from tests.trials_of_files import import_with, refused

HEAD = ["DataRate=100.000000", "DataType=Quaternion", "version=3", "OpenSimVersion=4.4-2022-07-23", "endheader"]
NAMES = ("femur_l_imu", "tibia_l_imu")


def sto(path: Path, *sensors: SwingingSensor, head: list[str] = HEAD, keep: slice = slice(None)) -> Path:
    lines = ["\t".join(["time", *NAMES[: len(sensors)]])]
    for row, time_s in enumerate(sensors[0].time_s):
        cells = [",".join(f"{part:.12f}" for part in one.q_earth_from_sensor[row]) for one in sensors]
        lines.append("\t".join([f"{time_s:.6f}", *cells]))
    path.write_text("\n".join([*head, lines[0], *lines[1:][keep], ""]))
    return path


def edited(path: Path, old: str, new: str) -> Path:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    return path


def refusal(path: Path) -> str:
    return refused(opensim_trial, [path])


def test_orientations_become_rates_with_gravity_for_acceleration(tmp_path: Path) -> None:
    truth = swinging_sensor(), swinging_sensor(reach_rad=0.3)
    trial = opensim_trial([sto(tmp_path / "a.sto", *truth)])
    for found, one, name in zip(trial.sensors, truth, NAMES, strict=True):
        assert (found.name, found.info.rate_hz) == (name, 100.0)
        np.testing.assert_allclose(found.block.time_s, one.time_s, atol=1e-6)
        np.testing.assert_allclose(found.block.gyr_rad_s[2:-2], one.gyr_rad_s[2:-2], atol=0.005)
        np.testing.assert_allclose(np.linalg.norm(found.block.acc_m_s2, axis=1), 9.81, atol=1e-9)
        assert found.block.is_rate_derived
        assert [(finding.key, finding.severity) for finding in found.findings] == [
            ("rate_from_orientation", Severity.INFO),
            ("gravity_for_acceleration", Severity.WARNING),
        ]


def test_gravity_points_where_the_sensor_would_feel_it(tmp_path: Path) -> None:
    one = swinging_sensor()
    (found,) = opensim_trial([sto(tmp_path / "a.sto", one)]).sensors
    error = found.block.acc_m_s2 - one.acc_m_s2
    np.testing.assert_allclose(np.linalg.norm(error, axis=1), np.linalg.norm(one.free_m_s2, axis=1), atol=1e-6)


def test_other_tables_of_opensim_are_none(tmp_path: Path) -> None:
    path = sto(tmp_path / "a.sto", swinging_sensor())
    assert format_of(path) == "opensim"
    assert format_of(edited(path, "DataType=Quaternion", "DataType=double")) is None
    (tmp_path / "b.mot").write_text(
        "Coordinates\nversion=1\nnRows=1\ninDegrees=yes\nendheader\ntime\tknee_angle_l\n0\t1\n"
    )
    assert format_of(tmp_path / "b.mot") is None


def test_sensors_are_placed_by_the_bodies_they_are_named_after(tmp_path: Path) -> None:
    path = sto(tmp_path / "a.sto", swinging_sensor(), swinging_sensor())
    assert [site_of_name(name) for name in (*NAMES, "calcn_r_imu")] == [
        Site.LEFT_THIGH,
        Site.LEFT_SHANK,
        Site.RIGHT_FOOT,
    ]
    placed = {Site.LEFT_THIGH: NAMES[0], Site.LEFT_SHANK: NAMES[1]}
    assert set(import_with(opensim_trial, [path], placed, "walk 1").imu) == set(placed)


def test_missing_rows_and_cells_are_gaps(tmp_path: Path) -> None:
    path = sto(tmp_path / "a.sto", swinging_sensor())
    text = path.read_text().splitlines()
    del text[100:150]
    cells = text[60].split("\t")
    text[60] = f"{cells[0]}\t"
    path.write_text("\n".join([*text, ""]).replace(f"{cells[0]}\t\n", f"{cells[0]}\tnan,nan,nan,nan\n"))
    block = opensim_trial([path]).sensors[0].block
    assert len(block) == 250
    assert float(np.diff(block.time_s).max()) == pytest.approx(0.51)
    assert np.isnan(block.acc_m_s2[54]).all()
    assert np.isnan(block.gyr_rad_s[53:56]).any(axis=1).all()


def test_a_table_without_rows_is_an_empty_recording(tmp_path: Path) -> None:
    (sensor,) = opensim_trial([sto(tmp_path / "a.sto", swinging_sensor(), keep=slice(0))]).sensors
    assert len(sensor.block) == 0


def test_what_is_damaged_is_refused_where_it_is(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    path = tmp_path / "a.sto"

    def good() -> Path:
        return sto(path, swinging_sensor(), swinging_sensor())

    def of(old: str, new: str) -> str:
        return refusal(edited(good(), old, new))

    back = good().read_text()
    for k in range(100, 300):
        back = back.replace(f"{0.01 * k:.6f}\t", f"{0.01 * k - 0.5:.6f}\t")
    path.write_text(back)
    assert {
        "times go back": refusal(path),
        "no end of the head": of("endheader", "end"),
        "no times": of("time", "t"),
        "a sensor twice": of("tibia_l_imu", "femur_l_imu"),
        "a cell too few": of("0.020000\t", "0.020000"),
        "an orientation of no length": of("0.020000\t", "0.020000\t9"),
        "times that are not even": of("0.020000\t", "0.025000\t"),
    } == snapshot
    assert "is not an orientation of four numbers" in of("0.020000\t", "0.020000\t1.0,")
    assert "line 9: a value is not a number" in of("0.020000\t", "0.020000\tx")  # then in NumPy's words
    path.write_bytes(good().read_bytes().replace(b"0.020000\t", b"0.02\xff\xfe\t"))
    assert "a.sto, line 9: a value is not a number" in refusal(path)


def test_decimal_commas_and_rows_cut_at_the_end_are_read(tmp_path: Path) -> None:
    whole = sto(tmp_path / "a.sto", swinging_sensor(), swinging_sensor())
    lines = whole.read_text().splitlines()
    numbers = [line.replace(".", ",") for line in lines[len(HEAD) + 1 :]]
    (tmp_path / "b.sto").write_text("\n".join([*lines[: len(HEAD) + 1], *numbers, "9,990000", ""]))
    one, other = (opensim_trial([tmp_path / name]).sensors[0] for name in ("a.sto", "b.sto"))
    np.testing.assert_array_equal(one.block.q_earth_from_sensor, other.block.q_earth_from_sensor)
    assert [found.key for found in other.findings][:1] == ["rows_cut_short"]


def test_the_angle_between_two_sensors_is_known_without_acceleration(tmp_path: Path) -> None:
    thigh, shank = swinging_sensor(1500), swinging_sensor(1500, reach_rad=0.2)
    placed = {Site.LEFT_THIGH: NAMES[0], Site.LEFT_SHANK: NAMES[1]}
    imported = import_with(opensim_trial, [sto(tmp_path / "a.sto", thigh, shank)], placed, "walk 1")
    recording = Recording("walk 1", RecordingKind.WALKING, "walk_1", imported.imu)
    (walk,) = analyse(Session((recording,), sensors=imported.sensors)).recordings
    angle = np.degrees(walk.joints[Joint.LEFT_KNEE].angle_rad)
    truth = np.degrees(0.5 * np.sin(5.65 * walk.time_s))
    inner = np.isfinite(angle) & (walk.time_s > 1.0) & (walk.time_s < 14.0)
    error = min(float(np.std(angle[inner] - sign * truth[inner])) for sign in (1, -1))
    assert error < 2.0

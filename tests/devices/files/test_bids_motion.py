"""Tests that files of a BIDS-Motion recording become the samples of its sensors.

The files are written as its specification states.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from syrupy.assertion import SnapshotAssertion

from core.body import Site
from core.samples import FloatArray, RateKind
from devices.files.bids_motion import bids_motion_trial
from devices.files.formats import format_of
from devices.files.gathering import gather
from tests.swinging_sensor import SwingingSensor, swinging_sensor
from tests.trials_of_files import import_with, refused

HEADS = ("name", "component", "type", "tracked_point", "units")
IMU = "sub-01_task-walk_tracksys-imu"
Row = dict[str, str]
Channel = tuple[Row, FloatArray]


def channels(
    point: str, one: SwingingSensor, *, acc_unit: str = "m/s^2", rate_unit: str = "rad/s", frame: str = "n/a"
) -> list[Channel]:
    scale = {"m/s^2": 1.0, "g": 1 / 9.80665, "rad/s": 1.0, "deg/s": 180 / np.pi, "mph": 1.0}
    found = []
    for kind, unit, values in (("ACCEL", acc_unit, one.acc_m_s2), ("GYRO", rate_unit, one.gyr_rad_s)):
        for k, axis in enumerate("xyz"):
            row = {"name": f"{point}_{kind}_{axis}", "component": axis, "type": kind}
            row |= {"tracked_point": point, "units": unit, "reference_frame": frame}
            found.append((row, values[:, k] * scale[unit]))
    return found


def other(kind: str, component: str, values: FloatArray, point: str = "n/a", unit: str = "n/a") -> Channel:
    row = {"name": f"{point}_{kind}_{component}", "component": component, "type": kind}
    return row | {"tracked_point": point, "units": unit, "reference_frame": "n/a"}, values


def bids(
    folder: Path,
    held: Sequence[Channel],
    base: str = IMU,
    settings: Mapping[str, object] | None = None,
    heads: Sequence[str] = HEADS,
) -> Path:
    """The three files of a tracking system; gives the table of samples."""
    folder.mkdir(parents=True, exist_ok=True)
    table = ["\t".join(heads), *("\t".join(row[name] for name in heads) for row, _ in held)]
    (folder / f"{base}_channels.tsv").write_text("\n".join([*table, ""]))
    columns = [values for _, values in held]
    rows = [
        "\t".join("n/a" if np.isnan(cell) else repr(float(cell)) for cell in row) for row in zip(*columns, strict=True)
    ]
    path = folder / f"{base}_motion.tsv"
    path.write_text("\n".join([*rows, ""]))
    reported = {
        "SamplingFrequency": 100,
        "TaskName": "walk",
        "Manufacturer": "Noraxon",
        "ManufacturersModelName": "n/a",
    }
    (folder / f"{base}_motion.json").write_text(json.dumps(reported if settings is None else settings))
    return path


def refusal(path: Path, rate_hz: float | None = None) -> str:
    return refused(bids_motion_trial, [path], rate_hz)


def test_accelerometers_and_gyroscopes_become_sensors(tmp_path: Path) -> None:
    thigh, shank = swinging_sensor(), swinging_sensor(reach_rad=0.3)
    head = other("POS", "x", np.zeros(300), "head", "m")
    path = bids(tmp_path, [head, *channels("leftThigh", thigh), *channels("leftShank", shank)])
    trial = bids_motion_trial([path])
    assert [sensor.name for sensor in trial.sensors] == ["leftThigh", "leftShank"]
    for found, truth in zip(trial.sensors, (thigh, shank), strict=True):
        np.testing.assert_array_equal(found.block.acc_m_s2, truth.acc_m_s2)
        np.testing.assert_array_equal(found.block.gyr_rad_s, truth.gyr_rad_s)
        np.testing.assert_allclose(found.block.time_s, truth.time_s, atol=1e-12)
        assert (found.info.rate_hz, found.info.model, found.info.rate_kind) == (100.0, "Noraxon", None)
        assert found.findings == ()
    placed = {Site.LEFT_THIGH: "leftThigh", Site.LEFT_SHANK: "leftshank"}
    assert set(import_with(bids_motion_trial, [path], placed, "walk 1").imu) == set(placed)


def test_a_table_of_a_public_set_is_understood(tmp_path: Path) -> None:
    """Its columns stand in another order, with one that the specification does not know."""
    held = channels("leftThigh", swinging_sensor())
    for row, _ in held:
        row |= {"sampling_frequency": "199.905882352941", "orientation_component": row["component"]}
    heads = ("name", "type", "units", "sampling_frequency", "tracked_point", "component", "orientation_component")
    path = bids(tmp_path, held, heads=heads, settings={"SamplingFrequency": 199.9058823529412})
    (sensor,) = bids_motion_trial([path]).sensors
    assert sensor.info.rate_hz == pytest.approx(199.90588)
    assert sensor.block.time_s[-1] == pytest.approx(299 / 199.9058823529412)


def test_units_that_are_reported_become_si(tmp_path: Path) -> None:
    truth = swinging_sensor()
    path = bids(tmp_path, channels("leftThigh", truth, acc_unit="g", rate_unit="deg/s"))
    (sensor,) = bids_motion_trial([path]).sensors
    np.testing.assert_allclose(sensor.block.acc_m_s2, truth.acc_m_s2, rtol=1e-12)
    np.testing.assert_allclose(sensor.block.gyr_rad_s, truth.gyr_rad_s, rtol=1e-12)


def test_latencies_are_the_times_and_missing_samples_gaps(tmp_path: Path) -> None:
    held = channels("leftThigh", swinging_sensor())
    held[0][1][150:160] = np.nan  # of one axis, which leaves the others
    for _, values in held:
        values[200:220] = np.nan
    latency = np.arange(300) / 100.0 + 0.25
    latency[51:] += 0.5
    path = bids(tmp_path, [other("LATENCY", "n/a", latency, unit="s"), *held], settings={})
    (sensor,) = bids_motion_trial([path]).sensors
    assert (len(sensor.block), sensor.info.rate_hz) == (280, 100.0)
    assert sensor.block.time_s[0] == 0.25
    assert sorted(np.diff(sensor.block.time_s))[-2:] == pytest.approx([0.21, 0.51])
    assert int(np.isnan(sensor.block.acc_m_s2[:, 0]).sum()) == 10
    latency[10] = latency[9]
    trial = bids_motion_trial([bids(tmp_path, [other("LATENCY", "n/a", latency, unit="s"), *held], settings={})])
    assert [finding.key for finding in trial.sensors[0].findings] == ["doubled_stamps"]


def test_a_frequency_that_nothing_shows_is_asked_for(tmp_path: Path) -> None:
    path = bids(tmp_path, channels("leftThigh", swinging_sensor()), settings={"SamplingFrequency": "n/a"})
    assert "the sampling frequency of the recording is missing. Give the rate in Hz (--rate)" in refusal(path)
    assert bids_motion_trial([path], 100.0).sensors[0].info.rate_hz == 100.0


@pytest.mark.parametrize("rows", [0, 1])
def test_hardly_any_samples_are_a_short_recording(tmp_path: Path, rows: int) -> None:
    held = [(row, values[:rows]) for row, values in channels("leftThigh", swinging_sensor())]
    assert len(bids_motion_trial([bids(tmp_path, held)]).sensors[0].block) == rows
    latency = other("LATENCY", "n/a", np.zeros(rows), unit="s")
    assert len(bids_motion_trial([bids(tmp_path, [latency, *held])]).sensors[0].block) == rows


def test_an_orientation_is_taken_where_it_turns_gravity_up(tmp_path: Path) -> None:
    truth = swinging_sensor()
    names = ("quat_w", "quat_x", "quat_y", "quat_z")

    def with_orientation(q: FloatArray) -> Path:
        orientation = [other("ORNT", name, q[:, k], "leftThigh") for k, name in enumerate(names)]
        return bids(tmp_path, [*channels("leftThigh", truth), *orientation])

    (sensor,) = bids_motion_trial([with_orientation(truth.q_earth_from_sensor)]).sensors
    np.testing.assert_array_equal(sensor.block.q_earth_from_sensor, truth.q_earth_from_sensor)
    turned = Rotation.from_euler("x", -90, degrees=True) * Rotation.from_quat(
        truth.q_earth_from_sensor, scalar_first=True
    )
    (sensor,) = bids_motion_trial([with_orientation(turned.as_quat(scalar_first=True))]).sensors
    assert sensor.block.q_earth_from_sensor is None
    assert [finding.key for finding in sensor.findings] == ["orientation_left_out"]


def test_what_is_stated_to_be_in_global_axes_is_looked_at(tmp_path: Path) -> None:
    """The specification's own example calls what an accelerometer measures global."""
    truth = swinging_sensor(1000, reach_rad=1.2)
    heads = (*HEADS, "reference_frame")
    path = bids(tmp_path, channels("leftThigh", truth, frame="global"), heads=heads)
    assert len(bids_motion_trial([path]).sensors) == 1
    turn = Rotation.from_quat(truth.q_earth_from_sensor, scalar_first=True)
    in_earth = SwingingSensor(
        truth.time_s,
        truth.q_earth_from_sensor,
        turn.apply(truth.gyr_rad_s),
        turn.apply(truth.acc_m_s2),
        truth.free_m_s2,
    )
    assert 'the acceleration of "leftThigh" does not rotate with the sensor, so it is in global axes' in refusal(
        bids(tmp_path, channels("leftThigh", in_earth, frame="global"), heads=heads)
    )


def test_systems_of_one_recording_are_brought_together_by_their_starts(tmp_path: Path) -> None:
    motion = tmp_path / "sub-01" / "motion"
    files = []
    for system, point in (("imuA", "leftThigh"), ("imuB", "leftShank"), ("omc", "head")):
        held = (
            [other("POS", "x", np.zeros(300), "head", "m")] if system == "omc" else channels(point, swinging_sensor())
        )
        files.append(bids(motion, held, f"sub-01_task-walk_tracksys-{system}_run-1"))
    trial = bids_motion_trial(files)
    assert [[finding.key for finding in one.findings] for one in trial.sensors] == [["not_synchronised"]] * 2
    assert len({one.info.clock for one in trial.sensors}) == 2
    assert "no tracked point has three ACCEL and three GYRO channels" in str(trial.unread[0].refusal)
    scans = ["filename\tacq_time"] + [
        f"motion/{path.name}\t2022-12-05T19:23:{27 + k}.500Z" for k, path in enumerate(files)
    ]
    (tmp_path / "sub-01" / "sub-01_scans.tsv").write_text("\n".join(scans))
    trial = bids_motion_trial(files)
    assert [one.block.time_s[0] for one in trial.sensors] == [0.0, 1.0]
    assert [one.findings for one in trial.sensors] == [(), ()]
    assert trial.started == "2022-12-05T19:23:27.500Z"


def test_files_are_reported_by_their_table_of_channels_and_gathered(tmp_path: Path) -> None:
    for run in (1, 2):
        for system in ("imuA", "imuB"):
            base = f"sub-01_task-walk_tracksys-{system}_run-{run}"
            bids(tmp_path, channels("leftThigh", swinging_sensor()), base)
    assert {format_of(path) for path in tmp_path.iterdir()} == {"bids-motion"}
    found = gather([tmp_path])
    assert [(one.name, len(one.files)) for one in found.trials] == [
        ("sub-01_task-walk_run-1", 6),
        ("sub-01_task-walk_run-2", 6),
    ]
    assert found.refused == ()
    sensors = bids_motion_trial(list(map(Path, found.trials[0].files))).sensors
    assert [one.name for one in sensors] == ["leftThigh (imuA)", "leftThigh (imuB)"]
    several = sorted(tmp_path.glob("*imuA*_motion.tsv"))
    assert "the files belong to several recordings" in refused(bids_motion_trial, several)
    only = tmp_path / "only"
    bids(only, channels("leftThigh", swinging_sensor()))
    (only / "walk_00B42D4B.txt").write_text("// Update Rate: 100.0Hz\nPacketCounter\tAcc_X\tAcc_Y\tAcc_Z\n")
    assert [(one.format, one.name) for one in gather([only]).trials] == [
        ("bids-motion", "sub-01_task-walk"),
        ("xsens-mtmanager", "walk_00B42D4B"),
    ]
    (only / f"{IMU}_channels.tsv").write_text("name\ttime\n")
    assert format_of(only / f"{IMU}_motion.tsv") is None


def test_what_does_not_fit_is_refused_where_it_is(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    truth = swinging_sensor()
    held = channels("leftThigh", truth)

    def of(*others: Channel, held: Sequence[Channel] = held, heads: Sequence[str] = HEADS) -> str:
        return refusal(bids(tmp_path, [*others, *held], heads=heads))

    def latency(values: FloatArray, unit: str = "s") -> Channel:
        return other("LATENCY", "n/a", values, unit=unit)

    def with_text(before: str) -> str:
        path = bids(tmp_path, held)
        path.write_text(before + path.read_text())
        return refusal(path)

    back = np.arange(300) / 100.0 - 1.0 * (np.arange(300) >= 10)
    found = {
        "a cell too many": with_text("x\t"),
        "a channel twice": of(held[0]),
        "half a sensor": of(held=held[:3]),
        "no column of components": of(heads=HEADS[:1] + HEADS[2:]),
        "rates in another unit": of(held=channels("leftThigh", truth, rate_unit="mph")),
        "force in g, called m/s2": of(held=[(row, values / 9.81) for row, values in held]),
        "rates in deg/s, called rad/s": of(
            held=[(row, np.degrees(values) if row["type"] == "GYRO" else values) for row, values in held]
        ),
        "latency goes back": of(latency(back)),
        "latency in ms": of(latency(np.arange(300) * 10.0, "ms")),
    }
    header = with_text("\t".join(row["name"] for row, _ in held) + "\n")
    assert "line 1: a value is not a number" in header  # then in NumPy's words
    assert "Remove the header line: BIDS has none in this file" in header
    path = bids(tmp_path, held)
    (tmp_path / f"{IMU}_motion.json").write_text("{" * 5000)
    assert "the file is not readable JSON" in refusal(path)  # then in Python's words
    path.unlink()
    found["no samples"] = refusal(tmp_path / f"{IMU}_channels.tsv")
    assert found == snapshot


def test_a_point_with_half_a_sensor_is_left_out_by_name(tmp_path: Path) -> None:
    whole, half = channels("leftThigh", swinging_sensor()), channels("leftShank", swinging_sensor())[:3]
    path = bids(tmp_path, [*whole, *half])
    imported = import_with(bids_motion_trial, [path], {Site.LEFT_THIGH: "leftThigh"}, "walk 1")
    assert [finding.numbers["name"] for finding in imported.findings] == ["leftShank"]
    stated = refused(import_with, bids_motion_trial, [path], {Site.LEFT_SHANK: "leftShank"}, "walk 1")
    assert '"leftShank" has no GYRO channels' in stated


def test_our_columns_say_what_bids_has_no_word_for(tmp_path: Path) -> None:
    held = channels("leftThigh", swinging_sensor())
    for row, _ in held:
        row |= {"sensor": "00B42D4B", "rate_kind": "averaged"}
    heads = (*HEADS, "sensor", "rate_kind")
    (sensor,) = bids_motion_trial([bids(tmp_path, held, heads=heads)]).sensors
    assert (sensor.info.serial, sensor.ids, sensor.info.rate_kind) == ("00B42D4B", ("00B42D4B",), RateKind.AVERAGED)
    for row, _ in held:
        row["rate_kind"] = "derived"
    (sensor,) = bids_motion_trial([bids(tmp_path, held, heads=heads)]).sensors
    assert sensor.block.is_rate_derived
    assert [finding.key for finding in sensor.findings] == ["rate_from_orientation"]

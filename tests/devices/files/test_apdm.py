"""Tests that both dialects of APDM's exports become samples. What would be read wrongly is refused."""

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from syrupy.assertion import SnapshotAssertion

from core.body import Site
from core.samples import RateKind
from devices.files.apdm import apdm_trial
from devices.files.formats import recognised
from tests.trials_of_files import import_with, refused

FindData = Callable[[str], Path]
FOLDER = "vendor_exports/apdm"
THIGH_SHANK = {Site.LEFT_THIGH: "Upper", Site.LEFT_SHANK: "Middle"}
NAMED_AXES = [
    *(("Acceleration", axis, "m/s^2") for axis in "XYZ"),
    *(("Angular Velocity", axis, "rad/s") for axis in "XYZ"),
]


def cells_of(path: Path) -> list[list[str]]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        return list(csv.reader(file))


def written(path: Path, lines: list[list[str]]) -> Path:
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(lines)
    return path


def moveo(path: Path, rows: list[list[str]] | None = None, rate_unit: str = "rad/s", acc_unit: str = "m/s^2") -> Path:
    """One sensor called Thigh, at rest, z up."""
    units = {"m/s^2": acc_unit, "rad/s": rate_unit}
    heads = ["Time", *(f"Thigh/{quantity}/{axis}" for quantity, axis, _ in NAMED_AXES)]
    still = [[f"{k / 128:.6f}", "0.0", "0.0", "9.81", "0.01", "0.02", "0.03"] for k in range(20)]
    lines = [["Test Name:", "a walk"], ["Sample Rate:", "128", "Hz"], heads]
    return written(
        path, [*lines, ["s", *(units[unit] for _, _, unit in NAMED_AXES)], *(still if rows is None else rows)]
    )


def monitors(path: Path, acc: float = 9.81, gyr: float = 0.1) -> Path:
    """Two sensors of "Format=7", the first without magnetometer."""
    names = ["Format=7", "17", "", "", "Left Thigh", "", "", "21", "", "", "Left Shank", "", ""]
    quantities = ["Time", "Accelerometer", "", "", "Gyroscope", "", "", "Accelerometer", "", "", "Gyroscope", "", ""]
    rows = [[str(1550879504438281 + 7812 * k), *["0", "0", str(acc), str(gyr), "0", "0"] * 2] for k in range(20)]
    return written(path, [names, quantities, ["", *"XYZXYZXYZXYZ"], *rows])


def refusal(path: Path) -> str:
    return refused(apdm_trial, [path])


def test_the_orientation_turns_gravity_up(test_data: FindData) -> None:
    """Of sensors that swing, none of them level: a transposed or reordered quaternion would not."""
    for name in ("Upper", "Middle", "Lower"):
        imported = import_with(apdm_trial, [test_data(f"{FOLDER}/imuData01.csv")], {Site.LEFT_THIGH: name}, "walk 1")
        block = imported.imu[Site.LEFT_THIGH]
        assert block.q_earth_from_sensor is not None
        turn = Rotation.from_quat(block.q_earth_from_sensor, scalar_first=True)
        np.testing.assert_allclose(turn.apply(block.acc_m_s2).mean(axis=0), [0, 0, 9.8], atol=0.25)
        assert turn.inv().apply(block.acc_m_s2).mean(axis=0)[2] < 5.0
        assert block.acc_m_s2.mean(axis=0)[2] < 5.0


def test_rates_are_the_slope_of_the_orientation_at_their_stamps(test_data: FindData) -> None:
    block = import_with(apdm_trial, [test_data(f"{FOLDER}/imuData01.csv")], THIGH_SHANK, "walk 1").imu[Site.LEFT_THIGH]
    assert block.q_earth_from_sensor is not None
    turn = Rotation.from_quat(block.q_earth_from_sensor, scalar_first=True)
    central = (turn[:-2].inv() * turn[2:]).as_rotvec() / (block.time_s[2:] - block.time_s[:-2])[:, None]
    error = {
        shift: _rms(central[5:-5] - block.gyr_rad_s[6 + shift : len(block.time_s) - 6 + shift]) for shift in (-1, 0, 1)
    }
    assert min(error, key=error.__getitem__) == 0
    assert error[0] < 0.1 * _rms(block.gyr_rad_s)


def test_counts_units_and_rate_are_those_of_the_file(test_data: FindData) -> None:
    path = test_data(f"{FOLDER}/imuData01.csv")
    cells = cells_of(path)
    imported = import_with(apdm_trial, [path], THIGH_SHANK, "walk 1")
    block, info = imported.imu[Site.LEFT_THIGH], imported.sensors[Site.LEFT_THIGH]
    at = cells[2].index("Upper/Acceleration/X")
    assert len(block.time_s) == len(cells) - 4
    assert block.acc_m_s2[0].tolist() == [float(cell) for cell in cells[4][at : at + 3]]
    assert block.gyr_rad_s[-1].tolist() == [float(cell) for cell in cells[-1][at + 3 : at + 6]]
    assert block.time_s[-1] == pytest.approx(float(cells[-1][0]) - float(cells[4][0]))
    assert (info.rate_hz, info.rate_kind) == (128.0, RateKind.INSTANTANEOUS)
    assert {finding.numbers["name"] for finding in imported.findings} >= {"Static"}


def test_sensors_by_number_and_by_name(test_data: FindData) -> None:
    path = test_data(f"{FOLDER}/apdm_format7.csv")
    cells = cells_of(path)
    imported = import_with(apdm_trial, [path], {Site.LEFT_FOOT: "left foot", Site.RIGHT_FOOT: "6833"}, "walk 1")
    for site, number in ((Site.LEFT_FOOT, "6570"), (Site.RIGHT_FOOT, "6833")):
        at = cells[0].index(number)
        assert imported.imu[site].acc_m_s2[0].tolist() == [float(cell) for cell in cells[3][at : at + 3]]
        assert imported.imu[site].gyr_rad_s[0].tolist() == [float(cell) for cell in cells[3][at + 3 : at + 6]]
        assert imported.sensors[site].serial == number
    stamps = [int(line[0]) for line in cells[3:] if line]
    np.testing.assert_allclose(imported.imu[Site.LEFT_FOOT].time_s * 1e6, np.array(stamps) - stamps[0], atol=1.0)
    knee = refused(import_with, apdm_trial, [path], {Site.LEFT_FOOT: "Knee"}, "walk 1")
    assert '"Knee" matches no file and no sensor. Available sensors: Lumbar (5718)' in knee
    twice = refused(import_with, apdm_trial, [path], {Site.LEFT_FOOT: "Lumbar", Site.LEFT_SHANK: "5718"}, "walk 1")
    assert "is assigned to two sensor positions" in twice


def test_a_sensor_without_magnetometer_and_orientation_is_read(tmp_path: Path) -> None:
    imported = import_with(apdm_trial, [monitors(tmp_path / "a.csv")], {Site.LEFT_SHANK: "21"}, "walk 1")
    block = imported.imu[Site.LEFT_SHANK]
    assert block.mag is None
    assert block.q_earth_from_sensor is None
    assert block.gyr_rad_s[0].tolist() == [0.1, 0.0, 0.0]
    assert imported.sensors[Site.LEFT_SHANK].rate_hz == pytest.approx(128.0, abs=0.1)


def test_an_empty_cell_is_a_sample_that_is_not_there(tmp_path: Path) -> None:
    rows = [["0.0", "", "0.0", "9.81", "0", "0", "0"], ["0.1", "0", "0", "9.81", "0", "0", "0"]]
    imported = import_with(apdm_trial, [moveo(tmp_path / "a.csv", rows)], {Site.LEFT_THIGH: "thigh"}, "walk 1")
    block = imported.imu[Site.LEFT_THIGH]
    assert np.isnan(block.acc_m_s2[:, 0]).tolist() == [True, False]


def test_a_hard_blow_as_fast_as_the_sensor_can_is_read(tmp_path: Path) -> None:
    assert apdm_trial([monitors(tmp_path / "e.csv", acc=13.0, gyr=34.0)]).sensors


def test_the_last_rows_may_be_cut_short_and_decimal_signs_be_commas(tmp_path: Path) -> None:
    rows = [[f"{0.1 * k:.1f}", "0.5", "0.25", "9.81", "0.01", "0.02", "0.25"] for k in range(100)]
    whole = moveo(tmp_path / "a.csv", rows).read_text()
    (tmp_path / "b.csv").write_text(whole.replace(",", ";").replace(".", ","))
    with (tmp_path / "b.csv").open("a") as file:
        file.write("1,0;0,5\n1,1;0,5\n")
    assert recognised([tmp_path / "b.csv"]) == "apdm"
    one, other = (apdm_trial([tmp_path / name]).sensors[0] for name in ("a.csv", "b.csv"))
    np.testing.assert_array_equal(one.block.acc_m_s2, other.block.acc_m_s2)
    np.testing.assert_array_equal(one.block.time_s, other.block.time_s)
    assert [(found.key, found.numbers) for found in other.findings] == [("rows_cut_short", {"count": 2})]


def test_other_units_and_damage_are_refused_where_they_are(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    path = tmp_path / "a.csv"
    row = ["0.1", "0", "0", "9.81", "0", "0", "0"]

    def of(*rows: list[str]) -> str:
        return refusal(moveo(path, list(rows)))

    cells, two = cells_of(moveo(path)), cells_of(monitors(path))
    path.write_bytes(b"Test Name:," + b"x" * 70_000 + b"\xff")
    assert {
        "no text": refusal(path),
        "rates in deg/s": refusal(moveo(path, rate_unit="deg/s")),
        "force in g": refusal(moveo(path, acc_unit="g")),
        "two sensors, force in g": refusal(monitors(path, acc=1.0)),
        "two sensors, rates in deg/s": refusal(monitors(path, gyr=180.0)),
        "a short line": of(row, row[:3], row),
        "a word in a cell": of(["0.1", "moved", *row[2:]]),
        "times go back": of(row, ["0.05", *row[1:]]),
        "no time": of(["", *row[1:]]),
        "no rates": refusal(written(path, [line[:4] for line in cells])),
        "no header": refusal(written(path, cells[:2])),
        "headers of two lengths": refusal(written(path, [*two[:2], *(line[:9] for line in two[2:])])),
        "another table": refusal(written(path, [["Sensor", "Time"]])),
    } == snapshot


def test_a_trial_without_samples_is_an_empty_recording(tmp_path: Path) -> None:
    imported = import_with(apdm_trial, [moveo(tmp_path / "a.csv", [])], {Site.LEFT_THIGH: "Thigh"}, "walk 1")
    assert len(imported.imu[Site.LEFT_THIGH].time_s) == 0


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))

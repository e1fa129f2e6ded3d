"""Tests that tables of any program become samples. What they leave open is asked for instead of guessed."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from syrupy.assertion import SnapshotAssertion

from core.body import Site
from core.findings import Finding
from devices.files.csv_tables import csv_trial
from devices.files.formats import recognised
from devices.files.imports import ImportedFiles
from tests.trials_of_files import import_with, refused

FindData = Callable[[str], Path]
Columns = dict[str, NDArray[np.float64]]
G = 9.80665
ROWS = 400
TIME_S = np.arange(ROWS) / 100.0


def motion(seed: int = 1) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Specific force near gravity and rates of a walking leg, (n, 3) each, SI."""
    chance = np.random.default_rng(seed)
    acc = np.array([0.0, 0.0, G]) + chance.normal(size=(ROWS, 3))
    return acc, 3.0 * np.sin(2.0 * np.pi * TIME_S)[:, None] * np.array([1.0, 0.2, 0.1])


def named(acc: str, gyr: str, acc_unit: float = 1.0, gyr_unit: float = 1.0, seed: int = 1) -> Columns:
    """Columns of `motion`, in the names' {} the axis, divided by their units."""
    force, rate = motion(seed)
    return {acc.format(axis): force[:, k] / acc_unit for k, axis in enumerate("xyz")} | {
        gyr.format(axis): rate[:, k] / gyr_unit for k, axis in enumerate("xyz")
    }


def write(
    path: Path, columns: Mapping[str, NDArray[np.float64]], delimiter: str = ",", units: Sequence[str] = ()
) -> Path:
    rows = [
        delimiter.join("" if np.isnan(v) else f"{v:.9g}" for v in row) for row in zip(*columns.values(), strict=True)
    ]
    heads = [delimiter.join(columns), *([delimiter.join(units)] if units else [])]
    path.write_text("\n".join([*heads, *rows, ""]), encoding="utf-8")
    return path


def shank(path: Path, name: str = "a", rate_hz: float | None = None) -> ImportedFiles:
    return import_with(csv_trial, [path], {Site.LEFT_SHANK: name}, "walk 1", rate_hz)


def finding(imported: ImportedFiles, key: str) -> Finding:
    return next(one for one in imported.findings if one.key == key)


def refusal(path: Path, rate_hz: float | None = None) -> str:
    return refused(csv_trial, [path], rate_hz)


@pytest.mark.parametrize(
    ("acc", "gyr", "time", "acc_unit", "gyr_unit", "tick_s"),
    [
        ("acc_{}_m_s2", "gyr_{}_rad_s", "time_s", 1.0, 1.0, 1.0),
        ("accel_{} [g]", "gyro_{} [deg/s]", "Time [ms]", G, np.pi / 180, 1e-3),
        ("Accelerometer {} (mg)", "Gyroscope {} (dps)", "Timestamp (us)", G / 1000, np.pi / 180, 1e-6),
        ("a{}", "w{}", "t", G, np.pi / 180, 1e-3),  # by size: g, deg/s, ms
    ],
)
def test_names_and_units_become_si(
    tmp_path: Path, acc: str, gyr: str, time: str, acc_unit: float, gyr_unit: float, tick_s: float
) -> None:
    path = write(tmp_path / "a.csv", {time: TIME_S / tick_s, **named(acc, gyr, acc_unit, gyr_unit)})
    assert recognised([path]) == "csv"
    imported = shank(path)
    block = imported.imu[Site.LEFT_SHANK]
    force, rate = motion()
    np.testing.assert_allclose(block.acc_m_s2, force, atol=1e-6)
    np.testing.assert_allclose(block.gyr_rad_s, rate, atol=1e-6)
    np.testing.assert_allclose(block.time_s, TIME_S, atol=1e-6)
    assert imported.sensors[Site.LEFT_SHANK].rate_hz == 100.0
    assert imported.sensors[Site.LEFT_SHANK].rate_kind is None  # which no name reports
    assert finding(imported, "columns_understood").numbers["acc_unit"] == (
        "g" if acc_unit == G else "mg" if "mg" in acc else "m/s2"
    )
    by_size = [one.numbers for one in imported.findings if one.key == "unit_by_size"]
    assert by_size == (
        [{"names": "t", "unit": "ms"}, {"names": "ax, ay, az", "unit": "g"}, {"names": "wx, wy, wz", "unit": "deg/s"}]
        if time == "t"
        else []
    )


def test_our_own_sessions_columns_are_understood(test_data: FindData) -> None:
    path = test_data("stroke_treadmill/stroke01/walk_1/left_foot.csv")
    assert recognised([path]) == "csv"
    block = shank(path, "left_foot").imu[Site.LEFT_SHANK]
    with path.open() as file:
        names = file.readline().strip().split(",")
    first = dict(zip(names, path.read_text().splitlines()[1].split(","), strict=True))
    assert block.acc_m_s2[0].tolist() == [float(first[f"acc_{axis}_m_s2"]) for axis in "xyz"]
    assert block.gyr_rad_s[0].tolist() == [float(first[f"gyr_{axis}_rad_s"]) for axis in "xyz"]


def test_sensors_side_by_side_and_a_line_of_units_with_decimal_commas(tmp_path: Path) -> None:
    thigh, lower = (
        named(f"{name}_acc_{{}}", f"{name}_gyr_{{}}", G, np.pi / 180, seed)
        for name, seed in (("LeftThigh", 1), ("LeftShank", 2))
    )
    units = ["ms", *[*["g"] * 3, *["deg/s"] * 3] * 2]
    path = write(tmp_path / "a.csv", {"Zeit time": TIME_S * 1e3, **thigh, **lower}, ";", units)
    path.write_text(path.read_text().replace(".", ","))
    imported = import_with(
        csv_trial, [path], {Site.LEFT_THIGH: "leftthigh", Site.LEFT_SHANK: "LeftShank"}, "walk 1", 100.0
    )
    for site, seed in ((Site.LEFT_THIGH, 1), (Site.LEFT_SHANK, 2)):
        np.testing.assert_allclose(imported.imu[site].acc_m_s2, motion(seed)[0], atol=1e-6)
        np.testing.assert_allclose(imported.imu[site].gyr_rad_s, motion(seed)[1], atol=1e-6)


def test_one_file_for_each_sensor_is_called_by_its_file(tmp_path: Path) -> None:
    for number, name in enumerate(("thigh", "shank")):
        write(
            tmp_path / f"{name}.csv",
            {"time_s": TIME_S + 0.5 * number, **named("acc_{}_g", "gyr_{}_rad_s", G, 1.0, number)},
        )
    files = [tmp_path / "thigh.csv", tmp_path / "shank.csv"]
    imported = import_with(csv_trial, files, {Site.LEFT_THIGH: "thigh", Site.LEFT_SHANK: "shank.csv"}, "walk 1")
    assert imported.imu[Site.LEFT_SHANK].time_s[0] == 0.5
    np.testing.assert_allclose(imported.imu[Site.LEFT_SHANK].acc_m_s2, motion(1)[0], atol=1e-6)


def test_one_file_of_several_that_cannot_be_read_is_reported_when_it_is_required(tmp_path: Path) -> None:
    write(tmp_path / "thigh.csv", {"time_s": TIME_S, **named("acc_{}_g", "gyr_{}_rad_s", G)})
    write(tmp_path / "shank.csv", {"time_s": TIME_S, **named("acc_{}_m_s2", "gyr_{}_rad_s", G)})
    files = [tmp_path / "thigh.csv", tmp_path / "shank.csv"]
    placement = {Site.LEFT_THIGH: "thigh"}
    assert import_with(csv_trial, files, placement, "walk 1").imu
    stated = refused(import_with, csv_trial, files, placement | {Site.LEFT_SHANK: "shank"}, "walk 1")
    assert stated.startswith("shank.csv: the acceleration")
    assert "is labelled m/s2" in stated


def test_rows_without_a_sensors_values_are_its_gaps_and_doubled_stamps_a_finding(tmp_path: Path) -> None:
    columns = {"time_s": TIME_S.copy(), **named("acc_{}_m_s2", "gyr_{}_rad_s")}
    for name in columns:
        if name != "time_s":
            columns[name] = columns[name].copy()
            columns[name][10:20] = np.nan
    columns["time_s"][31] = columns["time_s"][30]
    imported = shank(write(tmp_path / "a.csv", columns))
    block = imported.imu[Site.LEFT_SHANK]
    assert len(block) == ROWS - 11
    assert np.max(np.diff(block.time_s)) == pytest.approx(0.11)
    assert finding(imported, "doubled_stamps").numbers == {"count": 1}


def test_without_times_a_rate_and_a_counter_are_asked_for(tmp_path: Path) -> None:
    columns = named("acc_{}_m_s2", "gyr_{}_rad_s")
    path = write(tmp_path / "a.csv", columns)
    imported = shank(path, rate_hz=50.0)
    assert imported.imu[Site.LEFT_SHANK].time_s[-1] == pytest.approx((ROWS - 1) / 50.0)
    assert finding(imported, "time_from_rate").numbers == {"rate_hz": 50.0}
    count = np.delete(np.arange(250, 250 + ROWS + 5) % 256, range(20, 25)).astype(float)  # five lost, and it turns
    imported = shank(write(tmp_path / "a.csv", {"counter": count, **columns}), rate_hz=50.0)
    assert np.max(np.diff(imported.imu[Site.LEFT_SHANK].time_s)) == pytest.approx(6 / 50.0)
    assert imported.imu[Site.LEFT_SHANK].time_s[-1] == pytest.approx((ROWS + 4) / 50.0)


def test_a_clock_of_32_bits_that_turns_goes_on(tmp_path: Path) -> None:
    ticks = (2**32 - 1_000_000 + 10_000 * np.arange(ROWS)) % 2**32
    columns = {"time_us": ticks.astype(float), **named("acc_{}_m_s2", "gyr_{}_rad_s")}
    path = tmp_path / "a.csv"
    rows = [",".join([str(int(row[0])), *(f"{v:.9g}" for v in row[1:])]) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join([",".join(columns), *rows, ""]))
    np.testing.assert_allclose(shank(path).imu[Site.LEFT_SHANK].time_s, TIME_S, atol=1e-9)


def test_counts_in_place_of_times_are_read_at_the_rate_that_is_given(tmp_path: Path) -> None:
    counts = {"time": np.arange(float(ROWS)), **named("acc_{}_m_s2", "gyr_{}_rad_s")}
    assert shank(write(tmp_path / "b.csv", counts), "b", 100.0).imu[Site.LEFT_SHANK].time_s[1] == 0.01


def test_units_and_times_are_held_to_their_size(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    def units(acc: str = "acc_{}_m_s2", gyr: str = "gyr_{}_rad_s", acc_unit: float = 1.0, gyr_unit: float = 1.0) -> str:
        return refusal(write(tmp_path / "a.csv", {"time_s": TIME_S, **named(acc, gyr, acc_unit, gyr_unit)}))

    known = named("acc_{}_m_s2", "gyr_{}_rad_s")

    def times(time: NDArray[np.float64], name: str = "time_s", rate_hz: float | None = None) -> str:
        return refusal(write(tmp_path / "a.csv", {name: time, **known}), rate_hz)

    free = {
        name: values - (G if "_z" in name and "acc" in name else 0.0)
        for name, values in named("free_acc_{}_m_s2", "gyr_{}_rad_s").items()
    }
    mixed = {name.replace("acc_y_m_s2", "acc_y_g"): values for name, values in known.items()}
    assert {
        "rates that may be in either unit: it hardly turns": units(gyr="gyr_{}", gyr_unit=100.0),
        "called m/s2, and g": units(acc_unit=G),
        "called g, and m/s2": units("acc_{}_g"),
        "no unit, and of no size": units("acc_{}", acc_unit=3.0),
        "called rad/s, and deg/s": units("acc_{}_g", acc_unit=G, gyr_unit=np.pi / 180),
        "called mm": units("acc_{} (mm)"),
        "without gravity": refusal(write(tmp_path / "a.csv", {"time_s": TIME_S, **free})),
        "axes in two units": refusal(write(tmp_path / "a.csv", {"time_s": TIME_S, **mixed})),
        "times that may be counts": times(np.arange(float(ROWS)), "time"),
        "times in 0.1 ms, which is no unit of ours": times(TIME_S * 1e4, "time"),
        "called s, and ms": times(TIME_S * 1e3),
        "another rate is stated": times(TIME_S, rate_hz=60.0),
        "times that go back": times(TIME_S - 0.3 * (np.arange(ROWS) >= 50)),
        "a sample without time": times(np.where(np.arange(ROWS) == 5, np.nan, TIME_S)),
        "whole seconds": times(np.floor(TIME_S)),
        "no times": refusal(write(tmp_path / "a.csv", known)),
    } == snapshot


def test_an_orientation_is_taken_where_it_turns_gravity_upwards(tmp_path: Path) -> None:
    earth_from_sensor = Rotation.from_euler("x", 70.0, degrees=True)
    acc = np.tile(earth_from_sensor.inv().apply([0.0, 0.0, G]), (ROWS, 1))
    columns = named("acc_{}_m_s2", "gyr_{}_rad_s") | {f"acc_{axis}_m_s2": acc[:, k] for k, axis in enumerate("xyz")}
    for rotation, is_taken in ((earth_from_sensor, True), (earth_from_sensor.inv(), False)):
        q = np.tile(rotation.as_quat(scalar_first=True), (ROWS, 1))
        quat = {f"q{k}": q[:, k] for k in range(4)}
        imported = shank(write(tmp_path / "a.csv", {"time_s": TIME_S, **columns, **quat}))
        block = imported.imu[Site.LEFT_SHANK]
        assert (block.q_earth_from_sensor is not None) == is_taken
        assert [one.key for one in imported.findings if one.key == "orientation_left_out"] == (
            [] if is_taken else ["orientation_left_out"]
        )


def test_columns_that_mean_nothing_are_reported(tmp_path: Path) -> None:
    columns = {"time_s": TIME_S, **named("acc_{}_m_s2", "gyr_{}_rad_s"), "pressure": TIME_S, "acc_norm": TIME_S}
    assert finding(shank(write(tmp_path / "a.csv", columns)), "columns_left_out").numbers == {
        "names": "pressure, acc_norm"
    }


def test_what_is_no_such_table_is_refused_and_not_recognised(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    path = tmp_path / "a.csv"
    xsens = {"PacketCounter": TIME_S, "SampleTimeFine": TIME_S, **named("Acc_{}", "Gyr_{}")}
    for columns in ({"time": TIME_S, "acc_x": TIME_S}, xsens):
        assert "the file format is not recognised" in refused(recognised, [write(path, columns)])
    found = {"other columns": refusal(write(path, {"time": TIME_S, "left": TIME_S, "acc_x": TIME_S}))}
    cut = write(path, {"time_s": TIME_S, **named("acc_{}_m_s2", "gyr_{}_rad_s")})
    cut.write_text(cut.read_text()[:-30])
    found["cut off"] = refusal(cut)
    path.write_text("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n0,1,2,here,4,5,6\n")
    found["a word in a cell"] = refusal(path)
    assert found == snapshot

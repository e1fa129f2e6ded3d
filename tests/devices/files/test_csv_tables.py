"""Tests that tables of any program become samples. What they leave open is asked for instead of guessed."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.body import Site
from core.findings import Finding
from devices.files.csv_tables import csv_trial
from devices.files.formats import recognised
from devices.files.imports import ImportedFiles
from devices.files.refusal import FileRefusedError
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
    path = write(
        tmp_path / "a.csv",
        {"Zeit time": TIME_S * 1e3, **thigh, **lower},
        ";",
        ["ms", *["g"] * 3, *["deg/s"] * 3] * 1 + ["g"] * 3 + ["deg/s"] * 3,
    )
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
    assert import_with(csv_trial, files, {Site.LEFT_THIGH: "thigh"}, "walk 1").imu
    with pytest.raises(FileRefusedError, match=r"shank.csv: the acceleration .* is labelled m/s2"):
        import_with(csv_trial, files, {Site.LEFT_THIGH: "thigh", Site.LEFT_SHANK: "shank"}, "walk 1")


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
    assert "the samples in the file have no times. Add a column time_s, time_ms or time_us, or give" in refusal(path)
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


def test_what_names_leave_open_is_asked_for(tmp_path: Path) -> None:
    slow = named("acc_{}_m_s2", "gyr_{}", gyr_unit=100.0)  # 0.03 rad/s or deg/s: it hardly turns
    assert (
        "it is unclear whether the angular rates gyr_x, gyr_y, gyr_z are in rad/s or in deg/s. Name the columns with"
        in refusal(write(tmp_path / "a.csv", {"time_s": TIME_S, **slow}))
    )
    counts = {"time": np.arange(float(ROWS)), **named("acc_{}_m_s2", "gyr_{}_rad_s")}
    path = write(tmp_path / "b.csv", counts)
    assert 'the unit of "time" is unclear; its step between samples is 1. Name the column' in refusal(path)
    assert shank(path, "b", 100.0).imu[Site.LEFT_SHANK].time_s[1] == 0.01
    fine = {"time": TIME_S * 1e4, **named("acc_{}_m_s2", "gyr_{}_rad_s")}  # 0.1 ms is no unit of ours
    assert 'the unit of "time" is unclear; its step between samples is 100.' in refusal(write(tmp_path / "c.csv", fine))


def test_units_are_held_to_their_size(tmp_path: Path) -> None:
    def of(acc: str, gyr: str, acc_unit: float, gyr_unit: float) -> str:
        return refusal(write(tmp_path / "a.csv", {"time_s": TIME_S, **named(acc, gyr, acc_unit, gyr_unit)}))

    assert "is labelled m/s2, but its median of 0.994 matches gravity in g" in of("acc_{}_m_s2", "gyr_{}_rad_s", G, 1.0)
    assert "is labelled g, but its median of 9.74 matches gravity in m/s2" in of("acc_{}_g", "gyr_{}_rad_s", 1.0, 1.0)
    assert "which does not match gravity in m/s2, g, mg. Export acceleration in m/s2 with gravity" in of(
        "acc_{}", "gyr_{}_rad_s", 3.0, 1.0
    )
    assert "are labelled rad/s, but reach 172, beyond the range of any sensor" in of(
        "acc_{}_g", "gyr_{}_rad_s", G, np.pi / 180
    )
    assert '"acc_x (mm)" is in "mm", expected one of m/s2, g, mg' in of("acc_{} (mm)", "gyr_{}_rad_s", 1.0, 1.0)
    free = {
        name: values - (G if "_z" in name and "acc" in name else 0.0)
        for name, values in named("free_acc_{}_m_s2", "gyr_{}_rad_s").items()
    }
    assert "does not match gravity in m/s2. Export acceleration in m/s2 with gravity, not free or linear" in refusal(
        write(tmp_path / "b.csv", {"time_s": TIME_S, **free})
    )
    mixed = named("acc_{}_m_s2", "gyr_{}_rad_s")
    mixed["acc_y_g"] = mixed.pop("acc_y_m_s2")
    assert "have different units" in refusal(write(tmp_path / "c.csv", {"time_s": TIME_S, **mixed}))


def test_times_are_held_to_their_size(tmp_path: Path) -> None:
    columns = named("acc_{}_m_s2", "gyr_{}_rad_s")
    assert "the times in the file give 0.1 samples per second, expected 1 to 20000" in refusal(
        write(tmp_path / "a.csv", {"time_s": TIME_S * 1e3, **columns})
    )
    path = write(tmp_path / "a.csv", {"time_s": TIME_S, **columns})
    assert "the times in the file give 100 samples per second, expected 60" in refusal(path, 60.0)
    back = TIME_S.copy()
    back[50:] -= 0.3
    assert 'a.csv, line 52: "time_s" goes back from 0.49 to 0.2' in refusal(write(path, {"time_s": back, **columns}))
    empty = TIME_S.copy()
    empty[5] = np.nan
    assert 'a.csv, line 7: a sample has no time in column "time_s"' in refusal(
        write(path, {"time_s": empty, **columns})
    )
    coarse = np.floor(TIME_S)
    assert "396 of 400 samples have the same time as the sample before. Export the times with more digits" in refusal(
        write(path, {"time_s": coarse, **columns})
    )


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


def test_what_is_no_such_table_is_refused_and_not_recognised(tmp_path: Path) -> None:
    path = write(tmp_path / "a.csv", {"time": TIME_S, "left": TIME_S, "acc_x": TIME_S})
    assert (
        "the file's columns do not identify acceleration and angular rates on three axes each: time, left, "
        "acc_x. Name" in refusal(path)
    )
    xsens = {"PacketCounter": TIME_S, "SampleTimeFine": TIME_S, **named("Acc_{}", "Gyr_{}")}
    for columns in ({"time": TIME_S, "acc_x": TIME_S}, xsens):
        with pytest.raises(FileRefusedError, match="the file format is not recognised"):
            recognised([write(path, columns)])
    cut = write(path, {"time_s": TIME_S, **named("acc_{}_m_s2", "gyr_{}_rad_s")})
    cut.write_text(cut.read_text()[:-30])
    assert "a.csv, line 401: the line ends after" in refusal(cut)
    path.write_text("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n0,1,2,here,4,5,6\n")
    assert 'a.csv, line 2: "here" in column acc_z is not a number' in refusal(path)

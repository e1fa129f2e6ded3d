"""What is kept of an x-IMU3: bytes as our emulator sends them, and the folder of CSV as public programs read it."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from devices.emulators.ximu3 import Ximu3Voice
from devices.files.formats import format_of
from devices.files.gathering import gather
from devices.files.ximu3_files import ximu3_trial
from tests.trials_of_files import refused

COUNT, HZ = 200, 100
HEAD = (
    "Timestamp (us),Gyroscope X (deg/s),Gyroscope Y (deg/s),Gyroscope Z (deg/s),"
    "Accelerometer X (g),Accelerometer Y (g),Accelerometer Z (g)"
)


def motion(number: int) -> tuple[float, ...]:
    return 0.5 * number, -10.0, 20.0, 0.25, -0.5, 1.0 + 0.001 * number


def kept(path: Path, *, is_binary: bool = True, lost: int = -1, count: int = COUNT) -> Path:
    voice = Ximu3Voice("0123ABCD", motion, rate_hz=HZ, is_binary=is_binary)
    path.write_bytes(b"\n" + b"".join(voice.sample(k) for k in range(count) if k != lost))
    return path


def converted(folder: Path, begin_us: int = 5_000_000, has_quaternion: bool = False, count: int = COUNT) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    rows = [f"{begin_us + 10_000 * k},{','.join(map(str, motion(k)))}" for k in range(count)]
    (folder / "Inertial.csv").write_text("\n".join([HEAD, *rows, ""]), encoding="utf-8")
    if has_quaternion:
        turns = [f"{begin_us + 20_000 * k},1.0,0.0,0.0,0.0" for k in range(count // 2)]
        (folder / "Quaternion.csv").write_text("\n".join(["Timestamp (us),W,X,Y,Z", *turns, ""]), encoding="utf-8")
    return folder


def truth() -> tuple[np.ndarray, np.ndarray]:
    """Rates in rad/s and force in m/s2 (n, 3)."""
    rows = np.array([motion(k) for k in range(COUNT)])
    return rows[:, :3] * np.pi / 180, rows[:, 3:] * 9.80665


@pytest.mark.parametrize("is_binary", [True, False])
def test_bytes_are_recognised_and_read(tmp_path: Path, is_binary: bool) -> None:
    path = kept(tmp_path / "left shank.ximu3", is_binary=is_binary)
    assert format_of(path) == "ximu3"
    (sensor,) = ximu3_trial([path]).sensors
    rate, force = truth()
    assert sensor.block.gyr_rad_s == pytest.approx(rate, abs=1e-5)
    assert sensor.block.acc_m_s2 == pytest.approx(force, abs=1e-3)
    assert sensor.block.time_s == pytest.approx(np.arange(COUNT) / HZ, abs=1e-6)
    assert (sensor.info.rate_hz, sensor.findings) == (100.0, ())


@pytest.mark.parametrize("is_file", [True, False])
def test_the_folder_of_csv_is_recognised_and_read(tmp_path: Path, is_file: bool) -> None:
    folder = converted(tmp_path / "trial" / "left_shank", has_quaternion=True)
    path = folder / "Inertial.csv" if is_file else folder
    assert format_of(path) == "ximu3"
    (sensor,) = ximu3_trial([path]).sensors
    rate, force = truth()
    assert sensor.name == "left_shank"
    assert sensor.block.gyr_rad_s == pytest.approx(rate)
    assert sensor.block.acc_m_s2 == pytest.approx(force)
    assert sensor.block.time_s == pytest.approx(np.arange(COUNT) / HZ)
    q = sensor.block.q_earth_from_sensor
    assert q is not None
    assert np.isfinite(q[:, 0]).tolist() == [k % 2 == 0 for k in range(COUNT)]


def test_folders_beside_each_other_are_one_trial(tmp_path: Path) -> None:
    for k, name in enumerate(("left_thigh", "left_shank")):
        converted(tmp_path / "walk" / name, begin_us=5_000_000 + 100_000 * k)
    (trial,) = gather([tmp_path / "walk"]).trials
    assert (trial.format, len(trial.files)) == ("ximu3", 2)
    shank, thigh = ximu3_trial([Path(file) for file in trial.files]).sensors
    assert (shank.name, thigh.name) == ("left_shank", "left_thigh")
    assert (thigh.block.time_s[0], shank.block.time_s[0]) == pytest.approx((0.0, 0.1))
    assert {thigh.info.clock, shank.info.clock} == {"left_thigh", "left_shank"}


def test_a_loss_is_a_gap_and_damage_is_reported(tmp_path: Path) -> None:
    path = kept(tmp_path / "a.ximu3", lost=50)
    data = path.read_bytes()
    path.write_bytes(data[:2000] + b"Inonsense\n" + data[2000:])
    (sensor,) = ximu3_trial([path]).sensors
    assert COUNT - 3 <= len(sensor.block) < COUNT
    assert np.diff(sensor.block.time_s).max() == pytest.approx(0.02, abs=1e-6)
    assert [finding.key for finding in sensor.findings] == ["damaged_stretches"]


def test_what_holds_no_samples_or_other_units_is_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    folder = converted(tmp_path / "left_shank", has_quaternion=True)
    inertial = folder / "Inertial.csv"
    rows = [line.split(",") for line in inertial.read_text(encoding="utf-8").splitlines()[1:]]

    def of(text: str) -> str:
        inertial.write_text(text, encoding="utf-8")
        return refused(ximu3_trial, [folder])

    def scaled(gyr: float, acc: float) -> str:
        scales = (1.0, *[gyr] * 3, *[acc] * 3)
        lines = [",".join(repr(float(cell) * scale) for cell, scale in zip(row, scales, strict=True)) for row in rows]
        return of("\n".join([HEAD, *lines, ""]))

    def sent(motion: Callable[[int], tuple[float, ...]], numbers: Sequence[int]) -> str:
        voice = Ximu3Voice("0123ABCD", motion, rate_hz=HZ)
        (tmp_path / "a.ximu3").write_bytes(b"\n" + b"".join(map(voice.sample, numbers)))
        return refused(ximu3_trial, [tmp_path / "a.ximu3"])

    assert {
        "a header alone": of(HEAD + "\n"),
        "other columns": of("Timestamp (us),X\n1,2\n"),
        "force in m/s2": scaled(1.0, 9.80665),
        "rates in mdeg/s": scaled(1000.0, 1.0),
        "bytes of a sensor that measures no gravity": sent(lambda _: (0.0, 0.0, 0.0, 0.0, 0.0, 0.01), range(COUNT)),
    } == snapshot


@pytest.mark.parametrize("data", [b"I,am,a,text\nof,no,numbers\n" * 9, b"time_s,acc_x\n0,1\n", bytes(4000)])
def test_other_files_are_none(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "other"
    path.write_bytes(data)
    assert format_of(path) != "ximu3"


@pytest.mark.parametrize("is_binary", [True, False])
def test_bytes_of_a_sensor_that_restarted_are_refused_and_one_wrong_time_is_mended(
    tmp_path: Path, is_binary: bool
) -> None:
    voice = Ximu3Voice("0123ABCD", lambda number: motion(number % COUNT), rate_hz=HZ, is_binary=is_binary)
    path = tmp_path / "a.ximu3"
    path.write_bytes(b"\n" + b"".join(voice.sample(k) for k in [*range(150, 300), *range(150)]))
    assert "a.ximu3, sample 151: its clock goes back from" in refused(ximu3_trial, [path])
    path.write_bytes(b"\n" + b"".join(voice.sample(50_000 if k == 80 else k) for k in range(COUNT)))
    (sensor,) = ximu3_trial([path]).sensors
    assert sensor.block.time_s == pytest.approx(np.arange(COUNT) / HZ, abs=1e-4)
    assert [one.key for one in sensor.findings] == ["stamps_mended"]

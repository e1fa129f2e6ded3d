"""Files of a Shimmer3's card, laid out here as their description states: times, numbers, calibration, clocks."""

import struct
from pathlib import Path

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from devices.files.formats import format_of
from devices.files.shimmer_tables import shimmer_trial
from tests.trials_of_files import refused

PERIOD = 320  # 102.4 Hz
COUNT = 300
GYRO, WIDE, LOW_NOISE, BATTERY = 1 << 6, 1 << 12, 1 << 7, 1 << 13
# offsets, sensitivities, alignment in hundredths: x and y change places, as on the boards
GYR_BLOCK = struct.pack(">6h9b", 10, -20, 30, 1640, 1640, 1640, 0, -100, 0, -100, 0, 0, 0, 0, -100)
ACC_BLOCK = struct.pack(">6h9b", 5, 6, 7, 209, 209, 209, -100, 0, 0, 0, 100, 0, 0, 0, -100)


def rate_raw(k: int) -> tuple[int, int, int]:
    return 100 + k, -200, 300 - 2 * k


def force_raw(k: int) -> tuple[int, int, int]:
    return 2050, -10 - k, 17


def truth(count: int = COUNT) -> tuple[np.ndarray, np.ndarray]:
    """Rates in rad/s and force in m/s2 (n, 3): C = R^-1 K^-1 (U - B)."""
    turn = np.array([[0.0, -1, 0], [-1, 0, 0], [0, 0, -1]])
    flip = np.diag([-1.0, 1, -1])
    rates = (np.array([rate_raw(k) for k in range(count)], float) - [10, -20, 30]) / 16.40
    forces = (np.array([force_raw(k) for k in range(count)], float) - [5, 6, 7]) / 209
    return np.radians(rates @ np.linalg.inv(turn).T), forces @ np.linalg.inv(flip).T


def written(
    path: Path,
    *,
    switches: int = GYRO | WIDE,
    begun: int = 123_456_789,
    real: int = 0,
    ahead: tuple[int, float] | None = None,
    first: int = 0,
    count: int = COUNT,
    lost: int = -1,
    calibration: bytes = GYR_BLOCK,
    acc_calibration: bytes = ACC_BLOCK,
) -> Path:
    """`ahead`: ticks at the first sample, and more for each one, written as the radio reports them in each block."""
    head = bytearray(256)
    head[0:2] = struct.pack("<H", PERIOD)
    head[3:6] = switches.to_bytes(3, "little")
    head[16] = 0x04 if ahead is not None else 0
    head[30:32] = struct.pack(">H", 3)
    head[34:40] = struct.pack(">HHBB", 2, 0, 22, 0)
    head[44:52] = struct.pack(">Q", real)
    head[76:97], head[97:118], head[139:160] = acc_calibration, calibration, acc_calibration
    start = begun + PERIOD * first
    head[251:256] = start.to_bytes(5, "little")[4:] + start.to_bytes(5, "little")[:4]
    samples = []
    for k in range(first, first + count):
        if k == lost:
            continue
        body = ((begun + PERIOD * k) % (1 << 24)).to_bytes(3, "little")
        body += struct.pack("<3h", *force_raw(k)) if switches & LOW_NOISE else b""
        body += b"\x11\x22" if switches & BATTERY else b""
        body += struct.pack(">3h", *rate_raw(k)) if switches & GYRO else b""
        body += struct.pack("<3h", *force_raw(k)) if switches & WIDE else b""
        samples.append((k, body))
    size = len(samples[0][1])
    in_block = (512 - 9 * (ahead is not None)) // size
    data = bytes(head)
    for at in range(0, len(samples), in_block):
        block = samples[at : at + in_block]
        if ahead is not None:
            ticks = round(ahead[0] + ahead[1] * block[0][0])
            data += struct.pack("<BQ", 1 if ticks < 0 else 0, abs(ticks)) if at else b"\x00" + b"\xff" * 8
        data += b"".join(body for _, body in block)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("switches", [GYRO | WIDE, GYRO | LOW_NOISE, GYRO | WIDE | BATTERY, GYRO | WIDE | LOW_NOISE])
def test_a_file_is_recognised_and_read(tmp_path: Path, switches: int) -> None:
    path = written(tmp_path / "ID40AC" / "000", switches=switches)
    assert format_of(path) == "shimmer"
    (sensor,) = shimmer_trial([path]).sensors
    rate, force = truth()
    assert sensor.name == "ID40AC"
    assert sensor.block.gyr_rad_s == pytest.approx(rate)
    assert sensor.block.acc_m_s2 == pytest.approx(force)
    assert sensor.block.time_s == pytest.approx(np.arange(COUNT) * PERIOD / 32768)
    assert (sensor.info.rate_hz, sensor.findings) == (102.4, ())


def test_losses_are_gaps_and_a_cut_file_keeps_its_whole_samples(tmp_path: Path) -> None:
    path = written(tmp_path / "a.bin", lost=100)
    path.write_bytes(path.read_bytes()[:-7])
    (sensor,) = shimmer_trial([path]).sensors
    assert len(sensor.block) == COUNT - 2
    assert np.diff(sensor.block.time_s).max() == pytest.approx(2 * PERIOD / 32768)


def test_parts_of_one_folder_are_one_recording(tmp_path: Path) -> None:
    folder = tmp_path / "ID40AC"
    parts = [written(folder / f"{k:03d}", first=k * COUNT, count=COUNT) for k in (1, 0, 2)]
    (sensor,) = shimmer_trial(parts).sensors
    rate, _ = truth(3 * COUNT)
    assert sensor.block.gyr_rad_s == pytest.approx(rate)
    assert np.diff(sensor.block.time_s) == pytest.approx(PERIOD / 32768)


def test_clocks_that_the_radio_set_right_agree(tmp_path: Path) -> None:
    """One board began 5 s before the other and runs 60 ppm fast; real time was set alike."""
    leading = written(tmp_path / "A" / "000", begun=1_000_000, real=7_000_000, ahead=(0, 0.0))
    late = written(tmp_path / "B" / "000", begun=1_163_840, real=7_000_000, ahead=(163_840 - 32_768, 0.0192))
    first, second = shimmer_trial([leading, late]).sensors
    assert first.info.clock == second.info.clock == "Consensys"
    assert second.block.time_s[0] - first.block.time_s[0] == pytest.approx(1.0, abs=1e-3)
    lasts_s = (COUNT - 1) * (PERIOD - 0.0192) / 32768
    assert second.block.time_s[-1] - second.block.time_s[0] == pytest.approx(lasts_s, abs=1e-4)


def test_without_radio_each_keeps_its_own_clock(tmp_path: Path) -> None:
    paths = [written(tmp_path / name / "000", begun=1_000_000 + 3277 * k) for k, name in enumerate("AB")]
    first, second = shimmer_trial(paths).sensors
    assert (first.info.clock, second.info.clock) == ("A", "B")
    assert second.block.time_s[0] - first.block.time_s[0] == pytest.approx(0.1, abs=1e-3)


def test_what_cannot_be_used_is_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    in_g = struct.pack(">6h9b", 5, 6, 7, 2050, 2050, 2050, -100, 0, 0, 0, 100, 0, 0, 0, -100)
    empty = written(tmp_path / "c.bin")
    empty.write_bytes(empty.read_bytes()[:256])
    assert format_of(empty) == "shimmer"
    assert {
        "no accelerometer": refused(shimmer_trial, [written(tmp_path / "a.bin", switches=GYRO)]),
        "no calibration": refused(shimmer_trial, [written(tmp_path / "a.bin", calibration=bytes(21))]),
        "no samples": refused(shimmer_trial, [empty]),
        "by its calibration nothing weighs what it must": refused(
            shimmer_trial, [written(tmp_path / "a.bin", acc_calibration=in_g)]
        ),
        "the radio's rate is wrong": refused(shimmer_trial, [written(tmp_path / "B" / "000", ahead=(0, 12.0))]),
        "its clock restarts": refused(
            shimmer_trial, [with_stamps(tmp_path / "a.bin", {k: 1000 + PERIOD * (k - 150) for k in range(150, COUNT)})]
        ),
    } == snapshot


@pytest.mark.parametrize("data", [bytes(5000), b"\x40\x01" + bytes(5000), bytes(range(256)) * 20])
def test_other_bytes_are_none(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "other.bin"
    path.write_bytes(data)
    assert format_of(path) != "shimmer"


def with_stamps(path: Path, changes: dict[int, int]) -> Path:
    """The card with other times at some of its samples: 3 bytes at the begin of each, 15 bytes with both sensors."""
    data = bytearray(written(path).read_bytes())
    for k, ticks in changes.items():
        block, row = divmod(k, 512 // 15)
        at = 256 + block * (512 // 15) * 15 + row * 15
        data[at : at + 3] = (ticks % (1 << 24)).to_bytes(3, "little")
    path.write_bytes(bytes(data))
    return path


@pytest.mark.parametrize("k", [0, 1, 150, COUNT - 1])
@pytest.mark.parametrize("ticks", [0, 8_000_000, 123_456_789 + PERIOD * 200])
def test_one_wrong_time_harms_nothing_after_it(tmp_path: Path, k: int, ticks: int) -> None:
    (sensor,) = shimmer_trial([with_stamps(tmp_path / "a.bin", {k: ticks})]).sensors
    (right,) = shimmer_trial([written(tmp_path / "b.bin")]).sensors
    left_out = [k] if len(sensor.block) < COUNT else []
    expected_s = np.delete(right.block.time_s, left_out)
    assert len(left_out) <= int(k in (0, COUNT - 1))
    assert sensor.block.time_s == pytest.approx(expected_s - expected_s[0], abs=1e-6)
    assert [one.key for one in sensor.findings] == ["stamps_mended"]


def test_two_times_that_changed_places_harm_nothing_after_them(tmp_path: Path) -> None:
    begun = 123_456_789
    changes = {150: begun + PERIOD * 151, 151: begun + PERIOD * 150}
    (sensor,) = shimmer_trial([with_stamps(tmp_path / "a.bin", changes)]).sensors
    assert sensor.block.time_s == pytest.approx(np.arange(COUNT) * PERIOD / 32768)
    assert [one.numbers["count"] for one in sensor.findings] == [2]


def test_a_wrong_offset_from_the_radio_bends_no_clock(tmp_path: Path) -> None:
    path = written(tmp_path / "A" / "000", ahead=(5000, 0.0192), count=3000)
    (right,) = shimmer_trial([path]).sensors
    data = bytearray(path.read_bytes())
    in_block = (512 - 9) // 15
    at = 256 + 40 * (9 + 15 * in_block)
    data[at : at + 9] = struct.pack("<BQ", 0, 1 << 40)
    path.write_bytes(bytes(data))
    (sensor,) = shimmer_trial([path]).sensors
    assert sensor.block.time_s == pytest.approx(right.block.time_s, abs=1e-4)

"""The maker's own package decodes what our emulator states, and ours decodes the same: the same floats, both ways."""

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.samples import FloatArray
from devices.drivers.ximu3 import END, INERTIAL, numbers_of, read_file, unstuffed
from devices.emulators.transports import Emulation, TcpServer
from devices.emulators.ximu3 import Ximu3Voice, message

ximu3 = pytest.importorskip("ximu3", reason="the maker's package is not there")

COUNTS = (10_000, pytest.param(100_000, marks=pytest.mark.endurance))


def values(seed: int, count: int) -> FloatArray:
    """Rate and force as a moving leg has them, and every byte that has to be escaped."""
    chance = np.random.default_rng(seed)
    numbers = np.concatenate([chance.normal(0, 300, (count, 3)), chance.normal(0, 2, (count, 3))], axis=1)
    numbers[:, :3] = np.clip(numbers[:, :3], -2000, 2000)
    return numbers


def logged(folder: Path, count: int, is_binary: bool) -> Path:
    numbers = values(int(is_binary), count)
    path = folder / "sensor.ximu3"
    with path.open("wb") as file:
        for k, row in enumerate(numbers.tolist()):
            file.write(message("I", k * 2570, row, is_binary))
            if k % 10 == 0:
                file.write(message("Q", k * 2570, (0.5, -0.5, 0.5, -0.5), is_binary))
    return path


def theirs(path: Path, count: int) -> FloatArray:
    """What the maker's package makes of a file: microseconds, deg/s (3), g (3), as single precision."""
    found: list[tuple[float, ...]] = []

    def note(one: Any) -> None:
        found.append(
            (
                one.timestamp,
                one.gyroscope_x,
                one.gyroscope_y,
                one.gyroscope_z,
                one.accelerometer_x,
                one.accelerometer_y,
                one.accelerometer_z,
            )
        )

    connection = ximu3.Connection(ximu3.FileConnectionConfig(str(path)))
    connection.add_inertial_callback(note)
    connection.open()
    until_s = time.monotonic() + 60
    while len(found) < count and time.monotonic() < until_s:
        time.sleep(0.05)
    statistics = connection.get_statistics()
    connection.close()
    assert statistics.error_total == 0
    return np.array(found)


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("is_binary", [True, False], ids=["binary", "text"])
def test_both_make_the_same_floats_of_every_message(tmp_path: Path, count: int, is_binary: bool) -> None:
    path = logged(tmp_path, count, is_binary)
    maker = theirs(path, count)
    ours = [
        numbers_of(unstuffed(stated), INERTIAL, 6)
        for stated in path.read_bytes().split(END)[:-1]
        if stated[0] & 0x7F == ord("I")
    ]
    mine = np.array(ours)
    assert len(maker) == len(mine) == count
    assert np.array_equal(maker[:, 0], mine[:, 0])
    assert np.array_equal(maker[:, 1:].astype(np.float32), mine[:, 1:].astype(np.float32))
    one = read_file(path)
    assert (one.counts.received, one.counts.lost, one.counts.damaged) == (count, 0, 0)
    assert np.allclose(one.block.gyr_rad_s, np.radians(maker[:, 1:4]), rtol=1e-6, atol=1e-9)
    assert one.block.q_earth_from_sensor is not None
    assert np.isfinite(one.block.q_earth_from_sensor[:, 0]).sum() == count // 10


@pytest.mark.endurance
def test_the_maker_speaks_with_our_emulator_and_logs_what_it_states(tmp_path: Path) -> None:
    voice = Ximu3Voice("655782F7", lambda number: (number % 1000, -2.5, 3.25, 0.5, -0.25, 1.0), rate_hz=400)
    server = TcpServer()
    emulation = Emulation(voice, lambda: server)
    try:
        connection = ximu3.Connection(ximu3.TcpConnectionConfig(server.address, server.port))
        connection.open()
        response = connection.ping()
        assert response is not None
        assert (response.serial_number, response.interface) == ("655782F7", "USB")
        answer = connection.send_command('{"inertial_message_rate_divisor":null}')
        assert answer is not None
        assert answer.value == "1"
        assert connection.send_command('{"strobe":null}') is not None
        assert voice.strobed == 1
        logger = ximu3.DataLogger(str(tmp_path), "log", [connection])
        time.sleep(1.0)
        del logger  # which ends the log
        errors = connection.get_statistics().error_total
        connection.close()
    finally:
        emulation.close()
    assert errors == 0
    (log,) = tmp_path.rglob("Inertial.csv")
    rows = np.loadtxt(log, delimiter=",", skiprows=1)
    assert len(rows) > 200
    number = (rows[:, 0] - 1_000_000) / 2500
    assert np.array_equal(rows[:, 1], number % 1000)
    assert np.array_equal(rows[:, 2:], np.tile([-2.5, 3.25, 0.5, -0.25, 1.0], (len(rows), 1)))

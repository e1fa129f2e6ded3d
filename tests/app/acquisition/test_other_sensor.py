"""A sensor of another package is found beside ours, recorded as samples, and read again without the package."""

import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from app.acquisition.journal_stream import JournalStream
from app.storage.journal.decoding import decode
from devices.emulators.transports import Emulation, PseudoTerminal, Voice
from devices.emulators.ximu3 import Ximu3Voice
from devices.other_drivers import load_drivers
from devices.other_packages import SENSORS
from devices.search import search
from devices.transport.ports import PortInfo
from tests.devices.scripted import free_port
from tests.examples.new_sensor import FRAME
from tests.other_authors import PLUGIN, site_of_others, write_package
from tests.safety.journal_material import ID, KEY
from tests.safety.live_material import open_journal

pytestmark = pytest.mark.endurance  # ports are listened to for as long as they would be
FAULTY = """
from gaitwright.devices import Driver
class Protocol:
    version = "1"
    def framer(self, info):
        raise ZeroDivisionError
OFFER = Driver("faulty", "Faulty", "By nothing at all.", None, Protocol, (115200,))
"""
SAMPLES = 60


class SumVoice:
    """Sends a frame of the example's sensor every 10 ms; its force along z is that of gravity."""

    def __init__(self) -> None:
        self._begin_s, self._sent = time.monotonic(), 0

    def say(self) -> bytes:
        due = int((time.monotonic() - self._begin_s) * 100.0)
        stated = b"".join(self._frame(number) for number in range(self._sent, due))
        self._sent = due
        return stated

    def hear(self, data: bytes) -> bytes:
        return b""

    def _frame(self, number: int) -> bytes:
        body = FRAME.pack(0xA5, number % 256, 10, -5, 0, 0, 0, 981, 0, 0)[:-2]
        return body + bytes([sum(body) % 256, 0x5A])


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    for place in site_of_others(tmp_path, monkeypatch):
        source = (PLUGIN / "gaitwright_sum_sensor.py").read_text(encoding="utf-8")
        write_package(place, "strange", SENSORS, {"sum-sensor": f"{source}\nOFFER = DRIVER\n", "faulty": FAULTY})
        yield place


@pytest.fixture
def ports(tmp_path: Path) -> Iterator[list[PortInfo]]:
    voices: dict[str, Voice] = {
        "sum": SumVoice(),
        "ximu3": Ximu3Voice("0000000A", lambda number: (number % 100, 0, 0, 0, 0, 1.0)),
    }
    emulations = [Emulation(voice, partial(PseudoTerminal, tmp_path / name)) for name, voice in voices.items()]
    yield [PortInfo(emulation.place, is_named=True) for emulation in emulations]
    for emulation in emulations:
        emulation.close()


def test_it_is_found_recorded_and_read_without_its_package(site: Path, ports: list[PortInfo], tmp_path: Path) -> None:
    found = search(ports, free_port(), others=load_drivers({("strange", "1.0")}).drivers)
    assert sorted(sensor.driver for sensor in found.sensors) == ["sum-sensor", "ximu3"]
    (problem,) = map(str, found.broken)
    assert problem.startswith("The driver faulty of the package strange 1.0 stopped with an error (ZeroDivisionError)")
    source = found.of("sum-sensor")[0].make()
    source.open()
    (folder := tmp_path / "journal").mkdir()
    writer = open_journal(folder, ID)
    tape, lengths = JournalStream(writer, source), list[int]()
    while sum(lengths) < SAMPLES:
        for block in source.read(tape.keep_bytes):
            tape.keep_samples(block, 100.0)
            lengths.append(len(block))
    source.close()
    summary = writer.stop()
    (site / "strange-1.0.dist-info" / "entry_points.txt").unlink()
    assert load_drivers({("strange", "1.0")}).drivers == ()
    journal = decode([summary.path], KEY, {})
    (sensor,) = journal.sensors.values()
    assert sum(lengths[1:]) <= len(sensor.block) <= sum(lengths)  # what is of before the recording is not in it
    assert np.median(np.diff(sensor.block.time_s)) == pytest.approx(0.01, abs=0.001)
    assert sensor.block.acc_m_s2[:, 2] == pytest.approx(9.81)
    assert sensor.block.gyr_rad_s[:, 0] == pytest.approx(0.1)

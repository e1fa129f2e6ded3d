"""Lines of numbers: what the columns mean is reported, kept with the journal, and damage is seen where it can be."""

import json
import math
from pathlib import Path

import pytest

from devices.drivers.csv_serial import DRIVER, MOST_LINE, VERSION, Columns, CsvFramer, CsvSerial
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.source import SourceInfo
from devices.stream import ByteSource, Decoder
from devices.transport.ports import PortInfo, SerialPort

COLUMNS = Columns(0, (1, 2, 3), (4, 5, 6), count=7)


def arrived(columns: Columns, *stated: bytes) -> CsvFramer:
    framer = CsvFramer(columns)
    framer.feed(b"tail\n", 0.0)
    for piece in stated:
        framer.feed(piece, 0.0)
    return framer


def test_columns_units_and_signs_are_as_reported() -> None:
    columns = Columns(6, (3, 4, 5), (2, 1, 0), 1.0, 0, "rad/s", "mg", "semicolon", signs=(1, -1, 1, -1, 1, 1), count=7)
    (row,) = arrived(columns, b"1000;0;500;1.5;2.5;-3.5;12.25\r\n").received.rows
    assert row == pytest.approx((12.25, 1.5, -2.5, -3.5, -0.5 * 9.80665, 0.0, 9.80665))


@pytest.mark.parametrize(("separator", "sign"), [("comma", ","), ("tab", "\t"), ("space", "  ")])
def test_separators(separator: str, sign: str) -> None:
    columns = Columns(0, (1, 2, 3), (4, 5, 6), separator=separator)
    (row,) = arrived(columns, (sign.join(["10", "180", "0", "0", "0", "0", "1"]) + "\n").encode()).received.rows
    assert row[:2] == pytest.approx((0.01, math.pi))


def test_a_heading_is_skipped_and_damage_counted() -> None:
    good = b"10,1,2,3,0,0,1\n"
    bad = [b"10,1,2,3,0,0\n", b"10,1,2,3,0,0,1,5\n", b"10,x,2,3,0,0,1\n", b"10,1e9,2,3,0,0,1\n", b"nan,1,2,3,0,0,1\n"]
    bad += [b"\n", b"9" * (MOST_LINE + 5) + b"\n"]
    found = arrived(COLUMNS, b"time,gx,gy,gz,ax,ay,az\n", good, *bad, good).received
    assert len(found.rows) == 2
    assert (found.skipped, found.damaged) == (1, len(bad))


def test_a_time_beyond_all_numbers_is_damage() -> None:
    columns = Columns(0, (1, 2, 3), (4, 5, 6), tick_hz=0.01, count=7)
    found = arrived(columns, b"1,1,2,3,0,0,1\n", b"1e307,1,2,3,0,0,1\n").received
    assert (len(found.rows), found.damaged) == (1, 1)


def test_a_counter_that_begins_again_goes_on() -> None:
    columns = Columns(0, (1, 2, 3), (4, 5, 6), tick_hz=100.0, wraps_bits=16, rate_hz=100.0)
    decoder = Decoder(CsvSerial())
    decoder.begin(SourceInfo(DRIVER, VERSION, sensors=("C",), settings=columns.settings()))
    decoder.feed(b"\n", 0.0)
    for number in range(65_000, 66_000):
        if number != 65_700:
            decoder.feed(f"{number % 65536},1,2,3,0,0,1\n".encode(), number / 100)
    one = decoder.finish()["C"]
    assert (one.counts.received, one.counts.lost, one.counts.damaged) == (999, 1, 0)


def test_what_columns_mean_comes_back_from_a_journal() -> None:
    columns = Columns(0, (1, 2, 3), (4, 5, 6), wraps_bits=24, signs=(1, 1, -1, 1, 1, 1), rate_hz=50.0, count=9)
    assert Columns.parsed(json.loads(json.dumps(columns.settings()))) == columns
    with pytest.raises(ValueError, match="does not say"):
        Columns.parsed({})


@pytest.mark.parametrize(
    "wrong",
    [
        {"time": 1},
        {"rate": (1, 2)},
        {"rate_unit": "rpm"},
        {"separator": "dot"},
        {"wraps_bits": 7},
        {"tick_hz": 0.0},
        {"signs": (1, 1, 1, 1, 1, 0)},
    ],
)
def test_columns_that_cannot_be_are_refused(wrong: dict[str, object]) -> None:
    reported: dict[str, object] = {"time": 0, "rate": (1, 2, 3), "force": (4, 5, 6)}
    with pytest.raises(ValueError, match=r"columns|unit|expected|signs"):
        Columns(**{**reported, **wrong})  # type: ignore[arg-type]  # wrong on purpose


class ScriptedLines:
    """Sends a line with every breath."""

    def __init__(self) -> None:
        self.number = 0

    def say(self) -> bytes:
        self.number += 1
        return f"{self.number * 10},{self.number % 100},2,3,0,0,1\n".encode()

    def hear(self, data: bytes) -> bytes:
        return b""


def test_it_is_received_through_a_port(tmp_path: Path) -> None:
    emulation = Emulation(ScriptedLines(), lambda: PseudoTerminal(tmp_path / "port"))
    source = ByteSource(CsvSerial(COLUMNS, name="home-made"), SerialPort(PortInfo(emulation.place)))
    try:
        source.open()
        kept = bytearray()
        count = sum(len(block) for _ in range(20) for block in source.read(kept.extend))
    finally:
        source.close()
        emulation.close()
    assert source.info.sensors == ("home-made",)
    assert count > 5
    assert count <= kept.count(b"\n")

"""T5: damaged streams. Check whether a driver raises, loses whole messages, falls out of step, or hoards bytes.

    python -m tests.safety.device_fuzz --frames 1000000 [--bursts]

One message in seven is changed, cut, doubled in part, or has noise before it; the stream is fed in pieces of any size.
A message that is whole, and begins where a whole one ended or after a whole end of line, has to be received. With
`--bursts` whole blocks are damaged, lost, swapped, repeated or stamped by a clock that leaps (`stream_bursts.py`); then
a whole message has to be received that follows two whole ones in their order.
"""

import argparse
import random
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from devices.drivers.csv_serial import Columns, CsvFramer
from devices.drivers.shimmer3 import Shimmer3Framer, checksum
from devices.drivers.witmotion import WitFramer
from devices.drivers.ximu3 import Ximu3Framer
from devices.drivers.xsens_mti import MtiFramer
from devices.emulators.shimmer3 import ACC_CALIBRATION, CHANNELS, GYR_CALIBRATION, Shimmer3Voice
from devices.emulators.witmotion import WitVoice
from devices.emulators.ximu3 import message
from devices.emulators.xsens_mti import MtiVoice
from devices.source import SourceInfo
from devices.stream import Framer, Row
from tests.driver import Found, drive
from tests.safety.stream_bursts import in_bursts

DAMAGED_SHARE = 1 / 7
FOLLOWS = 2  # whole messages after a burst; the next one must be received
LONGEST_PIECE = 300
MOST_HELD = 4096 + LONGEST_PIECE
SHIMMER3 = SourceInfo(
    "shimmer3",
    "1",
    settings={
        "period_ticks": 320,
        "channels": list(CHANNELS),
        "has_checksum": True,
        "gyr_calibration": GYR_CALIBRATION.hex(),
        "acc_calibration": ACC_CALIBRATION.hex(),
    },
)
OLD_SHIMMER3 = SourceInfo("shimmer3", "1", settings={**SHIMMER3.settings, "has_checksum": False})
MTI = SourceInfo("xsens-mti", "1", settings={"rate_hz": 100.0})
COLUMNS = Columns(0, (1, 2, 3), (4, 5, 6), count=7)


@dataclass(frozen=True, slots=True)
class Fuzzed:
    """A driver's protocol: how a sample of this number is sent, and whether an end of line parts messages."""

    make: Callable[[], Framer]
    sample: Callable[[int], bytes]
    has_lines: bool
    row: Callable[[bytes], Row] | None = None
    """What a message reports that is not understood alone."""
    most_held: int = MOST_HELD
    most_lost: int = 0
    """Of a thousand messages, where not every whole one beside damage can be distinguished from it."""
    most_false: int | None = None
    """Of a thousand messages damaged one by one, those received that nobody sent; None: nothing tells them apart."""


def motion(number: int) -> Sequence[float]:
    chance = random.Random(number)
    return [*(chance.uniform(-1900, 1900) for _ in range(3)), *(chance.uniform(-15, 15) for _ in range(3))]


def line(number: int) -> bytes:
    return f"{number * 10},{','.join(f'{value:.3f}' for value in motion(number))}\r\n".encode()


def raw(number: int) -> Sequence[int]:
    chance = random.Random(number)
    return [chance.randrange(-32768, 32768) for _ in range(6)]


def drivers() -> dict[str, Fuzzed]:
    mti = MtiVoice(motion=lambda number: [*(value / 60.0 for value in motion(number)), 1.0, 0.0, 0.0, 0.0])  # rad/s
    shimmer3 = Shimmer3Voice(raw)
    shimmer3.period, shimmer3.has_checksum = 320, True
    voice = WitVoice("1", motion, content=0b1111, now_ns=lambda: 0)
    return {
        "x-IMU3, binary": Fuzzed(Ximu3Framer, lambda k: message("I", k * 10_000, motion(k), True), True),
        "x-IMU3, text": Fuzzed(Ximu3Framer, lambda k: message("I", k * 10_000, motion(k), False), True),
        "WitMotion": Fuzzed(WitFramer, voice.sample, False, most_false=1),
        "Xsens MTi": Fuzzed(lambda: MtiFramer(MTI), mti.sample, False, most_false=1),
        "Shimmer3, with checksums": Fuzzed(
            lambda: Shimmer3Framer(SHIMMER3), shimmer3.sample, False, most_held=50, most_false=0
        ),
        "CSV": Fuzzed(lambda: CsvFramer(COLUMNS), line, True),
    }


def old_shimmer3() -> Fuzzed:
    """A Shimmer3 whose packets have no checksum: not every whole one beside damage can be distinguished from it."""
    voice, checked = Shimmer3Voice(raw), drivers()["Shimmer3, with checksums"]
    voice.period = 320
    return Fuzzed(
        lambda: Shimmer3Framer(OLD_SHIMMER3),
        voice.sample,
        False,
        lambda stated: row_of(checked, stated + checksum(stated)),
        most_held=50,
        most_lost=1,
    )


def fuzz(driver: Fuzzed, frames: int, seed: int, *, has_bursts: bool = False) -> Found:
    """A message that was never sent is a fault where the protocol has a checksum."""
    chance, found = random.Random(seed), Found(Counter(messages=frames))
    framer = driver.make()
    received: dict[Row, int] = {}
    expected: set[Row] = set()
    sent: set[Row] = set()
    waiting = b""
    for stated, sample, is_expected in (_in_bursts if has_bursts else _one_by_one)(driver, frames, chance):
        if sample:
            sent.add(row := row_of(driver, sample))
            if is_expected:
                expected.add(row)
                found.count["whole"] += 1
        waiting += stated
        while len(waiting) > LONGEST_PIECE:
            size = chance.randint(1, LONGEST_PIECE)
            piece, waiting = waiting[:size], waiting[size:]
            _feed(framer, piece, received, found)
    _feed(framer, waiting, received, found)
    framer.flush()
    _take(framer, received)
    found.count["that were none"] = len(received.keys() - sent)
    found.count["whole, but lost"] = len(expected - received.keys())
    if found.count["whole, but lost"] > driver.most_lost * frames / 1000:
        found.faults.append(f"{found.count['whole, but lost']} whole messages lost")
    most_false = None if has_bursts else driver.most_false
    if most_false is not None and found.count["that were none"] > most_false * frames / 1000:
        found.faults.append(f"{found.count['that were none']} messages received that nobody sent")
    if found.count["bytes held at most"] > driver.most_held:
        found.faults.append(f"{found.count['bytes held at most']} bytes held")
    if not framer.received.damaged:
        found.faults.append("no damage was reported")
    return found


Stated = tuple[bytes, bytes, bool]
"""What is fed, the message of the sample that was to be reported, empty where there was none, and whether it must
be."""


def _one_by_one(driver: Fuzzed, frames: int, chance: random.Random) -> Iterator[Stated]:
    is_joined = False  # whether the end of the message before is whole
    for number in range(frames):
        sample = driver.sample(number)
        stated = _damaged(sample, chance) if chance.random() < DAMAGED_SHARE else sample
        yield stated, sample, stated == sample and (is_joined or not driver.has_lines)
        is_joined = stated.endswith(b"\n") if driver.has_lines else True


def _in_bursts(driver: Fuzzed, frames: int, chance: random.Random) -> Iterator[Stated]:
    follows, before = 0, -1  # how many whole messages in their order came before this one
    for one in in_bursts(driver.sample, frames, chance):
        follows = follows + 1 if one.number is not None and one.number == before + 1 else 0
        before = -1 if one.number is None else one.number
        yield one.data, one.data if one.number is not None else b"", follows >= FOLLOWS


def _feed(framer: Framer, piece: bytes, received: dict[Row, int], found: Found) -> None:
    try:
        framer.feed(piece, 0.0)
    except Exception as error:  # which is what is looked for
        found.faults.append(repr(error))
    held = getattr(getattr(framer, "_framer", framer), "_held", getattr(framer, "_rest", b""))
    found.count["bytes held at most"] = max(found.count["bytes held at most"], len(held))
    _take(framer, received)


def _take(framer: Framer, received: dict[Row, int]) -> None:
    for row in (row[1:] for row in framer.received.rows):  # its time depends on those before
        received[row] = received.get(row, 0) + 1
    framer.received.rows.clear()
    framer.received.replies.clear()


def row_of(driver: Fuzzed, sample: bytes) -> Row:
    """What a whole message reports: rate and force."""
    if driver.row is not None:
        return driver.row(sample)
    framer = driver.make()
    framer.feed((b"\n" if driver.has_lines else b"") + sample, 0.0)
    framer.flush()
    (row,) = framer.received.rows
    return row[1:]


def _damaged(sample: bytes, chance: random.Random) -> bytes:
    data = bytearray(sample)
    at = chance.randrange(len(data))
    match chance.randrange(7):
        case 0:
            data[at] ^= 1 << chance.randrange(8)
        case 1:
            for _ in range(chance.randint(2, 8)):
                data[chance.randrange(len(data))] = chance.randrange(256)
        case 2:
            del data[at : at + chance.randint(1, 12)]
        case 3:
            data[at:at] = chance.randbytes(chance.randint(1, 20))
        case 4:
            del data[at:]
        case 5:
            data[at:at] = data[: chance.randint(1, len(data))]
        case _:
            data[:0] = chance.randbytes(chance.randint(1, 200))
    return bytes(data)


def speed(driver: Fuzzed, frames: int = 20_000) -> int:
    """Messages decoded a second, of a clean stream in pieces of 500 bytes."""
    stated = b"".join(driver.sample(number) for number in range(frames))
    framer = driver.make()
    begin_s = time.process_time()
    for at in range(0, len(stated), 500):
        framer.feed(stated[at : at + 500], 0.0)
    framer.flush()
    assert len(framer.received.rows) >= frames - 1
    return round(frames / (time.process_time() - begin_s))


def run(asked: argparse.Namespace, _: Path) -> Iterator[tuple[str, Found]]:
    for name, driver in drivers().items():
        if asked.driver in name:
            found = fuzz(driver, asked.frames, asked.seed, has_bursts=asked.bursts)
            found.count["messages decoded a second"] = round(speed(driver), -2)
            yield name, found


if __name__ == "__main__":
    drive(
        __doc__,
        run,
        frames=1_000_000,
        seed=1,
        bursts=False,
        driver=("", "only those whose name has this in it"),
    )

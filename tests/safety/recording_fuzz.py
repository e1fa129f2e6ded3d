"""T5, whole recordings:

check that nothing raises between a hurt stream and its Recording. The stamps must still be right.

    python -m tests.safety.recording_fuzz --samples 1000000

A sensor's stream is hurt in bursts (`stream_bursts.py`), arrives late or all at once, and is cut by losses of the
source. It goes the way of a visit: the source reads it and stamps it live, a journal keeps it, and the Recording is
decoded from the journal. Streams of samples (Lab Streaming Layer) are kept as they are stamped live.

Whatever was sent, stamps ascend, each sample is there once, and counts add up. How many whole samples were left out and
how many are stamped more than `RIGHT_S` wrong is reported: a clock that leaps amid damage cannot always be followed.
"""

import argparse
import random
import tempfile
import traceback
import uuid
import warnings
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

from app.acquisition.journal_stream import JournalStream
from app.acquisition.sensor_stream import SensorStream
from app.storage.journal.decoding import DecodedJournal, decode
from app.storage.journal.payloads import layout_of
from app.storage.journal.writer import JournalWriter
from core.body import Site
from core.samples import ImuBlock
from core.session import Recording, RecordingKind
from devices.clocks.live_clock import LiveClock
from devices.decoders import DECODERS
from devices.drivers.csv_serial import DRIVER as CSV
from devices.drivers.lsl import DRIVER as LSL
from devices.drivers.witmotion import DRIVER as WITMOTION
from devices.drivers.ximu3 import DRIVER as XIMU3
from devices.live import SensorDetails
from devices.source import SourceInfo
from devices.stream import ByteSource, Framer, Row
from devices.transport.channels import Channel
from tests.driver import Found, drive
from tests.safety.device_fuzz import COLUMNS, MTI, OLD_SHIMMER3, SHIMMER3, Fuzzed, drivers, motion, old_shimmer3, row_of
from tests.safety.journal_material import NO_ROOM_ASKED
from tests.safety.stream_bursts import Sent, in_bursts

SHIMMER3_HZ = 32768 / 320
PER_RECORDING = 3000  # samples
PIECES = (1, 40)  # messages that arrive together
HELD_UP_SHARE, HELD_UP_S = 1 / 500, 8.0
LOST_SHARE = 1 / 300  # of the pieces, before which the source was lost
RIGHT_S = 0.02
WRONG = f"stamped more than {1000 * RIGHT_S:.0f} ms wrong"
BEGIN_S = 5000.0  # on the host's clock
NAME, SITE = "fuzzed", Site.LEFT_FOOT


@dataclass(frozen=True, slots=True)
class Stream:
    """A kind of sensor: what its decoder is reported, and its protocol; None where it gives samples, not bytes."""

    info: SourceInfo
    protocol: Fuzzed | None
    rate_hz: float


@dataclass(frozen=True, slots=True)
class Arrival:
    """What comes at one time. `is_back`: the source was lost before."""

    at_s: float
    sent: Sequence[Sent]
    is_back: bool


def streams() -> dict[str, Stream]:
    settings = {
        "x-IMU3, binary": (XIMU3, {}, 100.0),
        "x-IMU3, text": (XIMU3, {"rate_hz": 100.0}, 100.0),
        "WitMotion": (WITMOTION, {}, 100.0),
        "Xsens MTi": (MTI.driver, MTI.settings, 100.0),
        "Shimmer3, with checksums": (SHIMMER3.driver, SHIMMER3.settings, SHIMMER3_HZ),
        "Shimmer3, without": (OLD_SHIMMER3.driver, OLD_SHIMMER3.settings, SHIMMER3_HZ),
        "CSV": (CSV, COLUMNS.settings(), 100.0),
    }
    known = {**drivers(), "Shimmer3, without": old_shimmer3()}
    found = {
        name: Stream(SourceInfo(driver, "1", "", (NAME,), reported), known[name], rate_hz)
        for name, (driver, reported, rate_hz) in settings.items()
    }
    return {**found, "Lab Streaming Layer": Stream(SourceInfo(LSL, "1", "", (NAME,)), None, 100.0)}


def fuzz(stream: Stream, samples: int, seed: int) -> Found:
    outcome = Found(Counter(samples=samples))
    with tempfile.TemporaryDirectory(prefix="gaitwright-fuzz-") as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        for number, first in enumerate(range(0, samples, PER_RECORDING)):
            chance = random.Random(f"{seed} {number}")
            try:
                _record(stream, min(PER_RECORDING, samples - first), chance, Path(folder), outcome)
            except Exception:  # which is what is looked for
                outcome.faults.append(f"recording {number}: {traceback.format_exc()}")
            outcome.count["recordings"] += 1
    return outcome


def _record(stream: Stream, samples: int, chance: random.Random, folder: Path, outcome: Found) -> None:
    arrivals = list(_arriving(stream, samples, chance))
    clock = _Clock()
    identity = uuid.UUID(int=chance.getrandbits(128))
    with JournalWriter.create(folder, identity, None, room=NO_ROOM_ASKED, now_ns=clock.now_ns) as journal:
        if stream.protocol is None:
            visit: _BytesVisit | _SamplesVisit = _SamplesVisit(stream, clock, journal)
        else:
            visit = _BytesVisit(stream, stream.protocol, clock, journal)
        for arrival in arrivals:
            clock.now_s = BEGIN_S + arrival.at_s
            visit.hear(arrival)
    decoded = decode([journal.path], None, DECODERS)
    journal.path.unlink()
    recording = decoded.recording(Recording("fuzzed", RecordingKind.WALKING, "", {}), {NAME: SITE})
    outcome.faults += _contradictions(decoded)
    _compare(stream, arrivals, recording, outcome)


def _arriving(stream: Stream, samples: int, chance: random.Random) -> Iterator[Arrival]:
    """The stream in pieces: each comes a moment after its last sample was taken, or once a stall is over."""
    make = stream.protocol.sample if stream.protocol is not None else (lambda _number: b"-")
    waiting: list[Sent] = []
    taken, size, at_s = 0, 1, 0.0
    for one in in_bursts(make, samples, chance):
        waiting.append(one)
        taken = max(taken, one.index or 0)
        if len(waiting) >= size:
            stall_s = chance.uniform(0.0, HELD_UP_S) if chance.random() < HELD_UP_SHARE else 0.0
            at_s = max(at_s, taken / stream.rate_hz + stall_s + chance.uniform(0.0005, 0.01))
            yield Arrival(at_s, waiting, chance.random() < LOST_SHARE)
            waiting, size = [], chance.randint(*PIECES)
    yield Arrival(max(at_s, taken / stream.rate_hz), waiting, is_back=False)


class _Clock:
    """The host's, set by hand."""

    def __init__(self) -> None:
        self.now_s = BEGIN_S

    def now_ns(self) -> int:
        return round(self.now_s * 1e9)


class _Greeted:
    """A driver's `SensorProtocol` that knows its sensor, and the `Channel` to it that gives one piece at a time."""

    version, place, serial = "1", "", ""

    def __init__(self, stream: Stream, protocol: Fuzzed) -> None:
        self.driver, self._info, self._protocol = stream.info.driver, stream.info, protocol
        self.piece = b""

    def framer(self, info: SourceInfo) -> Framer:
        return self._protocol.make()

    def greet(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        return self._info, SensorDetails()

    def identifying(self) -> bytes:
        return b""

    def open(self) -> None: ...

    def read(self) -> bytes:
        piece, self.piece = self.piece, b""
        return piece

    def write(self, data: bytes) -> None: ...

    def close(self) -> None: ...


class _BytesVisit:
    """What reads, keeps and shows a source of bytes."""

    def __init__(self, stream: Stream, protocol: Fuzzed, clock: _Clock, journal: JournalWriter) -> None:
        self._greeted, self._clock = _Greeted(stream, protocol), clock
        self._source = ByteSource(self._greeted, self._greeted, clock.now_ns)
        self._source.open()
        self._tape, self._shown = JournalStream(journal, self._source), SensorStream(NAME, stream.rate_hz, 0.0)

    def hear(self, arrival: Arrival) -> None:
        if arrival.is_back:
            self._source.close()
            self._source.open()
            self._tape.come_back()
        self._greeted.piece = b"".join(one.data for one in arrival.sent)
        for block in self._source.read(self._tape.keep_bytes):
            self._shown.hear(block, block.time_s - BEGIN_S, arrival.at_s)
        self._shown.status(0, SensorDetails(), arrival.at_s)


class _SamplesVisit:
    """The same of a source that gives samples, stamped by the clock of a sender that may begin again."""

    def __init__(self, stream: Stream, clock: _Clock, journal: JournalWriter) -> None:
        self._stream, self._host, self._journal, self._live = stream, clock, journal, LiveClock()
        self._layout = layout_of(self._block([]), stream.rate_hz)
        self._number = journal.source(stream.info, self._layout)
        self._shown = SensorStream(NAME, stream.rate_hz, 0.0)

    def hear(self, arrival: Arrival) -> None:
        if arrival.is_back:
            self._live.begin()
            self._journal.change(self._number, self._stream.info, self._layout)
        if numbers := [one.number for one in arrival.sent if one.number is not None]:
            block = self._block(numbers)
            self._journal.samples(self._number, 0, block)
            self._shown.hear(block, block.time_s, arrival.at_s)

    def _block(self, numbers: Sequence[int]) -> ImuBlock:
        time_s = self._live.stamp(np.array(numbers) / self._stream.rate_hz, self._host.now_s) - BEGIN_S
        rows = np.array([motion(number) for number in numbers]).reshape(-1, 6)
        return ImuBlock(NAME, time_s, rows[:, :3], rows[:, 3:])


def _contradictions(decoded: DecodedJournal) -> Iterator[str]:
    if decoded.undecoded or decoded.dropped_records:
        yield f"not decoded: {decoded.undecoded}, dropped: {decoded.dropped_records}"
    for sensor in decoded.sensors.values():
        block, counts = sensor.block, sensor.counts
        if not np.isfinite(block.time_s).all() or not (np.diff(block.time_s) > 0).all():
            yield "stamps do not ascend"
        if np.isinf(block.gyr_rad_s).any() or np.isinf(block.acc_m_s2).any():
            yield "a value without bounds"
        if counts.received != len(block) or min(astuple(counts)) < 0:
            yield f"{len(block)} samples are told as {counts}"


def _compare(stream: Stream, arrivals: Sequence[Arrival], recording: Recording, outcome: Found) -> None:
    """Count whole samples, those that the recording holds, and those of them whose stamps are not right."""
    taken_s: defaultdict[Row, list[float]] = defaultdict(list)
    for one in (one for arrival in arrivals for one in arrival.sent):
        if one.number is None:
            continue
        row = tuple(motion(one.number)) if stream.protocol is None else row_of(stream.protocol, one.data)
        taken_s[row] += [] if one.index is None else [one.index / stream.rate_hz]
    outcome.count["sent whole"] += sum(map(bool, taken_s.values()))
    if SITE not in recording.imu:
        return
    block = recording.imu[SITE]
    rows = zip(*block.gyr_rad_s.T.tolist(), *block.acc_m_s2.T.tolist(), strict=True)
    for row, time_s in zip(rows, block.time_s.tolist(), strict=True):
        if sent_s := taken_s.get(row):
            outcome.count["in the recordings"] += 1
            outcome.count[WRONG] += min(abs(time_s - at_s) for at_s in sent_s) > RIGHT_S


def run(asked: argparse.Namespace, _: Path) -> Iterator[tuple[str, Found]]:
    for name, stream in streams().items():
        if asked.sensor in name:
            yield name, fuzz(stream, asked.samples, asked.seed)


if __name__ == "__main__":
    drive(
        __doc__,
        run,
        samples=(1_000_000, "of each kind of sensor"),
        seed=1,
        sensor=("", "only those whose name has this in it"),
    )

"""What is recorded where journals are killed, torn and filled: the sources of six sensors, and a decoder of lines."""

import itertools
from collections.abc import Mapping
from pathlib import Path
from uuid import UUID

import numpy as np

from app.storage.data_key import KeyMaterial
from app.storage.journal.disk import Room
from app.storage.journal.payloads import layout_of
from app.storage.journal.reader import Damage, JournalReader, ReadReport
from app.storage.journal.records import Record
from app.storage.journal.writer import JournalSummary, JournalWriter
from core.samples import ImuBlock
from devices.source import DecodedSensor, SensorCounts, SourceInfo

ID = UUID("01890a5d-ac96-774b-bcce-b302099a8057")
OTHER_ID = UUID("01890a5d-ac96-774b-bcce-b302099a8058")
KEY = bytes(range(32))
NO_ROOM_ASKED = Room(start_s=0.0, start_bytes=0, warn_s=0.0, kept_bytes=0)
RATE_HZ = 200.0
NAMES = tuple(f"sensor-{k}" for k in range(6))


def block(sensor: str, first: int, count: int = 1, rate_hz: float = RATE_HZ) -> ImuBlock:
    """`count` samples from number `first` on, all values reported by their number."""
    number = np.arange(first, first + count, dtype=float)
    return ImuBlock(
        sensor=sensor,
        time_s=number / rate_hz,
        gyr_rad_s=np.sin(number[:, None] / 7 + np.arange(3)),
        acc_m_s2=9.81 * np.cos(number[:, None] / 11 + np.arange(3)),
    )


LAYOUT = layout_of(block("any", 0), RATE_HZ)
WALKER = SourceInfo("walker", "1", sensors=NAMES, is_simulated=True)
LINES = SourceInfo("lines", "1", serial="port-1", sensors=("line",), settings={"rate_hz": RATE_HZ})


def record_some(
    folder: Path, data_key: KeyMaterial | None, *, recording_id: UUID = ID, rounds: int = 20
) -> JournalSummary:
    """A whole journal: per round one sample of each of six sensors and one line; on every tenth a mark."""
    with JournalWriter.create(folder, recording_id, data_key, room=NO_ROOM_ASKED) as journal:
        walker, lines = journal.source(WALKER, LAYOUT), journal.source(LINES)
        journal.sent(lines, b"start\n")
        for number in range(rounds):
            for k, name in enumerate(NAMES):
                journal.samples(walker, k, block(name, number))
            journal.received(lines, line(number))
            if number % 10 == 0:
                journal.mark(f"round {number}")
    return journal.stop()


def read_all(
    path: Path, data_key: bytes | None, wrapped_key: bytes | None = None
) -> tuple[list[Record], list[Damage], ReadReport]:
    reader = JournalReader(path, data_key, wrapped_key)
    found = list(reader.records())
    records = [one for one in found if isinstance(one, Record)]
    return records, [one for one in found if isinstance(one, Damage)], reader.report


def line(number: int) -> bytes:
    """One sample as the small protocol of these tests sends it: number, rate (3), force (3), end of line."""
    values = [*np.sin(number / 7 + np.arange(3)), *(9.81 * np.cos(number / 11 + np.arange(3)))]
    return f"{number},{','.join(f'{value:.6f}' for value in values)}\n".encode()


class LineDecoder:
    """Decodes `line`: comma-separated values, one sample a line, lost ones reported by their number."""

    def __init__(self) -> None:
        self._rate_hz = RATE_HZ
        self._sensor = ""
        self._rest = b""
        self._rows: dict[int, list[float]] = {}
        self._damaged = self._doubled = self._late = 0
        self.host_times_s: list[float] = []

    def begin(self, source: SourceInfo) -> None:
        rate_hz = source.settings["rate_hz"]
        assert isinstance(rate_hz, float)
        self._rate_hz, self._sensor = rate_hz, source.sensors[0]
        self._damaged += bool(self._rest)
        self._rest = b""

    def feed(self, data: bytes, host_time_s: float) -> None:
        self.host_times_s.append(host_time_s)
        *lines, self._rest = (self._rest + data).split(b"\n")
        for one in lines:
            try:
                number, *values = one.decode("ascii").split(",")
                row = [float(value) for value in values]
                if len(row) != 6:
                    raise ValueError(one)
                self._doubled += int(number) in self._rows
                self._late += bool(self._rows) and int(number) < max(self._rows)
                self._rows.setdefault(int(number), row)
            except ValueError:
                self._damaged += 1

    def finish(self) -> Mapping[str, DecodedSensor]:
        numbers = sorted(self._rows)
        rows = np.array([self._rows[number] for number in numbers]).reshape(-1, 6)
        lost = sum(b - a - 1 for a, b in itertools.pairwise(numbers))
        decoded = ImuBlock(self._sensor, np.array(numbers, dtype=float) / self._rate_hz, rows[:, :3], rows[:, 3:])
        counts = SensorCounts(len(numbers), lost, self._damaged, self._doubled, self._late)
        return {self._sensor: DecodedSensor(decoded, counts)}

"""Ports that send lines of numbers, and what their columns may be.

Whoever built the sensor knows; what is guessed here is shown to be confirmed, never used unseen.
"""

import math
import threading
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from core.samples import G_M_S2, FloatArray
from devices.drivers.csv_serial import FORCE_UNITS, MOST_LINE, SEPARATORS, Columns
from devices.live import SourceLostError, SourceRefusedError
from devices.transport.channels import Channel
from devices.transport.ports import PortInfo

LEAST_LINES, LEAST_COLUMNS = 3, 7
KEPT_LINES = 200
STILL = (0.7, 1.4)  # times gravity: what an acceleration's size is about, whatever moves
TICKS_HZ = (1.0, 1e3, 1e6)  # seconds, milliseconds, microseconds


Triple = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class LinesAt:
    """A port that sends lines of so many numbers; `columns` None: nobody stated yet what they mean."""

    port: PortInfo
    baud: int
    count: int
    columns: Columns | None = None


def columns_in(data: bytes) -> int:
    """How many columns the lines of a stream have; 0 where they are none of numbers."""
    table, _ = table_of(data.decode("ascii", "replace").splitlines()[1:-1])  # the first and the last may be cut
    return table.shape[1] if len(table) >= LEAST_LINES else 0


def table_of(lines: Sequence[str]) -> tuple[FloatArray, str]:
    """Give the numbers (n, columns) of lines with the usual many of them, and the name of their separator."""
    best, chosen = np.empty((0, 0)), "comma"
    for name, separator in SEPARATORS.items():
        rows = [row for line in lines if (row := _numbers(line, separator))]
        counts = [len(row) for row in rows if len(row) >= LEAST_COLUMNS]
        if not counts:
            continue
        usual = max(set(counts), key=counts.count)
        table = np.array([row for row in rows if len(row) == usual])
        if len(table) > len(best):
            best, chosen = table, name
    return best, chosen


def guessed(lines: Sequence[str]) -> Columns | None:
    """What the columns may be: a time that ascends, three that hold gravity, three beside them; None: no idea."""
    table, separator = table_of(lines)
    if len(table) < LEAST_LINES:
        return None
    count = table.shape[1]
    step = np.diff(table, axis=0)
    ascending = [column for column in range(count) if (step[:, column] > 0).all()]
    time = ascending[0] if ascending else 0
    found = [
        (abs(math.log(size)), unit, rate, force)
        for unit, scale in FORCE_UNITS.items()
        for force in ((first, first + 1, first + 2) for first in range(count - 2))
        for rate in (_beside(force, -1), _beside(force, 1))
        if min(rate) >= 0 and max(rate) < count and time not in (*rate, *force)
        if STILL[0] < (size := float(np.median(np.linalg.norm(table[:, force] * scale, axis=1))) / G_M_S2) < STILL[1]
    ]
    if not found:
        return None
    _, unit, rate, force = min(found)
    tick_hz = _tick_hz(float(np.median(step[:, time])))
    return Columns(time, rate, force, tick_hz, 0, "deg/s", unit, separator, count=count)


def _beside(columns: Triple, direction: int) -> Triple:
    x, y, z = (column + 3 * direction for column in columns)
    return x, y, z


def _tick_hz(step: float) -> float:
    """Ticks a second, if a step of the clock is 2 to 50 ms; milliseconds where that gives nothing."""
    return next((hz for hz in TICKS_HZ if 0.002 < step / hz < 0.05), 1e3)


def _numbers(line: str, separator: str) -> list[float]:
    parts = line.split() if separator == " " else line.strip().split(separator)
    numbers: list[float] = []
    for part in parts:
        try:
            numbers.append(float(part))
        except ValueError:
            return []
    return numbers if np.isfinite(numbers).all() else []


class LinePreview:
    """Reads a port in a thread of its own, for somebody who looks at what comes. `lines` may be read from any."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._lines: deque[str] = deque(maxlen=KEPT_LINES)
        self._is_closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="lines of numbers", daemon=True)

    def start(self) -> None:
        self._thread.start()

    @property
    def lines(self) -> tuple[str, ...]:
        """The latest, oldest first."""
        return tuple(self._lines.copy())

    def close(self) -> None:
        """Let go of the port; waits a moment."""
        self._is_closing.set()
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        rest = b""
        with suppress(SourceRefusedError, SourceLostError):
            self._channel.open()
            while not self._is_closing.is_set():
                *lines, rest = (rest + self._channel.read()).split(b"\n")
                self._lines.extend(line.decode("ascii", "replace").strip() for line in lines)
                rest = rest[-MOST_LINE:]
        self._channel.close()

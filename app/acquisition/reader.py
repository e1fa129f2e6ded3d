"""Read one source in its own thread, journal first. A lost source is opened again until it is back."""

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress

from app.acquisition.journal_stream import JournalStream
from app.acquisition.sensor_stream import SensorStatus, SensorStream
from app.storage.journal.writer import JournalWriter
from core.samples import ImuBlock
from devices.live import LiveSource, SensorDetails, SourceLostError, SourceRefusedError, SourceRestartedError

REOPEN_S = 0.5
RECALLED_S = 2.0  # a journal may be opened so long before it is handed over
CLOSE_S = 5.0  # some ports answer no sooner
LAST_READ_S = 0.5  # how long a stop waits for what already lies at the source
NO_DETAILS = SensorDetails()

_log = logging.getLogger(__name__)


class Reader:
    """One source, its thread and its sensors. Every method may be called from any thread.

    The lock is held for moments only: what is done under it never waits, for the journal only queues.
    """

    def __init__(self, source: LiveSource, now_ns: Callable[[], int]) -> None:
        self.source = source
        self._now_ns, self._begin_ns = now_ns, 0
        self._lock = threading.Lock()
        self._tape: JournalStream | None = None
        self._recent: deque[tuple[float, ImuBlock]] = deque()  # when it was read, and what
        self._sensors: Mapping[str, SensorStream] = {}
        self._is_open = self._begins_again = False
        self._begun_reads = self._done_reads = 0
        self._is_closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"read {source.info.driver}", daemon=True)

    def open(self, begin_ns: int) -> None:
        """Open the source, its clock starting at `begin_ns`; raises SourceRefusedError where it does not open."""
        self._begin_ns = begin_ns
        self.source.open()
        self._is_open = True
        for name in self.source.info.sensors:
            self._known(name)

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        self._is_closing.set()
        if self._thread.is_alive():
            self._thread.join(CLOSE_S)
        if self._thread.is_alive():
            _log.warning("%s does not let go", self.source.info.driver)  # its thread ends with the program
        else:
            self.source.close()

    @property
    def sensors(self) -> tuple[str, ...]:
        return tuple(self._sensors)

    def status(self, source: int, now_s: float) -> Sequence[SensorStatus]:
        reported = self.source.details()
        with self._lock:
            return [
                sensor.status(source, reported.get(sensor.name, NO_DETAILS), now_s) for sensor in self._sensors.values()
            ]

    def silent_s(self, now_s: float) -> Mapping[str, float]:
        """For how long each sensor has been silent, as in its status."""
        reported = self.source.details()
        with self._lock:
            return {
                name: sensor.silent_s(reported.get(name, NO_DETAILS), now_s) for name, sensor in self._sensors.items()
            }

    def since(self, sensor: str, time_s: float) -> ImuBlock:
        """A sensor's samples that are not older than `time_s`."""
        with self._lock:
            return self._sensors[sensor].ring.since(time_s)

    def lost(self) -> Mapping[str, int]:
        """How many samples each sensor lacks so far."""
        with self._lock:
            return {name: received.lost for name, received in self._sensors.items()}

    def totals(self) -> Mapping[str, int]:
        """How many samples each sensor has sent."""
        with self._lock:
            return {name: sensor.ring.total for name, sensor in self._sensors.items()}

    def newest(self, sensor: str, after: int, most_s: float) -> tuple[ImuBlock, int, int]:
        """A sensor's samples beyond its first `after` ones, of `most_s` at most; how many it sent, and left out."""
        with self._lock:
            received = self._sensors[sensor]
            block = received.ring.newest(min(received.ring.total - after, round(most_s * received.usual_hz)))
            return block, received.ring.total, received.ring.total - after - len(block)

    def record(self, writer: JournalWriter) -> None:
        """Keep what was measured since the journal was opened."""
        tape = JournalStream(writer, self.source)
        with self._lock:
            if not self.source.has_bytes:
                for _, block in self._recent:
                    tape.keep_samples(block, self._sensors[block.sensor].rate_hz)
            self._tape = tape

    def finish_read(self) -> None:
        """Wait until what already lies at the source has been read, if it answers."""
        required, until_s = self._begun_reads + 1, time.monotonic() + LAST_READ_S
        while self._is_open and self._done_reads < required and time.monotonic() < until_s:
            time.sleep(0.005)

    def stop_recording(self) -> None:
        with self._lock:
            self._tape = None

    # the reader's thread

    def _run(self) -> None:
        while not self._is_closing.is_set():
            try:
                if not self._is_open:
                    self._open_again()
                self._read()
            except Exception as error:  # a driver's edge: whatever it is, this source is lost, and no other one
                self._note_lost(error)
                self._is_open = False
                with suppress(Exception):
                    self.source.close()
                self._is_closing.wait(REOPEN_S)

    def _open_again(self) -> None:
        self.source.open()
        _log.info("%s is back", self.source.info.driver)
        with self._lock:
            self._is_open = True
            for name, sensor in self._sensors.items():
                sensor.rate_hz = self._rate_hz(name)
                if self._begins_again:
                    sensor.begin_again()
            self._begins_again = False
            if self._tape:
                self._tape.come_back()

    def _note_lost(self, error: Exception) -> None:
        is_expected = isinstance(error, SourceLostError | SourceRefusedError)
        self._begins_again |= isinstance(error, SourceRestartedError)
        details = None if is_expected else error
        if self._is_open:
            _log.warning("%s was lost", self.source.info.driver, exc_info=details)
        elif details:
            _log.debug("%s does not open", self.source.info.driver, exc_info=details)

    def _read(self) -> None:
        self._begun_reads += 1
        blocks = self.source.read(self._keep)
        if blocks:
            now_ns = self._now_ns()
            with self._lock:
                for block in blocks:
                    self._take(block, now_ns)
        self._done_reads = self._begun_reads

    def _keep(self, data: bytes) -> None:
        with self._lock:
            if self._tape:
                self._tape.keep_bytes(data)

    def _take(self, block: ImuBlock, now_ns: int) -> None:
        sensor = self._known(block.sensor)
        if not self.source.has_bytes:
            if self._tape:
                self._tape.keep_samples(block, sensor.rate_hz)
            self._recent.append((now_ns, block))
            while self._recent[0][0] < now_ns - RECALLED_S * 1e9:
                self._recent.popleft()
        sensor.hear(block, block.time_s - self._begin_ns / 1e9, (now_ns - self._begin_ns) / 1e9)

    def _known(self, name: str) -> SensorStream:
        if name not in self._sensors:
            now_s = (self._now_ns() - self._begin_ns) / 1e9
            sensor = SensorStream(name, self._rate_hz(name), now_s)
            self._sensors = {**self._sensors, name: sensor}  # others are looking at the old one
        return self._sensors[name]

    def _rate_hz(self, sensor: str) -> float | None:
        return self.source.details().get(sensor, NO_DETAILS).rate_hz

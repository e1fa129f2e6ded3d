"""All sources of one visit, read side by side: recorded, shown and worked on, none of them waiting for another.

    sources -> readers -> journal (queue, own thread)
                       -> ring buffers -> the screen, the live estimator

Times are seconds since `start`, of the sensors' own stamps.
"""

import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from app.acquisition.heartbeat import Heartbeat, ProcessStall
from app.acquisition.preview import LiveEstimator, Preview
from app.acquisition.reader import Reader
from app.acquisition.sensor_memory import MemoryRecording
from app.acquisition.sensor_stream import SensorStatus
from app.storage.journal.writer import JournalSummary, JournalWriter
from core.alignment import NetChange
from core.samples import ImuBlock
from core.session import RecordingKind
from core.timed.protocols import PlannedTest
from devices.clocks.host_clock import host_time_ns
from devices.live import LiveSource, SourceRefusedError
from devices.simulation.demonstration_patient import DemonstrationPatient
from devices.simulation.prosthesis_user import ProsthesisUser

if TYPE_CHECKING:
    from devices.dot.source import DotGroup

__all__ = ["Acquisition", "LiveEstimator", "SensorStatus"]


class Acquisition:
    """Every method may be called from any thread; `start`, `close` and `stop_recording` wait, so not from the screen's.

    Parameters
    ----------
    now_ns
        The clock of the sources' stamps and of the journals.
    dots
        Whom the sources belong to, if they are DOTs: these record in their memories, too.
    """

    def __init__(
        self,
        sources: Sequence[LiveSource],
        now_ns: Callable[[], int] = host_time_ns,
        dots: "DotGroup | None" = None,
    ) -> None:
        self.now_ns, self._begin_ns = now_ns, now_ns()
        self.dots = dots
        self._readers = [Reader(source, now_ns) for source in sources]
        self._preview = Preview(self._readers)
        self._heartbeat = Heartbeat(lambda: self.now_s, self.lost)
        self._writer: JournalWriter | None = None
        self._in_memory: MemoryRecording | None = None
        self._stopping = threading.Lock()

    def start(self) -> None:
        """Open and read all sources; raises SourceRefusedError, all closed, where one refuses or names clash."""
        self._begin_ns = self.now_ns()
        try:
            for reader in self._readers:
                reader.open(self._begin_ns)
            names = self.sensors
            if twice := next((name for name in names if names.count(name) > 1), None):
                raise SourceRefusedError("Two sensors have the name {name}", "Connect only one of them", name=twice)
        except SourceRefusedError:
            self.close()
            raise
        for reader in self._readers:
            reader.start()
        self._preview.start()
        self._heartbeat.start()

    def close(self) -> None:
        """Stop reading, and a recording that is being made; close all sources."""
        with suppress(RuntimeError):
            self.stop_recording()
        if self._in_memory is not None:
            self._in_memory.end()
        self._heartbeat.close()
        self._preview.close()
        for reader in self._readers:
            reader.close()

    @property
    def sensors(self) -> tuple[str, ...]:
        return tuple(name for reader in self._readers for name in reader.sensors)

    @property
    def is_simulated(self) -> bool:
        return any(reader.source.info.is_simulated for reader in self._readers)

    @property
    def now_s(self) -> float:
        return (self.now_ns() - self._begin_ns) / 1e9

    @property
    def trouble(self) -> Exception | None:
        """What the present live estimator failed with first; the recording goes on."""
        return self._preview.trouble

    @property
    def dropped_from_preview(self) -> int:
        """Samples that the live estimator was too slow for. They are recorded all the same."""
        return self._preview.dropped

    def status(self) -> Mapping[str, SensorStatus]:
        """How each sensor is doing."""
        now_s = self.now_s
        return {one.sensor: one for k, reader in enumerate(self._readers) for one in reader.status(k, now_s)}

    def silent_s(self) -> Mapping[str, float]:
        """For how long each sensor has been silent; asked in every frame, for which a whole status costs too much."""
        now_s = self.now_s
        return {name: silent_s for reader in self._readers for name, silent_s in reader.silent_s(now_s).items()}

    def lost(self) -> Mapping[str, int]:
        """How many samples each sensor lacks so far; nought also where its rate is not known."""
        return {name: count for reader in self._readers for name, count in reader.lost().items()}

    @property
    def standstills(self) -> tuple[ProcessStall, ...]:
        """When this process stood still since `start`, and received nothing."""
        return self._heartbeat.standstills

    def awake_s(self) -> float:
        """A clock that stops with this process, give or take half a second."""
        return self._heartbeat.awake_s()

    def latest(self, sensor: str, seconds: float) -> ImuBlock:
        """A sensor's samples of the last `seconds`, 30 at most; none of one that is not known."""
        for reader in self._readers:
            if sensor in reader.sensors:
                return reader.since(sensor, self.now_s - seconds)
        return ImuBlock(sensor, np.empty(0), np.empty((0, 3)), np.empty((0, 3)))

    @property
    def is_in_memory(self) -> bool:
        """Whether the sensors are ready to record in their memories, and send nothing."""
        return self.dots is not None and self.dots.is_recording_use

    def record_in_memory(self, started_s: int) -> MemoryRecording:
        """Record in memory, named by `started_s` (UTC), until ended; raises SourceRefusedError, all or none."""
        assert self.dots is not None  # checked by `is_in_memory`
        recording = MemoryRecording(self.dots)
        recording.begin(started_s)
        self._in_memory = recording
        return recording

    def record(self, writer: JournalWriter) -> None:
        """Keep what all sensors measure since the journal was opened, until `stop_recording`."""
        if self._writer:
            raise RuntimeError("a recording is being made already")
        self._writer = writer
        for reader in self._readers:
            reader.record(writer)

    def stop_recording(self) -> JournalSummary:
        """End the recording with what was measured until now; waits for sources (0.5 s at most) and disk."""
        with self._stopping:
            writer = self._writer
            if writer is None:
                raise RuntimeError("no recording is being made")
            for reader in self._readers:
                reader.finish_read()
            for reader in self._readers:
                reader.stop_recording()
            self._writer = None
            return writer.stop()

    def set_estimator(self, estimator: LiveEstimator | None) -> None:
        """What is done with new samples from now on; see `LiveEstimator`."""
        self._preview.set_estimator(estimator)

    def ask(self, kind: RecordingKind | None) -> float | None:
        """Ask simulated patients for this movement; give its duration in s, None where no source knows it."""
        reported = [reader.source.ask(kind) for reader in self._readers]
        return max((length_s for length_s in reported if length_s is not None), default=None)

    def ask_test(self, planned: PlannedTest) -> None:
        """Ask the demonstration's patient for this timed test, what else is played for a walk."""
        for reader in self._readers:
            if isinstance(reader.source, DemonstrationPatient):
                reader.source.perform(planned)
            else:
                reader.source.ask(RecordingKind.WALKING)

    def set_up(self, changes: Sequence[NetChange]) -> None:
        """Report to the simulated user of a prosthesis what was changed at it; at a real one somebody has turned it."""
        for reader in self._readers:
            if isinstance(reader.source, ProsthesisUser):
                reader.source.set_up(changes)

    def identify(self, sensor: str) -> bool:
        """Light a sensor's LED; False where it has none."""
        return any(reader.source.identify(sensor) for reader in self._readers if sensor in reader.sensors)

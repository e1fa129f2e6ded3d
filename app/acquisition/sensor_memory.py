"""A recording in the sensors' own memory: begun and ended in all of them, whose files are fetched afterwards.

    sensors synchronised at the rate of their memories -> begin -> end -> fetch -> is it in the journal? -> erase

When each sensor was asked to begin and to end is noted: nothing else shows where its file lies in time.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

from app.acquisition.memory_fetching import Lack, MemoryFetching, OrderedFile, Progress, RequiredFile
from app.storage.data_key import KeyMaterial
from app.storage.journal.writer import JournalWriter
from devices.dot.memory import Begun, OwnClockError, record, stop
from devices.dot.source import DotGroup
from devices.live import SourceLostError, SourceRefusedError
from devices.transport.bluetooth import Tick

EARLY_S = 2.0  # a file that is shorter by less ended when it was asked to: beginnings and clocks differ so much


class MemoryRecording:
    """Methods wait, up to minutes where a sensor is out of reach, so not from the screen's thread."""

    def __init__(self, group: DotGroup) -> None:
        self._group = group
        self._rate_hz = group.record_hz or group.rate_hz
        self._begun: Mapping[str, Begun] = {}
        self._ended_ns: dict[str, int] = {}
        self._clocks: dict[str, str] = {}
        self._utc_s = self._required_ns = 0
        self.given_up: set[int] = set()  # beginnings where one refused: the others hold a moment that nobody wants
        self.fetching: MemoryFetching | None = None

    @property
    def utc_s(self) -> int:
        return self._utc_s

    def begin(self, utc_s: int) -> None:
        """Record in all memories or none, file named by `utc_s`; raises SourceRefusedError where one cannot."""
        group = self._group
        self.given_up.add(utc_s)
        clocks = {sensor.name: group.clock_of(sensor.name) for sensor in group.sensors}
        synchronised = [name for name, clock in clocks.items() if clock]
        try:
            self._begun = group.radio.run(record(group.sensors, utc_s, self._rate_hz, synchronised))
        except OwnClockError as problem:
            group.leave(problem.sensor)
            raise
        self.given_up.discard(utc_s)
        self._utc_s, self._clocks = utc_s, clocks

    def ask_to_end(self) -> None:
        """Note that it is to end now; waits for nothing."""
        self._required_ns = self._required_ns or self._group.radio.now_ns()

    def end(self, tick: Tick | None = None) -> Mapping[str, SourceLostError | SourceRefusedError]:
        """End the recording in each; those that it could not be ended in, and why. May be tried again."""
        failed: dict[str, SourceLostError | SourceRefusedError] = {}
        radio = self._group.radio
        self.ask_to_end()
        for sensor in self._group.sensors:
            if sensor.name in self._ended_ns:
                continue
            try:
                radio.run(stop(sensor), tick)
                self._ended_ns[sensor.name] = radio.now_ns()
            except (SourceLostError, SourceRefusedError) as problem:
                failed[sensor.name] = problem
        if not failed:
            self.fetching = self.fetching or MemoryFetching(radio, [self._required(name) for name in self._begun])
        return failed

    def finish(
        self, writer: JournalWriter, progress: Progress, tick: Tick | None = None
    ) -> Mapping[str, SourceLostError | SourceRefusedError]:
        """End it, and fetch it into the journal; those that it failed with, and why. May be tried again."""
        failed = self.end(tick)
        if failed:
            return failed
        assert self.fetching is not None  # all have ended
        return self.fetching.fetch(writer, progress, tick)

    def give_up(self) -> None:
        """End it where it can be ended; nobody wants it."""
        self.end()
        self.given_up.add(self._utc_s)

    def look_into(self, segments: Sequence[Path], data_key: KeyMaterial | None) -> Mapping[str, bool]:
        """As `MemoryFetching.look_into`."""
        return {} if self.fetching is None else self.fetching.look_into(segments, data_key)

    def lacks(self) -> tuple[Lack, ...]:
        """As `MemoryFetching.lacks`; which sensors ended before they were asked to is known, too."""
        return () if self.fetching is None else self.fetching.lacks(self.ended_early_s())

    def reported(self) -> str:
        """As `MemoryFetching.reported`."""
        return "" if self.fetching is None else self.fetching.reported()

    def _required(self, name: str) -> RequiredFile:
        begun, ended_ns = self._begun[name], self._ended_ns[name]
        sensor = next(one for one in self._group.sensors if one.name == name)
        about = round((self._required_ns - begun.recording_ns) / 1e9 * self._rate_hz)
        orders = OrderedFile(begun.reported_ns, begun.recording_ns, ended_ns)
        rate_hz = float(self._rate_hz)
        return RequiredFile(sensor, self._utc_s, None, rate_hz, self._clocks[name], orders, max(about, 1))

    def ended_early_s(self) -> Mapping[str, float]:
        """Give by how many s sensors ended too early (button, full memory); unknown if the end is not fetched."""
        if self.fetching is None:
            return {}
        early_s = {
            name: (self._required_ns - self._begun[name].recording_ns) / 1e9 - (one.samples + one.lost) / self._rate_hz
            for name, one in self.fetching.results.items()
            if one.is_end_known
        }
        return {name: seconds for name, seconds in early_s.items() if seconds > EARLY_S}

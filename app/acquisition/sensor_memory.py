"""A recording in the sensors' own memory: begun, ended, fetched into a journal, held against it, and only then erased.

    sources streamed -> begin -> end -> fetch -> is it in the journal? -> erase, once confirmed

What a sensor sends is put into the journal before it is looked at. The times of a file are the sensor's; how the host's
clock follows from them is what the stream has told before, the same for all sensors that are on one clock.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from app.storage.data_key import KeyMaterial
from app.storage.journal.decoding import decode
from app.storage.journal.writer import JournalWriter
from devices.decoders import DECODERS
from devices.dot.decoder import file_settings
from devices.dot.memory import RECORD_HZ, FetchedFile, Fetching, erase_kept, list_files, reached, record, stop
from devices.dot.samples import Tie
from devices.dot.sensor import DotRefusedError
from devices.dot.source import DotSource
from devices.live import SourceLostError, SourceRefusedError

EARLY_S = 2.0  # so much later than the first a sensor is told to begin

Progress = Callable[[str, int, int], None]
"""Takes a sensor, how many of its samples were fetched, and about how many there are."""


@dataclass(slots=True)
class _Fetched:
    """What is known of one sensor's file: how it is fetched, what the journal calls it, what came in the end."""

    fetching: Fetching
    source: int
    result: FetchedFile | None = None
    is_kept: bool = False


class MemoryRecording:
    """Methods wait, minutes where they fetch, so not from the screen's thread.

    Parameters
    ----------
    sources
        Which have streamed a while, so that their clocks are known, and are closed.
    """

    def __init__(self, sources: Sequence[DotSource]) -> None:
        self._sources = {source.sensor.name: source for source in sources}
        self._radio = sources[0].group.radio
        self._ties: dict[str, Tie] = {}
        self._utc_s = self._begun_ns = self._ended_ns = 0
        self._told: set[int] = set()  # every beginning: where one refused, the others hold a moment that nobody wants
        self._fetched: dict[str, _Fetched] = {}

    def begin(self, utc_s: int) -> None:
        """Record in all of them, or in none; `utc_s` names the file.

        Raises
        ------
        SourceRefusedError
            One has no room, records already, does not begin, or was not heard before.
        SourceLostError
            One is out of reach.
        """
        for name, source in self._sources.items():
            if (tie := source.tie()) is None:
                raise DotRefusedError("{sensor} was not heard yet", "Let it stream for some seconds first", sensor=name)
            self._ties[name] = tie
        self._told.add(utc_s)
        self._radio.run(record([source.sensor for source in self._sources.values()], utc_s))
        self._utc_s, self._begun_ns = utc_s, self._radio.now_ns()

    def end(self) -> Mapping[str, Exception]:
        """End the recording in each; those that it could not be ended in, and why. May be tried again."""
        failed: dict[str, Exception] = {}
        self._ended_ns = self._ended_ns or self._radio.now_ns()
        for name, source in self._sources.items():
            try:
                self._radio.run(stop(source.sensor))
            except (SourceLostError, SourceRefusedError) as problem:
                failed[name] = problem
        return failed

    def fetch(self, writer: JournalWriter, progress: Progress) -> Mapping[str, Exception]:
        """Fetch what is not there yet, one sensor after the other; those that it failed with, and why.

        May be tried again, into the same journal: what came is not asked for again.
        """
        failed: dict[str, Exception] = {}
        for name in self._sources:
            if name in self._fetched and self._fetched[name].result is not None:
                continue
            try:
                one = self._fetched.get(name) or self._found(name, writer, progress)
                self._fetched[name] = one
                one.result = self._radio.run(one.fetching.fetch())
            except (SourceLostError, SourceRefusedError) as problem:
                failed[name] = problem
        return failed

    def _found(self, name: str, writer: JournalWriter, progress: Progress) -> _Fetched:
        source = self._sources[name]
        self._radio.run(reached(source.sensor))
        files = self._radio.run(list_files(source.sensor))
        file = next((one for one in files if one.started_utc_s == self._utc_s), None)
        if file is None:
            raise DotRefusedError(
                "{sensor} holds nothing of this recording", "Look whether it was switched off meanwhile", sensor=name
            )
        opened_s = writer.header.opened_ns / 1e9
        tie = replace(self._ties[name], offset_s=self._ties[name].offset_s - opened_s)
        settings = file_settings(file, tie, self._begun_ns / 1e9 - opened_s)
        number = writer.source(replace(source.info, settings=settings))

        def keep(data: bytes) -> None:
            writer.received(number, data)

        def tell(done: int, of: int) -> None:
            progress(name, done, of)

        return _Fetched(Fetching(source.sensor, file, keep, tell), number)

    @property
    def results(self) -> Mapping[str, FetchedFile]:
        """What came of each sensor whose file was fetched to its end."""
        return {name: one.result for name, one in self._fetched.items() if one.result is not None}

    def ended_early_s(self) -> Mapping[str, float]:
        """Which sensors ended before they were told to, by their button or a full memory, and how long before, s."""
        wanted_s = (self._ended_ns - self._begun_ns) / 1e9
        early_s = {name: wanted_s - (one.samples + one.lost) / RECORD_HZ for name, one in self.results.items()}
        return {name: seconds for name, seconds in early_s.items() if seconds > EARLY_S}

    def look_into(self, segments: Sequence[Path], data_key: KeyMaterial | None) -> Mapping[str, bool]:
        """Whether the journal, read anew and closed before, holds every sample that each sensor sent."""
        sensors = decode(segments, data_key, DECODERS).sensors
        for name, one in self._fetched.items():
            found = sensors.get(name)
            one.is_kept = (
                one.result is not None
                and found is not None
                and len(found.block) == one.result.samples > 0
                and one.fetching.framer.has_forces()
            )
        return {name: name in self._fetched and self._fetched[name].is_kept for name in self._sources}

    def erase(self, sensor: str, utc_s: int, *, is_confirmed: bool, may_lack: bool = False) -> None:
        """Erase a sensor's memory, all of which must be in the journal: `look_into` has said so, and the user agrees.

        Parameters
        ----------
        may_lack
            Also where samples could not be had: they are gone then.

        Raises
        ------
        DotRefusedError
            It is not in the journal, not confirmed, lacks samples, or the memory holds more.
        SourceLostError
            It is out of reach.
        """
        one = self._fetched.get(sensor)
        if one is None or one.result is None or not one.is_kept or not is_confirmed:
            raise DotRefusedError("What {sensor} recorded is not known to be kept", "Fetch it first", sensor=sensor)
        if not one.result.is_complete and not may_lack:
            raise DotRefusedError(
                "{sensor} holds samples that were not fetched", "Fetch it again, or let them go", sensor=sensor
            )
        target = self._sources[sensor].sensor
        self._radio.run(reached(target))
        self._radio.run(erase_kept(target, self._told, utc_s))

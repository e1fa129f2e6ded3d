"""What lies in the memories of sensors that are worn: listed, fetched once more, and erased.

A file is named by the second in which it was begun, and so is the recording that it belongs to.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from app.acquisition.memory_fetching import FETCHED, Lack, MemoryFetching, Progress, RequiredFile, fetched_files
from app.storage.data_key import KeyMaterial
from app.storage.journal.decoding import decode
from app.storage.journal.writer import JournalWriter
from app.storage.opened import OpenedLibrary
from app.storage.stored import StoredRecording
from devices.decoders import DECODERS
from devices.dot.fetching import reached
from devices.dot.memory import erase_kept, list_files
from devices.dot.messages import RecordedFile
from devices.dot.sensor import DotSensor
from devices.dot.source import DotGroup
from devices.live import SourceLostError, SourceRefusedError
from devices.transport.bluetooth import Tick

Reported = Callable[[str], None]
"""Takes the name of the sensor that it is about now; what it raises ends the work."""


@dataclass(frozen=True, slots=True)
class HeldRecording:
    """Files that were begun in the same second, by the name of the sensor that has them."""

    started_utc_s: int
    files: Mapping[str, RecordedFile]


@dataclass(frozen=True, slots=True)
class KnownRecording:
    """What the library has of one: its rows, and which sensors' files its journals hold, every sample of them."""

    rows: tuple[StoredRecording, ...]
    kept: frozenset[str]
    lacking: frozenset[str] = frozenset()
    """Of those that are kept, sensors some of whose samples could not be had, however often they were fetched."""


class DotMemories:
    """Methods wait, so not from the screen's thread; sensors send nothing meanwhile, nor afterwards."""

    def __init__(self, group: DotGroup) -> None:
        self._group = group

    def held(self, show_message: Reported, tick: Tick | None = None) -> tuple[HeldRecording, ...]:
        """Give all files held, oldest first; raises SourceLostError, or SourceRefusedError while recording."""
        group = self._group
        group.fall_silent(tick)
        files: dict[int, dict[str, RecordedFile]] = {}
        for sensor in group.sensors:
            show_message(sensor.name)
            for file in group.radio.run(_listed(sensor), tick):
                files.setdefault(file.started_utc_s, {})[sensor.name] = file
        return tuple(HeldRecording(started, files[started]) for started in sorted(files))

    def left(self, held: HeldRecording) -> "LeftRecording":
        """One that this program began, and did not fetch: it records on one clock only."""
        sensors = [sensor for sensor in self._group.sensors if sensor.name in held.files]
        clock = f"file {held.started_utc_s}" if len(sensors) > 1 else ""
        required = [RequiredFile(one, held.started_utc_s, held.files[one.name], clock=clock) for one in sensors]
        return LeftRecording(MemoryFetching(self._group.radio, required))

    def erase(
        self, gone: Mapping[str, Collection[int]], utc_s: int, show_message: Reported, tick: Tick | None = None
    ) -> None:
        """Erase all memories; `gone`: start times (UTC, s) by sensor of the files that may go.
        Raises SourceLostError, or DotRefusedError if a memory holds others (those before it are erased).
        """
        for sensor in self._group.sensors:
            show_message(sensor.name)
            self._group.radio.run(_erased(sensor, gone.get(sensor.name, ()), utc_s), tick)


class LeftRecording:
    """An `InMemory` that ended long ago."""

    def __init__(self, fetching: MemoryFetching) -> None:
        self._fetching = fetching

    def ask_to_end(self) -> None:
        """It has ended."""

    def give_up(self) -> None:
        """It stays where it is."""

    def finish(
        self, writer: JournalWriter, progress: Progress, tick: Tick | None = None
    ) -> Mapping[str, SourceLostError | SourceRefusedError]:
        return self._fetching.fetch(writer, progress, tick)

    def look_into(self, segments: Sequence[Path], data_key: KeyMaterial | None) -> Mapping[str, bool]:
        return self._fetching.look_into(segments, data_key)

    def lacks(self) -> tuple[Lack, ...]:
        return self._fetching.lacks()

    def reported(self) -> str:
        return self._fetching.reported()


def known(opened: OpenedLibrary, started_utc_s: int) -> KnownRecording:
    """What the library has of a recording that was begun in this second; its journals are read to their end."""
    rows = opened.library.recordings.begun_at(started_utc_s)
    kept: set[str] = set()
    whole: set[str] = set()
    for row in rows:
        paths = [opened.journal_path(journal) for journal in row.journals]
        if not paths or not all(path.exists() for path in paths):
            continue
        journal = decode(paths, opened.data_key, DECODERS, [one.wrapped_key for one in row.journals])
        for mark in journal.marks:
            if not mark.text.startswith(FETCHED):
                continue
            for name, file in fetched_files(mark.text).items():
                found = journal.sensors.get(name)
                if file.started_utc_s == started_utc_s and found is not None and len(found.block) == file.samples > 0:
                    kept.add(name)
                    whole |= {name} if file.is_complete else set()
    return KnownRecording(rows, frozenset(kept), frozenset(kept - whole))


async def _listed(sensor: DotSensor) -> tuple[RecordedFile, ...]:
    await reached(sensor)
    return await list_files(sensor)


async def _erased(sensor: DotSensor, gone: Collection[int], utc_s: int) -> None:
    await reached(sensor)
    await erase_kept(sensor, gone, utc_s)

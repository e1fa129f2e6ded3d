"""Files of the sensors' memories on their way into one journal, held against it, and only then erased.

What a sensor sends is put into the journal before it is looked at. What could not be had is stated, by number.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from app.storage.data_key import KeyMaterial
from app.storage.journal.decoding import decode
from app.storage.journal.writer import JournalWriter
from devices.decoders import DECODERS
from devices.dot.decoder import FileOrders, file_settings
from devices.dot.fetching import FetchedFile, Fetching, reached
from devices.dot.memory import erase_kept, list_files
from devices.dot.messages import EMULATED, RecordedFile
from devices.dot.samples import DRIVER, RECORDED, VERSION
from devices.dot.sensor import DotRefusedError, DotSensor
from devices.live import SourceLostError, SourceRefusedError
from devices.source import SourceInfo
from devices.transport.bluetooth import Radio, Tick

FETCHED = "fetched "  # how the mark begins

Progress = Callable[[str, int, int], None]
"""Takes a sensor, how many of its samples were fetched, and about how many there are. What it raises ends the fetching,
for a while."""


@dataclass(frozen=True, slots=True)
class OrderedFile:
    """When a file was first asked to begin, when the sensor confirmed that it is recorded, and that it had ended, ns
    of the host's clock."""

    reported_ns: int
    recording_ns: int
    ended_ns: int

    def since(self, opened_ns: int) -> FileOrders:
        """In seconds since a journal was opened."""
        reported_s, recording_s = (self.reported_ns - opened_ns) / 1e9, (self.recording_ns - opened_ns) / 1e9
        return FileOrders((reported_s, recording_s), (self.ended_ns - opened_ns) / 1e9)


@dataclass(frozen=True, slots=True)
class RequiredFile:
    """A file of one sensor's memory."""

    sensor: DotSensor
    started_utc_s: int
    file: RecordedFile | None = None  # None: the one that was begun at `started_utc_s`, which is looked for first
    rate_hz: float | None = None
    clock: str = ""  # the name of the clock that it shares with others; empty: its own
    orders: OrderedFile | None = None  # None: nobody knows them
    about: int = 0  # how many samples it has, about; 0: by its size


@dataclass(frozen=True, slots=True)
class Lack:
    """What a sensor's file does not hold of a recording: numbered samples, and the last `early_s` before its end."""

    sensor: str
    lost: int = 0
    early_s: float = 0.0
    is_end_known: bool = True


@dataclass(slots=True)
class _Begun:
    """What is known of one sensor's file: how it is fetched, what came in the end, whether that is in the journal."""

    fetching: Fetching
    result: FetchedFile | None = None
    is_kept: bool = False


class MemoryFetching:
    """Methods wait, minutes where they fetch, so not from the screen's thread."""

    def __init__(self, radio: Radio, required: Sequence[RequiredFile]) -> None:
        self._radio = radio
        self._required = {one.sensor.name: one for one in required}
        self._begun: dict[str, _Begun] = {}
        self._progress: Progress = _nobody

    @property
    def about(self) -> Mapping[str, int]:
        """How many samples of each sensor there are, about; 0 where that is not known yet."""
        return {name: one.about for name, one in self._required.items()}

    @property
    def sensors(self) -> tuple[str, ...]:
        return tuple(self._required)

    @property
    def is_done(self) -> bool:
        """Whether each was fetched to its end."""
        return len(self.results) == len(self._required)

    @property
    def results(self) -> Mapping[str, FetchedFile]:
        """What came of each sensor whose file was fetched to its end."""
        return {name: one.result for name, one in self._begun.items() if one.result is not None}

    def fetch(
        self, writer: JournalWriter, progress: Progress, tick: Tick | None = None
    ) -> Mapping[str, SourceLostError | SourceRefusedError]:
        """Fetch missing files sensor by sensor and give the failures; repeatable, also after `tick` raised."""
        failed: dict[str, SourceLostError | SourceRefusedError] = {}
        self._progress = progress
        for name, required in self._required.items():
            if name in self.results:
                continue
            try:
                if name not in self._begun:
                    self._begun[name] = _Begun(self._found(required, writer, tick))
                one = self._begun[name]
                one.result = self._radio.run(one.fetching.fetch(), tick)
            except (SourceLostError, SourceRefusedError) as problem:
                failed[name] = problem
        return failed

    def _found(self, required: RequiredFile, writer: JournalWriter, tick: Tick | None) -> Fetching:
        sensor, file = required.sensor, required.file
        if file is None:
            files = self._radio.run(_listed(sensor), tick)
            named = [one for one in files if one.started_utc_s == required.started_utc_s]
            file = named[-1] if named else None  # one that was given up in the same second comes before
        if file is None or sensor.info is None:
            raise DotRefusedError(
                "{sensor} has no data of this recording",
                "Check whether the sensor was switched off",
                sensor=sensor.name,
            )
        orders = None if required.orders is None else required.orders.since(writer.header.opened_ns)
        settings = file_settings(file, required.rate_hz, required.clock, orders)
        is_simulated = sensor.info.model == EMULATED
        info = SourceInfo(DRIVER, VERSION, sensor.info.serial, (sensor.name,), settings, is_simulated)
        number = writer.source(info)

        def keep(data: bytes) -> None:
            writer.received(number, data)

        def show_message(done: int, of: int) -> None:
            self._progress(sensor.name, done, of)

        return Fetching(sensor, file, keep, show_message, required.about or file.most_bytes // RECORDED.size)

    def look_into(self, segments: Sequence[Path], data_key: KeyMaterial | None) -> Mapping[str, bool]:
        """Whether the journal, read again and closed before, holds every sample that each sensor sent."""
        sensors = decode(segments, data_key, DECODERS).sensors
        for name, one in self._begun.items():
            found = sensors.get(name)
            one.is_kept = (
                one.result is not None
                and found is not None
                and len(found.block) == one.result.samples > 0
                and one.fetching.framer.has_forces()
            )
        return {name: name in self._begun and self._begun[name].is_kept for name in self._required}

    def lacks(self, early_s: Mapping[str, float] = MappingProxyType({})) -> tuple[Lack, ...]:
        """What could not be had, of each sensor that lacks something; it may have ended `early_s` before it was to."""
        every = [
            Lack(name, one.lost, early_s.get(name, 0.0), one.is_end_known) for name, one in sorted(self.results.items())
        ]
        return tuple(one for one in every if one != Lack(one.sensor))

    def reported(self) -> str:
        """What was fetched, for the journal: of each sensor when it was begun, its samples, whether that is all."""
        reported = {
            name: [one.file.started_utc_s, one.samples, one.is_complete] for name, one in sorted(self.results.items())
        }
        return FETCHED + json.dumps(reported)

    def erase(
        self, sensor: str, utc_s: int, *, is_confirmed: bool, may_lack: bool = False, others: Sequence[int] = ()
    ) -> None:
        """Erase a sensor's memory once `look_into` found all of it in the journal and the user agrees.
        `may_lack`: also with lost samples; `others`: start times of other files that may go.
        Raises DotRefusedError where it is not all there, unconfirmed or holds more; SourceLostError.
        """
        one = self._begun.get(sensor)
        if one is None or one.result is None or not one.is_kept or not is_confirmed:
            raise DotRefusedError(
                "The recording of {sensor} is not confirmed as saved", "Fetch the recording first", sensor=sensor
            )
        if not one.result.is_complete and not may_lack:
            raise DotRefusedError(
                "{sensor} has data that were not fetched", "Fetch these data again, or discard them", sensor=sensor
            )
        kept = {one.result.file.started_utc_s, *others}
        self._radio.run(_erased(self._required[sensor].sensor, kept, utc_s))


@dataclass(frozen=True, slots=True)
class FetchedBefore:
    """What a journal states of one sensor's file."""

    started_utc_s: int
    samples: int
    is_complete: bool


def fetched_files(mark: str) -> Mapping[str, FetchedBefore]:
    """What `MemoryFetching.reported` has noted, by the sensor's name; nothing where it is not that."""
    try:
        reported = json.loads(mark.removeprefix(FETCHED))
        return {
            str(name): FetchedBefore(int(utc_s), int(count), bool(all_))
            for name, (utc_s, count, all_) in reported.items()
        }
    except (ValueError, TypeError, AttributeError):
        return {}


def _nobody(_sensor: str, _done: int, _of: int) -> None:
    """Nothing is fetched yet."""


async def _erased(sensor: DotSensor, kept: set[int], utc_s: int) -> None:
    await reached(sensor)
    await erase_kept(sensor, kept, utc_s)


async def _listed(sensor: DotSensor) -> tuple[RecordedFile, ...]:
    await reached(sensor)
    return await list_files(sensor)

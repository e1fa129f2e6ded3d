"""Recording in the sensors' own memory, and fetching it: with progress, going on after a lost link, and repaired.

Each notification is given to who keeps it before it is looked at. What could not be had is said, by number. The memory
is erased as a whole, and only by who shows that all of it was kept.
"""

import asyncio
import struct
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from devices.dot.messages import (
    Characteristic,
    DotAnswer,
    DotMessage,
    DotMessageError,
    DotNotice,
    Order,
    RecordedFile,
    erase,
    fetch_from,
    files_listed,
    start_recording,
)
from devices.dot.samples import CHOSEN, FileFramer, framed
from devices.dot.sensor import DotRefusedError, DotSensor
from devices.dot.synchronising import refuse_while_recording
from devices.live import Keep, SourceLostError, SourceRefusedError

RECORD_HZ = 120
LOOKS = 2  # behind the last sample: the one that comes again may be lost again
OVERTAKEN_S = 0.1  # so long after its end something may come that the end has overtaken
REPAIRS = 3  # so often what is missing is asked for again
SILENCE_S = 3.0
AWAY_S = 60.0  # so long a sensor that was lost is looked for
ERASES_S = 60.0
LINK_TRIES = 4  # where the link is lost over an order

Progress = Callable[[int, int], None]
"""Takes how many samples were fetched, and about how many there are."""


class MemoryFullError(DotRefusedError):
    """There is no room in a sensor's memory."""


class FileLostError(SourceLostError):
    """A sensor went out of reach while it was fetched, and was not found again. What came was kept; fetch it again."""


@dataclass(frozen=True, slots=True)
class FetchedFile:
    """What came of one file.

    Attributes
    ----------
    missing
        Numbers of samples that could not be had, below the last that came.
    is_end_known
        Whether the sensor said that nothing follows the last sample.
    is_even
        Whether the samples' times step evenly but for what is missing.
    """

    sensor: str
    file: RecordedFile
    samples: int
    missing: tuple[range, ...]
    is_end_known: bool
    is_even: bool

    @property
    def lost(self) -> int:
        return sum(map(len, self.missing))

    @property
    def is_complete(self) -> bool:
        return self.samples > 0 and not self.missing and self.is_end_known and self.is_even


async def record(sensors: Sequence[DotSensor], utc_s: int) -> None:
    """Begin a recording in all of them, at 120 Hz; in none if one refuses.

    Raises
    ------
    MemoryFullError
        One has no room.
    SourceRefusedError
        One records already, or does not begin.
    SourceLostError
        One is out of reach.
    """
    begun: list[DotSensor] = []
    try:
        for sensor in sensors:
            await _made_ready(sensor)
        for sensor in sensors:
            begun.append(sensor)
            await _begin(sensor, utc_s)
    except (SourceLostError, SourceRefusedError):
        for sensor in begun:
            await _stopped_quietly(sensor)
        raise


async def _made_ready(sensor: DotSensor) -> None:
    for attempt in range(LINK_TRIES):
        try:
            await reached(sensor)
            await refuse_while_recording(sensor)
            await sensor.stop_stream()
            await sensor.set_up(RECORD_HZ, (await sensor.settings()).profile)
            return
        except SourceLostError:
            if attempt == LINK_TRIES - 1:
                raise


async def _begin(sensor: DotSensor, utc_s: int) -> None:
    """Let it begin; where the link was lost over that, it may have begun already."""
    for attempt in range(LINK_TRIES):
        try:
            await reached(sensor)
            if attempt and await sensor.state() is DotAnswer.RECORDING:
                return
            told = await sensor.order(Order.START, start_recording(utc_s).data[1:])
            if told is DotAnswer.FULL:
                raise MemoryFullError(
                    "The memory of {sensor} is full",
                    "Fetch what is in it and erase it, then record",
                    sensor=sensor.name,
                )
            if await sensor.state() is DotAnswer.RECORDING:
                return
        except SourceLostError:
            if attempt == LINK_TRIES - 1:
                raise
    raise DotRefusedError(
        "{sensor} does not begin to record", "Switch it off and on, then try again", sensor=sensor.name
    )


async def _stopped_quietly(sensor: DotSensor) -> None:
    try:
        await stop(sensor)
    except (SourceLostError, SourceRefusedError):
        return  # out of reach: whoever looks for its files is told that it records


async def stop(sensor: DotSensor) -> None:
    """End its recording, however often the link is lost over it; one that ended by itself has ended.

    Raises
    ------
    SourceLostError
        It is out of reach, and may still be recording.
    DotRefusedError
        It goes on recording.
    """
    for _ in range(LINK_TRIES):
        try:
            await reached(sensor)
            if await sensor.state() is not DotAnswer.RECORDING:
                return
            await sensor.order(Order.STOP)
        except SourceLostError:
            continue
    await reached(sensor)
    if await sensor.state() is DotAnswer.RECORDING:
        raise DotRefusedError("{sensor} goes on recording", "Press its button for a second", sensor=sensor.name)


async def reached(sensor: DotSensor, within_s: float = AWAY_S) -> None:
    """Connect, trying for so long.

    Raises
    ------
    SourceLostError
        It is out of reach.
    """
    loop = asyncio.get_running_loop()
    until_s = loop.time() + within_s
    while not sensor.is_up:
        try:
            await sensor.connect()
        except SourceLostError:
            await sensor.disconnect()
            if loop.time() > until_s:
                raise
            await asyncio.sleep(0.5)


async def list_files(sensor: DotSensor) -> tuple[RecordedFile, ...]:
    """What is in its memory.

    Raises
    ------
    DotRefusedError
        It records, or does not tell.
    """
    await refuse_while_recording(sensor)
    for _ in range(REPAIRS):
        await _idle(sensor)
        count = await _count(sensor)
        files = [await _file(sensor, number) for number in range(1, (count or 0) + 1)]
        if count is not None and None not in files:
            return tuple(file for file in files if file is not None)
    raise DotRefusedError(
        "{sensor} does not tell what is in its memory", "Switch it off and on, then try again", sensor=sensor.name
    )


async def _count(sensor: DotSensor) -> int | None:
    if await sensor.order(Order.LIST) is not DotAnswer.DONE:
        return None
    pieces = b""
    while (said := await _notice(sensor)) is not None:
        if said.data[0] == DotNotice.LIST_END:
            try:
                return files_listed(pieces)
            except DotMessageError:
                return None
        if said.data[0] == DotNotice.LIST:
            pieces += said.data[1:]
    return None


async def _file(sensor: DotSensor, number: int) -> RecordedFile | None:
    if await sensor.order(Order.FILE_INFO, bytes([number])) is not DotAnswer.DONE:
        return None
    file = None
    while (said := await _notice(sensor)) is not None:
        match said.data[0]:
            case DotNotice.FILE_INFO:
                try:
                    file = RecordedFile.parsed(number, said.data[1:])
                except DotMessageError:
                    return None
            case DotNotice.FILE_INFO_END:
                return file
            case DotNotice.NO_FILE:
                return None
    return None


async def _notice(sensor: DotSensor, kept: Callable[[bytes], None] | None = None) -> DotMessage | None:
    """The next whole notice; None where the sensor has fallen silent."""
    while payload := await sensor.notice(SILENCE_S):
        if kept is not None:
            kept(payload)
        try:
            message = DotMessage.parsed(payload)
        except DotMessageError:
            continue
        if message.data:
            return message
    return None


async def _idle(sensor: DotSensor) -> None:
    """Let it break off what it sends, if it does."""
    state = await sensor.state()
    if state in (DotAnswer.EXPORTING_LIST, DotAnswer.EXPORTING_INFO, DotAnswer.EXPORTING):
        await sensor.order(Order.BREAK_OFF)
        while (said := await _notice(sensor)) is not None and said.data[0] != DotNotice.DATA_BROKEN_OFF:
            pass


class Fetching:
    """One file on its way out of a sensor. May be tried again after it was lost: what came is not asked for again.

    Parameters
    ----------
    keep
        Takes each notification before it is looked at.
    """

    def __init__(self, sensor: DotSensor, file: RecordedFile, keep: Keep, progress: Progress) -> None:
        self._sensor, self._file, self._keep, self._progress = sensor, file, keep, progress
        self.framer = FileFramer()
        self._is_end_known = False
        self._expected = max(file.length_s * RECORD_HZ, 1)
        self._has_begun = self._has_ended = False
        self._nothing_followed = 0
        self._is_from_start = False

    async def fetch(self) -> FetchedFile:
        """All of it, repaired as often as `REPAIRS` says.

        Raises
        ------
        FileLostError
            The sensor is out of reach.
        DotRefusedError
            It sends nothing.
        """
        try:
            await self._whole()
            for _ in range(REPAIRS):
                if not (missing := self.framer.missing()):
                    break
                for gap in missing:
                    await self._again(gap)
        except FileLostError:
            raise
        except SourceLostError as problem:
            raise FileLostError(str(problem)) from problem
        return FetchedFile(
            self._sensor.name,
            self._file,
            len(self.framer.samples),
            self.framer.missing(),
            self._is_end_known,
            self._is_even(),
        )

    async def _whole(self) -> None:
        """Until the sensor has said that nothing follows the last sample that came."""
        breaks = silences = 0
        while not self._is_end_known:
            before = self._next
            try:
                await reached(self._sensor)
                if await self._ask(before, may_begin_anew=not self._has_ended):
                    self._is_end_known = await self._listen(before, None)
                else:
                    self._has_ended = False  # it tells nothing of what lies behind the last sample: all of it once more
                if self._next == before and not self._is_end_known:
                    silences += 1
            except SourceLostError:
                await reached(self._sensor)  # which ends it, where it stays away
                breaks = breaks + 1 if self._next == before else 0
            if silences > REPAIRS or breaks > REPAIRS:
                if not self.framer.samples:
                    raise DotRefusedError(
                        "{sensor} does not send what it recorded",
                        "Switch it off and on, then fetch it again",
                        sensor=self._sensor.name,
                    )
                return

    @property
    def _next(self) -> int:
        return self.framer.next

    async def _again(self, gap: range) -> None:
        """Ask for what is missing; what comes beyond is broken off."""
        try:
            await reached(self._sensor)
            if await self._ask(gap.start):
                await self._listen(gap.start, gap.stop)
        except SourceLostError:
            await reached(self._sensor)

    async def _ask(self, number: int, *, may_begin_anew: bool = True) -> bool:
        """Let the sensor send from this sample on, or from the first where it does not know that any more."""
        sensor = self._sensor
        await _idle(sensor)
        chosen = bytes([self._file.number]), bytes(CHOSEN)
        if await sensor.order(Order.CHOOSE, chosen[1]) is not DotAnswer.DONE:
            return False
        if number and self._has_begun:
            if await sensor.order(Order.FETCH_FROM, fetch_from(number).data[1:]) is DotAnswer.DONE:
                self._is_from_start = False
                return True
            if not may_begin_anew:
                return False
            await _idle(sensor)
        told = await sensor.order(Order.FETCH, chosen[0])
        self._has_begun = self._is_from_start = told is DotAnswer.DONE
        return self._has_begun

    async def _listen(self, start: int, stop: int | None) -> bool:
        """Keep what comes, to the end or to `stop`; whether the end came, and nothing is missing right before it."""
        damaged = False
        while (said := await _notice(self._sensor, self._take)) is not None:
            match said.data[0]:
                case DotNotice.DATA_END:
                    # looks behind the last sample tell whether more was lost on the way
                    while payload := await self._sensor.notice(OVERTAKEN_S):
                        self._take(payload)
                    self._has_ended = not damaged
                    if damaged or self._next not in (start, 0):
                        self._nothing_followed = 0
                        return False
                    self._nothing_followed += 1
                    return self._is_from_start or self._nothing_followed == LOOKS
                case DotNotice.DATA_DAMAGED:
                    damaged = True
                case DotNotice.DATA if stop is not None and len(said.data) > 5:
                    (number,) = struct.unpack_from("<I", said.data, 1)
                    if number >= stop:
                        await self._sensor.order(Order.BREAK_OFF)
                        return False
        return False

    def _take(self, payload: bytes) -> None:
        frame = framed(Characteristic.NOTICE, payload)
        self._keep(frame)
        self.framer.feed(frame)
        self._progress(len(self.framer.samples), max(self._expected, self._next))

    def _is_even(self) -> bool:
        numbers = np.array(sorted(self.framer.samples))
        ticks = np.array([self.framer.samples[number].sample.ticks for number in numbers.tolist()], dtype=np.int64)
        if len(numbers) < 3:
            return True
        steps = np.diff(ticks) % (1 << 32) / np.diff(numbers)
        return bool(np.all(np.abs(steps - np.median(steps)) < 0.5 * np.median(steps)))


async def erase_kept(sensor: DotSensor, kept: Collection[int], utc_s: int) -> None:
    """Erase the memory, all of which was kept elsewhere: `kept` are when its files were begun, see `RecordedFile`.

    Raises
    ------
    DotRefusedError
        Something is in the memory that was not kept, or it is not erased.
    SourceLostError
        It is out of reach.
    """
    unkept = [file for file in await list_files(sensor) if file.started_utc_s not in kept]
    if unkept:
        raise DotRefusedError(
            "{sensor} holds {count} more recordings", "Fetch them first", sensor=sensor.name, count=len(unkept)
        )
    await sensor.order(Order.ERASE, erase(utc_s).data[1:])
    await sensor.expect(lambda said: said.data[:1] == bytes([DotNotice.ERASED]), ERASES_S)
    if await list_files(sensor):
        raise DotRefusedError("The memory of {sensor} was not erased", "Try again", sensor=sensor.name)

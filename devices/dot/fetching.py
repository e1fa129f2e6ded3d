"""One file on its way out of a sensor: going on after a lost link, repaired, and noted where it could not be had.

    choose, fetch -> samples, numbered from 0 -> the end
    a number is left out, or marked as damaged: from there on again, at once, for that is valid while it sends
    the end: what lies behind the last sample is asked for once more, for its last ones may be lost on their way

Each notification is given to who keeps it before it is looked at.
"""

import asyncio
import struct
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from devices.dot.messages import (
    RECORDING_GROUP,
    Characteristic,
    DotAnswer,
    DotMessage,
    DotNotice,
    Order,
    RecordedFile,
    fetch_from,
)
from devices.dot.samples import CHOSEN, MOST_SAMPLES, FileFramer
from devices.dot.sensor import DotRefusedError, DotSensor
from devices.live import Keep, SourceLostError
from devices.transport.notifications import framed

LOOKS = 2  # behind the last sample: the one that comes again may be lost again
OVERTAKEN_S = 0.1  # so long after its end something may come that the end has overtaken
REPAIRS = 3  # so often what is missing is asked for again
STUCK = 6  # so often in a row nothing new came
SILENCE_S = 3.0
TALK_S = 10.0  # so long it may talk before it sends what it was asked for
IDLE_TALK_S = 20.0  # so long it may send notices with nothing new in them
AWAY_S = 60.0  # so long a sensor that was lost is looked for
AGAIN_S = 0.5
EVER = 1 << 32  # no number is higher

Progress = Callable[[int, int], None]
"""Takes how many samples were fetched, and about how many there are. What it raises ends the fetching, for a while."""


class FileLostError(SourceLostError):
    """A sensor went out of reach while it was fetched, and was not found again. What came was kept; fetch it again."""


@dataclass(frozen=True, slots=True)
class FetchedFile:
    """What came of one file."""

    sensor: str
    file: RecordedFile
    samples: int
    missing: tuple[range, ...]  # numbers of samples that could not be had, below the last that came
    is_end_known: bool  # whether the sensor stated that nothing follows the last sample
    is_even: bool  # whether the samples' times step evenly but for what is missing

    @property
    def lost(self) -> int:
        return sum(map(len, self.missing))

    @property
    def is_complete(self) -> bool:
        return self.samples > 0 and not self.missing and self.is_end_known and self.is_even


async def reached(sensor: DotSensor, within_s: float = AWAY_S) -> None:
    """Connect, trying for `within_s`; raises SourceLostError where the sensor is out of reach."""
    loop = asyncio.get_running_loop()
    until_s = loop.time() + within_s
    while not sensor.is_up:
        try:
            await sensor.connect()
        except SourceLostError:
            await sensor.disconnect()
            if loop.time() > until_s:
                raise
            await asyncio.sleep(AGAIN_S)


def from_now_s(within_s: float) -> float:
    """Give when `within_s` are over, by the clock of the links' thread."""
    return asyncio.get_running_loop().time() + within_s


async def next_notice(
    sensor: DotSensor, until_s: float, kept: Callable[[bytes], None] | None = None
) -> DotMessage | None:
    """The next whole notice of its memory; None where the sensor has fallen silent, or talks on after `until_s`."""
    while from_now_s(0.0) < until_s and (payload := await sensor.notice(SILENCE_S)):
        if kept is not None:
            kept(payload)
        message = sensor.understood(payload)
        if message is not None and message.data and message.group == RECORDING_GROUP:
            return message
    return None


async def made_idle(sensor: DotSensor) -> None:
    """Let it break off what it sends, if it does."""
    state = await sensor.state()
    if state in (DotAnswer.EXPORTING_LIST, DotAnswer.EXPORTING_INFO, DotAnswer.EXPORTING):
        await sensor.order(Order.BREAK_OFF)
        until_s = from_now_s(TALK_S)
        while (stated := await next_notice(sensor, until_s)) is not None and stated.data[
            0
        ] != DotNotice.DATA_BROKEN_OFF:
            pass


class Fetching:
    """May be tried again after it was lost or stopped: what came is not asked for again.

    Parameters
    ----------
    keep
        Takes each notification before it is looked at.
    about
        How many samples there are, about.
    """

    def __init__(self, sensor: DotSensor, file: RecordedFile, keep: Keep, progress: Progress, about: int = 1) -> None:
        self._sensor, self._file, self._keep, self._progress = sensor, file, keep, progress
        self.framer = FileFramer()
        self._about = max(about, 1)
        self._asked: list[range] = []  # each time; no count of each number: a damaged one may be in the millions
        self._ended_at, self._looks = -1, 0  # so often the end came right after this number
        self._repairs_amid = True  # until the sensor refuses it

    async def fetch(self) -> FetchedFile:
        """Fetch it all, repaired up to `REPAIRS` times; raises FileLostError, or DotRefusedError if none came."""
        stuck, cut_before = 0, self._sensor.cut_notices
        while (required := self._required()) is not None and stuck <= STUCK:
            before = len(self.framer.samples), self._looks, len(self._asked)
            try:
                await reached(self._sensor)
                if await self._ask(required.start):
                    await self._listen(required)
            except SourceLostError:
                await self._found_again()
            except BaseException:
                await self._broken_off()
                raise
            now = len(self.framer.samples), self._looks, len(self._asked)
            stuck = 0 if now != before else stuck + 1
        found, missing = len(self.framer.samples), self.framer.missing()
        if not found:
            raise self._nothing(is_cut=self._sensor.cut_notices > cut_before)
        is_end_known = self._looks >= LOOKS
        return FetchedFile(self._sensor.name, self._file, found, missing, is_end_known, self._is_even())

    async def _found_again(self) -> None:
        try:
            await reached(self._sensor)
        except SourceLostError as problem:
            raise FileLostError(str(problem)) from problem

    async def _broken_off(self) -> None:
        with suppress(SourceLostError):  # then it sends nothing more either
            await made_idle(self._sensor)

    def _nothing(self, *, is_cut: bool) -> DotRefusedError:
        name = self._sensor.name
        if is_cut:
            return DotRefusedError("Data from {sensor} arrive incomplete", "Use another Bluetooth adapter", sensor=name)
        return DotRefusedError(
            "{sensor} does not send its recording",
            "Switch the sensor off and on, then fetch the recording again",
            sensor=name,
        )

    def _required(self) -> range | None:
        """What to ask for next: all up to the end, and what is behind it; then what is missing. None: nothing more."""
        if self._looks < LOOKS:
            return range(max(self.framer.next - 1, 0), EVER)
        return next((gap for gap in self.framer.missing() if self._tries(gap.start) < REPAIRS), None)

    def _tries(self, number: int) -> int:
        return sum(number in asked for asked in self._asked)

    async def _ask(self, number: int) -> bool:
        """Let the sensor send from this sample on, or from the first where it takes no other order."""
        sensor = self._sensor
        is_sending = await sensor.state() is DotAnswer.EXPORTING and sensor.fetched_last == self._file
        if number and is_sending and await self._again(number):
            return True
        await made_idle(sensor)
        if await sensor.order(Order.CHOOSE, bytes(CHOSEN)) is not DotAnswer.DONE:
            return False
        if number and sensor.fetched_last == self._file and await self._again(number):
            return True
        sensor.fetched_last = None
        if await sensor.order(Order.FETCH, bytes([self._file.number])) is not DotAnswer.DONE:
            return False
        sensor.fetched_last = self._file
        if number:
            await self._again(number)  # valid now that it sends; where it is not, all of it comes once more
        return True

    async def _again(self, number: int) -> bool:
        return await self._sensor.order(Order.FETCH_FROM, fetch_from(number).data[1:]) is DotAnswer.DONE

    async def _listen(self, required: range) -> None:
        """Keep what comes, to the end or as far as it is needed."""
        latest, asked_from = required.start - 1, EVER
        known, until_s = len(self.framer.samples), from_now_s(IDLE_TALK_S)
        while (stated := await next_notice(self._sensor, until_s, self._take)) is not None:
            if len(self.framer.samples) > known:
                known, until_s = len(self.framer.samples), from_now_s(IDLE_TALK_S)
            kind = stated.data[0]
            if kind == DotNotice.DATA_END:
                await self._ended(latest)
                break
            if kind not in (DotNotice.DATA, DotNotice.DATA_DAMAGED) or len(stated.data) < 5:
                continue
            (number,) = struct.unpack_from("<I", stated.data, 1)
            if number >= MOST_SAMPLES:
                continue  # no memory holds so many
            if number >= required.stop:
                await made_idle(self._sensor)
                break
            if asked_from < number:
                continue  # it was on its way before what was asked for again
            lacking = self._lacking(range(latest + 1, number + (kind == DotNotice.DATA_DAMAGED)))
            latest, asked_from = max(latest, number), EVER
            if lacking and await self._again(lacking.start):
                latest, asked_from = lacking.start - 1, lacking.start
                self._asked.append(lacking)
            elif lacking:
                self._repairs_amid = False
        if required.stop != EVER:
            self._asked.append(required)

    def _lacking(self, gap: range) -> range:
        """From the first of these that was left out or is damaged, if it may be asked for at once; else none."""
        lacking = (number for number in gap if number not in self.framer.samples)
        first = next(lacking, gap.stop) if self._repairs_amid else gap.stop
        return range(first, gap.stop) if first < gap.stop and self._tries(first) < REPAIRS else range(0)

    async def _ended(self, latest: int) -> None:
        """Count how often the end came right after the last sample that is known."""
        until_s = from_now_s(TALK_S)
        while from_now_s(0.0) < until_s and (payload := await self._sensor.notice(OVERTAKEN_S)):
            self._take(payload)
        if latest == self.framer.next - 1:
            self._looks = self._looks + 1 if latest == self._ended_at else 1
            self._ended_at = latest

    def _take(self, payload: bytes) -> None:
        frame = framed(Characteristic.NOTICE, payload)
        self._keep(frame)
        self.framer.feed(frame)
        self._progress(len(self.framer.samples), max(self._about, self.framer.next))

    def _is_even(self) -> bool:
        numbers = np.array(sorted(self.framer.samples))
        ticks = np.array([self.framer.samples[number].sample.ticks for number in numbers.tolist()], dtype=np.int64)
        if len(numbers) < 3:
            return True
        steps = np.diff(ticks) % (1 << 32) / np.diff(numbers)
        return bool(np.all(np.abs(steps - np.median(steps)) < 0.5 * np.median(steps)))

"""Recording in the sensors' own memory: begun and ended in all of them, listed, and erased.

    synchronised at this rate -> begin in each -> end in each -> list -> fetch (`devices/dot/fetching.py`) -> erase

A rate cannot be changed once sensors are synchronised (revision C, 2.2): they are to be synchronised at the rate that
they record with. The memory is erased as a whole, and only by who shows that all of it was kept.
"""

import asyncio
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from devices.dot.fetching import TALK_S, from_now_s, made_idle, next_notice, reached
from devices.dot.messages import (
    DotAnswer,
    DotMessageError,
    DotNotice,
    Order,
    RecordedFile,
    erase,
    files_listed,
    start_recording,
)
from devices.dot.sensor import DotRefusedError, DotSensor
from devices.dot.synchronising import has_own_clock, refuse_while_recording
from devices.live import SourceLostError, SourceRefusedError

RECORD_HZ = 120
LISTINGS = 3  # tries
ERASES_S = 60.0
LINK_TRIES = 4  # where the link is lost over an order
BEGINS_S = 8.0  # so long one is looked for that is to begin: the patient waits
ENDS_S, LOOKED_S = 12.0, 0.3  # so long a sensor may take to write what it holds, once asked to end


class MemoryFullError(DotRefusedError):
    """There is no room in a sensor's memory."""


class OwnClockError(DotRefusedError):
    """A sensor that was synchronised is not any more. `sensor` is its name."""

    @property
    def sensor(self) -> str:
        return str(self.values["sensor"])


@dataclass(frozen=True, slots=True)
class Begun:
    """When a sensor was first asked to record, and when it stated that it does, ns of the host's clock."""

    reported_ns: int
    recording_ns: int


async def record(
    sensors: Sequence[DotSensor], utc_s: int, rate_hz: int, synchronised: Collection[str] = ()
) -> Mapping[str, Begun]:
    """Begin a recording in all sensors, in none if one refuses, and give when each began.
    Raises MemoryFullError, OwnClockError (of `synchronised`, switched off since) or SourceRefusedError.
    """
    tried: list[DotSensor] = []
    begun: dict[str, Begun] = {}
    sensor = sensors[0]
    try:
        for sensor in sensors:
            await _made_ready(sensor, rate_hz, must_be_synchronised=sensor.name in synchronised)
        for sensor in sensors:
            tried.append(sensor)
            begun[sensor.name] = await _begin(sensor, utc_s)
    except (SourceLostError, SourceRefusedError) as problem:
        lost = sensor.name
        for sensor in tried:
            await _stopped_quietly(sensor)
        if isinstance(problem, SourceLostError):
            raise DotRefusedError(
                "{sensor} is out of range", "Bring it closer, then try again", sensor=lost
            ) from problem
        raise
    return begun


async def _made_ready(sensor: DotSensor, rate_hz: int, *, must_be_synchronised: bool) -> None:
    for attempt in range(LINK_TRIES):
        try:
            await reached(sensor, BEGINS_S)
            await refuse_while_recording(sensor)
            await sensor.stop_stream()
            if (await sensor.settings()).rate_hz != rate_hz:
                raise DotRefusedError(
                    "{sensor} is not set to the recording rate",
                    "Synchronise the sensors again",
                    sensor=sensor.name,
                )
            if must_be_synchronised and await has_own_clock(sensor):
                raise OwnClockError(
                    "{sensor} was switched off and is no longer synchronised",
                    "Synchronise the sensors again",
                    sensor=sensor.name,
                )
            return
        except SourceLostError:
            if attempt == LINK_TRIES - 1:
                raise


async def _begin(sensor: DotSensor, utc_s: int) -> Begun:
    """Let it begin; where the link was lost over that, it may have begun already."""
    reported_ns = 0
    for attempt in range(LINK_TRIES):
        try:
            await reached(sensor, BEGINS_S)
            if reported_ns and await sensor.state() is DotAnswer.RECORDING:
                return Begun(reported_ns, sensor.radio.now_ns())
            reported_ns, sensor.is_full = reported_ns or sensor.radio.now_ns(), False
            reported = await sensor.order(Order.START, start_recording(utc_s).data[1:])
            if await sensor.state() is DotAnswer.RECORDING:
                return Begun(reported_ns, sensor.radio.now_ns())
            if reported is DotAnswer.FULL or sensor.is_full:
                raise MemoryFullError(
                    "The memory of {sensor} is full",
                    "Fetch its recordings and erase its memory, then record",
                    sensor=sensor.name,
                )
        except SourceLostError:
            if attempt == LINK_TRIES - 1:
                raise
    raise DotRefusedError(
        "{sensor} does not start recording", "Switch it off and on, then try again", sensor=sensor.name
    )


async def _stopped_quietly(sensor: DotSensor) -> None:
    try:
        await stop(sensor)
    except (SourceLostError, SourceRefusedError):
        return  # out of reach: whoever looks for its files learns that it records


async def stop(sensor: DotSensor) -> None:
    """End its recording, also where it ended itself; raises SourceLostError or DotRefusedError (it goes on)."""
    for attempt in range(LINK_TRIES):
        try:
            await reached(sensor)
            if await _has_ended(sensor, 0.0):
                return
            await sensor.order(Order.STOP)
            if await _has_ended(sensor, ENDS_S):
                return
        except SourceLostError:
            if attempt == LINK_TRIES - 1:
                raise
    raise DotRefusedError("{sensor} does not stop recording", "Press its button for one second", sensor=sensor.name)


async def _has_ended(sensor: DotSensor, within_s: float) -> bool:
    """Whether it states within so long that it does something else; no answer is no end."""
    loop = asyncio.get_running_loop()
    until_s = loop.time() + within_s
    while await sensor.state() in (DotAnswer.RECORDING, DotAnswer.BUSY, DotAnswer.UNKNOWN):
        if loop.time() >= until_s:
            return False
        await asyncio.sleep(LOOKED_S)
    return True


async def list_files(sensor: DotSensor) -> tuple[RecordedFile, ...]:
    """List what is in its memory; raises DotRefusedError where it records or does not report whether it does."""
    await refuse_while_recording(sensor)
    cut_before = sensor.cut_notices
    for _ in range(LISTINGS):
        await made_idle(sensor)
        pieces = await _pieces(sensor)
        files = [await _file(sensor, number + 1, count) for number, count in enumerate(pieces or ())]
        if pieces is not None and None not in files:
            return tuple(file for file in files if file is not None)
    if sensor.cut_notices > cut_before:
        raise DotRefusedError(
            "Data from {sensor} arrive incomplete", "Use another Bluetooth adapter", sensor=sensor.name
        )
    raise DotRefusedError(
        "{sensor} does not report what its memory contains", "Switch it off and on, then try again", sensor=sensor.name
    )


async def _pieces(sensor: DotSensor) -> tuple[int, ...] | None:
    """How many pieces of the memory each file takes; None where that was not reported in full."""
    if await sensor.order(Order.LIST) is not DotAnswer.DONE:
        return None
    listed = b""
    until_s = from_now_s(TALK_S)
    while (stated := await next_notice(sensor, until_s)) is not None:
        if stated.data[0] == DotNotice.LIST_END:
            try:
                return files_listed(listed)
            except DotMessageError:
                return None
        if stated.data[0] == DotNotice.LIST:
            listed += stated.data[1:]
    return None


async def _file(sensor: DotSensor, number: int, pieces: int) -> RecordedFile | None:
    if await sensor.order(Order.FILE_INFO, bytes([number])) is not DotAnswer.DONE:
        return None
    file = None
    until_s = from_now_s(TALK_S)
    while (stated := await next_notice(sensor, until_s)) is not None:
        match stated.data[0]:
            case DotNotice.FILE_INFO:
                try:
                    file = RecordedFile.parsed(number, stated.data[1:], pieces)
                except DotMessageError:
                    return None
            case DotNotice.FILE_INFO_END:
                return file
            case DotNotice.NO_FILE:
                return None
    return None


async def erase_kept(sensor: DotSensor, kept: Collection[int], utc_s: int) -> None:
    """Erase the memory if `kept` has all its files' starts; raises DotRefusedError or SourceLostError."""
    unkept = [file for file in await list_files(sensor) if file.started_utc_s not in kept]
    if unkept:
        raise DotRefusedError(
            "{sensor} contains more recordings ({count})", "Fetch them first", sensor=sensor.name, count=len(unkept)
        )
    sensor.fetched_last = None
    await sensor.order(Order.ERASE, erase(utc_s).data[1:])
    await sensor.expect(lambda stated: stated.data[:1] == bytes([DotNotice.ERASED]), ERASES_S)
    if await list_files(sensor):
        raise DotRefusedError("The memory of {sensor} was not erased", "Try again", sensor=sensor.name)

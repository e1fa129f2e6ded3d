"""Movella DOTs on one clock: the steps that their maker tells, the waits between them, and who did not follow.

    each: is it synchronised, then stop that; rate and profile
    all: start, by the root's address; disconnect
    12 s later: connect again, one by one; the first thing asked is how it went
    all: stream a second; clocks that are said to be one must be heard as one

A failure is tried once more. The clocks part by about 2 ms in half an hour (Xsens DOT user manual 2021, 1 ppm): it is
renewed then.
"""

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from devices.dot.messages import (
    IS_NOT_SYNCHRONISED,
    IS_SYNCHRONISED,
    STOP_SYNC,
    SYNC_STATUS,
    SYNC_STOPPED,
    DotAnswer,
    DotMessageError,
    SyncResult,
    start_sync,
)
from devices.dot.samples import TURN_S, DotFramer, StreamMode
from devices.dot.sensor import DotRefusedError, DotSensor
from devices.live import SourceLostError, SourceRefusedError
from devices.source import SourceInfo

HELD_S = 0.8  # from the last start to the first disconnection
SYNCHRONISING_S = 14.0  # 12 until it is done, 14 until sensors are reached again
RECONNECT_S = 48.0  # for all of them, and then each once more
SETTLES_S = 1.5  # from the connection to the question
HEARD_S = 1.0
APART_S = 0.1  # links differ by less; clocks that are not one, by more
RENEWED_S = 1800.0
TRIES = 2


class SyncStage(StrEnum):
    """Where synchronising is."""

    PREPARING = "preparing"
    WAITING = "waiting"
    CONNECTING = "connecting"
    LISTENING = "listening"


Tell = Callable[[SyncStage, str], None]
"""Takes what is being done, and to which sensor, if to one."""


class NotSynchronisedError(SourceRefusedError):
    """Sensors that did not come onto one clock, by name, and what each said."""

    def __init__(self, failed: "dict[str, str]") -> None:
        super().__init__(
            "{sensors} could not be synchronised",
            "Lay all sensors side by side near this computer, switch these off and on, then try again",
            sensors=", ".join(failed),
        )
        self.failed = failed


@dataclass(frozen=True, slots=True)
class Synchronised:
    """Sensors on one clock, which stream now, each in its mode. `name` tells this clock from any other."""

    name: str
    at_ns: int
    modes: dict[str, StreamMode]


async def synchronise(sensors: Sequence[DotSensor], rate_hz: int, profile: int, tell: Tell) -> Synchronised:
    """Bring sensors onto one clock, the first of them being the root: the one nearest to all others.

    Raises
    ------
    NotSynchronisedError
        Some did not follow, twice; all are as if nothing had been begun, and may be tried again.
    SourceRefusedError
        One records in its memory, does not take its rate, or cannot synchronise.
    """
    failed: dict[str, str] = {}
    for _ in range(TRIES):
        failed = await _prepared(sensors, rate_hz, profile, tell)
        if not failed:
            failed = await _started(sensors, tell)
        if not failed:
            tell(SyncStage.LISTENING, "")
            modes, failed = await _heard_as_one(sensors)
            if not failed:
                root = sensors[0].info
                assert root is not None
                at_ns = sensors[0].radio.now_ns()
                return Synchronised(f"{root.mac} {at_ns}", at_ns, modes)
        for sensor in sensors:
            await _given_up(sensor)
    raise NotSynchronisedError(failed)


async def _prepared(sensors: Sequence[DotSensor], rate_hz: int, profile: int, tell: Tell) -> dict[str, str]:
    failed = {}
    for sensor in sensors:
        tell(SyncStage.PREPARING, sensor.name)
        try:
            await sensor.connect()
            await refuse_while_recording(sensor)
            if sensor.info is None or not sensor.info.can_synchronise:
                raise DotRefusedError(
                    "{sensor} is too old to be synchronised", "Update its firmware", sensor=sensor.name
                )
            await sensor.stop_stream()
            if not await _is_stopped(sensor):
                failed[sensor.name] = "it stays synchronised as it was"
            await sensor.set_up(rate_hz, profile)
        except (SourceLostError, DotMessageError):
            failed[sensor.name] = "it was lost"
    return failed


async def refuse_while_recording(sensor: DotSensor) -> None:
    """Raise unless its memory is idle: whatever is set while it records cuts the file."""
    state = await sensor.state()
    if state is DotAnswer.RECORDING:
        raise DotRefusedError(
            "{sensor} is recording in its memory", "Stop that recording, and fetch it, first", sensor=sensor.name
        )


async def _is_stopped(sensor: DotSensor) -> bool:
    """Whether it is not synchronised, or not any more."""
    await sensor.tell(SYNC_STATUS)
    told = await sensor.expect(lambda notice: notice in (IS_SYNCHRONISED, IS_NOT_SYNCHRONISED))
    if told == IS_NOT_SYNCHRONISED:
        return True
    await sensor.tell(STOP_SYNC)
    return await sensor.expect(lambda notice: notice == SYNC_STOPPED) is not None


async def _started(sensors: Sequence[DotSensor], tell: Tell) -> dict[str, str]:
    """Let the clocks find each other, and ask each sensor how it went."""
    root = sensors[0].info
    assert root is not None
    failed = {}
    for sensor in sensors:
        try:
            await sensor.tell(start_sync(root.mac))
        except SourceLostError:
            failed[sensor.name] = "it was lost"
    await asyncio.sleep(HELD_S)
    for sensor in sensors:
        await sensor.disconnect()
    tell(SyncStage.WAITING, "")
    await asyncio.sleep(SYNCHRONISING_S - HELD_S)
    until_s = asyncio.get_running_loop().time() + RECONNECT_S
    for sensor in sensors:
        tell(SyncStage.CONNECTING, sensor.name)
        problem = await _came_through(sensor, until_s)
        if problem:
            failed.setdefault(sensor.name, problem)
    return failed


async def _came_through(sensor: DotSensor, until_s: float) -> str:
    """Connect and ask for the result before anything else; what went wrong, or nothing."""
    loop = asyncio.get_running_loop()
    while True:
        try:
            await sensor.connect_barely()
            await asyncio.sleep(SETTLES_S)
            answer = await sensor.answer()
            result = SyncResult.UNKNOWN if answer is None else SyncResult.of(answer)
            if result is not SyncResult.GOOD:
                return result.name.lower().replace("_", " ")
            await sensor.connect()
            return ""
        except (SourceLostError, DotMessageError):
            await sensor.disconnect()
            if loop.time() > until_s:
                return "it did not come back"
            await asyncio.sleep(0.5)


async def _heard_as_one(sensors: Sequence[DotSensor]) -> tuple[dict[str, StreamMode], dict[str, str]]:
    """Let all stream, and hold their clocks against each other by what arrives: one that says so may not be on it."""
    modes, late_s, failed = {}, {}, {}
    for sensor in sensors:
        try:
            modes[sensor.name] = await sensor.start_stream()
            sensor.taken()
        except (SourceLostError, DotRefusedError):
            failed[sensor.name] = "it does not begin to measure"
    await asyncio.sleep(HEARD_S)
    for sensor in sensors:
        if sensor.name in modes and sensor.name not in failed:
            if (least_s := _least_late_s(sensor, modes[sensor.name])) is None:
                failed[sensor.name] = "it is not heard"
            else:
                late_s[sensor.name] = least_s
    if late_s:
        first_s = next(iter(late_s.values()))
        off_s = {name: (one_s - first_s + TURN_S / 2) % TURN_S - TURN_S / 2 for name, one_s in late_s.items()}
        middle_s = float(np.median(list(off_s.values())))
        failed |= {name: "its clock is another" for name, one_s in off_s.items() if abs(one_s - middle_s) > APART_S}
    return modes, failed


def _least_late_s(sensor: DotSensor, mode: StreamMode) -> float | None:
    """How much later than its own clock says its samples arrived, at the least; None where none did."""
    framer = DotFramer(SourceInfo("", "", settings={"mode": mode.number}))
    least_s = None
    for came_ns, frame in sensor.taken():
        framer.feed(frame, came_ns / 1e9)
        for row in framer.heard.rows:
            one_s = came_ns / 1e9 - row[0]
            least_s = one_s if least_s is None else min(least_s, one_s)
        framer.heard.rows.clear()
    return least_s


async def _given_up(sensor: DotSensor) -> None:
    """As if nothing had been begun, as far as it can be reached."""
    try:
        await sensor.connect()
        await sensor.stop_stream()
        await sensor.tell(STOP_SYNC)
        await sensor.expect(lambda notice: notice == SYNC_STOPPED)
    except (SourceLostError, DotMessageError):
        await sensor.disconnect()


async def end_synchronising(sensors: Sequence[DotSensor]) -> None:
    """Let each have its own clock again: being synchronised drains the battery."""
    for sensor in sensors:
        await _given_up(sensor)

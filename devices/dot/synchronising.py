"""Movella DOTs on one clock: the steps that their maker gives, the waits between them, and who did not follow.

    each: is it synchronised, then stop that; rate and profile, which cannot be changed until that is stopped
    all: start, by the root's address; disconnect
    12 s later: connect again, one by one; the first thing asked is how it went
    all that are to stream: a second of it; clocks that are reported as one must arrive as one

A failure is tried once more. The clocks part by about 2 ms in half an hour (Xsens DOT user manual 2021, 1 ppm): it is
renewed then.
"""

import asyncio
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
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
RECEIVED_S = 1.0
REPORTED_S = 0.5  # so often while all are left alone
PREPARES_S, CONNECTS_S = 1.5, 3.0  # each, about
APART_S = 0.1  # links differ by less; clocks that are not one, by more
RENEWED_S = 1800.0
TRIES = 2


class SyncStage(StrEnum):
    """Where synchronising is."""

    PREPARING = "preparing"
    WAITING = "waiting"
    CONNECTING = "connecting"
    LISTENING = "listening"


ShowMessage = Callable[[SyncStage, str, float], None]
"""Takes what is being done, to which sensor, if to one, and for how many seconds still, about, until all is done.

What it raises ends the synchronising, and nobody is left synchronised.
"""


class SyncFailure(StrEnum):
    """Why a sensor did not come onto the common clock."""

    LOST = "it was lost"
    STAYS = "it stays synchronised as it was"
    FEW_SAMPLES = "few samples"
    SKEW_TOO_LARGE = "skew too large"
    START_FAILED = "start failed"
    NOT_STARTED = "not started"
    UNKNOWN = "it does not answer"
    NOT_BACK = "it did not come back"
    SILENT = "it does not begin to measure"
    NOT_RECEIVED = "nothing is received from it"
    CUT = "what it sends arrives cut"
    OTHER_CLOCK = "its clock differs"


RESULTS = {
    SyncResult.FEW_SAMPLES: SyncFailure.FEW_SAMPLES,
    SyncResult.SKEW_TOO_LARGE: SyncFailure.SKEW_TOO_LARGE,
    SyncResult.START_FAILED: SyncFailure.START_FAILED,
    SyncResult.NOT_STARTED: SyncFailure.NOT_STARTED,
    SyncResult.UNKNOWN: SyncFailure.UNKNOWN,
}


class NotSynchronisedError(SourceRefusedError):
    """Sensors that did not come onto one clock, by name, and why."""

    def __init__(self, failed: Mapping[str, SyncFailure]) -> None:
        super().__init__(
            "{sensors} could not be synchronised",
            "Lay all sensors side by side near this computer, switch these off and on, then try again",
            sensors=", ".join(failed),
        )
        self.failed = dict(failed)


@dataclass(frozen=True, slots=True)
class Synchronised:
    """Sensors on one clock. `name` distinguishes the clock from others."""

    name: str
    at_ns: int


class _Synchronising:
    """One try after the other."""

    def __init__(self, sensors: Sequence[DotSensor], rate_hz: int, profile: int, show_message: ShowMessage) -> None:
        self._sensors, self._rate_hz, self._profile, self._show_whom = sensors, rate_hz, profile, show_message
        self.failed: dict[str, SyncFailure] = {}
        self._started: list[DotSensor] = []
        self._free_s = 0.0  # from then on those that were started can be reached

    async def has_succeeded(self) -> bool:
        """Whether all sensors follow; where one does not, none is left synchronised."""
        self.failed, self._started = {}, []
        try:
            await self._prepare()
            if not self.failed:
                await self._start()
                await self._bring_back()
        except BaseException:
            await self.give_up()
            raise
        if self.failed:
            await self.give_up()
        return not self.failed

    async def give_up(self) -> None:
        if self._started:
            await asyncio.sleep(max(self._free_s - asyncio.get_running_loop().time(), 0.0))
        for sensor in self._sensors:
            if sensor.is_up or sensor in self._started:
                await _given_up(sensor)

    def fail(self, failed: Mapping[str, SyncFailure]) -> None:
        self.failed |= failed

    def show_message(self, stage: SyncStage, sensor: str = "", left_s: float = 0.0) -> None:
        self._show_whom(stage, sensor, left_s + RECEIVED_S)

    async def _prepare(self) -> None:
        for number, sensor in enumerate(self._sensors):
            left = len(self._sensors)
            left_s = (left - number) * PREPARES_S + SYNCHRONISING_S + left * CONNECTS_S
            self.show_message(SyncStage.PREPARING, sensor.name, left_s)
            try:
                await sensor.connect()
                await refuse_while_recording(sensor)
                if sensor.info is None or not sensor.info.can_synchronise:
                    raise DotRefusedError(
                        "{sensor} cannot be synchronised: its firmware is too old",
                        "Update its firmware",
                        sensor=sensor.name,
                    )
                await sensor.stop_stream()
                if not await _is_stopped(sensor):
                    self.failed[sensor.name] = SyncFailure.STAYS
                    continue
                await sensor.set_up(self._rate_hz, self._profile)
            except SourceLostError:
                self.failed[sensor.name] = SyncFailure.LOST

    async def _start(self) -> None:
        """Let the clocks find each other."""
        loop, root = asyncio.get_running_loop(), self._sensors[0].info
        assert root is not None
        for sensor in self._sensors:
            try:
                await sensor.show_message(start_sync(root.mac))
                self._free_s = loop.time() + SYNCHRONISING_S
                self._started.append(sensor)
            except SourceLostError:
                self.failed[sensor.name] = SyncFailure.LOST
        await asyncio.sleep(HELD_S)
        for sensor in self._sensors:
            await sensor.disconnect()
        back_s = len(self._sensors) * CONNECTS_S
        while (left_s := self._free_s - loop.time()) > 0:
            self.show_message(SyncStage.WAITING, "", left_s + back_s)
            await asyncio.sleep(min(REPORTED_S, left_s))

    async def _bring_back(self) -> None:
        """Connect again, one by one, and ask each how it went."""
        until_s = asyncio.get_running_loop().time() + RECONNECT_S
        for number, sensor in enumerate(self._sensors):
            left_s = (len(self._sensors) - number) * CONNECTS_S
            problem = await self._came_through(sensor, until_s, left_s)
            if problem is not None:
                self.failed.setdefault(sensor.name, problem)

    async def _came_through(self, sensor: DotSensor, until_s: float, left_s: float) -> SyncFailure | None:
        """Connect and ask for the result before anything else; what went wrong, if something did."""
        loop = asyncio.get_running_loop()
        while True:
            self.show_message(SyncStage.CONNECTING, sensor.name, left_s)
            try:
                await sensor.connect_barely()
                await asyncio.sleep(SETTLES_S)
                answer = await sensor.answer()
                result = SyncResult.UNKNOWN if answer is None else SyncResult.of(answer)
                if result is not SyncResult.GOOD:
                    return RESULTS[result]
                await sensor.connect()
                return None
            except SourceLostError:
                await sensor.disconnect()
                if loop.time() > until_s:
                    return SyncFailure.NOT_BACK
                await asyncio.sleep(0.5)


async def synchronise(
    sensors: Sequence[DotSensor], rate_hz: int, profile: int, show_message: ShowMessage, *, must_stream: bool = True
) -> Synchronised:
    """Bring sensors onto one clock, the first as root; raises NotSynchronisedError or SourceRefusedError.

    After an error all are as if nothing had been begun, and may be tried again.
    """
    trying = _Synchronising(sensors, rate_hz, profile, show_message)
    for _ in range(TRIES):
        if not await trying.has_succeeded():
            continue
        if must_stream:
            trying.show_message(SyncStage.LISTENING)
            failed = await _received_as_one(sensors)
            if failed:
                trying.fail(failed)
                await trying.give_up()
                continue
        root = sensors[0].info
        assert root is not None
        at_ns = sensors[0].radio.now_ns()
        return Synchronised(f"{root.mac} {at_ns}", at_ns)
    raise NotSynchronisedError(trying.failed)


async def refuse_while_recording(sensor: DotSensor) -> None:
    """Raise DotRefusedError unless the memory is known to be idle (settings cut a file), or SourceLostError."""
    state = await sensor.state()
    if state is DotAnswer.RECORDING:
        raise DotRefusedError(
            "{sensor} is recording to its memory",
            "Stop that recording in the program that started it, such as Movella's app. Fetch the recording there",
            sensor=sensor.name,
        )
    has_memory = sensor.info is not None and sensor.info.can_synchronise  # both came with the same firmware
    if state is DotAnswer.UNKNOWN and has_memory:
        raise DotRefusedError("{sensor} does not report its state", "Try again", sensor=sensor.name)


async def has_own_clock(sensor: DotSensor) -> bool:
    """Whether it states that it is not synchronised."""
    await sensor.show_message(SYNC_STATUS)
    reported = await sensor.expect(lambda notice: notice in (IS_SYNCHRONISED, IS_NOT_SYNCHRONISED))
    return reported == IS_NOT_SYNCHRONISED


async def _is_stopped(sensor: DotSensor) -> bool:
    """Whether it is not synchronised, or not any more."""
    if await has_own_clock(sensor):
        return True
    await sensor.show_message(STOP_SYNC)
    return await sensor.expect(lambda notice: notice == SYNC_STOPPED) is not None


async def _received_as_one(sensors: Sequence[DotSensor]) -> dict[str, SyncFailure]:
    """Let all stream, and compare their clocks by what arrives: one that claims to be on it may not be."""
    modes, late_s = {}, {}
    failed: dict[str, SyncFailure] = {}
    for sensor in sensors:
        try:
            modes[sensor.name] = await sensor.start_stream()
            sensor.taken()
        except (SourceLostError, DotRefusedError):
            failed[sensor.name] = SyncFailure.SILENT
    await asyncio.sleep(RECEIVED_S)
    for sensor in sensors:
        if sensor.name in modes and sensor.name not in failed:
            least_s, is_cut = _least_late_s(sensor, modes[sensor.name])
            if least_s is None:
                failed[sensor.name] = SyncFailure.CUT if is_cut else SyncFailure.NOT_RECEIVED
            else:
                late_s[sensor.name] = least_s
    if late_s:
        first_s = next(iter(late_s.values()))
        off_s = {name: (one_s - first_s + TURN_S / 2) % TURN_S - TURN_S / 2 for name, one_s in late_s.items()}
        middle_s = float(np.median(list(off_s.values())))
        failed |= {name: SyncFailure.OTHER_CLOCK for name, one_s in off_s.items() if abs(one_s - middle_s) > APART_S}
    return failed


def _least_late_s(sensor: DotSensor, mode: StreamMode) -> tuple[float | None, bool]:
    """How much later than by its own clock its samples arrived, at the least, and whether some arrived damaged."""
    framer = DotFramer(SourceInfo("", "", settings={"mode": mode.number}))
    least_s = None
    for came_ns, frame in sensor.taken():
        framer.feed(frame, came_ns / 1e9)
        for row in framer.received.rows:
            one_s = came_ns / 1e9 - row[0]
            least_s = one_s if least_s is None else min(least_s, one_s)
        framer.received.rows.clear()
    return least_s, framer.received.damaged > 0


async def _given_up(sensor: DotSensor) -> None:
    """As if nothing had been begun, as far as it can be reached."""
    try:
        await sensor.connect()
    except SourceLostError:
        await sensor.disconnect()
        return
    await let_go(sensor, is_synchronised=True)


async def let_go(sensor: DotSensor, *, is_synchronised: bool) -> None:
    """Let a connected sensor send nothing and have its own clock, unless it records; never raises."""
    with suppress(SourceLostError, SourceRefusedError):
        await refuse_while_recording(sensor)
        await sensor.stop_stream()
        if is_synchronised:
            await sensor.show_message(STOP_SYNC)
            await sensor.expect(lambda notice: notice == SYNC_STOPPED)


async def end_synchronising(sensors: Sequence[DotSensor]) -> None:
    """Let each have its own clock again: being synchronised drains the battery."""
    for sensor in sensors:
        await _given_up(sensor)

"""The DOTs that were received, until some of them are worn: who they are, and how those are to measure.

Standing and free motion are measured live, at 60 Hz: their count, their gauges and their hints need samples while the
patient moves, they take seconds, and the patient is beside the computer. Walks are recorded in the sensors' memories,
at 120 Hz, one file for each: nothing is lost over the air however far the patient goes, a file is fetched in a short
while, and each can be held against its journal by itself; a file of the whole visit would hold many times as much, and
the air suits a few minutes. Memory and air at once are not to be had, nor is another rate without synchronising again.
So sensors are synchronised once for what is live, and once more before the walks; where walks are recorded at 60 Hz,
once is enough.
"""

import threading
from collections.abc import Callable, Coroutine, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, TypeVar

from app.acquisition.acquisition import Acquisition
from devices.dot.fetching import reached
from devices.dot.memory import RECORD_HZ, stop
from devices.dot.messages import EMULATED, DotAnswer
from devices.dot.sensor import DotSensor
from devices.dot.source import GENERAL, LIVE_HZ, DotGroup
from devices.live import SourceLostError
from devices.transport.bluetooth import Radio, Tick

Result = TypeVar("Result")

ANSWERS_S = 8.0  # so long one that was received is asked for


class DotAsked(StrEnum):
    """What came of asking a sensor who it is."""

    ANSWERED = "answered"
    RECORDING = "recording"  # in its memory
    TOO_OLD = "too old"  # to be synchronised
    SILENT = "silent"


@dataclass(frozen=True, slots=True)
class ReceivedDot:
    """A sensor that announced itself, and how strongly."""

    sensor: DotSensor
    rssi_dbm: int | None = None

    @property
    def name(self) -> str:
        return self.sensor.name


@dataclass(frozen=True, slots=True)
class DotPlan:
    """How sensors are to measure: what is live at `rate_hz`; walks in their memories, unless `record_hz` is None."""

    rate_hz: int = LIVE_HZ
    record_hz: int | None = RECORD_HZ
    profile: int = GENERAL


class DotFleet:
    """Methods wait, some of them for seconds, so not from the screen's thread."""

    def __init__(self, radio: Radio, dots: Sequence[ReceivedDot]) -> None:
        self.radio, self.dots = radio, tuple(dots)
        self._talking = threading.Lock()  # one question at a time, whoever asks

    @property
    def is_simulated(self) -> bool:
        """Whether one of those that were asked states that it is emulated."""
        return any(one.sensor.info is not None and one.sensor.info.model == EMULATED for one in self.dots)

    def ask(self, number: int, tick: Tick | None = None) -> DotAsked:
        """Ask one of them what it is and what it does. Its link is left: adapters have few."""
        with self._talking:
            try:
                return self.radio.run(_left(self.dots[number].sensor, _asked), tick)
            except SourceLostError:
                return DotAsked.SILENT

    def identify(self, number: int) -> bool:
        """Let its light blink; whether it was asked to."""
        with self._talking:
            try:
                return self.radio.run(_left(self.dots[number].sensor, _identified))
            except SourceLostError:
                return False

    def stop_recordings(self, numbers: Sequence[int]) -> None:
        """End these memory recordings, keeping the files; raises SourceLostError or SourceRefusedError."""
        with self._talking:
            for number in numbers:
                self.radio.run(_left(self.dots[number].sensor, stop))

    def wait(self) -> None:
        """Until nobody is asked any more."""
        with self._talking:
            pass

    def group(self, numbers: Sequence[int], plan: DotPlan) -> DotGroup:
        """Those that are worn, measuring so."""
        worn = [self.dots[number].sensor for number in numbers]
        return DotGroup(self.radio, worn, plan.rate_hz, plan.profile, plan.record_hz)

    def close(self, kept: Sequence[int] = ()) -> None:
        """Leave all but these."""
        with self._talking:
            for number, one in enumerate(self.dots):
                if number not in kept:
                    self.radio.run(one.sensor.disconnect())


def acquisition_of(group: DotGroup, now_ns: Callable[[], int]) -> Acquisition:
    """What reads these sensors."""
    return Acquisition(group.sources(), now_ns, group)


async def _left(sensor: DotSensor, work: Callable[[DotSensor], Coroutine[Any, Any, Result]]) -> Result:
    try:
        return await work(sensor)
    finally:
        await sensor.disconnect()


async def _asked(sensor: DotSensor) -> DotAsked:
    await reached(sensor, ANSWERS_S)
    if sensor.info is None or not sensor.info.can_synchronise:
        return DotAsked.TOO_OLD
    return DotAsked.RECORDING if await sensor.state() is DotAnswer.RECORDING else DotAsked.ANSWERED


async def _identified(sensor: DotSensor) -> bool:
    await reached(sensor, ANSWERS_S)
    if await sensor.state() is DotAnswer.RECORDING:
        return False  # nothing is sent to one that records
    await sensor.identify()
    return True

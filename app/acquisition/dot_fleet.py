"""The DOTs that were heard, until some of them are worn: who they are, and how those are to measure.

Standing and free motion are measured live, at 60 Hz: their count, their gauges and their hints need samples while the
patient moves, they take seconds, and the patient is beside the computer. Walks are recorded in the sensors' memories,
at 120 Hz, one file for each: nothing is lost over the air however far the patient goes, a file is fetched in a short
while, and each can be held against its journal by itself; a file of the whole visit would hold many times as much, and
the air suits a few minutes. Memory and air at once are not to be had, nor is another rate without synchronising anew.
So sensors are synchronised once for what is live, and once more before the walks; where walks are recorded at 60 Hz,
once is enough.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from app.acquisition.acquisition import Acquisition
from devices.bluetooth import Radio, Tick
from devices.dot.fetching import reached
from devices.dot.memory import RECORD_HZ, stop
from devices.dot.messages import EMULATED, DotMessageError
from devices.dot.sensor import DotSensor
from devices.dot.source import GENERAL, LIVE_HZ, DotGroup
from devices.live import SourceLostError

ANSWERS_S = 8.0  # so long one that was heard is asked for


@dataclass(frozen=True, slots=True)
class HeardDot:
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

    def __init__(self, radio: Radio, dots: Sequence[HeardDot]) -> None:
        self.radio, self.dots = radio, tuple(dots)

    @property
    def is_simulated(self) -> bool:
        """Whether one of those that were asked says that it is emulated."""
        return any(one.sensor.info is not None and one.sensor.info.model == EMULATED for one in self.dots)

    def ask(self, name: str, tick: Tick | None = None) -> bool:
        """Connect to a sensor, and let it tell of itself; whether it answers."""
        try:
            self.radio.run(reached(self._sensor(name), ANSWERS_S), tick)
        except (SourceLostError, DotMessageError):
            return False
        return True

    def identify(self, name: str) -> bool:
        """Let its light blink; whether it was told."""
        sensor = self._sensor(name)
        try:
            self.radio.run(_identified(sensor))
        except (SourceLostError, DotMessageError):
            return False
        return True

    def stop_recordings(self, tick: Tick | None = None) -> None:
        """End whatever they record in their memories; what they hold stays there.

        Raises
        ------
        SourceLostError
            One is out of reach.
        SourceRefusedError
            One goes on.
        """
        for one in self.dots:
            self.radio.run(stop(one.sensor), tick)

    def group(self, names: Sequence[str], plan: DotPlan) -> DotGroup:
        """Those that are worn, measuring so."""
        worn = [one.sensor for one in self.dots if one.name in names]
        return DotGroup(self.radio, worn, plan.rate_hz, plan.profile, plan.record_hz)

    def close(self, kept: Sequence[str] = ()) -> None:
        """Leave all but these."""
        for one in self.dots:
            if one.name not in kept:
                self.radio.run(one.sensor.disconnect())

    def _sensor(self, name: str) -> DotSensor:
        return next(one.sensor for one in self.dots if one.name == name)


def acquisition_of(group: DotGroup, now_ns: Callable[[], int]) -> Acquisition:
    """What reads these sensors."""
    return Acquisition(group.sources(), now_ns, group)


async def _identified(sensor: DotSensor) -> None:
    await reached(sensor, ANSWERS_S)
    await sensor.identify()

"""Find which sensor is being shaken, so that it can be given where it is worn.

Shaking is vigorous for a second, and only one sensor is: strapping one on is not so lively, and who carries them or
walks moves several.
"""

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from core.samples import FloatArray, ImuBlock

WINDOW_S = 0.25  # the slowest shaking turns back within it
WINDOWS = 4  # a second of it
SHAKEN_RAD_S, SHAKEN_M_S2 = 2.5, 5.0  # mean speed, or spread of the force: either is vigorous
CALM = 0.2  # of these
CALM_WINDOWS = 2
CLEARLY = 3.0  # times as vigorous as any other
SILENT_S = 0.5


@dataclass(frozen=True, slots=True)
class ShakingState:
    """Who is shaken now."""

    shaken: str | None = None  # from being recognised until it is calm again
    shaken_together: tuple[str, ...] = ()  # two that were shaken at once, until both are calm; neither counts
    count: int = 0  # how often a sensor has been recognised: that of the same sensor twice is two


@dataclass(slots=True)
class _Sensor:
    """`vigour` of the last windows, 1 at what counts as shaking."""

    windows: "Windows"
    received_s: float = -np.inf
    vigour: deque[float] = field(default_factory=lambda: deque([0.0] * WINDOWS, maxlen=WINDOWS))
    waiting: dict[int, float] = field(default_factory=dict)  # of windows that others have not passed yet
    is_ready: bool = True

    @property
    def is_vigorous(self) -> bool:
        return min(self.vigour) >= 1.0

    @property
    def is_calm(self) -> bool:
        return max(list(self.vigour)[-CALM_WINDOWS:]) < CALM

    @property
    def mean_vigour(self) -> float:
        return sum(self.vigour) / WINDOWS


class Shaking:
    """Watches sensors by name; fed block by block, of any size."""

    def __init__(self, names: Iterable[str]) -> None:
        self._sensors = {name: _Sensor(Windows()) for name in names}
        self._next: int | None = None
        self.state = ShakingState()
        self.spread_rad_s: dict[str, float] = {}

    def update(self, blocks: Mapping[str, ImuBlock]) -> ShakingState:
        """Take new samples of some or all sensors; those of unknown ones are passed over."""
        for name, sensor in self._sensors.items():
            block = blocks.get(name)
            if block is None or not len(block):
                continue
            sensor.received_s = float(block.time_s[-1])
            if self._next is None:
                first_s = min(block.time_s[0] for block in blocks.values() if len(block))
                self._next = int(np.floor(first_s / WINDOW_S))
            for number, gyr, acc in sensor.windows.feed(block):
                sensor.waiting[number] = _vigour(gyr, acc)
                self.spread_rad_s[name] = _spread(gyr)
        while self._next is not None and self._is_passed(self._next):
            self._judge(self._next)
            self._next += 1
        return self.state

    def _is_passed(self, number: int) -> bool:
        end_s = (number + 1) * WINDOW_S
        received_s = [sensor.received_s for sensor in self._sensors.values() if np.isfinite(sensor.received_s)]
        return bool(received_s) and (min(received_s) >= end_s or max(received_s) >= end_s + SILENT_S)

    def _judge(self, number: int) -> None:
        for sensor in self._sensors.values():
            for passed in [n for n in sensor.waiting if n < number]:
                del sensor.waiting[passed]
            sensor.vigour.append(sensor.waiting.pop(number, 0.0))
            sensor.is_ready |= sensor.is_calm
        shaken, together = self.state.shaken, self.state.shaken_together
        if shaken is not None and self._sensors[shaken].is_calm:
            shaken = None
        if all(self._sensors[name].is_calm for name in together):
            together = ()
        alone = self._vigorous_alone()
        is_new = any(self._sensors[name].is_ready for name in alone)
        for name in alone:
            self._sensors[name].is_ready = False
        count = self.state.count
        if len(alone) == 1 and is_new:
            shaken, count = alone[0], count + 1
        elif len(alone) == 2 and is_new:
            shaken, together = None, alone
        self.state = ShakingState(shaken, together, count)

    def _vigorous_alone(self) -> tuple[str, ...]:
        """One or two that are shaken while the others are clearly calmer."""
        vigorous = tuple(name for name, sensor in self._sensors.items() if sensor.is_vigorous)
        others = [sensor.mean_vigour for name, sensor in self._sensors.items() if name not in vigorous]
        if not vigorous or len(vigorous) > 2 or (len(vigorous) == 2 and not others):
            return ()
        least = min(self._sensors[name].mean_vigour for name in vigorous)
        return vigorous if least > CLEARLY * max(others, default=0.0) else ()


class Windows:
    """One sensor's samples in windows on a grid that all sensors share."""

    def __init__(self) -> None:
        self._number: int | None = None
        self._gyr: list[FloatArray] = []
        self._acc: list[FloatArray] = []

    def feed(self, block: ImuBlock) -> list[tuple[int, FloatArray, FloatArray]]:
        """Take samples; returns the windows they complete: number, rates and forces (n, 3)."""
        number = np.floor(block.time_s / WINDOW_S).astype(np.int64)
        whole = []
        for one in np.unique(number).tolist():
            if self._number is not None and one != self._number:
                whole.append((self._number, np.concatenate(self._gyr), np.concatenate(self._acc)))
                self._gyr, self._acc = [], []
            self._number, part = one, number == one
            self._gyr.append(block.gyr_rad_s[part])
            self._acc.append(block.acc_m_s2[part])
        return whole


def _vigour(gyr: FloatArray, acc: FloatArray) -> float:
    known = np.isfinite(gyr).all(axis=1) & np.isfinite(acc).all(axis=1)
    if np.count_nonzero(known) < 2:
        return 0.0
    speed_rad_s = float(np.mean(np.linalg.norm(gyr[known], axis=1)))
    return max(speed_rad_s / SHAKEN_RAD_S, _spread(acc[known]) / SHAKEN_M_S2)


def _spread(values: FloatArray) -> float:
    known = values[np.isfinite(values).all(axis=1)]
    return float(np.sqrt(np.sum(np.var(known, axis=0)))) if len(known) else 0.0

"""Whether the patient is standing still, which sensor moved, and what the sensors read meanwhile.

The limits of stillness are those of `core.calibration.rest`; what is found is what that module finds in the samples
since the last movement.
"""

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Generic, TypeVar

import numpy as np

from core.calibration.rest import MAX_ACC_SPREAD_M_S2, MAX_BIAS_RAD_S, MAX_SPREAD_RAD_S, Rest, rest_of
from core.samples import BoolArray, FloatArray, ImuBlock
from core.signal.tracks import is_possible

REQUIRED_S = 3.0
WINDOW_S = 0.25  # how soon a movement is reported
KEPT_S = 10.0  # who goes on standing is measured over the last nine or ten seconds,
REST_EVERY_S = 1.0  # once a second
SILENT_S = 0.5
SAME_BOUT_S = 1.0  # movements less far apart are one

Sensor = TypeVar("Sensor", bound=str)
"""A site, or a name where nobody knows the site yet."""


@dataclass(frozen=True, slots=True)
class StandingState(Generic[Sensor]):
    """How far the standing has come.

    `silent`: sensors without samples for half a second, or that repeat one value; without them nothing counts.
    `rest`: bias and specific force of each sensor, once all were still for the required time.
    `movement`: of each sensor in its last window, as a share of the limit: from 1 on it moves. Infinite where too
    little was received.
    """

    still_s: float  # how long all sensors have given samples and been still
    required_s: float
    moved: tuple[Sensor, ...] = ()  # sensors that moved in the last window of any; the count has restarted after them
    silent: tuple[Sensor, ...] = ()
    rest: Mapping[Sensor, Rest] = field(default_factory=dict)
    movement: Mapping[Sensor, float] = field(default_factory=dict)
    restarts: int = 0  # how often somebody who stood has moved

    @property
    def is_done(self) -> bool:
        return bool(self.rest)


class LiveStanding(Generic[Sensor]):
    """Watches any number of sensors; fed block by block, of any size and in any order of sensors.

    Parameters
    ----------
    optional
        Sensors that nothing waits for while they are silent; the rest is then that of the others.
    """

    def __init__(
        self, sensors: Iterable[Sensor], required_s: float = REQUIRED_S, optional: Container[Sensor] = ()
    ) -> None:
        self._optional = optional
        self._watches = {sensor: _StillnessWatch() for sensor in sensors}
        self._bouts = _Bouts()
        self._rest_of = np.inf, np.inf
        self._found: Mapping[Sensor, Rest] = {}
        self.state: StandingState[Sensor] = StandingState(0.0, required_s)

    def update(self, blocks: Mapping[Sensor, ImuBlock]) -> StandingState[Sensor]:
        """Take new samples of some or all sensors; KeyError for a sensor not announced."""
        for sensor, block in blocks.items():
            for start_s, end_s in self._watches[sensor].feed(block):
                self._bouts.add(start_s, end_s)
        self.state = self._state_now()
        return self.state

    def _state_now(self) -> StandingState[Sensor]:
        watches = self._watches
        latest_s = max((watch.received_s for watch in watches.values()), default=-np.inf)
        silent = tuple(s for s, w in watches.items() if w.is_stuck or not latest_s - w.received_s <= SILENT_S)
        begun_s = min((watch.begun_s for watch in watches.values()), default=np.inf)
        state = replace(
            self.state,
            movement={sensor: w.movement for sensor, w in watches.items() if np.isfinite(w.received_s)},
            restarts=self._bouts.count_after(begun_s + SAME_BOUT_S),
        )
        received = {sensor: watch for sensor, watch in watches.items() if sensor not in silent}
        if any(sensor not in self._optional for sensor in silent) or not received:
            # a sensor that is not received may be moving: the count waits for it and begins again
            return replace(state, still_s=0.0, moved=(), silent=silent, rest={})
        watches = received
        since_s = max(watch.still_since_s for watch in watches.values())
        until_s = min(watch.judged_s for watch in watches.values())
        still_s = until_s - since_s
        rest = self._rest(since_s, still_s, watches) if still_s >= self.state.required_s else {}
        moved = tuple(sensor for sensor, watch in watches.items() if watch.is_moving)
        return replace(state, still_s=max(0.0, still_s), moved=moved, silent=silent, rest=rest)

    def _rest(
        self, since_s: float, still_s: float, watches: "Mapping[Sensor, _StillnessWatch]"
    ) -> Mapping[Sensor, Rest]:
        """What all read while still since an instant, as of the last whole second after the required time."""
        whole_s = np.floor((still_s - self.state.required_s) / REST_EVERY_S) * REST_EVERY_S
        until_s = since_s + self.state.required_s + float(whole_s)
        from_s = max(since_s, until_s - KEPT_S + REST_EVERY_S)
        if (from_s, until_s) != self._rest_of:
            self._rest_of = from_s, until_s
            found = {sensor: watch.rest(from_s, until_s) for sensor, watch in watches.items()}
            known = {sensor: one for sensor, one in found.items() if one is not None}
            self._found = known if len(known) == len(found) else {}
        return self._found


class _StillnessWatch:
    """One sensor, judged in windows that follow each other from its first sample."""

    def __init__(self) -> None:
        self.received_s = self.still_since_s = self.judged_s = -np.inf
        self.begun_s = np.inf
        self.movement = 0.0
        self.is_stuck = False
        self._samples: ImuBlock | None = None

    @property
    def is_moving(self) -> bool:
        return self.movement >= 1.0

    def feed(self, block: ImuBlock) -> list[tuple[float, float]]:
        """Take new samples; returns the windows (start, end) in which the sensor moved."""
        moved: list[tuple[float, float]] = []
        is_new = (block.time_s > self.received_s) & is_possible(block.gyr_rad_s, block.acc_m_s2)
        is_new[1:] &= np.diff(block.time_s) > 0
        for part in _between_silences(_part(block, is_new)):
            if self._samples is None or part.time_s[0] - self.received_s > SILENT_S:
                self._samples = part
                self.still_since_s = self.judged_s = float(part.time_s[0])
            else:
                self._samples = _joined(self._samples, part)
            self.received_s = float(part.time_s[-1])
            self.begun_s = min(self.begun_s, float(part.time_s[0]))
            moved += self._judge(self._samples)
        return moved

    def rest(self, from_s: float, to_s: float) -> Rest | None:
        if self._samples is None:
            return None
        return rest_of(_part(self._samples, slice(*np.searchsorted(self._samples.time_s, [from_s, to_s]).tolist())))

    def _judge(self, samples: ImuBlock) -> list[tuple[float, float]]:
        moved = []
        while samples.time_s[-1] >= self.judged_s + WINDOW_S:
            until_s = self.judged_s + WINDOW_S
            window = slice(*np.searchsorted(samples.time_s, [self.judged_s, until_s]))
            gyr, acc = samples.gyr_rad_s[window], samples.acc_m_s2[window]
            self.is_stuck = len(gyr) > 2 and not (np.ptp(gyr, axis=0).any() or np.ptp(acc, axis=0).any())
            self.movement = movement(gyr, acc)
            if self.is_moving:
                self.still_since_s = until_s
                moved.append((self.judged_s, until_s))
            self.judged_s = until_s
        self._samples = _since(samples, max(self.still_since_s, self.judged_s - KEPT_S))
        return moved


class _Bouts:
    """Stretches in which any sensor moved, in whatever order they are given."""

    def __init__(self) -> None:
        self._bouts: list[tuple[float, float]] = []

    def add(self, start_s: float, end_s: float) -> None:
        near = [(a, b) for a, b in self._bouts if a <= end_s + SAME_BOUT_S and b >= start_s - SAME_BOUT_S]
        self._bouts = [bout for bout in self._bouts if bout not in near]
        self._bouts.append((min([start_s, *(a for a, _ in near)]), max([end_s, *(b for _, b in near)])))

    def count_after(self, time_s: float) -> int:
        return sum(start_s >= time_s for start_s, _ in self._bouts)


def movement(gyr: FloatArray, acc: FloatArray) -> float:
    """Give the worst share of the limits of rest, (n, 3) rad/s and m/s2; infinite for under two samples."""
    if len(gyr) < 2:
        return float("inf")
    spread = [float(np.sqrt(np.sum(np.var(values, axis=0)))) for values in (gyr, acc)]
    mean_rate = float(np.linalg.norm(gyr.mean(axis=0)))
    return max(spread[0] / MAX_SPREAD_RAD_S, spread[1] / MAX_ACC_SPREAD_M_S2, mean_rate / MAX_BIAS_RAD_S)


def _between_silences(block: ImuBlock) -> list[ImuBlock]:
    """The stretches of a block between silences; most blocks are one, an empty block is none."""
    cuts = (np.flatnonzero(np.diff(block.time_s) > SILENT_S) + 1).tolist()
    borders = [0, *cuts, len(block)] if len(block) else []
    return [_part(block, slice(a, b)) for a, b in pairwise(borders)]


def _since(block: ImuBlock, time_s: float) -> ImuBlock:
    return _part(block, slice(int(np.searchsorted(block.time_s, time_s)), None))


def _part(block: ImuBlock, part: slice | BoolArray) -> ImuBlock:
    return ImuBlock(block.sensor, block.time_s[part], block.gyr_rad_s[part], block.acc_m_s2[part])


def _joined(one: ImuBlock, other: ImuBlock) -> ImuBlock:
    return ImuBlock(
        one.sensor,
        np.concatenate([one.time_s, other.time_s]),
        np.concatenate([one.gyr_rad_s, other.gyr_rad_s]),
        np.concatenate([one.acc_m_s2, other.acc_m_s2]),
    )

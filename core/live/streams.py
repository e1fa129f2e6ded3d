"""One sensor's samples on an even clock as they come in: the rules of `core.signal.tracks`, causally."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.samples import BoolArray, FloatArray, ImuBlock, IntArray
from core.signal.tracks import (
    MAX_BRIDGED_GAP_S,
    MAX_FORCE_M_S2,
    MAX_HELD_S,
    MAX_RATE_RAD_S,
    MAX_REPORTED_GAP_S,
    MAX_STILL_GAP_S,
    STILL_RAD_S,
    is_received,
)

ON_GRID = 2e-3  # of a step: closer to a tick than this, a sample is used as it is
CLOCK_MEMORY_S = 2.0  # stamps of this long say where the sensor's own clock is
NOMINAL_STAMPS = 10  # how many stamps its nominal rate is worth
LIMITS = np.array([MAX_RATE_RAD_S] * 3 + [MAX_FORCE_M_S2] * 3)
MAX_ERROR = 0.25  # of a step; a stamp that is off by more carries no more information
LATE_STEPS = 0.15  # so much later than by half a step a sample has to be before one is taken for lost
MAX_STEP_ERROR = 0.05  # of the nominal step: how far the sensor's own may be off
MIN_APART = 0.1  # of a step, between samples whose stamps scatter by more than a step
CONTEXT = 2  # samples beyond an interval's ends that its interpolation needs


@dataclass(frozen=True, slots=True)
class EvenSamples:
    """Samples of one sensor on its grid; `tick` (n,) counts the grid's steps from the first sample ever received.

    Ticks follow each other but for gaps that are too long to bridge: there they jump, and a new stretch begins.
    `is_measured` (n,) is False inside of bridged gaps.
    """

    tick: IntArray
    time_s: FloatArray
    gyr_rad_s: FloatArray
    acc_m_s2: FloatArray
    is_measured: BoolArray

    def __len__(self) -> int:
        return len(self.tick)

    def part(self, which: slice) -> "EvenSamples":
        return EvenSamples(
            self.tick[which],
            self.time_s[which],
            self.gyr_rad_s[which],
            self.acc_m_s2[which],
            self.is_measured[which],
        )

    @property
    def first(self) -> int:
        """Tick of the first sample; there has to be one."""
        return int(self.tick[0])


def followed(parts: Sequence[EvenSamples]) -> EvenSamples:
    """Samples that follow each other; there has to be a part."""
    return EvenSamples(
        np.concatenate([part.tick for part in parts]),
        np.concatenate([part.time_s for part in parts]),
        np.concatenate([part.gyr_rad_s for part in parts]),
        np.concatenate([part.acc_m_s2 for part in parts]),
        np.concatenate([part.is_measured for part in parts]),
    )


Placed = tuple[IntArray, FloatArray, BoolArray]
"""Ticks (n,), their values (n, 6) and whether they are measured (n,)."""

NOTHING_PLACED: Placed = np.empty(0, dtype=np.int64), np.empty((0, 6)), np.empty(0, dtype=np.bool_)


class EvenStream:
    """One sensor's samples, brought to an even grid of its nominal rate that starts at its first stamp.

    A tick is reported as soon as the samples around it are there, two or three after it; at once where a sample lies on
    it. Sensors sample evenly while their stamps scatter: each sample is placed by the line through the stamps up to
    its own. Its rate may differ from the nominal one by a few percent. Samples that are not later than those before
    them are dropped and counted in `late`.
    """

    def __init__(self, rate_hz: float) -> None:
        self.step_s = 1.0 / rate_hz
        self.late = 0
        self._clock = _EvenClock(self.step_s)
        self._origin_s: float | None = None
        self._last_s = -np.inf
        # raw samples from the first one on that equals the last: of a sensor that hangs, perhaps
        self._run_s: FloatArray = np.empty(0)
        self._run: FloatArray = np.empty((0, 6))
        # received samples that ticks to come may need: where they lie on the grid, in steps, and what they are
        self._at: FloatArray = np.empty(0)
        self._values: FloatArray = np.empty((0, 6))
        self._next = 0
        self._placed: list[Placed] = []

    def feed(self, block: ImuBlock) -> None:
        """Take samples, any number of them."""
        if len(block) == 0:
            return
        time_s: FloatArray = block.time_s.astype(np.float64)
        values: FloatArray = np.concatenate([block.gyr_rad_s, block.acc_m_s2], axis=1, dtype=np.float64)
        if not (time_s[0] > self._last_s and (time_s[1:] > time_s[:-1]).all()):
            is_later = time_s > np.fmax.accumulate(np.concatenate([[self._last_s], time_s]))[:-1]
            self.late += int(np.count_nonzero(~is_later))
            time_s, values = time_s[is_later], values[is_later]
            if len(time_s) == 0:
                return
        self._last_s = float(time_s[-1])
        time_s, values = self._received(time_s, values)
        if len(time_s) == 0:
            return
        if self._origin_s is None:
            self._origin_s = float(time_s[0])
        self._add((self._clock.place(time_s) - self._origin_s) / self.step_s, values)

    def take(self) -> EvenSamples:
        """The even samples since the last call."""
        placed, self._placed = self._placed or [NOTHING_PLACED], []
        tick, values, is_measured = placed[0]
        if len(placed) > 1:
            tick = np.concatenate([one[0] for one in placed])
            values = np.concatenate([one[1] for one in placed])
            is_measured = np.concatenate([one[2] for one in placed])
        time_s = (self._origin_s or 0.0) + self.step_s * tick
        return EvenSamples(tick, time_s, values[:, :3], values[:, 3:], is_measured)

    def _received(self, time_s: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The new samples that are measurements; one that repeats itself waits until it is known for how long."""
        waiting = len(self._run_s)
        if waiting:
            time_s, values = np.concatenate([self._run_s, time_s]), np.concatenate([self._run, values])
        if waiting == 1 and _is_plain(values):
            self._run_s, self._run = time_s[-1:], values[-1:]
            return time_s[1:], values[1:]
        is_there = is_received(time_s, values[:, :3], values[:, 3:])
        is_there[: min(waiting, 1)] = False  # already taken
        first = len(time_s) - 1
        while first and np.array_equal(values[first], values[first - 1]):
            first -= 1
        is_there[first + 1 :] = False
        self._run_s, self._run = time_s[first:], values[first:]
        if self._run_s[-1] - self._run_s[0] > MAX_HELD_S:  # it hangs; its ends show for how long
            self._run_s, self._run = self._run_s[[0, -1]], self._run[[0, -1]]
        return time_s[is_there], values[is_there]

    def _add(self, at: FloatArray, values: FloatArray) -> None:
        """Place what the samples contain, stretch by stretch, and keep those that ticks to come need."""
        at, values = np.concatenate([self._at, at]), np.concatenate([self._values, values])
        gap_s = self.step_s * (at[1:] - at[:-1])
        is_cut = gap_s > max(MAX_BRIDGED_GAP_S, 1.5 * self.step_s)
        start = 0
        if is_cut.any():
            speed = np.linalg.norm(values[:, :3], axis=1)
            is_still = np.maximum(speed[:-1], speed[1:]) < STILL_RAD_S
            is_cut &= ~is_still | (gap_s > max(MAX_STILL_GAP_S, 1.5 * self.step_s))
            for end in (np.flatnonzero(is_cut) + 1).tolist():
                self._place(at[start:end], values[start:end], int(np.floor(at[end - 1] + ON_GRID)))
                self._next = int(np.ceil(at[end] - ON_GRID))
                start = end
            at, values = at[start:], values[start:]
        self._place(at, values, self._last_known(at))
        used = max(int(np.searchsorted(at, self._next, side="right")) - 1 - CONTEXT, 0)
        self._at, self._values = at[used:], values[used:]

    def _last_known(self, at: FloatArray) -> int:
        """The last tick that no further sample can change."""
        last = self._next - 1
        if len(at) > CONTEXT:
            last = max(last, int(np.floor(at[-1 - CONTEXT] + ON_GRID)))
        for one in at[-CONTEXT:].tolist():
            if round(one) == last + 1 and abs(one - round(one)) < ON_GRID:
                last += 1
        return last

    def _place(self, at: FloatArray, values: FloatArray, last: int) -> None:
        """The ticks up to `last` from the samples of one stretch at `at` (n,)."""
        if last < self._next:
            return
        tick = np.arange(self._next, last + 1)
        self._next = last + 1
        whole = np.round(at)
        is_on_grid = np.abs(at - whole) < ON_GRID
        if whole[-1] - whole[0] == len(at) - 1 and is_on_grid.all():
            at_tick = values[tick - int(whole[0])]
            self._placed.append((tick, at_tick, np.ones(len(tick), dtype=np.bool_)))
            return
        left = np.clip(np.searchsorted(at, tick, side="right") - 1, 0, len(at) - 2)
        at_tick = akima(at, values, tick, left)
        nearest = left + (tick - at[left] > at[left + 1] - tick)
        is_same = is_on_grid[nearest] & (whole[nearest] == tick)
        at_tick[is_same] = values[nearest[is_same]]
        is_gap = (at[left + 1] - at[left]) * self.step_s > MAX_REPORTED_GAP_S + 1e-6  # five steps of 0.01 s are 0.05 s
        is_measured = ~is_gap | (tick <= at[left] + 0.5) | (tick >= at[left + 1] - 0.5)
        self._placed.append((tick, at_tick, is_measured))


def _is_plain(values: FloatArray) -> bool:
    """Whether all rows (n, 6) are measurements that need no closer look: possible, and none like the one before."""
    is_possible = (np.abs(values).max(axis=0) <= LIMITS).all()  # of NaN never
    return bool(is_possible) and not (values[1:, 0] == values[:-1, 0]).any()


class _EvenClock:
    """Where evenly taken samples lie in time, by the line through their stamps so far."""

    # recursive line through the last stamps: Brookner 1998, Tracking and Kalman Filtering Made Easy, section 1.3

    def __init__(self, step_s: float) -> None:
        self._step_s = self._nominal_s = step_s
        self._memory = max(NOMINAL_STAMPS, round(CLOCK_MEMORY_S / step_s))
        self._count = 0
        self._last_s = 0.0

    def place(self, stamp_s: FloatArray) -> FloatArray:
        """Instants (n,) of samples with ascending stamps (n,); ascending, too."""
        nominal_s, count, last_s, step_s = self._nominal_s, self._count, self._last_s, self._step_s
        slowest_s, fastest_s = (1 + MAX_STEP_ERROR) * nominal_s, (1 - MAX_STEP_ERROR) * nominal_s
        placed_s = []
        for stamp in stamp_s.tolist():
            steps = max(1, round((stamp - last_s) / nominal_s - LATE_STEPS)) if count else 0
            expected_s = last_s + steps * step_s
            error_s = stamp - expected_s
            if count == 0 or abs(error_s) > nominal_s:  # another line begins
                step_s = nominal_s
                last_s = max(stamp, last_s + MIN_APART * nominal_s) if count else stamp
                count = NOMINAL_STAMPS
            else:
                count = min(count + 1, self._memory)
                share = 2 / (count * (count + 1))
                error_s = min(max(error_s, -MAX_ERROR * nominal_s), MAX_ERROR * nominal_s)
                last_s = max(expected_s + share * (2 * count - 1) * error_s, last_s + MIN_APART * nominal_s)
                step_s = min(max(step_s + 3 * share * error_s / steps, fastest_s), slowest_s)
            placed_s.append(last_s)
        self._count, self._last_s, self._step_s = count, last_s, step_s
        return np.array(placed_s)


def akima(at: FloatArray, values: FloatArray, required: IntArray, left: IntArray) -> FloatArray:
    """Interpolate samples (n, k) at `at` (n,) to `required` (m,) without overshoot; gives (m, k).
    `left` (m,) is the index of the sample before each (Akima 1970, doi 10.1145/321607.321609).
    """
    width = np.diff(at)[:, None]
    slope = np.empty((len(at) + 3, values.shape[1]))
    slope[2:-2] = np.diff(values, axis=0) / width
    if len(at) == 2:
        slope[:] = slope[2]
    else:
        slope[1] = 2 * slope[2] - slope[3]
        slope[0] = 2 * slope[1] - slope[2]
        slope[-2] = 2 * slope[-3] - slope[-4]
        slope[-1] = 2 * slope[-2] - slope[-3]
    bend = np.abs(np.diff(slope, axis=0))
    total = bend[2:] + bend[:-2]
    is_straight = total < 1e-12
    share = np.where(is_straight, 0.5, bend[:-2] / np.where(is_straight, 1.0, total))
    tangent = slope[1:-2] + share * (slope[2:-1] - slope[1:-2])
    h = width[left]
    u = (required - at[left])[:, None] / h
    rest = 1 - u
    by_value = u * u * (3 - 2 * u)
    found: FloatArray = (
        (1 - by_value) * values[left]
        + by_value * values[left + 1]
        + h * u * rest * (rest * tangent[left] - u * tangent[left + 1])
    )
    return found

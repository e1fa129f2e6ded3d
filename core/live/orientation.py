"""Orientation of each sensor as its samples come in, by the causal filter VQF, without magnetometer.

VQF as in `core.signal.orientation` (Laidig & Seel 2023, doi 10.1016/j.inffus.2022.10.014), whose offline form knows the
future. Two of its settings are our own, measured on simulated walks against the offline result.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.live.streams import EvenSamples
from core.samples import BoolArray, FloatArray, IntArray, RateKind
from core.signal.filters import live_filter
from core.signal.orientation import interval_rates

TAU_ACC_S = 2.0  # walking needs more than a step; with the customary 3 s the ankle is off by a third more
# Of the bias that standing gave, for warming up; with more, a walk from its first second on pulls the bias away.
BIAS_SD_DEG_S = 0.5


@dataclass(frozen=True, slots=True)
class OrientedSamples:
    """Even samples whose rates are free of bias and stand for the instants of their stamps, and their orientation.

    `tick`, `time_s`, `is_measured`: (n,): as in `EvenSamples`: where ticks jump a new stretch begins.
    `signals`: (n, 10): orientation (4), earth from sensor, scalar first, z up, without jumps between q and -q, its
    heading starting anywhere with each stretch; angular rate (3); specific force (3).
    """

    tick: IntArray
    time_s: FloatArray
    signals: FloatArray
    is_measured: BoolArray

    def __len__(self) -> int:
        return len(self.tick)

    def part(self, which: slice) -> "OrientedSamples":
        return OrientedSamples(self.tick[which], self.time_s[which], self.signals[which], self.is_measured[which])

    @property
    def q_earth_from_sensor(self) -> FloatArray:
        """Unit quaternions (n, 4), scalar first."""
        return self.signals[:, 0:4]

    @property
    def gyr_rad_s(self) -> FloatArray:
        """Angular rates (n, 3) in sensor axes."""
        return self.signals[:, 4:7]

    @property
    def acc_m_s2(self) -> FloatArray:
        """Specific forces (n, 3) in sensor axes."""
        return self.signals[:, 7:10]


NOTHING = OrientedSamples(np.empty(0, dtype=np.int64), np.empty(0), np.empty((0, 10)), np.empty(0, dtype=np.bool_))


def joined(parts: list[OrientedSamples]) -> OrientedSamples:
    """Samples that follow each other."""
    there = [part for part in parts if len(part)]
    if len(there) < 2:
        return there[0] if there else NOTHING
    return OrientedSamples(
        np.concatenate([part.tick for part in there]),
        np.concatenate([part.time_s for part in there]),
        np.concatenate([part.signals for part in there]),
        np.concatenate([part.is_measured for part in there]),
    )


class LiveOrientation:
    """The orientation of one sensor.

    Of rates that the device has averaged over the past interval each is reported one sample late: the rate at an
    instant is the mean of the intervals around it.
    """

    def __init__(self, bias_rad_s: FloatArray, rate_kind: RateKind, step_s: float) -> None:
        self._bias_rad_s = bias_rad_s
        self._is_averaged = rate_kind is RateKind.AVERAGED
        self._filter = live_filter(step_s, TAU_ACC_S, BIAS_SD_DEG_S)
        self._next: int | None = None
        self._last_rate = np.zeros((1, 3))
        self._must_skip = False
        self._held = NOTHING  # the last sample, whose rate the next one completes

    def begin_again(self, bias_rad_s: FloatArray, rest: EvenSamples) -> None:
        """Go on with another bias (3,), settled in the rest that showed it: as after a gap of one sample."""
        rates = rest.gyr_rad_s - bias_rad_s
        self._filter.reset()
        self._filter.update(rates, rest.acc_m_s2)
        self._bias_rad_s, self._last_rate = bias_rad_s, rates[-1:]
        self._next, self._must_skip = int(rest.tick[-1]) + 2, True

    def update(self, even: EvenSamples) -> OrientedSamples:
        """Take the samples of one stream, each once and in order."""
        if self._must_skip and len(even):
            even, self._must_skip = even.part(slice(1, None)), False
            if not len(even):
                return NOTHING
        if len(even) and even.tick[-1] - even.tick[0] == len(even) - 1:
            return joined(self._stretch(even, slice(None)))
        edges = [0, *(np.flatnonzero(np.diff(even.tick) > 1) + 1).tolist(), len(even)]
        return joined([part for a, b in pairwise(edges) if b > a for part in self._stretch(even, slice(a, b))])

    def _stretch(self, even: EvenSamples, which: slice) -> list[OrientedSamples]:
        """Samples without a jump among them; the held one of the stretch before, if another begins."""
        tick, rates, acc = even.tick[which], even.gyr_rad_s[which] - self._bias_rad_s, even.acc_m_s2[which]
        ended = NOTHING
        if tick[0] != self._next:
            bias = self._filter.bias()
            self._filter.reset()
            if self._next is not None:  # a gap makes no other sensor of it
                self._filter.set_bias(*bias)
            self._last_rate = rates[:1]
            ended, self._held = self._held, NOTHING
        self._next = int(tick[-1]) + 1
        between = interval_rates(np.concatenate([self._last_rate, rates]))[1:]
        self._last_rate = rates[-1:]
        turned = self._filter.update(rates if self._is_averaged else between, acc)
        signals = np.concatenate([turned, rates, acc], axis=1)
        new = OrientedSamples(tick, even.time_s[which], signals, even.is_measured[which])
        if not self._is_averaged:
            return [new]
        new = joined([self._held, new])
        new.signals[: len(new) - 1, 4:7] = between[len(between) + 1 - len(new) :]
        self._held = new.part(slice(-1, None))
        return [ended, new.part(slice(0, -1))]

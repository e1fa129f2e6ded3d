"""Check the gyroscope bias from standing against the first rest of a live recording, and take that instead.

A bias that was taken while the patient moved stays in every angle: what the orientation filter may correct is less.
"""

from dataclasses import dataclass

import numpy as np

from core.body import Site
from core.live.standing import movement
from core.live.streams import EvenSamples, followed
from core.samples import FloatArray

REST_S, LOOK_S = 1.0, 0.25  # a foot of who walks slowly rests as long
MAX_ERROR_RAD_S = np.deg2rad(2.0)  # the filter corrects less by itself
TURNING_SHARE = 0.5  # of what the rate would turn the vertical by: a sensor that does turns, slowly and evenly


@dataclass(frozen=True, slots=True)
class BiasCorrection:
    """The bias of `site` was off by `off_rad_s` until the rest that ended at `at_s`."""

    site: Site
    at_s: float
    off_rad_s: float


class BiasWatch:
    """One sensor until its first rest; `bias_rad_s` (3,) from standing."""

    def __init__(self, bias_rad_s: FloatArray, step_s: float) -> None:
        self._bias_rad_s, self._step_s = bias_rad_s, step_s
        self._rest, self._look = round(REST_S / step_s), max(1, round(LOOK_S / step_s))
        self._kept: list[EvenSamples] = []
        self._next = -1
        self.is_done = False

    def reach(self, even: EvenSamples) -> int:
        """How many of the next samples there are until the next look, so that the size of blocks changes nothing."""
        return int(np.searchsorted(even.tick, (even.first // self._look + 1) * self._look))

    def update(self, even: EvenSamples) -> EvenSamples | None:
        """Take samples up to a look at most; the samples of the first rest, if it contradicts the bias."""
        tick = even.tick
        if tick[0] != self._next or tick[-1] - tick[0] != len(even) - 1 or not even.is_measured.all():
            self._kept = []
        self._next = int(tick[-1]) + 1
        self._kept.append(even)
        if self._next % self._look:
            return None
        rest = followed(self._kept)
        if _is_moving(rest.part(slice(-self._look, None))):
            self._kept = []
            return None
        rest = rest.part(slice(-self._rest, None))
        self._kept = [rest]
        off = rest.gyr_rad_s.mean(axis=0) - self._bias_rad_s
        if len(rest) < self._rest or _is_moving(rest) or self._is_turning(off, rest.acc_m_s2):
            return None
        self.is_done, self._kept = True, []
        return rest if float(np.linalg.norm(off)) > MAX_ERROR_RAD_S else None

    def _is_turning(self, rate: FloatArray, acc: FloatArray) -> bool:
        """Whether gravity in the sensor turns as a rate (3,) implies."""
        middle = len(acc) // 2
        before, after = acc[:middle].mean(axis=0), acc[middle:].mean(axis=0)
        by_rate = np.cross(0.5 * (before + after), rate) * (middle * self._step_s)
        size = float(by_rate @ by_rate)
        is_much = size > 0.0 and float(np.linalg.norm(rate)) > MAX_ERROR_RAD_S
        return is_much and float((after - before) @ by_rate) > TURNING_SHARE * size


def _is_moving(even: EvenSamples) -> bool:
    return movement(even.gyr_rad_s, even.acc_m_s2) >= 1.0

"""What a sensor feels of a joint below 4 Hz, as its samples come in: the causal form of `core.signal.joint_force`.

The filter is the offline one's twice over forwards, so that it damps as much; what it delays, it delays alike for both
sensors of a joint.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from scipy.signal import butter, sosfilt, sosfilt_zi

from core.live.orientation import NOTHING, OrientedSamples, joined
from core.live.sample_sets import matrices_of
from core.samples import BoolArray, FloatArray, IntArray
from core.signal.joint_force import CUTOFF_HZ
from core.signal.pair import angular_acceleration

SPACING_S = 0.05  # between the instants that are reported: motion below 4 Hz needs no more
AT_ONCE_S = 1.0  # so much is filtered at once
SETTLES_S = 0.5  # after a gap, until what was missing has left the filter
EDGE = 2  # samples on either side that an angular acceleration needs
PASSES = 2
ROUNDING = 1e-6  # of the spacing


@dataclass(frozen=True, slots=True)
class FeltForces:
    """The terms of one sensor at whole multiples of SPACING_S, low-passed; see `signal.joint_force.JointForce`."""

    instant: IntArray  # (k,): the multiples, of the clock of the joint
    terms: FloatArray  # (k, 3, 7): in the sensor's own earth
    rate_rad_s: FloatArray  # (k,): how fast the sensor turns
    is_clear: BoolArray  # (k,): whether nothing was missing shortly before
    stretch: IntArray  # (k,): counts up where the orientation restarts

    def __len__(self) -> int:
        return len(self.instant)

    def part(self, which: slice | IntArray) -> "FeltForces":
        return FeltForces(*(getattr(self, name)[which] for name in FeltForces.__slots__))


NO_ROWS: FloatArray = np.empty((0, 24))
NO_FORCES = FeltForces(
    np.empty(0, dtype=np.int64),
    np.empty((0, 3, 7)),
    np.empty(0),
    np.empty(0, dtype=np.bool_),
    np.empty(0, dtype=np.int64),
)


def joined_forces(parts: list[FeltForces]) -> FeltForces:
    """Forces that follow each other."""
    there = [part for part in parts if len(part)]
    if len(there) < 2:
        return there[0] if there else NO_FORCES
    return FeltForces(*(np.concatenate([getattr(part, name) for part in there]) for name in FeltForces.__slots__))


class LiveJointForce:
    """One sensor's terms, from its oriented samples, each once and in order.

    Parameters
    ----------
    lag_s
        What is added to the sensor's stamps to bring them to the clock of the joint.
    """

    def __init__(self, step_s: float, lag_s: float = 0.0) -> None:
        self._step_s, self.lag_s = step_s, lag_s
        self._at_once = max(2 * EDGE + 1, round(AT_ONCE_S / step_s))
        self._waiting: list[OrientedSamples] = []
        self._count = 0  # of samples that wait
        self._kept = NOTHING  # the last samples of the stretch, which the next need
        self._state: FloatArray | None = None  # of the filter; None before a stretch's first sample
        self._last = NO_ROWS  # the last filtered row
        self._clear_from_s = -np.inf
        self._stretch = 0
        self._next: int | None = None  # instant

    def update(self, samples: OrientedSamples) -> FeltForces:
        """Take what is new; most calls only keep it, and return nothing."""
        if len(samples):
            self._waiting.append(samples)
            self._count += len(samples)
        if self._count < self._at_once:
            return NO_FORCES
        every, self._waiting, self._count = joined(self._waiting), [], 0
        borders = [0, *(np.flatnonzero(np.diff(every.tick) > 1) + 1).tolist(), len(every)]
        return joined_forces([self._reported(every.part(slice(a, b))) for a, b in pairwise(borders)])

    def _reported(self, samples: OrientedSamples) -> FeltForces:
        """Samples without a jump among them."""
        if len(self._kept) and samples.tick[0] != self._kept.tick[-1] + 1:
            self._kept, self._state, self._last = NOTHING, None, NO_ROWS
            self._stretch += 1
        near = joined([self._kept, samples])
        self._kept = near.part(slice(-2 * EDGE, None))
        if len(near) <= 2 * EDGE:
            self._kept = near
            return NO_FORCES
        return self._at_instants(self._filtered(near))

    def _filtered(self, near: OrientedSamples) -> FloatArray:
        """Stamps, since when they are clear of gaps, rates, the 21 terms, low-passed, but the first and last EDGE."""
        inner = slice(EDGE, -EDGE)
        time_s, gyr = near.time_s[inner] + self.lag_s, near.gyr_rad_s[inner]
        terms = _terms(
            matrices_of(near.q_earth_from_sensor[inner]),
            gyr,
            angular_acceleration(near.gyr_rad_s, self._step_s)[inner],
            near.acc_m_s2[inner],
        )
        sections, steady = _low_pass(self._step_s)
        if self._state is None:
            self._state = steady[:, None, :] * terms[0][None, :, None]
            self._clear_from_s = float(time_s[0]) + SETTLES_S
        smooth, self._state = sosfilt(sections, terms.T, axis=-1, zi=self._state)
        clear_from_s = np.full(len(time_s), self._clear_from_s)
        if not near.is_measured.all():
            is_near_gap = np.convolve(~near.is_measured, np.ones(2 * EDGE + 1), "valid") > 0.5
            own_s = np.where(is_near_gap, time_s + SETTLES_S, -np.inf)
            clear_from_s = np.maximum.accumulate(np.maximum(own_s, clear_from_s))
            self._clear_from_s = float(clear_from_s[-1])
        rate = np.sqrt(np.einsum("ni,ni->n", gyr, gyr))
        return np.concatenate([time_s[:, None], clear_from_s[:, None], rate[:, None], smooth.T], axis=1)

    def _at_instants(self, rows: FloatArray) -> FeltForces:
        rows = np.concatenate([self._last, rows])
        self._last = rows[-1:]
        time_s = rows[:, 0]
        first = int(np.ceil(time_s[0] / SPACING_S - ROUNDING))
        first = first if self._next is None else max(self._next, first)
        end = int(np.ceil(time_s[-1] / SPACING_S - ROUNDING))  # one that is just there is the next call's
        if end <= first:
            return NO_FORCES
        self._next, instant = end, np.arange(first, end, dtype=np.int64)
        at_s = SPACING_S * instant
        right = np.clip(np.searchsorted(time_s, at_s, side="right"), 1, len(time_s) - 1)
        share = (at_s - time_s[right - 1]) / (time_s[right] - time_s[right - 1])
        found = rows[right - 1] + share[:, None] * (rows[right] - rows[right - 1])
        return FeltForces(
            instant,
            found[:, 3:].reshape(-1, 3, 7),
            found[:, 2],
            at_s >= rows[right, 1],
            np.full(len(instant), self._stretch),
        )


def _terms(earth_from: FloatArray, rate: FloatArray, acceleration: FloatArray, force: FloatArray) -> FloatArray:
    """R [K, 1, a] row by row (n, 21)."""
    terms = np.empty((len(rate), 3, 7))
    seen = np.einsum("nij,nj->ni", earth_from, rate)
    square = np.einsum("ni,ni->n", rate, rate)[:, None]
    for j, k, m in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # R K with K = g g' - |g|^2 + [g']x
        terms[:, :, j] = seen * rate[:, j, None] - square * earth_from[:, :, j]
        terms[:, :, j] += (
            acceleration[:, m, None] * earth_from[:, :, k] - acceleration[:, k, None] * earth_from[:, :, m]
        )
    terms[:, :, 3:6] = earth_from
    terms[:, :, 6] = np.einsum("nij,nj->ni", earth_from, force)
    return terms.reshape(-1, 21)


@lru_cache(maxsize=16)
def _low_pass(step_s: float) -> tuple[FloatArray, FloatArray]:
    """Sections of the filter, and their state (s, 2) where 1 has come in for long."""
    sections = np.concatenate([butter(2, CUTOFF_HZ, fs=1 / step_s, output="sos")] * PASSES)
    return sections, sosfilt_zi(sections)

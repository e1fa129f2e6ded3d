"""Samples of both sensors of a joint at the same instants, as they come in."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from core.live.orientation import NOTHING, OrientedSamples, joined
from core.samples import BoolArray, FloatArray, IntArray

SAME_INSTANT = 1e-3  # of a step: closer to one of the distal samples than this, it is taken as it is
MAX_WAIT_S = 10.0  # after which the samples of one sensor go without those of the other
POWERS = np.arange(4)
CUBIC = np.array([[0, 6, 0, 0], [-2, -3, 6, -1], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6  # through four samples
STENCIL = POWERS - 1
KEPT_S = 0.2  # of distal samples already used: another calibration may know of another lag


@dataclass(frozen=True, slots=True)
class PairedSamples:
    """Samples on the proximal sensor's grid and clock.

    `proximal` and `distal` (n, 10) as `OrientedSamples.signals`; distal ones mean nothing where not `is_paired` (n,).
    `is_measured` (n,): both sensors gave a sample.
    """

    tick: IntArray
    time_s: FloatArray
    proximal: FloatArray
    distal: FloatArray
    is_paired: BoolArray
    is_measured: BoolArray

    def __len__(self) -> int:
        return len(self.tick)

    def part(self, which: slice) -> "PairedSamples":
        return PairedSamples(*(getattr(self, name)[which] for name in self.__slots__))


NO_PAIRS = PairedSamples(
    np.empty(0, dtype=np.int64),
    np.empty(0),
    np.empty((0, 10)),
    np.empty((0, 10)),
    np.empty(0, dtype=np.bool_),
    np.empty(0, dtype=np.bool_),
)


def joined_rows(parts: Collection[PairedSamples]) -> PairedSamples:
    """Samples that follow each other; there has to be a part."""
    return PairedSamples(*(np.concatenate([getattr(part, name) for part in parts]) for name in PairedSamples.__slots__))


class Pairing:
    """Waits for whichever sensor is behind and brings the distal samples to the proximal grid.

    `lag_s` is what is added to the distal sensor's stamps; it may change between two calls.
    """

    def __init__(self, proximal_step_s: float, distal_step_s: float, lag_s: float) -> None:
        self.lag_s = lag_s
        self._wait = round(MAX_WAIT_S / proximal_step_s), round(MAX_WAIT_S / distal_step_s)
        self._kept = round(KEPT_S / distal_step_s)
        self._distal_step_s = distal_step_s
        self._distal_origin_s = 0.0
        self._one, self._two = NOTHING, NOTHING

    def update(self, proximal: OrientedSamples, distal: OrientedSamples) -> PairedSamples:
        """Take what is new of each sensor, in order; returns the samples that both of them have reached."""
        if len(distal) and not len(self._two):
            self._distal_origin_s = float(distal.time_s[0]) - self._distal_step_s * float(distal.tick[0])
        self._one, self._two = joined([self._one, proximal]), joined([self._two, distal])
        one, two = self._one, self._two
        at = (one.time_s - (self.lag_s + self._distal_origin_s)) / self._distal_step_s
        left = np.floor(at + SAME_INSTANT).astype(np.int64)
        share = at - left
        is_whole = share < SAME_INSTANT
        count = 0
        if len(two):
            is_ready = left + 2 * ~is_whole <= two.tick[-1]
            count = len(one) if is_ready.all() else int(np.argmin(is_ready))
        count = max(count, len(one) - self._wait[0])
        if count == 0:
            self._two = two.part(slice(max(len(two) - self._wait[1], 0), None))
            return NO_PAIRS
        self._one, one = one.part(slice(count, None)), one.part(slice(0, count))
        paired, used = self._paired(one, left[:count], share[:count], is_whole[:count])
        self._two = two.part(slice(max(used - self._kept, len(two) - self._wait[1], 0), None))
        return paired

    def _paired(
        self, one: OrientedSamples, left: IntArray, share: FloatArray, is_whole: BoolArray
    ) -> tuple[PairedSamples, int]:
        """Proximal samples (n,) `share` of a step after the distal ones of tick `left`; how far those were used."""
        two, last = self._two, len(self._two) - 1
        if last < 0:
            none = np.zeros(len(one), dtype=np.bool_)
            return PairedSamples(one.tick, one.time_s, one.signals, np.zeros((len(one), 10)), none, none), 0
        at = two.tick.searchsorted(left)
        used, at = int(at[-1]), np.minimum(at, last)
        if is_whole.all():
            is_paired, distal, nearest = two.tick[at] == left, two.signals[at], at
        else:
            stencil = at[:, None] + STENCIL
            first, final = (two.tick.take(stencil[:, k], mode="clip") for k in (0, 3))
            is_between = (at < last - 1) & (first == left - 1) & (final == left + 2)
            is_paired = np.where(is_whole, two.tick[at] == left, is_between)
            u = np.where(is_whole, 0.0, share)
            weights = u[:, None] ** POWERS @ CUBIC  # (n, 4), as `at_positions` has them offline
            distal = np.einsum("nk,nki->ni", weights, two.signals.take(stencil, axis=0, mode="clip"))
            nearest = np.minimum(at + (u > 0.5), last)
        is_measured = is_paired & one.is_measured & two.is_measured[nearest]
        return PairedSamples(one.tick, one.time_s, one.signals, distal, is_paired, is_measured), used

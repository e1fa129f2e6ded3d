"""The reference's clock and sign, found from the rates of the angles.

Two systems that measure one joint share its rate, whatever their zeros are. First every whole sample of offset is tried
on all joints of a walk at once; then offset and clock rate are polished together, robustly, because tissue moves
sensors and markers differently at contacts. The walks of one session share both clocks, and so one clock rate.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import correlate

from core.agreement.curves import GRID_HZ, ComparedTrial, RateStretch, rates_of
from core.body import Joint
from core.samples import BoolArray, FloatArray
from core.signal.robust import robust_sd

MIN_OVERLAP_S = 2.0  # of motion known to both: two strides, which is what a small optical volume sees
MIN_RATE_RAD_S = np.deg2rad(8.0)  # root mean square; a walking ankle has 60 degrees a second, standing under 2
MIN_LIKENESS = 0.7  # of the joint that fits best; the same joint in two marker models has over 0.9
NOISE_SHARE = 0.02  # of the rates' power that is never explained, so that no likeness is infinitely good
APART_S = 0.3  # offsets nearer than this are one and the same
MIN_MARGIN = 1.05  # strides resemble each other: of a regular walk the next stride's fit is 0.8 of the best
MIN_LEAD = 10.0  # of the score, the logarithm of a likelihood times seconds: a long walk decides by little differences
ROUNDS = 12
CORRELATED_S = 0.1  # errors nearer than this are not independent
RATE_PRIOR = 300e-6  # clocks of sensors and cameras: 80 to 170 parts in a million are usual


class Misfit(StrEnum):
    """Why a walk and a reference cannot be compared."""

    NO_JOINT_IN_COMMON = "no_joint_in_common"
    TOO_SHORT = "too_short"
    TOO_LITTLE_MOTION = "too_little_motion"
    NOT_ALIKE = "not_alike"


@dataclass(frozen=True, slots=True)
class ReferenceClock:
    """What the reference's clock shows at an instant of the sensors': `offset_s` more at `at_s`, and `rate` faster."""

    at_s: float
    offset_s: float
    rate: float = 0.0

    def at(self, time_s: FloatArray) -> FloatArray:
        """Give the reference's time (n,), s, at times (n,) on the sensors' clock."""
        return time_s + self.offset_s + self.rate * (time_s - self.at_s)


@dataclass(frozen=True, slots=True)
class FoundOffset:
    """The whole sample that fits best. `score` grows with overlap and likeness; `rival_score`: of the next best."""

    offset_s: float
    score: float
    rival_score: float
    likeness: Mapping[Joint, float]

    @property
    def is_certain(self) -> bool:
        """Whether no other offset fits nearly as well."""
        return self.score >= min(MIN_MARGIN * self.rival_score, self.rival_score + MIN_LEAD)


@dataclass(frozen=True, slots=True)
class Alignment:
    """How one walk's reference is brought to it.

    `sign`: -1 where the reference counts the other way. `likeness`: correlation of the rates, by joint, with the sign
    taken out. `gain`: by how much the measured rates are larger than the reference's. `margin` under MIN_MARGIN: the
    offset may be wrong by a stride.
    """

    clock: ReferenceClock
    offset_sd_s: float
    rate_sd: float
    sign: Mapping[Joint, int]
    gain: Mapping[Joint, float]
    likeness: Mapping[Joint, float]
    is_offset_certain: bool


def find_offset(trial: ComparedTrial) -> FoundOffset | Misfit:
    """The offset at which the rates of all joints agree best, to one sample of the grid."""
    if not trial.joints:
        return Misfit.NO_JOINT_IN_COMMON
    pairs = {joint: (rates_of(trial.measured[joint]), rates_of(trial.reference[joint])) for joint in trial.joints}
    pairs = {joint: pair for joint, pair in pairs.items() if pair[0] and pair[1]}
    if not pairs:
        return Misfit.TOO_SHORT
    ones = {joint: _on_grid(one, _first_s(pairs, 0)) for joint, (one, _) in pairs.items()}
    others = {joint: _on_grid(other, _first_s(pairs, 1)) for joint, (_, other) in pairs.items()}
    longest = [max(len(rates) for rates, _ in side.values()) for side in (ones, others)]
    lags = np.arange(1 - longest[1], longest[0])
    score, seconds, power = np.zeros(len(lags)), np.zeros(len(lags)), np.zeros(len(lags))
    likeness: dict[Joint, FloatArray] = {}
    for joint in pairs:
        one, is_one = _padded(*ones[joint], longest[0])
        other, is_other = _padded(*others[joint], longest[1])
        count = _over_lags(is_one, is_other)
        powers = _over_lags(one**2, is_other), _over_lags(is_one, other**2)
        both = np.sqrt(np.maximum(powers[0] * powers[1], 1e-12))
        likeness[joint] = np.where(both > 1e-6, _over_lags(one, other) / both, 0.0)
        score += np.maximum(count, 0.0) / GRID_HZ * -np.log1p(NOISE_SHARE - np.minimum(likeness[joint] ** 2, 1.0))
        seconds = np.maximum(seconds, count / GRID_HZ)
        power = np.maximum(power, np.minimum(*powers) / np.maximum(count, 1.0))  # a leg at rest is no walk
    is_long, is_moving = seconds >= MIN_OVERLAP_S, power >= MIN_RATE_RAD_S**2
    if not is_long.any():
        return Misfit.TOO_SHORT
    if not (is_long & is_moving).any():
        return Misfit.TOO_LITTLE_MOTION
    score = np.where(is_long & is_moving, score, 0.0)
    best = int(np.argmax(score))
    found = {joint: float(values[best]) for joint, values in likeness.items()}
    if max(abs(value) for value in found.values()) < MIN_LIKENESS:
        return Misfit.NOT_ALIKE
    rival = float(score[np.abs(lags - lags[best]) > APART_S * GRID_HZ].max(initial=0.0))
    # a reference that begins `lag` samples after the measurement, and both on clocks of their own
    offset_s = _first_s(pairs, 1) - _first_s(pairs, 0) - lags[best] / GRID_HZ
    return FoundOffset(float(offset_s), float(score[best]), rival, found)


def align(trials: Sequence[ComparedTrial], found: Sequence[FoundOffset]) -> tuple[Alignment, ...]:
    """Offset of each walk and the clock rate of all, polished together, with signs and gains of the joints."""
    polished = [_PolishedTrial(trial, start) for trial, start in zip(trials, found, strict=True)]
    rate = 0.0
    if not polished:
        return ()
    for _ in range(ROUNDS):
        information = np.array([one.linearised(rate) for one in polished])
        rate_step, offset_steps = _solved(information, rate)
        rate += rate_step
        for one, step_s in zip(polished, offset_steps, strict=True):
            one.offset_s += step_s
        if abs(rate_step) < 1e-9 and np.abs(offset_steps).max() < 1e-7:
            break
    rate_sd = float(_rate_information(information) ** -0.5)
    return tuple(one.alignment(rate, rate_sd) for one in polished)


def _solved(information: FloatArray, rate: float) -> tuple[float, FloatArray]:
    """Steps of the shared rate and of every offset (k,) from rows `aa, ab, bb, ra, rb` of all walks."""
    aa, ab, _, ra, rb = information.T
    own = np.maximum(aa, 1e-12)
    right = float(np.sum(rb - ab * ra / own)) - rate / RATE_PRIOR**2
    rate_step = right / _rate_information(information)
    return rate_step, (ra - ab * rate_step) / own


def _rate_information(information: FloatArray) -> float:
    """What all walks show of the shared rate once each has its own offset, with what is known of clocks."""
    aa, ab, bb = information.T[:3]
    return float(np.sum(bb - ab**2 / np.maximum(aa, 1e-12))) + RATE_PRIOR**-2


class _PolishedTrial:
    """One walk while its offset is being polished."""

    def __init__(self, trial: ComparedTrial, start: FoundOffset) -> None:
        self.offset_s, self._start = start.offset_s, start
        self._measured = {joint: rates_of(trial.measured[joint]) for joint in start.likeness}
        self._reference = {
            joint: [_RateSpline(part) for part in rates_of(trial.reference[joint])] for joint in start.likeness
        }
        ends = [(part.start_s, part.time_s[-1]) for parts in self._measured.values() for part in parts]
        self.at_s = 0.5 * (min(first for first, _ in ends) + max(last for _, last in ends))
        self.gain = dict.fromkeys(start.likeness, 1.0)
        self.likeness = dict(start.likeness)
        self._of_joint: dict[Joint, tuple[float, float]] = {}

    def linearised(self, rate: float) -> FloatArray:
        """`aa, ab, bb, ra, rb`: the normal equations of offset and rate, weighed by how independent errors are."""
        total = np.zeros(5)
        self._of_joint.clear()
        clock = ReferenceClock(self.at_s, self.offset_s, rate)
        for joint, parts in self._measured.items():
            time_s = np.concatenate([part.time_s for part in parts])
            one = np.concatenate([part.rate_rad_s for part in parts])
            other, slope = _read(self._reference[joint], clock.at(time_s))
            is_known = np.isfinite(other) & np.isfinite(slope)
            one, other, slope = one[is_known], other[is_known], slope[is_known]
            if np.count_nonzero(is_known) < MIN_OVERLAP_S * GRID_HZ / 2:
                continue
            weight = np.ones(len(one))
            for _ in range(3):
                gain = float(np.sum(weight * one * other) / max(np.sum(weight * other**2), 1e-12))
                error = one - gain * other
                scale = max(robust_sd(error), 1e-4)
                weight = 1.0 / np.sqrt(1.0 + (error / scale) ** 2)
            self.gain[joint] = gain
            self.likeness[joint] = float(np.corrcoef(one, other)[0, 1])
            trust = weight / (scale**2 * CORRELATED_S * GRID_HZ)
            by_offset, by_rate = gain * slope, gain * slope * (time_s[is_known] - self.at_s)
            total += [
                np.sum(trust * by_offset**2),
                np.sum(trust * by_offset * by_rate),
                np.sum(trust * by_rate**2),
                np.sum(trust * by_offset * error),
                np.sum(trust * by_rate * error),
            ]
            self._of_joint[joint] = (float(np.sum(trust * by_offset**2)), float(np.sum(trust * by_offset * error)))
        return total

    def _settle(self) -> float:
        """Move the offset to where the joints have it on the whole, and give its standard deviation, s."""
        # tissue makes one joint seem early and another late: what they differ by beyond their noise weighs all alike
        weight = np.array([information for information, _ in self._of_joint.values()])
        own_s = np.array([right / max(information, 1e-12) for information, right in self._of_joint.values()])
        between = max(0.0, float(np.var(own_s, ddof=1) - np.mean(1.0 / weight))) if len(own_s) > 1 else 0.0
        weight = 1.0 / (1.0 / np.maximum(weight, 1e-12) + between)
        self.offset_s += float(np.sum(weight * own_s) / np.sum(weight))
        return float(np.sum(weight) ** -0.5)

    def alignment(self, rate: float, rate_sd: float) -> Alignment:
        offset_sd_s = self._settle() if self._of_joint else float("nan")
        sign = {joint: 1 if gain >= 0 else -1 for joint, gain in self.gain.items()}
        start = self._start
        return Alignment(
            ReferenceClock(self.at_s, float(self.offset_s), float(rate)),
            offset_sd_s,
            rate_sd,
            sign,
            {joint: abs(gain) for joint, gain in self.gain.items()},
            {joint: abs(value) for joint, value in self.likeness.items()},
            start.is_certain,
        )


class _RateSpline:
    """Rates of one stretch at any instant of it."""

    def __init__(self, part: RateStretch) -> None:
        self.start_s, self.end_s = part.start_s, float(part.time_s[-1])
        self._part = part

    @cached_property
    def _curve(self) -> CubicSpline:
        return CubicSpline(self._part.time_s, self._part.rate_rad_s)

    def __call__(self, time_s: FloatArray, derivative: int) -> FloatArray:
        return np.asarray(self._curve(time_s, derivative))


def _read(parts: Sequence[_RateSpline], time_s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rates (n,) and their slopes (n,) at instants (n,) of the reference's clock; NaN in gaps."""
    rate, slope = np.full(len(time_s), np.nan), np.full(len(time_s), np.nan)
    for part in parts:
        is_inside = (time_s >= part.start_s) & (time_s <= part.end_s)
        rate[is_inside], slope[is_inside] = part(time_s[is_inside], 0), part(time_s[is_inside], 1)
    return rate, slope


def _first_s(pairs: Mapping[Joint, tuple[list[RateStretch], list[RateStretch]]], which: int) -> float:
    return min(part.start_s for pair in pairs.values() for part in pair[which])


def _on_grid(parts: Sequence[RateStretch], first_s: float) -> tuple[FloatArray, BoolArray]:
    """Rates (n,) from `first_s` on, zero in gaps, and where they are known."""
    starts = [round((part.start_s - first_s) * GRID_HZ) for part in parts]
    rates = np.zeros(max(start + len(part.rate_rad_s) for start, part in zip(starts, parts, strict=True)))
    is_known = np.zeros(len(rates), dtype=bool)
    for start, part in zip(starts, parts, strict=True):
        rates[start : start + len(part.rate_rad_s)] = part.rate_rad_s
        is_known[start : start + len(part.rate_rad_s)] = True
    return rates, is_known


def _padded(rates: FloatArray, is_known: BoolArray, length: int) -> tuple[FloatArray, FloatArray]:
    more = length - len(rates)
    return np.pad(rates, (0, more)), np.pad(is_known.astype(np.float64), (0, more))


def _over_lags(one: FloatArray, other: FloatArray) -> FloatArray:
    """Sums of products over all lags, from `other` wholly before `one` to wholly after."""
    return np.asarray(correlate(one, other, mode="full", method="fft"))

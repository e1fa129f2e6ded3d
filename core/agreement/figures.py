"""What two curves of one joint differ by: per walk, and over walks as in Table 1.

Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, Table 1: root mean square deviations of every trial, their mean
and their standard deviation (n - 1). Limits of agreement: Bland and Altman 1986, doi 10.1016/S0140-6736(86)90837-8.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from core.gait.phases import PHASES, Phase
from core.samples import BoolArray, FloatArray, IntArray

LIMITS = 1.96  # standard deviations that hold 95 %
NAMED_PHASES = tuple(phase for phase in PHASES if phase is not Phase.UNKNOWN)
STANCE = (Phase.LOADING, Phase.FOOT_FLAT, Phase.PRE_SWING)
MIN_SAMPLES = 10


@dataclass(frozen=True, slots=True)
class PhaseError:
    """Errors in one phase of the gait, their mean over the whole walk taken out: n, root mean square and mean."""

    samples: int
    rms_rad: float
    bias_rad: float


@dataclass(frozen=True, slots=True)
class Agreement:
    """Measured less reference over one walk or recording, radians; NaN: not known.

    `z_rad`, `m_rad`: root mean square error as measured, and once its mean is removed.
    `bias_rad`, `sd_rad`: mean of the error and its standard deviation (n - 1).
    `low_rad`, `high_rad`: limits of agreement: bias less and plus 1.96 sd.
    `range_error_rad`, `range_error_sd_rad`, `ranges`: range measured less range of the reference, mean and sd (n - 1)
    over `ranges` strides; without strides, of the whole recording.
    `within_1_sd`, `within_2_sd`: shares of samples whose error, its mean removed, is inside one and two of the stated
    standard deviations.
    """

    samples: int
    z_rad: float
    m_rad: float
    bias_rad: float
    sd_rad: float
    correlation: float
    low_rad: float
    high_rad: float
    range_error_rad: float
    range_error_sd_rad: float
    ranges: int
    within_1_sd: float
    within_2_sd: float
    by_phase: Mapping[Phase, PhaseError]

    def in_phases(self, phases: Sequence[Phase]) -> PhaseError:
        """Several phases taken together."""
        return _pooled([self.by_phase[phase] for phase in phases if phase in self.by_phase])


@dataclass(frozen=True, slots=True)
class AgreementOverWalks:
    """The same over `walks` walks: means of their figures, with the sd (n - 1) of Z and M between them.

    `sd_rad` is of one sample of any walk: what varies inside walks and between them. Ranges, shares and phases weigh by
    their number.
    """

    walks: int
    whole: Agreement
    z_sd_rad: float
    m_sd_rad: float


def agreement_of(
    measured_rad: FloatArray,
    reference_rad: FloatArray,
    sd_rad: FloatArray | None = None,
    phase: IntArray | None = None,
    strides: IntArray | None = None,
    *,
    has_zero: bool = True,
) -> Agreement | None:
    """Compare a walk's angles (n,), NaN in gaps; None for under ten samples, no bias without `has_zero`."""
    is_known = np.isfinite(measured_rad) & np.isfinite(reference_rad)
    n = int(np.count_nonzero(is_known))
    if n < MIN_SAMPLES:
        return None
    one, other = measured_rad[is_known], reference_rad[is_known]
    error = one - other
    mean, sd = float(np.mean(error)), float(np.std(error, ddof=1))
    bias = mean if has_zero else np.nan
    ranges = _range_errors(measured_rad, reference_rad, is_known, strides)
    shape = error - mean
    stated = np.full(n, np.nan) if sd_rad is None else sd_rad[is_known]
    return Agreement(
        samples=n,
        z_rad=float(np.sqrt(np.mean(error**2))) if has_zero else np.nan,
        m_rad=float(np.sqrt(np.mean(shape**2))),
        bias_rad=bias,
        sd_rad=sd,
        correlation=float(np.corrcoef(one, other)[0, 1]) if np.ptp(one) > 0 and np.ptp(other) > 0 else np.nan,
        low_rad=bias - LIMITS * sd,
        high_rad=bias + LIMITS * sd,
        range_error_rad=float(np.mean(ranges)) if len(ranges) else np.nan,
        range_error_sd_rad=_sd(ranges),
        ranges=len(ranges),
        within_1_sd=_share_within(shape, stated),
        within_2_sd=_share_within(shape, 2.0 * stated),
        by_phase={} if phase is None else _by_phase(shape, phase[is_known]),
    )


def over_walks(walks: Sequence[Agreement]) -> AgreementOverWalks | None:
    """The figures of several walks of one joint taken together; None where there are none."""
    if not walks:
        return None
    z, m, bias, sd = (np.array([getattr(w, name) for w in walks]) for name in ("z_rad", "m_rad", "bias_rad", "sd_rad"))
    n, ranges = np.array([w.samples for w in walks]), np.array([w.ranges for w in walks])
    mean_bias = float(np.mean(bias))
    between = _sd(bias) if len(walks) > 1 else 0.0
    # without a zero nothing is known of what lies between the heights of two walks
    all_sd = float(np.sqrt(np.mean(sd**2) + (between**2 if np.isfinite(between) else 0.0)))
    whole = Agreement(
        samples=int(np.sum(n)),
        z_rad=float(np.mean(z)),
        m_rad=float(np.mean(m)),
        bias_rad=mean_bias,
        sd_rad=all_sd,
        correlation=float(np.mean([w.correlation for w in walks])),
        low_rad=mean_bias - LIMITS * all_sd,
        high_rad=mean_bias + LIMITS * all_sd,
        range_error_rad=_weighed(np.array([w.range_error_rad for w in walks]), ranges),
        range_error_sd_rad=_pooled_range_sd(walks),
        ranges=int(np.sum(ranges)),
        within_1_sd=_weighed(np.array([w.within_1_sd for w in walks]), n),
        within_2_sd=_weighed(np.array([w.within_2_sd for w in walks]), n),
        by_phase={
            phase: _pooled([w.by_phase[phase] for w in walks if phase in w.by_phase])
            for phase in NAMED_PHASES
            if any(phase in w.by_phase for w in walks)
        },
    )
    return AgreementOverWalks(len(walks), whole, _sd(z), _sd(m))


def _range_errors(one: FloatArray, other: FloatArray, is_known: BoolArray, strides: IntArray | None) -> FloatArray:
    """Range measured less range of the reference (k,), of the strides known throughout to both."""
    if strides is None or not len(strides):
        return np.array([np.ptp(one[is_known]) - np.ptp(other[is_known])])
    parts = [slice(first, last + 1) for first, last in strides]
    return np.array([np.ptp(one[part]) - np.ptp(other[part]) for part in parts if is_known[part].all()])


def _by_phase(shape: FloatArray, phase: IntArray) -> dict[Phase, PhaseError]:
    found: dict[Phase, PhaseError] = {}
    for name in NAMED_PHASES:
        here = shape[phase == PHASES.index(name)]
        if len(here):
            found[name] = PhaseError(len(here), float(np.sqrt(np.mean(here**2))), float(np.mean(here)))
    return found


def _pooled(errors: Sequence[PhaseError]) -> PhaseError:
    n = np.array([error.samples for error in errors])
    square = _weighed(np.array([error.rms_rad for error in errors]) ** 2, n)
    return PhaseError(int(np.sum(n)), float(np.sqrt(square)), _weighed(np.array([e.bias_rad for e in errors]), n))


def _pooled_range_sd(walks: Sequence[Agreement]) -> float:
    """Of the range errors of all strides, from means, spreads and numbers of the walks."""
    known = [walk for walk in walks if walk.ranges]
    n = np.array([walk.ranges for walk in known])
    if np.sum(n) < 2:
        return float("nan")
    mean = np.array([walk.range_error_rad for walk in known])
    inside = np.array([walk.range_error_sd_rad if walk.ranges > 1 else 0.0 for walk in known])
    squares = np.sum((n - 1) * inside**2) + np.sum(n * (mean - np.sum(n * mean) / np.sum(n)) ** 2)
    return float(np.sqrt(squares / (np.sum(n) - 1)))


def _share_within(error: FloatArray, limit: FloatArray) -> float:
    is_stated = np.isfinite(limit)
    return float(np.mean(np.abs(error[is_stated]) <= limit[is_stated])) if is_stated.any() else float("nan")


def _sd(values: FloatArray) -> float:
    return float(np.std(values, ddof=1)) if len(values) > 1 else float("nan")


def _weighed(values: FloatArray, weights: IntArray) -> float:
    is_known = np.isfinite(values) & (weights > 0)
    return float(np.average(values[is_known], weights=weights[is_known])) if is_known.any() else float("nan")

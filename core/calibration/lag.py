"""Lag of the distal sensor's clock, found from accelerations, which see a shift of a millisecond.

The rates' own criterion (eq 3) invents lags of tens of milliseconds at joints that are no perfect hinge.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from core.calibration.coincidence import (
    SCALE_M_S2,
    distal_terms,
    fit_coincidence,
    force_design,
    joint_forces,
    relative_rotation,
    solve_robustly,
)
from core.samples import FloatArray, IntArray
from core.signal.datasets import Datasets

SEARCH_S = 0.08
COARSE_S = 0.02
FINE_S = 0.005
CORRELATION_S = 0.1
MIN_SAMPLES = 50
MAX_LAG_S = 0.075  # nearer to the border of the search it is not a lag but not the same joint
MIN_LAG_S, MIN_TISSUE_LAG_S = 0.001, 0.008  # a segment under tissue follows its bone late, by up to 8 ms
TISSUE_SD_S = 0.0015
TISSUE_COST = 0.03  # of the best coincidence; without tissue 0.01 is left
MIN_COST_RATIO = 1.15
MAX_DISAGREEMENT_S = 0.005  # between the halves of a recording
MIN_SIGMAS = 4.0  # tissue alone shows lags of up to three and a half


@dataclass(frozen=True, slots=True)
class Lag:
    """`lag_s` is to be added to the distal sensor's stamps (0: none found); `is_at_border`: not the same joint.

    `best_s` is where the cost is lowest, found or not.
    """

    lag_s: float
    best_s: float
    sd_s: float | None
    cost_ratio: float
    is_at_border: bool


NO_LAG = Lag(0.0, 0.0, None, 1.0, False)


def find_lag(data: Datasets, knots_rad: FloatArray) -> Lag:
    """Find the distal lag that both halves of the data agree on, else 0; `knots_rad` (k,): relative heading."""
    lag = smoothest_lag(data, knots_rad)
    if not lag.lag_s:
        return lag
    is_first = np.arange(len(data)) < len(data) // 2
    halves = [smoothest_lag(data.only(half), knots_rad) for half in (is_first, ~is_first)]
    apart_s = max(abs(half.best_s - lag.best_s) for half in halves)
    if apart_s > max(MAX_DISAGREEMENT_S, MIN_SIGMAS * (lag.sd_s or 0.0)):
        return replace(lag, lag_s=0.0)
    return lag


def smoothest_lag(data: Datasets, knots_rad: FloatArray) -> Lag:
    """Find the lag at which the joint's accelerations coincide best below the frequencies of tissue."""
    forces = joint_forces(data, SEARCH_S)
    if len(forces) < MIN_SAMPLES:
        return NO_LAG
    heading = data.heading(knots_rad)[None, forces.chosen]

    def costs(shifts_s: FloatArray) -> FloatArray:
        shifted = distal_terms(data, forces.chosen, shifts_s)
        return solve_robustly(force_design(forces.terms_1, shifted, heading), SCALE_M_S2).cost

    return _lowest(costs, FINE_S, len(forces) * _share_of_sample(data.time_s[forces.chosen]))


def sharpest_lag(data: Datasets, knots_rad: FloatArray) -> Lag:
    """Find the lag at which a hinge's unfiltered accelerations coincide best, in whole samples."""
    step_s = data.pairs[0].step_s
    inner = _with_room(data, int(np.ceil(SEARCH_S / step_s)))
    if len(inner) < MIN_SAMPLES:
        return NO_LAG

    heading = inner.heading(knots_rad)[None]

    def costs(shifts_s: FloatArray) -> FloatArray:
        found = [_shifted(inner, shift) for shift in np.round(shifts_s / step_s).astype(np.int64).tolist()]
        return np.concatenate([fit_coincidence(one, relative_rotation(one, heading)).cost for one in found])

    return _lowest(costs, step_s, len(inner) * _share_of_sample(inner.time_s))


def _lowest(costs_of: Callable[[FloatArray], FloatArray], step_s: float, independent: float) -> Lag:
    """The lowest cost (costs (c,) of lags (c,), s) up to 80 ms: coarsely, then by `step_s`, then by a parabola."""
    known: dict[int, float] = {}

    def costs(*shifts: int) -> list[float]:
        new = [shift for shift in shifts if shift not in known]
        if new:
            known.update(zip(new, costs_of(step_s * np.array(new)).tolist(), strict=True))
        return [known[shift] for shift in shifts]

    def cheapest(*shifts: int) -> int:
        return shifts[int(np.argmin(costs(*shifts)))]

    reach = int(np.ceil(SEARCH_S / step_s - 1e-9))
    width = max(1, round(COARSE_S / step_s))
    best = cheapest(*range(-(reach // width) * width, reach + 1, width))
    while width > 1:  # a cost below the frequencies of tissue has one valley between two coarse steps
        width = max(1, width // 2)
        best = cheapest(best - width, best, best + width)
    unmoved, here = costs(0, best)
    if abs(best) >= reach:
        return Lag(0.0, 0.0, None, unmoved / here, unmoved / here > MIN_COST_RATIO)
    before, after = costs(best - 1, best + 1)
    bend = before - 2 * here + after
    offset = 0.5 * (before - after) / bend if bend > 0 else 0.0
    lowest = here - 0.125 * (before - after) ** 2 / bend if bend > 0 else here
    lag_s = (best + offset) * step_s
    ratio = unmoved / max(lowest, 1e-12)
    sd_s = float(step_s * np.sqrt(2 * max(lowest, 1e-12) / (bend * max(1.0, independent)))) if bend > 0 else None
    if abs(lag_s) > MAX_LAG_S:
        return Lag(0.0, 0.0, None, ratio, ratio > MIN_COST_RATIO)
    if lowest > TISSUE_COST and sd_s is not None:
        sd_s = float(np.hypot(sd_s, TISSUE_SD_S))
    is_clear = sd_s is not None and abs(lag_s) > MIN_SIGMAS * sd_s
    least_s = MIN_TISSUE_LAG_S if lowest > TISSUE_COST else MIN_LAG_S
    is_found = is_clear and ratio > MIN_COST_RATIO and abs(lag_s) > least_s
    return Lag(lag_s if is_found else 0.0, lag_s, sd_s, ratio, False)


def _share_of_sample(time_s: FloatArray) -> float:
    """What each of the samples at instants (n,) adds, where the samples beside it within 0.1 s show the same."""
    return min(1.0, float(np.median(np.diff(time_s))) / CORRELATION_S)


def _with_room(data: Datasets, reach: int) -> Datasets:
    """The samples for which all samples within `reach` are known."""
    keep = np.ones(len(data), dtype=bool)
    for s, pair in enumerate(data.pairs):
        mine = data.stretch == s
        index = data.index[mine]
        unknown = np.concatenate([[0], np.cumsum(~pair.is_known)])
        first, last = index - reach, index + reach + 1
        is_inside = (first >= 0) & (last <= len(pair))
        first, last = np.clip(first, 0, len(pair)), np.clip(last, 0, len(pair))
        keep[mine] = is_inside & (unknown[last] == unknown[first])
    return data.only(keep)


def _shifted(data: Datasets, shift: int) -> Datasets:
    """Distal samples stamped `shift` samples earlier: what they measured then belongs to now."""
    index: IntArray = data.index - shift

    def of(name: str) -> FloatArray:
        parts = [getattr(pair, name)[index[data.stretch == s]] for s, pair in enumerate(data.pairs)]
        return np.concatenate(parts)

    return replace(data, a2=of("a2"), g2=of("g2"), dg2=of("dg2"), earth_from_2=of("earth_from_2"))

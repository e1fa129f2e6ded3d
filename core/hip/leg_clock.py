"""One clock for both legs, found through the hips.

Each thigh's clock is held against the pelvis's by the accelerations of its hip; their difference is what the legs are
apart. What tissue adds to both legs alike falls out of it.
"""

from dataclasses import dataclass

import numpy as np

from core.calibration.coincidence import distal_terms, mean_cost
from core.hip.heading import Forces, fit_knots, forces_of, scan_heading
from core.hip.results import ClockStatus, LegClock
from core.samples import FloatArray
from core.signal.pair import Pair

SEARCH_S, COARSE_S, FINE_S = 0.150, 0.025, 0.005
MIN_MOVING_S, LONG_S = 20.0, 40.0
SD_S, LONG_SD_S = 0.005, 0.002  # of 20 s moving, and from 40 s on
MAX_HALVES_S = 0.008  # apart; not tried on people
MIN_MARGIN = 1.5
CLOCK_SAMPLES = 800
REFITS = 3


@dataclass(frozen=True, slots=True)
class ThighClock:
    """What brings one thigh's stamps to the pelvis's clock, s; `halves_s` how far both halves of the data disagree."""

    lag_s: float
    halves_s: float
    margin: float
    moving_s: float
    is_at_border: bool


def thigh_clock(pair: Pair) -> ThighClock | None:
    """Find the lag of one thigh in its longest stretch; None where it hardly moves."""
    forces = forces_of(pair, SEARCH_S)
    if forces is None:
        return None
    some = np.linspace(0, len(forces.data) - 1, min(len(forces.data), CLOCK_SAMPLES)).astype(np.int64)
    thinned = Forces(forces.data.only(some), forces.terms_1[..., some], forces.terms_2[..., some])
    lag_s, is_at_border, margin = 0.0, False, 0.0
    for _ in range(2):  # a late clock spoils the heading, and the heading the search
        heading_rad, margin = scan_heading(_moved(thinned, lag_s))
        knots_rad = np.full(thinned.data.knots, heading_rad)
        lag_s, is_at_border = _best_shift(thinned, knots_rad)
    _, margin = scan_heading(_moved(thinned, lag_s))
    first = np.arange(len(some)) < len(some) // 2
    halves = []
    for half in (first, ~first):
        part = Forces(thinned.data.only(half), thinned.terms_1[..., half], thinned.terms_2[..., half])
        halves.append(_best_shift(part, knots_rad, around_s=lag_s)[0])
    moving_s = float(np.count_nonzero(pair.is_moving & pair.is_known) * pair.step_s)
    return ThighClock(lag_s, abs(halves[1] - halves[0]), margin, moving_s, is_at_border)


def leg_clock(left: ThighClock, right: ThighClock, is_proven: bool) -> LegClock:
    """Give the legs' clock offset by their thighs, and its use: nothing is moved where `is_proven`."""
    offset_s = left.lag_s - right.lag_s
    moving_s = min(left.moving_s, right.moving_s)
    if is_proven:
        return LegClock(offset_s, SD_S if moving_s < LONG_S else LONG_SD_S, ClockStatus.PROVEN)
    is_found = (
        moving_s >= MIN_MOVING_S
        and min(left.margin, right.margin) >= MIN_MARGIN
        and max(left.halves_s, right.halves_s) <= MAX_HALVES_S
        and not (left.is_at_border or right.is_at_border)
    )
    if not is_found:
        return LegClock(offset_s, float("nan"), ClockStatus.NOT_REPORTED)
    return LegClock(offset_s, SD_S if moving_s < LONG_S else LONG_SD_S, ClockStatus.FOUND)


def _moved(forces: Forces, shift_s: float) -> Forces:
    """The same with the thigh's stamps moved."""
    chosen = np.arange(len(forces.data))
    return Forces(forces.data, forces.terms_1, distal_terms(forces.data, chosen, np.array([shift_s]))[0])


def _best_shift(forces: Forces, knots_rad: FloatArray, around_s: float | None = None) -> tuple[float, bool]:
    """The thigh's shift, s, at which both sensors coincide best, headings refitted; whether it is at the border."""
    chosen = np.arange(len(forces.data))

    def costs(shifts_s: FloatArray) -> FloatArray:
        shifted = distal_terms(forces.data, chosen, shifts_s)
        found = (fit_knots(Forces(forces.data, forces.terms_1, terms), knots_rad, REFITS) for terms in shifted)
        return np.array([mean_cost(error) for _, _, error in found])

    if around_s is None:
        coarse = np.arange(-SEARCH_S, SEARCH_S + 0.5 * COARSE_S, COARSE_S)
        around_s = float(coarse[np.argmin(costs(coarse))])
    fine = around_s + FINE_S * np.arange(-5, 6)
    cost = costs(fine)
    best = int(np.argmin(cost))
    if best in (0, len(fine) - 1) or abs(fine[best]) >= SEARCH_S - FINE_S:
        return float(fine[best]), True
    before, here, after = cost[best - 1 : best + 2]
    return float(fine[best] + 0.5 * FINE_S * (before - after) / (before - 2 * here + after)), False

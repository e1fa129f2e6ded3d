"""Find strides on stairs among level ones, by how much higher the foot comes to stand.

One stride's climb is the integral of an integral: a strap that gives, an accelerometer that is off or clipped, a belt
that moves raise some level strides, or all of them, by 10 cm and more. So a walk is level unless stairs are declared
or a run of steps shows: several steep strides in a row that differ from the foot's level ones by more than those
scatter, while the other foot climbs as high, or, of one foot alone, with the same height on the way back.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.body import Side
from core.samples import FloatArray, IntArray
from core.signal.robust import robust_sd

LEAST_CLIMB_M = 0.1  # steps of stairs rise by 0.14 to 0.2 m
LEAST_SLOPE = 0.125  # ramps rise by up to 1 in 8, stairs by half; the first swing onto them comes from the level floor
LEAST_RUN_SLOPE = 0.3  # of most strides of a run: treads of 0.27 to 0.32 m that rise by 0.14 m and more have 0.4
LEAST_LOW = 5  # so many low climbs show what a sensor makes of a level stride where stairs are declared
SCATTER_SD = 4.0  # of level strides: what differs less is one of them
LEAST_RUN, LEAST_RUN_ALONE = 2, 3  # strides of a foot, with the other's beside it and without
LEAST_RUN_M = 0.3  # two low steps
STEP_M, HEIGHT_SHARE = 0.2, 0.25  # both feet climb as high, within a step and this share
NEAR_S = 3.0  # strides of one flight, of either foot, lie no further apart


@dataclass(frozen=True, slots=True)
class FootClimbs:
    """One foot's strides in order of time, (k,) each: when they end, how far they go and climb; NaN where not known."""

    end_s: FloatArray
    length_m: FloatArray
    climb_m: FloatArray


@dataclass(frozen=True, slots=True)
class _Run:
    """Steep strides in a row: how many, how far they climb (negative: descend), when the first and the last end."""

    strides: int
    climb_m: float
    first_s: float
    last_s: float

    def has_height(self, climb_m: float) -> bool:
        most_m = STEP_M + HEIGHT_SHARE * max(abs(self.climb_m), abs(climb_m))
        return abs(self.climb_m - climb_m) < most_m


def on_stairs(feet: Sequence[FootClimbs], *, are_declared: bool) -> list[IntArray]:
    """Find strides up (1) or down (-1) stairs, else 0; `are_declared`: each by itself, not by flights."""
    if are_declared:
        return [np.sign(_steep_m(foot, _usual_low_m(foot), LEAST_CLIMB_M)).astype(np.int64) for foot in feet]
    above_m = [_above_level(foot) for foot in feet]
    runs = [_runs(foot, above) for foot, above in zip(feet, above_m, strict=True) if np.isfinite(foot.climb_m).any()]
    flights = _of_both(*runs) if len(runs) == len(Side) else _there_and_back(runs)
    ways = []
    for foot, above in zip(feet, above_m, strict=True):
        way = np.zeros(len(above), dtype=np.int64)
        for run in flights:
            is_near = (foot.end_s > run.first_s - NEAR_S) & (foot.end_s < run.last_s + NEAR_S)
            way[is_near & (above * run.climb_m > 0.0)] = np.sign(run.climb_m)
        ways.append(way)
    return ways


def _steep_m(foot: FootClimbs, usual_m: float, least_m: float) -> FloatArray:
    """How much higher than usual each stride (k,) leads; 0 where that is less than `least_m`, a ramp, or not known."""
    above_m = foot.climb_m - usual_m
    return np.where(np.abs(above_m) > np.maximum(least_m, LEAST_SLOPE * foot.length_m), above_m, 0.0)


def _usual_low_m(foot: FootClimbs) -> float:
    """What the sensor makes of a level stride, where many are on stairs: one whose scale is off raises all alike."""
    low = foot.climb_m[np.abs(foot.climb_m) < LEAST_CLIMB_M]
    return float(np.median(low)) if len(low) >= LEAST_LOW else 0.0


def _above_level(foot: FootClimbs) -> FloatArray:
    """How much higher than a level stride of this walk each stride (k,) leads; 0 where it may be a level one."""
    # the longer half is level: on stairs people take two treads at a stride, 0.6 m, or stand on each
    is_known = np.isfinite(foot.climb_m) & np.isfinite(foot.length_m)
    if not is_known.any():
        return np.zeros(len(foot.climb_m))
    level_m = foot.climb_m[is_known & (foot.length_m >= np.median(foot.length_m[is_known]))]
    usual_m = float(np.median(level_m))
    return _steep_m(foot, usual_m, max(LEAST_CLIMB_M, SCATTER_SD * robust_sd(level_m - usual_m)))


def _runs(foot: FootClimbs, above_m: FloatArray) -> list[_Run]:
    """Strides in a row that lead the same way, where they are as many, as high and as steep as stairs."""
    way = np.sign(above_m)
    edges = np.flatnonzero(np.diff(np.concatenate([[2.0], way, [2.0]])))
    runs = []
    for first, end in pairwise(edges.tolist()):
        above, length = above_m[first:end], foot.length_m[first:end]
        climb_m, slope = float(above.sum()), float(np.median(np.abs(above) / np.maximum(length, 1e-3)))
        if end - first >= LEAST_RUN and abs(climb_m) > LEAST_RUN_M and slope > LEAST_RUN_SLOPE:
            runs.append(_Run(end - first, climb_m, float(foot.end_s[first]), float(foot.end_s[end - 1])))
    return runs


def _of_both(left: Sequence[_Run], right: Sequence[_Run]) -> list[_Run]:
    """The runs of either foot beside which the other climbs as high."""
    found: list[_Run] = []
    for one in left:
        for other in right:
            is_beside = one.first_s - NEAR_S < other.last_s and other.first_s - NEAR_S < one.last_s
            found += [one, other] if is_beside and one.has_height(other.climb_m) else []
    return found


def _there_and_back(runs: Sequence[Sequence[_Run]]) -> list[_Run]:
    """The runs of a foot alone that are borne out by one as high the other way."""
    long = [run for of_foot in runs for run in of_foot if run.strides >= LEAST_RUN_ALONE]
    return [run for run in long if any(run.has_height(-other.climb_m) for other in long)]

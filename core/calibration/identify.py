"""The robust identification of how two sensors sit on their joint, step by step."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from core.calibration import certainty
from core.calibration.coincidence import disagreement, fit_forces, joint_forces
from core.calibration.heading import residual_scales
from core.calibration.hinge import (
    MAX_HINGE_RESIDUAL_RAD_S,
    MAX_OFF_AXIS_RAD_S,
    MIN_TURNING_SAMPLES,
    hinge_axes,
    hinge_residual,
    turning,
)
from core.calibration.joint_axis import (
    Candidates,
    candidates,
    heading_from_axes,
    joined,
    loss_and_weights,
    polish,
    residuals,
)
from core.calibration.joint_centre import JointCentre, centre_by_lengths, centre_by_vectors, centre_sd_m
from core.calibration.lag import Lag, find_lag, sharpest_lag, smoothest_lag
from core.calibration.refinement import refine_on_hinge
from core.calibration.same_joint import most_disagreement
from core.samples import FloatArray
from core.signal.datasets import Datasets, gather, moving_indices, slow_ones, united
from core.signal.pair import FAST_RAD_S, Pair
from core.signal.rotations import wrap

CANDIDATE_SAMPLES = 200
DECISION_SAMPLES = 400
POLISH_SAMPLES = 1500
AXIS_SAMPLES = 800
CANDIDATE_STEPS = 5
POLISH_STEPS = 6
MIN_MOVING_S = 2.0  # less movement than this identifies nothing
RIVAL_HEADING_RAD = np.deg2rad(45.0)
RATE_COST_FLOOR = 1e-9
ACCELERATION_COST_FLOOR = 0.05
MAX_LAG_SD_S = 0.002  # of a lag from free motion alone
MAX_REST_S = 0.01  # after the first correction
ELEVATION_SD_RAD = np.deg2rad(25.0)
MAX_ELEVATION_RAD = np.deg2rad(40.0)


@dataclass(frozen=True, slots=True)
class Identification:
    """Axes (3,) as the data pair them (their common sign is not clinical), centres, and how sure all that is."""

    axis_1: FloatArray
    axis_2: FloatArray
    axis_sd_rad: float
    centre: JointCentre
    centre_sd_m: float
    sign_margin: float
    lag: Lag
    hinge_residual_rad_s: float
    is_hinge: bool
    elevation_rad: float | None
    did_flexion_dominate: bool
    disagreement: float

    @property
    def is_same_joint(self) -> bool:
        """Whether the two sensors may be on adjacent segments."""
        most = most_disagreement(self.sign_margin)
        return not (self.lag.is_at_border or (most is not None and self.disagreement > most))


Downs = tuple[FloatArray, FloatArray]
PairsAtLag = Callable[[float], tuple[Pair, ...]]
"""The pairs that identify the joint, with a lag applied to the distal sensor."""


def moving_data(pairs: tuple[Pair, ...]) -> Datasets | None:
    """All samples with information on the joint; None when there is too little movement."""
    every = [moving_indices(pair) for pair in pairs]
    slow = [slow_ones(pair, index, FAST_RAD_S) for pair, index in zip(pairs, every, strict=True)]
    # jumps and turns are left out where enough remains without them
    indices = [s if len(s) > 0.5 * len(e) else e for s, e in zip(slow, every, strict=True)]
    used = [(pair, index) for pair, index in zip(pairs, indices, strict=True) if len(index) * pair.step_s >= 0.5]
    if sum(len(index) * pair.step_s for pair, index in used) < MIN_MOVING_S:
        return None
    return gather(tuple(pair for pair, _ in used), [index for _, index in used])


def identify_joint(
    pairs_at: PairsAtLag,
    others_at: PairsAtLag,
    free_at: PairsAtLag,
    is_knee: bool,
    is_from_walking: bool,
    downs: Downs | None,
) -> Identification | None:
    """Identify one joint, None for too little movement; `others_at` confirm a hinge, `free_at` None: all free."""
    data = moving_data(pairs_at(0.0))
    if data is None:
        return None
    decision = decide(data, downs)
    others = moving_data(others_at(0.0))
    lag = _lag(data, others, decision)
    if lag.lag_s:
        data, others = moving_data(pairs_at(lag.lag_s)) or data, moving_data(others_at(lag.lag_s))
        decision = decide(data, downs)
        rest_s = _rest_of_lag(data, others, decision)
        if abs(rest_s) < MAX_REST_S:
            lag = replace(lag, lag_s=lag.lag_s + rest_s)
            data, others = moving_data(pairs_at(lag.lag_s)) or data, moving_data(others_at(lag.lag_s))
    free = moving_data(free_at(lag.lag_s))
    return _refined(data, others, free or data, decision, lag, is_knee, is_from_walking, downs)


@dataclass(frozen=True, slots=True)
class Decision:
    """The best hypothesis (one candidate), and its best rival's cost over its own."""

    best: Candidates
    margin: float
    did_flexion_dominate: bool = True


def decide(data: Datasets, downs: Downs | None = None) -> Decision:
    """Choose axes and heading by rates and accelerations, with the margin over the best rival.
    Where the axis is steep in standing, the flattest with the same heading is taken: something else than
    flexion dominated.
    """
    few = data.thinned(CANDIDATE_SAMPLES)
    found = joined([candidates(data, few, s) for s in _richest_stretches(data)])
    found = polish(few, found, CANDIDATE_STEPS)
    some = data.thinned(DECISION_SAMPLES)
    forces = joint_forces(some)
    coincidence = fit_forces(forces, some.heading(found.knots_rad)[:, forces.chosen])
    by_rates = np.log(np.maximum(found.cost, RATE_COST_FLOOR))
    cost = by_rates + np.log(coincidence.cost + ACCELERATION_COST_FLOOR)
    best = int(np.argmin(cost))
    rivals = [k for k in range(len(found)) if _is_rival(found, best, k)]
    margin = float(np.exp(min(cost[k] for k in rivals) - cost[best])) if rivals else float("inf")
    if downs is not None:
        elevation = _elevations(found.axis_1, found.axis_2, downs)
        if elevation[best].max() > MAX_ELEVATION_RAD:
            prior = np.sum(elevation**2, axis=1) / (2 * ELEVATION_SD_RAD**2)
            alike = [k for k in range(len(found)) if not _is_rival(found, best, k)]
            level = min(alike, key=lambda k: float(by_rates[k] + prior[k]))
            return Decision(found.pick(level), margin, did_flexion_dominate=False)
    return Decision(found.pick(best), margin)


def _elevations(axis_1: FloatArray, axis_2: FloatArray, downs: Downs) -> FloatArray:
    """How far the axes (c, 3) of both sensors stand from horizontal in standing, (c, 2) radians."""
    along = [axis @ (down / np.linalg.norm(down)) for axis, down in zip((axis_1, axis_2), downs, strict=True)]
    return np.arcsin(np.clip(np.abs(np.stack(along, axis=1)), 0.0, 1.0))


def _lag(data: Datasets, others: Datasets | None, decision: Decision) -> Lag:
    """The lag that the data show, together with the others where these alone hardly do."""
    some, best = data.thinned(DECISION_SAMPLES), decision.best
    lag = find_lag(some, best.knots_rad[0])
    if others is None or (lag.sd_s is not None and lag.sd_s < MAX_LAG_SD_S):
        return lag
    return find_lag(*_with_others(some, others, best))


def _with_others(data: Datasets, others: Datasets, best: Candidates) -> tuple[Datasets, FloatArray]:
    """Both data sets in one, and their heading knots (k,)."""
    more = others.thinned(DECISION_SAMPLES)
    knots = np.concatenate([best.knots_rad, heading_from_axes(more, best.axis_1, best.axis_2)], axis=1)
    return united([data, more]), knots[0]


def _rest_of_lag(data: Datasets, others: Datasets | None, decision: Decision) -> float:
    """What a first correction has left. On a hinge nothing rings; walks, full of sharp changes, show it too."""
    some, best = data.thinned(DECISION_SAMPLES), decision.best
    if hinge_residual(turning(data, DECISION_SAMPLES), best.axis_1[0], best.axis_2[0]) > MAX_HINGE_RESIDUAL_RAD_S:
        return smoothest_lag(some, best.knots_rad[0]).best_s
    if others is None:
        return sharpest_lag(some, best.knots_rad[0]).best_s
    return sharpest_lag(*_with_others(some, others, best)).best_s


def _richest_stretches(data: Datasets) -> list[int]:
    """The stretch with the most samples of each half of the data: free motion and walking both propose."""
    counts = np.bincount(data.stretch, minlength=len(data.pairs))
    first = int(np.argmax(counts))
    order = [int(s) for s in np.argsort(-counts) if counts[s] > 0]
    return [first, *[s for s in order if s != first][:1]]


def _is_rival(found: Candidates, best: int, k: int) -> bool:
    apart = np.median(np.abs(wrap(found.knots_rad[k] - found.knots_rad[best])))
    pairing = np.dot(found.axis_1[k], found.axis_1[best]) * np.dot(found.axis_2[k], found.axis_2[best])
    return bool(apart > RIVAL_HEADING_RAD or pairing < 0)


def _refined(
    data: Datasets,
    others: Datasets | None,
    free: Datasets,
    decision: Decision,
    lag: Lag,
    is_knee: bool,
    is_from_walking: bool,
    downs: Downs | None,
) -> Identification:
    many, start = data.thinned(POLISH_SAMPLES), decision.best
    enough = data.thinned(AXIS_SAMPLES)
    # what dominates the motion would pull a flatter axis back
    steps = POLISH_STEPS if decision.did_flexion_dominate else 0
    fit = polish(enough, start, steps, *residual_scales(enough, start))
    j1, j2 = fit.axis_1[0], fit.axis_2[0]
    seen = [many] if others is None else [many, others.thinned(POLISH_SAMPLES)]
    turned = [turning(one, POLISH_SAMPLES) for one in ([data] if others is None else [data, others])]
    is_hinge, residual = _is_hinge(turned, fit)
    centre = centre_by_vectors(many, fit.knots_rad[0])
    loose = certainty.looseness(many, j1, many.heading(fit.knots_rad[0]))
    better = hinge_axes(many, j1, j2, centre.unknowns) if is_hinge else None
    if better is not None:
        j1, j2, rows = better
        slope, value = rows[..., :4], rows[..., 4]
        weight = 1 / np.sqrt(1 + value**2)
        covariance = certainty.sandwich_covariance(slope, value, weight, certainty.time_blocks(many))
        axis_sd = certainty.axis_sd_rad(covariance, certainty.hinge_floor_rad(loose))
        # the angle of a hinge needs no heading, so a centre under the axes before is as good a start
        centre = refine_on_hinge(united(seen), j1, j2, centre) or centre
        residual = _hinge_residual(turned, j1, j2)
    else:
        floor = certainty.AXIS_FLOOR_WALKING_RAD if is_from_walking else certainty.AXIS_FLOOR_HUMAN_RAD
        axis_sd = certainty.axis_sd_rad(axis_covariance(many, fit, residual_scales(many, fit)), floor)
    if not is_hinge:
        centre = centre_by_lengths(free.thinned(POLISH_SAMPLES), centre.unknowns)
    elevation = float(_elevations(j1[None], j2[None], downs)[0].max()) if downs else None
    lies_flat = is_hinge or (elevation is not None and elevation < MAX_ELEVATION_RAD)
    return Identification(
        axis_1=j1,
        axis_2=j2,
        axis_sd_rad=axis_sd,
        centre=centre,
        centre_sd_m=centre_sd_m(centre, j1, j2, is_hinge, is_knee, loose),
        sign_margin=decision.margin,
        lag=lag,
        hinge_residual_rad_s=residual,
        is_hinge=is_hinge,
        elevation_rad=elevation,
        did_flexion_dominate=decision.did_flexion_dominate or lies_flat,
        disagreement=max(disagreement_about(one, j1, j2) for one in seen),
    )


def _is_hinge(turned: list[Datasets], fit: Candidates) -> tuple[bool, float]:
    """Whether all of `turned`, of which the first is that of the fit, is the turning of a hinge; and its residual."""
    residual = _hinge_residual(turned, fit.axis_1[0], fit.axis_2[0])
    if len(turned[0]) < MIN_TURNING_SAMPLES:
        return False, residual
    # lengths alone can agree by chance: what a hinge does not do at all is turn across its axis
    off_axis, _ = residual_scales(turned[0], fit)
    return bool(residual < MAX_HINGE_RESIDUAL_RAD_S and off_axis < MAX_OFF_AXIS_RAD_S), residual


def _hinge_residual(turned: list[Datasets], axis_1: FloatArray, axis_2: FloatArray) -> float:
    return max((hinge_residual(one, axis_1, axis_2) for one in turned if len(one)), default=float("nan"))


def disagreement_about(data: Datasets, axis_1: FloatArray, axis_2: FloatArray) -> float:
    """Give the disagreement of two sensors' forces under axes (3,): 0 one joint, 1 none."""
    some = data.thinned(DECISION_SAMPLES)
    knots = heading_from_axes(some, axis_1[None], axis_2[None])
    forces = joint_forces(some)
    heading = some.heading(knots)[:, forces.chosen]
    return disagreement(forces, heading[0], fit_forces(forces, heading).unknowns[0])


def axis_covariance(data: Datasets, fit: Candidates, scales: tuple[float, float]) -> FloatArray:
    """Give the formal covariance (4, 4) of both axes' tangents for candidate 0, rad2, without a floor."""
    r = residuals(data, fit.axis_1, fit.axis_2, data.heading(fit.knots_rad), *scales)
    _, weight = loss_and_weights(r.value)
    # the heading is a nuisance: one slope per sample is taken out of the axes' slopes
    heading, axes, w = r.by_heading[0], r.by_axes[0], weight[0]
    share = np.einsum("nr,nr,nri->i", w, heading, axes) / max(float(np.sum(w * heading**2)), 1e-12)
    axes = axes - heading[..., None] * share
    return certainty.sandwich_covariance(axes, r.value[0], w, certainty.time_blocks(data))

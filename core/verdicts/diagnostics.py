"""How one joint was found and how sure that is: the paper's pictures on this patient's own recordings.

Nothing is decided here: the joint is identified again by the same steps and from the same samples as in `analysis`, and
what those steps only pass on to one another is kept to be looked at.
"""

from dataclasses import dataclass

import numpy as np

from core.angles.measure import Geometry, is_anchored, pairs_of
from core.angles.twist import off_axis_rate
from core.body import Joint, knee_of
from core.calibration.heading import heading_over
from core.calibration.identified import Identified, clock_moved_s, identify
from core.calibration.identify import moving_data
from core.calibration.rate_kind import tracks_of_kind
from core.calibration.validity import Basis, basis_of, spans_of_validity
from core.published.angles import DEFAULT_TAU_S
from core.published.figures import CostOverSphere, ProjectedRates, TwoWays, costs_of_both, projected_rates, two_ways
from core.published.identify import data_sets
from core.published.joint_axis import identify_axes
from core.results import JointCalibration
from core.samples import FloatArray
from core.session import Recording, Session
from core.signal.datasets import Datasets
from core.signal.pair import Pair, is_turning
from core.signal.robust import robust_sd
from core.signal.rotations import angle_between
from core.signal.sensors import SensorTracks
from core.verdicts.quality import look_at

MOST_SETS = 6000  # ten minutes of data sets (eq 2)


@dataclass(frozen=True, slots=True)
class IdentifyingMotion:
    """How much the motion showed that the joint was found from.

    `sets` is the number of data sets of eq 2 (one each tenth of a second while something moves), `moving_s` how long
    that is; `about_rad_s` the root mean square of the joint's own rate about its axis, `across_rad_s` that of the
    length of eq 3, the turning of both segments across the axis, without which eq 3 determines nothing.
    """

    sets: int
    moving_s: float
    about_rad_s: float
    across_rad_s: float


@dataclass(frozen=True, slots=True)
class JointDiagnostics:
    """One joint: its Figures 3, 4 and 6, and the figures that stand beside them.

    `from_recordings` identified the joint, `walk` is the recording of the angles. `published_apart_rad` is how far the
    paper's own minimum of eq 6, over both axes at once, lies from the axes in use, the larger of the two.
    `off_axis_rate_rad_s` is what the joint does beside its axis in `walk`, per direction (NaN: unknown).
    `bias_drift_rad_s` is by how much eq 11 would drift, had the gyroscopes' biases not been taken off; None where they
    are not known. `lag_cost_ratio` is the cost of the accelerations without a lag over that with the best one.
    """

    joint: Joint
    walk: str
    calibration: JointCalibration
    from_recordings: tuple[str, ...]
    excitation: IdentifyingMotion
    costs: tuple[CostOverSphere, CostOverSphere]
    published_apart_rad: float
    projected: ProjectedRates | None
    ways: TwoWays
    off_axis_rate_rad_s: float
    bias_drift_rad_s: float | None
    lag_cost_ratio: float | None

    def clinical(self, alpha_rad: FloatArray) -> FloatArray:
        """Angles of eqs 11 to 15 (n,) as flexion or dorsiflexion with the zero in force, by whole turns near zero."""
        found = self.calibration
        fused = found.clinical_sign * (-self.ways.fused_rad - found.zero_rad) + found.offset_rad
        turns = np.round(np.nanmedian(fused) / (2 * np.pi)) if np.isfinite(fused).any() else 0.0
        turned = found.clinical_sign * (-alpha_rad - found.zero_rad) + found.offset_rad
        return np.asarray(turned - 2 * np.pi * turns)


def diagnostics_of(
    session: Session, calibration: JointCalibration, recording_name: str, tau_s: float = DEFAULT_TAU_S
) -> JointDiagnostics | None:
    """Show how the joint of `calibration` was found and measured in one recording; None where it holds no motion of it.

    Parameters
    ----------
    calibration
        The joint's, as `analyse` found it for that recording.
    tau_s
        Time constant of the paper's fusion (eq 15).

    Returns
    -------
    JointDiagnostics or None
        Angles in rad, rates in rad/s, axes in sensor axes.
    """
    span = next((s for s in spans_of_validity(session) if any(r.name == recording_name for r in s)), None)
    if span is None:
        return None
    recording = next(r for r in span if r.name == recording_name)
    joint = calibration.joint
    tracks, _ = tracks_of_kind(session, span, look_at(session).unusable)
    if not tracks.is_usable(recording, joint.proximal, joint.distal):
        return None
    basis = basis_of(span, recording, joint, tracks.is_usable)
    found = identify(
        tracks, basis, calibration.method, tau_s, _knee_above(tracks, recording, basis, calibration, tau_s)
    )
    if found is None:
        return None
    geometry = found.geometry
    seen = _seen(tracks, found)
    data = moving_data(seen)
    if data is None:
        return None
    sets = data_sets(data).thinned(MOST_SETS)
    moved_s = clock_moved_s(tracks, recording, found) if found.robust and found.recordings != (recording.name,) else 0.0
    lag_s = geometry.lag_s + moved_s
    block = tracks.blocks(recording)[0]
    walked = tuple(pair for pair in pairs_of(tracks, recording, joint, block, lag_s) if is_anchored(pair))
    j1, j2 = geometry.axis_1, geometry.axis_2
    ways = two_ways(walked, j1, j2, geometry.centre_1_m, geometry.centre_2_m, tau_s)
    return JointDiagnostics(
        joint=joint,
        walk=recording.name,
        calibration=calibration,
        from_recordings=found.recordings,
        excitation=_excitation(sets, data, j1, j2),
        costs=costs_of_both(sets, j1, j2),
        published_apart_rad=_published_apart(sets, j1, j2),
        projected=projected_rates(seen, j1, j2),
        ways=ways,
        off_axis_rate_rad_s=_off_axis_rate(walked, geometry),
        bias_drift_rad_s=_bias_drift(calibration),
        lag_cost_ratio=found.lag.cost_ratio if found.lag else None,
    )


def _knee_above(
    tracks: SensorTracks, recording: Recording, ankle: Basis, calibration: JointCalibration, tau_s: float
) -> Identified | None:
    """The knee that helps an ankle; None where it cannot be identified, and of knees."""
    knee = knee_of(ankle.joint.side)
    if ankle.joint.is_knee or not tracks.is_usable(recording, knee.proximal, knee.distal):
        return None
    return identify(tracks, basis_of(tracks.span, recording, knee, tracks.is_usable), calibration.method, tau_s)


def _seen(tracks: SensorTracks, found: Identified) -> tuple[Pair, ...]:
    """The stretches that identified the joint, the distal clock brought to the proximal one."""
    joint = found.basis.joint
    identifying: list[Recording] = [r for r in tracks.span if r.name in found.recordings]
    return tuple(
        pair
        for recording in identifying
        for pair in pairs_of(tracks, recording, joint, tracks.blocks(recording)[0], found.geometry.lag_s)
    )


def _excitation(sets: Datasets, data: Datasets, j1: FloatArray, j2: FloatArray) -> IdentifyingMotion:
    about = sets.g1 @ j1 - sets.g2 @ j2
    lengths = [np.linalg.norm(np.cross(g, j), axis=1) for g, j in ((sets.g1, j1), (sets.g2, j2))]
    step_s = [data.pairs[int(s)].step_s for s in data.stretch]
    return IdentifyingMotion(
        sets=len(sets),
        moving_s=float(np.sum(step_s)),
        about_rad_s=float(np.sqrt(np.mean(about**2))),
        across_rad_s=float(np.sqrt(np.mean(np.concatenate(lengths) ** 2))),
    )


def _published_apart(sets: Datasets, j1: FloatArray, j2: FloatArray) -> float:
    """The axes are known up to their signs, so at most a right angle."""
    apart = [angle_between(*pair) for pair in zip(identify_axes(sets.g1, sets.g2), (j1, j2), strict=True)]
    return max(min(angle, np.pi - angle) for angle in apart)


def _off_axis_rate(pairs: tuple[Pair, ...], geometry: Geometry) -> float:
    seen = []
    for pair in pairs:
        heading = heading_over(pair, geometry.axis_1, geometry.axis_2, geometry.unknowns)
        is_seen = is_turning(pair.g1, pair.g2) & pair.is_measured
        seen.append(off_axis_rate(pair, geometry.axis_1, heading)[is_seen].ravel())
    return robust_sd(np.concatenate(seen)) if seen else float("nan")


def _bias_drift(calibration: JointCalibration) -> float | None:
    proximal, distal = calibration.gyro_bias_proximal_rad_s, calibration.gyro_bias_distal_rad_s
    if proximal is None or distal is None:
        return None
    return float(proximal @ calibration.axis_proximal - distal @ calibration.axis_distal)

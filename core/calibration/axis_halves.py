"""Whether a joint's axes come out alike in two parts of the data, and what it would change of the walk if not.

An ankle that hardly moves turns about several axes, and which of them are found then depends on the strides that are
looked at. Its formal standard deviation does not show that, for each part is sure of its own answer. So either part is
identified by itself, never starting with what was found of both.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from core.angles.hinge_angle import hinge_angle
from core.angles.measure import Geometry, is_anchored, pairs_of
from core.angles.twist import twist
from core.body import Joint, Side
from core.calibration import certainty
from core.calibration.calibrated import standing_twist_of
from core.calibration.heading import heading_over, residual_scales
from core.calibration.identified import Identified, downs_of, walked_axes
from core.calibration.identify import (
    AXIS_SAMPLES,
    MIN_MOVING_S,
    POLISH_STEPS,
    axis_covariance,
    decide,
    moving_data,
)
from core.calibration.joint_axis import polish
from core.calibration.validity import Basis
from core.gait.cycles import POINTS, cycles_of
from core.gait.strides import Strides
from core.gait.walking import joint_parameters
from core.prosthesis import JointNature
from core.results import AxisHalves, SideGait
from core.samples import FloatArray
from core.session import Recording
from core.signal.datasets import Datasets
from core.signal.pair import Pair
from core.signal.rotations import angle_between
from core.signal.sensors import SensorTracks
from core.span import JointAnalysis, SpanAnalysis

MOST_STRIDES = 20
OFF_PLANE_RAD = np.deg2rad(15.0)  # motion off the plane of flexion, of which an axis that is off leaks its share


@dataclass(frozen=True, slots=True)
class AxesOfPart:
    """Unit axes (3,) of both sensors as a part of the data gives them, and their formal standard deviation."""

    axis_1: FloatArray
    axis_2: FloatArray
    sd_rad: float


Parts = tuple[AxesOfPart, AxesOfPart]


@dataclass(slots=True)
class AxesOfParts:
    """The axes of each joint of a span in two parts of its data, found once for all walks that they hold for."""

    span: SpanAnalysis
    _known: dict[Basis, Parts | None] = field(default_factory=dict)

    def of(self, joint: JointAnalysis) -> Parts | None:
        """None where a part holds too little movement."""
        if joint.basis not in self._known:
            self._known[joint.basis] = _axes_of_parts(self.span, joint)
        return self._known[joint.basis]


def axis_halves_in(parts: AxesOfParts, walk: Recording, gait: Mapping[Side, SideGait]) -> dict[Joint, AxisHalves]:
    """Compare the axes of two parts and what they change in a walk; joints with little movement are missing."""
    halves = {}
    for joint, found in parts.span.joints_in(walk).items():
        axes = parts.of(found)
        if axes is None:
            continue
        spread = _spread(parts.span, walk, found, axes, gait[joint.side].strides) if joint.side in gait else {}
        sd_rad = float(np.sqrt(np.mean([part.sd_rad**2 for part in axes])))
        halves[joint] = AxisHalves(_apart_rad(axes), sd_rad, _is_free_motion_asked(parts.span, found), spread)
    return halves


def _is_free_motion_asked(span: SpanAnalysis, joint: JointAnalysis) -> bool:
    """Whether a free motion is compared with the walks: hands cannot bend a foot without a joint, only walking does."""
    nature = span.tracks.session.patient.nature_of(joint.basis.joint)
    return joint.basis.free_motion is not None and nature is not JointNature.RIGID


def _axes_of_parts(span: SpanAnalysis, joint: JointAnalysis) -> Parts | None:
    """Of the halves of the walks; with a free motion, of that and of the walks. None where one holds too little."""
    basis, tracks, found = joint.basis, span.tracks, joint.identified
    knee = joint.knee.identified if joint.knee else None
    walked = _moving(span, joint, basis.walks)
    if walked is None:
        return None
    if basis.free_motion is not None and _is_free_motion_asked(span, joint):
        free = _moving(span, joint, (basis.free_motion,))
        return None if free is None else (_axes(tracks, found, None, free, False), _axes(tracks, found, knee, walked))
    half = len(walked) // 2
    halves = [walked.only(index) for index in (np.arange(half), np.arange(half, len(walked)))]
    if any(_duration_s(part) < MIN_MOVING_S for part in halves):
        return None
    one, two = (_axes(tracks, found, knee, part) for part in halves)
    return one, two


def _moving(span: SpanAnalysis, joint: JointAnalysis, names: tuple[str, ...]) -> Datasets | None:
    """Samples of the first blocks, as in the identification, until a strap slips."""
    pairs, of, tracks = list[Pair](), joint.basis.joint, span.tracks
    for recording in tracks.span:
        if recording.name in names:
            first = pairs_of(tracks, recording, of, tracks.blocks(recording)[0], span.lag_s(recording.name, of))
            end_s = span.slipped_s.get((recording.name, of.side), np.inf)
            pairs += [_until(pair, end_s) if pair.time_s[-1] > end_s else pair for pair in first]
    return moving_data(tuple(pairs))


def _until(pair: Pair, end_s: float) -> Pair:
    return replace(pair, is_known=pair.is_known & (pair.time_s < end_s))


def _duration_s(data: Datasets) -> float:
    counts = np.bincount(data.stretch, minlength=len(data.pairs))
    return float(sum(count * pair.step_s for count, pair in zip(counts, data.pairs, strict=True)))


def _axes(
    tracks: SensorTracks, found: Identified, knee: Identified | None, data: Datasets, is_walked: bool = True
) -> AxesOfPart:
    """As the identification would have them of these data alone."""
    downs = downs_of(tracks, found.basis)
    decision = decide(data, downs)
    some = data.thinned(AXIS_SAMPLES)
    steps = POLISH_STEPS if decision.did_flexion_dominate else 0
    fit = polish(some, decision.best, steps, *residual_scales(some, decision.best))
    covariance = axis_covariance(some, fit, residual_scales(some, fit))
    axes = fit.axis_1[0], fit.axis_2[0]
    if is_walked and decision.did_flexion_dominate and not (found.basis.joint.is_knee or found.is_hinge):
        axes = walked_axes(axes, found.basis, data, knee, downs).axes
    return AxesOfPart(*axes, certainty.axis_sd_rad(covariance, 0.0))


def _apart_rad(parts: Parts) -> float:
    """The angle between the lines of both parts' axes, of the sensor at which it is larger."""
    one, two = parts
    apart = [angle_between(*pair) for pair in ((one.axis_1, two.axis_1), (one.axis_2, two.axis_2))]
    return max(min(angle, np.pi - angle) for angle in apart)


def _spread(
    span: SpanAnalysis, walk: Recording, joint: JointAnalysis, parts: Parts, strides: Strides
) -> dict[str, float]:
    """Half of what a walk's means differ by with either part's axes, beyond chance, rad, by the parameter's name."""
    # half, for the axes in use lie between those of both parts; each angle counts from its own zero
    tracks, found, of = span.tracks, joint.identified, joint.basis.joint
    offset_s, sign = span.offset_s(walk, of.proximal), joint.calibration.clinical_sign
    pairs = pairs_of(tracks, walk, of, tracks.blocks(walk)[0], joint.lags_s[walk.name])
    pairs = [pair for pair in pairs if is_anchored(pair)]
    used = np.flatnonzero(strides.is_used)
    used = used[np.linspace(0, len(used) - 1, min(MOST_STRIDES, len(used))).astype(np.int64)]
    within_s = strides.start_s[used] - offset_s, strides.end_s[used] - offset_s
    means = [_means(tracks, pairs, found, _alike(part, found.geometry), within_s, sign) for part in parts]
    chance = 0.5 * OFF_PLANE_RAD**2 * float(np.mean([part.sd_rad**2 for part in parts]))
    return {
        name: float(np.sqrt(max(0.0, 0.25 * (first - means[1][name]) ** 2 - chance)))
        for name, first in means[0].items()
        if np.isfinite(first - means[1].get(name, np.nan))
    }


def _alike(part: AxesOfPart, geometry: Geometry) -> Geometry:
    """The geometry with a part's axes, which have no sign of their own, on the side of those in use."""
    one, two = (
        axis * (1.0 if axis @ known >= 0.0 else -1.0)
        for axis, known in ((part.axis_1, geometry.axis_1), (part.axis_2, geometry.axis_2))
    )
    return replace(geometry, axis_1=one, axis_2=two)


def _means(
    tracks: SensorTracks,
    pairs: list[Pair],
    found: Identified,
    geometry: Geometry,
    within_s: tuple[FloatArray, FloatArray],
    clinical_sign: int,
) -> dict[str, float]:
    """Means over some strides by some axes, rad, NaN where there are none."""
    cycles = np.full((len(within_s[0]), POINTS), np.nan)
    for pair in pairs:
        time_s, angle_rad = _angle(pair, geometry, within_s)
        here = cycles_of(time_s, angle_rad, *within_s)
        cycles = np.where(np.isfinite(here), here, cycles)
    known = cycles[np.isfinite(cycles).all(axis=1)]
    zero_rad = standing_twist_of(tracks, found.basis, geometry)
    if zero_rad is None:
        zero_rad = float(np.median(known)) if len(known) else 0.0
    # a whole turn is no difference
    turned = clinical_sign * (known - zero_rad)
    turned -= 2 * np.pi * np.round(np.median(turned, axis=1, keepdims=True) / (2 * np.pi))
    values = joint_parameters({found.basis.joint: turned}) if len(turned) else {}
    return {
        name: float(np.nanmean(of_strides)) for name, of_strides in values.items() if _is_known_angle(name, of_strides)
    }


def _is_known_angle(name: str, of_strides: FloatArray) -> bool:
    return name.endswith("_rad") and bool(np.isfinite(of_strides).any())


def _angle(pair: Pair, geometry: Geometry, within_s: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Instants and the bare twist there, rad: of a hinge at all samples of a stretch, else around some strides."""
    one, two = geometry.axis_1, geometry.axis_2
    if geometry.is_hinge:
        return pair.time_s, hinge_angle(pair, one, two, geometry.unknowns)
    counts = np.zeros(len(pair) + 1, dtype=np.int64)
    np.add.at(counts, np.searchsorted(pair.time_s, within_s[0] - pair.step_s), 1)
    np.add.at(counts, np.searchsorted(pair.time_s, within_s[1] + 2 * pair.step_s), -1)
    near = np.flatnonzero(np.cumsum(counts)[:-1] > 0)
    heading = heading_over(pair, one, two, geometry.unknowns)
    some = replace(pair, earth_from_1=pair.earth_from_1[near], earth_from_2=pair.earth_from_2[near])
    return pair.time_s[near], twist(some, one, two, heading[near])

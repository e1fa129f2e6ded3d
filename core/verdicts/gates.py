"""The gates that a recording passes: from what was measured to a verdict per joint, leg and kind of quantity.

Limits are in `LIMITS`, each with its reason; those of clocks and signs stand where these are measured. A reason in a
verdict carries the value found beside its limit.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from core.body import Joint, Segment, Side, Site, ankle_of, hip_of, knee_of
from core.calibration.clinical_sign import MIN_MARGIN
from core.calibration.same_joint import most_disagreement
from core.gait.clocks import CARE_S, READ_S, ClockGate, LegClocks
from core.gait.cycles import mean_cycle, range_of_cycles
from core.hip.results import HipIdentification
from core.results import Analysis, JointCalibration, RecordingAnalysis, SideGait, ZeroKind
from core.samples import FloatArray
from core.session import RecordingKind
from core.verdicts.model import (
    NOT_MEASURED,
    READ,
    TOE_OFF_GATE,
    Assessment,
    GateReason,
    JointVerdicts,
    LegVerdicts,
    Verdict,
    Verdicts,
    assess,
)
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN, MIN_STRIDES_FOR_SD
from core.verdicts.sample_gates import clipped, closed, known_or_none, lost, off_rate


@dataclass(frozen=True, slots=True)
class GateLimits:
    """Where each gate closes. Of a pair the first is where caution begins, the second where nothing is reported."""

    pairing_margin: float = 1.5  # of the best hypothesis over its best rival, in motion below 4 Hz
    axis_sd_deg: tuple[float, float] = (6.5, 9.0)  # 15 deg of motion off the plane leak 15 sin sd: 1.7 and 2.3 deg
    axis_halves_deg: tuple[float, float] = (10.0, 25.0)  # ranges differ by 2.6, 4.9 and beyond by 10 deg (54 legs)
    # a person's axes in walking are 6 deg from those in free motion, which is 4 deg off: 3 sd of both are no fault
    axis_motions_deg: tuple[float, float] = (24.0, 33.0)
    lag_sd_ms: tuple[float, float] = (2.0, 10.0)  # 400 deg/s for 10 ms are 4 deg
    knee_range_deg: tuple[float, float] = (5.0, 90.0)  # walking knees 62 +- 4, stiff ones to 5
    ankle_range_deg: tuple[float, float] = (3.0, 60.0)  # walking ankles 25 +- 5
    hip_range_deg: tuple[float, float] = (5.0, 90.0)  # walking hips 40 to 58, stiff ones less
    hip_disagreement: float = 0.2  # hips 0.07 to 0.08, of pelvis and shank 0.54
    hip_centre_m: tuple[float, float] = (0.05, 0.4)
    hips_apart_m: tuple[float, float] = (0.12, 0.28)
    hip_heading_sd_deg: float = 6.0  # of abduction: beyond, it is a part of flexion
    hip_deep_deg: float = 80.0  # deeper, the sensor on the sacrum shows half of the pelvis's tilt
    pelvis_tilt_deg: float = 5.0  # over the stride: less is not distinguished from an error of 0.4 to 1.4
    knee_least_deg: float = -20.0
    ankle_height_deg: tuple[float, float] = (-45.0, 40.0)
    halves_deg: float = 2.0
    halves_stance_points: float = 1.5
    halves_time_percent: float = 4.0
    thirds_deg: float = 3.0
    odd_even_ratio: float = 3.0
    lost_percent: tuple[float, float] = (1.0, 5.0)  # of the time of the strides used, in gaps over 50 ms
    clipped_percent: tuple[float, float] = (0.0, 20.0)  # of the strides used; +-2 g at a foot shortens them by 15 %
    rate_percent: tuple[float, float] = (2.0, 10.0)  # off the rate that was set
    stance_percent: tuple[float, float] = (40.0, 85.0)
    stride_length_percent: float = 5.0
    speed_m_s: tuple[float, float] = (0.1, 2.5)


LIMITS = GateLimits()
HIP_NOT_FOUND = JointVerdicts(*[assess([GateReason("hip_found", Verdict.NOT_REPORTED)])] * 3)
OF_COURSE = ("halves", "halves_time", "drift")  # gates of what changes over a walk
MIN_STRIDES_TO_SPLIT = 6  # halves of three strides, thirds of two: fewer say nothing of a walk's course


def verdicts_of(
    recording: RecordingAnalysis, calibrated: Mapping[Joint, JointCalibration], stiff_sides: Collection[Side]
) -> Verdicts:
    """Make one recording's verdicts; stiff sides are those where a joint that hardly bends is expected."""
    joints = {
        joint: _joint_verdicts(recording, joint, calibrated[joint], joint.side in stiff_sides)
        for joint in recording.joints
        if joint in calibrated
    }
    joints |= {joint: _hip_verdicts(recording, joint, calibrated.get(knee_of(joint.side))) for joint in recording.hips}
    joints |= {joint: HIP_NOT_FOUND for joint in _worn_hips(recording) if joint not in recording.hips}
    pelvis = assess(_pelvis(recording)) if recording.pelvis is not None else NOT_MEASURED
    abduction = {joint.side: assess(_heading(hip.identification)) for joint, hip in recording.hips.items()}
    if recording.kind is not RecordingKind.WALKING:
        return Verdicts(joints, pelvis=pelvis, abduction=abduction)
    legs = {side: _leg_verdicts(recording, side, calibrated) for side in recording.gait}
    tilt = assess([*pelvis.reasons, *_tilt_range(recording)]) if recording.pelvis is not None else NOT_MEASURED
    return Verdicts(joints, legs, _between(recording), pelvis, tilt, abduction)


def calibration_verdicts(calibration: JointCalibration) -> JointVerdicts:
    """What may be stated about a joint by its calibration alone, before there is a walk."""
    shape = [*_calibrated(calibration)]
    sign = [*_sign(calibration)]
    return JointVerdicts(assess(shape), assess([*shape, *_zero(calibration), *sign]), assess(sign))


def judged(analysis: Analysis) -> Analysis:
    """The same analysis with every recording's verdicts made again."""
    recordings = tuple(
        replace(one, verdicts=verdicts_of(one, analysis.calibrated_for(one), analysis.stiff_sides))
        for one in analysis.recordings
    )
    return replace(analysis, recordings=recordings)


def _joint_verdicts(
    recording: RecordingAnalysis, joint: Joint, calibration: JointCalibration, may_be_stiff: bool
) -> JointVerdicts:
    shape = [
        *_labels(recording, joint.proximal, joint.distal),
        *_calibrated(calibration),
        *_axis_halves(recording, joint),
        *_delivered(recording, joint.proximal, joint.distal),
        *_drifting(recording, Verdict.NOT_REPORTED, joint.proximal, joint.distal),
    ]
    height = [*shape, *_zero(calibration), *_sign(calibration)]
    gait = recording.gait.get(joint.side)
    if recording.kind is RecordingKind.WALKING and gait is not None and joint in gait.cycles:
        cycles = np.rad2deg(gait.cycles[joint][gait.strides.is_used])
        cycles = cycles[np.isfinite(cycles).all(axis=1)]
        of_strides = [*_slip(recording, joint.side), *_strides(len(cycles))]
        ranges = range_of_cycles(cycles)
        of_strides += [*_plausible_range(joint, ranges, may_be_stiff), *_steady(ranges, LIMITS.halves_deg, "deg")]
        shape += [*of_strides, *_drift(ranges)]
        height += [*of_strides, *_drift(ranges), *_drift(cycles.mean(axis=1))]
        height += _plausible_height(joint, cycles, calibration)
    shape, height = _without_course(recording, shape), _without_course(recording, height)
    return JointVerdicts(assess(shape), assess(height), assess(_sign(calibration)))


def _without_course(recording: RecordingAnalysis, reasons: Iterable[GateReason]) -> list[GateReason]:
    """In a timed test its course is what is measured, and no reason for care."""
    return [one for one in reasons if recording.timed is None or one.gate not in OF_COURSE]


def _hip_verdicts(recording: RecordingAnalysis, joint: Joint, knee: JointCalibration | None) -> JointVerdicts:
    """A hip has no axis of its own: its frames lean on the knee's, its sign on the knee's sign."""
    of_knee = [*_pairing(knee), *_axis(knee)] if knee is not None else [GateReason("axis", Verdict.NOT_REPORTED)]
    of_knee += _axis_halves(recording, knee_of(joint.side))
    shape = [
        *_labels(recording, joint.proximal, joint.distal),
        *_adjacent(recording.hips[joint].identification),
        *of_knee,
        *_delivered(recording, joint.proximal, joint.distal),
        *_drifting(recording, Verdict.NOT_REPORTED, joint.proximal, joint.distal),
    ]
    sign = [*_sign(knee)] if knee is not None else []
    gait = recording.gait.get(joint.side)
    if recording.kind is RecordingKind.WALKING and gait is not None:
        ranges = np.rad2deg(gait.parameters["hip_range_rad"][gait.strides.is_used])
        ranges = ranges[np.isfinite(ranges)]
        shape += [*_slip(recording, joint.side), *_strides(len(ranges))]
        shape += [*_plausible_range(joint, ranges, may_be_stiff=True), *_steady(ranges, LIMITS.halves_deg, "deg")]
        shape += _drift(ranges)
    return JointVerdicts(assess(shape), assess([*shape, *sign]), assess(sign))


def _worn_hips(recording: RecordingAnalysis) -> list[Joint]:
    """The hips that have a sensor on either side of them, whether they could be found or not."""
    worn = recording.received
    return [hip_of(side) for side in Side if Site.PELVIS in worn and hip_of(side).distal in worn]


def _heading(found: HipIdentification) -> Iterator[GateReason]:
    """Without a sure heading between pelvis and thigh there is flexion, against the vertical, but no abduction."""
    sd_deg = known_or_none(float(np.rad2deg(found.heading_sd_rad)))
    if sd_deg is None or sd_deg > LIMITS.hip_heading_sd_deg:
        yield GateReason("hip_heading", Verdict.NOT_REPORTED, sd_deg, LIMITS.hip_heading_sd_deg, "deg")


def _adjacent(found: HipIdentification) -> Iterator[GateReason]:
    """Whether pelvis and thigh moved as adjacent segments, at lengths that a body has, the legs not swapped."""
    if found.margin < LIMITS.pairing_margin:
        yield GateReason("pairing", Verdict.NOT_REPORTED, found.margin, LIMITS.pairing_margin)
    if found.disagreement >= LIMITS.hip_disagreement:
        yield GateReason("hip_disagreement", Verdict.NOT_REPORTED, found.disagreement, LIMITS.hip_disagreement)
    for centre_m in (found.centre_proximal_m, found.centre_distal_m):
        yield from _outside("hip_centre", float(np.linalg.norm(centre_m)), LIMITS.hip_centre_m, "m")
    if found.centres_apart_m is not None:
        yield from _outside("hips_apart", found.centres_apart_m, LIMITS.hips_apart_m, "m")


def _pelvis(recording: RecordingAnalysis) -> Iterator[GateReason]:
    """The pelvis's frame comes from the hips: where no hip can be read, it has none."""
    yield from _delivered(recording, Site.PELVIS)
    trusted = [hip for hip in recording.hips.values() if not [*_adjacent(hip.identification)]]
    if not trusted:
        yield GateReason("pairing", Verdict.NOT_REPORTED, None, LIMITS.pairing_margin)
    arrived = [hip.angle_rad[np.isfinite(hip.angle_rad)] for hip in recording.hips.values()]
    deepest_deg = max((float(np.rad2deg(angle.max())) for angle in arrived if len(angle)), default=0.0)
    if deepest_deg > LIMITS.hip_deep_deg:
        yield GateReason("hip_deep", Verdict.CARE, deepest_deg, LIMITS.hip_deep_deg, "deg")


def _tilt_range(recording: RecordingAnalysis) -> Iterator[GateReason]:
    ranges = [gait.parameters["pelvis_tilt_range_rad"][gait.strides.is_used] for gait in recording.gait.values()]
    known = np.rad2deg(np.concatenate([one[np.isfinite(one)] for one in ranges])) if ranges else np.empty(0)
    if len(known) and float(known.mean()) <= LIMITS.pelvis_tilt_deg:
        yield GateReason("pelvis_tilt", Verdict.NOT_REPORTED, float(known.mean()), LIMITS.pelvis_tilt_deg, "deg")


def _leg_verdicts(
    recording: RecordingAnalysis, side: Side, calibrated: Mapping[Joint, JointCalibration]
) -> LegVerdicts:
    gait, strides = recording.gait[side], recording.gait[side].strides
    used = strides.is_used
    shared = [*_slip(recording, side), *_strides(int(np.count_nonzero(used)))]
    ankle = calibrated.get(ankle_of(side))
    if ankle is not None and ankle_of(side) in recording.joints:  # its foot sensor may not be on this foot
        shared += [GateReason(r.gate, Verdict.CARE, r.value, r.limit, r.unit) for r in _pairing(ankle)]
    shared += _events(gait)
    foot = Site(f"{side}_{Segment.FOOT}")
    shared += _labels(recording, foot)
    timing = [*shared, *_steady_times(gait), *_drifting(recording, Verdict.CARE, foot)]
    if gait.is_toe_off_biased:
        timing.append(GateReason(TOE_OFF_GATE, Verdict.CARE))
    distance = [*shared, *lost(recording, LIMITS.lost_percent, foot)]
    distance += [*clipped(recording, LIMITS.clipped_percent, [foot], [foot]), *_equal_lengths(recording), *_speed(gait)]
    has_length = bool(np.isfinite(strides.length_m[used]).any())
    timing = _without_course(recording, timing)
    return LegVerdicts(assess(timing), assess(distance) if has_length or not used.any() else NOT_MEASURED)


# joints


def _labels(recording: RecordingAnalysis, *sites: Site) -> Iterator[GateReason]:
    """A joint of which a sensor sits elsewhere may still look like one: thigh and foot turn about parallel axes too."""
    if not recording.doubted_sites.isdisjoint(sites):
        doubted = tuple(site for site in Site if site in recording.doubted_sites)
        yield GateReason("labels", Verdict.NOT_REPORTED, sites=doubted)


def _calibrated(found: JointCalibration) -> Iterator[GateReason]:
    yield from dict.fromkeys((*_pairing(found), *_axis(found), *_lag(found)))  # a lag may decide two of them


def _pairing(found: JointCalibration) -> Iterator[GateReason]:
    """Whether both sensors sit on one joint; the reason is the one of three that decided it."""
    margin, disagreement = found.sign_margin, found.disagreement
    if margin is not None and margin < LIMITS.pairing_margin:
        yield GateReason("pairing", Verdict.NOT_REPORTED, margin, LIMITS.pairing_margin)
    elif not found.is_same_joint:
        most = most_disagreement(margin)
        if disagreement is not None and most is not None and disagreement > most:
            yield GateReason("disagreement", Verdict.NOT_REPORTED, disagreement, most)
        elif found.is_lag_at_border:
            yield GateReason("lag", Verdict.NOT_REPORTED, None, LIMITS.lag_sd_ms[1], "ms")
        else:
            yield GateReason("pairing", Verdict.NOT_REPORTED, None, LIMITS.pairing_margin)


def _axis(found: JointCalibration) -> Iterator[GateReason]:
    sd_deg = None if found.axis_sd_rad is None else float(np.rad2deg(found.axis_sd_rad))
    yield from closed("axis", sd_deg, LIMITS.axis_sd_deg, "deg")


def _axis_halves(recording: RecordingAnalysis, joint: Joint) -> Iterator[GateReason]:
    """Whether two parts of the data, each by itself, show one axis: formally sure is not sure."""
    found = recording.axis_halves.get(joint)
    if found is None:
        return
    gate = "axis_motions" if found.is_free_motion else "axis_halves"
    limits = LIMITS.axis_motions_deg if found.is_free_motion else LIMITS.axis_halves_deg
    yield from closed(gate, float(np.rad2deg(found.apart_rad)), limits, "deg", joint)


def _lag(found: JointCalibration) -> Iterator[GateReason]:
    if not found.is_clock_shared:
        sd_ms = None if found.is_lag_at_border or found.lag_sd_s is None else 1000.0 * found.lag_sd_s
        yield from closed("lag", sd_ms, LIMITS.lag_sd_ms, "ms")


def _sign(found: JointCalibration) -> Iterator[GateReason]:
    if not found.is_sign_certain:
        yield GateReason("sign", Verdict.NOT_REPORTED, _below(found.clinical_sign_margin, MIN_MARGIN), MIN_MARGIN)


def _zero(found: JointCalibration) -> Iterator[GateReason]:
    if found.zero is ZeroKind.NONE:
        yield GateReason("zero", Verdict.NOT_REPORTED)


def _slip(recording: RecordingAnalysis, side: Side) -> Iterator[GateReason]:
    """A slip that left strides is reported with these strides; after one that left none, nothing is reported."""
    from_s = recording.slipped_from_s.get(side)
    if from_s is not None and not recording.gait[side].strides.is_used.any():
        yield GateReason("strap", Verdict.NOT_REPORTED)
    elif from_s is not None:
        yield GateReason("strap", Verdict.CARE, from_s, None, "s")


def _delivered(recording: RecordingAnalysis, *sites: Site) -> Iterator[GateReason]:
    """What the sensors of a joint delivered."""
    yield from lost(recording, LIMITS.lost_percent, *sites)
    yield from clipped(recording, LIMITS.clipped_percent, rates_of=sites)
    yield from off_rate(recording, LIMITS.rate_percent, *sites)


def _drifting(recording: RecordingAnalysis, verdict: Verdict, *sites: Site) -> Iterator[GateReason]:
    percent = max((abs(recording.drifting_percent.get(site, 0.0)) for site in sites), default=0.0)
    if percent:
        yield GateReason("clock_drift", verdict, percent, None, "%")


def _strides(used: int) -> Iterator[GateReason]:
    if used < MIN_STRIDES_FOR_MEAN:
        yield GateReason("strides", Verdict.NOT_REPORTED, used, MIN_STRIDES_FOR_MEAN)
    elif used < MIN_STRIDES_FOR_SD:
        yield GateReason("strides", Verdict.CARE, used, MIN_STRIDES_FOR_SD)


def _plausible_range(joint: Joint, ranges_deg: FloatArray, may_be_stiff: bool) -> Iterator[GateReason]:
    if not len(ranges_deg):
        return
    usual = float(np.median(ranges_deg))
    of_kind = {"hip": LIMITS.hip_range_deg, "knee": LIMITS.knee_range_deg, "ankle": LIMITS.ankle_range_deg}
    least, most = of_kind[joint.split("_")[1]]
    if usual < least:
        yield GateReason("plausible", Verdict.CARE if may_be_stiff else Verdict.NOT_REPORTED, usual, least, "deg")
    elif usual > most:
        yield GateReason("plausible", Verdict.NOT_REPORTED, usual, most, "deg")


def _plausible_height(joint: Joint, cycles_deg: FloatArray, found: JointCalibration) -> Iterator[GateReason]:
    if not len(cycles_deg) or found.zero is ZeroKind.NONE or not found.is_sign_certain:
        return
    mean = mean_cycle(cycles_deg).mean
    least, most = (LIMITS.knee_least_deg, np.inf) if joint.is_knee else LIMITS.ankle_height_deg
    for value, limit, is_beyond in (
        (float(mean.min()), least, mean.min() < least),
        (float(mean.max()), float(most), mean.max() > most),
    ):
        if is_beyond:
            yield GateReason("plausible_height", Verdict.NOT_REPORTED, value, limit, "deg")
            return


def _drift(values_deg: FloatArray) -> Iterator[GateReason]:
    """Whether the last third of a walk's strides (k,) is what the first was."""
    if len(values_deg) < MIN_STRIDES_TO_SPLIT:
        return
    third = len(values_deg) // 3
    apart = abs(float(values_deg[-third:].mean() - values_deg[:third].mean()))
    if apart > LIMITS.thirds_deg:
        yield GateReason("drift", Verdict.CARE, apart, LIMITS.thirds_deg, "deg")


# legs


def _events(gait: SideGait) -> Iterator[GateReason]:
    stance = gait.strides.stance_percent[gait.strides.is_used]
    stance = stance[np.isfinite(stance)]
    if len(stance):
        yield from _outside("events", float(np.median(stance)), LIMITS.stance_percent, "%")


def _steady_times(gait: SideGait) -> Iterator[GateReason]:
    used = gait.strides.is_used
    yield from _steady(gait.strides.stance_percent[used], LIMITS.halves_stance_points, "%")
    time_s = gait.strides.time_s[used]
    if len(time_s):
        yield from _steady(100.0 * time_s / float(np.mean(time_s)), LIMITS.halves_time_percent, "%", gate="halves_time")


def _equal_lengths(recording: RecordingAnalysis) -> Iterator[GateReason]:
    """In walking straight on, both feet travel equally far."""
    lengths = []
    for gait in recording.gait.values():
        known = gait.strides.length_m[gait.strides.is_used]
        known = known[np.isfinite(known)]
        if len(known) >= MIN_STRIDES_FOR_MEAN:
            lengths.append(float(known.mean()))
    if len(lengths) == len(Side):
        apart = 100.0 * abs(lengths[0] - lengths[1]) / max(float(np.mean(lengths)), 1e-9)
        if apart > LIMITS.stride_length_percent:
            yield GateReason("distance", Verdict.CARE, float(apart), LIMITS.stride_length_percent, "%")


def _speed(gait: SideGait) -> Iterator[GateReason]:
    speed = gait.strides.speed_m_s[gait.strides.is_used]
    speed = speed[np.isfinite(speed)]
    if len(speed):
        yield from _outside("speed", float(np.mean(speed)), LIMITS.speed_m_s, "m/s")


# both legs


def _between(recording: RecordingAnalysis) -> Assessment:
    clocks = recording.clocks
    if len(recording.gait) < len(Side) or clocks is None:
        return NOT_MEASURED
    if recording.drifting_percent:
        return assess(_drifting(recording, Verdict.NOT_REPORTED, *recording.drifting_percent))
    verdict = clocks_verdict(clocks)
    if verdict is Verdict.READ:
        return READ
    if clocks.gate is ClockGate.STEP_SHARE:
        limit = 50.0 + np.copysign(clocks.limit, clocks.value - 50.0)
        return assess([GateReason("step_share", verdict, clocks.value, float(limit), "%")])
    if clocks.gate is ClockGate.UNKNOWN and recording.leg_clock is not None:
        return assess([GateReason("leg_clock", verdict)])
    known = known_or_none(clocks.value)
    value_ms = None if known is None or clocks.gate is ClockGate.UNKNOWN else 1000.0 * known
    return assess([GateReason("clocks", verdict, value_ms, 1000.0 * clocks.limit, "ms")])


def clocks_verdict(clocks: LegClocks) -> Verdict:
    """What the clocks of both legs leave of what compares their instants."""
    if clocks.gate is not ClockGate.RESIDUAL or clocks.residual_s > CARE_S:
        return Verdict.NOT_REPORTED
    return Verdict.READ if clocks.residual_s <= READ_S else Verdict.CARE


# the course of a walk


def _steady(values: FloatArray, limit: float, unit: str, gate: str = "halves") -> Iterator[GateReason]:
    """Whether the halves of a walk agree, and whether every second stride differs as only a mistake does."""
    values = values[np.isfinite(values)]
    if len(values) < MIN_STRIDES_TO_SPLIT:
        return
    half = len(values) // 2
    apart = abs(float(values[-half:].mean() - values[:half].mean()))
    if apart > limit:
        yield GateReason(gate, Verdict.CARE, apart, limit, unit)
    odd, even = values[::2], values[1::2]
    error = float(np.sqrt(odd.var(ddof=1) / len(odd) + even.var(ddof=1) / len(even)))
    ratio = abs(float(odd.mean() - even.mean())) / max(error, 1e-9)
    if ratio > LIMITS.odd_even_ratio:
        yield GateReason("odd_even", Verdict.CARE, ratio, LIMITS.odd_even_ratio)


def _outside(gate: str, value: float, limits: tuple[float, float], unit: str) -> Iterator[GateReason]:
    """Nothing is reported of a value that no body has."""
    least, most = limits
    if not least <= value <= most:
        yield GateReason(gate, Verdict.NOT_REPORTED, value, least if value < least else most, unit)


def _below(margin: float | None, limit: float) -> float | None:
    """The margin where it is what closed the gate: beyond its limit it was something else, and no figure shows it."""
    known = known_or_none(margin)
    return known if known is not None and known < limit else None

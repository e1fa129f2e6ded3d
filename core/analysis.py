"""From a session to joint angles: look at the samples, identify every joint, measure every recording, turn and zero.

Read `analyse` and `_analyse_span` as a table of contents; each step is a module of its own.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from core.angles.measure import Twist, measure
from core.body import LEG_JOINTS, Joint, Segment, Side, Site, knee_of
from core.calibration import certainty
from core.calibration.axis_halves import AxesOfParts, axis_halves_in
from core.calibration.calibrated import calibrate
from core.calibration.clinical_sign import range_of
from core.calibration.identified import clock_moved_s, identify
from core.calibration.rate_kind import tracks_of_kind
from core.calibration.strap import slips_in_walks
from core.calibration.validity import Basis, basis_of, spans_of_validity
from core.calibration.zero import wrapped_to_zero
from core.findings import Finding, Severity
from core.gait.chosen_strides import leave_out
from core.gait.inclination import inclination
from core.gait.strides import Reason
from core.gait.walking import clocks_in, gait_in, site_of_events
from core.hip.analysis import find_hips, with_hips
from core.placement.labels import doubted_labels
from core.published.angles import DEFAULT_TAU_S
from core.results import (
    Analysis,
    Calibration,
    JointAngle,
    JointCalibration,
    Method,
    RecordingAnalysis,
    SideGait,
)
from core.samples import FloatArray
from core.session import Patient, Recording, RecordingKind, Session
from core.signal.clock_drift import about_clocks, clock_drifts
from core.signal.reception import Pause, receptions
from core.signal.robust import robust_sd
from core.signal.sensors import SensorTracks
from core.span import JointAnalysis, SpanAnalysis
from core.timed.protocols import DEFINITIONS
from core.timed.timing import time_test
from core.verdicts.gates import verdicts_of
from core.verdicts.joint_findings import about_angles, about_joint, about_missing_joints, about_session
from core.verdicts.quality import look_at
from core.verdicts.walk_findings import about_prosthesis, about_rigid_feet, about_turns, about_walk

Progress = Callable[[float, str], None]
"""Called with the share done (0 to 1) and what is being done. May raise to stop the analysis."""

# The first site present gives a recording its stamps (FORMATS, section 3).
CLOCK_ORDER = (
    Site.LEFT_THIGH,
    Site.LEFT_SHANK,
    Site.RIGHT_THIGH,
    Site.RIGHT_SHANK,
    Site.LEFT_FOOT,
    Site.RIGHT_FOOT,
)


def analyse(
    session: Session,
    method: Method = Method.ROBUST,
    tau_s: float = DEFAULT_TAU_S,
    progress: Progress | None = None,
) -> Analysis:
    """Identify every joint of `session` and compute its angles in every kept recording but standing.

    Parameters
    ----------
    session
        All recordings of one visit; what is odd about them becomes findings.
    method
        How the joints are identified and which angle is the result.
    tau_s
        Time constant of the fusion of Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, eq 15.
    progress
        Called with how far the analysis is; whatever it raises ends the analysis.

    Returns
    -------
    Analysis
        Calibrations per span of validity; angles in radians and gait per recording, NaN in gaps; findings. A joint that
        cannot be identified is missing, with a finding.

    Examples
    --------
    >>> walk = analyse(session).recordings[-1]
    >>> knee = walk.joints[Joint.LEFT_KNEE]
    >>> knee.angle_rad.shape == walk.time_s.shape
    True
    """
    quality = look_at(session)
    findings = [*session.findings, *about_session(session), *quality.findings]
    calibrations: list[Calibration] = []
    recordings: list[RecordingAnalysis] = []
    spans = spans_of_validity(session)
    for number, span in enumerate(spans):
        steps = _Steps(progress, number / len(spans), 1 / len(spans))
        tracks, noticed = tracks_of_kind(session, span, quality.unusable)
        by_walk, analysed, of_span = _analyse_span(session, tracks, quality.pauses, method, tau_s, steps)
        calibrations += by_walk
        recordings += analysed
        findings += [*noticed, *of_span]
    findings += about_missing_joints(session, quality.unusable, recordings)
    findings += [*about_prosthesis(recordings), *about_rigid_feet(session.patient.worn, recordings)]
    unique = {(f.key, f.where, tuple(sorted(f.numbers.items()))): f for f in findings}
    whole = Analysis(
        method=method,
        is_simulated=session.is_simulated,
        calibrations=tuple(calibrations),
        recordings=tuple(recordings),
        findings=tuple(unique.values()),
        affected_side=_affected_side(session.patient),
        stiff_sides=_stiff_sides(session.patient),
        prostheses=session.patient.worn,
    )
    return leave_out(whole, session.recordings)


def _analyse_span(
    session: Session,
    tracks: SensorTracks,
    pauses: Mapping[str, Sequence[Pause]],
    method: Method,
    tau_s: float,
    steps: "_Steps",
) -> tuple[list[Calibration], list[RecordingAnalysis], list[Finding]]:
    """Everything of one span: what every joint is, and the angles and gait of what moves."""
    doubted, drifts = doubted_labels(tracks), clock_drifts(tracks)
    findings = [*doubted.findings, *about_clocks(drifts)]
    span = SpanAnalysis(tracks, _bases(tracks), pauses, doubted.sites, drifts)
    steps.expect(len(set(span.bases.values())) + len(span.bases) + len(span.moving))
    _identify(span, method, tau_s, steps)
    findings += _find_lags(span)
    span.hips = find_hips(tracks)
    _measure(span, steps)
    calibrate(span, method)
    has_stood = any(r.is_kept and r.kind is RecordingKind.STANDING for r in session.recordings)
    for found in span.joints.values():
        joint = found.basis.joint
        turned, is_zero_typed = session.turned_sign.get(joint), joint in session.zero_rad
        findings += about_joint(found.calibration, found.identified, turned, is_zero_typed, has_stood)
    by_walk = _by_walk(span)
    findings += _find_slips(span, by_walk)
    recordings: list[RecordingAnalysis] = []
    parts = AxesOfParts(span)
    ringing_rad_s = {joint: span.ringing_rad_s(joint) for joint in LEG_JOINTS}
    for recording in span.moving:
        steps.tick(recording.name)
        analysed = _recording(span, recording, parts, ringing_rad_s)
        recordings.append(analysed)
        findings += [*about_angles(analysed), *about_turns(analysed)]
        findings += about_walk(analysed, {side: site_of_events(tracks, recording, side) for side in analysed.gait})
    return by_walk, recordings, findings


def _affected_side(patient: Patient) -> Side | None:
    """The side that symmetry compares with the sound one; None where none or both are affected."""
    stated = (patient.affected_side, patient.prosthetic_side)
    one = [side for side in stated if side in set(Side)]
    return Side(one[0]) if one and "both" not in stated else None


def _stiff_sides(patient: Patient) -> frozenset[Side]:
    affected = frozenset(side for side in Side if patient.affected_side in (side, "both"))
    return affected | patient.prosthetic_sides


class _Steps:
    """Counts what is done, for whoever watches."""

    def __init__(self, progress: Progress | None, first: float, share: float) -> None:
        self._progress, self._first, self._share = progress, first, share
        self._expected, self._done = 1, 0

    def expect(self, steps: int) -> None:
        self._expected = max(1, steps)

    def tick(self, what: str) -> None:
        if self._progress is not None:
            self._progress(self._first + self._share * min(1.0, self._done / self._expected), what)
        self._done += 1


def _bases(tracks: SensorTracks) -> dict[tuple[str, Joint], Basis]:
    return {
        (recording.name, joint): basis_of(tracks.span, recording, joint, tracks.is_usable)
        for recording in tracks.span
        for joint in LEG_JOINTS
        if recording.kind is not RecordingKind.STANDING and tracks.is_usable(recording, joint.proximal, joint.distal)
    }


def _identify(span: SpanAnalysis, method: Method, tau_s: float, steps: _Steps) -> None:
    """Every joint; knees first, since they help their ankles."""
    tried: set[Basis] = set()
    for name, joint in sorted(span.bases, key=lambda of: not of[1].is_knee):
        basis = span.bases[name, joint]
        if basis in tried:
            continue
        tried.add(basis)
        steps.tick(str(joint))
        knee = None if joint.is_knee else span.joint(name, knee_of(joint.side))
        found = identify(span.tracks, basis, method, tau_s, knee.identified if knee else None)
        if found is not None:
            span.joints[basis] = JointAnalysis(found, knee)


def _find_lags(span: SpanAnalysis) -> list[Finding]:
    """The lag of each joint in each recording; a finding where a recording has another than the identification."""
    findings = []
    for recording in span.moving:
        for joint, one in span.joints_in(recording).items():
            found, name = one.identified, recording.name
            one.lags_s[name] = found.geometry.lag_s
            if found.robust is not None and found.recordings != (name,):
                moved_s = clock_moved_s(span.tracks, recording, found)
                if moved_s:
                    one.lags_s[name] += moved_s
                    numbers = {"lag_ms": round(1000 * moved_s, 1)}
                    findings.append(Finding("clock_moved", Severity.WARNING, f"{name}, {joint}", numbers))
    return findings


def _measure(span: SpanAnalysis, steps: _Steps) -> None:
    for recording in span.moving:
        time_s = _clock_of(span.tracks, recording)
        for joint, one in span.joints_in(recording).items():
            steps.tick(recording.name)
            offset_s = span.offset_s(recording, joint.proximal)
            geometry = replace(one.identified.geometry, lag_s=one.lags_s[recording.name])
            one.twists[recording.name] = measure(span.tracks, recording, joint, geometry, time_s, offset_s)


def _clock_of(tracks: SensorTracks, recording: Recording) -> FloatArray:
    """Stamps of the first usable site."""
    for site in CLOCK_ORDER:
        if tracks.is_usable(recording, site):
            return recording.imu[site].time_s
    return np.empty(0)


def _by_walk(span: SpanAnalysis) -> list[Calibration]:
    """Walks that share the calibration of every joint; first, without walks, joints that only a free motion shows."""
    groups: dict[tuple[Basis, ...], list[str]] = {}
    for recording in span.walks or span.moving:
        bases = (span.bases.get((recording.name, joint)) for joint in LEG_JOINTS)
        key = tuple(basis for basis in bases if basis is not None)
        groups.setdefault(key, []).extend([recording.name] if span.walks else [])
    in_walks = {basis.joint for key in groups for basis in key}
    alone = {basis.joint: one.calibration for basis, one in span.joints.items() if basis.joint not in in_walks}
    by_walk = [
        Calibration(tuple(names), {b.joint: span.joints[b].calibration for b in key if b in span.joints})
        for key, names in groups.items()
    ]
    return [*([Calibration((), alone)] if alone else []), *by_walk]


def _recording(
    span: SpanAnalysis, recording: Recording, parts: AxesOfParts, ringing_rad_s: Mapping[Joint, float | None]
) -> RecordingAnalysis:
    """Angles and gait of one recording, and what of them may be stated."""
    tracks, name, is_walk = span.tracks, recording.name, recording.kind is RecordingKind.WALKING
    found, time_s = span.joints_in(recording), _clock_of(span.tracks, recording)
    joints: dict[Joint, JointAngle] = {}
    leaning: dict[Site, FloatArray] = {}
    for joint, one in found.items():
        measured = one.twists.pop(name)  # of hours, no second copy is held
        joints[joint] = _angle(one.calibration, measured, ringing_rad_s[joint])
        if is_walk and joint.is_knee:
            leaning |= _inclinations(tracks, one.calibration, measured)
    test = recording.test if is_walk else None
    gait: dict[Side, SideGait] = {}
    if is_walk and (test is None or DEFINITIONS[test.protocol].is_walked):
        gait = _gait(span, recording, time_s, joints, leaning)
    nominal_hz = {site: info.rate_hz for site, info in tracks.session.sensors.items()}
    offsets_s = {site: span.offset_s(recording, site) for site in recording.imu if tracks.is_usable(recording, site)}
    analysed = RecordingAnalysis(
        name=name,
        folder=recording.folder,
        kind=recording.kind,
        time_s=time_s,
        joints=joints,
        gait=gait,
        received=receptions(recording, nominal_hz, span.pauses[name], offsets_s),
        slipped_from_s={side: span.slipped_s[name, side] for side in Side if (name, side) in span.slipped_s},
        drifting_percent={site: percent for (walk, site), percent in span.drifts_percent.items() if walk == name},
        doubted_sites=span.doubted_sites,
        axis_halves=axis_halves_in(parts, recording, gait) if is_walk else {},
        clocks=clocks_in(tracks, recording, gait, {joint: one.lags_s[name] for joint, one in found.items()}),
        timed=time_test(tracks, recording, test) if test is not None else None,
    )
    calibrated = {joint: one.calibration for joint, one in found.items()}
    analysed = with_hips(analysed, tracks, recording, span.hips, calibrated)
    return replace(analysed, verdicts=verdicts_of(analysed, calibrated, _stiff_sides(tracks.session.patient)))


def _gait(
    span: SpanAnalysis,
    recording: Recording,
    time_s: FloatArray,
    joints: Mapping[Joint, JointAngle],
    leaning: Mapping[Site, FloatArray],
) -> dict[Side, SideGait]:
    """Both sides' gait, without the strides of a side after its strap slipped."""
    sites = {side: site_of_events(span.tracks, recording, side) or Site(f"{side}_{Segment.SHANK}") for side in Side}
    offsets_s = {side: span.offset_s(recording, site) for side, site in sites.items()}
    gait = gait_in(span.tracks, recording, time_s, joints, offsets_s, leaning)
    slipped = {side: span.slipped_s[recording.name, side] for side in gait if (recording.name, side) in span.slipped_s}
    for side, from_s in slipped.items():
        gait[side] = replace(gait[side], strides=gait[side].strides.left_out_from(from_s, Reason.SLIPPED))
    return gait


def _inclinations(tracks: SensorTracks, knee: JointCalibration, found: Twist) -> dict[Site, FloatArray]:
    """How thigh and shank lean (n,), relative to the standing that gave the knee its zero."""
    standing = next((r for r in tracks.span if r.name == knee.standing_from), None)
    leaning = {}
    for site, axis, lean_rad in (
        (knee.joint.proximal, knee.axis_proximal, found.lean_1_rad),
        (knee.joint.distal, knee.axis_distal, found.lean_2_rad),
    ):
        rest = tracks.rest(standing, site) if standing is not None else None
        if lean_rad is not None:
            up = rest.acc_m_s2 if rest is not None else None
            leaning[site] = inclination(lean_rad, axis, up, knee.clinical_sign)
    return leaning


def _find_slips(span: SpanAnalysis, calibrations: list[Calibration]) -> list[Finding]:
    findings = []
    for calibration in calibrations:
        walks = [walk for walk in span.walks if walk.name in calibration.walks]
        if not walks:
            continue
        turns = {
            joint: {name: twist.strap_turns for name, twist in one.twists.items()}
            for joint, one in span.joints_in(walks[0]).items()
        }
        is_published = any(one.method is Method.PUBLISHED for one in calibration.joints.values())
        for walk, slip in slips_in_walks(span.tracks, walks, turns, are_axes_published=is_published):
            if (walk.name, slip.site.side) in span.slipped_s:
                continue  # an earlier slip, reported already
            numbers = {"from_s": round(float(slip.from_s), 1), "turn_deg": round(float(np.rad2deg(abs(slip.turn_rad))))}
            findings.append(Finding("strap_slipped", Severity.WARNING, f"{walk.name}, {slip.site}", numbers))
            span.slipped_s[walk.name, slip.site.leg_side] = slip.sure_until_s
            for later in _until_free_motion(span.tracks.span, walk, slip.site):
                span.slipped_s[later.name, slip.site.leg_side] = -np.inf
    return findings


def _until_free_motion(span: tuple[Recording, ...], walk: Recording, site: Site) -> list[Recording]:
    """Walks after one in which the sensor at `site` slipped, before its axes were identified again."""
    later = []
    for recording in span[span.index(walk) + 1 :]:
        if recording.kind is RecordingKind.FREE_MOTION and recording.holds(site):
            break
        later.append(recording)
    return [recording for recording in later if recording.kind is RecordingKind.WALKING]


def _angle(calibration: JointCalibration, found: Twist, ringing_rad_s: float | None) -> JointAngle:
    """A twist turned to the clinical sign and zero, and how sure it is."""

    def clinical(twist_rad: FloatArray) -> FloatArray:
        turned = calibration.clinical_sign * (twist_rad - calibration.zero_rad) + calibration.offset_rad
        return wrapped_to_zero(turned)

    published = clinical(found.published_rad)
    angle = published if calibration.method is Method.PUBLISHED else clinical(found.twist_rad)
    sd = certainty.angle_sd_rad(
        np.abs(angle - np.nanmedian(angle)) if np.isfinite(angle).any() else np.zeros(len(angle)),
        robust_sd(found.moving_off_axis) if len(found.moving_off_axis) else 0.0,
        range_of(found.moving_twist) if len(found.moving_twist) else 0.0,
        calibration.joint.is_knee,
        calibration.is_hinge,
        calibration.nature,
        ringing_rad_s,
    )
    orientation = None if found.orientation_rad is None else clinical(found.orientation_rad)
    sd_rad = np.where(np.isfinite(angle), np.hypot(sd, found.added_sd_rad), np.nan)
    return JointAngle(angle, sd_rad, published, orientation)

"""From a session to joint angles: look at the samples, identify every joint, measure every recording, turn and zero.

Read `analyse` and `_analyse_span` as a table of contents; each step is a module of its own.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from core.angles.measure import Twist, measure
from core.body import LEG_JOINTS, Joint, Segment, Side, Site, ankle_of, knee_of
from core.calibration import certainty
from core.calibration.axis_halves import Parts, axes_of_parts, halves_of, spread_of
from core.calibration.calibrated import Bases, calibrate
from core.calibration.clinical_sign import range_of
from core.calibration.identified import Identified, clock_moved_s, identify
from core.calibration.rate_kind import tracks_of_kind
from core.calibration.strap import slips_in_walks
from core.calibration.validity import Basis, basis_of, spans_of_validity
from core.calibration.zero import wrapped_to_zero
from core.findings import Finding, Severity
from core.gait.chosen_strides import leave_out
from core.gait.inclination import inclination
from core.gait.strides import Reason
from core.gait.walking import clocks_in, gait_in, prosthetic_sides, site_of_events
from core.hip.analysis import HipsOfSpan, find_hips, with_hips
from core.placement.labels import doubted_labels
from core.published.angles import DEFAULT_TAU_S
from core.results import (
    Analysis,
    AxisHalves,
    Calibration,
    JointAngle,
    JointCalibration,
    Method,
    RecordingAnalysis,
    SideGait,
)
from core.samples import FloatArray, Patient, Recording, RecordingKind, Session
from core.signal.clock_drift import about_clocks, clock_drifts
from core.signal.reception import receptions
from core.signal.robust import robust_sd
from core.signal.sensors import SensorTracks
from core.timed.protocols import DEFINITIONS
from core.timed.timing import time_test
from core.verdicts.gates import verdicts_of
from core.verdicts.joint_findings import about_angles, about_joint, about_missing_joints, about_session
from core.verdicts.quality import look_at
from core.verdicts.walk_findings import about_prosthesis, about_turns, about_walk

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
        by_walk, analysed, of_span = _analyse_span(session, tracks, method, tau_s, steps)
        calibrations += by_walk
        recordings += analysed
        findings += [*noticed, *of_span]
    findings += about_missing_joints(session, quality.unusable, recordings)
    findings += about_prosthesis(recordings)
    unique = {(f.key, f.where, tuple(sorted(f.numbers.items()))): f for f in findings}
    whole = Analysis(
        method=method,
        is_simulated=session.is_simulated,
        calibrations=tuple(calibrations),
        recordings=tuple(recordings),
        findings=tuple(unique.values()),
        affected_side=_affected_side(session.patient),
        stiff_sides=_stiff_sides(session.patient),
    )
    return leave_out(whole, session.recordings)


def _analyse_span(
    session: Session, tracks: SensorTracks, method: Method, tau_s: float, steps: "_Steps"
) -> tuple[list[Calibration], list[RecordingAnalysis], list[Finding]]:
    """Everything of one span: what every joint is, and the angles and gait of what moves."""
    span, stiff_sides = tracks.span, _stiff_sides(session.patient)
    has_stood = any(r.is_kept and r.kind is RecordingKind.STANDING for r in session.recordings)
    doubted, drifts = doubted_labels(tracks), clock_drifts(tracks)
    findings = [*doubted.findings, *about_clocks(drifts)]
    bases = _bases(tracks)
    steps.expect(len(set(bases.values())) + len(bases))
    identified = _identify(tracks, bases, method, tau_s, steps)
    lags, noticed = _lags(tracks, bases, identified)
    findings += noticed
    hips = find_hips(tracks)
    measured = _measure(tracks, bases, identified, lags, hips, steps)
    calibrated = calibrate(tracks, bases, identified, measured, method)
    for basis, calibration in calibrated.items():
        joint = basis.joint
        turned, is_zero_typed = session.turned_sign.get(joint), joint in session.zero_rad
        findings += about_joint(calibration, identified[basis], turned, is_zero_typed, has_stood)
    by_walk = _by_walk(span, bases, calibrated)
    slipped, noticed = _slipped(tracks, by_walk, lags)
    findings += noticed
    recordings: list[RecordingAnalysis] = []
    parts = _Parts(tracks, bases, identified, lags, slipped)
    for recording in _moving(span):
        found = _angles(tracks, recording, bases, calibrated, measured, lags, hips)
        found = _before_slips(found, slipped)
        if recording.test is not None and recording.kind is RecordingKind.WALKING:
            is_walked = DEFINITIONS[recording.test.protocol].is_walked
            gait = found.gait if is_walked else {}
            found = replace(found, timed=time_test(tracks, recording, recording.test), gait=gait)
        found = replace(found, clocks=clocks_in(tracks, recording, found.gait, _lags_in(recording, lags)))
        found = replace(found, drifting_percent={s: p for (name, s), p in drifts.items() if name == recording.name})
        found = replace(found, doubted_sites=doubted.sites)
        found = replace(found, axis_halves=_axis_halves(parts, recording, found, calibrated, hips))
        here = {joint: calibrated[bases[recording.name, joint]] for joint in found.joints}
        found = with_hips(found, tracks, recording, hips, here)
        found = replace(found, verdicts=verdicts_of(found, here, stiff_sides))
        recordings.append(found)
        findings += [*about_angles(found), *about_turns(found)]
        findings += about_walk(found, {side: site_of_events(tracks, recording, side) for side in found.gait})
    return by_walk, recordings, findings


def _affected_side(patient: Patient) -> Side | None:
    """The side that symmetry compares with the sound one; None where none or both are affected."""
    stated = (patient.affected_side, patient.prosthetic_side)
    one = [side for side in stated if side in set(Side)]
    return Side(one[0]) if one and "both" not in stated else None


def _stiff_sides(patient: Patient) -> frozenset[Side]:
    affected = frozenset(side for side in Side if patient.affected_side in (side, "both"))
    return affected | prosthetic_sides(patient)


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


def _moving(span: tuple[Recording, ...]) -> list[Recording]:
    return [recording for recording in span if recording.kind is not RecordingKind.STANDING]


def _bases(tracks: SensorTracks) -> Bases:
    return {
        (recording.name, joint): basis_of(tracks.span, recording, joint, tracks.is_usable)
        for recording in _moving(tracks.span)
        for joint in LEG_JOINTS
        if tracks.is_usable(recording, joint.proximal, joint.distal)
    }


def _identify(
    tracks: SensorTracks, bases: Bases, method: Method, tau_s: float, steps: _Steps
) -> dict[Basis, Identified]:
    """Every joint; knees first, since they help their ankles."""
    identified: dict[Basis, Identified] = {}
    for name, joint in sorted(bases, key=lambda of: not of[1].is_knee):
        basis = bases[name, joint]
        if basis in identified:
            continue
        steps.tick(str(basis.joint))
        knee = bases.get((name, knee_of(joint.side)))
        found = identify(tracks, basis, method, tau_s, identified.get(knee) if knee else None)
        if found is not None:
            identified[basis] = found
    return identified


def _lags(
    tracks: SensorTracks, bases: Bases, identified: dict[Basis, Identified]
) -> tuple[dict[tuple[str, Joint], float], list[Finding]]:
    """The lag of each joint in each recording, and a finding where a recording has another than the identification."""
    lags, findings = {}, []
    for (name, joint), basis in bases.items():
        found = identified.get(basis)
        if found is None:
            continue
        lags[name, joint] = found.geometry.lag_s
        if found.robust is not None and found.recordings != (name,):
            recording = next(r for r in tracks.span if r.name == name)
            moved_s = clock_moved_s(tracks, recording, found)
            if moved_s:
                lags[name, joint] += moved_s
                numbers = {"lag_ms": round(1000 * moved_s, 1)}
                findings.append(Finding("clock_moved", Severity.WARNING, f"{name}, {joint}", numbers))
    return lags, findings


def _measure(
    tracks: SensorTracks,
    bases: Bases,
    identified: dict[Basis, Identified],
    lags: dict[tuple[str, Joint], float],
    hips: HipsOfSpan,
    steps: _Steps,
) -> dict[tuple[str, Joint], Twist]:
    measured: dict[tuple[str, Joint], Twist] = {}
    for recording in _moving(tracks.span):
        time_s = _clock_of(tracks, recording)
        for joint in LEG_JOINTS:
            basis = bases.get((recording.name, joint))
            if basis is None or basis not in identified:
                continue
            steps.tick(recording.name)
            offset_s = _offset_of_s(recording, joint.proximal, lags) + hips.offset_s(recording, joint.side)
            geometry = replace(identified[basis].geometry, lag_s=lags[recording.name, joint])
            measured[recording.name, joint] = measure(tracks, recording, joint, geometry, time_s, offset_s)
    return measured


def _clock_of(tracks: SensorTracks, recording: Recording) -> FloatArray:
    """Stamps of the first usable site."""
    for site in CLOCK_ORDER:
        if tracks.is_usable(recording, site):
            return recording.imu[site].time_s
    return np.empty(0)


def _by_walk(span: tuple[Recording, ...], bases: Bases, calibrated: dict[Basis, JointCalibration]) -> list[Calibration]:
    """Walks that share the calibration of every joint go together.

    What a free motion shows of joints that no walk holds comes first, without walks.
    """
    groups: dict[tuple[Basis, ...], list[str]] = {}
    walks = [recording for recording in span if recording.kind is RecordingKind.WALKING]
    for recording in walks or _moving(span):
        key = tuple(bases[recording.name, joint] for joint in LEG_JOINTS if (recording.name, joint) in bases)
        groups.setdefault(key, []).extend([recording.name] if walks else [])
    in_walks = {basis.joint for key in groups for basis in key}
    alone = {basis.joint: found for basis, found in calibrated.items() if basis.joint not in in_walks}
    by_walk = [
        Calibration(tuple(names), {basis.joint: calibrated[basis] for basis in key if basis in calibrated})
        for key, names in groups.items()
    ]
    return [*([Calibration((), alone)] if alone else []), *by_walk]


def _angles(
    tracks: SensorTracks,
    recording: Recording,
    bases: Bases,
    calibrated: dict[Basis, JointCalibration],
    measured: dict[tuple[str, Joint], Twist],
    lags: dict[tuple[str, Joint], float],
    hips: HipsOfSpan,
) -> RecordingAnalysis:
    """Turn the twists of one recording to the clinical sign and zero, and say how sure they are."""
    joints: dict[Joint, JointAngle] = {}
    for joint in LEG_JOINTS:
        basis, found = bases.get((recording.name, joint)), measured.get((recording.name, joint))
        if basis is None or found is None:
            continue
        joints[joint] = _angle(calibrated[basis], found, _ringing_rad_s(tracks, joint, measured))
    time_s, gait = _clock_of(tracks, recording), dict[Side, SideGait]()
    if recording.kind is RecordingKind.WALKING:
        offsets = {
            side: _clock_offset_s(tracks, recording, side, lags) + hips.offset_s(recording, side) for side in Side
        }
        leaning: dict[Site, FloatArray] = {}
        for joint in (knee for knee in joints if knee.is_knee):
            leaning |= _inclinations(tracks, calibrated[bases[recording.name, joint]], measured[recording.name, joint])
        gait = gait_in(tracks, recording, time_s, joints, offsets, leaning)
    nominal_hz = {site: info.rate_hz for site, info in tracks.session.sensors.items()}
    offsets_s = {
        site: _offset_of_s(recording, site, lags) + (hips.offset_s(recording, site.side) if site.side else 0.0)
        for site in recording.imu
        if tracks.is_usable(recording, site)
    }
    received = receptions(recording, nominal_hz, offsets_s)
    return RecordingAnalysis(recording.name, recording.folder, recording.kind, time_s, joints, gait, received)


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


Slipped = dict[tuple[str, Side], float]
"""From when on a side's straps are not to be trusted, by the walk's name, on its clock."""


def _slipped(
    tracks: SensorTracks, calibrations: list[Calibration], lags: dict[tuple[str, Joint], float]
) -> tuple[Slipped, list[Finding]]:
    slipped: Slipped = {}
    findings = []
    for calibration in calibrations:
        walks = [recording for recording in tracks.span if recording.name in calibration.walks]
        for walk, slip in slips_in_walks(tracks, walks, calibration.joints, lags):
            if (walk.name, slip.site.side) in slipped:
                continue  # an earlier slip, reported already
            numbers = {"from_s": round(float(slip.from_s), 1), "turn_deg": round(float(np.rad2deg(abs(slip.turn_rad))))}
            findings.append(Finding("strap_slipped", Severity.WARNING, f"{walk.name}, {slip.site}", numbers))
            slipped[walk.name, slip.site.leg_side] = slip.sure_until_s
            for later in _until_free_motion(tracks.span, walk, slip.site):
                slipped[later.name, slip.site.leg_side] = -np.inf
    return slipped, findings


def _until_free_motion(span: tuple[Recording, ...], walk: Recording, site: Site) -> list[Recording]:
    """Walks after one in which the sensor at `site` slipped, before its axes were identified again."""
    later = []
    for recording in span[span.index(walk) + 1 :]:
        if recording.kind is RecordingKind.FREE_MOTION and recording.holds(site):
            break
        later.append(recording)
    return [recording for recording in later if recording.kind is RecordingKind.WALKING]


def _before_slips(recording: RecordingAnalysis, slipped: Slipped) -> RecordingAnalysis:
    """The same, without the strides of a side after its strap slipped."""
    from_s = {side: slipped[recording.name, side] for side in Side if (recording.name, side) in slipped}
    gait = {
        side: replace(found, strides=found.strides.left_out_from(from_s[side], Reason.SLIPPED))
        if side in from_s
        else found
        for side, found in recording.gait.items()
    }
    return replace(recording, gait=gait, slipped_from_s=from_s)


class _Parts:
    """The axes of each joint in two parts of its data, found once for all walks that they hold for."""

    def __init__(
        self,
        tracks: SensorTracks,
        bases: Bases,
        identified: dict[Basis, Identified],
        lags: dict[tuple[str, Joint], float],
        slipped: Slipped,
    ) -> None:
        self.tracks, self.bases, self.identified, self.lags = tracks, bases, identified, lags
        self._slipped = slipped
        self._known: dict[Basis, Parts | None] = {}

    def of(self, name: str, joint: Joint) -> Parts | None:
        basis = self.bases[name, joint]
        if basis not in self._known:
            knee = self.bases.get((name, knee_of(joint.side)))
            lags_s = {name: lag_s for (name, of), lag_s in self.lags.items() if of is joint}
            until_s = {name: from_s for (name, side), from_s in self._slipped.items() if side is joint.side}
            self._known[basis] = axes_of_parts(
                self.tracks, self.identified[basis], self.identified.get(knee) if knee else None, lags_s, until_s
            )
        return self._known[basis]


def _axis_halves(
    parts: _Parts,
    recording: Recording,
    analysed: RecordingAnalysis,
    calibrated: dict[Basis, JointCalibration],
    hips: HipsOfSpan,
) -> dict[Joint, AxisHalves]:
    """Of the joints of one walk: how far apart the axes of two parts are, and what that does to its means."""
    halves = {}
    for joint in analysed.joints if recording.kind is RecordingKind.WALKING else ():
        basis = parts.bases[recording.name, joint]
        axes = parts.of(recording.name, joint)
        if axes is None:
            continue
        gait, spread = analysed.gait.get(joint.side), dict[str, float]()
        if gait is not None:
            offset_s = _offset_of_s(recording, joint.proximal, parts.lags) + hips.offset_s(recording, joint.side)
            spread = spread_of(
                parts.tracks,
                recording,
                parts.identified[basis],
                axes,
                gait.strides,
                calibrated[basis].clinical_sign,
                parts.lags[recording.name, joint],
                offset_s,
            )
        halves[joint] = halves_of(axes, spread, basis.free_motion is not None)
    return halves


def _lags_in(recording: Recording, lags: dict[tuple[str, Joint], float]) -> dict[Joint, float]:
    return {joint: lag_s for (name, joint), lag_s in lags.items() if name == recording.name}


def _clock_offset_s(
    tracks: SensorTracks, recording: Recording, side: Side, lags: dict[tuple[str, Joint], float]
) -> float:
    """What brings the clock of the sensor that gives the events to the thigh's."""
    site = site_of_events(tracks, recording, side)
    return _offset_of_s(recording, site or Site(f"{side}_{Segment.SHANK}"), lags)


def _offset_of_s(recording: Recording, site: Site, lags: dict[tuple[str, Joint], float]) -> float:
    """What brings the clock of a leg's sensor to its thigh's: the lags of the joints between; the pelvis has none."""
    if site.side is None or site.segment is Segment.THIGH:
        return 0.0
    joints = (knee_of(site.side), ankle_of(site.side))[: 1 if site.segment is Segment.SHANK else 2]
    return sum(lags.get((recording.name, joint), 0.0) for joint in joints)


def _ringing_rad_s(tracks: SensorTracks, joint: Joint, measured: dict[tuple[str, Joint], Twist]) -> float | None:
    """How much tissue rings at a joint in the walk where it does most; None without a walk."""
    walks = [recording.name for recording in tracks.span if recording.kind is RecordingKind.WALKING]
    rung = [measured[name, joint].moving_ringing for name in walks if (name, joint) in measured]
    found = [float(np.sqrt(np.mean(np.sum(one**2, axis=1)))) for one in rung if len(one)]
    return max(found, default=None)


def _angle(calibration: JointCalibration, found: Twist, ringing_rad_s: float | None) -> JointAngle:
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
        calibration.is_prosthetic,
        ringing_rad_s,
    )
    orientation = None if found.orientation_rad is None else clinical(found.orientation_rad)
    sd_rad = np.where(np.isfinite(angle), np.hypot(sd, found.added_sd_rad), np.nan)
    return JointAngle(angle, sd_rad, published, orientation)

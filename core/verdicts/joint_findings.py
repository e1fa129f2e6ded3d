"""Findings about the joints and their angles."""

from typing import Protocol

import numpy as np

from core.body import LEG_JOINTS, Segment, Site
from core.calibration.identified import Identified
from core.findings import Finding, Severity
from core.results import JointCalibration, Method, RecordingAnalysis, ZeroKind
from core.session import RecordingKind, Session
from core.signal.rotations import wrap


class Say(Protocol):
    """Notes one finding about the joint at hand."""

    def __call__(self, key: str, severity: Severity, **numbers: float | int | str) -> None: ...


MIN_SIGN_MARGIN = 1.5  # of the best hypothesis against its best rival: wrong ones, of weak short motions, had 1.45
MAX_AXIS_SD_RAD = np.deg2rad(10.0)
MAX_DIFFERENCE_RAD = np.deg2rad(5.0)  # between the result and the published angle, about their means


def about_session(session: Session) -> list[Finding]:
    """What holds for the visit as a whole."""
    findings = []
    if session.is_simulated:
        findings.append(Finding("simulated", Severity.INFO, "session"))
    kinds = {recording.kind for recording in session.recordings if recording.is_kept}
    is_joint_worn = any(r.holds(joint.proximal, joint.distal) for r in session.recordings for joint in LEG_JOINTS)
    if RecordingKind.STANDING not in kinds and is_joint_worn:
        findings.append(Finding("no_standing", Severity.WARNING, "session"))
    for recording in session.recordings:
        for site, block in recording.imu.items():
            if block.is_rate_derived:
                findings.append(Finding("rate_from_orientation", Severity.INFO, f"{recording.name}, {site}"))
        if recording.is_restrapped_before:
            findings.append(Finding("restrapped", Severity.INFO, recording.name))
    return findings


def about_joint(
    calibration: JointCalibration, found: Identified, turned: int | None, is_zero_typed: bool, has_stood: bool
) -> list[Finding]:
    """What one joint's identification reports about itself."""
    where, findings = str(calibration.joint), []

    def say(key: str, severity: Severity, **numbers: float | int | str) -> None:
        findings.append(Finding(key, severity, where, numbers))

    margin = calibration.sign_margin
    if calibration.method is Method.ROBUST and margin is not None and margin < MIN_SIGN_MARGIN:
        say("sign_in_doubt", Severity.WARNING, margin=round(margin, 2))
    if calibration.method is Method.PUBLISHED and margin is not None and margin < MIN_SIGN_MARGIN:
        say("published_sign_unsure", Severity.WARNING)
    if turned is not None:
        say("sign_turned" if turned < 0 else "sign_confirmed", Severity.INFO)
    elif not calibration.is_sign_certain:
        say("clinical_sign_uncertain", Severity.WARNING, margin=round(calibration.clinical_sign_margin or 0.0, 2))
    if calibration.gyro_bias_proximal_rad_s is None or calibration.gyro_bias_distal_rad_s is None:
        say("gyro_bias_unknown", Severity.WARNING)
    if calibration.zero is ZeroKind.GONIOMETER:
        say("zero_from_goniometer", Severity.INFO, value_deg=round(float(np.rad2deg(calibration.offset_rad)), 1))
    if calibration.zero is ZeroKind.NONE:
        if has_stood:  # else `no_standing` states it once for all
            say("zero_unknown", Severity.WARNING)
        if is_zero_typed:
            say("goniometer_without_standing", Severity.WARNING)
    if found.basis.is_from_after:
        say("calibration_after_walk", Severity.INFO)
    if found.robust is not None:
        _about_robust(calibration, found, say)
    return findings


def _about_robust(calibration: JointCalibration, found: Identified, say: Say) -> None:
    robust = found.robust
    assert robust is not None
    residual = round(calibration.hinge_residual_rad_s or 0.0, 3)
    say("is_a_hinge" if found.is_hinge else "not_a_hinge", Severity.INFO, hinge_residual_rad_s=residual)
    if not robust.is_same_joint:
        say("not_the_same_joint", Severity.WARNING, margin=round(robust.sign_margin, 2))
    elif calibration.lag_s:
        say("lag_corrected", Severity.INFO, lag_ms=round(1000 * calibration.lag_s, 1))
    if not robust.did_flexion_dominate:
        elevation = round(float(np.rad2deg(robust.elevation_rad or 0.0)))
        say("flexion_did_not_dominate", Severity.WARNING, elevation_deg=elevation)
    if calibration.axis_sd_rad is not None and calibration.axis_sd_rad > MAX_AXIS_SD_RAD:
        say("axis_uncertain", Severity.WARNING, axis_sd_deg=round(float(np.rad2deg(calibration.axis_sd_rad)), 1))
    if calibration.centre_proximal_m is None:
        say("centre_unknown", Severity.INFO)
    if found.is_bare:
        say("ankle_axis_from_rates", Severity.INFO)
    if found.basis.free_motion is None:
        say("axis_from_walking", Severity.INFO)


def about_angles(recording: RecordingAnalysis) -> list[Finding]:
    """Where the result and the published angle part."""
    findings = []
    for joint, angle in recording.joints.items():
        difference = wrap(angle.angle_rad - angle.published_rad)
        if np.isfinite(difference).any():
            rms = float(np.sqrt(np.nanmean(wrap(difference - np.nanmedian(difference)) ** 2)))
            if rms > MAX_DIFFERENCE_RAD:
                numbers = {"difference_deg": round(float(np.rad2deg(rms)), 1)}
                findings.append(Finding("published_differs", Severity.INFO, f"{recording.name}, {joint}", numbers))
    return findings


def about_missing_joints(
    session: Session, unusable: frozenset[tuple[str, Site]], recordings: list[RecordingAnalysis]
) -> list[Finding]:
    """Joints whose two sensors were worn but that have no angle, and sessions without any joint."""
    findings = []
    kept = [r for r in session.recordings if r.is_kept and r.kind is not RecordingKind.STANDING]
    for joint in LEG_JOINTS:
        worn = [r.name for r in kept if r.holds(joint.proximal, joint.distal)]
        if worn and not any(joint in found.joints for found in recordings):
            spoilt = all(unusable & {(name, joint.proximal), (name, joint.distal)} for name in worn)
            key = "joint_left_out" if spoilt else "too_little_motion"
            findings.append(Finding(key, Severity.GRAVE, str(joint)))
    if not any(found.joints for found in recordings):
        is_feet_only = {site.segment for r in kept for site in r.imu} == {Segment.FOOT}
        key, severity = ("feet_only", Severity.INFO) if is_feet_only else ("no_joint", Severity.GRAVE)
        findings.append(Finding(key, severity, "session"))
    return findings

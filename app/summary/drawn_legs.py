"""Legs at each moment of a walk. Drawn from the angles and the thighs' inclination, not measured.

The hips stay where they are, side by side, and each leg's heading is such that its knee axis points to the left: how
far the patient came and which way they faced is not known without a magnetometer, nor is it shown. Forward is x, left
is y, up is z, metres.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from core.body import Joint, Side, Site, ankle_of, knee_of
from core.results import Analysis, JointCalibration, RecordingAnalysis
from core.samples import FloatArray, IntArray, RateKind
from core.session import Recording, RecordingKind, Session
from core.signal.orientation import oriented
from core.signal.rotations import matrix_from_quaternion, turn_about_vertical
from core.signal.tracks import blocks_of, even_tracks, nominal_step_s

# shares of the height (Drillis & Contini 1966, Body segment parameters)
THIGH, SHANK, FOOT, HIPS = 0.245, 0.246, 0.152, 0.191
UNKNOWN_HEIGHT_M = 1.70
PELVIS = 0.1  # of the height, from the hips up: it is drawn as large as it looks right
HALF_WIDTHS_M = ((0.075, 0.055), (0.055, 0.035), (0.05, 0.025))  # of thigh, shank and foot at either end
MAX_LENGTH_RATIO = 1.3  # a shank further from what its height lets expect comes of centres that were not found
FRAMES_HZ = 50.0  # smooth to the eye


@dataclass(frozen=True, slots=True)
class DrawnLeg:
    """One leg at `time_s` (n,): hip, knee and ankle (n, 3, 3), ankle and toes (n, 2, 3), NaN where not known."""

    time_s: FloatArray
    leg_m: FloatArray
    foot_m: FloatArray
    shank_m: float


def height_of(session: Session) -> float:
    """The patient's height in metres, or a common one."""
    return session.patient.height_m or UNKNOWN_HEIGHT_M


def how_drawn(session: Session, *, has_pelvis: bool = False) -> str:
    """Say what of the drawing is measured, what is a share of the height, and what is not known."""
    height_m, is_typed = height_of(session), session.patient.height_m is not None
    hips = "The hips stay side by side in one place"
    if has_pelvis:
        hips = "The hips stay in one place, and between them the pelvis tilts, drops and turns as its sensor did"
    return (
        f"The legs are drawn, not measured. Knee and ankle bend as the angles say and each thigh is inclined as its "
        f"sensor was; thigh, foot and hips are shares of a height of {height_m:.2f} m"
        f"{'' if is_typed else ', which nobody typed'} (Drillis & Contini 1966), as is the shank where the centres of "
        f"knee and ankle are not both known. How thick they are means nothing. {hips}, "
        f"and every knee's axis points sideways: where the patient walked to is not known. {FRAMES_HZ:.0f} pictures a "
        f"second at most. A leg or foot is grey where the angle that bends it is not reported, has no zero, or may be "
        f"mirrored."
    )


def draw_legs(session: Session, analysis: Analysis, recording: RecordingAnalysis) -> dict[Side, DrawnLeg]:
    """Each leg of a walk whose knee was found and whose thigh sensor sent samples."""
    if recording.kind is not RecordingKind.WALKING:
        return {}
    raw = next((r for r in session.recordings if r.name == recording.name), None)
    spans = [span.joints for span in analysis.calibrations if recording.name in span.walks]
    calibrated = {joint: found for joints in spans for joint, found in joints.items()}
    sides = [side for side in Side if knee_of(side) in recording.joints and knee_of(side) in calibrated]
    if raw is None or not len(recording.time_s):
        return {}
    frames = _frames(recording.time_s)
    return {
        side: _drawn(session, recording, raw, calibrated, side, frames) for side in sides if raw.holds(_thigh(side))
    }


def draw_pelvis(session: Session, recording: RecordingAnalysis) -> tuple[FloatArray, FloatArray] | None:
    """Give times (n,) s and pelvis points (n, 4, 3) m: left hip, top, right hip, back; None if not reported."""
    if recording.kind is not RecordingKind.WALKING or not _has_pelvis(recording) or not len(recording.time_s):
        return None
    frames, height_m = _frames(recording.time_s), height_of(session)
    left_m, right_m = (_hip_m(recording, frames, height_m, side) for side in Side)
    tilt = _known(recording.pelvis.tilt_rad[frames]) if recording.pelvis is not None else np.zeros(len(frames))
    up = np.stack([np.sin(tilt), np.zeros_like(tilt), np.cos(tilt)], axis=1)
    top_m = 0.5 * (left_m + right_m) + PELVIS * height_m * up
    return recording.time_s[frames], np.stack([left_m, top_m, right_m, left_m], axis=1)


def _has_pelvis(recording: RecordingAnalysis) -> bool:
    return recording.pelvis is not None and recording.verdicts.pelvis.is_reported


def _hip_m(recording: RecordingAnalysis, frames: IntArray, height_m: float, side: Side) -> FloatArray:
    """One hip at each frame (n, 3): beside the other, as the pelvis drops and turns where it may be read."""
    lateral = np.broadcast_to([0.0, 1.0, 0.0], (len(frames), 3))
    if recording.pelvis is not None and _has_pelvis(recording):
        drop, turn = (_known(a[frames]) for a in (recording.pelvis.obliquity_rad, recording.pelvis.rotation_rad))
        lateral = np.stack([-np.sin(turn) * np.cos(drop), np.cos(turn) * np.cos(drop), np.sin(drop)], axis=1)
    aside_m = HIPS * height_m / 2 * (1 if side is Side.LEFT else -1)
    return np.array([0.0, 0.0, (THIGH + SHANK) * height_m]) + aside_m * lateral


def _known(angle_rad: FloatArray) -> FloatArray:
    """What is not known, as rotation in turns, is drawn as in standing."""
    return np.nan_to_num(angle_rad)


def _frames(time_s: FloatArray) -> IntArray:
    """The samples to draw, evenly among all."""
    step_s = nominal_step_s(time_s) if len(time_s) > 1 else 1.0
    return np.arange(0, len(time_s), max(1, round(1 / (FRAMES_HZ * step_s))))


def _drawn(
    session: Session,
    recording: RecordingAnalysis,
    raw: Recording,
    calibrated: Mapping[Joint, JointCalibration],
    side: Side,
    frames: IntArray,
) -> DrawnLeg:
    knee, ankle, height_m = calibrated[knee_of(side)], calibrated.get(ankle_of(side)), height_of(session)
    time_s = recording.time_s[frames]
    forward, up = _thigh_directions(session, raw, knee, time_s)
    shank_m = _shank_length(knee, ankle, height_m)
    bent = recording.joints[knee_of(side)].angle_rad[frames, None]
    shank_forward = np.cos(bent) * forward - np.sin(bent) * up
    shank_up = np.cos(bent) * up + np.sin(bent) * forward
    lifted = np.full_like(bent, np.nan)
    if ankle_of(side) in recording.joints:
        lifted = recording.joints[ankle_of(side)].angle_rad[frames, None]
    foot_forward = np.cos(lifted) * shank_forward + np.sin(lifted) * shank_up
    hip_m = _hip_m(recording, frames, height_m, side)
    knee_m = hip_m - THIGH * height_m * up
    ankle_m = knee_m - shank_m * shank_up
    toes_m = ankle_m + FOOT * height_m * foot_forward
    return DrawnLeg(time_s, np.stack([hip_m, knee_m, ankle_m], axis=1), np.stack([ankle_m, toes_m], axis=1), shank_m)


def _shank_length(knee: JointCalibration, ankle: JointCalibration | None, height_m: float) -> float:
    """From the two joint centres, both at -o in the shank sensor's axes, where they can be believed; else by height."""
    expected_m = SHANK * height_m
    if ankle is not None and knee.centre_distal_m is not None and ankle.centre_proximal_m is not None:
        length_m = float(np.linalg.norm(knee.centre_distal_m - ankle.centre_proximal_m))
        if expected_m / MAX_LENGTH_RATIO < length_m < expected_m * MAX_LENGTH_RATIO:
            return length_m
    return expected_m


def _thigh_directions(
    session: Session, raw: Recording, knee: JointCalibration, time_s: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Where the thigh's front and its upper end point at each frame (n, 3), its knee axis turned to the left."""
    left_axis = knee.clinical_sign * knee.axis_proximal
    forward, up = np.full((2, len(time_s), 3), np.nan)
    upright = _upright(session, raw, knee)
    long_axis = upright - (upright @ left_axis) * left_axis
    length = float(np.linalg.norm(long_axis))
    if not length > 0:  # NaN too
        return forward, up
    long_axis /= length
    front = np.cross(left_axis, long_axis)
    for rows, q_earth_from_sensor in _orientations(session, raw, knee, time_s):
        earth_from_sensor = matrix_from_quaternion(q_earth_from_sensor)
        axis = earth_from_sensor @ left_axis
        to_left = np.pi / 2 - np.arctan2(axis[:, 1], axis[:, 0])
        forward[rows] = turn_about_vertical(to_left, earth_from_sensor @ front)
        up[rows] = turn_about_vertical(to_left, earth_from_sensor @ long_axis)
    return forward, up


def _upright(session: Session, raw: Recording, knee: JointCalibration) -> FloatArray:
    """Up in the thigh sensor's axes (3,) while standing, else on average over the walk; NaN if it never sent."""
    site = knee.joint.proximal
    standing = next((r for r in session.recordings if r.name == knee.standing_from and r.holds(site)), raw)
    acc_m_s2 = standing.imu[site].acc_m_s2
    known = acc_m_s2[np.isfinite(acc_m_s2).all(axis=1)]
    mean = known.mean(axis=0) if len(known) else np.full(3, np.nan)
    return np.asarray(mean / np.linalg.norm(mean))


def _orientations(
    session: Session, raw: Recording, knee: JointCalibration, time_s: FloatArray
) -> Iterator[tuple[IntArray, FloatArray]]:
    """Frames at which the thigh sensor sent, and its orientation there, block by block."""
    site = knee.joint.proximal
    block, info = raw.imu[site], session.sensors.get(site)
    kind = (info.rate_kind if info else None) or RateKind.INSTANTANEOUS
    bias = np.zeros(3) if knee.gyro_bias_proximal_rad_s is None else knee.gyro_bias_proximal_rad_s
    for piece in blocks_of(float(time_s[0]), float(time_s[-1])):
        is_here = (time_s >= piece.core_from_s) & (time_s < piece.core_to_s)
        for track in even_tracks(block, piece.from_s, piece.to_s):
            at = np.rint((time_s - track.start_s) / track.step_s).astype(np.int64)
            is_inside = is_here & (at >= 0) & (at < len(track))
            rows = np.flatnonzero(is_inside)
            rows = rows[track.is_measured[at[rows]]]
            yield rows, oriented(track, kind, bias).q_earth_from_sensor[at[rows]]


def _thigh(side: Side) -> Site:
    return knee_of(side).proximal

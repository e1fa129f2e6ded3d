"""Poses of the segments of one leg at every instant, from joint angles."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from core.samples import FloatArray
from devices.simulation.walker_body import FreeMotion, Leg, Motion
from devices.simulation.walker_prosthesis import polycentric_shift_m

X_AXIS, Y_AXIS, Z_AXIS = np.eye(3)


@dataclass(frozen=True, slots=True)
class JointAngles:
    """All (n,), radians: knee flexion, dorsiflexion, and what the ankle does beside it."""

    knee: FloatArray
    ankle: FloatArray
    inversion: FloatArray
    rotation: FloatArray


@dataclass(frozen=True, slots=True)
class TrueFootEvents:
    """When one foot lands and leaves, seconds, each ascending."""

    initial_contact_s: FloatArray
    full_contact_s: FloatArray
    heel_rise_s: FloatArray
    toe_off_s: FloatArray


NO_EVENTS = TrueFootEvents(*(np.empty(0) for _ in range(4)))


@dataclass(frozen=True, slots=True)
class LegMotion:
    """Poses of one leg on the fine clock `time_s` (n,), earth z up.

    `rotations` and `origins_m` hold thigh, shank and foot in this order: earth from segment (3, n, 3, 3), and the place
    of the segment's proximal joint (3, n, 3). `footholds_m` (i, 2) is where the ankle is over the floor at each
    stance.
    """

    time_s: FloatArray
    angles: JointAngles
    rotations: FloatArray
    origins_m: FloatArray
    events: TrueFootEvents
    footholds_m: FloatArray

    def turned(self, rotation: FloatArray) -> "LegMotion":
        """The same motion in another compass direction; `rotation` (3, 3) about the vertical."""
        return replace(
            self,
            rotations=rotation @ self.rotations,
            origins_m=self.origins_m @ rotation.T,
            footholds_m=self.footholds_m @ rotation[:2, :2].T,
        )


def rotation_about(axis: FloatArray, angle_rad: FloatArray) -> FloatArray:
    """Give rotation matrices (n, 3, 3) about a unit axis (3,) by right-handed angles (n,)."""
    x, y, z = axis
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    s, c = np.sin(angle_rad)[:, None, None], np.cos(angle_rad)[:, None, None]
    return np.asarray(np.eye(3) + s * k + (1.0 - c) * (k @ k))


def knee_rotation(leg: Leg, angles: JointAngles) -> FloatArray:
    """Give the rotations (n, 3, 3) from the shank's axes to the thigh's."""
    flexion = rotation_about(leg.knee_axis, angles.knee)
    if leg.knee_rotation_per_flexion == 0.0:
        return flexion
    return flexion @ rotation_about(_normal_to(leg.knee_axis, Z_AXIS), leg.knee_rotation_per_flexion * angles.knee)


def ankle_rotation(leg: Leg, angles: JointAngles) -> FloatArray:
    """Give the rotations (n, 3, 3) from the foot's axes to the shank's."""
    dorsiflexion = rotation_about(leg.ankle_axis, angles.ankle)
    inverts = 1.0 if leg.foot is None else leg.foot.inverts
    if inverts == 0.0:
        return dorsiflexion
    # inversion lifts the inner edge: about -x on the left foot, +x on the right
    forward = _normal_to(leg.ankle_axis, X_AXIS)
    upward = np.cross(leg.ankle_axis, forward)
    beside = rotation_about(forward, -leg.outward * inverts * angles.inversion)
    return dorsiflexion @ beside @ rotation_about(upward, leg.outward * inverts * angles.rotation)


def _normal_to(axis: FloatArray, direction: FloatArray) -> FloatArray:
    """The unit vector (3,) nearest to `direction` about which turning is no flexion at all."""
    normal = direction - axis * (axis @ direction)
    return np.asarray(normal / np.linalg.norm(normal))


def hang_from_hip(leg: Leg, thigh: FloatArray, hip_m: FloatArray, angles: JointAngles) -> tuple[FloatArray, FloatArray]:
    """Give rotations (3, n, 3, 3), earth from segment, and origins (3, n, 3) of the leg below a hip."""
    shank = thigh @ knee_rotation(leg, angles)
    foot = shank @ ankle_rotation(leg, angles)
    knee_m = hip_m - leg.thigh_m * thigh[:, :, 2]
    if leg.is_polycentric:
        knee_m = knee_m + np.einsum("nij,nj->ni", thigh, polycentric_shift_m(angles.knee))
    ankle_m = knee_m - leg.shank_m * shank[:, :, 2]
    return np.stack([thigh, shank, foot]), np.stack([hip_m, knee_m, ankle_m])


def smooth(signal: FloatArray, step_s: float, width_s: float) -> FloatArray:
    """Average twice over `width_s` in running means, which together reach no further than `width_s`."""
    width = 2 * round(0.5 * width_s / step_s) + 1
    return np.asarray(uniform_filter1d(uniform_filter1d(signal, width, mode="nearest"), width, mode="nearest"))


def smooth_step(x: FloatArray) -> FloatArray:
    """Give 0 below 0, 1 above 1, and between them a step with two continuous derivatives."""
    u = np.clip(x, 0.0, 1.0)
    return u**3 * (10.0 - 15.0 * u + 6.0 * u**2)


def sway_of(time_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Give the quiet-standing sway (n, 2), forward and left, m: a few millimetres at 0.1 to 0.6 Hz."""
    return noise_in_band(time_s, (0.1, 0.6), (2, 4), rng) * 0.0015


def noise_in_band(
    time_s: FloatArray, band_hz: tuple[float, float], shape: tuple[int, int], rng: np.random.Generator
) -> FloatArray:
    """Sums (n, signals) of sines within a band by chance, so many for each signal: `shape` is (signals, sines)."""
    frequency, phase = rng.uniform(*band_hz, shape), rng.uniform(0.0, 2.0 * np.pi, shape)
    waves = [np.sin(2.0 * np.pi * np.outer(time_s, f) + p).sum(axis=1) for f, p in zip(frequency, phase, strict=True)]
    return np.stack(waves, axis=-1)


def move_freely(
    leg: Leg, recording: FreeMotion, time_s: FloatArray, start_s: float, rng: np.random.Generator
) -> LegMotion:
    """Circle one leg from `start_s` for the recording's duration; it hangs still before and after."""
    is_lying = recording.motion is Motion.SIDE_LYING
    strength = {Motion.WEAK: 0.4}.get(recording.motion, 1.0)
    tempo = {Motion.WEAK: 0.6}.get(recording.motion, 1.0) * rng.uniform(0.9, 1.1)
    thigh_strength = {Motion.KNEE_ONLY: 0.03, Motion.SIDE_LYING: 0.15}.get(recording.motion, strength)
    ankle_strength = 0.0 if recording.motion is Motion.KNEE_ONLY else strength
    beside = 0.0 if recording.motion is Motion.SAGITTAL else 1.0
    t = time_s - start_s
    ease = smooth_step(t / 0.4) * smooth_step((recording.duration_s - t) / 0.4)

    def swing(frequency_hz: float) -> FloatArray:
        """Sine of unit size whose phase runs forth and back, and whose size breathes."""
        return np.sin(_changing_phase(t, tempo * frequency_hz, rng)) * (1.0 + 0.2 * np.sin(t * rng.uniform(0.5, 1.2)))

    circle = _changing_phase(t, 0.6 * tempo, rng)
    size = ease * thigh_strength * (1.0 + 0.25 * np.sin(t * rng.uniform(0.6, 1.2) + rng.uniform(0, 6)))
    flexion = np.deg2rad(ease * 15.0 * thigh_strength + 18.0 * size * np.sin(circle))
    abduction = np.deg2rad(ease * 8.0 * thigh_strength + 15.0 * size * np.cos(circle)) * beside
    hip_rotation = np.deg2rad(10.0) * size * swing(0.8) * beside
    ankle_limit = 1.0 if leg.foot is None else leg.foot.moved_by_hand
    angles = JointAngles(
        knee=leg.standing_knee_rad + ease * strength * leg.knee_gain * np.deg2rad(42.0 + 32.0 * swing(0.75)),
        ankle=ease * ankle_strength * ankle_limit * leg.ankle_gain * np.deg2rad(15.0) * swing(0.9),
        inversion=ease * ankle_strength * beside * np.deg2rad(4.0) * swing(0.8),
        rotation=ease * ankle_strength * beside * np.deg2rad(3.0) * swing(0.7),
    )
    thigh = rotation_about(Z_AXIS, leg.outward * hip_rotation) @ rotation_about(X_AXIS, leg.outward * abduction)
    thigh = thigh @ rotation_about(Y_AXIS, -flexion)
    if is_lying:
        thigh = _lie_on_the_side(leg, recording.axis_from_vertical_rad) @ thigh
    drift = np.stack([swing(f) for f in (0.5, 0.4, 0.6)], axis=-1) * [0.02, 0.015, 0.01]
    hip_m = np.array([0.0, 0.09 * leg.outward, 0.92]) + (ease * thigh_strength)[:, None] * drift
    rotations, origins = hang_from_hip(leg, thigh, hip_m, angles)
    return LegMotion(time_s, angles, rotations, origins, NO_EVENTS, np.empty((0, 2)))


def _changing_phase(t: FloatArray, frequency_hz: float, rng: np.random.Generator) -> FloatArray:
    """A phase (n,) that runs at `frequency_hz`, turns its direction every 2 to 3.5 s and never jumps."""
    turns = np.cumsum(rng.uniform(2.0, 3.5, int(max(t[-1], 1.0) / 2.0) + 2))
    direction = np.ones_like(t)
    for i, turn in enumerate(turns):
        direction += (-1.0) ** (i + 1) * 2.0 * smooth_step((t - turn) / 0.5 + 0.5)
    phase = np.cumsum(direction) * (t[1] - t[0]) * 2.0 * np.pi * frequency_hz
    return np.asarray(phase + rng.uniform(0.0, 2.0 * np.pi))


def _lie_on_the_side(leg: Leg, from_vertical_rad: float) -> FloatArray:
    """The body turned about its forward axis so that the resting knee axis is `from_vertical_rad` from vertical."""
    elevation = np.arctan2(leg.knee_axis[2], leg.knee_axis[1])
    # the axis keeps its forward component, which the turn about x cannot remove
    reach = np.hypot(leg.knee_axis[1], leg.knee_axis[2])
    required = np.arcsin(min(np.cos(from_vertical_rad) / reach, 1.0))
    return rotation_about(X_AXIS, np.array([required - elevation]))

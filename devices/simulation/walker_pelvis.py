"""The pelvis of the simulated patient: how it moves, how its sensor rides on it, and what is true of the hips.

Both legs hang from it, so that the hips are true ball joints of one body. The walker's legs are made from the floor up
and their hips part by centimetres; here each leg is carried to its hip, and a standing foot gives by as much as that.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from core.body import Joint, Side, Site
from core.samples import FloatArray
from devices.simulation.walker_body import FreeMotion, Leg, Motion, Tissue
from devices.simulation.walker_motion import (
    NO_EVENTS,
    X_AXIS,
    Y_AXIS,
    Z_AXIS,
    JointAngles,
    LegMotion,
    hang_from_hip,
    noise_in_band,
    rotation_about,
    smooth_step,
)
from devices.simulation.walker_sensors import Mounting, SensorClock, interpolate, ring_after

HALF_WIDTH_M = 0.085  # the hips' centres are 0.17 m apart
OBLIQUITY_RAD, ROTATION_RAD, TILT_RAD = np.deg2rad([4.0, 6.0, 2.0])  # over a stride; it tilts twice in it
LEAN_RAD = np.deg2rad(2.0)  # forward while walking
SWAY_RAD = np.deg2rad(1.3)  # of the legs about the ankles, towards the stance side: 2 cm at the hips
SURGE_RAD = np.deg2rad(0.8)  # forward and back with every step: 0.14 m/s about the mean speed, as people have
HEADING_S = 0.4  # the way that the body faces, from thighs that turn with every step
# Sensors against bones on people: pelvis 1.4, 0.8, 1.6 deg (tilt, obliquity, rotation), thigh roll 1.7, length 4 to 9
REAL_PELVIS_RAD = np.deg2rad([0.8, 1.4, 1.6])  # about x, y, z
SOFT_PELVIS_RAD = np.deg2rad([0.3, 0.5, 0.5])
REAL_RING_RAD, RING_HZ, RING_DECAY_S = np.deg2rad(0.35), (7.0, 12.0), 0.08
REAL_THIGH_GAIN = (-0.15, -0.07)
# with the slow wobble that fits knees, pelvis and thigh disagree by 0.15 to 0.22; people's by 0.07 to 0.08
REAL_THIGH_WOBBLE = 0.4
REAL_THIGH_ROLL_RAD, REAL_THIGH_LENGTH_RAD = np.deg2rad(1.7), np.deg2rad([4.0, 9.0])
LUNGE_S, LUNGE_M = 3.0, np.array([0.35, 0.0, -0.22])


@dataclass(frozen=True, slots=True)
class PelvisMotion:
    """Earth from pelvis (n, 3, 3) and the middle between the hips (n, 3) on the fine clock; segment axes as a leg's."""

    time_s: FloatArray
    rotations: FloatArray
    centre_m: FloatArray

    def turned(self, rotation: FloatArray) -> "PelvisMotion":
        """The same in another compass direction; `rotation` (3, 3) about the vertical."""
        return replace(self, rotations=rotation @ self.rotations, centre_m=self.centre_m @ rotation.T)


@dataclass(frozen=True, slots=True)
class HipTruth:
    """One hip at the stamps (n,) of its thigh's sensor: flexion and abduction less standing, rad, clinical sign.

    `centre_proximal_m` and `centre_distal_m` (3,) point from the joint to the sensors, in sensor axes; `lag_s` brings
    the thigh's stamps to the pelvis's.
    """

    time_s: FloatArray
    flexion_rad: FloatArray
    abduction_rad: FloatArray
    centre_proximal_m: FloatArray
    centre_distal_m: FloatArray
    lag_s: float


@dataclass(frozen=True, slots=True)
class PelvisTruth:
    """The pelvis at its sensor's stamps (n,), rad: tilt forward, obliquity left up, heading to the left."""

    time_s: FloatArray
    tilt_rad: FloatArray
    obliquity_rad: FloatArray
    heading_rad: FloatArray


def with_pelvis(
    motions: Mapping[Side, LegMotion], rng: np.random.Generator
) -> tuple[PelvisMotion, dict[Side, LegMotion]]:
    """Give the pelvis between two moving legs and the legs as they hang from it; earth axes, z up."""
    left = motions[Side.LEFT]
    time_s, step_s = left.time_s, float(left.time_s[1] - left.time_s[0])
    thighs = [motion.rotations[0, :, :2, 0] for motion in motions.values()]
    forward = gaussian_filter1d(np.sum(thighs, axis=0), HEADING_S / step_s, axis=0)
    facing = np.unwrap(np.arctan2(forward[:, 1], forward[:, 0]))
    stride, ease = _stride_phase(left, motions[Side.RIGHT])
    if len(left.events.initial_contact_s):
        obliquity = OBLIQUITY_RAD * ease * np.sin(stride)
        rotation = -ROTATION_RAD * ease * np.cos(stride)
        tilt = ease * (LEAN_RAD + TILT_RAD * np.cos(2.0 * stride + 0.6))
        sway, surge = -SWAY_RAD * ease * np.sin(stride), SURGE_RAD * ease * np.sin(2.0 * stride + 0.9)
    else:
        obliquity, tilt, rotation = np.deg2rad(2.0) * _slow(time_s, rng, 3).T * _liveliness(left)
        sway = surge = np.zeros_like(time_s)
    swayed = {side: _leaning(motion, facing, sway, surge) for side, motion in motions.items()}
    turned = rotation_about(Z_AXIS, facing + rotation) @ rotation_about(Y_AXIS, tilt)
    rotations = turned @ rotation_about(X_AXIS, obliquity)
    hips = [motion.origins_m[0] for motion in swayed.values()]
    pelvis = PelvisMotion(time_s, rotations, 0.5 * (hips[0] + hips[1]))
    return pelvis, {side: hung(motion, hip_m(pelvis, side)) for side, motion in swayed.items()}


def hip_m(pelvis: PelvisMotion, side: Side) -> FloatArray:
    """Give a hip's centre (n, 3), m, in earth axes."""
    outward = 1.0 if side is Side.LEFT else -1.0
    return pelvis.centre_m + outward * HALF_WIDTH_M * pelvis.rotations[:, :, 1]


def hung(motion: LegMotion, at_m: FloatArray) -> LegMotion:
    """Carry a leg to its hip's centre (n, 3) in earth axes."""
    return replace(motion, origins_m=motion.origins_m + (at_m - motion.origins_m[0]))


def _leaning(motion: LegMotion, facing: FloatArray, roll_rad: FloatArray, pitch_rad: FloatArray) -> LegMotion:
    """The whole leg leaning over its ankle, to the right by its roll and forward by its pitch (n,)."""
    about_z = rotation_about(Z_AXIS, facing)
    lean = rotation_about(X_AXIS, roll_rad) @ rotation_about(Y_AXIS, pitch_rad)
    turn = about_z @ lean @ np.swapaxes(about_z, 1, 2)
    ankle = motion.origins_m[2]
    origins = ankle + np.einsum("nij,knj->kni", turn, motion.origins_m - ankle)
    return replace(motion, rotations=turn @ motion.rotations, origins_m=origins)


def _stride_phase(left: LegMotion, right: LegMotion) -> tuple[FloatArray, FloatArray]:
    """Phase (n,) of the left foot's strides, 0 at its initial contacts, and whether the body walks (n,), 0 to 1."""
    contacts = left.events.initial_contact_s
    if len(contacts) < 2:
        return np.zeros_like(left.time_s), np.zeros_like(left.time_s)
    every = np.sort(np.concatenate([contacts, right.events.initial_contact_s]))
    usual_s = float(np.median(np.diff(contacts)))
    knots = np.concatenate(
        [contacts[0] - usual_s * np.arange(3, 0, -1), contacts, contacts[-1] + usual_s * np.arange(1, 4)]
    )
    step_s = float(left.time_s[1] - left.time_s[0])
    phase = np.interp(left.time_s, knots, 2.0 * np.pi * np.arange(len(knots)))
    ease = smooth_step((left.time_s - every[0] + 0.5 * usual_s) / (0.6 * usual_s))
    ease *= smooth_step((every[-1] + 0.5 * usual_s - left.time_s) / (0.6 * usual_s))
    return gaussian_filter1d(phase, 0.05 / step_s, mode="nearest"), ease


def _slow(time_s: FloatArray, rng: np.random.Generator, count: int) -> FloatArray:
    """Slow noise (n, count) of unit standard deviation, 0.2 to 0.8 Hz."""
    return noise_in_band(time_s, (0.2, 0.8), (count, 4), rng) * np.sqrt(0.5)


def _liveliness(leg: LegMotion) -> FloatArray:
    """How much a leg moves (n,), 0 to 1, smooth."""
    step_s = float(leg.time_s[1] - leg.time_s[0])
    speed = np.abs(np.gradient(leg.angles.knee, step_s))
    return np.minimum(gaussian_filter1d(np.minimum(speed, 1.0), 0.3 / step_s), 1.0)


def lunge(
    legs: Mapping[Side, Leg], recording: FreeMotion, time_s: FloatArray, rng: np.random.Generator
) -> tuple[PelvisMotion, dict[Side, LegMotion]]:
    """Give lunges left and right in turn, with a half turn of the body after every second one."""
    count = max(1, int(recording.duration_s // LUNGE_S))
    down = {side: np.zeros_like(time_s) for side in Side}
    for k in range(count):
        u = (time_s - k * LUNGE_S) / LUNGE_S
        down[list(Side)[k % 2]] += rng.uniform(0.85, 1.0) * smooth_step(u / 0.45) * smooth_step((1.0 - u) / 0.45)
    deep = down[Side.LEFT] + down[Side.RIGHT]
    facing = sum(np.pi * smooth_step((time_s - 2 * k * LUNGE_S + 0.4) / 0.8) for k in range(1, count // 2 + 1))
    facing = np.zeros_like(time_s) + facing
    wobble = np.deg2rad(1.5) * _slow(time_s, rng, 3).T * np.minimum(deep, 1.0)
    rotations = rotation_about(Z_AXIS, facing + wobble[2]) @ rotation_about(Y_AXIS, 0.15 * deep + wobble[1])
    rotations = rotations @ rotation_about(X_AXIS, wobble[0])
    ahead = np.stack([np.cos(facing), np.sin(facing), np.zeros_like(facing)], axis=-1)
    centre = LUNGE_M[0] * deep[:, None] * ahead + np.array([0.0, 0.0, 0.92]) + np.outer(deep, [0.0, 0.0, LUNGE_M[2]])
    pelvis = PelvisMotion(time_s, rotations, centre)
    motions = {}
    for side, leg in legs.items():
        front, back = down[side], down[side.other]
        knee = leg.standing_knee_rad + leg.knee_gain * np.deg2rad(85.0 * front + 75.0 * back)
        ankle = leg.ankle_gain * np.deg2rad(12.0 * front + 5.0 * back)
        nothing = np.zeros_like(time_s)
        angles = JointAngles(knee=knee, ankle=ankle, inversion=nothing, rotation=nothing)
        abduction = leg.outward * np.deg2rad(3.0) * deep
        thigh = rotation_about(Z_AXIS, facing) @ rotation_about(X_AXIS, abduction)
        thigh = thigh @ rotation_about(Y_AXIS, -np.deg2rad(70.0 * front - 12.0 * back))
        turned, origins = hang_from_hip(leg, thigh, hip_m(pelvis, side), angles)
        motions[side] = LegMotion(time_s, angles, turned, origins, NO_EVENTS, np.empty((0, 2)))
    return pelvis, motions


def is_lunging(required: object) -> bool:
    """Whether a recording is one of lunges, which only a body with a pelvis makes."""
    return isinstance(required, FreeMotion) and required.motion is Motion.LUNGES


def pelvis_poses(
    pelvis: PelvisMotion,
    contacts_s: FloatArray,
    mounting: Mounting,
    tissue: Tissue,
    strap: np.random.Generator,
    rng: np.random.Generator,
) -> tuple[FloatArray, FloatArray]:
    """Give earth from sensor (n, 3, 3) and place (n, 3), m; `strap` is alike in all recordings of a strapping."""
    if tissue is Tissue.RIGID:
        ridden = pelvis.rotations
    else:
        size = REAL_PELVIS_RAD if tissue is Tissue.REAL else SOFT_PELVIS_RAD
        v = pelvis.rotations
        lean = np.stack([np.arcsin(v[:, 2, 1]), -np.arcsin(v[:, 2, 0])], axis=-1)
        drives = (lean - lean.mean(axis=0)) / np.maximum(lean.std(axis=0), np.deg2rad(1.0))
        follows = drives @ strap.normal(size=(2, 3)) / np.sqrt(2.0)
        turn = size * np.sqrt(0.5) * (follows + _slow(pelvis.time_s, rng, 3) * np.sqrt(0.5))
        if tissue is Tissue.REAL:
            direction = strap.normal(size=3)
            ring = ring_after(
                pelvis.time_s, contacts_s, np.ones(len(contacts_s)), strap.uniform(*RING_HZ), RING_DECAY_S
            )
            turn = turn + REAL_RING_RAD * ring[:, None] * direction
        ridden = pelvis.rotations @ _small_turn(turn)
    place = pelvis.centre_m + np.einsum("nij,j->ni", ridden, mounting.place_m)
    return ridden @ mounting.segment_from_sensor, place


def thigh_on_tissue(motion: LegMotion, outward: float, strap: np.random.Generator) -> FloatArray:
    """Give the rotation (n, 3, 3) of a thigh's sensor by pitch: 7-15 % behind, rolled 1.7 and turned 4-9 deg."""
    pitch = -np.arcsin(np.clip(motion.rotations[0, :, 2, 0], -1.0, 1.0))
    share = pitch / max(float(np.std(pitch)), np.deg2rad(3.0))
    length_rad = strap.uniform(*REAL_THIGH_LENGTH_RAD) / 2.0
    gain, roll = strap.uniform(*REAL_THIGH_GAIN), REAL_THIGH_ROLL_RAD * strap.choice([-1.0, 1.0])
    turn = np.stack([roll * share * np.sqrt(0.5), gain * pitch, outward * length_rad * share * np.sqrt(0.5)], axis=-1)
    return _small_turn(turn)


def _small_turn(v: FloatArray) -> FloatArray:
    """Rotation matrices (n, 3, 3) of rotation vectors (n, 3)."""
    x, y, z = v.T
    return rotation_about(Z_AXIS, z) @ rotation_about(Y_AXIS, y) @ rotation_about(X_AXIS, x)


def hip_truth(
    pelvis: PelvisMotion,
    standing: tuple[PelvisMotion, LegMotion] | None,
    leg: LegMotion,
    side: Side,
    mountings: Mapping[Site, Mounting],
    clocks: Mapping[Site, SensorClock],
    late_s: Mapping[Site, float],
) -> HipTruth:
    """What is true of one hip in one recording; `standing` gives the zero, else it is the anatomical one."""
    joint = Joint(f"{side}_hip")
    flexion, abduction = _hip_angles(pelvis, leg, side)
    if standing is not None:
        zero = [float(np.mean(values)) for values in _hip_angles(*standing, side)]
        flexion, abduction = flexion - zero[0], abduction - zero[1]
    clock = clocks[joint.distal]
    at = (clock.true_s - leg.time_s[0]) / (leg.time_s[1] - leg.time_s[0])
    outward = 1.0 if side is Side.LEFT else -1.0
    of_pelvis, of_thigh = mountings[Site.PELVIS], mountings[joint.distal]
    to_pelvis = of_pelvis.segment_from_sensor.T
    return HipTruth(
        time_s=clock.stamp_s,
        flexion_rad=interpolate(flexion, at),
        abduction_rad=interpolate(abduction, at),
        centre_proximal_m=to_pelvis @ (of_pelvis.place_m - np.array([0.0, outward * HALF_WIDTH_M, 0.0])),
        centre_distal_m=of_thigh.segment_from_sensor.T @ of_thigh.place_m,
        lag_s=late_s.get(Site.PELVIS, 0.0) - late_s.get(joint.distal, 0.0),
    )


def pelvis_truth(pelvis: PelvisMotion, clock: SensorClock) -> PelvisTruth:
    """What is true of the pelvis in one recording, at its sensor's stamps."""
    at = (clock.true_s - pelvis.time_s[0]) / (pelvis.time_s[1] - pelvis.time_s[0])
    r = pelvis.rotations
    tilt, obliquity = np.arctan2(-r[:, 2, 0], r[:, 2, 2]), np.arcsin(r[:, 2, 1])
    heading = np.unwrap(np.arctan2(r[:, 1, 0], r[:, 0, 0]))
    return PelvisTruth(clock.stamp_s, *(interpolate(values, at) for values in (tilt, obliquity, heading)))


def _hip_angles(pelvis: PelvisMotion, leg: LegMotion, side: Side) -> tuple[FloatArray, FloatArray]:
    """Flexion and abduction (n,), rad, of the thigh in the pelvis: Cardan angles about y, x', z''."""
    r = np.swapaxes(pelvis.rotations, 1, 2) @ leg.rotations[0]
    outward = 1.0 if side is Side.LEFT else -1.0
    return -np.unwrap(np.arctan2(r[:, 0, 2], r[:, 2, 2])), -outward * np.arcsin(np.clip(r[:, 1, 2], -1.0, 1.0))

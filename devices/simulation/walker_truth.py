"""What is true of a simulated session, joint by joint and foot by foot."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from core.body import LEG_JOINTS, Joint, Side, Site
from core.samples import FloatArray
from devices.simulation.walker_body import Leg, WalkerSettings
from devices.simulation.walker_motion import JointAngles, LegMotion, TrueFootEvents, ankle_rotation, knee_rotation
from devices.simulation.walker_pelvis import PelvisMotion
from devices.simulation.walker_sensors import Mounting, SensorClock, angular_rate, interpolate

FUNCTIONAL_EVERY = 5  # fine samples; the principal direction of a motion needs no more


@dataclass(frozen=True, slots=True)
class JointTruth:
    """One joint in one recording. Axes (in clinical sign) and centres (joint to sensor): (3,), in sensor axes.

    `functional_proximal`, `functional_distal`: (3,): principal direction of the bones' relative rate over the whole
    session; on a hinge it is the axis.
    `lag_s`: added to the distal sensor's stamps it brings them to the proximal sensor's clock; where clocks run at
    rates of their own, at the start.
    `time_s`, `angle_rad`: (n,): the angle, zero in the anatomical neutral position, at the proximal sensor's stamps.
    """

    axis_proximal: FloatArray
    axis_distal: FloatArray
    functional_proximal: FloatArray
    functional_distal: FloatArray
    centre_proximal_m: FloatArray
    centre_distal_m: FloatArray
    lag_s: float
    standing_rad: float  # mean angle in the session's first standing, NaN without one
    time_s: FloatArray
    angle_rad: FloatArray
    sensor_gain: float  # by what share of the angle the sensors turn further than the bones, by tissue and strapping


@dataclass(frozen=True, slots=True)
class FootTruth:
    """One foot in one recording, on the true clock.

    `footholds_m`: (i, 2): where the ankle is over the floor at each stance, the first and the last being standing.
    """

    events: TrueFootEvents
    footholds_m: FloatArray
    time_s: FloatArray
    ankle_path_m: FloatArray  # (m, 3): earth axes, z up, at the instants `time_s` (m,)

    @property
    def stride_lengths_m(self) -> FloatArray:
        """(i - 1,), stride k leads from foothold k to k + 1 and ends with initial contact k."""
        return np.asarray(np.linalg.norm(np.diff(self.footholds_m, axis=0), axis=1))


@dataclass(frozen=True, slots=True)
class RecordingTruth:
    """Joints as far as both their sensors are worn; `gyro_bias_rad_s` (3,) is the mean over the recording.

    `speed_m_s` is the mean over whole steady strides, NaN without walking.
    """

    joints: Mapping[Joint, JointTruth]
    feet: Mapping[Side, FootTruth]
    gyro_bias_rad_s: Mapping[Site, FloatArray]
    speed_m_s: float


@dataclass(frozen=True, slots=True)
class SessionTruth:
    """What is true of each recording, by name, and the accelerometers' biases (3,) by site, in sensor axes."""

    recordings: Mapping[str, RecordingTruth]
    acc_bias_m_s2: Mapping[Site, FloatArray]


@dataclass(frozen=True, slots=True)
class MovedRecording:
    """One recording as it was moved: the legs, the clocks, the mountings in force, the mean gyroscope biases."""

    name: str
    is_standing: bool
    legs: Mapping[Side, LegMotion]
    clocks: Mapping[Site, SensorClock]
    mountings: Mapping[Site, Mounting]
    gyro_bias_rad_s: Mapping[Site, FloatArray]
    gains: Mapping[Joint, float]
    pelvis: PelvisMotion | None = None


def show_truth(
    settings: WalkerSettings,
    legs: Mapping[Side, Leg],
    moved: Sequence[MovedRecording],
    acc_bias_m_s2: Mapping[Site, FloatArray],
) -> SessionTruth:
    """Give what is known of `moved` in sensor terms: rad, clinical sign, sensor axes."""
    joints = [j for j in LEG_JOINTS if j.proximal in settings.sites and j.distal in settings.sites]
    functional = {joint: _functional_axes(joint, legs[joint.side], moved) for joint in joints}
    standing = {joint: _standing_angle(joint, moved) for joint in joints}
    recordings = {}
    for take in moved:
        feet = {side: _foot(motion) for side, motion in take.legs.items()}
        recordings[take.name] = RecordingTruth(
            joints={
                joint: _joint(settings, joint, legs[joint.side], take, functional[joint], standing[joint])
                for joint in joints
            },
            feet=feet,
            gyro_bias_rad_s=take.gyro_bias_rad_s,
            speed_m_s=_speed(feet),
        )
    return SessionTruth(recordings, acc_bias_m_s2)


def _joint(
    settings: WalkerSettings,
    joint: Joint,
    leg: Leg,
    take: MovedRecording,
    functional: tuple[FloatArray, FloatArray],
    standing_rad: float,
) -> JointTruth:
    proximal, distal = take.mountings[joint.proximal], take.mountings[joint.distal]
    to_proximal, to_distal = proximal.segment_from_sensor.T, distal.segment_from_sensor.T
    axis = leg.knee_axis if joint.is_knee else leg.ankle_axis
    length = leg.thigh_m if joint.is_knee else leg.shank_m
    clock = take.clocks[joint.proximal]
    motion = take.legs[joint.side]
    at = (clock.true_s - motion.time_s[0]) / (motion.time_s[1] - motion.time_s[0])
    late_s = settings.clock_late_s
    return JointTruth(
        axis_proximal=to_proximal @ axis,
        axis_distal=to_distal @ axis,
        functional_proximal=to_proximal @ functional[0],
        functional_distal=to_distal @ functional[1],
        centre_proximal_m=to_proximal @ (proximal.place_m + np.array([0.0, 0.0, length])),
        centre_distal_m=to_distal @ distal.place_m,
        lag_s=late_s.get(joint.proximal, 0.0) - late_s.get(joint.distal, 0.0),
        standing_rad=standing_rad,
        time_s=clock.stamp_s,
        angle_rad=interpolate(_angle(joint, motion), at),
        sensor_gain=take.gains[joint],
    )


def _angle(joint: Joint, motion: LegMotion) -> FloatArray:
    return motion.angles.knee if joint.is_knee else motion.angles.ankle


def _functional_axes(joint: Joint, leg: Leg, moved: Sequence[MovedRecording]) -> tuple[FloatArray, FloatArray]:
    """Principal directions of the relative rate in both segments' axes, signed as the joint's axis."""
    axis = leg.knee_axis if joint.is_knee else leg.ankle_axis
    moments = np.zeros((2, 3, 3))
    for take in moved:
        motion = take.legs[joint.side]
        some = slice(None, None, FUNCTIONAL_EVERY)
        angles = JointAngles(*(getattr(motion.angles, k)[some] for k in ("knee", "ankle", "inversion", "rotation")))
        relative = knee_rotation(leg, angles) if joint.is_knee else ankle_rotation(leg, angles)
        distal = angular_rate(relative, float(motion.time_s[FUNCTIONAL_EVERY] - motion.time_s[0]))
        proximal = np.einsum("nij,nj->ni", relative, distal)
        moments += np.stack([proximal.T @ proximal, distal.T @ distal])
    principal = np.linalg.eigh(moments)[1][:, :, -1]
    signed = [v * np.sign(v @ axis) for v in principal]
    return signed[0], signed[1]


def _standing_angle(joint: Joint, moved: Sequence[MovedRecording]) -> float:
    for take in moved:
        if take.is_standing:
            return float(np.mean(_angle(joint, take.legs[joint.side])))
    return float("nan")


def _foot(motion: LegMotion) -> FootTruth:
    return FootTruth(motion.events, motion.footholds_m, motion.time_s, motion.origins_m[2])


def _speed(feet: Mapping[Side, FootTruth]) -> float:
    lengths, times = 0.0, 0.0
    for foot in feet.values():
        contact_s = foot.events.initial_contact_s
        lengths += float(foot.stride_lengths_m[1:-1].sum())
        times += float(contact_s[-2] - contact_s[0]) if len(contact_s) > 2 else 0.0
    return lengths / times if times > 0.0 else float("nan")


def truth_table(truth: SessionTruth) -> tuple[list[str], list[list[str]]]:
    """Header and rows for a truth.csv: the joint angles at their stamps, then the events, recording by recording."""
    joints = list(next(iter(truth.recordings.values())).joints) if truth.recordings else []
    header = ["recording", "time_s", *(f"{joint.value}_deg" for joint in joints), "side", "event"]
    rows: list[list[str]] = []
    for name, recording in truth.recordings.items():
        cells: dict[float, list[str]] = {}
        for column, joint in enumerate(joints):
            known = recording.joints[joint]
            for time_s, angle in zip(known.time_s, np.rad2deg(known.angle_rad), strict=True):
                cells.setdefault(round(float(time_s), 6), [""] * len(joints))[column] = f"{angle:.5f}"
        rows += [[name, f"{time_s:.6f}", *cells[time_s], "", ""] for time_s in sorted(cells)]
        events = [
            (float(time_s), side.value, event)
            for side, foot in recording.feet.items()
            for event in ("initial_contact", "full_contact", "heel_rise", "toe_off")
            for time_s in getattr(foot.events, f"{event}_s")
        ]
        rows += [[name, f"{time_s:.6f}", *[""] * len(joints), side, event] for time_s, side, event in sorted(events)]
    return header, rows

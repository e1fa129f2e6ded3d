"""A person of rigid segments and perfect hinges, whose sensors are made by differentiating poses numerically.

It shares no equation with the core: poses are functions of time, rates and accelerations are central differences of
them. Segment axes: x forward, y left, z up, so that knee flexion is a positive turn about y, dorsiflexion a negative.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from core.body import Joint, Segment, Side, Site
from core.results import Analysis
from core.samples import FloatArray, ImuBlock
from core.session import Recording, RecordingKind, Session
from core.signal.pair import OrientedTrack, Pair, pair_up
from core.signal.tracks import Track

GRAVITY = np.array([0.0, 0.0, 9.81])
THIGH_M, SHANK_M = 0.42, 0.43
PLACE_M = {
    Segment.THIGH: np.array([0.03, 0.06, -0.2]),
    Segment.SHANK: np.array([0.04, 0.05, -0.15]),
    Segment.FOOT: np.array([0.12, 0.01, -0.05]),
}
STRIDE_S = 1.1
DIFFERENCE_S = 1e-3

Pose = tuple[Rotation, FloatArray]


def bump(phase: FloatArray, at: float, width: float) -> FloatArray:
    return np.exp((np.cos(2 * np.pi * (phase - at)) - 1) / width)


@dataclass(frozen=True)
class Person:
    """`seed` decides how the sensors are turned and where exactly they sit. `bias` (3,) rad/s is every gyroscope's."""

    seed: int = 0
    noise: float = 1.0
    bias_rad_s: tuple[float, float, float] = (0.004, -0.006, 0.003)
    extra_turn: Rotation | None = None

    def mounting(self, site: Site) -> Rotation:
        turn = Rotation.random(rng=np.random.default_rng([self.seed, list(Site).index(site)]))
        return turn * self.extra_turn if self.extra_turn is not None else turn

    def angles(self, kind: RecordingKind, side: Side, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Thigh pitch, knee flexion, ankle dorsiflexion (n,), rad; zero in standing."""
        if kind is RecordingKind.STANDING:
            return np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
        late = 0.0 if side is Side.LEFT else 0.5
        if kind is RecordingKind.WALKING:
            p = t / STRIDE_S + late
            thigh = -np.deg2rad(5 + 22 * np.cos(2 * np.pi * (p - 0.02)))
            knee = np.deg2rad(5 + 14 * bump(p, 0.15, 0.25) + 56 * bump(p, 0.72, 0.3))
            ankle = np.deg2rad(2 + 10 * bump(p, 0.45, 0.4) - 20 * bump(p, 0.63, 0.1))
            return thigh, knee, ankle
        thigh = -np.deg2rad(30 + 20 * np.sin(2.9 * t + late) + 6 * np.sin(5.3 * t))
        knee = np.deg2rad(40 + 30 * np.sin(4.1 * t + 1 + late) + 8 * np.sin(2.3 * t))
        ankle = np.deg2rad(18 * np.sin(5.0 * t + 2 + late) + 8 * np.sin(3.1 * t))
        return thigh, knee, ankle

    def truth(self, kind: RecordingKind, joint: Joint, t: FloatArray) -> FloatArray:
        """Flexion or dorsiflexion (n,), rad."""
        return self.angles(kind, joint.side, t)[1 if joint.is_knee else 2]

    def error_deg(self, found: Analysis, name: str, joint: Joint = Joint.LEFT_KNEE) -> FloatArray:
        """Of a recording that was analysed: its angle less the truth (n,)."""
        (recording,) = (one for one in found.recordings if one.name == name)
        truth = self.truth(recording.kind, joint, recording.time_s - recording.time_s[0])
        return np.rad2deg(recording.joints[joint].angle_rad - truth)

    def _bones(self, kind: RecordingKind, side: Side, t: FloatArray) -> dict[Segment, Pose]:
        thigh, knee, ankle = self.angles(kind, side, t)
        outward = 1.0 if side is Side.LEFT else -1.0
        if kind is RecordingKind.STANDING:
            hip, roll, yaw = np.zeros((len(t), 3)), np.zeros_like(t), np.full_like(t, 0.3)
        elif kind is RecordingKind.WALKING:
            p = 2 * np.pi * t / STRIDE_S
            hip = np.stack([1.2 * t + 0.02 * np.sin(2 * p), 0.03 * np.sin(p), 0.025 * np.cos(2 * p)], axis=1)
            roll, yaw = 0.06 * np.sin(p + outward), 0.3 + 0.09 * np.sin(p + 0.4) + 0.03 * np.sin(0.9 * t)
        else:
            hip = 0.04 * np.stack([np.sin(2.2 * t), np.sin(3.4 * t + 1), np.cos(2.7 * t)], axis=1)
            roll = outward * (0.3 + 0.25 * np.sin(3.7 * t)) + 0.1 * np.sin(1.9 * t)
            yaw = 0.3 + 0.35 * np.sin(3.3 * t + outward)
        about_y = np.array([0.0, 1.0, 0.0])
        in_earth = Rotation.from_euler("ZX", np.stack([yaw, roll], axis=1)) * Rotation.from_rotvec(
            thigh[:, None] * about_y
        )
        poses: dict[Segment, Pose] = {Segment.THIGH: (in_earth, hip)}
        shank = in_earth * Rotation.from_rotvec(knee[:, None] * about_y)
        knee_m = hip + in_earth.apply([0.0, 0.0, -THIGH_M])
        poses[Segment.SHANK] = shank, knee_m
        foot = shank * Rotation.from_rotvec(-ankle[:, None] * about_y)
        poses[Segment.FOOT] = foot, knee_m + shank.apply([0.0, 0.0, -SHANK_M])
        return poses

    def pose(self, kind: RecordingKind, site: Site, t: FloatArray) -> Pose:
        """Rotation earth from sensor and place in the earth (n, 3)."""
        turned, origin = self._bones(kind, site.leg_side, t)[site.segment]
        return turned * self.mounting(site), origin + turned.apply(PLACE_M[site.segment])

    def samples(self, kind: RecordingKind, site: Site, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Exact rate and specific force (n, 3) in sensor axes, by differences of poses, extrapolated to step zero."""
        h = DIFFERENCE_S
        there = {k: self.pose(kind, site, t + k * h) for k in (-2, -1, 0, 1, 2)}

        def rate(k: int) -> FloatArray:
            return (there[-k][0].inv() * there[k][0]).as_rotvec() / (2 * k * h)

        def acceleration(k: int) -> FloatArray:
            return (there[k][1] - 2 * there[0][1] + there[-k][1]) / (k * h) ** 2

        gyr = (4 * rate(1) - rate(2)) / 3
        acc = there[0][0].inv().apply((4 * acceleration(1) - acceleration(2)) / 3 + GRAVITY)
        return gyr, acc

    def axis(self, site: Site, joint: Joint) -> FloatArray:
        """The axis (3,) in the sensor of `site`, in clinical sign."""
        return self.mounting(site).inv().apply([0.0, 1.0 if joint.is_knee else -1.0, 0.0])

    def centre_m(self, site: Site, joint: Joint) -> FloatArray:
        """From the joint to the sensor (3,) in sensor axes (eq 7)."""
        joint_m = np.zeros(3)
        if site is joint.proximal:
            joint_m = np.array([0.0, 0.0, -THIGH_M if joint.is_knee else -SHANK_M])
        return self.mounting(site).inv().apply(PLACE_M[site.segment] - joint_m)

    def recording(
        self,
        name: str,
        kind: RecordingKind,
        duration_s: float = 10.0,
        sites: tuple[Site, ...] = (Site.LEFT_THIGH, Site.LEFT_SHANK),
        rate_hz: float = 100.0,
        start_s: float = 0.0,
        is_kept: bool = True,
        is_restrapped_before: bool = False,
    ) -> Recording:
        """All sensors from `start_s` on, with noise and bias; motion begins the same wherever the clock starts."""
        t = np.arange(round(duration_s * rate_hz)) / rate_hz
        imu = {}
        for site in sites:
            gyr, acc = self.samples(kind, site, t)
            rng = np.random.default_rng([self.seed, list(Site).index(site), list(RecordingKind).index(kind)])
            turn = self.extra_turn.inv().as_matrix().T if self.extra_turn is not None else np.eye(3)
            # what a sensor adds turns with it
            gyr = gyr + (self.bias_rad_s + self.noise * 0.001 * rng.normal(size=gyr.shape)) @ turn
            acc = acc + (self.noise * 0.015 * rng.normal(size=acc.shape)) @ turn
            imu[site] = ImuBlock(f"sensor of {site}", t + start_s, gyr, acc)
        folder = name.replace(" ", "_")
        return Recording(
            name, kind, folder, imu, is_kept=is_kept, is_restrapped_before=is_restrapped_before, started=f"{start_s}"
        )

    def visit(
        self,
        sites: tuple[Site, ...] = (Site.LEFT_THIGH, Site.LEFT_SHANK),
        rate_hz: float = 100.0,
        duration_s: float = 10.0,
        start_s: float = 0.0,
        kinds: tuple[RecordingKind, ...] = tuple(RecordingKind),
    ) -> Session:
        """One recording of each kind, one after the other, named standing, free motion and walk."""
        names = {
            RecordingKind.STANDING: ("standing", 3.0),
            RecordingKind.FREE_MOTION: ("free motion", duration_s),
            RecordingKind.WALKING: ("walk", duration_s),
        }
        recordings = []
        for kind in kinds:
            name, lasts_s = names[kind]
            recordings.append(self.recording(name, kind, lasts_s, sites, rate_hz, start_s))
            start_s += lasts_s + 20.0
        return Session(tuple(recordings))

    def exact_pair(
        self,
        joint: Joint,
        kind: RecordingKind = RecordingKind.FREE_MOTION,
        duration_s: float = 6.0,
        rate_hz: float = 100.0,
        heading_rad: float = 0.0,
    ) -> Pair:
        """Both sensors without any error, the distal one's earth turned by -`heading_rad` about the vertical."""
        t = np.arange(round(duration_s * rate_hz)) / rate_hz
        tracks = []
        for site in (joint.proximal, joint.distal):
            gyr, acc = self.samples(kind, site, t)
            track = Track(0.0, 1 / rate_hz, gyr, acc, None, None, np.ones(len(t), dtype=bool))
            turned = self.pose(kind, site, t)[0]
            if site is joint.distal:
                turned = Rotation.from_rotvec([0.0, 0.0, -heading_rad]) * turned
            tracks.append(OrientedTrack(track, turned.as_quat(scalar_first=True)))
        pair = pair_up(tracks[0], tracks[1], 0.0)
        assert pair is not None
        return pair


PERSON = Person()

"""Input of every method of the comparison. Recordings of one joint with its truth, the same samples for all."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from core.body import Joint, Site
from core.calibration.rate_kind import tracks_of_kind
from core.samples import FloatArray, ImuBlock, RateKind
from core.session import Recording, RecordingKind, Session
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings, simulate

JOINTS = (Joint.LEFT_KNEE, Joint.LEFT_ANKLE)
STRIDES_PER_MINUTE = 54
HINGES = ("1D_02", "1D_03")


@dataclass(frozen=True, slots=True)
class Truth:
    """Axes (3,) in clinical sign, the angle (n,) at `time_s`, and what it is in standing (NaN without standing).

    A human joint's true axis is the functional one. `is_clock_shared`: where not, the reference is another system's,
    and its time offset of up to two samples is fitted before scoring.
    """

    axis_1: FloatArray
    axis_2: FloatArray
    time_s: FloatArray
    angle_rad: FloatArray
    standing_rad: float
    is_clock_shared: bool


@dataclass(frozen=True, slots=True)
class Trial:
    """One joint in one recording: as a session for Gaitwright, and as bare arrays for the others.

    Rates `g1`, `g2` (n, 3) are free of the bias that rest shows; `down_1`, `down_2` (3,): mean specific force in
    standing, None without standing.
    """

    group: str
    joint: Joint
    session: Session
    recording: str
    step_s: float
    rate_kind: RateKind
    g1: FloatArray
    g2: FloatArray
    a1: FloatArray
    a2: FloatArray
    down_1: FloatArray | None
    down_2: FloatArray | None
    truth: Truth

    @property
    def kind(self) -> str:
        return "knee" if self.joint.is_knee else "ankle"


def simulated_trials(seeds: range, minutes: float = 1.0, joints: Sequence[Joint] = JOINTS) -> Iterator[Trial]:
    """Circling and walking, rigid and with soft tissue, knee and ankle, after 3 s of standing."""
    motions: dict[str, FreeMotion | Walk] = {
        "circling": FreeMotion("minute", duration_s=60.0 * minutes),
        "walking": Walk("minute", strides=round(STRIDES_PER_MINUTE * minutes)),
    }
    sites = tuple(dict.fromkeys(site for joint in joints for site in (joint.proximal, joint.distal)))
    for name, motion in motions.items():
        for tissue in (Tissue.RIGID, Tissue.SOFT):
            for seed in seeds:
                settings = WalkerSettings(seed=seed, recordings=(Standing(), motion), sites=sites, tissue=tissue)
                made = simulate(settings)
                for joint in joints:
                    true = made.truth.recordings["minute"].joints[joint]
                    axes = true.functional_proximal, true.functional_distal
                    truth = Truth(*axes, true.time_s, true.angle_rad, true.standing_rad, is_clock_shared=True)
                    yield _trial(f"{name}, {tissue.value}", joint, _of_two_sensors(made.session, joint), truth)


def hinge_trials() -> Iterator[Trial]:
    """Two sensors on a mechanical hinge against optics, where GAITWRIGHT_TEST_DATA names the shared recordings."""
    reported = os.environ.get("GAITWRIGHT_TEST_DATA")
    for name in HINGES if reported else ():
        with np.load(Path(str(reported)) / "hinge_mechanical" / f"{name}.npz") as archive:
            data = {key: np.asarray(archive[key], dtype=float) for key in archive.files}
        time_s = np.arange(len(data["acc1"])) / float(data["fs"])
        sites = (Site.LEFT_THIGH, Site.LEFT_SHANK)
        imu = {s: ImuBlock(str(s), time_s, data[f"gyr{k}"], data[f"acc{k}"]) for k, s in enumerate(sites, start=1)}
        session = Session((Recording("minute", RecordingKind.FREE_MOTION, "minute", imu),))
        is_seen = data["ref_ok"] > 0
        angle_rad = np.where(is_seen, np.unwrap(data["angle_ref_rad"]), np.nan)
        truth = Truth(data["j1_ref"], data["j2_ref"], time_s, angle_rad, np.nan, is_clock_shared=False)
        yield _trial("mechanical hinge, optics", Joint.LEFT_KNEE, session, truth)


def _of_two_sensors(session: Session, joint: Joint) -> Session:
    sites = (joint.proximal, joint.distal)
    recordings = tuple(replace(r, imu={site: r.imu[site] for site in sites}) for r in session.recordings)
    return replace(session, recordings=recordings, sensors={site: session.sensors[site] for site in sites})


def _trial(group: str, joint: Joint, session: Session, truth: Truth) -> Trial:
    (recording,) = (r for r in session.recordings if r.kind is not RecordingKind.STANDING)
    tracks, _ = tracks_of_kind(session, session.recordings, frozenset())
    reported_kind = {info.rate_kind for info in session.sensors.values()} - {None}
    rate_kind = reported_kind.pop() if reported_kind else tracks.rate_kind
    assert rate_kind is not None
    one, two = (recording.imu[site] for site in (joint.proximal, joint.distal))
    down: list[FloatArray | None] = [None, None]
    for standing in session.recordings:
        if standing.kind is RecordingKind.STANDING:
            down = [np.mean(standing.imu[site].acc_m_s2, axis=0) for site in (joint.proximal, joint.distal)]
    return Trial(
        group=group,
        joint=joint,
        session=session,
        recording=recording.name,
        step_s=float(np.mean(np.diff(one.time_s))),
        rate_kind=rate_kind,
        g1=one.gyr_rad_s - tracks.gyro_bias(recording, joint.proximal).rad_s,
        g2=two.gyr_rad_s - tracks.gyro_bias(recording, joint.distal).rad_s,
        a1=one.acc_m_s2,
        a2=two.acc_m_s2,
        down_1=down[0],
        down_2=down[1],
        truth=truth,
    )

"""For every finding of the core one simulated session in which it must come."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from core.analysis import analyse
from core.body import LEG_SITES, Joint, Side, Site
from core.findings import Finding
from core.gait.chosen_strides import leave_out
from core.prosthesis import FootKind, Prosthesis
from core.results import Method
from core.samples import BoolArray, FloatArray, ImuBlock, RateKind
from core.session import RecordingKind, Session
from core.timed.protocols import PlannedTest, TimedProtocol
from core.verdicts.quality import look_at
from devices.simulation.walker import (
    CourseKind,
    FreeMotion,
    Manner,
    Motion,
    Standing,
    TimedCourse,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)

LEFT = tuple(site for site in LEG_SITES if site.side is Side.LEFT)
THIGH, SHANK, FOOT = LEFT
KNEE = Joint.LEFT_KNEE
BRIEF = (Standing(), FreeMotion(duration_s=5.0), Walk(strides=5))
Change = Callable[[ImuBlock], ImuBlock]


@dataclass(frozen=True, slots=True)
class Case:
    """How to make the session, and what reports the finding: the look at the samples alone, or a whole analysis."""

    build: Callable[[], Session]
    is_of_samples: bool = False
    method: Method = Method.ROBUST

    def findings(self) -> tuple[Finding, ...]:
        session = self.build()
        if self.is_of_samples:
            return look_at(session).findings
        return leave_out(analyse(session, self.method), session.recordings).findings


def of_samples(change: Change, site: Site = SHANK, recording: str = "walk 1") -> Case:
    """A session of one leg in which one sensor of one recording is spoiled."""
    return Case(lambda: changed(walked(sites=LEFT), change, (site,), (recording,)), is_of_samples=True)


def walked(**settings: object) -> Session:
    return simulate(WalkerSettings(**{"seed": 3, "recordings": BRIEF, **settings})).session  # type: ignore[arg-type]  # names of fields


def changed(session: Session, change: Change, sites: tuple[Site, ...], names: tuple[str, ...] = ()) -> Session:
    """The session with the samples of some sites, in some or in all recordings, changed."""
    recordings = tuple(
        replace(r, imu={s: change(b) if s in sites and (not names or r.name in names) else b for s, b in r.imu.items()})
        for r in session.recordings
    )
    return replace(session, recordings=recordings)


def part(block: ImuBlock, here: BoolArray | slice) -> ImuBlock:
    return replace(block, time_s=block.time_s[here], gyr_rad_s=block.gyr_rad_s[here], acc_m_s2=block.acc_m_s2[here])


def scaled(time: float = 1.0, gyr: float = 1.0, acc: float = 1.0) -> Change:
    return lambda b: replace(b, time_s=time * b.time_s, gyr_rad_s=gyr * b.gyr_rad_s, acc_m_s2=acc * b.acc_m_s2)


def lost(share: float) -> Change:
    """Samples missing one by one."""
    return lambda b: part(b, np.random.default_rng(0).random(len(b)) >= share)


def hole(b: ImuBlock) -> ImuBlock:
    return part(b, (b.time_s < 3.0) | (b.time_s > 3.6))


def paused(b: ImuBlock) -> ImuBlock:
    return part(b, (b.time_s < 3.0) | (b.time_s > 6.0))


def frozen(b: ImuBlock) -> ImuBlock:
    """The samples of half a second in swing all alike."""
    fastest = int(np.argmax(np.linalg.norm(b.gyr_rad_s, axis=1)))
    gyr, acc = b.gyr_rad_s.copy(), b.acc_m_s2.copy()
    gyr[fastest : fastest + 50], acc[fastest : fastest + 50] = gyr[fastest], acc[fastest]
    return replace(b, gyr_rad_s=gyr, acc_m_s2=acc)


def spiked(b: ImuBlock) -> ImuBlock:
    return replace(b, gyr_rad_s=np.where(np.arange(len(b))[:, None] == 200, 1e4, b.gyr_rad_s))


def holding_one_value(b: ImuBlock) -> ImuBlock:
    return replace(b, gyr_rad_s=np.full_like(b.gyr_rad_s, 0.02))


def clipped(b: ImuBlock) -> ImuBlock:
    return replace(b, gyr_rad_s=np.clip(b.gyr_rad_s, -2.0, 2.0))


def copied() -> Session:
    made = walked(sites=LEFT)
    copies = (replace(r, imu={**r.imu, FOOT: replace(r.imu[SHANK], sensor="copy")}) for r in made.recordings)
    return replace(made, recordings=tuple(copies))


def exchanged(new: Mapping[Site, Site]) -> Session:
    """Sensors worn at other sites than they are labelled with."""
    made = walked(recordings=(Standing(), FreeMotion(), Walk()))
    recordings = (replace(r, imu={s: r.imu[new.get(s, s)] for s in r.imu}) for r in made.recordings)
    return replace(made, recordings=tuple(recordings))


def strangers() -> Session:
    """A thigh and a shank of two people."""
    one, other = (walked(seed=seed, sites=(THIGH, SHANK)) for seed in (3, 4))
    recordings = (
        replace(a, imu={THIGH: a.imu[THIGH], SHANK: b.imu[SHANK]})
        for a, b in zip(one.recordings, other.recordings, strict=True)
    )
    return replace(one, recordings=tuple(recordings))


def recordings_of(session: Session, *kinds: RecordingKind) -> Session:
    return replace(session, recordings=tuple(r for r in session.recordings if r.kind in kinds))


def unknown_rate_kind() -> Session:
    made = walked(rate_kind=RateKind.AVERAGED, rate_hz=60.0)
    return replace(made, sensors={site: replace(info, rate_kind=None) for site, info in made.sensors.items()})


def without_site_in_standing() -> Session:
    made = walked(sites=LEFT)
    first, *others = made.recordings
    return replace(made, recordings=(replace(first, imu={FOOT: first.imu[FOOT]}), *others))


def slipped() -> Session:
    """The right shank's sensor turned by 20 deg about the shank, 22 s into a walk."""
    made = walked(seed=5, tissue=Tissue.SOFT, recordings=(Standing(), FreeMotion(), Walk(strides=32)))
    up = made.recordings[0].imu[Site.RIGHT_SHANK].acc_m_s2.mean(axis=0)
    x, y, z = up / np.linalg.norm(up)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + np.sin(np.deg2rad(20.0)) * cross + (1.0 - np.cos(np.deg2rad(20.0))) * cross @ cross

    def turned(b: ImuBlock) -> ImuBlock:
        late = b.time_s[:, None] >= 22.0
        gyr, acc = (np.where(late, v @ turn.T, v) for v in (b.gyr_rad_s, b.acc_m_s2))
        return replace(b, gyr_rad_s=gyr, acc_m_s2=acc)

    return changed(made, turned, (Site.RIGHT_SHANK,), ("walk 1",))


def one_side_shown() -> Session:
    """Only the left foot walks."""
    walk = walked(recordings=(Standing(), Walk(strides=8)))
    stood = walked(recordings=(Standing("walk 1", duration_s=12.0),))
    right = {s: b for s, b in stood.recordings[0].imu.items() if s.side is Side.RIGHT}
    standing, walking = walk.recordings
    return replace(walk, recordings=(standing, replace(walking, imu={**walking.imu, **right})))


def standing_called_walk() -> Session:
    made = walked(recordings=(Standing(), Standing("walk 1", duration_s=8.0)))
    standing, walk = made.recordings
    return replace(made, recordings=(standing, replace(walk, kind=RecordingKind.WALKING)))


def chosen_strides() -> Session:
    made = walked(recordings=(Standing(), Walk(strides=6)))
    standing, walk = made.recordings
    found = analyse(made).recordings[0].gait[Side.LEFT].strides
    middle = 0.5 * float(found.start_s[1] + found.end_s[1])
    return replace(made, recordings=(standing, replace(walk, left_out_s={Side.LEFT: (middle,)})))


def few_on_one_side() -> Session:
    """The right foot's sensor is silent in the second half of a walk."""
    made = walked(recordings=(Standing(), Walk(strides=16)))
    return changed(made, lambda b: part(b, b.time_s < 11.0), (Site.RIGHT_FOOT, Site.RIGHT_SHANK), ("walk 1",))


def angles_with_gaps() -> Session:
    """The thigh's sensor is silent for 0.3 s in every second."""
    made = walked(recordings=(Standing(), FreeMotion(), Walk(strides=8)))
    return changed(made, lambda b: part(b, b.time_s % 0.9 > 0.3), (THIGH,), ("walk 1",))


def turned_sign(sign: int) -> Session:
    return replace(walked(sites=LEFT), turned_sign={KNEE: sign})


def derived(b: ImuBlock) -> ImuBlock:
    return replace(b, is_rate_derived=True)


def late_in_the_walk() -> Session:
    return changed(walked(), lambda b: replace(b, time_s=b.time_s + 0.03), (SHANK,), ("walk 1",))


def on_after_stop(offset_s: float) -> Change:
    return lambda b: replace(b, time_s=b.time_s + offset_s)


def shaken(b: ImuBlock) -> ImuBlock:
    return replace(b, gyr_rad_s=b.gyr_rad_s + np.sin(2 * np.pi * 5.0 * b.time_s)[:, None])


def lying_called_standing() -> Session:
    """At rest the person lies on the side, so that the knee's axis is upright where it should be level."""
    made = simulate(WalkerSettings(3, (Standing(), Walk(strides=5)), (THIGH, SHANK), tissue=Tissue.SOFT))
    reported = made.truth.recordings["standing"].joints[KNEE]
    lying = made.session
    for site, axis in ((THIGH, reported.axis_proximal), (SHANK, reported.axis_distal)):
        lying = changed(lying, partial(_upright, axis), (site,), ("standing",))
    return lying


def _upright(axis: FloatArray, b: ImuBlock) -> ImuBlock:
    return replace(b, acc_m_s2=b.acc_m_s2 - np.mean(b.acc_m_s2, axis=0) + 9.81 * axis)


def discarded() -> Session:
    made = walked(sites=LEFT)
    *others, walk = made.recordings
    return replace(made, recordings=(*others, replace(walk, is_kept=False)))


def turned_unseen_by_the_pelvis() -> Session:
    course = TimedCourse(CourseKind.UP_AND_GO, seed=3, name="walk 1")
    recordings = (Standing(), Walk(name="walk 0", strides=8, turn_rad=3.1), course)
    session = walked(recordings=recordings, sites=tuple(Site))
    *before, timed = session.recordings
    planned = replace(timed, test=PlannedTest(TimedProtocol.UP_AND_GO))
    session = replace(session, recordings=(*before, planned))
    return changed(session, lambda b: replace(b, gyr_rad_s=0.1 * b.gyr_rad_s), (Site.PELVIS,), ("walk 1",))


def walked_backward() -> Session:
    """A walk played from its end: the same accelerations, all rates turned round."""
    made = walked(recordings=(Standing(), Walk(strides=12)))
    standing, walk = made.recordings
    imu = {
        site: replace(block, gyr_rad_s=-block.gyr_rad_s[::-1], acc_m_s2=block.acc_m_s2[::-1])
        for site, block in walk.imu.items()
    }
    return replace(made, recordings=(standing, replace(walk, imu=imu)))


FREE_ONLY = (Standing(), FreeMotion())
LYING = (Standing(), FreeMotion(motion=Motion.SIDE_LYING))
KNEE_ONLY = (Standing(), FreeMotion(motion=Motion.KNEE_ONLY, duration_s=5.0))
S, F, W = RecordingKind.STANDING, RecordingKind.FREE_MOTION, RecordingKind.WALKING

CASES: dict[str, Case] = {
    # of the samples
    "too_few_samples": of_samples(lambda b: part(b, slice(0, 5))),
    "time_in_ms": of_samples(scaled(time=1000.0)),
    "all_zero": of_samples(scaled(gyr=0.0, acc=0.0)),
    "acc_in_g": of_samples(scaled(acc=1 / 9.81)),
    "acc_implausible": of_samples(scaled(acc=100.0)),
    "acc_reversed": of_samples(scaled(acc=-1.0), recording="free motion"),
    "rate_in_deg_s": of_samples(scaled(gyr=180 / np.pi)),
    "impossible_values": of_samples(spiked),
    "stuck": of_samples(frozen),
    "stuck_throughout": of_samples(holding_one_value),
    "bridged": of_samples(lost(0.03)),
    "gaps": of_samples(hole),
    "many_gaps": of_samples(lost(0.6)),
    "pause": Case(lambda: changed(walked(sites=LEFT), paused, LEFT, ("walk 1",)), is_of_samples=True),
    "every_second_lost": of_samples(lambda b: part(b, slice(None, None, 2))),
    "rate_off": of_samples(scaled(time=1.05)),
    "low_rate": of_samples(lambda b: part(b, slice(None, None, 5))),
    "clipped": of_samples(clipped),
    "moved_while_standing": of_samples(shaken, recording="standing"),
    "clock_jumps": of_samples(lambda b: replace(b, time_s=b.time_s + 3600.0 * (b.time_s > np.median(b.time_s)))),
    "clock_offset": of_samples(on_after_stop(30.0)),
    "same_data": Case(copied, is_of_samples=True),
    "missing_site": Case(lambda: walked(sites=(THIGH,)), is_of_samples=True),
    "recording_discarded": Case(discarded, is_of_samples=True),
    # of the session
    "simulated": Case(lambda: walked(recordings=(Standing(), Walk(strides=3)), sites=(FOOT,))),
    "no_standing": Case(lambda: walked(recordings=(Walk(strides=4),), sites=LEFT)),
    "restrapped": Case(lambda: walked(recordings=(Standing(), Walk(strides=3, is_restrapped_before=True)))),
    "rate_from_orientation": Case(lambda: changed(walked(sites=LEFT), derived, (SHANK,))),
    "rate_kind_found": Case(unknown_rate_kind),
    "feet_only": Case(lambda: walked(sites=(FOOT, Site.RIGHT_FOOT))),
    "no_joint": Case(lambda: walked(sites=(THIGH, FOOT))),
    "joint_left_out": Case(lambda: changed(walked(sites=LEFT), scaled(acc=0.1), (THIGH,))),
    "too_little_motion": Case(standing_called_walk),
    # of the joints
    "is_a_hinge": Case(lambda: walked(sites=LEFT)),
    "not_a_hinge": Case(lambda: walked(sites=LEFT, tissue=Tissue.SOFT)),
    "centre_unknown": Case(lambda: walked(sites=LEFT, tissue=Tissue.REAL)),
    "sign_in_doubt": Case(strangers),
    "not_the_same_joint": Case(strangers),
    "published_sign_unsure": Case(strangers, method=Method.PUBLISHED),
    "published_differs": Case(lambda: walked(sites=LEFT, tissue=Tissue.REAL, recordings=LYING)),
    "clinical_sign_uncertain": Case(lambda: walked(recordings=FREE_ONLY, sites=(SHANK, FOOT))),
    "sign_confirmed": Case(lambda: turned_sign(1)),
    "sign_turned": Case(lambda: turned_sign(-1)),
    "gyro_bias_unknown": Case(lambda: changed(walked(sites=LEFT), shaken, (SHANK,))),
    "zero_unknown": Case(without_site_in_standing),
    "zero_from_goniometer": Case(lambda: replace(walked(sites=LEFT), zero_rad={KNEE: 0.1})),
    "goniometer_without_standing": Case(lambda: replace(recordings_of(walked(sites=LEFT), F, W), zero_rad={KNEE: 0.1})),
    "calibration_after_walk": Case(lambda: walked(recordings=(Standing(), Walk(strides=4), FreeMotion()), sites=LEFT)),
    "axis_from_walking": Case(lambda: walked(recordings=(Standing(), Walk(strides=5)), sites=LEFT)),
    "axis_uncertain": Case(lambda: walked(sites=LEFT, tissue=Tissue.SOFT, recordings=KNEE_ONLY)),
    "flexion_did_not_dominate": Case(lying_called_standing),
    "lag_corrected": Case(lambda: walked(clock_late_s={SHANK: 0.03})),
    "clock_moved": Case(late_in_the_walk),
    "clock_drifts": Case(lambda: walked(recordings=(Standing(), Walk(strides=12)), clock_rate={SHANK: 1.02})),
    "ankle_axis_from_rates": Case(lambda: walked(sites=(SHANK, FOOT))),
    "labels_look_swapped": Case(lambda: exchanged({SHANK: Site.RIGHT_SHANK, Site.RIGHT_SHANK: SHANK})),
    "labels_look_mixed": Case(lambda: exchanged({THIGH: SHANK, SHANK: FOOT, FOOT: THIGH})),
    "strap_slipped": Case(slipped),
    "turns_contradict": Case(turned_unseen_by_the_pelvis),
    # of the strides
    "no_strides": Case(standing_called_walk),
    "side_without_strides": Case(one_side_shown),
    "events_from_shank": Case(lambda: walked(sites=(THIGH, SHANK))),
    "prosthetic_toe_off": Case(lambda: walked(prosthetic_side=Side.LEFT)),
    "foot_against_shank": Case(lambda: walked(prosthetic_side=Side.LEFT, fitted=Prosthesis(foot=FootKind.SACH))),
    "no_mean": Case(lambda: walked(recordings=(Standing(), Walk(strides=3)))),
    "no_spread": Case(lambda: walked(recordings=(Standing(), Walk(strides=6)))),
    "no_spread_of_side": Case(few_on_one_side),
    "angle_without_mean": Case(angles_with_gaps),
    "no_peak": Case(lambda: walked(recordings=(Standing(), Walk(strides=8, manner=Manner.TOES, speed_m_s=0.8)))),
    "doubtful_strides": Case(walked_backward),
    "strides_all_left_out": Case(lambda: changed(walked(), lost(0.5), (FOOT,), ("walk 1",))),
    "strides_left_out_by_hand": Case(chosen_strides),
}

"""A forward-kinematic patient with both legs, up to six sensors and every truth known.

The poses of the segments are prescribed; rates and accelerations come from differentiating them numerically. No
equation of the estimator is used here, so that the two can disagree.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from core.body import LEG_JOINTS, Joint, Segment, Side, Site
from core.prosthesis import stated_only
from core.samples import FloatArray, ImuBlock, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from devices.simulation.walker_body import (
    COARSE,
    NO_CHANGE,
    NO_ERRORS,
    PEOPLE,
    VERY_COARSE,
    CourseKind,
    FreeMotion,
    GaitChange,
    Leg,
    Manner,
    Motion,
    SensorErrors,
    Standing,
    TimedCourse,
    Tissue,
    Treadmill,
    Variation,
    Walk,
    WalkerSettings,
    make_leg,
    set_up,
)
from devices.simulation.walker_course_pelvis import course_pelvis
from devices.simulation.walker_courses import walk_course
from devices.simulation.walker_gait import walk_leg
from devices.simulation.walker_motion import Z_AXIS, LegMotion, move_freely, rotation_about, sway_of
from devices.simulation.walker_pelvis import (
    REAL_THIGH_WOBBLE,
    PelvisMotion,
    is_lunging,
    lunge,
    pelvis_poses,
    thigh_on_tissue,
    with_pelvis,
)
from devices.simulation.walker_plan import plan_standing, plan_walk
from devices.simulation.walker_prosthesis import AS_BUILT, ProsthesisSetting
from devices.simulation.walker_sensors import (
    SEGMENT_ROW,
    Mounting,
    Ride,
    SensorClock,
    SensorFaults,
    draw_faults,
    draw_mounting,
    draw_ride,
    make_clock,
    record,
    sensor_poses,
    turn_in_step,
)
from devices.simulation.walker_strap import on_loose_strap
from devices.simulation.walker_treadmill import on_treadmill
from devices.simulation.walker_truth import (
    FootTruth,
    JointTruth,
    MovedRecording,
    RecordingTruth,
    SessionTruth,
    show_truth,
    truth_table,
)
from devices.simulation.walker_variation import NO_CHANGES, StepChanges, draw_changes, draw_gain, follow_joint

__all__ = [
    "AS_BUILT",
    "COARSE",
    "DEMONSTRATION",
    "NO_CHANGE",
    "NO_ERRORS",
    "PEOPLE",
    "VERY_COARSE",
    "CourseKind",
    "FootTruth",
    "FreeMotion",
    "GaitChange",
    "JointTruth",
    "Manner",
    "Motion",
    "ProsthesisSetting",
    "RecordingTruth",
    "SensorErrors",
    "SessionTruth",
    "SimulatedSession",
    "Standing",
    "TimedCourse",
    "Tissue",
    "Treadmill",
    "Variation",
    "Walk",
    "WalkerSettings",
    "simulate",
    "truth_table",
]

# The patient that the application shows; ten strides of each foot and more make a spread.
DEMONSTRATION = WalkerSettings(seed=1, tissue=Tissue.SOFT, recordings=(Standing(), FreeMotion(), Walk(strides=14)))

FINE_HZ = 1000.0  # least rate of the fine clock: differences of fourth order are then far below the sensors' noise
MARGIN_S = 0.25  # the fine clock runs on by this at both ends, for lags, averaging and differences
MAX_LATE_S = 0.2  # what the margin leaves for a clock


@dataclass(frozen=True, slots=True)
class StrappedSensors:
    """How the sensors were strapped before recording `strapping`; `gains` as in `JointTruth`."""

    strapping: int
    mountings: Mapping[Site, Mounting]
    gains: Mapping[Joint, float]


@dataclass(frozen=True, slots=True)
class SimulatedSession:
    """A session as sensors would have recorded it, what is true of it, and how each recording was moved."""

    session: Session
    truth: SessionTruth
    moved: tuple[MovedRecording, ...]


def simulate(settings: WalkerSettings) -> SimulatedSession:
    """All recordings of one session; the same settings give the same samples.

    Raises
    ------
    ValueError
        Two recordings of one name; a clock that is off by more than 0.2 s.
    """
    names = [required.name for required in settings.recordings]
    if len(set(names)) < len(names):
        raise ValueError(f"recordings need names of their own, got {names}")
    if any(abs(late_s) > MAX_LATE_S for late_s in settings.clock_late_s.values()):
        raise ValueError(f"clock_late_s is {dict(settings.clock_late_s)}, expected at most {MAX_LATE_S} s")
    legs = {side: make_leg(settings, side) for side in Side}
    faults = {site: draw_faults(settings.errors_of(site), _rng(settings, 2, _index(site))) for site in settings.sites}
    start_faults = faults
    strapping = 0
    mountings = _mount(settings, strapping)
    rides: dict[tuple[Site, RecordingKind], Ride] = {}
    recordings: list[Recording] = []
    moved: list[MovedRecording] = []
    for number, required in enumerate(settings.recordings):
        if required.is_restrapped_before:
            strapping = number
            mountings, rides = _mount(settings, strapping), {}
        soft = [joint for joint in LEG_JOINTS if not _is_bare(legs, joint.distal)]
        gains = {joint: draw_gain(settings, joint, strapping) if joint in soft else 0.0 for joint in LEG_JOINTS}
        worn = StrappedSensors(strapping, mountings, gains)
        recording, take, faults = _take(settings, number, legs, worn, faults, rides)
        recordings.append(recording)
        moved.append(take)
    truth = show_truth(settings, legs, moved, {site: fault.acc_bias_m_s2 for site, fault in start_faults.items()})
    return SimulatedSession(_session(settings, recordings), truth, tuple(moved))


def _session(settings: WalkerSettings, recordings: list[Recording]) -> Session:
    prosthetic = settings.prosthetic_side.value if settings.prosthetic_side else "none"
    stiff = settings.stiff_knee_side.value if settings.stiff_knee_side else prosthetic
    sensors = {
        site: SensorInfo(
            serial=f"DEMO-{site.value}",
            model="simulated",
            rate_hz=settings.site_rates_hz.get(site, settings.rate_hz),
            rate_kind=settings.rate_kind,
            clock="" if settings.clock_late_s else "simulated",
        )
        for site in settings.sites
    }
    fitted = {settings.prosthetic_side: settings.fitted} if settings.prosthetic_side else {}
    patient = Patient(code="DEMO-1", affected_side=stiff, prosthetic_side=prosthetic, prostheses=stated_only(fitted))
    return Session(recordings=tuple(recordings), patient=patient, sensors=sensors, is_simulated=True)


def _rng(settings: WalkerSettings, *key: int) -> np.random.Generator:
    """Every kind of chance has a stream of its own, so that changing one setting leaves the others as they were."""
    return np.random.default_rng([settings.seed, *key])


def _index(site: Site) -> int:
    return list(Site).index(site)


def _mount(settings: WalkerSettings, number: int) -> dict[Site, Mounting]:
    spread_m = settings.mounting_sd_m
    return {site: draw_mounting(site, spread_m, _rng(settings, 3, _index(site), number)) for site in settings.sites}


def _take(
    settings: WalkerSettings,
    number: int,
    legs: Mapping[Side, Leg],
    worn: StrappedSensors,
    faults: Mapping[Site, SensorFaults],
    rides: dict[tuple[Site, RecordingKind], Ride],
) -> tuple[Recording, MovedRecording, dict[Site, SensorFaults]]:
    """Recording `number`, how it was moved, the sensors' faults at its end; a first motion fills how each `rides`."""
    required = settings.recordings[number]
    kind = _kind_of(required)
    motions, pelvis, duration_s = _move(settings, number, worn.strapping, legs)
    imu: dict[Site, ImuBlock] = {}
    clocks: dict[Site, SensorClock] = {}
    biases: dict[Site, FloatArray] = {}
    after: dict[Site, SensorFaults] = {}
    fine_s = motions[Side.LEFT].time_s
    for site in settings.sites:
        if site is Site.PELVIS:
            poses = _pelvis_poses(settings, number, motions, pelvis, worn)
        else:
            leg = motions[site.leg_side]
            tissue = Tissue.RIGID if _is_bare(legs, site) else settings.tissue
            chance = _rng(settings, 4, _index(site), number)
            ride = rides.setdefault((site, kind), draw_ride(chance))
            following, wobble = _following(legs[site.leg_side], leg, site, worn.gains), 1.0
            if settings.tissue_turn_rad and tissue is not Tissue.RIGID:
                of_strap = _rng(settings, 14, _index(site), worn.strapping)
                turned = turn_in_step(leg, legs[site.leg_side], site.segment, settings.tissue_turn_rad, of_strap)
                following = turned if following is None else turned @ following
            if pelvis is not None and tissue is Tissue.REAL and site.segment is Segment.THIGH:
                turned = thigh_on_tissue(
                    leg, legs[site.leg_side].outward, _rng(settings, 10, _index(site), worn.strapping)
                )
                following = turned if following is None else turned @ following
                wobble = REAL_THIGH_WOBBLE
            poses = sensor_poses(leg, site, worn.mountings[site], tissue, ride, chance, following, wobble)
            poses = on_loose_strap(poses, worn.mountings[site], settings.loose_straps.get(site, 0.0), fine_s)
        clocks[site] = make_clock(settings, site, duration_s, _rng(settings, 5, _index(site), number))
        noise = _rng(settings, 8, _index(site), number)
        imu[site], bias = record(settings, site, clocks[site], fine_s, poses, faults[site], noise)
        biases[site] = bias.mean(axis=0)
        after[site] = replace(faults[site], gyr_bias_rad_s=bias[-1])
    recording = Recording(
        name=required.name,
        kind=kind,
        folder=required.name.replace(" ", "_"),
        imu=imu,
        is_restrapped_before=required.is_restrapped_before,
    )
    return (
        recording,
        MovedRecording(
            required.name, isinstance(required, Standing), motions, clocks, worn.mountings, biases, worn.gains, pelvis
        ),
        after,
    )


def _kind_of(required: Standing | FreeMotion | Walk | TimedCourse) -> RecordingKind:
    if isinstance(required, Standing):
        return RecordingKind.STANDING
    return RecordingKind.FREE_MOTION if isinstance(required, FreeMotion) else RecordingKind.WALKING


def _pelvis_poses(
    settings: WalkerSettings,
    number: int,
    motions: Mapping[Side, LegMotion],
    pelvis: PelvisMotion | None,
    worn: StrappedSensors,
) -> tuple[FloatArray, FloatArray]:
    assert pelvis is not None
    contacts_s = np.sort(np.concatenate([motion.events.initial_contact_s for motion in motions.values()]))
    strap, chance = (
        _rng(settings, 10, _index(Site.PELVIS), worn.strapping),
        _rng(settings, 4, _index(Site.PELVIS), number),
    )
    return pelvis_poses(pelvis, contacts_s, worn.mountings[Site.PELVIS], settings.tissue, strap, chance)


def _is_bare(legs: Mapping[Side, Leg], site: Site) -> bool:
    """Whether a site is on a prosthesis, where there is no tissue."""
    return legs[site.leg_side].foot is not None and SEGMENT_ROW[site.segment] > 0


def _following(leg: Leg, motion: LegMotion, site: Site, gains: Mapping[Joint, float]) -> FloatArray | None:
    for joint, axis in ((Joint(f"{leg.side}_knee"), leg.knee_axis), (Joint(f"{leg.side}_ankle"), leg.ankle_axis)):
        turned = follow_joint(motion, axis, joint, site, gains[joint])
        if turned is not None:
            return turned
    return None


def _move(
    settings: WalkerSettings, number: int, strapping: int, legs: Mapping[Side, Leg]
) -> tuple[dict[Side, LegMotion], PelvisMotion | None, float]:
    """Both legs' poses on the fine clock, in the recording's own compass direction, and its duration."""
    # without a pelvis, each leg's hip goes its own way
    required = settings.recordings[number]
    pelvis = None
    rng = _rng(settings, 6, number)
    per_leg = {side: _rng(settings, 7, number, i) for i, side in enumerate(Side)}
    if isinstance(required, FreeMotion) and is_lunging(required):
        duration_s = required.duration_s
        pelvis, motions = lunge(legs, required, _fine_clock(settings, duration_s), _rng(settings, 9, number))
    elif isinstance(required, TimedCourse):
        motions, seated, _, duration_s = walk_course(required, legs)
        if Site.PELVIS in settings.sites:
            pelvis, motions = course_pelvis(motions, seated)
    elif isinstance(required, FreeMotion):
        duration_s = required.duration_s * (2 if required.is_in_turn else 1)
        time_s = _fine_clock(settings, duration_s)
        starts = {Side.LEFT: 0.0, Side.RIGHT: required.duration_s if required.is_in_turn else 0.0}
        motions = {side: move_freely(legs[side], required, time_s, starts[side], per_leg[side]) for side in Side}
    else:
        changes = draw_changes(settings, number, strapping, required) if isinstance(required, Walk) else NO_CHANGES
        motions, duration_s = _stand_or_walk(settings, required, changes, legs, rng, per_leg)
    if isinstance(required, Walk) and required.treadmill is not None:
        motions = on_treadmill(motions, required.treadmill, required.speed_m_s)
    compass = rotation_about(Z_AXIS, rng.uniform(0.0, 2.0 * np.pi, 1))[0]
    if Site.PELVIS in settings.sites and pelvis is None:
        pelvis, motions = with_pelvis(motions, _rng(settings, 9, number))
    turned = None if pelvis is None else pelvis.turned(compass)
    return {side: motion.turned(compass) for side, motion in motions.items()}, turned, duration_s


def _stand_or_walk(
    settings: WalkerSettings,
    required: Standing | Walk,
    changes: StepChanges,
    legs: Mapping[Side, Leg],
    rng: np.random.Generator,
    per_leg: Mapping[Side, np.random.Generator],
) -> tuple[dict[Side, LegMotion], float]:
    if isinstance(required, Walk):
        # no stride moved longer than 2.2 s; the plan gives how much of this is needed
        slowest = max(1.0, float(changes.of_steps(2 * required.strides)[0].max()))
        ample = required.standing_before_s + required.standing_after_s + 2.2 * slowest * (required.strides + 2)
        time_s = _fine_clock(settings, ample)
        first = list(Side)[int(rng.integers(2))]
        plan = plan_walk(required, time_s, first, {side: leg.foot for side, leg in legs.items()}, rng, changes)
        time_s = time_s[time_s <= plan.duration_s + MARGIN_S]
        plan = replace(plan, hip_path_m=plan.hip_path_m[: len(time_s)])
        legs = {side: set_up(leg, required.prosthesis) for side, leg in legs.items()}
    else:
        time_s = _fine_clock(settings, required.duration_s)
        plan = plan_standing(time_s, required.duration_s)
    sway_m = sway_of(time_s, rng)
    return {side: walk_leg(legs[side], plan, time_s, sway_m, per_leg[side]) for side in Side}, plan.duration_s


def _fine_clock(settings: WalkerSettings, duration_s: float) -> FloatArray:
    """From `MARGIN_S` before 0 to as long after the end, at a multiple of the sensors' rate, 0 among its instants."""
    fine_hz = settings.rate_hz * np.ceil(FINE_HZ / settings.rate_hz)
    margin = int(np.ceil(MARGIN_S * fine_hz))
    return np.arange(-margin, int(np.ceil(duration_s * fine_hz)) + margin + 1) / fine_hz

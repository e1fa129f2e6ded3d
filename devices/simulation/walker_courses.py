"""Simulated courses of timed tests, with what is true of them: starts, turns, pauses, rises, distance.

As unkind as people are: the speed varies and falls, they hesitate before a turn and take shorter steps there, turn to
either side, pause on the way, fidget on the chair; and a sensor may fall silent for seconds.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from core.body import Side, Site
from core.samples import BoolArray, FloatArray, ImuBlock, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from devices.simulation.walker_body import CourseKind, Leg, TimedCourse, Tissue, WalkerSettings, make_leg
from devices.simulation.walker_bouts import Bout, CourseStep, PlannedBout, SeatChange, climb, plan_bout, sit, walk_bouts
from devices.simulation.walker_course_pelvis import course_pelvis
from devices.simulation.walker_gait import walk_leg
from devices.simulation.walker_manners import Gait, gaits_of
from devices.simulation.walker_motion import Z_AXIS, LegMotion, rotation_about, smooth_step, sway_of
from devices.simulation.walker_pelvis import PelvisMotion, pelvis_poses
from devices.simulation.walker_plan import plan_standing
from devices.simulation.walker_sensors import draw_faults, draw_mounting, draw_ride, make_clock, record, sensor_poses

FINE_HZ, MARGIN_S = 500.0, 0.25
STANDING_S = 3.0
SITS_DOWN_AFTER_S, STAYS_SEATED_S = 0.5, 4.0  # the latter is longer than a recording goes on after a test
TAPE_M = (2.0, 12.0)  # of a course of 14 m, where the 10 m begin and end
CHAIR_TO_CONE_M = 3.0
EDGE_SHARE = 0.1  # of the way between seat and standing: from there on the thighs have left one or reached the other
PAUSE_S = 1.0  # both feet on the floor for so long is a pause
LONG_S = {"2 min": 120.0, "6 min": 360.0}


@dataclass(frozen=True, slots=True)
class CourseTurn:
    """A turn of the body's way: when it begins and ends, and how far it leads, positive to the left."""

    start_s: float
    end_s: float
    angle_rad: float


@dataclass(frozen=True, slots=True)
class CourseTruth:
    """What is true of a course, on the true clock.

    `time_s`, `way_m`: (n,): how far the body has come along its way, turns included.
    `left_seat_s`, `upright_s`: (r,): of each rise: the thighs have left the seat; they are as in standing.
    `climbs_m`: (k,): of each foot: how much higher each of its contacts is than the one before.
    """

    time_s: FloatArray
    way_m: FloatArray
    contacts_s: FloatArray  # (k,): of both feet, ascending
    turns: tuple[CourseTurn, ...]
    pauses_s: tuple[tuple[float, float], ...]  # from the last contact before to the first toe-off after
    left_seat_s: FloatArray
    upright_s: FloatArray
    seated_s: FloatArray  # (d,): of each sitting down: the thighs rest on the seat
    climbs_m: Mapping[Side, FloatArray] = field(default_factory=dict)

    def passes_s(self, at_m: float) -> float:
        """When the body passes a place along its way, seconds."""
        return float(np.interp(at_m, self.way_m, self.time_s))

    def way_at(self, time_s: float) -> float:
        """How far the body has come, m."""
        return float(np.interp(time_s, self.time_s, self.way_m))


@dataclass(frozen=True, slots=True)
class SimulatedCourse:
    """A session of standing and the course, and what is true of the course."""

    session: Session
    truth: CourseTruth


def draw_course(kind: CourseKind, seed: int) -> TimedCourse:
    """A course by chance, of a patient of any speed, with pauses, hesitations and now and then a silent sensor."""
    rng = np.random.default_rng([seed, 11])
    course = TimedCourse(
        kind,
        seed=seed,
        speed_m_s=float(rng.uniform(0.4, 1.6)),
        lap_m=float(rng.uniform(8.0, 30.0)),
        pauses=int(rng.integers(3)),
        hesitates=bool(rng.integers(2)),
        slowing=float(rng.uniform(-0.05, 0.25)),
        rise_s=float(rng.uniform(0.8, 2.5)),
        tissue=Tissue.RIGID if kind in LONG_S else Tissue.SOFT,
    )
    if kind in LONG_S:
        course = replace(course, sites=(Site.LEFT_FOOT, Site.RIGHT_FOOT))
    if kind in LONG_S and rng.uniform() < 0.2:
        start_s = float(rng.uniform(20.0, 90.0))
        site = course.sites[int(rng.integers(2))]
        return replace(course, silent_s={site: (start_s, start_s + float(rng.uniform(1.0, 8.0)))})
    return course


def simulate_course(course: TimedCourse) -> SimulatedCourse:
    """Standing, then the course; the same settings give the same samples."""
    settings = WalkerSettings(
        seed=course.seed, sites=course.sites, tissue=course.tissue, rate_hz=course.rate_hz, errors=course.errors
    )
    legs = {side: make_leg(settings, side) for side in Side}
    mountings = {site: draw_mounting(site, settings.mounting_sd_m, _rng(course, 3, site)) for site in course.sites}
    faults = {site: draw_faults(course.errors, _rng(course, 2, site)) for site in course.sites}
    walked, changes, truth, duration_s = walk_course(course, legs)
    stood = _stand(course, legs)
    of_pelvis: list[tuple[str, PelvisMotion, FloatArray, float]] = []
    if Site.PELVIS in course.sites:
        pelvis, stood = course_pelvis(stood, ())
        of_pelvis.append(("standing", pelvis, np.empty(0), STANDING_S))
        pelvis, walked = course_pelvis(walked, changes)
        of_pelvis.append(("course", pelvis, truth.contacts_s, duration_s))
    imu: dict[str, dict[Site, ImuBlock]] = {"standing": {}, "course": {}}
    for site in course.sites:
        if site is Site.PELVIS:
            strap, chance = _rng(course, 10, site), _rng(course, 6, site)
            for name, pelvis, hits_s, lasts_s in of_pelvis:
                poses = pelvis_poses(pelvis, hits_s, mountings[site], course.tissue, strap, chance)
                clock = make_clock(settings, site, lasts_s, chance)
                imu[name][site] = record(settings, site, clock, pelvis.time_s, poses, faults[site], chance)[0]
            continue
        ride = draw_ride(_rng(course, 4, site))
        for name, motions, lasts_s in (("standing", stood, STANDING_S), ("course", walked, duration_s)):
            chance = _rng(course, 5 if name == "course" else 6, site)
            leg = motions[site.leg_side]
            poses = sensor_poses(leg, site, mountings[site], course.tissue, ride, chance)
            clock = make_clock(settings, site, lasts_s, chance)
            imu[name][site] = record(settings, site, clock, leg.time_s, poses, faults[site], chance)[0]
    for site, (from_s, to_s) in course.silent_s.items():
        time_s = imu["course"][site].time_s
        received: BoolArray = (time_s < from_s) | (time_s > to_s)
        imu["course"][site] = imu["course"][site].select(received)
    recordings = (
        Recording("standing", RecordingKind.STANDING, "standing", imu["standing"]),
        Recording("course", RecordingKind.WALKING, "course", imu["course"]),
    )
    sensors = {
        site: SensorInfo(f"DEMO-{site.value}", "simulated", "", course.rate_hz, settings.rate_kind, "simulated")
        for site in course.sites
    }
    return SimulatedCourse(
        Session(recordings, patient=Patient(code="DEMO-1"), sensors=sensors, is_simulated=True), truth
    )


def _rng(course: TimedCourse, *key: int | Site) -> np.random.Generator:
    numbers = [list(Site).index(k) if isinstance(k, Site) else k for k in key]
    return np.random.default_rng([course.seed, list(CourseKind).index(course.kind), *numbers])


def _stand(course: TimedCourse, legs: Mapping[Side, Leg]) -> dict[Side, LegMotion]:
    time_s = _fine_clock(STANDING_S)
    rng = _rng(course, 7)
    sway_m = sway_of(time_s, rng)
    plan = plan_standing(time_s, STANDING_S)
    return {side: walk_leg(legs[side], plan, time_s, sway_m, rng) for side in Side}


def _fine_clock(duration_s: float) -> FloatArray:
    margin = round(MARGIN_S * FINE_HZ)
    return np.arange(-margin, int(np.ceil(duration_s * FINE_HZ)) + margin + 1) / FINE_HZ


def walk_course(
    course: TimedCourse, legs: Mapping[Side, Leg]
) -> tuple[dict[Side, LegMotion], list[SeatChange], CourseTruth, float]:
    """Give both legs' poses, seat changes, truth and duration in s from the start; earth axes, z up, m."""
    rng = _rng(course, 8)
    start_s = round(rng.uniform(1.6, 3.0) * FINE_HZ) / FINE_HZ
    changes: list[SeatChange] = []
    planned: list[PlannedBout] = []
    is_from_chair = course.kind in (CourseKind.UP_AND_GO, CourseKind.SIT_TO_STAND)
    if is_from_chair:
        if course.is_between_standing:
            changes.append(SeatChange(SITS_DOWN_AFTER_S, course.rise_s, is_down=True))
            start_s += changes[-1].end_s
        changes.append(SeatChange(start_s, course.rise_s, is_down=False))
        start_s = changes[-1].end_s
    end_s = start_s
    bouts = _bouts(course, rng)
    gaits = _gaits(course)
    of_side = {side: course.change for side in Side if course.changed_side in (None, side)}
    for bout in bouts:
        first = list(Side)[int(rng.integers(2))]
        plan = plan_bout(bout, gaits, 1.0 / FINE_HZ, first, rng, of_side)
        planned.append(PlannedBout(round(end_s * FINE_HZ) / FINE_HZ, plan))
        end_s = planned[-1].start_s + plan.duration_s
    if course.kind is CourseKind.SIT_TO_STAND:
        changes += _more_rises(course, changes[-1].end_s, rng)
        end_s = changes[-1].end_s
    elif is_from_chair:
        changes.append(SeatChange(end_s, course.rise_s * rng.uniform(0.9, 1.4), is_down=True))
        end_s = changes[-1].end_s
        if course.is_between_standing:
            changes.append(SeatChange(end_s + STAYS_SEATED_S, course.rise_s, is_down=False))
            end_s = changes[-1].end_s
    duration_s = end_s + 2.0
    time_s = _fine_clock(duration_s)
    sway_m = sway_of(time_s, rng)
    per_leg = {side: _rng(course, 9, i) for i, side in enumerate(Side)}
    if planned:
        motions = walk_bouts(legs, planned, time_s, sway_m, per_leg)
    else:
        plan = plan_standing(time_s, duration_s)
        motions = {side: walk_leg(legs[side], plan, time_s, sway_m, per_leg[side]) for side in Side}
    climbs_m: dict[Side, FloatArray] = {}
    if course.kind is CourseKind.STAIRS:
        motions, climbs_m = _climbed(motions, bouts[0])
    phase_rad = rng.uniform(0.0, 2.0 * np.pi)
    motions = {side: sit(legs[side], motion, changes, phase_rad) for side, motion in motions.items()}
    compass = rotation_about(Z_AXIS, rng.uniform(0.0, 2.0 * np.pi, 1))[0]
    motions = {side: motion.turned(compass) for side, motion in motions.items()}
    return motions, changes, replace(_truth(motions, planned, changes), climbs_m=climbs_m), duration_s


def _climbed(motions: Mapping[Side, LegMotion], bout: Bout) -> tuple[dict[Side, LegMotion], dict[Side, FloatArray]]:
    """Both legs on the stairs of a bout, and how much higher each contact of each is than the one before."""
    height_m = np.cumsum([step.rise_m for step in bout.steps])
    first = min(motions, key=lambda side: float(motions[side].events.initial_contact_s[0]))
    heights = {side: np.concatenate([[0.0], height_m[0 if side is first else 1 :: 2]]) for side in motions}
    climbed = {side: climb(motion, heights[side]) for side, motion in motions.items()}
    return climbed, {side: np.diff(values) for side, values in heights.items()}


def _more_rises(course: TimedCourse, at_s: float, rng: np.random.Generator) -> list[SeatChange]:
    """Down and up four times, each in a time of its own."""
    changes = []
    for _ in range(4):
        for is_down in (True, False):
            at_s += rng.uniform(0.15, 0.7)
            changes.append(SeatChange(at_s, course.rise_s * rng.uniform(0.85, 1.25), is_down))
            at_s = changes[-1].end_s
    return changes


def _bouts(course: TimedCourse, rng: np.random.Generator) -> list[Bout]:
    """What the patient walks between one pause and the next."""
    if course.kind is CourseKind.SIT_TO_STAND:
        return []
    if course.kind is CourseKind.STAIRS:
        return [Bout(_stairs(course, rng), (), 0.5, 1.5)]
    if course.kind is CourseKind.TEN_METRES:
        return [Bout(_straight(course, 15.0, 0.0, rng), (), 0.5, 1.5)]
    if course.kind is CourseKind.UP_AND_GO:
        steps = [*_straight(course, CHAIR_TO_CONE_M, 0.0, rng), *_turn(course, 0, rng)]
        steps += [
            *_straight(course, CHAIR_TO_CONE_M, 0.5, rng),
            *_turn(course, 1, rng),
            *_straight(course, 0.6, 1, rng),
        ]
        return [Bout(steps, (_about(rng), _about(rng)), 0.5, 0.4)]
    return _to_and_fro(course, LONG_S[course.kind] + 6.0, rng)


def _to_and_fro(course: TimedCourse, lasts_s: float, rng: np.random.Generator) -> list[Bout]:
    """From turn to turn for at least `lasts_s`, with the patient's pauses."""
    pause_s = sorted(rng.uniform(0.15, 0.85, course.pauses) * lasts_s)
    bouts: list[Bout] = []
    walked_s, to_turn_m = 0.0, course.lap_m
    while walked_s < lasts_s:
        steps: list[CourseStep] = []
        turns: list[float] = []
        until_s = pause_s.pop(0) if pause_s else np.inf
        while not steps or walked_s < min(until_s, lasts_s):
            piece_m = min(to_turn_m, 3.0)
            piece = _straight(course, piece_m, walked_s / lasts_s, rng)
            to_turn_m -= sum(step.length_m for step in piece)
            if to_turn_m < 0.5:
                piece += _turn(course, len(turns), rng)
                turns.append(_about(rng))
                to_turn_m = course.lap_m
            steps += piece
            walked_s += sum(step.time_s for step in piece)
        if len(steps) % 2 or steps[-1].turn is not None:  # a bout ends on the straight
            steps += _straight(course, 1.5, walked_s / lasts_s, rng)
        standing_s = rng.uniform(1.0, 5.0)
        bouts.append(Bout(steps, turns, 0.5, standing_s))
        walked_s += standing_s
    return bouts


def _gaits(course: TimedCourse) -> Mapping[Side, Gait]:
    return gaits_of(course.speed_m_s, course.manner_of_side)


def _usual_step(course: TimedCourse) -> tuple[float, float]:
    """Length and time of a step on the straight, m and s."""
    gait = _gaits(course)[Side.LEFT]  # strides are those of both
    return 0.5 * gait.stride_m, 0.5 * gait.stride_s


def _about(rng: np.random.Generator) -> float:
    """A turn about, to either side, more or less."""
    return float(rng.choice([-1.0, 1.0]) * (np.pi + rng.normal(0.0, np.deg2rad(6.0))))


def _straight(course: TimedCourse, way_m: float, done: float, rng: np.random.Generator) -> list[CourseStep]:
    """Steps for at least `way_m`, by a patient who has `done` a share of the test."""
    steps: list[CourseStep] = []
    step_m, step_s = _usual_step(course)
    factor = np.sqrt(1.0 - course.slowing * done)  # slower by shorter steps and by longer times alike
    while sum(step.length_m for step in steps) < way_m:
        steps.append(
            CourseStep(
                step_m * factor * rng.normal(1.0, 0.03),
                step_s / factor * rng.normal(1.0, 0.02),
            )
        )
    return steps


def _stairs(course: TimedCourse, rng: np.random.Generator) -> list[CourseStep]:
    """To the stairs, up, over a landing, down again and away; one step a tread, or both feet on each."""
    count, rise_m, tread_m = int(rng.integers(6, 13)), float(rng.uniform(0.14, 0.19)), float(rng.uniform(0.27, 0.32))
    is_by_both = bool(rng.integers(2))
    time_s = float(rng.uniform(0.55, 0.8))
    steps = _straight(course, 5.0, 0.0, rng)
    for sign in (1.0, -1.0):
        for _ in range(count):
            steps.append(CourseStep(tread_m, time_s * rng.normal(1.0, 0.03), rise_m=sign * rise_m))
            if is_by_both:
                steps.append(CourseStep(0.02, time_s * rng.normal(1.0, 0.03)))
        steps += _straight(course, 4.0, 0.5, rng)
    return steps


def _turn(course: TimedCourse, number: int, rng: np.random.Generator) -> list[CourseStep]:
    """Shorter steps on the turn; a patient who hesitates waits before it and takes two short steps on the straight."""
    usual_m, step_s = _usual_step(course)
    step_m = min(0.28, usual_m)
    steps: list[CourseStep] = []
    if course.hesitates:
        steps = [CourseStep(0.6 * usual_m, step_s), CourseStep(step_m, step_s)]
        steps.append(CourseStep(step_m, step_s + rng.uniform(0.1, 0.4)))
    count = int(rng.integers(5, 9))
    factors = rng.normal(1.0, [[0.05, 0.03]] * count)
    return steps + [CourseStep(step_m * a, step_s * b, number) for a, b in factors.tolist()]


def _truth(
    motions: Mapping[Side, LegMotion], planned: Sequence[PlannedBout], changes: Sequence[SeatChange]
) -> CourseTruth:
    time_s = motions[Side.LEFT].time_s
    way, turns, come_m = np.zeros_like(time_s), [], 0.0
    for bout in planned:
        path = bout.plan.hip_path_m
        clock = bout.start_s + np.arange(len(path)) / FINE_HZ
        way = np.where(time_s >= clock[0], np.interp(time_s, clock, path) + come_m, way)
        come_m += float(path[-1])
        for bend in bout.plan.bends:
            share = smooth_step((path - bend.middle_m) / (1.3 * bend.arc_m) + 0.5)
            begin, end = np.searchsorted(share, [0.05, 0.95])
            turns.append(CourseTurn(float(clock[begin]), float(clock[end]), bend.turn_rad))
    contacts = np.sort(np.concatenate([m.events.initial_contact_s for m in motions.values()]))
    offs = np.sort(np.concatenate([m.events.toe_off_s for m in motions.values()]))
    following = np.searchsorted(offs, contacts)
    shown = [(float(a), float(offs[k])) for a, k in zip(contacts, following, strict=True) if k < len(offs)]
    seat = _seat_truth(motions, changes)
    return CourseTruth(
        time_s=time_s,
        way_m=way,
        contacts_s=contacts,
        turns=tuple(turns),
        pauses_s=tuple((a, b) for a, b in shown if b - a >= PAUSE_S and not np.any((contacts > a) & (contacts < b))),
        left_seat_s=seat["left_seat_s"],
        upright_s=seat["upright_s"],
        seated_s=seat["seated_s"],
    )


def _seat_truth(motions: Mapping[Side, LegMotion], changes: Sequence[SeatChange]) -> dict[str, FloatArray]:
    """When the thighs leave the seat, are as in standing, and rest on the seat, by their true tilt."""
    time_s = motions[Side.LEFT].time_s
    tilt = np.mean([np.arccos(np.clip(m.rotations[0][:, 2, 2], -1.0, 1.0)) for m in motions.values()], axis=0)
    found: dict[str, list[float]] = {"left_seat_s": [], "upright_s": [], "seated_s": []}
    for change in changes:
        here = slice(*np.searchsorted(time_s, [change.start_s, change.end_s]))
        begins, ends = tilt[here.start], tilt[here.stop]
        edge = EDGE_SHARE * abs(begins - ends)
        away = np.flatnonzero(np.abs(tilt[here] - ends) > edge)[-1] + 1
        if change.is_down:
            found["seated_s"].append(float(time_s[here][away]))
        else:
            left = np.flatnonzero(np.abs(tilt[here] - begins) > edge)[0]
            found["left_seat_s"].append(float(time_s[here][left]))
            found["upright_s"].append(float(time_s[here][away]))
    return {name: np.array(values) for name, values in found.items()}

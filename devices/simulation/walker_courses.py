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
from devices.simulation.walker_body import (
    CourseFlaw,
    CourseKind,
    FeetInTurns,
    Leg,
    Manner,
    TimedCourse,
    Tissue,
    WalkerSettings,
    make_leg,
)
from devices.simulation.walker_bouts import (
    OFF_SHARE,
    REST_SHARE,
    Bout,
    CourseStep,
    PlannedBout,
    SeatChange,
    climb,
    plan_bout,
    sit,
    walk_bouts,
)
from devices.simulation.walker_course_pelvis import course_pelvis
from devices.simulation.walker_gait import walk_leg
from devices.simulation.walker_manners import Gait, gaits_of
from devices.simulation.walker_motion import Z_AXIS, LegMotion, rotation_about, smooth_step, sway_of
from devices.simulation.walker_pelvis import PelvisMotion, pelvis_poses
from devices.simulation.walker_plan import plan_standing
from devices.simulation.walker_route import (
    LEAST_STRAIGHT_M,
    Piece,
    StepPace,
    about,
    before_turn,
    bends_of,
    draw_up_and_go,
    shape_of,
    steps_of,
    straight,
    turn,
    up_and_go_pieces,
)
from devices.simulation.walker_sensors import draw_faults, draw_mounting, draw_ride, make_clock, record, sensor_poses

FINE_HZ, MARGIN_S = 500.0, 0.25
STANDING_S = 3.0
TAPE_M = (2.0, 12.0)  # of a course of 14 m, where the 10 m begin and end
EDGE_SHARE = 0.1  # of the way between seat and standing: from there on the thighs have left one or reached the other
SEATED_S, FALSE_START_S = 3.0, 0.4
HESITATION_M = 3.0  # of the straight before a turn, in which a hesitation lies
PAUSE_S = 1.0  # both feet on the floor for so long is a pause
LONG_S = {"2 min": 120.0, "6 min": 360.0}


@dataclass(frozen=True, slots=True)
class CourseTurn:
    """A turn of the body's way: when a tenth and nine tenths of it are done, and how far, positive to the left."""

    start_s: float
    end_s: float
    angle_rad: float


@dataclass(frozen=True, slots=True)
class CourseTruth:
    """What is true of a course, on the true clock.

    `time_s`, `way_m`: (n,): how far the body has come along its way, turns included.
    `left_seat_s`, `upright_s`: (r,): of each rise: the thighs have left the seat; they are as in standing.
    `climbs_m`: (k,): of each foot: how much higher each of its contacts is than the one before.
    `parts_s`: of an up and go, from when to when each part was planned: a rise and a turn from a tenth to nine tenths
    of the way, the turn to sit until the sitting begins.
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
    parts_s: Mapping[str, tuple[float, float]] = field(default_factory=dict)

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
    if kind is CourseKind.UP_AND_GO:
        return _drawn_up_and_go(course, rng)
    if kind in LONG_S:
        course = replace(course, sites=(Site.LEFT_FOOT, Site.RIGHT_FOOT))
    if kind in LONG_S and rng.uniform() < 0.2:
        start_s = float(rng.uniform(20.0, 90.0))
        site = course.sites[int(rng.integers(2))]
        return replace(course, silent_s={site: (start_s, start_s + float(rng.uniform(1.0, 8.0)))})
    return course


def _drawn_up_and_go(course: TimedCourse, rng: np.random.Generator) -> TimedCourse:
    """As people go it: one in four shuffles, one in four has a leg that moves otherwise; feet point where they will."""
    manner_of_side: dict[Side, Manner] = {}
    drawn = int(rng.integers(8))
    if drawn < 2:
        manner_of_side = dict.fromkeys(Side, Manner.SHUFFLING)
        course = replace(course, speed_m_s=float(rng.uniform(0.35, 0.9)))
    elif drawn < 4:
        other = (Manner.HEMIPARETIC, Manner.FLAT, Manner.DRAGGING)[int(rng.integers(3))]
        manner_of_side = {list(Side)[int(rng.integers(2))]: other}
    feet = FeetInTurns(
        float(np.deg2rad(rng.uniform(1.0, 4.0))), float(rng.uniform(-0.05, 0.1)), float(rng.uniform(0.0, 0.5))
    )
    return replace(course, manner_of_side=manner_of_side, up_and_go=draw_up_and_go(rng), feet=feet)


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
    changes = _first_changes(course, start_s)
    end_s = changes[-1].end_s if changes else start_s
    bouts = _bouts(course, rng)
    gaits = _gaits(course)
    if course.kind is CourseKind.UP_AND_GO:
        # a bout begins before its first toe-off
        end_s += course.up_and_go.first_step_s - bouts[0].standing_before_s - OFF_SHARE * gaits[Side.LEFT].stride_s
    planned: list[PlannedBout] = []
    of_side = {side: course.change for side in Side if course.changed_side in (None, side)}
    for bout in bouts:
        first = list(Side)[int(rng.integers(2))]
        plan = plan_bout(bout, gaits, 1.0 / FINE_HZ, first, rng, of_side, course.feet)
        planned.append(PlannedBout(round(end_s * FINE_HZ) / FINE_HZ, plan))
        end_s = planned[-1].start_s + plan.duration_s
    if course.kind is CourseKind.SIT_TO_STAND:
        changes += _more_rises(course, changes[-1].end_s, rng)
        end_s = changes[-1].end_s
    elif course.kind is CourseKind.UP_AND_GO:
        stopped_s = end_s - bouts[-1].standing_after_s - REST_SHARE * gaits[Side.LEFT].stride_s
        down_s = stopped_s + course.up_and_go.sits_after_s
        changes.append(SeatChange(down_s, course.rise_s * rng.uniform(0.9, 1.4), is_down=True))
        end_s = changes[-1].end_s
        if course.is_joined:
            changes.append(SeatChange(end_s + SEATED_S, course.rise_s, is_down=False))
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
    truth = replace(_truth(motions, planned, changes), climbs_m=climbs_m)
    if course.kind is CourseKind.UP_AND_GO:
        truth = replace(truth, parts_s=_parts(truth.turns, changes))
    return motions, changes, truth, duration_s


def _first_changes(course: TimedCourse, start_s: float) -> list[SeatChange]:
    """What comes before the first step, or, of rises alone, the first of them."""
    if course.kind not in (CourseKind.UP_AND_GO, CourseKind.SIT_TO_STAND):
        return []
    changes = []
    if course.is_joined:
        changes.append(SeatChange(start_s, course.rise_s, is_down=True))
        start_s = changes[-1].end_s + SEATED_S
    flaw = course.up_and_go.flaw
    if flaw is CourseFlaw.STANDING_START:
        return changes
    changes.append(SeatChange(start_s, course.rise_s, is_down=False))
    if flaw is CourseFlaw.FALSE_START:
        for is_down in (True, False):
            changes.append(SeatChange(changes[-1].end_s + FALSE_START_S, course.rise_s, is_down))
    return changes


def _parts(turns: Sequence[CourseTurn], changes: Sequence[SeatChange]) -> dict[str, tuple[float, float]]:
    """When each part of an up and go begins and ends, as it was planned; what it has not is left out."""
    edges_s = {change.start_s: _edges(change) for change in changes}
    up = [edges_s[one.start_s] for one in changes if not one.is_down and one.start_s < turns[0].start_s]
    down = [edges_s[one.start_s] for one in changes if one.is_down and one.start_s > turns[0].end_s]
    if not up or not down or len(turns) != 2:
        return {}
    out, back = turns
    return {
        "rise": up[-1],
        "walk_out": (up[-1][1], out.start_s),
        "turn": (out.start_s, out.end_s),
        "walk_back": (out.end_s, back.start_s),
        "turn_to_sit": (back.start_s, down[0][0]),
        "sit": down[0],
    }


def _edges(change: SeatChange) -> tuple[float, float]:
    """When a tenth and nine tenths of the way are done."""
    at = np.linspace(0.0, 1.0, 1001)
    first, last = np.interp([EDGE_SHARE, 1.0 - EDGE_SHARE], smooth_step(at), at).tolist()
    return change.start_s + first * change.duration_s, change.start_s + last * change.duration_s


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
        return [Bout(_straight(course, course.straight_m, 0.0, rng), (), 0.5, 1.5)]
    if course.kind is CourseKind.UP_AND_GO:
        pieces = up_and_go_pieces(course, _pace(course), rng)
        return [Bout(steps_of(pieces), bends_of(pieces), 0.5, 0.4)]
    return _to_and_fro(course, LONG_S[course.kind] + 6.0, rng)


def _to_and_fro(course: TimedCourse, lasts_s: float, rng: np.random.Generator) -> list[Bout]:
    """Round one cone, back and round the other for at least `lasts_s`, with the patient's pauses."""
    pace, pauses_s = _pace(course), sorted((rng.uniform(0.15, 0.85, course.pauses) * lasts_s).tolist())
    bouts: list[Bout] = []
    pieces: list[Piece] = []
    walked_s = gone_m = 0.0  # so much of the next lap lies behind the patient
    while walked_s < lasts_s:
        turn_rad, clearance_m = about(rng), float(rng.uniform(0.2, 0.6))
        shape = shape_of(turn_rad)
        turn_m = 2.0 * clearance_m / abs(shape.end_y)
        ahead_m = max(LEAST_STRAIGHT_M, course.lap_m + clearance_m - shape.reach * turn_m - gone_m)
        lap_s = ahead_m / course.speed_m_s
        while pauses_s and pauses_s[0] < walked_s + lap_s:
            before_m = min(max(1.5, (pauses_s.pop(0) - walked_s) * course.speed_m_s), ahead_m - 1.5)
            if before_m < 1.5:
                continue
            before = _stretch(pace, before_m, walked_s / lasts_s, rng)
            standing_s = float(rng.uniform(1.0, 5.0))
            pieces += before
            bouts.append(Bout(steps_of(pieces), bends_of(pieces), 0.5, standing_s))
            walked_s += sum(piece.time_s for piece in before) + standing_s
            pieces, ahead_m = [], ahead_m - before_m
            break
        lap = [*_stretch(pace, ahead_m - HESITATION_M, walked_s / lasts_s, rng)] if ahead_m > 2.0 * HESITATION_M else []
        rest_m = ahead_m - sum(piece.length_m for piece in lap)
        lap += [*before_turn(pace, rest_m, walked_s / lasts_s, rng), turn(pace, turn_m, turn_rad, rng)]
        gone_m = (shape.reach - shape.end_x) * turn_m - clearance_m
        pieces += lap
        walked_s += sum(piece.time_s for piece in lap)
    pieces.append(straight(pace, 1.5, 1.0, rng))  # it ends on the straight
    bouts.append(Bout(steps_of(pieces), bends_of(pieces), 0.5, float(rng.uniform(1.0, 5.0))))
    return bouts


def _stretch(pace: StepPace, length_m: float, done: float, rng: np.random.Generator) -> list[Piece]:
    count = max(1, round(length_m / 3.0))
    return [straight(pace, length_m / count, done, rng) for _ in range(count)]


def _gaits(course: TimedCourse) -> Mapping[Side, Gait]:
    return gaits_of(course.speed_m_s, course.manner_of_side)


def _pace(course: TimedCourse) -> StepPace:
    gait = _gaits(course)[Side.LEFT]  # strides are those of both
    return StepPace(0.5 * gait.stride_m, 0.5 * gait.stride_s, course.slowing, course.hesitates)


def _straight(course: TimedCourse, way_m: float, done: float, rng: np.random.Generator) -> list[CourseStep]:
    """Steps for at least `way_m`, by a patient who has `done` a share of the test."""
    steps: list[CourseStep] = []
    pace = _pace(course)
    factor = pace.factor(done)
    while sum(step.length_m for step in steps) < way_m:
        length_m, time_s = pace.step_m * factor * rng.normal(1.0, 0.03), pace.step_s / factor * rng.normal(1.0, 0.02)
        steps.append(CourseStep(length_m, time_s))
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
            share = bend.heading_at(path) / bend.turn_rad
            begin, end = np.searchsorted(share, [EDGE_SHARE, 1.0 - EDGE_SHARE])
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

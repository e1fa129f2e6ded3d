"""Where a simulated patient goes on a course: straight on and round cones, and the steps of each part of the way."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from devices.simulation.walker_body import CourseFlaw, TimedCourse, UpAndGo
from devices.simulation.walker_bouts import CourseStep
from devices.simulation.walker_plan import Bend

GRID = 400  # points along a turn's shape
LEAST_STRAIGHT_M = 0.3
TURNING_SHARE = 0.85  # of a usual step's length: no step of a turn is longer
STEP_TURN_RAD = np.deg2rad(55.0)  # no step turns the body farther
SLANTS_RAD = (-0.4, 0.7)
SIDEWAYS_RAD = np.deg2rad(35.0)  # of turn, and no more, before the patient sits down sideways
SHORT_M = 0.28  # a step before a turn, of a patient who hesitates


@dataclass(frozen=True, slots=True)
class StepPace:
    """A patient's steps on the straight, and how much slower they are at the end of the course."""

    step_m: float
    step_s: float
    slowing: float = 0.0
    hesitates: bool = False

    def factor(self, done: float) -> float:
        """Of length, and of one over time, by a patient who has `done` a share: both shrink alike."""
        return float(np.sqrt(1.0 - self.slowing * done))


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of the way: its steps, and how far it turns, 0 straight on."""

    steps: tuple[CourseStep, ...]
    turn_rad: float = 0.0
    early: float = 0.0

    @property
    def length_m(self) -> float:
        return sum(step.length_m for step in self.steps)

    @property
    def time_s(self) -> float:
        return sum(step.time_s for step in self.steps)


def steps_of(pieces: Sequence[Piece]) -> list[CourseStep]:
    """All steps, one after the other."""
    return [step for piece in pieces for step in piece.steps]


def bends_of(pieces: Sequence[Piece]) -> list[Bend]:
    """Where along the way the pieces turn."""
    bends, begin_m = [], 0.0
    for piece in pieces:
        if piece.turn_rad:
            middle_m, arc_m = begin_m + 0.5 * piece.length_m, piece.length_m / 1.3
            bends.append(Bend(middle_m, piece.turn_rad, arc_m, piece.early))
        begin_m += piece.length_m
    return bends


def straight(pace: StepPace, length_m: float, done: float, rng: np.random.Generator) -> Piece:
    """Straight on for exactly so far."""
    factor = pace.factor(done)
    count = max(1, round(length_m / (pace.step_m * factor)))
    lengths = rng.normal(1.0, 0.03, count)
    lengths *= length_m / lengths.sum()
    times = pace.step_s / factor * rng.normal(1.0, 0.02, count)
    return Piece(tuple(CourseStep(a, b) for a, b in zip(lengths.tolist(), times.tolist(), strict=True)))


def before_turn(pace: StepPace, length_m: float, done: float, rng: np.random.Generator) -> list[Piece]:
    """Straight on up to a turn: a patient who hesitates waits before it, and takes two short steps."""
    if not pace.hesitates:
        return [straight(pace, length_m, done, rng)]
    short_m = min(SHORT_M, pace.step_m)
    steps = (CourseStep(0.6 * pace.step_m, pace.step_s), CourseStep(short_m, pace.step_s))
    hesitation = Piece((*steps, CourseStep(short_m, pace.step_s + rng.uniform(0.1, 0.4))))
    if hesitation.length_m > length_m - LEAST_STRAIGHT_M:
        return [straight(pace, length_m, done, rng)]
    return [straight(pace, length_m - hesitation.length_m, done, rng), hesitation]


def turn(
    pace: StepPace,
    length_m: float,
    turn_rad: float,
    rng: np.random.Generator,
    *,
    least_s: float = 2.5,
    early: float = 0.0,
) -> Piece:
    """Turn on a way of exactly so long, in at least so much time."""
    fewest = (least_s / pace.step_s, length_m / (TURNING_SHARE * pace.step_m), abs(turn_rad) / STEP_TURN_RAD)
    count = int(np.ceil(max(fewest)))
    lengths = rng.normal(1.0, 0.05, count)
    lengths *= length_m / lengths.sum()
    times = pace.step_s * rng.normal(1.0, 0.03, count)
    steps = tuple(CourseStep(a, b) for a, b in zip(lengths.tolist(), times.tolist(), strict=True))
    return Piece(steps, turn_rad, early)


@dataclass(frozen=True, slots=True)
class TurnShape:
    """A turn of 1 m of way, begun in direction x: how far it leads ahead at most, and where it ends."""

    reach: float
    end_x: float
    end_y: float


def shape_of(turn_rad: float, early: float = 0.0) -> TurnShape:
    """The shape of a turn; all its lengths grow with the way it takes."""
    at = (np.arange(GRID) + 0.5) / GRID
    heading = Bend(0.5, turn_rad, 1.0 / 1.3, early).heading_at(at)
    x, y = np.cumsum(np.cos(heading)) / GRID, np.cumsum(np.sin(heading)) / GRID
    return TurnShape(float(x.max()), float(x[-1]), float(y[-1]))


def about(rng: np.random.Generator) -> float:
    """A turn about, to either side, more or less."""
    return float(rng.choice([-1.0, 1.0]) * (np.pi + rng.normal(0.0, np.deg2rad(6.0))))


def up_and_go_pieces(course: TimedCourse, pace: StepPace, rng: np.random.Generator) -> list[Piece]:
    """From standing before the chair round the cone and back, to standing before the chair with the back to it."""
    how = course.up_and_go
    side = float(rng.choice([-1.0, 1.0]))
    if how.flaw is CourseFlaw.ONE_WAY:
        ahead = before_turn(pace, how.cone_m - how.before_chair_m, 0.5, rng)
        return [*ahead, turn(pace, how.sit_arc_m, side * np.pi, rng, least_s=how.sit_turn_s, early=how.early[1])]
    if how.flaw is CourseFlaw.TWICE:
        first = _round(how, pace, side, rng)
        return [*first, *_round(how, pace, side, rng)]
    return _round(how, pace, side, rng)


@dataclass(frozen=True, slots=True)
class _Loop:
    """Out, round the cone, back and about: lengths and turns."""

    out_m: float
    turn_m: float
    out_rad: float
    back_m: float
    last_rad: float
    beside_m: float  # of the chair the patient then stands, to the side of the turn


def _loop(how: UpAndGo, side: float, back_at_m: float, slant: float) -> _Loop:
    """The loop of a patient who comes back at an angle to the way out, as the chair is not beside it."""
    out_rad = side * (np.pi + slant)
    last_rad = -out_rad if how.is_unwound else side * (np.pi - slant)
    if how.flaw is CourseFlaw.SIDEWAYS:
        last_rad = np.sign(last_rad) * SIDEWAYS_RAD
    there, here = shape_of(out_rad, how.early[0]), shape_of(last_rad, how.early[1])
    turn_m = 2.0 * how.clearance_m / abs(shape_of(np.pi, how.early[0]).end_y)
    beyond_m = how.cone_m + how.clearance_m + how.overshoot_m
    out_m = max(LEAST_STRAIGHT_M, beyond_m - how.before_chair_m - there.reach * turn_m)
    x, y = how.before_chair_m + out_m + there.end_x * turn_m, there.end_y * turn_m
    c, s = np.cos(out_rad), np.sin(out_rad)
    x += (c * here.end_x - s * here.end_y) * how.sit_arc_m
    y += (s * here.end_x + c * here.end_y) * how.sit_arc_m
    back_m = max(LEAST_STRAIGHT_M, (back_at_m - x) / c)
    return _Loop(out_m, turn_m, out_rad, back_m, last_rad, float(side * (y + back_m * s)))


def _round(how: UpAndGo, pace: StepPace, side: float, rng: np.random.Generator) -> list[Piece]:
    """Once round the cone, back to the chair, and about."""
    back_at_m = how.before_chair_m + (float(rng.uniform(1.0, 1.8)) if how.flaw is CourseFlaw.OTHER_CHAIR else 0.0)
    low, high = SLANTS_RAD
    for _ in range(30):
        slant = 0.5 * (low + high)
        is_short = _loop(how, side, back_at_m, slant).beside_m > 0.0
        low, high = (slant, high) if is_short else (low, slant)
    loop = _loop(how, side, back_at_m, 0.5 * (low + high))
    return [
        *before_turn(pace, loop.out_m, 0.0, rng),
        turn(pace, loop.turn_m, loop.out_rad, rng, least_s=how.turn_s, early=how.early[0]),
        *before_turn(pace, loop.back_m, 0.5, rng),
        turn(pace, how.sit_arc_m, loop.last_rad, rng, least_s=how.sit_turn_s, early=how.early[1]),
    ]


def draw_up_and_go(rng: np.random.Generator) -> UpAndGo:
    """As people go it: closely or widely round the cone, a little beyond it, off before they are upright."""
    return UpAndGo(
        clearance_m=float(rng.uniform(0.12, 0.7)),
        overshoot_m=float(rng.uniform(-0.1, 0.35)),
        before_chair_m=float(rng.uniform(0.0, 0.3)),
        first_step_s=float(rng.uniform(-0.25, 1.0)),
        sits_after_s=float(rng.uniform(-0.3, 1.2)),
        turn_s=float(rng.uniform(1.8, 4.5)),
        sit_turn_s=float(rng.uniform(1.5, 4.0)),
        sit_arc_m=float(rng.uniform(0.25, 0.9)),
        early=(float(rng.uniform(-0.4, 0.4)), float(rng.uniform(-0.4, 0.4))),
        is_unwound=bool(rng.integers(2)),
    )


INVALID = (
    *("2 m", "4 m", "5 m", "past the cone", "turned early"),
    *(str(flaw) for flaw in CourseFlaw if flaw is not CourseFlaw.NONE),
)


def spoiled(how: UpAndGo, wrong: str, rng: np.random.Generator) -> UpAndGo:
    """The same patient on a course that is not the test: one of `INVALID`."""
    if wrong in ("2 m", "4 m", "5 m"):
        return replace(how, cone_m=float(wrong.removesuffix(" m")))
    if wrong == "past the cone":
        return replace(how, overshoot_m=float(rng.uniform(1.0, 3.0)))
    if wrong == "turned early":
        return replace(how, overshoot_m=-float(rng.uniform(1.0, 2.0)))
    return replace(how, flaw=CourseFlaw(wrong))

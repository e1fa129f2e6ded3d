"""Whether simulated courses that are not the test are flagged and valid ones are not; printed by `timed_courses`.

What is true of a course is what was planned for it: where the cone is, how far the patient goes, which chair is sat
down on, how long a lap is and how many were completed.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from core.samples import RateKind
from core.session import Recording, Session
from core.signal.sensors import SensorTracks
from core.timed.found import TimedTest
from core.timed.protocols import PlannedTest, TimedProtocol
from core.timed.timing import time_test
from devices.simulation.walker_body import CourseKind, TimedCourse
from devices.simulation.walker_courses import CourseTruth, draw_course, simulate_course
from devices.simulation.walker_route import INVALID, spoiled

UP_AND_GO = TimedProtocol.UP_AND_GO
SEATED = "did not rise, by keys"
EIGHT_FEET_M = 2.44  # another test, so near that it is not always distinguished from 3 m


def tracks_of(session: Session) -> tuple[SensorTracks, Recording]:
    return SensorTracks(session, session.recordings, frozenset(), RateKind.INSTANTANEOUS), session.recordings[-1]


def timed(course: TimedCourse) -> TimedTest:
    """An up and go as it is reported without keys."""
    return time_test(*tracks_of(simulate_course(course).session), PlannedTest(UP_AND_GO))


def is_flagged(found: TimedTest) -> bool:
    """Whether no figure of it counts: it is not valid, or has no time."""
    return bool(found.not_valid) or not np.isfinite(found.time_s)


@dataclass(slots=True)
class Flags:
    """How many courses of one kind were flagged, and the seeds of those that were not as they should be."""

    flagged: int = 0
    courses: int = 0
    wrong: list[str] = field(default_factory=list)

    def add(self, name: str, found: TimedTest, *, should_be: bool) -> None:
        self.courses += 1
        self.flagged += is_flagged(found)
        if is_flagged(found) is not should_be:
            reasons = " ".join(map(str, found.not_valid)) or "not flagged"
            self.wrong.append(f"{name}: {reasons}, {found.course_found_m:.2f} m")

    @property
    def percent(self) -> float:
        return 100.0 * self.flagged / self.courses


def wrong_courses(seeds: range) -> dict[str, Flags]:
    """Every kind of invalid up and go, by the patients of these seeds."""
    kinds = {wrong: Flags() for wrong in (*INVALID, SEATED)}
    for seed in seeds:
        course = draw_course(CourseKind.UP_AND_GO, seed)
        for wrong in INVALID:
            how = spoiled(course.up_and_go, wrong, np.random.default_rng([seed, 77]))
            kinds[wrong].add(f"{seed}", timed(replace(course, up_and_go=how)), should_be=True)
        made = simulate_course(course)
        seated = PlannedTest(UP_AND_GO, 0.2, float(made.truth.left_seat_s[0]) - 0.5)
        kinds[SEATED].add(f"{seed}", time_test(*tracks_of(made.session), seated), should_be=True)
    return kinds


def eight_feet(seeds: range) -> Flags:
    """The same patients, the cone at 2.44 m."""
    total = Flags()
    for seed in seeds:
        course = draw_course(CourseKind.UP_AND_GO, seed)
        near = replace(course, up_and_go=replace(course.up_and_go, cone_m=EIGHT_FEET_M))
        total.add(f"{seed}", timed(near), should_be=True)
    return total


@dataclass(slots=True)
class LapScore:
    """Laps of courses to and fro: the length found, the distance by laps, and which entries were flagged."""

    length_m: list[float] = field(default_factory=list)
    distance_m: list[float] = field(default_factory=list)
    right: Flags = field(default_factory=Flags)
    one_more: Flags = field(default_factory=Flags)
    longer: Flags = field(default_factory=Flags)

    def add(self, seed: int, course: TimedCourse, session: Session, truth: CourseTruth, kind: CourseKind) -> None:
        protocol, walk = TimedProtocol(kind.value), tracks_of(session)
        start_s = float(truth.contacts_s[0])
        end_s = start_s + {TimedProtocol.TWO_MINUTES: 120.0, TimedProtocol.SIX_MINUTES: 360.0}[protocol]
        done = [turn for turn in truth.turns if 0.5 * (turn.start_s + turn.end_s) <= end_s]
        # somebody with a tape measures from the cone where the patient has just turned
        rest_m = max(0.0, truth.way_at(end_s) - (truth.way_at(done[-1].end_s) if done else 0.0))
        right = PlannedTest(protocol, lap_m=course.lap_m, typed_laps=len(done), rest_m=rest_m)
        found = time_test(*walk, replace(right, typed_laps=None, rest_m=None))
        self.length_m.append(found.course_found_m - course.lap_m)
        self.distance_m.append(found.distance_m - (len(done) * course.lap_m + rest_m))
        self.right.add(f"{seed}", time_test(*walk, right), should_be=False)
        self.one_more.add(f"{seed}", time_test(*walk, replace(right, typed_laps=len(done) + 1)), should_be=True)
        self.longer.add(f"{seed}", time_test(*walk, replace(right, lap_m=1.25 * course.lap_m)), should_be=True)


def reported_laps(total: LapScore) -> Iterator[str]:
    lengths, distances = np.abs(total.length_m), np.abs(total.distance_m)
    yield (
        f"  laps: length off by median {np.nanmedian(lengths):.2f}, worst {np.nanmax(lengths):.2f} m; distance by laps "
        f"off by median {np.nanmedian(distances):.2f}, worst {np.nanmax(distances):.2f} m"
    )
    yield f"  entered rightly: flagged {total.right.flagged} of {total.right.courses} {'; '.join(total.right.wrong)}"
    yield (
        f"  one lap too many flagged {total.one_more.percent:.0f} %, laps a quarter too long "
        f"{total.longer.percent:.0f} % {'; '.join(total.one_more.wrong + total.longer.wrong)}"
    )


def reported_validity(valid: Flags, seeds: range) -> Iterator[str]:
    """The share of invalid courses that are flagged, kind by kind, and of valid ones that are."""
    kinds = wrong_courses(seeds)
    flagged, courses = sum(one.flagged for one in kinds.values()), sum(one.courses for one in kinds.values())
    yield f"up and go that is not one: {flagged} of {courses} flagged, {100.0 * flagged / courses:.1f} %"
    for wrong, one in kinds.items():
        yield f"  {wrong}: {one.flagged} of {one.courses} {'; '.join(one.wrong)}".rstrip()
    yield f"  valid ones flagged: {valid.flagged} of {valid.courses} {'; '.join(valid.wrong)}".rstrip()
    near = eight_feet(seeds)
    yield f"  8 feet for 3 m, which is near: {near.flagged} of {near.courses}"

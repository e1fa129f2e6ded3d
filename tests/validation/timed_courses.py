"""Accuracy of reported timed tests, on 370 simulated courses and on people's recordings.

    python -m tests.validation.timed_courses [--scale 1.0]

Courses: distance, time, turns, laps, pauses and rises against the truth, one line per test, every miss beside its seed;
of an up and go each part, and the share of courses that are no such test and are flagged. Nothing ties the ends of a
10 m walk to a tape unless keys are pressed: it is timed both ways. The recordings are used where GAITWRIGHT_TEST_DATA
names the shared folder: a person who walks and turns beside optics, people after a stroke on a treadmill, who neither
start nor turn.
"""

import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

import numpy as np

from core.body import Side
from core.timed.found import TimedTest
from core.timed.protocols import PlannedTest, TimedProtocol
from core.timed.timing import time_test
from core.timed.way import body_way, pauses_of, start_of, turns_of
from devices.files.session_folder import read_session
from devices.simulation.walker_body import CourseKind
from devices.simulation.walker_courses import TAPE_M, CourseTruth, draw_course, simulate_course
from tests.benchmarks.gait import optical_foot
from tests.driver import options
from tests.validation.recordings_with_references import feet
from tests.validation.timed_validity import Flags, LapScore, reported_laps, reported_validity, tracks_of

COURSES = {
    CourseKind.TEN_METRES: 60,
    CourseKind.TWO_MINUTES: 40,
    CourseKind.SIX_MINUTES: 10,
    CourseKind.UP_AND_GO: 200,
    CourseKind.SIT_TO_STAND: 40,
    CourseKind.STAIRS: 20,
}
LASTS_S = {CourseKind.TWO_MINUTES: 120.0, CourseKind.SIX_MINUTES: 360.0}
WRONG_SEEDS = 20  # patients who walk every kind of course that is not the test
MAX_PART_S = 0.15
MAX_DISTANCE_PERCENT, MAX_TIME_S, MAX_PAUSE_S = 2.0, 0.1, 0.1
MAX_TIGHT_PERCENT = 6.0  # of an up and go, half of which may be turns on the spot


@dataclass(slots=True)
class Score:
    """One test's errors over all its courses; `wrong` names what was missed, with the seed."""

    distance_percent: list[float] = field(default_factory=list)
    start_s: list[float] = field(default_factory=list)
    time_s: list[float] = field(default_factory=list)
    pause_s: list[float] = field(default_factory=list)
    turn_deg: list[float] = field(default_factory=list)
    tape_percent: list[float] = field(default_factory=list)
    turns: int = 0
    pauses: int = 0
    rises: int = 0
    stairs: int = 0
    level: int = 0
    climb_m: list[float] = field(default_factory=list)
    silent: int = 0
    parts_s: dict[str, list[float]] = field(default_factory=dict)
    valid: Flags = field(default_factory=Flags)
    laps: LapScore = field(default_factory=LapScore)
    wrong: list[str] = field(default_factory=list)

    def add(self, seed: int, found: TimedTest, truth: CourseTruth, kind: CourseKind, *, is_silent: bool) -> None:
        start_s, end_s = true_span(kind, truth)
        self.start_s.append(found.start_s - start_s)
        self.time_s.append(found.time_s - (end_s - start_s))
        if not abs(self.time_s[-1]) <= MAX_TIME_S:
            self.wrong.append(f"{seed}: time {self.time_s[-1]:+.3f} s")
        has_distance = not is_silent and kind is not CourseKind.SIT_TO_STAND
        if has_distance == np.isnan(found.distance_m):
            self.wrong.append(f"{seed}: distance {found.distance_m} of a sensor that was silent: {is_silent}")
        self.silent += is_silent
        way_m = truth.way_at(end_s)
        if kind is CourseKind.TEN_METRES:  # 10 m by definition: what the body went between the ends that were found
            way_m = truth.way_at(found.end_s) - truth.way_at(found.start_s)
        if has_distance:
            self.distance_percent.append(100.0 * (found.distance_m / way_m - 1.0))
            most = MAX_TIGHT_PERCENT if kind is CourseKind.UP_AND_GO else MAX_DISTANCE_PERCENT
            if abs(self.distance_percent[-1]) > most:
                self.wrong.append(f"{seed}: distance {self.distance_percent[-1]:+.1f} %")
        self._add_events(seed, found, truth, start_s, end_s)
        for part in found.parts:
            begin_s, over_s = truth.parts_s[part.part]
            self.parts_s.setdefault(part.part, []).append(part.time_s - (over_s - begin_s))

    def _add_events(self, seed: int, found: TimedTest, truth: CourseTruth, start_s: float, end_s: float) -> None:
        turns = [turn for turn in truth.turns if start_s <= 0.5 * (turn.start_s + turn.end_s) <= end_s]
        self.turns += len(turns)
        signs = [np.sign(turn.angle_rad) for turn in turns]
        if signs != [np.sign(turn.angle_rad) for turn in found.turns]:
            self.wrong.append(f"{seed}: {len(found.turns)} turns of {len(turns)}, or to the other side")
        else:
            pairs = zip(found.turns, turns, strict=True)
            self.turn_deg += [float(np.rad2deg(a.angle_rad - b.angle_rad)) for a, b in pairs]
        if len(found.laps) != len(turns) + 1:
            self.wrong.append(f"{seed}: {len(found.laps)} laps of {len(turns) + 1}")
        pauses = [(a, b) for a, b in truth.pauses_s if start_s <= a < end_s]
        self.pauses += len(pauses)
        if len(pauses) != len(found.pauses_s):
            self.wrong.append(f"{seed}: {len(found.pauses_s)} pauses of {len(pauses)}")
        else:
            self.pause_s += [(a[1] - a[0]) - (b[1] - b[0]) for a, b in zip(found.pauses_s, pauses, strict=True)]
        self._add_stairs(seed, found, truth)
        self.rises += len(truth.left_seat_s)
        if len(found.rises) != len(truth.left_seat_s):
            self.wrong.append(f"{seed}: {len(found.rises)} rises of {len(truth.left_seat_s)}")

    def _add_stairs(self, seed: int, found: TimedTest, truth: CourseTruth) -> None:
        """Every stride up and down with its height, by the foot; a foot's first swing ends no stride."""
        for side, climbs_m in truth.climbs_m.items():
            true_m = [float(one) for one in climbs_m[1:] if abs(one) > 0.01]
            reported_m = [one.climb_m for one in found.stairs if one.side is side]
            self.stairs += len(true_m)
            self.level += len(climbs_m) - 1 - len(true_m)
            if [np.sign(one) for one in reported_m] != [np.sign(one) for one in true_m]:
                self.wrong.append(
                    f"{seed}: {len(reported_m)} strides on stairs of {len(true_m)}, or up for down, {side}"
                )
            else:
                self.climb_m += [a - b for a, b in zip(reported_m, true_m, strict=True)]
        if not truth.climbs_m and found.stairs:
            self.wrong.append(f"{seed}: {len(found.stairs)} strides on stairs that are not there")


def true_span(kind: CourseKind, truth: CourseTruth) -> tuple[float, float]:
    """Start and end by the truth."""
    if kind is CourseKind.TEN_METRES:
        return truth.passes_s(TAPE_M[0]), truth.passes_s(TAPE_M[1])
    if kind is CourseKind.UP_AND_GO:
        return float(truth.left_seat_s[0]), float(truth.seated_s[0])
    if kind is CourseKind.SIT_TO_STAND:
        return float(truth.left_seat_s[0]), float(truth.upright_s[4])
    if kind is CourseKind.STAIRS:
        return float(truth.contacts_s[0]), float(truth.contacts_s[-1])
    return float(truth.contacts_s[0]), float(truth.contacts_s[0]) + LASTS_S[kind]


def score(kind: CourseKind, seeds: range) -> Score:
    """Time every course of one kind."""
    total = Score()
    for seed in seeds:
        course = draw_course(kind, seed)
        made = simulate_course(course)
        tracks, recording = tracks_of(made.session)
        found = time_test(tracks, recording, PlannedTest(TimedProtocol(kind.value)))
        total.add(seed, found, made.truth, kind, is_silent=bool(course.silent_s))
        if kind in LASTS_S:
            total.laps.add(seed, course, made.session, made.truth, kind)
        if kind is CourseKind.UP_AND_GO:
            total.valid.add(f"{seed}", found, should_be=False)
        if kind is CourseKind.TEN_METRES:
            by_key = time_test(tracks, recording, PlannedTest(TimedProtocol(kind.value), *true_span(kind, made.truth)))
            total.tape_percent.append(100.0 * by_key.tape_difference_m / by_key.distance_m)
    return total


def spread(values: list[float], unit: str, digits: int = 2) -> str:
    """Median, 95th percentile and worst of the sizes."""
    if not values:
        return "-"
    sizes = np.abs(values)
    cells = (f"{value:.{digits}f}" for value in (np.median(values), np.nanquantile(sizes, 0.95), np.nanmax(sizes)))
    return "median {}, p95 {}, worst {} ".format(*cells) + unit


def reported(kind: CourseKind, total: Score) -> Iterator[str]:
    """What is printed of one test."""
    yield f"{kind}: {len(total.time_s)} courses, {total.silent} with a silent sensor"
    yield f"  distance {spread(total.distance_percent, '%')}"
    if total.tape_percent:
        yield f"  the sensors' own 10 m between two keys {spread(total.tape_percent, '%')}"
    yield f"  time {spread(total.time_s, 's', 3)}; start {spread(total.start_s, 's', 3)}"
    yield f"  {total.turns} turns, angle {spread(total.turn_deg, 'deg', 1)}"
    if total.stairs:
        yield f"  {total.stairs} strides on stairs and {total.level} level ones, height {spread(total.climb_m, 'm', 3)}"
    yield f"  {total.pauses} pauses, length {spread(total.pause_s, 's', 3)}; {total.rises} rises"
    for part, errors in total.parts_s.items():
        within = 100.0 * np.mean(np.abs(errors) <= MAX_PART_S)
        yield f"  {part}: {spread(errors, 's', 3)}; within {MAX_PART_S} s {within:.1f} %"
    if kind in LASTS_S:
        yield from reported_laps(total.laps)
    yield f"  missed: {'; '.join(total.wrong) or 'nothing'}"


def recordings(data: Path) -> Iterator[str]:
    """What can be given of people's recordings."""
    with tempfile.TemporaryDirectory() as folder:
        session = read_session(feet(data, Path(folder)).session)
    tracks, recording = tracks_of(session)
    way = body_way(tracks, recording)
    turns = ", ".join(f"{np.rad2deg(turn.angle_rad):+.0f}" for turn in turns_of(way))
    start_s = start_of(way)[0]
    yield f"healthy feet beside optics: {way.way_m[-1]:.1f} m, turns {turns or 'none'} deg, start {start_s:.2f} s"
    strides = [one for side in Side for one in optical_foot(data, side).strides]
    ours = sum(way.way_at(one.end_s) - way.way_at(one.start_s) for one in strides)
    optics = sum(one.length_m for one in strides)
    yield f"  {len(strides)} strides of {optics:.2f} m by optics, the body's way {100.0 * (ours / optics - 1.0):+.2f} %"
    for place in sorted((data / "stroke_treadmill").glob("stroke0*")):
        tracks, recording = tracks_of(read_session(place))
        way = body_way(tracks, recording)
        lasts_s = way.time_s[-1] - way.time_s[0]
        yield (
            f"{place.name}: {lasts_s:.0f} s, belt passed {way.way_m[-1]:.1f} m, turns {len(turns_of(way))}, "
            f"pauses {len(pauses_of(way))}, start {start_of(way)[0]:.2f} s, cadence "
            f"{way.cadence_in(way.time_s[0], way.time_s[-1]):.0f} steps/min"
        )


def main() -> None:
    required = options(__doc__, first=(0, "the first seed"), scale=(1.0, "share of the 370 courses"))
    scale, first = required.scale, required.first
    for kind, count in COURSES.items():
        total = score(kind, range(first, first + max(1, round(scale * count))))
        lines = reported(kind, total)
        if kind is CourseKind.UP_AND_GO:
            lines = chain(
                lines, reported_validity(total.valid, range(first, first + max(1, round(scale * WRONG_SEEDS))))
            )
        for line in lines:
            print(line, flush=True)
    data = os.environ.get("GAITWRIGHT_TEST_DATA")
    for line in recordings(Path(data)) if data else ():
        print(line, flush=True)


if __name__ == "__main__":
    main()

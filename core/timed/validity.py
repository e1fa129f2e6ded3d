"""Whether a test was walked on the course that it is called by, held against the way of the feet.

The body's way over the floor is the feet's distance laid along their heading. From the chair to the cone it is as far
as the patient got, less half the width of the loop round the cone, so that a wide turn counts as one round the same
cone. The same between two turns is a lap.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.samples import FloatArray
from core.timed.found import NotValid, Turn
from core.timed.protocols import Definition
from core.timed.seat import SeatMotions
from core.timed.way import BodyWay

# On simulated valid courses of 3 m the cone was found where it is, give or take 0.18 m (standard deviation), most of it
# because patients stand 0 to 0.3 m before the chair and turn up to 0.35 m beyond the cone, or 0.1 m short of it. Three
# such deviations are 0.55 m. Longer courses add the feet's own error, 2 % at most, and what people's add to it.
TOLERANCE_M, TOLERANCE_SHARE = 0.40, 0.05
LOOP_M = 0.8  # so far back from the farthest point the loop round a cone is as wide as it gets
ELSEWHERE_M = 0.85  # at the end from where it began: patients who came back to their chair were within 0.65 m
TO_SIT_RAD = np.deg2rad(90.0)  # who turns by less sits down sideways
SEAT_S = 2.0  # a key at the start may be pressed so long after the rise has begun
TIME_TOLERANCE_S = 1.0  # of a set time that a key ends: nobody presses to the tenth
DISTANCE_TOLERANCE_M = 2.0  # of a distance that was entered: a step or two


@dataclass(frozen=True, slots=True)
class Checked:
    """What a course was by the feet, NaN where they do not show it, and why it is not the test's."""

    found_m: float
    reasons: tuple[NotValid, ...] = ()


NOT_CHECKED = Checked(math.nan)


def tolerance_m(course_m: float) -> float:
    """By how much a course of so many metres may be off by the feet, m."""
    return TOLERANCE_M + TOLERANCE_SHARE * course_m


def length_reasons(found_m: float, course_m: float) -> tuple[NotValid, ...]:
    """Why a course of `found_m` is not one of `course_m`; nothing where either is not known."""
    if not abs(found_m - course_m) > tolerance_m(course_m):
        return ()
    return (NotValid.COURSE_LONGER,) if found_m > course_m else (NotValid.COURSE_SHORTER,)


def check_whole(definition: Definition, seat: SeatMotions, span_s: tuple[float, float]) -> tuple[NotValid, ...]:
    """Why a test that a key ended is not whole: another time than the set one, or fewer rises than it takes."""
    start_s, end_s = span_s
    reasons = []
    if definition.duration_s is not None and abs(end_s - start_s - definition.duration_s) > TIME_TOLERANCE_S:
        reasons.append(NotValid.OTHER_TIME)
    rises = sum(start_s - SEAT_S <= one.left_seat_s < end_s for one in seat.rises)
    if definition.rises > 1 and seat.has_thighs and rises < definition.rises:
        reasons.append(NotValid.FEWER_RISES)
    return tuple(reasons)


def check_straight(turns: tuple[Turn, ...]) -> tuple[NotValid, ...]:
    """Why a walk between tapes is none: the patient turned round on the way."""
    return (NotValid.MORE_TURNS,) if any(turn.is_about for turn in turns) else ()


def place_at(way: BodyWay, start_s: float, end_s: float) -> tuple[FloatArray, FloatArray]:
    """The clock (n,) between two instants and where the body is over the floor (n, 2), m, from the first on."""
    rows = (way.time_s >= start_s) & (way.time_s <= end_s)
    heading = way.heading_rad[rows]
    gone = np.diff(way.way_m[rows], prepend=way.way_m[rows][:1])
    return way.time_s[rows], np.cumsum(gone[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1), axis=0)


def cone_turns(way: BodyWay, turns: tuple[Turn, ...], start_s: float, end_s: float) -> tuple[Turn | None, Turn | None]:
    """The turn where the patient was farthest from the start, and the last one if it came later."""
    time_s, place = place_at(way, start_s, end_s)
    if not turns or len(time_s) < 2:
        return None, None
    far_s = float(time_s[int(np.argmax(np.linalg.norm(place, axis=1)))])
    cone = min(turns, key=lambda one: max(one.start_s - far_s, far_s - one.end_s, 0.0))
    return cone, turns[-1] if turns[-1] is not cone else None


def check_up_and_go(
    way: BodyWay, seat: SeatMotions, turns: tuple[Turn, ...], span_s: tuple[float, float], course_m: float
) -> Checked:
    """Hold an up and go against what it asks for: rise, go round a cone so far away, come back, turn, sit."""
    start_s, end_s = span_s
    time_s, place = place_at(way, start_s, end_s)
    if len(time_s) < 2 or not way.is_whole_in(start_s, end_s):
        return NOT_CHECKED
    reasons: list[NotValid] = []
    if seat.has_thighs and not any(start_s - SEAT_S <= one.left_seat_s < end_s for one in seat.rises):
        reasons.append(NotValid.NO_RISE)
    found_m = _far_end(place)
    reasons += length_reasons(found_m, course_m)
    cone, _ = cone_turns(way, turns, start_s, end_s)
    if cone is None or not cone.is_about:
        reasons.append(NotValid.NO_TURN)
    elif abs(_turned_after(way, cone, end_s)) < TO_SIT_RAD:
        reasons.append(NotValid.NO_TURN_TO_SIT)
    if sum(one.is_about for one in turns) > 2:
        reasons.append(NotValid.MORE_TURNS)
    if float(np.linalg.norm(place[-1])) > ELSEWHERE_M:
        reasons.append(NotValid.ELSEWHERE)
    return Checked(found_m, tuple(reasons))


def _turned_after(way: BodyWay, cone: Turn, end_s: float) -> float:
    """How far the body turned after the cone, rad, both ways taken together."""
    after, last = np.searchsorted(way.time_s, [cone.end_s, end_s])
    heading = way.heading_rad[after : max(last, after + 1)]
    return float(heading[-1] - np.median(heading[: max(1, len(heading) // 2)]))


def _far_end(place: FloatArray) -> float:
    """From the first place (n, 2) to the cone, m: as far as the way leads, less half of its width there."""
    distance = np.linalg.norm(place - place[0], axis=1)
    far = int(np.argmax(distance))
    if distance[far] <= 0.0:
        return 0.0
    ahead = (place[far] - place[0]) / distance[far]
    return float(distance[far] - 0.5 * _width(place - place[0], ahead, float(distance[far])))


def _width(place: FloatArray, ahead: FloatArray, far_m: float) -> float:
    """How wide the way is at its far end."""
    near = place @ ahead > far_m - LOOP_M
    return float(np.ptp(place[near] @ np.array([-ahead[1], ahead[0]])))


@dataclass(frozen=True, slots=True)
class Laps:
    """Laps from cone to cone: how many were completed, how long they were (median), and how far the next one came."""

    completed: int
    length_m: float
    rest_m: float


def laps_of(way: BodyWay, turns: tuple[Turn, ...], start_s: float, end_s: float) -> Laps:
    """Give the laps between turns about. What a silence touches is NaN, and all of it once no foot was received."""
    if _is_unseen(way, start_s, end_s):
        return Laps(0, math.nan, math.nan)
    abouts = [turn for turn in turns if turn.is_about]
    ends_s = [start_s, *(turn.middle_s for turn in abouts), end_s]
    lengths, rest_m = [], math.nan
    for number, (from_s, to_s) in enumerate(pairwise(ends_s)):
        if not way.is_whole_in(from_s, to_s):
            continue
        _, place = place_at(way, from_s, to_s)
        is_first, is_last = number == 0, number == len(abouts)
        length_m = _between(place, is_round_first=not is_first, is_round_last=not is_last)
        if is_last:
            rest_m = length_m
        else:
            lengths.append(length_m)
    return Laps(len(abouts), float(np.median(lengths)) if lengths else math.nan, rest_m)


def _is_unseen(way: BodyWay, start_s: float, end_s: float) -> bool:
    """Whether there was a moment in which no foot was received, so that a turn may be missing."""
    silences = way.silences_in(start_s, end_s)
    of_sites = [[one for one in silences if one.site is site] for site in {one.site for one in silences}]
    if len(of_sites) < len(way.feet):
        return not way.feet
    return any(
        all(any(one.start_s < other.end_s and one.end_s > other.start_s for other in of_site) for of_site in of_sites)
        for one in silences
    )


def _between(place: FloatArray, *, is_round_first: bool, is_round_last: bool) -> float:
    """From cone to cone, m, of the way (n, 2) from the middle of the turn round one to that round the other."""
    ahead = place[-1] - place[0] if len(place) else np.zeros(2)
    length_m = float(np.linalg.norm(ahead))
    if length_m <= 0.0:  # it ends in the turn
        return 0.0
    ahead = ahead / length_m
    # of each loop half is seen here, so that its width is half of a whole one's
    first = _width(place[::-1] - place[-1], -ahead, length_m) if is_round_first else 0.0
    last = _width(place - place[0], ahead, length_m) if is_round_last else 0.0
    return max(0.0, length_m - first - last)


def check_laps(laps: Laps, lap_m: float, typed_m: float, found_m: float, open_m: float) -> Checked:
    """Hold laps against their entered length, and an entered distance against the one that was found.

    `open_m`: so much less the entered distance may be, where only whole laps were entered; NaN is not known.
    """
    reasons: list[NotValid] = []
    if abs(laps.length_m - lap_m) > tolerance_m(lap_m):
        reasons.append(NotValid.LAP_DIFFERS)
    if typed_m - found_m > DISTANCE_TOLERANCE_M or found_m - typed_m > DISTANCE_TOLERANCE_M + open_m:
        reasons.append(NotValid.DISTANCE_DIFFERS)
    return Checked(laps.length_m, tuple(reasons))

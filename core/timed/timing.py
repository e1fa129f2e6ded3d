"""Time, distance, speed, cadence, turns and pauses of one timed test, and how they change over it.

A key wins over the motion: between two keys a walk of 10 m counts as 10.00 m, and the sensors' own distance is
given beside it. A foot sensor that falls silent takes the distance, never the time.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.gait.stairs import FootClimbs, on_stairs
from core.session import Recording
from core.signal.sensors import SensorTracks
from core.timed.found import DistanceSource, NotMeasured, StairStride, TimedPart, TimedTest, Turn, UpAndGoPart
from core.timed.parts import parts_of
from core.timed.protocols import DEFINITIONS, Definition, PlannedTest
from core.timed.seat import NO_SEAT, SeatMotions, seat_motions
from core.timed.validity import (
    NOT_CHECKED,
    Checked,
    Laps,
    check_laps,
    check_straight,
    check_up_and_go,
    check_whole,
    cone_turns,
    laps_of,
    length_reasons,
)
from core.timed.way import BodyWay, body_way, laps_between, pauses_of, start_of, turns_of

THIRDS = 3


def time_test(tracks: SensorTracks, recording: Recording, planned: PlannedTest) -> TimedTest:
    """Time one test from its recording, in seconds, metres and radians; key times on its clock."""
    is_from_chair = DEFINITIONS[planned.protocol].is_from_chair
    seat = seat_motions(tracks, recording) if is_from_chair else NO_SEAT
    return timed(body_way(tracks, recording), seat, planned)


def timed(way: BodyWay, seat: SeatMotions, planned: PlannedTest) -> TimedTest:
    """Time one test from the body's way and rises, live and recorded alike, on the clock of `way`."""
    definition = DEFINITIONS[planned.protocol]
    missing: list[NotMeasured] = []
    if definition.is_from_chair:
        start_s, end_s = _chair(definition, seat, planned, missing)
    else:
        start_s, end_s = _on_foot(definition, way, planned, missing)
    start_s, end_s = _by_keys(start_s, end_s, planned)
    if not math.isfinite(start_s) and not missing:
        missing.append(NotMeasured.NO_START)
    is_whole = math.isfinite(start_s) and math.isfinite(end_s)
    if math.isfinite(start_s) and not is_whole:
        missing.append(NotMeasured.NOT_FINISHED)
    silences = way.silences_in(start_s, end_s) if is_whole else way.silences
    has_way = definition.rises <= 1  # who rises again and again goes nowhere
    has_distance = has_way and is_whole and len(way.time_s) > 0 and not silences
    if has_way and silences:
        missing.append(NotMeasured.SILENT)
    elif has_way and not len(way.time_s):
        missing.append(NotMeasured.NO_FEET)
    walked = way.way_at(end_s) - origin_of(way, start_s) if has_distance else math.nan
    inside = tuple(t for t in turns_of(way) if start_s <= t.middle_s <= end_s)
    course = _course(way, seat, planned, inside, (start_s, end_s), walked) if is_whole else NOT_WALKED
    thirds_s = np.linspace(start_s, end_s, THIRDS + 1).tolist() if is_whole else []
    return TimedTest(
        protocol=planned.protocol,
        start_s=start_s,
        end_s=end_s,
        is_start_by_key=planned.start_key_s is not None,
        is_end_by_key=planned.end_key_s is not None,
        distance_m=course.distance_m,
        sensor_distance_m=course.sensor_distance_m,
        cadence_steps_min=way.cadence_in(start_s, end_s),
        turns=inside,
        pauses_s=tuple((a, b) for a, b in pauses_of(way) if start_s <= a < end_s),
        laps=tuple(_part(way, a, b) for a, b in laps_between(inside, start_s, end_s)) if is_whole else (),
        thirds=tuple(_part(way, a, b) for a, b in pairwise(thirds_s)),
        rises=tuple(rise for rise in seat.rises if start_s <= rise.left_seat_s <= end_s),
        silences=silences,
        missing=tuple(dict.fromkeys(missing)),
        stairs=stairs_in(way, start_s, end_s, are_declared=planned.protocol.is_on_stairs) if is_whole else (),
        parts=_parts(way, seat, definition, inside, (start_s, end_s)),
        sittings=tuple(one for one in seat.sittings if start_s < one.seated_s <= end_s),
        course_m=course.course_m,
        course_found_m=course.checked.found_m,
        not_valid=(*check_whole(definition, seat, (start_s, end_s)), *course.checked.reasons) if is_whole else (),
        distance_source=course.source,
    )


def _parts(
    way: BodyWay, seat: SeatMotions, definition: Definition, turns: tuple[Turn, ...], span_s: tuple[float, float]
) -> tuple[UpAndGoPart, ...]:
    """All six of an up and go that was finished; a swing that was not received takes the turns."""
    if definition.course_m is None or not all(map(math.isfinite, span_s)):
        return ()
    at_cone = cone_turns(way, turns, *span_s) if way.is_whole_in(*span_s) else (None, None)
    return parts_of(way, seat, at_cone, *span_s)


@dataclass(frozen=True, slots=True)
class _Walked:
    """Which distance counts, and what the course was."""

    distance_m: float = math.nan
    sensor_distance_m: float = math.nan
    source: DistanceSource = DistanceSource.FEET
    course_m: float = math.nan
    checked: Checked = NOT_CHECKED


NOT_WALKED = _Walked()


def _course(
    way: BodyWay,
    seat: SeatMotions,
    planned: PlannedTest,
    turns: tuple[Turn, ...],
    span_s: tuple[float, float],
    walked_m: float,
) -> _Walked:
    """The distance that counts, and the course held against the way of the feet."""
    definition = DEFINITIONS[planned.protocol]
    if definition.course_m is not None:
        course_m = planned.course_m or definition.course_m
        return _Walked(
            walked_m, walked_m, course_m=course_m, checked=check_up_and_go(way, seat, turns, span_s, course_m)
        )
    if definition.length_m is not None:
        length_m = planned.course_m or definition.length_m
        if planned.end_key_s is None:
            found_m = length_m if math.isfinite(walked_m) else math.nan
            checked = Checked(math.nan, check_straight(turns))
            return _Walked(found_m, found_m, course_m=length_m, checked=checked)
        reasons = (*check_straight(turns), *length_reasons(walked_m, length_m))
        return _Walked(length_m, walked_m, DistanceSource.TAPE, length_m, Checked(walked_m, reasons))
    if definition.duration_s is not None and planned.lap_m is not None:
        return _by_laps(laps_of(way, turns, *span_s), planned, walked_m)
    return _Walked(walked_m, walked_m)


def _by_laps(laps: Laps, planned: PlannedTest, walked_m: float) -> _Walked:
    """Laps of an entered length: as many as were entered, else as many as were found."""
    lap_m = planned.lap_m or math.nan
    found_m = laps.completed * lap_m + min(laps.rest_m, lap_m)
    typed_m = math.nan if planned.typed_laps is None else planned.typed_laps * lap_m + (planned.rest_m or 0.0)
    checked = check_laps(laps, lap_m, typed_m, found_m, lap_m if planned.rest_m is None else 0.0)
    if math.isfinite(typed_m):
        return _Walked(typed_m, walked_m, DistanceSource.TYPED, lap_m, checked)
    if math.isfinite(found_m) and laps.completed:
        return _Walked(found_m, walked_m, DistanceSource.FOUND_LAPS, lap_m, checked)
    return _Walked(walked_m, walked_m, course_m=lap_m, checked=checked)


def _by_keys(start_s: float, end_s: float, planned: PlannedTest) -> tuple[float, float]:
    """A key wins over the motion; what would then end before it began has not begun."""
    start_s = start_s if planned.start_key_s is None else planned.start_key_s
    end_s = end_s if planned.end_key_s is None else planned.end_key_s
    return (start_s, end_s) if not end_s <= start_s else (math.nan, math.nan)


def _chair(
    definition: Definition, seat: SeatMotions, planned: PlannedTest, missing: list[NotMeasured]
) -> tuple[float, float]:
    """From the first rise to the last one's end, or, of one rise, to sitting again."""
    if not seat.has_thighs:
        missing.append(NotMeasured.NO_THIGHS)
    key_s = planned.start_key_s
    first_s = key_s if key_s is not None else seat.rises[0].left_seat_s if seat.rises else math.nan
    if seat.has_thighs and not seat.rises and key_s is None:
        missing.append(NotMeasured.NO_RISE)
    later = [rise for rise in seat.rises if rise.upright_s > first_s]
    if definition.rises == 1:
        ends = [one.seated_s for one in seat.sittings if later and one.seated_s > later[0].upright_s]
        return first_s, ends[0] if ends else math.nan
    return first_s, later[definition.rises - 1].upright_s if len(later) >= definition.rises else math.nan


def _on_foot(
    definition: Definition, way: BodyWay, planned: PlannedTest, missing: list[NotMeasured]
) -> tuple[float, float]:
    """From the first contact, or the tape's first mark, on."""
    first_s, left_s = start_of(way)
    key_s = planned.start_key_s
    if key_s is None and not math.isfinite(first_s):
        missing.append(NotMeasured.NO_START)
        return math.nan, math.nan
    if definition.tape_m is None:
        start_s = first_s if key_s is None else key_s
        return start_s, _end_on_foot(definition, way, start_s)
    begin_m, end_m = definition.tape_m
    end_m = begin_m + planned.course_m if planned.course_m is not None else end_m
    start_s = way.passes_s(way.way_at(left_s) + begin_m) if key_s is None else key_s
    end_s = way.passes_s(way.way_at(start_s) + end_m - begin_m) if math.isfinite(start_s) else math.nan
    # a way that was not received shows no mark on it
    first_of_way_s = way.time_s[0] if len(way.time_s) else 0.0
    if key_s is None and way.silences_in(first_of_way_s, start_s if math.isfinite(start_s) else math.inf):
        return math.nan, math.nan
    if way.silences_in(start_s, end_s if math.isfinite(end_s) else math.inf):
        end_s = math.nan
    return start_s, end_s


def _end_on_foot(definition: Definition, way: BodyWay, start_s: float) -> float:
    """When its time is over, or, where it has none, with the last contact; NaN where nobody knows yet."""
    if definition.duration_s is None:
        swings = way.swings_s
        return float(swings[:, 1].max()) if len(swings) else math.nan
    end_s = start_s + definition.duration_s
    return math.nan if len(way.time_s) and end_s > way.time_s[-1] else end_s


def stairs_in(way: BodyWay, start_s: float, end_s: float, *, are_declared: bool) -> tuple[StairStride, ...]:
    """Give the strides onto a higher or lower step, in order of time; a foot's first contact ends no stride."""
    feet = [FootClimbs(foot.contact_s, foot.length_m, foot.climb_m) for foot in way.feet.values()]
    found = []
    for side, foot, ways in zip(way.feet, feet, on_stairs(feet, are_declared=are_declared), strict=True):
        for k in np.flatnonzero(ways).tolist():
            if k > 0 and start_s <= foot.end_s[k] <= end_s:
                found.append(StairStride(side, float(foot.end_s[k - 1]), float(foot.end_s[k]), float(foot.climb_m[k])))
    return tuple(sorted(found, key=lambda one: one.end_s))


def origin_of(way: BodyWay, start_s: float) -> float:
    """Give where the way begins, in metres: where the patient stood if the first contact starts the clock."""
    first_s, left_s = start_of(way)
    return way.way_at(left_s if start_s == first_s else start_s)


def _part(way: BodyWay, start_s: float, end_s: float) -> TimedPart:
    is_known = len(way.time_s) > 0 and not way.silences_in(start_s, end_s)
    distance_m = way.way_at(end_s) - way.way_at(start_s) if is_known else math.nan
    return TimedPart(start_s, end_s, distance_m, distance_m / (end_s - start_s), way.cadence_in(start_s, end_s))

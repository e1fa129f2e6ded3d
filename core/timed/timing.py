"""Time, distance, speed, cadence, turns and pauses of one timed test, and how they change over it.

A key wins over the motion: between two keys a walk of 10 m counts as 10.00 m, and the sensors' own distance stands
beside it. A foot sensor that falls silent takes the distance, never the time.
"""

import math
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

import numpy as np

from core.samples import Recording
from core.sensors import SensorTracks
from core.timed.protocols import DEFINITIONS, Definition, TimedProtocol
from core.timed.seat import Rise, SeatMotions, seat_motions
from core.timed.way import BodyWay, Silence, Turn, body_way, laps_between, pauses_of, start_of, turns_of

THIRDS = 3


class NotMeasured(StrEnum):
    """Why a value is missing. The values are the words of timed_tests.csv."""

    NO_FEET = "no_foot_sensors"
    NO_THIGHS = "no_thigh_sensors_or_no_standing"
    NO_START = "no_still_second_before_a_step"
    NOT_FINISHED = "not_finished"
    SILENT = "foot_sensor_silent"


@dataclass(frozen=True, slots=True)
class TimedPart:
    """A lap or a third of a test; NaN where not measured. The speed is over the whole part, pauses included."""

    start_s: float
    end_s: float
    distance_m: float
    speed_m_s: float
    cadence_steps_min: float


@dataclass(frozen=True, slots=True)
class TimedTest:
    """What one test gives; NaN where not measured, and `missing` says why.

    Attributes
    ----------
    start_s, end_s
        On the recording's clock.
    distance_m
        What counts: between two keys the tape's, else the sensors', turns included.
    sensor_distance_m
        By the feet between start and end.
    pauses_s
        From contact to toe-off, wherever both feet stood for a second.
    """

    protocol: TimedProtocol
    start_s: float
    end_s: float
    is_start_by_key: bool
    is_end_by_key: bool
    distance_m: float
    sensor_distance_m: float
    cadence_steps_min: float
    turns: tuple[Turn, ...]
    pauses_s: tuple[tuple[float, float], ...]
    laps: tuple[TimedPart, ...]
    thirds: tuple[TimedPart, ...]
    rises: tuple[Rise, ...]
    silences: tuple[Silence, ...]
    missing: tuple[NotMeasured, ...]

    @property
    def time_s(self) -> float:
        """How long it took, NaN where start or end is missing."""
        return self.end_s - self.start_s

    @property
    def speed_m_s(self) -> float:
        """Distance over time, pauses included."""
        return self.distance_m / self.time_s if self.time_s > 0 else math.nan

    @property
    def tape_difference_m(self) -> float:
        """The sensors' distance less the one that counts; NaN unless a tape told."""
        return self.sensor_distance_m - self.distance_m if self.is_start_by_key and self.is_end_by_key else math.nan

    @property
    def definition(self) -> Definition:
        """What starts and ends it, and what is known of its error."""
        return DEFINITIONS[self.protocol]


def time_test(
    tracks: SensorTracks, recording: Recording, protocol: TimedProtocol, keys_s: tuple[float, ...] = ()
) -> TimedTest:
    """Time one test.

    Parameters
    ----------
    keys_s
        When a key was pressed: none, the start, or start and end, on the recording's clock.

    Returns
    -------
    TimedTest
        Seconds, metres, radians.

    Raises
    ------
    ValueError
        More than two keys, or an end that is not after its start.
    """
    if len(keys_s) > 2 or (len(keys_s) == 2 and keys_s[1] <= keys_s[0]):
        raise ValueError(f"keys_s is {keys_s}, expected none, the start, or start and end")
    definition = DEFINITIONS[protocol]
    way = body_way(tracks, recording)
    seat = seat_motions(tracks, recording) if definition.is_from_chair else SeatMotions((), ())
    missing: list[NotMeasured] = []
    if definition.is_from_chair:
        start_s, end_s = _chair(definition, seat, keys_s, missing)
    else:
        start_s, end_s = _on_foot(definition, way, keys_s, missing)
    is_whole = math.isfinite(start_s) and math.isfinite(end_s)
    silences = way.silences_in(start_s, end_s) if is_whole else way.silences
    has_distance = is_whole and len(way.time_s) > 0 and not silences
    if silences:
        missing.append(NotMeasured.SILENT)
    elif not len(way.time_s):
        missing.append(NotMeasured.NO_FEET)
    walked = way.way_at(end_s) - _origin(way, start_s) if has_distance else math.nan
    if definition.tape_m is not None and len(keys_s) < 2 and has_distance:
        walked = definition.tape_m[1] - definition.tape_m[0]
    is_taped = definition.tape_m is not None and len(keys_s) == 2
    inside = tuple(t for t in turns_of(way) if start_s <= t.middle_s <= end_s)
    thirds_s = np.linspace(start_s, end_s, THIRDS + 1).tolist() if is_whole else []
    return TimedTest(
        protocol=protocol,
        start_s=start_s,
        end_s=end_s,
        is_start_by_key=bool(keys_s),
        is_end_by_key=len(keys_s) == 2,
        distance_m=definition.tape_m[1] - definition.tape_m[0] if is_taped and definition.tape_m else walked,
        sensor_distance_m=walked,
        cadence_steps_min=way.cadence_in(start_s, end_s),
        turns=inside,
        pauses_s=tuple((a, b) for a, b in pauses_of(way) if start_s <= a < end_s),
        laps=tuple(_part(way, a, b) for a, b in laps_between(inside, start_s, end_s)) if is_whole else (),
        thirds=tuple(_part(way, a, b) for a, b in pairwise(thirds_s)),
        rises=tuple(rise for rise in seat.rises if start_s <= rise.left_seat_s <= end_s),
        silences=silences,
        missing=tuple(dict.fromkeys(missing)),
    )


def _chair(
    definition: Definition, seat: SeatMotions, keys_s: tuple[float, ...], missing: list[NotMeasured]
) -> tuple[float, float]:
    """From the first rise to the last one's end, or, of one rise, to sitting again."""
    if not seat.has_thighs:
        missing.append(NotMeasured.NO_THIGHS)
    first_s = keys_s[0] if keys_s else seat.rises[0].left_seat_s if seat.rises else math.nan
    if len(keys_s) == 2:
        return first_s, keys_s[1]
    later = [rise for rise in seat.rises if rise.upright_s > first_s]
    if definition.rises == 1:
        ends = [s for s in seat.seated_s if later and s > later[0].upright_s]
        end_s = ends[0] if ends else math.nan
    else:
        end_s = later[definition.rises - 1].upright_s if len(later) >= definition.rises else math.nan
    if seat.has_thighs and not math.isfinite(end_s):
        missing.append(NotMeasured.NOT_FINISHED)
    return first_s, end_s


def _on_foot(
    definition: Definition, way: BodyWay, keys_s: tuple[float, ...], missing: list[NotMeasured]
) -> tuple[float, float]:
    """From the first contact, or the tape's first mark, on."""
    if len(keys_s) == 2:
        return keys_s[0], keys_s[1]
    first_s, left_s = start_of(way)
    if not keys_s and not math.isfinite(first_s):
        missing.append(NotMeasured.NO_START)
        return math.nan, math.nan
    if definition.tape_m is not None:
        begin_m, end_m = definition.tape_m
        start_s = keys_s[0] if keys_s else way.passes_s(way.way_at(left_s) + begin_m)
        end_s = way.passes_s(way.way_at(start_s) + end_m - begin_m) if math.isfinite(start_s) else math.nan
        if way.silences_in(way.time_s[0] if len(way.time_s) else 0.0, end_s):
            return start_s if keys_s else math.nan, math.nan
    else:
        start_s = keys_s[0] if keys_s else first_s
        end_s = start_s + (definition.duration_s or 0.0)
        if len(way.time_s) and end_s > way.time_s[-1]:
            end_s = math.nan
    if not math.isfinite(end_s):
        missing.append(NotMeasured.NOT_FINISHED)
    return start_s, end_s


def _origin(way: BodyWay, start_s: float) -> float:
    """Where the way begins: where the patient stood, if the clock starts with the first contact."""
    first_s, left_s = start_of(way)
    return way.way_at(left_s if start_s == first_s else start_s)


def _part(way: BodyWay, start_s: float, end_s: float) -> TimedPart:
    is_known = len(way.time_s) > 0 and not way.silences_in(start_s, end_s)
    distance_m = way.way_at(end_s) - way.way_at(start_s) if is_known else math.nan
    return TimedPart(start_s, end_s, distance_m, distance_m / (end_s - start_s), way.cadence_in(start_s, end_s))

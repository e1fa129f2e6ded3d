"""Courses drawn on the floor: which are an up and go of so many metres, how long their laps are, and which are not."""

import numpy as np
import pytest

from core.body import Side
from core.samples import FloatArray
from core.timed.found import NotValid, Rise
from core.timed.protocols import DEFINITIONS, TimedProtocol
from core.timed.seat import SeatMotions
from core.timed.validity import check_laps, check_up_and_go, check_whole, laps_of, tolerance_m
from core.timed.way import BodyWay, FootSteps, turns_of

STEP_S, SPEED_M_S = 0.02, 1.0
RISE = SeatMotions((Rise(0.1, 1.0),), ())
Piece = tuple[float, float]  # how far, and by how many degrees it turns meanwhile


def drawn(*pieces: Piece) -> BodyWay:
    """A way over the floor at 1 m/s, turning evenly within each piece."""
    rates: list[FloatArray] = []
    for length_m, turn_deg in pieces:
        count = round(length_m / SPEED_M_S / STEP_S)
        rates.append(np.full(count, np.deg2rad(turn_deg) / count))
    heading = np.cumsum(np.concatenate(rates))
    time_s = np.arange(len(heading)) * STEP_S
    contacts_s = np.arange(0.5, time_s[-1], 0.5)
    feet = {
        side: FootSteps(contacts_s[k::2] - 0.4, contacts_s[k::2], np.ones(len(contacts_s[k::2])), contacts_s[k::2] * 0)
        for k, side in enumerate(Side)
    }
    return BodyWay(time_s, time_s * SPEED_M_S, heading, feet, ())


def round_cone(radius_m: float) -> Piece:
    return np.pi * radius_m, 180.0


def there_and_back(cone_m: float, radius_m: float, sit_deg: float = 180.0) -> BodyWay:
    """Straight on, half round a cone, straight back, and about on the spot of half a metre."""
    return drawn((cone_m, 0.0), round_cone(radius_m), (cone_m, 0.0), (0.5, sit_deg))


def checked(way: BodyWay, course_m: float = 3.0, seat: SeatMotions = RISE) -> tuple[float, tuple[NotValid, ...]]:
    found = check_up_and_go(way, seat, turns_of(way), (0.0, float(way.time_s[-1])), course_m)
    return found.found_m, found.reasons


@pytest.mark.parametrize("radius_m", [0.2, 0.4])
def test_the_cone_is_found_where_it_is_however_wide_the_turn(radius_m: float) -> None:
    found_m, reasons = checked(there_and_back(3.0, radius_m))
    assert found_m == pytest.approx(3.0, abs=0.1)
    assert reasons == ()


@pytest.mark.parametrize(
    ("way", "reason"),
    [
        (there_and_back(2.0, 0.3), NotValid.COURSE_SHORTER),
        (there_and_back(4.0, 0.3), NotValid.COURSE_LONGER),
        (there_and_back(3.0, 0.3, sit_deg=45.0), NotValid.NO_TURN_TO_SIT),
        (drawn((3.0, 0.0)), NotValid.NO_TURN),
        (drawn((3.0, 0.0), round_cone(0.3), (1.5, 0.0), (0.5, 180.0)), NotValid.ELSEWHERE),
    ],
)
def test_another_course_is_named(way: BodyWay, reason: NotValid) -> None:
    assert reason in checked(way)[1]


def test_a_course_as_long_as_it_was_entered_is_valid() -> None:
    assert checked(there_and_back(5.0, 0.3), 5.0)[1] == ()


def test_who_goes_twice_or_never_rose_did_another_test() -> None:
    once = ((3.0, 0.0), round_cone(0.3), (3.0, 0.0), round_cone(0.3))
    assert NotValid.MORE_TURNS in checked(drawn(*once, *once))[1]
    way = there_and_back(3.0, 0.3)
    assert checked(way, seat=SeatMotions((), ()))[1] == (NotValid.NO_RISE,)
    assert checked(way, seat=SeatMotions((), (), has_thighs=False))[1] == ()  # nothing shows it


def test_laps_are_measured_from_cone_to_cone_and_counted() -> None:
    lap = ((10.0, 0.0), round_cone(0.4))
    way = drawn(*lap, *lap, *lap, (4.0, 0.0))
    turns = turns_of(way)
    laps = laps_of(way, turns, 0.0, float(way.time_s[-1]))
    assert laps.completed == 3
    assert laps.length_m == pytest.approx(10.0, abs=0.2)
    assert laps.rest_m == pytest.approx(4.0, abs=0.3)
    found_m = 3 * 10.0 + laps.rest_m
    assert check_laps(laps, 10.0, 34.0, found_m, 0.0).reasons == ()
    assert check_laps(laps, 10.0, np.nan, found_m, 0.0).reasons == ()  # nothing was entered
    assert check_laps(laps, 10.0, 44.0, found_m, 0.0).reasons == (NotValid.DISTANCE_DIFFERS,)
    assert check_laps(laps, 10.0, 24.0, found_m, 0.0).reasons == (NotValid.DISTANCE_DIFFERS,)
    assert check_laps(laps, 10.0, 30.0, found_m, 10.0).reasons == ()  # the lap that was not completed is missing
    assert check_laps(laps, 12.0, np.nan, found_m, 0.0).reasons == (NotValid.LAP_DIFFERS,)


def test_a_test_that_ends_in_a_turn_has_no_rest() -> None:
    way = drawn((10.0, 0.0), round_cone(0.4), (10.0, 0.0), round_cone(0.4), (3.0, 0.0))
    turns = turns_of(way)
    laps = laps_of(way, turns, 0.0, turns[1].middle_s + 0.01)
    assert (laps.completed, laps.rest_m) == (2, 0.0)


def test_a_way_without_turns_has_no_lap_length() -> None:
    way = drawn((30.0, 0.0))
    laps = laps_of(way, turns_of(way), 0.0, float(way.time_s[-1]))
    assert laps.completed == 0
    assert np.isnan(laps.length_m)


def test_tolerance_grows_with_the_course() -> None:
    assert tolerance_m(3.0) == pytest.approx(0.55)
    assert tolerance_m(30.0) > tolerance_m(10.0)


@pytest.mark.parametrize(("lasted_s", "is_whole"), [(119.2, True), (121.0, True), (118.9, False), (121.2, False)])
def test_a_set_time_is_kept_to_a_second(lasted_s: float, is_whole: bool) -> None:
    definition = DEFINITIONS[TimedProtocol.TWO_MINUTES]
    reasons = check_whole(definition, SeatMotions((), ()), (3.0, 3.0 + lasted_s))
    assert reasons == (() if is_whole else (NotValid.OTHER_TIME,))


@pytest.mark.parametrize(("count", "has_thighs", "is_whole"), [(5, True, True), (4, True, False), (0, False, True)])
def test_five_rises_are_five_where_the_thighs_show_them(count: int, has_thighs: bool, is_whole: bool) -> None:
    definition = DEFINITIONS[TimedProtocol.SIT_TO_STAND]
    seat = SeatMotions(tuple(Rise(k, k + 0.8) for k in range(count)), (), has_thighs)
    reasons = check_whole(definition, seat, (0.0, 5.0))
    assert reasons == (() if is_whole else (NotValid.FEWER_RISES,))


def test_a_walk_between_tapes_may_be_of_any_time_and_needs_no_rise() -> None:
    assert check_whole(DEFINITIONS[TimedProtocol.TEN_METRES], SeatMotions((), ()), (0.0, 90.0)) == ()

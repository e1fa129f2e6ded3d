"""Tests that timed tests of the simulated patient are reported as they were. What was not measured is left out."""

from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Side, Site
from core.gait.strides import Reason
from core.samples import RateKind
from core.session import Recording, Session
from core.signal.sensors import SensorTracks
from core.timed.found import DistanceSource, NotMeasured, NotValid, PartOfUpAndGo, TimedTest, Validity
from core.timed.measures import counted_figure
from core.timed.protocols import DEFINITIONS, PlannedTest, TimedProtocol
from core.timed.timing import time_test
from devices.simulation.walker_body import CourseKind, TimedCourse, Tissue
from devices.simulation.walker_courses import CourseTruth, SimulatedCourse, draw_course, simulate_course
from devices.simulation.walker_route import spoiled

FEET = (Site.LEFT_FOOT, Site.RIGHT_FOOT)
TEN_METRES = TimedCourse(CourseKind.TEN_METRES, seed=2, speed_m_s=0.9, sites=FEET, tissue=Tissue.SOFT)
TWO_MINUTES = TimedCourse(
    CourseKind.TWO_MINUTES, seed=4, speed_m_s=1.0, lap_m=12.0, pauses=1, hesitates=True, slowing=0.25, sites=FEET
)


def timed(session: Session, protocol: TimedProtocol, keys_s: tuple[float, float] | None = None) -> TimedTest:
    start_s, end_s = keys_s or (None, None)
    return held(session, PlannedTest(protocol, start_s, end_s))


def held(session: Session, planned: PlannedTest) -> TimedTest:
    tracks = SensorTracks(session, session.recordings, frozenset(), RateKind.INSTANTANEOUS)
    return time_test(tracks, session.recordings[-1], planned)


def with_course(session: Session, course: Recording) -> Session:
    return replace(session, recordings=(session.recordings[0], course))


def cut(session: Session, from_s: float, to_s: float) -> Session:
    """Only what lies between two instants of the course."""
    course = session.recordings[1]
    imu = {site: b.select((b.time_s >= from_s) & (b.time_s <= to_s)) for site, b in course.imu.items()}
    return with_course(session, replace(course, imu=imu))


@pytest.fixture(scope="module")
def ten_metres() -> SimulatedCourse:
    return simulate_course(TEN_METRES)


@pytest.fixture(scope="module")
def two_minutes() -> SimulatedCourse:
    return simulate_course(TWO_MINUTES)


@pytest.fixture(scope="module")
def up_and_go() -> SimulatedCourse:
    return simulate_course(draw_course(CourseKind.UP_AND_GO, 1))


def silent(made: SimulatedCourse, sites: tuple[Site, ...], from_s: float, to_s: float) -> Session:
    """The course as it would be received if some sensors sent nothing meanwhile."""
    course = made.session.recordings[1]
    received = {site: b.select((b.time_s < from_s) | (b.time_s > to_s)) for site, b in course.imu.items()}
    imu = {site: received[site] if site in sites else block for site, block in course.imu.items()}
    return with_course(made.session, replace(course, imu=imu))


def without_feet(made: SimulatedCourse) -> Session:
    course = made.session.recordings[1]
    return with_course(made.session, replace(course, imu={s: b for s, b in course.imu.items() if s not in FEET}))


def turns_between(truth: CourseTruth, start_s: float, end_s: float) -> list[float]:
    return [turn.angle_rad for turn in truth.turns if start_s <= 0.5 * (turn.start_s + turn.end_s) <= end_s]


def test_ten_metres_are_timed_without_a_key(ten_metres: SimulatedCourse) -> None:
    truth = ten_metres.truth
    found = timed(ten_metres.session, TimedProtocol.TEN_METRES)
    assert found.time_s == pytest.approx(truth.passes_s(12.0) - truth.passes_s(2.0), abs=0.1)
    assert truth.way_at(found.end_s) - truth.way_at(found.start_s) == pytest.approx(10.0, rel=0.02)
    assert found.distance_m == 10.0
    assert np.isnan(found.tape_difference_m)  # no tape: the sensors would be compared with themselves
    assert found.missing == ()


def test_keys_at_the_tape_win_and_the_sensors_own_distance_is_reported(ten_metres: SimulatedCourse) -> None:
    truth = ten_metres.truth
    # one who presses late at the end: time as pressed, 10.00 m, and the sensors say that it was more
    keys_s = (truth.passes_s(2.0), truth.passes_s(12.5))
    found = timed(ten_metres.session, TimedProtocol.TEN_METRES, keys_s)
    assert found.time_s == pytest.approx(keys_s[1] - keys_s[0], abs=1e-9)
    assert found.distance_m == 10.0
    assert found.tape_difference_m == pytest.approx(0.5, abs=0.2)
    assert found.speed_m_s == pytest.approx(10.0 / found.time_s)


def test_two_minutes_with_turns_a_pause_and_a_slowing_patient(two_minutes: SimulatedCourse) -> None:
    truth = two_minutes.truth
    found = timed(two_minutes.session, TimedProtocol.TWO_MINUTES)
    start_s = float(truth.contacts_s[0])
    assert found.start_s == pytest.approx(start_s, abs=0.05)
    assert found.time_s == pytest.approx(120.0)
    assert found.distance_m == pytest.approx(truth.way_at(start_s + 120.0), rel=0.02)
    assert found.missing == ()
    angles = turns_between(truth, start_s, start_s + 120.0)
    assert len(angles) >= 5
    np.testing.assert_allclose([turn.angle_rad for turn in found.turns], angles, atol=np.deg2rad(8.0))
    assert len(found.laps) == len(angles) + 1
    assert sum(lap.distance_m for lap in found.laps) == pytest.approx(found.distance_m, abs=0.7)  # + the first step
    ((pause_start_s, pause_end_s),) = found.pauses_s
    ((true_start_s, true_end_s),) = truth.pauses_s
    assert (pause_start_s, pause_end_s) == pytest.approx((true_start_s, true_end_s), abs=0.06)
    first, last = found.thirds[0], found.thirds[-1]
    assert last.cadence_steps_min < 0.95 * first.cadence_steps_min


def test_a_silent_foot_takes_the_distance_and_not_the_time(two_minutes: SimulatedCourse) -> None:
    truth = two_minutes.truth
    found = timed(silent(two_minutes, (Site.LEFT_FOOT,), 60.0, 65.0), TimedProtocol.TWO_MINUTES)
    assert found.time_s == pytest.approx(120.0)
    assert np.isnan(found.distance_m)
    assert np.isnan(found.speed_m_s)
    assert found.missing == (NotMeasured.SILENT,)
    (silence,) = found.silences
    assert silence.site is Site.LEFT_FOOT
    assert (silence.start_s, silence.end_s) == pytest.approx((60.0, 65.0), abs=0.05)
    start_s = float(truth.contacts_s[0])
    assert len(found.turns) == len(turns_between(truth, start_s, start_s + 120.0))
    assert len(found.pauses_s) == len(truth.pauses_s)
    # laps that the silence does not touch keep their distance
    assert sum(np.isfinite(lap.distance_m) for lap in found.laps) == len(found.laps) - 1


def test_up_and_go_from_leaving_the_seat_to_sitting_again(up_and_go: SimulatedCourse) -> None:
    truth = up_and_go.truth
    found = timed(up_and_go.session, TimedProtocol.UP_AND_GO)
    assert found.start_s == pytest.approx(truth.left_seat_s[0], abs=0.05)
    assert found.end_s == pytest.approx(truth.seated_s[0], abs=0.05)
    assert [np.sign(t.angle_rad) for t in found.turns] == [np.sign(t.angle_rad) for t in truth.turns]
    assert found.distance_m == pytest.approx(truth.way_m[-1], rel=0.01)  # its turns as arcs: 1.5 % less without
    assert len(found.rises) == 1


def test_an_up_and_go_has_six_parts_and_is_held_against_its_course(up_and_go: SimulatedCourse) -> None:
    found = timed(up_and_go.session, TimedProtocol.UP_AND_GO)
    assert [one.part for one in found.parts] == list(PartOfUpAndGo)
    for one in found.parts:
        planned_s = up_and_go.truth.parts_s[one.part]
        assert (one.start_s, one.end_s) == pytest.approx(planned_s, abs=0.3)
    assert (found.parts[0].start_s, found.parts[-1].end_s) == pytest.approx((found.start_s, found.end_s))
    assert (found.course_m, found.validity) == (3.0, Validity.VALID)
    assert found.course_found_m == pytest.approx(3.0, abs=0.5)
    # who walks the same way on a course that is laid out otherwise does another test
    planned = PlannedTest(TimedProtocol.UP_AND_GO, course_m=5.0)
    assert held(up_and_go.session, planned).not_valid == (NotValid.COURSE_SHORTER,)


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ("4 m", NotValid.COURSE_LONGER),
        ("turned early", NotValid.COURSE_SHORTER),
        ("sideways", NotValid.NO_TURN_TO_SIT),
        ("other chair", NotValid.ELSEWHERE),
        ("twice", NotValid.MORE_TURNS),
        ("false start", NotValid.NO_TURN),
    ],
)
def test_a_course_that_is_no_up_and_go_is_not_valid(wrong: str, reason: NotValid) -> None:
    course = draw_course(CourseKind.UP_AND_GO, 1)
    how = spoiled(course.up_and_go, wrong, np.random.default_rng(1))
    found = timed(simulate_course(replace(course, up_and_go=how)).session, TimedProtocol.UP_AND_GO)
    assert reason in found.not_valid
    assert found.validity is Validity.NOT_VALID
    assert not np.isfinite(counted_figure(found))


def test_keys_while_nobody_rises_are_no_up_and_go(up_and_go: SimulatedCourse) -> None:
    seated_s = (0.2, float(up_and_go.truth.left_seat_s[0]) - 0.5)
    assert NotValid.NO_RISE in timed(up_and_go.session, TimedProtocol.UP_AND_GO, seated_s).not_valid


def test_without_feet_a_course_is_not_checked_and_its_walked_parts_are_missing(up_and_go: SimulatedCourse) -> None:
    found = timed(without_feet(up_and_go), TimedProtocol.UP_AND_GO)
    assert (found.validity, found.is_valid) == (Validity.NOT_CHECKED, True)
    known = {one.part for one in found.parts if np.isfinite(one.time_s)}
    assert known == {PartOfUpAndGo.RISE, PartOfUpAndGo.SIT}


def test_a_swing_lost_in_a_gap_leaves_the_course_unchecked_and_the_turns_unknown(up_and_go: SimulatedCourse) -> None:
    turn_s = 0.5 * sum(up_and_go.truth.parts_s["turn"])
    gaps_s = [(turn_s + shift_s, turn_s + shift_s + 0.28) for shift_s in (-0.6, -0.3, 0.0, 0.3)]
    found = [timed(silent(up_and_go, (Site.LEFT_FOOT,), *gap_s), TimedProtocol.UP_AND_GO) for gap_s in gaps_s]
    assert all(one.silences == () for one in found)
    unknown = [one for one in found if one.validity is Validity.NOT_CHECKED]
    assert unknown  # some of these gaps lie in a swing
    for one in unknown:
        assert {part.part for part in one.parts if np.isfinite(part.time_s)} == {PartOfUpAndGo.RISE, PartOfUpAndGo.SIT}
    assert all(one.is_valid for one in found)


def test_keys_on_a_tape_that_is_elsewhere_are_not_valid(ten_metres: SimulatedCourse) -> None:
    truth = ten_metres.truth
    short = timed(ten_metres.session, TimedProtocol.TEN_METRES, (truth.passes_s(2.0), truth.passes_s(10.0)))
    assert short.not_valid == (NotValid.COURSE_SHORTER,)
    planned = PlannedTest(TimedProtocol.TEN_METRES, truth.passes_s(2.0), truth.passes_s(10.0), course_m=8.0)
    found = held(ten_metres.session, planned)
    assert (found.validity, found.distance_m, found.distance_source) == (Validity.VALID, 8.0, DistanceSource.TAPE)
    # without a key the feet would be compared with themselves
    unkeyed = held(ten_metres.session, PlannedTest(TimedProtocol.TEN_METRES, course_m=6.0))
    assert (unkeyed.validity, unkeyed.distance_m) == (Validity.NOT_CHECKED, 6.0)


def test_ten_metres_there_and_back_are_not_valid(two_minutes: SimulatedCourse) -> None:
    keys_s = (4.0, 30.0)
    assert NotValid.MORE_TURNS in timed(two_minutes.session, TimedProtocol.TEN_METRES, keys_s).not_valid


def test_laps_of_an_entered_length_count_and_are_held_against_the_feet(two_minutes: SimulatedCourse) -> None:
    truth = two_minutes.truth
    by_feet = timed(two_minutes.session, TimedProtocol.TWO_MINUTES)
    assert (by_feet.distance_source, by_feet.validity) == (DistanceSource.FEET, Validity.NOT_CHECKED)
    planned = PlannedTest(TimedProtocol.TWO_MINUTES, lap_m=12.0)
    found = held(two_minutes.session, planned)
    end_s = float(truth.contacts_s[0]) + 120.0
    done = [turn for turn in truth.turns if 0.5 * (turn.start_s + turn.end_s) <= end_s]
    rest_m = truth.way_at(end_s) - truth.way_at(done[-1].end_s)
    assert found.distance_source is DistanceSource.FOUND_LAPS
    assert found.distance_m == pytest.approx(len(done) * 12.0 + rest_m, abs=1.0)
    assert found.distance_m < found.sensor_distance_m  # which has the ways round the cones, too
    assert found.validity is Validity.VALID
    assert found.course_found_m == pytest.approx(12.0, abs=0.5)
    typed = held(two_minutes.session, replace(planned, typed_laps=len(done), rest_m=rest_m))
    assert typed.distance_source is DistanceSource.TYPED
    assert typed.distance_m == pytest.approx(len(done) * 12.0 + rest_m)
    assert typed.validity is Validity.VALID
    whole = held(two_minutes.session, replace(planned, typed_laps=len(done)))  # the last lap was not measured
    assert (whole.distance_m, whole.not_valid) == (len(done) * 12.0, ())
    miscounted = held(two_minutes.session, replace(planned, typed_laps=len(done) + 1, rest_m=rest_m))
    assert miscounted.not_valid == (NotValid.DISTANCE_DIFFERS,)
    longer = held(two_minutes.session, replace(planned, lap_m=15.0))
    assert NotValid.LAP_DIFFERS in longer.not_valid


def test_laps_count_where_one_foot_was_silent_and_not_where_both_were(two_minutes: SimulatedCourse) -> None:
    planned = PlannedTest(TimedProtocol.TWO_MINUTES, lap_m=12.0)
    one = held(silent(two_minutes, (Site.LEFT_FOOT,), 60.0, 65.0), planned)
    assert one.distance_source is DistanceSource.FOUND_LAPS
    found = held(silent(two_minutes, FEET, 60.0, 65.0), planned)
    assert np.isnan(found.distance_m)
    assert found.validity is Validity.NOT_CHECKED


@pytest.mark.parametrize("seed", [0, 5])
def test_five_rises_are_timed_to_the_fifth(seed: int) -> None:
    made = simulate_course(draw_course(CourseKind.SIT_TO_STAND, seed))
    found = timed(made.session, TimedProtocol.SIT_TO_STAND)
    assert found.time_s == pytest.approx(made.truth.upright_s[4] - made.truth.left_seat_s[0], abs=0.1)
    np.testing.assert_allclose([rise.left_seat_s for rise in found.rises], made.truth.left_seat_s, atol=0.1)
    np.testing.assert_allclose([rise.upright_s for rise in found.rises], made.truth.upright_s, atol=0.1)
    np.testing.assert_allclose([one.seated_s for one in found.sittings], made.truth.seated_s, atol=0.1)
    took_s = [one.time_s for one in found.rises]
    np.testing.assert_allclose(took_s, made.truth.upright_s - made.truth.left_seat_s, atol=0.15)
    assert (found.parts, found.validity) == ((), Validity.NOT_CHECKED)
    assert found.pauses_s == ()
    assert np.isnan(found.distance_m)
    assert found.missing == ()
    # cut after the fourth it is not finished
    shorter = cut(made.session, 0.0, float(made.truth.left_seat_s[4]) - 0.3)
    assert timed(shorter, TimedProtocol.SIT_TO_STAND).missing == (NotMeasured.NOT_FINISHED,)


def test_rises_from_a_chair_are_no_walk_without_strides(up_and_go: SimulatedCourse) -> None:
    """In no test of theirs is a stride looked for, where one that is walked has them."""

    def findings_of(made: SimulatedCourse, protocol: TimedProtocol | None) -> tuple[set[str], int]:
        test = PlannedTest(protocol) if protocol is not None else None
        found = analyse(with_course(made.session, replace(made.session.recordings[1], test=test)))
        walk = found.recordings[-1]
        about = {"no_strides", "side_without_strides", "no_mean", "no_spread", "no_spread_of_side"}
        return {one.key for one in found.findings} & about, sum(len(gait.strides) for gait in walk.gait.values())

    made = simulate_course(draw_course(CourseKind.SIT_TO_STAND, 0))
    assert findings_of(made, TimedProtocol.SIT_TO_STAND) == (set(), 0)
    assert findings_of(made, None)[0] == {"no_strides"}
    assert findings_of(up_and_go, TimedProtocol.UP_AND_GO)[1] > 0


def test_what_is_missing_is_named(ten_metres: SimulatedCourse, up_and_go: SimulatedCourse) -> None:
    # no still second: the recording begins in the middle of the walk
    late = cut(ten_metres.session, float(ten_metres.truth.contacts_s[4]), np.inf)
    found = timed(late, TimedProtocol.TWO_MINUTES)
    assert NotMeasured.NO_START in found.missing
    assert np.isnan(found.time_s)
    # it ends before ten metres, and long before two minutes
    short = cut(ten_metres.session, 0.0, ten_metres.truth.passes_s(9.0))
    assert timed(short, TimedProtocol.TEN_METRES).missing == (NotMeasured.NOT_FINISHED,)
    assert timed(short, TimedProtocol.TWO_MINUTES).missing == (NotMeasured.NOT_FINISHED,)
    # no thighs, or nobody stood
    assert NotMeasured.NO_THIGHS in timed(ten_metres.session, TimedProtocol.UP_AND_GO).missing
    unseen = replace(up_and_go.session, recordings=up_and_go.session.recordings[1:])
    assert NotMeasured.NO_THIGHS in timed(unseen, TimedProtocol.UP_AND_GO).missing
    # no feet: the chair's time stays
    only = timed(without_feet(up_and_go), TimedProtocol.UP_AND_GO)
    assert only.missing == (NotMeasured.NO_FEET,)
    assert only.time_s > 0.0
    assert np.isnan(only.distance_m)


def test_keys_out_of_order_are_refused(ten_metres: SimulatedCourse) -> None:
    with pytest.raises(ValueError, match="not after the start"):
        timed(ten_metres.session, TimedProtocol.TEN_METRES, (5.0, 4.0))


def test_every_test_is_defined_with_its_error_and_its_source_was_read() -> None:
    assert set(DEFINITIONS) == set(TimedProtocol)
    assert all(definition.errors for definition in DEFINITIONS.values())
    errors = [error for definition in DEFINITIONS.values() for error in definition.errors]
    assert all(error.is_verified for error in errors)
    assert {(error.low, error.high) for error in errors if error.quantity == "distance_m"} == {
        (0.0, 13.0),
        (16.0, 39.0),
    }


@pytest.mark.endurance
@pytest.mark.parametrize("seed", [0, 3])
def test_strides_on_stairs_are_reported_with_their_heights_and_are_in_no_mean(seed: int) -> None:
    made = simulate_course(draw_course(CourseKind.STAIRS, seed))
    found = timed(made.session, TimedProtocol.STAIRS)
    for side in Side:
        true_m = [one for one in made.truth.climbs_m[side][1:].tolist() if abs(one) > 0.01]
        reported_m = [one.climb_m for one in found.stairs if one.side is side]
        np.testing.assert_allclose(reported_m, true_m, atol=0.08)
    assert found.time_s == pytest.approx(made.truth.contacts_s[-1] - made.truth.contacts_s[0], abs=0.1)
    walk = analyse(made.session).recordings[-1]
    reasons = [reason for gait in walk.gait.values() for reason in gait.strides.reason]
    on_stairs = sum(one in (Reason.STAIRS_UP, Reason.STAIRS_DOWN) for one in reasons)
    assert on_stairs >= len(found.stairs) - 2  # a stride over 3 s is none
    for gait in walk.gait.values():
        assert np.all(np.abs(gait.strides.climb_m[gait.strides.is_used]) < 0.1)
        # the means are of the level strides: by far longer than those on treads of some 0.3 m
        level_m = gait.strides.length_m[gait.strides.is_used]
        on_m = gait.strides.length_m[[one in (Reason.STAIRS_UP, Reason.STAIRS_DOWN) for one in gait.strides.reason]]
        assert level_m.min() > on_m.max()


def test_no_stride_of_a_level_course_is_on_stairs(two_minutes: SimulatedCourse) -> None:
    assert timed(two_minutes.session, TimedProtocol.TWO_MINUTES).stairs == ()

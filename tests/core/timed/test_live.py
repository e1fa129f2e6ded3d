"""Tests that a timed test is reported live as from its recording, and of what a key means."""

import math
from dataclasses import replace

import numpy as np
import pytest

from core.body import Segment, Side, Site
from core.calibration.rest import rest_of
from core.live.sensors import LiveSensor, LiveSensors
from core.session import Recording
from core.timed.found import NotMeasured, Validity
from core.timed.live import LiveTest
from core.timed.protocols import KeyMeaning, PlannedTest, TimedProtocol
from devices.simulation.walker_body import CourseKind, TimedCourse, Tissue
from devices.simulation.walker_courses import SimulatedCourse, draw_course, simulate_course

FEET = (Site.LEFT_FOOT, Site.RIGHT_FOOT)
BLOCK_S = 0.1
TEN = TimedCourse(CourseKind.TEN_METRES, seed=2, speed_m_s=0.9, sites=FEET, tissue=Tissue.SOFT)


class CourseReceived:
    """Receives a course block by block, as a program does."""

    def __init__(
        self, made: SimulatedCourse, protocol: TimedProtocol, sides: frozenset[Side] = frozenset(Side)
    ) -> None:
        standing, course = made.session.recordings
        rests = {site: rest for site, block in standing.imu.items() if (rest := rest_of(block)) is not None}
        self._course: Recording = course
        self._sensors = LiveSensors({site: LiveSensor(100.0, rest.gyr_rad_s) for site, rest in rests.items()})
        upright = {site: rest.acc_m_s2 for site, rest in rests.items() if site.segment is Segment.THIGH}
        self.now_s = min(float(block.time_s[0]) for block in course.imu.values())
        self.end_s = max(float(block.time_s[-1]) for block in course.imu.values())
        self.test = LiveTest(PlannedTest(protocol), upright, frozenset(), sides, self.now_s)

    def hear_until(self, time_s: float) -> None:
        while self.now_s < min(time_s, self.end_s):
            here = {
                site: block.select((block.time_s >= self.now_s) & (block.time_s < self.now_s + BLOCK_S))
                for site, block in self._course.imu.items()
            }
            self.test.update(self._sensors.update({site: block for site, block in here.items() if len(block)}))
            self.now_s += BLOCK_S


@pytest.fixture(scope="module")
def ten_metres() -> SimulatedCourse:
    return simulate_course(TEN)


@pytest.mark.endurance
def test_ten_metres_are_reported_live_within_a_second_of_their_end(ten_metres: SimulatedCourse) -> None:
    received, truth = CourseReceived(ten_metres, TimedProtocol.TEN_METRES), ten_metres.truth
    received.hear_until(truth.passes_s(7.0))
    now = received.test.state
    assert now.start_s == pytest.approx(truth.passes_s(2.0), abs=0.15)
    assert not now.is_over
    assert now.distance_m == pytest.approx(5.0, abs=0.8)  # to the last step that has landed
    assert [side for side, _ in now.steps[1:]] == [side.other for side, _ in now.steps[:-1]]
    received.hear_until(truth.passes_s(12.0) + 1.0)
    over = received.test.state
    assert over.is_over
    assert over.elapsed_s(99.0) == pytest.approx(truth.passes_s(12.0) - truth.passes_s(2.0), abs=0.2)
    assert over.distance_m == pytest.approx(10.0, abs=0.01)


def test_nothing_begins_where_nobody_walks(ten_metres: SimulatedCourse) -> None:
    received = CourseReceived(ten_metres, TimedProtocol.TWO_MINUTES)
    received.hear_until(float(ten_metres.truth.contacts_s[0]) - 0.7)
    before = received.test.state
    assert (before.has_begun, before.is_still) == (False, True)
    received.hear_until(float(ten_metres.truth.contacts_s[0]) + 1.0)
    now = received.test.state
    assert now.start_s == pytest.approx(float(ten_metres.truth.contacts_s[0]), abs=0.05)
    assert not now.is_still


@pytest.mark.endurance
def test_a_key_before_the_motion_starts_and_one_after_ends(ten_metres: SimulatedCourse) -> None:
    received, truth = CourseReceived(ten_metres, TimedProtocol.TEN_METRES), ten_metres.truth
    received.hear_until(truth.passes_s(1.5))
    first_s, last_s = received.now_s, truth.passes_s(11.0)
    assert received.test.press(first_s) is KeyMeaning.START
    received.hear_until(last_s)
    assert received.test.state.start_s == first_s
    assert received.test.press(last_s) is KeyMeaning.END
    assert received.test.planned == PlannedTest(TimedProtocol.TEN_METRES, first_s, last_s)
    received.hear_until(last_s + 1.0)
    assert received.test.state.elapsed_s(99.0) == pytest.approx(last_s - first_s)
    assert received.test.press(last_s + 1.0) is None  # nothing is left to say


@pytest.mark.endurance
def test_a_key_just_after_the_motion_has_started_means_the_start_and_one_in_the_run_out_the_tape(
    ten_metres: SimulatedCourse,
) -> None:
    received, truth = CourseReceived(ten_metres, TimedProtocol.TEN_METRES), ten_metres.truth
    received.hear_until(truth.passes_s(2.0) + 0.9)
    begun = received.test.state
    assert begun.has_begun
    assert received.test.press(received.test.state.start_s + 1.0) is KeyMeaning.START
    received.hear_until(truth.passes_s(12.0) + 2.0)
    over = received.test.state
    assert over.is_over
    assert received.test.press(over.end_s + 0.5) is KeyMeaning.END
    late = CourseReceived(ten_metres, TimedProtocol.TEN_METRES)
    late.hear_until(math.inf)
    assert late.test.press(late.test.state.end_s + 3.0) is None


@pytest.mark.endurance
def test_a_silent_foot_takes_the_distance_and_the_time_goes_on() -> None:
    made = simulate_course(replace(TEN, silent_s={Site.LEFT_FOOT: (6.0, 60.0)}))
    received = CourseReceived(made, TimedProtocol.TWO_MINUTES)
    received.hear_until(5.8)
    assert math.isfinite(received.test.state.distance_m)
    assert received.test.state.silent == ()
    received.hear_until(9.0)
    silent = received.test.state
    assert silent.has_begun
    assert math.isnan(silent.distance_m)
    assert silent.silent == (Site.LEFT_FOOT,)
    assert NotMeasured.SILENT in silent.reasons
    assert silent.elapsed_s(10.0) > silent.elapsed_s(9.0)


@pytest.mark.endurance
@pytest.mark.parametrize("kind", [CourseKind.UP_AND_GO, CourseKind.SIT_TO_STAND])
def test_tests_from_a_chair_are_reported_live(kind: CourseKind) -> None:
    made = simulate_course(draw_course(kind, 1))
    received = CourseReceived(made, TimedProtocol(kind.value))
    received.hear_until(float(made.truth.left_seat_s[0]) - 0.2)
    before = received.test.state
    assert not before.has_begun
    end_s = float(made.truth.seated_s[0] if kind is CourseKind.UP_AND_GO else made.truth.upright_s[4])
    received.hear_until(end_s - 1.0)
    amid = received.test.state
    assert (amid.has_begun, amid.is_over) == (True, False)
    received.hear_until(math.inf)
    assert received.test.state.end_s == pytest.approx(end_s, abs=0.1)
    assert received.test.state.elapsed_s(0.0) == pytest.approx(end_s - made.truth.left_seat_s[0], abs=0.15)
    found = received.test.state.found
    assert found is not None
    if kind is CourseKind.UP_AND_GO:
        assert found.validity is Validity.VALID
        for one in found.parts:
            assert (one.start_s, one.end_s) == pytest.approx(made.truth.parts_s[one.part], abs=0.4)


@pytest.mark.endurance
def test_no_step_of_stairs_is_taken_for_the_last_one_while_another_may_follow() -> None:
    made = simulate_course(TimedCourse(CourseKind.STAIRS, seed=3, sites=FEET))
    received, contacts_s = CourseReceived(made, TimedProtocol.STAIRS), made.truth.contacts_s
    for at_s in contacts_s[4::6].tolist():
        received.hear_until(at_s)
        assert received.test.state.has_begun
        assert not received.test.state.is_over
    received.hear_until(math.inf)
    found = received.test.state.found
    assert found is not None
    assert found.end_s == pytest.approx(float(contacts_s[-1]), abs=0.1)


@pytest.mark.endurance
def test_blocks_of_any_size_and_another_estimator_amid_the_walk_lose_no_step(ten_metres: SimulatedCourse) -> None:
    whole, twice = (CourseReceived(ten_metres, TimedProtocol.TEN_METRES) for _ in range(2))
    whole.hear_until(math.inf)
    twice.hear_until(10.0)
    again = CourseReceived(ten_metres, TimedProtocol.TEN_METRES)  # its ticks begin again
    again.test, again.now_s = twice.test, twice.now_s
    again.hear_until(math.inf)
    assert len(again.test.state.steps) == pytest.approx(len(whole.test.state.steps), abs=2)
    assert again.test.state.silent == ()
    assert np.isfinite(again.test.state.distance_m)

"""Tests that simulated courses go on without a jump and that what is called true of them is true."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Side, Site
from core.samples import FloatArray
from devices.simulation.walker_body import NO_ERRORS, CourseKind, TimedCourse, WalkerSettings, make_leg
from devices.simulation.walker_courses import SimulatedCourse, draw_course, simulate_course, walk_course
from devices.simulation.walker_route import INVALID, spoiled

UP_AND_GO = TimedCourse(CourseKind.UP_AND_GO, seed=3, errors=NO_ERRORS, hesitates=True)


@pytest.fixture(scope="module")
def up_and_go() -> SimulatedCourse:
    return simulate_course(UP_AND_GO)


@pytest.fixture(scope="module")
def two_minutes() -> SimulatedCourse:
    # short laps and two pauses: many seams between bouts
    feet = (Site.LEFT_FOOT, Site.RIGHT_FOOT)
    return simulate_course(
        TimedCourse(CourseKind.TWO_MINUTES, seed=5, lap_m=10.0, pauses=2, sites=feet, errors=NO_ERRORS, hesitates=True)
    )


def turned_rad(made: SimulatedCourse, site: Site) -> float:
    """How far a sensor turned about the vertical over the course; the foot is flat at both ends, as in standing."""
    block = made.session.recordings[1].imu[site]
    still = made.session.recordings[0].imu[site].acc_m_s2.mean(axis=0)
    up = still / np.linalg.norm(still)
    # a foot turns about the vertical in swing, where it is pitched by up to a radian: the mean tilt costs some degrees
    return float(np.sum(block.gyr_rad_s @ up) * 0.01)


def is_still(values: FloatArray) -> bool:
    return bool(np.max(np.abs(values)) < 0.2)


@pytest.mark.endurance
@pytest.mark.parametrize("name", ["up_and_go", "two_minutes"])
def test_nothing_jumps_where_bouts_and_sitting_meet(name: str, request: pytest.FixtureRequest) -> None:
    made: SimulatedCourse = request.getfixturevalue(name)
    for block in made.session.recordings[1].imu.values():
        assert np.abs(block.acc_m_s2).max() < 80.0  # a jump by a millimetre in 2 ms would be 250
        assert np.abs(block.gyr_rad_s).max() < 15.0


def test_a_seated_thigh_lies_level_and_a_standing_one_does_not(up_and_go: SimulatedCourse) -> None:
    standing, course = up_and_go.session.recordings
    assert Site.PELVIS not in course.imu  # which nobody asked for
    truth = up_and_go.truth
    site = Site.LEFT_THIGH
    upright = standing.imu[site].acc_m_s2.mean(axis=0)
    time_s, acc = course.imu[site].time_s, course.imu[site].acc_m_s2
    for span, level_deg in (
        ((0.0, truth.left_seat_s[0] - 1.0), 90.0),
        ((truth.upright_s[0] + 0.2, truth.contacts_s[0] - 0.6), 0.0),
        ((truth.seated_s[-1] + 0.5, time_s[-1]), 90.0),
    ):
        mean = acc[(time_s > span[0]) & (time_s < span[1])].mean(axis=0)
        cosine = mean @ upright / np.linalg.norm(mean) / np.linalg.norm(upright)
        assert abs(np.rad2deg(np.arccos(cosine)) - level_deg) < 12.0


def test_the_feet_stay_still_on_the_seat_and_in_pauses(
    up_and_go: SimulatedCourse, two_minutes: SimulatedCourse
) -> None:
    assert len(two_minutes.truth.pauses_s) == 2
    course = up_and_go.session.recordings[1].imu[Site.LEFT_FOOT]
    assert is_still(course.gyr_rad_s[course.time_s < up_and_go.truth.upright_s[0]])
    for site in (Site.LEFT_FOOT, Site.RIGHT_FOOT):
        block = two_minutes.session.recordings[1].imu[site]
        for start_s, end_s in two_minutes.truth.pauses_s:
            # the foot rolls for a while after its contact and before its toe-off
            assert is_still(block.gyr_rad_s[(block.time_s > start_s + 0.7) & (block.time_s < end_s - 0.7)])


def test_the_way_ends_with_the_last_step_and_turns_sum_up(two_minutes: SimulatedCourse) -> None:
    truth = two_minutes.truth
    assert np.all(np.diff(truth.way_m) > -1e-9)
    assert len(truth.turns) >= 6
    for turn in truth.turns:
        assert turn.start_s < turn.end_s
        assert abs(abs(turn.angle_rad) - np.pi) < np.deg2rad(25.0)
    total = sum(turn.angle_rad for turn in truth.turns)
    for site in (Site.LEFT_FOOT, Site.RIGHT_FOOT):
        assert abs(turned_rad(two_minutes, site) - total) < 0.15 * len(truth.turns) * np.pi
    # after the last contact the body does no more than close up to the foot before it
    last_s = float(truth.contacts_s[-1])
    assert truth.way_m[-1] - truth.way_at(last_s) < 0.7


def test_laps_are_as_long_as_asked_and_turns_go_to_both_sides() -> None:
    signs = [
        np.sign(turn.angle_rad)
        for seed in range(3)
        for turn in simulate_course(TimedCourse(CourseKind.UP_AND_GO, seed=seed, sites=(Site.LEFT_FOOT,))).truth.turns
    ]
    assert {-1.0, 1.0} == set(signs)


def footholds(course: TimedCourse) -> FloatArray:
    """Where the middle between the feet is in the end (2,) and farthest away (2,), m, from where they are first."""
    legs = {side: make_leg(WalkerSettings(seed=course.seed), side) for side in Side}
    motions = walk_course(course, legs)[0]
    every = np.concatenate([motion.footholds_m for motion in motions.values()])
    first = np.mean([motion.footholds_m[0] for motion in motions.values()], axis=0)
    last = np.mean([motion.footholds_m[-1] for motion in motions.values()], axis=0)
    return np.array([last - first, every[np.argmax(np.linalg.norm(every - first, axis=1))] - first])


@pytest.mark.parametrize("cone_m", [3.0, 5.0])
@pytest.mark.parametrize("is_unwound", [True, False])
def test_an_up_and_go_leads_round_its_cone_and_back_to_the_chair(cone_m: float, is_unwound: bool) -> None:
    for seed in range(2):
        course = draw_course(CourseKind.UP_AND_GO, seed)
        how = replace(course.up_and_go, cone_m=cone_m, is_unwound=is_unwound, overshoot_m=0.0)
        last, far = np.linalg.norm(footholds(replace(course, up_and_go=how)), axis=1)
        assert last < 0.3
        assert abs(far - (cone_m + how.clearance_m - how.before_chair_m)) < 0.35  # a foot is half a step from the body


def test_an_up_and_go_that_is_spoiled_leads_elsewhere() -> None:
    course = draw_course(CourseKind.UP_AND_GO, 1)
    found = {}
    for wrong in INVALID:
        how = spoiled(course.up_and_go, wrong, np.random.default_rng(0))
        found[wrong] = np.linalg.norm(footholds(replace(course, up_and_go=how)), axis=1)
    assert found["past the cone"][1] > found["twice"][1] + 0.8 > found["turned early"][1] + 1.6
    assert found["one way"][0] > 2.0
    assert 0.7 < found["other chair"][0] < 2.2
    assert found["sideways"][0] < 0.6


def test_the_parts_of_an_up_and_go_follow_each_other() -> None:
    for seed in range(3):
        parts_s = simulate_course(
            replace(draw_course(CourseKind.UP_AND_GO, seed), sites=(Site.LEFT_FOOT,))
        ).truth.parts_s
        assert list(parts_s) == ["rise", "walk_out", "turn", "walk_back", "turn_to_sit", "sit"]
        starts, ends = zip(*parts_s.values(), strict=True)
        assert starts[1:] == ends[:-1]
        assert np.all(np.subtract(ends, starts) > 0.0)


def test_laps_lie_between_two_cones() -> None:
    course = TimedCourse(CourseKind.TWO_MINUTES, seed=2, lap_m=11.0)
    far = np.linalg.norm(footholds(course)[1])
    assert 11.0 < far < 12.2  # round the cone, at most 0.6 m from it


@pytest.mark.parametrize("kind", [kind for kind in CourseKind if kind is not CourseKind.SIX_MINUTES])
def test_a_course_that_is_joined_begins_and_ends_with_standing(kind: CourseKind) -> None:
    sites = (Site.LEFT_THIGH, Site.LEFT_FOOT)
    made = simulate_course(TimedCourse(kind, seed=4, sites=sites, is_joined=True, lap_m=40.0, errors=NO_ERRORS))
    standing, course = made.session.recordings
    for site in sites:
        acc, upright = course.imu[site].acc_m_s2, standing.imu[site].acc_m_s2.mean(axis=0)
        for end in (acc[:30], acc[-30:]):
            assert np.linalg.norm(end.mean(axis=0) - upright) < 0.4
    is_from_chair = kind in (CourseKind.UP_AND_GO, CourseKind.SIT_TO_STAND)
    assert len(made.truth.seated_s) >= int(is_from_chair)
    assert bool(len(made.truth.left_seat_s)) is is_from_chair


def test_a_silent_sensor_sends_nothing_and_the_others_go_on() -> None:
    course = replace(UP_AND_GO, silent_s={Site.RIGHT_FOOT: (4.0, 7.0)})
    imu = simulate_course(course).session.recordings[1].imu
    time_s = imu[Site.RIGHT_FOOT].time_s
    assert not np.any((time_s > 4.0) & (time_s < 7.0))
    assert np.any(time_s > 7.0)
    assert np.max(np.diff(imu[Site.LEFT_FOOT].time_s)) < 0.02


@pytest.mark.endurance
def test_one_seed_gives_one_course_and_another_another() -> None:
    kind = CourseKind.SIT_TO_STAND
    one, same, other = (simulate_course(draw_course(kind, seed)) for seed in (1, 1, 2))
    site = Site.LEFT_THIGH
    gyr, again = (made.session.recordings[1].imu[site].gyr_rad_s for made in (one, same))
    assert np.array_equal(gyr, again)
    assert len(one.truth.left_seat_s) == len(one.truth.upright_s) == 5
    assert not np.array_equal(one.truth.left_seat_s, other.truth.left_seat_s)


def test_a_rise_is_timed_between_a_tenth_and_nine_tenths_of_the_way(up_and_go: SimulatedCourse) -> None:
    truth = up_and_go.truth
    rises_s = truth.upright_s[0] - truth.left_seat_s[0]
    # a quintic step passes 0.1 and 0.9 at 0.247 and 0.753 of its time
    assert rises_s == pytest.approx(0.506 * UP_AND_GO.rise_s, abs=0.05)
    assert Side.LEFT in {site.side for site in UP_AND_GO.sites}


def test_a_pelvis_turns_with_the_way_and_leans_before_the_seat_is_left() -> None:
    made = simulate_course(replace(UP_AND_GO, sites=(Site.PELVIS,), hesitates=False))
    block = made.session.recordings[1].imu[Site.PELVIS]
    assert np.abs(block.acc_m_s2).max() < 80.0
    up = made.session.recordings[0].imu[Site.PELVIS].acc_m_s2.mean(axis=0)
    up /= np.linalg.norm(up)
    turned = float(np.sum(block.gyr_rad_s @ up) * 0.01)
    assert turned == pytest.approx(sum(turn.angle_rad for turn in made.truth.turns), abs=0.2)
    (left_s,) = made.truth.left_seat_s
    tilt = np.arccos(np.clip(block.acc_m_s2 @ up / np.linalg.norm(block.acc_m_s2, axis=1), -1.0, 1.0))
    clock = block.time_s
    assert np.median(tilt[clock < left_s - 1.2]) < np.deg2rad(3.0)  # seated, upright
    assert tilt[np.abs(clock - left_s) < 0.5].max() > np.deg2rad(15.0)

"""What a visit gives its patient's course: each condition by itself, judged by what is kept alone, and as kept."""

import json
import math
from dataclasses import replace

import pytest

from app.summary.comparison import Comparison, Contrast
from app.summary.conditions import conditions_of
from app.summary.course import OF_A_LEG, Course, CourseCondition, change, course_from_json, course_in_json, course_of
from core.body import Joint, Side
from core.parameters import CADENCE, KNEE, SPEED, STANCE
from core.session import Recording
from core.timed.found import NotValid
from core.timed.measures import COLUMNS
from core.timed.protocols import TimedProtocol
from core.verdicts.measurement_error import Judgement
from core.verdicts.model import Verdict
from core.verdicts.quantities import OF_HIPS
from tests.app.course_material import analysis, course, recordings, timed, unsure, walked
from tests.core.verdicts.built_walk import calibrations, judged_walk


def only(found: Course) -> CourseCondition:
    (one,) = found.conditions
    return one


def test_each_condition_is_reported_by_itself_and_its_walks_together() -> None:
    found = course(
        (walked("walk 1", speed_m_s=1.0), "shoes"),
        (walked("walk 2", speed_m_s=0.6), "stick"),
        (walked("walk 3", speed_m_s=1.2), "shoes"),
    )
    assert [one.condition for one in found.conditions] == ["shoes", "stick"]
    shoes, stick = (one.figure(SPEED) for one in found.conditions)
    assert shoes is not None
    assert stick is not None
    assert shoes.found.mean == pytest.approx(1.1)
    assert stick.found.mean == pytest.approx(0.6)
    assert [one.strides for one in found.conditions] == [48, 24]


def test_of_two_strappings_the_last_counts() -> None:
    walks = [(walked("walk 1", knee_deg=40.0), "shoes"), (walked("walk 2", knee_deg=50.0), "shoes")]
    reported = recordings(*walks)
    reported[1] = replace(reported[1], is_restrapped_before=True)
    found = only(course_of(analysis(*(one for one, _ in walks)), reported))
    knee = found.figure(KNEE, Side.LEFT)
    assert knee is not None
    assert knee.found.mean == pytest.approx(50.0)
    assert found.strides == 24


def test_a_figure_has_half_of_the_error_between_visits_for_its_whisker() -> None:
    """Two visits alike in all but the mean: whiskers are as long as half the error between two such means."""
    one, other = only(course((walked(knee_deg=50.0), ""))), only(course((walked(knee_deg=70.0), "")))
    for column, side in ((KNEE, Side.LEFT), (SPEED, None)):
        figure, found = one.figure(column, side), change(other, one, column, side)
        assert figure is not None
        assert found is not None
        of_other = other.figure(column, side)
        assert of_other is not None
        each = (figure.whisker_at(math.nan), of_other.whisker_at(math.nan))
        assert found.error == pytest.approx(math.sqrt(2) * math.hypot(*each))
    knee = change(other, one, KNEE, Side.LEFT)
    assert knee is not None
    assert knee.exceeds
    assert knee.difference == pytest.approx(20.0)
    assert not knee.is_unverified


def test_a_change_is_judged_as_the_comparison_of_visits_judges_it() -> None:
    """Home and Compare say the same: also where the walks' speeds differ, and a lag is unsure."""
    reported = calibrations(Joint.LEFT_KNEE, lag_sd_s=0.004)
    first, last = (
        walked(knee_deg=40.0, speed_m_s=0.7, reported=reported),
        walked(knee_deg=52.0, speed_m_s=1.1, reported=reported),
    )
    parts = [conditions_of(analysis(one, reported=reported), recordings((one, "shoes")))[0] for one in (first, last)]
    compared = {
        (row.measure.column, row.side): row.difference for row in Comparison(Contrast.VISITS, tuple(parts)).rows
    }
    courses = [only(course((one, "shoes"), reported=reported)) for one in (first, last)]
    for column, side in ((KNEE, Side.LEFT), (KNEE, Side.RIGHT), (SPEED, None)):
        found = change(courses[1], courses[0], column, side)
        assert repr(found) == repr(compared[column, side or Side.LEFT])  # no NaN equals itself


def test_what_is_not_reported_leaves_a_gap_and_is_named() -> None:
    reported = unsure(Joint.LEFT_KNEE)
    found = only(course((walked(reported=reported), "shoes"), reported=reported))
    knee, sound = (found.figure(KNEE, side) for side in Side)
    assert knee is not None
    assert sound is not None
    assert (knee.verdict, knee.is_reported) == (Verdict.NOT_REPORTED, False)
    assert math.isnan(knee.found.mean)
    assert math.isnan(knee.whisker_at(math.nan))
    assert sound.is_reported
    assert found.not_reported == (Joint.LEFT_KNEE,)
    readable = only(course((walked(), "shoes")))
    judged = change(readable, found, KNEE, Side.LEFT)
    assert judged is not None
    assert judged.judgement is Judgement.NOT_REPORTED
    assert readable.not_reported == ()


def test_two_strides_are_no_mean() -> None:
    found = only(course((walked(strides=2), "shoes")))
    for one in found.figures:
        assert not one.is_reported
    assert found.strides == 4


def test_stance_between_the_legs_is_reported_where_both_are() -> None:
    found = only(course((walked(stance_percent=64.0), "shoes"))).between_legs(STANCE)
    assert found is not None
    assert found.difference == pytest.approx(4.0)
    assert found.exceeds
    one_leg = walked()
    one_leg = replace(one_leg, gait={Side.LEFT: one_leg.gait[Side.LEFT]})
    assert only(course((one_leg, "shoes"))).between_legs(STANCE) is None


def test_the_toe_off_of_a_prosthesis_is_remembered_so_that_stance_is_not_judged() -> None:
    walk = walked(stance_percent=64.0)
    left = replace(walk.gait[Side.LEFT], is_toe_off_biased=True)
    biased = judged_walk(replace(walk, gait={**walk.gait, Side.LEFT: left}))
    kept = course_from_json(course_in_json(course((biased, "shoes"))))
    found = only(kept).between_legs(STANCE)
    assert found is not None
    assert found.judgement is Judgement.NO_PUBLISHED_FIGURE


def test_what_is_kept_is_what_was_found() -> None:
    reported = unsure(Joint.LEFT_KNEE)
    found = course(
        (walked(reported=reported), "shoes"), (walked("walk 2", strides=1, reported=reported), ""), reported=reported
    )
    written = json.dumps(course_in_json(found), allow_nan=False)
    read = course_from_json(json.loads(written))
    assert repr(read) == repr(found)
    of_leg = [column for column in OF_A_LEG if column not in OF_HIPS]  # no sensor is on the pelvis
    assert [one.column for one in read.conditions[0].figures] == [SPEED, CADENCE, *of_leg, *of_leg]
    assert read.conditions[0].figure(STANCE, Side.RIGHT) is not None


@pytest.mark.parametrize("content", [None, {}, [], {"format": "gaitwright-course/0"}])
def test_what_is_no_course_of_this_version_is_refused(content: object) -> None:
    with pytest.raises(ValueError, match="course"):
        course_from_json(content)


def test_a_visit_without_a_walk_has_no_conditions() -> None:
    found = course_of(analysis(), list[Recording]())
    assert found.conditions == ()
    assert course_from_json(course_in_json(found)) == found


def test_a_timed_test_is_with_its_condition_as_the_mean_of_its_attempts() -> None:
    found = course(
        (walked("walk 1"), "shoes"),
        (timed(TimedProtocol.TEN_METRES, time_s=10.0, name="walk 2"), "shoes"),
        (timed(TimedProtocol.TEN_METRES, time_s=8.0, name="walk 3"), "shoes"),
        (timed(TimedProtocol.TEN_METRES, time_s=20.0, name="walk 4"), "stick"),
        (timed(TimedProtocol.STAIRS, name="walk 5"), "shoes"),
    )
    shoes, stick = found.conditions
    (test,) = shoes.tests
    assert test.column == COLUMNS[TimedProtocol.TEN_METRES]
    assert test.found.mean == pytest.approx(1.125)
    assert test.found.attempts == 2
    assert test.whisker == pytest.approx(0.09009, abs=1e-5)
    assert stick.tests[0].found.mean == pytest.approx(0.5)


def test_an_attempt_that_is_not_valid_is_in_no_mean() -> None:
    up_and_go = COLUMNS[TimedProtocol.UP_AND_GO]
    good = timed(TimedProtocol.UP_AND_GO, time_s=10.0, name="walk 2")
    other = timed(TimedProtocol.UP_AND_GO, time_s=18.0, name="walk 3")
    assert other.timed is not None
    twice = replace(other, timed=replace(other.timed, not_valid=(NotValid.MORE_TURNS,)))
    (test,) = only(course((good, "shoes"), (twice, "shoes"))).tests
    assert (test.column, test.found.mean, test.found.attempts) == (up_and_go, 10.0, 1)
    (alone,) = only(course((twice, "shoes"))).tests
    assert not alone.is_reported


def test_a_condition_of_tests_from_a_chair_alone_has_no_figure_of_walking() -> None:
    found = course((walked(), "shoes"), (timed(TimedProtocol.SIT_TO_STAND, time_s=14.0), "barefoot"))
    barefoot = found.condition("barefoot")
    assert barefoot is not None
    assert (barefoot.strides, barefoot.figures) == (0, ())
    test = barefoot.test(COLUMNS[TimedProtocol.SIT_TO_STAND])
    assert test is not None
    assert test.found.mean == pytest.approx(14.0)
    assert not math.isfinite(test.whisker)
    assert change(barefoot, barefoot, SPEED) is None


def test_what_rests_on_the_feet_is_not_reported_with_them_and_what_ends_at_the_tape_is_not() -> None:
    def reported(*, is_end_by_key: bool) -> Verdict:
        slow = walked("walk 9", speed_m_s=0.05)  # no speed that anybody walks at
        test = timed(TimedProtocol.TEN_METRES, is_end_by_key=is_end_by_key)
        found = only(course((replace(slow, timed=test.timed), "shoes"))).test(COLUMNS[TimedProtocol.TEN_METRES])
        assert found is not None
        assert found.is_reported is (found.verdict is not Verdict.NOT_REPORTED)
        return found.verdict

    assert reported(is_end_by_key=False) is Verdict.NOT_REPORTED
    assert reported(is_end_by_key=True) is Verdict.READ


def test_a_test_that_was_broken_off_has_no_value_and_is_kept_as_it_is() -> None:
    found = course((timed(TimedProtocol.UP_AND_GO, time_s=math.nan), "shoes"))
    test = only(found).test(COLUMNS[TimedProtocol.UP_AND_GO])
    assert test is not None
    assert not test.is_reported
    again = course_from_json(json.loads(json.dumps(course_in_json(found))))
    assert str(again) == str(found)


def test_tests_on_two_courses_are_in_no_mean_and_no_change() -> None:
    def on(*lengths_m: float) -> CourseCondition:
        tests = []
        for k, length_m in enumerate(lengths_m):
            walk = timed(TimedProtocol.UP_AND_GO, time_s=10.0 + k, name=f"walk {k}")
            test = walk.timed
            assert test is not None
            tests.append((replace(walk, timed=replace(test, course_m=length_m)), "shoes"))
        return only(course(*tests))

    three, mixed, five = on(3.0, 3.0), on(5.0, 3.0), on(5.0)
    found = [one.test("up_and_go_time_s") for one in (three, mixed, five)]
    assert [(one.found.mean, one.found.attempts, one.course_m) for one in found if one is not None] == [
        *((10.5, 2, 3.0), (11.0, 1, 3.0), (10.0, 1, 5.0))
    ]
    assert change(mixed, three, "up_and_go_time_s") is not None
    assert change(five, three, "up_and_go_time_s") is None
    kept = course_from_json(course_in_json(Course(None, (five,))))
    assert kept.conditions[0].tests == five.tests

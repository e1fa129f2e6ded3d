"""The answer to a walk: each kind has a walk in which it must come, and one in which it must not."""

import datetime
import re
from dataclasses import replace

import pytest

from app.summary.answer import Answer, Outcome, answer_of
from app.summary.facts import Facts
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import LEG_JOINTS, Joint, Side
from core.goals import Goal, GoalOf
from core.results import Analysis
from tests.app.changed_analysis import recalibrated, rewalked, walk_of, with_few_strides
from tests.app.reports.patient.test_what_stands_out import stated, with_more


@pytest.fixture
def analysis(request_of_demonstration: ReportRequest) -> Analysis:
    return request_of_demonstration.visit.analysis


def answer(request: ReportRequest, analysis: Analysis) -> Answer:
    return answer_of(Facts(AnalysedVisit(request.visit.session, analysis), walk_of(analysis)))


def test_what_differs_most_is_the_answer_and_its_error_is_beside_it(
    request_of_demonstration: ReportRequest, analysis: Analysis
) -> None:
    found = answer(request_of_demonstration, with_more(analysis, Side.LEFT, "knee_range_rad", -20.0))
    assert found.outcome is Outcome.DIFFERS
    assert found.first == "The left knee has 21.3° less range of motion than the right: 41.7° against 63.0°."
    assert re.match(r"Likely between 1\d° and 2\d°\. 95 of 100 healthy people differ by less\.", found.then)


def test_where_nothing_exceeds_its_error_the_answer_is_that(
    request_of_demonstration: ReportRequest, analysis: Analysis
) -> None:
    found = answer(request_of_demonstration, analysis)
    assert found.outcome is Outcome.NOTHING
    assert found.first.startswith("Left and right are similar: ")
    assert re.match(
        r"Difference \d\.\d°, which may be measurement error: anything from −\d\d° to \+\d° fits\.", found.then
    )
    assert "within 2\u00a0SD of the reference" in found.then


def test_a_difference_that_is_reported_in_the_table_alone_is_not_called_none(
    request_of_demonstration: ReportRequest, analysis: Analysis
) -> None:
    """3.6 points of stance exceed the error of 3.0, and no healthy people's 4.0."""
    found = answer(request_of_demonstration, with_more(analysis, Side.LEFT, "stance_percent", 3.6))
    assert found.outcome is Outcome.OPEN
    assert found.first.startswith("Stance is 3.6")
    assert "Many healthy people differ as much." in found.then
    assert answer(request_of_demonstration, with_more(analysis, Side.LEFT, "stance_percent", 6.0)).outcome is (
        Outcome.DIFFERS
    )


@pytest.mark.parametrize(
    ("left", "right", "outcome"), [(2, 2, Outcome.UNREADABLE), (2, 9, Outcome.OPEN), (12, 12, Outcome.NOTHING)]
)
def test_too_few_strides_are_counted(
    request_of_demonstration: ReportRequest, analysis: Analysis, left: int, right: int, outcome: Outcome
) -> None:
    found = answer(request_of_demonstration, with_few_strides(analysis, left=left, right=right))
    assert found.outcome is outcome
    assert (found.first == "Too few strides for a mean: L\u00a02 and R\u00a02.") is (outcome is Outcome.UNREADABLE)


def test_of_a_walk_without_strides_nothing_is_read(request_of_demonstration: ReportRequest, analysis: Analysis) -> None:
    found = answer(request_of_demonstration, rewalked(analysis, gait={}))
    assert found.outcome is Outcome.UNREADABLE
    assert found.first.startswith("No results for this walk")


def test_what_is_not_reported_is_no_answer_but_the_caveat_beside_it(
    request_of_demonstration: ReportRequest, analysis: Analysis
) -> None:
    shortened = with_more(analysis, Side.LEFT, "knee_range_rad", -20.0)
    found = answer(
        request_of_demonstration, recalibrated(shortened, [Joint.LEFT_KNEE], is_same_joint=False, sign_margin=1.05)
    )
    assert "knee has" not in found.first
    assert found.then.endswith("Not reported: left knee.")


def test_the_screen_and_the_report_say_the_same(request_of_demonstration: ReportRequest, analysis: Analysis) -> None:
    for name, side, more in (("knee_range_rad", Side.RIGHT, -20.0), ("step_time_s", Side.LEFT, 0.2)):
        changed = with_more(analysis, side, name, more)
        first = answer(request_of_demonstration, changed).first.replace("\u00a0", " ")
        assert any(sentence.startswith(first) for sentence in stated(request_of_demonstration, changed))


@pytest.mark.parametrize("joints", [LEG_JOINTS, (Joint.LEFT_KNEE, Joint.LEFT_ANKLE), (Joint.LEFT_KNEE,)])
def test_where_no_angle_can_be_compared_it_is_stated_beside_what_times_show(
    request_of_demonstration: ReportRequest, analysis: Analysis, joints: tuple[Joint, ...]
) -> None:
    found = answer(request_of_demonstration, recalibrated(analysis, joints, is_same_joint=False, sign_margin=1.05))
    assert found.outcome is Outcome.NOTHING
    has_pair = joints == (Joint.LEFT_KNEE,)  # the ankles
    assert ("No angle can be compared." in found.then) is not has_pair
    assert found.first.startswith("Left and right are similar: stance ")


def test_a_goal_agreed_before_is_answered_and_one_agreed_on_the_day_is_not(
    request_of_demonstration: ReportRequest, analysis: Analysis
) -> None:
    session = request_of_demonstration.visit.session

    def then(agreed: str) -> str:
        goal = Goal("speed_m_s", GoalOf.WALK, 3.0, datetime.date.fromisoformat(agreed))
        reported = replace(session, started="2026-11-20", patient=replace(session.patient, goals=(goal,)))
        return answer_of(Facts(AnalysedVisit(reported, analysis), walk_of(analysis))).then

    assert (
        "Goal: Walking speed: at least 3.00\u00a0m/s; measured 1.18\u00a0m/s, not reached; the difference is beyond"
        in then("2026-11-19")
    )
    assert "Fewer than 1 of 10 such measurements are at the goal." in then("2026-11-19")
    assert "Goal" not in then("2026-11-20")
    assert "Goal" not in then("2026-11-21")

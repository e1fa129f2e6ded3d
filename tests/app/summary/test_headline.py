"""Tests of the sentence over a walk, its four values and its quality line."""

import datetime
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from uuid import UUID

import pytest

from app.summary.course_lanes import CourseVisit
from app.summary.facts import Facts
from app.summary.headline import Headline, Rule, headline_of
from app.summary.quality_line import quality_sentence
from app.summary.request import AnalysedVisit
from app.summary.tiles import Tile, tiles_of
from app.summary.what_differs import what_differs, without_family
from core.body import Joint, Side
from core.goals import Goal, GoalOf
from core.parameters import CADENCE, KNEE, KNEE_RANGE, SPEED, STANCE
from core.results import RecordingAnalysis
from core.session import Patient, Session
from tests.app.course_material import analysis, course, recordings, unsure, walked
from tests.core.verdicts.built_walk import Reported

DAYS = [datetime.date(2026, 7, 1), datetime.date(2026, 9, 23), datetime.date(2026, 11, 3)]
SHOES = "shoes"


def facts(
    *walks: RecordingAnalysis,
    affected: Side | None = Side.LEFT,
    goals: Sequence[Goal] = (),
    reported: Reported | None = None,
) -> Facts:
    """The last of these walks, one at each visit."""
    days = DAYS[-len(walks) :]
    seen = tuple(
        CourseVisit(UUID(int=k), day, course((one, SHOES), affected=affected))
        for k, (one, day) in enumerate(zip(walks, days, strict=True), start=1)
    )
    last = walks[-1]
    found = analysis(last, affected=affected, reported=reported)
    patient = Patient(affected_side=str(affected) if affected else "none", goals=tuple(goals))
    started = f"{days[-1].isoformat()}T10:00:00"
    session = Session(tuple(recordings((last, SHOES))), patient=patient, started=started)
    return Facts(AnalysedVisit(session, found), last, course=seen)


def plain(found: Headline) -> str:
    return found.first.replace("\u00a0", " ")


def tile(found: Facts, column: str) -> Tile:
    return next(one for one in tiles_of(found) if one.column == column)


def test_a_change_since_the_last_visit_comes_before_all_else() -> None:
    found = headline_of(facts(walked(knee_deg=35.0), walked(knee_deg=40.0), walked(knee_deg=58.0)))
    assert found.rule is Rule.SINCE_LAST
    assert plain(found) == "Left knee flexes 58° from stance to swing, up 18° since 23 Sep."
    assert found.since is not None
    assert found.since.day == DAYS[1]
    assert found.then.startswith("Change likely between ")


def test_a_change_within_error_makes_no_headline() -> None:
    found = headline_of(facts(walked(knee_deg=58.0), walked(knee_deg=59.0)))
    assert found.rule is Rule.SIMILAR
    assert found.since is not None  # whose curves are drawn thin all the same


def test_since_the_first_visit_the_last_one_is_named_too() -> None:
    found = headline_of(facts(walked(knee_deg=35.0), walked(knee_deg=49.0), walked(knee_deg=53.0)))
    assert found.rule is Rule.SINCE_FIRST
    assert plain(found) == "Left knee flexes 53° from stance to swing, up 18° since 1 Jul."
    assert found.beside[-1] == "Since 23 Sep: +4°, within measurement error."
    assert found.since is not None
    assert found.since.day == DAYS[0]


def test_stance_is_given_in_points_before_and_now() -> None:
    found = headline_of(facts(walked(knee_deg=60.0, stance_percent=68.0), walked(knee_deg=60.0, stance_percent=62.0)))
    assert plain(found) == "Left stance is 6.0 points shorter than on 23 Sep: 68.0 → 62.0 %."


def test_at_a_first_visit_the_affected_leg_is_beside_the_sound_one() -> None:
    found = headline_of(facts(walked(knee_deg=35.0)))
    assert found.rule is Rule.LEGS
    assert plain(found) == "Left knee flexes 35° from stance to swing, 25° less than the right."
    assert "95 of 100 healthy people differ by less." in found.then
    assert found.since is None


def test_beyond_error_alone_many_healthy_people_differ_as_much() -> None:
    found = headline_of(facts(walked(knee_deg=51.5)))
    assert found.rule is Rule.LEGS_BEYOND_ERROR
    assert plain(found).endswith("less than the right; many healthy people differ as much.")
    assert "95 of 100" not in found.then


def test_where_nothing_differs_both_values_are_given() -> None:
    found = headline_of(facts(walked(knee_deg=59.0)))
    assert found.rule is Rule.SIMILAR
    assert plain(found) == "Left and right are similar: knee 59° and 60° from stance to swing."
    assert re.search(r"may be measurement error: anything from .* to .* fits", found.then)


def test_too_few_strides_say_what_was_measured_and_what_to_do() -> None:
    found = headline_of(facts(walked(strides=2)))
    assert found.rule is Rule.NOTHING
    assert plain(found) == "Too few strides for a mean: L 2 and R 2."
    assert found.then == "Repeat the walk over a longer distance or time."


def test_labels_swapped_mirror_the_sentence() -> None:
    """What is of one leg is of the other where that is affected; nothing else changes."""
    left = plain(headline_of(facts(walked(knee_deg=35.0), affected=Side.LEFT)))
    right = plain(headline_of(facts(walked(knee_deg=35.0), affected=Side.RIGHT)))
    assert left == "Left knee flexes 35° from stance to swing, 25° less than the right."
    assert right == "Right knee flexes 60° from stance to swing, 25° more than the left."


@pytest.mark.parametrize("knee_deg", [35.4, 35.6, 58.4, 48.5, 53.49])
def test_shown_values_give_the_shown_difference(knee_deg: float) -> None:
    found = headline_of(facts(walked(knee_deg=knee_deg)))
    if found.rule is Rule.LEGS:
        value, size = map(float, re.findall(r"([\d.]+)°", found.first))
        decimals = 1 if "." in found.first.split("°")[0] else 0
        assert round(round(60.0, decimals) - value, 1) == size


def test_four_tiles_are_always_there() -> None:
    for one in (facts(walked()), facts(walked(strides=2)), facts(walked(reported=unsure(Joint.LEFT_KNEE)))):
        assert [tile.column for tile in tiles_of(one)] == [SPEED, CADENCE, KNEE, STANCE]


def test_a_change_beyond_error_is_marked_and_one_within_is_named_so() -> None:
    found = facts(walked(knee_deg=35.0, speed_m_s=0.9), walked(knee_deg=58.0, speed_m_s=0.95))
    assert (tile(found, KNEE).change.is_beyond_error, tile(found, KNEE).change.words) == (True, "+23° since 23 Sep")
    assert tile(found, SPEED).change.words == "+0.05 since 23 Sep, within error"
    assert not tile(found, SPEED).change.is_beyond_error


def test_the_first_visit_is_called_so_and_the_other_knee_is_beside() -> None:
    found = facts(walked(knee_deg=35.0))
    assert tile(found, SPEED).change.words == "First visit"
    assert tile(found, KNEE).change.words == "R 60°"
    assert tile(facts(walked(), affected=None), KNEE).change.words == "First visit"


def test_who_was_here_before_in_another_condition_is_not_at_a_first_visit() -> None:
    found = facts(walked(), affected=None)
    before = CourseVisit(UUID(int=9), DAYS[0], course((walked(), "barefoot"), affected=None))
    returned = replace(found, course=(before, *found.course))
    assert {one.change.words for one in tiles_of(returned)} == {"First in this condition"}
    assert {one.change.words for one in tiles_of(found)} == {"First visit"}


def test_without_an_affected_side_the_knee_has_both_values() -> None:
    values = tile(facts(walked(knee_deg=52.0), affected=None), KNEE).values
    assert [(one.side, one.text) for one in values] == [(Side.LEFT, "52°"), (Side.RIGHT, "60°")]


def test_a_joint_that_is_not_reported_has_no_value_and_no_change() -> None:
    one = facts(walked(knee_deg=35.0), walked(knee_deg=58.0, reported=unsure(Joint.LEFT_KNEE)))
    found = tile(one, KNEE)
    assert math.isnan(found.values[0].value)
    assert (found.why, found.change.words) == ("not reported", "")


def test_a_change_counts_from_the_last_visit_that_has_the_value() -> None:
    """One without it in between is passed over."""
    unread = walked(reported=unsure(Joint.LEFT_KNEE))
    found = facts(walked(knee_deg=35.0), unread, walked(knee_deg=58.0))
    assert tile(found, KNEE).change.words == "+23° since 1 Jul"


def test_a_goal_is_on_its_tile_with_how_it_is_met() -> None:
    goal = Goal(KNEE, GoalOf.LEFT, 55.0, DAYS[0])
    found = tile(facts(walked(knee_deg=35.0), walked(knee_deg=58.0), goals=[goal]), KNEE)
    assert (found.goals, found.goal) == ((55.0,), "goal 55°")
    assert "of 10 such measurements" in found.goal_words
    assert tile(facts(walked(), goals=[goal]), SPEED).goals == ()


def test_stance_between_legs_has_an_error_of_each_legs_change() -> None:
    found = facts(walked(stance_percent=72.0), walked(stance_percent=60.0))
    assert tile(found, STANCE).change.words == "−12.0 since 23 Sep"
    assert tile(found, STANCE).change.is_beyond_error
    small = tile(facts(walked(stance_percent=62.0), walked(stance_percent=60.0)), STANCE)
    assert small.change.words == "−2.0 since 23 Sep, within error"


def test_the_largest_differences_begin_with_what_healthy_people_do_not_have() -> None:
    rows = without_family(what_differs(facts(walked(knee_deg=35.0))))
    assert rows[0].column == KNEE
    assert KNEE_RANGE not in [row.column for row in rows]
    order = [(row.difference.is_reported, row.difference.is_judged, row.difference.ratio > 0) for row in rows]
    assert order == sorted(order, reverse=True)


def test_the_quality_line_is_good_or_names_the_gravest_and_how_many_more() -> None:
    good = quality_sentence(facts(walked()))
    assert good.is_good
    assert good.in_words.startswith("Data quality: good. 12 and 12 strides")
    found = quality_sentence(facts(walked(reported=unsure(Joint.LEFT_KNEE))))
    assert not found.is_good
    assert found.first == "Left knee: not reported."
    assert found.then


def test_a_walk_of_one_leg_states_what_it_has() -> None:
    both = walked(knee_deg=52.0)
    alone = replace(both, gait={Side.LEFT: both.gait[Side.LEFT]})
    found = headline_of(facts(alone))
    assert found.rule is Rule.ONE_LEG
    assert plain(found) == "Left knee flexes 52° from stance to swing."

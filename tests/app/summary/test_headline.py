"""Tests of the sentence over a walk, its four values and its quality line."""

import datetime
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from uuid import UUID

import pytest
from syrupy.assertion import SnapshotAssertion

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


def stated(found: Headline) -> tuple[str, str, tuple[str, ...], datetime.date | None]:
    """By which rule, both lines, and the day of the visit that is drawn thin."""
    return found.rule.name, found.first, found.beside, found.since.day if found.since else None


def tile(found: Facts, column: str) -> Tile:
    return next(one for one in tiles_of(found) if one.column == column)


def test_the_first_rule_that_holds_makes_the_headline(snapshot: SnapshotAssertion) -> None:
    both = walked(knee_deg=52.0)
    cases = {
        "a change since the last visit comes before all else": facts(
            walked(knee_deg=35.0), walked(knee_deg=40.0), walked(knee_deg=58.0)
        ),
        "a change within error makes no headline; its curves are drawn thin all the same": facts(
            walked(knee_deg=58.0), walked(knee_deg=59.0)
        ),
        "since the first visit the last one is named too": facts(
            walked(knee_deg=35.0), walked(knee_deg=49.0), walked(knee_deg=53.0)
        ),
        "stance is in points, before and now": facts(
            walked(knee_deg=60.0, stance_percent=68.0), walked(knee_deg=60.0, stance_percent=62.0)
        ),
        "at a first visit the affected leg is beside the sound one": facts(walked(knee_deg=35.0)),
        "labels swapped mirror the sentence": facts(walked(knee_deg=35.0), affected=Side.RIGHT),
        "beyond error alone many healthy people differ as much": facts(walked(knee_deg=51.5)),
        "where nothing differs both values are given": facts(walked(knee_deg=59.0)),
        "too few strides: what was measured and what to do": facts(walked(strides=2)),
        "one leg has what it has": facts(replace(both, gait={Side.LEFT: both.gait[Side.LEFT]})),
    }
    assert {case: stated(headline_of(one)) for case, one in cases.items()} == snapshot


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


def shown(found: Facts, column: str) -> dict[str, object]:
    """What a tile shows; nothing of what it has not."""
    one = tile(found, column)
    values = {str(value.side): value.text for value in one.values}
    parts = {"values": values, "why": one.why, "goal": one.goal, "goals": one.goals, "of goals": one.goal_words}
    change = {"change": one.change.words, "filled": one.change.is_beyond_error}
    return {name: part for name, part in (parts | change).items() if part}


def test_a_tile_has_its_change_its_values_and_its_goal(snapshot: SnapshotAssertion) -> None:
    unread = walked(reported=unsure(Joint.LEFT_KNEE))
    two = facts(walked(knee_deg=35.0, speed_m_s=0.9), walked(knee_deg=58.0, speed_m_s=0.95))
    first = facts(walked(knee_deg=35.0))
    goal = [Goal(KNEE, GoalOf.LEFT, 55.0, DAYS[0])]
    assert {
        "beyond error": shown(two, KNEE),
        "within error": shown(two, SPEED),
        "a first visit": shown(first, SPEED),
        "a first visit, the other knee is beside": shown(first, KNEE),
        "a first visit, no side is affected": shown(facts(walked(knee_deg=52.0), affected=None), KNEE),
        "not reported": shown(facts(walked(knee_deg=35.0), unread), KNEE),
        "since the last visit with the value": shown(facts(walked(knee_deg=35.0), unread, walked(knee_deg=58.0)), KNEE),
        "a goal": shown(facts(walked(knee_deg=35.0), walked(knee_deg=58.0), goals=goal), KNEE),
        "a goal of another measure": shown(facts(walked(), goals=goal), SPEED),
        "stance by each leg's change": shown(facts(walked(stance_percent=72.0), walked(stance_percent=60.0)), STANCE),
        "stance within error": shown(facts(walked(stance_percent=62.0), walked(stance_percent=60.0)), STANCE),
    } == snapshot
    assert math.isnan(tile(facts(unread), KNEE).values[0].value)


def test_who_was_here_before_in_another_condition_is_not_at_a_first_visit() -> None:
    found = facts(walked(), affected=None)
    before = CourseVisit(UUID(int=9), DAYS[0], course((walked(), "barefoot"), affected=None))
    returned = replace(found, course=(before, *found.course))
    assert {one.change.words for one in tiles_of(returned)} == {"First in this condition"}
    assert {one.change.words for one in tiles_of(found)} == {"First visit"}


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

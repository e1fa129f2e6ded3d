"""The sentences of page one: each has a case in which it must come, and one in which it must not."""

import datetime
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any
from uuid import UUID

import numpy as np
import pytest

from app.reports.patient.comparison_page import comparison_of
from app.reports.patient.document import facts_of
from app.reports.patient.time_page import time_distance_table
from app.summary import comparison
from app.summary.comparison import Comparison, Contrast
from app.summary.conditions import Part
from app.summary.course_lanes import CourseVisit
from app.summary.facts import Facts, role
from app.summary.goals import goal_sentence
from app.summary.headline import headline_of
from app.summary.measure_sentences import unit_and_decimals, who_of_role
from app.summary.measures import MEASURES, Measure
from app.summary.request import AnalysedVisit, ReportRequest
from app.summary.what_stands_out import (
    LEAST_CERTAIN,
    MAX_FINDINGS,
    Candidate,
    Rank,
    Since,
    caveat,
    printed_findings,
)
from app.wording.measures import name_in_sentence
from core.body import Joint, Side
from core.goals import Goal, GoalOf, agreed_by
from core.parameters import BETWEEN_LEGS, BY_COLUMN, ParameterFile, QuantityClass, columns_of
from core.prosthesis import AmputationLevel, Prosthesis
from core.results import Analysis, ZeroKind
from core.session import Patient, Session
from core.verdicts.gates import judged
from core.verdicts.measurement_error import Difference, Judgement
from tests.app.changed_analysis import recalibrated, rewalked, walk_of, with_few_strides
from tests.app.course_material import analysis as material
from tests.app.course_material import course, recordings, walked
from tests.app.hip_visits import hip_facts
from tests.core.verdicts.built_walk import calibrations

SIMILAR = "Left and right are similar: "
ZERO = "Angles are measured from the patient's standing posture"


def stated(request: ReportRequest, analysis: Analysis | None = None) -> list[str]:
    """The sentences of a report, of another analysis where one is given."""
    if analysis is not None:
        request = replace(request, visit=AnalysedVisit(request.visit.session, analysis))
    facts, compared = facts_of(request), comparison_of(request)
    goals = [stated for one in facts.reported_goals if (stated := goal_sentence(one))][:1]
    caveats = [" ".join([*caveat(facts, compared), *goals])]
    sentences = findings(facts, compared) or [f"{headline_of(facts).first} {headline_of(facts).then}"]
    sentences += filter(None, caveats)
    return [sentence.replace("\u00a0", " ").replace("\u2212", "-") for sentence in sentences]


def findings(facts: Facts, comparison: Comparison | None) -> list[str]:
    return [" ".join(filter(None, (one.stated, one.evidence))) for one in printed_findings(facts, comparison)]


def of_a_child(request: ReportRequest, analysis: Analysis) -> ReportRequest:
    session = request.visit.session
    child = replace(session, started="2026-11-20", patient=replace(session.patient, birth_year=2016))
    return replace(request, visit=AnalysedVisit(child, analysis))


def with_more(analysis: Analysis, side: Side, name: str, more: float) -> Analysis:
    """One parameter of a leg larger in every stride of every walk; an angle in degrees."""
    recordings = []
    for one in analysis.recordings:
        gait = dict(one.gait)
        if side in gait:
            is_angle = name.endswith("_rad")
            added = np.deg2rad(more) if is_angle else more
            parameters = {**gait[side].parameters, name: gait[side].parameters[name] + added}
            gait[side] = replace(gait[side], parameters=parameters)
        recordings.append(replace(one, gait=gait))
    return judged(replace(analysis, recordings=tuple(recordings)))


def raised(analysis: Analysis, joint: Joint, by_deg: float) -> Analysis:
    """One joint's curve lying higher as a whole, as a zero taken in another posture makes it."""
    walk = walk_of(analysis)
    found, kind = walk.gait[joint.side], "knee" if joint.is_knee else "ankle"
    heights = {
        name
        for name in columns_of(ParameterFile.STRIDES, ParameterFile.PEAKS)
        if BY_COLUMN[name].rests_on is QuantityClass.HEIGHT and name.startswith(kind)
    }
    is_height = {name: name.replace("_rad", "_deg") in heights for name in found.parameters}
    parameters = {
        name: values + np.deg2rad(by_deg) if is_height[name] else values for name, values in found.parameters.items()
    }
    cycles = {**found.cycles, joint: found.cycles[joint] + np.deg2rad(by_deg)}
    return rewalked(analysis, gait={**walk.gait, joint.side: replace(found, parameters=parameters, cycles=cycles)})


def test_where_nothing_differs_that_is_stated_and_the_caveat_of_the_zero(demo: ReportRequest) -> None:
    first, last = stated(demo)
    assert first.startswith(SIMILAR)
    assert "° and " in first
    assert "which may be measurement error: anything from -" in first
    assert last.startswith(ZERO)


def test_without_a_standing_zero_its_caveat_is_not_stated(demo: ReportRequest) -> None:
    analysis = recalibrated(demo.visit.analysis, zero=ZeroKind.GONIOMETER)
    assert not any(ZERO in sentence for sentence in stated(demo, analysis))


@pytest.mark.parametrize(("more_deg", "is_reported"), [(-3.0, False), (-20.0, True)])
def test_a_knee_that_moves_less_than_the_other_by_more_than_healthy_people_differ(
    demo: ReportRequest, more_deg: float, is_reported: bool
) -> None:
    """Of 63 and 41.7° the sigmas are hypot(1.2, 2.71) and hypot(1.2, 1.79), so that 1.96 S is 7.2° and chance."""
    analysis = with_more(demo.visit.analysis, Side.LEFT, "knee_range_rad", more_deg)
    reported = [sentence for sentence in stated(demo, analysis) if "range of motion than" in sentence]
    assert bool(reported) is is_reported
    if is_reported:
        first, second, third = reported[0].split(". ")
        assert first == "The left knee has 21.3° less range of motion than the right: 41.7° against 63.0°"
        low, high = map(int, re.findall(r"\d+", second))
        assert second == f"Likely between {low}° and {high}°"
        assert (low + high) / 2 == pytest.approx(21.3, abs=0.6)
        assert (high - low) / 2 == pytest.approx(7.3, abs=0.9)
        assert third == "95 of 100 healthy people differ by less."
    assert any(SIMILAR in sentence for sentence in stated(demo, analysis)) is not is_reported


def test_with_the_legs_exchanged_the_sentence_is_mirrored(demo: ReportRequest) -> None:
    for side, words in ((Side.LEFT, "less"), (Side.RIGHT, "more")):
        analysis = with_more(demo.visit.analysis, side, "knee_range_rad", -20.0)
        assert f"° {words} range of motion than the right" in stated(demo, analysis)[0]


@pytest.mark.parametrize(("more_deg", "is_reported"), [(-3.0, False), (-20.0, True)])
def test_an_ankle_between_legs_makes_a_sentence_beyond_what_healthy_people_differ_by(
    demo: ReportRequest, more_deg: float, is_reported: bool
) -> None:
    """Their ranges differ by up to 6.2°; attachment cannot part two legs by more, so that this is the error as well."""
    analysis = with_more(demo.visit.analysis, Side.LEFT, "ankle_range_rad", more_deg)
    reported = [one for one in stated(demo, analysis) if "The left ankle has " in one]
    assert bool(reported) is is_reported
    if is_reported:
        assert reported[0].endswith("95 of 100 healthy people differ by less.")
        assert "\u2020" not in reported[0]  # the limit is measured, whatever the ankle's sigma rests on


@pytest.mark.parametrize(("more", "is_reported"), [(2.0, False), (3.6, False), (6.0, True)])
def test_stance_that_lasts_longer_on_one_leg(demo: ReportRequest, more: float, is_reported: bool) -> None:
    """Error 1.96 sqrt(2) 1.1 = 3.0 points; 95 of 100 healthy people differ by less than 4.0."""
    analysis = with_more(demo.visit.analysis, Side.LEFT, "stance_percent", more)
    request = of_a_child(demo, analysis)  # who has no band
    reported = [one for one in stated(request) if one.startswith("Stance is ") and "95 of 100 healthy" in one]
    assert bool(reported) is is_reported


def with_goal_of(request: ReportRequest, day: str, of: GoalOf = GoalOf.BETWEEN) -> ReportRequest:
    """With a goal of stance that was agreed on a day."""
    session = request.visit.session
    goal = Goal("stance_percent", of, 60.0, datetime.date.fromisoformat(day), is_at_most=True)
    reported = replace(session, patient=replace(session.patient, goals=(goal,)))
    return replace(request, visit=AnalysedVisit(reported, request.visit.analysis))


def test_a_measure_chosen_before_the_walk_is_reported_from_one_error_on_and_never_one_chosen_after(
    demo: ReportRequest,
) -> None:
    """Of two walks with the sensors left on stance errs by 1.96 sqrt(2) 0.55 = 1.52 points, a sentence needs 1.83."""

    def is_reported(more: float, day: str, of: GoalOf = GoalOf.LEFT) -> bool:
        goal = Goal("stance_percent", of, 60.0, datetime.date.fromisoformat(day), is_at_most=True)
        agreed = agreed_by((goal,), datetime.date(2026, 11, 20))
        walks = [walked(letter, stance_percent=60.0 + (more if letter == "B" else 0.0)) for letter in "AB"]
        parts = tuple(Part(one.name, one.name, (one,), calibrations(), agreed=agreed) for one in walks)
        found = printed_findings(facts_of(demo), Comparison(Contrast.CONDITIONS, parts))
        return any(one.column == "stance_percent" for one in found)

    assert not is_reported(1.7, "2026-11-20")
    assert is_reported(1.7, "2026-11-19")
    assert not is_reported(1.7, "2026-11-19", GoalOf.RIGHT)
    assert not is_reported(1.7, "2026-11-21")
    assert not is_reported(1.4, "2026-11-19")


def test_a_goal_lets_no_difference_between_legs_be_a_finding_that_many_healthy_people_have(demo: ReportRequest) -> None:
    """3.6 points of stance lie between the error, 3.0, and what healthy people differ by, 4.0."""
    analysis = with_more(demo.visit.analysis, Side.LEFT, "stance_percent", 3.6)
    request = with_goal_of(of_a_child(demo, analysis), "2026-11-19")
    assert printed_findings(facts_of(request), None) == []
    (first, *_) = stated(request)
    assert first.startswith("Left stance is 64.1 %, 3.6 points more than the right; many healthy people")
    assert "many healthy people differ as much" in first


@pytest.mark.parametrize(("more_m", "is_reported"), [(0.0, False), (0.5, True)])
def test_a_stride_length_beyond_two_sd_of_its_band(demo: ReportRequest, more_m: float, is_reported: bool) -> None:
    analysis = demo.visit.analysis
    for side in Side:
        analysis = with_more(analysis, side, "stride_length_m", more_m)
    reported = [one for one in stated(demo, analysis) if one.startswith("Stride length, ")]
    assert bool(reported) is is_reported
    if is_reported:
        assert "more than 2 SD above the reference [2] (1.30 ± 0.11 m with measurement error)." in reported[0]


class OrderedLegs(frozenset[Side]):
    """A set of legs that gives them in a known order."""

    def __new__(cls, order: Sequence[Side]) -> "OrderedLegs":
        made = super().__new__(cls, order)
        made.order = order
        return made

    order: Sequence[Side]

    def __iter__(self) -> Iterator[Side]:
        return iter(self.order)


def test_of_both_legs_beyond_the_band_by_as_much_the_first_is_named_in_every_run(demo: ReportRequest) -> None:
    """The order of a set of legs is another one in each run."""
    gait = walk_of(demo.visit.analysis).gait
    analysis = rewalked(
        demo.visit.analysis,
        gait={
            side: replace(found, parameters={**found.parameters, "stride_length_m": np.full(len(found.strides), 1.9)})
            for side, found in gait.items()
        },
    )
    facts = facts_of(replace(demo, visit=AnalysedVisit(demo.visit.session, analysis)))
    first, second = facts.first_and_second
    for order in ((first, second), (second, first)):
        facts.__dict__["sides_with_band"] = OrderedLegs(order)
        reported, *_ = (one for one in findings(facts, None) if one.startswith("Stride length, "))
        assert reported.startswith(f"Stride length, {role(facts, first)}: ")


@pytest.mark.parametrize(
    ("more", "words", "is_a_sentence"),
    [
        (-8.0, "L, R more than 2 SD below", True),
        (-5.0, "L, R 1–2 SD below", False),
        (0.0, "L, R within 1 SD", False),
        (4.0, "L, R 1–2 SD above", False),
        (8.0, "L, R more than 2 SD above", True),
    ],
)
def test_stance_is_judged_against_a_band_that_holds_our_own_error(
    demo: ReportRequest, more: float, words: str, is_a_sentence: bool
) -> None:
    """60.3 ± 1.1 %, with our 1.1 and 2.8 points 3.2: of a stance of 60.5 % less 5 is 1.5 SD, and less 8 2.4."""
    analysis = demo.visit.analysis
    for side in Side:
        analysis = with_more(analysis, side, "stance_percent", more)
    facts = Facts(AnalysedVisit(demo.visit.session, analysis), walk_of(analysis))
    reported = [*findings(facts, None), headline_of(facts).first]
    assert any("tance, " in one and "2\u00a0SD" in one and "(60.3 ± 3.2" in one for one in reported) is is_a_sentence
    table: Any = time_distance_table(facts)[0]
    rows = [[cell["said"] for cell in row["cells"]] for row in table["rows"]]
    found = {row[0]: row[-1].replace("\u00a0", " ") for row in rows}
    assert found["Stance (% gait cycle)"] == words


def test_stance_of_a_foot_that_rolls_on_is_reported_in_no_sentence(demo: ReportRequest) -> None:
    analysis = with_more(demo.visit.analysis, Side.LEFT, "stance_percent", 8.0)
    gait = walk_of(analysis).gait
    assert any("Stance" in sentence for sentence in stated(demo, analysis))
    rolls_on = replace(gait[Side.LEFT], is_toe_off_biased=True)
    biased = rewalked(analysis, gait={**gait, Side.LEFT: rolls_on})
    assert not any("Stance, " in sentence for sentence in stated(demo, biased))


def test_a_zero_in_another_posture_changes_no_sentence_up_to_seven_degrees(demo: ReportRequest) -> None:
    analysis = demo.visit.analysis
    usual = stated(demo)
    for joint, by_deg in ((Joint.LEFT_KNEE, 7.0), (Joint.RIGHT_ANKLE, -3.0), (Joint.LEFT_ANKLE, 7.0)):
        assert stated(demo, raised(analysis, joint, by_deg)) == usual, joint


def test_a_curve_that_lies_ten_degrees_off_sends_to_the_zero_first(demo: ReportRequest) -> None:
    analysis = demo.visit.analysis
    reported = stated(demo, raised(analysis, Joint.RIGHT_ANKLE, 20.0))
    assert any(
        one.startswith("Right ankle: the whole curve is +1")
        and one.endswith("° from the reference. Check the standing reference first.")
        for one in reported
    )
    assert not any("the whole curve is" in one for one in stated(demo))
    unset = recalibrated(raised(analysis, Joint.RIGHT_ANKLE, 20.0), zero=ZeroKind.NONE)
    assert not any("the whole curve is" in one for one in stated(demo, unset))


@pytest.mark.parametrize(("more_deg", "is_reported"), [(-4.0, False), (-14.0, True)])
def test_a_peak_beyond_two_sd_of_the_band_at_the_curves_height(
    demo: ReportRequest, more_deg: float, is_reported: bool
) -> None:
    analysis = with_more(demo.visit.analysis, Side.LEFT, "knee_swing_peak_rad", more_deg)
    reported = [one for one in stated(demo, analysis) if "Left knee peak flexion, swing" in one]
    assert bool(reported) is is_reported
    if is_reported:
        assert "more than 2 SD below the reference [1] (" in reported[0]
        assert reported[0].endswith("° at the curve's level).")
    assert not any("reference [" in sentence for sentence in stated(of_a_child(demo, analysis)))


def test_what_is_not_reported_is_reported_in_the_caveat_alone(demo: ReportRequest) -> None:
    shortened = with_more(demo.visit.analysis, Side.LEFT, "knee_range_rad", -20.0)
    analysis = recalibrated(shortened, [Joint.LEFT_KNEE], is_same_joint=False, sign_margin=1.05)
    sentences = stated(demo, analysis)
    assert not any("knee has" in sentence for sentence in sentences)
    assert sentences[-1].startswith("Left knee: Sensor positions could not be confirmed (clarity 1.05, required 1.50).")
    assert not any("could not be confirmed" in sentence for sentence in stated(demo, shortened))


def test_of_too_few_strides_nothing_is_reported(demo: ReportRequest) -> None:
    shortened = with_more(demo.visit.analysis, Side.LEFT, "knee_range_rad", -30.0)
    assert any("knee has" in one for one in stated(demo, shortened))
    for count in (2, 9):
        analysis = with_few_strides(shortened, left=count)
        assert not any("knee has" in one for one in stated(demo, analysis)), count


def test_at_most_three_findings_are_reported_one_of_each_joint_and_direction(demo: ReportRequest) -> None:
    analysis = demo.visit.analysis
    for name, more in (
        ("knee_range_rad", -25.0),
        ("knee_swing_peak_rad", -25.0),
        ("knee_loading_peak_rad", 30.0),
        ("ankle_stance_dorsiflexion_rad", -20.0),
        ("stance_percent", 9.0),
        ("step_time_s", 0.3),
    ):
        analysis = with_more(analysis, Side.LEFT, name, more)
    request = replace(demo, visit=AnalysedVisit(demo.visit.session, analysis))
    reported = findings(facts_of(request), None)
    assert len(reported) == MAX_FINDINGS
    topics = [topic for one in printed_findings(facts_of(request), None) for topic in one.topics]
    assert len(set(topics)) == len(topics)
    assert not any("tance" in one and "share" in one for one in reported)  # shapes come first


def test_a_change_between_conditions_is_reported_only_beyond_its_error(aligned: ReportRequest) -> None:
    analysis = aligned.visit.analysis
    usual = stated(aligned)
    assert not any("range of motion in" in sentence for sentence in usual)
    last = analysis.recordings[-1]
    changed = with_more(replace(analysis, recordings=(last,)), Side.LEFT, "knee_range_rad", -25.0).recordings[-1]
    loud = stated(aligned, judged(replace(analysis, recordings=(*analysis.recordings[:-1], changed))))
    assert any(
        "knee has" in one and "range of motion in" in one and "less than in \u2068alignment A\u2069" in one
        for one in loud
    )


def test_speeds_apart_are_the_caveat_where_nothing_is_not_reported(aligned: ReportRequest) -> None:
    assert stated(aligned)[-1].startswith("Speed A: 1.05, B: ")
    alone = replace(aligned, walks=aligned.walks[-1:])
    assert not any(one.startswith("Speed ") for one in stated(alone))
    not_reported = recalibrated(aligned.visit.analysis, [Joint.LEFT_KNEE], is_same_joint=False, sign_margin=1.05)
    assert not any(one.startswith("Speed ") for one in stated(aligned, not_reported))


def test_no_sentence_judges(demo: ReportRequest) -> None:
    analysis = with_more(demo.visit.analysis, Side.LEFT, "knee_range_rad", -25.0)
    words = " ".join([*stated(demo), *stated(demo, analysis)]).lower()
    for word in ("better", "worse", "normal", "significant", "improved", "mostly"):
        assert word not in words


def test_every_quantity_has_its_unit_and_what_is_compared_has_a_name() -> None:
    units = {
        column: unit_and_decimals(column)[0].strip()
        for column in columns_of(ParameterFile.STRIDES, ParameterFile.PEAKS)
    }
    assert units["speed_m_s"] == "m/s"
    assert units["stride_length_m"] == "m"
    assert units["knee_stance_to_swing_deg"] == "°"
    assert set(units.values()) == {"°", "%", "s", "m", "m/s"}
    for column in {*BETWEEN_LEGS, *(measure.column for measure in MEASURES)}:
        assert name_in_sentence(column)


def test_a_range_and_the_movement_that_makes_it_are_reported_once(demo: ReportRequest) -> None:
    analysis = demo.visit.analysis
    both = with_more(
        with_more(analysis, Side.LEFT, "knee_range_rad", -25.0), Side.LEFT, "knee_stance_to_swing_rad", -20.0
    )
    stated = " ".join(lines(demo, both))
    assert "flexes" in stated
    assert "from stance to swing" in stated
    assert "has" not in stated.split()
    alone = " ".join(lines(demo, with_more(analysis, Side.LEFT, "knee_range_rad", -25.0)))
    assert "The left knee has" in alone
    loading = with_more(analysis, Side.LEFT, "knee_while_loading_rad", -20.0)
    assert "in loading response than the right" in " ".join(lines(demo, loading))
    ankle = with_more(analysis, Side.LEFT, "ankle_push_off_rad", -25.0)
    assert "The left ankle plantarflexes 2" in " ".join(lines(demo, ankle))


def lines(request: ReportRequest, analysis: Analysis) -> list[str]:
    return findings(Facts(AnalysedVisit(request.visit.session, analysis), walk_of(analysis)), None)


@pytest.mark.parametrize(
    ("name", "more", "words"),
    [
        ("knee_stance_to_swing_rad", -20.0, "less from stance to swing than the right: "),
        ("knee_stance_to_swing_rad", 20.0, "more from stance to swing than the right: "),
        ("knee_while_loading_rad", -20.0, "less in loading response than the right: "),
        ("knee_while_loading_rad", 20.0, "more in loading response than the right: "),
        ("knee_straightening_rad", -20.0, "less in mid-stance than the right: "),
        ("knee_straightening_rad", 20.0, "more in mid-stance than the right: "),
        ("knee_range_rad", 20.0, "more range of motion than the right: "),
        ("ankle_push_off_rad", -20.0, "less at push-off than the right: "),
        ("ankle_rocker_rad", 20.0, "more in stance than the right: "),
    ],
)
def test_each_measure_and_direction_has_a_sentence_that_comes_beyond_healthy_differences_only(
    demo: ReportRequest, name: str, more: float, words: str
) -> None:
    analysis = demo.visit.analysis
    reported = lines(demo, with_more(analysis, Side.LEFT, name, more))
    assert sum(words in sentence for sentence in reported) == 1
    within = lines(demo, with_more(analysis, Side.LEFT, name, 0.1 * more))
    assert not any(words in sentence for sentence in within)


def test_an_excursion_of_a_joint_without_a_sign_is_reported_in_no_sentence(demo: ReportRequest) -> None:
    analysis = with_more(demo.visit.analysis, Side.LEFT, "knee_stance_to_swing_rad", -20.0)
    unsure = recalibrated(analysis, [Joint.LEFT_KNEE], is_sign_certain=False, clinical_sign_margin=0.1)
    assert any("from stance to swing" in one for one in lines(demo, analysis))
    assert not any("from stance to swing" in one for one in lines(demo, unsure))


@pytest.mark.parametrize(("more_s", "word"), [(-0.2, "s less than"), (0.2, "s more than"), (0.01, "")])
def test_step_time_beyond_its_error_is_stated_where_no_finding_is(
    demo: ReportRequest, more_s: float, word: str
) -> None:
    """No healthy people's limit is known of it, so it is no finding; 1.96 sqrt(2) 0.018 s is 0.05 s."""
    analysis = with_more(demo.visit.analysis, Side.LEFT, "step_time_s", more_s)
    assert lines(demo, analysis) == []
    first, *_ = stated(demo, analysis)
    assert first.startswith("Left step time is ") is bool(word)
    assert word in first
    assert "healthy" not in first
    assert ("Difference likely between 0." in first) is bool(word)


def candidate(**changes: Any) -> Candidate:
    found = Candidate(Rank.SHAPE, 2.0, ((Joint.LEFT_KNEE, None, False),), "", column="knee_range_deg")
    return replace(found, **changes)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (candidate(since=Since.LAST_VISIT), candidate(since=Since.FIRST_VISIT, is_agreed=True)),
        (candidate(since=Since.FIRST_VISIT), candidate(ratio=9.0)),
        (candidate(is_agreed=True, rank=Rank.DISTANCE), candidate(ratio=9.0)),
        (candidate(), candidate(rank=Rank.TIMING, ratio=9.0)),
        (candidate(), candidate(is_of_other_side=True, ratio=9.0)),
        (candidate(ratio=2.1), candidate()),
        (
            candidate(ratio=2.0, column="knee_stance_to_swing_deg"),
            candidate(ratio=2.04, column="knee_while_loading_deg"),
        ),
    ],
    ids=["last visit", "first visit", "a goal", "a shape", "the affected side", "the larger", "the swing of two alike"],
)
def test_what_is_reported_first(first: Candidate, second: Candidate) -> None:
    assert first.weight < second.weight


def test_of_a_goal_between_the_legs_the_finding_comes_first(demo: ReportRequest) -> None:
    """8 points of stance, a goal, before a knee of 20°, which is a shape and 3 errors large."""
    analysis = with_more(demo.visit.analysis, Side.LEFT, "stance_percent", 8.0)
    analysis = with_more(analysis, Side.LEFT, "knee_range_rad", -20.0)
    request = of_a_child(demo, analysis)
    columns = [one.column for one in printed_findings(facts_of(request), None)]
    assert columns == ["knee_range_deg", "stance_percent"]
    agreed = with_goal_of(request, "2026-11-19")
    assert [one.column for one in printed_findings(facts_of(agreed), None)] == columns[::-1]


def nothing(request: ReportRequest, analysis: Analysis) -> list[str]:
    facts = Facts(AnalysedVisit(request.visit.session, analysis), walk_of(analysis))
    assert printed_findings(facts, None) == []
    found = headline_of(facts)
    return [one.replace("\u00a0", " ").replace("\u2212", "-") for one in (found.first, *found.beside)]


def test_where_nothing_is_found_both_legs_are_stated_with_their_values_and_what_fits(demo: ReportRequest) -> None:
    first, second, *_ = nothing(demo, demo.visit.analysis)
    one = r"\d\d(\.\d)?°"
    assert re.fullmatch(rf"Left and right are similar: knee {one} and {one} from stance to swing\.", first)
    assert re.fullmatch(r"L - R -?\d\.\d°, which may be measurement error: anything from -10° to \+7° fits\.", second)


def test_between_error_and_healthy_people_a_difference_is_stated_and_they_are_named(demo: ReportRequest) -> None:
    """Stance 3.6 points longer: beyond 3.0, and 95 of 100 healthy people differ by less than 4.0."""
    analysis = demo.visit.analysis
    first, second, *_ = nothing(demo, with_more(analysis, Side.LEFT, "stance_percent", 3.6))
    size, healthy = r"3\.[5-7] points", "many healthy people differ as much"
    assert re.fullmatch(rf"Left stance is 6\d\.\d %, {size} more than the right; {healthy}\.", first)
    assert re.fullmatch(r"Difference likely between 0\.\d and 6\.\d % of the gait cycle\.", second)
    assert not any("similar" in one for one in (first, second))
    usual = " ".join(nothing(demo, analysis))
    assert "healthy people" not in usual


def test_what_is_measured_least_surely_is_named_below_where_tables_mark_it(demo: ReportRequest) -> None:
    usual = demo.visit.analysis
    found = nothing(demo, with_more(usual, Side.LEFT, "ankle_toes_lifted_rad", -20.0))
    assert found[0].startswith(SIMILAR)
    (named,) = [one for one in found if "how sensors are attached" in one]
    size, likely = r"[12]\d\.\d°", r"likely between \d+° and \d+°"
    assert re.fullmatch(
        rf"Ankle dorsiflexion, swing differs by {size}, {likely}; it depends most on how sensors are attached\.", named
    )
    assert not any("how sensors are attached" in one for one in nothing(demo, usual))


def test_of_one_leg_its_value_is_stated_and_no_other_leg(request_of_one_leg: ReportRequest) -> None:
    (first, *_) = nothing(request_of_one_leg, request_of_one_leg.visit.analysis)
    assert re.fullmatch(r"Left knee flexes \d\d° from stance to swing\.", first)
    assert "ight" not in first


def test_where_no_angle_is_compared_stance_is_stated(demo: ReportRequest) -> None:
    usual = demo.visit.analysis
    found = nothing(demo, recalibrated(usual, is_same_joint=False, sign_margin=1.05))
    assert re.fullmatch(r"Left and right are similar: stance 6\d\.\d % and 6\d\.\d %\.", found[0])
    assert "stance 6" not in nothing(demo, usual)[0]


@pytest.mark.parametrize(("before_deg", "is_stated"), [(49.0, True), (30.0, False)])
def test_a_change_since_the_last_visit_that_is_no_finding_is_stated_beside_the_headline(
    before_deg: float, is_stated: bool
) -> None:
    """Of 50.5 and 49 degrees the sigmas are hypot(1.2, 2.17) and hypot(1.2, 2.11): 1.5 within 6.8 and chance."""
    walks = [walked(f"walk {k}", knee_deg=deg) for k, deg in enumerate((before_deg, 50.5))]
    seen = tuple(
        CourseVisit(UUID(int=k), datetime.date(2026, 10 + k, 20), course((one, "shoes"))) for k, one in enumerate(walks)
    )
    visit = AnalysedVisit(
        Session(tuple(recordings((walks[1], "shoes"))), started="2026-11-20T10:00:00+00:00"),
        material(walks[1], affected=Side.LEFT),
    )
    facts = Facts(visit, walks[1], course=seen)
    assert ("Since 20 Oct: +2°, within measurement error." in headline_of(facts).beside) is is_stated
    assert bool([one for one in printed_findings(facts, None) if one.since is Since.LAST_VISIT]) is not is_stated


def forged(monkeypatch: pytest.MonkeyPatch, required: str) -> None:
    """Let one column differ by five times its error in every comparison, and no other by anything."""

    def compared(column: str, *_: object, **__: object) -> Difference:
        size = -5.0 if column == required else 0.0
        judgement = Judgement.EXCEEDS_ERROR if size else Judgement.INSIDE_ERROR
        return Difference(size, 1.0, judgement, is_worth_a_sentence=bool(size))

    monkeypatch.setattr(comparison, "compare", compared)


@pytest.mark.parametrize("contrast", [one for one in Contrast if one is not Contrast.SIDES])
@pytest.mark.parametrize("measure", MEASURES, ids=lambda measure: measure.column)
def test_every_compared_column_has_a_sentence_in_every_comparison(
    monkeypatch: pytest.MonkeyPatch, measure: Measure, contrast: Contrast
) -> None:
    forged(monkeypatch, measure.column)
    facts = hip_facts()
    pair = tuple(replace(facts.part, letter=letter, name=letter) for letter in "AB")
    found = Comparison(contrast, pair)
    reported = printed_findings(facts, found)
    has_other_zero = measure.needs_height and contrast is Contrast.VISITS
    assert any(one.column == measure.column and one.stated for one in reported) is not has_other_zero


def test_the_least_certain_measure_makes_no_sentence_between_the_legs(monkeypatch: pytest.MonkeyPatch) -> None:
    (column,) = LEAST_CERTAIN
    forged(monkeypatch, column)
    assert not any(one.column == column for one in printed_findings(hip_facts(), None))


@pytest.mark.parametrize("column", [one for one in BETWEEN_LEGS if one not in LEAST_CERTAIN])
def test_every_other_column_that_is_compared_between_the_legs_has_a_sentence(
    monkeypatch: pytest.MonkeyPatch, column: str
) -> None:
    forged(monkeypatch, column)
    (reported,) = [one for one in printed_findings(hip_facts(), None) if one.column == column]
    assert {"less", "shorter", "lower"} & set(reported.stated.split())


def test_between_the_legs_no_height_is_compared() -> None:
    assert not any(BY_COLUMN[column].rests_on is QuantityClass.HEIGHT for column in BETWEEN_LEGS)


def test_only_a_joint_that_is_the_prosthesis_s_is_named_so(demo: ReportRequest) -> None:
    def names(patient: Patient) -> list[str]:
        visit = AnalysedVisit(replace(demo.visit.session, patient=patient), demo.visit.analysis)
        facts = facts_of(replace(demo, visit=visit))
        columns = ("knee_range_deg", "ankle_range_deg", "stance_percent")
        return [who_of_role(facts, Side.LEFT, column) for column in columns]

    alone = Patient(prosthetic_side="left")
    prosthetic = ["left (prosthetic) knee", "left (prosthetic) ankle", "left (prosthetic)"]
    assert names(alone) == prosthetic
    for level, found in (
        (AmputationLevel.TRANSFEMORAL, prosthetic),
        (AmputationLevel.TRANSTIBIAL, ["left knee", *prosthetic[1:]]),
        (AmputationLevel.PARTIAL_FOOT, ["left knee", "left ankle", prosthetic[2]]),
    ):
        assert names(replace(alone, prostheses={Side.LEFT: Prosthesis(level)})) == found
    both = replace(alone, affected_side="left", prostheses={Side.LEFT: Prosthesis(AmputationLevel.TRANSTIBIAL)})
    assert names(both)[0] == "left (affected) knee"

"""The sentences of page one: each has a case in which it must come, and one in which it must not."""

import datetime
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any
from uuid import UUID

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

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
from app.summary.measures import MEASURES
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
from tests.core.verdicts.built_walk import calibrations

SIMILAR = "Left and right are similar: "
ZERO = "Angles are measured from the patient's standing posture"


def of(request: ReportRequest, analysis: Analysis) -> ReportRequest:
    return replace(request, visit=AnalysedVisit(request.visit.session, analysis))


def of_a_child(request: ReportRequest, analysis: Analysis) -> ReportRequest:
    """Who has no band."""
    session = request.visit.session
    child = replace(session, started="2026-11-20", patient=replace(session.patient, birth_year=2016))
    return replace(request, visit=AnalysedVisit(child, analysis))


def stated(request: ReportRequest, analysis: Analysis | None = None) -> list[str]:
    """The sentences of a report, of another analysis where one is given."""
    request = request if analysis is None else of(request, analysis)
    facts, compared = facts_of(request), comparison_of(request)
    goals = [stated for one in facts.reported_goals if (stated := goal_sentence(one))][:1]
    caveats = [" ".join([*caveat(facts, compared), *goals])]
    sentences = findings(facts, compared) or [f"{headline_of(facts).first} {headline_of(facts).then}"]
    return plain([*sentences, *filter(None, caveats)])


def plain(sentences: list[str]) -> list[str]:
    return [sentence.replace("\u00a0", " ").replace("\u2212", "-") for sentence in sentences]


def findings(facts: Facts, comparison: Comparison | None) -> list[str]:
    return [" ".join(filter(None, (one.stated, one.evidence))) for one in printed_findings(facts, comparison)]


def lines(request: ReportRequest, analysis: Analysis) -> list[str]:
    """The findings alone, compared with nothing."""
    return plain(findings(facts_of(of(request, analysis)), None))


def nothing(request: ReportRequest, analysis: Analysis) -> list[str]:
    """The headline and what is beside it, where there is no finding."""
    facts = facts_of(of(request, analysis))
    assert printed_findings(facts, None) == []
    return plain([headline_of(facts).first, *headline_of(facts).beside])


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


def left(request: ReportRequest, **more: float) -> Analysis:
    """Some parameters of the left leg larger."""
    analysis = request.visit.analysis
    for name, by in more.items():
        analysis = with_more(analysis, Side.LEFT, name, by)
    return analysis


def both_legs(request: ReportRequest, name: str, more: float) -> Analysis:
    return with_more(left(request, **{name: more}), Side.RIGHT, name, more)


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


def unreadable(analysis: Analysis, *joints: Joint) -> Analysis:
    """With some joints that are not reported; none named: all."""
    return recalibrated(analysis, *filter(None, [joints]), is_same_joint=False, sign_margin=1.05)


def test_where_nothing_differs_that_is_stated_and_the_caveat_of_the_zero(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    first, last = stated(demo)
    assert first.startswith(SIMILAR)
    assert last.startswith(ZERO)
    assert [first, last] == snapshot


def test_without_a_standing_zero_its_caveat_is_not_stated(demo: ReportRequest) -> None:
    analysis = recalibrated(demo.visit.analysis, zero=ZeroKind.GONIOMETER)
    assert not any(ZERO in sentence for sentence in stated(demo, analysis))


def test_a_knee_that_moves_less_than_the_other_by_more_than_healthy_people_differ(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    """Of 63 and 41.7° the sigmas are hypot(1.2, 2.71) and hypot(1.2, 1.79), so that 1.96 S is 7.2° and chance."""
    found = {by: stated(demo, left(demo, knee_range_rad=by)) for by in (-3.0, -20.0)}
    assert found == snapshot
    low, high = map(int, re.findall(r"\d+", found[-20.0][0].split(". ")[1]))
    assert (low + high) / 2 == pytest.approx(21.3, abs=0.6)
    assert (high - low) / 2 == pytest.approx(7.3, abs=0.9)
    assert any(SIMILAR in sentence for sentence in found[-3.0])
    assert not any(SIMILAR in sentence for sentence in found[-20.0])


def test_with_the_legs_exchanged_the_sentence_is_mirrored(demo: ReportRequest) -> None:
    for side, words in ((Side.LEFT, "less"), (Side.RIGHT, "more")):
        analysis = with_more(demo.visit.analysis, side, "knee_range_rad", -20.0)
        assert f"° {words} range of motion than the right" in stated(demo, analysis)[0]


def test_an_ankle_between_legs_makes_a_sentence_beyond_what_healthy_people_differ_by(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    """Their ranges differ by up to 6.2°; attachment cannot part two legs by more, so that this is the error as well.

    No dagger: the limit is measured, whatever the ankle's sigma rests on.
    """
    assert {by: lines(demo, left(demo, ankle_range_rad=by)) for by in (-3.0, -20.0)} == snapshot


def test_stance_that_lasts_longer_on_one_leg(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    """Error 1.96 sqrt(2) 1.1 = 3.0 points; 95 of 100 healthy people differ by less than 4.0."""
    found = {by: stated(of_a_child(demo, left(demo, stance_percent=by))) for by in (2.0, 3.6, 6.0)}
    assert found == snapshot
    assert [any("95 of 100 healthy" in one for one in sentences) for sentences in found.values()] == [
        *2 * [False],
        True,
    ]


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


def test_a_goal_lets_no_difference_between_legs_be_a_finding_that_many_healthy_people_have(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    """3.6 points of stance lie between the error, 3.0, and what healthy people differ by, 4.0."""
    request = with_goal_of(of_a_child(demo, left(demo, stance_percent=3.6)), "2026-11-19")
    assert printed_findings(facts_of(request), None) == []
    assert stated(request)[0] == snapshot


def test_a_stride_length_beyond_two_sd_of_its_band(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    assert {by: lines(demo, both_legs(demo, "stride_length_m", by)) for by in (0.0, 0.5)} == snapshot


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
    alike = {
        side: replace(found, parameters={**found.parameters, "stride_length_m": np.full(len(found.strides), 1.9)})
        for side, found in gait.items()
    }
    facts = facts_of(of(demo, rewalked(demo.visit.analysis, gait=alike)))
    first, second = facts.first_and_second
    for order in ((first, second), (second, first)):
        facts.__dict__["sides_with_band"] = OrderedLegs(order)
        reported, *_ = (one for one in findings(facts, None) if one.startswith("Stride length, "))
        assert reported.startswith(f"Stride length, {role(facts, first)}: ")


def test_stance_is_judged_against_a_band_that_holds_our_own_error(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    """60.3 ± 1.1 %, with our 1.1 and 2.8 points 3.2: of a stance of 60.5 % less 5 is 1.5 SD, and less 8 2.4."""
    found = {}
    for more in (-8.0, -5.0, 0.0, 4.0, 8.0):
        facts = facts_of(of(demo, both_legs(demo, "stance_percent", more)))
        reported = plain([*findings(facts, None), headline_of(facts).first])
        table: Any = time_distance_table(facts)[0]
        rows = {row["cells"][0]["said"]: row["cells"][-1]["said"] for row in table["rows"]}
        found[more] = *plain([rows["Stance (% gait cycle)"]]), [one for one in reported if "tance, " in one]
    assert found == snapshot
    assert [more for more, (words, reported) in found.items() if reported] == [-8.0, 8.0]
    assert [more for more, (words, reported) in found.items() if "more than 2 SD" in words] == [-8.0, 8.0]


def test_stance_of_a_foot_that_rolls_on_is_reported_in_no_sentence(demo: ReportRequest) -> None:
    analysis = left(demo, stance_percent=8.0)
    gait = walk_of(analysis).gait
    assert any("Stance" in sentence for sentence in stated(demo, analysis))
    rolls_on = replace(gait[Side.LEFT], is_toe_off_biased=True)
    biased = rewalked(analysis, gait={**gait, Side.LEFT: rolls_on})
    assert not any("Stance, " in sentence for sentence in stated(demo, biased))


def test_a_zero_in_another_posture_changes_no_sentence_up_to_seven_degrees(demo: ReportRequest) -> None:
    usual = stated(demo)
    for joint, by_deg in ((Joint.LEFT_KNEE, 7.0), (Joint.RIGHT_ANKLE, -3.0), (Joint.LEFT_ANKLE, 7.0)):
        assert stated(demo, raised(demo.visit.analysis, joint, by_deg)) == usual, joint


def test_a_curve_that_lies_ten_degrees_off_sends_to_the_zero_first(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    off = raised(demo.visit.analysis, Joint.RIGHT_ANKLE, 20.0)
    unset = recalibrated(off, zero=ZeroKind.NONE)
    cases = {"20 degrees off": off, "as it was": demo.visit.analysis, "off without a zero": unset}
    found = {name: [one for one in stated(demo, case) if "the whole curve is" in one] for name, case in cases.items()}
    assert found == snapshot


def test_a_peak_beyond_two_sd_of_the_band_at_the_curves_height(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    def found(request: ReportRequest) -> list[str]:
        return [one for one in stated(request) if "reference [" in one]

    near, beyond = (left(demo, knee_swing_peak_rad=by) for by in (-4.0, -14.0))
    assert {
        "within": found(of(demo, near)),
        "beyond": found(of(demo, beyond)),
        "of a child": found(of_a_child(demo, beyond)),
    } == snapshot


def test_what_is_not_reported_is_reported_in_the_caveat_alone(demo: ReportRequest) -> None:
    shortened = left(demo, knee_range_rad=-20.0)
    sentences = stated(demo, unreadable(shortened, Joint.LEFT_KNEE))
    assert not any("knee has" in sentence for sentence in sentences)
    assert sentences[-1].startswith("Left knee: Sensor positions could not be confirmed (clarity 1.05, required 1.50).")
    assert not any("could not be confirmed" in sentence for sentence in stated(demo, shortened))


def test_of_too_few_strides_nothing_is_reported(demo: ReportRequest) -> None:
    shortened = left(demo, knee_range_rad=-30.0)
    assert any("knee has" in one for one in stated(demo, shortened))
    for count in (2, 9):
        analysis = with_few_strides(shortened, left=count)
        assert not any("knee has" in one for one in stated(demo, analysis)), count


def test_at_most_three_findings_are_reported_one_of_each_joint_and_direction(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    """Shapes come first."""
    analysis = left(
        demo,
        knee_range_rad=-25.0,
        knee_swing_peak_rad=-25.0,
        knee_loading_peak_rad=30.0,
        ankle_stance_dorsiflexion_rad=-20.0,
        stance_percent=9.0,
        step_time_s=0.3,
    )
    reported = printed_findings(facts_of(of(demo, analysis)), None)
    topics = [topic for one in reported for topic in one.topics]
    assert len(set(topics)) == len(topics)
    assert len(reported) == MAX_FINDINGS
    assert [one.stated for one in reported] == snapshot


def test_a_change_between_conditions_is_reported_only_beyond_its_error(
    aligned: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    analysis = aligned.visit.analysis
    last = replace(analysis, recordings=analysis.recordings[-1:])
    changed = with_more(last, Side.LEFT, "knee_range_rad", -25.0).recordings
    loud = judged(replace(analysis, recordings=(*analysis.recordings[:-1], *changed)))
    assert {"as they were": stated(aligned), "C 25 degrees less than A": stated(aligned, loud)} == snapshot
    assert not any("range of motion in" in sentence for sentence in stated(aligned))


def test_speeds_apart_are_the_caveat_where_nothing_is_not_reported(aligned: ReportRequest) -> None:
    assert stated(aligned)[-1].startswith("Speed A: 1.05, B: ")
    alone = replace(aligned, walks=aligned.walks[-1:])
    assert not any(one.startswith("Speed ") for one in stated(alone))
    not_reported = unreadable(aligned.visit.analysis, Joint.LEFT_KNEE)
    assert not any(one.startswith("Speed ") for one in stated(aligned, not_reported))


def test_no_sentence_judges(demo: ReportRequest) -> None:
    words = " ".join([*stated(demo), *stated(demo, left(demo, knee_range_rad=-25.0))]).lower()
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


def test_a_range_and_the_movement_that_makes_it_are_reported_once(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    both = lines(demo, left(demo, knee_range_rad=-25.0, knee_stance_to_swing_rad=-20.0))
    assert "has" not in " ".join(both).split()
    assert {"both": both, "the range alone": lines(demo, left(demo, knee_range_rad=-25.0))} == snapshot


def test_each_measure_and_direction_has_a_sentence_that_comes_beyond_healthy_differences_only(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    cases = (
        *((name, more) for name in ("stance_to_swing", "while_loading", "straightening") for more in (-20.0, 20.0)),
        ("range", 20.0),
    )
    measures = [(f"knee_{name}_rad", more) for name, more in cases]
    measures += [("ankle_push_off_rad", -20.0), ("ankle_push_off_rad", -25.0), ("ankle_rocker_rad", 20.0)]
    found = {f"{name} {more:+}": lines(demo, left(demo, **{name: more})) for name, more in measures}
    assert found == snapshot
    assert all(len(reported) == 1 for reported in found.values())
    for name, more in measures:
        assert lines(demo, left(demo, **{name: 0.1 * more})) == []


def test_an_excursion_of_a_joint_without_a_sign_is_reported_in_no_sentence(demo: ReportRequest) -> None:
    analysis = left(demo, knee_stance_to_swing_rad=-20.0)
    unsure = recalibrated(analysis, [Joint.LEFT_KNEE], is_sign_certain=False, clinical_sign_margin=0.1)
    assert any("from stance to swing" in one for one in lines(demo, analysis))
    assert not any("from stance to swing" in one for one in lines(demo, unsure))


def test_step_time_beyond_its_error_is_stated_where_no_finding_is(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    """No healthy people's limit is known of it, so it is no finding; 1.96 sqrt(2) 0.018 s is 0.05 s."""
    found = {by: nothing(demo, left(demo, step_time_s=by)) for by in (-0.2, 0.2, 0.01)}
    assert found == snapshot
    assert not any("healthy" in sentence for sentences in found.values() for sentence in sentences)


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
    request = of_a_child(demo, left(demo, stance_percent=8.0, knee_range_rad=-20.0))
    columns = [one.column for one in printed_findings(facts_of(request), None)]
    assert columns == ["knee_range_deg", "stance_percent"]
    agreed = with_goal_of(request, "2026-11-19")
    assert [one.column for one in printed_findings(facts_of(agreed), None)] == columns[::-1]


def test_where_nothing_is_found_the_legs_are_stated_with_their_values_and_what_fits(
    demo: ReportRequest, request_of_one_leg: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    """Stance 3.6 points longer lies beyond 3.0, and 95 of 100 healthy people differ by less than 4.0."""
    found = {
        "as it was": nothing(demo, demo.visit.analysis),
        "beyond error, as many healthy people": nothing(demo, left(demo, stance_percent=3.6)),
        "the least certain measure, below where tables mark it": nothing(demo, left(demo, ankle_toes_lifted_rad=-20.0)),
        "one leg": nothing(request_of_one_leg, request_of_one_leg.visit.analysis),
        "no angle is reported": nothing(demo, unreadable(demo.visit.analysis)),
    }
    assert found == snapshot
    usual, between = (" ".join(found[name]) for name in ("as it was", "beyond error, as many healthy people"))
    for words in ("healthy people", "how sensors are attached", "stance 6"):
        assert words not in usual
    assert "similar" not in between
    assert "ight" not in found["one leg"][0]


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
def test_every_compared_column_has_a_sentence_in_every_comparison(
    monkeypatch: pytest.MonkeyPatch, hips: Facts, contrast: Contrast, snapshot: SnapshotAssertion
) -> None:
    """But none of a height between visits, which have another zero."""
    pair = tuple(replace(hips.part, letter=letter, name=letter) for letter in "AB")
    found = {}
    for measure in MEASURES:
        forged(monkeypatch, measure.column)
        reported = printed_findings(hips, Comparison(contrast, pair))
        found[measure.column] = [one.stated for one in reported if one.column == measure.column and one.stated]
        assert bool(found[measure.column]) is not (measure.needs_height and contrast is Contrast.VISITS)
    assert found == snapshot


def test_every_column_that_is_compared_between_the_legs_has_a_sentence_but_the_least_certain(
    monkeypatch: pytest.MonkeyPatch, hips: Facts, snapshot: SnapshotAssertion
) -> None:
    found = {}
    for column in BETWEEN_LEGS:
        forged(monkeypatch, column)
        found[column] = [one.stated for one in printed_findings(hips, None) if one.column == column]
    assert found == snapshot
    assert {column: len(reported) for column, reported in found.items()} == {
        column: int(column not in LEAST_CERTAIN) for column in BETWEEN_LEGS
    }


def test_between_the_legs_no_height_is_compared() -> None:
    assert not any(BY_COLUMN[column].rests_on is QuantityClass.HEIGHT for column in BETWEEN_LEGS)


def test_only_a_joint_that_is_the_prosthesis_s_is_named_so(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    def names(patient: Patient) -> list[str]:
        visit = AnalysedVisit(replace(demo.visit.session, patient=patient), demo.visit.analysis)
        facts = facts_of(replace(demo, visit=visit))
        return [
            who_of_role(facts, Side.LEFT, column) for column in ("knee_range_deg", "ankle_range_deg", "stance_percent")
        ]

    alone = Patient(prosthetic_side="left")
    levels = (AmputationLevel.TRANSFEMORAL, AmputationLevel.TRANSTIBIAL, AmputationLevel.PARTIAL_FOOT)
    worn = {level.name: replace(alone, prostheses={Side.LEFT: Prosthesis(level)}) for level in levels}
    cases = {"alone": alone, **worn, "TRANSTIBIAL, affected": replace(worn["TRANSTIBIAL"], affected_side="left")}
    assert {name: names(patient) for name, patient in cases.items()} == snapshot

"""The sentences of page one: each has a case in which it must come, and one in which it must not."""

import datetime
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.reports.patient.comparison_page import comparison_of
from app.reports.patient.document import facts_of
from app.reports.patient.first_page import answer
from app.reports.patient.time_page import time_distance_table
from app.results.beside_words import answer_beside
from app.summary import comparison
from app.summary.answer import Outcome, answer_of
from app.summary.comparison import Comparison, Contrast
from app.summary.facts import Facts
from app.summary.measure_sentences import unit_and_decimals
from app.summary.measures import MEASURES, Measure
from app.summary.numbers_in_words import NOTHING
from app.summary.request import AnalysedVisit, ReportRequest
from app.summary.what_stands_out import MAX_FINDINGS, printed_findings
from app.wording.measures import name_in_sentence
from core.body import Joint, Side
from core.goals import Goal, GoalOf
from core.parameters import BETWEEN_LEGS, BY_COLUMN, ParameterFile, QuantityClass, columns_of
from core.results import Analysis, ZeroKind
from core.verdicts.gates import judged
from core.verdicts.measurement_error import Difference, Judgement
from tests.app.changed_analysis import recalibrated, rewalked, walk_of, with_few_strides
from tests.app.hip_visits import hip_facts

NO_DIFFERENCE = "All judged differences are within measurement error."
ALL_INSIDE = "All judged peaks are within 2 SD of the reference"
SIMILAR = "Left and right are similar: "
ZERO = "Angles start from the patient's standing posture"


def stated(request: ReportRequest, analysis: Analysis | None = None) -> list[str]:
    """The sentences of a report, of another analysis where one is given."""
    if analysis is not None:
        request = replace(request, visit=AnalysedVisit(request.visit.session, analysis))
    reported = answer(facts_of(request), comparison_of(request))
    numbered, caveats = reported["sentences"], reported["caveats"]
    assert isinstance(numbered, list)
    assert isinstance(caveats, list)
    sentences = [" ".join(filter(None, words)) for _, *words in numbered] + caveats
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


def test_where_nothing_differs_that_is_stated_and_the_caveat_of_the_zero(
    request_of_demonstration: ReportRequest,
) -> None:
    first, last = stated(request_of_demonstration)
    assert first.startswith(SIMILAR)
    assert "° and " in first
    assert f"{NO_DIFFERENCE} {ALL_INSIDE}" in first
    assert last.startswith(ZERO)


def test_without_a_standing_zero_its_caveat_is_not_stated(request_of_demonstration: ReportRequest) -> None:
    analysis = recalibrated(request_of_demonstration.visit.analysis, zero=ZeroKind.GONIOMETER)
    assert not any(ZERO in sentence for sentence in stated(request_of_demonstration, analysis))


@pytest.mark.parametrize(("more_deg", "is_reported"), [(-3.0, False), (-20.0, True)])
def test_a_knee_that_moves_less_than_the_other_by_more_than_its_error(
    request_of_demonstration: ReportRequest, more_deg: float, is_reported: bool
) -> None:
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "knee_range_rad", more_deg)
    reported = [
        sentence for sentence in stated(request_of_demonstration, analysis) if "range of motion than" in sentence
    ]
    assert bool(reported) is is_reported
    if is_reported:
        first, second = reported[0].split(". ")
        assert first == "The left knee has 21.3° less range of motion than the right: 41.7° against 63.0°"
        assert second.startswith("Measurement error between the legs: 9.")
    assert any(NO_DIFFERENCE in sentence for sentence in stated(request_of_demonstration, analysis)) is not is_reported


def test_with_the_legs_exchanged_the_sentence_is_mirrored(request_of_demonstration: ReportRequest) -> None:
    for side, words in ((Side.LEFT, "less"), (Side.RIGHT, "more")):
        analysis = with_more(request_of_demonstration.visit.analysis, side, "knee_range_rad", -20.0)
        assert f"° {words} range of motion than the right" in stated(request_of_demonstration, analysis)[0]


def test_an_ankle_between_legs_is_in_the_table_and_in_no_sentence(request_of_demonstration: ReportRequest) -> None:
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "ankle_range_rad", -20.0)
    sentences = stated(request_of_demonstration, analysis)
    assert not any("nkle range" in sentence for sentence in sentences)
    assert not any(NO_DIFFERENCE in sentence for sentence in sentences)  # it would be untrue
    assert "The tables mark every difference beyond error." in sentences[0]


@pytest.mark.parametrize(("more", "is_reported"), [(2.0, False), (6.0, True)])
def test_stance_that_lasts_longer_on_one_leg(
    request_of_demonstration: ReportRequest, more: float, is_reported: bool
) -> None:
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "stance_percent", more)
    request = of_a_child(request_of_demonstration, analysis)  # who has no band
    reported = [one for one in stated(request) if one.startswith("Stance is ")]
    assert bool(reported) is is_reported


def with_goal_of(request: ReportRequest, day: str, of: GoalOf = GoalOf.BETWEEN) -> ReportRequest:
    """With a goal of stance that was agreed on a day."""
    session = request.visit.session
    goal = Goal("stance_percent", of, 60.0, datetime.date.fromisoformat(day), is_at_most=True)
    reported = replace(session, patient=replace(session.patient, goals=(goal,)))
    return replace(request, visit=AnalysedVisit(reported, request.visit.analysis))


def test_a_measure_chosen_before_the_walk_is_reported_from_one_error_on_and_never_one_chosen_after(
    request_of_demonstration: ReportRequest,
) -> None:
    """3.2 points of stance lie between the error, 2.6, and what a sentence needs otherwise, 3.9."""
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "stance_percent", 3.2)
    request = of_a_child(request_of_demonstration, analysis)  # who has no band; measured on 20 November
    less = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "stance_percent", 2.0)

    def is_reported(one: ReportRequest) -> bool:
        return any(sentence.startswith("Stance is ") for sentence in stated(one))

    assert not is_reported(request)
    assert is_reported(with_goal_of(request, "2026-11-19"))
    assert is_reported(with_goal_of(request, "2026-11-19", GoalOf.LEFT))
    assert not is_reported(with_goal_of(request, "2026-11-20"))
    assert not is_reported(with_goal_of(request, "2026-11-21"))
    assert not is_reported(with_goal_of(of_a_child(request_of_demonstration, less), "2026-11-19"))


@pytest.mark.parametrize(("more_m", "is_reported"), [(0.0, False), (0.5, True)])
def test_a_stride_length_beyond_two_sd_of_its_band(
    request_of_demonstration: ReportRequest, more_m: float, is_reported: bool
) -> None:
    analysis = request_of_demonstration.visit.analysis
    for side in Side:
        analysis = with_more(analysis, side, "stride_length_m", more_m)
    reported = [one for one in stated(request_of_demonstration, analysis) if one.startswith("Stride length, ")]
    assert bool(reported) is is_reported
    if is_reported:
        assert "reference [2]" in reported[0]
        assert reported[0].endswith("more than 2 SD above.")


@pytest.mark.parametrize("more", [-8.0, 4.0, 8.0])
def test_of_stance_no_word_states_how_far_from_the_band_it_lies(
    request_of_demonstration: ReportRequest, more: float
) -> None:
    """Neither on page one, nor on the screen, nor in the table of time and distance, whose other rows have words."""
    analysis = request_of_demonstration.visit.analysis
    for side in Side:
        analysis = with_more(analysis, side, "stance_percent", more)
    facts = Facts(AnalysedVisit(request_of_demonstration.visit.session, analysis), walk_of(analysis))
    reported = [*findings(facts, None), answer_of(facts).first, answer_of(facts).then]
    assert not any("tance" in one and "SD" in one for one in reported)
    table: Any = time_distance_table(facts)[0]
    rows = [[cell["said"] for cell in row["cells"]] for row in table["rows"]]
    words = {row[0]: row[-1] for row in rows}
    assert words["Stance (% gait cycle)"] == NOTHING
    assert "SD" in words["Stride length, m"]


def test_stance_of_a_foot_that_rolls_on_is_reported_in_no_sentence(request_of_demonstration: ReportRequest) -> None:
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "stance_percent", 8.0)
    gait = walk_of(analysis).gait
    assert any("Stance" in sentence for sentence in stated(request_of_demonstration, analysis))
    rolls_on = replace(gait[Side.LEFT], is_toe_off_biased=True)
    biased = rewalked(analysis, gait={**gait, Side.LEFT: rolls_on})
    assert not any("Stance, " in sentence for sentence in stated(request_of_demonstration, biased))


def test_a_zero_in_another_posture_changes_no_sentence_up_to_seven_degrees(
    request_of_demonstration: ReportRequest,
) -> None:
    analysis = request_of_demonstration.visit.analysis
    usual = stated(request_of_demonstration)
    for joint, by_deg in ((Joint.LEFT_KNEE, 7.0), (Joint.RIGHT_ANKLE, -3.0), (Joint.LEFT_ANKLE, 7.0)):
        assert stated(request_of_demonstration, raised(analysis, joint, by_deg)) == usual, joint


def test_a_curve_that_lies_ten_degrees_off_sends_to_the_zero_first(request_of_demonstration: ReportRequest) -> None:
    analysis = request_of_demonstration.visit.analysis
    reported = stated(request_of_demonstration, raised(analysis, Joint.RIGHT_ANKLE, 20.0))
    assert any(
        one.startswith("Right ankle: the whole curve is +1")
        and one.endswith("° from the reference. Check the standing reference first.")
        for one in reported
    )
    assert not any("the whole curve is" in one for one in stated(request_of_demonstration))
    unset = recalibrated(raised(analysis, Joint.RIGHT_ANKLE, 20.0), zero=ZeroKind.NONE)
    assert not any("the whole curve is" in one for one in stated(request_of_demonstration, unset))


@pytest.mark.parametrize(("more_deg", "is_reported"), [(-4.0, False), (-14.0, True)])
def test_a_peak_beyond_two_sd_of_the_band_at_the_curves_height(
    request_of_demonstration: ReportRequest, more_deg: float, is_reported: bool
) -> None:
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "knee_swing_peak_rad", more_deg)
    reported = [one for one in stated(request_of_demonstration, analysis) if "Left knee peak flexion, swing" in one]
    assert bool(reported) is is_reported
    if is_reported:
        assert "reference [1] at the level of the curve" in reported[0]
        assert reported[0].endswith("more than 2 SD below.")
    assert not any("reference [" in sentence for sentence in stated(of_a_child(request_of_demonstration, analysis)))


def test_what_is_not_reported_is_reported_in_the_caveat_alone(request_of_demonstration: ReportRequest) -> None:
    shortened = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "knee_range_rad", -20.0)
    analysis = recalibrated(shortened, [Joint.LEFT_KNEE], is_same_joint=False, sign_margin=1.05)
    sentences = stated(request_of_demonstration, analysis)
    assert not any("knee has" in sentence for sentence in sentences)
    assert sentences[-1].startswith("Left knee: Sensor positions could not be confirmed (margin 1.05, required 1.50).")
    assert not any("could not be confirmed" in sentence for sentence in stated(request_of_demonstration, shortened))


def test_of_too_few_strides_nothing_is_reported(request_of_demonstration: ReportRequest) -> None:
    shortened = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "knee_range_rad", -30.0)
    assert any("knee has" in one for one in stated(request_of_demonstration, shortened))
    for count in (2, 9):
        analysis = with_few_strides(shortened, left=count)
        assert not any("knee has" in one for one in stated(request_of_demonstration, analysis)), count


def test_at_most_three_findings_are_reported_one_of_each_joint_and_direction(
    request_of_demonstration: ReportRequest,
) -> None:
    analysis = request_of_demonstration.visit.analysis
    for name, more in (
        ("knee_range_rad", -25.0),
        ("knee_swing_peak_rad", -25.0),
        ("knee_loading_peak_rad", 30.0),
        ("ankle_stance_dorsiflexion_rad", -20.0),
        ("stance_percent", 9.0),
        ("step_time_s", 0.3),
    ):
        analysis = with_more(analysis, Side.LEFT, name, more)
    request = replace(request_of_demonstration, visit=AnalysedVisit(request_of_demonstration.visit.session, analysis))
    reported = findings(facts_of(request), None)
    assert len(reported) == MAX_FINDINGS
    below = [one for one in reported if "knee" in one.lower() and ("below" in one or "difference \u2212" in one)]
    assert len(below) == 1
    assert not any("tance" in one and "share" in one for one in reported)  # shapes come first


def test_a_change_between_conditions_is_reported_only_beyond_its_error(request_of_alignments: ReportRequest) -> None:
    analysis = request_of_alignments.visit.analysis
    usual = stated(request_of_alignments)
    assert not any("range of motion in" in sentence for sentence in usual)
    last = analysis.recordings[-1]
    changed = with_more(replace(analysis, recordings=(last,)), Side.LEFT, "knee_range_rad", -25.0).recordings[-1]
    loud = stated(request_of_alignments, judged(replace(analysis, recordings=(*analysis.recordings[:-1], changed))))
    assert any(
        "knee has" in one and "range of motion in" in one and "less than in \u2068alignment A\u2069" in one
        for one in loud
    )


def test_speeds_apart_are_the_caveat_where_nothing_is_not_reported(request_of_alignments: ReportRequest) -> None:
    assert stated(request_of_alignments)[-1].startswith("Speed A: 1.05, B: ")
    alone = replace(request_of_alignments, walks=request_of_alignments.walks[-1:])
    assert not any(one.startswith("Speed ") for one in stated(alone))
    not_reported = recalibrated(
        request_of_alignments.visit.analysis, [Joint.LEFT_KNEE], is_same_joint=False, sign_margin=1.05
    )
    assert not any(one.startswith("Speed ") for one in stated(request_of_alignments, not_reported))


def test_no_sentence_judges(request_of_demonstration: ReportRequest) -> None:
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "knee_range_rad", -25.0)
    words = " ".join([*stated(request_of_demonstration), *stated(request_of_demonstration, analysis)]).lower()
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


def test_a_range_and_the_movement_that_makes_it_are_reported_once(request_of_demonstration: ReportRequest) -> None:
    analysis = request_of_demonstration.visit.analysis
    both = with_more(
        with_more(analysis, Side.LEFT, "knee_range_rad", -25.0), Side.LEFT, "knee_stance_to_swing_rad", -20.0
    )
    stated = " ".join(lines(request_of_demonstration, both))
    assert "flexes" in stated
    assert "from stance to swing" in stated
    assert "has" not in stated.split()
    alone = " ".join(lines(request_of_demonstration, with_more(analysis, Side.LEFT, "knee_range_rad", -25.0)))
    assert "The left knee has" in alone
    loading = with_more(analysis, Side.LEFT, "knee_while_loading_rad", -20.0)
    assert "in loading response than the right" in " ".join(lines(request_of_demonstration, loading))
    ankle = with_more(analysis, Side.LEFT, "ankle_push_off_rad", -25.0)
    assert "ankle" not in " ".join(lines(request_of_demonstration, ankle))  # its error is borrowed


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
        ("step_time_s", -0.2, "shorter on the left than on the right: "),
        ("step_time_s", 0.2, "longer on the left than on the right: "),
    ],
)
def test_each_measure_and_direction_has_a_sentence_that_comes_beyond_the_error_only(
    request_of_demonstration: ReportRequest, name: str, more: float, words: str
) -> None:
    analysis = request_of_demonstration.visit.analysis
    reported = lines(request_of_demonstration, with_more(analysis, Side.LEFT, name, more))
    assert sum(words in sentence for sentence in reported) == 1
    within = lines(request_of_demonstration, with_more(analysis, Side.LEFT, name, 0.15 * more))
    assert not any(words in sentence for sentence in within)


def test_an_excursion_of_a_joint_without_a_sign_is_reported_in_no_sentence(
    request_of_demonstration: ReportRequest,
) -> None:
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "knee_stance_to_swing_rad", -20.0)
    unsure = recalibrated(analysis, [Joint.LEFT_KNEE], is_sign_certain=False, clinical_sign_margin=0.1)
    assert any("from stance to swing" in one for one in lines(request_of_demonstration, analysis))
    assert not any("from stance to swing" in one for one in lines(request_of_demonstration, unsure))


def test_of_excursions_as_large_against_their_errors_the_swing_is_reported_first(
    request_of_demonstration: ReportRequest,
) -> None:
    analysis = request_of_demonstration.visit.analysis
    for name, more in (("knee_while_loading_rad", 20.0), ("knee_stance_to_swing_rad", -20.0)):
        analysis = with_more(analysis, Side.LEFT, name, more)
    reported = lines(request_of_demonstration, analysis)
    assert "from stance to swing" in reported[0]
    assert "in loading response" in reported[1]


def forged(monkeypatch: pytest.MonkeyPatch, required: str) -> None:
    """Let one column differ by five times its error in every comparison, and no other by anything."""

    def compared(column: str, *_: object, **__: object) -> Difference:
        size = -5.0 if column == required else 0.0
        judgement = Judgement.EXCEEDS_ERROR if size else Judgement.INSIDE_ERROR
        return Difference(size, 1.0, judgement, is_worth_a_sentence=bool(size))

    monkeypatch.setattr(comparison, "compare", compared)


@pytest.mark.parametrize("contrast", [one for one in Contrast if one is not Contrast.SIDES])
@pytest.mark.parametrize("measure", MEASURES, ids=lambda measure: measure.column)
def test_every_compared_column_has_a_sentence_on_paper_and_screen_in_every_comparison(
    monkeypatch: pytest.MonkeyPatch, measure: Measure, contrast: Contrast
) -> None:
    forged(monkeypatch, measure.column)
    facts = hip_facts()
    pair = tuple(replace(facts.part, letter=letter, name=letter) for letter in "AB")
    found = Comparison(contrast, pair)
    reported = printed_findings(facts, found)
    assert answer_beside(found).outcome is Outcome.DIFFERS
    has_other_zero = measure.needs_height and contrast is Contrast.VISITS
    assert any(one.column == measure.column and one.stated for one in reported) is not has_other_zero


@pytest.mark.parametrize("column", BETWEEN_LEGS)
def test_every_column_that_is_compared_between_the_legs_has_a_sentence(
    monkeypatch: pytest.MonkeyPatch, column: str
) -> None:
    forged(monkeypatch, column)
    (reported,) = [one for one in printed_findings(hip_facts(), None) if one.column == column]
    assert {"less", "shorter", "lower"} & set(reported.stated.split())


def test_between_the_legs_no_height_is_compared() -> None:
    assert not any(BY_COLUMN[column].rests_on is QuantityClass.HEIGHT for column in BETWEEN_LEGS)

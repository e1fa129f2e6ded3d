"""What can be read of a walk, in words: each sentence has a walk in which it must come and one in which it must not."""

from dataclasses import replace

import numpy as np
import pytest

from app.results.summary_text import door_words
from app.summary.data_quality import DataQuality, data_quality, quality_without_walk
from app.summary.facts import Facts
from app.summary.quality_line import quality_sentence
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import LEG_JOINTS, Joint, Side
from core.findings import Finding, Severity
from core.results import Analysis, ZeroKind
from core.verdicts.model import Assessment, GateReason, Verdict
from tests.app.changed_analysis import recalibrated, walk_of, with_few_strides


@pytest.fixture
def visit(demo: ReportRequest) -> AnalysedVisit:
    return demo.visit


def facts(visit: AnalysedVisit, analysis: Analysis) -> Facts:
    return Facts(replace(visit, analysis=analysis), walk_of(analysis))


def quality_of(visit: AnalysedVisit, analysis: Analysis) -> DataQuality:
    return data_quality(facts(visit, analysis))


def test_where_all_can_be_read_nothing_is_against_it(visit: AnalysedVisit) -> None:
    found = quality_of(visit, visit.analysis)
    assert found.first == "All four joints are reported."
    assert found.lines == ()
    assert "no strap moved" in found.in_order
    line = door_words(found, quality_sentence(facts(visit, visit.analysis), found))
    assert line.first == "Data quality: good."
    assert not line.is_caution


def test_a_not_reported_joint_comes_first_with_why_what_to_do_and_whose_motion_mends_it(visit: AnalysedVisit) -> None:
    slanted = recalibrated(visit.analysis, [Joint.RIGHT_KNEE], axis_sd_rad=np.deg2rad(8.0))
    gated = recalibrated(slanted, [Joint.LEFT_ANKLE], axis_sd_rad=np.deg2rad(11.0))
    found = quality_of(visit, gated)
    assert found.first == "2 of 4 joints: Good. Caution: right knee. Not reported: left ankle."
    first, second, *_ = found.lines
    assert (first.where, first.verdict, first.side) == ("Left ankle", Verdict.NOT_REPORTED, Side.LEFT)
    assert first.why == "The calibration has an uncertainty of ±11.0° (limit ±9.0°)."
    assert first.to_do.startswith("Record free motion")
    assert (second.where, second.verdict, second.side) == ("Right knee", Verdict.CARE, Side.RIGHT)
    door = door_words(found, quality_sentence(facts(visit, gated), found))
    assert door.first == "Left ankle: not reported."
    assert door.then == f"{first.why} And {len(found.lines) - 1} more."
    assert door.is_caution


@pytest.mark.parametrize(
    ("care", "out", "words"),
    [
        ((), (), "All four joints are reported."),
        (LEG_JOINTS, (), "All joints: Caution."),
        ((Joint.LEFT_KNEE,), (), "3 of 4 joints: Good. Caution: left knee."),
        (
            (Joint.LEFT_KNEE, Joint.RIGHT_KNEE),
            (Joint.LEFT_ANKLE, Joint.RIGHT_ANKLE),
            "Caution: left knee and right knee. Not reported: left ankle and right ankle.",
        ),
        ((), (Joint.LEFT_ANKLE,), "3 of 4 joints: Good. Not reported: left ankle."),
        ((), LEG_JOINTS, "No joint is reported for this walk."),
    ],
)
def test_what_is_stated_of_the_joints_follows_their_verdicts(
    visit: AnalysedVisit, care: tuple[Joint, ...], out: tuple[Joint, ...], words: str
) -> None:
    found = recalibrated(visit.analysis, care, axis_sd_rad=np.deg2rad(8.0)) if care else visit.analysis
    found = recalibrated(found, out, axis_sd_rad=np.deg2rad(11.0)) if out else found
    assert quality_of(visit, found).first == words


def test_without_a_zero_the_shape_is_read_and_the_heights_are_not(visit: AnalysedVisit) -> None:
    found = quality_of(visit, recalibrated(visit.analysis, zero=ZeroKind.NONE))
    assert (found.first, found.then) == (
        "All four joints are reported.",
        "Range of motion and curve shape are valid. Absolute angles are not reported.",
    )


def test_legs_whose_clocks_are_not_known_to_agree_can_each_be_read(visit: AnalysedVisit) -> None:
    walk = walk_of(visit.analysis)
    between = Assessment(Verdict.NOT_REPORTED, (GateReason("clocks", Verdict.NOT_REPORTED),))
    apart = replace(walk, verdicts=replace(walk.verdicts, between=between))
    recordings = tuple(apart if one is walk else one for one in visit.analysis.recordings)
    found = data_quality(Facts(replace(visit, analysis=replace(visit.analysis, recordings=recordings)), apart))
    (line,) = found.lines
    assert line.where == "Timing between the legs"
    assert found.first == "All four joints are reported."
    assert "left and right sensors synchronised" not in found.in_order


def test_too_few_strides_withhold_a_leg(visit: AnalysedVisit) -> None:
    found = quality_of(visit, with_few_strides(visit.analysis, left=2))
    assert found.lines[0].where == "Left leg"
    assert found.lines[0].why == "Few strides (2 used, 3 required)."
    assert "2 of 4 joints: Good." in found.first


def test_what_was_noticed_is_stated_where_no_verdict_states_it_already(visit: AnalysedVisit) -> None:
    silent = Finding(
        "gaps", Severity.WARNING, "walk 1, right_foot", {"missing_percent": 2.0, "gaps": 1, "longest_s": 3.1}
    )
    slanted = Finding("axis_uncertain", Severity.WARNING, "left_ankle", {"axis_sd_deg": 11.0})
    elsewhere = replace(silent, where="free motion, right_foot")
    gated = recalibrated(visit.analysis, [Joint.LEFT_ANKLE], axis_sd_rad=np.deg2rad(11.0))
    noticed = replace(gated, findings=(*gated.findings, silent, slanted, elsewhere))
    found = quality_of(visit, noticed)
    stated = [f"{line.where}: {line.why}" for line in found.lines]
    assert len([text for text in stated if "R foot" in text]) == 1
    assert len([text for text in stated if "11.0°" in text]) == 1
    assert all(line.verdict is not Verdict.NOT_REPORTED or "ankle" in line.where for line in found.lines)


def test_of_what_is_no_walk_only_what_was_noticed_is_stated(visit: AnalysedVisit) -> None:
    assert quality_without_walk(visit, "free motion").first == "No data quality findings."
    grave = Finding("no_joint", Severity.GRAVE, "")
    noticed = replace(visit, analysis=replace(visit.analysis, findings=(grave,)))
    found = quality_without_walk(noticed, "free motion")
    assert found.first == "There are data quality findings."
    assert found.lines[0].why == "No joint angle could be computed."

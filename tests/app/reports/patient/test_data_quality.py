"""What can be read of a walk, in words: each sentence has a walk in which it must come and one in which it must not."""

from dataclasses import replace

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from app.results.summary_text import door_words
from app.summary.data_quality import DataQuality, data_quality, quality_without_walk
from app.summary.facts import Facts
from app.summary.quality_line import quality_sentence
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import LEG_JOINTS, Joint
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


def gated(analysis: Analysis, care: tuple[Joint, ...] = (), out: tuple[Joint, ...] = ()) -> Analysis:
    """With some joints that can be read with care, and some that are not reported."""
    found = recalibrated(analysis, care, axis_sd_rad=np.deg2rad(8.0)) if care else analysis
    return recalibrated(found, out, axis_sd_rad=np.deg2rad(11.0)) if out else found


def test_what_is_not_good_comes_with_why_what_to_do_and_whose_motion_mends_it(
    visit: AnalysedVisit, snapshot: SnapshotAssertion
) -> None:
    """What is not reported comes first; where all can be read, nothing is against it."""
    both = gated(visit.analysis, (Joint.RIGHT_KNEE,), (Joint.LEFT_ANKLE,))
    cases = {"good": visit.analysis, "two joints": both, "few strides": with_few_strides(visit.analysis, left=2)}
    found = {name: quality_of(visit, one) for name, one in cases.items()}
    doors = {name: door_words(one, quality_sentence(facts(visit, cases[name]), one)) for name, one in found.items()}
    assert {
        name: (one.first, one.in_order, one.lines, (doors[name].first, doors[name].then, doors[name].is_caution))
        for name, one in found.items()
    } == snapshot


def test_what_is_stated_of_the_joints_follows_their_verdicts(visit: AnalysedVisit, snapshot: SnapshotAssertion) -> None:
    knees, ankles = (Joint.LEFT_KNEE, Joint.RIGHT_KNEE), (Joint.LEFT_ANKLE, Joint.RIGHT_ANKLE)
    cases = {
        "all good": visit.analysis,
        "all with care": gated(visit.analysis, LEG_JOINTS),
        "one with care": gated(visit.analysis, knees[:1]),
        "knees with care, ankles out": gated(visit.analysis, knees, ankles),
        "one out": gated(visit.analysis, out=ankles[:1]),
        "all out": gated(visit.analysis, out=LEG_JOINTS),
        "no zero: shapes, no heights": recalibrated(visit.analysis, zero=ZeroKind.NONE),
    }
    found = {name: quality_of(visit, one) for name, one in cases.items()}
    assert {name: (one.first, one.then) for name, one in found.items()} == snapshot


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


def test_what_was_noticed_is_stated_where_no_verdict_states_it_already(visit: AnalysedVisit) -> None:
    silent = Finding(
        "gaps", Severity.WARNING, "walk 1, right_foot", {"missing_percent": 2.0, "gaps": 1, "longest_s": 3.1}
    )
    slanted = Finding("axis_uncertain", Severity.WARNING, "left_ankle", {"axis_sd_deg": 11.0})
    elsewhere = replace(silent, where="free motion, right_foot")
    out = gated(visit.analysis, out=(Joint.LEFT_ANKLE,))
    noticed = replace(out, findings=(*out.findings, silent, slanted, elsewhere))
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

"""What is marked on a walk's curves: only what a sentence may report, and only gaps that no height explains."""

from dataclasses import replace

import numpy as np
import pytest

from app.summary.facts import Facts
from app.summary.headline import headline_of
from app.summary.marks_on_curves import bracket_of, gaps_of, labels_of
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import LEG_JOINTS, Joint, JointKind, Side
from core.results import Analysis, ZeroKind
from core.samples import FloatArray
from tests.app.changed_analysis import recalibrated, rewalked, visit_of, walk_of
from tests.app.reports.patient.test_what_stands_out import with_more
from tests.app.results.test_result_page import GROWN, at_speed


@pytest.fixture
def analysis(demo: ReportRequest) -> Analysis:
    return demo.visit.analysis


def facts(request: ReportRequest, analysis: Analysis) -> Facts:
    visit: AnalysedVisit = visit_of(analysis, request.visit.session, GROWN)
    return Facts(visit, walk_of(analysis))


def moved(analysis: Analysis, joint: Joint, by_rad: FloatArray | float) -> Analysis:
    """With every stride of a joint raised by (101,) or by one height."""
    gait = dict(walk_of(analysis).gait)
    found = gait[joint.side]
    gait[joint.side] = replace(found, cycles={**found.cycles, joint: found.cycles[joint] + by_rad})
    return rewalked(analysis, gait=gait)


def test_peaks_have_the_values_of_the_tables_and_lie_on_their_curves(demo: ReportRequest, analysis: Analysis) -> None:
    found = facts(demo, analysis)
    labels = {kind: labels_of(found, kind) for kind in (JointKind.KNEE, JointKind.ANKLE)}
    assert [len(labels[kind]) for kind in labels] == [2, 4]
    for label in labels[JointKind.KNEE]:
        value = found.value(label.side, "knee_swing_peak_deg").mean
        assert label.text == f"{label.side.letter} {value:.0f}\N{DEGREE SIGN}"
        curve = found.mean_curve_deg(label.side, "knee")
        assert label.point.angle_deg == pytest.approx(curve[int(label.point.percent)])
    gated = recalibrated(analysis, [Joint.LEFT_KNEE], is_same_joint=False, sign_margin=1.05)
    assert [label.side for label in labels_of(facts(demo, gated), JointKind.KNEE)] == [Side.RIGHT]
    assert labels_of(facts(demo, recalibrated(analysis, LEG_JOINTS, zero=ZeroKind.NONE)), JointKind.KNEE) == []


def test_the_headlines_movement_has_a_bracket_with_its_numbers(demo: ReportRequest, analysis: Analysis) -> None:
    found = facts(demo, with_more(analysis, Side.LEFT, "knee_stance_to_swing_rad", -20.0))
    headline = headline_of(found)
    bracket = bracket_of(found, headline)
    assert bracket is not None
    assert bracket.words == "L 41\N{DEGREE SIGN}"
    assert bracket.more == "21\N{DEGREE SIGN} less than R"
    assert all(number in headline.first for number in ("41\N{DEGREE SIGN}", "21\N{DEGREE SIGN}"))
    assert bracket.first.angle_deg < bracket.second.angle_deg
    assert bracket.first.joint is Joint.LEFT_KNEE


def test_similar_legs_and_stance_have_no_bracket(demo: ReportRequest, analysis: Analysis) -> None:
    for changed in (analysis, with_more(analysis, Side.LEFT, "stance_percent", 6.0)):
        found = facts(demo, changed)
        assert bracket_of(found, headline_of(found)) is None


def test_a_bump_leaves_the_band_and_a_height_alone_does_not(demo: ReportRequest, analysis: Analysis) -> None:
    walk = at_speed(analysis, 1.2)
    before = [gap.joint for gap in gaps_of(facts(demo, walk))]
    assert Joint.RIGHT_KNEE not in before
    bump = np.zeros(101)
    bump[25:40] = np.deg2rad(25.0)
    after = gaps_of(facts(demo, moved(walk, Joint.RIGHT_KNEE, bump)))
    (gap,) = [gap for gap in after if gap.joint is Joint.RIGHT_KNEE]
    assert 20 < gap.first_percent < gap.last_percent < 45
    raised = gaps_of(facts(demo, moved(walk, Joint.RIGHT_KNEE, np.deg2rad(25.0))))
    assert [gap for gap in raised if gap.joint is Joint.RIGHT_KNEE] == []

"""What is marked on a walk's curves: only what a sentence may report, and only gaps that no height explains."""

from dataclasses import replace

import numpy as np
import pytest

from app.summary.facts import Facts
from app.summary.marks_on_curves import deviations_of, gaps_of
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import Joint, Side
from core.results import Analysis
from core.samples import FloatArray
from tests.app.changed_analysis import recalibrated, rewalked, visit_of, walk_of
from tests.app.reports.patient.test_what_stands_out import with_more
from tests.app.results.test_result_page import GROWN, at_speed


@pytest.fixture
def analysis(request_of_demonstration: ReportRequest) -> Analysis:
    return request_of_demonstration.visit.analysis


def facts(request: ReportRequest, analysis: Analysis) -> Facts:
    visit: AnalysedVisit = visit_of(analysis, request.visit.session, GROWN)
    return Facts(visit, walk_of(analysis))


def moved(analysis: Analysis, joint: Joint, by_rad: FloatArray | float) -> Analysis:
    """With every stride of a joint raised by (101,) or by one height."""
    gait = dict(walk_of(analysis).gait)
    found = gait[joint.side]
    gait[joint.side] = replace(found, cycles={**found.cycles, joint: found.cycles[joint] + by_rad})
    return rewalked(analysis, gait=gait)


def test_the_range_that_a_sentence_shows_is_marked_between_its_extremes(
    request_of_demonstration: ReportRequest, analysis: Analysis
) -> None:
    assert deviations_of(facts(request_of_demonstration, analysis)) == []
    (mark,) = deviations_of(facts(request_of_demonstration, with_more(analysis, Side.LEFT, "knee_range_rad", -20.0)))
    assert mark.words.startswith("L ")
    assert mark.more.endswith(" less than R")
    assert mark.first.angle_deg < mark.second.angle_deg
    assert mark.is_larger_than_error


def test_what_is_not_reported_is_not_marked(request_of_demonstration: ReportRequest, analysis: Analysis) -> None:
    shortened = with_more(analysis, Side.LEFT, "knee_range_rad", -20.0)
    gated = recalibrated(shortened, [Joint.LEFT_KNEE], is_same_joint=False, sign_margin=1.05)
    assert deviations_of(facts(request_of_demonstration, gated)) == []


def test_a_bump_leaves_the_band_and_a_height_alone_does_not(
    request_of_demonstration: ReportRequest, analysis: Analysis
) -> None:
    walk = at_speed(analysis, 1.2)
    before = [gap.joint for gap in gaps_of(facts(request_of_demonstration, walk))]
    assert Joint.RIGHT_KNEE not in before
    bump = np.zeros(101)
    bump[25:40] = np.deg2rad(25.0)
    after = gaps_of(facts(request_of_demonstration, moved(walk, Joint.RIGHT_KNEE, bump)))
    (gap,) = [gap for gap in after if gap.joint is Joint.RIGHT_KNEE]
    assert 20 < gap.first_percent < gap.last_percent < 45
    raised = gaps_of(facts(request_of_demonstration, moved(walk, Joint.RIGHT_KNEE, np.deg2rad(25.0))))
    assert [gap for gap in raised if gap.joint is Joint.RIGHT_KNEE] == []

"""A measure over visits: what is drawn of it and what is a gap, over which error and to which scale."""

import datetime
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from app.summary.comparison import Compared, Comparison, Contrast
from app.summary.visit_trend import Trend, trend_of
from app.summary.visits import WalkedVisit, visits_by_condition
from core.body import Joint, Side
from core.results import Analysis, ZeroKind
from core.session import Session
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk
from devices.simulation.walker_body import Tissue
from tests.app.changed_analysis import recalibrated, with_few_strides
from tests.simulated import analysis_of, session_of

DAYS = (datetime.date(2026, 5, 1), datetime.date(2026, 5, 11), datetime.date(2026, 6, 10))


@pytest.fixture(scope="module")
def session() -> Session:
    recordings = (Standing(), FreeMotion(), Walk(strides=13))
    return session_of(replace(DEMONSTRATION, tissue=Tissue.RIGID, recordings=recordings))


@pytest.fixture(scope="module")
def analysis(session: Session) -> Analysis:
    return analysis_of(session)


def compared(session: Session, analyses: Sequence[Analysis], *, has_days: bool = True) -> Comparison:
    each = zip(DAYS, analyses, strict=True)
    (visits,) = visits_by_condition(
        [WalkedVisit(str(day), one, session.recordings, day if has_days else None) for day, one in each]
    )
    return Comparison(Contrast.VISITS, visits.parts)


def row_of(found: Comparison, column: str, side: Side = Side.LEFT) -> Compared:
    (row,) = (row for row in found.changes if row.measure.column == column and row.side is side)
    return row


def trend(found: Comparison, column: str, side: Side = Side.LEFT) -> Trend:
    return trend_of(found, row_of(found, column, side))


def test_the_changes_are_those_to_the_latest_visit(session: Session, analysis: Analysis) -> None:
    found = compared(session, (analysis,) * 3)
    assert {row.part.letter for row in found.changes} == {"3"}
    assert {row.part.letter for row in replace(found, base=2).changes} == {"2"}
    chosen = replace(found, kind=Contrast.CHOSEN)
    assert {row.part.letter for row in chosen.changes} == {"2", "3"}
    alone = replace(found, parts=found.parts[:1])
    assert (alone.latest, alone.changes) == (None, ())


def test_values_are_those_of_each_visit_over_the_error_of_the_change(session: Session, analysis: Analysis) -> None:
    found = compared(session, (analysis,) * 3)
    row, shown = row_of(found, "knee_range_deg"), trend(found, "knee_range_deg")
    each = [part.value(Side.LEFT, "knee_range_deg").mean for part in found.parts]
    assert shown.values == pytest.approx(each)
    error = row.difference.error
    assert error == pytest.approx(7.8, abs=0.2)  # 1.96 sqrt(2) hypot(1.2, 0.043 * 58.7) = 7.7, and chance
    assert shown.band == pytest.approx((each[0] - error, each[0] + error))


def test_what_is_inside_the_error_is_not_blown_up(session: Session, analysis: Analysis) -> None:
    found = compared(session, (analysis,) * 3)
    low, high = trend(found, "knee_range_deg").edges
    assert high - low >= 2 * row_of(found, "knee_range_deg").difference.error * (1 - 1e-9)
    few = compared(session, (analysis, analysis, with_few_strides(analysis, left=5)))
    unjudged = trend(few, "knee_range_deg")
    assert unjudged.band is None  # from five strides no error is known, and none is drawn
    assert unjudged.edges[1] - unjudged.edges[0] >= 2 * 7.7 * (1 - 1e-9)


def test_a_visit_without_its_value_is_a_gap(session: Session, analysis: Analysis) -> None:
    gated = recalibrated(analysis, [Joint.LEFT_KNEE], axis_sd_rad=np.deg2rad(11.0))
    found = compared(session, (analysis, gated, analysis))
    assert [math.isfinite(value) for value in trend(found, "knee_range_deg").values] == [True, False, True]
    right = trend(found, "knee_range_deg", Side.RIGHT)
    assert all(map(math.isfinite, right.values))


def test_a_value_of_too_few_strides_is_not_drawn(session: Session, analysis: Analysis) -> None:
    for strides, is_drawn in ((2, False), (3, True)):
        found = compared(session, (analysis, with_few_strides(analysis, left=strides), analysis))
        shown = trend(found, "knee_range_deg").values
        assert [math.isfinite(value) for value in shown] == [True, is_drawn, True]


def test_heights_above_zeros_of_different_kinds_make_no_line(session: Session, analysis: Analysis) -> None:
    other = recalibrated(analysis, [Joint.LEFT_KNEE], zero=ZeroKind.GONIOMETER)
    found = compared(session, (analysis, other, analysis))
    assert not any(map(math.isfinite, trend(found, "knee_swing_peak_deg").values))
    assert all(map(math.isfinite, trend(found, "knee_range_deg").values))  # needs no zero
    same = compared(session, (analysis,) * 3)
    assert all(map(math.isfinite, trend(same, "knee_swing_peak_deg").values))


def test_the_error_lies_about_the_first_visit_that_can_be_read(session: Session, analysis: Analysis) -> None:
    gated = recalibrated(analysis, [Joint.LEFT_KNEE], axis_sd_rad=np.deg2rad(11.0))
    found = compared(session, (gated, analysis, analysis))
    shown = trend(found, "knee_range_deg")
    assert shown.band is not None
    assert sum(shown.band) / 2 == pytest.approx(shown.values[1])
    not_reported = compared(session, (analysis, analysis, gated))
    assert trend(not_reported, "knee_range_deg").band is None


def test_visits_lie_to_the_scale_of_days_where_these_are_known(session: Session, analysis: Analysis) -> None:
    assert trend(compared(session, (analysis,) * 3), "speed_m_s").places == pytest.approx((0.0, 0.25, 1.0))
    unknown = compared(session, (analysis,) * 3, has_days=False)
    assert trend(unknown, "speed_m_s").places == pytest.approx((0.0, 0.5, 1.0))
    twice = replace(unknown, parts=tuple(replace(part, day=DAYS[0]) for part in unknown.parts))
    assert trend(twice, "speed_m_s").places == pytest.approx((0.0, 0.5, 1.0))

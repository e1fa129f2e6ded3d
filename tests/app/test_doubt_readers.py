"""Tests that report and screen leave out the same as each other and as the verdicts. Read from their words alone."""

from datetime import UTC, datetime

import numpy as np
import pytest

from app.reports.patient.document import make_report
from app.results.result_page import ResultPage
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import Joint, Side
from core.parameters import BY_COLUMN, ParameterFile, QuantityClass, columns_of
from core.results import Analysis, ZeroKind
from core.session import Session
from devices.simulation.walker import DEMONSTRATION
from tests.app.changed_analysis import recalibrated, with_few_strides
from tests.app.doubt_readers import Doubts, Stated, stated_in_report, stated_on_screen
from tests.simulated import analysis_of, session_of

pytestmark = pytest.mark.endurance  # `test_exported_doubt` holds the same of four sessions in every run


@pytest.fixture(scope="module")
def session() -> Session:
    return session_of(DEMONSTRATION)


@pytest.fixture(scope="module")
def analysis(session: Session) -> Analysis:
    return analysis_of(session)


def read(session: Session, analysis: Analysis, result_page: ResultPage) -> tuple[Doubts, Doubts]:
    """What the report states, and what the screen states."""
    made_at = datetime(2026, 11, 22, 12, tzinfo=UTC)
    report = make_report(ReportRequest(AnalysedVisit(session, analysis), ("walk 1",), made_at, "1.2.3"))
    result_page.show_visit(AnalysedVisit(session, analysis))
    return stated_in_report(report), stated_on_screen(result_page)


def assert_both(found: tuple[Doubts, Doubts], expected: dict[tuple[Side, str], Stated]) -> None:
    """Both say what is expected, and `Stated.REPORTED` of everything else; and they have most figures in common."""
    for doubts in found:
        assert len(doubts) > 25
        assert doubts == {key: expected.get(key, Stated.REPORTED) for key in doubts}
    assert len(set(found[0]) & set(found[1])) > 20
    assert set(expected) <= set(found[0]) | set(found[1])


def columns(kind: str, *classes: QuantityClass) -> list[str]:
    """Columns of strides.csv that both readers know."""
    unread = ("at_initial_contact_deg", "peak_percent")
    return [
        name
        for name in columns_of(ParameterFile.STRIDES, ParameterFile.PEAKS)
        if name.startswith(kind) and BY_COLUMN[name].rests_on in classes and not name.endswith(unread)
    ]


def test_of_a_sound_recording_everything_is_reported(
    session: Session, analysis: Analysis, result_page: ResultPage
) -> None:
    assert_both(read(session, analysis, result_page), {})


def test_without_a_zero_all_heights_are_not_reported_and_no_range(
    session: Session, analysis: Analysis, result_page: ResultPage
) -> None:
    heights = [*columns("knee", QuantityClass.HEIGHT), *columns("ankle", QuantityClass.HEIGHT)]
    expected = {(side, name): Stated.NOT_REPORTED for side in Side for name in heights}
    assert_both(read(session, recalibrated(analysis, zero=ZeroKind.NONE), result_page), expected)


def test_of_sensors_that_are_no_adjacent_their_joint_is_not_reported_and_the_foot_read_with_care(
    session: Session, analysis: Analysis, result_page: ResultPage
) -> None:
    changed = recalibrated(analysis, [Joint.RIGHT_ANKLE], is_same_joint=False, sign_margin=1.05)
    ankle = columns("ankle", QuantityClass.HEIGHT, QuantityClass.SHAPE)
    times = ("stride_time_s", "stride_length_m", "stance_percent")
    expected = dict.fromkeys([(Side.RIGHT, name) for name in ankle], Stated.NOT_REPORTED)
    expected |= {(Side.RIGHT, name): Stated.CARE for name in times}
    expected |= {(side, name): Stated.CARE for side in Side for name in ("speed_m_s", "cadence_steps_min")}
    expected |= {(side, "double_support_percent"): Stated.NOT_REPORTED for side in Side}
    assert_both(read(session, changed, result_page), expected)


def test_of_one_leg_with_two_strides_the_other_is_reported(
    session: Session, analysis: Analysis, result_page: ResultPage
) -> None:
    found = read(session, with_few_strides(analysis, left=2), result_page)
    of_both = {"speed_m_s", "cadence_steps_min", "double_support_percent"}
    for doubts in found:
        for (side, name), stated in doubts.items():
            is_not_reported = side is Side.LEFT or name in of_both
            assert stated is (Stated.NOT_REPORTED if is_not_reported else Stated.REPORTED), (side, name)


def test_an_unsure_sign_leaves_the_range(session: Session, analysis: Analysis, result_page: ResultPage) -> None:
    changed = recalibrated(analysis, [Joint.LEFT_KNEE], is_sign_certain=False)
    expected = {(Side.LEFT, name): Stated.NOT_REPORTED for name in columns("knee", QuantityClass.HEIGHT)}
    assert_both(read(session, changed, result_page), expected)


def test_care_is_read_as_care(session: Session, analysis: Analysis, result_page: ResultPage) -> None:
    changed = recalibrated(analysis, [Joint.RIGHT_KNEE], axis_sd_rad=np.deg2rad(8.0))
    names = columns("knee", QuantityClass.HEIGHT, QuantityClass.SHAPE)
    assert_both(read(session, changed, result_page), {(Side.RIGHT, name): Stated.CARE for name in names})


def test_a_report_that_withholds_nothing_is_not_misread(
    session: Session, analysis: Analysis, result_page: ResultPage
) -> None:
    """The reader must be able to fail: another analysis is distinguished."""
    unset = read(session, recalibrated(analysis, zero=ZeroKind.NONE), result_page)
    with pytest.raises(AssertionError):
        assert_both(unset, {})

"""The legs of a mean stride: where they stand, and what is left out."""

import numpy as np
import pytest

from app.summary.mean_legs import ANKLE, HIP, KNEE, TOES, MeanLegs, mean_legs
from core.body import Joint, Side
from core.results import Analysis, ZeroKind
from core.session import Session
from tests.app.changed_analysis import recalibrated, rewalked, walk_of
from tests.simulated import LONG_WALK, analysis_of, session_of


@pytest.fixture(scope="module")
def session() -> Session:
    return session_of(LONG_WALK)


@pytest.fixture(scope="module")
def analysis(session: Session) -> Analysis:
    return analysis_of(session)


def legs_of(session: Session, analysis: Analysis) -> MeanLegs:
    found = mean_legs(session, analysis, walk_of(analysis))
    assert found is not None
    return found


def test_the_knee_between_the_drawn_segments_is_the_knee_angle(session: Session, analysis: Analysis) -> None:
    found = legs_of(session, analysis)
    for side in Side:
        points = found.points_m[side]
        thigh, shank = points[:, HIP] - points[:, KNEE], points[:, KNEE] - points[:, ANKLE]
        bent = np.arctan2(thigh[:, 1], thigh[:, 0]) - np.arctan2(shank[:, 1], shank[:, 0])
        cycles = walk_of(analysis).gait[side].cycles[Joint(f"{side}_knee")]
        mean = np.nanmean(cycles[walk_of(analysis).gait[side].strides.is_used], axis=0)
        apart = np.angle(np.exp(1j * (bent - mean)))  # a bent knee's shank lies behind the thigh's line
        assert np.max(np.abs(np.rad2deg(apart))) < 3.0


def test_in_contact_the_foot_is_ahead_and_half_a_stride_later_behind(session: Session, analysis: Analysis) -> None:
    found = legs_of(session, analysis)
    assert found.pose_m(Side.LEFT, 0.0)[ANKLE, 0] > 0.2
    assert found.pose_m(Side.LEFT, 50.0)[ANKLE, 0] < -0.1


def test_what_may_not_be_read_is_not_drawn(session: Session, analysis: Analysis) -> None:
    without_foot = recalibrated(analysis, [Joint.LEFT_ANKLE], axis_sd_rad=np.deg2rad(11.0))
    found = legs_of(session, without_foot)
    assert np.isnan(found.points_m[Side.LEFT][:, TOES]).all()
    assert np.isfinite(found.points_m[Side.LEFT][:, ANKLE]).any()
    assert np.isfinite(found.points_m[Side.RIGHT][:, TOES]).any()
    without_zero = recalibrated(analysis, zero=ZeroKind.NONE)
    assert mean_legs(session, without_zero, walk_of(without_zero)) is None


def test_one_leg_is_drawn_alone(session: Session, analysis: Analysis) -> None:
    gait = walk_of(analysis).gait
    alone = rewalked(analysis, gait={Side.RIGHT: gait[Side.RIGHT]})
    found = legs_of(session, alone)
    assert set(found.points_m) == {Side.RIGHT}

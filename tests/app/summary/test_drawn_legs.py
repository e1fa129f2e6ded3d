"""Tests of the drawn legs. They bend by the angles, reach forward at contact, and leave out what nobody measured."""

from dataclasses import replace

import numpy as np
import pytest

from app.summary.drawn_legs import FOOT, HIPS, SHANK, THIGH, UNKNOWN_HEIGHT_M, draw_legs
from core.body import Joint, Side, Site, ankle_of, knee_of
from core.results import Analysis, RecordingAnalysis
from core.samples import FloatArray
from core.session import RecordingKind, Session
from tests.simulated import SHORT_VISIT, analysis_of, session_of

HEIGHT_M = 1.8


@pytest.fixture(scope="module")
def visit() -> tuple[Session, Analysis]:
    session = session_of(SHORT_VISIT)
    session = replace(session, patient=replace(session.patient, height_m=HEIGHT_M))
    return session, analysis_of(session)


def walk_of(analysis: Analysis) -> RecordingAnalysis:
    return next(r for r in analysis.recordings if r.kind is RecordingKind.WALKING)


def angle_between_deg(one: FloatArray, other: FloatArray) -> FloatArray:
    cosine = (one * other).sum(axis=1) / (np.linalg.norm(one, axis=1) * np.linalg.norm(other, axis=1))
    return np.rad2deg(np.arccos(np.clip(cosine, -1, 1)))


@pytest.mark.parametrize("side", Side)
def test_the_legs_bend_as_the_angles_say(visit: tuple[Session, Analysis], side: Side) -> None:
    session, analysis = visit
    walk = walk_of(analysis)
    leg = draw_legs(session, analysis, walk)[side]
    hip_m, knee_m, ankle_m = leg.leg_m[:, 0], leg.leg_m[:, 1], leg.leg_m[:, 2]
    at = np.searchsorted(walk.time_s, leg.time_s)
    knee_deg = np.rad2deg(walk.joints[knee_of(side)].angle_rad[at])
    ankle_deg = np.rad2deg(walk.joints[ankle_of(side)].angle_rad[at])
    assert np.ptp(knee_deg) > 40
    np.testing.assert_allclose(angle_between_deg(knee_m - hip_m, ankle_m - knee_m), np.abs(knee_deg), atol=1e-3)
    toes_m = leg.foot_m[:, 1] - leg.foot_m[:, 0]
    np.testing.assert_allclose(angle_between_deg(toes_m, knee_m - ankle_m), 90 - ankle_deg, atol=1e-3)


@pytest.mark.parametrize("side", Side)
def test_a_foot_lands_before_the_body_and_leaves_behind_it(visit: tuple[Session, Analysis], side: Side) -> None:
    session, analysis = visit
    walk = walk_of(analysis)
    leg, strides = draw_legs(session, analysis, walk)[side], walk.gait[side].strides
    ankle_forward_m = leg.leg_m[:, 2, 0]
    assert len(strides) >= 3
    assert np.interp(strides.start_s, leg.time_s, ankle_forward_m).min() > 0.15
    assert np.interp(strides.toe_off_s, leg.time_s, ankle_forward_m).max() < -0.15


def test_lengths_are_shares_of_the_height_and_the_hips_stand_side_by_side(visit: tuple[Session, Analysis]) -> None:
    session, analysis = visit
    unknown = replace(session, patient=replace(session.patient, height_m=None))
    for reported, height_m in ((session, HEIGHT_M), (unknown, UNKNOWN_HEIGHT_M)):
        legs = draw_legs(reported, analysis, walk_of(analysis))
        left, right = legs[Side.LEFT], legs[Side.RIGHT]
        np.testing.assert_allclose(
            left.leg_m[:, 0] - right.leg_m[:, 0], [[0, HIPS * height_m, 0]] * len(left.time_s), atol=1e-12
        )
        thigh_m = np.linalg.norm(left.leg_m[:, 1] - left.leg_m[:, 0], axis=1)
        np.testing.assert_allclose(thigh_m, THIGH * height_m)
        np.testing.assert_allclose(np.linalg.norm(left.foot_m[:, 1] - left.foot_m[:, 0], axis=1), FOOT * height_m)


@pytest.mark.parametrize(("apart_m", "drawn_m"), [(0.40, 0.40), (0.02, SHANK * HEIGHT_M)])
def test_the_shank_is_as_long_as_its_centres_lie_apart_unless_that_cannot_be(
    visit: tuple[Session, Analysis], apart_m: float, drawn_m: float
) -> None:
    session, analysis = visit
    (span,) = analysis.calibrations
    along = np.array([0.0, 0.6, 0.8])
    found = dict(span.joints)
    found[Joint.LEFT_KNEE] = replace(found[Joint.LEFT_KNEE], centre_distal_m=along * 0.1)
    found[Joint.LEFT_ANKLE] = replace(found[Joint.LEFT_ANKLE], centre_proximal_m=along * (0.1 - apart_m))
    reported = replace(analysis, calibrations=(replace(span, joints=found),))
    leg = draw_legs(session, reported, walk_of(reported))[Side.LEFT]
    assert leg.shank_m == pytest.approx(drawn_m)
    np.testing.assert_allclose(np.linalg.norm(leg.leg_m[:, 2] - leg.leg_m[:, 1], axis=1), drawn_m)


def test_nothing_is_drawn_where_nothing_is_known(visit: tuple[Session, Analysis]) -> None:
    session, analysis = visit
    walk = walk_of(analysis)
    knee = walk.joints[Joint.LEFT_KNEE]
    angle_rad = knee.angle_rad.copy()
    angle_rad[:200] = np.nan
    joints = {Joint.LEFT_KNEE: replace(knee, angle_rad=angle_rad), Joint.RIGHT_KNEE: walk.joints[Joint.RIGHT_KNEE]}
    legs = draw_legs(session, analysis, replace(walk, joints=joints))
    is_known = np.isfinite(legs[Side.LEFT].leg_m).all(axis=(1, 2))
    np.testing.assert_array_equal(is_known, legs[Side.LEFT].time_s >= walk.time_s[200])
    assert np.isnan(legs[Side.RIGHT].foot_m[:, 1]).all()  # no ankle, no foot

    without_thigh = tuple(
        replace(r, imu={site: block for site, block in r.imu.items() if site is not Site.LEFT_THIGH})
        for r in session.recordings
    )
    assert list(draw_legs(replace(session, recordings=without_thigh), analysis, walk)) == [Side.RIGHT]
    assert draw_legs(session, analysis, replace(walk, kind=RecordingKind.FREE_MOTION)) == {}

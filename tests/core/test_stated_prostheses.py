"""What the level, knee and foot of a prosthesis change of an analysis, and that nothing stated changes nothing."""

from dataclasses import replace

import numpy as np
import pytest

from app.storage.analysis_content import packed
from core.analysis import analyse
from core.body import LEG_JOINTS, Joint, Side, Site
from core.prosthesis import NOT_STATED, AmputationLevel, FootKind, JointNature, KneeKind, Prosthesis
from core.results import Analysis
from core.session import Patient, Session
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings
from tests.simulated import session_of

SETTINGS = WalkerSettings(
    seed=3,
    tissue=Tissue.SOFT,
    prosthetic_side=Side.LEFT,
    fitted=Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING),
    recordings=(Standing(), FreeMotion(duration_s=8.0), Walk(strides=6)),
)
TRANSTIBIAL = Prosthesis(AmputationLevel.TRANSTIBIAL)
SPRINGY = Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING)


@pytest.fixture(scope="module")
def walked() -> Session:
    return session_of(SETTINGS)


def stated(session: Session, prostheses: dict[Side, Prosthesis], side: str = "left") -> Analysis:
    return analyse(replace(session, patient=Patient(prosthetic_side=side, prostheses=prostheses)))


def same(one: Analysis, other: Analysis) -> bool:
    """To the last bit."""
    return packed(one) == packed(other)


@pytest.fixture(scope="module")
def alone(walked: Session) -> Analysis:
    """Of the side alone."""
    return stated(walked, {})


@pytest.fixture(scope="module")
def left_leg(walked: Session) -> Session:
    recordings = [
        replace(one, imu={site: block for site, block in one.imu.items() if site.side is Side.LEFT})
        for one in walked.recordings
    ]
    return replace(walked, recordings=tuple(recordings))


def keys(found: Analysis) -> set[str]:
    return {finding.key for finding in found.findings}


def test_nothing_stated_and_what_is_stated_of_a_side_without_a_prosthesis_change_nothing(
    walked: Session, alone: Analysis
) -> None:
    assert alone.prostheses == {}
    assert same(stated(walked, {Side.LEFT: NOT_STATED}), alone)
    assert same(stated(walked, {Side.RIGHT: SPRINGY}), alone)
    assert {joint: found.nature for joint, found in alone.calibrations[-1].joints.items()} == {
        joint: JointNature.PROSTHETIC if joint.side is Side.LEFT else JointNature.NOT_STATED for joint in LEG_JOINTS
    }


def test_only_certainty_and_what_is_reported_of_the_side_follow_what_is_stated_of_it(
    walked: Session, alone: Analysis
) -> None:
    known = stated(walked, {Side.LEFT: SPRINGY})
    assert known.prostheses == {Side.LEFT: SPRINGY}
    for before, after in zip(alone.recordings, known.recordings, strict=True):
        for joint, angle in before.joints.items():
            np.testing.assert_array_equal(angle.angle_rad, after.joints[joint].angle_rad)
            if joint.side is Side.RIGHT:
                np.testing.assert_array_equal(angle.sd_rad, after.joints[joint].sd_rad)
        for side, gait in before.gait.items():
            np.testing.assert_array_equal(gait.strides.start_s, after.gait[side].strides.start_s)
            assert gait.is_toe_off_biased is after.gait[side].is_toe_off_biased
    added = [one for one in known.findings if one not in alone.findings]
    assert [(one.key, one.where) for one in added] == [("foot_against_shank", "left_ankle")]


@pytest.mark.parametrize(
    ("one", "is_reported"),
    [
        (Prosthesis(foot=FootKind.SACH), True),
        (TRANSTIBIAL, False),
        (Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.HYDRAULIC_ANKLE), False),
    ],
)
def test_an_angle_is_reported_to_be_the_foot_s_against_the_shank_where_the_foot_has_no_joint(
    left_leg: Session, one: Prosthesis, is_reported: bool
) -> None:
    assert ("foot_against_shank" in keys(stated(left_leg, {Side.LEFT: one}))) is is_reported


def test_a_foot_that_has_no_sensor_is_reported_nothing_of(left_leg: Session) -> None:
    recordings = tuple(
        replace(one, imu={site: block for site, block in one.imu.items() if site is not Site.LEFT_FOOT})
        for one in left_leg.recordings
    )
    assert "foot_against_shank" not in keys(stated(replace(left_leg, recordings=recordings), {Side.LEFT: SPRINGY}))


def test_a_rigid_leg_is_a_hinge_of_the_prosthesis_and_none_of_the_patient() -> None:
    """Without tissue nothing in the data separates a person's knee from a hinge; what is stated does."""
    rigid = session_of(replace(SETTINGS, tissue=Tissue.RIGID, sites=(Site.LEFT_THIGH, Site.LEFT_SHANK)))
    knees = {
        name: stated(rigid, worn).recordings[-1].joints[Joint.LEFT_KNEE].sd_rad
        for name, worn in {
            "alone": {},
            "own": {Side.LEFT: TRANSTIBIAL},
            "prosthetic": {Side.LEFT: Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.SINGLE_AXIS)},
        }.items()
    }
    np.testing.assert_array_equal(knees["alone"], knees["prosthetic"])
    assert np.rad2deg(np.nanmedian(knees["alone"])) < 0.3
    assert np.rad2deg(np.nanmin(knees["own"])) > 1.0

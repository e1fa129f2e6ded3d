"""Tests of which way a joint bends and where its zero is. The data are made so that the answer is known."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from core.analysis import analyse
from core.body import LEG_SITES, Joint, Segment
from core.calibration.clinical_sign import (
    MIN_RANGE_RAD,
    ClinicalSign,
    ankle_sign,
    ankle_sign_from_foot,
    forward_swing,
    knee_sign,
    skewness,
)
from core.calibration.zero import standing_twist, wrapped_to_zero
from core.samples import FloatArray
from core.signal.rotations import joint_frame, wrap
from devices.simulation.walker import Manner, Tissue, Walk, WalkerSettings
from tests.simulated import simulation_of

T = np.arange(1000) / 100
SWING = 9 * np.exp(2 * (np.cos(6 * T) - 1)) - 2  # 7 rad/s forward, 2 back
FLEXION = np.deg2rad(30 - 30 * np.cos(6 * T))


@pytest.mark.parametrize("sign", [1, -1])
def test_a_knee_that_bends_one_way_from_standing_shows_its_sign(sign: int) -> None:
    assert forward_swing(SWING) > 0
    found = knee_sign(sign * FLEXION, sign * SWING, is_walking=True, has_standing=True)
    assert (found.sign, found.is_certain) == (sign, True)


@pytest.mark.parametrize("sign", [1, -1])
def test_turning_everything_turns_the_sign_and_nothing_else(sign: int) -> None:
    one = knee_sign(FLEXION, SWING, is_walking=True, has_standing=False)
    other = knee_sign(-FLEXION, -SWING, is_walking=True, has_standing=False)
    assert (one.sign, one.is_certain) == (-other.sign, other.is_certain)
    assert one.margin == pytest.approx(other.margin)


def test_a_stiff_knee_is_uncertain() -> None:
    stiff = 0.2 * MIN_RANGE_RAD * np.sin(6 * T)
    assert not knee_sign(stiff, SWING, is_walking=True, has_standing=True).is_certain


def test_opinions_that_disagree_are_uncertain() -> None:
    assert not knee_sign(FLEXION, -SWING, is_walking=True, has_standing=True).is_certain


def test_without_walking_and_standing_nothing_shows() -> None:
    assert not knee_sign(FLEXION, SWING, is_walking=False, has_standing=False).is_certain
    assert knee_sign(FLEXION, SWING, is_walking=False, has_standing=True).is_certain


def test_a_shank_that_hardly_swings_has_no_opinion() -> None:
    assert forward_swing(0.14 * SWING) == 0.0


@pytest.mark.parametrize("knee_turn", [1, -1])
@pytest.mark.parametrize("alignment", [0.9, -0.9])
def test_dorsiflexion_turns_the_other_way_about_the_same_line(knee_turn: int, alignment: float) -> None:
    knee = ClinicalSign(knee_turn, 2.0, True)
    same_way = knee_turn * np.sign(alignment)
    found = ankle_sign(knee, alignment, same_way * SWING, is_walking=True)
    assert (found.sign, found.is_certain) == (-same_way, True)
    assert found.margin == pytest.approx(0.9)


def test_an_ankle_follows_no_knee_whose_axis_is_another() -> None:
    knee = ClinicalSign(1, 2.0, True)
    assert not ankle_sign(knee, 0.3, SWING, is_walking=True).is_certain


def test_an_ankle_of_an_uncertain_knee_goes_by_the_swing() -> None:
    for likelier in (1, -1):
        found = ankle_sign(ClinicalSign(likelier, 0.1, False), 0.95, SWING, is_walking=True)
        assert (found.sign, found.is_certain) == (-1, True)
    assert not ankle_sign(ClinicalSign(1, 0.1, False), 0.95, SWING, is_walking=False).is_certain


def test_an_ankle_without_knee_goes_by_the_swing() -> None:
    found = ankle_sign(None, 0.0, SWING, is_walking=True)
    assert (found.sign, found.is_certain) == (-1, True)
    assert ankle_sign(None, 0.0, -SWING, is_walking=True).sign == 1
    assert not ankle_sign(None, 0.0, SWING, is_walking=False).is_certain


def test_skewness_is_one_for_one_sided_and_none_for_symmetric_and_constant_values() -> None:
    assert skewness(np.linspace(0, 1, 1001), 0.0) == 1.0
    assert skewness(np.linspace(-1, 1, 1001), 0.02) == pytest.approx(0.0, abs=1e-12)
    assert skewness(np.full(10, 3.0), 0.02) == 0.0


@given(st.floats(-3, 3), st.integers(0, 2**31))
def test_standing_reads_the_twist_from_gravity_alone(angle: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    mounts = Rotation.random(2, rng=rng)
    axis = np.array([0.0, 1.0, 0.0])
    down = rng.normal(size=3)
    down[0] += 3.0 * np.sign(down[0])
    # distal segment turned by `angle` about the axis; at angle 0 both segment frames coincide
    down_distal = Rotation.from_rotvec(angle * axis).inv().apply(down)
    axes: list[FloatArray] = [m.inv().apply(axis) for m in mounts]
    found = standing_twist(mounts[0].inv().apply(down), mounts[1].inv().apply(down_distal), axes[0], axes[1])
    # the frames' x axes lie wherever eq 13 puts them: their difference is the twist of angle 0
    at_zero = standing_twist(mounts[0].inv().apply(down), mounts[1].inv().apply(down), axes[0], axes[1])
    assert float(wrap(np.array(found - at_zero - angle))) == pytest.approx(0.0, abs=1e-9)
    x1, x2 = mounts[0].apply(joint_frame(axes[0])[0]), mounts[1].apply(joint_frame(axes[1])[0])
    between = np.arctan2(np.cross(x1, x2) @ axis, x1 @ x2)
    assert float(wrap(np.array(at_zero - between))) == pytest.approx(0.0, abs=1e-9)


def test_whole_turns_are_taken_out_and_nothing_else() -> None:
    angle = np.array([0.1, np.nan, 0.4, 0.3])
    np.testing.assert_allclose(wrapped_to_zero(angle + 6 * np.pi), angle, atol=1e-12)
    np.testing.assert_allclose(wrapped_to_zero(angle - 2 * np.pi), angle, atol=1e-12)
    assert np.isnan(wrapped_to_zero(np.full(3, np.nan))).all()
    assert len(wrapped_to_zero(np.empty(0))) == 0


def test_an_ankle_takes_its_sign_from_the_way_of_its_foot() -> None:
    """Dorsiflexion lifts the toes: an axis along the foot's own is turned so, whichever way it was found."""
    assert ankle_sign_from_foot(0.95, swings=8) == ClinicalSign(1, 0.95, True)
    assert ankle_sign_from_foot(-0.95, swings=8) == ClinicalSign(-1, 0.95, True)
    assert not ankle_sign_from_foot(0.49, swings=8).is_certain
    assert not ankle_sign_from_foot(0.95, swings=2).is_certain


def test_a_foot_that_hardly_rolls_still_states_which_way_its_ankle_bends() -> None:
    """The shank's swing alone leaves both ankles of this walk in doubt (0.25 and 0.23)."""
    made = simulation_of(
        WalkerSettings(seed=1, tissue=Tissue.SOFT, recordings=(Walk(strides=8, manner=Manner.FLAT, speed_m_s=0.5),))
    )
    sites = {site for site in LEG_SITES if site.segment is not Segment.THIGH}
    (walk,) = made.session.recordings
    worn = replace(walk, imu={site: block for site, block in walk.imu.items() if site in sites})
    analysis = analyse(replace(made.session, recordings=(worn,)))
    for joint in (Joint.LEFT_ANKLE, Joint.RIGHT_ANKLE):
        assert analysis.calibrations[-1].joints[joint].is_sign_certain
        found, truth = analysis.recordings[0].joints[joint].angle_rad, made.truth.recordings["walk 1"].joints[joint]
        true = np.interp(analysis.recordings[0].time_s, truth.time_s, truth.angle_rad)
        is_known = np.isfinite(found)
        assert np.corrcoef(found[is_known], true[is_known])[0, 1] > 0.5

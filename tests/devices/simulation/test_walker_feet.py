"""Tests that the simulated patient's feet rest on the floor and its joints bend as a human's.

One walk, seen closely.
"""

from itertools import pairwise

import numpy as np
import pytest

from core.body import LEG_JOINTS, Joint, Side, Site
from core.samples import FloatArray
from devices.simulation.walker import NO_ERRORS, SimulatedSession, Walk, WalkerSettings, simulate

SPEED_M_S = 1.19


@pytest.fixture(scope="module")
def walked() -> SimulatedSession:
    walk = Walk(speed_m_s=SPEED_M_S, strides=6)
    return simulate(WalkerSettings(seed=0, errors=NO_ERRORS, recordings=(walk,)))


@pytest.mark.parametrize("side", list(Side))
def test_events_of_a_stride_come_in_their_order_at_human_shares(walked: SimulatedSession, side: Side) -> None:
    events = walked.truth.recordings["walk 1"].feet[side].events
    stride_s = np.diff(events.initial_contact_s)[1:-1]
    shares = [
        (events.full_contact_s[1:-2] - events.initial_contact_s[1:-2]) / stride_s,
        (events.heel_rise_s[2:-1] - events.initial_contact_s[1:-2]) / stride_s,
        (events.toe_off_s[2:-1] - events.initial_contact_s[1:-2]) / stride_s,
    ]
    assert [len(share) for share in shares] == [3, 3, 3]
    for share, low, high in zip(shares, (0.05, 0.25, 0.58), (0.20, 0.45, 0.63), strict=True):
        assert (share > low).all()
        assert (share < high).all()
    assert stride_s == pytest.approx(1.08, abs=0.08)


@pytest.mark.parametrize("side", list(Side))
def test_a_flat_foot_neither_turns_nor_moves(walked: SimulatedSession, side: Side) -> None:
    foot = walked.truth.recordings["walk 1"].feet[side]
    block = walked.session.recordings[0].imu[Site(f"{side}_foot")]
    for start_s, end_s in zip(foot.events.full_contact_s[:-1], foot.events.heel_rise_s[1:], strict=True):
        still = (block.time_s > start_s + 0.005) & (block.time_s < end_s - 0.005)
        assert still.sum() > 4
        np.testing.assert_allclose(block.gyr_rad_s[still], 0.0, atol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(block.acc_m_s2[still], axis=1), 9.81, atol=1e-4)


@pytest.mark.parametrize("side", list(Side))
def test_a_foot_rolls_over_heel_and_toe_and_swings_clear_of_the_floor(walked: SimulatedSession, side: Side) -> None:
    """The ankle is 8 cm over the floor in foot flat, rises over the heel and, more, over the toes."""
    foot = walked.truth.recordings["walk 1"].feet[side]
    events, height_m = foot.events, foot.ankle_path_m[:, 2]

    def between(start_s: float, end_s: float) -> FloatArray:
        return height_m[(foot.time_s > start_s) & (foot.time_s < end_s)]

    for k in range(1, 5):
        flat = between(events.full_contact_s[k - 1] + 0.01, events.heel_rise_s[k] - 0.01)
        np.testing.assert_allclose(flat, 0.08, atol=1e-3)
        loading = between(events.initial_contact_s[k - 1], events.full_contact_s[k - 1])
        assert 0.08 <= loading.max() < 0.10
        push_off = between(events.heel_rise_s[k], events.toe_off_s[k])
        assert (np.diff(push_off) > -1e-6).all()
        assert 0.10 < push_off.max() < 0.20
        swing = between(events.toe_off_s[k], events.initial_contact_s[k])
        assert swing.min() > 0.08
        assert swing.max() < 0.30


def test_it_walks_at_the_speed_that_was_asked_and_its_feet_take_turns(walked: SimulatedSession) -> None:
    truth = walked.truth.recordings["walk 1"]
    assert truth.speed_m_s == pytest.approx(SPEED_M_S, rel=0.02)
    contacts = sorted((at_s, side) for side, foot in truth.feet.items() for at_s in foot.events.initial_contact_s)
    assert all(one[1] is not other[1] for one, other in pairwise(contacts))
    path_m = truth.feet[Side.LEFT].ankle_path_m[:, :2]
    forward = (path_m[-1] - path_m[0]) / np.linalg.norm(path_m[-1] - path_m[0])
    to_the_left = np.array([-forward[1], forward[0]])
    across_m = {side: foot.ankle_path_m[:, :2] @ to_the_left for side, foot in truth.feet.items()}
    for side, foot in truth.feet.items():
        assert foot.stride_lengths_m[1:-1] == pytest.approx(1.28, abs=0.12)
        assert np.ptp(across_m[side]) < 0.1
    assert 0.05 < np.mean(across_m[Side.LEFT]) - np.mean(across_m[Side.RIGHT]) < 0.3


@pytest.mark.parametrize("side", list(Side))
def test_knee_and_ankle_bend_as_a_humans(walked: SimulatedSession, side: Side) -> None:
    truth = walked.truth.recordings["walk 1"]
    contacts_s = truth.feet[side].events.initial_contact_s[1:-1]
    cycles = {}
    for kind in ("knee", "ankle"):
        known = truth.joints[Joint(f"{side}_{kind}")]
        strides = [np.interp(np.linspace(a, b, 101), known.time_s, known.angle_rad) for a, b in pairwise(contacts_s)]
        cycles[kind] = np.rad2deg(np.mean(strides, axis=0))
    knee, ankle = cycles["knee"], cycles["ankle"]
    assert 13.0 < knee[5:31].max() < 20.0
    assert 10 < 5 + knee[5:31].argmax() < 18
    assert 55.0 < knee.max() < 68.0
    assert 70 <= knee.argmax() <= 75
    assert 0.0 < knee.min() < 5.0
    assert 10.0 < ankle.max() < 17.0
    assert 35 <= ankle.argmax() <= 50
    assert -17.0 < ankle.min() < -10.0
    assert 58 <= ankle.argmin() <= 70
    assert ankle[:15].min() < -4.0


def test_sensors_sit_where_they_are_strapped(walked: SimulatedSession) -> None:
    """From the joint above: the side of the thigh, the front of the shin, the instep, each a finger's width off."""
    shank_m, foot_m = np.linalg.norm([0.04, 0.03, -0.20]), np.linalg.norm([0.09, 0.0, -0.03])
    thigh_m = np.linalg.norm([0.02, 0.07, 0.43 - 0.22])  # from the knee
    joints = walked.truth.recordings["walk 1"].joints
    for side in Side:
        knee, ankle = joints[Joint(f"{side}_knee")], joints[Joint(f"{side}_ankle")]
        assert np.linalg.norm(knee.centre_distal_m) == pytest.approx(shank_m, abs=0.05)
        assert np.linalg.norm(ankle.centre_distal_m) == pytest.approx(foot_m, abs=0.05)
        assert np.linalg.norm(knee.centre_proximal_m) == pytest.approx(thigh_m, abs=0.05)
        for joint in (knee, ankle):
            for axis in (joint.axis_proximal, joint.axis_distal):
                assert np.linalg.norm(axis) == pytest.approx(1.0)


@pytest.mark.parametrize("joint", list(LEG_JOINTS))
def test_it_is_after_the_walk_as_it_stood_before(walked: SimulatedSession, joint: Joint) -> None:
    angle_deg = np.rad2deg(walked.truth.recordings["walk 1"].joints[joint].angle_rad)
    assert angle_deg[-1] == pytest.approx(angle_deg[0], abs=0.3)
    assert abs(angle_deg[0]) < 12.0

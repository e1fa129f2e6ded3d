"""Tests that feet that hardly roll, are stiff, drag or land on the toes move as stated."""

import numpy as np
import pytest

from core.body import Joint, Side
from core.samples import FloatArray
from devices.simulation.walker import NO_ERRORS, Manner, Walk, WalkerSettings, simulate
from devices.simulation.walker_body import HEEL_M, TOE_M, make_leg
from devices.simulation.walker_gait import walk_leg
from devices.simulation.walker_motion import LegMotion
from devices.simulation.walker_plan import plan_walk

MANNERS = [Manner.FLAT, Manner.STIFF, Manner.DRAGGING, Manner.TOE_FIRST, Manner.HEMIPARETIC]
STEP_S = 0.002


def walked(manner: Manner, speed_m_s: float = 0.6, strides: int = 4) -> LegMotion:
    walk = Walk(speed_m_s=speed_m_s, strides=strides, manner=manner)
    time_s = np.arange(-0.25, 16.0, STEP_S)
    plan = plan_walk(walk, time_s, Side.LEFT, {}, np.random.default_rng(1))
    leg = make_leg(WalkerSettings(), Side.LEFT)
    return walk_leg(leg, plan, time_s, np.zeros((len(time_s), 2)), np.random.default_rng(2))


def heel_and_toe_m(motion: LegMotion) -> tuple[FloatArray, FloatArray]:
    """Paths (n, 3) of the lowest points of the foot."""
    foot, ankle_m = motion.rotations[2], motion.origins_m[2]
    return ankle_m + foot @ HEEL_M, ankle_m + foot @ TOE_M


def pitch_deg(motion: LegMotion, at_s: FloatArray) -> FloatArray:
    return np.interp(at_s, motion.time_s, np.rad2deg(np.arcsin(motion.rotations[2][:, 2, 0])))


@pytest.mark.parametrize("manner", MANNERS)
@pytest.mark.parametrize("speed_m_s", [0.4, 1.19])
def test_feet_stand_where_they_stand_and_stay_above_the_floor(manner: Manner, speed_m_s: float) -> None:
    motion = walked(manner, speed_m_s)
    heel, toe = heel_and_toe_m(motion)
    assert min(heel[:, 2].min(), toe[:, 2].min()) > -1e-6
    events, t = motion.events, motion.time_s
    for on, flat, rise, off in zip(
        events.initial_contact_s[:-1],
        events.full_contact_s[:-1],
        events.heel_rise_s[1:],
        events.toe_off_s[1:],
        strict=True,
    ):
        assert on < flat < rise < off
        still = (t > flat + 0.02) & (t < rise - 0.02)  # a stiff foot is flat in passing, and then smoothed
        assert max(np.ptp(heel[still], axis=0).max(), np.ptp(toe[still], axis=0).max()) < 5e-4
        touching = (t > on) & (t < off)
        lowest = np.minimum(heel[touching, 2], toe[touching, 2])
        np.testing.assert_allclose(lowest, 0.0, atol=1e-6)


def test_a_flat_foot_lands_and_lifts_flat() -> None:
    events = walked(Manner.FLAT).events
    for at_s in (events.initial_contact_s, events.toe_off_s):
        assert np.abs(pitch_deg(walked(Manner.FLAT), at_s)).max() < 6.0
    ordinary = walked(Manner.ORDINARY)
    assert np.abs(pitch_deg(ordinary, ordinary.events.toe_off_s)).min() > 20.0


def test_a_stiff_ankle_hardly_moves_while_the_foot_rolls() -> None:
    motion = walked(Manner.STIFF, 1.0)
    assert np.rad2deg(np.ptp(motion.angles.ankle)) < 9.0
    assert np.rad2deg(motion.angles.knee.max()) > 50.0
    assert pitch_deg(motion, motion.events.initial_contact_s).min() > 5.0
    assert pitch_deg(motion, motion.events.toe_off_s[1:]).max() < -20.0


def test_dragging_toes_slide_over_the_floor_in_early_swing() -> None:
    motion = walked(Manner.DRAGGING)
    _, toe = heel_and_toe_m(motion)
    events, t = motion.events, motion.time_s
    for off, on in zip(events.toe_off_s[1:], events.initial_contact_s[1:], strict=True):
        dragged = (t > off) & (t < off + 0.25 * (on - off))
        assert toe[dragged, 2].max() < 1e-3
        assert np.linalg.norm(np.ptp(toe[dragged], axis=0)) > 0.02
        assert toe[(t > off) & (t < on), 2].max() > 4e-3
    assert pitch_deg(motion, events.initial_contact_s).max() < 0.0


def test_a_foot_that_lands_on_its_toes_lowers_the_heel_then() -> None:
    motion = walked(Manner.TOE_FIRST)
    heel, _ = heel_and_toe_m(motion)
    height = np.interp(motion.events.initial_contact_s, motion.time_s, heel[:, 2])
    assert height.min() > 0.015
    assert np.interp(motion.events.full_contact_s, motion.time_s, heel[:, 2]).max() < 1e-3


def test_one_side_may_walk_in_a_manner_of_its_own() -> None:
    walk = Walk(speed_m_s=0.7, strides=6, manner_of_side={Side.RIGHT: Manner.STIFF})
    truth = simulate(WalkerSettings(errors=NO_ERRORS, recordings=(walk,))).truth.recordings["walk 1"]
    ranges = {side: np.rad2deg(np.ptp(truth.joints[Joint(f"{side}_ankle")].angle_rad)) for side in Side}
    assert ranges[Side.RIGHT] < 9.0
    assert ranges[Side.LEFT] > 18.0
    lengths = [np.mean(truth.feet[side].stride_lengths_m[1:-1]) for side in Side]
    assert lengths[0] == pytest.approx(lengths[1], rel=0.03)
    times = [np.mean(np.diff(truth.feet[side].events.initial_contact_s)) for side in Side]
    assert times[0] == pytest.approx(times[1], rel=0.02)


def test_a_leg_after_a_stroke_lands_flat_and_late_bends_little_and_is_for_a_shorter_time() -> None:
    walk = Walk(speed_m_s=0.5, strides=8, manner_of_side={Side.RIGHT: Manner.HEMIPARETIC})
    truth = simulate(WalkerSettings(errors=NO_ERRORS, recordings=(walk,))).truth.recordings["walk 1"]
    peaks = {side: np.rad2deg(truth.joints[Joint(f"{side}_knee")].angle_rad.max()) for side in Side}
    assert peaks[Side.RIGHT] < 40.0 < 55.0 < peaks[Side.LEFT]
    contacts = {side: truth.feet[side].events.initial_contact_s for side in Side}
    stance = {}
    for side in Side:
        offs = truth.feet[side].events.toe_off_s
        inner = contacts[side][1:-1]
        stance[side] = np.mean(offs[np.searchsorted(offs, inner)] - inner) / np.mean(np.diff(contacts[side]))
    assert stance[Side.LEFT] - stance[Side.RIGHT] == pytest.approx(0.06, abs=0.02)
    following = np.searchsorted(contacts[Side.RIGHT], contacts[Side.LEFT][1:-2])
    steps_s = contacts[Side.RIGHT][following] - contacts[Side.LEFT][1:-2]
    assert np.mean(steps_s) / np.mean(np.diff(contacts[Side.LEFT])) == pytest.approx(0.53, abs=0.01)
    motion = walked(Manner.HEMIPARETIC, 0.5)
    assert np.abs(pitch_deg(motion, motion.events.initial_contact_s)).max() < 5.0

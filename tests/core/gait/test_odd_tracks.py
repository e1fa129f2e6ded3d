"""Tests that a foot that does nothing, or next to nothing, gives no events and no error."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.gait.events import gait_of
from core.gait.phases import PHASES, Phase, phases_at
from core.gait.shank import gait_of_shank
from core.gait.strides import Reason, strides_of
from core.samples import GRAVITY_M_S2, FloatArray, RateKind
from core.signal.orientation import oriented
from core.signal.pair import OrientedTrack
from core.signal.tracks import Track

RNG = np.random.default_rng(5)


def foot(gyr: FloatArray, acc: FloatArray, step_s: float = 0.01) -> OrientedTrack:
    track = Track(0.0, step_s, gyr, acc, None, None, np.ones(len(gyr), dtype=bool))
    return oriented(track, RateKind.INSTANTANEOUS, np.zeros(3))


def still(n: int) -> tuple[FloatArray, FloatArray]:
    return np.zeros((n, 3)), np.tile([0.0, 0.0, GRAVITY_M_S2], (n, 1))


@pytest.mark.parametrize("n", [10, 30, 500])
def test_a_foot_that_lies_still_has_no_events(n: int) -> None:
    track = foot(*still(n))
    assert len(gait_of(track)) == 0
    assert len(gait_of_shank(track)) == 0


def test_noise_has_no_events() -> None:
    gyr, acc = still(1000)
    track = foot(gyr + 0.02 * RNG.normal(size=gyr.shape), acc + 0.1 * RNG.normal(size=acc.shape))
    assert len(gait_of(track)) == 0
    assert len(gait_of_shank(track)) == 0


def test_a_foot_tapping_on_the_spot_makes_no_step() -> None:
    t = np.arange(1000) / 100.0
    lift = np.deg2rad(15.0) * np.maximum(np.sin(2 * np.pi * 0.8 * t), 0.0) ** 4
    gyr = np.zeros((1000, 3))
    gyr[:, 1] = -np.gradient(lift, t)
    acc = GRAVITY_M_S2 * np.stack([np.sin(lift), np.zeros(1000), np.cos(lift)], axis=1)
    assert len(gait_of(foot(gyr, acc))) == 0


def test_shaking_that_never_rests_has_no_events() -> None:
    t = np.arange(1500) / 100.0
    gyr = np.stack([5.0 * np.sin(7.0 * t), 4.0 * np.cos(5.0 * t), 3.0 * np.sin(3.0 * t)], axis=1)
    acc = still(1500)[1] + 5.0 * np.stack([np.sin(9.0 * t), np.cos(11.0 * t), np.sin(6.0 * t)], axis=1)
    assert len(gait_of(foot(gyr, acc))) == 0


@pytest.mark.parametrize("step_m", [0.15, 0.3])
def test_a_foot_that_slides_flat_over_the_floor_makes_every_step_but_no_heel_rise(step_m: float) -> None:
    """Ten steps of 0.48 s, one every 1.2 s, in a mounting of chance."""
    t = (np.arange(15000) + 0.5) / 1000.0  # never where one step ends and the next begins
    since = np.clip(t - 1.5, 0.0, 12.0 - 1e-9)
    u = np.clip((since % 1.2 - 0.72) / 0.48, 0.0, 1.0)
    forward_m = step_m * (np.floor(since / 1.2) + u**3 * (10.0 - 15.0 * u + 6.0 * u**2))
    forward = np.gradient(np.gradient(forward_m, t), t)
    acc = np.stack([forward, np.zeros_like(t), np.full_like(t, GRAVITY_M_S2)], axis=1)[::10]
    mounting = Rotation.from_rotvec([0.5, -1.1, 2.0])
    gyr = 0.002 * RNG.normal(size=acc.shape)
    events = gait_of(foot(gyr, mounting.apply(acc) + 0.03 * RNG.normal(size=acc.shape)))
    assert len(events) == 10
    np.testing.assert_allclose(events.length_m, step_m, atol=0.02)
    off_s = 1.5 + 1.2 * np.arange(10) + 0.72
    np.testing.assert_allclose(events.toe_off_s, off_s, atol=0.06)
    np.testing.assert_allclose(events.initial_contact_s, off_s + 0.48, atol=0.06)
    assert np.isnan(events.heel_rise_s).all()
    assert np.isnan(events.full_contact_s).all()
    strides = strides_of([events])
    assert set(strides.reason) == {Reason.USED}
    np.testing.assert_allclose(strides.stance_percent, 60.0, atol=6.0)
    phases = [PHASES[k] for k in phases_at(off_s[3] + np.array([-0.3, 0.24, 0.78]), [events])]
    assert phases == [Phase.UNKNOWN, Phase.SWING, Phase.UNKNOWN]

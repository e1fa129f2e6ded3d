"""Tests that coarse, clipped and fast sensors differ from good ones by exactly that."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Joint, Side, Site
from core.samples import FloatArray
from devices.simulation.walker import (
    COARSE,
    NO_ERRORS,
    VERY_COARSE,
    SensorErrors,
    Standing,
    Treadmill,
    Walk,
    WalkerSettings,
    simulate,
)

WALK = WalkerSettings(seed=1, errors=NO_ERRORS, recordings=(Walk(strides=3),))
SITE = Site.LEFT_SHANK


@pytest.mark.endurance
@pytest.mark.parametrize("errors", [COARSE, VERY_COARSE])
def test_a_coarse_sensor_shows_whole_steps_only(errors: SensorErrors) -> None:
    coarse = simulate(replace(WALK, errors=errors)).session.recordings[0].imu[SITE]
    fine = simulate(replace(WALK, errors=replace(errors, gyro_step_rad_s=0.0, acc_step_m_s2=0.0)))
    same = fine.session.recordings[0].imu[SITE]
    for signal, ideal, step in (
        (coarse.gyr_rad_s, same.gyr_rad_s, errors.gyro_step_rad_s),
        (coarse.acc_m_s2, same.acc_m_s2, errors.acc_step_m_s2),
    ):
        np.testing.assert_allclose(signal / step, np.round(signal / step), atol=1e-6)
        away = np.abs(signal - ideal)
        assert 0.4 * step < away.max() <= 0.5 * step * (1 + 1e-9)


def test_a_sensor_stays_within_its_range() -> None:
    limited = replace(NO_ERRORS, gyro_range_rad_s=3.0, acc_range_m_s2=15.0)
    clipped, whole = (simulate(replace(WALK, errors=e)).session.recordings[0].imu[SITE] for e in (limited, NO_ERRORS))
    np.testing.assert_array_equal(clipped.gyr_rad_s, np.clip(whole.gyr_rad_s, -3.0, 3.0))
    np.testing.assert_array_equal(clipped.acc_m_s2, np.clip(whole.acc_m_s2, -15.0, 15.0))
    assert np.abs(whole.gyr_rad_s).max() > 3.0


def test_a_very_coarse_sensor_at_rest_repeats_itself() -> None:
    still = simulate(WalkerSettings(errors=VERY_COARSE, recordings=(Standing(),))).session.recordings[0].imu[SITE]
    assert np.mean(np.diff(still.gyr_rad_s, axis=0) == 0.0) > 0.3


@pytest.mark.endurance
def test_a_fast_clock_stretches_the_stamps_and_takes_more_samples() -> None:
    fast = simulate(replace(WALK, clock_rate={SITE: 1.02}))
    one, other = (s.session.recordings[0].imu[SITE] for s in (fast, simulate(WALK)))
    assert len(one) == pytest.approx(1.02 * len(other), abs=1)
    at = one.time_s / 1.02
    inside = at < other.time_s[-1] - 0.1
    expected = np.stack([np.interp(at, other.time_s, axis) for axis in other.gyr_rad_s.T], axis=-1)
    assert np.sqrt(np.mean((one.gyr_rad_s - expected)[inside] ** 2)) < 0.1
    np.testing.assert_array_equal(fast.session.recordings[0].imu[Site.LEFT_FOOT].time_s,
                                  simulate(WALK).session.recordings[0].imu[Site.LEFT_FOOT].time_s)  # fmt: skip


def test_the_angle_is_reported_at_a_fast_clocks_stamps() -> None:
    fast, plain = (
        simulate(settings).truth.recordings["walk 1"].joints[Joint.LEFT_ANKLE]
        for settings in (replace(WALK, clock_rate={SITE: 1.02}), WALK)
    )
    at = fast.time_s / 1.02
    np.testing.assert_allclose(fast.angle_rad, np.interp(at, plain.time_s, plain.angle_rad), atol=0.01)


FEET = (Site.LEFT_FOOT, Site.RIGHT_FOOT)
ON_FEET = replace(WALK, sites=FEET)


def accelerations(settings: WalkerSettings) -> dict[Site, FloatArray]:
    return {site: block.acc_m_s2 for site, block in simulate(settings).session.recordings[0].imu.items()}


def test_one_sensor_may_be_off_while_the_others_are_not() -> None:
    off = replace(NO_ERRORS, acc_bias_sd_m_s2=0.05, acc_scale_sd=0.003)
    one, plain = (accelerations(s) for s in (replace(ON_FEET, site_errors={FEET[0]: off}), ON_FEET))
    np.testing.assert_array_equal(one[FEET[1]], plain[FEET[1]])
    rows = [np.polyfit(plain[FEET[0]][:, k], one[FEET[0]][:, k], 1, full=True) for k in range(3)]
    for (scale, bias), residual, *_ in rows:
        assert residual[0] < 1e-12
        assert 0.0 < abs(scale - 1.0) < 0.015
        assert 0.0 < abs(bias) < 0.25


def test_a_loose_strap_lets_its_sensor_swing_and_stand_as_it_stood() -> None:
    loose, plain = (accelerations(s) for s in (replace(ON_FEET, loose_straps={FEET[0]: 1.0}), ON_FEET))
    np.testing.assert_array_equal(loose[FEET[1]], plain[FEET[1]])
    apart = np.linalg.norm(loose[FEET[0]] - plain[FEET[0]], axis=1)
    assert apart[:20].max() < 0.1  # before the first step
    assert apart.max() > 5.0


def test_a_belt_that_rises_takes_the_feet_up_and_one_that_ripples_moves_them_while_they_stand() -> None:
    walks = {name: replace(ON_FEET, recordings=(Walk(strides=3, treadmill=belt),)) for name, belt in BELTS.items()}
    feet = {name: simulate(one).truth.recordings["walk 1"].feet[Side.LEFT] for name, one in walks.items()}
    ends_m = {name: foot.ankle_path_m[-1] - foot.ankle_path_m[0] for name, foot in feet.items()}
    np.testing.assert_allclose(ends_m["even"], ends_m["none"], atol=1e-9)
    np.testing.assert_allclose(ends_m["rippling"], ends_m["none"], atol=1e-9)
    assert ends_m["rising"][2] == pytest.approx(0.1 * np.linalg.norm(ends_m["rising"][:2]), abs=0.005)
    foot = feet["none"]
    shown = slice(*np.searchsorted(foot.time_s, [foot.events.full_contact_s[0], foot.events.heel_rise_s[1]]))
    moves_m = {name: float(np.ptp(one.ankle_path_m[shown, :2], axis=0).max()) for name, one in feet.items()}
    assert moves_m["even"] == pytest.approx(moves_m["none"], abs=1e-9)
    assert moves_m["rippling"] > moves_m["none"] + 0.003


BELTS = {"none": None, "even": Treadmill(), "rippling": Treadmill(ripple=0.08), "rising": Treadmill(slope=0.1)}

"""Do coarse, clipped and fast sensors differ from good ones by just that?"""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Joint, Site
from devices.walker import COARSE, NO_ERRORS, VERY_COARSE, SensorErrors, Standing, Walk, WalkerSettings, simulate

WALK = WalkerSettings(seed=1, errors=NO_ERRORS, recordings=(Walk(strides=3),))
SITE = Site.LEFT_SHANK


@pytest.mark.endurance
@pytest.mark.parametrize("errors", [COARSE, VERY_COARSE])
def test_a_coarse_sensor_tells_whole_steps_only(errors: SensorErrors) -> None:
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


def test_the_angle_is_told_at_a_fast_clocks_stamps() -> None:
    fast, plain = (
        simulate(settings).truth.recordings["walk 1"].joints[Joint.LEFT_ANKLE]
        for settings in (replace(WALK, clock_rate={SITE: 1.02}), WALK)
    )
    at = fast.time_s / 1.02
    np.testing.assert_allclose(fast.angle_rad, np.interp(at, plain.time_s, plain.angle_rad), atol=0.01)

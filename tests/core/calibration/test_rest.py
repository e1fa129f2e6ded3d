"""Tests that a sensor is called still only when it is, and that it then gives its bias."""

import numpy as np
import pytest

from core.calibration.rest import rest_of
from core.samples import FloatArray, ImuBlock

BIAS = np.array([0.01, -0.02, 0.005])
DOWN = np.array([1.0, -3.0, 9.2])


def block(gyr: FloatArray, acc: FloatArray, rate_hz: float = 100.0, start_s: float = 0.0) -> ImuBlock:
    return ImuBlock("one", start_s + np.arange(len(gyr)) / rate_hz, gyr, acc)


def still(n: int = 300) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(0)
    return BIAS + 0.002 * rng.normal(size=(n, 3)), DOWN + 0.02 * rng.normal(size=(n, 3))


@pytest.mark.parametrize("start_s", [0.0, 1e9])
@pytest.mark.parametrize("rate_hz", [50.0, 200.0])
def test_standing_gives_bias_and_gravity(rate_hz: float, start_s: float) -> None:
    rest = rest_of(block(*still(), rate_hz=rate_hz, start_s=start_s))
    assert rest is not None
    np.testing.assert_allclose(rest.gyr_rad_s, BIAS, atol=5e-4)
    np.testing.assert_allclose(rest.acc_m_s2, DOWN, atol=5e-3)
    assert rest.duration_s == pytest.approx(300 / rate_hz, rel=0.05)


def test_movement_before_and_after_does_not_enter() -> None:
    gyr, acc = still(600)
    t = np.arange(600) / 100
    moving = (t < 2) | (t > 4)
    gyr[moving] += np.sin(8 * t[moving])[:, None] * [1.0, 2.0, -1.0]
    acc[moving] += 3 * np.cos(8 * t[moving])[:, None]
    rest = rest_of(block(gyr, acc))
    assert rest is not None
    np.testing.assert_allclose(rest.gyr_rad_s, BIAS, atol=0.01)
    assert 1.0 < rest.duration_s < 2.1


def test_a_steady_turn_is_no_bias() -> None:
    gyr, acc = still()
    assert rest_of(block(gyr + np.array([0.0, 0.0, 0.5]), acc)) is None


def test_walking_never_rests() -> None:
    t = np.arange(1000) / 100
    gyr = np.stack([2 * np.sin(6 * t), np.cos(12 * t), 0.3 * np.sin(6 * t + 1)], axis=1)
    assert rest_of(block(gyr, DOWN + gyr)) is None


@pytest.mark.parametrize("n", [0, 1, 4, 20])
def test_hardly_any_samples_are_no_rest(n: int) -> None:
    gyr, acc = still()
    assert rest_of(block(gyr[:n], acc[:n])) is None


def test_missing_samples_do_not_hide_a_rest() -> None:
    gyr, acc = still()
    gyr[::7] = np.nan
    rest = rest_of(block(gyr, acc))
    assert rest is not None
    np.testing.assert_allclose(rest.gyr_rad_s, BIAS, atol=5e-4)

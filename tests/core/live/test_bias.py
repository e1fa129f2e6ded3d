"""A gyroscope bias that the first rest contradicts is set again, once and on no other ground."""

import numpy as np
import pytest

from core.body import Site
from core.live.bias import BiasWatch
from core.live.sensors import LiveSensor, LiveSensors
from core.live.streams import EvenSamples
from core.samples import FloatArray, ImuBlock, RateKind

RATE_HZ = 100.0
NO_BIAS = np.zeros(3)
UP = np.array([0.0, 0.0, 9.81])


def block(gyr: FloatArray, acc: FloatArray | None = None, from_s: float = 0.0) -> ImuBlock:
    """Rates (n, 3), with a gyroscope's and an accelerometer's noise."""
    rng = np.random.default_rng(1)
    noise = rng.normal(size=(2, *gyr.shape))
    force = (UP if acc is None else acc) + 0.01 * noise[1]
    return ImuBlock("s", from_s + np.arange(len(gyr)) / RATE_HZ, gyr + 0.002 * noise[0], force)


def rest(off_deg_s: float, duration_s: float = 3.0) -> FloatArray:
    return np.tile(np.deg2rad([0.6, 0.0, 0.8]) * off_deg_s, (round(duration_s * RATE_HZ), 1))


def swinging(duration_s: float = 4.0) -> FloatArray:
    t = np.arange(round(duration_s * RATE_HZ)) / RATE_HZ
    return np.stack([2.0 * np.sin(6.0 * t), 0.3 * np.cos(5.0 * t), np.zeros_like(t)], axis=1)


@pytest.mark.parametrize("kind", list(RateKind))
@pytest.mark.parametrize("size", [1, 7, 10_000])
def test_the_first_rest_after_a_movement_corrects_a_bias_and_states_by_how_much(size: int, kind: RateKind) -> None:
    gyr = np.concatenate([swinging(), rest(0.0)]) + rest(5.0)[0]
    samples = block(gyr)
    live = LiveSensors({Site.LEFT_SHANK: LiveSensor(RATE_HZ, NO_BIAS, kind)})
    found = []
    for k in range(0, len(samples), size):
        turned = live.update({Site.LEFT_SHANK: samples.select(slice(k, k + size))})
        found += list(turned.values())
    (one,) = live.corrections
    assert np.rad2deg(one.off_rad_s) == pytest.approx(5.0, abs=0.1)
    assert one.at_s == pytest.approx(5.1, abs=0.2)
    rates, ticks = (np.concatenate([getattr(part, name) for part in found]) for name in ("gyr_rad_s", "tick"))
    assert np.rad2deg(np.abs(rates[-100:].mean(axis=0)).max()) < 0.1
    assert sorted(set(np.diff(ticks).tolist())) == [1, 2]  # angles begin again


@pytest.mark.parametrize("off_deg_s", [0.0, 1.5])
def test_a_bias_that_is_nearly_right_stays(off_deg_s: float) -> None:
    live = LiveSensors({Site.LEFT_SHANK: LiveSensor(RATE_HZ, NO_BIAS)})
    live.update({Site.LEFT_SHANK: block(rest(off_deg_s))})
    live.update({Site.LEFT_SHANK: block(rest(5.0), from_s=3.0)})
    assert live.corrections == ()  # only the first rest is asked


def watched(gyr: FloatArray, acc: FloatArray | None = None) -> FloatArray | None:
    """The bias that is found."""
    samples = block(gyr, acc)
    even = EvenSamples(
        np.arange(len(samples)), samples.time_s, samples.gyr_rad_s, samples.acc_m_s2, np.ones(len(samples), dtype=bool)
    )
    watch, found = BiasWatch(NO_BIAS, 1.0 / RATE_HZ), None
    while len(even) and found is None:
        count = watch.reach(even)
        found, even = watch.update(even.part(slice(0, count))), even.part(slice(count, None))
    return None if found is None else found.gyr_rad_s.mean(axis=0)


def test_a_sensor_that_turns_slowly_and_evenly_is_not_at_rest() -> None:
    gyr = np.tile([np.deg2rad(6.0), 0.0, 0.0], (100, 1))
    tilt = np.deg2rad(6.0) * np.arange(100) / RATE_HZ
    turning = 9.81 * np.stack([np.zeros(100), np.sin(tilt), np.cos(tilt)], axis=1)
    assert watched(gyr, turning) is None
    assert watched(gyr) == pytest.approx(gyr[0], abs=0.001)


def test_a_moving_sensor_is_not_at_rest() -> None:
    assert watched(swinging(1.0)) is None
    assert watched(rest(20.0, 1.0)) is None

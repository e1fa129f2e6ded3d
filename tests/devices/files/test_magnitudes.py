"""Units held to the size of what was measured: what must be refused, and what people do that must not be."""

import numpy as np
import pytest

from core.samples import FloatArray
from devices.files.magnitudes import check_magnitudes, times_the_turning
from devices.files.refusal import FileRefusedError
from tests.swinging_sensor import swinging_sensor

G = 9.80665
ROWS, HZ = 1000, 100.0


def still() -> tuple[FloatArray, FloatArray]:
    noise = np.random.default_rng(0).normal(0.0, 0.02, (2, ROWS, 3))
    return noise[0] + [0.0, 0.0, G], noise[1]


def running() -> tuple[FloatArray, FloatArray]:
    """A foot at three steps a second: up to 16 g when it lands, 2.5 g in the middle, 30 rad/s while it swings."""
    phase = 2.0 * np.pi * 1.5 * np.arange(ROWS) / HZ
    size = G * (2.5 + 13.5 * np.clip(np.sin(phase), 0.0, None) ** 12)
    zero = np.zeros(ROWS)
    return np.column_stack([zero, size * 0.6, size * 0.8]), np.column_stack([30.0 * np.sin(phase), zero, zero])


def clipped() -> tuple[FloatArray, FloatArray]:
    """Of a range of 2 g and of 500 deg/s, which is left in one direction only."""
    acc, gyr = running()
    return np.minimum(0.7 * acc, 2.0 * G), np.minimum(gyr, np.radians(500.0))


def with_one_damaged() -> tuple[FloatArray, FloatArray]:
    acc, gyr = still()
    acc[17], gyr[17, 1] = 1e5, 1e5
    return acc, gyr


def with_losses() -> tuple[FloatArray, FloatArray]:
    acc, gyr = still()
    acc[::2], gyr[::3] = np.nan, np.nan
    return acc, gyr


def nothing() -> tuple[FloatArray, FloatArray]:
    return np.full((ROWS, 3), np.nan), np.empty((0, 3))


@pytest.mark.parametrize("is_export", [True, False])
@pytest.mark.parametrize("motion", [still, running, clipped, with_one_damaged, with_losses, nothing])
def test_what_people_do_and_sensors_lose_is_no_other_unit(motion: object, is_export: bool) -> None:
    assert callable(motion)
    acc, gyr = motion()
    check_magnitudes(acc, gyr, "a", "a.csv", is_export=is_export)


@pytest.mark.parametrize("motion", [still, running])
@pytest.mark.parametrize("factor", [1.0 / G, G, 100.0, 1000.0, 1000.0 / G])
def test_the_same_in_another_unit_is_refused_with_what_to_do(motion: object, factor: float) -> None:
    assert callable(motion)
    acc, _ = motion()
    with pytest.raises(
        FileRefusedError, match=r'a.csv: the median acceleration of "left" is .*, which does not match gravity'
    ) as refused:
        check_magnitudes(factor * acc, None, "left", "a.csv")
    assert "m/s2" in refused.value.remedy
    with pytest.raises(FileRefusedError, match="which does not match gravity") as of_sensor:
        check_magnitudes(factor * acc, None, "left", "a.bin", is_export=False)
    assert "record again" in of_sensor.value.remedy


def test_acceleration_without_gravity_is_refused() -> None:
    free = 4.0 * swinging_sensor().free_m_s2  # as of a walking shank
    with pytest.raises(FileRefusedError, match="Export the file again in m/s2, with gravity included"):
        check_magnitudes(free, None, "a", "a.csv")


def test_rates_beyond_every_range_are_in_another_unit() -> None:
    acc, gyr = running()
    with pytest.raises(FileRefusedError, match=r'of "a" are in deg/s, not in rad/s. Export the file again in rad/s'):
        check_magnitudes(acc, np.degrees(gyr), "a", "a.csv")
    with pytest.raises(FileRefusedError, match=r"beyond the range of any sensor. Export the file again in deg/s"):
        check_magnitudes(acc, np.degrees(gyr), "a", "a.csv", gyr_unit="deg/s")
    with pytest.raises(FileRefusedError, match=r"beyond the range of any sensor. Check the sensor's range"):
        check_magnitudes(acc, np.degrees(gyr), "a", "a.bin", is_export=False)


@pytest.mark.parametrize("scale", [1.0, np.pi / 180, 180 / np.pi])
def test_the_orientation_shows_by_how_much_rates_are_off(scale: float) -> None:
    swing = swinging_sensor()
    counter = np.arange(len(swing.time_s))
    found = times_the_turning(scale * swing.gyr_rad_s, swing.q_earth_from_sensor, counter, 100.0)
    assert found == pytest.approx(scale, rel=0.01)
    assert np.isnan(times_the_turning(swing.gyr_rad_s, swing.q_earth_from_sensor[:1].repeat(300, 0), counter, 100.0))

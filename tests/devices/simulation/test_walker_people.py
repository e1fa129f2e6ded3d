"""Tests that simulated people differ as much as stated."""

import numpy as np
import pytest

from core.body import Side
from core.samples import FloatArray
from devices.simulation.walker_body import WalkerSettings, make_leg
from devices.simulation.walker_motion import NO_EVENTS, JointAngles, LegMotion
from devices.simulation.walker_sensors import _liveliness, interpolate

PEOPLE = 400


@pytest.mark.parametrize("side", list(Side))
def test_joint_axes_lean_as_much_forward_as_upward(side: Side) -> None:
    """Knees by 3 degrees each way from straight across, ankles by 0.04 from the malleoli; 400 people report to 4 %."""
    legs = [make_leg(WalkerSettings(seed=seed), side) for seed in range(PEOPLE)]
    knees = np.array([leg.knee_axis / leg.knee_axis[1] for leg in legs])
    ankles = np.array([leg.ankle_axis / -leg.ankle_axis[1] for leg in legs])
    assert np.std(knees[:, 0]) == pytest.approx(np.tan(np.deg2rad(3.0)), rel=0.15)
    assert np.std(knees[:, 2]) == pytest.approx(np.tan(np.deg2rad(3.0)), rel=0.15)
    np.testing.assert_allclose(np.mean(knees, axis=0), [0.0, 1.0, 0.0], atol=0.01)
    assert np.std(ankles[:, 0]) == pytest.approx(0.04, rel=0.15)
    assert np.std(ankles[:, 2]) == pytest.approx(0.04, rel=0.15)
    outward = 1.0 if side is Side.LEFT else -1.0
    np.testing.assert_allclose(np.mean(ankles, axis=0), [0.08 * outward, -1.0, 0.10 * outward], atol=0.01)


def test_what_lies_between_samples_is_exact_for_a_cubic() -> None:
    index = np.arange(12.0)
    at = np.linspace(1.0, 9.9, 40)

    def curves(x: FloatArray) -> FloatArray:
        return np.stack([2.0 + x - 0.3 * x**2 + 0.05 * x**3, 1.0 - 0.02 * (x - 4.0) ** 3], axis=1)

    np.testing.assert_allclose(interpolate(curves(index), at), curves(at), atol=1e-10)


@pytest.mark.parametrize(
    ("rate_rad_s", "expected"),
    [(0.2, 0.0), (1.575, 0.25), (3.15 / np.sqrt(2.0), 0.5), (3.1, (3.1 / 3.15) ** 2), (6.0, 1.0)],
)
def test_tissue_shakes_as_the_square_of_how_fast_the_knee_bends(rate_rad_s: float, expected: float) -> None:
    """A knee that bends and stretches at one rate for 5 of 10 s; 3.15 rad/s, and all that is faster, shakes in full."""
    time_s = 0.001 * np.arange(10_000)
    knee = rate_rad_s * np.abs((np.minimum(time_s, 5.0) + 0.25) % 1.0 - 0.5)
    zero = np.zeros_like(knee)
    leg = LegMotion(time_s, JointAngles(knee, zero, zero, zero), np.empty(0), np.empty(0), NO_EVENTS, np.empty((0, 2)))
    assert _liveliness(leg) == pytest.approx(expected, abs=0.005)

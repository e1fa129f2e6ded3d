"""Tests that the heading by forces walks down the robust cost that it is stated to."""

from dataclasses import replace

import numpy as np

from core.body import Joint
from core.calibration.heading import FORCE_CORRELATION_S, _force_terms
from core.samples import FloatArray
from core.signal.datasets import gather
from tests.core.hinges import Person

STEP_RAD = 1e-6


def test_the_slope_is_that_of_a_cost_that_grows_evenly_far_out() -> None:
    """The cost sqrt(1 + |f1 - Rz f2|^2 / s^2), s the components' spread; of samples 0.02 s apart a fifth is news."""
    pair = Person(seed=3).exact_pair(Joint.LEFT_KNEE)
    data = gather((pair,), [np.arange(50, 250)])
    spacing_s = 0.2 * FORCE_CORRELATION_S
    data = replace(data, time_s=spacing_s * np.arange(len(data)))
    rng = np.random.default_rng(4)
    one, two = (rng.normal(size=len(data)) + 1j * rng.normal(size=len(data)) for _ in range(2))
    one[::9] *= 20.0  # impacts
    heading = rng.uniform(-3.0, 3.0, len(data))
    apart = one - np.exp(1j * heading) * two
    spread = 1.4826 * np.median(np.abs(np.concatenate([apart.real, apart.imag])))

    def cost(at_rad: FloatArray) -> FloatArray:
        return np.asarray(np.sqrt(1.0 + np.abs(one - np.exp(1j * at_rad) * two) ** 2 / spread**2))

    expected = 0.2 * (cost(heading + STEP_RAD) - cost(heading - STEP_RAD)) / (2.0 * STEP_RAD)
    slope, bend = _force_terms(data, (one, two), heading)
    np.testing.assert_allclose(slope, expected, atol=1e-3 * np.abs(expected).max())
    np.testing.assert_allclose(bend, 0.2 * np.abs(two) ** 2 / spread**2 / cost(heading), rtol=1e-3)

"""The median is NumPy's; the spread is that of the middle of the values, whatever a few of them do."""

import numpy as np
import pytest

from core.signal.robust import median_of, robust_sd


@pytest.mark.parametrize("count", [1, 2, 3, 20, 99, 100])
def test_the_median_is_numpys_and_the_values_stay_in_their_order(count: int) -> None:
    values = np.random.default_rng(count).normal(size=count)
    before = values.copy()
    assert median_of(values) == np.median(values)
    np.testing.assert_array_equal(values, before)


@pytest.mark.parametrize("count", [1, 2, 101])
def test_nothing_is_known_of_values_of_which_one_is_not(count: int) -> None:
    values = np.arange(float(count))
    values[0] = np.nan
    assert np.isnan(median_of(values))
    assert np.isnan(robust_sd(values))
    assert np.isnan(robust_sd(np.empty(0)))


def test_a_few_wild_values_hardly_widen_the_spread() -> None:
    values = np.random.default_rng(0).normal(scale=2.0, size=1000)
    values[:20] = 1e6
    assert robust_sd(values) == pytest.approx(2.0, rel=0.1)

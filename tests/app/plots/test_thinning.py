"""Fewer points than samples, and nothing lost that can be seen."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.plots.thinning import envelope, thin
from core.samples import FloatArray


def ramp(n: int) -> tuple[FloatArray, FloatArray]:
    time_s = np.arange(n) / 100
    return time_s, np.sin(time_s)


def test_few_samples_stay_as_they_are() -> None:
    time_s, values = ramp(200)
    kept_s, kept = thin(time_s, values, columns=100)
    assert kept_s is time_s
    assert kept is values


@given(st.integers(2_000, 50_000), st.integers(0, 49_999))
def test_a_single_peak_is_kept(n: int, at: int) -> None:
    time_s, values = ramp(n)
    values[at % n] = 90.0
    kept_s, kept = thin(time_s, values, columns=200)
    assert len(kept) <= 2 * 200 + n // 200 + 200
    assert time_s[at % n] in kept_s[kept == 90.0]
    assert np.all(np.diff(kept_s) >= 0)


def test_a_long_gap_stays_a_gap() -> None:
    time_s, values = ramp(20_000)
    values[8_000:12_000] = np.nan
    kept_s, kept = thin(time_s, values, columns=200)
    inside = (kept_s > 81) & (kept_s < 119)
    assert inside.any()
    assert np.isnan(kept[inside]).all()
    assert np.isfinite(kept[(kept_s < 79) | (kept_s > 121)]).all()


def test_single_missing_samples_do_not_widen_into_gaps() -> None:
    time_s, values = ramp(20_000)
    values[::50] = np.nan
    assert np.isfinite(thin(time_s, values, columns=200)[1]).all()


def test_a_band_keeps_its_reach_and_its_gap() -> None:
    time_s, values = ramp(20_000)
    values[8_000:12_000] = np.nan
    values[3_000] = 90.0
    kept_s, low, high = envelope(time_s, values - 1, values + 2, columns=200)
    assert len(kept_s) == len(low) == len(high) == 200
    assert np.nanmax(high) == 92.0
    assert np.nanmin(low) == np.nanmin(values) - 1
    np.testing.assert_array_equal(np.isnan(low), (kept_s > 80) & (kept_s < 120))
    np.testing.assert_array_equal(np.isnan(low), np.isnan(high))

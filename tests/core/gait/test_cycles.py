"""Tests that angles are brought to 0-100 % of each stride. Their peaks are where a clinician finds them."""

import numpy as np
import pytest

from core.gait.cycles import POINTS, cycles_of, excursion_of_cycles, find_peak, mean_cycle, range_of_cycles
from core.gait.symmetry import curve_difference, gait_variable_score, symmetry_index_percent
from core.parameters import EXCURSIONS, PeakWindow

TIME_S = np.arange(0.0, 5.0, 0.01)
START_S = np.array([0.5, 1.6, 2.7])
END_S = START_S + 1.1


def angle() -> np.ndarray:
    return 30.0 - 30.0 * np.cos(2 * np.pi * (TIME_S - 0.5) / 1.1)


def test_each_stride_is_brought_to_its_own_percent() -> None:
    cycles = cycles_of(TIME_S, angle(), START_S, END_S)
    assert cycles.shape == (3, 101)
    np.testing.assert_allclose(
        cycles, np.tile(30.0 - 30.0 * np.cos(2 * np.pi * np.linspace(0, 1, 101)), (3, 1)), atol=0.05
    )
    np.testing.assert_allclose(range_of_cycles(cycles), 60.0, atol=0.1)


def test_a_gap_drops_its_stride_only() -> None:
    broken = angle()
    broken[(TIME_S > 2.0) & (TIME_S < 2.1)] = np.nan
    cycles = cycles_of(TIME_S, broken, START_S, END_S)
    assert np.isfinite(cycles).all(axis=1).tolist() == [True, False, True]
    assert mean_cycle(cycles).n == 2


@pytest.mark.parametrize(("lost_s", "is_known"), [(0.03, True), (0.2, False)])
def test_stamps_that_are_missing_drop_their_stride_as_missing_angles_do(lost_s: float, is_known: bool) -> None:
    since_s = TIME_S - 2.0
    is_there = (since_s < 0.0) | (since_s > lost_s)
    cycles = cycles_of(TIME_S[is_there], angle()[is_there], START_S, END_S)
    assert np.isfinite(cycles).all(axis=1).tolist() == [True, is_known, True]


def test_a_low_rate_is_no_gap() -> None:
    assert np.isfinite(cycles_of(TIME_S[::6], angle()[::6], START_S, END_S)).all()


def test_a_stride_beyond_the_recording_is_not_known() -> None:
    cycles = cycles_of(TIME_S, angle(), np.array([-0.5, 4.5]), np.array([0.6, 5.6]))
    assert np.isnan(cycles).all()
    assert cycles_of(np.empty(0), np.empty(0), START_S, END_S).shape == (3, 101)


def test_mean_and_sd_of_strides() -> None:
    reported = mean_cycle(np.stack([np.full(101, 1.0), np.full(101, 3.0)]))
    np.testing.assert_allclose(reported.mean, 2.0)
    np.testing.assert_allclose(reported.sd, np.sqrt(2.0))
    assert mean_cycle(np.empty((0, 101))).n == 0


def test_a_peak_is_found_in_its_window() -> None:
    peak = find_peak(cycles_of(TIME_S, angle(), START_S, END_S), PeakWindow("swing", 30, 90, True))
    np.testing.assert_allclose(peak.value, 60.0, atol=0.05)
    np.testing.assert_allclose(peak.percent, 50.0, atol=1.0)


def test_an_extremum_at_the_edge_of_the_window_is_no_peak() -> None:
    peak = find_peak(cycles_of(TIME_S, angle(), START_S, END_S), PeakWindow("rising", 10, 40, True))
    assert np.isnan(peak.value).all()
    assert np.isnan(peak.percent).all()


def test_the_symmetry_index_is_for_positive_figures_only() -> None:
    assert symmetry_index_percent(1.1, 0.9) == pytest.approx(20.0)
    assert symmetry_index_percent(0.9, 1.1) == pytest.approx(-20.0)
    assert np.isnan(symmetry_index_percent(-2.0, 2.5))
    assert np.isnan(symmetry_index_percent(float("nan"), 2.5))


def test_curves_are_compared_point_by_point() -> None:
    one = np.linspace(0.0, 10.0, 101)
    assert curve_difference(one, one + 3.0) == pytest.approx(3.0)
    assert gait_variable_score(one, one - 4.0) == pytest.approx(4.0)


@pytest.mark.parametrize("lost", [51, 100, 159, 160, 161])
def test_one_missing_sample_anywhere_makes_its_stride_missing_throughout(lost: int) -> None:
    """The stride lies between the samples 50 and 51 at one end, 160 and 161 at the other."""
    broken = angle()
    broken[lost] = np.nan
    start_s = np.array([0.503, 1.613])
    cycles = cycles_of(TIME_S, broken, start_s, start_s + 1.1)
    assert np.isnan(cycles[0]).all()
    assert np.isfinite(cycles[1]).all() == (lost < 161)


def test_an_excursion_is_the_height_of_neither_end_and_none_without_a_peak() -> None:
    percent = np.arange(POINTS)
    knee = 10.0 * np.exp(-(((percent - 15) / 6) ** 2)) + 60.0 * np.exp(-(((percent - 73) / 9) ** 2))
    knee = np.tile(knee, (4, 1))
    found = {one.name: excursion_of_cycles(knee, one) for one in EXCURSIONS if one.name.startswith("knee")}
    assert found["knee_stance_to_swing"] == pytest.approx(60.0, abs=0.3)
    assert found["knee_while_loading"] == pytest.approx(10.0, abs=0.3)
    raised = {one.name: excursion_of_cycles(knee + 12.0, one) for one in EXCURSIONS if one.name.startswith("knee")}
    for name, values in found.items():
        np.testing.assert_allclose(raised[name], values, atol=1e-12)
    without_loading = np.tile(60.0 * np.exp(-(((percent - 73) / 9) ** 2)) + 0.1 * percent, (4, 1))
    loading = next(one for one in EXCURSIONS if one.name == "knee_while_loading")
    assert np.isnan(excursion_of_cycles(without_loading, loading)).all()
    assert excursion_of_cycles(np.empty((0, POINTS)), loading).shape == (0,)

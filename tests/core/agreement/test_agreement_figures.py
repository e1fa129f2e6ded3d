"""Tests that the figures of agreement match their definitions. The oracle is written out here, in NumPy."""

import numpy as np
import pytest

from core.agreement.figures import Agreement, agreement_of, over_walks
from core.gait.phases import PHASES, Phase

RNG = np.random.default_rng(11)


def curves(n: int = 600, bias: float = 0.05, gain: float = 1.1) -> tuple[np.ndarray, np.ndarray]:
    reference = 0.4 + 0.5 * np.sin(np.arange(n) / 17.0)
    return gain * reference + bias + RNG.normal(0, 0.01, n), reference


def found_of(*args: object, **more: object) -> Agreement:
    found = agreement_of(*args, **more)  # type: ignore[arg-type]  # passed on as it came
    assert found is not None
    return found


def test_the_figures_are_those_of_their_definitions() -> None:
    one, other = curves()
    found = found_of(one, other)
    e = one - other
    assert found.samples == 600
    assert found.z_rad == pytest.approx(np.sqrt((e @ e) / 600))
    assert found.bias_rad == pytest.approx(e.sum() / 600)
    assert found.m_rad == pytest.approx(np.sqrt(((e - e.mean()) ** 2).sum() / 600))
    assert found.sd_rad == pytest.approx(np.sqrt(((e - e.mean()) ** 2).sum() / 599))
    assert found.low_rad == pytest.approx(e.mean() - 1.96 * found.sd_rad)
    assert found.high_rad == pytest.approx(e.mean() + 1.96 * found.sd_rad)
    a, b = one - one.mean(), other - other.mean()
    assert found.correlation == pytest.approx((a @ b) / np.sqrt((a @ a) * (b @ b)))
    assert found.z_rad**2 == pytest.approx(found.m_rad**2 + found.bias_rad**2)


def test_what_only_one_system_saw_does_not_count() -> None:
    one, other = curves()
    holes = one.copy()
    holes[50:120] = np.nan
    gaps = other.copy()
    gaps[300:310] = np.nan
    known = np.r_[0:50, 120:300, 310:600]
    whole, part = found_of(holes, gaps), found_of(one[known], other[known])
    assert whole.samples == 520
    assert (whole.z_rad, whole.m_rad, whole.correlation) == pytest.approx((part.z_rad, part.m_rad, part.correlation))


def test_too_few_samples_are_no_figure() -> None:
    one, other = curves()
    one[9:] = np.nan
    assert agreement_of(one, other) is None
    assert over_walks([]) is None


def test_the_range_error_is_of_each_stride_and_a_stride_with_a_gap_is_left_out() -> None:
    one, other = curves()
    one[250] = np.nan
    strides = np.array([[0, 99], [100, 199], [200, 299], [300, 399]])
    found = found_of(one, other, strides=strides)
    errors = [np.ptp(one[a : b + 1]) - np.ptp(other[a : b + 1]) for a, b in strides[[0, 1, 3]]]
    assert found.ranges == 3
    assert found.range_error_rad == pytest.approx(np.mean(errors))
    assert found.range_error_sd_rad == pytest.approx(np.std(errors, ddof=1))


def test_without_strides_the_range_is_that_of_the_recording() -> None:
    one, other = curves()
    found = found_of(one, other)
    assert found.ranges == 1
    assert found.range_error_rad == pytest.approx((one.max() - one.min()) - (other.max() - other.min()))
    assert np.isnan(found.range_error_sd_rad)


def test_errors_are_reported_by_phase_with_the_mean_of_the_walk_taken_out() -> None:
    n = 400
    other = np.sin(np.arange(n) / 9.0)
    phase = np.repeat([PHASES.index(p) for p in (Phase.UNKNOWN, Phase.LOADING, Phase.FOOT_FLAT, Phase.SWING)], 100)
    extra = np.repeat([0.0, 0.3, 0.1, -0.2], 100)
    found = found_of(other + extra + 7.0, other, phase=phase)
    shape = extra - extra.mean()
    assert set(found.by_phase) == {Phase.LOADING, Phase.FOOT_FLAT, Phase.SWING}
    assert found.by_phase[Phase.LOADING].bias_rad == pytest.approx(shape[150])
    assert found.by_phase[Phase.SWING].rms_rad == pytest.approx(abs(shape[350]))
    stance = found.in_phases((Phase.LOADING, Phase.FOOT_FLAT, Phase.PRE_SWING))
    assert stance.samples == 200
    assert stance.rms_rad == pytest.approx(np.sqrt(np.mean(shape[100:300] ** 2)))


def test_an_honest_sd_holds_68_and_95_percent_and_a_boastful_one_does_not() -> None:
    rng = np.random.default_rng(5)
    other = np.sin(np.arange(20_000) / 50.0)
    one = other + rng.normal(0.2, 0.05, len(other))  # a wrong zero is no matter of the sd, which is of the shape
    honest, boastful = (found_of(one, other, np.full(len(one), sd)) for sd in (0.05, 0.01))
    assert honest.within_1_sd == pytest.approx(0.683, abs=0.02)
    assert honest.within_2_sd == pytest.approx(0.954, abs=0.02)
    assert boastful.within_2_sd < 0.4
    assert np.isnan(found_of(one, other).within_1_sd)


def test_without_a_zero_height_states_nothing_and_shape_all() -> None:
    one, other = curves()
    found, not_reported = found_of(one, other), found_of(one, other, has_zero=False)
    for name in ("z_rad", "bias_rad", "low_rad", "high_rad"):
        assert np.isnan(getattr(not_reported, name))
    assert (not_reported.m_rad, not_reported.sd_rad, not_reported.correlation) == (
        found.m_rad,
        found.sd_rad,
        found.correlation,
    )


def test_table_1_is_the_mean_and_the_sd_over_trials() -> None:
    walks = [found_of(*curves(bias=bias)) for bias in (0.02, 0.05, -0.04, 0.01, 0.03, 0.0)]
    found = over_walks(walks)
    assert found is not None
    z = np.array([walk.z_rad for walk in walks])
    assert found.walks == 6
    assert found.whole.z_rad == pytest.approx(z.sum() / 6)
    assert found.z_sd_rad == pytest.approx(np.sqrt(((z - z.mean()) ** 2).sum() / 5))
    bias, sd = (np.array([getattr(walk, name) for walk in walks]) for name in ("bias_rad", "sd_rad"))
    total = np.sqrt(np.mean(sd**2) + np.sum((bias - bias.mean()) ** 2) / 5)
    assert found.whole.sd_rad == pytest.approx(total)
    assert found.whole.high_rad - found.whole.low_rad == pytest.approx(2 * 1.96 * total)


def test_the_papers_own_rows_have_its_average_and_sigma() -> None:
    """Three of its four rows; in that of the sound knee, 0.40 among values over 2.7 fits neither average nor text."""
    for degrees, sd, average in (
        ([0.46, 0.89, 0.59, 0.95, 0.57, 0.77], 0.19, 0.71),
        ([0.92, 1.03, 0.91, 0.65, 0.67, 0.69], 0.16, 0.81),
        ([0.95, 1.50, 1.25, 1.53, 1.85, 2.61], 0.57, 1.62),
    ):
        other = np.sin(np.arange(500) / 9.0)
        found = over_walks([found_of(other + value, other) for value in degrees])
        assert found is not None
        assert found.whole.z_rad == pytest.approx(average, abs=0.006)
        assert found.z_sd_rad == pytest.approx(sd, abs=0.006)


def test_ranges_of_all_strides_of_all_walks_are_pooled() -> None:
    strides = np.array([[0, 99], [100, 199], [200, 299]])
    pairs = [curves(gain=gain) for gain in (1.0, 1.2)]
    found = over_walks([found_of(*pairs[0], strides=strides), found_of(*pairs[1], strides=strides[:2])])
    assert found is not None
    errors = [
        np.ptp(one[a : b + 1]) - np.ptp(other[a : b + 1])
        for (one, other), rows in zip(pairs, (strides, strides[:2]), strict=True)
        for a, b in rows
    ]
    assert found.whole.ranges == 5
    assert found.whole.range_error_rad == pytest.approx(np.mean(errors))
    assert found.whole.range_error_sd_rad == pytest.approx(np.std(errors, ddof=1))

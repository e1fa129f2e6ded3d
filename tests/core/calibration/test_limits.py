"""Tests that rest, sign and certainty change where they are stated to. All limits and figures are written out."""

import numpy as np
import pytest

from core.calibration.certainty import axis_sd_rad
from core.calibration.clinical_sign import ClinicalSign, ankle_sign, forward_swing, knee_sign, range_of, skewness
from core.calibration.rest import Rest, rest_of
from core.calibration.zero import standing_twist, within_half_a_turn, wrapped_to_zero
from core.samples import FloatArray, ImuBlock

DEG = np.pi / 180.0
STEPS = np.linspace(0.0, 1.0, 1001)


# signs


def swinging(low_rad_s: float, high_rad_s: float) -> FloatArray:
    """Rates spread evenly between two, of which the outer half percent does not count."""
    return low_rad_s + (high_rad_s - low_rad_s) * (STEPS * 1.01 - 0.005)


def bent(low_deg: float, high_deg: float) -> FloatArray:
    """Angles spread so evenly that 2 and 98 % of them lie below the two."""
    return DEG * (low_deg + (high_deg - low_deg) * (STEPS * 1.0 / 0.96 - 0.02 / 0.96))


def test_skewness_is_the_middle_of_two_quantiles_over_half_their_distance() -> None:
    """Of -1, 0, ... 9 all: (9 - 1) / (9 + 1); with a tenth left out at either end: (8 + 0) / (8 - 0)."""
    values = np.arange(-1.0, 10.0)
    assert skewness(values, 0.0) == pytest.approx(0.8)
    assert skewness(values, 0.1) == pytest.approx(1.0)
    assert skewness(-values, 0.0) == pytest.approx(-0.8)


def test_the_range_leaves_two_percent_out_at_either_end() -> None:
    assert range_of(np.arange(101.0)) == pytest.approx(96.0)


def test_a_shank_swings_that_turns_through_one_point_four_radians_a_second() -> None:
    assert forward_swing(swinging(-0.2, 1.19)) == 0.0
    assert forward_swing(swinging(-0.2, 1.21)) == pytest.approx(1.01 / 1.41, abs=1e-3)
    assert forward_swing(swinging(-3.0, 1.0)) == pytest.approx(-0.5, abs=1e-3)


def test_a_knee_s_margin_is_its_bending_and_twice_its_swinging() -> None:
    """Bending -10 to 40 degrees is 0.6, swinging -1 to 3 rad/s 0.5."""
    both = knee_sign(bent(-10, 40), swinging(-1.0, 3.0), is_walking=True, has_standing=False)
    assert (both.sign, both.is_certain, both.is_contradicted) == (1, True, False)
    assert both.margin == pytest.approx(1.6, abs=5e-3)
    alone = knee_sign(bent(-10, 40), swinging(-1.0, 3.0), is_walking=False, has_standing=True)
    assert (alone.sign, alone.is_certain) == (1, True)
    assert alone.margin == pytest.approx(0.6, abs=5e-3)


@pytest.mark.parametrize(("high_deg", "is_certain"), [(9.5, False), (10.5, True)])
def test_a_knee_that_bends_less_than_ten_degrees_shows_nothing(high_deg: float, is_certain: bool) -> None:
    found = knee_sign(bent(0.0, high_deg), swinging(-1.0, 3.0), is_walking=True, has_standing=True)
    assert found.is_certain == is_certain
    assert found.margin == pytest.approx(2.0 if is_certain else 1.0, abs=5e-3)  # swinging reports the likelier sign


@pytest.mark.parametrize(("low_deg", "is_certain"), [(-13.5, True), (-14.5, False), (-20.0, False)])
def test_a_knee_needs_a_margin_of_a_half(low_deg: float, is_certain: bool) -> None:
    """To 42 degrees: margins of 0.51, 0.49 and 0.35."""
    found = knee_sign(bent(low_deg, 42.0), np.zeros(5), is_walking=False, has_standing=True)
    assert found.margin == pytest.approx((42.0 + low_deg) / (42.0 - low_deg), abs=5e-3)
    assert found.is_certain == is_certain


@pytest.mark.parametrize(("back_rad_s", "is_contradicted"), [(-1.3, False), (-1.6, True), (-20.0, True)])
def test_bending_and_swinging_contradict_each_other_if_the_weaker_has_half_of_the_stronger(
    back_rad_s: float, is_contradicted: bool
) -> None:
    """Bending all one way is 1; swinging to 1 rad/s the other way counts twice: 0.26, 0.46 and 1.8 of it."""
    found = knee_sign(bent(0.0, 60.0), swinging(back_rad_s, 1.0), is_walking=True, has_standing=True)
    swing = 2 * (back_rad_s + 1.0) / (1.0 - back_rad_s)
    assert found.margin == pytest.approx(abs(1.0 + swing), abs=1e-2)
    expected = min(1.0, -swing) > 0.5 * max(1.0, -swing)
    assert found.is_contradicted == expected
    assert found.is_certain == (not expected and found.margin > 0.25)
    assert is_contradicted == expected or abs(-swing - 0.5) < 0.1


@pytest.mark.parametrize(("alignment", "is_certain"), [(0.51, True), (0.49, False), (-0.51, True), (-0.49, False)])
def test_an_ankle_follows_a_knee_whose_axis_is_within_sixty_degrees(alignment: float, is_certain: bool) -> None:
    knee = ClinicalSign(1, 0.9, True)
    found = ankle_sign(knee, alignment, np.zeros(5), is_walking=True)
    assert found.is_certain == is_certain
    if is_certain:
        assert found.sign == (-1 if alignment > 0 else 1)
        assert found.margin == pytest.approx(0.51)
    assert ankle_sign(ClinicalSign(1, 0.3, True), 0.9, np.zeros(5), is_walking=True).margin == 0.3


@pytest.mark.parametrize(("high_rad_s", "is_certain"), [(3.2, True), (2.8, False)])
def test_an_ankle_alone_needs_a_swing_of_a_half(high_rad_s: float, is_certain: bool) -> None:
    """From -1 rad/s to 3.2 is 0.52, to 2.8 is 0.47."""
    for sign in (1, -1):
        found = ankle_sign(None, 0.0, sign * swinging(-1.0, high_rad_s), is_walking=True)
        assert (found.sign, found.is_certain) == (-sign, is_certain)


@pytest.mark.parametrize(("high_rad_s", "is_certain"), [(1.55, True), (1.75, False)])
def test_a_swing_of_a_quarter_the_other_way_makes_an_ankle_uncertain(high_rad_s: float, is_certain: bool) -> None:
    against = ankle_sign(ClinicalSign(-1, 2.0, True), 0.9, swinging(-1.0, high_rad_s), is_walking=True)
    assert (against.sign, against.is_certain) == (1, is_certain)


def test_where_a_knee_contradicts_the_swing_the_ankle_has_no_witness() -> None:
    knee = ClinicalSign(1, 0.4, is_certain=False, is_contradicted=True)
    assert not ankle_sign(knee, 0.9, swinging(-1.0, 5.0), is_walking=True).is_certain


# standing


def test_standing_is_the_angle_between_what_both_sensors_feel() -> None:
    """Axes along z: the frames of eq 13 lie alike, so that gravity turned by 30 degrees is a twist of -30."""
    axis, down = np.array([0.0, 0.0, 1.0]), np.array([9.0, 2.0, 1.0])
    for turned_deg in (-170.0, -30.0, 0.0, 45.0, 120.0):
        c, s = np.cos(DEG * turned_deg), np.sin(DEG * turned_deg)
        other = np.array([c * down[0] - s * down[1], s * down[0] + c * down[1], down[2]])
        found = standing_twist(down, other, axis, axis)
        assert abs(np.rad2deg(found)) == pytest.approx(abs(turned_deg))
        assert found == pytest.approx(-standing_twist(other, down, axis, axis))


def test_samples_are_brought_within_half_a_turn_of_each_other() -> None:
    around = np.array([3.0, -3.0, 3.1, -3.1])  # all near half a turn
    assert np.ptp(within_half_a_turn(around)) == pytest.approx(2 * np.pi - 6.0)
    np.testing.assert_allclose(
        within_half_a_turn(np.array([0.1, 6.5, -6.0]), 6.2), [0.1 + 2 * np.pi, 6.5, -6.0 + 4 * np.pi]
    )
    np.testing.assert_allclose(wrapped_to_zero(np.array([3.0, 3.2, 3.3])), np.array([3.0, 3.2, 3.3]) - 2 * np.pi)
    np.testing.assert_allclose(wrapped_to_zero(np.array([3.0, 3.1, 3.3])), [3.0, 3.1, 3.3])


# rest


def lying(
    samples: int, gyr: FloatArray | None = None, acc: FloatArray | None = None, rate_hz: float = 100.0
) -> Rest | None:
    gyr = np.zeros((samples, 3)) if gyr is None else gyr
    acc = np.tile([0.0, 0.0, 9.81], (samples, 1)) if acc is None else acc
    tiny = 1e-6 * np.random.default_rng(1).normal(size=(samples, 3))  # what repeats itself is stuck
    return rest_of(ImuBlock("one", np.arange(samples) / rate_hz, gyr + tiny, acc + tiny))


def test_half_a_second_is_the_shortest_rest() -> None:
    assert lying(49) is None
    for samples in (50, 200):
        rest = lying(samples)
        assert rest is not None
        assert rest.duration_s == pytest.approx(samples / 100)


@pytest.mark.parametrize(("turn_deg_s", "is_rest"), [(14.9, True), (15.1, False), (-14.9, True), (-15.1, False)])
def test_a_mean_rate_of_fifteen_degrees_a_second_is_a_turn(turn_deg_s: float, is_rest: bool) -> None:
    for axis in range(3):
        gyr = np.zeros((300, 3))
        gyr[:, axis] = DEG * turn_deg_s
        rest = lying(300, gyr)
        assert (rest is not None) == is_rest
        if rest is not None:
            np.testing.assert_allclose(rest.gyr_rad_s, gyr[0], atol=1e-5)


@pytest.mark.parametrize(("sd", "is_rest"), [(0.97, True), (1.03, False)])
def test_trembling_beyond_a_limit_is_no_rest(sd: float, is_rest: bool) -> None:
    """Rates that spread by 0.06 rad/s about their mean, forces by 0.4 m/s2; every second sample lies on either side."""
    sign = np.where(np.arange(300) % 2, 1.0, -1.0)
    direction = np.array([2.0, -1.0, 2.0]) / 3.0
    gyr = 0.06 * sd * sign[:, None] * direction
    acc = np.array([0.0, 0.0, 9.81]) + 0.4 * sd * sign[:, None] * direction
    assert (lying(300, gyr) is not None) == is_rest
    assert (lying(300, None, acc) is not None) == is_rest


def test_only_the_first_ten_minutes_show_how_a_sensor_rests() -> None:
    """At 5 Hz it lies still from 9 minutes on, for two."""
    samples = 11 * 60 * 5
    time_s = np.arange(samples) / 5
    gyr = np.where(time_s[:, None] < 540.0, np.sin(time_s)[:, None] * [1.0, 2.0, 1.0], 0.01)
    rest = lying(samples, gyr, rate_hz=5.0)
    assert rest is not None
    assert rest.duration_s == pytest.approx(60.0, abs=1.0)
    np.testing.assert_allclose(rest.gyr_rad_s, 0.01, atol=1e-3)


# certainty


def test_an_axis_is_as_uncertain_as_its_weakest_direction() -> None:
    """Directions that hang together: eigenvalues 9 and 1 of [[5, 4], [4, 5]]."""
    covariance = np.zeros((4, 4))
    covariance[:2, :2] = 1e-4 * np.array([[5.0, 4.0], [4.0, 5.0]])
    covariance[2:, 2:] = 1e-4 * np.eye(2)
    covariance[0, 2] = covariance[2, 0] = 5e-3  # between the axes: it does not count
    assert axis_sd_rad(covariance, 0.0) == pytest.approx(0.03)
    assert axis_sd_rad(covariance[::-1, ::-1], 0.04) == pytest.approx(0.05)

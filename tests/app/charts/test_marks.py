"""Marks of a chart: which points differ, where a curve leaves a limit, and what is stated about them."""

import numpy as np
import pytest

from app.charts.cycles import PERCENT, Band
from app.charts.marks import BAND_SDS, Deviation, Gap, Point, extreme_of, gaps_outside, laid_at_height_of
from core.body import Joint
from core.samples import FloatArray

KNEE: FloatArray = 50 * np.exp(-(((PERCENT - 72) / 12) ** 2))
BAND = Band(KNEE, np.full(101, 3.0))
POINT = Point(Joint.LEFT_KNEE, 72.0, 50.0)


def outside(curve: FloatArray, band: Band) -> tuple[Gap, ...]:
    """Where a curve of a left knee leaves two standard deviations of a band."""
    reach = BAND_SDS * band.sd_deg
    return gaps_outside(Joint.LEFT_KNEE, curve, band.mean_deg - reach, band.mean_deg + reach, "outside the band")


def test_an_extreme_is_looked_for_inside_its_window_alone() -> None:
    assert extreme_of(Joint.LEFT_KNEE, KNEE, 55, 90, is_maximum=True) == POINT
    highest = extreme_of(Joint.LEFT_KNEE, KNEE, 54.5, 60.5, is_maximum=True)
    assert (highest.percent, highest.angle_deg) == (60.0, KNEE[60])
    assert extreme_of(Joint.LEFT_KNEE, KNEE, 55, 60, is_maximum=False).percent == 55.0


def test_a_curve_inside_its_band_has_no_gap() -> None:
    assert outside(KNEE + 5.9, BAND) == ()
    assert outside(np.full(101, np.nan), BAND) == ()


def test_a_gap_lasts_as_long_as_the_curve_is_out_and_keeps_the_limit_it_left() -> None:
    curve = KNEE.copy()
    curve[66:85] -= 7.0
    curve[10:15] += 6.5
    above, below = outside(curve, BAND)
    assert (above.first_percent, above.last_percent) == (10, 14)
    assert (below.first_percent, below.last_percent) == (66, 84)
    np.testing.assert_allclose(above.limit_deg, KNEE + 6.0)
    np.testing.assert_allclose(below.limit_deg, KNEE - 6.0)
    np.testing.assert_allclose(below.lowered(4.0).limit_deg, KNEE - 10.0)
    assert below.in_words() == "Left knee, 66 to 84 % of the gait cycle: outside the band."


def test_a_gap_that_is_hardly_seen_is_none() -> None:
    curve = KNEE.copy()
    curve[70:74] += 10
    assert gaps_outside(Joint.LEFT_KNEE, curve, KNEE - 5, KNEE + 5, "beyond the error") == ()
    curve[74] += 10
    assert [gap.words for gap in gaps_outside(Joint.LEFT_KNEE, curve, KNEE - 5, KNEE + 5, "beyond the error")] == [
        "beyond the error"
    ]


def test_a_band_laid_at_the_curves_height_judges_shape_alone() -> None:
    curve = KNEE + 20.0
    assert outside(curve, BAND) != ()
    laid = laid_at_height_of(curve, BAND)
    np.testing.assert_allclose(laid.mean_deg, curve)
    assert outside(curve, laid) == ()


def test_only_what_is_larger_than_the_error_is_stated_to_be() -> None:
    other = Point(Joint.RIGHT_KNEE, 73.0, 61.0)
    reported = Deviation(POINT, other, "L 11° under R", "band 55 to 70°", is_larger_than_error=True)
    assert reported.in_words() == "L 11° under R, beyond measurement error; band 55 to 70°."
    assert Deviation(POINT, other, "L 3° under R").in_words() == "L 3° under R."


def test_a_knee_and_an_ankle_have_no_chart_in_common() -> None:
    with pytest.raises(ValueError, match="not drawn in one chart"):
        Deviation(POINT, Point(Joint.LEFT_ANKLE, 60.0, -10.0), "")

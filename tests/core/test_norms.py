"""Are the reference bands what their source says, and are differences called real by the rule?"""

from pathlib import Path

import numpy as np
import pytest

from core.body import Joint
from core.gait.spatiotemporal import MeanAndSd
from core.norms import (
    Verdict,
    compare_new_attachment,
    compare_same_attachment,
    nearest_class,
    read_curves,
    read_time_distance,
)

BANDS = Path(__file__).parents[2] / "resources" / "reference_bands"
CURVES = (BANDS / "fukuchi2018_young_treadmill_comfortable_knee_ankle.csv").read_text(encoding="utf-8")
CLASSES = (BANDS / "fukuchi2018_spatiotemporal_overground_by_froude_class.csv").read_text(encoding="utf-8")


def test_the_curves_are_those_of_the_source() -> None:
    curves = read_curves(CURVES)
    assert curves.knee_mean_deg.max() == pytest.approx(62.26, abs=0.01)
    assert int(np.argmax(curves.knee_mean_deg)) == 74
    assert curves.ankle_mean_deg.min() == pytest.approx(-13.58, abs=0.01)
    assert curves.n == 24
    assert "CC BY 4.0" in curves.source
    assert "as derived by" in curves.source
    assert "figshare.5722711" in CURVES


def test_a_band_says_which_speed_it_is_for() -> None:
    curves = read_curves(CURVES)
    assert curves.fits(1.2)
    assert not curves.fits(0.8)


def test_half_a_table_is_refused() -> None:
    with pytest.raises(ValueError, match="expected 101"):
        read_curves("\n".join(CURVES.splitlines()[:50]))


def test_time_and_distance_by_class_of_speed() -> None:
    classes = read_time_distance(CLASSES)
    assert [c.speed_class for c in classes] == ["slow", "comfortable", "fast"]
    assert nearest_class(classes, 1.0).speed_class == "slow"
    assert nearest_class(classes, 1.3).values["stance"].mean == pytest.approx(60.3)


def angle(mean: float, n: int = 16, sd: float = 2.0) -> MeanAndSd:
    return MeanAndSd(mean, sd if n > 1 else float("nan"), n)


def test_with_the_sensors_left_on_a_difference_is_real_beyond_chance_and_one_degree() -> None:
    found = compare_same_attachment(angle(60.0), angle(57.0))
    assert found.difference_deg == 3.0
    assert found.error_deg == pytest.approx(1.96 * np.sqrt(0.5) + 1.0)
    assert found.verdict is Verdict.EXCEEDS_ERROR
    assert compare_same_attachment(angle(57.8), angle(60.0)).verdict is Verdict.INSIDE_ERROR
    assert compare_same_attachment(angle(56.0), angle(60.0)).verdict is Verdict.EXCEEDS_ERROR
    assert compare_same_attachment(angle(57.0, n=100), angle(60.0, sd=10.0)).verdict is Verdict.INSIDE_ERROR


def test_a_spread_is_trusted_from_ten_strides_and_a_mean_from_three() -> None:
    nine = compare_same_attachment(angle(60.0, n=10), angle(30.0, n=9))
    assert (nine.difference_deg, nine.verdict) == (30.0, Verdict.TOO_FEW_STRIDES)
    assert np.isnan(nine.error_deg)
    assert compare_same_attachment(angle(60.0, n=10), angle(30.0, n=10)).verdict is Verdict.EXCEEDS_ERROR
    for compared in (
        compare_same_attachment(angle(60.0), angle(30.0, n=2)),
        compare_new_attachment(Joint.LEFT_KNEE, angle(60.0), angle(30.0, n=2)),
        compare_new_attachment(Joint.LEFT_ANKLE, angle(60.0, n=0), angle(30.0)),
    ):
        assert compared.verdict is Verdict.TOO_FEW_STRIDES
        assert np.isnan(compared.difference_deg)
    assert compare_new_attachment(Joint.LEFT_KNEE, angle(60.0, n=3), angle(30.0, n=3)).error_deg == 9.2


def test_between_visits_and_sides_a_knee_is_judged_and_an_ankle_never() -> None:
    assert compare_new_attachment(Joint.LEFT_KNEE, angle(50.0), angle(59.3)).verdict is Verdict.EXCEEDS_ERROR
    assert compare_new_attachment(Joint.RIGHT_KNEE, angle(59.1), angle(50.0)).verdict is Verdict.INSIDE_ERROR
    ankle = compare_new_attachment(Joint.LEFT_ANKLE, angle(30.0), angle(0.0))
    assert (ankle.difference_deg, ankle.verdict) == (30.0, Verdict.NO_PUBLISHED_FIGURE)
    assert np.isnan(ankle.error_deg)

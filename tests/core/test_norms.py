"""Are the reference bands what their source says?"""

from pathlib import Path

import numpy as np
import pytest

from core.norms import nearest_class, read_curves, read_time_distance

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

"""Tests that the reference bands match their source, and of which of them may be shown beside a walk."""

from pathlib import Path

import numpy as np
import pytest

from core.verdicts.norms import (
    FROUDE_LIMITS,
    AgeAndHeight,
    NoBand,
    choose_bands,
    class_of_speed,
    froude_number,
    height_offset_deg,
    peak_away_sd,
    read_curves,
    read_time_distance,
)

BANDS = Path(__file__).parents[3] / "resources" / "reference_bands"
CURVES = (BANDS / "fukuchi2018_young_treadmill_comfortable_knee_ankle.csv").read_text(encoding="utf-8")
HIP = (BANDS / "fukuchi2018_young_treadmill_comfortable_hip.csv").read_text(encoding="utf-8")
CLASSES = (BANDS / "fukuchi2018_spatiotemporal_overground_by_froude_class.csv").read_text(encoding="utf-8")
GROUP, GROUPS = read_curves(CURVES, HIP), read_time_distance(CLASSES)


def test_the_curves_are_those_of_the_source() -> None:
    assert GROUP.knee_mean_deg.max() == pytest.approx(62.26, abs=0.01)
    assert int(np.argmax(GROUP.knee_mean_deg)) == 74
    assert GROUP.ankle_mean_deg.min() == pytest.approx(-13.58, abs=0.01)
    assert GROUP.hip_mean_deg.min() == pytest.approx(-8.08, abs=0.01)
    assert int(np.argmin(GROUP.hip_mean_deg)) == 54
    assert np.ptp(GROUP.hip_mean_deg) == pytest.approx(40.42, abs=0.01)
    assert (GROUP.hip_sd_deg > 6.0).all()
    assert GROUP.n == 24
    assert "CC BY 4.0" in GROUP.source
    assert "as derived by" in GROUP.source
    assert "figshare.5722711" in CURVES
    assert "leg length 0.878 m" in CURVES
    assert (GROUP.leg_length_m, GROUP.speed_class) == (0.878, "comfortable")


def test_half_a_table_is_refused() -> None:
    half = "\n".join(CURVES.splitlines()[:50])
    for texts in ((half, HIP), (CURVES, "\n".join(HIP.splitlines()[:50]))):
        with pytest.raises(ValueError, match="expected 101"):
            read_curves(*texts)


def test_the_classes_of_speed_are_those_of_the_source() -> None:
    assert [group.speed_class for group in GROUPS] == ["slow", "comfortable", "fast"]
    assert [group.values["stance"].mean for group in GROUPS] == [61.8, 60.3, 59.1]
    assert "slow <0.1304, comfortable 0.1304-0.2306, fast >=0.2306" in CLASSES
    assert FROUDE_LIMITS == (0.1304, 0.2306)


def test_somebody_of_one_metre_sixty_walks_comfortably_at_1_09_m_s() -> None:
    """The nearest mean speed, 0.94 m/s, would have called this slow."""
    assert froude_number(1.09, 0.53 * 1.60) == pytest.approx(0.142, abs=0.001)
    assert class_of_speed(1.09, 1.60) == "comfortable"
    bands = choose_bands(GROUP, GROUPS, 1.09, AgeAndHeight(30, 1.60))
    assert bands.values is GROUPS[1]


@pytest.mark.parametrize(
    ("froude", "expected"),
    [(0.1303, "slow"), (0.1305, "comfortable"), (0.2305, "comfortable"), (0.2307, "fast"), (0.0, "slow")],
)
def test_the_class_changes_at_its_froude_number(froude: float, expected: str) -> None:
    height_m = 1.70
    assert class_of_speed(float(np.sqrt(froude * 9.81 * 0.53 * height_m)), height_m) == expected


def test_the_same_speed_is_faster_for_shorter_legs() -> None:
    assert [class_of_speed(1.45, height_m) for height_m in (1.50, 1.95)] == ["fast", "comfortable"]


def test_without_a_height_a_band_is_only_where_all_adults_legs_agree() -> None:
    assert class_of_speed(1.20, None) == "comfortable"  # Froude 0.20 with legs of 0.75 m, 0.15 with 1.00 m
    assert class_of_speed(1.09, None) is None  # 0.16 and 0.12
    bands = choose_bands(GROUP, GROUPS, 1.09, AgeAndHeight())
    assert (bands.curves, bands.values) == (None, None)
    assert bands.why_no_curves is bands.why_no_values is NoBand.HEIGHT_MISSING


@pytest.mark.parametrize(
    ("speed_m_s", "height_m", "has_curves", "speed_class"),
    [
        (1.10, 1.70, True, "comfortable"),
        (1.38, 1.70, True, "comfortable"),
        (1.09, 1.60, False, "comfortable"),  # in its class, but 0.155 m/s slower
        (1.40, 1.70, False, "comfortable"),
        (1.20, 2.10, True, "comfortable"),
        (1.29, 1.40, True, "comfortable"),
        (1.35, 1.40, False, "fast"),  # near enough, but of another class
        (0.80, 1.70, False, "slow"),
    ],
)
def test_curves_stand_beside_a_walk_of_their_class_and_near_their_speed(
    speed_m_s: float, height_m: float, has_curves: bool, speed_class: str
) -> None:
    bands = choose_bands(GROUP, GROUPS, speed_m_s, AgeAndHeight(30, height_m))
    assert (bands.curves is GROUP) is has_curves
    assert bands.why_no_curves is (None if has_curves else NoBand.OTHER_SPEED)
    assert bands.values is not None
    assert bands.values.speed_class == speed_class


def test_a_child_and_an_unknown_speed_have_no_band() -> None:
    child = choose_bands(GROUP, GROUPS, 1.2, AgeAndHeight(17, 1.70))
    assert (child.curves, child.values, child.why_no_curves) == (None, None, NoBand.CHILD)
    unknown = choose_bands(GROUP, GROUPS, float("nan"), AgeAndHeight(30, 1.70))
    assert (unknown.curves, unknown.values, unknown.why_no_values) == (None, None, NoBand.SPEED_UNKNOWN)


def test_the_curves_of_young_adults_are_of_other_ages_for_older_ones() -> None:
    judged = {age: choose_bands(GROUP, GROUPS, 1.2, AgeAndHeight(age, 1.7)) for age in (18, 39, 40, 62)}
    assert [bands.are_curves_of_other_ages for bands in judged.values()] == [False, False, True, True]
    assert not choose_bands(GROUP, GROUPS, 1.2, AgeAndHeight(None, 1.7)).are_curves_of_other_ages


def ankle_away_sd(offset_deg: float, more_deg: float) -> float:
    """How far the swing peak of an ankle lies whose curve is the group's, moved as a whole, and its peak once more."""
    band, at = GROUP.mean_and_sd_deg("ankle"), 84
    return peak_away_sd(float(band[0][at]) + offset_deg + more_deg, band[0] + offset_deg, band, at, "ankle")


def test_a_zero_taken_in_dorsiflexion_moves_the_curve_and_no_peak() -> None:
    sd_deg = float(GROUP.ankle_sd_deg[84])
    assert 4.6 / sd_deg > 2  # pointwise, it would have been a flag
    assert ankle_away_sd(4.6, 0.0) == pytest.approx(0.0)
    assert ankle_away_sd(4.6, 3 * sd_deg) == pytest.approx(3.0)
    assert height_offset_deg(GROUP.ankle_mean_deg + 4.6, GROUP.ankle_mean_deg) == pytest.approx(4.6)


def knee_away_sd(scale: float) -> float:
    """How far the swing peak of a knee lies that moves `scale` times as much as the group's."""
    mean_deg, sd_deg = GROUP.mean_and_sd_deg("knee")
    return peak_away_sd(float(scale * mean_deg[74]), scale * mean_deg, (mean_deg, sd_deg), 74, "knee")


def test_a_knee_lies_below_or_above_only_as_measured_and_divided_by_what_we_read_too_much() -> None:
    mean_deg, sd_deg = float(GROUP.knee_mean_deg[74]), float(GROUP.knee_sd_deg[74])
    assert knee_away_sd(1.09) == pytest.approx(0.0, abs=1e-9)
    assert knee_away_sd(1.05) == 0.0  # above as measured, below when divided
    height_deg = float(np.median(GROUP.knee_mean_deg))
    assert knee_away_sd(0.8) == pytest.approx(-0.2 * (mean_deg - height_deg) / sd_deg, rel=0.15)
    assert knee_away_sd(1.4) == pytest.approx((1.4 / 1.09 - 1) * (mean_deg - height_deg) / sd_deg, rel=0.15)

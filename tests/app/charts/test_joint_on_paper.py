"""A joint of both legs on paper: values at peaks, the headline's bracket, toe-offs, hidden curves, no small letters."""

import re
from dataclasses import replace

import numpy as np
import pytest

from app.charts.cycles import PERCENT
from app.charts.joint_on_paper import BAR, CURVES, DASH, SMALL, draw_joint
from app.charts.marks import CurveLabel, Deviation, HiddenCurve, extreme_of
from app.charts.stride_chart import Axis, StrideChart, StrideCurve
from core.body import Joint, Side
from core.samples import FloatArray

SIZE = (241.0, 255.0)  # points: 85 x 90 mm
KNEE: FloatArray = 10 * np.exp(-(((PERCENT - 14) / 8) ** 2)) + 55 * np.exp(-(((PERCENT - 73) / 12) ** 2))
LOW = extreme_of(Joint.LEFT_KNEE, 0.8 * KNEE, 25, 60, is_maximum=False)
HIGH = extreme_of(Joint.LEFT_KNEE, 0.8 * KNEE, 55, 90, is_maximum=True)
RIGHT = extreme_of(Joint.RIGHT_KNEE, KNEE, 55, 90, is_maximum=True)
CHART = StrideChart(
    Axis(-10, 80, 20, 10),
    (StrideCurve("L", Side.LEFT, 0.8 * KNEE, 60.0), StrideCurve("R", Side.RIGHT, KNEE, 61.0)),
    band=None,
    is_simulated=False,
    title="Knee",
    sign="flexion + (°)",
    alt="Knee.",
    labels=(CurveLabel(HIGH, "L 44°"), CurveLabel(RIGHT, "R 55°")),
)
BRACKET = Deviation(LOW, HIGH, "L 43°", "1 Jul: 35°", is_larger_than_error=True)


def words(svg: str) -> list[str]:
    return re.findall(r">([^<>]+)</text>", svg)


def test_values_are_at_the_peaks_and_toe_offs_above_the_plot() -> None:
    drawn = words(draw_joint(CHART, *SIZE).svg)
    assert {"L 44°", "R 55°", "toe-off L 60 %", "R 61 %"} <= set(drawn)
    assert "SIMULATED" not in drawn
    assert "SIMULATED" in words(draw_joint(replace(CHART, is_simulated=True), *SIZE).svg)


def test_a_bracket_has_both_numbers_and_takes_the_place_of_the_value_at_its_end() -> None:
    picture = draw_joint(replace(CHART, deviations=(BRACKET,)), *SIZE)
    drawn = words(picture.svg)
    assert {BRACKET.words, BRACKET.more, "R 55°"} <= set(drawn)
    assert "L 44°" not in drawn
    assert f'stroke-width="{BAR}"' in picture.svg
    assert "1 Jul: 35°" in picture.alt


def test_legs_are_known_without_colour() -> None:
    svg = draw_joint(CHART, *SIZE).svg
    dashed = {side: set(re.findall(rf'<path[^>]*stroke="{CURVES[side]}"[^>]*>', svg)) for side in Side}
    assert all(DASH in path for path in dashed[Side.RIGHT])
    assert not any("dasharray" in path for path in dashed[Side.LEFT])
    assert words(svg).count("L") == words(svg).count("R") == 1  # their chips


@pytest.mark.parametrize("height", [255.0, 170.0])
def test_no_letter_is_smaller_than_nine_points(height: float) -> None:
    hidden = replace(CHART, hidden=(HiddenCurve(Side.LEFT, "±9.8"),), curves=CHART.curves[1:])
    for chart in (replace(CHART, deviations=(BRACKET,)), hidden):
        sizes = re.findall(
            r'font-size="([\d.]+)"', draw_joint(replace(chart, labels=CHART.labels[1:]), 241.0, height).svg
        )
        assert min(map(float, sizes)) >= SMALL == 9.0


def test_a_hidden_curve_is_a_hatched_box_with_its_reason_and_no_line() -> None:
    chart = replace(CHART, curves=CHART.curves[1:], labels=CHART.labels[1:])
    svg = draw_joint(replace(chart, hidden=(HiddenCurve(Side.LEFT, "±9.8"),)), *SIZE).svg
    assert {"Not reported", "±9.8"} <= set(words(svg))
    assert '<path d="M' in svg
    assert not re.findall(rf'<path[^>]*stroke="{CURVES[Side.LEFT]}"', svg)
    assert "Not reported" not in words(draw_joint(chart, *SIZE).svg)


def test_an_earlier_visit_is_thin_and_named_in_the_key() -> None:
    before = replace(CHART.curves[0], letter="1 Jul", angle_deg=0.5 * KNEE)
    assert "1 Jul" in words(draw_joint(replace(CHART, beside=(before,)), *SIZE).svg)
    assert "1 Jul" not in words(draw_joint(CHART, *SIZE).svg)

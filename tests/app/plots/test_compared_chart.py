"""Curves compared: the band only beside curves with a height, and a casing of one width at every size."""

import math

import numpy as np
import pytest
from PySide6.QtGui import QColor
from pytestqt.qtbot import QtBot

from app.charts.cycles import Band
from app.charts.stride_chart import StrideCurve
from app.plots.compared_chart import ComparedChart
from app.summary.reference_bands import reference_curves
from app.theme.current import current_theme, set_scale
from core.body import JointKind, Side

BAND = Band(*reference_curves().mean_and_sd_deg("knee"))


def flat(letter: str, angle_deg: float) -> StrideCurve:
    return StrideCurve(letter, Side.LEFT, np.full(101, angle_deg))


def chart_of(qtbot: QtBot) -> ComparedChart:
    chart = ComparedChart(JointKind.KNEE)
    qtbot.addWidget(chart)
    chart.resize(600, 500)
    return chart


def colours_down(chart: ComparedChart, percent: float) -> list[QColor]:
    picture, frame = chart.grab().toImage(), chart.frame
    x = round(float(frame.x(percent)))
    return [picture.pixelColor(x, y) for y in range(int(frame.top) + 1, int(frame.bottom))]


def test_the_band_is_there_but_where_curves_are_drawn_about_their_mean(qtbot: QtBot) -> None:
    chart = chart_of(qtbot)
    chart.band = BAND
    band = QColor(current_theme().colours.band_1sd)
    chart.show_curves([flat("A", 0.0)], is_simulated=False)
    assert band in colours_down(chart, 30)
    chart.show_curves([flat("A", 0.0)], is_simulated=False, is_about_mean=True)
    assert band not in colours_down(chart, 30)
    chart.show_curves([flat("A", 0.0)], is_simulated=False)
    assert band in colours_down(chart, 30)


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_the_casing_grows_with_the_size_of_everything(qtbot: QtBot, scale: float) -> None:
    set_scale(scale)
    chart = chart_of(qtbot)
    chart.band = Band(np.full(101, 40.0), np.full(101, 60.0))  # under all of the chart, to see the casing on
    chart.show_curves([flat("A", 40.0)], is_simulated=False)
    band = QColor(current_theme().colours.band_1sd)
    others = [colour for colour in colours_down(chart, 70) if colour != band]
    zero_px, blurred_px = scale, 3.0
    assert len(others) == pytest.approx((2.75 + 2.0) * scale + zero_px + blurred_px, abs=2)


def test_the_later_curve_is_the_thicker_one(qtbot: QtBot) -> None:
    chart = chart_of(qtbot)
    chart.show_curves([flat("A", 20.0), flat("B", 60.0)], is_simulated=False)
    colours = colours_down(chart, 10)
    of_line = [max(0, 255 - colour.blue()) for colour in colours]  # the left leg's orange
    half = len(of_line) // 2
    assert sum(of_line[:half]) > 1.5 * sum(of_line[half + 1 :])
    assert [curve.letter for curve in chart.described.curves] == ["A", "B"]


def test_curves_that_are_not_known_are_not_drawn(qtbot: QtBot) -> None:
    chart = chart_of(qtbot)
    chart.show_curves([flat("A", math.nan), flat("B", 60.0)], is_simulated=False)
    assert [curve.letter for curve in chart.described.curves] == ["B"]

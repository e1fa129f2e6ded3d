"""Knee above ankle: the same axes, the same time, gaps as gaps, and a way back to the whole."""

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.charts.axes import ANKLE_DEG, KNEE_DEG
from app.plots.angle_chart import AngleChart, Curve
from app.plots.joint_charts import NO_VALUE, JointCharts
from app.theme.current import current_theme, set_dark
from core.body import Joint, Side
from core.samples import FloatArray

TIME_S = np.arange(1000) / 100 + 5.0
GAP = slice(400, 450)


def angle(highest_deg: float) -> FloatArray:
    return highest_deg * np.sin(2 * np.pi * TIME_S) ** 2


@pytest.fixture
def charts(qtbot: QtBot) -> JointCharts:
    charts = JointCharts()
    qtbot.addWidget(charts)
    charts.resize(800, 500)
    charts.show()
    left = angle(60)
    left[GAP] = np.nan
    charts.show_recording("walk 1", TIME_S, is_simulated=False)
    charts.show_joints(
        {
            Joint.LEFT_KNEE: Curve(left, np.full(1000, 1.5)),
            Joint.RIGHT_KNEE: Curve(angle(50)),
            Joint.LEFT_ANKLE: Curve(angle(20)),
        }
    )
    return charts


def inked_columns(chart: AngleChart, side: Side) -> FloatArray:
    """Give the times at which pixels of a leg's curve are found."""
    picture = chart.grab().toImage()
    ink = current_theme().curve(side)
    found = []
    for x in range(picture.width()):
        column = (picture.pixelColor(x, y) for y in range(picture.height()))
        if any(
            abs(c.red() - ink.red()) + abs(c.green() - ink.green()) + abs(c.blue() - ink.blue()) < 60 for c in column
        ):
            time_s = chart.time_at(x, chart.height() / 2)
            if time_s is not None:
                found.append(time_s)
    return np.array(found)


def test_axes_are_the_same_every_time(charts: JointCharts) -> None:
    assert KNEE_DEG == (-10.0, 80.0)
    assert ANKLE_DEG == (-30.0, 30.0)
    assert charts.knee.chart.range_deg == KNEE_DEG
    assert charts.ankle.chart.range_deg == ANKLE_DEG
    assert charts.knee.chart.view_box.viewRange()[1] == list(KNEE_DEG)


def test_an_axis_that_is_left_is_widened_and_states_so(charts: JointCharts) -> None:
    assert not charts.knee.wide.isVisible()
    charts.show_joints({Joint.LEFT_KNEE: Curve(angle(93.0))})
    assert charts.knee.chart.range_deg == (-10.0, 100.0)
    assert charts.knee.wide.isVisible()
    assert "100°" in charts.knee.wide.text()
    charts.show_joints({Joint.LEFT_KNEE: Curve(angle(60.0))})
    assert charts.knee.chart.range_deg == KNEE_DEG
    assert not charts.knee.wide.isVisible()


def test_a_gap_is_drawn_as_a_gap(charts: JointCharts) -> None:
    _, drawn = charts.knee.chart.curve_points(Side.LEFT)
    assert np.isnan(drawn[GAP]).all()
    assert np.isfinite(drawn[: GAP.start]).all()
    assert np.isfinite(drawn[GAP.stop :]).all()
    first, last = TIME_S[GAP.start], TIME_S[GAP.stop]
    seen_s = inked_columns(charts.knee.chart, Side.LEFT)
    assert len(seen_s) > 100
    assert not ((seen_s > first + 0.05) & (seen_s < last - 0.05)).any()


def test_a_leg_without_sensors_has_neither_curve_nor_key(charts: JointCharts) -> None:
    assert len(inked_columns(charts.ankle.chart, Side.RIGHT)) == 0
    assert not charts.ankle.keys[Side.RIGHT].isVisible()
    assert charts.ankle.keys[Side.LEFT].isVisible()


def test_knee_and_ankle_share_their_time(charts: JointCharts) -> None:
    charts.zoom(0.5)
    assert charts.ankle.chart.visible_s == pytest.approx(charts.knee.chart.visible_s)
    assert charts.visible_s[1] - charts.visible_s[0] == pytest.approx(9.99 / 2)


def test_keys_zoom_move_and_bring_the_whole_back(qtbot: QtBot, charts: JointCharts) -> None:
    assert charts.is_whole
    QTest.keyClick(charts, Qt.Key.Key_Plus)
    first, last = charts.visible_s
    assert last - first == pytest.approx(0.6 * 9.99)
    QTest.keyClick(charts, Qt.Key.Key_PageDown)
    assert charts.visible_s[1] > last
    assert charts.visible_s[1] <= TIME_S[-1] + 1e-6
    with qtbot.waitSignal(charts.view_changed) as reported:
        QTest.keyClick(charts, Qt.Key.Key_Home)
    assert charts.is_whole
    assert reported.args == [True, "Whole recording, 10.0 s"]


def test_zooming_out_stops_at_the_whole(qtbot: QtBot, charts: JointCharts) -> None:
    QTest.keyClick(charts, Qt.Key.Key_Minus)
    assert charts.visible_s == pytest.approx((TIME_S[0], TIME_S[-1]))


def test_arrows_read_from_sample_to_sample(qtbot: QtBot, charts: JointCharts) -> None:
    charts.zoom(0.02)
    QTest.keyClick(charts, Qt.Key.Key_Right)
    here = charts.cursor_s
    QTest.keyClick(charts, Qt.Key.Key_Right)
    assert here is not None
    assert charts.cursor_s == pytest.approx(here + 0.01)


def test_the_mouse_reads_values_with_their_certainty(charts: JointCharts) -> None:
    charts.read_at(5.25)
    row = 25
    assert charts.knee.moment.text() == "5.25 s"
    assert charts.knee.values[Side.LEFT].text() == f"{angle(60)[row]:.1f}° ± 3.0°"
    assert charts.knee.values[Side.RIGHT].text() == f"{angle(50)[row]:.1f}°"
    assert charts.ankle.values[Side.RIGHT].text() == ""


def test_the_mouse_over_the_plot_sets_the_reading_line(monkeypatch: pytest.MonkeyPatch, charts: JointCharts) -> None:
    monkeypatch.setattr(charts.knee.chart, "underMouse", lambda: True)
    centre = charts.knee.chart.view_box.sceneBoundingRect().center()
    charts.knee.chart.scene().sigMouseMoved.emit(QPointF(centre))
    assert charts.cursor_s == pytest.approx(float(np.mean(charts.visible_s)), abs=0.02)
    assert charts.ankle.chart.reading_line.isVisible()


def test_inside_a_gap_no_value_is_read(charts: JointCharts) -> None:
    charts.read_at(float(TIME_S[GAP.start + 5]))
    assert charts.knee.values[Side.LEFT].text() == NO_VALUE


def test_simulated_is_on_every_chart(charts: JointCharts) -> None:
    assert not charts.knee.simulated.isVisible()
    charts.show_recording("walk 1", TIME_S, is_simulated=True)
    assert charts.knee.simulated.isVisible()
    assert charts.ankle.simulated.isVisible()


def test_the_charts_are_reported_in_words(charts: JointCharts) -> None:
    assert charts.accessibleName() == "Knee and ankle angles of walk 1"
    assert "Left knee from 0.0° to 60.0°." in charts.accessibleDescription()
    assert "Right ankle" not in charts.accessibleDescription()


def test_a_recording_without_samples_is_no_trouble(charts: JointCharts) -> None:
    charts.show_recording("walk 2", np.zeros(0), is_simulated=False)
    charts.show_joints({Joint.LEFT_KNEE: Curve(np.zeros(0))})
    charts.step(1)
    assert "Left knee has no values." in charts.accessibleDescription()


def test_right_is_drawn_dashed_and_left_is_not() -> None:
    for is_dark in (False, True):
        set_dark(is_dark)
        assert current_theme().side_pen(Side.RIGHT, 2).dashPattern()
        assert current_theme().side_pen(Side.LEFT, 2).style() is Qt.PenStyle.SolidLine

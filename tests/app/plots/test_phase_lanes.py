"""Phase lanes: every phase in its look and place, on the time of the curves; events named; the unknown empty."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QWheelEvent
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.plots.joint_charts import JointCharts
from app.plots.phase_lanes import Lane, PhaseLanes
from app.theme.current import current_theme
from core.body import Side
from core.gait.events import FootEvents
from core.gait.phases import phases_at
from core.gait.strides import strides_of
from core.results import SideGait

TIME_S = np.arange(1001) / 100
STRIDES = 8


def events(first_s: float, count: int = STRIDES) -> FootEvents:
    """Heel rise, toe-off, contact and full contact of strides of 1 s: swing from 0.2 to 0.6 s after `first_s`."""
    start_s = first_s + np.arange(count)
    nothing = np.full(count, np.nan)
    yes = np.ones(count, dtype=bool)
    each = np.ones((count, 4), dtype=np.int64), np.full((count, 4), 0.01)
    swing = start_s, start_s + 0.2, start_s + 0.6, start_s + 0.72
    return FootEvents(*swing, nothing, nothing, nothing, nothing, yes, yes, *each)


def gait(first_s: float, count: int = STRIDES) -> SideGait:
    found = (events(first_s, count),)
    return SideGait(found, strides_of(found), {}, {}, phases_at(TIME_S, found))


@pytest.fixture
def charts(qtbot: QtBot) -> JointCharts:
    charts = JointCharts()
    qtbot.addWidget(charts)
    charts.resize(1000, 640)
    charts.show()
    charts.show_recording("walk 1", TIME_S, False, {Side.LEFT: gait(1.0), Side.RIGHT: gait(1.5)})
    charts.show_joints({})
    return charts


def colours_at(lanes: PhaseLanes, side: Side, time_s: float) -> list[str]:
    """Give the colours down the lane of a leg at an instant."""
    picture, area = lanes.window().grab().toImage(), lanes.area(side)  # with the card it lies on
    corner = lanes.mapTo(lanes.window(), QPoint(0, 0))
    x = corner.x() + round(float(lanes.x_of(np.array(time_s))))
    return [picture.pixelColor(x, corner.y() + y).name() for y in range(int(area.top()), int(area.bottom()))]


def grey(colour: str) -> int:
    return QColor(colour).lightness()


def test_each_phase_has_its_look(charts: JointCharts) -> None:
    lanes = charts.phases.lanes
    for side, shift in ((Side.LEFT, 0.0), (Side.RIGHT, 0.5)):
        full, pale = current_theme().curve(side).name(), current_theme().soft(side).name()
        assert set(colours_at(lanes, side, 1.66 + shift)) == {full}  # loading
        assert set(colours_at(lanes, side, 1.86 + shift)) == {pale}  # foot flat
        hatched = colours_at(lanes, side, 2.1 + shift)  # pre-swing: stripes of colour on the surface
        assert len({colour for colour in hatched if grey(colour) < 170}) > 0
        assert len({colour for colour in hatched if grey(colour) > 240}) > 0
        swing = colours_at(lanes, side, 1.4 + shift)
        assert swing[0] == current_theme().colours.surface.lower()
        assert swing[-1] == full


def test_the_looks_differ_without_colour(charts: JointCharts) -> None:
    lanes = charts.phases.lanes
    middle = [grey(colours_at(lanes, Side.RIGHT, at)[10]) for at in (2.16, 2.36, 1.9)]
    assert middle[0] + 40 < middle[1]
    assert middle[1] + 20 < middle[2]


def test_where_the_phase_is_unknown_nothing_is_drawn(charts: JointCharts) -> None:
    for at in (0.5, 9.5):
        assert set(colours_at(charts.phases.lanes, Side.LEFT, at)) == {current_theme().colours.surface.lower()}


def test_lanes_stand_on_the_time_of_the_curves(charts: JointCharts) -> None:
    chart = charts.ankle.chart
    for share in (1.0, 0.4):
        charts.zoom(share)
        first, last = charts.visible_s
        for at in (first + 0.1, (first + last) / 2, last - 0.1):
            x = float(charts.phases.lanes.x_of(np.array(at)))
            assert chart.time_at(x, chart.height() / 2) == pytest.approx(at, abs=(last - first) / 400)


def test_the_reading_line_names_phase_and_event(charts: JointCharts) -> None:
    charts.read_at(1.86)
    assert charts.phases.reading_in_words() == "Left foot: foot flat. Right foot: swing."
    charts.read_at(1.2)
    assert charts.phases.reading_in_words() == "Left foot: toe-off. Right foot: not known."
    charts.read_at(1.6)
    assert charts.phases.readings[Side.LEFT].text() == "initial contact"


def test_brackets_go_from_event_to_event_and_stop_at_the_last(charts: JointCharts) -> None:
    passed = []
    for _ in range(5):
        QTest.keyClick(charts, Qt.Key.Key_BracketRight)
        passed.append(charts.cursor_s)
    assert passed == pytest.approx([1.2, 1.6, 1.7, 2.1, 2.2])
    QTest.keyClick(charts, Qt.Key.Key_BracketLeft)
    assert charts.cursor_s == pytest.approx(2.1)
    for _ in range(60):
        QTest.keyClick(charts, Qt.Key.Key_BracketRight)
    assert charts.cursor_s == pytest.approx(9.1)


def test_an_event_out_of_sight_is_brought_in(charts: JointCharts) -> None:
    charts.read_at(1.0)
    charts.zoom(0.05)
    for _ in range(6):
        QTest.keyClick(charts, Qt.Key.Key_BracketRight)
    first, last = charts.visible_s
    assert charts.cursor_s is not None
    assert first <= charts.cursor_s <= last
    assert last - first == pytest.approx(0.5)


def test_the_mouse_over_a_lane_reads_moves_and_zooms(qtbot: QtBot, charts: JointCharts) -> None:
    lanes = charts.phases.lanes
    area = lanes.area(Side.LEFT)
    QTest.mouseMove(lanes, QPoint(int(area.center().x()), int(area.center().y())))
    assert charts.cursor_s == pytest.approx(5.0, abs=0.02)
    wheel = QWheelEvent(
        QPointF(area.center()),
        QPointF(lanes.mapToGlobal(area.center().toPoint())),
        QPoint(0, 0),
        QPoint(0, 120),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    lanes.wheelEvent(wheel)
    first, last = charts.visible_s
    assert last - first == pytest.approx(10 * 1.02**-15)
    start = area.center().toPoint()
    QTest.mousePress(lanes, Qt.MouseButton.LeftButton, pos=start)
    QTest.mouseMove(lanes, start - QPoint(int(area.width() / 10), 0))
    QTest.mouseRelease(lanes, Qt.MouseButton.LeftButton)
    assert charts.visible_s[0] == pytest.approx(first + (last - first) / 10, abs=0.05)


def test_phases_too_narrow_to_show_apart_ask_for_a_zoom(qtbot: QtBot) -> None:
    lanes = PhaseLanes()
    qtbot.addWidget(lanes)
    lanes.show_lanes({Side.LEFT: Lane.of(TIME_S, gait(1.0))})
    lanes.resize(400, 26)
    lanes.see(-200.0, 200.0)
    full = current_theme().curve(Side.LEFT).name()
    assert full not in colours_at(lanes, Side.LEFT, 1.66)
    assert current_theme().colours.sunken.lower() in colours_at(lanes, Side.LEFT, 5.0)
    lanes.see(0.0, 10.0)
    assert full in colours_at(lanes, Side.LEFT, 1.66)


def test_lanes_are_reported_in_words(charts: JointCharts) -> None:
    reported = charts.phases.lanes.accessibleDescription()
    assert "Left foot: 8 initial contacts and 8 toe-offs, phases from 1.0 to 8.7 s." in reported
    assert reported in charts.accessibleDescription()


def test_without_gait_there_are_no_lanes(charts: JointCharts) -> None:
    assert charts.phases.isVisible()
    charts.show_recording("free motion", TIME_S, is_simulated=False)
    assert not charts.phases.isVisible()
    QTest.keyClick(charts, Qt.Key.Key_BracketRight)
    assert charts.cursor_s is None


def test_simulated_is_on_the_lanes_too(charts: JointCharts) -> None:
    assert not charts.phases.simulated.isVisible()
    charts.show_recording("walk 1", TIME_S, True, {Side.LEFT: gait(1.0)})
    assert charts.phases.simulated.isVisible()

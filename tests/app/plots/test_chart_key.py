"""The key to a chart's curves, values on them and the cursor: what is named, what gives way, what the mouse moves."""

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.charts.marks import CurveLabel, Point
from app.plots.chart_key import ChartKey, ChartKeyWords
from app.plots.cycle_charts import CycleCharts
from app.summary.reference_bands import reference_curves
from app.theme.current import current_theme
from core.body import Joint, Side
from core.verdicts.model import READ, JointVerdicts, Verdict
from tests.app.plots.test_cycle_chart import ZERO, cycle

LEGS = dict.fromkeys(Side, Verdict.READ)
THIN = ChartKeyWords(LEGS, "1 Jul", (Side.LEFT,), ("No reference at this speed", "No reference"))
PEAK = CurveLabel(Point(Joint.LEFT_KNEE, 72.0, 60.0), "L 60°")


@pytest.fixture
def key(qtbot: QtBot) -> ChartKey:
    key = ChartKey()
    qtbot.addWidget(key)
    return key


@pytest.fixture
def charts(qtbot: QtBot) -> CycleCharts:
    charts = CycleCharts(reference_curves())
    qtbot.addWidget(charts)
    charts.resize(424, 460)
    charts.show()
    return charts


def shown(key: ChartKey, width: int) -> list[str]:
    key.resize(width, 24)
    return [text.text for text in key.painted_texts()]


def test_the_reference_gives_way_before_the_thin_lines_date(key: ChartKey) -> None:
    key.show_words(THIN)
    assert shown(key, 500) == ["No reference at this speed", "1 Jul"]
    assert shown(key, 270) == ["No reference", "1 Jul"]
    assert shown(key, 190) == ["1 Jul"]
    assert shown(key, 110) == []
    assert all(text.needed.width() <= text.box.width() for text in key.painted_texts())


def test_the_key_is_read_out_with_what_has_no_room(key: ChartKey) -> None:
    key.show_words(THIN)
    key.resize(110, 24)
    assert key.accessibleName() == ("left leg: good, right leg: good, Thin line: 1 Jul and No reference at this speed")


def test_a_value_is_on_its_curve_and_not_on_one_without_zero(charts: CycleCharts) -> None:
    charts.show_cycles({Joint.LEFT_KNEE: cycle(12)}, {}, is_simulated=False)
    charts.show_labels([PEAK])
    ((label, box),) = charts.knee.chart.layout_of_words.labels
    assert label.text == "L 60°"
    assert box is not None
    assert not charts.ankle.chart.layout_of_words.labels
    charts.show_cycles({Joint.LEFT_KNEE: cycle(12)}, {}, is_simulated=False)
    assert not charts.knee.chart.layout_of_words.labels  # the next walk's are given anew
    charts.show_cycles(
        {Joint.LEFT_KNEE: cycle(12)}, {Joint.LEFT_KNEE: JointVerdicts(READ, ZERO, READ)}, is_simulated=False
    )
    charts.show_labels([PEAK])
    assert not charts.knee.chart.layout_of_words.labels


def test_the_cursor_follows_the_mouse_while_its_button_is_down(charts: CycleCharts) -> None:
    charts.show_cycles({Joint.LEFT_KNEE: cycle(12)}, {}, is_simulated=False)
    picked: list[float] = []
    charts.picked.connect(lambda _, percent, __: picked.append(percent))
    chart, frame = charts.knee.chart, charts.knee.chart.frame
    first, then, beside = (
        QPoint(round(float(frame.x(percent))), round(frame.top + 30)) for percent in (40.0, 60.0, 130.0)
    )
    QTest.mousePress(chart, Qt.MouseButton.LeftButton, pos=first)
    QTest.mouseMove(chart, then)
    assert picked == [pytest.approx(40.0, abs=0.5)]  # no cursor is shown: a press alone picks
    charts.show_cursor({Side.LEFT: 40.0})
    for place in (then, beside):
        event_at(charts, place)
    assert picked[1:] == [pytest.approx(60.0, abs=0.5), 100.0]


def event_at(charts: CycleCharts, place: QPoint) -> None:
    """A move with the left button down, which QTest does not send."""
    left, none = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    chart = charts.knee.chart
    at = QPointF(place)
    chart.mouseMoveEvent(QMouseEvent(QEvent.Type.MouseMove, at, at, left, left, none))


def test_the_cursor_has_its_line_and_handle_in_ink(charts: CycleCharts) -> None:
    charts.set_band_shown(False)
    charts.show_cycles({Joint.LEFT_KNEE: cycle(12)}, {}, is_simulated=False)
    chart = charts.knee.chart
    x, top = round(float(chart.frame.x(20.0))), round(chart.frame.top)
    assert chart.grab().toImage().pixelColor(x, top + 1).lightness() > 200
    charts.show_cursor({Side.LEFT: 20.0})
    picture = chart.grab().toImage()
    assert picture.pixelColor(x, top + 1).name() == current_theme().colours.ink.lower()
    assert picture.pixelColor(x + 2, top + 1).name() == current_theme().colours.ink.lower()
    assert picture.pixelColor(x + 3, top + 12).lightness() > 200

"""The knee's range by visit: points stand at their dates and values, and are told to a reader of screens."""

import datetime

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.plots.visit_chart import VisitChart, VisitRange
from app.theme import Look

VISITS = (
    VisitRange(datetime.date(2026, 3, 1), "Mar 2026", 48.6, None),
    VisitRange(datetime.date(2026, 1, 30), "Jan 2026", 43.1, 61.0),
    VisitRange(datetime.date(2026, 1, 1), "Jan 2026", 41.0, 60.0),
)


@pytest.fixture
def chart(qtbot: QtBot, qapp: QApplication) -> VisitChart:
    chart = VisitChart(Look())
    qtbot.addWidget(chart)
    chart.resize(400, 132)
    chart.show_visits(VISITS)
    return chart


def test_the_axis_holds_all_values_between_whole_tens(chart: VisitChart) -> None:
    assert chart.limits_deg == (40, 70)


def test_a_visit_stands_at_its_date(chart: VisitChart) -> None:
    first, middle, last = (chart.point(visit, 50.0).x() for visit in reversed(VISITS))
    assert (middle - first) / (last - first) == pytest.approx(29 / 59)


def test_more_degrees_stand_higher(chart: VisitChart) -> None:
    low, high = (chart.point(VISITS[0], value).y() for value in (45.0, 55.0))
    assert low > high
    assert chart.point(VISITS[0], 50.0).y() == pytest.approx((low + high) / 2)


def test_every_value_is_told(chart: VisitChart) -> None:
    assert chart.accessibleDescription() == (
        "Jan 2026: left 41.0°, Jan 2026: right 60.0°, Jan 2026: left 43.1°, Jan 2026: right 61.0°, Mar 2026: left 48.6°"
    )


def test_one_visit_or_none_is_painted_without_trouble(chart: VisitChart) -> None:
    for visits in (VISITS[:1], ()):
        chart.show_visits(visits)
        assert not chart.grab().isNull()

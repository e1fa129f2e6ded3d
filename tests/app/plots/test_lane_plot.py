"""Lanes of a course: where visits and values lie, which dates find room, no word cut."""

import datetime
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from uuid import UUID

import pytest
from PySide6.QtGui import QColor, QImage
from pytestqt.qtbot import QtBot

from app.plots.lane_plot import APART, INSET, DateAxis, LanePlot, LaneScale
from app.summary.course import Course
from app.summary.course_lanes import KNEE_LANE, CourseVisit, lanes
from app.summary.course_words import day_of
from app.theme.current import current_theme, set_scale
from app.wording.measures import least_span
from core.body import Joint
from core.goals import Goal, GoalOf
from tests.app.course_material import course, unsure, walked

SHOES = "shoes"


def visit(day: int, found: Course | None) -> CourseVisit:
    return CourseVisit(UUID(int=day), datetime.date(2026, 1, 1) + datetime.timedelta(days=day), found)


def shoes(knee_deg: float) -> Course:
    return course((walked(knee_deg=knee_deg), SHOES))


def knee_plot(qtbot: QtBot, *visits: CourseVisit, goals: Sequence[Goal] = (), height: int = 121) -> LanePlot:
    plot = LanePlot()
    qtbot.addWidget(plot)
    plot.resize(400, height)
    found = next(one for one in lanes(visits, goals=goals) if one.kind is KNEE_LANE)
    plot.show_lane(found, visits)
    return plot


def colour_at(plot: LanePlot, x: float, y: float) -> QColor:
    image = plot.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    return image.pixelColor(round(x), round(y))


def is_left(colour: QColor) -> bool:
    required = QColor(current_theme().colours.left)
    channels = (QColor.red, QColor.green, QColor.blue)
    return all(abs(channel(colour) - channel(required)) < 60 for channel in channels)


def test_adjacent_are_joined_and_what_lies_beyond_a_gap_is_not(qtbot: QtBot) -> None:
    reported = unsure(Joint.LEFT_KNEE)
    gap = course((walked(reported=reported), SHOES), reported=reported)
    joined = knee_plot(qtbot, visit(0, shoes(50.0)), visit(100, shoes(50.0)))
    at = joined.x_of(0) + 0.25 * (joined.x_of(1) - joined.x_of(0)), joined.y_of(50.0)
    assert is_left(colour_at(joined, *at))
    apart = knee_plot(qtbot, visit(0, shoes(50.0)), visit(50, gap), visit(100, shoes(50.0)))
    assert not is_left(colour_at(apart, *at))
    assert is_left(colour_at(apart, apart.x_of(2), apart.y_of(50.0)))


def test_visits_lie_as_far_apart_as_their_days(qtbot: QtBot) -> None:
    plot = knee_plot(qtbot, *(visit(day, shoes(50.0)) for day in (0, 10, 100)))
    first, second, last = (plot.x_of(number) for number in range(3))
    assert (second - first) / (last - first) == pytest.approx(0.1)
    alone = knee_plot(qtbot, visit(0, shoes(50.0)))
    assert alone.x_of(0) == pytest.approx(alone.plot.center().x())


@pytest.mark.parametrize("values", [(50.0, 50.1), (20.0, 75.0), (38.4, 49.3), (4.0, 4.0)])
def test_all_that_is_drawn_lies_in_the_plot(values: tuple[float, ...]) -> None:
    visits = [visit(30 * k, shoes(value)) for k, value in enumerate(values)]
    for lane in lanes(visits):
        scale = LaneScale.of(lane)
        assert scale.low <= min(lane.values, default=0.0) + 1e-6
        assert scale.high >= max(lane.values, default=0.0) - 1e-6
        assert scale.high - scale.low >= least_span(lane.kind.column)


def test_a_visit_that_is_not_reported_has_a_tick_and_no_dot(qtbot: QtBot) -> None:
    reported = unsure(Joint.LEFT_KNEE)
    gap = course((walked(reported=reported), SHOES), reported=reported)
    plot = knee_plot(qtbot, visit(0, shoes(50.0)), visit(50, gap), visit(100, shoes(50.0)))
    ground = colour_at(plot, plot.x_of(1) + 30, plot.height() - 4)
    assert colour_at(plot, plot.x_of(1), plot.height() - 4) != ground
    assert colour_at(plot, plot.x_of(0), plot.height() - 4) == ground


def test_the_last_value_is_filled_and_those_before_are_open(qtbot: QtBot) -> None:
    plot = knee_plot(qtbot, visit(0, shoes(40.0)), visit(100, shoes(50.0)))
    assert is_left(colour_at(plot, plot.x_of(1), plot.y_of(50.0)))
    assert not is_left(colour_at(plot, plot.x_of(0), plot.y_of(40.0)))


@pytest.mark.parametrize("scale", [0.8, 1.0, 2.0])
@pytest.mark.parametrize("value_deg", [30.0, 55.0, 70.0])
def test_a_goal_is_named_in_the_plot_at_the_end_that_is_free(qtbot: QtBot, scale: float, value_deg: float) -> None:
    set_scale(scale)
    goal = Goal("knee_stance_to_swing_deg", GoalOf.LEFT, value_deg, datetime.date(2026, 1, 1))
    plot = knee_plot(qtbot, visit(0, shoes(38.0)), visit(90, shoes(60.0)), goals=[goal])
    plot.resize(round(400 * scale), plot.minimumSizeHint().height())
    (text,) = plot.painted_texts()
    assert text.text == f"goal L {value_deg:.0f}°"
    assert text.needed.width() <= text.box.width()
    assert text.box.top() >= -1
    assert text.box.bottom() <= plot.height() + 1
    set_scale(1.0)


def test_dates_that_would_touch_are_left_out_but_for_the_first_and_the_last(qtbot: QtBot) -> None:
    axis = DateAxis()
    qtbot.addWidget(axis)
    axis.resize(400, 28)
    axis.show_visits([visit(day, None) for day in (0, 3, 6, 150, 297, 300)])
    assert list(axis.labels()) == [0, 3, 5]
    assert [text.text for text in axis.labels().values()] == ["1 Jan", "31 May", "28 Oct"]
    axis.resize(4000, 28)
    assert list(axis.labels()) == [0, 2, 3, 5]
    for text in axis.painted_texts():
        assert text.box.left() >= 0
        assert text.box.right() <= axis.width()
        assert text.needed.width() <= text.box.width()


@pytest.mark.endurance
def test_visits_of_one_day_are_reported_apart(qtbot: QtBot) -> None:
    """By their place and by the time of the day; a visit of another day stays at its day, and none leaves the plot."""
    morning, noon = (replace(visit(0, shoes(50.0)), id=UUID(int=90 + k), clock=f"{9 + 3 * k:02d}:00") for k in (0, 1))
    alone = knee_plot(qtbot, morning, noon)
    assert alone.x_of(1) - alone.x_of(0) == pytest.approx(APART)
    assert [day_of(k, alone.visits) for k in (0, 1)] == ["1 Jan, 09:00", "1 Jan, 12:00"]
    later = knee_plot(qtbot, morning, noon, visit(100, shoes(50.0)))
    assert later.x_of(0) == later.plot.left() + INSET
    assert later.x_of(1) - later.x_of(0) == pytest.approx(APART)
    assert later.x_of(2) == pytest.approx(later.plot.right() - INSET)
    assert day_of(2, later.visits) == "11 Apr"
    last = knee_plot(qtbot, visit(0, shoes(50.0)), *[visit(100, shoes(50.0))] * 2)
    assert last.x_of(2) == pytest.approx(last.plot.right() - INSET)
    assert last.x_of(2) - last.x_of(1) == pytest.approx(APART)
    many = knee_plot(qtbot, *[visit(k // 2, shoes(50.0)) for k in range(200)])
    places = [many.x_of(k) for k in range(200)]
    assert all(after > before for before, after in pairwise(places))
    assert places[0] >= many.plot.left() + INSET - 1e-9
    assert places[-1] <= many.plot.right() - INSET + 1e-9

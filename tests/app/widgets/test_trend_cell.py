"""The small line of a table: where its points lie, and that nothing is drawn across a gap."""

import math

import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtWidgets import QApplication

from app.theme.current import current_theme, set_dark
from app.theme.theme import Theme
from app.widgets.trend_cell import WIDTH, TrendCell
from core.body import Side

ROOM = QRectF(0, 0, WIDTH, 28)


@pytest.fixture
def theme(qapp: QApplication) -> Theme:
    set_dark(False)
    return current_theme()


def painted(cell: TrendCell, theme: Theme) -> QImage:
    image = QImage(WIDTH, 28, QImage.Format.Format_RGB32)
    image.fill(QColor(theme.colours.surface))
    painter = QPainter(image)
    cell.paint(painter, ROOM, theme)
    painter.end()
    return image


def is_drawn(image: QImage, x: float, y: float = 14) -> bool:
    return image.pixelColor(round(x), round(y)).lightness() < 160


def test_points_lie_by_day_and_value_and_inside_the_cell(theme: Theme) -> None:
    first, middle, last = TrendCell((0.0, 0.25, 1.0), (1.0, 2.0, 3.0), (1.0, 3.0)).points(ROOM, theme)
    assert first is not None
    assert middle is not None
    assert last is not None
    assert (middle.x() - first.x()) / (last.x() - first.x()) == pytest.approx(0.25)
    assert first.y() > middle.y() > last.y()
    assert middle.y() == pytest.approx(14.0)
    assert first.x() > 3
    assert last.x() < WIDTH - 3
    assert last.y() > 3


def test_across_a_gap_nothing_is_joined(theme: Theme) -> None:
    whole = painted(TrendCell((0.0, 0.5, 1.0), (2.0, 2.0, 2.0), (1.0, 3.0)), theme)
    gap = painted(TrendCell((0.0, 0.5, 1.0), (2.0, math.nan, 2.0), (1.0, 3.0)), theme)
    for x in (WIDTH * 0.3, WIDTH * 0.5, WIDTH * 0.7):
        assert is_drawn(whole, x)
        assert not is_drawn(gap, x)
    for end in (5, WIDTH - 5):
        assert is_drawn(gap, end)


def test_the_error_is_grey_where_there_is_one(theme: Theme) -> None:
    grey = QColor(theme.colours.band_2sd)
    with_error = painted(TrendCell((0.0, 1.0), (math.nan, math.nan), (0.0, 4.0), band=(1.0, 3.0)), theme)
    without = painted(TrendCell((0.0, 1.0), (math.nan, math.nan), (0.0, 4.0)), theme)
    assert with_error.pixelColor(WIDTH // 2, 14) == grey
    assert with_error.pixelColor(WIDTH // 2, 3) != grey
    assert without.pixelColor(WIDTH // 2, 14) != grey


def test_a_leg_has_its_colour_and_one_value_is_a_point_in_the_middle(theme: Theme) -> None:
    cell = TrendCell((0.0,), (5.0,), (5.0, 5.0), side=Side.LEFT)
    (point,) = cell.points(ROOM, theme)
    assert point is not None
    assert point.y() == 14.0
    assert painted(cell, theme).pixelColor(round(point.x()), 14) == theme.curve(Side.LEFT)


def test_it_states_its_values_and_is_copied_as_nothing() -> None:
    cell = TrendCell((0.0, 1.0), (1.0, 2.0), (1.0, 2.0), spoken="Walking speed: 1 0.71, 2 1.12")
    assert (cell.stated, cell.words) == ("Walking speed: 1 0.71, 2 1.12", "")

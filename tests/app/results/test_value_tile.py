"""The four tiles: every word in its box, an arrow that states its error, the goal over its tick."""

import math
from collections.abc import Iterator
from dataclasses import replace

import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QFontMetrics, QImage
from pytestqt.qtbot import QtBot

from app.results.value_tile import TileRow, ValueTile
from app.summary.tiles import Tile, TileChange, TileValue
from app.theme.current import current_theme, px, set_scale
from app.wording.translation import tr, use_language
from core.body import Side
from core.parameters import CADENCE, KNEE, SPEED, STANCE
from tests.app.room import settle, words_cut

WIDTHS = {"960 x 600": (864, True), "1280 x 800": (1016, False)}  # of the row in a window, and whether in brief


def since(change: str, *, rises: bool = True, is_beyond: bool = False) -> TileChange:
    brief = tr("{change} since {day}").format(change=change, day="23 Sep 2025")
    words = tr("{change} since {day}, within error").format(change=change, day="23 Sep 2025")
    return TileChange(brief if is_beyond else words, rises, is_beyond, brief, change)


def four() -> tuple[Tile, ...]:
    """As wide as they get: each has a change, a goal and a last visit, and the knee is of both legs."""
    speed = Tile(
        SPEED,
        tr("Walking speed"),
        "m/s",
        (TileValue("1.13", 1.13, last=1.0),),
        since("+0.13"),
        (0.0, 2.0),
        goals=(1.1,),
    )
    cadence = Tile(CADENCE, tr("Cadence"), tr("steps/min"), (TileValue("110", 110.0),), since("+4"), (40.0, 160.0))
    knees = TileValue("53°", 53.0, Side.LEFT, 48.0), TileValue("58°", 58.0, Side.RIGHT)
    name, brief = tr("Knee flexion, stance to swing"), tr("Knee, stance to swing")
    knee = Tile(KNEE, name, "", knees, since("L +22°", is_beyond=True), (0.0, 80.0), goals=(55.0,), brief=brief)
    value = TileValue("−10.2", -10.2)
    stance = Tile(
        STANCE, tr("Stance symmetry, L − R"), tr("points"), (value,), since("+2.0"), (-10.0, 10.0), (-3.0, 3.0)
    )
    return replace(speed, goal=f"{tr('goal')} 1.10 m/s"), cadence, replace(knee, goal=f"{tr('goal')} L 55°"), stance


@pytest.fixture(params=["en", "de"])
def language(request: pytest.FixtureRequest) -> Iterator[str]:
    use_language(request.param)
    yield request.param
    use_language("en")


@pytest.fixture
def tile(qtbot: QtBot) -> ValueTile:
    found = ValueTile()
    qtbot.addWidget(found)
    found.resize(245, 93)
    return found


def words(tile: ValueTile) -> list[str]:
    return [text.text for text in tile.painted_texts()]


def ink_boxes(tile: ValueTile) -> list[QRectF]:
    """Where letters and chips are."""
    assert tile.tile is not None
    px, found = current_theme().px, []
    for text in tile.painted_texts():
        ink = QFontMetrics(text.font).tightBoundingRect(text.text)
        box = QRectF(text.box.left(), text.box.center().y() - ink.height() / 2, ink.width(), ink.height())
        if text.align.value & 0x2:  # at the right
            box.moveRight(text.box.right())
        found.append(box)
    for text, side in tile.value_texts(tile.tile):
        if side is not None:
            found.append(QRectF(text.box.right() + px(6), text.box.center().y() - px(9), px(18), px(18)))
    return found


@pytest.mark.parametrize("scale", [1.0, 2.0])
@pytest.mark.parametrize("window", WIDTHS)
def test_every_word_of_a_tile_is_in_its_box_and_none_is_over_another(
    qtbot: QtBot, language: str, window: str, scale: float
) -> None:
    set_scale(scale)
    row = TileRow()
    qtbot.addWidget(row)
    width, is_brief = WIDTHS[window]
    row.set_brief(is_brief)
    row.show_tiles(four())
    row.resize(px(width), row.sizeHint().height())
    row.show()
    settle()
    assert row.minimumSizeHint().width() <= row.width()
    assert words_cut(row) == []
    for tile in row.tiles:
        boxes = ink_boxes(tile)
        assert all(QRectF(tile.rect()).contains(box) for box in boxes)
        crossed = [(i, k) for i, one in enumerate(boxes) for k in range(i) if one.intersects(boxes[k])]
        assert crossed == [], [words(tile), language]
        if tile.tile is not None and (bar := tile.bar_of(tile.tile)) is not None:
            assert not any(bar.intersects(box) for box in boxes)


def arrow_pixels(image: QImage, tile: ValueTile) -> tuple[QColor, QColor]:
    """The middle of the arrow, and what is around the tile's text."""
    assert tile.tile is not None
    (change,) = tile.change_texts(tile.tile)
    px = current_theme().px
    x, y = change.box.left() - px(5) - px(9) / 2, change.box.center().y()
    return image.pixelColor(round(x), round(y + (1 if tile.tile.change.rises else -1))), image.pixelColor(8, 50)


@pytest.mark.parametrize("rises", [True, False])
@pytest.mark.parametrize("is_beyond", [True, False])
def test_the_arrow_is_filled_beyond_error_and_outlined_within_it(tile: ValueTile, rises: bool, is_beyond: bool) -> None:
    speed = four()[0]
    tile.show_tile(replace(speed, change=since("+0.13", rises=rises, is_beyond=is_beyond)))
    middle, ground = arrow_pixels(tile.grab().toImage(), tile)
    assert middle.name() == (QColor(current_theme().colours.ink).name() if is_beyond else ground.name())


def test_a_first_visit_has_no_arrow(tile: ValueTile) -> None:
    first = replace(four()[0], change=TileChange("First visit", brief="First visit"))
    tile.show_tile(first)
    (change,) = tile.change_texts(first)
    assert change.text == "First visit"
    assert change.box.left() == px(16)  # where the arrow would be


def test_where_the_change_has_no_room_its_words_go_and_then_its_day_and_the_tooltip_has_all(tile: ValueTile) -> None:
    speed = four()[0]
    tile.show_tile(speed)
    for width, shown in ((280, 0), (220, 1), (100, 2)):
        tile.resize(width, 93)
        assert tile.change_texts(speed)[0].text == (speed.change.words, speed.change.brief, speed.change.size)[shown]
    assert speed.change.words in tile.toolTip()
    assert tile.accessibleName() == tile.toolTip()


def test_the_goal_is_over_its_tick_on_the_scale(tile: ValueTile) -> None:
    speed = four()[0]
    tile.show_tile(speed)
    bar, (goal,) = tile.bar_of(speed), tile.goal_texts(speed)
    assert bar is not None
    assert goal.text == "goal 1.10 m/s"
    x = bar.left() + bar.width() * 1.1 / 2.0
    assert goal.box.left() <= x <= goal.box.right()
    assert goal.box.bottom() <= bar.center().y() - px(8)
    top = round(bar.center().y() - px(7))  # of the tick, above bar and dot
    image = tile.grab().toImage()
    ink = QColor(current_theme().colours.ink)
    assert abs(image.pixelColor(round(x) - 1, top).lightness() - ink.lightness()) < 60
    tile.show_tile(replace(speed, goals=(), goal=""))
    assert tile.goal_texts(replace(speed, goals=(), goal="")) == []
    assert tile.grab().toImage().pixelColor(round(x) - 1, top) == QColor(current_theme().colours.surface)


def test_what_is_not_reported_has_the_word_and_no_scale_or_change(tile: ValueTile) -> None:
    nothing = TileValue("–", math.nan)
    tile.show_tile(Tile(SPEED, "Walking speed", "m/s", (nothing,), TileChange(""), (0.0, 2.0), why="not reported"))
    assert tile.tile is not None
    assert words(tile) == ["Walking speed", "Not reported"]
    assert tile.bar_of(tile.tile) is None
    assert tile.accessibleName() == "Walking speed: not reported"


def test_of_two_knees_the_one_that_is_not_reported_has_a_dash_and_is_read_out(tile: ValueTile) -> None:
    knee = replace(four()[2], values=(TileValue("–", math.nan, Side.LEFT), four()[2].values[1]), why="L not reported")
    tile.show_tile(knee)
    assert words(tile)[1:3] == ["–", "58°"]
    assert "L –, R 58°" in tile.accessibleName()
    assert "L not reported" in tile.accessibleName()

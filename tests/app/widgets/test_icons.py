"""Tests that every icon has its drawing and takes the ink it is given."""

from importlib.resources import files

import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QImage, QPainter

from app.theme.icons import Icon, paint_icon

SIDE = 48


def picture(icon: Icon, ink: str) -> QImage:
    image = QImage(SIDE, SIDE, QImage.Format.Format_ARGB32)
    image.fill(0)
    painter = QPainter(image)
    paint_icon(painter, icon, QRectF(0, 0, SIDE, SIDE), ink)
    painter.end()
    return image


def test_every_file_has_its_name_and_every_name_its_file() -> None:
    assert {file.name for file in (files("resources") / "icons").iterdir()} == {f"{icon}.svg" for icon in Icon}


@pytest.mark.usefixtures("qapp")
@pytest.mark.parametrize("icon", Icon)
def test_an_icon_is_drawn_in_the_ink_of_the_theme_alone(icon: Icon) -> None:
    image = picture(icon, "#ff0000")
    pixels = [image.pixelColor(x, y) for x in range(SIDE) for y in range(SIDE)]
    assert max(pixel.red() * pixel.alpha() for pixel in pixels) > 200 * 200
    assert not any(pixel.green() or pixel.blue() for pixel in pixels)


@pytest.mark.usefixtures("qapp")
def test_an_icon_of_another_ink_is_drawn_again() -> None:
    assert picture(Icon.PLAY, "#14202b") != picture(Icon.PLAY, "#edf1f4")

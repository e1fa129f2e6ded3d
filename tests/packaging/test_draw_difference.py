"""The manual's picture of differences shows one of each kind, judged by the limits in force."""

import importlib
from types import ModuleType

import pytest
from PySide6.QtGui import QImage

from app.theme.current import current_theme, load_fonts
from app.wording.translation import use_language
from core.verdicts.measurement_error import Judgement, Mark


@pytest.fixture
def script() -> ModuleType:
    return importlib.import_module("draw_difference")


def test_each_kind_of_difference_is_drawn_once(script: ModuleType) -> None:
    found = script.differences()
    assert [(one.judgement, one.mark) for one in found] == [
        (Judgement.EXCEEDS_ERROR, Mark.HEALTHY),
        (Judgement.EXCEEDS_ERROR, Mark.ERROR),
        (Judgement.INSIDE_ERROR, Mark.NONE),
        (Judgement.TOO_FEW_STRIDES, Mark.NONE),
    ]
    beyond, exceeding, within, _ = found
    edges = [edge for one in (beyond, exceeding, within) for edge in one.interval]
    assert beyond.difference > beyond.healthy > exceeding.difference > exceeding.error
    assert within.interval[0] < 0 < within.interval[1]
    assert all(script.LEAST_DEG < edge < script.MOST_DEG for edge in edges)


@pytest.mark.usefixtures("qapp")
def test_the_manual_has_the_picture_in_each_language_as_it_is_drawn(script: ModuleType) -> None:
    load_fonts()
    for language, folder in script.FOLDERS.items():
        use_language(language)
        try:
            now = script.drawn(current_theme())
        finally:
            use_language("en")
        stored = QImage(str(folder / "difference.png"))
        assert stored.size() == now.size()
        assert share_alike(script, stored, now) > 0.998  # edges may be smoothed in another way
        assert (folder / "difference-dark.png").is_file()


def share_alike(script: ModuleType, one: QImage, other: QImage) -> float:
    """How many pixels of the chart, which has no letters in it, are alike, of one."""
    across = range(0, round(script.PIXELS * script.WORDS * script.WIDTH), 2)
    down = range(script.PIXELS * script.TOP, script.PIXELS * (script.HEIGHT - script.AXIS), 2)
    alike = [one.pixelColor(x, y).lightness() - other.pixelColor(x, y).lightness() for x in across for y in down]
    return sum(abs(difference) < 24 for difference in alike) / len(alike)

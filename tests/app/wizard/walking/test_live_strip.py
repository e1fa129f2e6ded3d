"""Live strips: moved on by pixels they look as if drawn again; dashes stand still; gaps are empty and stated in
words."""

import numpy as np
import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.charts.axes import ANKLE_DEG, KNEE_DEG
from app.theme.current import current_theme, set_dark, set_scale, set_theme
from app.wizard.walking.live_strip import LiveStrip, _Trace
from app.wizard.walking.readout import LiveTrace
from core.body import Side
from core.samples import FloatArray, IntArray

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

RATE_HZ, FRAME_S = 100.0, 1 / 30
KEPT_S = 15.0
PERIOD_S = 1.1


@pytest.fixture
def strip(qtbot: QtBot) -> LiveStrip:
    strip = LiveStrip(KNEE_DEG, 30)
    qtbot.addWidget(strip)
    strip.resize(780, 160)
    strip.show()
    return strip


def knee_rad(time_s: FloatArray) -> FloatArray:
    return np.deg2rad(30 - 28 * np.cos(2 * np.pi * time_s / PERIOD_S))


def trace(
    now_s: float, shift_s: float = 0.0, gap_s: tuple[float, float] | None = None, is_provisional: bool = False
) -> LiveTrace:
    """What is kept of a walk that began at 0."""
    time_s = np.arange(max(0, round((now_s - KEPT_S) * RATE_HZ)), int(now_s * RATE_HZ) + 1) / RATE_HZ
    if gap_s is not None:
        time_s = time_s[(time_s < gap_s[0]) | (time_s > gap_s[1])]
    return LiveTrace(time_s, knee_rad(time_s + shift_s), is_provisional)


def walk(strip: LiveStrip, from_s: float, to_s: float, gap_s: tuple[float, float] | None = None) -> None:
    """Show every frame of a stretch of the walk, and let each be painted."""
    for now_s in np.arange(from_s, to_s, FRAME_S).tolist():
        strip.show_traces(
            now_s, {Side.LEFT: trace(now_s), Side.RIGHT: trace(now_s, PERIOD_S / 2, gap_s, is_provisional=now_s < 3.0)}
        )
        QApplication.processEvents()


def rounded(strip: LiveStrip) -> list[tuple[Side, float, float | None]]:
    """Give what is missing, to a tenth of a second."""
    return [
        (span.side, round(span.start_s, 1), None if span.end_s is None else round(span.end_s, 1))
        for span in strip.missing
    ]


def picture(strip: LiveStrip) -> IntArray:
    image = strip.grab().toImage().convertToFormat(strip.grab().toImage().Format.Format_RGB32)
    pixels = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.width(), 4)
    return pixels[:, :, :3].astype(np.int64)


def coloured(pixels: IntArray, colour: str) -> IntArray:
    """Give where (n, 2) a picture is all but exactly of a colour."""
    blue_green_red = [int(colour[k : k + 2], 16) for k in (5, 3, 1)]
    return np.argwhere(np.abs(pixels - blue_green_red).max(axis=2) < 24)


def test_a_strip_that_moved_on_looks_as_if_drawn_again(strip: LiveStrip) -> None:
    walk(strip, 0.0, 13.0, gap_s=(8.0, 10.0))
    moved = picture(strip)
    set_theme(current_theme())  # everything is drawn from the history
    np.testing.assert_array_equal(picture(strip), moved)
    assert len(coloured(moved, current_theme().colours.left)) > 1000


def test_dashes_stand_still_in_time(strip: LiveStrip) -> None:
    walk(strip, 0.0, 10.0)
    before = coloured(picture(strip), current_theme().colours.right)
    walk(strip, 10.0, 12.0)
    after = coloured(picture(strip), current_theme().colours.right)
    width = 780 - 40 - 16
    moved_px = int((12.0 - FRAME_S / 2) * width / 8) - int((10.0 - FRAME_S / 2) * width / 8)
    for shift_px in (moved_px - 1, moved_px, moved_px + 1):  # the last frames lie a fraction of a pixel before
        there = {(row, column - shift_px) for row, column in before.tolist() if 100 < column - shift_px < 500}
        here = {(row, column) for row, column in after.tolist() if 100 < column < 500}
        if here == there:
            return
    pytest.fail("the dashes of 2 s ago are not where they were drawn")


def test_a_gap_stays_empty_and_is_stated(strip: LiveStrip) -> None:
    walk(strip, 0.0, 11.0, gap_s=(7.0, 9.0))
    assert rounded(strip) == [(Side.RIGHT, 7.0, 9.0)]
    pixels = picture(strip)
    box = coloured(pixels[12:13], current_theme().colours.caution)  # above the curves
    left, right = box[:, 1].min(), box[:, 1].max()
    assert right - left == pytest.approx(2.0 * 724 / 8, abs=4)
    assert not len(coloured(pixels[:, left + 3 : right - 2], current_theme().colours.right))
    assert len(coloured(pixels[:, left + 3 : right - 2], current_theme().colours.left)) > 100


def test_a_leg_that_falls_silent_is_reported_until_it_is_back(strip: LiveStrip) -> None:
    walk(strip, 0.0, 5.0, gap_s=(4.0, 90.0))
    assert rounded(strip) == [(Side.RIGHT, 4.0, None)]
    walk(strip, 5.0, 5.5, gap_s=(4.0, 5.2))
    assert rounded(strip) == [(Side.RIGHT, 4.0, 5.2)]


def test_a_short_break_ends_the_line_without_words(strip: LiveStrip) -> None:
    walk(strip, 0.0, 6.0, gap_s=(5.0, 5.3))
    assert rounded(strip) == []
    pixels = picture(strip)
    x = 40 + round((5.15 - 6.0 + 8.0) * 724 / 8)
    assert not len(coloured(pixels[:, x - 8 : x + 8], current_theme().colours.right))


def test_what_is_provisional_is_thin(strip: LiveStrip) -> None:
    walk(strip, 0.0, 6.0)  # provisional for 3 s

    def ink(from_s: float) -> int:
        left = 40 + round((from_s - 6.0 + 8.0) * 724 / 8)
        return len(coloured(picture(strip)[:, left : left + 100], current_theme().colours.right))

    assert ink(0.8) < 0.6 * ink(3.0 + 0.8)


@pytest.mark.parametrize("change", ["size", "theme", "scale", "seconds", "hidden"])
def test_the_strip_comes_back_from_its_history(strip: LiveStrip, change: str) -> None:
    walk(strip, 0.0, 9.0)
    if change == "size":
        strip.resize(1000, 200)
    elif change == "theme":
        set_dark(True)
    elif change == "scale":
        set_scale(1.5)
    elif change == "seconds":
        strip.set_seconds(4.0)
    else:
        strip.hide()
        walk(strip, 9.0, 10.0)
        strip.show()
    pixels = picture(strip)
    colours = current_theme().colours
    for colour in (colours.left, colours.right):
        columns = coloured(pixels, colour)[:, 1]
        assert columns.min() < strip.width() * 0.15
        assert columns.max() > strip.width() * 0.9


def test_axes_stay_until_a_walk_leaves_them_and_then_stay_wider(qtbot: QtBot) -> None:
    strip = LiveStrip(ANKLE_DEG, 20)
    qtbot.addWidget(strip)
    time_s = np.arange(100) / RATE_HZ
    strip.show_traces(1.0, {Side.LEFT: LiveTrace(time_s, np.deg2rad(25 * np.sin(6 * time_s)))})
    assert strip.range_deg == ANKLE_DEG
    strip.show_traces(2.0, {Side.LEFT: LiveTrace(1.0 + time_s, np.deg2rad(-33 * np.sin(6 * time_s)))})
    assert strip.range_deg == (-40.0, 40.0)
    strip.show_traces(3.0, {Side.LEFT: LiveTrace(2.0 + time_s, np.zeros(100))})
    assert strip.range_deg == (-40.0, 40.0)
    strip.clear()
    assert strip.range_deg == ANKLE_DEG


def test_a_clock_that_goes_back_begins_again(strip: LiveStrip) -> None:
    walk(strip, 0.0, 5.0, gap_s=(2.0, 3.0))
    walk(strip, 0.0, 0.5)
    assert rounded(strip) == []


def test_the_filters_get_time_for_their_first_angle(strip: LiveStrip) -> None:
    nothing = LiveTrace(np.zeros(0), np.zeros(0))
    strip.show_traces(10.0, {Side.LEFT: nothing})
    strip.show_traces(12.0, {Side.LEFT: nothing})
    assert rounded(strip) == []
    strip.show_traces(16.0, {Side.LEFT: nothing})
    assert rounded(strip) == [(Side.LEFT, 10.0, None)]


def test_a_leg_of_which_nothing_has_come_yet_is_painted_as_nothing(strip: LiveStrip) -> None:
    nothing = LiveTrace(np.zeros(0), np.zeros(0), is_provisional=True)
    strip.show_traces(1.0, {Side.LEFT: trace(1.0), Side.RIGHT: nothing})
    with_nothing = picture(strip)
    strip.clear()
    strip.show_traces(1.0, {Side.LEFT: trace(1.0)})
    assert np.array_equal(with_nothing, picture(strip))


def test_a_line_without_a_row_is_measured_without_one() -> None:
    # an exception while it is painted ends the program
    line = _Trace()
    line.measure(0, 100.0, 2.0)
    assert len(line.length_px) == 0

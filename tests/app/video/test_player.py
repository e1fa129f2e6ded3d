"""A clip's frame on the screen: the latest that was asked for, its tags, and nothing that is left after `clear`."""

import math
from collections.abc import Callable
from dataclasses import replace
from threading import Event

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QColor, QImage
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.theme.current import px
from app.video.player import ClipPlayer, ValueTag
from app.video.sync_words import sync_in_words
from core.body import Side
from core.video.clip import Clip, Sync, SyncBy
from tests.app.drawn_clips import SURE, Jpegs, jpeg_of, plain_clip
from tests.app.room import words_cut


@pytest.fixture
def player(qtbot: QtBot) -> ClipPlayer:
    found = ClipPlayer()
    qtbot.addWidget(found)
    found.resize(480, 360)
    with qtbot.waitActive(found):
        found.show()
        found.activateWindow()
    return found


def show(player: ClipPlayer, clip: Clip) -> None:
    player.show_clip(clip, "walk 1 · from the left", sync_in_words(clip), is_caution=not clip.is_synchronised)


def middle(player: ClipPlayer) -> int:
    """How bright the picture is: `plain_clip` makes each frame brighter."""
    return player.grab().toImage().pixelColor(240, 180).red()


def test_the_frame_that_was_asked_for_is_shown_whole_and_in_its_shape(player: ClipPlayer, qtbot: QtBot) -> None:
    show(player, plain_clip())
    player.show_frame(7)
    qtbot.waitUntil(lambda: player.shown_frame == 7)
    assert middle(player) == pytest.approx(70, abs=3)
    box = player.picture_box
    assert box.width() / box.height() == pytest.approx(16 / 9, rel=0.01)
    assert box.width() == 480  # as wide as there is room


def test_the_latest_request_wins_and_what_lies_between_may_be_skipped(player: ClipPlayer, qtbot: QtBot) -> None:
    """The first frame is held until all others were asked for."""
    clip, begun, go_on = plain_clip(), Event(), Event()

    class Slow(Jpegs):
        def jpeg(self, number: int) -> bytes:
            if number == 0:
                begun.set()
                assert go_on.wait(10)
            return super().jpeg(number)

    pictures = Slow([clip.pictures.jpeg(k) for k in range(20)])
    show(player, replace(clip, pictures=pictures))
    player.show_frame(0)
    assert begun.wait(10)
    for number in range(1, 20):
        player.show_frame(number)
    go_on.set()
    qtbot.waitUntil(lambda: player.shown_frame == 19)
    assert pictures.asked == [0, 19]


def test_after_clear_nothing_is_left_and_nothing_comes(player: ClipPlayer, qtbot: QtBot) -> None:
    show(player, plain_clip())
    player.show_values([ValueTag(Side.LEFT, "knee 50°")])
    player.show_frame(20)
    qtbot.waitUntil(lambda: player.shown_frame == 20)
    player.show_frame(22)  # at work, or decoded and not yet received
    player.clear()
    QTest.qWait(0)
    assert player.picture.isNull()
    assert player.clip is None
    assert player.shown_frame is None
    assert not player.painted_texts()
    assert middle(player) not in range(195, 225)


def test_a_window_that_nobody_sees_decodes_nothing(player: ClipPlayer, qtbot: QtBot) -> None:
    clip = plain_clip()
    player.hide()
    show(player, clip)
    player.show_frame(3)
    assert isinstance(clip.pictures, Jpegs)
    assert clip.pictures.asked == []
    player.show()
    qtbot.waitUntil(lambda: player.shown_frame == 3)


def test_a_damaged_frame_is_stated_and_the_next_one_is_shown(player: ClipPlayer, qtbot: QtBot) -> None:
    show(player, plain_clip(damaged=[3]))
    player.show_frame(3)
    qtbot.waitUntil(lambda: player.note != "")
    assert "This frame cannot be read." in [text.text for text in player.painted_texts()]
    player.show_frame(4)
    qtbot.waitUntil(lambda: player.shown_frame == 4)
    assert "This frame cannot be read." not in [text.text for text in player.painted_texts()]


def test_bytes_that_are_no_picture_are_a_damaged_frame(player: ClipPlayer, qtbot: QtBot) -> None:
    show(player, replace(plain_clip(), pictures=Jpegs([b"no picture"] * 20)))
    player.show_frame(3)
    qtbot.waitUntil(lambda: player.note != "")
    assert player.picture.isNull()


@pytest.mark.parametrize(
    ("sync", "words", "is_sure"),
    [
        (None, "Not synchronised", False),
        (Sync(0.1, math.nan, SyncBy.CLOCK), "Not synchronised, computer's clock only", False),
        (SURE, "Synchronised, ±1 frame", True),
        (Sync(0.1, 1 / 30, SyncBy.HAND), "Synchronised, ±1 frame", True),
        (Sync(0.1, 0.034, SyncBy.MOTION), "Synchronised, ±2 frames", True),
        (Sync(0.1, 0.2, SyncBy.CLOCK), "Synchronised, ±6 frames", True),
    ],
)
def test_how_well_a_clip_is_synchronised_is_stated_in_frames(sync: Sync | None, words: str, is_sure: bool) -> None:
    clip = plain_clip(sync=sync)
    assert sync_in_words(clip) == words
    assert clip.is_synchronised is is_sure


def test_amber_is_for_a_clip_that_is_not_synchronised_alone(player: ClipPlayer) -> None:
    def tag_colour() -> QColor:
        text = next(one for one in player.painted_texts() if "ynchronised" in one.text)
        return player.grab().toImage().pixelColor(text.box.topLeft().toPoint() + QPoint(px(5), px(3)))

    show(player, plain_clip(sync=None))
    amber = tag_colour()
    assert amber.red() > amber.blue() + 40
    show(player, plain_clip())
    dark = tag_colour()
    assert abs(dark.red() - dark.blue()) < 40


@pytest.mark.parametrize("width", [480, 240])
def test_tags_have_their_room_and_are_read_out(player: ClipPlayer, width: int) -> None:
    player.resize(width, 240)
    show(player, plain_clip())
    player.show_values([ValueTag(side, words) for side in Side for words in ("knee 50°", "ankle −10°")])
    player.describe()
    assert words_cut(player) == []
    assert player.accessibleName() == "Video: walk 1 · from the left"
    for words in ("Synchronised, ±1 frame", "L knee 50°", "R ankle −10°"):
        assert words in player.accessibleDescription()
    boxes = [text.box for text in player.painted_texts()]
    assert not any(one.intersects(other) for k, one in enumerate(boxes) for other in boxes[k + 1 :])


def test_drawn_along_with_shift_frames_are_counted_and_without_it_none(player: ClipPlayer) -> None:
    dragged: list[int] = []
    player.dragged.connect(dragged.append)
    show(player, plain_clip())
    for modifier, expected in ((Qt.KeyboardModifier.NoModifier, 0), (Qt.KeyboardModifier.ShiftModifier, 5)):
        dragged.clear()
        QTest.mousePress(player, Qt.MouseButton.LeftButton, modifier, QPoint(100, 100))
        QTest.mouseMove(player, QPoint(100 + px(31), 100))
        QTest.mouseRelease(player, Qt.MouseButton.LeftButton, modifier, QPoint(100 + px(31), 100))
        assert sum(dragged) == expected


def test_a_jpeg_is_decoded_no_larger_than_it_is_shown(player: ClipPlayer, qtbot: QtBot) -> None:
    large = QImage(1280, 720, QImage.Format.Format_RGB32)
    large.fill(QColor(90, 90, 90))
    show(player, replace(plain_clip(), pictures=Jpegs([jpeg_of(large)] * 20)))
    player.show_frame(1)
    qtbot.waitUntil(lambda: player.shown_frame == 1)
    ratio: Callable[[], float] = player.devicePixelRatioF
    assert player.picture.width() == pytest.approx(480 * ratio(), abs=1)

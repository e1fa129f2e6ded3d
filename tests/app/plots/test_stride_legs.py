"""The legs beside the curves: where each is at the cursor, what moves them, and why there are none."""

from collections.abc import Mapping

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.plots.stride_legs import StrideLegs
from app.summary.mean_legs import ANKLE, HIP, KNEE, TOES, MeanLegs, ThinBend, bent_by
from app.wording.translation import use_language
from core.body import Side
from core.gait.cycles import POINTS
from core.samples import FloatArray
from tests.app.room import words_cut

SHIFT = Qt.KeyboardModifier.ShiftModifier


def leg(ahead_m: float) -> FloatArray:
    """A straight leg (101, 4, 2) whose foot goes from `ahead_m` to as far behind over the stride."""
    share = np.linspace(0.0, 1.0, POINTS)
    ankle = np.stack([ahead_m * (1 - 2 * share), np.full(POINTS, -0.8)], axis=1)
    return np.stack([np.zeros((POINTS, 2)), ankle / 2, ankle, ankle + np.array([0.2, 0.0])], axis=1)


def both(**change: object) -> MeanLegs:
    """The left leg's stride is longer than the right's."""
    points_m = {Side.LEFT: leg(0.4), Side.RIGHT: leg(0.2)}
    return MeanLegs(**{"points_m": points_m, **change})  # type: ignore[arg-type] # of any field


KNEES: Mapping[Side, FloatArray | None] = {Side.LEFT: np.arange(POINTS) * 0.5, Side.RIGHT: np.full(POINTS, -4.0)}


@pytest.fixture
def legs(qtbot: QtBot) -> StrideLegs:
    found = StrideLegs()
    qtbot.addWidget(found)
    found.resize(160, 260)
    found.show_legs(both(), KNEES)
    with qtbot.waitActive(found):
        found.show()
        found.activateWindow()
    return found


def test_each_leg_is_at_the_same_percent_of_its_own_cycle(legs: StrideLegs) -> None:
    """However long its strides are: no common clock is needed."""
    legs.show_percent(25.0)
    shown = legs.picture.legs
    assert shown is not None
    for side, ahead_m in ((Side.LEFT, 0.2), (Side.RIGHT, 0.1)):
        assert shown.pose_m(side, legs.picture.percent)[ANKLE, 0] == pytest.approx(ahead_m)
    assert legs.picture.readings() == {Side.LEFT: "knee 12°", Side.RIGHT: "knee −4°"}
    assert legs.accessibleDescription() == "25 %, knee 12°, knee −4°"


def test_arrows_move_the_cursor_by_one_percent_and_with_shift_by_ten(qtbot: QtBot, legs: StrideLegs) -> None:
    legs.show_percent(50.0)
    with qtbot.waitSignal(legs.moved) as moved:
        QTest.keyClick(legs, Qt.Key.Key_Right)
    assert moved.args == [51.0]
    QTest.keyClick(legs, Qt.Key.Key_Left, SHIFT)
    assert legs.percent == 41.0
    legs.show_percent(0.0)
    QTest.keyClick(legs, Qt.Key.Key_Left)
    assert legs.percent == 99.0  # a cycle goes on where it began


def test_space_or_a_click_plays_and_stops(legs: StrideLegs) -> None:
    playing = []
    for _ in range(2):
        QTest.keyClick(legs, Qt.Key.Key_Space)
        playing.append(legs.is_playing)
    for _ in range(2):
        QTest.mouseClick(legs, Qt.MouseButton.LeftButton)
        playing.append(legs.is_playing)
    assert playing == [True, False, True, False]


def test_a_beat_of_playing_moves_the_legs_on(qtbot: QtBot, legs: StrideLegs) -> None:
    legs.show_percent(99.5)
    with qtbot.waitSignal(legs.moved):
        legs.turn()
    assert 0.0 < legs.percent < 50.0


def test_out_of_sight_nothing_plays(legs: StrideLegs) -> None:
    legs.turn()
    legs.hide()
    assert not legs.is_playing


def test_another_walk_stops_them_where_the_cursor_was(legs: StrideLegs) -> None:
    legs.show_percent(40.0)
    legs.turn()
    legs.show_legs(both(), KNEES)
    assert not legs.is_playing
    assert legs.percent == 40.0


def test_without_legs_it_is_stated_why_and_nothing_plays(legs: StrideLegs) -> None:
    legs.show_legs(None, KNEES)
    assert legs.note.isVisible()
    assert not legs.picture.isVisible()
    assert legs.note.text() == "To draw legs, data of a thigh sensor and an absolute knee angle are needed."
    assert legs.accessibleDescription() == legs.toolTip() == legs.note.text()
    QTest.keyClick(legs, Qt.Key.Key_Space)
    assert not legs.is_playing
    legs.show_legs(both(), KNEES)
    assert not legs.note.isVisible()


def test_one_leg_has_its_reading_alone_and_what_is_not_reported_is_named(legs: StrideLegs) -> None:
    legs.show_legs(both(points_m={Side.RIGHT: leg(0.2)}), {Side.RIGHT: KNEES[Side.RIGHT]})
    assert [text.text for text in legs.picture.painted_texts()] == ["knee −4°"]
    legs.show_legs(both(), {**KNEES, Side.LEFT: None})
    assert [text.text for text in legs.picture.painted_texts()] == ["not reported", "knee −4°"]


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_reading_that_is_not_reported_has_its_room(qtbot: QtBot, language: str) -> None:
    use_language(language)
    try:
        found = StrideLegs()
        qtbot.addWidget(found)
        found.show_legs(both(), {**KNEES, Side.LEFT: None})
        found.resize(found.minimumSizeHint())
        found.show()
        assert words_cut(found) == []
    finally:
        use_language("en")


def test_a_thin_leg_is_bent_from_the_same_thigh() -> None:
    """By hand: a shank turned back by 90° about the knee, and a foot that keeps its angle with it."""
    upright = np.array([[0.0, 0.0], [0.0, -0.4], [0.0, -0.8], [0.2, -0.8]])
    bent = bent_by(upright, 90.0, 0.0)
    assert bent[[HIP, KNEE]].tolist() == upright[[HIP, KNEE]].tolist()
    np.testing.assert_allclose(bent[ANKLE], [-0.4, -0.4], atol=1e-12)  # behind the knee, at its height
    np.testing.assert_allclose(bent[TOES], [-0.4, -0.6], atol=1e-12)  # and its toes down
    lifted = bent_by(upright, 0.0, 90.0)  # dorsiflexed: toes up, before the shin
    np.testing.assert_allclose(lifted[ANKLE], upright[ANKLE], atol=1e-12)
    np.testing.assert_allclose(lifted[TOES], [0.0, -0.6], atol=1e-12)


def test_thin_legs_are_drawn_only_where_a_thin_line_is_and_the_tooltip_names_them(legs: StrideLegs) -> None:
    plain, words = legs.picture.grab().toImage(), legs.toolTip()
    nothing = np.zeros(POINTS)
    legs.show_legs(both(), KNEES, {Side.LEFT: ThinBend(nothing + 30.0, nothing)})
    assert legs.picture.grab().toImage() != plain
    assert legs.toolTip() == f"{words} Thin: shank and foot at the angles of the thin line."
    without_ankle = legs.picture.grab().toImage()
    legs.show_legs(both(), KNEES, {Side.LEFT: ThinBend(nothing + 30.0, nothing + np.nan)})
    assert legs.picture.grab().toImage() != without_ankle  # its shank alone
    legs.show_legs(both(), KNEES)
    assert legs.picture.grab().toImage() == plain


def test_a_pelvis_is_drawn_where_it_may_be_read_and_leans_with_its_tilt(legs: StrideLegs) -> None:
    pictures = [legs.picture.grab().toImage()]
    for tilt_rad in (0.0, 0.3):
        legs.show_legs(both(tilt_rad=np.full(POINTS, tilt_rad)), KNEES)
        pictures.append(legs.picture.grab().toImage())
    assert len({bytes(one.constBits()) for one in pictures}) == 3

"""The legs beside the curves: keys move them, playing goes on by itself, and both legs keep their places."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.plots.moving_legs import MovingLegs
from app.summary.mean_legs import MeanLeg, MeanLegs
from app.theme.notifier import ThemeNotifier, load_fonts
from core.body import Side


def leg() -> MeanLeg:
    swing = 0.3 * np.cos(2 * np.pi * np.linspace(0, 1, 101))
    points = np.zeros((101, 4, 2))
    for k, (share, height) in enumerate(((0.0, 0.0), (0.5, -0.4), (1.0, -0.8), (1.5, -0.85))):
        points[:, k, 0], points[:, k, 1] = share * swing, height
    return MeanLeg(points, 1.1, 62.0)


@pytest.fixture
def legs(qtbot: QtBot, qapp: QApplication) -> MovingLegs:
    load_fonts()
    look = ThemeNotifier()
    look.set_dark(False)
    legs = MovingLegs(look)
    qtbot.addWidget(legs)
    legs.resize(400, 440)
    legs.show_legs(MeanLegs({side: leg() for side in Side}, Side.LEFT, 50.0, is_together=True))
    legs.show()
    return legs


def test_arrows_step_through_the_stride_and_each_leg_has_its_own_place(legs: MovingLegs) -> None:
    legs.show_percent(0.0)
    QTest.keyClick(legs, Qt.Key.Key_Right)
    QTest.keyClick(legs, Qt.Key.Key_Right, Qt.KeyboardModifier.ShiftModifier)
    assert legs.percent == pytest.approx(11.0)
    assert legs.places == {Side.LEFT: pytest.approx(11.0), Side.RIGHT: pytest.approx(61.0)}
    QTest.keyClick(legs, Qt.Key.Key_Left, Qt.KeyboardModifier.ShiftModifier)
    QTest.keyClick(legs, Qt.Key.Key_Left, Qt.KeyboardModifier.ShiftModifier)
    assert legs.percent == pytest.approx(91.0)
    assert legs.accessibleDescription() == "91 % of the left gait cycle"


def test_another_place_is_another_picture(legs: MovingLegs) -> None:
    legs.show_percent(0.0)
    before = legs.grab().toImage()
    legs.show_percent(40.0)
    assert legs.grab().toImage() != before


def test_space_plays_and_stops_and_out_of_sight_nothing_plays(qtbot: QtBot, legs: MovingLegs) -> None:
    legs.show_percent(0.0)
    QTest.keyClick(legs, Qt.Key.Key_Space)
    qtbot.waitUntil(lambda: legs.percent > 2.0, timeout=5000)
    assert (legs.is_playing, legs.play.text()) == (True, "Stop")
    QTest.keyClick(legs, Qt.Key.Key_Space)
    assert (legs.is_playing, legs.play.text()) == (False, "Play")
    legs.turn()
    legs.hide()
    assert (legs.is_playing, legs.isHidden()) == (False, True)


def test_clocks_that_do_not_agree_are_stated_and_no_legs_say_why(legs: MovingLegs) -> None:
    assert "clocks" not in legs.note.text()
    legs.show_legs(MeanLegs({side: leg() for side in Side}, Side.LEFT))
    assert "Left and right sensors are not synchronised: legs are drawn half a gait cycle apart" in legs.note.text()
    legs.show_legs(None)
    assert legs.note.text().startswith("To draw legs, data of a thigh sensor and an absolute knee angle are needed")
    assert legs.places == {}
    legs.turn()
    assert not legs.is_playing

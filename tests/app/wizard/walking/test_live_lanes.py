"""Live lanes: moved on by pixels they look as if drawn again, also where a phase was reported late; silence is
stated."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.theme.current import current_theme, set_dark
from app.wizard.walking.live_lanes import LiveLanes
from app.wizard.walking.readout import LiveLane, PhaseSpan
from core.body import Side
from core.gait.phases import Phase

FRAME_S = 1 / 30
LOADING, FLAT, PRE_SWING, SWING = Phase.LOADING, Phase.FOOT_FLAT, Phase.PRE_SWING, Phase.SWING
SHARES = ((LOADING, 0.0, 0.12), (FLAT, 0.12, 0.45), (PRE_SWING, 0.45, 0.6), (SWING, 0.6, 1.0))


@pytest.fixture
def lanes(qtbot: QtBot) -> LiveLanes:
    lanes = LiveLanes()
    qtbot.addWidget(lanes)
    lanes.resize(780, 84)
    lanes.show()
    return lanes


def lane(now_s: float, shift_s: float = 0.0) -> LiveLane:
    """Strides of a second each, as known at `now_s`: an event is reported 0.1 s late, and until then the phase goes
    on."""
    spans = []
    reported_s = now_s - 0.1
    for start_s in np.arange(np.floor(now_s - 15), now_s + 1) + shift_s:
        for phase, begin, end in SHARES:
            if start_s + begin < reported_s:
                is_over = start_s + end < reported_s
                spans.append(PhaseSpan(phase, float(start_s + begin), float(start_s + end) if is_over else None))
    return LiveLane(tuple(spans))


def walk(lanes: LiveLanes, from_s: float, to_s: float) -> None:
    for now_s in np.arange(from_s, to_s, FRAME_S).tolist():
        lanes.show_lanes(now_s, {Side.LEFT: lane(now_s), Side.RIGHT: lane(now_s, 0.5)})
        QApplication.processEvents()


def picture(lanes: LiveLanes) -> QImage:
    return lanes.grab().toImage()


def colour_at(lanes: LiveLanes, ago_s: float, side: Side) -> str:
    x = 40 + 724 * (8 - ago_s) / 8
    return picture(lanes).pixelColor(QPoint(round(x), 6 if side is Side.LEFT else 40)).name()


def test_lanes_that_moved_on_look_as_if_drawn_again(lanes: LiveLanes) -> None:
    walk(lanes, 20.0, 31.0)
    moved = picture(lanes)
    lanes.redraw()
    assert picture(lanes) == moved


def test_each_phase_has_its_look(lanes: LiveLanes) -> None:
    walk(lanes, 20.0, 20.1)
    ago_s = 20.0 + 2 * FRAME_S - 16.0  # of the stride that began at 16
    assert colour_at(lanes, ago_s - 0.06, Side.LEFT) == current_theme().curve(Side.LEFT).name()
    assert colour_at(lanes, ago_s - 0.3, Side.LEFT) == current_theme().soft(Side.LEFT).name()
    assert colour_at(lanes, ago_s - 0.8, Side.LEFT) == current_theme().colours.surface.lower()
    assert colour_at(lanes, ago_s - 0.5 - 0.06, Side.RIGHT) == current_theme().curve(Side.RIGHT).name()


def test_a_phase_reported_late_is_mended(lanes: LiveLanes) -> None:
    lanes.show_lanes(10.0, {Side.LEFT: LiveLane((PhaseSpan(FLAT, 7.0, None),))})
    assert colour_at(lanes, 0.5, Side.LEFT) == current_theme().soft(Side.LEFT).name()
    mended = (PhaseSpan(FLAT, 7.0, 9.0), PhaseSpan(LOADING, 9.0, None))
    lanes.show_lanes(10.01, {Side.LEFT: LiveLane(mended)})
    assert colour_at(lanes, 0.5, Side.LEFT) == current_theme().curve(Side.LEFT).name()
    assert colour_at(lanes, 1.5, Side.LEFT) == current_theme().soft(Side.LEFT).name()


def test_a_silent_foot_is_stated_in_its_lane(lanes: LiveLanes) -> None:
    silent = LiveLane((PhaseSpan(FLAT, 5.0, 9.8),), ((9.8, None),))
    lanes.show_lanes(10.0, {Side.LEFT: silent})
    assert (
        colour_at(lanes, 0.7, Side.LEFT) == current_theme().colours.caution.lower()
    )  # the words take the room they need
    back = LiveLane((PhaseSpan(FLAT, 5.0, 9.8), PhaseSpan(FLAT, 10.2, None)), ((9.8, 10.2),))
    lanes.show_lanes(11.0, {Side.LEFT: back})
    assert colour_at(lanes, 1.0, Side.LEFT) == current_theme().colours.caution.lower()
    assert colour_at(lanes, 0.5, Side.LEFT) == current_theme().soft(Side.LEFT).name()


def test_a_leg_without_a_lane_stays_empty(lanes: LiveLanes) -> None:
    walk(lanes, 20.0, 20.1)
    lanes.show_lanes(20.2, {Side.LEFT: lane(20.2)})
    assert colour_at(lanes, 2.0, Side.RIGHT) == current_theme().colours.surface.lower()


@pytest.mark.parametrize("change", ["size", "theme", "seconds"])
def test_lanes_come_back_from_what_they_show(lanes: LiveLanes, change: str) -> None:
    walk(lanes, 20.0, 21.0)
    if change == "size":
        lanes.resize(1000, 84)
    elif change == "theme":
        set_dark(True)
    else:
        lanes.set_seconds(4.0)
    image = picture(lanes)
    required = current_theme().curve(Side.LEFT).name()
    columns = [x for x in range(image.width()) if image.pixelColor(x, 6).name() == required]
    assert max(columns) > 0.7 * lanes.width()
    assert min(column for column in columns if column > 40) < 0.3 * lanes.width()

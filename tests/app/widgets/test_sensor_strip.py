"""The strip of sensors: its states, its words, how often it paints, and the button it folds into."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QPaintEvent
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.theme.colours import LIGHT
from app.theme.current import set_scale
from app.widgets.sensor_strip import SensorStrip
from app.widgets.sensor_tile import SensorTile, TileState, sentence
from app.widgets.strip_button import StripButton
from app.widgets.tile_widget import TileWidget
from core.body import LEG_SITES, Site
from tests.app.room import settle, words_cut

FOOT = Site.RIGHT_FOOT


def tile(
    site: Site = FOOT,
    battery: float | None = 0.84,
    lost_share: float = 0.0004,
    silent_s: float = 0.0,
    is_moving: bool = True,
    is_worn: bool = True,
) -> SensorTile:
    return SensorTile(site, "0A22", battery, 100.2, lost_share, silent_s, is_moving, is_worn)


def fine() -> dict[Site, SensorTile]:
    return {site: tile(site) for site in LEG_SITES}


STATES = [
    (tile(), TileState.FINE, "100 Hz · 0.0 % lost"),
    (tile(battery=None), TileState.FINE, "100 Hz · 0.0 % lost"),
    (tile(battery=0.11), TileState.LOW_BATTERY, "charge soon · 11 %"),
    (tile(lost_share=0.024), TileState.LOSS, "2.4 % lost"),
    (tile(lost_share=0.01), TileState.FINE, "100 Hz · 1.0 % lost"),
    (tile(silent_s=3.4, lost_share=0.2, battery=0.05), TileState.SILENT, "no signal 3 s"),
    (tile(silent_s=9.0, is_worn=False), TileState.NOT_WORN, "not used"),
    (replace(tile(is_worn=False), is_awaited=True), TileState.NOT_WORN, "detected later"),
]


@pytest.fixture
def strip(qtbot: QtBot) -> SensorStrip:
    strip = SensorStrip()
    qtbot.addWidget(strip)
    strip.resize(1064, 72)
    strip.show()
    settle()
    return strip


@pytest.mark.parametrize(("shown", "state", "words"), STATES)
def test_a_tile_shows_the_gravest_thing_that_is_true(shown: SensorTile, state: TileState, words: str) -> None:
    assert (shown.state, shown.words) == (state, words)
    assert shown.is_bad == (state in (TileState.LOW_BATTERY, TileState.LOSS, TileState.SILENT))


@pytest.mark.parametrize(("shown", "state", "words"), STATES)
def test_a_bad_tile_is_yellow_and_states_why(
    strip: SensorStrip, shown: SensorTile, state: TileState, words: str
) -> None:
    strip.show_tiles(fine() | {FOOT: shown})
    widget = strip.widgets[FOOT]
    assert words in [text.text for text in widget.painted_texts()]
    ground = widget.grab().toImage().pixelColor(widget.width() // 2, widget.height() - 5)
    assert (ground == QColor(LIGHT.caution)) == shown.is_bad


def test_each_tile_is_a_part_of_its_own_for_a_screen_reader(strip: SensorStrip) -> None:
    strip.show_tiles(fine() | {FOOT: tile(silent_s=3.2), Site.LEFT_SHANK: tile(Site.LEFT_SHANK, is_moving=False)})
    names = [widget.accessibleName() for widget in strip.widgets.values()]
    assert names == [
        "R thigh, 100 Hz · 0.0 % lost, moving",
        "R shank, 100 Hz · 0.0 % lost, moving",
        "R foot, no signal 3 s",
        "L thigh, 100 Hz · 0.0 % lost, moving",
        "L shank, 100 Hz · 0.0 % lost, still",
        "L foot, 100 Hz · 0.0 % lost, moving",
    ]
    assert strip.widgets[FOOT].accessibleDescription() == "sensor 0A22, battery 84 %"


def test_the_right_leg_is_at_the_left_and_turns_with_the_figure(strip: SensorStrip) -> None:
    def from_left() -> list[Site]:
        return sorted(strip.widgets, key=lambda site: strip.widgets[site].x())

    assert from_left()[0] is Site.RIGHT_THIGH
    assert from_left()[-1] is Site.LEFT_FOOT
    strip.set_from_behind(True)
    assert from_left()[0] is Site.LEFT_THIGH


def test_only_what_changed_is_painted(qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> None:
    painted: list[Site] = []
    paint = TileWidget.paintEvent

    def noting(widget: TileWidget, event: QPaintEvent) -> None:
        painted.append(widget._tile.site)
        paint(widget, event)

    monkeypatch.setattr(TileWidget, "paintEvent", noting)
    strip = SensorStrip()
    qtbot.addWidget(strip)
    strip.resize(1064, 72)
    strip.show()
    strip.show_tiles(fine())
    settle()
    assert set(painted) == set(LEG_SITES)
    painted.clear()
    changed = {FOOT: tile(silent_s=2.0), Site.LEFT_FOOT: tile(Site.LEFT_FOOT, lost_share=0.00041)}
    strip.show_at_once(fine() | changed)
    settle()
    assert painted == [FOOT]


def test_what_comes_faster_than_can_be_read_waits_and_the_last_is_shown(strip: SensorStrip, qtbot: QtBot) -> None:
    shown: list[float] = []
    strip.tiles_changed.connect(lambda: shown.append(strip.tiles[FOOT].silent_s))
    for k in range(30):
        strip.show_tiles(fine() | {FOOT: tile(silent_s=float(k))})
    assert shown == [0.0]
    qtbot.waitUntil(lambda: shown == [0.0, 29.0])


def test_it_shows_once_that_a_sensor_turned_bad(strip: SensorStrip) -> None:
    reported: list[int] = []
    strip.turned_bad.connect(lambda: reported.append(1))
    for tiles in (fine(), fine() | {FOOT: tile(silent_s=2.0)}, fine() | {FOOT: tile(silent_s=3.0)}, fine()):
        strip.show_at_once(tiles)
    assert reported == [1]


def test_arrows_go_from_tile_to_tile(strip: SensorStrip) -> None:
    strip.focus()
    assert strip.widgets[Site.RIGHT_THIGH].hasFocus()
    QTest.keyClick(strip.widgets[Site.RIGHT_THIGH], Qt.Key.Key_Right)
    assert strip.widgets[Site.RIGHT_SHANK].hasFocus()
    QTest.keyClick(strip.widgets[Site.RIGHT_SHANK], Qt.Key.Key_End)
    assert strip.widgets[Site.LEFT_FOOT].hasFocus()
    stops = [one for one in strip.widgets.values() if one.focusPolicy() & Qt.FocusPolicy.TabFocus]
    assert stops == [strip.widgets[Site.LEFT_FOOT]]


WIDTHS = [(1064, 1.0), (1680, 1.0), (852, 0.8), (1920, 2.0)]
COMPACT_WIDTHS = [(736, 0.8), (736, 1.0), (1116, 1.0), (1152, 2.0), (672, 2.0)]


@pytest.mark.parametrize("language", ["en", "pseudo"])
@pytest.mark.parametrize(
    ("width", "scale", "is_compact"), [(*w, False) for w in WIDTHS] + [(*w, True) for w in COMPACT_WIDTHS]
)
def test_no_word_is_cut_in_any_state(
    strip: SensorStrip,
    width: int,
    scale: float,
    is_compact: bool,
    language: str,
    request: pytest.FixtureRequest,
) -> None:
    if language == "pseudo":
        request.getfixturevalue("pseudo_language")
    set_scale(scale)
    strip.set_compact(is_compact)
    strip.resize(width, 72)
    for shown, _, _ in STATES:
        strip.show_at_once({site: SensorTile(site, *_rest(shown)) for site in LEG_SITES})
        strip._arrange()
        assert words_cut(strip) == []


def _rest(shown: SensorTile) -> tuple[str, float | None, float, float, float, bool, bool]:
    return (
        shown.name,
        shown.battery,
        shown.rate_hz,
        shown.lost_share,
        shown.silent_s,
        shown.is_moving,
        shown.is_worn,
    )


def test_the_button_states_in_one_sentence_how_the_sensors_are() -> None:
    foot, thigh = tile(silent_s=3.2), tile(Site.LEFT_THIGH, battery=0.1)
    unused = tile(Site.LEFT_FOOT, is_worn=False)
    assert sentence({}) == "No sensors yet"
    assert sentence(fine()) == "6 sensors, all connected"
    assert sentence(fine() | {Site.LEFT_FOOT: unused}) == "5 sensors, all connected"
    assert sentence(fine() | {FOOT: foot}) == "R foot: no signal 3 s"
    assert sentence(fine() | {FOOT: foot, Site.LEFT_THIGH: thigh}) == "Check 2 of 6 sensors"


def test_the_button_is_yellow_while_a_sensor_is_bad(qtbot: QtBot) -> None:
    button = StripButton()
    qtbot.addWidget(button)
    button.show()
    for tiles, colour in ((fine(), LIGHT.ground), (fine() | {FOOT: tile(silent_s=3.2)}, LIGHT.caution)):
        button.show_tiles(tiles)
        button.resize(button.sizeHint())
        button.setAttribute(Qt.WidgetAttribute.WA_UnderMouse, False)
        assert button.grab().toImage().pixelColor(button.width() - 6, 8) == QColor(colour)
        assert button.accessibleName() == sentence(tiles)
        assert words_cut(button) == []


SEVEN = {site: tile(site) for site in Site}


def test_a_seventh_tile_is_between_the_legs_only_while_the_pelvis_wears_a_sensor(strip: SensorStrip) -> None:
    strip.show_tiles(fine())
    settle()
    six = strip.grab().toImage()
    assert Site.PELVIS not in strip.widgets
    strip.show_at_once(SEVEN)
    settle()
    order = sorted(strip.widgets, key=lambda site: strip.widgets[site].x())
    assert order[3] is Site.PELVIS
    assert {widget.y() for widget in strip.widgets.values()} == {8}
    assert strip.widgets[Site.PELVIS].accessibleName() == "Pelvis, 100 Hz · 0.0 % lost, moving"
    assert words_cut(strip) == []
    assert strip.grab().toImage() != six
    strip.show_at_once(fine())
    settle()
    assert strip.grab().toImage() == six


@pytest.mark.parametrize("width", [320, 640, 896, 1064, 1680])
@pytest.mark.parametrize("is_compact", [False, True])
def test_seven_tiles_have_room_and_lie_over_none(strip: SensorStrip, width: int, is_compact: bool) -> None:
    strip.set_compact(is_compact)
    strip.show_at_once(SEVEN | {Site.PELVIS: tile(Site.PELVIS, silent_s=3.0)})
    strip.resize(width, strip.height())
    settle()
    places = [widget.geometry() for widget in strip.widgets.values()]
    assert len(places) == 7
    assert not any(one.intersects(other) for k, one in enumerate(places) for other in places[:k])
    assert max(place.bottom() for place in places) < strip.height()


def test_arrows_go_over_the_pelvis(strip: SensorStrip) -> None:
    strip.show_at_once(SEVEN)
    strip.widgets[Site.RIGHT_FOOT].setFocus()
    QTest.keyClick(strip.widgets[Site.RIGHT_FOOT], Qt.Key.Key_Right)
    assert strip.widgets[Site.PELVIS].hasFocus()
    strip.show_at_once(fine())  # taken off
    assert [widget.focusPolicy() for widget in strip.widgets.values()].count(Qt.FocusPolicy.StrongFocus) == 1


def test_a_silent_pelvis_is_named_in_the_sentence() -> None:
    assert sentence(SEVEN) == "7 sensors, all connected"
    assert sentence(SEVEN | {Site.PELVIS: tile(Site.PELVIS, silent_s=3.2)}) == "Pelvis: no signal 3 s"

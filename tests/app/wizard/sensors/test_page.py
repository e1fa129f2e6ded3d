"""The page of the sensors: by mouse, by keys and by shaking each sensor comes to one place, and is stated to be
there."""

from collections.abc import Iterator

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QMimeData, QPoint, QPointF, Qt
from PySide6.QtGui import QDragEnterEvent, QDragMoveEvent, QDropEvent, QKeyEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QWidget
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.theme.current import current_theme, set_scale
from app.wizard.sensors.page import SensorsPage, Way
from app.wizard.sensors.sensor_drag import DRAGGED
from app.wizard.sensors.sensor_row import SensorRow
from app.wizard.sensors.sensor_trace import _lines
from app.wizard.sensors.source_pages import SourceOption
from app.wording.translation import use_language
from core.body import LEG_SITES, Side, Site
from tests.app.room import settle, words_cut

NAMES = ("0A09", "0A31", "0A2C", "0A17", "0A1B", "0A22")
SEVENTH = "0A3E"
OPTIONS = (
    SourceOption("serial", "Serial ports", "6 found"),
    SourceOption("replay", "Replay of a session"),
    SourceOption("demonstration", "Demonstration"),
    SourceOption("network", "Network"),
    SourceOption("stream", "Streams"),
    SourceOption("other", "Another"),
)


def rows(*sites: Site | None, **changes: dict[str, object]) -> tuple[SensorRow, ...]:
    """Sensors worn at `sites`, the others nowhere; `changes` by name, with an underscore before the figure."""
    worn = (*sites, *[None] * (len(NAMES) - len(sites)))
    made = []
    for name, site in zip(NAMES, worn, strict=True):
        facts: dict[str, object] = {"rate_hz": 100.0, "battery": 0.8, "can_identify": True, "site": site}
        made.append(SensorRow(name, "x-IMU3", **(facts | changes.get(f"s{name}", {}))))  # type: ignore[arg-type]  # facts of many types, by name
    return tuple(made)


def seven(*sites: Site | None, **changes: dict[str, object]) -> tuple[SensorRow, ...]:
    worn = sites[6] if len(sites) > 6 else None
    facts: dict[str, object] = {"rate_hz": 100.0, "battery": 0.8, "can_identify": True, "site": worn}
    pelvis = SensorRow(SEVENTH, "x-IMU3", **(facts | changes.get(f"s{SEVENTH}", {})))  # type: ignore[arg-type]  # facts by name, as `rows` has them
    return (*rows(*sites[:6], **changes), pelvis)


@pytest.fixture
def page(qtbot: QtBot) -> Iterator[SensorsPage]:
    page = SensorsPage()
    qtbot.addWidget(page)
    page.resize(1064, 672)
    page.show_sources(OPTIONS, "serial")
    page.show_sensors(rows())
    page.show()
    yield page
    page.hide()


@pytest.fixture
def german() -> Iterator[None]:
    use_language("de")
    yield
    use_language("en")


@pytest.mark.usefixtures("german")
def test_in_german_the_demonstrations_sensors_stand_beside_the_figure(qtbot: QtBot) -> None:
    """At 1280 x 800 of the whole window."""
    page = SensorsPage()
    qtbot.addWidget(page)
    page.resize(1064, 672)
    named = zip(("DEMO-09", "DEMO-31", "DEMO-2C", "DEMO-17", "DEMO-1B", "DEMO-22"), LEG_SITES, strict=True)
    page.show_sensors([SensorRow(name, "simulated", 100.0, None, site) for name, site in named])
    page.show()
    settle()
    assert page.ways.mapTo(page, QPoint()).x() > page.places.mapTo(page, QPoint(page.places.width(), 0)).x()
    assert next(iter(page.list.rows.values())).sensor.second_line == "simuliert"


@pytest.mark.usefixtures("german")
def test_no_tile_lies_over_the_letters_of_the_legs(qtbot: QtBot) -> None:
    """Tiles are high where names are long, and near the legs where everything is large."""
    set_scale(2.0)
    page = SensorsPage()
    qtbot.addWidget(page)
    page.set_compact(True)
    page.resize(1790, 1006)
    page.show_sensors([SensorRow(name, site=site) for name, site in zip(("DOT 0001", "DOT 0002"), LEG_SITES)])  # noqa: B905 - two of them
    page.show()
    settle()
    figure = page.places.figure
    picture, letters = figure.grab().toImage(), {current_theme().text(side).name() for side in Side}
    for tile in page.places.shown_tiles.values():
        box = tile.geometry().translated(-figure.pos())
        under = {
            picture.pixelColor(x, y).name()
            for x in range(box.left(), box.right())
            for y in range(box.top(), box.bottom())
        }
        assert not under & letters


@pytest.fixture
def assigned(page: SensorsPage) -> list[tuple[str, Site | None]]:
    received: list[tuple[str, Site | None]] = []
    page.assigned.connect(lambda sensor, site: received.append((sensor, site)))
    return received


def data_of(sensor: str) -> QMimeData:
    data = QMimeData()
    data.setData(DRAGGED, sensor.encode())
    return data


def drop(page: SensorsPage, sensor: str, at: QPoint) -> None:
    data, nothing = data_of(sensor), Qt.KeyboardModifier.NoModifier
    places = page.places
    move = QDragMoveEvent(at, Qt.DropAction.MoveAction, data, Qt.MouseButton.LeftButton, nothing)
    places.dragMoveEvent(move)
    event = QDropEvent(QPointF(at), Qt.DropAction.MoveAction, data, Qt.MouseButton.LeftButton, nothing)
    places.dropEvent(event)


def test_a_sensor_is_dropped_on_a_tile_or_on_the_figure(
    page: SensorsPage, assigned: list[tuple[str, Site | None]]
) -> None:
    for number, site in enumerate(LEG_SITES):
        drop(page, NAMES[number], page.places.tiles[site].geometry().center())
        drop(page, NAMES[number], page.places.figure.anchor(site).toPoint() + page.places.figure.pos())
    assert assigned == [(NAMES[number], site) for number, site in enumerate(LEG_SITES) for _ in range(2)]


def test_a_drop_beside_the_figure_is_none(page: SensorsPage, assigned: list[tuple[str, Site | None]]) -> None:
    drop(page, "0A09", QPoint(20, 20))
    assert assigned == []


def test_a_worn_place_states_that_dropping_swaps(page: SensorsPage) -> None:
    page.show_sensors(rows(Site.LEFT_THIGH))
    at = page.places.tiles[Site.LEFT_THIGH].geometry().center()
    data = data_of("0A31")  # the event does not keep it alive
    move = QDragMoveEvent(at, Qt.DropAction.MoveAction, data, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier)
    page.places.dragMoveEvent(move)
    assert page.notice.text == "L thigh already has sensor 0A09. Drop here to swap the two sensors."


@pytest.mark.parametrize("is_sensor", [True, False])
def test_only_a_sensor_may_be_dropped_on_the_figure(page: SensorsPage, is_sensor: bool) -> None:
    data = data_of("0A2C")
    if not is_sensor:
        data = QMimeData()
        data.setText("0A2C")
    buttons, keys = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    enter = QDragEnterEvent(QPoint(5, 5), Qt.DropAction.MoveAction, data, buttons, keys)
    enter.ignore()
    page.places.dragEnterEvent(enter)
    assert enter.isAccepted() == is_sensor


def test_the_mouse_carries_a_sensor_by_its_name(page: SensorsPage, monkeypatch: pytest.MonkeyPatch) -> None:
    carried: list[str] = []
    drag = "app.wizard.sensors.sensor_drag.drag_sensor"
    monkeypatch.setattr(drag, lambda _source, sensor: carried.append(sensor))
    row = page.list.rows["0A2C"]
    QTest.mousePress(row, Qt.MouseButton.LeftButton, pos=QPoint(60, 20))
    QTest.mouseMove(row, QPoint(62, 20))
    QTest.mouseMove(row, QPoint(100, 60))
    QTest.mouseRelease(row, Qt.MouseButton.LeftButton, pos=QPoint(100, 60))
    assert carried == ["0A2C"]


def test_a_row_and_a_number_say_the_place(page: SensorsPage, assigned: list[tuple[str, Site | None]]) -> None:
    page.focus()
    assert page.list.rows["0A09"].hasFocus()
    QTest.keyClick(page.list.rows["0A09"], Qt.Key.Key_Down)
    assert page.list.rows["0A31"].hasFocus()
    assert page.place_selected(5)
    assert assigned == [("0A31", Site.RIGHT_SHANK)]
    assert not page.place_selected(8)


@pytest.mark.qt_log_ignore("This plugin does not support", extend=True)  # offscreen has no popups of its own
@pytest.mark.parametrize(
    ("key", "held"),
    [(Qt.Key.Key_Space, Qt.KeyboardModifier.NoModifier), (Qt.Key.Key_Down, Qt.KeyboardModifier.AltModifier)],
)
def test_the_list_of_places_opens_by_keys_and_is_chosen_by_arrows(
    page: SensorsPage, assigned: list[tuple[str, Site | None]], key: Qt.Key, held: Qt.KeyboardModifier
) -> None:
    page.show_sensors(rows(Site.LEFT_THIGH))
    page.focus()
    QTest.keyClick(page.list.rows["0A09"], key, held)
    menu = page.findChild(QMenu)
    assert isinstance(menu, QMenu)
    assert menu.isVisible()
    QTest.keyClick(menu, Qt.Key.Key_Down)
    QTest.keyClick(menu, Qt.Key.Key_Return)
    assert assigned == [("0A09", Site.LEFT_SHANK)]


def test_the_row_that_keys_mean_comes_into_sight(page: SensorsPage) -> None:
    page.resize(900, 480)
    page.set_compact(True)
    settle()
    page.focus()
    for name in NAMES:
        row = page.list.rows[name]
        assert row.hasFocus()
        assert row.visibleRegion().boundingRect().height() == row.height()
        QTest.keyClick(row, Qt.Key.Key_Down)


def test_enter_on_a_row_is_left_to_the_primary_button(page: SensorsPage) -> None:
    page.focus()
    event = QKeyEvent(QEvent.Type.KeyPress, Qt.Key.Key_Return, Qt.KeyboardModifier.NoModifier)
    page.list.rows["0A09"].keyPressEvent(event)
    assert not event.isAccepted()
    assert page.findChild(QMenu) is None


def test_a_tile_takes_the_selected_sensor(page: SensorsPage, assigned: list[tuple[str, Site | None]]) -> None:
    page.list.select("0A17")
    tile = page.places.tiles[Site.RIGHT_THIGH]
    tile.setFocus()
    QTest.keyClick(tile, Qt.Key.Key_Return)
    assert assigned == [("0A17", Site.RIGHT_THIGH)]


def test_shaken_sensors_take_the_places_in_turn(page: SensorsPage, assigned: list[tuple[str, Site | None]]) -> None:
    page.show_way(Way.SHAKE)
    assert "Shake the left thigh sensor." in page.notice.text
    page.show_shaken("0A22")
    assert assigned == [("0A22", Site.LEFT_THIGH)]
    page.show_sensors(rows(None, None, None, None, None, Site.LEFT_THIGH))
    assert "Shake the left shank sensor." in page.notice.text
    page.places.tiles[Site.RIGHT_FOOT].click()
    assert "Shake the right foot sensor." in page.notice.text
    page.show_shaken("0A22")
    assert len(assigned) == 1, "one that has its place only flashes it"
    page.show_shaken("0A31")
    assert assigned[-1] == ("0A31", Site.RIGHT_FOOT)


def test_two_shaken_at_once_show_nothing(page: SensorsPage) -> None:
    page.show_way(Way.SHAKE)
    page.show_shaken_together(["0A22", "0A2C"])
    assert page.notice.text == "0A22 and 0A2C were both shaken. Shake one sensor at a time."
    page.show_shaken_together([])
    assert "Shake the left thigh sensor." in page.notice.text


def test_a_foot_or_pelvis_taken_off_is_missed_at_once(page: SensorsPage) -> None:
    page.show_sensors(rows(*LEG_SITES))
    page.list.assigned.emit("0A22", None)
    page.show_sensors(rows(*LEG_SITES[:5]))
    assert page.notice.text.startswith("No right foot sensor: no right ankle angles.")
    page.show_sensors(seven(*Site))
    page.assign(SEVENTH, None)
    page.show_sensors(seven(*LEG_SITES))
    assert page.notice.text == "No sensor on the pelvis: no hip angles. Knees, ankles and steps are not affected."


def test_the_notice_states_what_a_sensor_that_is_missing_silent_or_bad_costs(
    page: SensorsPage, snapshot: SnapshotAssertion
) -> None:
    stated: dict[str, str] = {}
    for case, shown in {
        "all are there, hips are no matter": rows(*LEG_SITES),
        "a sensor is still to be assigned": rows(*LEG_SITES[:5]),
        "no sensor is left for a foot": rows(*LEG_SITES)[:5],
        "without a pelvis a silent thigh costs no hip": rows(*LEG_SITES, s0A09={"silent_s": 4.0}),
        "all seven are there": seven(*Site),
        "a silent pelvis costs the hips alone": seven(*Site, s0A3E={"silent_s": 4.0}),
        "with a pelvis a silent thigh costs its hip": seven(*Site, s0A09={"silent_s": 4.0}),
    }.items():
        page.show_sensors(shown)
        stated[case] = page.notice.text
    bad: dict[str, dict[str, object]] = {
        "silent": {"silent_s": 3.2},
        "battery for this patient": {"battery": 0.11},
        "battery for no walk": {"battery": 0.03},
        "samples lost": {"lost_share": 0.024},
        "samples lost that its memory would keep": {"lost_share": 0.06, "has_memory": True},
    }
    for case, changes in bad.items():
        page.show_sensors(rows(*LEG_SITES, s0A22=changes))
        stated[case] = page.notice.text
        assert page.list.rows["0A22"].sensor.wants_look, case
        assert page.places.figure.accessibleDescription().count("worn") == 5, case
    assert stated == snapshot


def test_shaking_assigns_nothing_unless_that_way_is_chosen(
    page: SensorsPage, assigned: list[tuple[str, Site | None]]
) -> None:
    page.show_shaken("0A22")
    assert assigned == []


def test_a_refusal_goes_before_all_else_and_is_seen_without_a_source(page: SensorsPage) -> None:
    page.show_no_source()
    page.show_message("COM7 is in use by another program.", "Close that program, then search again.")
    assert page.nothing.isVisible()
    assert "COM7 is in use by another program. Close that program, then search again." in _texts_of(page.nothing)


def test_the_sources_take_the_focus_as_soon_as_they_are_offered(qtbot: QtBot) -> None:
    page = SensorsPage()
    qtbot.addWidget(page)
    page.show()
    page.show_sources(OPTIONS)
    page.focus()
    assert page.focusWidget() is page.nothing.buttons[0]
    assert page.nothing.buttons[0].nextInFocusChain() is page.nothing.buttons[1]


def test_without_a_source_five_are_offered_and_pressed_by_keys(page: SensorsPage, qtbot: QtBot) -> None:
    page.show_no_source()
    assert [button.text() for button in page.nothing.buttons] == [option.name for option in OPTIONS[:5]]
    page.focus()
    with qtbot.waitSignal(page.source_chosen) as received:
        QTest.keyClick(page.nothing.buttons[0], Qt.Key.Key_Return)
    assert received.args == ["serial"]
    page.show_searching("Serial ports")
    assert page.searching.isVisible()
    with qtbot.waitSignal(page.searching.stop.clicked):
        QTest.keyClick(page.searching.stop, Qt.Key.Key_Space)


def test_rows_keep_the_focus_while_they_are_shown_again(page: SensorsPage) -> None:
    page.focus()
    page.show_sensors(rows(Site.LEFT_FOOT))
    assert page.list.rows["0A09"].hasFocus()
    assert "position: L foot" in page.list.rows["0A09"].accessibleName()


def test_a_silent_sensor_is_looked_for_and_a_received_one_lit(page: SensorsPage, qtbot: QtBot) -> None:
    page.show_sensors(rows(*LEG_SITES, s0A22={"silent_s": 4.0}))
    with qtbot.waitSignal(page.list.reconnect_pressed):
        page.list.rows["0A22"].identify.click()
    with qtbot.waitSignal(page.list.identify_pressed):
        assert page.identify_selected()


def test_left_to_the_motion_no_place_is_a_gap(page: SensorsPage) -> None:
    chosen: list[str] = []
    page.way_chosen.connect(chosen.append)
    page.ways.segments[2].click()
    assert chosen == [Way.MOTION]
    assert page.notice.text.startswith("Sensor positions are detected in the free motion.")
    assert page.places.figure.accessibleDescription() == ""


def test_tiles_turn_with_the_figure(page: SensorsPage) -> None:
    for is_from_behind in (False, True):
        page.set_from_behind(is_from_behind)
        for site, tile in page.places.shown_tiles.items():
            is_right_half = tile.geometry().center().x() > page.places.width() / 2
            assert is_right_half == ((site.side is Side.LEFT) != is_from_behind)


@pytest.mark.parametrize("scale", [0.8, 1.0, 2.0])
@pytest.mark.parametrize(("size", "is_compact"), [((1064, 672), False), ((736, 432), True), ((896, 472), True)])
def test_nothing_lies_over_another_or_outside(
    page: SensorsPage, scale: float, size: tuple[int, int], is_compact: bool
) -> None:
    set_scale(scale)
    page.resize(round(size[0] * scale), round(size[1] * scale))
    page.set_compact(is_compact)
    page.show_sensors(rows(*LEG_SITES, s0A22={"silent_s": 3.0}, s0A2C={"battery": 0.1}))
    for _ in range(10):  # from layout to layout up to the area that scrolls
        QApplication.processEvents()
    tiles = [tile.geometry() for tile in page.places.tiles.values()]
    for number, tile in enumerate(tiles):
        assert page.places.rect().contains(tile)
        assert not any(tile.intersects(other) for other in tiles[number + 1 :])
        assert not any(tile.contains(page.places.figure.anchor(site).toPoint()) for site in LEG_SITES)
    for control in page.tab_order:
        if control.isVisible():
            assert control.accessibleName(), control
            left = control.mapTo(page, QPoint(0, 0)).x()
            assert left >= 0
            assert left + control.width() <= page.width()


def test_a_trace_breaks_where_nothing_was_received() -> None:
    values = np.sin(np.arange(500) / 10)
    values[200:300] = np.nan
    first, last = _lines(values, 600, 40)
    assert first.count() == last.count() == 200
    assert _lines(np.full(500, np.nan), 600, 40) == []
    assert _lines(np.empty(0), 600, 40) == []


def _texts_of(widget: QWidget) -> str:
    return " ".join(child.accessibleName() for child in widget.findChildren(QWidget))


def test_a_page_asks_no_room_for_another(page: SensorsPage) -> None:
    page.set_compact(True)
    page.resize(736, 432)
    scroll = page._whole.verticalScrollBar()
    page.show_no_source()
    settle()
    assert page._whole.horizontalScrollBar().maximum() == 0
    low = scroll.maximum()
    page.stored.show_message("what " * 80, "then " * 120)
    page.show_stored()
    settle()
    assert scroll.maximum() > low
    page.show_no_source()
    settle()
    assert (page._whole.horizontalScrollBar().maximum(), scroll.maximum()) == (0, low)


def test_a_seventh_place_comes_and_goes_with_a_seventh_sensor(page: SensorsPage) -> None:
    settle()
    before = page.grab().toImage()
    assert not page.places.tiles[Site.PELVIS].isVisible()
    page.show_sensors(seven())
    settle()
    assert page.places.tiles[Site.PELVIS].isVisible()
    assert "Seven sensors" in page.title.text()
    assert "sacrum" in page.subtitle.text()
    assert page.list.rows["0A09"].accessibleDescription().startswith("Keys 1 to 7")
    page.show_sensors(rows())
    settle()
    assert page.grab().toImage() == before


def test_who_wants_the_pelvis_with_six_sensors_puts_one_there(
    page: SensorsPage, assigned: list[tuple[str, Site | None]]
) -> None:
    page.list.select("0A22")
    assert page.place_selected(7)
    middle = page.places.figure.anchor(Site.PELVIS).toPoint() + page.places.figure.pos()
    drop(page, "0A2C", middle)
    assert assigned == [("0A22", Site.PELVIS), ("0A2C", Site.PELVIS)]
    page.show_sensors(rows(*LEG_SITES[:5], Site.PELVIS))
    settle()
    assert page.places.tiles[Site.PELVIS].isVisible()


def test_a_seventh_is_dropped_on_the_tile_of_the_pelvis(
    page: SensorsPage, assigned: list[tuple[str, Site | None]]
) -> None:
    page.show_sensors(seven())
    settle()
    drop(page, SEVENTH, page.places.tiles[Site.PELVIS].geometry().center())
    assert assigned == [(SEVENTH, Site.PELVIS)]


def test_shaken_in_turn_the_pelvis_comes_last(page: SensorsPage, assigned: list[tuple[str, Site | None]]) -> None:
    page.show_way(Way.SHAKE)
    page.show_sensors(seven(*LEG_SITES))
    assert page.notice.text.startswith("Shake the pelvis sensor.")
    page.show_shaken(SEVENTH)
    assert assigned == [(SEVENTH, Site.PELVIS)]


@pytest.mark.parametrize("is_from_behind", [False, True])
@pytest.mark.parametrize(("size", "is_compact"), [((1064, 672), False), ((896, 472), True)])
def test_the_seventh_tile_lies_over_no_other(
    page: SensorsPage, size: tuple[int, int], is_compact: bool, is_from_behind: bool
) -> None:
    page.set_compact(is_compact)
    page.set_from_behind(is_from_behind)
    page.show_sensors(seven(*Site))
    page.resize(*size)
    assert words_cut(page) == []
    places = [tile.geometry() for tile in page.places.shown_tiles.values()]
    assert not any(one.intersects(other) for k, one in enumerate(places) for other in places[:k])
    assert all(page.places.rect().contains(place) for place in places)

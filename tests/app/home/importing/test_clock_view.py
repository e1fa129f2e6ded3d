"""Tests that the import page shows sensors' clocks where something befell them, and splits recordings there."""

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.home.importing.clock_part import ClockPart
from app.home.importing.import_page import ImportPage
from app.home.importing.import_words import liveliness
from app.widgets.button import Button
from app.workers.library_controller import LibraryController
from devices.files.formats import read_trial
from tests.app.home.importing.test_importing import choices, read, shown
from tests.clock_files import ALL, TIME_S, jumped, pair, restarted, without

RESTARTED = restarted(9.0), ALL
PAUSED = TIME_S, without((6.0, 11.0))
OPEN_RESTART = "split it where its clock restarts or jumps, or exclude it."


def splits(page: ImportPage) -> list[Button]:
    return [one for one in page.findChildren(Button) if one.text() == "Split here" and one.isVisible()]


def split(qtbot: QtBot, page: ImportPage, number: int = 0) -> None:
    before = len(page.draft.kinds)
    QTest.mouseClick(splits(page)[number], Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: len(page.draft.kinds) > before)


def test_a_clean_import_shows_nothing_of_clocks(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    page = read(qtbot, home, *pair(tmp_path))
    assert not page.findChildren(ClockPart)
    assert "clock" not in shown(page)
    assert not splits(page)
    assert page.draft.join.isHidden()


def test_each_event_is_stated_and_some_are_places_to_split(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    whole = TIME_S, ALL
    for thigh, shank, stated, can_be_split in (
        (RESTARTED, RESTARTED, "left_shank and left_thigh: clock restarts after 9.0 s, 8.5 s back.", True),
        (whole, (jumped(9.0, 3600.0), ALL), "left_shank: clock jumps forward by 3600.0 s after 9.0 s.", True),
        (PAUSED, PAUSED, "No sensor recorded for 5.0 s, from 6.0 s on.", True),
        (whole, PAUSED, "left_shank: samples missing for 5.0 s, after 6.0 s.", False),
    ):
        page = read(qtbot, home, *pair(tmp_path, thigh, shank))
        words = shown(page).replace("\N{ZERO WIDTH SPACE}", "")
        assert stated in words
        assert words.count("Sensor clocks") == 1
        assert len(splits(page)) == can_be_split
        assert (OPEN_RESTART in words) == ("clock" in stated)
        home.escape()


def test_a_recording_is_split_and_both_parts_come_into_the_library(
    qtbot: QtBot, home: Home, controller: LibraryController, tmp_path: Path
) -> None:
    page = read(qtbot, home, *pair(tmp_path, RESTARTED, RESTARTED))
    page.code.set_text("P-0300")
    page.code.edited.emit("P-0300")
    assert not home.bar.primary.isEnabled()
    assert OPEN_RESTART in shown(page)
    split(qtbot, page)
    assert "2 recordings of" in shown(page)
    assert OPEN_RESTART not in shown(page)
    assert not page.findChildren(ClockPart)
    assert page.code.text == "P-0300"
    assert home.bar.primary.isEnabled()
    QTest.keyClick(page.code.line_edit, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: home.current is home.page)
    assert controller.state is not None
    library = controller.state.library.library
    patient = library.patients.find("P-0300")
    assert patient is not None
    (summary,) = library.sessions.list(patient.id)
    assert len(library.sessions.get(summary.id).recordings) == 2


def test_a_broken_clock_hinders_nothing_that_is_left_out(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    page = read(qtbot, home, *pair(tmp_path, thigh=RESTARTED))
    page.code.set_text("P-0300")
    page.code.edited.emit("P-0300")
    assert OPEN_RESTART in shown(page)
    choices(page)["Position of left_thigh"].setCurrentIndex(0)
    assert OPEN_RESTART not in shown(page)
    assert home.bar.primary.isEnabled()


def test_splitting_keeps_what_was_chosen_and_can_be_undone(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    page = read(qtbot, home, *pair(tmp_path, PAUSED, PAUSED))
    (kind,) = (one for name, one in choices(page).items() if name.startswith("Type of"))
    kind.setCurrentIndex(1)
    choices(page)["Position of left_shank"].setCurrentIndex(3)
    kinds, sites = page.draft.kinds, page.draft.sites
    split(qtbot, page)
    assert (page.draft.kinds, page.draft.sites) == (kinds * 2, sites)
    assert page.draft.join.isVisible()
    assert page.focusWidget() in page.draft.tab_order
    QTest.mouseClick(page.draft.join, Qt.MouseButton.LeftButton)
    assert len(page.draft.kinds) == 1
    assert page.draft.sites == sites
    assert page.draft.join.isHidden()
    assert len(splits(page)) == 1


def test_splitting_goes_by_keys(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    page = read(qtbot, home, *pair(tmp_path, PAUSED, PAUSED))
    (button,) = splits(page)
    assert button in page.tab_order
    assert "No sensor recorded for 5.0 s" in button.accessibleDescription()
    (kind,) = (one for name, one in choices(page).items() if name.startswith("Type of"))
    kind.setFocus()
    QTest.keyClick(kind, Qt.Key.Key_Tab)
    assert button.hasFocus()
    QTest.keyClick(button, Qt.Key.Key_Space)
    qtbot.waitUntil(lambda: len(page.draft.kinds) == 2)


def test_the_small_curve_of_a_clock_that_jumped_has_room(tmp_path: Path) -> None:
    files = pair(tmp_path, shank=(jumped(9.0, 3600.0), ALL))
    whole, jump = (sensor.block for sensor in read_trial("", files, None, splits=True).sensors)
    for block in (whole, jump):
        time_s, _ = liveliness([block])
        assert float(np.ptp(time_s)) == pytest.approx(20.0, abs=0.2)

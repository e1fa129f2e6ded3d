"""Tables that nobody knows: shown as they would be read, changed by keys, confirmed, and kept for their program."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QScrollArea
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.home.home import Home
from app.home.importing.import_page import ImportPage
from app.home.importing.table_form import TableForm
from app.system.known_tables import known_tables
from app.widgets.choice import Choice
from app.wording.translation import use_language
from core.samples import ImuBlock
from tests.app.home.importing.test_importing import choices, shown
from tests.devices.files import test_table_preview
from tests.devices.files.test_public_layouts import MovedSensor, no_header, rows_of, write
from tests.devices.files.test_table_preview import NAMES

KNOWN = ("time_s", "ax", "ay", "az", "gx", "gy", "gz")  # columns that state what they hold
LEFT, RIGHT = MovedSensor(rows=400), MovedSensor(rows=400, phase=1.0)  # half as long: each is read and drawn often
table = partial(test_table_preview.table, motion=LEFT)
READY = "1 sensor · 4.0 s · 100 Hz · gravity 9.9 m/s²"


def explain(qtbot: QtBot, home: Home, *paths: Path) -> TableForm:
    """Read files of which one has to be explained."""
    home.importing.read(paths)
    qtbot.waitUntil(home.importing.page.table.isVisible)
    return home.importing.page.table


def press_to(choice: Choice, data: object) -> None:
    """Go to a line by the arrow keys."""
    choice.setFocus()
    steps = choice.findData(data) - choice.currentIndex()
    assert choice.findData(data) >= 0
    for _ in range(abs(steps)):
        QTest.keyClick(choice, Qt.Key.Key_Down if steps > 0 else Qt.Key.Key_Up)


def wait_for(qtbot: QtBot, form: TableForm, words: str) -> None:
    qtbot.waitUntil(lambda: words in form.notice.text)


def press_enter(home: Home) -> None:
    widget = home.window().focusWidget()
    assert widget is not None
    QTest.keyClick(widget, Qt.Key.Key_Return)


def wait_for_draft(qtbot: QtBot, home: Home) -> ImportPage:
    page = home.importing.page
    qtbot.waitUntil(lambda: home.current is page and page.draft.isVisible())
    return page


def blocks(home: Home) -> dict[str, ImuBlock]:
    """What was read, by the sensors' names."""
    found = home.importing.shown
    assert found is not None
    assert found.draft is not None
    return {one.name: one.block for recording in found.draft.recordings for one in recording.trial.sensors}


def test_a_table_that_nobody_knows_is_confirmed_by_one_key(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    form = explain(qtbot, home, table(tmp_path / "walk_left_thigh.csv"))
    stated = shown(home.importing.page)
    assert "its columns do not identify acceleration and angular rates on three axes: t, p, q, r, u, v, w." in stated
    assert form.notice.text == f"{READY} The columns were found by their values alone. Check them."
    assert "p acceleration x" in form.rows.as_text()
    assert home.bar.primary.text() == "Use these columns"
    press_enter(home)
    page = wait_for_draft(qtbot, home)
    assert "1 recording of any program (CSV, named columns)" in shown(page)
    assert choices(page)["Position of walk_left_thigh"].currentText() == "Left thigh"
    (block,) = blocks(home).values()
    np.testing.assert_allclose(block.acc_m_s2, LEFT.acc, atol=1e-5)
    np.testing.assert_allclose(block.gyr_rad_s, LEFT.gyr, atol=1e-5)


def test_why_a_table_is_refused_is_stated_once_and_in_which_line(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", names=KNOWN)
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[40] += ",7"
    form = explain(qtbot, home, write(path, lines))
    wait_for(qtbot, form, "Line 41: the line has 8 columns, but the header has 7. Correct the file or export it again.")
    assert shown(home.importing.page).count("the line has 8 columns") == 1


def test_columns_without_names_are_called_by_their_places(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    use_language("de")
    try:
        form = explain(qtbot, home, *no_header(tmp_path))
        qtbot.waitUntil(lambda: form.acc[0].currentData() == "column 2")
        assert form.acc[0].currentText() == "Spalte 2"
        assert "Spalte 2 Beschleunigung x" in form.rows.as_text()
        assert "column 2" not in shown(home.importing.page)
    finally:
        use_language("en")


Which = Callable[[TableForm], Choice]
CHANGES: dict[str, tuple[Which, object]] = {
    "encoding": (lambda form: form.encoding, "utf-16"),
    "header": (lambda form: form.header_line, 0),
    "separator": (lambda form: form.separator, ";"),
    "decimal": (lambda form: form.decimal, ","),
    "time": (lambda form: form.time, "none"),
    "unit of time": (lambda form: form.time_unit, "ms"),
    "sensor": (lambda form: form.sensor, "p"),
    "acceleration x": (lambda form: form.acc[0], "u"),
    "acceleration y": (lambda form: form.acc[1], "r"),
    "acceleration none": (lambda form: form.acc[0], "none"),
    "unit of acceleration": (lambda form: form.acc_unit, "g"),
    "angular rate z": (lambda form: form.gyr[2], "t"),
    "angular rate none": (lambda form: form.gyr[0], "none"),
    "unit of angular rate": (lambda form: form.gyr_unit, "deg/s"),
}


def face(form: TableForm) -> tuple[str, ...]:
    """Words, rows and curves as a screen reader has them."""
    return (form.notice.text, form.rows.as_text(), form.gyr_curves.accessibleDescription())


def test_each_choice_changes_what_is_shown_until_it_is_taken_back(
    qtbot: QtBot, home: Home, tmp_path: Path, snapshot: SnapshotAssertion
) -> None:
    form = explain(qtbot, home, table(tmp_path / "walk_left_thigh.csv"))
    found, changed = face(form), {}

    def is_as_found() -> bool:
        return face(form) == found

    for change, (which, data) in CHANGES.items():
        press_to(which(form), data)
        qtbot.waitUntil(lambda: not is_as_found())
        changed[change] = {"words": form.notice.text, "can be used": home.bar.primary.isEnabled()}
        form.detect.click()
        qtbot.waitUntil(is_as_found)
    assert changed == snapshot


def test_nothing_is_confirmed_before_it_was_read_as_stated(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    form = explain(qtbot, home, table(tmp_path / "walk_left_thigh.csv"))
    assert home.bar.primary.isEnabled()
    press_to(form.acc_unit, "g")
    assert not home.bar.primary.isEnabled()
    press_enter(home)
    assert form.isVisible()
    wait_for(qtbot, form, "is labelled g")
    assert form.acc_unit.hasFocus()  # where somebody goes on
    press_enter(home)
    assert form.isVisible()


def test_what_was_stated_is_kept_for_tables_of_the_same_columns(
    qtbot: QtBot, home: Home, tmp_path: Path, tables_kept: Path
) -> None:
    form = explain(qtbot, home, table(tmp_path / "walk_left_thigh.csv", names=("t", "P-0147", "q", "r", "u", "v", "w")))
    press_to(form.gyr_unit, "mdeg/s")
    qtbot.waitUntil(home.bar.primary.isEnabled)
    press_enter(home)
    wait_for_draft(qtbot, home)
    (kept,) = known_tables().values()
    assert (kept.acc, kept.gyr, kept.gyr_unit, kept.time) == (("2", "3", "4"), ("5", "6", "7"), "mdeg/s", "1")
    assert "P-0147" not in tables_kept.read_text()
    home.escape()
    again = table(tmp_path / "other" / "walk_right_shank.csv", names=("t", "P-0147", "q", "r", "u", "v", "w"))
    home.importing.read([again])
    page = wait_for_draft(qtbot, home)
    assert not page.table.isVisible()
    (block,) = blocks(home).values()
    np.testing.assert_allclose(block.gyr_rad_s, np.deg2rad(LEFT.gyr) / 1000, atol=1e-9)
    other = table(tmp_path / "third.csv")  # whose columns have other names
    explain(qtbot, home, other)


def test_what_is_kept_can_be_changed_and_forgotten(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    path = table(tmp_path / "walk_left_thigh.csv", names=KNOWN)
    home.importing.read([path])
    page = wait_for_draft(qtbot, home)
    assert not page.table.isVisible()  # it is recognised
    page.draft.columns.click()
    qtbot.waitUntil(page.table.isVisible)
    press_to(page.table.gyr_unit, "mdeg/s")
    qtbot.waitUntil(home.bar.primary.isEnabled)
    press_enter(home)
    wait_for_draft(qtbot, home)
    (block,) = blocks(home).values()
    np.testing.assert_allclose(block.gyr_rad_s, np.deg2rad(LEFT.gyr) / 1000, atol=1e-9)
    page.draft.columns.click()
    qtbot.waitUntil(page.table.isVisible)
    assert page.table.gyr_unit.currentData() == "mdeg/s"
    page.table.detect.click()
    qtbot.waitUntil(lambda: page.table.gyr_unit.currentData() == "rad/s")
    press_enter(home)
    wait_for_draft(qtbot, home)
    (block,) = blocks(home).values()
    np.testing.assert_allclose(block.gyr_rad_s, LEFT.gyr, atol=1e-5)
    assert known_tables() == {}


def test_what_is_shown_next_is_seen_from_its_beginning(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    home.resize(900, 560)
    table(tmp_path / "A.csv", names=KNOWN)
    home.importing.read([tmp_path / "A.csv", table(tmp_path / "walk.csv")])
    page = wait_for_draft(qtbot, home)
    area = next(one for one in home.findChildren(QScrollArea) if one.widget() is page)
    area.verticalScrollBar().setValue(area.verticalScrollBar().maximum())
    assert area.verticalScrollBar().value() > 0
    page.explain.click()
    qtbot.waitUntil(page.table.isVisible)
    assert area.verticalScrollBar().value() == 0
    assert page.table.encoding.hasFocus()


def test_tables_of_one_program_are_asked_about_once(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    table(tmp_path / "walk_left_thigh.csv")
    table(tmp_path / "walk_left_shank.csv", motion=RIGHT)
    form = explain(qtbot, home, tmp_path)
    assert "Table 1 of 2: " in shown(home.importing.page)
    assert form.acc[0].currentData() == "p"
    press_enter(home)
    wait_for_draft(qtbot, home)
    found = blocks(home)
    np.testing.assert_allclose(found["walk_left_thigh"].acc_m_s2, LEFT.acc, atol=1e-5)
    np.testing.assert_allclose(found["walk_left_shank"].acc_m_s2, RIGHT.acc, atol=1e-5)


def test_tables_of_two_programs_are_asked_about_each(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    table(tmp_path / "walk_left_thigh.csv")
    table(tmp_path / "walk_right_thigh.csv", names=("T", *NAMES[1:]))
    explain(qtbot, home, tmp_path)
    press_enter(home)
    qtbot.waitUntil(lambda: "Table 2 of 2: " in shown(home.importing.page))
    home.bar.quiet[0].click()
    page = wait_for_draft(qtbot, home)
    assert [*blocks(home)] == ["walk_left_thigh"]
    assert "walk_right_thigh.csv: the file format is not recognised" in shown(page)
    page.explain.click()
    qtbot.waitUntil(page.table.isVisible)
    assert "walk_right_thigh.csv" in shown(page)
    press_enter(home)
    wait_for_draft(qtbot, home)
    assert {*blocks(home)} == {"walk_left_thigh", "walk_right_thigh"}


def test_a_table_without_names_is_confirmed_each_time_as_it_was(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    """Seven columns are those of many programs."""
    form = explain(qtbot, home, *no_header(tmp_path / "one"))
    press_to(form.gyr_unit, "mdeg/s")
    qtbot.waitUntil(home.bar.primary.isEnabled)
    press_enter(home)
    wait_for_draft(qtbot, home)
    home.escape()
    form = explain(qtbot, home, *no_header(tmp_path / "two"))
    assert form.gyr_unit.currentData() == "mdeg/s"


def test_accelerometer_and_gyroscope_in_files_of_their_own_are_joined(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    write(tmp_path / "left_thigh_acc.csv", ["t,p,q,r", *rows_of(LEFT.time_s, LEFT.acc)])
    write(tmp_path / "left_thigh_gyro.csv", ["t,p,q,r", *rows_of(LEFT.time_s, LEFT.gyr)])
    form = explain(qtbot, home, tmp_path)
    assert "This file has no angular rates; they must be in a second file of this sensor." in form.notice.text
    press_enter(home)
    wait_for(qtbot, form, "This file has no acceleration; it must be in a second file of this sensor.")
    press_enter(home)
    wait_for_draft(qtbot, home)
    (block,) = blocks(home).values()
    np.testing.assert_allclose(block.acc_m_s2, LEFT.acc, atol=1e-5)
    np.testing.assert_allclose(block.gyr_rad_s, LEFT.gyr, atol=1e-5)


def test_samples_without_times_need_a_rate(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    body = rows_of(LEFT.acc[:, 0], LEFT.acc[:, 1:], LEFT.gyr)
    form = explain(qtbot, home, write(tmp_path / "left_thigh.csv", [",".join(NAMES[1:]), *body]))
    wait_for(qtbot, form, "The samples in the file have no times.")
    assert form.rate.isVisible()
    form.rate.line_edit.setFocus()
    QTest.keyClicks(form.rate.line_edit, "100")
    wait_for(qtbot, form, READY)
    QTest.keyClick(form.rate.line_edit, Qt.Key.Key_Return)
    wait_for_draft(qtbot, home)
    home.escape()
    form = explain(qtbot, home, tmp_path / "left_thigh.csv")  # another recording may have another rate
    assert form.rate.value == 100.0


def test_files_that_are_not_called_alike_are_made_one_recording(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    table(tmp_path / "A7F2.csv", names=KNOWN)
    alone = tmp_path / "B801.csv"
    table(alone, names=KNOWN, motion=RIGHT)
    home.importing.read([tmp_path])
    page = wait_for_draft(qtbot, home)
    assert "Session 1 of 2" in shown(page)
    page.draft.combine.click()
    qtbot.waitUntil(lambda: len(page.draft.sites) == 2)
    assert "Session 1 of 2" not in shown(page)
    assert not page.draft.combine.isVisible()
    home.escape()
    home.importing.read([alone])
    assert not wait_for_draft(qtbot, home).draft.combine.isVisible()


def test_what_was_left_out_stays_refused_in_words(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    explain(qtbot, home, table(tmp_path / "walk.csv"))
    home.bar.quiet[0].click()
    page = home.importing.page
    qtbot.waitUntil(page.choose_files.isVisible)
    assert "walk.csv: the file format is not recognised" in shown(page)
    page.explain.click()
    qtbot.waitUntil(page.table.isVisible)
    home.escape()
    assert home.current is home.page
    assert known_tables() == {}


def test_a_session_that_was_taken_in_does_not_come_again(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    table(tmp_path / "A.csv", names=KNOWN)
    table(tmp_path / "b" / "B.csv", names=KNOWN)
    unknown = table(tmp_path / "c" / "C.csv")
    home.importing.read([tmp_path / "A.csv", tmp_path / "b", unknown])
    page = wait_for_draft(qtbot, home)
    assert "Session 1 of 2" in shown(page)
    home.importing.leave_out()
    page.explain.click()
    qtbot.waitUntil(page.table.isVisible)
    press_enter(home)
    wait_for_draft(qtbot, home)
    assert "Session 1 of 2" in shown(page)
    assert [*blocks(home)] == ["B"]
    home.importing.leave_out()
    assert [*blocks(home)] == ["C"]


def test_that_choices_cannot_be_kept_is_reported(qtbot: QtBot, home: Home, tmp_path: Path, tables_kept: Path) -> None:
    tables_kept.parent.parent.mkdir(exist_ok=True)
    tables_kept.parent.write_text("a file in the way")
    explain(qtbot, home, table(tmp_path / "walk_left_thigh.csv"))
    reports: list[str] = []
    home.importing.reported.connect(lambda what, _remedy: reports.append(what))
    press_enter(home)
    wait_for_draft(qtbot, home)
    assert reports
    assert reports[0].startswith("The meaning of the columns could not be stored (")

"""Files of other programs, from the window to the library: what is shown first, what is asked, what is refused."""

from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Event

import numpy as np
import pytest
from PySide6.QtCore import Qt, QThread
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox
from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.home.importing.controller import _why
from app.home.importing.import_page import ImportPage
from app.importing.import_drafts import SessionDraft
from app.widgets.text import Text
from app.workers.library_controller import LibraryController
from core.body import Site
from core.session import RecordingKind
from devices.files.refusal import FileRefusedError
from tests.waiting import PATIENCE_S

FindData = Callable[[str], Path]


def monitors(path: Path, names: tuple[str, ...], seconds: float = 3.0) -> Path:
    """An export of Motion Studio: sensors that turn to and fro."""
    quantities = ["Accelerometer", "", "", "Gyroscope", "", ""]
    lines = [
        "Format=7," + ",".join(f"{100 + k},,{name},,," for k, name in enumerate(names)),
        "Time," + ",".join(",".join(quantities) for _ in names),
        "," + ",".join("X,Y,Z,X,Y,Z" for _ in names),
    ]
    for k in range(int(seconds * 128)):
        rate = np.sin(k / 20)
        lines.append(f"{1_000_000 + k * 7812}," + ",".join(f"0,0,9.81,{rate:.4f},0,0" for _ in names))
    path.write_text("\n".join([*lines, ""]))
    return path


def shown(page: ImportPage) -> str:
    return " ".join(text.text() for text in page.findChildren(Text) if text.isVisible())


def read(qtbot: QtBot, home: Home, *paths: Path) -> ImportPage:
    home.importing.read(paths)
    qtbot.waitUntil(lambda: home.current is home.importing.page)
    return home.importing.page


def choices(page: ImportPage) -> dict[str, QComboBox]:
    return {one.accessibleName(): one for one in page.findChildren(QComboBox) if one.isVisible()}


def test_what_was_understood_is_shown_before_anything_is_stored(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    path = monitors(tmp_path / "walk.csv", ("Left Thigh", "Left Shank", "Lumbar"))
    page = read(qtbot, home, path)
    stated = shown(page)
    assert "1 recording of APDM" in stated
    assert "3 sensors · 3.0 s · 128 Hz · gravity 9.8 m/s² · no gaps" in stated
    assert stated.count("from its name") == 2
    by_name = choices(page)
    assert by_name["Position of Left Thigh (100)"].currentText() == "Left thigh"
    assert by_name["Position of Lumbar (102)"].currentText() == "Not recorded"
    assert by_name["Type of walk"].currentText() == "Walk"
    by_name["Position of Left Thigh (100)"].setCurrentIndex(4)
    assert shown(page).count("from its name") == 1  # what a person states is no proposal
    assert len(home.page.patients.lines) == 2


def test_what_was_made_of_the_orientation_is_shown(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    """Gravity and rates of a sensor that turns, of which neither was recorded."""
    lines = ["sep=,", "DeviceTag:,left thigh", "SyncStatus:,Synced", "OutputRate:,60Hz", ""]
    lines.append("PacketCounter,SampleTimeFine,Euler_X,Euler_Y,Euler_Z,FreeAcc_X,FreeAcc_Y,FreeAcc_Z")
    lines += [f"{k},{16667 * k},{30 * np.sin(k / 20):.4f},0,0,0.1,0,0" for k in range(180)]
    path = tmp_path / "LFemur_20230101_101112_831.csv"
    path.write_text("\n".join([*lines, ""]))
    stated = shown(read(qtbot, home, path))
    assert "1 recording of Movella DOT (files of its app)" in stated
    reported = "1 sensor · 3.0 s · 60 Hz · gravity 9.8 m/s² · gravity added from orientation · no gaps"
    assert f"{reported} · angular rates derived from orientation" in stated
    assert "from its name" in stated


def test_a_recording_of_another_program_comes_into_the_library(
    qtbot: QtBot, home: Home, controller: LibraryController, tmp_path: Path
) -> None:
    page = read(qtbot, home, monitors(tmp_path / "walk.csv", ("Left Thigh", "Left Shank", "Lumbar")))
    page.code.set_text("P-0300")
    page.day_field.set_text("2026-03-09")
    QTest.keyClick(page.code.line_edit, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: home.current is home.page)
    assert controller.state is not None
    library = controller.state.library.library
    patient = library.patients.find("P-0300")
    assert patient is not None
    (summary,) = library.sessions.list(patient.id)
    visit = library.sessions.get(summary.id)
    assert visit.details.started == "2026-03-09"
    (recording,) = visit.recordings
    assert recording.details.kind is RecordingKind.WALKING
    assert recording.placement is not None
    assert set(recording.placement.site_of.values()) == {Site.LEFT_THIGH, Site.LEFT_SHANK}


def test_nothing_is_imported_as_long_as_something_is_wrong(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    page = read(qtbot, home, monitors(tmp_path / "walk.csv", ("one", "two")))
    page.code.set_text("P-0300")
    page.code.edited.emit("P-0300")
    assert "Enter the position of at least one sensor." in shown(page)
    assert not home.bar.primary.isEnabled()
    one, two = (choices(page)[f"Position of {name}"] for name in ("one (100)", "two (101)"))
    one.setCurrentIndex(1)
    assert home.bar.primary.isEnabled()
    two.setCurrentIndex(1)
    assert "Left thigh is assigned twice." in shown(page)
    assert not home.bar.primary.isEnabled()
    two.setCurrentIndex(2)
    page.day_field.line_edit.setText("9 March")
    page.day_field.line_edit.textEdited.emit("9 March")
    assert "Enter the date as year-month-day, such as 2026-03-09" in shown(page)
    assert not home.bar.primary.isEnabled()
    QTest.keyClick(page.code.line_edit, Qt.Key.Key_Return)
    assert home.current is page  # nor by the key


def test_one_session_after_the_other_is_asked_for(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    first = monitors(tmp_path / "a.csv", ("Left Foot",))
    (tmp_path / "b").mkdir()
    second = tmp_path / "b" / "b.csv"
    second.write_text(monitors(second, ("Right Foot",)).read_text().replace(",100,", ",200,"))
    page = read(qtbot, home, first, second, tmp_path)
    assert "Session 1 of 2" in shown(page)
    assert [button.text() for button in home.bar.quiet] == ["Skip this one"]
    home.importing.leave_out()
    assert "Session 2 of 2" in shown(page)
    home.importing.leave_out()
    assert home.current is home.page


def test_what_could_not_be_read_is_stated_beside_what_was(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    good = monitors(tmp_path / "walk.csv", ("Left Thigh", "Left Shank"))
    head = "// Firmware Version: 4.0.2\nPacketCounter\tAcc_X\tAcc_Y\tAcc_Z\tGyr_X\tGyr_Y\tGyr_Z\n"
    (tmp_path / "mt.txt").write_text(head + "".join(f"{k}\t0\t0\t9.81\t0\t0\t{k % 2}\n" for k in range(300)))
    (tmp_path / "notes.txt").write_text("to be left out\n")
    page = read(qtbot, home, good, tmp_path / "mt.txt", tmp_path / "notes.txt")
    stated = shown(page)
    assert (
        "notes.txt: the file format is not recognised, and the file is not a table of numbers. Leave this file out"
        in stated
    )
    assert "mt.txt: the sample rate is missing." in stated
    page.rate.set_value(100.0)
    page.read_again.click()
    qtbot.waitUntil(lambda: "1 recording of Xsens MT Manager" in shown(page))
    assert "3.0 s · 100 Hz" in shown(page)
    assert not page.read_again.isVisible()


def test_a_single_file_of_no_program_is_refused_in_words(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("to be left out\n")
    home.importing.read([tmp_path / "notes.txt"])
    qtbot.waitUntil(home.banner.isVisible)
    assert home.banner.text.startswith("The file format is not recognised, and the file is not a table of numbers.")
    assert home.banner.text.endswith("Where: notes.txt.")
    assert home.current is home.page


def test_the_motion_places_the_sensors_of_a_real_walk(qtbot: QtBot, home: Home, test_data: FindData) -> None:
    folder = test_data("vendor_exports/xsens_mtmanager")
    page = read(qtbot, home, *sorted(folder.glob("OpenSenseExample_*.txt")))
    for torso in ("00B42268", "00B42279"):
        choices(page)[f"Position of {torso}"].setCurrentIndex(8)
    page.draft.place.click()
    qtbot.waitUntil(page.draft.is_right.isVisible)
    assert (
        "According to the movement, 00B4227C, 00B4227D and 00B421EF are on one leg, listed from the thigh down."
        in shown(page)
    )
    page.draft.is_right.click()
    assert page.draft.sites["00B4227C"] is Site.RIGHT_THIGH
    assert page.draft.sites["00B421E6"] is Site.LEFT_FOOT
    assert shown(page).count("from movement") == 6


def test_a_site_that_was_stated_shows_the_side(qtbot: QtBot, home: Home, test_data: FindData) -> None:
    folder = test_data("vendor_exports/xsens_mtmanager")
    page = read(qtbot, home, *sorted(folder.glob("OpenSenseExample_*.txt")))
    for torso in ("00B42268", "00B42279"):
        choices(page)[f"Position of {torso}"].setCurrentIndex(8)
    thigh = choices(page)["Position of 00B4227C"]
    thigh.setCurrentIndex(1)  # left, whatever it was
    page.draft.place.click()
    qtbot.waitUntil(lambda: page.draft.sites["00B421EF"] is Site.LEFT_FOOT)
    assert page.draft.sites["00B421E6"] is Site.RIGHT_FOOT
    choices(page)["Position of 00B421E6"].setCurrentIndex(0)
    thigh.setCurrentIndex(3)  # a foot, which the motion takes for a thigh
    page.draft.place.click()
    qtbot.waitUntil(home.banner.isVisible)
    assert "The movement does not fit the entered sensor positions" in home.banner.text
    assert page.draft.sites["00B421E6"] is None


def legs_of_a_real_walk(test_data: FindData) -> list[Path]:
    """Its six sensors on legs, whose names state nothing."""
    every = test_data("vendor_exports/xsens_mtmanager").glob("OpenSenseExample_*.txt")
    return sorted(path for path in every if not path.stem.endswith(("00B42268", "00B42279")))


def test_positions_are_proposed_from_movement_without_being_asked_for(
    qtbot: QtBot, home: Home, test_data: FindData
) -> None:
    page = read(qtbot, home, *legs_of_a_real_walk(test_data))
    qtbot.waitUntil(page.draft.is_right.isVisible)
    assert "00B4227C, 00B4227D and 00B421EF are on one leg" in shown(page)
    assert not page.draft.is_left.hasFocus()  # somebody may be typing
    assert set(page.draft.sites.values()) == {None}
    page.draft.is_right.click()
    assert page.draft.sites["00B421EF"] is Site.RIGHT_FOOT


def test_what_the_motion_shows_late_of_one_draft_is_not_stated_of_the_next(
    qtbot: QtBot, home: Home, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    left, looked = Event(), list[str]()

    def slowly(draft: SessionDraft, _worn: Sequence[str]) -> None:
        left.wait(PATIENCE_S)
        looked.append(draft.recordings[0].trial.sensors[0].name)

    monkeypatch.setattr("app.home.importing.controller.chains_of_motion", slowly)
    first = monitors(tmp_path / "a.csv", ("one", "two"))
    (tmp_path / "b").mkdir()
    second = monitors(tmp_path / "b" / "b.csv", ("three", "four"))
    second.write_text(second.read_text().replace(",100,", ",200,").replace(",101,", ",201,"))
    page = read(qtbot, home, first, second)
    page.draft.place.click()
    home.importing.leave_out()
    assert "Session 2 of 2" in shown(page)
    left.set()
    qtbot.waitUntil(lambda: sorted(looked) == ["one", "one", "three"])
    qtbot.waitUntil(lambda: not home.importing.findChildren(QThread))
    assert not home.banner.isVisible()


def test_why_a_file_was_not_read_is_not_that_of_one_whose_name_holds_its_own() -> None:
    other = FileRefusedError("left walk.csv, line 3", "the line ends", "Correct it")
    assert _why(Path("walk.csv"), [other]) is None
    own = FileRefusedError("walk.csv, line 2", "the line ends", "Correct it")
    assert _why(Path("walk.csv"), [other, own]) is own
    both = FileRefusedError("acc.csv, gyr.csv", "one of the two files has no samples", "Import both")
    assert [_why(Path("x") / name, [both]) for name in ("acc.csv", "gyr.csv", "yr.csv")] == [both, both, None]


def test_a_mapping_file_names_seven_positions(qtbot: QtBot, home: Home, test_data: FindData) -> None:
    folder = test_data("vendor_exports/xsens_mtmanager")
    mapping = folder / "OpenSenseExample_myIMUMappings.xml"
    page = read(qtbot, home, *sorted(folder.glob("OpenSenseExample_MT*.txt")), mapping)
    assert set(page.draft.sites.values()) == {*Site, None}  # the torso's is none of them
    assert shown(page).replace("unclear from its name", "").count("from its name") == 7
    assert choices(page)["Position of pelvis_imu (00B42279)"].currentText() == "Pelvis"
    assert not page.draft.what_is_wrong


def test_that_sensors_shared_a_receiver_is_asked_where_files_do_not_state_it(
    qtbot: QtBot, home: Home, controller: LibraryController, test_data: FindData, tmp_path: Path
) -> None:
    page = read(qtbot, home, *legs_of_a_real_walk(test_data))
    assert page.draft.one_receiver.isVisible()
    assert not page.draft.is_one_receiver
    page.draft.one_receiver.click()
    for number, key in enumerate(page.draft.sites, 1):
        choices(page)[f"Position of {key}"].setCurrentIndex(number)
    page.code.set_text("P-0301")
    QTest.keyClick(page.code.line_edit, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: home.current is home.page)
    assert controller.state is not None
    library = controller.state.library.library
    patient = library.patients.find("P-0301")
    assert patient is not None
    (summary,) = library.sessions.list(patient.id)
    assert {info.clock for info in library.sessions.get(summary.id).details.sensors.values()} == {"one receiver"}
    alone = read(qtbot, home, monitors(tmp_path / "walk.csv", ("Left Thigh",)))
    assert not alone.draft.one_receiver.isVisible()


def test_import_begins_with_a_choice_of_files_or_a_folder(qtbot: QtBot, home: Home) -> None:
    home.rail.step_pressed.emit(2)
    page = home.importing.page
    assert home.current is page
    assert "Drop files or folders here, or choose them" in shown(page)
    assert page.choose_files.hasFocus()
    home.escape()
    assert home.page.isVisible()


def test_nothing_is_filled_in_but_what_the_files_say(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    """Not the code of the patient who is in sight."""
    home.page.patients.choose_line(home.page.patients.lines[0].id)
    qtbot.waitUntil(lambda: home.patients.patient is not None)
    home.page.empty.importing.clicked.emit()
    page = read(qtbot, home, monitors(tmp_path / "walk.csv", ("Left Thigh", "Left Shank")))
    assert (page.code.text, home.bar.primary.isEnabled()) == ("", False)

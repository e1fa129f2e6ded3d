"""The length of a course is entered before a test and after it, laps after it; what is no figure is no entry."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.widgets.field import NumberField
from app.wizard.walking.course_entry import CourseEntry
from app.wizard.walking.timed_chooser import CourseField
from core.timed.protocols import PlannedTest, TimedProtocol

TEN, TWO, UP, RISES, STAIRS = (
    *(TimedProtocol.TEN_METRES, TimedProtocol.TWO_MINUTES, TimedProtocol.UP_AND_GO),
    *(TimedProtocol.SIT_TO_STAND, TimedProtocol.STAIRS),
)


@pytest.fixture
def entry(qtbot: QtBot) -> CourseEntry:
    entry = CourseEntry()
    qtbot.addWidget(entry)
    entry.show()
    return entry


def write(field: NumberField, text: str) -> None:
    field.line_edit.setFocus()
    field.line_edit.selectAll()
    QTest.keyClicks(field.line_edit, text)
    QTest.keyClick(field.line_edit, Qt.Key.Key_Return)


@pytest.mark.parametrize(
    ("planned", "is_shown", "length"),
    [
        (PlannedTest(TEN), True, "10"),
        (PlannedTest(UP), True, "3"),
        (PlannedTest(UP, course_m=2.44), True, "2.44"),
        (PlannedTest(TWO), True, ""),
        (PlannedTest(TWO, lap_m=20.0), True, "20"),
        (PlannedTest(RISES), False, ""),
        (PlannedTest(STAIRS), False, ""),
    ],
)
def test_a_test_that_has_a_course_shows_its_length(
    qtbot: QtBot, entry: CourseEntry, planned: PlannedTest, is_shown: bool, length: str
) -> None:
    entry.show_test(planned)
    field = CourseField()
    qtbot.addWidget(field)
    field.show_course(planned)
    assert (entry.isVisible(), entry.length.text) == (is_shown, length)
    assert (field.isVisible(), field.field.text) == (is_shown, length)
    assert entry.laps.isVisible() is (planned.protocol is TWO)


def test_laps_and_the_rest_are_the_tests(qtbot: QtBot, entry: CourseEntry) -> None:
    entry.show_test(PlannedTest(TWO, lap_m=20.0))
    for field, text, planned in (
        (entry.laps, "6", PlannedTest(TWO, lap_m=20.0, typed_laps=6)),
        (entry.rest, "7.5", PlannedTest(TWO, lap_m=20.0, typed_laps=6, rest_m=7.5)),
        (entry.length, "25", PlannedTest(TWO, lap_m=25.0, typed_laps=6, rest_m=7.5)),
    ):
        with qtbot.waitSignal(entry.entered):
            write(field, text)
        assert entry.planned == planned
        entry.show_test(planned)


def test_what_is_no_figure_and_what_was_there_before_are_no_entry(qtbot: QtBot, entry: CourseEntry) -> None:
    entry.show_test(PlannedTest(TWO, lap_m=20.0, typed_laps=6))
    with qtbot.assertNotEmitted(entry.entered):
        write(entry.laps, "6")
        write(entry.laps, "six")
        write(entry.length, "0")


def test_what_is_being_typed_stays_where_the_test_is_found_again(qtbot: QtBot, entry: CourseEntry) -> None:
    field = CourseField()
    for one in (entry, field):
        qtbot.addWidget(one)
    entry.show_test(PlannedTest(TWO, lap_m=20.0))
    field.show()
    entry.length.line_edit.setFocus()
    entry.length.line_edit.setText("2")
    entry.show_test(PlannedTest(TWO, lap_m=20.0, typed_laps=6))
    assert (entry.length.text, entry.laps.text) == ("2", "6")
    field.show_course(PlannedTest(UP))
    write(field.field, "0.2")  # too short, and the field is left
    field.show_course(PlannedTest(UP))
    assert (field.field.text, field.is_wrong) == ("0.2", True)
    field.show_course(PlannedTest(TEN))
    assert (field.field.text, field.is_wrong) == ("10", False)


def test_the_tests_own_length_is_no_entry_of_another(entry: CourseEntry) -> None:
    entry.show_test(PlannedTest(UP, course_m=6.0))
    write(entry.length, "3")
    assert entry.planned == PlannedTest(UP)


def test_enter_and_esc_leave_the_field_and_a_wrong_length_is_known(qtbot: QtBot) -> None:
    field = CourseField()
    qtbot.addWidget(field)
    field.show()
    field.show_course(PlannedTest(UP))
    for key in (Qt.Key.Key_Return, Qt.Key.Key_Escape):
        with qtbot.waitSignal(field.left):
            QTest.keyClick(field.field.line_edit, key)
    write(field.field, "4,5")
    assert (field.value, field.is_wrong) == (4.5, False)
    write(field.field, "0.2")
    assert (field.value, field.is_wrong) == (None, True)
    write(field.field, " ")
    assert not field.is_wrong

"""The next change by keys alone: positions by steps, programs and settings by what is typed, with what they were."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.wizard.walking.bench import TOPICS, ChangeEntry, EntryTopic, KnownStates, chain_of
from app.wizard.walking.bench_view import BenchView
from app.wizard.walking.entry_fields import EntryFields
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.session import Recording
from tests.app.room import words_cut
from tests.app.wizard.walking.bench_material import WALKED, recording

KNEE, FOOT, PYLON = ProsthesisPart.KNEE_UNIT, ProsthesisPart.FOOT, ProsthesisPart.PYLON
TO_2 = PartChange(KNEE, program_before="Walk 1", program="Walk 2")
TO_50 = PartChange(KNEE, setting="Swing flexion", setting_before=45.0, setting_value=50.0)
BOTH = replace(TO_2, setting="Swing flexion", setting_before=45.0, setting_value=50.0)
Key = Qt.Key


@pytest.fixture
def entry() -> ChangeEntry:
    return ChangeEntry()


@pytest.fixture
def fields(qtbot: QtBot, entry: ChangeEntry) -> EntryFields:
    fields = EntryFields(entry)
    qtbot.addWidget(fields)
    fields.reported.connect(fields.show_entry)
    fields.resize(260, 420)
    fields.show_entry()
    fields.show()
    return fields


def chosen(fields: EntryFields, topic: EntryTopic) -> None:
    """By the arrow down, from the top of the list."""
    QTest.keyClick(fields.parts, Key.Key_Home)
    for _ in range(TOPICS.index(topic)):
        QTest.keyClick(fields.parts, Key.Key_Down)


def tabs(fields: EntryFields) -> list[QWidget]:
    return [widget for widget in fields.tab_order if widget.isVisible()]


def test_every_part_is_offered_and_those_with_programs_twice() -> None:
    positions = [topic.part for topic in TOPICS if not topic.is_program]
    assert set(positions) == set(ProsthesisPart) - {FOOT}
    assert [topic.part for topic in TOPICS if topic.is_program] == [FOOT, KNEE]


def test_a_knee_unit_is_offered_where_the_knee_is_the_prosthesis_or_was_entered(
    fields: EntryFields, entry: ChangeEntry
) -> None:
    entry.has_knee = False
    fields.show_entry()
    shown = [fields.parts.itemText(k) for k in range(fields.parts.count())]
    assert len(shown) == len(TOPICS) - 2
    assert not any("Knee" in name for name in shown)
    entry.load((TO_2,))
    fields.show_entry()
    assert fields.parts.count() == len(TOPICS)
    chosen(fields, EntryTopic(KNEE))
    assert entry.topic == EntryTopic(KNEE)


def test_the_chooser_decides_what_is_asked_and_each_is_reached_by_tab(fields: EntryFields) -> None:
    assert len(tabs(fields)) == 6  # the chooser, four figures, words
    chosen(fields, EntryTopic(KNEE, is_program=True))
    assert [widget.accessibleName() for widget in tabs(fields)] == [
        *("Part", "Program before", "Program now", "Setting, by its name", "Value before", "Value now")
    ]
    chosen(fields, EntryTopic(PYLON))
    assert len(tabs(fields)) == 6
    assert not fields.program.isVisible()


def test_tab_goes_through_what_is_asked_in_the_order_of_reading(fields: EntryFields) -> None:
    for topic in (EntryTopic(KNEE, is_program=True), EntryTopic(PYLON)):
        chosen(fields, topic)
        fields.parts.setFocus()
        for widget in tabs(fields)[1:]:
            QTest.keyClick(fields.window().focusWidget() or fields, Key.Key_Tab)
            assert fields.window().focusWidget() is widget, widget.accessibleName()


def test_a_program_and_a_setting_are_typed_and_read_as_they_print(fields: EntryFields, entry: ChangeEntry) -> None:
    chosen(fields, EntryTopic(KNEE, is_program=True))
    QTest.keyClicks(fields.program_before.line_edit, "Walk 1")
    assert fields.written.text() == "Nothing changed yet."
    QTest.keyClicks(fields.program.line_edit, "Walk 2")
    assert fields.written.text() == "Recorded as: Knee unit: program Walk 2, was Walk 1"
    QTest.keyClicks(fields.setting.line_edit, "Swing flexion")
    QTest.keyClicks(fields.setting_before.line_edit, "45")
    QTest.keyClicks(fields.setting_value.line_edit, "49.5")
    for _ in range(2):
        QTest.keyClick(fields.setting_value.line_edit, Key.Key_Up)
    QTest.keyClick(fields.setting_value.line_edit, Key.Key_Down)
    written = "Recorded as: Knee unit: program Walk 2, was Walk 1; knee unit: Swing flexion 50.5, was 45"
    assert fields.written.text() == written
    both = replace(BOTH, setting_value=50.5)
    assert entry.parts == (both,)
    entry.load(())
    fields.show_entry()
    assert [field.text for field in (*fields.names.values(), *fields.numbers.values())] == [""] * 5
    entry.load((both,))
    fields.show_entry()
    assert entry.parts == (both,)


def test_what_is_known_is_the_value_before_where_nothing_is_typed_and_arrows_go_on_from_it(
    fields: EntryFields, entry: ChangeEntry
) -> None:
    entry.known = KnownStates({(KNEE, ""): "Walk 2", (KNEE, "swing flexion"): 50.0})
    chosen(fields, EntryTopic(KNEE, is_program=True))
    assert fields.program_before.line_edit.placeholderText() == "Walk 2"
    QTest.keyClicks(fields.setting.line_edit, "swing flexion")
    assert fields.setting_before.line_edit.placeholderText() == "50"
    QTest.keyClick(fields.setting_value.line_edit, Key.Key_Down)
    assert entry.parts == (PartChange(KNEE, setting="swing flexion", setting_before=50.0, setting_value=49.0),)
    QTest.keyClicks(fields.program.line_edit, "walk 2")  # as it is: no change
    assert entry.parts[0].program == ""
    chosen(fields, EntryTopic(FOOT, is_program=True))
    assert fields.program_before.line_edit.placeholderText() == ""


@pytest.mark.parametrize("typed", ["fifty", "10000", ""])
def test_what_is_no_number_is_no_setting(fields: EntryFields, entry: ChangeEntry, typed: str) -> None:
    chosen(fields, EntryTopic(KNEE, is_program=True))
    QTest.keyClicks(fields.setting.line_edit, "Stance")
    QTest.keyClicks(fields.setting_value.line_edit, typed)
    assert entry.parts == ()
    assert fields.setting_value.text == typed  # it is not taken away


def test_enter_in_a_field_is_done_with_it_and_presses_nothing(qtbot: QtBot, fields: EntryFields) -> None:
    passed_on: list[object] = []
    outer = QWidget()
    qtbot.addWidget(outer)
    outer.keyPressEvent = lambda event: passed_on.append(event.key())  # type: ignore[method-assign]  # of this one only
    fields.setParent(outer)
    outer.show()
    for which in (fields.words.line_edit, fields.steppers["turns"]):
        which.setFocus()
        with qtbot.waitSignal(fields.left, raising=False) as caught:
            QTest.keyClick(which, Key.Key_Return)
        assert caught.signal_triggered is (which is fields.words.line_edit)
    assert passed_on == [Key.Key_Return]  # of the figure: the filled button's
    fields.setParent(None)


def test_after_enter_the_focus_is_on_the_bench(qtbot: QtBot, entry: ChangeEntry) -> None:
    view = BenchView(entry)
    qtbot.addWidget(view)
    view.show()
    view.focus_entry()
    assert view.focusWidget() is view.alignments.fields.parts
    view.alignments.fields.words.line_edit.setFocus()
    QTest.keyClick(view.alignments.fields.words.line_edit, Key.Key_Return)
    assert view.window().focusWidget() is view


def walked(*reported: AlignmentChange | None) -> tuple[Recording, ...]:
    return tuple(
        recording(k + 1, letter, change) for k, (letter, change) in enumerate(zip("ABCD", reported, strict=False))
    )


@pytest.mark.parametrize(
    ("reported", "returned_to", "program", "setting"),
    [
        ((None,), "", "", None),
        ((None, AlignmentChange("Alignment A", (TO_2, TO_50))), "", "Walk 2", 50.0),
        ((None, AlignmentChange("Alignment A", (TO_2, TO_50))), "Alignment A", "Walk 1", 45.0),
        # back by a change of its own, and on from there
        (
            (
                None,
                AlignmentChange("Alignment A", (TO_2,)),
                AlignmentChange("Alignment B", (PartChange(KNEE, program_before="Walk 2", program="Walk 1"),)),
            ),
            *("", "Walk 1", None),
        ),
        ((None, AlignmentChange("Alignment A", (PartChange(KNEE, program="Walk 2"),))), "Alignment A", "", None),
        # of another chain nothing is known
        ((None, AlignmentChange("gone", (TO_2,)), None), "Alignment C", "", None),
    ],
)
def test_what_a_program_is_now_is_known_from_the_changes(
    reported: tuple[AlignmentChange | None, ...], returned_to: str, program: str, setting: float | None
) -> None:
    known = chain_of(walked(*reported), returned_to).known
    assert (known.program(KNEE), known.setting(KNEE, " SWING flexion")) == (program, setting)
    assert (known.program(FOOT), known.setting(KNEE, "")) == ("", None)


def test_a_program_is_undone_on_the_way_back() -> None:
    chain = chain_of((*WALKED, recording(4, "D", AlignmentChange("Alignment C", (TO_2, TO_50)))), "Alignment A")
    _, change = chain.again
    assert change.parts == (
        PartChange(KNEE, program_before="Walk 2", program="Walk 1"),
        PartChange(KNEE, setting="Swing flexion", setting_before=50.0, setting_value=45.0),
        PartChange(PYLON, height_mm=-2.0),
    )


@pytest.mark.usefixtures("pseudo_language")
@pytest.mark.parametrize("is_compact", [False, True])
def test_no_word_of_a_program_is_cut_in_a_language_as_long_as_german(fields: EntryFields, is_compact: bool) -> None:
    fields.set_compact(is_compact)
    chosen(fields, EntryTopic(KNEE, is_program=True))
    fields.resize(fields.minimumSizeHint().expandedTo(fields.size()))
    assert words_cut(fields) == []


def test_each_figure_is_explained_under_the_mouse(fields: EntryFields) -> None:
    assert fields.steppers["turns"].toolTip() == "Screw turns: plus, minus or an arrow changes it by 0.125."


def test_what_is_no_number_stays_while_the_change_is_entered_and_goes_with_it(
    fields: EntryFields, entry: ChangeEntry
) -> None:
    chosen(fields, EntryTopic(KNEE, is_program=True))
    QTest.keyClicks(fields.setting_value.line_edit, "fifty")
    QTest.keyClicks(fields.setting.line_edit, "Stance")
    assert fields.setting_value.text == "fifty"
    entry.load(())  # the walk has begun: the next change is another
    fields.show_entry()
    assert fields.setting_value.text == ""
    QTest.keyClicks(fields.setting_value.line_edit, "fifty")
    chosen(fields, EntryTopic(FOOT, is_program=True))
    assert fields.setting_value.text == ""


def test_esc_in_a_field_is_done_with_it(qtbot: QtBot, fields: EntryFields) -> None:
    for field in (fields.words, fields.program, fields.setting_value):
        with qtbot.waitSignal(fields.left):
            QTest.keyClick(field.line_edit, Key.Key_Escape)


def test_two_entries_of_one_part_are_one_change(entry: ChangeEntry) -> None:
    spacer = PartChange(PYLON, height_mm=3.0, text="spacer")
    screw = PartChange(PYLON, height_mm=-1.0, turns=0.5, text="screw")
    entry.load([spacer, screw, TO_2, TO_50])
    assert set(entry.parts) == {PartChange(PYLON, height_mm=2.0, turns=0.5, text="spacer; screw"), BOTH}

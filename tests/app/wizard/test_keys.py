"""Keys and what they mean: in text, on buttons, while something runs, held down."""

import pytest
from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QApplication,
    QComboBox,
    QDialog,
    QLineEdit,
    QPlainTextEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)
from pytestqt.qtbot import QtBot

from app.widgets.button import Button
from app.wizard.keys import Intent, KeyAction, Keys

Key, Held = Qt.Key, Qt.KeyboardModifier


class Window(QWidget):
    def __init__(self) -> None:
        super().__init__()
        self.field, self.words, self.button, self.plain = QLineEdit(), QPlainTextEdit(), Button("Back"), QWidget()
        self.plain.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        column = QVBoxLayout(self)
        for widget in (self.field, self.words, self.button, self.plain):
            column.addWidget(widget)
        self.keys = Keys(self)
        self.intents: list[Intent] = []
        self.clicks = 0
        self.keys.pressed.connect(self.intents.append)
        self.button.clicked.connect(self._on_clicked)

    def press(self, key: Qt.Key, held: Qt.KeyboardModifier = Held.NoModifier) -> list[Intent]:
        """Press a key where the focus is, and give what it meant."""
        self.intents.clear()
        QTest.keyClick(self.focusWidget() or self, key, held)
        return list(self.intents)

    def _on_clicked(self) -> None:
        self.clicks += 1


@pytest.fixture
def window(qtbot: QtBot) -> Window:
    window = Window()
    qtbot.addWidget(window)
    window.show()
    window.plain.setFocus()
    return window


MEANINGS = [
    (Key.Key_Space, Held.NoModifier, Intent(KeyAction.RUN)),
    (Key.Key_Return, Held.NoModifier, Intent(KeyAction.PRIMARY)),
    (Key.Key_Enter, Held.KeypadModifier, Intent(KeyAction.PRIMARY)),
    (Key.Key_K, Held.NoModifier, Intent(KeyAction.KEEP)),
    (Key.Key_D, Held.NoModifier, Intent(KeyAction.DISCARD)),
    (Key.Key_X, Held.NoModifier, Intent(KeyAction.DISCARD)),
    (Key.Key_T, Held.NoModifier, Intent(KeyAction.NEXT_TEST)),
    (Key.Key_C, Held.NoModifier, Intent(KeyAction.ENTER_FIELDS)),
    (Key.Key_L, Held.NoModifier, Intent(KeyAction.LEFT_LEG)),
    (Key.Key_R, Held.ShiftModifier, Intent(KeyAction.RIGHT_LEG)),
    (Key.Key_1, Held.NoModifier, Intent(KeyAction.LABEL, 1)),
    (Key.Key_9, Held.KeypadModifier, Intent(KeyAction.LABEL, 9)),
    (Key.Key_Exclam, Held.ShiftModifier, Intent(KeyAction.SECOND_LABEL, 1)),
    (Key.Key_I, Held.NoModifier, Intent(KeyAction.IDENTIFY)),
    (Key.Key_BracketLeft, Held.NoModifier, Intent(KeyAction.EARLIER)),
    (Key.Key_BracketRight, Held.NoModifier, Intent(KeyAction.LATER)),
    (Key.Key_Escape, Held.NoModifier, Intent(KeyAction.LEAVE)),
    (Key.Key_1, Held.ControlModifier, Intent(KeyAction.STEP, 1)),
    (Key.Key_7, Held.ControlModifier, Intent(KeyAction.STEP, 7)),
    (Key.Key_Left, Held.AltModifier, Intent(KeyAction.BACK)),
    (Key.Key_F1, Held.NoModifier, Intent(KeyAction.HELP)),
    (Key.Key_F8, Held.NoModifier, Intent(KeyAction.PATIENT_SCREEN)),
    (Key.Key_F11, Held.NoModifier, Intent(KeyAction.FULL_SCREEN)),
    (Key.Key_F6, Held.NoModifier, Intent(KeyAction.NEXT_REGION)),
    (Key.Key_F6, Held.ShiftModifier, Intent(KeyAction.PREVIOUS_REGION)),
    (Key.Key_Plus, Held.ControlModifier | Held.ShiftModifier, Intent(KeyAction.LARGER)),
    (Key.Key_Equal, Held.ControlModifier, Intent(KeyAction.LARGER)),
    (Key.Key_Minus, Held.ControlModifier | Held.KeypadModifier, Intent(KeyAction.SMALLER)),
    (Key.Key_0, Held.ControlModifier, Intent(KeyAction.USUAL_SIZE)),
    (Key.Key_F, Held.ControlModifier, Intent(KeyAction.SEARCH)),
    (Key.Key_N, Held.ControlModifier, Intent(KeyAction.NEW_PATIENT)),
    (Key.Key_S, Held.ControlModifier, Intent(KeyAction.SAVE)),
    (Key.Key_P, Held.ControlModifier, Intent(KeyAction.PRINT)),
    (Key.Key_Z, Held.ControlModifier, Intent(KeyAction.UNDO)),
]


@pytest.mark.parametrize(("key", "held", "intent"), MEANINGS)
def test_a_key_means_what_the_manual_states(
    window: Window, key: Qt.Key, held: Qt.KeyboardModifier, intent: Intent
) -> None:
    assert window.press(key, held) == [intent]


@pytest.mark.parametrize(
    ("key", "held"),
    [
        (Key.Key_J, Held.NoModifier),
        (Key.Key_8, Held.ControlModifier),
        (Key.Key_K, Held.ControlModifier),
        (Key.Key_L, Held.AltModifier),
        (Key.Key_Z, Held.ControlModifier | Held.ShiftModifier),
        (Key.Key_S, Held.ControlModifier | Held.AltModifier),
        (Key.Key_Left, Held.NoModifier),
    ],
)
def test_other_keys_mean_nothing(window: Window, key: Qt.Key, held: Qt.KeyboardModifier) -> None:
    assert window.press(key, held) == []


def test_a_text_field_takes_what_can_be_written(window: Window) -> None:
    window.field.setFocus()
    written = [
        key for key, held, intent in MEANINGS if held in (Held.NoModifier,) and intent.action is not KeyAction.HELP
    ]
    for key in written:
        if key not in (Key.Key_Return, Key.Key_Escape, Key.Key_F6, Key.Key_F8, Key.Key_F11):
            assert window.press(key) == [], key
    assert window.field.text() == " kdxtcl1i[]"


def test_space_is_written_in_a_text_field_even_while_something_runs(window: Window) -> None:
    window.keys.set_running(True)
    window.field.setFocus()
    assert window.press(Key.Key_Space) == []
    assert window.field.text() == " "


def test_a_field_of_numbers_lets_space_through_and_keeps_the_rest(window: Window) -> None:
    window.field.setInputMethodHints(Qt.InputMethodHint.ImhFormattedNumbersOnly)
    window.field.setFocus()
    assert window.press(Key.Key_Space) == [Intent(KeyAction.RUN)]
    assert window.press(Key.Key_1) == []
    assert window.press(Key.Key_K) == []
    assert window.field.text() == "1k"


def test_a_field_that_is_only_read_takes_no_letters(window: Window) -> None:
    window.field.setReadOnly(True)
    window.field.setFocus()
    assert window.press(Key.Key_K) == [Intent(KeyAction.KEEP)]


def test_what_is_written_is_undone_before_what_was_done(window: Window) -> None:
    window.field.setFocus()
    QTest.keyClicks(window.field, "P-0147")
    assert window.press(Key.Key_Z, Held.ControlModifier) == []
    assert window.field.text() == ""


def test_other_keys_with_ctrl_mean_the_same_in_a_text_field(window: Window) -> None:
    window.field.setFocus()
    assert window.press(Key.Key_2, Held.ControlModifier) == [Intent(KeyAction.STEP, 2)]
    assert window.press(Key.Key_F6) == [Intent(KeyAction.NEXT_REGION)]


def test_enter_in_a_field_of_one_line_is_the_primary_verb_after_the_field_has_received_it(window: Window) -> None:
    received: list[int] = []
    window.field.setFocus()
    window.field.returnPressed.connect(lambda: received.append(len(window.intents)))
    assert window.press(Key.Key_Return) == [Intent(KeyAction.PRIMARY)]
    assert received == [0]


def test_enter_in_a_field_of_many_lines_is_a_new_line(window: Window) -> None:
    window.words.setFocus()
    assert window.press(Key.Key_Return) == []
    assert window.words.toPlainText() == "\n"


@pytest.mark.parametrize("key", [Key.Key_Space, Key.Key_Return])
def test_a_button_that_has_the_focus_is_pressed(window: Window, key: Qt.Key) -> None:
    window.button.setFocus()
    assert window.press(key) == []
    assert window.clicks == 1


def test_space_stops_what_runs_even_where_a_button_has_the_focus(window: Window) -> None:
    window.keys.set_running(True)
    window.button.setFocus()
    assert window.press(Key.Key_Space) == [Intent(KeyAction.RUN)]
    assert window.clicks == 0


def test_a_key_held_down_stops_and_starts_nothing_again(window: Window) -> None:
    for key, text, times in ((Key.Key_Space, " ", 0), (Key.Key_BracketRight, "]", 1)):
        window.intents.clear()
        held = QKeyEvent(QEvent.Type.KeyPress, key, Held.NoModifier, text, autorep=True)
        QApplication.sendEvent(window.plain, held)
        assert len(window.intents) == times


def test_a_dialog_has_its_keys_for_itself(window: Window, qtbot: QtBot) -> None:
    dialog = QDialog(window)
    button = QPushButton("Save", dialog)
    dialog.show()
    button.setFocus()
    window.intents.clear()
    QTest.keyClick(button, Key.Key_K)
    assert window.intents == []


def test_a_window_without_a_focus_receives_keys_too(window: Window) -> None:
    window.plain.clearFocus()
    assert window.press(Key.Key_Space) == [Intent(KeyAction.RUN)]
    assert window.press(Key.Key_Return) == [Intent(KeyAction.PRIMARY)]


def test_a_list_of_choices_is_searched_by_letters_but_not_while_something_runs(qtbot: QtBot, window: Window) -> None:
    parts = QComboBox(window)
    parts.addItems(["Foot, anterior screw", "Knee unit"])
    parts.show()
    parts.setFocus()
    assert window.press(Key.Key_K) == []
    assert parts.currentText() == "Knee unit"
    assert window.press(Key.Key_1) == [Intent(KeyAction.LABEL, 1)]
    window.keys.set_running(True)
    assert window.press(Key.Key_K) == [Intent(KeyAction.KEEP)]


CLICKER = [Key.Key_PageDown, Key.Key_PageUp, Key.Key_Return, Key.Key_F5, Key.Key_B, Key.Key_Period, Key.Key_VolumeUp]


@pytest.mark.parametrize("key", CLICKER)
def test_a_clickers_key_means_space_while_a_test_runs_and_else_what_it_is(window: Window, key: Qt.Key) -> None:
    run = [Intent(KeyAction.RUN)]
    assert window.press(key) != run
    window.keys.set_clicker(True)
    assert window.press(key) == run
    window.button.setFocus()
    assert window.press(key) == run
    assert window.clicks == 0
    assert window.press(Key.Key_F1) == [Intent(KeyAction.HELP)]
    assert window.press(Key.Key_Escape) == [Intent(KeyAction.LEAVE)]
    assert window.press(key, Held.ControlModifier) != run
    window.field.setFocus()
    assert window.press(key) != run
    window.keys.set_clicker(False)
    window.plain.setFocus()
    assert window.press(key) != run

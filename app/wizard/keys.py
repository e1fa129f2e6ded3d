"""Meaning of keys while the wizard is in sight. One filter turns keys into intents; nobody else reads them.

Text has the first word: in a text field letters, figures, brackets and Space are written, and Ctrl Z takes back what
was written; only a field of numbers, which has no use for Space, lets it through. After it comes the bar: a key that
one of its buttons shows presses that button, whatever has the focus, for who presses it looks at the patient and not at
the screen; so does Space while something runs. Only then a button that has the focus is pressed by Space and Enter, as
everywhere, and a list of choices is searched by letters. With Shift, Space and Enter are never the bar's: where it
shows both, they press what has the focus.
"""

import sys
from collections.abc import Callable, Collection
from dataclasses import dataclass
from enum import Enum, auto

from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLineEdit,
    QPlainTextEdit,
    QTextEdit,
    QWidget,
)
from shiboken6 import isValid

from app.wording.translation import tr


class KeyAction(Enum):
    RUN = auto()  # Space: start, stop, again: the thing that runs
    PRIMARY = auto()  # Enter
    KEEP = auto()
    DISCARD = auto()
    LEFT_LEG = auto()
    RIGHT_LEG = auto()
    LABEL = auto()  # number: 1 to 9
    SECOND_LABEL = auto()  # the same with Shift
    IDENTIFY = auto()
    EARLIER = auto()
    LATER = auto()
    LEAVE = auto()  # Esc
    STEP = auto()  # number: 1 to 7
    BACK = auto()
    HELP = auto()
    NEXT_REGION = auto()
    PREVIOUS_REGION = auto()
    LARGER = auto()
    SMALLER = auto()
    USUAL_SIZE = auto()
    SEARCH = auto()
    NEW_PATIENT = auto()
    SAVE = auto()
    PRINT = auto()
    UNDO = auto()
    PATIENT_SCREEN = auto()  # F8
    FULL_SCREEN = auto()  # F11
    NEXT_TEST = auto()  # T
    ENTER_FIELDS = auto()  # C: of a test's course, or of a change at the prosthesis


@dataclass(frozen=True, slots=True)
class Intent:
    """What a key asks for. `number` is that of the step or label, from 1; 0 where there is none."""

    action: KeyAction
    number: int = 0


_Key = Qt.Key
_PLAIN: dict[int, KeyAction] = {
    _Key.Key_Space: KeyAction.RUN,
    _Key.Key_K: KeyAction.KEEP,
    _Key.Key_D: KeyAction.DISCARD,
    _Key.Key_X: KeyAction.DISCARD,
    _Key.Key_L: KeyAction.LEFT_LEG,
    _Key.Key_R: KeyAction.RIGHT_LEG,
    _Key.Key_I: KeyAction.IDENTIFY,
    _Key.Key_T: KeyAction.NEXT_TEST,
    _Key.Key_C: KeyAction.ENTER_FIELDS,
}
# what presenters' clickers send: forward and back, first and last, start, black screen, volume, media
_OF_CLICKERS = frozenset(
    {
        *(_Key.Key_PageUp, _Key.Key_PageDown, _Key.Key_Return, _Key.Key_Enter),
        *(_Key.Key_Left, _Key.Key_Right, _Key.Key_Up, _Key.Key_Down, _Key.Key_Home, _Key.Key_End),
        *(_Key.Key_F5, _Key.Key_B, _Key.Key_Period, _Key.Key_VolumeUp, _Key.Key_VolumeDown),
        *(_Key.Key_MediaPlay, _Key.Key_MediaTogglePlayPause, _Key.Key_MediaNext, _Key.Key_MediaPrevious),
    }
)
# digits with Shift by their place on the keyboard, as Linux and Windows report it: what they write differs by country
_FIRST_DIGIT_AT = {"linux": 10, "win32": 2}
_US_SHIFTED = "!@#$%^&*("
_BRACKETS = {"[": KeyAction.EARLIER, "]": KeyAction.LATER}  # by what is written: many keyboards have them on AltGr
_WITH_CTRL: dict[int, KeyAction] = {
    _Key.Key_Plus: KeyAction.LARGER,
    _Key.Key_Equal: KeyAction.LARGER,  # the same key, where plus needs Shift
    _Key.Key_Minus: KeyAction.SMALLER,
    _Key.Key_0: KeyAction.USUAL_SIZE,
    _Key.Key_F: KeyAction.SEARCH,
    _Key.Key_N: KeyAction.NEW_PATIENT,
    _Key.Key_S: KeyAction.SAVE,
    _Key.Key_P: KeyAction.PRINT,
    _Key.Key_Z: KeyAction.UNDO,
}
_STEPS: dict[int, int] = {_Key.Key_0 + number: number for number in range(1, 8)}
_FUNCTIONS: dict[int, KeyAction] = {
    _Key.Key_F1: KeyAction.HELP,
    _Key.Key_F8: KeyAction.PATIENT_SCREEN,
    _Key.Key_F11: KeyAction.FULL_SCREEN,
}
_LETTERS = (
    *(KeyAction.KEEP, KeyAction.DISCARD, KeyAction.LEFT_LEG, KeyAction.RIGHT_LEG, KeyAction.IDENTIFY),
    KeyAction.ENTER_FIELDS,
)
_REPEATED_WHILE_HELD = {KeyAction.EARLIER, KeyAction.LATER, KeyAction.LARGER, KeyAction.SMALLER}
_ENTER = (_Key.Key_Return, _Key.Key_Enter)
_NO_LETTERS = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.MetaModifier

_TEXT_FIELDS = (QLineEdit, QPlainTextEdit, QTextEdit, QAbstractSpinBox)
_PRESSED_BY_SPACE = (QAbstractButton, QComboBox, QAbstractItemView)


class Keys(QObject):
    """Listens in the window of `root` while `root` is in sight; a dialog has its keys for itself.

    Parameters
    ----------
    shown
        Gives the keys that the bar's buttons show now.

    Signals
    -------
    pressed
        An Intent.
    bar_pressed
        A key that the bar shows.
    """

    pressed = Signal(object)
    bar_pressed = Signal(str)

    def __init__(self, root: QWidget, shown: Callable[[], Collection[str]] = tuple) -> None:
        super().__init__(root)
        self._root, self._shown, self._is_running, self._has_clicker = root, shown, False, False
        self._received: list[QWidget] = []
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        application.focusChanged.connect(self._on_focus_changed)
        self._on_focus_changed(None, application.focusWidget())

    def set_running(self, is_running: bool) -> None:
        """Say whether something runs that Space stops."""
        self._is_running = is_running

    def set_clicker(self, has_clicker: bool) -> None:
        """Say whether a presenter's clicker means what Space does, whichever of its keys it sends."""
        self._has_clicker = has_clicker

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() is not QEvent.Type.KeyPress or not isinstance(event, QKeyEvent):
            return False
        if (
            not isinstance(watched, QWidget)
            or not self._root.isVisible()
            or watched.window() is not self._root.window()
        ):
            return False
        if self._has_clicker and event.key() in _OF_CLICKERS and not event.modifiers() & _NO_LETTERS:
            focused = self._focused_in(watched)
            return watched is focused and not _takes_text(focused) and self._emit(Intent(KeyAction.RUN), event)
        focused = self._focused_in(watched)
        if watched is focused and (key := self._bar_key(event, focused)):
            if not event.isAutoRepeat():
                self.bar_pressed.emit(key)
            return True
        if event.key() in _ENTER:  # what nobody on its way up from the focus took is for the primary verb
            return watched is self._root.window() and self._emit(Intent(KeyAction.PRIMARY), event)
        if watched is not focused:
            return False
        intent = self._intent(event, focused)
        return intent is not None and self._emit(intent, event)

    def _focused_in(self, watched: QWidget) -> QWidget:
        return watched.window().focusWidget() or watched.window()

    def _on_focus_changed(self, _before: QWidget | None, focused: QWidget | None) -> None:
        """Filter only where keys go and end: filtering all events costs a third of a page's build time."""
        if not isValid(self._root):
            return  # at the program's end
        for left in filter(isValid, self._received):
            left.removeEventFilter(self)
        self._received = [self._root.window()]
        if focused is not None and focused is not self._root.window():
            self._received.append(focused)
        for widget in self._received:
            widget.installEventFilter(self)

    def _bar_key(self, event: QKeyEvent, focused: QWidget) -> str:
        """Give the key as the bar shows it; empty where it shows none such, or the text that has the focus takes it."""
        key = _as_shown(event)
        is_written = _takes_text(focused) and not (event.key() == _Key.Key_Space and _takes_figures_only(focused))
        return key if key in self._shown() and not is_written else ""

    def _intent(self, event: QKeyEvent, focused: QWidget) -> Intent | None:
        is_text = _takes_text(focused)
        plain = _plain_intent(event)
        if plain is None:
            intent = _modified_intent(event)
            return None if is_text and intent == Intent(KeyAction.UNDO) else intent
        if isinstance(focused, QComboBox) and plain.action in _LETTERS and not self._is_running:
            return None  # a list is searched by its letters
        if is_text and not (plain.action is KeyAction.RUN and _takes_figures_only(focused)):
            return None
        if plain.action is KeyAction.RUN and not self._is_running and isinstance(focused, _PRESSED_BY_SPACE):
            return None
        return plain

    def _emit(self, intent: Intent, event: QKeyEvent) -> bool:
        """Take the key. A key that is held down starts and stops nothing twice."""
        if not event.isAutoRepeat() or intent.action in _REPEATED_WHILE_HELD:
            self.pressed.emit(intent)
        return True


def _as_shown(event: QKeyEvent) -> str:
    """Give a typing or pressing key as bar buttons show it; other keys reach the bar whatever has the focus."""
    has_shift = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
    if event.modifiers() & _NO_LETTERS or (has_shift and event.key() in (_Key.Key_Space, *_ENTER)):
        return ""
    if event.key() == _Key.Key_Space:
        return tr("Space")
    if event.key() in _ENTER:
        return tr("Enter")
    return event.text().upper()


def _takes_text(widget: QWidget) -> bool:
    if isinstance(widget, QComboBox):
        return widget.isEditable()
    if isinstance(widget, (QLineEdit, QPlainTextEdit, QTextEdit)):
        return not widget.isReadOnly()
    return isinstance(widget, _TEXT_FIELDS)


def _takes_figures_only(widget: QWidget) -> bool:
    figures = Qt.InputMethodHint.ImhFormattedNumbersOnly | Qt.InputMethodHint.ImhDigitsOnly
    return isinstance(widget, QAbstractSpinBox) or bool(widget.inputMethodHints() & figures)


def _plain_intent(event: QKeyEvent) -> Intent | None:
    """Give what a key means alone, or with Shift."""
    if event.text() in _BRACKETS:
        return Intent(_BRACKETS[event.text()])
    if event.modifiers() & _NO_LETTERS:
        return None
    if len(event.text()) == 1 and event.text() in "123456789":
        return Intent(KeyAction.LABEL, int(event.text()))
    if number := _shifted_digit(event):
        return Intent(KeyAction.SECOND_LABEL, number)
    if event.key() == _Key.Key_Escape:
        return Intent(KeyAction.LEAVE)
    action = _PLAIN.get(event.key())
    return Intent(action) if action is not None else None


def _shifted_digit(event: QKeyEvent) -> int:
    """Give the digit, 1 to 9, that is pressed with Shift; 0 where none is."""
    if not event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
        return 0
    first, at = _FIRST_DIGIT_AT.get(sys.platform), event.nativeScanCode()
    if first is not None and at:
        return at - first + 1 if 0 <= at - first < 9 else 0
    return _US_SHIFTED.index(event.text()) + 1 if len(event.text()) == 1 and event.text() in _US_SHIFTED else 0


def _modified_intent(event: QKeyEvent) -> Intent | None:
    """Give what a key of functions, or one with Ctrl or Alt, means."""
    key = event.key()
    held = event.modifiers() & ~(Qt.KeyboardModifier.KeypadModifier | Qt.KeyboardModifier.ShiftModifier)
    has_shift = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
    if held == Qt.KeyboardModifier.NoModifier:
        if key == _Key.Key_F6:
            return Intent(KeyAction.PREVIOUS_REGION if has_shift else KeyAction.NEXT_REGION)
        return Intent(_FUNCTIONS[key]) if key in _FUNCTIONS else None
    if held == Qt.KeyboardModifier.AltModifier:
        return Intent(KeyAction.BACK) if key == _Key.Key_Left else None
    if held != Qt.KeyboardModifier.ControlModifier:
        return None
    if key in _STEPS and not has_shift:
        return Intent(KeyAction.STEP, _STEPS[key])
    action = _WITH_CTRL.get(key)
    if action is None or (has_shift and action is not KeyAction.LARGER):
        return None
    return Intent(action)

"""A user gone wild: mostly what leads a session on, now and then anything that a hand on keys and mouse can do."""

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QEvent, QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QDialog,
    QFileDialog,
    QLineEdit,
    QMenu,
    QPlainTextEdit,
    QWidget,
)

from app.system.settings import Scheme
from tests.safety.hostile_names import SEEDS
from tests.safety.random_hands import CTRL, LEFT, NO_MODIFIER, RIGHT, SHIFT, Key
from tests.safety.random_visits import SensibleUser

SENSIBLE = 0.85
KEYS = (
    *(Key.Key_Tab, Key.Key_Backtab, Key.Key_Return, Key.Key_Enter, Key.Key_Escape, Key.Key_Space, Key.Key_Delete),
    *(Key.Key_Up, Key.Key_Down, Key.Key_Left, Key.Key_Right, Key.Key_Home, Key.Key_End, Key.Key_PageUp),
    *(Key.Key_PageDown, Key.Key_F1, Key.Key_F6, Key.Key_Backspace, Key.Key_BracketLeft, Key.Key_BracketRight),
    *(Key.Key_K, Key.Key_D, Key.Key_L, Key.Key_R, Key.Key_I, Key.Key_S, Key.Key_F, Key.Key_B, Key.Key_X),
    *(Key.Key_1, Key.Key_2, Key.Key_3, Key.Key_4, Key.Key_5, Key.Key_6, Key.Key_7, Key.Key_9, Key.Key_0),
)
WITH_CTRL = (
    *(Key.Key_1, Key.Key_2, Key.Key_3, Key.Key_4, Key.Key_5, Key.Key_6, Key.Key_7, Key.Key_Plus, Key.Key_Minus),
    *(Key.Key_0, Key.Key_F, Key.Key_N, Key.Key_S, Key.Key_P, Key.Key_Z, Key.Key_A, Key.Key_V, Key.Key_D, Key.Key_O),
)
SIZES = ((640, 480), (800, 600), (1024, 700), (1280, 800), (1600, 1000), (2200, 1300))


class RandomUser(SensibleUser):
    """Each `act` does one thing and states in words what it was."""

    def act(self) -> str:
        popup, modal = QApplication.activePopupWidget(), QApplication.activeModalWidget()
        if popup is not None:
            return self._answer_popup(popup)
        if modal is not None and modal is not self._window:
            return self._answer_dialog(modal)
        if QApplication.activeWindow() is not self._window:
            self._window.activateWindow()  # without a desktop nobody does that when a dialog is closed
            return "comes back to the window"
        return self.lead_on() if self._chance.random() < SENSIBLE else self._wild()

    # what is asked in front of the window

    def _answer_popup(self, popup: QWidget) -> str:
        for _ in range(self._chance.randrange(4)):
            QTest.keyClick(popup, Key.Key_Down)
        if QApplication.activePopupWidget() is popup:
            key = Key.Key_Return if self._chance.random() < 0.6 and not _edits_files(popup) else Key.Key_Escape
            QTest.keyClick(popup, key)
        return f"answers {type(popup).__name__}"

    def _answer_dialog(self, dialog: QWidget) -> str:
        if isinstance(dialog, QFileDialog):
            return self._choose_path(dialog)
        if self._chance.random() < 0.3 and isinstance(dialog, QDialog):
            QTest.keyClick(dialog, Key.Key_Escape)
            return f"escapes {type(dialog).__name__}"
        buttons = [one for one in self.controls(dialog) if isinstance(one, QAbstractButton)]
        if buttons:
            self.click(self._chance.choice(buttons))
        return f"presses in {type(dialog).__name__}"

    def _choose_path(self, dialog: QFileDialog) -> str:
        """Only by name: with its own menus a file dialog deletes and renames, which no fault of ours would be."""
        line = dialog.findChild(QLineEdit, "fileNameEdit")
        if self._chance.random() < 0.2 or not isinstance(line, QLineEdit):
            QTest.keyClick(dialog, Key.Key_Escape)
            return "closes the file dialog"
        if dialog.acceptMode() is QFileDialog.AcceptMode.AcceptSave:
            self._saved += 1
            path = self._chance.choice(
                (*[self._place / "out" / f"results {self._saved} {self._chance.randrange(10**6)}"] * 8,
                 self._place / "out", self._place / "sessions", Path("/proc/none/there"), self._library() / "out")
            )  # fmt: skip
        else:
            folders = sorted((self._place / "sessions").iterdir())
            path = self._chance.choice((*folders * 3, self._place / "out", self._library(), self._place / "none"))
        line.setText(str(path))
        QTest.keyClick(line, Key.Key_Return)
        return f"chooses {path}"

    def _library(self) -> Path:
        state = self._window.controller.state
        return state.library.folder if state is not None else self._place / "library"

    # what leads nowhere

    def _wild(self) -> str:
        deeds: tuple[tuple[Callable[[], str], int], ...] = (
            (self._any_key, 30),
            (self._any_control, 25),
            (self._any_place, 10),
            (self._hostile_text, 12),
            (self._any_size, 4),
            (self._any_look, 3),
            (self._wheel, 6),
            (self._drop, 1),
            (self._lock, 1),
            (self._drag, 6),
        )
        deed = self._chance.choices([one for one, _ in deeds], [weight for _, weight in deeds])[0]
        return f"wild: {deed()}"

    def _any_key(self) -> str:
        if self._chance.random() < 0.3:
            key = self._chance.choice(WITH_CTRL)
            self.press(key, CTRL)
            return f"Ctrl {key.name}"
        times = self._chance.choice((1, 1, 1, 2, 5, 20))
        key = self._chance.choice(KEYS)
        for _ in range(times):
            if QApplication.activePopupWidget() is None:
                self.press(key, self._chance.choice((NO_MODIFIER, NO_MODIFIER, NO_MODIFIER, SHIFT)))
        return f"{times} x {key.name}"

    def _any_control(self) -> str:
        controls = self.controls()
        if not controls:
            return "nothing to press"
        one = self._chance.choice(controls)
        self.click(one, is_double=self._chance.random() < 0.2)
        return f"presses {one.accessibleName() or type(one).__name__!r}"

    def _any_place(self) -> str:
        at = QPoint(self._chance.randrange(self._window.width()), self._chance.randrange(self._window.height()))
        target = self._window.childAt(at) or self._window
        button = RIGHT if self._chance.random() < 0.2 else LEFT
        QTest.mouseClick(target, button, NO_MODIFIER, target.mapFrom(self._window, at))
        return f"clicks at {at.x()}, {at.y()} ({type(target).__name__})"

    def _hostile_text(self) -> str:
        lines = [one for one in self.controls() if isinstance(one, QLineEdit | QPlainTextEdit)]
        secret = [one for one in lines if isinstance(one, QLineEdit) and one.echoMode() is QLineEdit.EchoMode.Password]
        lines = [one for one in lines if one not in secret or self._chance.random() < 0.1]
        if not lines:
            return "no field"
        text = self._chance.choice((*SEEDS, "", "x" * 3000))
        self.type_into(self._chance.choice(lines), text)
        if self._chance.random() < 0.5:
            self.press(Key.Key_Return)
        return f"types {text[:30]!r}"

    def _any_size(self) -> str:
        size = self._chance.choice(SIZES)
        self._window.resize(*size)
        return f"size {size}"

    def _any_look(self) -> str:
        self._window._settings.scheme = self._chance.choice(list(Scheme))
        return "another look"

    def _wheel(self) -> str:
        at = QPoint(self._chance.randrange(self._window.width()), self._chance.randrange(self._window.height()))
        target = self._window.childAt(at) or self._window
        turned = QPoint(0, self._chance.choice((-120, 120, 960, -960)))
        event = QWheelEvent(
            *(QPointF(target.mapFrom(self._window, at)), QPointF(self._window.mapToGlobal(at)), QPoint(), turned),
            *(Qt.MouseButton.NoButton, NO_MODIFIER, Qt.ScrollPhase.NoScrollPhase, False),
        )
        QApplication.sendEvent(target, event)
        return f"turns the wheel over {type(target).__name__}"

    def _drop(self) -> str:
        folders = sorted((self._place / "sessions").iterdir())
        mime = QMimeData()
        mime.setUrls([QUrl.fromLocalFile(str(self._chance.choice(folders)))])
        action, middle = Qt.DropAction.CopyAction, self._window.rect().center()
        entering = QDragEnterEvent(middle, action, mime, LEFT, NO_MODIFIER)
        QApplication.sendEvent(self._window, entering)
        if entering.isAccepted():
            drop = QDropEvent(QPointF(middle), action, mime, LEFT, NO_MODIFIER, QEvent.Type.Drop)
            QApplication.sendEvent(self._window, drop)
        return "drops a folder"

    def _lock(self) -> str:
        """As if nobody had worked here for five minutes."""
        self._window.idle._idle_s += 1000.0
        self._window.idle.poll()
        return "stays away for five minutes"

    def _drag(self) -> str:
        controls = self.controls()
        if not controls:
            return "nothing to drag"
        one = self._chance.choice(controls)
        at = one.rect().center()
        QTest.mousePress(one, LEFT, NO_MODIFIER, at)
        for _ in range(3):
            at += QPoint(self._chance.randrange(-60, 60), self._chance.randrange(-60, 60))
            if QApplication.activePopupWidget() is None:
                QTest.mouseMove(one, at)
        QTest.mouseRelease(one, LEFT, NO_MODIFIER, at)
        return f"drags {type(one).__name__}"


def _edits_files(popup: QWidget) -> bool:
    """Whether it is a menu of a file dialog."""
    return isinstance(popup, QMenu) and isinstance(QApplication.activeModalWidget(), QFileDialog)

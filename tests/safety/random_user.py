"""A user gone wild: mostly what leads a session on, now and then anything that a hand on keys and mouse can do."""

import random
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QEvent, QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent, QInputMethodEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QApplication,
    QComboBox,
    QDialog,
    QFileDialog,
    QLineEdit,
    QMenu,
    QPlainTextEdit,
    QScrollArea,
    QWidget,
)

from app.settings import Scheme
from tests.safety.hostile_names import SEEDS

if TYPE_CHECKING:
    from app.main_window import MainWindow
    from app.wizard.wizard import Wizard

OPERATOR, PASSPHRASE = "rk", "seven quiet herons cross"
SENSIBLE = 0.85
CONTROLS = (QAbstractButton, QComboBox, QLineEdit, QPlainTextEdit, QAbstractItemView, QAbstractSlider)
NO_MODIFIER = Qt.KeyboardModifier.NoModifier
CTRL, SHIFT, ALT = (
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.AltModifier,
)
LEFT, RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton
Key = Qt.Key
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
LONGEST_TYPED = 60  # letters, key by key
WALK_STEPS = (10, 40)  # of the user's, while a walk is recorded
COMMENTS = ("Walks further than in spring.", "The left foot drags.", "New socket since Monday.")


class RandomUser:
    """Each `act` does one thing and says in words what it was.

    Parameters
    ----------
    place
        A folder of the user's own, with session folders to import and room for what is saved.
    """

    def __init__(self, window: "MainWindow", chance: random.Random, place: Path) -> None:
        self._window, self._chance, self._place = window, chance, place
        self._saved = self._waits = 0
        self._last_saved: Path | None = None
        self.did: Callable[[str], None] = print
        self.recovery_key = ""

    def act(self) -> str:
        popup, modal = QApplication.activePopupWidget(), QApplication.activeModalWidget()
        if popup is not None:
            return self._answer_popup(popup)
        if modal is not None and modal is not self._window:
            return self._answer_dialog(modal)
        if QApplication.activeWindow() is not self._window:
            self._window.activateWindow()  # without a desktop nobody does that when a dialog is closed
            return "comes back to the window"
        return self._sensible() if self._chance.random() < SENSIBLE else self._wild()

    def controls(self, front: QWidget | None = None) -> list[QWidget]:
        """What can be pressed or typed into now, and is in sight or can be scrolled there."""
        front = front or QApplication.activeModalWidget() or self._window
        found = [widget for kind in CONTROLS for widget in front.findChildren(kind)]
        return [one for one in found if one.isVisible() and one.isEnabled() and one.width() > 0]

    # hands

    def click(self, widget: QWidget, *, button: Qt.MouseButton = LEFT, is_double: bool = False) -> None:
        """Scroll to it as a hand would, and press what is there: something may lie over it."""
        _bring_into_sight(widget)
        shown = widget.visibleRegion().boundingRect()
        if shown.isEmpty():
            return
        at = widget.mapTo(widget.window(), shown.center())
        target = widget.window().childAt(at) or widget
        press = QTest.mouseDClick if is_double else QTest.mouseClick
        press(target, button, NO_MODIFIER, target.mapFrom(widget.window(), at))

    def press(self, key: Qt.Key, modifier: Qt.KeyboardModifier = NO_MODIFIER) -> None:
        QTest.keyClick(QApplication.focusWidget() or self._window, key, modifier)

    def type_into(self, line: QWidget, text: str) -> None:
        self.click(line)
        if QApplication.focusWidget() is line:
            self.press(Key.Key_A, CTRL)
            if len(text) <= LONGEST_TYPED and text.isascii() and text.isprintable():
                QTest.keyClicks(line, text)
            else:  # at once, as it is pasted or an input method gives it
                self.press(Key.Key_Delete)
                event = QInputMethodEvent("", [])
                event.setCommitString(text.encode("utf-8", "ignore").decode())
                QApplication.sendEvent(line, event)

    def press_named(self, words: str, front: QWidget | None = None) -> bool:
        for one in self.controls(front):
            name = one.accessibleName() or (one.text() if isinstance(one, QAbstractButton) else "")
            if name.replace("&", "").startswith(words):
                self.click(one)
                return True
        return False

    # what leads on

    def _sensible(self) -> str:
        screen: Any = self._window.screens.currentWidget()
        name = type(screen).__name__
        deed = {
            "FirstStartPage": self._on_first_start,
            "LogInPage": self._on_log_in,
            "Home": self._on_home,
            "Wizard": self._on_wizard,
            "HelpPage": self._on_help,
            "SessionScreen": self._on_session_screen,
        }.get(name)
        said = deed(screen) if deed is not None else "waits"
        return f"{name}: {said}"

    def _on_first_start(self, page: Any) -> str:
        if page.typed.isVisible():
            self.recovery_key = "-".join(page._key_words.text().split())
            self.type_into(page.typed.line_edit, self.recovery_key)
            self.press(Key.Key_Return)
            return "types the key back"
        if not page.make.isEnabled():
            return "waits"
        texts = (OPERATOR, "R. Keys", PASSPHRASE, PASSPHRASE)
        for field, text in zip((page.code, page.name, page.passphrase, page.again), texts, strict=True):
            self.type_into(field.line_edit, text)
        self.click(page.make)
        return "makes the library"

    def _on_log_in(self, page: Any) -> str:
        if not page.go.isEnabled():
            return "waits"
        if page.recovery_key.isVisible():
            self.click(page.use_recovery)
            return "goes back to the passphrase"
        if page.operator.isVisible() and page.operator.isEnabled() and page.code != OPERATOR:
            page.operator.setCurrentIndex(max(page.operator.findData(OPERATOR), 0))
        self.type_into(page.passphrase.line_edit, PASSPHRASE)
        self.press(Key.Key_Return)
        return "logs in"

    def _on_home(self, home: Any) -> str:
        from app.pages.home_page import HomePage
        from app.pages.import_page import ImportPage

        page = home.current
        if isinstance(page, ImportPage):
            if not page.code.text.strip() or self._chance.random() < 0.3:
                self.type_into(page.code.line_edit, self._code())
            self.click(home.bar.primary)
            return "imports"
        if not isinstance(page, HomePage):
            if page is home.working:
                return "waits"
            return self._in_settings(home)
        state = self._window.desk.state
        if state is not None and state.is_demonstration and self._chance.random() < 0.1:
            self.press_named("Leave the demonstration")
            return "leaves the demonstration"
        deed = self._chance.choices(
            ("old", "new", "open", "settings", "help", "demonstration", "import", "search", "delete", "undo", "theme"),
            (40, 25, 25, 3, 2, 1, 3, 3, 2, 2, 1),
        )[0]
        if deed == "old" and home._patient is not None:
            for _ in range(self._chance.randrange(4)):
                page.patients.step(self._chance.choice((-1, 1)))
            self.click(home.bar.primary)
            self.did("session begun")
        elif deed == "new" or deed == "old":
            self.press(Key.Key_N, CTRL)
            self.did("session begun")
        elif deed == "open":
            self._click_row(page.sessions)
        elif deed == "settings":
            self.press_named("Settings")
        elif deed == "help":
            self.press(Key.Key_F1)
        elif deed == "demonstration":
            self.press_named("Open demonstration")
        elif deed == "import":
            self.press_named("Import recordings")
        elif deed == "search":
            self.type_into(page.search, self._chance.choice(("demo", "1", "", "", "knee")))
        elif deed == "delete":
            self.press_named("Delete")
        elif deed == "undo":
            self.press(Key.Key_Z, CTRL)
        elif deed == "theme":
            self.press_named("Light or dark")
        return deed

    def _in_settings(self, home: Any) -> str:
        if self._chance.random() < 0.4:
            self.press(Key.Key_Escape)
            return "leaves the settings"
        controls = self.controls(home.current)
        one = self._chance.choice(controls) if controls else None
        if one is None:
            return "waits"
        words = one.text() if isinstance(one, QAbstractButton) else one.accessibleName()
        if isinstance(one, QLineEdit):
            self.type_into(one, self._chance.choice(("M. Muster", "mm", "quiet brown geese fly")))
        else:
            self.click(one)
        return f"sets {words!r}"

    def _on_wizard(self, wizard: "Wizard") -> str:
        visit = wizard.visit
        if visit is None or wizard.current is None:
            return "waits"
        if wizard.shell.banner.isVisible() and self._chance.random() < 0.3:
            self.press_named("Dismiss", wizard)
            return "dismisses the banner"
        if self._chance.random() < 0.004:
            self.press_named("All patients", wizard)
            return "goes to all patients"
        step = type(wizard.current).__name__
        deeds: dict[str, Callable[[Wizard], str]] = {
            "PatientStep": self._on_patient,
            "SensorsStep": self._on_sensors,
            "StandStillStep": self._on_stand_still,
            "FreeMotionStep": self._on_free_motion,
            "WalkingStep": self._on_walking,
            "ResultsStep": self._on_results,
            "ReportStep": self._on_report,
        }
        return f"{step} {deeds[step](wizard)}"

    def _on_patient(self, wizard: "Wizard") -> str:
        page: Any = wizard.current.page if wizard.current is not None else None
        if page._taken.isVisible():
            if self._chance.random() < 0.5:
                self.click(page._taken.open)
                return "opens the one that is there"
            self.type_into(page.code.line_edit, self._code())
            return "types another code"
        if not page.code.text.strip():
            self.type_into(page.code.line_edit, self._code())
            return "types a code"
        if self._chance.random() < 0.6:
            return self._tell_of_patient(page)
        self._primary(wizard)
        return "goes on"

    def _tell_of_patient(self, page: Any) -> str:
        field, text = self._chance.choice(
            (
                (page.birth_year, str(self._chance.randrange(1925, 2015))),
                (page.height_cm, f"{self._chance.uniform(120, 205):.1f}"),
                (page.mass_kg, f"{self._chance.uniform(30, 130):.1f}"),
                (page.device, self._chance.choice(("knee K2", "foot, carbon", ""))),
            )
        )
        if self._chance.random() < 0.5:
            buttons = [*page.sex.segments, *page.side.segments, *page.limb.segments, *page.aids.buttons]
            self.click(self._chance.choice([one for one in buttons if one.isVisible() and one.isEnabled()]))
            return "ticks"
        self.type_into(field.line_edit, text)
        return f"types {text!r}"

    def _on_sensors(self, wizard: "Wizard") -> str:
        visit = wizard.visit
        page: Any = wizard.current.page if wizard.current is not None else None
        assert visit is not None
        sensors = visit.sensors
        if sensors.is_searching:
            return "waits"
        if sensors.acquisition is None:
            if not visit.choices or self._chance.random() < 0.05:
                self.press(Key.Key_Left, ALT)  # nothing simulated for a real patient: another code, or away
                if self._chance.random() < 0.5:
                    self.press_named("All patients", wizard)
                return "goes away"
            self.press_named(visit.choices[0].name, page)
            return "chooses the sensors"
        if (not sensors.site_of and not sensors.is_left_to_motion) or self._chance.random() < 0.1:
            if self._chance.random() < 0.4:
                self.press_named("Movement decides", page)
                return "leaves it to the movement"
            self._place_by_digits(page)
            return "places the sensors"
        self._primary(wizard)
        return "goes on"

    def _place_by_digits(self, page: Any) -> None:
        """Each sensor's place by its figure; once in a while a wrong one, or one less."""
        from core.body import Site

        places = {str(site): number for number, site in enumerate(Site, 1)}
        for name, row in tuple(page.list.rows.items()):
            right = next((number for site, number in places.items() if site in name), 1)
            number = right if self._chance.random() < 0.97 else self._chance.randrange(1, 7)
            self.click(row)
            self.press(Qt.Key(Key.Key_0 + number))

    def _on_stand_still(self, wizard: "Wizard") -> str:
        if self._waits > 0:
            self._waits -= 1
            return "waits"
        chance = self._chance.random()
        page: Any = wizard.current.page if wizard.current is not None else None
        if chance < 0.05:
            self.press_named("Cannot stand", page) or self.press_named("The patient can", page)
            return "says who can stand"
        if chance < 0.15:
            fields = [one for one in self.controls(page) if isinstance(one, QLineEdit)]
            if fields:
                self.type_into(self._chance.choice(fields), self._chance.choice(("5", "-10", "", "0")))
                return "types a zero"
        self.press(Key.Key_Space)
        self._waits = 10
        return "starts the count"

    def _on_free_motion(self, wizard: "Wizard") -> str:
        if self._waits > 0:
            self._waits -= 1
            return "waits"
        self._waits = 12
        page: Any = wizard.current.page if wizard.current is not None else None
        if self._chance.random() < 0.3:
            buttons = [one for one in self.controls(page) if isinstance(one, QAbstractButton)]
            if buttons:
                self.click(self._chance.choice(buttons))
                return "answers what is asked"
        self._primary(wizard)
        return "goes on"

    def _on_walking(self, wizard: "Wizard") -> str:
        visit = wizard.visit
        assert visit is not None
        takes = visit.takes
        if takes.is_stopping:
            return "waits"
        if takes.is_recording:
            if self._waits > 0:
                self._waits -= 1
                return "lets walk"
            self.press(Key.Key_Space)
            self.did("walk recorded")
            return "stops the walk"
        step: Any = wizard.current
        if step._asked is not None:
            key = self._chance.choices((Key.Key_K, Key.Key_D, Key.Key_Space), (6, 2, 2))[0]
            self.press(key)
            return "answers whether it is kept"
        kept = sum(take.told.is_kept for take in takes.walks)
        if kept and self._chance.random() < 0.3 + 0.1 * kept:
            self._primary(wizard)
            return "goes to the results"
        if self._chance.random() < 0.3:
            self.press(Qt.Key(Key.Key_1 + self._chance.randrange(5)))
            return "chooses a label"
        if self._chance.random() < 0.02:
            page: Any = step.page
            self.click(page.walks.restrapped)
            return "straps anew"
        self.press(Key.Key_Space)
        self._waits = self._chance.randrange(*WALK_STEPS)
        return "starts a walk"

    def _on_results(self, wizard: "Wizard") -> str:
        page: Any = wizard.current.page if wizard.current is not None else None
        front = page.currentWidget()
        if type(front).__name__ == "WorkingPage":
            return "waits"
        chance = self._chance.random()
        if chance < 0.15:
            self._primary(wizard)
            self.did("results seen")
            return "goes to the report"
        if chance < 0.2:
            self.press_named("Correct", wizard)
            return "corrects"
        if chance < 0.25:
            self.press(Key.Key_Z, CTRL)
            return "takes back"
        controls = self.controls(front)
        if not controls:
            self._primary(wizard)
            return "goes on"
        one = self._chance.choice(controls)
        if isinstance(one, QLineEdit):
            self.type_into(one, self._chance.choice(("alignment B", "barefoot", "slow, with stick")))
            self.press(Key.Key_Return)
            return "types a condition"
        self.click(one)
        return f"presses {one.accessibleName() or type(one).__name__!r}"

    def _on_report(self, wizard: "Wizard") -> str:
        step: Any = wizard.current
        if step._is_saving:
            return "waits"
        if step._saved not in (None, self._last_saved):
            self._last_saved = step._saved
            self.did("report saved")
        chance = self._chance.random()
        report = step.page.report
        if chance < 0.3 and report.isVisible():
            report.comment.setFocus()
            QTest.keyClicks(report.comment, self._chance.choice(COMMENTS))
            return "comments"
        if chance < 0.55:
            self.press(Key.Key_S, CTRL)
            return "saves"
        if chance < 0.7 and report.isVisible():
            buttons = [one for one in self.controls(report) if isinstance(one, QAbstractButton)]
            if buttons:
                self.click(self._chance.choice(buttons))
            return "chooses what is written"
        if chance < 0.85:
            self.press_named("All patients", wizard)
            return "goes to all patients"
        self.press(Qt.Key(Key.Key_1 + self._chance.randrange(6)), CTRL)
        return "goes to another step"

    def _on_help(self, page: Any) -> str:
        if self._chance.random() < 0.6:
            self.press(Key.Key_Escape)
            return "goes back"
        controls = self.controls(page)
        if controls:
            self.click(self._chance.choice(controls))
        return "reads"

    def _on_session_screen(self, page: Any) -> str:
        if page.is_working and self._chance.random() < 0.9:
            return "waits"
        if self._chance.random() < 0.3:
            self.press(Key.Key_Escape)
            return "leaves"
        controls = self.controls(page)
        if controls:
            self.click(self._chance.choice(controls))
        return "looks round"

    def _primary(self, wizard: "Wizard") -> None:
        if self._chance.random() < 0.5 and wizard.shell.bar.primary.isVisible():
            self.click(wizard.shell.bar.primary)
        else:
            self.press(Key.Key_Return)

    def _code(self) -> str:
        return f"{self._chance.choices(('DEMO-', 'P-'), (9, 1))[0]}{self._chance.randrange(1, 7)}"

    def _click_row(self, view: QAbstractItemView) -> None:
        model = view.model()
        if view.isVisible() and model.rowCount():
            index = model.index(self._chance.randrange(model.rowCount()), 0)
            view.scrollTo(index)
            QTest.mouseClick(view.viewport(), LEFT, NO_MODIFIER, view.visualRect(index).center())
            self.did("session opened")

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
        state = self._window.desk.state
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


def _bring_into_sight(widget: QWidget) -> None:
    parent = widget.parentWidget()
    while parent is not None:
        if isinstance(parent, QScrollArea):
            parent.ensureWidgetVisible(widget, 0, 0)
        parent = parent.parentWidget()

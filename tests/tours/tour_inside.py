"""The application's side of a tour: it opens as always, and reports on a pipe what is on its screen.

Started by `tour.py`.
"""

import json
import sys
import threading
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    from PySide6.QtGui import QPixmap
    from PySide6.QtWidgets import QWidget

CORNER = (20, 30)  # of the window on the display
SETTLE_MS = 150


def run() -> int:
    """Open the window as always, and answer whoever leads the tour."""
    if getattr(sys, "frozen", False):  # into the folder that is installed: `installers/gaitwright.spec`
        from app.__main__ import begin_frozen

        begin_frozen()
    else:
        sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    from PySide6.QtCore import QObject, Qt, Signal

    from app.main_window import open_window

    class Guide(QObject):
        """Receives commands from a thread that reads, and answers on the screen's."""

        asked = Signal(str)

        def listen(self, commands: IO[str]) -> None:
            for command in commands:
                self.asked.emit(command.strip())

    guide = Guide()
    guide.asked.connect(_answer, Qt.ConnectionType.QueuedConnection)
    threading.Thread(target=guide.listen, args=(sys.stdin,), name="tour", daemon=True).start()
    return open_window([])


def _answer(command: str) -> None:
    from PySide6.QtWidgets import QApplication

    from app.main_window import MainWindow

    windows = [widget for widget in QApplication.topLevelWidgets() if isinstance(widget, MainWindow)]
    window = next(widget for widget in windows if widget.isVisible())
    verb, *rest = command.split()
    reported: dict[str, Any] = {}
    match verb:
        case "begin":
            window.move(*CORNER)
            window.activateWindow()
        case "look":
            _take_look(window, *rest)
        case "speak":
            window._settings.language = rest[0]  # the window is made again in it
        case "picture":
            _picture_of(window).save(rest[0])
            for patients in _patients_windows():
                patients.grab().save(rest[0].replace(".png", "-patient.png"))
        case "tell":
            reported = _look_at(window)
        case "end":
            window.close()
    print(f"tour: {json.dumps(reported)}", flush=True)


def _take_look(window: Any, theme: str, size: str) -> None:
    """Show the window in this theme and size, and let it settle."""
    from app.theme.current import current_theme, set_dark, set_scale

    side, scale = size.split("@")
    width, height = (int(one) for one in side.split("x"))
    if (current_theme().is_dark, current_theme().scale) != (theme == "dark", int(scale) / 100):
        set_dark(theme == "dark")
        set_scale(int(scale) / 100)
    if (window.width(), window.height()) != (width, height):
        window.resize(width, height)
        _settle()
    _settle()


def _settle() -> None:
    from PySide6.QtCore import QEventLoop, QTimer

    loop = QEventLoop()
    QTimer.singleShot(SETTLE_MS, loop.quit)
    loop.exec()


def _picture_of(window: Any) -> "QPixmap":
    """What is in sight, an open dialog over the window included."""
    from PySide6.QtGui import QPainter
    from PySide6.QtWidgets import QApplication

    picture: QPixmap = window.grab()
    dialog = QApplication.activeModalWidget()
    if dialog is not None:
        painter = QPainter(picture)
        painter.drawPixmap(window.mapFromGlobal(dialog.mapToGlobal(dialog.rect().topLeft())), dialog.grab())
        painter.end()
    return picture


def _patients_windows() -> "list[QWidget]":
    from PySide6.QtWidgets import QApplication

    from app.patient_screen.window import PatientWindow

    return [one for one in QApplication.topLevelWidgets() if isinstance(one, PatientWindow) and one.isVisible()]


def _look_at(window: Any) -> dict[str, Any]:
    from PySide6.QtWidgets import (
        QAbstractButton,
        QAbstractItemView,
        QApplication,
        QComboBox,
        QLabel,
        QLineEdit,
        QWidget,
    )

    from app.wording.translation import spoken_language

    language = spoken_language()

    def read(stated: str) -> tuple[str, ...]:
        if language == "en":  # as always in the installed folder, which has neither catalogues to read nor their reader
            return (stated,)
        from tests.tours.tour_words import in_english

        return in_english(stated, language)

    screen = window.screens.currentWidget()
    step = getattr(screen, "current", None)
    visit = getattr(screen, "visit", None)
    focus = QApplication.focusWidget()
    front = QApplication.activeModalWidget() or window
    controls: dict[str, tuple[int, int]] = {}
    words: list[str] = []
    for widget in front.findChildren(QWidget):
        if not widget.isVisible():
            continue
        if isinstance(widget, QLabel):
            words.extend(read(widget.text()))
        elif isinstance(widget, QAbstractButton | QComboBox | QLineEdit | QAbstractItemView):
            seen = widget.visibleRegion().boundingRect()
            if (name := _name_of(widget)) and widget.isEnabled() and not seen.isEmpty():
                middle = widget.mapToGlobal(seen.center())
                for meant in read(name):
                    controls.setdefault(meant, (middle.x(), middle.y()))
        elif widget.accessibleName():
            words.extend(read(widget.accessibleName()))
    for patients in _patients_windows():
        words.extend(read(patients.accessibleName()))
    return {
        "screen": type(screen).__name__,
        "step": type(step).__name__ if step is not None else "",
        "focus": read(_name_of(focus)) if focus is not None else (),
        "is_recording": bool(getattr(screen, "is_recording", False)),
        "banner": next((b.text for b in _banners(window) if b.isVisible()), ""),
        "stopwatch_s": (visit.elapsed_s or 0.0) if visit is not None else 0.0,
        "words": words,
        "controls": controls,
    }


def _name_of(widget: "QWidget") -> str:
    """By its accessible name, or as a native dialog's button is read."""
    from PySide6.QtWidgets import QAbstractButton

    stated = widget.text().replace("&", "") if isinstance(widget, QAbstractButton) else ""
    return widget.accessibleName() or stated


def _banners(window: "QWidget") -> list[Any]:
    from app.widgets.banner import Banner

    return list(window.findChildren(Banner))


if __name__ == "__main__":
    sys.exit(run())

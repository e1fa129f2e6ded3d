"""One life of the window under a random user: from its start until it is closed, or killed.

    python -m tests.safety.random_life PLACE --seed 1/1 --seconds 60 --end close

PLACE holds the library, the user's settings and folders; `random_keys` makes it. Each line of the output is JSON:
`did` counts what was reached, `fault` is what must not be, with the step and what was done before it.
"""

import faulthandler
import gc
import json
import logging
import os
import random
import signal
import sys
import threading
import time
import traceback
from collections import deque
from pathlib import Path
from types import TracebackType
from typing import Any

os.environ["QT_QPA_PLATFORM"] = "offscreen"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import sqlcipher3.dbapi2 as sqlite
from PySide6.QtCore import QMessageLogContext, QObject, Qt, QTimer, QtMsgType, qInstallMessageHandler
from PySide6.QtGui import QDrag
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QComboBox, QLabel, QWidget

from app.main_window import MainWindow
from app.storage.keys import KeyRefusedError, KeySlots
from app.storage.layout import KEYS
from app.storage.opened import OpenedLibrary
from tests.app.watchdog import Watchdog
from tests.driver import options
from tests.safety.random_user import RandomUser
from tests.safety.random_visits import OPERATOR, PASSPHRASE
from tests.safety.said_and_held import HeldLibrary, contradictions, left_open
from tests.safety.window_material import application, fast_patient, offer, window_in

SPEED = 20.0
PAUSE_MS = (10, 120)
CHECK_EVERY = 5  # steps
SETTLES_S, SETTLES_BUSY_S = 4.0, 45.0  # what is stated and what is held may differ for so long
LOOK_AGAIN_MS = 250
HELD_UP_S = 2.0  # of the thread that draws
HANGS_S = 90.0  # without a step: then all threads are reported, and the life ends
STALE_STEPS, STALE_S = 150, 20.0  # with nothing new on the screen: then every control is tried
WAY_OUT_S = 120.0  # a page on which nothing can be pressed may stay for so long, on a busy machine
REMEMBERED = 25  # steps reported with a fault
NOISE = ("This plugin does not support",)  # offscreen's own
ENDS = ("close", "kill")


class RandomLife(QObject):
    """Lets the user act, and looks at what came of it. All of it happens on the screen's thread."""

    def __init__(self, window: MainWindow, user: RandomUser, dog: Watchdog, chance: random.Random, end: str) -> None:
        super().__init__()
        self._window, self._user, self._dog, self._chance, self._end = window, user, dog, chance, end
        self.shows = False
        self._number = self._nested = self._late_reported = self._compared = 0
        self._is_acting = self._is_over = self._has_library_answered = False
        self._before: deque[str] = deque(maxlen=REMEMBERED)
        self._reported: set[str] = set()
        self._doubts: set[str] = set()
        self._doubted_s = 0.0
        self._seen = ""
        self._stale, self._stale_since_s = 0, 0.0
        self._to_try: list[QWidget] | None = None
        self._shut_since_s: float | None = None
        self._held_now: tuple[OpenedLibrary, HeldLibrary] | None = None
        user.did = self.count

    def count(self, what: str) -> None:
        print(json.dumps({"did": what}), flush=True)

    def fault(self, kind: str, what: str) -> None:
        if (key := f"{kind} {what[-300:]}") not in self._reported:
            self._reported.add(key)
            screen, home = self._window.screens.currentWidget(), self._window.home
            seen = {"page": type(screen).__name__, "home says": "" if home is None else home.banner.text}
            reported = {"fault": kind, "step": self._number, "what": what, **seen, "before": list(self._before)}
            print(json.dumps(reported), flush=True)

    def step(self) -> None:
        """Do one thing, or look again; the next step is asked for first, for a menu has a loop of its own."""
        if self._is_over:
            return
        faulthandler.dump_traceback_later(HANGS_S, exit=True)
        waits_ms = LOOK_AGAIN_MS if self._doubts else self._chance.randint(*PAUSE_MS)
        QTimer.singleShot(waits_ms, self, self.step)
        if self._is_acting and self._leaves_alone():
            return
        was_acting, self._is_acting = self._is_acting, True
        try:
            self._act()
        except Exception:
            self.fault("exception in a step", traceback.format_exc())
        finally:
            self._is_acting = was_acting

    def _leaves_alone(self) -> bool:
        """Whether an inner loop has nothing that could be answered: what is dragged is let go after a while."""
        if QApplication.activePopupWidget() is not None or QApplication.activeModalWidget() is not None:
            self._nested = 0
            return False
        self._nested += 1
        if self._nested % 5 == 0:
            QDrag.cancel()
            QTest.mouseRelease(self._window, Qt.MouseButton.LeftButton)
        return True

    def _act(self) -> None:
        self._number += 1
        if self._number % CHECK_EVERY == 0 or self._doubts:
            with self._dog.paused():
                self._compare()
            if self._doubts:
                return  # hands off, until it is settled
        for late in self._dog.late[self._late_reported :]:
            if late.busy_s + late.waited_s > HELD_UP_S:
                self.fault("held up", str(late))
        self._late_reported = len(self._dog.late)
        if self._to_try is not None:
            self._try_next()
        else:
            self._remember(self._user.act())
        self._look()

    def _remember(self, deed: str) -> None:
        if self._before and self._before[-1].endswith(f": {deed}"):
            self._before.pop()  # the last of many alike is enough
        self._before.append(f"{self._number}: {deed}")
        if self.shows:
            print(f"{self._number}: {deed}", file=sys.stderr, flush=True)

    # what the screen states

    def _compare(self) -> None:
        if QApplication.activeModalWidget() is not None or self._window.is_covered or (held := self._held()) is None:
            self._doubts.clear()
            return
        try:
            now = set(contradictions(self._window, held)) | set(self._left_open(held))
        except sqlite.OperationalError as refusal:  # the program is just opening or closing it
            now = {f"the library cannot be read beside: {refusal}"}
        self._compared += 1
        if not self._doubts:
            self._doubts, self._doubted_s, self._has_library_answered = now, time.monotonic(), False
            if now:
                self._window.controller.run(lambda _opened: None, self._on_library_answered, None, self)
            return
        self._doubts &= now
        waited_s = time.monotonic() - self._doubted_s
        if self._doubts and waited_s > (SETTLES_BUSY_S if self._is_busy() else SETTLES_S):
            for one in self._doubts:  # what is stated before the library was received is not so either
                self.fault("contradiction" if self._has_library_answered else "said too early", one)
            self._doubts.clear()

    def _on_library_answered(self, _nothing: object) -> None:
        self._has_library_answered = True

    def _left_open(self, held: HeldLibrary) -> list[str]:
        wizard = self._window.wizard
        visits = [] if wizard is None else [*wizard._closing, *([wizard.visit] if wizard.visit is not None else [])]
        return [] if any(not visit.recordings.is_idle for visit in visits) else left_open(held)

    def _is_busy(self) -> bool:
        wizard = self._window.wizard
        visit = wizard.visit if wizard is not None else None
        is_long = self._window.controller._long.is_busy
        if visit is None:
            return is_long
        return is_long or visit.evaluation.is_busy or not visit.recordings.is_idle or visit.sensors.is_searching

    def _held(self) -> HeldLibrary | None:
        """The open library's, while there is one whose key the user knows."""
        state = self._window.controller.state
        if state is None:
            return None
        folder = state.library.folder
        if self._held_now is None or self._held_now[0] is not state.library:  # opened again: it may have another key
            data_key = None
            if not state.is_demonstration:
                try:
                    data_key = KeySlots(folder / KEYS).open(OPERATOR, PASSPHRASE)
                except KeyRefusedError:
                    return None  # the user has changed the passphrase
            self._held_now = state.library, HeldLibrary(folder, data_key)
        return self._held_now[1]

    # whether there is a way on

    def _look(self) -> None:
        controls = self._user.controls()
        if any(isinstance(one, QAbstractButton) for one in controls) or QApplication.activePopupWidget() is not None:
            self._shut_since_s = None
        else:
            self._shut_since_s = self._shut_since_s or time.monotonic()
            if time.monotonic() - self._shut_since_s > WAY_OUT_S:
                self.fault("dead end", f"nothing can be pressed on {self._where()}")
                self._shut_since_s = None
        seen = self._signature(controls)
        if seen != self._seen or self._shut_since_s is not None:
            self._seen, self._stale, self._stale_since_s, self._to_try = seen, 0, time.monotonic(), None
            return
        self._stale += 1
        is_stale = self._stale > STALE_STEPS and time.monotonic() - self._stale_since_s > STALE_S
        if self._to_try is None and is_stale:
            self._to_try = [one for one in controls if isinstance(one, QAbstractButton | QComboBox)]

    def _try_next(self) -> None:
        assert self._to_try is not None
        if self._to_try:
            one = self._to_try.pop()
            if one.isVisible() and one.isEnabled():
                self._user.click(one)
            self._remember(f"tries {one.accessibleName() or type(one).__name__!r}")
            return
        self.fault("dead end", f"whatever is pressed, nothing changes on {self._where()}")
        self._to_try, self._stale = None, 0

    def _signature(self, controls: list[QWidget]) -> str:
        """What is on the screen but for figures, which change by themselves."""
        front = QApplication.activeModalWidget() or self._window
        labels = [one.text() for one in front.findChildren(QLabel) if one.isVisible()]
        names = [f"{one.accessibleName()} {_state(one)}" for one in controls]
        whole = "|".join([self._where(), *labels, *names, f"{front.size()}"])
        return "".join(letter for letter in whole if not letter.isdigit())

    def _where(self) -> str:
        screen: Any = self._window.screens.currentWidget()
        current = getattr(screen, "current", None)
        modal = QApplication.activeModalWidget()
        return f"{type(screen).__name__} {type(current).__name__} {type(modal).__name__ if modal else ''}"

    # the end

    def finish(self) -> None:
        """Close the window as a user does, or be killed."""
        for what, count in (("steps", self._number), ("comparisons", self._compared)):
            print(json.dumps({"did": what, "count": count}), flush=True)
        if self._end == "kill":
            self.count("killed")
            os.kill(os.getpid(), signal.SIGKILL)
        self._is_over = True
        faulthandler.cancel_dump_traceback_later()
        for widget in filter(None, (QApplication.activePopupWidget(), QApplication.activeModalWidget())):
            widget.close()
        self._window.close()
        QApplication.quit()


def _state(widget: QWidget) -> str:
    if isinstance(widget, QAbstractButton):
        return f"{widget.text()} {widget.isChecked()}"
    return widget.currentText() if isinstance(widget, QComboBox) else ""


class _LoudLog(logging.Handler):
    def __init__(self, life: RandomLife) -> None:
        super().__init__(logging.ERROR)
        self._life = life

    def emit(self, record: logging.LogRecord) -> None:
        trace = "".join(traceback.format_exception(*record.exc_info)) if record.exc_info else ""
        self._life.fault("logged", f"{record.name}: {record.getMessage()}\n{trace}")


def listen(life: RandomLife) -> None:
    """Let whatever goes wrong anywhere in the program be a fault of this life."""

    def hook(kind: type[BaseException], error: BaseException | None, trace: TracebackType | None) -> None:
        life.fault("exception", "".join(traceback.format_exception(kind, error, trace)))

    def unraisable(reported: Any) -> None:
        life.fault(
            "unraisable",
            "".join(traceback.format_exception(reported.exc_type, reported.exc_value, reported.exc_traceback)),
        )

    def qt_stated(kind: QtMsgType, _context: QMessageLogContext, message: str) -> None:
        if kind not in (QtMsgType.QtDebugMsg, QtMsgType.QtInfoMsg) and not message.startswith(NOISE):
            life.fault("Qt warns", f"{message}\n{''.join(traceback.format_stack(limit=12))}")

    sys.excepthook = hook
    sys.unraisablehook = unraisable
    threading.excepthook = lambda reported: hook(reported.exc_type, reported.exc_value, reported.exc_traceback)
    qInstallMessageHandler(qt_stated)
    logging.getLogger().addHandler(_LoudLog(life))


def main() -> int:
    required = options(
        __doc__,
        place=Path,
        seed="1/1",
        seconds=60.0,
        end={"choices": ENDS, "default": "close"},
        tell={"dest": "show_message", "action": "store_true", "help": "write every step to the standard error"},
    )
    faulthandler.enable()
    offer("fast", fast_patient(speed=SPEED))
    made = application()
    chance = random.Random(required.seed)
    window = window_in(made, required.place / "library")
    dog = Watchdog()
    user = RandomUser(window, chance, required.place)
    life = RandomLife(window, user, dog, chance, required.end)
    life.shows = required.show_message
    listen(life)
    window.activateWindow()
    window.prepare()
    dog.start()
    QTimer.singleShot(0, life, life.step)
    QTimer.singleShot(round(1000 * required.seconds), life, life.finish)
    made.exec()
    faulthandler.dump_traceback_later(HANGS_S, exit=True)
    dog.stop()
    window.finish()
    longest_s = max((late.busy_s + late.waited_s for late in dog.late), default=0.0)
    print(json.dumps({"did": "closed", "longest_held_up_s": longest_s}), flush=True)
    gc.collect()
    return 0


if __name__ == "__main__":
    sys.exit(main())

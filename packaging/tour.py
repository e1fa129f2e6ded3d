"""Walk through a whole session as a user would, with real keys or a real mouse: `python packaging/tour.py OUT`.

Starts the application on a display of its own (Xvfb with openbox) and with a data folder of its own, which is gone
afterwards. The window is worked by xdotool alone, from outside: `--hands keys` uses no mouse, `--hands mouse` uses keys
only to type into fields. What is on the screen is told by the application's own process, and a picture of every stop is
written into OUT. It exits with 1, naming the stop, when the session cannot be led to its end.

To change the tour change `STOPS`: each waits until the screen says what it should, takes a picture and acts.
"""

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

    from PySide6.QtWidgets import QWidget

ROOT = Path(__file__).resolve().parents[1]
PROGRAMS = {"Xvfb": "xvfb", "openbox": "openbox", "xdotool": "xdotool"}  # and Debian's package of each
SCREEN = "1920x1200x24"
WINDOW = (1280, 800)
LOOK_EVERY_S = 0.2
PATIENCE_S = 30.0
MOST_TABS = 60  # more stops than any page has
KEY_PAUSE_S = 0.08  # between keys: nobody is faster, and what a key opens has to be there for the next


@dataclass(frozen=True, slots=True)
class Seen:
    """What the application tells of itself: screen and step by their classes, the control that has the focus, and the
    enabled controls in sight by their accessible names, each with its middle on the display."""

    screen: str
    step: str
    focus: str
    is_recording: bool
    banner: str
    words: tuple[str, ...]
    controls: Mapping[str, tuple[int, int]]

    def has(self, control: str) -> bool:
        return any(name.startswith(control) for name in self.controls)

    def says(self, words: str) -> bool:
        return any(words in text for text in self.words)


@dataclass(frozen=True, slots=True)
class Stop:
    """One place of the tour.

    Attributes
    ----------
    name
        Of its picture.
    until
        What the screen must say before anything is done.
    keys
        Pressed one after the other, as xdotool names them; "type P-1" types P-1, and "to Stop" presses Tab until a
        control whose name begins with Stop has the focus.
    clicks
        Controls that are clicked instead where the mouse has to do; the beginning of the name is enough.
    lingers_s
        Before the picture, for what moves.
    """

    name: str
    until: Callable[[Seen], bool]
    keys: tuple[str, ...] = ()
    clicks: tuple[str, ...] = ()
    lingers_s: float = 0.5
    patience_s: float = PATIENCE_S


def at_step(step: str) -> Callable[[Seen], bool]:
    return lambda seen: seen.screen == "Wizard" and seen.step == step


def offers(*controls: str) -> Callable[[Seen], bool]:
    return lambda seen: all(seen.has(control) for control in controls)


STOPS: tuple[Stop, ...] = (
    Stop("01-first-start", lambda seen: seen.screen == "FirstStartPage", ("ctrl+d",), ("Look at the demonstration",)),
    Stop("02-home", offers("New session"), ("Return",), ("New session",), lingers_s=1.0),
    Stop("03-patient", offers("Put on sensors"), ("Return",), ("Put on sensors",), lingers_s=1.0),
    Stop("04-source", at_step("SensorsStep"), ("to Simulated patient", "Return"), ("Simulated patient",)),
    Stop("05-sensors", offers("Movement decides"), ("to Drag", "Right", "Right"), ("Movement decides",), lingers_s=5.0),
    Stop("06-placed", offers("Stand still"), ("to Stand still", "Return"), ("Stand still",), lingers_s=1.0),
    Stop("07-stand-still", at_step("StandStillStep"), ("space",), ("Start the count",), lingers_s=1.0),
    Stop("08-standing", lambda seen: seen.is_recording, lingers_s=1.5),
    Stop("09-free-motion", at_step("FreeMotionStep"), lingers_s=6.0),
    Stop("09-which-leg", lambda seen: seen.says("Which one wears"), ("to Left", "Return"), ("Left",), patience_s=60.0),
    Stop("10-walking", at_step("WalkingStep"), ("space",), ("Start walk",), lingers_s=1.0, patience_s=90.0),
    Stop("11-recording", lambda seen: seen.is_recording, lingers_s=20.0),
    Stop("12-still-recording", lambda seen: seen.is_recording, ("space",), ("Stop walk",)),
    Stop("13-keep", offers("Keep"), ("k",), ("Keep",), lingers_s=1.0),
    Stop("14-kept", offers("Start"), ("ctrl+6",), ("Step 6",)),
    Stop("15-results", lambda seen: at_step("ResultsStep")(seen) and seen.has("Mean cycle"), lingers_s=2.0),
    Stop("16-report", at_step("ResultsStep"), ("ctrl+7",), ("Step 7",)),
    Stop("17-help", at_step("ReportStep"), ("F1",), ("Help",), lingers_s=1.0),
    Stop("18-manual", offers("Search the help"), ("Escape",), ("Back",), lingers_s=1.0),
    Stop("19-leave", at_step("ReportStep"), ("to Step 7", "Down", "Return"), ("All patients",)),
    Stop("20-home-again", offers("New session"), lingers_s=1.0),
)


class TourError(Exception):
    """The tour cannot go on. The message names the stop and what is on the screen."""


@dataclass(slots=True)
class Application:
    """The application in a process of its own, and what it tells."""

    process: subprocess.Popen[str]
    display: str

    def ask(self, command: str) -> dict[str, Any]:
        if self.process.stdin is None or self.process.stdout is None or self.process.poll() is not None:
            raise TourError("The application has ended.")
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()
        for line in self.process.stdout:
            if line.startswith("tour: "):
                return dict(json.loads(line.removeprefix("tour: ")))
        raise TourError("The application has ended.")

    def seen(self) -> Seen:
        told = self.ask("look")
        controls = {name: (x, y) for name, (x, y) in told.pop("controls").items()}
        return Seen(**{**told, "words": tuple(told["words"]), "controls": controls})

    def picture(self, file: Path) -> None:
        self.ask(f"picture {file}")

    def hand(self, *arguments: str) -> None:
        """Press or click for real."""
        subprocess.run(["xdotool", *arguments], env={**os.environ, "DISPLAY": self.display}, check=True)


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("out", metavar="OUT", type=Path, help="the folder for the pictures")
    parser.add_argument("--hands", choices=["keys", "mouse"], default="keys")
    parser.add_argument("--theme", choices=["light", "dark"], default="light")
    parser.add_argument("--size", type=int, nargs=2, default=WINDOW, metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)  # this is the application's process
    wanted = parser.parse_args(arguments)
    if wanted.inside:
        sys.exit(_run_inside())
    missing = [package for program, package in PROGRAMS.items() if shutil.which(program) is None]
    if missing:
        sys.exit(f"The tour needs a display and hands. Install {', '.join(missing)}, then start again.")
    wanted.out.mkdir(parents=True, exist_ok=True)
    begun_s = time.monotonic()
    with ExitStack() as stack:
        display = stack.enter_context(_display())
        application = stack.enter_context(_application(display, wanted.theme, tuple(wanted.size)))
        try:
            lead(application, wanted.out.resolve(), STOPS, uses_mouse=wanted.hands == "mouse")
        except TourError as end:
            sys.exit(str(end))
    print(f"{len(STOPS)} stops by {wanted.hands} alone in {time.monotonic() - begun_s:.0f} s. Pictures: {wanted.out}")


def lead(application: Application, out: Path, stops: Sequence[Stop], *, uses_mouse: bool) -> None:
    """Go from stop to stop.

    Raises
    ------
    TourError
        A stop was not reached in time.
    """
    for stop in stops:
        _wait_for(application, stop)
        time.sleep(stop.lingers_s)
        application.picture(out / f"{stop.name}.png")
        if uses_mouse:
            for control in stop.clicks:
                _click(application, stop, control)
        else:
            for key in stop.keys:
                _press(application, stop, key)


def _press(application: Application, stop: Stop, key: str) -> None:
    verb, _, words = key.partition(" ")
    if not words:
        application.hand("key", key)
    elif verb == "type":
        application.hand("type", "--delay", "40", words)
    else:
        for _ in range(MOST_TABS):
            if application.seen().focus.startswith(words):
                break
            application.hand("key", "Tab")
            time.sleep(KEY_PAUSE_S)
        else:
            raise TourError(f"{stop.name}: Tab never comes to “{words}”.\n{_in_words(application.seen())}")
    time.sleep(KEY_PAUSE_S)


def _wait_for(application: Application, stop: Stop) -> Seen:
    until_s = time.monotonic() + stop.patience_s
    while True:
        seen = application.seen()
        if stop.until(seen):
            return seen
        if time.monotonic() > until_s:
            raise TourError(f"{stop.name} was not reached in {stop.patience_s:.0f} s.\n{_in_words(seen)}")
        time.sleep(LOOK_EVERY_S)


def _click(application: Application, stop: Stop, control: str) -> None:
    until_s = time.monotonic() + stop.patience_s
    while True:
        found = [at for name, at in application.seen().controls.items() if name.startswith(control)]
        if found:
            x, y = found[0]
            application.hand("mousemove", str(x), str(y), "click", "1")
            time.sleep(KEY_PAUSE_S)
            return
        if time.monotonic() > until_s:
            raise TourError(f"{stop.name}: nothing to click is called “{control}”.\n{_in_words(application.seen())}")
        time.sleep(LOOK_EVERY_S)


def _in_words(seen: Seen) -> str:
    return (
        f"On the screen: {seen.screen} {seen.step}, focus on “{seen.focus}”, banner “{seen.banner}”.\n"
        f"Controls: {', '.join(seen.controls)}\nWords: {' | '.join(seen.words)}"
    )


@contextmanager
def _display() -> "Iterator[str]":
    """Give a display that nobody else uses, with a window manager."""
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", SCREEN, "-nolisten", "tcp"],
        pass_fds=[write],
        stdin=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(write)
    with ExitStack() as stack:
        stack.callback(_end, server)
        with os.fdopen(read) as number:
            display = f":{number.readline().strip()}"
        quiet = subprocess.DEVNULL
        environment = {**os.environ, "DISPLAY": display}
        manager = subprocess.Popen(["openbox", "--sm-disable"], env=environment, stdout=quiet, stderr=quiet)
        stack.callback(_end, manager)
        time.sleep(1.0)  # until it manages windows: without it nothing gets the focus
        yield display


@contextmanager
def _application(display: str, theme: str, size: tuple[int, int]) -> "Iterator[Application]":
    with tempfile.TemporaryDirectory(prefix="gaitwright-tour-") as folder:
        places = {
            name: str(Path(folder) / name.lower())
            for name in ("HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME")
        }
        environment = {**os.environ, **places, "DISPLAY": display, "QT_QPA_PLATFORM": "xcb"}
        for place in places.values():
            Path(place).mkdir()
        process = subprocess.Popen(
            [sys.executable, __file__, "--inside", "."],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        application = Application(process, display)
        try:
            application.ask(f"begin {theme} {size[0]} {size[1]}")
            yield application
            application.ask("end")
            process.wait(timeout=PATIENCE_S)
        finally:
            _end(process)


def _end(process: "subprocess.Popen[Any]") -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


# inside the application's process


def _run_inside() -> int:
    """Open the window as always, and answer whoever leads the tour."""
    sys.path.insert(0, str(ROOT))
    from PySide6.QtCore import QObject, Qt, Signal

    from app.main_window import open_window

    class Guide(QObject):
        """Hears commands from a thread that reads, and answers on the screen's."""

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

    window = next(widget for widget in QApplication.topLevelWidgets() if isinstance(widget, MainWindow))
    verb, *rest = command.split()
    told: dict[str, Any] = {}
    match verb:
        case "begin":
            window._look.set_dark(rest[0] == "dark")
            window.move(40, 40)
            window.resize(int(rest[1]), int(rest[2]))
            window.activateWindow()
        case "look":
            told = _look_at(window)
        case "picture":
            window.grab().save(rest[0])
        case "end":
            window.close()
    print(f"tour: {json.dumps(told)}", flush=True)


def _look_at(window: "QWidget") -> dict[str, Any]:
    from PySide6.QtWidgets import QAbstractButton, QAbstractItemView, QApplication, QComboBox, QLabel, QLineEdit

    screen = window.screens.currentWidget()  # type: ignore[attr-defined]  # of the main window
    step = getattr(screen, "current", None)
    focus = QApplication.focusWidget()
    controls: dict[str, tuple[int, int]] = {}
    words = []
    for widget in window.findChildren(QLabel):
        if widget.isVisible() and widget.text():
            words.append(widget.text())
    for kind in (QAbstractButton, QComboBox, QLineEdit, QAbstractItemView):
        for control in window.findChildren(kind):
            name = control.accessibleName()
            seen = control.visibleRegion().boundingRect()
            if name and control.isVisible() and control.isEnabled() and not seen.isEmpty():
                middle = control.mapToGlobal(seen.center())
                controls.setdefault(name, (middle.x(), middle.y()))
    return {
        "screen": type(screen).__name__,
        "step": type(step).__name__ if step is not None else "",
        "focus": focus.accessibleName() if focus is not None else "",
        "is_recording": bool(getattr(screen, "is_recording", False)),
        "banner": next((b.text for b in _banners(window) if b.isVisible()), ""),
        "words": words,
        "controls": controls,
    }


def _banners(window: "QWidget") -> list[Any]:
    from app.widgets.banner import Banner

    return list(window.findChildren(Banner))


if __name__ == "__main__":
    main(sys.argv[1:])

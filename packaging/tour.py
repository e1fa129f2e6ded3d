"""Walk through whole sessions as a user would, with real keys or a real mouse: `python packaging/tour.py OUT`.

Starts the application on a display of its own (Xvfb with openbox) and with a data folder of its own, which is gone
afterwards. The window is worked by xdotool alone, from outside. `--keyboard` uses no mouse: from the first start, with
a library of its own, to the saved results. `--mouse` uses keys for nothing, in the demonstration. What is on the screen
is told by the application's own process, and pictures of every stop are written into OUT, a folder for each look. It
exits with 1, naming the stop, when a session cannot be led to its end, or not in five minutes of the application's
stopwatch.

To change a tour change `KEYBOARD` or `MOUSE`: each stop waits until the screen says what it should, has its pictures
taken and acts.
"""

import argparse
import json
import os
import re
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

    from PySide6.QtGui import QPixmap
    from PySide6.QtWidgets import QWidget

ROOT = Path(__file__).resolve().parents[1]
PROGRAMS = {"Xvfb": "xvfb", "openbox": "openbox", "xdotool": "xdotool"}  # and Debian's package of each
SCREEN = "2000x1200x24"
WINDOW = "1280x800@100"
THEMES = ("light", "dark")
CORNER = (20, 30)  # of the window on the display
SETTLE_MS = 150
TRACED = ("-f", "--seccomp-bpf", "-e", "trace=connect,sendto,sendmsg,sendmmsg,bind", "-e", "signal=none")
MOST_S = 300.0  # of the application's stopwatch
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
    stopwatch_s: float
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
        Of its pictures.
    until
        What the screen must say before anything is done.
    does
        One after the other: "press Return" (keys as xdotool names them), "type P-1" ("{home}" is the tour's own
        folder), "copy key" (types the recovery key that is shown), "to Stop" (presses Tab until a control whose name
        begins with Stop has the focus), "click Stop", "drag 0A09 to L thigh".
    lingers_s
        Before the pictures, for what moves.
    """

    name: str
    until: Callable[[Seen], bool]
    does: tuple[str, ...] = ()
    lingers_s: float = 0.5
    patience_s: float = PATIENCE_S


def at(screen: str) -> Callable[[Seen], bool]:
    return lambda seen: seen.screen == screen


def at_step(step: str) -> Callable[[Seen], bool]:
    return lambda seen: seen.screen == "Wizard" and seen.step == step


def offers(*controls: str) -> Callable[[Seen], bool]:
    return lambda seen: all(seen.has(control) for control in controls)


def says(words: str) -> Callable[[Seen], bool]:
    return lambda seen: seen.says(words)


def is_recording(seen: Seen) -> bool:
    return seen.is_recording


def has_walked(strides: int) -> Callable[[Seen], bool]:
    """Whether so many strides are counted of the walk that is being recorded."""

    def counted(seen: Seen) -> bool:
        if not seen.is_recording or "Strides" not in seen.words:
            return False
        figure = seen.words[seen.words.index("Strides") + 1]
        return figure.isdigit() and int(figure) >= strides

    return counted


PASSPHRASE = "seven quiet herons cross"
STRIDES = 13  # the simulated patient takes 14 steps with each foot
PLACES = {
    "DEMO-09": "L thigh",
    "DEMO-17": "R thigh",
    "DEMO-1B": "R shank",
    "DEMO-22": "R foot",
    "DEMO-2C": "L foot",
    "DEMO-31": "L shank",
}
DIGITS = {"L thigh": 1, "L shank": 2, "L foot": 3, "R thigh": 4, "R shank": 5, "R foot": 6}
PLACED_BY_KEYS = tuple(key for place in PLACES.values() for key in (f"press {DIGITS[place]}", "press Down"))
PLACED_BY_MOUSE = tuple(f"drag {sensor} to {place}" for sensor, place in PLACES.items())


def walk(number: int, starts: tuple[str, ...], stops: str) -> tuple[Stop, ...]:
    """Give the stops of one walk."""
    return (
        Stop(f"{number + 9:02d}a-choose", offers("Barefoot"), starts, lingers_s=1.0, patience_s=90.0),
        Stop(f"{number + 9:02d}b-walking", has_walked(6), patience_s=60.0),
        Stop(f"{number + 9:02d}c-walked", has_walked(STRIDES), (stops,), patience_s=60.0),
    )


KEYBOARD: tuple[Stop, ...] = (
    Stop(
        "01-first-start",
        at("FirstStartPage"),
        (
            "type TM",
            "press Tab",
            "type Tour Guide",
            "press Tab",
            f"type {PASSPHRASE}",
            "press Tab",
            f"type {PASSPHRASE}",
        ),
    ),
    Stop("02-typed", at("FirstStartPage"), ("press Return",)),
    Stop("03-recovery-key", says("Your recovery key"), ("to Type it back", "copy key")),
    Stop("04-typed-back", says("Your recovery key"), ("press Return",)),
    Stop("05-home", offers("New patient"), ("press ctrl+n",), lingers_s=1.0),
    Stop(
        "06-patient",
        at_step("PatientStep"),
        ("type DEMO-7", "to Birth year", "type 1990", "to Height", "type 178", "to Mass", "type 74"),
        lingers_s=1.0,
    ),
    Stop("07-patient-typed", offers("Put on sensors"), ("press Return",), lingers_s=1.0),
    Stop("07a-source", at_step("SensorsStep"), ("press Return",), lingers_s=1.0),
    Stop("07b-sensors", offers("Movement decides"), PLACED_BY_KEYS, lingers_s=5.0),
    Stop("07c-placed", says("All six are worn"), ("press Return",), lingers_s=1.0),
    Stop("08a-stand-still", at_step("StandStillStep"), ("press space",), lingers_s=1.0),
    Stop("08b-standing", is_recording, lingers_s=1.5),
    Stop("09-free-motion", lambda seen: at_step("FreeMotionStep")(seen) and seen.is_recording, lingers_s=7.0),
    *walk(1, ("press 1", "press space"), "press space"),
    Stop("10d-keep", offers("Keep 1"), ("press k",), lingers_s=1.0),
    *walk(2, ("press 2", "press space"), "press space"),
    *walk(3, ("press 4", "press space"), "press space"),  # kept, and the next begun, by one key
    Stop("12d-keep", offers("Keep 1"), ("press k",), lingers_s=1.0),
    Stop("12e-kept", offers("Results"), ("press Return",), lingers_s=1.0),
    Stop("13a-results", offers("Mean cycle"), ("to Mean cycle", "press Right"), lingers_s=2.0, patience_s=60.0),
    Stop("13b-whole-walk", offers("Mean cycle"), ("press Right",), lingers_s=2.0),
    Stop("13c-figures", offers("Mean cycle"), ("press Right",), lingers_s=1.0),
    Stop("13d-findings", offers("Mean cycle"), ("press ctrl+7",), lingers_s=1.0),
    Stop("14a-report", at_step("ReportStep"), ("press ctrl+s",), lingers_s=1.0),
    Stop("14b-where", offers("Save"), ("press ctrl+a", "type {home}/results", "press Return"), lingers_s=1.0),
    Stop("14c-saved", says("Saved as"), ("press F1",), lingers_s=1.0),
    Stop("15-manual", offers("Search the help"), ("press Escape",), lingers_s=1.0),
    Stop("16-leave", at_step("ReportStep"), ("to Step 7", "press Down", "press Return")),
    Stop("17-home-again", offers("New session"), lingers_s=1.0),
)
MOUSE: tuple[Stop, ...] = (
    Stop("01-first-start", at("FirstStartPage"), ("click Look at the demonstration",)),
    Stop("05-home", offers("New session"), ("click New session",), lingers_s=1.0),
    Stop("06-patient", offers("Put on sensors"), ("click Put on sensors",), lingers_s=1.0),
    Stop("07a-source", at_step("SensorsStep"), ("click Simulated patient",), lingers_s=1.0),
    Stop("07b-sensors", offers("Movement decides"), PLACED_BY_MOUSE, lingers_s=5.0),
    Stop("07c-placed", says("All six are worn"), ("click Stand still",), lingers_s=1.0),
    Stop("08a-stand-still", at_step("StandStillStep"), ("click Start the count",), lingers_s=1.0),
    Stop("08b-standing", is_recording, lingers_s=1.5),
    Stop("09-free-motion", lambda seen: at_step("FreeMotionStep")(seen) and seen.is_recording, lingers_s=7.0),
    *walk(1, ("click Barefoot", "click Start walk"), "click Stop walk"),
    Stop("10d-keep", offers("Keep 1"), ("click Keep 1",), lingers_s=1.0),
    *walk(2, ("click Shoes", "click Start walk"), "click Stop walk"),
    *walk(3, ("click Alignment A", "click Keep, start next"), "click Stop walk"),
    Stop("12d-keep", offers("Keep 1"), ("click Keep 1",), lingers_s=1.0),
    Stop("12e-kept", offers("Results"), ("click Results",), lingers_s=1.0),
    Stop("13a-results", offers("Mean cycle"), ("click Whole walk",), lingers_s=2.0, patience_s=60.0),
    Stop("13b-whole-walk", offers("Mean cycle"), ("click Figures",), lingers_s=2.0),
    Stop("13c-figures", offers("Mean cycle"), ("click Findings",), lingers_s=1.0),
    Stop("13d-findings", offers("Mean cycle"), ("click Go to the report",), lingers_s=1.0),
    Stop("14a-report", at_step("ReportStep"), ("click Save the results",), lingers_s=1.0),
    Stop("14b-where", offers("Save"), ("click Save",), lingers_s=1.0),
    Stop("14c-saved", says("Saved as"), ("click Help",), lingers_s=1.0),
    Stop("15-manual", offers("Search the help"), ("click Back",), lingers_s=1.0),
    Stop("16-leave", at_step("ReportStep"), ("click All patients",)),
    Stop("17-home-again", offers("New session"), lingers_s=1.0),
)
TOURS = {"keyboard": KEYBOARD, "mouse": MOUSE}


class TourError(Exception):
    """The tour cannot go on. The message names the stop and what is on the screen."""


@dataclass(slots=True)
class Application:
    """The application in a process of its own, and what it tells."""

    process: subprocess.Popen[str]
    display: str
    home: Path

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
        told = self.ask("tell")
        controls = {name: (x, y) for name, (x, y) in told.pop("controls").items()}
        return Seen(**{**told, "words": tuple(told["words"]), "controls": controls})

    def picture(self, look: str, file: Path) -> None:
        file.parent.mkdir(parents=True, exist_ok=True)
        self.ask(f"look {look}")
        self.ask(f"picture {file}")

    def hand(self, *arguments: str) -> None:
        """Press or click for real."""
        subprocess.run(["xdotool", *arguments], env={**os.environ, "DISPLAY": self.display}, check=True)


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("out", metavar="OUT", type=Path, help="the folder for the pictures")
    hands = parser.add_mutually_exclusive_group()
    for tour in TOURS:
        hands.add_argument(f"--{tour}", action="store_const", const=tour, dest="tour", help=f"by {tour} alone")
    parser.add_argument("--theme", choices=[*THEMES, "both"], default="both", help="of the pictures")
    parser.add_argument(
        "--sizes",
        nargs="+",
        default=[WINDOW],
        metavar="SIZE",
        help=f"of the pictures: window and size of everything, as {WINDOW}; the first is the one that is worked with",
    )
    parser.add_argument("--trace", type=Path, metavar="FILE", help="note there, by strace, whom the application calls")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)  # this is the application's process
    wanted = parser.parse_args(arguments)
    if wanted.inside:
        sys.exit(_run_inside())
    missing = [package for program, package in PROGRAMS.items() if shutil.which(program) is None]
    if missing:
        sys.exit(f"The tour needs a display and hands. Install {', '.join(missing)}, then start again.")
    themes = THEMES if wanted.theme == "both" else (wanted.theme,)
    looks = [f"{theme} {size}" for size in wanted.sizes for theme in themes]
    for tour in [wanted.tour] if wanted.tour else list(TOURS):
        with ExitStack() as stack:
            display = stack.enter_context(_display())
            application = stack.enter_context(_application(display, wanted.trace))
            try:
                stopwatch_s = lead(application, TOURS[tour], wanted.out.resolve(), looks)
            except TourError as end:
                sys.exit(str(end))
        print(f"{len(TOURS[tour])} stops by {tour} alone, {stopwatch_s:.0f} s of the application's stopwatch.")


def lead(application: Application, stops: Sequence[Stop], out: Path, looks: Sequence[str]) -> float:
    """Go from stop to stop, and give what the application's own stopwatch says of the session.

    Parameters
    ----------
    looks
        Of the pictures: theme, window and size of everything, as "dark 1280x800@100". The first is worked with.

    Raises
    ------
    TourError
        A stop was not reached in time, or the session took too long.
    """
    stopwatch_s = 0.0
    application.ask(f"look {looks[0]}")
    for stop in stops:
        seen = _wait_for(application, stop)
        stopwatch_s = max(stopwatch_s, seen.stopwatch_s)
        time.sleep(stop.lingers_s)
        for look in looks:
            application.picture(look, out / look.replace(" ", "-") / f"{stop.name}.png")
        if len(looks) > 1:
            application.ask(f"look {looks[0]}")
        for deed in stop.does:
            _do(application, stop, deed)
    if stopwatch_s > MOST_S:
        raise TourError(f"The session took {stopwatch_s:.0f} s of the application's stopwatch, {MOST_S:.0f} s at most.")
    return stopwatch_s


def _do(application: Application, stop: Stop, deed: str) -> None:
    verb, _, words = deed.partition(" ")
    match verb:
        case "press":
            application.hand("key", words)
        case "type":
            application.hand("type", "--delay", "40", words.format(home=application.home))
        case "copy":
            application.hand("type", "--delay", "20", _recovery_key(application.seen()))
        case "to":
            _tab_to(application, stop, words)
        case "click":
            application.hand("mousemove", *_place_of(application, stop, words), "click", "1")
        case "drag":
            what, _, where = words.partition(" to ")
            _drag(application, _place_of(application, stop, what), _place_of(application, stop, where))
    time.sleep(KEY_PAUSE_S)


def _recovery_key(seen: Seen) -> str:
    """What a user would copy from the paper: groups of letters and figures, in lines."""
    for words in seen.words:
        groups = words.split()
        if len(groups) > 4 and all(re.fullmatch("[0-9A-Z]{1,4}", group) for group in groups):
            return "-".join(groups)
    raise TourError(f"No recovery key is shown.\n{_in_words(seen)}")


def _tab_to(application: Application, stop: Stop, name: str) -> None:
    for _ in range(MOST_TABS):
        if application.seen().focus.startswith(name):
            return
        application.hand("key", "Tab")
        time.sleep(KEY_PAUSE_S)
    raise TourError(f"{stop.name}: Tab never comes to “{name}”.\n{_in_words(application.seen())}")


def _drag(application: Application, start: tuple[str, str], end: tuple[str, str]) -> None:
    """As a hand does: not at once."""
    (x0, y0), (x1, y1) = ((int(x), int(y)) for x, y in (start, end))
    application.hand("mousemove", *start, "mousedown", "1")
    for share in (0.05, 0.1, 0.4, 0.7, 0.95, 1.0, 1.0):
        time.sleep(KEY_PAUSE_S)
        application.hand("mousemove", str(round(x0 + share * (x1 - x0))), str(round(y0 + share * (y1 - y0))))
    time.sleep(KEY_PAUSE_S)
    application.hand("mouseup", "1")
    time.sleep(3 * KEY_PAUSE_S)


def _wait_for(application: Application, stop: Stop) -> Seen:
    until_s = time.monotonic() + stop.patience_s
    while True:
        seen = application.seen()
        if stop.until(seen):
            return seen
        if time.monotonic() > until_s:
            raise TourError(f"{stop.name} was not reached in {stop.patience_s:.0f} s.\n{_in_words(seen)}")
        time.sleep(LOOK_EVERY_S)


def _place_of(application: Application, stop: Stop, control: str) -> tuple[str, str]:
    until_s = time.monotonic() + stop.patience_s
    while True:
        found = [place for name, place in application.seen().controls.items() if name.startswith(control)]
        if found:
            return str(found[0][0]), str(found[0][1])
        if time.monotonic() > until_s:
            raise TourError(f"{stop.name}: nothing in sight is called “{control}”.\n{_in_words(application.seen())}")
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
def _application(display: str, trace: Path | None) -> "Iterator[Application]":
    with tempfile.TemporaryDirectory(prefix="gaitwright-tour-") as folder:
        places = {
            name: str(Path(folder) / name.lower())
            for name in ("HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME")
        }
        environment = {**os.environ, **places, "DISPLAY": display, "QT_QPA_PLATFORM": "xcb"}
        for place in places.values():
            Path(place).mkdir()
        tracer = [] if trace is None else ["strace", *TRACED, "-o", str(trace.resolve())]
        process = subprocess.Popen(
            [*tracer, sys.executable, str(Path(__file__).resolve()), "--inside", "."],
            cwd=places["HOME"],  # where dialogs begin
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        application = Application(process, display, Path(places["HOME"]))
        try:
            application.ask("begin")
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
            window.move(*CORNER)
            window.activateWindow()
        case "look":
            _take_look(window, *rest)
        case "picture":
            _picture_of(window).save(rest[0])
        case "tell":
            told = _look_at(window)
        case "end":
            window.close()
    print(f"tour: {json.dumps(told)}", flush=True)


def _take_look(window: Any, theme: str, size: str) -> None:
    """Show the window in this theme and size, and let it settle."""
    from PySide6.QtTest import QTest

    look, (side, scale) = window._look, size.split("@")
    width, height = (int(one) for one in side.split("x"))
    if (look.theme.is_dark, look.theme.scale) != (theme == "dark", int(scale) / 100):
        look.set_dark(theme == "dark")
        look.set_scale(int(scale) / 100)
    if (window.width(), window.height()) != (width, height):
        window.resize(width, height)
        QTest.qWait(SETTLE_MS)
    QTest.qWait(SETTLE_MS)


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

    screen = window.screens.currentWidget()
    step = getattr(screen, "current", None)
    visit = getattr(screen, "visit", None)
    focus = QApplication.focusWidget()
    front = QApplication.activeModalWidget() or window
    controls: dict[str, tuple[int, int]] = {}
    words = []
    for widget in front.findChildren(QWidget):
        if not widget.isVisible():
            continue
        if isinstance(widget, QLabel):
            words.append(widget.text())
        elif isinstance(widget, QAbstractButton | QComboBox | QLineEdit | QAbstractItemView):
            seen = widget.visibleRegion().boundingRect()
            if (name := _name_of(widget)) and widget.isEnabled() and not seen.isEmpty():
                middle = widget.mapToGlobal(seen.center())
                controls.setdefault(name, (middle.x(), middle.y()))
        elif widget.accessibleName():
            words.append(widget.accessibleName())
    return {
        "screen": type(screen).__name__,
        "step": type(step).__name__ if step is not None else "",
        "focus": _name_of(focus) if focus is not None else "",
        "is_recording": bool(getattr(screen, "is_recording", False)),
        "banner": next((b.text for b in _banners(window) if b.isVisible()), ""),
        "stopwatch_s": visit.elapsed_s if visit is not None else 0.0,
        "words": words,
        "controls": controls,
    }


def _name_of(widget: "QWidget") -> str:
    """By its accessible name, or as a native dialog's button is read."""
    from PySide6.QtWidgets import QAbstractButton

    said = widget.text().replace("&", "") if isinstance(widget, QAbstractButton) else ""
    return widget.accessibleName() or said


def _banners(window: "QWidget") -> list[Any]:
    from app.widgets.banner import Banner

    return list(window.findChildren(Banner))


if __name__ == "__main__":
    main(sys.argv[1:])

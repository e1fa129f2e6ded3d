"""Walk through whole sessions as a user would, with real keys or a real mouse: `python -m tests.tours.tour OUT`.

Starts the application on a display of its own (Xvfb with openbox) and with a data folder of its own, which is gone
afterwards. The window is worked by xdotool alone, from outside. `--keyboard` uses no mouse: from the first start, with
a library of its own, to the saved results. `--mouse` uses keys for nothing, in the demonstration. What is on the screen
is given by the application's own process, and pictures of every stop are written into OUT, a folder for each look. It
exits with 1, naming the stop, when a session cannot be led to its end, or not in five minutes of the application's
stopwatch; four at the bench.

To change a tour change `tour_stops.py`: each stop waits until the screen states what it should, has its pictures taken
and acts. `--manual` puts the pictures that the manual and the README show where they are read; `--lang` leads the same
sessions in another language.
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
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tests.tours.tour_stops import PATIENCE_S, TOURS, Seen, Stop

if TYPE_CHECKING:
    from collections.abc import Iterator

HELP = Path(__file__).resolve().parents[2] / "resources" / "help"
PICTURES = HELP / "pictures"
MANUAL = {  # which stop of a tour becomes which picture
    "keyboard": {
        "07-patient-typed": "patient",
        "07c-placed": "sensors",
        "08b-standing": "stand-still",
        "09-free-motion": "free-motion",
        "10b-walking": "walking",
        "13a-results": "results",
        "13e-compare": "compare",
        "14c-saved": "report",  # its pages are there then, however slow the computer is
        "27-home-again": "home",
    },
    "bench": {"34-b-against-a": "bench"},
    "timed": {"51c-running": "timed-test"},
}
PROGRAMS = {"Xvfb": "xvfb", "openbox": "openbox", "xdotool": "xdotool", "convert": "imagemagick"}  # Debian's packages
SCREEN = "2000x1200x24"
WINDOW = "1280x800@100"
THEMES = ("light", "dark")
TRACED = ("-f", "--seccomp-bpf", "-e", "trace=connect,sendto,sendmsg,sendmmsg,bind", "-e", "signal=none")
INSIDE = (sys.executable, str(Path(__file__).resolve().with_name("tour_inside.py")))
MOST_S = 300.0  # of the application's stopwatch
MOST_OF = {"bench": 240.0}  # four walks, and what was changed before each
MOST_COUNTED = {"new": (40, 300.0), "returning": (10, 90.0)}  # actions, and seconds of the stopwatch
LOOK_EVERY_S = 0.2
MOST_TABS = 60  # more stops than any page has
KEY_PAUSE_S = 0.08  # between keys: nobody is faster, and what a key opens has to be there for the next


class TourError(Exception):
    """The tour cannot go on. The message names the stop and what is on the screen."""


@dataclass(slots=True)
class Application:
    """The application in a process of its own, and what it reports."""

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
        reported = self.ask("tell")
        controls = {name: (x, y) for name, (x, y) in reported.pop("controls").items()}
        words, focus = tuple(reported.pop("words")), tuple(reported.pop("focus"))
        return Seen(**reported, words=words, focus=focus, controls=controls)

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
    parser.add_argument("--lang", default="en", help="what the application speaks, as de")
    parser.add_argument("--manual", action="store_true", help="give the manual of that language its pictures anew")
    required = parser.parse_args(arguments)
    missing = [package for program, package in PROGRAMS.items() if shutil.which(program) is None]
    if missing:
        sys.exit(f"The tour needs a display and hands. Install {', '.join(missing)}, then start again.")
    themes = THEMES if required.theme == "both" else (required.theme,)
    looks = [f"{theme} {size}" for size in required.sizes for theme in themes]
    for tour in [required.tour] if required.tour else list(TOURS):
        with ExitStack() as stack:
            display = stack.enter_context(own_display())
            application = stack.enter_context(running(display, [*tracer(required.trace), *INSIDE]))
            if required.lang != "en":
                application.ask(f"speak {required.lang}")
                application.ask("begin")  # the window is another
            try:
                led = lead(application, TOURS[tour], required.out.resolve(), looks, MOST_OF.get(tour, MOST_S))
            except TourError as end:
                sys.exit(str(end))
        if required.manual:
            _give_pictures(
                required.out,
                MANUAL.get(tour, {}),
                PICTURES if required.lang == "en" else HELP / required.lang / "pictures",
            )
        print(f"{len(TOURS[tour])} stops by {tour} alone, {led.stopwatch_s:.0f} s of the application's stopwatch.")
        if led.actions:
            print(f"Counted: {led.actions} actions, {led.counted_s:.0f} s of the application's stopwatch.")
        most = MOST_COUNTED.get(tour)
        if most is not None and (led.actions > most[0] or led.counted_s > most[1]):
            sys.exit(f"At most {most[0]} actions and {most[1]:.0f} s are allowed.")


def _give_pictures(out: Path, required: Mapping[str, str], pictures: Path) -> None:
    """With a palette of 256 colours, more than the pages have, they are a third as large."""
    pictures.mkdir(parents=True, exist_ok=True)
    for stop, picture in required.items():
        for theme, suffix in (("light", ""), ("dark", "-dark")):
            taken, given = out / f"{theme}-{WINDOW}" / f"{stop}.png", pictures / f"{picture}{suffix}.png"
            subprocess.run(["convert", taken, "-dither", "None", "-colors", "256", f"PNG8:{given}"], check=True)


@dataclass(slots=True)
class Led:
    """What a tour took: the longest that the stopwatch showed; of the stops that are counted, keys and clicks too."""

    stopwatch_s: float = 0.0
    actions: int = 0
    counted_s: float = 0.0


def lead(
    application: Application, stops: Sequence[Stop], out: Path, looks: Sequence[str], most_s: float = MOST_S
) -> Led:
    """Go from stop to stop, and give what that took.

    Parameters
    ----------
    looks
        Of the pictures: theme, window and size of everything, as "dark 1280x800@100". The first is worked with.
    most_s
        Of the application's stopwatch.
    """
    led = Led()
    application.ask(f"look {looks[0]}")
    for stop in stops:
        seen = _wait_for(application, stop)
        led.stopwatch_s = max(led.stopwatch_s, seen.stopwatch_s)
        if stop.is_counted and led.actions:
            led.counted_s = max(led.counted_s, seen.stopwatch_s)
        time.sleep(stop.lingers_s)
        for look in looks:
            application.picture(look, out / look.replace(" ", "-") / f"{stop.name}.png")
        if len(looks) > 1:
            application.ask(f"look {looks[0]}")
        for deed in stop.does:
            count = _do(application, stop, deed)
            led.actions += count if stop.is_counted else 0
        for files, words in stop.leaves:
            if not any(words in file.read_text("utf-8") for file in application.home.glob(files)):
                raise TourError(f"{stop.name}: no file {files} says “{words}”.")
    if led.stopwatch_s > most_s:
        stated = f"The session took {led.stopwatch_s:.0f} s of the application's stopwatch, {most_s:.0f} s at most."
        raise TourError(stated)
    return led


def _do(application: Application, stop: Stop, deed: str) -> int:
    """Do it, and give how many keys and clicks it took: typing takes one for each letter."""
    verb, _, words = deed.partition(" ")
    actions = 1
    match verb:
        case "press":
            application.hand("key", words)
        case "type":
            application.hand("type", "--delay", "40", words.format(home=application.home))
            actions = len(words)
        case "copy":
            application.hand("type", "--delay", "20", _recovery_key(application.seen()))
        case "to":
            actions = _tab_to(application, stop, words)
        case "click":
            application.hand("mousemove", *_place_of(application, stop, words), "click", "1")
        case "await":
            _await_window(application, stop, words)
        case "raise":
            application.hand("search", "--onlyvisible", "--name", words, "windowactivate", "--sync")
        case "drag":
            what, _, where = words.partition(" to ")
            _drag(application, _place_of(application, stop, what), _place_of(application, stop, where))
    time.sleep(KEY_PAUSE_S)
    return actions


def _recovery_key(seen: Seen) -> str:
    """What a user would copy from the paper: the last two of the key's groups."""
    for words in seen.words:
        groups = words.split()
        if len(groups) > 4 and all(re.fullmatch("[0-9A-Z]{1,4}", group) for group in groups):
            return "-".join(groups[-2:])
    raise TourError(f"No recovery key is shown.\n{_in_words(seen)}")


def _tab_to(application: Application, stop: Stop, name: str) -> int:
    for tabs in range(MOST_TABS):
        if any(one.startswith(name) for one in application.seen().focus):
            return tabs
        application.hand("key", "Tab")
        time.sleep(KEY_PAUSE_S)
    raise TourError(f"{stop.name}: Tab never comes to “{name}”.\n{_in_words(application.seen())}")


def _await_window(application: Application, stop: Stop, title: str) -> None:
    """Wait for a window of another program of ours."""
    until_s = time.monotonic() + stop.patience_s
    environment = {**os.environ, "DISPLAY": application.display}
    while subprocess.run(["xdotool", "search", "--onlyvisible", "--name", title], env=environment).returncode != 0:
        if time.monotonic() > until_s:
            raise TourError(f"{stop.name}: no window is called “{title}”.\n{_in_words(application.seen())}")
        time.sleep(LOOK_EVERY_S)


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
        f"On the screen: {seen.screen} {seen.step}, focus on “{' = '.join(seen.focus)}”, banner “{seen.banner}”.\n"
        f"Controls: {', '.join(seen.controls)}\nWords: {' | '.join(seen.words)}"
    )


@contextmanager
def own_display() -> "Iterator[str]":
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
def running(display: str, program: Sequence[str], owner: int | None = None) -> "Iterator[Application]":
    """The application, started by `program`, on a display, with a home of its own that is gone afterwards.

    `owner` is the user whose home it is, where `program` begins by becoming another.
    """
    with tempfile.TemporaryDirectory(prefix="gaitwright-tour-") as folder:
        places = {
            name: str(Path(folder) / name.lower())
            for name in ("HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME")
        }
        environment = {**os.environ, **places, "DISPLAY": display, "QT_QPA_PLATFORM": "xcb"}
        for place in places.values():
            Path(place).mkdir()
        if owner is not None:
            for place in (folder, *places.values()):
                os.chown(place, owner, owner)
        process = subprocess.Popen(
            program,
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


def tracer(trace: Path | None) -> list[str]:
    return [] if trace is None else ["strace", *TRACED, "-o", str(trace.resolve())]


def _end(process: "subprocess.Popen[Any]") -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


if __name__ == "__main__":
    main(sys.argv[1:])

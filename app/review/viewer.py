"""Show a session's log in Rerun. In a window of its own, a program that ends with ours.

The log is plain text to whoever reads the disk, and may come out of an encrypted library. So it lies in one folder per
run of the program, which only this user may enter, and which is emptied when the program ends or, where it could not,
at its next start. The viewer keeps its own settings there too: analytics are off, nothing of a session stays with it.
It listens on this computer only.
"""

import importlib.util
import logging
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path

import platformdirs

from app.review.installed import write_log
from app.storage.files import held
from app.wording.translation import tr
from core.results import Analysis
from core.session import Session
from core.video.clip import Clip

MEMORY_LIMIT = "2GB"  # forty sessions of ten minutes
END_S = 5.0  # then it is ended by force
ADDRESS = "127.0.0.1"
NOBODY = "http://127.0.0.1:9"  # where nobody listens
SETTINGS = "settings"
ERRORS = ".err"  # behind the name of a log: what the viewer writes of its errors
ENDED = (0, -9, -15)  # by its window, or by somebody who ended the program
MOST_ERRORS, MOST_REASON = 4096, 200  # bytes, letters
_COLOURS = re.compile(r"\x1b\[[0-9;]*m")
_PLACE = re.compile(r"\S*[/\\]\S*")  # a path may hold somebody's name
LOCK = ".lock"

_log = logging.getLogger(__name__)


class ViewerRefusedError(Exception):
    """Nothing can be shown; the message is for the clinician."""


def default_root() -> Path:
    """Where the folders of all runs are."""
    return platformdirs.user_cache_path("gaitwright", appauthor=False) / "review"


def viewer_program() -> Path | None:
    """The viewer itself, which comes with the library; not the script that starts it and would outlive its end."""
    found = importlib.util.find_spec("rerun_cli")
    if found is None or found.origin is None:
        return None
    folder = Path(found.origin).parent
    names = {"win32": ("rerun.exe",), "darwin": ("Rerun.app/Contents/MacOS/Rerun", "rerun")}.get(
        sys.platform, ("rerun",)
    )
    return next((folder / name for name in names if (folder / name).is_file()), None)


def why_not(program: Path | None) -> str:
    """Say why nothing can be shown here; empty where it can."""
    if program is None:
        return tr("Rerun is not installed on this computer. Open the session on a computer that has Rerun.")
    has_screen = any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
    if sys.platform.startswith("linux") and not has_screen:
        return tr(
            "Rerun needs a display, and there is none here. Open session.rrd from the results on a "
            "computer with a display."
        )
    return ""


class Viewer:
    """Shows sessions, each in a window of its own, until `close`. Used from one thread at a time, not the screen's.

    `root` holds the folders of all runs; what runs that ended left there is removed at the first `open`.
    """

    def __init__(self, root: Path, program: Path | None) -> None:
        self._root = root
        self._program = program
        self._held = ExitStack()
        self._folder: Path | None = None
        self._shown: dict[Path, subprocess.Popen[bytes]] = {}

    def open(self, session: Session, analysis: Analysis, clips: Sequence[Clip] = ()) -> None:
        """Write the log and show it; raises ViewerRefusedError (no viewer, screen or room, or no start).

        `clips` are in it as it lies on the disk, plain, until the program ends.
        """
        program, why = self._program, why_not(self._program)
        if program is None or why:
            raise ViewerRefusedError(why)
        try:
            folder = self._folder or self._begin(program)
            self._forget_closed()
            number, log = tempfile.mkstemp(prefix="session-", suffix=".rrd", dir=folder)
            os.close(number)
            write_log(session, analysis, Path(log), clips)
            self._shown[Path(log)] = _start(
                [
                    *(str(program), "--bind", ADDRESS, "--port", "auto"),
                    *("--memory-limit", MEMORY_LIMIT, "--hide-welcome-screen", log),
                ],
                folder / SETTINGS,
                _errors_of(Path(log)),
            )
        except (OSError, subprocess.TimeoutExpired) as problem:
            _log.warning("Rerun was not started", exc_info=True)
            raise ViewerRefusedError(
                tr("Rerun could not be started. Check for free disk space, then try again.")
            ) from problem

    @property
    def is_showing(self) -> bool:
        """Whether a window is open that nobody has closed."""
        return any(process.poll() is None for process in self._shown.values())

    def failures(self) -> list[str]:
        """Why viewers ended with an error since this was asked last, as without usable graphics; empty: no reason."""
        return self._forget_closed()

    def close(self) -> None:
        """End every viewer and remove what it showed."""
        for process in self._shown.values():
            process.terminate()
        for process in self._shown.values():
            try:
                process.wait(END_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self._shown.clear()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._held.close()
            with suppress(OSError):
                _lock_of(self._folder).unlink()
            self._folder = None

    def _begin(self, program: Path) -> Path:
        """Remove what ended runs left, and make this run's folder with analytics off."""
        self._root.mkdir(mode=0o700, parents=True, exist_ok=True)
        for left in self._root.iterdir():
            if left.is_dir():
                _remove_unless_held(left)
        folder = Path(tempfile.mkdtemp(prefix="run-", dir=self._root))  # only its owner may enter
        self._held.enter_context(held(_lock_of(folder)))
        self._folder = folder
        (folder / SETTINGS).mkdir()
        if _start([str(program), "analytics", "disable"], folder / SETTINGS).wait(END_S) != 0:
            raise OSError("analytics could not be switched off")
        return folder

    def _forget_closed(self) -> list[str]:
        """Remove the logs whose windows were closed; gives why those ended that ended with an error."""
        codes = {log: code for log, process in self._shown.items() if (code := process.poll()) is not None}
        reasons = [_reason(_errors_of(log)) for log, code in codes.items() if code not in ENDED]
        for log in codes:
            del self._shown[log]
            log.unlink(missing_ok=True)
            _errors_of(log).unlink(missing_ok=True)
        return reasons


def _errors_of(log: Path) -> Path:
    return log.with_name(log.name + ERRORS)


def _reason(errors: Path) -> str:
    """The last line of what a viewer wrote of its errors, without places of this computer."""
    try:
        with errors.open("rb") as file:
            file.seek(max(errors.stat().st_size - MOST_ERRORS, 0))
            written = file.read().decode("utf-8", "replace")
    except OSError:
        return ""
    lines = [line.strip() for line in _COLOURS.sub("", written).splitlines() if line.strip()]
    stated = _PLACE.sub("\N{HORIZONTAL ELLIPSIS}", lines[-1].removeprefix("Error: ")) if lines else ""
    return stated[:MOST_REASON].rstrip(". ")


def _start(command: list[str], settings: Path, errors: Path | None = None) -> "subprocess.Popen[bytes]":
    """Start the viewer with its settings, and all else that it keeps, in a folder of ours; `errors`: its stderr."""
    # in turn where Linux, Windows and macOS look
    own = dict.fromkeys(
        ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "APPDATA", "LOCALAPPDATA"), str(settings)
    )
    if sys.platform == "darwin":
        own["HOME"] = str(settings)
    # at every start it asks the internet for a newer one of itself, and no setting forbids it
    own |= dict.fromkeys(("HTTPS_PROXY", "HTTP_PROXY", "ALL_PROXY", "https_proxy", "http_proxy", "all_proxy"), NOBODY)
    nowhere = subprocess.DEVNULL
    with ExitStack() as ends:
        into = ends.enter_context(errors.open("wb")) if errors is not None else nowhere
        return subprocess.Popen(command, env=os.environ | own, stdin=nowhere, stdout=nowhere, stderr=into)


def _lock_of(folder: Path) -> Path:
    """Beside the folder, because Windows removes no folder with an open file."""
    return folder.with_name(folder.name + LOCK)


def _remove_unless_held(folder: Path) -> None:
    with suppress(BlockingIOError):  # another window of ours is showing it
        with held(_lock_of(folder)):
            shutil.rmtree(folder, ignore_errors=True)
        with suppress(OSError):
            _lock_of(folder).unlink()

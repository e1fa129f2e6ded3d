"""Short sounds in the room, for those who look at the patient and not at the screen.

Each has its words on the screen too, so nothing is lost where there is no sound. The platform's own player plays them
in a process beside ours: Qt's multimedia would bring more than all else together. One thread starts it and waits for
it, so that the screen's thread never does, one sound follows the other, and no ended process stays behind.
"""

import contextlib
import logging
import shutil
import subprocess
import sys
from collections.abc import Sequence
from enum import StrEnum
from importlib.resources import files
from queue import Empty, Full, Queue
from threading import Thread

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QApplication

# PulseAudio's, PipeWire's and ALSA's own; the first that is there and states that it played is used from then on
PLAYERS: Sequence[Sequence[str]] = (
    (("afplay",),) if sys.platform == "darwin" else (("paplay",), ("pw-play",), ("aplay", "-q"))
)
LONGEST_S = 3.0  # the sounds last less than half a second; a player that hangs must not hold up the next sound

_log = logging.getLogger(__name__)


class Sound(StrEnum):
    START = "start"
    STOP = "stop"
    COUNT = "count"
    READY = "ready"
    LOSS = "loss"
    REACHED = "reached"
    TICK = "tick"


class Loudspeaker(QObject):
    """Plays one sound after the other. Where nothing can play, it lets the desktop beep.

    Of several that are asked for while another sounds only the latest is kept: an old one would report what is over.
    Only the tick of a metronome takes no other's place: it signals nothing that the next one does not.
    """

    _not_received = Signal()

    def __init__(self, players: Sequence[Sequence[str]] = PLAYERS) -> None:
        super().__init__()
        self.is_on = True
        self._players = [list(player) for player in players]
        self._next: Queue[Sound] = Queue(maxsize=1)
        self._thread: Thread | None = None
        self._not_received.connect(self._on_not_received, Qt.ConnectionType.QueuedConnection)

    def play(self, sound: Sound) -> None:
        """Play `sound`, at once or after the one that sounds; nothing while the bell is off."""
        if not self.is_on:
            return
        if self._thread is None:
            # a daemon: the end of the program waits for no sound
            self._thread = Thread(target=self._run, name="sounds", daemon=True)
            self._thread.start()
        while True:
            with contextlib.suppress(Full):
                self._next.put_nowait(sound)
                return
            if sound is Sound.TICK:
                return
            with contextlib.suppress(Empty):
                self._next.get_nowait()

    def _run(self) -> None:
        while True:
            if not self._is_received(self._next.get()):
                with contextlib.suppress(RuntimeError):  # the program has ended meanwhile
                    self._not_received.emit()

    def _is_received(self, sound: Sound) -> bool:
        file = str(files("resources") / "sounds" / f"{sound}.wav")
        if sys.platform == "win32":
            return _play_on_windows(file)
        while self._players:
            if _has_played([*self._players[0], file]):
                return True
            del self._players[0]  # not there, or nothing to play to: the next time would be no better
        return False

    def _on_not_received(self) -> None:
        if self.is_on:
            QApplication.beep()


def play(sound: Sound) -> None:
    """Let the room hear `sound`. Takes a few microseconds, and never fails."""
    _loudspeaker.play(sound)


def is_on() -> bool:
    return _loudspeaker.is_on


def set_on(is_on: bool) -> None:
    """Turn all sounds on or off: the bell of the action bar."""
    _loudspeaker.is_on = is_on


def _has_played(command: Sequence[str]) -> bool:
    if shutil.which(command[0]) is None:
        return False
    quiet = subprocess.DEVNULL
    try:
        ended = subprocess.run(command, stdin=quiet, stdout=quiet, stderr=quiet, timeout=LONGEST_S, check=False)
    except (OSError, subprocess.TimeoutExpired) as problem:
        _log.info("%s played nothing: %s", command[0], problem)
        return False
    return ended.returncode == 0


def _play_on_windows(file: str) -> bool:
    if sys.platform == "win32":
        import winsound

        try:
            winsound.PlaySound(file, winsound.SND_FILENAME | winsound.SND_NODEFAULT)
        except RuntimeError as problem:
            _log.info("the sound was not played: %s", problem)
            return False
        return True
    return False


_loudspeaker = Loudspeaker()

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
from collections.abc import Callable, Sequence
from enum import StrEnum
from importlib.resources import files
from threading import Condition, Thread
from time import monotonic

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QApplication

if sys.platform == "win32":
    import winsound

# PulseAudio's, PipeWire's and ALSA's own; the first that is there and states that it played is used from then on
PLAYERS: Sequence[Sequence[str]] = (
    (("afplay",),) if sys.platform == "darwin" else (("paplay",), ("pw-play",), ("aplay", "-q"))
)
LONGEST_S = 6.0  # tones last under half a second, phrases under four; a player that hangs holds up no other sound
LOOK_S = 0.02  # how soon a phrase is cut off

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
    Only the tick of a metronome takes no other's place: it signals nothing that the next one does not. A spoken phrase
    waits for the tones, and is cut off by whatever comes next: a tone marks an instant, and a new phrase is what holds.

    `has_output`: whether the last tone could be played; True before the first.
    """

    _not_received = Signal()

    def __init__(self, players: Sequence[Sequence[str]] = PLAYERS) -> None:
        super().__init__()
        self.is_on = self.has_output = True
        self._players = [list(player) for player in players]
        self._waits = Condition()
        self._tone: Sound | None = None  # what comes next
        self._phrase = ""
        self._thread: Thread | None = None
        self._not_received.connect(self._on_not_received, Qt.ConnectionType.QueuedConnection)

    def play(self, sound: Sound) -> None:
        """Play `sound`, at once or after the one that sounds; nothing while the bell is off."""
        if not self.is_on:
            return
        with self._waits:
            if sound is not Sound.TICK or self._tone is None:
                self._tone = sound
            self._wake()

    def speak(self, phrase: str) -> None:
        """Play a spoken phrase, named by its language and its name, as "en/recorded"; nothing while the bell is off."""
        if not self.is_on:
            return
        with self._waits:
            self._phrase = phrase
            self._wake()

    def _wake(self) -> None:
        if self._thread is None:
            # a daemon: the end of the program waits for no sound
            self._thread = Thread(target=self._run, name="sounds", daemon=True)
            self._thread.start()
        self._waits.notify()

    def _run(self) -> None:
        while True:
            with self._waits:
                self._waits.wait_for(self._has_more)
                tone, phrase = self._tone, self._phrase
                self._tone = None
                if tone is None:
                    self._phrase = ""
            if tone is None:
                self._is_received(f"spoken/{phrase}", self._has_more)
                continue
            self.has_output = self._is_received(tone)
            if not self.has_output and tone is not Sound.TICK:  # nobody walks to the beeps of a desktop
                with contextlib.suppress(RuntimeError):  # the program has ended meanwhile
                    self._not_received.emit()

    def _has_more(self) -> bool:
        return self._tone is not None or bool(self._phrase)

    def _is_received(self, sound: str, is_over: Callable[[], bool] | None = None) -> bool:
        """Play it, to its end or until `is_over`; whether anything could."""
        file = str(files("resources") / "sounds" / f"{sound}.wav")
        if sys.platform == "win32":
            return _play_on_windows(file, is_beside=is_over is not None)
        while self._players:
            if _has_played([*self._players[0], file], is_over):
                return True
            del self._players[0]  # not there, or nothing to play to: the next time would be no better
        return False

    def _on_not_received(self) -> None:
        if self.is_on:
            QApplication.beep()


def play(sound: Sound) -> None:
    """Let the room hear `sound`. Takes a few microseconds, and never fails."""
    _loudspeaker.play(sound)


def speak(phrase: str) -> None:
    """Let the room hear a spoken phrase, as `play` does a sound."""
    _loudspeaker.speak(phrase)


def is_on() -> bool:
    return _loudspeaker.is_on


def has_output() -> bool:
    """Whether sounds are audible here, as far as any was played yet."""
    return _loudspeaker.has_output


def set_on(is_on: bool) -> None:
    """Turn all sounds on or off: the bell of the action bar."""
    _loudspeaker.is_on = is_on


def _has_played(command: Sequence[str], is_over: Callable[[], bool] | None) -> bool:
    """Whether the command played its sound, to its end or until `is_over`."""
    if shutil.which(command[0]) is None:
        return False
    quiet = subprocess.DEVNULL
    try:
        with subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet) as process:
            until_s = monotonic() + LONGEST_S
            while process.poll() is None:
                is_cut = is_over is not None and is_over()
                if is_cut or monotonic() > until_s:
                    process.kill()
                    return is_cut
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(LOOK_S)
            return process.returncode == 0
    except OSError as problem:
        _log.info("%s played nothing: %s", command[0], problem)
        return False


def _play_on_windows(file: str, *, is_beside: bool) -> bool:
    """Play a sound to its end; `is_beside`: the call returns at once, and the next sound cuts it off."""
    if sys.platform == "win32":
        try:
            flags = winsound.SND_FILENAME | winsound.SND_NODEFAULT
            winsound.PlaySound(file, flags | winsound.SND_ASYNC if is_beside else flags)
        except RuntimeError as problem:
            _log.info("the sound was not played: %s", problem)
            return False
        return True
    return False


_loudspeaker = Loudspeaker()

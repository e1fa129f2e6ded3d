"""Watch whether the open library is still where it was opened.

A thread looks twice a second: a disk may be slow to answer.

At a clinic's station it listens to the server, too: does it answer, and did another station do something? What was
recorded here is handed over to the others.
"""

import logging
import time
from contextlib import ExitStack
from threading import Event
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QThread, Signal

from app.storage.bringing_home import bring_home
from app.storage.clinic.handing_over import hand_over
from app.storage.clinic.joining import refuse_silent
from app.storage.opened import held_alone
from app.storage.stored import LibraryError, LibraryFaultError
from app.workers.refusals import refusal_of

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary

LOOK_EVERY_S = 0.5
LISTEN_EVERY_S = 2.0  # to a clinic's server: one question that costs it a millisecond
SERVER_AGAIN_S = 10.0  # while a station works without it
BRING_AGAIN_S = 30.0  # after a file could not be brought home

_log = logging.getLogger(__name__)


class LibraryWatch(QThread):
    """Brings home, too, what was recorded while the library was gone, as soon as it can be; runs until `end`."""

    went = Signal()
    came_back = Signal(int)  # how many recordings were brought home
    left_away = Signal(str)  # why what was recorded while the library was gone could not be brought home
    left_here = Signal(str, str)  # why what was recorded here could not be handed over to the other stations
    changed_elsewhere = Signal()  # another station did something
    server_back = Signal()  # whose station works without it

    def __init__(self, library: "OpenedLibrary", parent: QObject) -> None:
        super().__init__(parent)
        self._library = library
        self._is_over = Event()
        self._bring_from_s = self._hand_over_from_s = self._listen_from_s = 0.0
        self._is_left_here = False
        self._does_answer = True  # the server
        self._has_server_answered = False  # while the station works without it
        self._entries_of_others: int | None = None

    def end(self) -> None:
        """Look no more; what it is at, a question to a server that does not answer, may take some seconds yet."""
        self._is_over.set()

    def ended(self) -> "LibraryWatch":
        """Itself, once it looks no more: for a thread that may wait."""
        self.wait()
        return self

    def run(self) -> None:
        is_gone = False
        with ExitStack() as ends:
            while not self._is_over.wait(LOOK_EVERY_S):
                try:
                    is_there = (self._library.is_there or self._took_back(ends)) and self._listen()
                    brought = self._bring_home() if is_there else 0
                    if is_there:
                        self._hand_over()
                    self._look_for_server()
                except Exception:  # the edge of the thread: it goes on looking
                    _log.exception("the library could not be looked for")
                    continue
                was_gone, is_gone = is_gone, not is_there
                if is_gone and not was_gone:
                    self.went.emit()
                elif brought or (was_gone and not is_gone):  # what was still being recorded comes home later
                    self.came_back.emit(brought)

    def _listen(self) -> bool:
        """Whether the clinic's server answers, as it was found a moment ago; true where there is none."""
        if self._library.shared is None or time.monotonic() < self._listen_from_s:
            return self._does_answer
        try:
            found = self._library.library.audit.entries_of_others()
        except LibraryFaultError as fault:
            if self._does_answer:
                _log.warning("the clinic's server does not answer: %s", fault.what)
            self._does_answer = False
        else:
            self._does_answer = True
            if self._entries_of_others is not None and found > self._entries_of_others:
                self.changed_elsewhere.emit()
            self._entries_of_others = found
        self._listen_from_s = time.monotonic() + LISTEN_EVERY_S
        return self._does_answer

    def _hand_over(self) -> None:
        if self._library.shared is None or time.monotonic() < self._hand_over_from_s:
            return
        self._hand_over_from_s = time.monotonic() + LISTEN_EVERY_S
        try:
            hand_over(self._library)
        except (LibraryError, OSError) as error:
            _log.warning("what was recorded here cannot be handed over", exc_info=error)
            self._hand_over_from_s = time.monotonic() + BRING_AGAIN_S
            if not self._is_left_here:
                self.left_here.emit(*refusal_of(error))
            self._is_left_here = True
        else:
            self._is_left_here = False

    def _look_for_server(self) -> None:
        """Notify, once, a station that works without its server when that answers again."""
        station = self._library.away_from
        if station is None or self._has_server_answered or time.monotonic() < self._listen_from_s:
            return
        try:
            refuse_silent(station)
        except LibraryError:
            self._listen_from_s = time.monotonic() + SERVER_AGAIN_S
        else:
            self._has_server_answered = True
            self.server_back.emit()

    def _took_back(self, ends: ExitStack) -> bool:
        """Go on with the same library in another folder at its place: its disk was mounted again, or it is a copy."""
        root = self._library.library.root
        if root is None or not root.is_another():
            return False
        try:
            ends.enter_context(held_alone(self._library.folder))
            self._library.library.take_back()
        except (LibraryError, OSError) as refusal:  # another program works with it, or it is gone again
            _log.warning("the library is not taken back", exc_info=refusal)
            return False
        return True

    def _bring_home(self) -> int:
        if time.monotonic() < self._bring_from_s:
            return 0
        try:
            return len(bring_home(self._library))
        except LibraryError:  # gone again
            return 0
        except OSError as error:
            _log.warning("what is in the shelter cannot be brought home", exc_info=error)
            if not self._bring_from_s:
                self.left_away.emit(error.strerror or type(error).__name__)
            self._bring_from_s = time.monotonic() + BRING_AGAIN_S
            return 0

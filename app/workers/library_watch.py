"""Is the open library still where it was opened? A thread looks twice a second: a disk may be slow to answer."""

import logging
import time
from contextlib import ExitStack
from threading import Event
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QThread, Signal

from app.storage.bringing_home import bring_home
from app.storage.opened import held_alone
from app.storage.stored import LibraryError

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary

LOOK_EVERY_S = 0.5
BRING_AGAIN_S = 30.0  # after a file could not be brought home

_log = logging.getLogger(__name__)


class LibraryWatch(QThread):
    """Brings home, too, what was recorded while the library was gone, as soon as it can be; runs until `finish`."""

    went = Signal()
    came_back = Signal(int)  # how many recordings were brought home
    left_away = Signal(str)  # why what was recorded while the library was gone could not be brought home

    def __init__(self, library: "OpenedLibrary", parent: QObject) -> None:
        super().__init__(parent)
        self._library = library
        self._is_over = Event()
        self._bring_from_s = 0.0

    def finish(self) -> None:
        self._is_over.set()
        self.wait()

    def run(self) -> None:
        is_gone = False
        with ExitStack() as ends:
            while not self._is_over.wait(LOOK_EVERY_S):
                try:
                    is_there = self._library.is_there or self._took_back(ends)
                    brought = self._bring_home() if is_there else 0
                except Exception:  # the edge of the thread: it goes on looking
                    _log.exception("the library could not be looked for")
                    continue
                was_gone, is_gone = is_gone, not is_there
                if is_gone and not was_gone:
                    self.went.emit()
                elif brought or (was_gone and not is_gone):  # what was still being recorded comes home later
                    self.came_back.emit(brought)

    def _took_back(self, ends: ExitStack) -> bool:
        """Go on with the same library in another folder at its place: its disk was mounted anew, or it is a copy."""
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

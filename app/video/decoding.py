"""Decode frames of a clip in a thread of their own, so that nothing holds up the screen; the latest request wins."""

import logging
from threading import Lock
from typing import NamedTuple

from PySide6.QtCore import QObject, QSize, QThread, Signal
from PySide6.QtGui import QImage

from app.video.jpeg import JpegDecoder
from core.video.clip import Clip

JPEG = b"\xff\xd8"  # begins each one

_log = logging.getLogger(__name__)


class Request(NamedTuple):
    """A frame of a clip, as large as it is shown, in pixels of the screen."""

    clip: Clip
    number: int
    room: QSize


class FrameDecoder(QThread):
    """Runs while there is something to decode. `decoded` gives a Request and its QImage, null where it is damaged."""

    decoded = Signal(object, QImage)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._lock = Lock()
        self._next: Request | None = None
        self._is_at_work = False
        self._decoder = JpegDecoder()

    def ask(self, request: Request) -> None:
        """Decode this frame next, in place of one that has not been begun."""
        with self._lock:
            self._next = request
            must_start, self._is_at_work = not self._is_at_work, True
        if must_start:
            self.wait()  # for the last few instructions of the run before
            self.start()

    def finish(self) -> None:
        """Drop what was asked and wait for the frame at work, which takes milliseconds."""
        with self._lock:
            self._next = None
        self.wait()
        self._decoder.clear()

    def run(self) -> None:
        while (request := self._taken()) is not None:
            self.decoded.emit(request, self._decode(request))

    def _taken(self) -> Request | None:
        with self._lock:
            taken, self._next = self._next, None
            self._is_at_work = taken is not None
            return taken

    def _decode(self, request: Request) -> QImage:
        try:
            jpeg = request.clip.pictures.jpeg(request.number)
        except OSError:
            jpeg = b""
        if not jpeg.startswith(JPEG):
            _log.warning("frame %d of a clip is damaged", request.number)
            return QImage()
        return self._decoder.decoded(jpeg, request.room)

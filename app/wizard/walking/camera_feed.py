"""One camera: its frames for the preview, and into a clip while a walk is recorded."""

import threading
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from devices.cameras.camera import CameraInfo, CameraLostError, CameraMode, CapturedFrame
from devices.cameras.capture import Capture

if TYPE_CHECKING:
    from app.storage.videos.writer import ClipWriter


class CameraFeed(QObject):
    """Frames come in the capture's own thread, which waits for nobody: the clip's writer takes them or drops them."""

    ended = Signal(object)  # CameraLostError
    changed = Signal()  # the mode in force

    def __init__(self, number: int, info: CameraInfo, mode: CameraMode, view: str, parent: QObject) -> None:
        super().__init__(parent)
        self.number, self.info, self.view = number, info, view
        self.latest: CapturedFrame | None = None
        self.writer: ClipWriter | None = None
        self.taken = 0  # frames of the clip
        self._is_over = False
        self._given: CameraMode | None = None  # what the camera gives, which may be another mode than was asked for
        self._capture = Capture(info, mode, self._on_frame, self._on_ended, self._on_change)

    @property
    def mode(self) -> CameraMode:
        """In force, which may be less than was asked for."""
        return self._capture.mode

    @property
    def is_known(self) -> bool:
        """Whether the camera has stated what it gives, as it does just before its first frame."""
        return self._given is not None

    @property
    def is_over(self) -> bool:
        return self._is_over

    @property
    def is_reduced(self) -> bool:
        """Whether it sends fewer or smaller frames than the camera gives: the computer keeps up with no more."""
        return self._given is not None and self._given != self.mode

    def record(self, writer: "ClipWriter") -> None:
        """Write what comes from now on into this clip."""
        self.taken, self.writer = 0, writer

    def end_clip(self) -> "ClipWriter | None":
        """Write no more; the clip's writer, which is still to be stopped."""
        writer, self.writer = self.writer, None
        return writer

    def kill(self) -> None:
        """End its process at once, as a crash would."""
        self._capture.process.kill()

    def stop(self) -> None:
        """Close the camera; its latest picture goes, too."""
        self._is_over, self.latest = True, None
        # a camera may take a second to let go
        threading.Thread(target=self._capture.stop, name="camera stop", daemon=True).start()

    def _on_frame(self, frame: CapturedFrame) -> None:
        if self._is_over:
            return
        self.latest = frame
        if (writer := self.writer) is not None:
            self.taken += writer.add(frame)

    def _on_change(self, mode: CameraMode) -> None:
        self._given = self._given or mode
        if not self._is_over:
            self.changed.emit()

    def _on_ended(self, error: CameraLostError) -> None:
        if not self._is_over:
            self.ended.emit(error)

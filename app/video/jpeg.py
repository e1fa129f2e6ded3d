"""Decode JPEGs one after the other, no larger than they are needed."""

from PySide6.QtCore import QBuffer, QIODevice, QSize, Qt
from PySide6.QtGui import QImage, QImageReader


class JpegDecoder:
    """Made by the screen's thread, which ends what it has of Qt; used by one thread at a time."""

    def __init__(self) -> None:
        self._content = QBuffer()

    def decoded(self, jpeg: bytes, room: QSize) -> QImage:
        """Give the picture, as large as fits into `room`; null where these bytes are none."""
        self._content.setData(jpeg)
        self._content.open(QIODevice.OpenModeFlag.ReadOnly)
        reader = QImageReader(self._content, b"jpeg")
        if (whole := reader.size()).isValid():
            reader.setScaledSize(whole.scaled(room, Qt.AspectRatioMode.KeepAspectRatio))
        picture = reader.read()
        self._content.close()
        return picture

    def clear(self) -> None:
        """Let go of the picture that was decoded last."""
        self._content.setData(b"")

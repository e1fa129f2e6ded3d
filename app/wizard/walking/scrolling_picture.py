"""Live curves that cost little. A picture of the last seconds moves on by whole pixels; only its new end is drawn.

Every instant has its column, counted from the clock's zero, so that a sample is drawn at the same fraction of a pixel
whenever it is drawn: moving the picture on and drawing all of it again give the same picture.
"""

import math

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter, QPixmap, QResizeEvent
from PySide6.QtWidgets import QWidget

from app.theme.current import on_theme
from core.samples import FloatArray

SHOWN_S = 8.0  # seconds


class ScrollingPicture:
    """`columns` by `rows` device pixels, the last `seconds` of a clock from left to right."""

    def __init__(self, columns: int, rows: int, seconds: float) -> None:
        self.columns, self.rows = columns, rows
        self.pixmap = QPixmap(columns, rows)
        self._px_per_s = columns / seconds
        self._last_column: int | None = None  # which ends the picture; None before anything was drawn

    @property
    def px_per_s(self) -> float:
        return self._px_per_s

    def advance(self, now_s: float) -> int:
        """Scroll the end to `now_s` and give the first empty column; a clock jump clears the whole picture."""
        last = math.floor(now_s * self._px_per_s)
        before, self._last_column = self._last_column, last
        if before is None or not 0 <= last - before < self.columns:
            return 0
        if last > before:
            self.pixmap.scroll(before - last, 0, self.pixmap.rect())
        return self.columns - (last - before)

    def x_of(self, time_s: float) -> float:
        """Where in the picture an instant lies, px from its left."""
        return time_s * self._px_per_s - self._left

    def xs_of(self, time_s: FloatArray) -> FloatArray:
        """The same for (n,) instants."""
        return time_s * self._px_per_s - self._left

    def time_at(self, x: float) -> float:
        return (x + self._left) / self._px_per_s

    def paint(self, painter: QPainter, place: QRectF, pixel_ratio: float) -> None:
        """Copy the picture to `place`, pixel by pixel."""
        corner = painter.worldTransform().map(place.topLeft())
        painter.save()
        painter.resetTransform()
        painter.scale(1 / pixel_ratio, 1 / pixel_ratio)
        painter.drawPixmap(round(corner.x() * pixel_ratio), round(corner.y() * pixel_ratio), self.pixmap)
        painter.restore()

    @property
    def _left(self) -> int:
        return (self._last_column or 0) - self.columns


class Scrolling(QWidget):
    """Has the last seconds up to `_now_s` in a picture: another one for another size, time in sight or look."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._seconds, self._now_s = SHOWN_S, 0.0
        self._picture: ScrollingPicture | None = None
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        on_theme(self.redraw)

    def set_seconds(self, seconds: float) -> None:
        """Set how much time is in sight."""
        if seconds != self._seconds:
            self._seconds = seconds
            self.redraw()

    def redraw(self) -> None:
        """Draw everything again, the next time it is in sight."""
        self._picture = None
        self.update()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.redraw()

    def _picture_of(self, columns: int, rows: int) -> ScrollingPicture:
        picture = self._picture
        if picture is None or (picture.columns, picture.rows) != (columns, rows):
            picture = self._picture = ScrollingPicture(columns, rows, self._seconds)
        return picture

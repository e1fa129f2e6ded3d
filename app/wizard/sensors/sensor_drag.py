"""A sensor that is dragged from its row or from the place where it is worn."""

from PySide6.QtCore import QMimeData, QPoint, Qt
from PySide6.QtGui import QColor, QDrag, QFontMetrics, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QApplication, QWidget

from app.theme.current import current_theme, px
from app.widgets.painted_button import PaintedButton
from app.widgets.text import SEMIBOLD

DRAGGED = "application/x-gaitwright-sensor"


class DraggedButton(PaintedButton):
    """`dragged`: the sensor that the mouse takes away from it; empty: none."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.dragged = ""
        self._pressed_at: QPoint | None = None

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._pressed_at = event.position().toPoint()
        super().mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self.dragged and self._is_meant(event):
            self._pressed_at = None
            self.setDown(False)
            drag_sensor(self, self.dragged)
            return
        super().mouseMoveEvent(event)

    def _is_meant(self, event: QMouseEvent) -> bool:
        """Whether the mouse, with its button down, has moved so far that a drag is meant."""
        if self._pressed_at is None or not event.buttons() & Qt.MouseButton.LeftButton:
            return False
        return (event.position().toPoint() - self._pressed_at).manhattanLength() >= QApplication.startDragDistance()


def sensor_in(data: QMimeData) -> str:
    return bytes(data.data(DRAGGED).data()).decode()


def drag_sensor(source: QWidget, sensor: str) -> None:
    """Let the mouse carry `sensor` until it is let go; returns then."""
    data = QMimeData()
    data.setData(DRAGGED, sensor.encode())
    drag = QDrag(source)
    drag.setMimeData(data)
    label = _Carried(sensor)
    drag.setPixmap(label.grab())
    drag.setHotSpot(QPoint(label.width() // 2, label.height() // 2))
    label.deleteLater()
    drag.exec(Qt.DropAction.MoveAction)


class _Carried(QWidget):
    """What hangs at the mouse while a sensor is dragged."""

    def __init__(self, sensor: str) -> None:
        super().__init__()
        self._sensor = sensor
        width = QFontMetrics(current_theme().font(16, SEMIBOLD, is_code=True)).horizontalAdvance(sensor)
        self.resize(width + px(32), px(40))

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = current_theme()
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(theme.colours.inv))
        painter.setPen(QColor(theme.colours.inv_ink))
        painter.setFont(theme.font(16, SEMIBOLD, is_code=True))
        painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, self._sensor)

"""A sensor that is dragged from its row or from the place where it is worn."""

from PySide6.QtCore import QMimeData, QPoint, Qt
from PySide6.QtGui import QDrag, QMouseEvent
from PySide6.QtWidgets import QApplication, QWidget

from app.theme.current import px
from app.theme.ground import Ground, set_ground
from app.widgets.painted_button import PaintedButton
from app.widgets.text import SEMIBOLD, Text

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
    label = carried(sensor)
    drag.setPixmap(label.grab())
    drag.setHotSpot(QPoint(label.width() // 2, label.height() // 2))
    label.deleteLater()
    drag.exec(Qt.DropAction.MoveAction)


def carried(sensor: str) -> Text:
    """What hangs at the mouse while a sensor is dragged."""
    label = Text(sensor, 16, SEMIBOLD, tone="inv_ink", is_code=True)
    label.setAlignment(Qt.AlignmentFlag.AlignCenter)
    set_ground(label, Ground("inv", radius=0, inset=0))
    label.resize(label.fontMetrics().horizontalAdvance(sensor) + px(32), px(40))
    return label

"""Keys that lead out of a field on a page whose keys do other things."""

from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QKeyEvent

from app.widgets.field import Field

LEAVING = (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Escape)


class LeavingKeys(QObject):
    """Lets Enter and Esc leave a field: Enter is the primary button's elsewhere, Esc the window's. `left`: by them."""

    left = Signal()

    def __init__(self, field: Field) -> None:
        super().__init__(field)
        self._line = field.line_edit
        self._line.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if isinstance(event, QKeyEvent) and event.key() in LEAVING and not event.modifiers():
            if event.type() is QEvent.Type.ShortcutOverride:
                event.accept()
                return True
            if event.type() is QEvent.Type.KeyPress:
                self._line.clearFocus()
                self.left.emit()
                return True
        return super().eventFilter(watched, event)

"""The second window, which the patient looks at. It takes no focus when it opens: the operator goes on working."""

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QCloseEvent, QGuiApplication, QKeyEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from app.patient_screen.patient_view import PatientView
from app.patient_screen.picture import HEIGHT, WIDTH, paint_patient_view
from app.wording.translation import tr


class PatientWindow(QWidget):
    """Esc and F8 close it, F11 fills the screen, Space is for the walk."""

    closed = Signal()  # by whatever way
    run_requested = Signal()  # Space was pressed here

    def __init__(self) -> None:
        super().__init__()
        self.view = PatientView()
        self.setWindowTitle(tr("Patient screen"))
        self.setAttribute(Qt.WidgetAttribute.WA_ShowWithoutActivating)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMinimumSize(480, 300)
        self.show_view(self.view)

    def open_beside(self, other: QWidget) -> None:
        """Open it, on another screen than `other` where there is one, and fill that."""
        mine = other.screen()
        free = [screen for screen in QGuiApplication.screens() if screen is not mine]
        room = (free[0] if free else mine).availableGeometry()
        self.resize(min(WIDTH, room.width()), min(HEIGHT, room.height()))
        self.move(room.center() - self.rect().center())
        if free:
            self.showFullScreen()
        else:
            self.show()

    def show_view(self, view: PatientView) -> None:
        if view != self.view or not self.accessibleName():
            self.view = view
            self.setAccessibleName(view.in_words)
            self.update()

    def toggle_full_screen(self) -> None:
        self.setWindowState(self.windowState() ^ Qt.WindowState.WindowFullScreen)

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        paint_patient_view(painter, QRectF(self.rect()), self.view)
        painter.end()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        match event.key():
            case Qt.Key.Key_Escape | Qt.Key.Key_F8:
                self.close()
            case Qt.Key.Key_F11:
                self.toggle_full_screen()
            case Qt.Key.Key_Space if not event.isAutoRepeat():
                self.run_requested.emit()
            case _:
                super().keyPressEvent(event)

    def closeEvent(self, event: QCloseEvent) -> None:
        super().closeEvent(event)
        self.closed.emit()

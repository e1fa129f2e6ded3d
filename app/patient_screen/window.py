"""The window that the patient looks at. It takes no focus: keys stay with the clinician, who goes on working."""

from dataclasses import dataclass, field

from PySide6.QtCore import QPoint, QRect, QRectF, QSize, Qt, QTimer, Signal, Slot
from PySide6.QtGui import (
    QCloseEvent,
    QGuiApplication,
    QKeyEvent,
    QMoveEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QScreen,
)
from PySide6.QtWidgets import QWidget

from app.patient_screen.patient_view import PatientView
from app.patient_screen.picture import HEIGHT, WIDTH, paint_patient_view
from app.theme.current import px
from app.widgets.grid import COMPACT_BELOW
from app.wording.translation import tr

LEAST = QSize(320, 200)
CORNER_SHARE, CORNER_MOST = 0.3, 640  # of the screen's width, and px: what lies below stays of use
GAP = 12
ACTION_BAR = 72  # at the foot of the clinician's window, with what starts and stops the walk
BAR_COUNTS = 20  # so many times as much as the rest


@dataclass(slots=True)
class Placing:
    """How the screen was last shown, so that it comes back so.

    `is_full`: by whether there is a second screen: each has a choice of its own. `corner`: where it was moved to in a
    corner of the clinician's screen.
    """

    is_full: dict[bool, bool] = field(default_factory=dict)
    corner: QRect | None = None

    def ask_for_full(self) -> None:
        """Let it fill a screen when it is opened next."""
        self.is_full = {False: True, True: True}


class PatientWindow(QWidget):
    """Esc and F8 close it, F11 fills the screen, Space is for the walk, where it has the focus against its will.

    Parameters
    ----------
    placing
        How it was last shown; kept up to date.
    """

    closed = Signal()  # by whatever way
    run_requested = Signal()  # Space was pressed here
    placed = Signal(bool)  # whether it fills a screen now

    def __init__(self, placing: Placing | None = None) -> None:
        flags = Qt.WindowType.Window | Qt.WindowType.WindowStaysOnTopHint | Qt.WindowType.WindowDoesNotAcceptFocus
        super().__init__(None, flags)
        self.view = PatientView()
        self._placing = placing or Placing()
        self._other: QWidget | None = None
        self._is_placed = False
        self.setWindowTitle(tr("Patient screen"))
        self.setAttribute(Qt.WidgetAttribute.WA_ShowWithoutActivating)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMinimumSize(LEAST)
        self.show_view(self.view)

    def open_beside(self, other: QWidget) -> None:
        """Open it: on another screen than `other` where there is one, and fill that; else in a corner."""
        self._other = other
        application = QGuiApplication.instance()
        assert isinstance(application, QGuiApplication)
        application.screenRemoved.connect(self._on_screen_removed)
        self._show()

    def show_view(self, view: PatientView) -> None:
        if view != self.view or not self.accessibleName():
            self.view = view
            self.setAccessibleName(view.in_words)
            self.update()

    def toggle_full_screen(self) -> None:
        """Fill the screen, or go back to a part of it; it is remembered."""
        self._placing.is_full[self._second is not None] = not self.isFullScreen()
        self._show()

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        paint_patient_view(painter, QRectF(self.rect()), self.view)
        painter.end()

    def moveEvent(self, event: QMoveEvent) -> None:
        super().moveEvent(event)
        self._note_corner()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._note_corner()

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

    @property
    def _second(self) -> QScreen | None:
        """A screen that the clinician's window is not on."""
        mine = self._other.screen() if self._other is not None else QGuiApplication.primaryScreen()
        return next((screen for screen in QGuiApplication.screens() if screen is not mine), None)

    def _show(self) -> None:
        other, second = self._other, self._second
        if other is None:  # nowhere to be beside
            self.setWindowState(self.windowState() ^ Qt.WindowState.WindowFullScreen)
            return
        screen = second or other.screen()
        self._is_placed = False
        self.setScreen(screen)
        if self._placing.is_full.get(second is not None, second is not None):
            self.setGeometry(_middle(screen.availableGeometry()))  # so that it fills this screen
            self.setWindowState(Qt.WindowState.WindowFullScreen)  # Qt's own method would ask for the focus
            self.show()
            self.placed.emit(True)
            return
        self.setWindowState(Qt.WindowState.WindowNoState)
        self.show()
        if second is not None:
            self.setGeometry(_middle(screen.availableGeometry()))
        else:
            self.setGeometry(self._corner(screen.availableGeometry(), other.frameGeometry()))
            self._is_placed = True
        self.placed.emit(False)

    def _corner(self, room: QRect, other: QRect) -> QRect:
        """Where it was moved to, as far as that is on the screen; else the corner that hides least of `other`.

        Its action bar is hidden last. Of equal corners the left comes first, where the rail is wide: there lie the list
        of steps and what was a while ago, at the right the present. Without it the controls lie at the left.
        """
        if self._placing.corner is not None and room.contains(self._placing.corner):
            return self._placing.corner
        width = max(min(round(CORNER_SHARE * room.width()), CORNER_MOST), LEAST.width())
        size = QSize(width, width * HEIGHT // WIDTH)
        bar = QRect(other.left(), other.bottom() + 1 - px(ACTION_BAR), other.width(), px(ACTION_BAR))
        feet = room.bottom() + 1, min(room.bottom() + 1, bar.top())
        tops = [foot - GAP - size.height() for foot in feet]
        lefts = [room.left() + GAP, room.right() + 1 - GAP - size.width()]
        if other.width() < px(COMPACT_BELOW[0]):
            lefts.reverse()
        places = [QRect(QPoint(left, top), size) for top in tops for left in lefts]
        return min(places, key=lambda one: _shared(one, other) + BAR_COUNTS * _shared(one, bar))

    def _note_corner(self) -> None:
        if self._is_placed and not self.isFullScreen() and self.isVisible():
            self._placing.corner = self.geometry()

    @Slot()
    def _on_screen_removed(self) -> None:
        QTimer.singleShot(0, self, self._leave_screen)  # once Qt has brought its windows to another

    def _leave_screen(self) -> None:
        """Where its screen is gone it goes to another or into a corner: it never covers the clinician's by itself."""
        if self._second is None:
            self._placing.is_full[False] = False
        elif self._other is not None and self.screen() is not self._other.screen():
            return  # another screen was unplugged
        if self.isVisible():
            self._show()


def _middle(room: QRect) -> QRect:
    size = QSize(WIDTH, HEIGHT).boundedTo(room.size())
    place = QRect(room.topLeft(), size)
    place.moveCenter(room.center())
    return place


def _shared(one: QRect, other: QRect) -> int:
    """How many pixels two places have in common."""
    both = one.intersected(other)
    return both.width() * both.height() if both.isValid() else 0

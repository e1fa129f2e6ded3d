"""The ring round whatever has the focus, 3 px outside it, where a control cannot paint for itself."""

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, QRectF, Qt
from PySide6.QtGui import QPainter, QRegion
from PySide6.QtWidgets import QAbstractScrollArea, QApplication, QWidget
from shiboken6 import isValid

from app.theme.current import current_theme, px
from app.theme.theme import CONTROL_RADIUS
from app.widgets.painted import Painted

DISTANCE = 3
WIDTH = 2
NO_RING = "has_no_focus_ring"  # property of a region that is read and not worked: its size means nothing


class FocusRing(Painted):
    """Lies over all of `window` and follows the focus inside it."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._window = window
        self._chain: list[QWidget] = []
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        app = QApplication.instance()
        if isinstance(app, QApplication):
            app.focusChanged.connect(self._on_focus_changed)
        self.hide()

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        half = WIDTH * theme.scale / 2
        box = QRectF(self.rect()).adjusted(half, half, -half, -half)
        theme.paint_box(painter, box, None, theme.colours.ink, WIDTH, CONTROL_RADIUS + DISTANCE)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        moved = (QEvent.Type.Move, QEvent.Type.Resize, QEvent.Type.Show, QEvent.Type.Hide)
        if event.type() in moved and watched is not self:
            self._follow()
        return super().eventFilter(watched, event)

    def _on_focus_changed(self, _old: QWidget | None, new: QWidget | None) -> None:
        for left in filter(isValid, self._chain):  # the focus also leaves what is being deleted
            left.removeEventFilter(self)
        self._chain = []
        if new is not None and self._window.isAncestorOf(new):
            while new is not None and new is not self._window:
                self._chain.append(new)
                new.installEventFilter(self)
                new = new.parentWidget()
        self._follow()

    def _follow(self) -> None:
        seen = _seen_of(self._chain[0]) if self._chain else QRect()
        if seen.isEmpty() or self._chain[0].property(NO_RING):
            self.hide()
            return
        reach = px(DISTANCE + WIDTH)
        corner = self._chain[0].mapTo(self._window, QPoint(0, 0))
        self.setGeometry(seen.translated(corner).adjusted(-reach, -reach, reach, reach))
        inside = self.rect().adjusted(2 * reach, 2 * reach, -2 * reach, -2 * reach)  # beyond the round corners
        self.setMask(QRegion(self.rect()) - QRegion(inside))  # so that it is not painted with what moves inside it
        self.raise_()
        self.show()


def _seen_of(widget: QWidget) -> QRect:
    """What is in sight of a control; of one that scrolls, its content as well, which Qt counts as another widget."""
    seen = widget.visibleRegion().boundingRect()
    if isinstance(widget, QAbstractScrollArea):
        inside = widget.viewport()
        seen = seen.united(inside.visibleRegion().boundingRect().translated(inside.pos()))
    return seen

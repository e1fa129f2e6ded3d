"""Parts beside each other that wrap into as many lines as they need, and buttons among which arrows go on."""

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme.current import px
from app.widgets.button import Button, ButtonKind

GAP = 8
STEPS = {Qt.Key.Key_Right: 1, Qt.Key.Key_Down: 1, Qt.Key.Key_Left: -1, Qt.Key.Key_Up: -1}


class Wrapping(QWidget):
    """As high as its lines, each `line` px: layouts in areas that scroll ask for no height of a width.

    Whoever derives from it gives the parts in the order of reading, and calls `arrange` when these are others.
    """

    def __init__(self, line: float) -> None:
        super().__init__()
        self._line = line
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def parts(self) -> Sequence[QWidget]:
        return ()

    def step(self, part: QWidget, by: int) -> None:
        """Go on to the part before or after, and round at the end."""

    def sizeHint(self) -> QSize:
        return self.size().expandedTo(self.minimumSizeHint())

    def minimumSizeHint(self) -> QSize:
        return QSize(max(map(_width, self.parts()), default=0), px(self._line))

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.arrange()

    def arrange(self) -> None:
        x = y = 0
        for part in self.parts():
            width = _width(part)
            if x and x + width > self.width():
                x, y = 0, y + px(self._line) + px(GAP)
            part.setGeometry(x, y, width, px(self._line))
            x += width + px(GAP)
        self.setFixedHeight(y + px(self._line))
        self.updateGeometry()


class WrappedButton(Button):
    """One of the buttons that wrap: an arrow goes on to the next."""

    def __init__(self, word: str, kind: ButtonKind, height: float, group: Wrapping) -> None:
        super().__init__(word, kind, height=height, parent=group)
        self._group = group
        self.setCheckable(True)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if (by := STEPS.get(Qt.Key(event.key()))) is not None:
            self._group.step(self, by)
        else:
            super().keyPressEvent(event)


def _width(part: QWidget) -> int:
    return part.sizeHint().expandedTo(part.minimumSize()).boundedTo(part.maximumSize()).width()

"""A page as high as its words need in the width they have, for what scrolls: Qt's own areas ask for the least only."""

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget


class TallPage(QWidget):
    """Its parts stand in `column`, which is given the height that its words take once they wrap."""

    def __init__(self) -> None:
        super().__init__()
        self.column = QVBoxLayout(self)  # held: a layout asked for by `layout()` while its page goes away crashes

    def event(self, event: QEvent) -> bool:
        is_done = super().event(event)
        if event.type() in (QEvent.Type.LayoutRequest, QEvent.Type.Resize):
            self.setMinimumHeight(max(0, self.column.minimumHeightForWidth(self.width())))
        return is_done

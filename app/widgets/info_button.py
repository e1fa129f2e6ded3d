"""A small button that states where figures come from, beside it while it is asked for."""

from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QToolTip

from app.theme.current import current_theme, scaled
from app.theme.icons import Icon, paint_icon
from app.widgets.painted_button import PaintedButton

ICON, TARGET = 18, 24


class InfoButton(PaintedButton):
    """Pressed, or under the mouse, it shows its words; hidden while it has none."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.setAccessibleName(name)
        scaled(self.setFixedSize, TARGET, TARGET)
        self.clicked.connect(self._show)
        self.show_words("")

    @property
    def words(self) -> str:
        return self.toolTip()

    def show_words(self, words: str) -> None:
        self.setToolTip(words)
        self.setAccessibleDescription(words)
        self.setVisible(bool(words))

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme, painter = current_theme(), QPainter(self)
        side, box = theme.px(ICON), QRectF(self.rect())
        self.paint_veil(painter, box)
        place = QRectF(box.center().x() - side / 2, box.center().y() - side / 2, side, side)
        paint_icon(painter, Icon.INFO, place, theme.colours.ink2)

    def _show(self) -> None:
        QToolTip.showText(self.mapToGlobal(self.rect().bottomLeft()), self.words, self)

"""An icon in a page, beside its words."""

from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainter

from app.theme.current import current_theme, scaled
from app.theme.icons import Icon, paint_icon
from app.widgets.painted import Painted


class IconMark(Painted):
    """An icon beside words. The words say what it shows, so a screen reader passes over it."""

    def __init__(self, icon: Icon, size: float = 20, tone: str = "ink") -> None:
        super().__init__()
        self._icon, self._tone = icon, tone
        scaled(self.setFixedSize, size, size)

    def set_icon(self, icon: Icon, tone: str = "") -> None:
        self._icon, self._tone = icon, tone or self._tone
        self.update()

    def draw(self, painter: QPainter) -> None:
        paint_icon(painter, self._icon, QRectF(self.rect()), getattr(current_theme().colours, self._tone))

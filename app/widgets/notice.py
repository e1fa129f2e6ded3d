"""What is so and what follows, beside what it is about, after an icon. Yellow where it needs a look."""

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QPainter
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QVBoxLayout

from app.theme.current import current_theme
from app.theme.ground import Ground, set_ground
from app.theme.icons import Icon, paint_icon
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.text import SEMIBOLD, Text

ICON = 22
PADDING = 10


class Notice(Painted):
    """Keeps its place while it has nothing to say, unless it is hidden. `padding`: above and below, px."""

    accessible_role = QAccessible.Role.Note

    def __init__(self, size: float = 18, padding: int = PADDING) -> None:
        super().__init__()
        self._icon: Icon | None = None
        self._is_caution = False
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)  # fixed ones may not wrap
        self._what = Text(size=size, weight=SEMIBOLD, wraps=True)
        self._then = Text(size=14, tone="ink2", wraps=True)
        words = lay_out(QVBoxLayout(), self._what, self._then, spacing=2)
        row = QHBoxLayout(self)
        lay_out(row, (words, 1), margins=(PADDING + ICON + 8, padding, PADDING, padding))

    @property
    def text(self) -> str:
        return " ".join(filter(None, [self._what.text(), self._then.text()]))

    def show_message(self, icon: Icon | None, what: str, then: str = "", is_caution: bool = False) -> None:
        """Show it; whoever cannot see it is notified whenever the first line changes."""
        if (icon, what, then, is_caution) == (self._icon, self._what.text(), self._then.text(), self._is_caution):
            return
        is_news = what != self._what.text()
        self._icon, self._is_caution = icon, is_caution
        set_ground(self, Ground("caution", "caution_edge") if is_caution else None)
        self._what.setText(what)
        self._what.setVisible(bool(what))
        self._then.setText(then)
        self._then.setVisible(bool(then))
        self._then.set_tone("caution_ink" if is_caution else "ink2")
        self._what.set_tone("caution_ink" if is_caution else "ink")
        self.setAccessibleName(self.text)
        if is_news and self.isVisible():
            QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, self.text))
        self.update()

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        if self._icon is not None:
            first = self._what if self._what.text() else self._then
            wraps = Qt.TextFlag.TextWordWrap
            words = first.fontMetrics().boundingRect(first.contentsRect(), wraps, first.text())
            above = max(first.height() - words.height(), 0) / 2  # words lie in the middle of what room they are given
            middle = first.y() + above + first.fontMetrics().height() / 2
            mark = QRectF(px(PADDING), middle - px(ICON) / 2, px(ICON), px(ICON))
            paint_icon(painter, self._icon, mark, c.caution_ink if self._is_caution else c.ink)

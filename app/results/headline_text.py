"""The sentence over the results, and the line under it, which fits: letters shrink and last sentences go."""

from collections.abc import Sequence

from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QFontMetrics, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import current_theme, on_theme, px
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text

SIZES = (22, 21, 20)
SECOND = 14
SPARE = 24  # px: words are wrapped a little before they touch the edge


class HeadlineText(QWidget):
    """Whoever cannot see it is notified whenever the first sentence changes; the tooltip has all sentences."""

    accessible_role = QAccessible.Role.Note

    def __init__(self) -> None:
        super().__init__()
        self._beside: Sequence[str] = ()
        self.first = Text(size=SIZES[0], weight=SEMIBOLD, wraps=True)
        self.second = Text(size=SECOND, tone="ink2", wraps=True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        lay_out(QVBoxLayout(self), self.first, self.second, margins=0, spacing=4)
        on_theme(self._fit)

    @property
    def text(self) -> str:
        """Everything, whether it has room or not."""
        return " ".join(filter(None, [self.first.text(), *self._beside]))

    @property
    def shown(self) -> str:
        """The second line as far as it has room."""
        return self.second.text()

    def show_sentences(self, first: str, beside: Sequence[str] = ()) -> None:
        """Show a headline and what belongs to it, the most important first."""
        is_news = first != self.first.text()
        self._beside = tuple(beside)
        self.first.setText(first)
        self.second.setVisible(bool(beside))
        self._fit()
        self.setAccessibleName(self.text)
        self.setToolTip(self.text)
        if is_news and self.isVisible():
            QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, self.text))

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        theme, width = current_theme(), self.width() - px(SPARE)
        for size in SIZES:
            self.first.set_size(size)
            if QFontMetrics(theme.font(size, SEMIBOLD)).horizontalAdvance(self.first.text()) <= width:
                break
        metrics = QFontMetrics(theme.font(SECOND))
        count = len(self._beside)
        while count > 1 and metrics.horizontalAdvance(" ".join(self._beside[:count])) > width:
            count -= 1
        self.second.setText(" ".join(self._beside[:count]))

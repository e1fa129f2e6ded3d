"""What goes on beside the screen and how far it is, in one line that is in nobody's way."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QHBoxLayout, QProgressBar, QSizePolicy

from app.theme.current import current_theme
from app.widgets.text import Text
from app.widgets.themed import Themed
from app.wording.translation import tr

HEIGHT, BAR = 36, (160, 6)


class ProgressStrip(Themed):
    """Hidden until it is shown something."""

    def __init__(self) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self.words = Text(tone="ink2", wraps=True)
        self._line = QProgressBar()
        self._line.setTextVisible(False)
        self._line.setAccessibleName(tr("Progress so far"))
        self._row = QHBoxLayout(self)
        self._row.addWidget(self.words, 1)
        self._row.addWidget(self._line, 0, Qt.AlignmentFlag.AlignVCenter)
        self._apply_theme()
        self.hide()

    @property
    def done(self) -> tuple[int, int]:
        """How many of how many."""
        return self._line.value(), self._line.maximum()

    def show_progress(self, words: str, done: int, total: int) -> None:
        self.words.setText(words)
        self._line.setRange(0, total)
        self._line.setValue(done)
        self.show()

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setPen(current_theme().pen(current_theme().colours.line, 1))
        painter.drawLine(0, 0, self.width(), 0)

    def _apply_theme(self) -> None:
        px = current_theme().px
        self._row.setContentsMargins(px(24), px(6), px(24), px(6))
        self._row.setSpacing(px(16))
        self._line.setFixedSize(px(BAR[0]), px(BAR[1]))
        self.setMinimumHeight(px(HEIGHT))

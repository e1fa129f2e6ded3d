"""What goes on beside the screen and how far it is, in one line that is in nobody's way."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QProgressBar, QSizePolicy, QWidget

from app.theme.current import scaled
from app.theme.ground import Ground, set_ground
from app.widgets.lay_out import lay_out
from app.widgets.text import Text
from app.wording.translation import tr

HEIGHT, BAR = 36, (160, 6)


class ProgressStrip(QWidget):
    """Hidden until it is shown something."""

    def __init__(self) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        set_ground(self, Ground(line="line", edge=Qt.Edge.TopEdge))
        self.words = Text(tone="ink2", wraps=True)
        self._line = QProgressBar()
        self._line.setTextVisible(False)
        self._line.setAccessibleName(tr("Progress so far"))
        row = QHBoxLayout(self)
        lay_out(
            row, (self.words, 1), (self._line, 0, Qt.AlignmentFlag.AlignVCenter), margins=(24, 6, 24, 6), spacing=16
        )
        scaled(self._line.setFixedSize, BAR[0], BAR[1])
        scaled(self.setMinimumHeight, HEIGHT)
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

"""What is shown in place of a result before there is one: an empty page, and a page that works."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QProgressBar, QVBoxLayout, QWidget

from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import later, tr

MIDDLE = Qt.AlignmentFlag.AlignHCenter
SENTENCE = later("No session is open.")


class EmptyPage(QWidget):
    """One sentence and the two ways on."""

    def __init__(self) -> None:
        super().__init__()
        self.open_folder = Button(tr("Open a session folder"), ButtonKind.PRIMARY, Icon.FOLDER, tr("Ctrl O"))
        self.open_demonstration = Button(tr("Open the demonstration"), ButtonKind.SECONDARY, Icon.PLAY, tr("Ctrl D"))
        self._sentence = Text(tr(SENTENCE), size=26, weight=SEMIBOLD)
        self._hint = Text(tr("You can also drop a session folder here."), tone="ink2")
        self._row = lay_out(QHBoxLayout(), 1, self.open_folder, self.open_demonstration, 1, spacing=16)
        parts = (1, (self._sentence, 0, MIDDLE), self._row, (self._hint, 0, MIDDLE), 1)
        lay_out(QVBoxLayout(self), *parts, margins=24, spacing=24)

    def set_narrow(self, is_narrow: bool) -> None:
        """Stack the two buttons where they do not fit side by side."""
        way = QHBoxLayout.Direction.TopToBottom if is_narrow else QHBoxLayout.Direction.LeftToRight
        self._row.setDirection(way)


class WorkingPage(QWidget):
    """What is being done, how far it is, and the way out."""

    def __init__(self) -> None:
        super().__init__()
        self._title = Text(size=26, weight=SEMIBOLD, wraps=True)
        self._title.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._what = Text(tone="ink2")
        self._line = QProgressBar()
        self._line.setTextVisible(False)
        self._line.setRange(0, 1000)
        self._line.setAccessibleName(tr("Progress so far"))
        self.stop = Button(tr("Stop"), ButtonKind.SECONDARY, Icon.STOP, tr("Esc"))
        parts = (1, self._title, (self._line, 0, MIDDLE), (self._what, 0, MIDDLE), (self.stop, 0, MIDDLE), 1)
        lay_out(QVBoxLayout(self), *parts, margins=24, spacing=16)
        scaled(self._line.setFixedSize, 400, 8)

    def begin(self, title: str) -> None:
        self._title.setText(title)
        self.show_progress(0.0, "")

    def show_progress(self, share: float, what: str) -> None:
        self._line.setValue(round(share * 1000))
        self._what.setText(what)

    @property
    def progress(self) -> tuple[float, str]:
        return self._line.value() / 1000, self._what.text()

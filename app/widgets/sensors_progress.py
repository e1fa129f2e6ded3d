"""Something that is done to several sensors: what, how far it is, which of them are done, and the way out."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QProgressBar, QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import on_theme, px, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.translation import tr

LINE, MARK, GAP = 28, 18, 10
WIDEST = 560  # longer lines are not read at a glance
PER_MILLE = 1000


class LineState(Enum):
    DONE = auto()
    NOW = auto()
    TO_DO = auto()
    WRONG = auto()


@dataclass(frozen=True, slots=True)
class SensorLine:
    """One sensor, how it is with it, and in words what is particular."""

    name: str
    state: LineState
    words: str = ""


@dataclass(frozen=True, slots=True)
class ProgressShown:
    """`share` 0 to 1, None: nobody knows. `stop` is what the way out is called; empty: there is none now."""

    title: str
    sentence: str = ""
    share: float | None = None
    lines: tuple[SensorLine, ...] = ()
    what: str = ""
    then: str = ""
    stop: str = ""
    is_running: bool = True


class SensorsProgress(QWidget):
    """A title, a bar and a line for each sensor, while something is done with all of them."""

    stop_pressed = Signal()  # it is to be left

    def __init__(self) -> None:
        super().__init__()
        self._shown = ProgressShown("")
        self._title = Text(size=20, weight=SEMIBOLD, wraps=True)
        self._sentence = Text(size=15, tone="ink2", wraps=True)
        self._bar = QProgressBar()
        self._bar.setTextVisible(False)
        self._lines = _SensorLines()
        self.notice = Notice(size=16)
        self.stop = Button(tr("Cancel"), ButtonKind.SECONDARY, Icon.STOP)
        self._inside = QWidget()
        column = QVBoxLayout(self._inside)
        for part in (self._title, self._sentence):
            part.setAlignment(Qt.AlignmentFlag.AlignHCenter)
        for widget in (self._title, self._sentence, self._bar, self._lines, self.notice):
            column.addWidget(widget)
        lay_out(column, (self.stop, 0, Qt.AlignmentFlag.AlignHCenter), margins=0, spacing=14)
        middle = lay_out(QHBoxLayout(), 1, self._inside, 1)
        lay_out(QVBoxLayout(self), 1, middle, 2, margins=0)
        self.stop.clicked.connect(self.stop_pressed)
        scaled(self._bar.setFixedHeight, 8)
        on_theme(self._fit)

    @property
    def shown(self) -> ProgressShown:
        return self._shown

    def show_state(self, shown: ProgressShown) -> None:
        """Show it; some times a second is enough."""
        if shown == self._shown:
            return
        self._shown = shown
        self._title.setText(shown.title)
        self._sentence.setText(shown.sentence)
        self._sentence.setVisible(bool(shown.sentence))
        self._bar.setVisible(shown.is_running)
        self._bar.setRange(0, PER_MILLE if shown.share is not None else 0)
        if shown.share is not None:
            self._bar.setValue(round(shown.share * PER_MILLE))
        self._bar.setAccessibleName(shown.title)
        self._lines.show_lines(shown.lines)
        self.notice.show_message(
            Icon.WARNING if shown.what else None, shown.what, shown.then, is_caution=bool(shown.what)
        )
        self.notice.setVisible(bool(shown.what))
        self.stop.setVisible(bool(shown.stop))
        if shown.stop and self.stop.text() != shown.stop:
            self.stop.setText(shown.stop)
            self.stop.setAccessibleName(shown.stop)

    def focus(self) -> None:
        if not self.stop.isHidden():
            self.stop.setFocus()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        """Give it a width of its own: sentences that wrap ask for their height by that."""
        self._inside.setFixedWidth(min(px(WIDEST), self.width()))


class _SensorLines(QWidget):
    """The sensors one below the other, each with its state for a screen reader."""

    def __init__(self) -> None:
        super().__init__()
        self._shown: tuple[SensorLine, ...] = ()
        self._rows: list[tuple[QWidget, IconMark, Text]] = []
        self._column = lay_out(QVBoxLayout(self), margins=0, spacing=0)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)

    def show_lines(self, lines: Sequence[SensorLine]) -> None:
        if tuple(lines) == self._shown:
            return
        self._shown = tuple(lines)
        self.setVisible(bool(lines))
        while len(self._rows) < len(lines):
            self._add_row()
        for number, (row, mark, words) in enumerate(self._rows):
            row.setVisible(number < len(lines))
            if number < len(lines):
                line = lines[number]
                tone = "ink2" if line.state is LineState.TO_DO else "ink"
                mark.set_icon(_ICONS[line.state], tone)
                words.set_tone(tone)
                words.setText(f"{line.name} · {line.words}" if line.words else line.name)
                words.setAccessibleName(f"{line.name} {line.words or _STATES[line.state]()}")

    def _add_row(self) -> None:
        row, mark, words = QWidget(), IconMark(Icon.UNCHECKED, MARK), Text(weight=MEDIUM)
        words.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)  # the page is no wider for it
        lay_out(QHBoxLayout(row), mark, (words, 1), margins=0, spacing=GAP)
        scaled(row.setFixedHeight, LINE)
        self._column.addWidget(row)
        self._rows.append((row, mark, words))


_ICONS = {
    LineState.DONE: Icon.CHECK,
    LineState.NOW: Icon.NEXT,
    LineState.TO_DO: Icon.UNCHECKED,
    LineState.WRONG: Icon.WARNING,
}
_STATES = {
    LineState.DONE: lambda: tr("done"),
    LineState.NOW: lambda: tr("now"),
    LineState.TO_DO: lambda: tr("to do"),
    LineState.WRONG: lambda: tr("needs checking"),
}

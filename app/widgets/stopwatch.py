"""Stopwatch of the session: the time since it began, and a line that grows to the target; never an alarm."""

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, px
from app.widgets.painted import Painted
from app.widgets.painted_text import RIGHT, PaintedText
from app.widgets.text import SEMIBOLD
from app.wording.numbers import clock
from app.wording.translation import tr

TARGET_S = 300  # from the first sensor to the first stride
LINE = 96
THICK = 5


class Stopwatch(Painted):
    """Passive: it shows what it is given."""

    def __init__(self) -> None:
        super().__init__()
        self._is_compact, self._elapsed_s = False, 0
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.show_elapsed(0.0)

    def show_elapsed(self, elapsed_s: float) -> None:
        if self.accessibleName() and int(elapsed_s) == self._elapsed_s:
            return
        self._elapsed_s = int(max(elapsed_s, 0.0))
        self.setAccessibleName(f"{clock(self._elapsed_s, 2)}, {self._words()}")
        self.update()

    def set_compact(self, is_compact: bool) -> None:
        """Leave the line away; its words stay."""
        self._is_compact = is_compact
        self._refresh()

    def sizeHint(self) -> QSize:
        words, time = self._columns()
        return QSize(words + px(16) + time, px(40))

    def painted_texts(self) -> list[PaintedText]:
        """Give what is painted now, each in its box."""
        theme = current_theme()
        words, time = self._columns()
        return [
            PaintedText(self._words(), self._words_box(words), theme.font(12), "ink2", RIGHT),
            PaintedText(
                clock(self._elapsed_s, 2),
                QRectF(self.width() - time, 0, time, self.height()),
                theme.font(self._time_size(), SEMIBOLD),
                align=RIGHT,
            ),
        ]

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        if self._is_compact:
            return
        words = self._words_box(self._columns()[0])
        line = QRectF(words.right() - px(LINE), words.bottom() + px(4), px(LINE), px(THICK))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(c.track))
        painter.drawRoundedRect(line, line.height() / 2, line.height() / 2)
        share = min(self._elapsed_s / TARGET_S, 1.0)
        line.setWidth(max(share * line.width(), line.height()))
        painter.setBrush(QColor(c.ink))
        painter.drawRoundedRect(line, line.height() / 2, line.height() / 2)

    def _words_box(self, width: int) -> QRectF:
        height = self.height() if self._is_compact else px(18)
        top = 0 if self._is_compact else (self.height() - px(18 + 6 + THICK)) / 2
        return QRectF(0, top, width, height)

    def _words(self) -> str:
        minutes = TARGET_S // 60
        if self._elapsed_s > TARGET_S:
            return tr("{minutes} min target exceeded").format(minutes=minutes)
        return tr("of {minutes} min target").format(minutes=minutes)

    def _time_size(self) -> int:
        return 22 if self._is_compact else 26

    def _columns(self) -> tuple[int, int]:
        """Give the widths of words and time, from all they may say: the header must not shift."""
        theme = current_theme()
        minutes = TARGET_S // 60
        small = QFontMetrics(theme.font(12))
        stated = [tr("{minutes} min target exceeded"), tr("of {minutes} min target")]
        widest = max(small.horizontalAdvance(words.format(minutes=minutes)) for words in stated)
        large = QFontMetrics(theme.font(self._time_size(), SEMIBOLD))
        time = max(large.horizontalAdvance("00:00"), large.horizontalAdvance(clock(self._elapsed_s, 2)))
        return max(widest + theme.px(2), theme.px(LINE)), time + theme.px(2)

    def _refresh(self) -> None:
        self.updateGeometry()
        self.update()

"""The one thing to do now, in a band that is read from two metres, with the time that has gone."""

from dataclasses import dataclass

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QColor, QFontMetrics, QPainter
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, px
from app.theme.icons import Icon, paint_icon
from app.theme.theme import CARD_RADIUS
from app.widgets.painted import Painted
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wording.numbers import clock
from app.wording.translation import tr

HEIGHT, COMPACT_HEIGHT, LARGE_HEIGHT = 112, 84, 144
SENTENCE, COMPACT_SENTENCE, LARGE_SENTENCE = 56, 40, 72
LARGE_FROM = 1500


@dataclass(frozen=True, slots=True)
class Hint:
    """`sentence` has at most 28 letters; `how` is the second line, `how_short` where there is little room.

    `phrase`: the name of the spoken prompt that has the same sentence.
    """

    sentence: str
    how: str = ""
    how_short: str = ""
    icon: Icon = Icon.REPEAT
    phrase: str = ""


class HintBand(Painted):
    accessible_role = QAccessible.Role.Note

    def __init__(self) -> None:
        super().__init__()
        self._hint = Hint("")
        self._elapsed, self._usual = "", ""
        self._is_compact = False
        self.setSizePolicy(QSizePolicy.Policy.MinimumExpanding, QSizePolicy.Policy.Fixed)

    @property
    def hint(self) -> Hint:
        return self._hint

    def show_hint(self, hint: Hint) -> None:
        """Show what to do; whoever cannot see it is notified when the sentence changes."""
        if hint == self._hint:
            return
        is_news = hint.sentence != self._hint.sentence
        self._hint = hint
        self.setAccessibleName(f"{hint.sentence}. {hint.how}")
        if is_news:
            QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, self.accessibleName()))
        self.update()

    def show_elapsed(self, elapsed_s: float | None, usual_s: float) -> None:
        """Show whole seconds; None while nothing is recorded."""
        elapsed = "" if elapsed_s is None else clock(elapsed_s, 2)
        usual = tr("usually {seconds:.0f} s").format(seconds=usual_s)
        if (elapsed, usual) != (self._elapsed, self._usual):
            self._elapsed, self._usual = elapsed, usual
            self.update(self._clock().toAlignedRect())

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        height = COMPACT_HEIGHT if self._is_compact else LARGE_HEIGHT if self._is_large else HEIGHT
        return QSize(px(480), px(height))

    def draw(self, painter: QPainter) -> None:
        theme, hint = current_theme(), self._hint
        c, px = theme.colours, theme.px
        theme.paint_box(painter, QRectF(self.rect()), c.inv, radius=CARD_RADIUS)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        middle = self.height() / 2
        side = px(40) if self._is_compact else px(70)
        mark = QRectF(px(18 if self._is_compact else 27), middle - side / 2, side, side)
        if not self._is_compact:
            painter.setPen(theme.pen(c.inv_ink2, 1.5))
            painter.drawEllipse(mark)
            mark.adjust(px(13), px(13), -px(13), -px(13))
        paint_icon(painter, hint.icon, mark, c.inv_ink)
        left = px(72 if self._is_compact else 120)
        clock = self._clock()
        words = QRectF(left, 0, clock.left() - px(12) - left, self.height())
        self._paint_words(painter, words)
        painter.setPen(QColor(c.inv_ink))
        painter.setFont(theme.font(34 if self._is_compact else 40, SEMIBOLD))
        right = Qt.AlignmentFlag.AlignRight
        half = clock.height() * 0.58
        upper = QRectF(clock.left(), clock.top(), clock.width(), half)
        painter.drawText(upper, right | Qt.AlignmentFlag.AlignBottom, self._elapsed)
        painter.setPen(QColor(c.inv_ink2))
        painter.setFont(theme.font(14 if self._is_compact else 16, MEDIUM))
        lower = QRectF(clock.left(), clock.top() + half + px(4), clock.width(), clock.height() - half)
        painter.drawText(lower, right | Qt.AlignmentFlag.AlignTop, self._usual if self._elapsed else "")

    def _paint_words(self, painter: QPainter, words: QRectF) -> None:
        """The sentence as large as it may be and still fits; what to add under it."""
        theme, hint = current_theme(), self._hint
        c, px = theme.colours, theme.px
        size: float = COMPACT_SENTENCE if self._is_compact else LARGE_SENTENCE if self._is_large else SENTENCE
        width = QFontMetrics(theme.font(size, SEMIBOLD)).horizontalAdvance(hint.sentence)
        if width > words.width():
            size = max(24.0, size * words.width() / width)
        note_size = 16 if self._is_compact else 20
        note = theme.font(note_size)
        how = hint.how
        if self._is_compact or QFontMetrics(note).horizontalAdvance(how) > words.width():
            how = hint.how_short or hint.how
        gap = 0.66 if how else 1.0
        painter.setPen(QColor(c.inv_ink))
        painter.setFont(theme.font(size, SEMIBOLD))
        upper = QRectF(words.left(), words.top() + px(2), words.width(), words.height() * gap)
        painter.drawText(upper, int(Qt.AlignmentFlag.AlignVCenter) | int(Qt.TextFlag.TextDontClip), hint.sentence)
        painter.setPen(QColor(c.inv_ink2))
        painter.setFont(note)
        lower = QRectF(words.left(), upper.bottom(), words.width(), words.height() * 0.26)
        painter.drawText(lower, Qt.AlignmentFlag.AlignVCenter, how)

    @property
    def _is_large(self) -> bool:
        return not self._is_compact and self.width() >= px(LARGE_FROM)

    def _clock(self) -> QRectF:
        small = current_theme().font(14 if self._is_compact else 16, MEDIUM)
        width = max(px(128), QFontMetrics(small).horizontalAdvance(self._usual) + px(4))
        height = px(64 if self._is_compact else 88)
        return QRectF(self.width() - px(24) - width, (self.height() - height) / 2, width, height)

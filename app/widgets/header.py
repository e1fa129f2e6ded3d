"""Header line at the top of every page: whose session is on the screen, and whether it is real."""

from PySide6.QtCore import QPoint, QPointF, QRect, QSize, Qt
from PySide6.QtGui import QPainter, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.theme import CHIP_RADIUS
from app.widgets.grid import LEAST, side_margin
from app.widgets.painted import Painted
from app.widgets.stopwatch import Stopwatch
from app.widgets.strip_button import StripButton
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr
from core.body import Side

HEIGHT = 56
COMPACT_HEIGHT = 48
FACTS_AT_LEAST = 120  # narrower, the lines break after every word


class Header(QWidget):
    """With the rail beside it, it needs neither mark nor name; `fold` and `stopwatch` are hidden until they are used.

    Where all does not fit into one line, what is at the right moves to a second.
    """

    def __init__(self, has_mark: bool = True) -> None:
        super().__init__()
        self._has_mark, self._is_compact = has_mark, False
        set_ground(self, Ground("surface", "line", edge=Qt.Edge.BottomEdge))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self._mark = ProductMark()
        self._name = Text("Gaitwright", size=18, weight=SEMIBOLD)
        self.code = Text(size=22, weight=SEMIBOLD, is_code=True)
        self.facts = Text(size=14, tone="ink2", wraps=True)
        self.simulated = Tag(tr("SIMULATED"))
        self.fold = StripButton()
        self.stopwatch = Stopwatch()
        self._left: list[QWidget] = [self._mark, self._name, self.code, self.facts, self.simulated]
        self._right: list[QWidget] = [self.fold, self.stopwatch]
        for widget in (*self._left, *self._right):
            widget.setParent(self)
        for widget in (*self._right, self.simulated):
            widget.hide()
        self._mark.setVisible(has_mark)
        self.fold.resized.connect(self._arrange)
        self._shown: tuple[str, str, bool] | None = None
        self.show_session("", "", is_simulated=False)
        on_theme(self._arrange)

    def show_session(self, code: str, facts: str, is_simulated: bool) -> None:
        """Show the patient's code and what the clinic typed; without a session, the program's name."""
        if (shown := (code, facts, is_simulated)) == self._shown:
            return
        self._shown = shown
        for label, text in ((self.code, code), (self.facts, facts)):
            label.setText(text)
            label.setVisible(bool(text))
        self._name.setVisible(self._has_mark and not code)
        self.simulated.setVisible(is_simulated)
        self._arrange()

    def show_elapsed(self, elapsed_s: float | None) -> None:
        """Show how long the session has taken; None: nobody is waiting, it is only looked at."""
        if elapsed_s is not None:
            self.stopwatch.show_elapsed(elapsed_s)
        if self.stopwatch.isHidden() == (elapsed_s is not None):
            self.stopwatch.setVisible(elapsed_s is not None)
            self._arrange()

    def set_fold_shown(self, is_shown: bool) -> None:
        """Show the sensors as a button that unfolds their strip, or take it away."""
        self.fold.setVisible(is_shown)
        self._arrange()

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self.fold.set_compact(is_compact)
        self.stopwatch.set_compact(is_compact)
        self._arrange()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self._arrange()

    def _arrange(self) -> None:
        margin, gap = side_margin(self.width(), current_theme()), px(16)
        line = px(COMPACT_HEIGHT if self._is_compact else HEIGHT)
        room = max(self.width(), px(LEAST)) - 2 * margin
        left = [widget for widget in self._left if not widget.isHidden()]
        right = [widget for widget in self._right if not widget.isHidden()]
        facts = self.facts.fontMetrics().horizontalAdvance(self.facts.text()) + px(2) if self.facts in left else 0
        others = sum(_size(widget).width() for widget in left if widget is not self.facts)
        others += gap * max(len(left) - 1, 0)
        taken = sum(_size(widget).width() + gap for widget in right)
        is_one_line = others + min(facts, px(FACTS_AT_LEAST)) + taken <= room
        free = room - others - (taken if is_one_line else 0)
        has_own_line = facts > 0 and free < min(facts, px(FACTS_AT_LEAST))  # below the rest, from edge to edge
        width = max(min(facts, room if has_own_line else free), 1)
        high = self.facts.heightForWidth(width) if facts else 0
        height = max(0 if has_own_line else high, line - px(8))
        top = px(4)
        x = margin
        for widget in left:
            if widget is self.facts and has_own_line:
                continue
            size = QSize(width, high) if widget is self.facts else _size(widget)
            widget.setGeometry(QRect(QPoint(x, top + (height - size.height()) // 2), size))
            x += size.width() + gap
        if has_own_line:
            self.facts.setGeometry(margin, top + height, width, high)
            height += high
        rows = [right]
        if not is_one_line:
            top += height
            height = line - px(8)
            if taken - gap > room:
                rows = [[widget] for widget in right]
        for row in rows:
            x = margin + room
            for widget in reversed(row):
                size = _size(widget)
                x -= size.width()
                widget.setGeometry(QRect(QPoint(x, top + (height - size.height()) // 2), size))
                x -= gap
            top += height
        self.setFixedHeight(top + px(4))


def _size(widget: QWidget) -> QSize:
    return widget.sizeHint().expandedTo(widget.minimumSize())


class ProductMark(Painted):
    """The program's mark: two legs, left solid, right dashed."""

    def __init__(self) -> None:
        super().__init__()
        scaled(self.setFixedSize, 28, 28)

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        unit = self.width() / 24
        hip = QPointF(12.5 * unit, 2.5 * unit)
        for side, foot in ((Side.RIGHT, 3.5), (Side.LEFT, 20.5)):  # it faces you: the right leg is at your left
            pen = theme.pen(theme.curve(side), 3.4)
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)
            if side is Side.RIGHT:
                pen.setDashPattern([1.6, 0.8])
            painter.setPen(pen)
            painter.drawLine(hip, QPointF(foot * unit, 21 * unit))


class Tag(Text):
    """A word that must not be overlooked, on yellow."""

    def __init__(self, text: str) -> None:
        super().__init__(text, size=13, weight=SEMIBOLD, tone="caution_ink")
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        set_ground(self, Ground("caution", "caution_edge", 1.25, CHIP_RADIUS, inset=1))
        scaled(self.setContentsMargins, 10, 4, 10, 4)

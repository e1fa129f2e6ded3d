"""A figure that goes up and down in steps, by keys or by pressing its ends: no keyboard of digits is needed."""

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QAccessible, QFontMetrics, QKeyEvent, QMouseEvent, QPainter
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, px
from app.widgets.painted import Painted
from app.widgets.painted_text import CENTRE, LEFT, PaintedText
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wording.numbers import MINUS
from app.wording.translation import tr

CAPTION, BOX, END = 18, 44, 32
LEAST = 116
UP = (Qt.Key.Key_Plus, Qt.Key.Key_Equal, Qt.Key.Key_Up, Qt.Key.Key_Right)
DOWN = (Qt.Key.Key_Minus, Qt.Key.Key_Underscore, Qt.Key.Key_Down, Qt.Key.Key_Left)


class Stepper(Painted):
    """`stepped` gives the direction, 1 or -1; whoever receives it sets what is shown then."""

    accessible_role = QAccessible.Role.SpinBox

    stepped = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.caption, self.value = "", ""
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def show_value(self, caption: str, value: str) -> None:
        self.caption, self.value = caption, value
        self.setAccessibleName(f"{caption}: {value}")
        self.setAccessibleDescription(tr("The plus and minus keys change the value."))
        self.updateGeometry()
        self.update()

    def minimumSizeHint(self) -> QSize:
        theme = current_theme()
        caption = QFontMetrics(theme.font(12)).horizontalAdvance(self.caption)
        value = QFontMetrics(theme.font(14, SEMIBOLD)).horizontalAdvance(self.value) + 2 * px(END)
        return QSize(max(px(LEAST), caption + 2, value + 2), px(CAPTION + BOX))

    def painted_texts(self) -> list[PaintedText]:
        theme, box = current_theme(), self._box
        end, sign = theme.px(END), theme.font(16, MEDIUM)
        caption = QRectF(0, 0, self.width(), theme.px(CAPTION))
        less = QRectF(0, box.top(), end, box.height())
        more = QRectF(box.right() - end, box.top(), end, box.height())
        return [
            PaintedText(self.caption, caption, theme.font(12), "ink2", LEFT),
            PaintedText(MINUS, less, sign, "ink", CENTRE),
            PaintedText(self.value, box.adjusted(end, 0, -end, 0), theme.font(14, SEMIBOLD), "ink", CENTRE),
            PaintedText("+", more, sign, "ink", CENTRE),
        ]

    def keyPressEvent(self, event: QKeyEvent) -> None:
        by = 1 if event.key() in UP else -1 if event.key() in DOWN else 0
        if by:
            self.stepped.emit(by)
        else:
            super().keyPressEvent(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        end, x = px(END), event.position().x()
        if event.position().y() >= self._box.top() and (x < end or x > self.width() - end):
            self.stepped.emit(-1 if x < end else 1)

    def draw(self, painter: QPainter) -> None:
        c, box = current_theme().colours, self._box.adjusted(1, 1, -1, -1)
        current_theme().paint_box(painter, box, c.surface, c.control)

    @property
    def _box(self) -> QRectF:
        top = px(CAPTION)
        return QRectF(0, top, self.width(), self.height() - top)

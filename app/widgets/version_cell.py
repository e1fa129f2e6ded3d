"""One of two versions of a value: what it shows and whose it is, to be chosen. Arrows are signalled, not followed."""

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QKeyEvent, QPainter, QPaintEvent, QStaticText, QTextOption, QTransform
from PySide6.QtWidgets import QAbstractButton, QSizePolicy

from app.theme.current import current_theme, px, scaled
from app.widgets.painted import smooth_painter

PADDING, MARK, GAP = 14, 20, 12
VALUE_SIZE, WHOSE_SIZE = 16, 14
LEAST = 160
ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}


class VersionCell(QAbstractButton):
    """As high as its words need; the one that is chosen has a filled mark and a bold edge."""

    moved = Signal(int, int)  # an arrow was pressed: columns to the right, rows down
    confirmed = Signal()  # Enter was pressed

    def __init__(self, field: str, value: str, whose: str) -> None:
        super().__init__()
        self.value, self.whose = value, whose
        self.setCheckable(True)
        self.setText(value)
        self.setAccessibleName(f"{field}, {whose}: {value}")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        policy = QSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        policy.setHeightForWidth(True)
        scaled(self.setMinimumWidth, LEAST)
        self.setSizePolicy(policy)

    def heightForWidth(self, width: int) -> int:  # noqa: N802  Qt calls it
        value, whose = self._texts(width - px(2 * PADDING + MARK + GAP))
        return round(value.size().height() + whose.size().height()) + px(2 * PADDING + 2)

    def sizeHint(self) -> QSize:
        width = px(LEAST)
        return QSize(width, self.heightForWidth(width))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        key = Qt.Key(event.key())
        if key in ARROWS:
            self.moved.emit(*ARROWS[key])
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.confirmed.emit()
        else:
            super().keyPressEvent(event)

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        painter = smooth_painter(self)
        inset = px(1)
        box = QRectF(self.rect()).adjusted(inset, inset, -inset, -inset)
        is_strong = self.isChecked() or self.hasFocus()
        theme.paint_box(painter, box, c.surface, c.ink if is_strong else c.control, 2 if is_strong else 1)
        if self.underMouse() or self.isDown():
            theme.paint_box(painter, box, theme.veil(self.isDown()))
        if self.hasFocus():
            theme.paint_box(painter, box.adjusted(px(3), px(3), -px(3), -px(3)), None, c.ink, 1)
        self._paint_mark(painter)
        left = px(PADDING + MARK + GAP)
        value, whose = self._texts(self.width() - left - px(PADDING))
        below = px(PADDING + 2) + value.size().height()
        for text, top, size, colour in ((value, px(PADDING), VALUE_SIZE, c.ink), (whose, below, WHOSE_SIZE, c.ink2)):
            painter.setFont(self._font(size))
            painter.setPen(QColor(colour))
            painter.drawStaticText(QPointF(left, top), text)

    def _paint_mark(self, painter: QPainter) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        box = QRectF(px(PADDING), px(PADDING) + px(1), px(MARK), px(MARK))
        painter.setPen(theme.pen(c.ink if self.isChecked() else c.control, 1.5))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(box)
        if self.isChecked():
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(c.ink))
            painter.drawEllipse(box.adjusted(px(5), px(5), -px(5), -px(5)))

    def _texts(self, width: float) -> tuple[QStaticText, QStaticText]:
        """Value and whose it is, laid out in lines; a word that is too long for one is broken."""
        option = QTextOption()
        option.setWrapMode(QTextOption.WrapMode.WrapAtWordBoundaryOrAnywhere)
        texts = QStaticText(self.value), QStaticText(self.whose)
        for text, size in zip(texts, (VALUE_SIZE, WHOSE_SIZE), strict=True):
            text.setTextFormat(Qt.TextFormat.PlainText)
            text.setTextOption(option)
            text.setTextWidth(max(width, 1.0))
            text.prepare(QTransform(), self._font(size))
        return texts

    def _font(self, size: float) -> QFont:
        return current_theme().font(size, QFont.Weight.Medium if size == VALUE_SIZE else QFont.Weight.Normal)

"""All sensors in one sentence, which unfolds into tiles."""

from collections.abc import Mapping

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QFont, QFontMetrics, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractButton, QSizePolicy

from app.theme.current import current_theme, px
from app.widgets.body_figure import paint_legs
from app.widgets.painted_text import PaintedText
from app.widgets.sensor_tile import SensorTile, marks, sentence
from app.widgets.text import SEMIBOLD
from core.body import Site


class StripButton(QAbstractButton):
    """The strip in one sentence, where the page has no need of it; pressing it unfolds the strip."""

    resized = Signal()  # its words have another length

    def __init__(self) -> None:
        super().__init__()
        self._is_compact = False
        self._tiles: dict[Site, SensorTile] = {}
        self.setCheckable(True)  # checked: the strip is unfolded
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self.show_tiles({})

    def show_tiles(self, tiles: Mapping[Site, SensorTile]) -> None:
        words = sentence(tiles)
        if words != self.text() or marks(tiles) != marks(self._tiles):
            self._tiles = dict(tiles)
            self.setText(words)
            self.setAccessibleName(words)
            self._refresh()
            self.resized.emit()

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self._refresh()

    def sizeHint(self) -> QSize:
        theme = current_theme()
        words = QFontMetrics(self._font()).horizontalAdvance(self.text())
        return QSize(self._text_left() + words + theme.px(16), theme.px(44 if not self._is_compact else 40))

    def painted_texts(self) -> list[PaintedText]:
        """Give the sentence in its box."""
        box = QRectF(self.rect()).adjusted(self._text_left(), 0, -px(14), 0)
        return [PaintedText(self.text(), box, self._font(), "caution_ink" if self._is_bad() else "ink")]

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        painter = QPainter(self)
        is_bad, box = self._is_bad(), QRectF(self.rect()).adjusted(1, 1, -1, -1)
        line = c.ink if self.isChecked() else c.caution_edge if is_bad else c.control
        width = 1.75 if self.isChecked() or is_bad else 1.25
        theme.paint_box(painter, box, c.caution if is_bad else c.ground, line, width)
        if self.underMouse() or self.isDown():
            theme.paint_box(painter, box, theme.veil(self.isDown()))
        legs = QRectF(px(12), px(5), px(24), self.height() - 2 * px(5))
        paint_legs(painter, legs, theme, None, marks(self._tiles))
        for text in self.painted_texts():
            text.paint(painter, c)

    def _is_bad(self) -> bool:
        return any(tile.is_bad for tile in self._tiles.values())

    def _font(self) -> QFont:
        return current_theme().font(14, SEMIBOLD)

    def _text_left(self) -> int:
        return px(44)

    def _refresh(self) -> None:
        self.updateGeometry()
        self.update()

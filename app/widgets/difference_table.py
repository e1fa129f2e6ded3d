"""The figures of what is compared, and their differences: one row per measure and leg, marked where error is left."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter
from PySide6.QtWidgets import (
    QHeaderView,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QWidget,
)

from app.icons import Icon, paint_icon
from app.theme import Look
from app.widgets.bare_table import ROW, BareTable
from app.widgets.chip import CHIP, paint_chip
from app.widgets.text import SEMIBOLD
from core.body import Side

HEAD = 32
PADDING = 6
MARK = 16
Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True, slots=True)
class Cell:
    """A value and what stands smaller behind it; `is_marked`: bold with a triangle; `is_grey`: not to be relied on."""

    value: str
    addition: str = ""
    is_marked: bool = False
    is_grey: bool = False

    @property
    def words(self) -> str:
        return " ".join(filter(None, [self.value, self.addition]))


@dataclass(frozen=True, slots=True)
class DifferenceTableRow:
    """`side` stands as a chip before the name; None where a row is of both legs."""

    name: str
    side: Side | None
    cells: tuple[Cell, ...]


class DifferenceTableModel(QAbstractTableModel):
    def __init__(self) -> None:
        super().__init__()
        self.head: Sequence[str] = ()
        self.rows: Sequence[DifferenceTableRow] = ()

    def show_rows(self, head: Sequence[str], rows: Sequence[DifferenceTableRow]) -> None:
        self.beginResetModel()
        self.head, self.rows = head, rows
        self.endResetModel()

    def cell(self, index: Index) -> Cell:
        row = self.rows[index.row()]
        return Cell(row.name) if index.column() == 0 else row.cells[index.column() - 1]

    def rowCount(self, _parent: Index = QModelIndex()) -> int:  # noqa: B008  Qt's own signature
        return len(self.rows)

    def columnCount(self, _parent: Index = QModelIndex()) -> int:  # noqa: B008  Qt's own signature
        return len(self.head)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        if role not in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.AccessibleTextRole):
            return None
        words = self.cell(index).words
        row = self.rows[index.row()]
        if role == Qt.ItemDataRole.DisplayRole or index.column() == 0:
            return words
        side = f"{row.side[0].upper()} " if row.side is not None else ""
        return f"{side}{row.name}, {self.head[index.column()]}: {words}"

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        is_head = role == Qt.ItemDataRole.DisplayRole and orientation == Qt.Orientation.Horizontal
        return self.head[section] if is_head and section < len(self.head) else None


class DifferenceTable(BareTable):
    def __init__(self, look: Look, name: str) -> None:
        model = DifferenceTableModel()
        super().__init__(look, model, name, HEAD)
        self.figures = model
        self.dress(_Header(look, self), _Delegate(look, self))

    def show_rows(self, head: Sequence[str], rows: Sequence[DifferenceTableRow]) -> None:
        """Show `rows`, whose cells stand under all of `head` but the first, which is the name's."""
        self.figures.show_rows(head, rows)
        self.fit()

    def as_text(self) -> str:
        """Give the table as tab-separated lines."""
        lines = [["", *self.figures.head]]
        for row in self.figures.rows:
            side = row.side[0].upper() if row.side is not None else ""
            lines.append([side, row.name, *(cell.words for cell in row.cells)])
        return "\n".join("\t".join(cells) for cells in lines)


class _Delegate(QStyledItemDelegate):
    def __init__(self, look: Look, parent: QWidget) -> None:
        super().__init__(parent)
        self._look = look

    def sizeHint(self, _option: QStyleOptionViewItem, index: Index) -> QSize:
        px, cell = self._look.theme.px, _model(index).cell(index)
        large, small = self._fonts(cell, index.column() == 0)
        width = QFontMetrics(large).horizontalAdvance(cell.value) + QFontMetrics(small).horizontalAdvance(cell.addition)
        width += px(4) if cell.value and cell.addition else 0
        width += px(MARK + 4) if cell.is_marked else 0
        width += px(CHIP + 8) if index.column() == 0 and _model(index).rows[index.row()].side is not None else 0
        return QSize(width + 2 * px(PADDING) + 1, px(ROW))

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        theme, model = self._look.theme, _model(index)
        c, px, rect = theme.colours, theme.px, QRectF(option.rect)
        cell, row = model.cell(index), model.rows[index.row()]
        large, small = self._fonts(cell, index.column() == 0)
        painter.save()
        painter.setPen(theme.pen(c.line, 1))
        painter.drawLine(rect.topLeft(), rect.topRight())
        inner = rect.adjusted(px(PADDING), 0, -px(PADDING), 0)
        ink = QColor(c.ink3 if cell.is_grey else c.ink)
        middle = rect.center().y()
        if index.column() == 0:
            if row.side is not None:
                chip = px(CHIP)
                paint_chip(painter, QRectF(rect.left(), middle - chip / 2, chip, chip), row.side, theme)
            inner.setLeft(rect.left() + (px(CHIP + 8) if row.side is not None else 0))
            self._draw(painter, inner, cell.value, large, ink, Qt.AlignmentFlag.AlignLeft)
        else:
            self._draw(painter, inner, cell.addition, small, QColor(c.ink2), Qt.AlignmentFlag.AlignRight)
            if cell.addition:
                inner.setRight(inner.right() - QFontMetrics(small).horizontalAdvance(cell.addition) - px(4))
            self._draw(painter, inner, cell.value, large, ink, Qt.AlignmentFlag.AlignRight)
            if cell.is_marked:
                side = px(MARK)
                x = inner.right() - QFontMetrics(large).horizontalAdvance(cell.value) - px(4) - side
                paint_icon(painter, Icon.WARNING, QRectF(x, middle - side / 2, side, side), c.ink)
        painter.restore()

    def _draw(
        self, painter: QPainter, room: QRectF, text: str, font: QFont, ink: QColor, way: Qt.AlignmentFlag
    ) -> None:
        painter.setFont(font)
        painter.setPen(ink)
        painter.drawText(room, way | Qt.AlignmentFlag.AlignVCenter, text)

    def _fonts(self, cell: Cell, is_name: bool) -> tuple[QFont, QFont]:
        theme = self._look.theme
        if is_name:
            return theme.font(14), theme.font(12)
        return theme.font(15, SEMIBOLD if cell.is_marked else QFont.Weight.Normal), theme.font(12)


class _Header(QHeaderView):
    def __init__(self, look: Look, parent: QWidget) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self._look = look
        self.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.setMinimumSectionSize(1)
        self.setSectionsClickable(False)

    def sectionSizeFromContents(self, section: int) -> QSize:
        px = self._look.theme.px
        width = QFontMetrics(self._look.theme.font(12)).horizontalAdvance(self._word(section))
        return QSize(width + 2 * px(PADDING) + 1, px(HEAD))

    def paintSection(self, painter: QPainter, rect: object, section: int) -> None:
        theme = self._look.theme
        box = QRectF(rect)  # type: ignore[call-overload]  # the stubs call it an object
        painter.save()
        painter.setPen(QColor(theme.colours.ink2))
        painter.setFont(theme.font(12))
        way = Qt.AlignmentFlag.AlignRight if section else Qt.AlignmentFlag.AlignLeft
        box = box.adjusted(0, 0, -theme.px(PADDING) if section else 0, 0)
        painter.drawText(box, way | Qt.AlignmentFlag.AlignVCenter, self._word(section))
        painter.restore()

    def _word(self, section: int) -> str:
        model = self.model()
        assert isinstance(model, DifferenceTableModel)
        return model.head[section] if section < len(model.head) else ""


def _model(index: Index) -> DifferenceTableModel:
    model = index.model()
    assert isinstance(model, DifferenceTableModel)
    return model

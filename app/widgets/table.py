"""The one table of the application: plain rows of cells, standing on a page like text or scrolling as a list."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import (
    QAbstractTableModel,
    QEvent,
    QModelIndex,
    QPersistentModelIndex,
    QPointF,
    QRectF,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import QColor, QFocusEvent, QKeyEvent, QKeySequence, QPainter, QResizeEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QHeaderView,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
)

from app.theme.current import current_theme, px
from app.widgets.table_cells import EMPTY, TableCell

ROW, HEAD, PADDING = 28, 32, 6
LEAST_ROWS = 2.5  # of a list in sight: half a row shows that there are more
Index = QModelIndex | QPersistentModelIndex
ROOT = QModelIndex()


@dataclass(frozen=True, slots=True)
class TableColumn:
    """`head`: shown above. `share`: its part of what the columns do not need; where none has one, the last takes all.

    `widest` is measured in place of all cells, which is for tables of hundreds of rows; `least`: px of the design.
    `hint` explains its head under the mouse.
    """

    head: TableCell = EMPTY
    share: int = 0
    widest: TableCell | None = None
    least: int = 0
    is_hidden: bool = False
    hint: str = ""


@dataclass(frozen=True, slots=True)
class TableRow:
    """Cells, one for each column. `key` names the row in a list; `hint` explains it under the mouse."""

    cells: tuple[TableCell, ...]
    key: Hashable = None
    hint: str = ""
    is_heading: bool = False


class TableModel(QAbstractTableModel):
    """Columns and rows, replaced as a whole."""

    def __init__(self) -> None:
        super().__init__()
        self.columns: tuple[TableColumn, ...] = ()
        self.rows: tuple[TableRow, ...] = ()

    def show(self, columns: Sequence[TableColumn], rows: Sequence[TableRow]) -> None:
        """Show other rows, or what became of the same ones: those stay where they are, and so does the focus."""
        keys = [row.key for row in rows]
        is_same = len(columns) == len(self.columns) and None not in keys and keys == [row.key for row in self.rows]
        if is_same and rows:
            self.columns, self.rows = tuple(columns), tuple(rows)
            self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, len(columns) - 1)
            self.dataChanged.emit(self.index(0, 0), self.index(len(rows) - 1, len(columns) - 1))
            return
        self.beginResetModel()
        self.columns, self.rows = tuple(columns), tuple(rows)
        self.endResetModel()

    def cell(self, index: Index) -> TableCell:
        return self.rows[index.row()].cells[index.column()]

    def rowCount(self, parent: Index = ROOT) -> int:
        return 0 if parent.isValid() else len(self.rows)

    def columnCount(self, parent: Index = ROOT) -> int:
        return 0 if parent.isValid() else len(self.columns)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        cell = self.cell(index)
        match role:
            case Qt.ItemDataRole.DisplayRole:
                return cell.words
            case Qt.ItemDataRole.AccessibleTextRole:
                return cell.stated
            case Qt.ItemDataRole.ToolTipRole:
                return self.rows[index.row()].hint or None
            case Qt.ItemDataRole.CheckStateRole if cell.is_checked is not None:
                return Qt.CheckState.Checked if cell.is_checked else Qt.CheckState.Unchecked
        return None

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation != Qt.Orientation.Horizontal or section >= len(self.columns):
            return None
        head = self.columns[section].head
        match role:
            case Qt.ItemDataRole.DisplayRole:
                return head.words
            case Qt.ItemDataRole.AccessibleTextRole:
                return head.stated
            case Qt.ItemDataRole.ToolTipRole:
                return self.columns[section].hint or None
        return None


class CellTable(QTableView):
    """On a page as high as its rows, without scroll bars, and copied as tab-separated text.

    A list (`is_list`) scrolls, has rows of one height, and one of them may be chosen: by mouse, arrows, Home and End.
    Every column has what its widest cell needs; what is left is shared. Lengths are in px of the design: `row` and
    `head` (0: none) the heights, `padding` at both sides of a cell, `edge` before the first column.
    """

    chosen = Signal(object)  # the key of the row in force, or None
    opened = Signal(object)  # the key of the row at which Enter was pressed

    def __init__(
        self,
        name: str,
        *,
        row: int = ROW,
        head: int = HEAD,
        padding: int = PADDING,
        edge: int = 0,
        is_list: bool = False,
    ) -> None:
        super().__init__()
        self._row, self._head, self._padding, self._edge = row, head, padding, edge
        self._is_list = is_list
        self.needed_widths: list[int] = []  # px of the screen by column; nothing for a hidden one
        self.cells = TableModel()
        self.cells.setParent(self)
        self.setModel(self.cells)
        self.setHorizontalHeader(_Header(self))
        self.horizontalHeader().setVisible(head > 0)
        self.verticalHeader().hide()
        self.verticalHeader().setMinimumSectionSize(1)
        self.setItemDelegate(_Delegate(self))
        self.setAccessibleName(name)
        self.setShowGrid(False)
        self.setFrameShape(QTableView.Shape.NoFrame)
        self.setCornerButtonEnabled(False)
        self.setTabKeyNavigation(False)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        if is_list:
            self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
            self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
            self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
            self.setMouseTracking(True)
            self.selectionModel().currentRowChanged.connect(self._on_current_row_changed)
        else:
            self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)

    def show_rows(self, columns: Sequence[TableColumn], rows: Sequence[TableRow]) -> None:
        """Show `rows`, whose cells stand under `columns`."""
        self.clearSpans()
        self.cells.show(columns, rows)
        for number, column in enumerate(columns):
            self.setColumnHidden(number, column.is_hidden)
        for number, row in enumerate(rows) if not self._is_list else ():
            for at, cell in enumerate(row.cells):
                if cell.span > 1:
                    self.setSpan(number, at, 1, cell.span)
        self.fit()

    @property
    def key(self) -> Any:
        """The key of the row in force, or None."""
        index = self.currentIndex()
        return self.cells.rows[index.row()].key if index.isValid() else None

    def choose(self, row: int) -> None:
        """Put a row in force and into sight; there is none at -1."""
        self.setCurrentIndex(self.cells.index(row, 0))
        if row >= 0:
            self.scrollTo(self.cells.index(row, 0))

    def step(self, rows: int) -> None:
        """Choose the row above or below, as the arrow keys do."""
        last = self.cells.rowCount() - 1
        if last >= 0:
            self.setCurrentIndex(self.cells.index(min(max(self.currentIndex().row() + rows, 0), last), 0))

    def as_text(self) -> str:
        """Give the table as tab-separated lines."""
        lines = [[column.head.stated for column in self.cells.columns]]
        lines += [[cell.words for cell in row.cells] for row in self.cells.rows]
        return "\n".join("\t".join(cells) for cells in lines)

    def paint_ground(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Draw what lies under a cell: the line above it, and whether its row is a heading, chosen or in focus."""
        theme, rect = current_theme(), QRectF(option.rect)
        is_chosen = self._is_list and bool(option.state & QStyle.StateFlag.State_Selected)
        if is_chosen or self.cells.rows[index.row()].is_heading:
            painter.fillRect(rect, QColor(theme.colours.sunken if is_chosen else theme.colours.ground))
        painter.setPen(theme.pen(theme.colours.line, 1))
        painter.drawLine(rect.topLeft(), rect.topRight())
        if is_chosen and self.hasFocus():
            painter.setPen(theme.pen(theme.colours.ink, 2))
            for y in (rect.top() + 1, rect.bottom() - 1):
                painter.drawLine(QPointF(rect.left(), y), QPointF(rect.right(), y))

    def paint_cell(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        is_heading = self.cells.rows[index.row()].is_heading
        room = self.room_of(QRectF(option.rect), index.column(), is_heading=is_heading)
        self.cells.cell(index).paint(painter, room, current_theme())

    def paint_head(self, painter: QPainter, rect: QRectF, column: int) -> None:
        if column < len(self.cells.columns):
            self.cells.columns[column].head.paint(painter, self.room_of(rect, column), current_theme())

    def room_of(self, rect: QRectF, column: int, *, is_heading: bool = False) -> QRectF:
        """What a cell's padding leaves of it; a heading lies on a ground of its own and begins after its edge."""
        left = px(self._padding) if is_heading else self._left_padding(column)
        return rect.adjusted(left, 0, -px(self._padding), 0)

    def fit(self) -> None:
        """Measure all of it again."""
        self.setFont(current_theme().font(14))
        self.horizontalHeader().setFixedHeight(px(self._head) if self._head else 0)
        self.fit_rows()
        self.needed_widths = [self.needed_width(column) for column in range(len(self.cells.columns))]
        self.setMinimumWidth(self.minimumSizeHint().width())
        if not self._is_list:
            self.setFixedHeight(self.minimumSizeHint().height())
        self.share_width()
        self.updateGeometry()
        self.viewport().update()

    def fit_rows(self) -> None:
        """Give every row its height; the rows of a list all have the same."""
        theme = current_theme()
        self.verticalHeader().setDefaultSectionSize(theme.px(self._row))
        for number, row in enumerate(self.cells.rows) if not self._is_list else ():
            self.setRowHeight(number, max(theme.px(self._row), *(cell.height(theme) for cell in row.cells)))

    def share_width(self) -> None:
        """Give every column what it needs, and its share of the rest."""
        needed, columns = self.needed_widths, self.cells.columns
        shown = [column for column in range(len(needed)) if not self.isColumnHidden(column)]
        shares = {column: columns[column].share for column in shown}
        if shown and not any(shares.values()):
            shares[shown[-1]] = 1
        spare, left = max(0, self.viewport().width() - sum(needed)), sum(shares.values())
        for column, share in shares.items():
            more = spare * share // left if share else 0
            spare, left = spare - more, left - share
            self.setColumnWidth(column, needed[column] + more)

    def minimumSizeHint(self) -> QSize:
        width, head = sum(self.needed_widths), px(self._head) if self._head else 0
        if self._is_list:
            return QSize(width + self.verticalScrollBar().sizeHint().width(), head + px(LEAST_ROWS * self._row))
        return QSize(width, head + sum(self.rowHeight(row) for row in range(len(self.cells.rows))))

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()

    def needed_width(self, column: int) -> int:
        """What a column needs, in px of the screen."""
        if self.isColumnHidden(column):
            return 0
        theme, described = current_theme(), self.cells.columns[column]
        measured = [described.head]
        if described.widest is not None:
            measured.append(described.widest)
        else:
            measured += [row.cells[column] for row in self.cells.rows if row.cells[column].span == 1]
        needed = max(cell.width(theme) for cell in measured) + self._left_padding(column) + theme.px(self._padding) + 1
        return max(needed, theme.px(described.least)) if described.least else needed

    def _left_padding(self, column: int) -> int:
        """The padding before a cell, which is the table's edge at the first column that is shown."""
        is_first = all(self.isColumnHidden(before) for before in range(column))
        length = self._edge if is_first else self._padding
        return px(length) if length else 0

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not self._is_list and event.matches(QKeySequence.StandardKey.Copy):
            QApplication.clipboard().setText(self.as_text())
        elif self._is_list and self.is_opening(event) and self.currentIndex().isValid():
            if not event.isAutoRepeat():
                self.opened.emit(self.key)
        else:
            super().keyPressEvent(event)

    def is_opening(self, event: QKeyEvent) -> bool:
        """Return whether a key opens the row in force."""
        return event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter)

    def moveCursor(  # noqa: N802  Qt calls it
        self, action: QAbstractItemView.CursorAction, modifiers: Qt.KeyboardModifier
    ) -> QModelIndex:
        """In a list, Home and End go to its first and last row; Qt's go to the ends of a row."""
        ends = {self.CursorAction.MoveHome: 0, self.CursorAction.MoveEnd: self.cells.rowCount() - 1}
        if self._is_list and action in ends:
            return self.cells.index(ends[action], max(self.currentIndex().column(), 0))
        return super().moveCursor(action, modifiers)

    def focusInEvent(self, event: QFocusEvent) -> None:
        super().focusInEvent(event)
        is_by_mouse = event.reason() == Qt.FocusReason.MouseFocusReason
        if self._is_list and not self.currentIndex().isValid() and not is_by_mouse:
            self.step(1)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.share_width()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() is QEvent.Type.StyleChange:
            self.fit()

    def _on_current_row_changed(self, _index: QModelIndex, _before: QModelIndex) -> None:
        self.chosen.emit(self.key)


class _Delegate(QStyledItemDelegate):
    """Draws the ground of a row, then the cell as its kind requires."""

    def __init__(self, table: CellTable) -> None:
        super().__init__(table)
        self._table = table

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        painter.save()
        self._table.paint_ground(painter, option, index)
        self._table.paint_cell(painter, option, index)
        painter.restore()


class _Header(QHeaderView):
    """Draws the cells that stand above the columns."""

    def __init__(self, table: CellTable) -> None:
        super().__init__(Qt.Orientation.Horizontal, table)
        self._table = table
        self.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.setMinimumSectionSize(1)
        self.setSectionsClickable(False)

    def paintSection(self, painter: QPainter, rect: object, section: int) -> None:
        painter.save()
        self._table.paint_head(painter, QRectF(rect), section)  # type: ignore[call-overload]  # the stubs call it an object
        painter.restore()

"""A table that stands on a page like its text: as high as its rows, without frame or scroll bars."""

from collections.abc import Iterable

from PySide6.QtCore import QAbstractTableModel, QEvent, QModelIndex, QSize, Qt
from PySide6.QtGui import QKeyEvent, QKeySequence, QResizeEvent
from PySide6.QtWidgets import QApplication, QHeaderView, QStyledItemDelegate, QStyleOptionViewItem, QTableView

from app.theme import Look

ROW = 28


class BareTable(QTableView):
    """Every column has what its widest cell needs, and the first one the rest; copied, it is tab-separated text.

    Who derives from it says `as_text`, and calls `fit` when rows have changed; `head` is the height of the header.
    """

    def __init__(self, look: Look, model: QAbstractTableModel, name: str, head: int) -> None:
        super().__init__()
        self._look, self._head = look, head
        self.needed_widths: list[int] = []  # by the widest cell of each column; nothing for a hidden one
        model.setParent(self)
        self.setModel(model)
        self.setAccessibleName(name)
        self.setShowGrid(False)
        self.setFrameShape(QTableView.Shape.NoFrame)
        self.setCornerButtonEnabled(False)
        self.setTabKeyNavigation(False)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)

    def dress(self, head: QHeaderView, delegate: QStyledItemDelegate, beside: QHeaderView | None = None) -> None:
        """Take what paints the header above, the cells, and the header beside the rows, which may be none."""
        self.setHorizontalHeader(head)
        if beside is not None:
            self.setVerticalHeader(beside)
        else:
            self.verticalHeader().hide()
            self.verticalHeader().setMinimumSectionSize(1)
        self.setItemDelegate(delegate)
        self.fit()

    def as_text(self) -> str:
        """Give the table as tab-separated lines."""
        raise NotImplementedError

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() is QEvent.Type.StyleChange:
            self.fit()

    def minimumSizeHint(self) -> QSize:
        height = self.horizontalHeader().height() + sum(self.rowHeight(row) for row in range(self.model().rowCount()))
        return QSize(self._width_beside() + sum(self.needed_widths), height)

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.matches(QKeySequence.StandardKey.Copy):
            QApplication.clipboard().setText(self.as_text())
            return
        super().keyPressEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._share_width()

    def fit(self) -> None:
        """Measure all of it anew."""
        self.setFont(self._look.theme.font(14))
        self.horizontalHeader().setFixedHeight(self._look.theme.px(self._head))
        self.needed_widths = [self._needed_width(column) for column in range(self.model().columnCount())]
        for row in range(self.model().rowCount()):
            self.setRowHeight(row, self._row_height(row))
        self.setFixedHeight(self.minimumSizeHint().height())
        self.setMinimumWidth(self.minimumSizeHint().width())
        self._share_width()
        self.viewport().update()

    def _needed_width(self, column: int) -> int:
        if self.isColumnHidden(column):
            return 0
        option, head = QStyleOptionViewItem(), self.horizontalHeader().sectionSizeFromContents(column).width()
        cells = (self.itemDelegate().sizeHint(option, cell).width() for cell in self._measured_cells(column))
        return max([head, *cells])

    def _measured_cells(self, column: int) -> Iterable[QModelIndex]:
        """Give the cells that ask their column for room."""
        return (self.model().index(row, column) for row in range(self.model().rowCount()))

    def _row_height(self, _row: int) -> int:
        return self._look.theme.px(ROW)

    def _share_width(self) -> None:
        if not self.needed_widths:
            return
        spare = max(0, self.width() - self._width_beside() - sum(self.needed_widths))
        for column, width in enumerate(self._shared(spare)):
            if width:
                self.setColumnWidth(column, width)

    def _shared(self, spare: int) -> list[int]:
        """Give each column's width where there is so much more than they need."""
        return [self.needed_widths[0] + spare, *self.needed_widths[1:]]

    def _width_beside(self) -> int:
        return 0 if self.verticalHeader().isHidden() else self.verticalHeader().width()

"""Every stride of a walk, a line each: Space, Enter or a click on its mark leaves it out or takes it in again."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
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
from PySide6.QtGui import QColor, QFocusEvent, QFontMetrics, QKeyEvent, QPainter, QPolygonF, QResizeEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
    QWidget,
)

from app.icons import Icon, paint_icon
from app.theme import Look
from app.widgets.chip import CHIP, paint_chip
from app.widgets.text import MEDIUM
from app.wording import capitalised, later, side_name, tr
from core.body import Side
from core.samples import FloatArray

ROW, HEAD = 44, 36
LEAST_ROWS = 2.5  # in sight: half a row says that there are more
PADDING, MARK = 8, 20
STRIDE, BEGINS, TAKES, KNEE, ANKLE, STATE, KNEE_SHAPE, ANKLE_SHAPE = range(8)
HEADS = (
    later("Stride"),
    later("at (s)"),
    later("takes (s)"),
    later("knee range (°)"),
    later("ankle range (°)"),
    "",
    later("knee"),
    later("ankle"),
)
FIGURES = (BEGINS, TAKES, KNEE, ANKLE)
SHAPES = (KNEE_SHAPE, ANKLE_SHAPE)
LEAST_SHAPE = 64  # narrower, a curve tells nothing
WIDEST = {BEGINS: "000.0", TAKES: "0.00", KNEE: "000.0", ANKLE: "000.0"}
STATE_WIDTH = 112  # words wrap in it
Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True, slots=True)
class StrideLine:
    """One stride of one side. `reason` says in words why it is left out; empty: it is used.

    Only what is used, or was left out by hand, can be turned. NaN: not known. `shapes_deg`: knee and ankle over the
    stride (101,), as far as they are known.
    """

    side: Side
    number: int
    start_s: float
    end_s: float
    knee_range_deg: float
    ankle_range_deg: float
    reason: str
    is_by_hand: bool
    shapes_deg: Mapping[int, FloatArray] = field(default_factory=dict, compare=False, repr=False)

    @property
    def is_used(self) -> bool:
        return not self.reason

    @property
    def can_be_turned(self) -> bool:
        return self.is_used or self.is_by_hand

    @property
    def name(self) -> str:
        return tr("{side} stride {number}").format(side=side_name(self.side), number=self.number)


class StrideModel(QAbstractTableModel):
    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.lines: tuple[StrideLine, ...] = ()
        self.can_turn = True

    def show(self, lines: Sequence[StrideLine]) -> None:
        """Show other lines, or what became of the same ones: those stay where they are, and so does the focus."""
        if [_key(line) for line in self.lines] == [_key(line) for line in lines]:
            self.lines = tuple(lines)
            if lines:
                self.dataChanged.emit(self.index(0, 0), self.index(len(lines) - 1, len(HEADS) - 1))
            return
        self.beginResetModel()
        self.lines = tuple(lines)
        self.endResetModel()

    def rowCount(self, _parent: Index = QModelIndex()) -> int:  # noqa: B008  Qt's own signature
        return len(self.lines)

    def columnCount(self, _parent: Index = QModelIndex()) -> int:  # noqa: B008  Qt's own signature
        return len(HEADS)

    def words(self, index: Index) -> str:
        line = self.lines[index.row()]
        match index.column():
            case 0:
                return str(line.number)
            case 1:
                return _number(line.start_s, 1)
            case 2:
                return _number(line.end_s - line.start_s, 2)
            case 3:
                return _number(line.knee_range_deg, 1)
            case 4:
                return _number(line.ankle_range_deg, 1)
            case 5:
                return line.reason or tr("used")
        return ""  # a curve

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        line = self.lines[index.row()]
        if role == Qt.ItemDataRole.DisplayRole:
            return self.words(index)
        if role == Qt.ItemDataRole.AccessibleTextRole:
            if index.column() in FIGURES:
                return f"{tr(HEADS[index.column()])}: {self.words(index)}"
            return ", ".join([capitalised(line.name), self.words(self.index(index.row(), STATE))])  # of a curve, too
        if role == Qt.ItemDataRole.CheckStateRole and index.column() == STRIDE and self.can_turn:
            return Qt.CheckState.Checked if line.is_used else Qt.CheckState.Unchecked
        return None

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        if role != Qt.ItemDataRole.DisplayRole or orientation != Qt.Orientation.Horizontal:
            return None
        return _heading(section)


class StrideList(QTableView):
    """The line in force is drawn bold in the charts; the figures of a side that has none are hidden.

    Where there are no charts beside it, every line draws its own curves over the mean of its side.
    """

    chosen = Signal(object)  # StrideLine, or None
    turned = Signal(object)  # StrideLine as it is now

    def __init__(self, look: Look, name: str) -> None:
        super().__init__()
        self._look = look
        self.strides = StrideModel(self)
        self.means: dict[tuple[Side, int], FloatArray] = {}
        self.reach: dict[int, tuple[float, float]] = {}
        self._has_shapes = False
        self.setModel(self.strides)
        self.setHorizontalHeader(_Header(look, self))
        self.verticalHeader().hide()
        self.verticalHeader().setMinimumSectionSize(1)
        self.setItemDelegate(_StrideDelegate(look, self))
        self.setAccessibleName(name)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFrameShape(QTableView.Shape.NoFrame)
        self.setShowGrid(False)
        self.setTabKeyNavigation(False)
        self.set_can_turn(True)
        self.selectionModel().currentChanged.connect(self._on_current_changed)
        self.clicked.connect(self._on_clicked)
        self._on_look_changed()

    @property
    def line(self) -> StrideLine | None:
        """The line in force."""
        index = self.currentIndex()
        return self.strides.lines[index.row()] if index.isValid() else None

    def set_can_turn(self, can_turn: bool) -> None:
        """Let strides be left out and taken in again; else they are only looked at, and nothing looks like a box."""
        self.strides.can_turn = can_turn
        self.setAccessibleDescription(tr("Space leaves the stride out, or takes it in again.") if can_turn else "")
        self.viewport().update()

    def show_lines(self, lines: Sequence[StrideLine]) -> None:
        self.strides.show(lines)
        for column, values in ((KNEE, "knee_range_deg"), (ANKLE, "ankle_range_deg")):
            is_known = any(math.isfinite(getattr(line, values)) for line in lines)
            self.setColumnHidden(column, not is_known)
        used = [line for line in lines if line.is_used]
        for shape in SHAPES:
            every = [line.shapes_deg[shape] for line in lines if shape in line.shapes_deg]
            self.reach[shape] = (float(np.min(every)), float(np.max(every))) if every else (0.0, 1.0)
            for side in Side:
                of_side = [line.shapes_deg[shape] for line in used if line.side is side and shape in line.shapes_deg]
                self.means[side, shape] = np.mean(of_side, axis=0) if of_side else np.empty(0)
        self._on_look_changed()
        self.chosen.emit(self.line)

    def set_shapes_shown(self, is_shown: bool) -> None:
        self._has_shapes = is_shown
        self._share_width()

    def choose(self, row: int) -> None:
        self.setCurrentIndex(self.strides.index(row, STRIDE))
        self.scrollTo(self.strides.index(row, STRIDE))

    def focusInEvent(self, event: QFocusEvent) -> None:
        super().focusInEvent(event)
        if not self.currentIndex().isValid() and self.strides.lines:
            self.choose(0)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Space, Qt.Key.Key_Return, Qt.Key.Key_Enter):
            if not event.isAutoRepeat():
                self.turn()
            return
        super().keyPressEvent(event)

    def turn(self) -> None:
        """Leave the stride in force out, or take it in again."""
        if self.strides.can_turn and (line := self.line) is not None and line.can_be_turned:
            self.turned.emit(line)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._share_width()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() is QEvent.Type.StyleChange:
            self._on_look_changed()

    def minimumSizeHint(self) -> QSize:
        px = self._look.theme.px
        return QSize(sum(self._widths()) + self.verticalScrollBar().sizeHint().width(), px(HEAD + LEAST_ROWS * ROW))

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()

    def _widths(self) -> list[int]:
        """What each column needs."""
        theme = self._look.theme
        figures, head = QFontMetrics(theme.font(14, MEDIUM)), QFontMetrics(theme.font(12))
        widths = [theme.px(MARK + CHIP + 4 * PADDING) + figures.horizontalAdvance("000")]
        for column in FIGURES:
            heading = max(map(head.horizontalAdvance, _heading(column).split(" ")))
            needed = max(figures.horizontalAdvance(WIDEST[column]), heading) + 2 * theme.px(PADDING)
            widths.append(0 if self.isColumnHidden(column) else needed)
        return [*widths, theme.px(STATE_WIDTH)]

    def _share_width(self) -> None:
        """Give every column what it needs, and the rest to the curves where they are shown, else to the words."""
        needed = self._widths()
        spare = max(0, self.viewport().width() - sum(needed))
        known = [shape for shape in SHAPES if any(len(self.means.get((side, shape), ())) for side in Side)]
        each = spare // max(len(known), 1)
        is_shown = self._has_shapes and bool(known) and each >= self._look.theme.px(LEAST_SHAPE)
        for shape in SHAPES:
            self.setColumnHidden(shape, not (is_shown and shape in known))
            needed.append(each if is_shown and shape in known else 0)
        needed[STATE] += 0 if is_shown else spare
        for column, width in enumerate(needed):
            if width:
                self.setColumnWidth(column, width)

    def _on_current_changed(self, _index: QModelIndex, _before: QModelIndex) -> None:
        self.chosen.emit(self.line)

    def _on_clicked(self, index: QModelIndex) -> None:
        if index.column() == STRIDE:
            self.turn()

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self.horizontalHeader().setFixedHeight(px(HEAD))
        self.verticalHeader().setDefaultSectionSize(px(ROW))
        self.setMinimumWidth(self.minimumSizeHint().width())
        self._share_width()
        self.updateGeometry()
        self.viewport().update()


class _StrideDelegate(QStyledItemDelegate):
    """A mark, the side's chip and the number; figures at the right; in words what became of it."""

    def __init__(self, look: Look, view: StrideList) -> None:
        super().__init__(view)
        self._look, self._view = look, view

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        theme, model = self._look.theme, self._view.strides
        if index.row() >= len(model.lines):
            return
        c, px, rect, line = theme.colours, theme.px, QRectF(option.rect), model.lines[index.row()]
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        is_chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        if is_chosen:
            painter.fillRect(rect, QColor(c.sunken))
        painter.setPen(theme.pen(c.line, 1))
        painter.drawLine(rect.topLeft(), rect.topRight())
        if is_chosen and self._view.hasFocus():
            painter.setPen(theme.pen(c.ink, 2))
            for y in (rect.top() + 1, rect.bottom() - 1):
                painter.drawLine(QPointF(rect.left(), y), QPointF(rect.right(), y))
        ink = QColor(c.ink if line.is_used else c.ink2)
        if index.column() == STRIDE:
            self._paint_stride(painter, rect, line, ink)
        elif index.column() in SHAPES:
            self._paint_shape(painter, rect, line, index.column())
        else:
            is_figure = index.column() in FIGURES
            painter.setFont(theme.font(14, MEDIUM) if is_figure else theme.font(12))
            painter.setPen(ink)
            way = Qt.AlignmentFlag.AlignRight if is_figure else Qt.AlignmentFlag.AlignLeft
            inner = rect.adjusted(px(PADDING), 0, -px(PADDING), 0)
            wrap = int(way | Qt.AlignmentFlag.AlignVCenter) | int(Qt.TextFlag.TextWordWrap)
            painter.drawText(inner, wrap, model.words(index))
        painter.restore()

    def _paint_shape(self, painter: QPainter, rect: QRectF, line: StrideLine, shape: int) -> None:
        """The stride in its side's line, over the mean of that side's strides in grey; all on the same scale."""
        theme, view = self._look.theme, self._view
        inner = rect.adjusted(theme.px(PADDING), theme.px(5), -theme.px(PADDING), -theme.px(5))
        own = theme.side_pen(line.side, 1.6) if line.is_used else theme.pen(theme.colours.ink2, 1)
        mean = theme.pen(theme.colours.control, 1)
        for curve_deg, pen in ((view.means.get((line.side, shape)), mean), (line.shapes_deg.get(shape), own)):
            if curve_deg is not None and len(curve_deg):
                painter.setPen(pen)
                painter.drawPolyline(_points(curve_deg, inner, view.reach[shape]))

    def _paint_stride(self, painter: QPainter, rect: QRectF, line: StrideLine, ink: QColor) -> None:
        theme = self._look.theme
        c, px = theme.colours, theme.px
        mark = QRectF(rect.left() + px(PADDING), rect.center().y() - px(MARK) / 2, px(MARK), px(MARK))
        if line.can_be_turned and self._view.strides.can_turn:
            painter.setPen(theme.pen(c.control, 1.25))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRoundedRect(mark.adjusted(1, 1, -1, -1), px(4), px(4))
        if line.is_used:
            paint_icon(painter, Icon.CHECK, mark, c.ink)
        chip = QRectF(mark.right() + px(PADDING), rect.center().y() - px(CHIP) / 2, px(CHIP), px(CHIP))
        paint_chip(painter, chip, line.side, theme)
        painter.setFont(theme.font(14, MEDIUM))
        painter.setPen(ink)
        room = QRectF(chip.right() + px(PADDING), rect.top(), rect.right() - chip.right(), rect.height())
        painter.drawText(room, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, str(line.number))


class _Header(QHeaderView):
    """Names of the columns, small; they may take two lines."""

    def __init__(self, look: Look, parent: QWidget) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self._look = look
        self.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.setMinimumSectionSize(1)
        self.setSectionsClickable(False)

    def paintSection(self, painter: QPainter, rect: object, section: int) -> None:
        theme = self._look.theme
        box = QRectF(rect)  # type: ignore[call-overload]  # the stubs call it an object
        inner = box.adjusted(theme.px(PADDING), 0, -theme.px(PADDING), 0)
        way = Qt.AlignmentFlag.AlignRight if section in FIGURES else Qt.AlignmentFlag.AlignLeft
        painter.save()
        painter.setPen(QColor(theme.colours.ink2))
        painter.setFont(theme.font(12))
        words = str(self.model().headerData(section, Qt.Orientation.Horizontal))
        painter.drawText(inner, int(way | Qt.AlignmentFlag.AlignVCenter) | int(Qt.TextFlag.TextWordWrap), words)
        painter.restore()


def _heading(column: int) -> str:
    """The column's name, its unit not parted from the word before."""
    return tr(HEADS[column]).replace(" (", "\N{NO-BREAK SPACE}(") if HEADS[column] else ""


def _points(curve_deg: FloatArray, room: QRectF, reach: tuple[float, float]) -> QPolygonF:
    """The curve from the left to the right of `room`, its lowest and highest angle at the edges."""
    low, high = reach
    x = np.linspace(room.left(), room.right(), len(curve_deg))
    y = room.bottom() - room.height() * (curve_deg - low) / max(high - low, 1e-9)
    return QPolygonF([QPointF(float(a), float(b)) for a, b in zip(x, y, strict=True)])


def _key(line: StrideLine) -> tuple[Side, int, float]:
    return line.side, line.number, line.start_s


def _number(value: float, decimals: int) -> str:
    return f"{value:.{decimals}f}" if math.isfinite(value) else ""

"""Every stride of a walk, a line each: Space or a click on its mark leaves it out or takes it in again."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from PySide6.QtCore import QModelIndex, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QKeyEvent, QPainter, QPolygonF

from app.theme.current import px
from app.theme.icons import Icon, paint_icon
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.theme import Theme
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import EMPTY, LEFT, RIGHT, TableCell, TextCell
from app.widgets.text import MEDIUM
from app.wording.body import side_name
from app.wording.translation import capitalised, figure_text, later, tr
from core.body import JointKind, Side
from core.samples import FloatArray

ROW, HEAD = 44, 36
PADDING, MARK = 8, 20
STRIDE, BEGINS, TAKES, HIP, KNEE, ANKLE, STATE, HIP_SHAPE, KNEE_SHAPE, ANKLE_SHAPE = range(10)
HEADS = (
    later("Stride"),
    later("start (s)"),
    later("duration (s)"),
    later("hip ROM (°)"),
    later("knee ROM (°)"),
    later("ankle ROM (°)"),
    "",
    later("hip"),
    later("knee"),
    later("ankle"),
)
RANGES = {HIP: JointKind.HIP, KNEE: JointKind.KNEE, ANKLE: JointKind.ANKLE}
SHAPES = {HIP_SHAPE: JointKind.HIP, KNEE_SHAPE: JointKind.KNEE, ANKLE_SHAPE: JointKind.ANKLE}
LEAST_SHAPE = 64  # narrower, a curve shows nothing
SHAPE_MARGIN = 5  # between a curve and the lines of its row
WIDEST = {BEGINS: "000.0", TAKES: "0.00", HIP: "000.0", KNEE: "000.0", ANKLE: "000.0"}
STATE_WIDTH = 112  # words wrap in it


@dataclass(frozen=True, slots=True)
class StrideLine:
    """One stride of one side, the same one whatever became of it. `reason`: why it is left out; empty: it is used.

    Only what is used, or was left out by hand, can be turned. `ranges_deg`: of each kind of joint, NaN where not known;
    `shapes_deg`: the joints over the stride (101,), as far as they are known.
    """

    side: Side
    number: int
    start_s: float
    end_s: float
    ranges_deg: Mapping[JointKind, float] = field(compare=False)
    reason: str = field(compare=False)
    is_by_hand: bool = field(compare=False)
    shapes_deg: Mapping[JointKind, FloatArray] = field(default_factory=dict, compare=False, repr=False)

    @property
    def is_used(self) -> bool:
        return not self.reason

    @property
    def can_be_turned(self) -> bool:
        return self.is_used or self.is_by_hand

    @property
    def name(self) -> str:
        return tr("{side} stride {number}").format(side=side_name(self.side), number=self.number)

    @property
    def in_words(self) -> str:
        """The stride, and what became of it."""
        return ", ".join([capitalised(self.name), self.reason or tr("used")])


@dataclass(frozen=True, slots=True)
class StrideCell(TableCell):
    """The chip of the side and the number, behind the mark of what is used; a box where that `can_turn`."""

    line: StrideLine
    can_turn: bool

    @property
    def words(self) -> str:
        return str(self.line.number)

    @property
    def stated(self) -> str:
        return self.line.in_words

    @property
    def is_checked(self) -> bool | None:
        return self.line.is_used if self.can_turn else None

    def width(self, theme: Theme) -> int:
        return theme.px(MARK + CHIP + 2 * PADDING) + QFontMetrics(theme.font(14, MEDIUM)).horizontalAdvance(self.words)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        c, px, middle = theme.colours, theme.px, room.center().y()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        mark = QRectF(room.left(), middle - px(MARK) / 2, px(MARK), px(MARK))
        if self.line.can_be_turned and self.can_turn:
            painter.setPen(theme.pen(c.control, 1.25))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRoundedRect(mark.adjusted(1, 1, -1, -1), px(4), px(4))
        if self.line.is_used:
            paint_icon(painter, Icon.CHECK, mark, c.ink)
        chip = QRectF(mark.right() + px(PADDING), middle - px(CHIP) / 2, px(CHIP), px(CHIP))
        paint_chip(painter, chip, self.line.side, theme)
        painter.setFont(theme.font(14, MEDIUM))
        painter.setPen(QColor(c.ink if self.line.is_used else c.ink2))
        room = room.adjusted(px(MARK + CHIP + 2 * PADDING), 0, 0, 0)
        painter.drawText(room, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, self.words)


@dataclass(frozen=True, slots=True)
class CurveCell(TableCell):
    """A stride in its side's line, over the mean of that side's strides in grey; all of a column on the same scale.

    Both curves (n,) or empty; `reach_deg`: the lowest and the highest angle of the column.
    """

    line: StrideLine
    curve_deg: FloatArray
    mean_deg: FloatArray
    reach_deg: tuple[float, float]

    @property
    def stated(self) -> str:
        return self.line.in_words

    def width(self, theme: Theme) -> int:
        return theme.px(LEAST_SHAPE)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        inner = room.adjusted(0, theme.px(SHAPE_MARGIN), 0, -theme.px(SHAPE_MARGIN))
        own = theme.side_pen(self.line.side, 1.6) if self.line.is_used else theme.pen(theme.colours.ink2, 1)
        for curve_deg, pen in ((self.mean_deg, theme.pen(theme.colours.control, 1)), (self.curve_deg, own)):
            painter.setPen(pen)
            painter.drawPolyline(_points(curve_deg, inner, self.reach_deg))


class StrideList(CellTable):
    """The line in force is drawn bold in the charts; the figures of a side that has none are hidden.

    Where there are no charts beside it, every line draws its own curves over the mean of its side.

    `chosen`: the StrideLine in force, or None.
    """

    turned = Signal(object)  # a StrideLine as it is now, which is to be left out or taken in again

    def __init__(self, name: str) -> None:
        super().__init__(name, row=ROW, head=HEAD, padding=PADDING, edge=PADDING, is_list=True)
        self.lines: tuple[StrideLine, ...] = ()
        self._can_turn = True
        self._has_shapes = False
        self.opened.connect(self.turn)
        self.clicked.connect(self._on_clicked)

    @property
    def line(self) -> StrideLine | None:
        """The line in force."""
        return self.key

    def show_lines(self, lines: Sequence[StrideLine], *, can_turn: bool) -> None:
        """Show these strides. Where they cannot be turned they are only looked at, and nothing looks like a box."""
        self.lines, self._can_turn = tuple(lines), can_turn
        self.setAccessibleDescription(tr("Press Space to exclude or include the stride.") if can_turn else "")
        self.show_rows(_columns(lines), _rows(lines, can_turn=can_turn))
        self.chosen.emit(self.line)

    def set_shapes_shown(self, is_shown: bool) -> None:
        self._has_shapes = is_shown
        self.share_width()

    def turn(self) -> None:
        """Leave the stride in force out, or take it in again."""
        if self._can_turn and (line := self.line) is not None and line.can_be_turned:
            self.turned.emit(line)

    def is_opening(self, event: QKeyEvent) -> bool:
        return event.key() == Qt.Key.Key_Space or super().is_opening(event)

    def needed_width(self, column: int) -> int:
        return 0 if column in SHAPES else super().needed_width(column)

    def share_width(self) -> None:
        """Give what is left to the curves where they are shown and have room, else to the words."""
        known = [
            column
            for column, kind in SHAPES.items()
            if any(kind in line.shapes_deg for line in self.lines if line.is_used)
        ]
        spare = self.viewport().width() - sum(self.needed_widths)
        is_shown = self._has_shapes and bool(known) and spare // len(known) >= px(LEAST_SHAPE)
        for shape in SHAPES:
            self.setColumnHidden(shape, not (is_shown and shape in known))
        super().share_width()

    def _on_clicked(self, index: QModelIndex) -> None:
        if index.column() == STRIDE:
            self.turn()


def _columns(lines: Sequence[StrideLine]) -> list[TableColumn]:
    is_known = {
        column: any(math.isfinite(line.ranges_deg.get(kind, math.nan)) for line in lines)
        for column, kind in RANGES.items()
    }
    sample = StrideCell(StrideLine(Side.LEFT, 100, 0.0, 1.0, {}, "", is_by_hand=False), can_turn=True)
    figures = [
        TableColumn(_head(column, RIGHT), widest=_figure(widest), is_hidden=not is_known.get(column, True))
        for column, widest in WIDEST.items()
    ]
    return [
        TableColumn(_head(STRIDE), widest=sample),
        *figures,
        TableColumn(_head(STATE), widest=EMPTY, least=STATE_WIDTH),
        *(TableColumn(_head(shape), share=1, widest=EMPTY) for shape in SHAPES),
    ]


def _rows(lines: Sequence[StrideLine], *, can_turn: bool) -> list[TableRow]:
    """One row a stride. The mean of a side is that of its strides used, the reach that of all."""
    none = np.empty(0)
    means, reach = {}, {}
    for shape in SHAPES.values():
        every = [line.shapes_deg[shape] for line in lines if shape in line.shapes_deg]
        reach[shape] = (float(np.min(every)), float(np.max(every))) if every else (0.0, 1.0)
        for side in Side:
            of_side = [line for line in lines if line.side is side and line.is_used and shape in line.shapes_deg]
            means[side, shape] = np.mean([line.shapes_deg[shape] for line in of_side], axis=0) if of_side else none
    heads = {column: tr(HEADS[column]) for column in WIDEST}
    rows = []
    for line in lines:
        figures = {
            BEGINS: _number(line.start_s, 1),
            TAKES: _number(line.end_s - line.start_s, 2),
            **{column: _number(line.ranges_deg.get(kind, math.nan), 1) for column, kind in RANGES.items()},
        }
        tone = "ink" if line.is_used else "ink2"
        cells: tuple[TableCell, ...] = (
            StrideCell(line, can_turn),
            *(_figure(words, tone, f"{heads[column]}: {words}") for column, words in figures.items()),
            TextCell(line.reason or tr("used"), size=12, tone=tone, wraps=True, spoken=line.in_words),
            *(CurveCell(line, line.shapes_deg.get(k, none), means[line.side, k], reach[k]) for k in SHAPES.values()),
        )
        rows.append(TableRow(cells, key=line))
    return rows


def _figure(words: str, tone: str = "ink", spoken: str = "") -> TextCell:
    return TextCell(words, align=RIGHT, weight=MEDIUM, tone=tone, spoken=spoken)


def _head(column: int, align: Qt.AlignmentFlag = LEFT) -> TextCell:
    """The name of a column, small; it may take two lines."""
    return TextCell(_heading(column), align=align, size=12, tone="ink2", wraps=True)


def _heading(column: int) -> str:
    """The column's name, its unit not parted from the word before."""
    return tr(HEADS[column]).replace(" (", "\N{NO-BREAK SPACE}(") if HEADS[column] else ""


def _points(curve_deg: FloatArray, room: QRectF, reach: tuple[float, float]) -> QPolygonF:
    """The curve from the left to the right of `room`, its lowest and highest angle at the edges."""
    low, high = reach
    x = np.linspace(room.left(), room.right(), len(curve_deg))
    y = room.bottom() - room.height() * (curve_deg - low) / max(high - low, 1e-9)
    return QPolygonF([QPointF(float(a), float(b)) for a, b in zip(x, y, strict=True)])


def _number(value: float, decimals: int) -> str:
    return figure_text(value, f".{decimals}f") if math.isfinite(value) else ""

"""What did the walk give in figures? One row per figure: left, right, and the same of a cited group."""

import math
from collections.abc import Iterable, Mapping, Sequence

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter
from PySide6.QtWidgets import (
    QHeaderView,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QWidget,
)

from app.gates_in_words import verdict_word
from app.reports.walk_figures import Figure, is_mean_enough, is_spread_enough
from app.theme import Look
from app.widgets.bare_table import ROW, BareTable
from app.widgets.chip import CHIP, paint_chip
from app.widgets.text import SEMIBOLD
from app.wording import capitalised, later, side_name, tr, tr_n
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.verdicts.model import Verdict

HEAD = 32
PADDING = 6
NAME, LEFT, RIGHT, BAND = range(4)
COLUMNS = 4
SIDE_OF = {LEFT: Side.LEFT, RIGHT: Side.RIGHT}
BAND_HEAD = later("band 1 SD")
MINUS = "\N{MINUS SIGN}"
CARE_MARK = "*"  # behind what is to be read with care
Index = QModelIndex | QPersistentModelIndex


class FiguresModel(QAbstractTableModel):
    """Rows are headings (a word) or figures. A cell is the value and what stands smaller behind it."""

    def __init__(self) -> None:
        super().__init__()
        self.rows: list[str | Figure] = []
        self.strides: Mapping[Side, int] = {}

    def show_figures(self, rows: Sequence[str | Figure], strides: Mapping[Side, int]) -> None:
        self.beginResetModel()
        self.rows, self.strides = list(rows), strides
        self.endResetModel()

    def cell(self, index: Index) -> tuple[str, str]:
        """Give value and addition of a cell, as "58.7" and "± 1.8"."""
        row, column = self.rows[index.row()], index.column()
        if isinstance(row, str):
            return (row if column == NAME else ""), ""
        if column == NAME:
            return row.name, "" if row.unit == "°" or row.name.endswith(row.unit) else row.unit
        if column == BAND:
            return "", _range(row) if row.band is not None else ""
        if row.both is not None:
            return self._of_both(row) if column == LEFT else ("", "")
        side = SIDE_OF[column]
        if side in row.unknown:
            return "", tr(row.unknown[side])
        return _marked(_mean(row.sides.get(side), row.decimals), side in row.with_care)

    def _of_both(self, row: Figure) -> tuple[str, str]:
        if row.unknown_both:
            return "", tr(row.unknown_both)
        assert row.both is not None
        return " ".join(filter(None, _marked((_number(row.both, row.decimals), ""), bool(row.with_care)))), ""

    def is_grey(self, index: Index) -> bool:
        """Tell whether too few strides stand behind a cell to make a mean."""
        row, side = self.rows[index.row()], SIDE_OF.get(index.column())
        if isinstance(row, str) or side is None or side not in row.sides:
            return False
        return not is_mean_enough(row.sides[side].n)

    def rowCount(self, _parent: Index = QModelIndex()) -> int:  # noqa: B008  Qt's own signature
        return len(self.rows)

    def columnCount(self, _parent: Index = QModelIndex()) -> int:  # noqa: B008  Qt's own signature
        return COLUMNS

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        words = " ".join(filter(None, self.cell(index)))
        if role == Qt.ItemDataRole.DisplayRole:
            return words
        if role == Qt.ItemDataRole.AccessibleTextRole:
            return self._in_words(index, words)
        return None

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        if role != Qt.ItemDataRole.DisplayRole or orientation != Qt.Orientation.Horizontal:
            return None
        return ("", self._strides(Side.LEFT), self._strides(Side.RIGHT), tr(BAND_HEAD))[section]

    def _strides(self, side: Side) -> str:
        if side not in self.strides:
            return ""
        return tr_n("{count} stride", "{count} strides", self.strides[side]).format(count=self.strides[side])

    def _in_words(self, index: Index, words: str) -> str:
        """Say a cell with its row, its side and its unit, for who hears one cell at a time."""
        row, column = self.rows[index.row()], index.column()
        if isinstance(row, str) or column == NAME:
            return words
        heading = next((above for above in reversed(self.rows[: index.row()]) if isinstance(above, str)), "")
        both = tr("both sides") if row.both is not None else ""
        who = tr("reference band") if column == BAND else both or side_name(SIDE_OF[column])
        name = " ".join(filter(None, [heading, row.name[0].lower() + row.name[1:]]))
        said = f"{words} {row.unit}" if words else tr("no value")
        if words.endswith(CARE_MARK):
            said = f"{words.removesuffix(CARE_MARK).rstrip()} {row.unit}, {verdict_word(Verdict.CARE)}"
        return f"{capitalised(name)}, {who}: {said}"


class FiguresTable(BareTable):
    def __init__(self, look: Look, name: str) -> None:
        model = FiguresModel()
        super().__init__(look, model, name, HEAD)
        self.figures = model
        self.dress(_SideHeader(look, self), _FigureDelegate(look, self))

    def show_figures(self, rows: Sequence[str | Figure], strides: Mapping[Side, int]) -> None:
        """Show headings and figures; `strides` used stand above each side's column."""
        self.clearSpans()
        self.figures.show_figures(rows, strides)
        for k, row in enumerate(rows):
            if isinstance(row, str):
                self.setSpan(k, NAME, 1, COLUMNS)
            elif row.both is not None:
                self.setSpan(k, LEFT, 1, 2)
        for column, side in SIDE_OF.items():
            self.setColumnHidden(column, side not in strides and len(strides) > 0)
        self.fit()

    def as_text(self) -> str:
        """Give the table as tab-separated lines."""
        model = self.figures
        head = ["", f"L, {model.headerData(LEFT, Qt.Orientation.Horizontal)}"]
        head += [f"R, {model.headerData(RIGHT, Qt.Orientation.Horizontal)}", tr(BAND_HEAD)]
        rows = [[str(model.data(model.index(row, k))) for k in range(COLUMNS)] for row in range(model.rowCount())]
        return "\n".join("\t".join(cells) for cells in [head, *rows])

    def _measured_cells(self, column: int) -> Iterable[QModelIndex]:
        """Leave out what goes over several columns."""
        for k, row in enumerate(self.figures.rows):
            if not isinstance(row, str) and (row.both is None or column in (NAME, BAND)):
                yield self.figures.index(k, column)


class _FigureDelegate(QStyledItemDelegate):
    """Paints names at the left, figures at the right: the value large, its spread small."""

    def __init__(self, look: Look, parent: QWidget) -> None:
        super().__init__(parent)
        self._look = look

    def sizeHint(self, _option: QStyleOptionViewItem, index: Index) -> QSize:
        model, px = _model(index), self._look.theme.px
        value, addition = model.cell(index)
        fonts = self._fonts(model, index)
        width = sum(
            QFontMetrics(font).horizontalAdvance(text) for font, text in zip(fonts, (value, addition), strict=True)
        )
        padding = px(PADDING) if index.column() == NAME else 2 * px(PADDING)  # names begin at the edge
        return QSize(width + (px(4) if value and addition else 0) + padding + 1, px(ROW))

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        theme, model = self._look.theme, _model(index)
        c, rect = theme.colours, QRectF(option.rect)
        painter.save()
        is_heading = isinstance(model.rows[index.row()], str)
        if is_heading:
            painter.fillRect(rect, QColor(c.ground))
        painter.setPen(theme.pen(c.line, 1))
        painter.drawLine(rect.topLeft(), rect.topRight())
        value, addition = model.cell(index)
        large, small = self._fonts(model, index)
        inner = rect.adjusted(theme.px(PADDING), 0, -theme.px(PADDING), 0)
        gap = theme.px(4) if value and addition else 0
        if index.column() == NAME:
            inner.setLeft(rect.left() + (theme.px(PADDING) if is_heading else 0))
            self._draw(painter, inner, value, large, c.ink, Qt.AlignmentFlag.AlignLeft)
            inner.setLeft(inner.left() + QFontMetrics(large).horizontalAdvance(value) + gap)
            self._draw(painter, inner, addition, small, c.ink2, Qt.AlignmentFlag.AlignLeft)
        else:
            row = model.rows[index.row()]
            is_both = isinstance(row, Figure) and row.both is not None and index.column() == LEFT
            way = Qt.AlignmentFlag.AlignHCenter if is_both else Qt.AlignmentFlag.AlignRight
            self._draw(painter, inner, addition, small, c.ink2, Qt.AlignmentFlag.AlignRight)
            if addition:
                inner.setRight(inner.right() - QFontMetrics(small).horizontalAdvance(addition) - gap)
            self._draw(painter, inner, value, large, c.ink3 if model.is_grey(index) else c.ink, way)
        painter.restore()

    def _draw(self, painter: QPainter, room: QRectF, text: str, font: QFont, ink: str, way: Qt.AlignmentFlag) -> None:
        painter.setFont(font)
        painter.setPen(QColor(ink))
        painter.drawText(room, way | Qt.AlignmentFlag.AlignVCenter, text)

    def _fonts(self, model: FiguresModel, index: Index) -> tuple[QFont, QFont]:
        theme = self._look.theme
        if isinstance(model.rows[index.row()], str):
            return theme.font(14, SEMIBOLD), theme.font(12)
        if index.column() == NAME:
            return theme.font(14), theme.font(12)
        return theme.font(15, SEMIBOLD), theme.font(12)


class _SideHeader(QHeaderView):
    """Chip and strides above each side, so that no column can be mistaken for the other leg's."""

    def __init__(self, look: Look, parent: QWidget) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self._look = look
        self.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.setMinimumSectionSize(1)
        self.setSectionsClickable(False)

    def sectionSizeFromContents(self, section: int) -> QSize:
        px, words = self._look.theme.px, self._words(section)
        width = QFontMetrics(self._look.theme.font(12)).horizontalAdvance(words)
        chip = px(CHIP + 6) if section in SIDE_OF else 0
        return QSize(width + chip + 2 * px(PADDING) + 1, px(HEAD))

    def paintSection(self, painter: QPainter, rect: object, section: int) -> None:
        theme = self._look.theme
        box = QRectF(rect)  # type: ignore[call-overload]  # the stubs call it an object
        painter.save()
        painter.setPen(QColor(theme.colours.ink2))
        painter.setFont(theme.font(12))
        inner = box.adjusted(0, 0, -theme.px(PADDING), 0)
        words = self._words(section)
        painter.drawText(inner, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, words)
        if section in SIDE_OF:
            side = theme.px(CHIP)
            x = inner.right() - QFontMetrics(theme.font(12)).horizontalAdvance(words) - theme.px(6) - side
            paint_chip(painter, QRectF(x, box.center().y() - side / 2, side, side), SIDE_OF[section], theme)
        painter.restore()

    def _words(self, section: int) -> str:
        model = self.model()
        assert isinstance(model, FiguresModel)
        return str(model.headerData(section, Qt.Orientation.Horizontal))


def _model(index: Index) -> FiguresModel:
    model = index.model()
    assert isinstance(model, FiguresModel)
    return model


def _mean(value: MeanAndSd | None, decimals: int) -> tuple[str, str]:
    if value is None or not math.isfinite(value.mean):
        return "", tr("none")
    spread = f"± {value.sd:.{decimals}f}" if is_spread_enough(value.n) else ""
    return _number(value.mean, decimals), spread


def _marked(cell: tuple[str, str], is_care: bool) -> tuple[str, str]:
    value, addition = cell
    return (value, f"{addition} {CARE_MARK}".lstrip()) if is_care and value else cell


def _range(figure: Figure) -> str:
    assert figure.band is not None
    decimals = figure.decimals if figure.decimals > 1 else 0
    low, high = (_number(value, decimals) for value in figure.band)
    return tr("{low} to {high}").format(low=low, high=high)


def _number(value: float, decimals: int) -> str:
    if not math.isfinite(value):
        return tr("none")
    return f"{value:.{decimals}f}".replace("-", MINUS) if round(value, decimals) else f"{0:.{decimals}f}"

"""How was each joint found, and how sure is that? One column per joint, one row per question."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, QPointF, QRectF, QSize, Qt
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
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wording import later, name_of, tr
from core.body import Joint, Side
from core.results import AxisSource, JointCalibration, ZeroKind

HEAD = 36
PADDING = 6
MARK = 16
MARGIN_WANTED = 1.3  # the same as in the findings: below it another answer fits almost as well
SHORTEST_LAG_S = 0.0005

AXIS_FROM = {
    AxisSource.FREE_MOTION: later("free motion"),
    AxisSource.WALKING: later("walking"),
    AxisSource.POOLED: later("free motion, walking"),
    AxisSource.HINGE: later("true hinge"),
    AxisSource.REFINED: later("rigid limb"),
}


@dataclass(frozen=True, slots=True)
class Cell:
    """What one cell says; `needs_look` marks it by a triangle and bold letters."""

    text: str
    needs_look: bool = False


JOINTS = (Joint.LEFT_KNEE, Joint.RIGHT_KNEE, Joint.LEFT_ANKLE, Joint.RIGHT_ANKLE)
Index = QModelIndex | QPersistentModelIndex


def _axis_from(found: JointCalibration) -> Cell:
    return Cell(tr(AXIS_FROM[found.axis_source]), found.axis_source is AxisSource.WALKING)


def _axis_certainty(found: JointCalibration) -> Cell:
    if found.axis_sd_rad is None or not math.isfinite(found.axis_sd_rad):
        return Cell(tr("unknown"), needs_look=True)
    return Cell(f"± {math.degrees(found.axis_sd_rad):.1f}°")


def _margin(found: JointCalibration) -> Cell:
    if found.sign_margin is None:
        return Cell(tr("unknown"), needs_look=True)
    if not math.isfinite(found.sign_margin) or found.sign_margin >= 100:
        return Cell(tr("over 100"))
    return Cell(f"{found.sign_margin:.1f}", found.sign_margin < MARGIN_WANTED)


def _direction(found: JointCalibration) -> Cell:
    return Cell(tr("sure")) if found.is_sign_certain else Cell(tr("uncertain"), needs_look=True)


def _lag(found: JointCalibration) -> Cell:
    if abs(found.lag_s) < SHORTEST_LAG_S:
        return Cell(tr("none"))
    return Cell(f"{found.lag_s * 1000:+.0f} ms".replace("-", "\N{MINUS SIGN}"))


def _zero(found: JointCalibration) -> Cell:
    match found.zero:
        case ZeroKind.STANDING:
            return Cell(tr("standing"))
        case ZeroKind.GONIOMETER:
            return Cell(tr("{angle} standing").format(angle=_degrees(found.offset_rad)))
        case _:
            return Cell(tr("none"), needs_look=True)


def _degrees(angle_rad: float) -> str:
    return f"{math.degrees(angle_rad):.1f}°".replace("-", "\N{MINUS SIGN}")


ROWS: tuple[tuple[str, str, Callable[[JointCalibration], Cell]], ...] = (
    (later("Axis from"), later("Which recording showed how the joint turns."), _axis_from),
    (later("Axis certainty"), later("One standard deviation of the direction of the joint axis."), _axis_certainty),
    (later("Margin"), later("How much worse the next best answer fits. Under {wanted} is doubt."), _margin),
    (later("Direction"), later("Whether flexion is told from extension."), _direction),
    (later("Clock lag"), later("What was added to the farther sensor's clock."), _lag),
    (later("Zero"), later("What reads zero, or the goniometer's value in standing."), _zero),
)


class FactsModel(QAbstractTableModel):
    def __init__(self) -> None:
        super().__init__()
        self._cells: list[list[Cell]] = []
        self.joints: list[Joint] = []

    def show_joints(self, found: Mapping[Joint, JointCalibration]) -> None:
        self.beginResetModel()
        self.joints = [joint for joint in JOINTS if joint in found]
        self._cells = [[tell(found[joint]) for joint in self.joints] for _, _, tell in ROWS]
        self.endResetModel()

    def cell(self, index: Index) -> Cell:
        return self._cells[index.row()][index.column()]

    def rowCount(self, _parent: Index = QModelIndex()) -> int:  # noqa: B008  Qt's own signature
        return len(self._cells) if self.joints else 0

    def columnCount(self, _parent: Index = QModelIndex()) -> int:  # noqa: B008  Qt's own signature
        return len(self.joints)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        row, joint = ROWS[index.row()], self.joints[index.column()]
        cell = self.cell(index)
        if role == Qt.ItemDataRole.DisplayRole:
            return cell.text
        if role == Qt.ItemDataRole.ToolTipRole:
            return tr(row[1]).format(wanted=MARGIN_WANTED)
        if role == Qt.ItemDataRole.AccessibleTextRole:
            said = f"{name_of(joint)}, {tr(row[0])}: {cell.text}"
            return tr("{cell}, look at it").format(cell=said) if cell.needs_look else said
        return None

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        if role != Qt.ItemDataRole.DisplayRole:
            return None
        return name_of(self.joints[section]) if orientation == Qt.Orientation.Horizontal else tr(ROWS[section][0])


class FactsTable(BareTable):
    def __init__(self, look: Look) -> None:
        model = FactsModel()
        super().__init__(look, model, tr("How each joint was found"), HEAD)
        self.facts = model
        self.dress(_JointHeader(look, self), _CellDelegate(look, self), _QuestionHeader(look, self))

    def show_joints(self, found: Mapping[Joint, JointCalibration]) -> None:
        self.facts.show_joints(found)
        self.fit()

    def as_text(self) -> str:
        """Give the table as tab-separated lines."""
        head = ["", *(name_of(joint) for joint in self.facts.joints)]
        model = self.facts
        rows = [
            [tr(ROWS[row][0]), *(model.cell(model.index(row, column)).text for column in range(model.columnCount()))]
            for row in range(model.rowCount())
        ]
        return "\n".join("\t".join(cells) for cells in [head, *rows])

    def fit(self) -> None:
        """Measure all of it anew, the questions too."""
        metrics = QFontMetrics(self._look.theme.font(14))
        questions = max(metrics.horizontalAdvance(tr(title)) for title, _, _ in ROWS)
        self.verticalHeader().setFixedWidth(questions + self._look.theme.px(PADDING))
        super().fit()

    def _row_height(self, row: int) -> int:
        option = QStyleOptionViewItem()
        cells = (self.facts.index(row, column) for column in range(self.facts.columnCount()))
        return max(self.itemDelegate().sizeHint(option, cell).height() for cell in cells)

    def _shared(self, spare: int) -> list[int]:
        return [width + spare // len(self.needed_widths) for width in self.needed_widths]


class _CellDelegate(QStyledItemDelegate):
    """Paints a cell's words, one line per comma, right-aligned under the joint."""

    def __init__(self, look: Look, parent: QWidget) -> None:
        super().__init__(parent)
        self._look = look

    def sizeHint(self, _option: QStyleOptionViewItem, index: Index) -> QSize:
        cell, px = self._cell(index), self._look.theme.px
        metrics = QFontMetrics(self._font(cell))
        lines = _lines(cell)
        width = max(metrics.horizontalAdvance(line) for line in lines) + 2 * px(PADDING)
        if cell.needs_look:
            width += px(MARK + 4)
        return QSize(width, px(ROW) + (len(lines) - 1) * px(18))

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        theme = self._look.theme
        cell, rect = self._cell(index), QRectF(option.rect)
        painter.save()
        painter.setPen(theme.pen(theme.colours.line, 1))
        painter.drawLine(rect.topLeft(), rect.topRight())
        painter.setPen(QColor(theme.colours.ink))
        painter.setFont(self._font(cell))
        lines = _lines(cell)
        inner = rect.adjusted(0, 0, -theme.px(PADDING), 0)
        painter.drawText(inner, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, "\n".join(lines))
        if cell.needs_look:
            metrics = QFontMetrics(self._font(cell))
            side = theme.px(MARK)
            x = inner.right() - max(metrics.horizontalAdvance(line) for line in lines) - theme.px(4) - side
            paint_icon(painter, Icon.WARNING, QRectF(x, rect.center().y() - side / 2, side, side), theme.colours.ink)
        painter.restore()

    def _cell(self, index: Index) -> Cell:
        model = index.model()
        assert isinstance(model, FactsModel)
        return model.cell(index)

    def _font(self, cell: Cell) -> QFont:
        return self._look.theme.font(14, SEMIBOLD if cell.needs_look else QFont.Weight.Normal)


class _JointHeader(QHeaderView):
    """Chip and joint above each column, so that no column can be mistaken for the other leg's."""

    def __init__(self, look: Look, parent: QWidget) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self._look = look
        self.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.setMinimumSectionSize(1)
        self.setSectionsClickable(False)

    def sectionSizeFromContents(self, section: int) -> QSize:
        px = self._look.theme.px
        metrics = QFontMetrics(self._look.theme.font(14, MEDIUM))
        return QSize(metrics.horizontalAdvance(self._word(section)) + px(CHIP + 6 + 2 * PADDING), px(HEAD))

    def paintSection(self, painter: QPainter, rect: object, section: int) -> None:
        theme = self._look.theme
        box = QRectF(rect)  # type: ignore[call-overload]  # the stubs call it an object
        painter.save()
        word = self._word(section)
        width = QFontMetrics(theme.font(14, MEDIUM)).horizontalAdvance(word)
        side = theme.px(CHIP)
        x = box.right() - theme.px(PADDING) - width
        painter.setPen(QColor(theme.colours.ink))
        painter.setFont(theme.font(14, MEDIUM))
        painter.drawText(QRectF(x, box.top(), width + 1, box.height()), Qt.AlignmentFlag.AlignVCenter, word)
        chip = QRectF(QPointF(x - theme.px(6) - side, box.center().y() - side / 2), QSize(side, side))
        paint_chip(painter, chip, self._side(section), theme)
        painter.restore()

    def _joint(self, section: int) -> Joint:
        model = self.model()
        assert isinstance(model, FactsModel)
        return model.joints[section]

    def _word(self, section: int) -> str:
        return tr("Knee") if self._joint(section).is_knee else tr("Ankle")

    def _side(self, section: int) -> Side:
        return self._joint(section).side


class _QuestionHeader(QHeaderView):
    def __init__(self, look: Look, parent: QWidget) -> None:
        super().__init__(Qt.Orientation.Vertical, parent)
        self._look = look
        self.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.setMinimumSectionSize(1)
        self.setSectionsClickable(False)

    def paintSection(self, painter: QPainter, rect: object, section: int) -> None:
        theme = self._look.theme
        box = QRectF(rect)  # type: ignore[call-overload]  # the stubs call it an object
        painter.save()
        painter.setPen(theme.pen(theme.colours.line, 1))
        painter.drawLine(box.topLeft(), box.topRight())
        painter.setPen(QColor(theme.colours.ink2))
        painter.setFont(theme.font(14))
        painter.drawText(box, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, ROWS[section][0])
        painter.restore()


def _lines(cell: Cell) -> list[str]:
    parts = cell.text.split(", ")
    return [part + "," for part in parts[:-1]] + parts[-1:]

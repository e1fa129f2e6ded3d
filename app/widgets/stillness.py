"""Progress of the standing, and which sensor moves: a ring that fills, and a line per sensor beside its limit."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QAccessible, QColor, QFontMetrics, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme.current import current_theme, px, scaled
from app.theme.icons import Icon, paint_icon
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.theme import CHIP_RADIUS
from app.widgets.painted import Painted, smooth_painter
from app.widgets.text import MEDIUM, REGULAR, SEMIBOLD
from app.wording.body import segment_name
from app.wording.translation import figure_text, tr
from core.body import Site

ONE_TURN = 360 * 16  # as Qt counts
STEPS = 720  # of the ring: finer ones nobody sees
RING = 18  # its width, on a ring of RING_SIZE
RING_SIZE = 340
COUNT = 176
ROW, COMPACT_ROW = 32, 26
INSET = 4
LIMIT_AT = 0.8  # of a bar's length


@dataclass(frozen=True, slots=True)
class RingFace:
    """What the ring shows: a share of the whole turn, and within it a figure or an icon over a word and a key."""

    share: float = 0.0
    figure: str = ""
    icon: Icon | None = None
    word: str = ""
    key: str = ""
    is_dotted: bool = False


class CountRing(Painted):
    """As large as its place; the figure is read from six metres."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self) -> None:
        super().__init__()
        self._face = RingFace()
        scaled(self.setMinimumSize, 160, 160)  # it takes the room there is, and asks for none that would have to scroll
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def show_face(self, face: RingFace) -> None:
        if face == self._face:
            return
        self._face = face
        self.setAccessibleName(" ".join(filter(None, [face.figure, face.word, face.key])))
        self.update()

    def draw(self, painter: QPainter) -> None:
        theme, face = current_theme(), self._face
        c = theme.colours
        side = min(self.width(), self.height(), theme.px(1.3 * RING_SIZE))
        grow = side / RING_SIZE  # of what lies inside
        box = QRectF((self.width() - side) / 2, (self.height() - side) / 2, side, side)
        width = RING * grow
        arc = box.adjusted(width / 2, width / 2, -width / 2, -width / 2)
        pen = theme.pen(c.track, 1)
        pen.setWidthF(width)
        pen.setCapStyle(Qt.PenCapStyle.FlatCap)
        if face.is_dotted:
            pen.setColor(QColor(c.control))
            pen.setWidthF(width / 3)
            pen.setDashPattern([1.0, 1.6])
        painter.setPen(pen)
        painter.drawEllipse(arc)
        if face.share > 0:
            pen.setColor(QColor(c.ink))
            painter.setPen(pen)
            painter.drawArc(arc, 90 * 16, -round(face.share * ONE_TURN))
        self._paint_face(painter, box, grow)

    def _paint_face(self, painter: QPainter, box: QRectF, grow: float) -> None:
        theme, face = current_theme(), self._face
        c, middle = theme.colours, Qt.AlignmentFlag.AlignCenter
        has_more = bool(face.word or face.key)
        figure = QRectF(box.left(), box.center().y() - 108 * grow, box.width(), 190 * grow)
        if not has_more:
            figure.moveCenter(box.center())
        if face.figure:
            painter.setPen(QColor(c.ink))
            font = theme.font(COUNT, SEMIBOLD)
            font.setPixelSize(max(1, round(COUNT * grow)))
            painter.setFont(font)
            painter.drawText(figure, middle, face.figure)
        elif face.icon is not None:
            size = 150 * grow
            mark = QRectF(0, 0, size, size)
            mark.moveCenter(figure.center())
            paint_icon(painter, face.icon, mark, c.ink)
        line = QRectF(box.left(), box.center().y() + 78 * grow, box.width(), theme.px(28))
        if not face.figure and face.icon is None:
            line.moveCenter(box.center())
        painter.setFont(theme.font(18, MEDIUM))
        word_width = painter.fontMetrics().horizontalAdvance(face.word)
        painter.setPen(QColor(c.ink2))
        if not face.key:
            painter.drawText(line, middle, face.word)
            return
        painter.setFont(theme.font(14, MEDIUM))
        cap_width = painter.fontMetrics().horizontalAdvance(face.key) + theme.px(20)
        left = line.center().x() - (cap_width + theme.px(8) + word_width) / 2
        cap = QRectF(left, line.top(), cap_width, line.height())
        painter.setPen(theme.pen(c.control, 1.25))
        painter.drawRoundedRect(cap, CHIP_RADIUS * theme.scale, CHIP_RADIUS * theme.scale)
        painter.setPen(QColor(c.ink))
        painter.drawText(cap, middle, face.key)
        painter.setFont(theme.font(18, MEDIUM))
        painter.setPen(QColor(c.ink2))
        word = QRectF(cap.right() + theme.px(8), line.top(), word_width + 2, line.height())
        painter.drawText(word, Qt.AlignmentFlag.AlignVCenter, face.word)


@dataclass(frozen=True, slots=True)
class _Row:
    figure: str
    share: float  # of the bar's length
    has_moved: bool
    is_silent: bool


class MovementBars(QWidget):
    """A row per worn sensor: L, then R, then by name those whose site nobody knows.

    A row is painted again only when its figure or its mark changes.
    """

    def __init__(self) -> None:
        super().__init__()
        self._is_compact = False
        self._limit = 1.0
        self._rows: dict[str, _Row] = {}
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self._refresh()

    def show_movement(
        self,
        movement_deg_s: Mapping[str, float],
        limit_deg_s: float,
        moved: Sequence[str],
        silent: Sequence[str],
    ) -> None:
        """Show each worn sensor's movement; infinite where too few samples came to know it."""
        sites = [site for site in Site if site in movement_deg_s]
        unplaced = sorted(set(movement_deg_s) - set(sites))
        rows = {
            site: _Row(
                figure_text(movement_deg_s[site], ".1f") if math.isfinite(movement_deg_s[site]) else "\N{EN DASH}",
                round(min(movement_deg_s[site] / limit_deg_s * LIMIT_AT, 1.0), 2),
                site in moved,
                site in silent,
            )
            for site in (*sites, *unplaced)
        }
        if list(rows) != list(self._rows) or limit_deg_s != self._limit:
            self._rows, self._limit = rows, limit_deg_s
            self._refresh()
            return
        for number, (site, row) in enumerate(rows.items()):
            if row != self._rows[site]:
                self.update(0, number * self._row_height, self.width(), self._row_height)
        self._rows = rows

    def sizeHint(self) -> QSize:
        return QSize(px(230), max(1, len(self._rows)) * self._row_height)

    def minimumSizeHint(self) -> QSize:
        return QSize(
            px(INSET + CHIP + 8) + self._name_width + px(8 + 50 + 8) + self._figure_width, self.sizeHint().height()
        )

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = smooth_painter(self)
        for number, (sensor, row) in enumerate(self._rows.items()):
            place = QRect(0, number * self._row_height, self.width(), self._row_height)
            if event.rect().intersects(place):
                self._paint_row(painter, place, sensor, row)

    def _paint_row(self, painter: QPainter, place: QRect, sensor: str, row: "_Row") -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        ink = c.ink
        if row.has_moved or row.is_silent:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(c.caution))
            painter.drawRoundedRect(QRectF(place).adjusted(0, 1, 0, -1), CHIP_RADIUS, CHIP_RADIUS)
            ink = c.caution_ink
        chip, left = px(CHIP), px(INSET)
        is_placed = sensor in set(Site)
        if is_placed and (side := Site(sensor).side) is not None:
            box = QRectF(left, place.center().y() - chip / 2 + 0.5, chip, chip)
            paint_chip(painter, box, side, theme)
        painter.setPen(QColor(ink))
        painter.setFont(theme.font(14, MEDIUM))
        name = place.adjusted(left + (chip + px(8) if is_placed else 0), 0, 0, 0)
        upright = Qt.AlignmentFlag.AlignVCenter
        painter.drawText(name, upright, _name(sensor))
        bar_left = left + chip + px(8) + self._name_width + px(8)
        if row.is_silent:
            painter.setFont(theme.font(14, SEMIBOLD))
            painter.drawText(place.adjusted(0, 0, -left, 0), upright | Qt.AlignmentFlag.AlignRight, tr("no signal"))
            return
        figure = place.adjusted(place.width() - self._figure_width, 0, -left, 0)
        painter.setFont(theme.font(14, SEMIBOLD if row.has_moved else REGULAR))
        painter.drawText(figure, upright | Qt.AlignmentFlag.AlignRight, row.figure)
        bar = QRectF(bar_left, place.center().y() - px(3), figure.left() - px(8) - bar_left, px(6))
        radius = bar.height() / 2
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(c.track if not row.has_moved else c.surface))
        painter.drawRoundedRect(bar, radius, radius)
        painter.setBrush(QColor(ink))
        painter.drawRoundedRect(
            QRectF(bar.left(), bar.top(), max(bar.height(), row.share * bar.width()), bar.height()), radius, radius
        )
        limit = bar.left() + LIMIT_AT * bar.width()
        painter.setPen(theme.pen(ink, 1.75))
        painter.drawLine(QPointF(limit, bar.center().y() - px(8)), QPointF(limit, bar.center().y() + px(8)))

    @property
    def _row_height(self) -> int:
        return px(COMPACT_ROW if self._is_compact else ROW)

    @property
    def _name_width(self) -> int:
        metrics = QFontMetrics(current_theme().font(14, MEDIUM))
        chip = px(CHIP + 8)  # a sensor that nobody has placed has none, but a longer name
        widths = [metrics.horizontalAdvance(_name(one)) - (0 if one in set(Site) else chip) for one in self._rows]
        return max(widths, default=0)

    @property
    def _figure_width(self) -> int:
        return QFontMetrics(current_theme().font(14, SEMIBOLD)).horizontalAdvance("000.0") + px(INSET)

    def _refresh(self) -> None:
        self.updateGeometry()
        self.update()


def _name(sensor: str) -> str:
    return segment_name(Site(sensor).segment) if sensor in set(Site) else sensor

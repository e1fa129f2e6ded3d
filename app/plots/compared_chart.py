"""One joint of one leg in several walks: their mean cycles laid over one another, told apart by letter and width."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy

from app.charts.axes import degrees_in_words, part_in_words, range_for, range_in_words, sign_in_words, title_in_words
from app.charts.cycles import PERCENT, is_mean_enough
from app.icons import Icon
from app.plots.cycle_chart import CASING_PX, SIMULATED, CycleChart
from app.theme import Look
from app.widgets.card import Card
from app.widgets.chip import Chip
from app.widgets.icons import IconMark
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording import tr
from core.body import Side
from core.gait.cycles import MeanCycle

DOT = 10  # radius of a letter's circle
LETTER_PX = 12
APART = 4  # between two letters
FIRST_PX, LAST_PX = 1.25, 2.75
FIRST_ALPHA = 0.65
LEADER_PERCENT = 16  # from where the lines are read to their letters
TOE_OFF_PX = 0.75


@dataclass(frozen=True, slots=True)
class Line:
    """The mean cycle (101,) of one walk, condition or visit, degrees, and when its foot leaves the floor."""

    letter: str
    mean: MeanCycle
    toe_off_percent: float


class ComparedChart(CycleChart):
    """The later, the thicker; the last letter is filled."""

    def __init__(self, look: Look, side: Side, fixed_deg: tuple[float, float]) -> None:
        super().__init__(look, fixed_deg)
        self._side = side
        self.lines: tuple[Line, ...] = ()

    def show_lines(self, lines: Sequence[Line], is_simulated: bool, is_about_mean: bool = False) -> None:
        """Draw every line that is known, and widen the axis where one leaves it."""
        self.lines, self.is_simulated = tuple(line for line in lines if line.mean.n), is_simulated
        self.is_about_mean = is_about_mean
        self.range_deg = range_for(self._usual_deg, [line.mean.mean for line in self.lines])
        self.redraw()

    def pen_of(self, k: int) -> QPen:
        """The pen of line `k`: thin and pale to begin with, thick at the end; left solid, right dashed."""
        theme, share = self._look.theme, k / max(len(self.lines) - 1, 1) if len(self.lines) > 1 else 1.0
        width = FIRST_PX + share * (LAST_PX - FIRST_PX)
        pen = theme.side_pen(self._side, width)
        if self._side is Side.RIGHT:
            pen.setDashPattern([9.0 / width, 5.0 / width])  # dashes of one length, however thick
        colour = theme.text(self._side) if not theme.is_dark else theme.curve(self._side)
        if not is_mean_enough(self.lines[k].mean.n):
            colour = QColor(theme.colours.control)
        colour.setAlphaF(FIRST_ALPHA + share * (1 - FIRST_ALPHA))
        pen.setColor(colour)
        return pen

    def letters(self) -> list[tuple[str, QPointF, QPointF]]:
        """Each letter, the place of its circle, and that of its line where it is read: where they lie furthest apart.

        The circles stand above one another in the order of the lines, beside them, inside the plot.
        """
        if not self.lines:
            return []
        area, px = self.plot_area(), self._look.theme.px
        means = np.array([line.mean.mean for line in self.lines])
        at = int(np.argmax(np.ptp(means[:, 5:96], axis=0))) + 5 if len(self.lines) > 1 else int(np.argmax(means[0]))
        order = np.argsort(-means[:, at], kind="stable")
        spacing = min(px(2 * DOT + APART), (area.height() - px(2 * DOT)) / max(len(order), 1))
        percent = at + LEADER_PERCENT if at + LEADER_PERCENT < 95 else at - LEADER_PERCENT
        height = spacing * (len(order) - 1)
        top = self.at(at, float(means[:, at].mean())).y() - height / 2
        top = min(max(top, area.top() + px(DOT + 1)), area.bottom() - px(DOT + 1) - height)
        return [
            (
                self.lines[k].letter,
                QPointF(self.at(percent, 0).x(), top + row * spacing),
                self.at(at, float(means[k, at])),
            )
            for row, k in enumerate(order)
        ]

    def _paint(self, painter: QPainter) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.save()
        painter.setClipRect(self.plot_area())
        if self.has_band and self.band is not None:
            for sds, colour in ((2, self._look.theme.colours.band_2sd), (1, self._look.theme.colours.band_1sd)):
                self._fill(painter, self.band.mean_deg, sds * self.band.sd_deg, QColor(colour))
        painter.restore()
        self._paint_axes(painter)
        painter.save()
        painter.setClipRect(self.plot_area())
        self._paint_toe_offs(painter)
        for k, line in enumerate(self.lines):
            curve = self._polygon(PERCENT, line.mean.mean)
            pen = self.pen_of(k)
            casing = self._look.theme.pen(self._look.theme.colours.surface, CASING_PX - 2.5 + pen.widthF())
            casing.setCapStyle(Qt.PenCapStyle.FlatCap)
            painter.setPen(casing)
            painter.drawPolyline(curve)
            painter.setPen(pen)
            painter.drawPolyline(curve)
        painter.restore()
        self._paint_letters(painter)
        self._paint_simulated(painter)

    def _paint_toe_offs(self, painter: QPainter) -> None:
        area = self.plot_area()
        for k, line in enumerate(self.lines):
            if np.isfinite(line.toe_off_percent):
                pen = self.pen_of(k)
                pen.setWidthF(TOE_OFF_PX * self._look.theme.scale)
                painter.setPen(pen)
                x = self.at(line.toe_off_percent, 0).x()
                painter.drawLine(QPointF(x, area.top()), QPointF(x, area.bottom()))

    def _paint_letters(self, painter: QPainter) -> None:
        theme = self._look.theme
        last = self.lines[-1].letter if self.lines else ""
        for letter, centre, on_line in self.letters():
            painter.setPen(theme.pen(theme.colours.ink2, 0.75))
            way = 1 if centre.x() > on_line.x() else -1
            elbow = QPointF(centre.x() - way * theme.px(DOT + 8), centre.y())
            painter.drawLine(on_line, elbow)
            painter.drawLine(elbow, centre)
            paint_letter(painter, self._look, letter, centre, theme.text(self._side), letter == last)

    def _paint_simulated(self, painter: QPainter) -> None:
        if self.is_simulated:
            theme = self._look.theme
            painter.setFont(theme.font(12, SEMIBOLD))
            painter.setPen(QColor(theme.colours.ink))
            room = QRectF(0, 0, self.width(), self.plot_area().top())
            painter.drawText(room, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, tr(SIMULATED))


class ComparedFrame(Card):
    """A chart under its leg, joint and sign, with what must be known to read it."""

    def __init__(self, look: Look, chart: ComparedChart, side: Side, is_knee: bool) -> None:
        self._side, self._is_knee = side, is_knee
        self.chart = chart
        self._mark = IconMark(look, Icon.WARNING, size=18)
        self._note = Text(look, size=12, weight=MEDIUM, wraps=True)
        super().__init__(look, padding=12, spacing=2)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        head, notes = QHBoxLayout(), QHBoxLayout()
        head.setSpacing(8)
        head.addWidget(Chip(look, side))
        head.addWidget(Text(look, title_in_words(is_knee), size=16, weight=SEMIBOLD))
        head.addStretch(1)
        head.addWidget(Text(look, sign_in_words(is_knee), size=12, tone="ink2"))
        notes.setSpacing(8)
        notes.addWidget(self._mark, 0, Qt.AlignmentFlag.AlignTop)
        notes.addWidget(self._note, 1)
        self.column.addLayout(head)
        self.column.addLayout(notes)
        self.column.addWidget(chart, 1)

    @property
    def note(self) -> str:
        return self._note.text()

    def show_lines(self, lines: Sequence[Line], note: str, is_simulated: bool, *, is_about_mean: bool = False) -> None:
        self.chart.show_lines(lines, is_simulated, is_about_mean)
        said = [note] if note else []
        if not self.chart.lines:
            said = said or [tr("Not measured.")]
        elif self.chart.is_widened:
            said.append(range_in_words(self.chart.range_deg))
        self._note.setText(" ".join(said))
        for widget in (self._mark, self._note):
            widget.setVisible(bool(said))
        self.chart.setAccessibleName(tr("{joint}, compared").format(joint=part_in_words(self._side, self._is_knee)))
        self.chart.setAccessibleDescription(self.in_words())

    def in_words(self) -> str:
        """Say each curve's highest and lowest angle, for who cannot see them."""
        said = [tr("Simulated.")] if self.chart.is_simulated else []
        for line in self.chart.lines:
            mean = line.mean.mean
            told = tr("{letter}: {lowest} at {lowest_percent} % to {highest} at {highest_percent} %.")
            said.append(
                told.format(
                    letter=line.letter,
                    lowest=degrees_in_words(np.min(mean)),
                    lowest_percent=np.argmin(mean),
                    highest=degrees_in_words(np.max(mean)),
                    highest_percent=np.argmax(mean),
                )
            )
        return " ".join([*said, self.note]).strip()


def paint_letter(painter: QPainter, look: Look, letter: str, centre: QPointF, colour: QColor, is_filled: bool) -> None:
    """Draw a letter in its circle, filled or hollow."""
    theme = look.theme
    c, radius = theme.colours, DOT * theme.scale
    painter.setPen(theme.pen(colour, 1.5))
    painter.setBrush(colour if is_filled else QColor(c.surface))
    painter.drawEllipse(centre, radius, radius)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QColor(c.ground if theme.is_dark else c.surface) if is_filled else colour)
    painter.setFont(theme.font(LETTER_PX, SEMIBOLD))
    room = QRectF(centre.x() - radius, centre.y() - radius, 2 * radius, 2 * radius)
    painter.drawText(room, Qt.AlignmentFlag.AlignCenter, letter)

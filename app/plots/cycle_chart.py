"""Knee above ankle over one stride: each side on its own stride, the mean on the band of a cited group.

The chart paints itself: nobody zooms a stride, and so every label finds its place.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QMouseEvent, QPainter, QPaintEvent, QPen, QPixmap, QPolygonF
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QSizePolicy

from app.charts.axes import (
    ABOUT_MEAN_DEG,
    ANKLE_DEG,
    AXIS_WIDTH,
    KNEE_DEG,
    degrees_in_words,
    joint_of,
    nothing_in_words,
    part_in_words,
    range_for,
    range_in_words,
    sign_in_words,
    title_in_words,
)
from app.charts.cycles import PERCENT, Band, SideCycle, is_mean_enough, is_spread_enough
from app.charts.frame import Frame
from app.charts.marks import BAND_SDS, MOST_MARKS, Deviation, Gap, Point
from app.charts.on_screen import gap_boxes, paint_deviation, paint_gap_bars, paint_gaps, place_deviation
from app.charts.places import Ground, MarkPlace, line_of
from app.icons import Icon
from app.reports.walk_figures import MAY_BE_MIRRORED, NO_HEIGHT, NO_ZERO, WITHHELD, doubt_in, verdict_of, why_in_words
from app.theme import Look
from app.widgets.card import Card
from app.widgets.chip import LETTERS
from app.widgets.icons import IconMark
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.widgets.themed import Themed
from app.widgets.verdict_chip import VerdictChip
from app.widgets.withheld_panel import WithheldPanel
from app.wording import capitalised, joined, later, tr
from core.body import Joint, Side
from core.norms import ReferenceCurves
from core.samples import FloatArray
from core.verdicts.model import JointVerdicts, Verdict

LEAST_SIZE = (284, 156)
LABEL_HEIGHT = 24  # toe-off stands above the plot
TICKS_HEIGHT = 24
RIGHT_MARGIN = 20  # half of "100 %" stands beside the plot
TICK = 4
TICK_DEG = 20
TICK_PERCENT = 20
MEAN_PX, CASING_PX, STRIDE_PX, TOE_OFF_PX = 2.5, 4.5, 1.0, 1.5
STRIDE_ALPHA = 0.7
DOUBTS = {
    NO_ZERO: later("{sides}: no zero. Range and shape hold, height does not."),
    NO_HEIGHT: later("{sides}: the height cannot be read. Range and shape hold."),
    MAY_BE_MIRRORED: later("{sides}: sign unsure. The curve may be upside down."),
}
SMOOTH_UP_TO = 40  # strides; smooth lines take ten times as long
SIMULATED = later("SIMULATED")


class CycleCharts(Themed):
    """Both charts, with what they share: the band and the single strides, each on or off."""

    picked = Signal(bool, float, float)  # whether of the knee; percent of the stride, degrees

    def __init__(self, look: Look, reference: ReferenceCurves) -> None:
        super().__init__()
        self._look = look
        knee, ankle = CycleChart(look, KNEE_DEG), CycleChart(look, ANKLE_DEG)
        self.knee = CycleFrame(look, knee, is_knee=True)
        self.ankle = CycleFrame(look, ankle, is_knee=False)
        self._box = QBoxLayout(QBoxLayout.Direction.TopToBottom, self)
        self._box.setContentsMargins(0, 0, 0, 0)
        for frame in self.frames:
            self._box.addWidget(frame, 1)
            frame.chart.picked.connect(self._on_picked)
        self.set_band(reference)
        self._on_look_changed()

    @property
    def frames(self) -> tuple["CycleFrame", "CycleFrame"]:
        return self.knee, self.ankle

    @property
    def heights_deg(self) -> dict[Joint, float]:
        """By how much the curves of joints without a height are drawn lower than they were measured."""
        found: dict[Joint, float] = {}
        for frame, is_knee in ((self.knee, True), (self.ankle, False)):
            found |= {joint_of(side, is_knee): height for side, height in frame.heights_deg.items()}
        return found

    def show_cycles(
        self, cycles: Mapping[Joint, SideCycle], verdicts: Mapping[Joint, JointVerdicts], is_simulated: bool
    ) -> None:
        """Draw the joints of one walk, as far as the verdicts let them be seen; a joint without one can be read."""
        for frame, is_knee in ((self.knee, True), (self.ankle, False)):
            frame.show_cycles(
                {joint.side: cycle for joint, cycle in cycles.items() if joint.is_knee is is_knee},
                {joint.side: found for joint, found in verdicts.items() if joint.is_knee is is_knee},
                is_simulated,
            )

    def set_band(self, reference: ReferenceCurves | None) -> None:
        """Draw this group's band, or none where none may stand beside the walk."""
        for frame, kind in ((self.knee, "knee"), (self.ankle, "ankle")):
            frame.chart.band = Band(*reference.mean_and_sd_deg(kind)) if reference is not None else None
            frame.chart.redraw()

    def show_stride(self, curves_deg: Mapping[Joint, FloatArray]) -> None:
        """Draw one stride (101,) over all others, bold; none: no stride is in force."""
        for frame, is_knee in ((self.knee, True), (self.ankle, False)):
            found = [(joint.side, curve) for joint, curve in curves_deg.items() if joint.is_knee is is_knee]
            frame.show_stride(found[0] if found else None)

    def show_marks(self, deviations: Sequence[Deviation], gaps: Sequence[Gap] = ()) -> None:
        """Mark on the curves what stands out, degrees as measured; the next walk shown is without."""
        for frame, is_knee in ((self.knee, True), (self.ankle, False)):
            frame.show_marks(
                [found for found in deviations if found.is_knee is is_knee],
                [gap for gap in gaps if gap.joint.is_knee is is_knee],
            )

    def set_strides_shown(self, is_shown: bool) -> None:
        for frame in self.frames:
            frame.set_strides_shown(is_shown)

    def set_band_shown(self, is_shown: bool) -> None:
        for frame in self.frames:
            frame.chart.has_band = is_shown
            frame.chart.redraw()

    def show_cursor(self, percent: Mapping[Side, float]) -> None:
        """Mark a place on each leg's own stride; none: no cursor."""
        for frame in self.frames:
            frame.chart.readings = percent
            frame.chart.update()

    def set_brief(self, is_brief: bool) -> None:
        """Leave out what the axis and the icons say as well, where there is little room."""
        for frame in self.frames:
            frame.set_brief(is_brief)

    def set_side_by_side(self, is_side_by_side: bool) -> None:
        way = QBoxLayout.Direction.LeftToRight if is_side_by_side else QBoxLayout.Direction.TopToBottom
        self._box.setDirection(way)

    def _on_picked(self, percent: float, angle_deg: float) -> None:
        self.picked.emit(self.sender() is self.knee.chart, percent, angle_deg)

    def _on_look_changed(self) -> None:
        self._box.setSpacing(self._look.theme.px(12))


class CycleFrame(Card):
    """A chart with its title, its sign in words, the key to its curves and what must be known to read them."""

    def __init__(self, look: Look, chart: "CycleChart", is_knee: bool) -> None:
        self._is_knee = is_knee
        self.chart = chart
        self.chips = {side: VerdictChip(look, side) for side in Side}
        self._mark = IconMark(look, Icon.WARNING, size=18)
        self._note = Text(look, size=12, weight=MEDIUM, wraps=True)
        self.withheld = {side: WithheldPanel(look, side) for side in Side}
        self.heights_deg: dict[Side, float] = {}
        super().__init__(look, padding=12, spacing=2)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        head = QHBoxLayout()
        head.setSpacing(8)
        head.addWidget(Text(look, title_in_words(is_knee), size=16, weight=SEMIBOLD))
        self._sign = Text(look, sign_in_words(is_knee), size=12, tone="ink2")
        head.addWidget(self._sign)
        head.addStretch(1)
        for side in Side:
            head.addWidget(self.chips[side])
        notes = QHBoxLayout()
        notes.setSpacing(8)
        notes.addWidget(self._mark, 0, Qt.AlignmentFlag.AlignTop)
        notes.addWidget(self._note, 1)
        self.column.addLayout(head)
        self.column.addLayout(notes)
        for panel in self.withheld.values():
            self.column.addWidget(panel)
        self.column.addWidget(chart, 3)

    @property
    def note(self) -> str:
        return self._note.text()

    def show_cycles(
        self, cycles: Mapping[Side, SideCycle], verdicts: Mapping[Side, JointVerdicts], is_simulated: bool
    ) -> None:
        """Draw what may be seen; without a height of every leg that is drawn, all are drawn about their own mean."""
        doubts = {side: why for side, found in verdicts.items() if side in cycles and (why := doubt_in(found))}
        reasons = {side: why_in_words(found) for side, found in verdicts.items() if side in cycles}
        is_about_mean = any(why != WITHHELD for why in doubts.values())
        self.heights_deg = {side: cycle.height_deg for side, cycle in cycles.items()} if is_about_mean else {}
        drawn = {side: cycle.about_mean() for side, cycle in cycles.items()} if is_about_mean else cycles
        withheld = frozenset(side for side, why in doubts.items() if why == WITHHELD)
        self.chart.show_cycles(drawn, is_simulated, withheld, is_about_mean)
        for side, chip in self.chips.items():
            chip.setVisible(side in cycles)
            chip.tell(verdict_of(verdicts[side]) if side in verdicts else Verdict.READ, has_line=side not in withheld)
            self.withheld[side].tell(reasons[side] if side in withheld else "")
        self._note.setText(" ".join(self._notes(cycles, doubts)))
        for widget in (self._mark, self._note):
            widget.setVisible(bool(self._note.text()))
        self._show_chart()
        self.chart.setAccessibleName(tr("{joint} over one stride").format(joint=title_in_words(self._is_knee)))
        self.chart.setAccessibleDescription(self.in_words())

    def show_marks(self, deviations: Sequence[Deviation], gaps: Sequence[Gap]) -> None:
        """Mark the curves that are drawn; of several differences the first two."""

        def lowered(point: Point) -> Point:
            return point.lowered(self.heights_deg.get(point.joint.side, 0.0))

        drawn = self.chart.sides_with_mean
        self.chart.deviations = tuple(
            replace(found, first=lowered(found.first), second=lowered(found.second))
            for found in deviations
            if drawn.issuperset(point.joint.side for point in found.points)
        )[:MOST_MARKS]
        heights = self.heights_deg
        self.chart.gaps = tuple(
            gap.lowered(heights.get(gap.joint.side, 0.0)) for gap in gaps if gap.joint.side in drawn
        )
        self.chart.redraw()
        self.chart.setAccessibleDescription(self.in_words())

    def show_stride(self, stride: tuple[Side, FloatArray] | None) -> None:
        """Draw one stride (101,) over all others, bold."""
        self.chart.stride = (stride[0], stride[1] - self.heights_deg.get(stride[0], 0.0)) if stride else None
        self.chart.redraw()

    def set_brief(self, is_brief: bool) -> None:
        self._sign.setVisible(not is_brief)
        for chip in self.chips.values():
            chip.set_brief(is_brief)

    def set_strides_shown(self, is_shown: bool) -> None:
        self.chart.has_strides = is_shown
        self._show_chart()
        self.chart.redraw()

    def _show_chart(self) -> None:
        """Leave it away where nothing of it could be seen: the panels then take its place."""
        chart = self.chart
        is_empty = bool(chart.cycles) and not any(chart.is_drawn(side) for side in chart.cycles)
        chart.setVisible(not is_empty)

    def in_words(self) -> str:
        """Say each side's mean curve, for who cannot see it."""
        said = [tr("Simulated.")] if self.chart.is_simulated else []
        for side, cycle in self.chart.cycles.items():
            part = part_in_words(side, self._is_knee)
            if side in self.chart.withheld:
                said.append(f"{part}: {self.withheld[side].text}")
                continue
            if not cycle.mean.n:
                said.append(tr("{part} has no usable stride.").format(part=part))
                continue
            lowest, highest = np.min(cycle.mean.mean), np.max(cycle.mean.mean)
            told = tr(
                "{part}, mean of {count}: {lowest} at {lowest_percent} % to {highest} at {highest_percent} %, "
                "toe-off at {toe_off_percent:.0f} %."
            )
            said.append(
                told.format(
                    part=part,
                    count=cycle.mean.n,
                    lowest=degrees_in_words(lowest),
                    lowest_percent=np.argmin(cycle.mean.mean),
                    highest=degrees_in_words(highest),
                    highest_percent=np.argmax(cycle.mean.mean),
                    toe_off_percent=cycle.toe_off_percent,
                )
            )
        for side, chip in self.chips.items():
            if side in self.chart.cycles and chip.verdict is Verdict.CARE:
                said.append(f"{capitalised(chip.accessibleName())}.")
        said += [deviation.in_words() for deviation in self.chart.deviations]
        said += [gap.in_words() for gap in self.chart.gaps]
        said += [self.note] if self.note else []
        return " ".join(said) or nothing_in_words(self._is_knee)

    def _notes(self, cycles: Mapping[Side, SideCycle], doubts: Mapping[Side, str]) -> list[str]:
        notes = []
        for why, what in DOUBTS.items():
            sides = [LETTERS[side] for side in doubts if doubts[side] == why]
            notes += [tr(what).format(sides=joined(sides))] if sides else []
        if self.chart.is_about_mean:
            notes.append(tr("0° is the mean of the stride."))
        if not cycles:
            notes.append(nothing_in_words(self._is_knee))
        empty = [LETTERS[s] for s, cycle in cycles.items() if not cycle.mean.n and s not in self.chart.withheld]
        if empty:
            notes.append(tr("{sides}: no usable stride.").format(sides=joined(empty)))
        if self.chart.is_widened:
            notes.append(range_in_words(self.chart.range_deg))
        return notes


class CycleChart(Themed):
    """One joint over 0 to 100 % of the stride; its axis stays unless a mean curve leaves it."""

    picked = Signal(float, float)  # percent of the stride, degrees

    def __init__(self, look: Look, fixed_deg: tuple[float, float]) -> None:
        super().__init__()
        self._look, self._fixed = look, fixed_deg
        self.range_deg = fixed_deg
        self.cycles: Mapping[Side, SideCycle] = {}
        self.band: Band | None = None
        self.is_simulated = False
        self.has_band, self.has_strides = True, False
        self.is_about_mean = False
        self.withheld: frozenset[Side] = frozenset()  # of whom no mean is drawn
        self.stride: tuple[Side, FloatArray] | None = None
        self.readings: Mapping[Side, float] = {}  # percent of each leg's own stride
        self.deviations: tuple[Deviation, ...] = ()
        self.gaps: tuple[Gap, ...] = ()
        self._picture: QPixmap | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    @property
    def is_widened(self) -> bool:
        return self.range_deg != self._usual_deg

    @property
    def _usual_deg(self) -> tuple[float, float]:
        return ABOUT_MEAN_DEG.get(self._fixed, self._fixed) if self.is_about_mean else self._fixed

    def sizeHint(self) -> QSize:
        px = self._look.theme.px
        return QSize(px(LEAST_SIZE[0]), px(LEAST_SIZE[1]))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def show_cycles(
        self,
        cycles: Mapping[Side, SideCycle],
        is_simulated: bool,
        withheld: frozenset[Side] = frozenset(),
        is_about_mean: bool = False,
    ) -> None:
        """Draw each side's strides, and widen the axis where their mean leaves it."""
        self.cycles, self.is_simulated = cycles, is_simulated
        self.withheld, self.is_about_mean = withheld, is_about_mean
        self.deviations, self.gaps = (), ()
        means = [cycle.mean.mean for side, cycle in cycles.items() if side not in withheld]
        self.range_deg = range_for(self._usual_deg, means)
        self.redraw()

    def is_drawn(self, side: Side) -> bool:
        """Whether a side is to be seen: of what is withheld, single strides where they are wanted or few."""
        return side not in self.withheld or self._has_strides_of(side)

    def _has_strides_of(self, side: Side) -> bool:
        return self.has_strides or (side in self.withheld and not is_mean_enough(len(self.cycles[side].strides_deg)))

    def _means(self) -> Iterator[tuple[Side, SideCycle]]:
        """Those whose mean may be seen."""
        return ((side, cycle) for side, cycle in self.cycles.items() if side not in self.withheld)

    @property
    def sides_with_mean(self) -> frozenset[Side]:
        return frozenset(side for side, cycle in self._means() if cycle.mean.n)

    def places(self) -> list[MarkPlace]:
        """Where each difference that is marked finds room, px of the widget."""
        frame = self.frame
        curves = [line_of(frame, PERCENT, cycle.mean.mean) for _, cycle in self._means() if cycle.mean.n]
        edges = []
        if self._band_drawn is not None:
            reach = BAND_SDS * self._band_drawn.sd_deg
            edges = [self._band_drawn.mean_deg - reach, self._band_drawn.mean_deg, self._band_drawn.mean_deg + reach]
        ground = Ground(
            frame,
            curves,
            [line_of(frame, PERCENT, edge) for edge in edges],
            [float(frame.x(percent)) for _, percent in self._toe_offs()],
            gap_boxes(self._look.theme, frame, self.gaps),
        )
        return [place_deviation(self._look.theme, ground, deviation) for deviation in self.deviations]

    @property
    def _band_drawn(self) -> Band | None:
        return self.band if self.has_band and not self.is_about_mean else None

    @property
    def frame(self) -> Frame:
        area, (lowest, highest) = self.plot_area(), self.range_deg
        return Frame(area.left(), area.top(), area.width(), area.height(), lowest, highest)

    def redraw(self) -> None:
        """Paint anew, since what is shown has changed."""
        self._picture = None
        self.update()

    def toe_off_labels(self) -> dict[Side, str]:
        """Name each toe-off: the word at the earlier line, which has the room at its left."""
        found = self._toe_offs()
        labels = [tr("toe-off {side} {percent:.0f} %"), "{side} {percent:.0f} %"]
        return {
            side: label.format(side=LETTERS[side], percent=percent)
            for label, (side, percent) in zip(labels, found, strict=False)
        }

    def paintEvent(self, _event: QPaintEvent) -> None:
        ratio = self.devicePixelRatioF()
        if self._picture is None or self._picture.size() != self.size() * ratio:
            self._picture = QPixmap(self.size() * ratio)
            self._picture.setDevicePixelRatio(ratio)
            self._picture.fill(QColor(self._look.theme.colours.surface))
            self._paint(QPainter(self._picture))
        painter = QPainter(self)
        painter.drawPixmap(0, 0, self._picture)
        self._paint_cursor(painter)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        area, (lowest, highest) = self.plot_area(), self.range_deg
        at = event.position()
        if event.button() is not Qt.MouseButton.LeftButton or not area.contains(at):
            super().mousePressEvent(event)
            return
        share = (area.bottom() - at.y()) / area.height()
        self.picked.emit(100 * (at.x() - area.left()) / area.width(), lowest + (highest - lowest) * share)

    def plot_area(self) -> QRectF:
        """The room inside the axes, 4:3 where the page gives that much, in px of the widget."""
        px = self._look.theme.px
        left, top = px(AXIS_WIDTH), px(LABEL_HEIGHT)
        return QRectF(left, top, self.width() - left - px(RIGHT_MARGIN), self.height() - top - px(TICKS_HEIGHT))

    def at(self, percent: float, angle_deg: float) -> QPointF:
        """The place of a point of the chart in px of the widget."""
        area, (lowest, highest) = self.plot_area(), self.range_deg
        x = area.left() + area.width() * percent / 100
        return QPointF(x, area.bottom() - area.height() * (angle_deg - lowest) / (highest - lowest))

    def _paint(self, painter: QPainter) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.save()
        painter.setClipRect(self.plot_area())
        if (band := self._band_drawn) is not None:
            for sds, colour in ((2, self._look.theme.colours.band_2sd), (1, self._look.theme.colours.band_1sd)):
                self._fill(painter, band.mean_deg, sds * band.sd_deg, QColor(colour))
        painter.restore()
        self._paint_axes(painter)
        painter.save()
        painter.setClipRect(self.plot_area())
        theme, frame = self._look.theme, self.frame
        paint_gaps(painter, theme, frame, self.gaps, {side: cycle.mean.mean for side, cycle in self._means()})
        for side, cycle in self._means():
            if is_spread_enough(cycle.mean.n) and not self.has_strides:
                self._fill(painter, cycle.mean.mean, cycle.mean.sd, self._look.theme.band(side))
        for side, cycle in self.cycles.items():
            if self._has_strides_of(side):
                self._paint_strides(painter, side, cycle)
        for side, cycle in self._means():
            if cycle.mean.n:
                self._paint_mean(painter, side, cycle)
        if self.stride is not None:
            self._paint_stride(painter, *self.stride)
        painter.restore()
        self._paint_labels(painter)
        paint_gap_bars(painter, theme, frame, self.gaps)
        for deviation, place in zip(self.deviations, self.places(), strict=True):
            paint_deviation(painter, theme, frame, deviation, place)

    def _paint_cursor(self, painter: QPainter) -> None:
        """A line at each leg's place with what the curve has there; solid at the left leg's, dashed at the right's."""
        theme, area = self._look.theme, self.plot_area()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(theme.font(12, SEMIBOLD))
        metrics, rows = QFontMetrics(theme.font(12, SEMIBOLD)), theme.px(16)
        for number, (side, cycle) in enumerate(self._means()):
            percent = self.readings.get(side)
            if percent is None or not cycle.mean.n:
                continue
            angle = float(np.interp(percent, PERCENT, cycle.mean.mean))
            at = self.at(percent, angle)
            pen = theme.pen(theme.colours.ink, 1.5)
            pen.setStyle(Qt.PenStyle.SolidLine if side is Side.LEFT else Qt.PenStyle.DashLine)
            painter.setPen(pen)
            painter.drawLine(QPointF(at.x(), area.top()), QPointF(at.x(), area.bottom()))
            painter.setPen(theme.pen(theme.curve(side), 2))
            painter.setBrush(theme.curve(side) if side is Side.LEFT else QColor(theme.colours.surface))
            painter.drawEllipse(at, theme.px(5), theme.px(5))
            words = f"{LETTERS[side]} {degrees_in_words(angle)}"
            width = metrics.horizontalAdvance(words)
            left = at.x() + theme.px(6) if at.x() + theme.px(6) + width < area.right() else at.x() - theme.px(6) - width
            box = QRectF(left, area.bottom() - (number + 1) * rows - theme.px(2), width + 1, rows)
            painter.fillRect(box, QColor(theme.colours.surface))
            painter.setPen(theme.text(side))
            painter.drawText(box, Qt.AlignmentFlag.AlignVCenter, words)

    def _paint_axes(self, painter: QPainter) -> None:
        theme = self._look.theme
        area, (lowest, highest) = self.plot_area(), self.range_deg
        tick = theme.px(TICK)
        painter.setFont(theme.font(12))
        line, ink = _crisp(theme.pen(theme.colours.control, 1)), QColor(theme.colours.ink2)
        painter.setPen(line)
        painter.drawLine(self.at(0, 0), self.at(100, 0))
        painter.drawLine(area.bottomLeft(), area.topLeft())
        painter.drawLine(area.bottomLeft(), area.bottomRight())
        first = int(np.ceil(lowest / TICK_DEG)) * TICK_DEG
        for angle in range(first, int(highest) + 1, TICK_DEG):
            y = self.at(0, angle).y()
            painter.setPen(line)
            painter.drawLine(QPointF(area.left() - tick, y), QPointF(area.left(), y))
            painter.setPen(ink)
            room = QRectF(0, y - area.height(), area.left() - 2 * tick, 2 * area.height())
            words = f"{angle}".replace("-", "\N{MINUS SIGN}")
            painter.drawText(room, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, words)
        for percent in range(0, 101, TICK_PERCENT):
            x = self.at(percent, 0).x()
            painter.setPen(line)
            painter.drawLine(QPointF(x, area.bottom()), QPointF(x, area.bottom() + tick))
            painter.setPen(ink)
            room = QRectF(x - area.width(), area.bottom() + tick, 2 * area.width(), theme.px(TICKS_HEIGHT) - tick)
            words = f"{percent}" if percent < 100 else "100 %"
            painter.drawText(room, Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignVCenter, words)

    def _paint_strides(self, painter: QPainter, side: Side, cycle: SideCycle) -> None:
        """Fine lines; of many, hairlines in the pale colour, a cloud from which the mean stands out."""
        theme, is_few = self._look.theme, len(cycle.strides_deg) <= SMOOTH_UP_TO
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, is_few)
        colour = theme.curve(side) if is_few else theme.soft(side)
        if side in self.withheld:
            colour = QColor(theme.colours.control)  # evidence, not to be read
        colour.setAlphaF(STRIDE_ALPHA if is_few else 1.0)
        painter.setPen(QPen(colour, STRIDE_PX * theme.scale if is_few else 0))
        for stride_deg in cycle.strides_deg:
            painter.drawPolyline(self._polygon(PERCENT, stride_deg))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)

    def _paint_stride(self, painter: QPainter, side: Side, stride_deg: FloatArray) -> None:
        """The stride in force in ink, whether it is used or not; solid or dashed, as its side is."""
        theme, curve = self._look.theme, self._polygon(PERCENT, stride_deg)
        painter.setPen(theme.pen(theme.colours.surface, CASING_PX))
        painter.drawPolyline(curve)
        pen = theme.side_pen(side, MEAN_PX)
        pen.setColor(QColor(theme.colours.ink))
        painter.setPen(pen)
        painter.drawPolyline(curve)

    def _paint_mean(self, painter: QPainter, side: Side, cycle: SideCycle) -> None:
        """Left solid, right dashed, on a casing that lifts it off the band."""
        theme = self._look.theme
        curve = self._polygon(PERCENT, cycle.mean.mean)
        casing = theme.pen(theme.colours.surface, CASING_PX)
        casing.setCapStyle(Qt.PenCapStyle.FlatCap)
        painter.setPen(casing)
        painter.drawPolyline(curve)
        painter.setPen(theme.side_pen(side, MEAN_PX))
        painter.drawPolyline(curve)

    def _paint_labels(self, painter: QPainter) -> None:
        """Write above the plot what is simulated and where each side's toe-off is, with its line."""
        theme, area = self._look.theme, self.plot_area()
        painter.setFont(theme.font(12, SEMIBOLD))
        metrics = QFontMetrics(theme.font(12, SEMIBOLD))
        labels, lines, least = self.toe_off_labels(), self._toe_offs(), 0.0
        if self.is_simulated:
            least = metrics.horizontalAdvance(tr(SIMULATED)) + theme.px(8)
            painter.setPen(QColor(theme.colours.ink))
            room = QRectF(0, 0, self.width(), area.top())
            painter.drawText(room, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, tr(SIMULATED))
        for i, (side, percent) in enumerate(lines):
            x = self.at(percent, 0).x()
            painter.setPen(theme.side_pen(side, TOE_OFF_PX))
            painter.drawLine(QPointF(x, area.top()), QPointF(x, area.bottom()))
            painter.setPen(theme.text(side))
            width = metrics.horizontalAdvance(labels[side]) + 1
            left = x - width - theme.px(4) if i == 0 else x + theme.px(4)
            left = min(max(left, least), self.width() - width)
            room = QRectF(left, 0, width, area.top())
            painter.drawText(room, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, labels[side])

    def _toe_offs(self) -> list[tuple[Side, float]]:
        """Each side's toe-off, percent, the earlier first."""
        known = [
            (side, cycle.toe_off_percent)
            for side, cycle in self._means()
            if cycle.mean.n and np.isfinite(cycle.toe_off_percent)
        ]
        return sorted(known, key=lambda found: round(found[1]))  # left first where both read the same

    def _fill(self, painter: QPainter, mean: FloatArray, reach: FloatArray, colour: QColor) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colour)
        there_and_back = np.concatenate([PERCENT, PERCENT[::-1]])
        painter.drawPolygon(self._polygon(there_and_back, np.concatenate([mean - reach, (mean + reach)[::-1]])))
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _polygon(self, percent: FloatArray, angle_deg: FloatArray) -> QPolygonF:
        area, (lowest, highest) = self.plot_area(), self.range_deg
        x = area.left() + area.width() * percent / 100
        y = area.bottom() - area.height() * (angle_deg - lowest) / (highest - lowest)
        return pg.functions.arrayToQPolygonF(x, y)

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.redraw()


def _crisp(pen: QPen) -> QPen:
    pen.setCapStyle(Qt.PenCapStyle.FlatCap)
    return pen

"""Hip, knee and ankle over one stride: each side on its own stride, the mean on the band of a cited group.

The chart paints itself: nobody zooms a stride, and so every label finds its place.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QAccessible, QColor, QMouseEvent, QPainter, QPaintEvent, QPixmap
from PySide6.QtWidgets import QBoxLayout, QGridLayout, QHBoxLayout, QSizePolicy

from app.charts.axes import (
    degrees_in_words,
    nothing_in_words,
    part_in_words,
    range_for,
    range_in_words,
    sign_in_words,
    title_in_words,
)
from app.charts.cycles import Band, SideCycle
from app.charts.frame import Frame
from app.charts.marks import MOST_MARKS, Deviation, Gap, Point, laid_at_height_of
from app.charts.marks_on_screen import places_of
from app.charts.on_screen import frame_of, paint, paint_cursor
from app.charts.places import MarkPlace
from app.charts.stride_chart import (
    SCREEN_TICK_DEG,
    Axis,
    StrideChart,
    StrideCurve,
    curves_of_walk,
    usual_range_deg,
)
from app.summary.comparison import Comparison
from app.summary.walk_figures import (
    MAY_BE_MIRRORED,
    NO_HEIGHT,
    NO_ZERO,
    NOT_REPORTED,
    doubt_in,
    verdict_of,
    why_in_words,
)
from app.theme.icons import Icon
from app.theme.notifier import ThemeNotifier
from app.widgets.card import Card
from app.widgets.icons import IconMark
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.widgets.themed import Themed
from app.widgets.verdict_chip import VerdictChip
from app.widgets.withheld_panel import NotReportedPanel
from app.wording.translation import capitalised, joined, later, tr
from core.body import Joint, JointKind, Side
from core.samples import FloatArray
from core.verdicts.model import JointVerdicts, Verdict
from core.verdicts.norms import ReferenceCurves

LEAST_SIZE, TIGHT_SIZE = (284, 144), (160, 100)  # of two charts, or of three where there is little room
EARLIER = (0, 2)  # the thin one of two curves, as in every comparison
DOUBTS = {
    NO_ZERO: later(
        "{sides}: no standing reference. Range of motion and curve shape are valid; absolute angles are not."
    ),
    NO_HEIGHT: later("{sides}: absolute angle not reported. Range of motion and curve shape are valid."),
    MAY_BE_MIRRORED: later("{sides}: it is unclear which direction is flexion. The curve may be inverted."),
}


class CycleCharts(Themed):
    """All charts, with what they share: the band and the single strides, each on or off.

    The hip's is there where a hip was measured, or should have been.
    """

    picked = Signal(object, float, float)  # JointKind; percent of the stride, degrees

    def __init__(self, look: ThemeNotifier, reference: ReferenceCurves) -> None:
        super().__init__()
        self._look = look
        self.hip, self.knee, self.ankle = (CycleFrame(look, CycleChart(look, kind), kind) for kind in JointKind)
        self._frames = (self.hip, self.knee, self.ankle)
        self.hip.hide()
        self._box = QBoxLayout(QBoxLayout.Direction.TopToBottom, self)
        self._box.setContentsMargins(0, 0, 0, 0)
        for frame in self._frames:
            self._box.addWidget(frame, 1)
            frame.chart.picked.connect(self._on_picked)
        self.set_band(reference)
        self._on_look_changed()

    @property
    def frames(self) -> tuple["CycleFrame", ...]:
        """Those that are there."""
        return tuple(frame for frame in self._frames if not frame.isHidden())

    @property
    def heights_deg(self) -> dict[Joint, float]:
        """By how much the curves of joints without a height are drawn lower than they were measured."""
        found: dict[Joint, float] = {}
        for frame in self._frames:
            found |= {frame.kind.of(side): height for side, height in frame.heights_deg.items()}
        return found

    def show_cycles(
        self, cycles: Mapping[Joint, SideCycle], verdicts: Mapping[Joint, JointVerdicts], is_simulated: bool
    ) -> None:
        """Draw the joints of one walk, as far as the verdicts let them be seen; a joint without one can be read."""
        for frame in self._frames:
            frame.show_cycles(
                {joint.side: cycle for joint, cycle in cycles.items() if joint.kind is frame.kind},
                {joint.side: found for joint, found in verdicts.items() if joint.kind is frame.kind},
                is_simulated,
            )
        self.hip.setVisible(any(joint.is_hip for joint in cycles))

    def set_band(self, reference: ReferenceCurves | None) -> None:
        """Draw this group's band, or none where none may stand beside the walk."""
        for frame in self._frames:
            frame.chart.band = Band(*reference.mean_and_sd_deg(frame.kind)) if reference is not None else None
            frame.chart.redraw()

    def show_beside(self, found: Comparison | None, words: str = "") -> None:
        """Draw thin what the walk is compared with, or say why nothing; marks are to be shown again, the next walk is
        without."""
        for frame in self._frames:
            frame.show_beside(found, words)

    def show_stride(self, curves_deg: Mapping[Joint, FloatArray]) -> None:
        """Draw one stride (101,) over all others, bold; none: no stride is in force."""
        for frame in self._frames:
            found = [(joint.side, curve) for joint, curve in curves_deg.items() if joint.kind is frame.kind]
            frame.show_stride(found[0] if found else None)

    def show_marks(self, deviations: Sequence[Deviation], gaps: Sequence[Gap] = ()) -> None:
        """Mark what is notable on the curves, degrees as measured; the next walk shown is without."""
        for frame in self._frames:
            frame.show_marks(
                [found for found in deviations if found.kind is frame.kind],
                [gap for gap in gaps if gap.joint.kind is frame.kind],
            )

    def set_strides_shown(self, is_shown: bool) -> None:
        for frame in self._frames:
            frame.set_strides_shown(is_shown)

    def set_band_shown(self, is_shown: bool) -> None:
        for frame in self._frames:
            frame.chart.has_band = is_shown
            frame.chart.redraw()

    def show_cursor(self, percent: Mapping[Side, float]) -> None:
        """Mark a place on each leg's own stride; none: no cursor."""
        for frame in self._frames:
            frame.chart.readings = percent
            frame.chart.update()

    def set_brief(self, is_brief: bool) -> None:
        """Leave out what the axis and the icons say as well, where there is little room."""
        for frame in self._frames:
            frame.set_brief(is_brief)

    def set_tight(self, *, is_tight: bool, is_narrow: bool) -> None:
        """Let three charts be small where there is little room; `is_narrow`: three beside each other."""
        for frame in self._frames:
            frame.chart.set_tight(is_tight)
            frame.set_narrow(is_narrow)

    def set_side_by_side(self, is_side_by_side: bool) -> None:
        way = QBoxLayout.Direction.LeftToRight if is_side_by_side else QBoxLayout.Direction.TopToBottom
        self._box.setDirection(way)

    def _on_picked(self, percent: float, angle_deg: float) -> None:
        kind = next(frame.kind for frame in self._frames if frame.chart is self.sender())
        self.picked.emit(kind, percent, angle_deg)

    def _on_look_changed(self) -> None:
        self._box.setSpacing(self._look.theme.px(12))


class CycleFrame(Card):
    """A chart with its title, its sign in words, the key to its curves and what must be known to read them."""

    def __init__(self, look: ThemeNotifier, chart: "CycleChart", kind: JointKind) -> None:
        self.kind = kind
        self.chart = chart
        self.chips = {side: VerdictChip(look, side) for side in Side}
        self._mark = IconMark(look, Icon.DIFFERENCE, size=18)
        self._note = Text(look, size=12, weight=MEDIUM, wraps=True)
        self.beside = Text(look, size=12, tone="ink2", wraps=True)
        self._walk: tuple[Mapping[Side, SideCycle], Mapping[Side, JointVerdicts], bool] = ({}, {}, False)
        self.not_reported = {side: NotReportedPanel(look, side) for side in Side}
        self.heights_deg: dict[Side, float] = {}
        super().__init__(look, padding=12, spacing=2)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        head = QHBoxLayout()
        head.setSpacing(8)
        head.addWidget(Text(look, title_in_words(kind), size=16, weight=SEMIBOLD))
        self._sign = Text(look, sign_in_words(kind), size=12, tone="ink2")
        head.addWidget(self._sign)
        head.addStretch(1)
        self._chips = QHBoxLayout()
        self._chips.setSpacing(8)
        for side in Side:
            self._chips.addWidget(self.chips[side])
        self._head = QGridLayout()
        self._head.setHorizontalSpacing(8)
        self._head.setVerticalSpacing(2)
        self._head.addLayout(head, 0, 0)
        self._head.addLayout(self._chips, 0, 1)
        self._head.setColumnStretch(0, 1)
        notes = QHBoxLayout()
        notes.setSpacing(8)
        notes.addWidget(self._mark, 0, Qt.AlignmentFlag.AlignTop)
        notes.addWidget(self._note, 1)
        self.column.addLayout(self._head)
        self.column.addLayout(notes)
        self.column.addWidget(self.beside)
        for panel in self.not_reported.values():
            self.column.addWidget(panel)
        self.column.addWidget(chart, 3)

    @property
    def note(self) -> str:
        return self._note.text()

    def show_cycles(
        self, cycles: Mapping[Side, SideCycle], verdicts: Mapping[Side, JointVerdicts], is_simulated: bool
    ) -> None:
        """Draw what may be seen; without a height of every leg that is drawn, all are drawn about their own mean."""
        self._walk = cycles, verdicts, is_simulated
        self.show_beside(None)

    def show_beside(self, found: Comparison | None, words: str = "") -> None:
        """Draw the walk again, thin beside it what it is compared with, or say in `words` why nothing is."""
        cycles, verdicts, is_simulated = self._walk
        doubts = {side: why for side, judged in verdicts.items() if side in cycles and (why := doubt_in(judged))}
        reasons = {side: why_in_words(judged) for side, judged in verdicts.items() if side in cycles}
        joints = [joint for joint in (found.joints if found is not None else ()) if joint.kind is self.kind]
        has_other_zero = found is not None and not all(_has_common_height(found, joint) for joint in joints)
        is_about_mean = has_other_zero or any(why != NOT_REPORTED for why in doubts.values())
        self.heights_deg = {side: cycle.height_deg for side, cycle in cycles.items()} if is_about_mean else {}
        drawn = {side: cycle.about_mean() for side, cycle in cycles.items()} if is_about_mean else cycles
        not_reported = frozenset(side for side, why in doubts.items() if why == NOT_REPORTED)
        beside = {
            joint.side: found.against.curve(joint, is_about_mean=is_about_mean)
            for joint in joints
            if found is not None and all(joint in part.joints and part.is_drawn(joint) for part in found.parts)
        }
        self.chart.show_cycles(drawn, is_simulated, not_reported, is_about_mean, beside)
        self.beside.setText(words if found is None else self._beside_in_words(found, has_other_zero))
        self._show_beside_words()
        for side, chip in self.chips.items():
            chip.setVisible(side in cycles)
            chip.show_message(
                verdict_of(verdicts[side]) if side in verdicts else Verdict.READ, has_line=side not in not_reported
            )
            self.not_reported[side].show_message(reasons[side] if side in not_reported else "")
        self._note.setText(" ".join(self._notes(cycles, doubts)))
        for widget in (self._mark, self._note):
            widget.setVisible(bool(self._note.text()))
        self._show_chart()
        self.chart.setAccessibleName(tr("{joint} over one gait cycle").format(joint=title_in_words(self.kind)))
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

    def set_narrow(self, is_narrow: bool) -> None:
        """Put the chips under the title, where they have no room beside it."""
        self._head.removeItem(self._chips)
        place = (1, 0, 1, 2, Qt.AlignmentFlag.AlignLeft) if is_narrow else (0, 1, 1, 1, Qt.AlignmentFlag.AlignRight)
        self._head.addLayout(self._chips, *place)

    def set_strides_shown(self, is_shown: bool) -> None:
        self.chart.has_strides = is_shown
        self._show_beside_words()
        self._show_chart()
        self.chart.redraw()

    def _show_beside_words(self) -> None:
        self.beside.setVisible(bool(self.beside.text()) and not self.chart.has_strides)

    def _beside_in_words(self, found: Comparison, has_other_zero: bool) -> str:
        """Name the thin curves, and say of whom there is none."""
        against = found.against
        stated = [tr("Thin line: {walk}.").format(walk=against.name)] if self.chart.beside else []
        worn = {self.kind.of(side) for side in self.chart.cycles}
        for joint in sorted(worn, key=list(Joint).index):
            if joint not in against.joints:
                stated.append(tr("{side}: not measured in {walk}.").format(side=joint.side.letter, walk=against.name))
            elif not against.is_drawn(joint):
                stated.append(tr("{side}: not reported in {walk}.").format(side=joint.side.letter, walk=against.name))
        if has_other_zero and self.chart.beside:
            stated.append(
                tr("No common standing reference: compare range of motion and curve shape, not absolute angles.")
            )
        return " ".join(stated)

    def _show_chart(self) -> None:
        """Leave it away where nothing of it could be seen: the panels then take its place."""
        chart = self.chart
        chart.setVisible(not (chart.cycles and chart.is_empty))

    def in_words(self) -> str:
        """Say each side's mean curve, for who cannot see it."""
        stated = [tr("Simulated.")] if self.chart.is_simulated else []
        for side, cycle in self.chart.cycles.items():
            part = part_in_words(side, self.kind)
            if side in self.chart.not_reported:
                stated.append(f"{part}: {self.not_reported[side].text}")
                continue
            if not cycle.mean.n:
                stated.append(tr("{part} has no usable stride.").format(part=part))
                continue
            lowest, highest = np.min(cycle.mean.mean), np.max(cycle.mean.mean)
            reported = tr(
                "{part}, mean of {count} strides: from {lowest} at {lowest_percent} % to {highest} at "
                "{highest_percent} % of the gait cycle, toe-off at {toe_off_percent:.0f} %."
            )
            stated.append(
                reported.format(
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
                stated.append(f"{capitalised(chip.accessibleName())}.")
        stated += [deviation.in_words() for deviation in self.chart.deviations]
        stated += [gap.in_words() for gap in self.chart.gaps]
        stated += [text for text in (self.beside.text(), self.note) if text]
        return " ".join(stated) or nothing_in_words(self.kind)

    def _notes(self, cycles: Mapping[Side, SideCycle], doubts: Mapping[Side, str]) -> list[str]:
        notes = []
        for why, what in DOUBTS.items():
            sides = [side.letter for side in doubts if doubts[side] == why]
            notes += [tr(what).format(sides=joined(sides))] if sides else []
        if self.chart.is_about_mean:
            notes.append(tr("0° is the mean angle over the gait cycle."))
        if not cycles:
            notes.append(nothing_in_words(self.kind))
        empty = [s.letter for s, cycle in cycles.items() if not cycle.mean.n and s not in self.chart.not_reported]
        if empty:
            notes.append(tr("{sides}: no usable stride.").format(sides=joined(empty)))
        if self.chart.is_widened:
            notes.append(range_in_words(self.chart.range_deg))
        return notes


def _has_common_height(found: Comparison, joint: Joint) -> bool:
    """Whether the curves of a joint can be laid over one another as high as they were measured."""
    drawn = [part for part in found.parts if joint in part.joints and part.is_drawn(joint)]
    return len(drawn) < 2 or (
        found.has_one_zero(joint) and all(part.verdicts.joint(joint).height.is_reported for part in drawn)
    )


class CycleChart(Themed):
    """One joint over 0 to 100 % of the stride; its axis stays unless a mean curve leaves it."""

    accessible_role = QAccessible.Role.Chart

    picked = Signal(float, float)  # percent of the stride, degrees

    def __init__(self, look: ThemeNotifier, kind: JointKind) -> None:
        super().__init__()
        self._look, self._kind = look, kind
        self.range_deg = usual_range_deg(kind, is_about_mean=False)
        self.cycles: Mapping[Side, SideCycle] = {}
        self.band: Band | None = None
        self.is_simulated = False
        self.has_band, self.has_strides = True, False
        self.is_about_mean = False
        self.not_reported: frozenset[Side] = frozenset()  # of whom no mean is drawn
        self.beside: tuple[StrideCurve, ...] = ()  # of another walk, of legs whose mean is drawn
        self.stride: tuple[Side, FloatArray] | None = None
        self.readings: Mapping[Side, float] = {}  # percent of each leg's own stride
        self.deviations: tuple[Deviation, ...] = ()
        self.gaps: tuple[Gap, ...] = ()
        self._picture: QPixmap | None = None
        self._least = LEAST_SIZE
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    @property
    def is_widened(self) -> bool:
        return self.range_deg != self._usual_deg

    @property
    def _usual_deg(self) -> tuple[float, float]:
        return usual_range_deg(self._kind, is_about_mean=self.is_about_mean)

    def sizeHint(self) -> QSize:
        px = self._look.theme.px
        return QSize(px(self._least[0]), px(self._least[1]))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def set_tight(self, is_tight: bool) -> None:
        self._least = TIGHT_SIZE if is_tight else LEAST_SIZE
        self.updateGeometry()

    def show_cycles(
        self,
        cycles: Mapping[Side, SideCycle],
        is_simulated: bool,
        not_reported: frozenset[Side] = frozenset(),
        is_about_mean: bool = False,
        beside: Mapping[Side, StrideCurve] | None = None,
    ) -> None:
        """Draw each side's strides, `beside` them another walk's means, and widen the axis where a mean leaves it."""
        self.cycles, self.is_simulated = cycles, is_simulated
        self.not_reported, self.is_about_mean = not_reported, is_about_mean
        self.deviations, self.gaps = (), ()
        drawn = self.sides_with_mean
        self.beside = tuple(
            replace(curve, order=EARLIER) for side, curve in (beside or {}).items() if side in drawn and curve.is_known
        )
        means = [cycle.mean.mean for side, cycle in cycles.items() if side not in not_reported]
        means += [curve.angle_deg for curve in self.beside]
        self.range_deg = range_for(self._usual_deg, means)
        self.redraw()

    @property
    def described(self) -> StrideChart:
        """What is drawn; no band where curves are drawn about their own mean."""
        return StrideChart(
            axis=Axis(*self.range_deg, SCREEN_TICK_DEG, SCREEN_TICK_DEG),
            curves=self._curves(),
            band=self._drawn_band(),
            is_simulated=self.is_simulated,
            beside=() if self.has_strides else self.beside,
            chosen=self.stride,
            deviations=self.deviations,
            gaps=self.gaps,
        )

    def _drawn_band(self) -> Band | None:
        """At the hip laid at the height of the curves, for its group's zero is another one."""
        if self.band is None or not self.has_band or self.is_about_mean:
            return None
        if self._kind is not JointKind.HIP:
            return self.band
        means = [curve.angle_deg for curve in self._curves() if curve.is_known]
        return laid_at_height_of(np.mean(means, axis=0), self.band) if means else None

    def _curves(self) -> tuple[StrideCurve, ...]:
        return curves_of_walk(self.cycles, self.not_reported, has_strides=self.has_strides)

    @property
    def is_empty(self) -> bool:
        """Whether all sides are not reported and none has its strides shown."""
        return all(curve.is_not_reported and not len(curve.strides_deg) for curve in self._curves())

    @property
    def sides_with_mean(self) -> frozenset[Side]:
        return frozenset(curve.side for curve in self._curves() if curve.is_known)

    @property
    def frame(self) -> Frame:
        """The room inside the axes, in px of the widget."""
        return frame_of(self._look.theme, self.width(), self.height(), self.described)

    def at(self, percent: float, angle_deg: float) -> QPointF:
        """The place of a point of the chart in px of the widget."""
        return QPointF(float(self.frame.x(percent)), float(self.frame.y(angle_deg)))

    def places(self) -> list[MarkPlace]:
        """Where each difference that is marked finds room, px of the widget."""
        return places_of(self._look.theme, self.frame, self.described)

    def redraw(self) -> None:
        """Paint again, since what is shown has changed."""
        self._picture = None
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        ratio = self.devicePixelRatioF()
        if self._picture is None or self._picture.size() != self.size() * ratio:
            self._picture = QPixmap(self.size() * ratio)
            self._picture.setDevicePixelRatio(ratio)
            self._picture.fill(QColor(self._look.theme.colours.surface))
            paint(QPainter(self._picture), self._look.theme, self.frame, self.width(), self.described)
        painter = QPainter(self)
        painter.drawPixmap(0, 0, self._picture)
        paint_cursor(painter, self._look.theme, self.frame, self.described.curves, self.readings)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        frame, at = self.frame, event.position()
        is_inside = QRectF(frame.left, frame.top, frame.width, frame.height).contains(at)
        if event.button() is not Qt.MouseButton.LeftButton or not is_inside:
            super().mousePressEvent(event)
            return
        self.picked.emit(frame.percent_at(at.x()), frame.angle_at(at.y()))

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.redraw()

"""A chart of the stride in its frame: its title, the key to its curves, and what must be known to read it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy

from app.charts.axes import (
    degrees_in_words,
    nothing_in_words,
    part_in_words,
    range_in_words,
    title_in_words,
)
from app.charts.cycles import SideCycle
from app.charts.marks import MOST_MARKS, CurveLabel, Deviation, Gap, Point
from app.plots.chart_key import ChartKey, ChartKeyWords
from app.plots.cycle_chart import CycleChart
from app.summary.comparison import Comparison
from app.summary.walk_figures import (
    MAY_BE_MIRRORED,
    NO_HEIGHT,
    NO_ZERO,
    NOT_REPORTED,
    doubt_in,
    verdict_of,
    why_in_figures,
    why_in_words,
)
from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.card import Card
from app.widgets.chip import leg_name
from app.widgets.icons import IconMark
from app.widgets.info_button import InfoButton
from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.translation import capitalised, joined, later, tr
from app.wording.verdicts import verdict_alone, verdict_word
from core.body import Joint, JointKind, Side
from core.samples import FloatArray
from core.verdicts.model import JointVerdicts, Verdict

DOUBTS = {
    NO_ZERO: later(
        "{sides}: no standing reference. Range of motion and curve shape are valid; absolute angles are not."
    ),
    NO_HEIGHT: later("{sides}: absolute angle not reported. Range of motion and curve shape are valid."),
    MAY_BE_MIRRORED: later("{sides}: it is unclear which direction is flexion. The curve may be inverted."),
}


class CycleFrame(Card):
    """A chart with its title, the key to its curves, whose the reference is, and what must be known to read it."""

    def __init__(self, chart: CycleChart, kind: JointKind) -> None:
        super().__init__(spacing=2)
        self.kind = kind
        self.chart = chart
        self.key = ChartKey()
        self.info = InfoButton(tr("Reference"))
        self._mark = IconMark(Icon.DIFFERENCE, size=18)
        self._note = Text(size=12, weight=MEDIUM, wraps=True)
        self.beside = Text(size=12, tone="ink2", wraps=True)
        self._walk: tuple[Mapping[Side, SideCycle], Mapping[Side, JointVerdicts], bool] = ({}, {}, False)
        self._reference: Sequence[str] = ()
        self._thin = ""
        self.not_reported: dict[Side, str] = {}  # why, as a sentence
        self.heights_deg: dict[Side, float] = {}
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        title = Text(title_in_words(kind), size=16, weight=SEMIBOLD)
        head = lay_out(QHBoxLayout(), title, (self.key, 1), self.info, margins=(4, 0, 8, 0), spacing=8)
        mark = self._mark, 0, Qt.AlignmentFlag.AlignTop
        notes = lay_out(QHBoxLayout(), mark, (self._note, 1), margins=(4, 0, 8, 0), spacing=8)
        lay_out(self.column, head, notes, self.beside, (chart, 3))
        # the chart reaches the right edge, where there is room for what is turned
        scaled(self.column.setContentsMargins, 12, 6, 4, 2)

    @property
    def note(self) -> str:
        return self._note.text()

    def show_cycles(
        self, cycles: Mapping[Side, SideCycle], verdicts: Mapping[Side, JointVerdicts], is_simulated: bool
    ) -> None:
        """Draw what may be seen; without a height of every leg that is drawn, all are drawn about their own mean."""
        self._walk = cycles, verdicts, is_simulated
        self.show_beside(None)

    def show_beside(self, found: Comparison | None, words: str = "", thin_sides: frozenset[Side] = frozenset()) -> None:
        """Redraw the walk with its comparison thin, or `words` why there is none; `thin_sides`: if not both."""
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
        beside = {side: curve for side, curve in beside.items() if not thin_sides or side in thin_sides}
        self.not_reported = {side: reasons[side] for side in cycles if side in not_reported}
        hidden = {side: why_in_figures(verdicts[side]) for side in self.not_reported}
        self.chart.show_cycles(drawn, is_simulated, hidden, is_about_mean, beside)
        self.beside.setText(words if found is None else self._beside_in_words(found, has_other_zero))
        self._thin = found.against.short_name if found is not None and self.chart.beside else ""
        self._show_beside_words()
        self._note.setText(" ".join(self._notes(cycles, doubts)))
        for widget in (self._mark, self._note):
            widget.setVisible(bool(self._note.text()))
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

    def show_labels(self, labels: Sequence[CurveLabel]) -> None:
        """Write values at points of curves that are drawn; about their mean, curves have no values."""
        drawn = self.chart.sides_with_mean if not self.chart.is_about_mean else frozenset()
        self.chart.labels = tuple(label for label in labels if label.side in drawn)
        self.chart.redraw()

    def show_reference(self, names: Sequence[str], source: str) -> None:
        self._reference = names
        self.info.show_words(source)
        self._show_key()
        self.chart.redraw()

    def set_band_shown(self, is_shown: bool) -> None:
        self.chart.has_band = is_shown
        self._show_key()
        self.chart.redraw()

    def set_strides_shown(self, is_shown: bool) -> None:
        self.chart.has_strides = is_shown
        self._show_beside_words()
        self.chart.redraw()

    def _show_beside_words(self) -> None:
        self.beside.setVisible(bool(self.beside.text()) and not self.chart.has_strides)
        self._show_key()

    def _show_key(self) -> None:
        """Name the curves that are drawn."""
        chart, (_, verdicts, _) = self.chart, self._walk
        legs = {
            side: verdict_of(verdicts[side]) if side in verdicts else Verdict.READ
            for side in Side
            if side in chart.cycles and side not in self.not_reported
        }
        thin = self._thin if not chart.has_strides else ""
        has_reference = bool(chart.cycles) and chart.has_band
        has_band = has_reference and chart.described.band is not None
        reference = self._reference if has_band or chart.band is None else ()
        sides = tuple(curve.side for curve in chart.beside)
        self.key.show_words(ChartKeyWords(legs, thin, sides, reference if has_reference else (), has_band))

    def _beside_in_words(self, found: Comparison, has_other_zero: bool) -> str:
        """Say of whom there is no thin curve, and what it is not compared by."""
        against = found.against
        stated: list[str] = []
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

    def in_words(self) -> str:
        """Say each side's mean curve, for who cannot see it."""
        stated = [tr("Simulated.")] if self.chart.is_simulated else []
        for side, cycle in self.chart.cycles.items():
            part = part_in_words(side, self.kind)
            if side in self.chart.not_reported:
                stated.append(f"{part}: {verdict_alone(Verdict.NOT_REPORTED)}. {self.not_reported[side]}".strip())
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
        stated += [
            f"{capitalised(leg_name(side))}: {verdict_word(verdict)}."
            for side, verdict in self.key.words.legs.items()
            if verdict is Verdict.CARE
        ]
        thin = [tr("Thin line: {walk}.").format(walk=self.key.words.thin)] if self.key.words.thin else []
        stated += [deviation.in_words() for deviation in self.chart.deviations]
        stated += [gap.in_words() for gap in self.chart.gaps]
        stated += [text for text in (*thin, self.beside.text(), self.note) if text]
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

"""One joint of one leg in several walks: their mean cycles laid over one another, distinguished by letter and width."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy

from app.charts.axes import degrees_in_words, part_in_words, range_for, range_in_words, sign_in_words, title_in_words
from app.charts.stride_chart import StrideCurve
from app.plots.cycle_chart import CycleChart
from app.theme.current import scaled
from app.theme.icons import VERDICT_ICONS, Icon
from app.widgets.card import Card
from app.widgets.chip import Chip
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.translation import tr
from app.wording.verdicts import verdict_alone
from core.body import JointKind, Side
from core.verdicts.model import Verdict


class ComparedChart(CycleChart):
    """The later, the thicker; the last letter is filled."""

    curves: tuple[StrideCurve, ...] = ()

    def show_curves(self, curves: Sequence[StrideCurve], is_simulated: bool, is_about_mean: bool = False) -> None:
        """Draw every curve that is known, and widen the axis where one leaves it."""
        known = [curve for curve in curves if curve.is_known]
        self.curves = tuple(replace(curve, order=(k, len(known))) for k, curve in enumerate(known))
        self.is_simulated, self.is_about_mean = is_simulated, is_about_mean
        self.range_deg = range_for(self._usual_deg, [curve.angle_deg for curve in known])
        self.redraw()

    def _curves(self) -> tuple[StrideCurve, ...]:
        return self.curves


class ComparedFrame(Card):
    """A chart under its leg, joint and sign, with what must be known to read it."""

    def __init__(self, chart: ComparedChart, side: Side, kind: JointKind) -> None:
        super().__init__(padding=12, spacing=2)
        self._side, self._kind = side, kind
        self.chart = chart
        self._mark = IconMark(Icon.INFO, size=18)
        self._note = Text(size=12, weight=MEDIUM, wraps=True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._verdict_mark = IconMark(VERDICT_ICONS[Verdict.READ], size=16)
        self.verdict = Text(size=12, weight=MEDIUM)
        for part in (self._verdict_mark, self.verdict):
            part.hide()
        title = Text(title_in_words(kind), size=16, weight=SEMIBOLD)
        sign = Text(sign_in_words(kind), size=12, tone="ink2")
        head = lay_out(QHBoxLayout(), Chip(side), title, self._verdict_mark, self.verdict, 1, sign)
        notes = lay_out(QHBoxLayout(), (self._mark, 0, Qt.AlignmentFlag.AlignTop), (self._note, 1))
        for row in (head, notes):
            scaled(row.setSpacing, 8)
        lay_out(self.column, head, notes, (chart, 1))

    @property
    def note(self) -> str:
        return self._note.text()

    def show_verdict(self, verdict: Verdict, why: str = "") -> None:
        """Say beside the joint what may be read of all its curves, and under the mouse why."""
        self._verdict_mark.set_icon(VERDICT_ICONS[verdict])
        self.verdict.setText(verdict_alone(verdict))
        for part in (self._verdict_mark, self.verdict):
            part.setVisible(verdict is not Verdict.NOT_MEASURED)
            part.setToolTip(why)

    def show_curves(
        self, curves: Sequence[StrideCurve], note: str, is_simulated: bool, *, is_about_mean: bool = False
    ) -> None:
        self.chart.show_curves(curves, is_simulated, is_about_mean)
        stated = [note] if note else []
        if not self.chart.curves:
            stated = stated or [tr("Not measured.")]
        elif self.chart.is_widened:
            stated.append(range_in_words(self.chart.range_deg))
        self._note.setText(" ".join(stated))
        for widget in (self._mark, self._note):
            widget.setVisible(bool(stated))
        self.chart.setAccessibleName(tr("{joint}, compared").format(joint=part_in_words(self._side, self._kind)))
        self.chart.setAccessibleDescription(self.in_words())

    def in_words(self) -> str:
        """Say each curve's highest and lowest angle, for who cannot see them."""
        stated = [tr("Simulated.")] if self.chart.is_simulated else []
        for curve in self.chart.curves:
            mean = curve.angle_deg
            reported = tr(
                "{letter}: from {lowest} at {lowest_percent} % to {highest} at {highest_percent} % of the gait cycle."
            )
            stated.append(
                reported.format(
                    letter=curve.letter,
                    lowest=degrees_in_words(np.min(mean)),
                    lowest_percent=np.argmin(mean),
                    highest=degrees_in_words(np.max(mean)),
                    highest_percent=np.argmax(mean),
                )
            )
        return " ".join([*stated, self.note]).strip()

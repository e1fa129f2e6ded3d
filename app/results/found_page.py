"""Page on how this was found.

The paper's Figures 3, 4 and 6 on this patient's recordings, each with what it states in words.
"""

import math
from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QBoxLayout,
    QGridLayout,
    QHBoxLayout,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from app.charts.on_screen import SIMULATED
from app.plots.cost_map import CostMap
from app.plots.projected_rates_plot import ProjectedRatesPlot
from app.plots.two_ways_chart import TwoWaysChart
from app.summary.diagnostics import MARGIN_BEYOND, FoundFigure, figures_of
from app.theme.current import on_theme, px, scaled
from app.theme.icons import SEVERITY_ICONS, Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.chip import Chip
from app.widgets.findings_list import ORDER, FindingRow
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.lay_out import lay_out
from app.widgets.line_keys import LineKeys
from app.widgets.reading_area import ReadingArea
from app.widgets.segmented import Segmented
from app.widgets.sentence_page import SentencePage
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.body import name_of, segment_name
from app.wording.findings import sentence
from app.wording.translation import capitalised, figure_text, joined, tr
from core.body import Joint, Side
from core.findings import Finding
from core.results import Method
from core.verdicts.diagnostics import JointDiagnostics

ACROSS, DOWN = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom
SIDE_BY_SIDE_FROM = 940  # what the first two pictures need beside each other
MAPS_FROM = 500  # what both maps need beside each other
WHOLE, TEN_SECONDS = "whole", "ten-seconds"
CLOSE_S = 10.0
MIN_APART = 0.2  # of how alike the curves are; less apart, this second distinguishes no pairing


class FoundPage(QWidget):
    """One joint at a time; it is computed elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self._width = 0.0
        self.back = Button(tr("Back to the results"), ButtonKind.SECONDARY, Icon.BACK)
        names = [(str(joint), capitalised(name_of(joint)), "") for joint in _IN_ORDER]
        self.joints = Segmented(tr("Joint"), names)
        self.save = Button(tr("Save values as CSV"), ButtonKind.SECONDARY, Icon.FOLDER)
        self.note = Text(tone="ink2", wraps=True)
        self.waiting = SentencePage()
        self.axis = _AxisCard()
        self.pairing = _PairingCard()
        self.angle = _AngleCard()
        self.figures = _FiguresCard()
        self.noticed = Card()
        self._stack = QStackedWidget()
        self._build()

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.back, *self.joints.segments, self.save, self.cards, *self.angle.stretch.segments]

    def show_joints(self, joints: Sequence[Joint], chosen: Joint) -> None:
        """Offer the joints that were measured."""
        self.joints.setVisible(bool(joints))
        self.joints.blockSignals(True)
        for joint in sorted(_IN_ORDER, key=lambda one: one is not chosen):  # what is chosen must be there first
            self.joints.set_offered(str(joint), joint in joints or joint is chosen)
            if joint is chosen:
                self.joints.choose(str(joint))
        self.joints.blockSignals(False)

    def show_working(self, joint: Joint) -> None:
        """Say that the recordings are being looked through; nothing of another joint stays in sight."""
        self.save.setEnabled(False)
        self.note.setText("")
        self.waiting.show_sentence(tr("Analysing the recordings of the {joint}.").format(joint=name_of(joint)))
        self._stack.setCurrentWidget(self.waiting)

    def show_nothing(self, joint: Joint) -> None:
        self.save.setEnabled(False)
        self.waiting.show_sentence(
            tr("This recording has no data for the {joint}.").format(joint=name_of(joint)),
            tr("Choose another joint, or another recording in the results."),
        )
        self._stack.setCurrentWidget(self.waiting)

    def show_found(self, found: JointDiagnostics, findings: Sequence[Finding], is_simulated: bool) -> None:
        """Show one joint, and what was noticed about it."""
        figures = figures_of(found)
        self.save.setEnabled(True)
        self.note.setText(
            tr("{joint}, calibrated from {recordings}. The angle is from {walk}.").format(
                joint=capitalised(name_of(found.joint)), recordings=joined(found.from_recordings), walk=found.walk
            )
        )
        for card in (self.axis, self.pairing, self.angle):
            card.head.show_joint(found.joint.side, is_simulated)
            card.show_found(found, figures)
        self.figures.show_figures(list(figures.values()))
        self._show_findings(findings)
        self.cards.verticalScrollBar().setValue(0)
        self._stack.setCurrentWidget(self.cards)

    def show_saved(self, folder: str) -> None:
        self.note.setText(tr("Saved in {folder}.").format(folder=folder))

    def set_room(self, width: float, _height: float) -> None:
        self._width = width
        self._place_head()
        is_wide = width >= SIDE_BY_SIDE_FROM
        self._pictures.setDirection(ACROSS if is_wide else DOWN)
        self.axis.set_side_by_side(width / (2 if is_wide else 1) >= MAPS_FROM)
        self.figures.set_columns(2 if is_wide else 1)

    def focus(self) -> None:
        self.back.setFocus()

    def _build(self) -> None:
        self._head = QGridLayout()
        self._head.setColumnStretch(1, 1)
        scaled(self._head.setSpacing, 12)
        self._pictures = lay_out(QBoxLayout(ACROSS), (self.axis, 1), (self.pairing, 1), spacing=12)
        column = QWidget()
        cards = (self._pictures, self.angle, self.figures, self.noticed, 1)
        lay_out(QVBoxLayout(column), *cards, margins=(0, 0, 4, 0), spacing=12)
        self.cards = ReadingArea(column, tr("Calibration of this joint"))
        self.cards.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        for page in (self.waiting, self.cards):
            self._stack.addWidget(page)
        lay_out(QVBoxLayout(self), self._head, self.note, (self._stack, 1), margins=(16, 16, 16, 12), spacing=12)
        on_theme(self._place_head)

    def _place_head(self) -> None:
        """Put the joints between both buttons, or under them where that is too wide."""
        for widget in (self.back, self.joints, self.save):
            self._head.removeWidget(widget)
        needed = sum(widget.sizeHint().width() for widget in (self.back, self.joints, self.save))
        self._head.addWidget(self.back, 0, 0)
        self._head.addWidget(self.save, 0, 2)
        left = Qt.AlignmentFlag.AlignLeft
        if needed + px(2 * 12 + 2 * 16) <= px(self._width):
            self._head.addWidget(self.joints, 0, 1, left)
        else:
            self._head.addWidget(self.joints, 1, 0, 1, 3, left)
        hear_as_laid_out(self)

    def _show_findings(self, findings: Sequence[Finding]) -> None:
        _empty(self.noticed)
        column = self.noticed.column
        column.addWidget(Text(tr("Findings for this joint"), size=16, weight=SEMIBOLD))
        for finding in sorted(findings, key=lambda one: ORDER.index(one.severity)):
            icon = SEVERITY_ICONS[finding.severity]
            column.addWidget(FindingRow(icon, finding.severity, sentence(finding)))
        self.noticed.setVisible(bool(findings))


_IN_ORDER = (Joint.LEFT_KNEE, Joint.RIGHT_KNEE, Joint.LEFT_ANKLE, Joint.RIGHT_ANKLE)


class _Head(QHBoxLayout):
    """A picture's title, the figure of the paper that it is, the leg, and whether it is simulated."""

    def __init__(self, title: str, figure: str) -> None:
        super().__init__()
        self._chip = Chip(Side.LEFT)  # until a joint is shown
        self._simulated = Text(tr(SIMULATED), size=12, weight=SEMIBOLD)
        scaled(self.setSpacing, 8)
        words = Text(title, size=16, weight=SEMIBOLD, wraps=True)
        lay_out(self, self._chip, (words, 1), Text(figure, size=12, tone="ink2"), self._simulated)

    def show_joint(self, side: Side, is_simulated: bool) -> None:
        self._chip.set_side(side)
        self._simulated.setVisible(is_simulated)


class _AxisCard(Card):
    """Figure 3: the cost over the sphere, for both sensors."""

    def __init__(self) -> None:
        super().__init__()
        self.head = _Head(tr("Direction of the joint axis"), tr("Figure 3"))
        self.maps = (CostMap(), CostMap())
        self._names = [Text(size=14, weight=MEDIUM) for _ in self.maps]
        self._verdict = Text(weight=MEDIUM, wraps=True)
        words = tr(
            "Each map shows all directions that the axis could have in one sensor. Full colour: a hinge "
            "with that axis would move as this joint did (equation 6). An axis has two ends, so there are "
            "two such spots."
        )
        marks = tr(
            "Cross: axis in use. Circle: its uncertainty, 2 SD. Ring: best fit in this map. Scale: misfit "
            "of equation 3, root mean square."
        )
        maps = [lay_out(QVBoxLayout(), *one) for one in zip(self._names, self.maps, strict=True)]
        self._row = lay_out(QBoxLayout(ACROSS), *((one, 1) for one in maps))
        why, key = Text(words, tone="ink2", wraps=True), Text(marks, size=12, tone="ink2", wraps=True)
        lay_out(self.column, self.head, why, self._row, key, self._verdict, 1)

    def set_side_by_side(self, is_side_by_side: bool) -> None:
        self._row.setDirection(ACROSS if is_side_by_side else DOWN)

    def show_found(self, found: JointDiagnostics, figures: dict[str, FoundFigure]) -> None:
        calibration = found.calibration
        segments = [segment_name(site.segment) for site in (found.joint.proximal, found.joint.distal)]
        for name, chart, cost, segment in zip(self._names, self.maps, found.costs, segments, strict=True):
            sensor = tr("{segment} sensor").format(segment=segment)
            name.setText(sensor)
            chart.show_cost(cost, found.joint.side, calibration.axis_sd_rad, sensor)
        near, far = (figures[f"lowest_{sensor}_apart_deg"].in_words for sensor in ("proximal", "distal"))
        stated = tr(
            "The axis in use lies {near} (proximal sensor) and {far} (distal sensor) from the best fit. "
            "Calibration uncertainty: {axis_sd} (1 SD)."
        )
        stated = stated.format(near=near, far=far, axis_sd=figures["axis_sd_deg"].in_words)
        self._verdict.setText(f"{stated} {_why_apart(found)}".strip())


def _why_apart(found: JointDiagnostics) -> str:
    if found.calibration.method is Method.PUBLISHED:
        return ""
    if found.calibration.is_hinge:
        return tr("This joint moves like a true hinge, so this map determines the axis.")
    return tr("An anatomical joint is not a hinge. The whole relative motion determines the axis, not this map alone.")


class _PairingCard(Card):
    """Figure 4: the projected rates, as paired and with one axis reversed."""

    def __init__(self) -> None:
        super().__init__()
        self.head = _Head(tr("Same direction of both axes"), tr("Figure 4"))
        self.plot = ProjectedRatesPlot()
        self._keys = LineKeys()
        self._verdict = Text(weight=MEDIUM, wraps=True)
        words = tr(
            "In this second, the joint hardly bends, so both segments rotate alike across the axis. One "
            "curve is rotated to fit the other. If both axes point the same way, the curves overlap. If "
            "not, they are mirror images."
        )
        why = Text(words, tone="ink2", wraps=True)
        lay_out(self.column, self.head, why, self._keys, self.plot, self._verdict, 1)

    def show_found(self, found: JointDiagnostics, figures: dict[str, FoundFigure]) -> None:
        near, far = (segment_name(site.segment) for site in (found.joint.proximal, found.joint.distal))
        self._keys.show_keys([(self.plot.near_pen, near), (self.plot.far_pen, far)])
        self.plot.show_rates(found.projected, found.joint.side)
        self.plot.setVisible(found.projected is not None)
        self._keys.setVisible(found.projected is not None)
        self._verdict.setText(" ".join(filter(None, [_paired(found, figures), _decided(found, figures)])))


def _paired(found: JointDiagnostics, figures: dict[str, FoundFigure]) -> str:
    if found.projected is None:
        return tr("No second of this motion has enough rotation across the axis to draw the curves.")
    apart = found.projected.congruence - found.projected.reversed_congruence
    paired, reverse = (figures[f"{name}congruence_percent"].in_words for name in ("", "reversed_"))
    if abs(apart) < MIN_APART:
        return tr(
            "Both directions fit: agreement {paired} as paired, {reverse} reversed. This second does not "
            "decide the pairing."
        ).format(paired=paired, reverse=reverse)
    stated = tr("Agreement {paired} as paired, {reverse} reversed: the pairing is confirmed.")
    if apart < 0:
        stated = tr("Agreement {paired} as paired, {reverse} reversed: this second contradicts the pairing.")
    return stated.format(paired=paired, reverse=reverse)


def _decided(found: JointDiagnostics, figures: dict[str, FoundFigure]) -> str:
    margin = found.calibration.sign_margin
    if found.calibration.method is Method.PUBLISHED or margin is None:
        return ""
    if margin > MARGIN_BEYOND:
        return tr(
            "The accelerations decided the pairing: the next best solution fits more than {most} times worse."
        ).format(most=f"{MARGIN_BEYOND:.0f}")
    return tr("The accelerations decided the pairing: the next best solution fits {times} times worse.").format(
        times=figures["pairing_margin"].in_words
    )


class _AngleCard(Card):
    """Figure 6: the gyroscopes' angle, the accelerometers', and both together."""

    def __init__(self) -> None:
        super().__init__()
        self.head = _Head(tr("Joint angle by two methods"), tr("Figure 6"))
        self.stretch = Segmented(
            tr("Time segment"), [(WHOLE, tr("Whole recording"), ""), (TEN_SECONDS, tr("Ten seconds"), "")]
        )
        self.chart = TwoWaysChart()
        self._keys = LineKeys()
        self._cut = Text(size=12, tone="ink2", wraps=True)
        self._verdict = Text(weight=MEDIUM, wraps=True)
        words = tr(
            "The angle from gyroscopes alone (equation 11) is smooth but drifts. From accelerometers "
            "alone (equation 14), it does not drift but scatters. Combined (equation 15), it does "
            "neither. The combined angle is the published one, shown with the result under Whole walk."
        )
        why, stretch = Text(words, tone="ink2", wraps=True), (self.stretch, 0, Qt.AlignmentFlag.AlignLeft)
        lay_out(self.column, self.head, why, stretch, self._keys, (self.chart, 1), self._cut, self._verdict)
        self.stretch.chosen.connect(self._on_stretch_chosen)

    def show_found(self, found: JointDiagnostics, figures: dict[str, FoundFigure]) -> None:
        ways = found.ways
        angles = (ways.from_rates_rad, ways.from_accelerations_rad, ways.fused_rad)
        self.chart.show_angles(found.joint, ways.time_s, *(np.rad2deg(found.clinical(angle)) for angle in angles))
        self._keys.show_keys(
            [
                (self.chart.forces_pen, tr("Accelerometers")),
                (self.chart.rates_pen, tr("Gyroscopes")),
                (self.chart.fused_pen, tr("Combined")),
            ]
        )
        self._verdict.setText(_drifted(found, figures))
        self.chart.setAccessibleName(tr("Joint angle by two methods, {joint}").format(joint=name_of(found.joint)))
        self.chart.setAccessibleDescription(self._verdict.text())
        self._on_stretch_chosen()

    def _on_stretch_chosen(self) -> None:
        first, last = self.chart.whole_s
        middle = (first + last) / 2
        is_whole = self.stretch.choice == WHOLE or last - first <= CLOSE_S
        self.chart.see(*((first, last) if is_whole else (middle - CLOSE_S / 2, middle + CLOSE_S / 2)))
        percent = 100 * self.chart.cut_share
        cut = tr("{percent} % of the accelerometer angle lies outside this chart and is cut off.")
        self._cut.setText(cut.format(percent=figure_text(percent, ".1f")) if percent >= 0.05 else "")
        self._cut.setVisible(bool(self._cut.text()))


def _drifted(found: JointDiagnostics, figures: dict[str, FoundFigure]) -> str:
    scatter = tr("Accelerometer scatter: {scatter}.").format(scatter=figures["scatter_deg"].in_words)
    if not math.isfinite(found.ways.drift_rad_s):
        return scatter
    drift = tr("Gyroscope drift: {drift}, offset removed.")
    if found.bias_drift_rad_s is None:
        drift = tr("Gyroscope drift: {drift}, offset not known.")
    return f"{drift.format(drift=figures['drift_deg_s'].in_words)} {scatter}"


class _FiguresCard(Card):
    """All figures of the joint as a list of names and values."""

    def __init__(self) -> None:
        super().__init__()
        self._grid = QGridLayout()
        scaled(self._grid.setHorizontalSpacing, 12)
        scaled(self._grid.setVerticalSpacing, 4)
        self._figures: Sequence[FoundFigure] = ()
        self._columns = 2
        lay_out(self.column, Text(tr("In numbers"), size=16, weight=SEMIBOLD), self._grid)
        self._texts: list[Text] = []

    def show_figures(self, figures: Sequence[FoundFigure]) -> None:
        self._figures = figures
        self._place()

    def set_columns(self, columns: int) -> None:
        if columns != self._columns:
            self._columns = columns
            self._place()

    def _place(self) -> None:
        for text in self._texts:
            self._grid.removeWidget(text)
            text.hide()
            text.deleteLater()
        self._texts = []
        rows = -(-len(self._figures) // self._columns)
        for k, figure in enumerate(self._figures):
            column, row = divmod(k, max(rows, 1))
            name = Text(figure.name, tone="ink2", wraps=True)
            value = Text(figure.in_words, size=15, weight=SEMIBOLD)
            value.setAccessibleName(f"{figure.name}: {figure.in_words}")
            self._grid.addWidget(name, row, 3 * column)
            self._grid.addWidget(value, row, 3 * column + 1, Qt.AlignmentFlag.AlignRight)
            self._texts += [name, value]
        for column in range(6):
            is_name = column % 3 == 0 and column < 3 * self._columns
            self._grid.setColumnStretch(column, 1 if is_name else 0)
            self._grid.setColumnMinimumWidth(column, px(24) if column == 2 < 3 * self._columns - 1 else 0)


def _empty(card: Card) -> None:
    while (item := card.column.takeAt(0)) is not None:
        if (widget := item.widget()) is not None:
            widget.hide()
            widget.deleteLater()

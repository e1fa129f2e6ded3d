"""What came of one session: a walk as its mean cycle or as a whole, figures and findings beside it."""

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import QBoxLayout, QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.icons import Icon
from app.pages.compare_page import ComparePage
from app.pages.cycle_page import CyclePage
from app.pages.strides_page import StridesPage
from app.plots.angle_chart import Curve
from app.plots.joint_charts import JointCharts
from app.reports.comparison import conditions_of
from app.reports.patient_report.answer import Answer, Outcome
from app.reports.reference_bands import NOBODY, sides_with_band
from app.theme import Look
from app.widgets.button import Button, Kind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.facts_table import FactsTable
from app.widgets.findings_list import FindingsList
from app.widgets.notice import Notice
from app.widgets.segmented import Segmented
from app.widgets.text import SEMIBOLD, Text
from app.widgets.themed import Themed
from app.widgets.toggle import Toggle
from app.wording import later, tr
from core.body import Joint
from core.norms import AgeAndHeight
from core.results import Analysis, JointAngle, RecordingAnalysis
from core.samples import FloatArray, Recording, RecordingKind

RESULT, PUBLISHED, ORIENTATION, BOTH = "result", "published", "orientation", "both"

# the views; the last two only where room is short
MEAN, WHOLE, STRIDES, COMPARE, FIGURES, FACTS = "mean", "whole", "strides", "compare", "figures", "facts"
WALK, RECORDING = later("Whole walk"), later("Whole recording")

COMPACT_BELOW = (940, 656)  # what the charts of a mean cycle need with one table beside them
NARROW_BELOW = 940  # what both tables need without the charts
THREE_COLUMNS_FROM = 1264  # what the charts and both tables need side by side
LEAST_FINDINGS = 48  # under the peaks; what does not fit scrolls
SPACIOUS_FROM = 1600  # what charts, differences and their table need side by side
TWO_CHARTS_FROM = 680
ANSWER_PX = 22
ANSWER_ICONS = {
    Outcome.DIFFERS: Icon.WARNING,
    Outcome.NOTHING: Icon.CHECK,
    Outcome.OPEN: Icon.INFO,
    Outcome.UNREADABLE: Icon.GRAVE,
}

HINTS = {
    RESULT: later("Pale: certainty, ± 2 SD."),
    PUBLISHED: later("Equation 15 of the paper, on the same joint axes. No certainty is known for it."),
    ORIENTATION: later("Equation 10 of the paper, from orientations with magnetometer. No certainty is known for it."),
    BOTH: later("Bold: the result, pale its certainty of ± 2 SD. Thin: the published method."),
}
KEYS = later("Wheel or + \N{MINUS SIGN} zooms, drag or Page Up, Page Down moves, mouse or arrows read.")
EVENT_KEYS = later("[ ] step through contacts and toe-offs. Pre-swing is heel rise to toe-off.")


class ResultParts:
    """The parts of a result page that take long to be made: one at a time before they are wanted, or else when."""

    def __init__(self, look: Look) -> None:
        self._look = look

    @cached_property
    def cycles(self) -> CyclePage:
        return CyclePage(self._look)

    @cached_property
    def strides(self) -> StridesPage:
        return StridesPage(self._look)

    @cached_property
    def compare(self) -> ComparePage:
        return ComparePage(self._look)

    @cached_property
    def charts(self) -> JointCharts:
        return JointCharts(self._look)

    def make_next(self) -> bool:
        """Make one part; whether there was one left to be made."""
        left = [name for name in ("cycles", "strides", "compare", "charts") if name not in vars(self)]
        if left:
            getattr(self, left[0])
        return bool(left)


class ResultPage(Themed):
    """`parts`: those that were made before."""

    def __init__(self, look: Look, parts: ResultParts | None = None) -> None:
        super().__init__()
        parts = parts or ResultParts(look)
        self._look = look
        self._analysis: Analysis | None = None
        self._can_choose = False
        self._answer: Callable[[RecordingAnalysis], Answer] | None = None
        self._who = NOBODY
        self._stride: Mapping[Joint, FloatArray] = {}  # in force
        self._is_compact = False
        self._is_narrow = False
        self._has_two_charts = False
        self._columns_wanted = 3
        self._is_spacious = False
        self._wanted = MEAN  # of a walk; kept while recordings without it are looked at
        self.view = Segmented(
            look,
            tr("View"),
            [
                (MEAN, tr("Mean cycle"), ""),
                (WHOLE, tr(WALK), ""),
                (STRIDES, tr("Strides"), ""),
                (COMPARE, tr("Compare"), ""),
                (FIGURES, tr("Figures"), ""),
                (FACTS, tr("Findings"), ""),
            ],
        )
        self.recordings = Choice(look, tr("Recording"))
        self.methods = Segmented(
            look,
            tr("Method"),
            [
                (RESULT, tr("Result"), tr("relative orientation")),
                (PUBLISHED, tr("Published"), tr("equation 15")),
                (ORIENTATION, tr("Orientation"), tr("equation 10")),
                (BOTH, tr("Both"), tr("result and published")),
            ],
        )
        self.answer = Notice(look, ANSWER_PX, padding=4)
        self.single_strides = Toggle(look, tr("Single strides"), "S", is_on=False)
        self.band = Toggle(look, tr("Band"), "B", is_on=True)
        self.cycles = parts.cycles
        self.strides = parts.strides
        self.compare = parts.compare
        self.charts = parts.charts
        self.shown = Text(look, size=14, tone="ink2")
        self.whole = Button(look, tr("Whole recording"), Kind.QUIET, Icon.WHOLE, tr("Home"), height=44)
        self.hint = Text(look, size=12, tone="ink2", wraps=True)
        self.facts = FactsTable(look)
        self.findings = FindingsList(look)
        self._build()
        self._connect()
        self._on_look_changed()

    def show_analysis(
        self,
        analysis: Analysis,
        session: Sequence[Recording] = (),
        *,
        is_prosthetic: bool = False,
        can_choose: bool = False,
        who: AgeAndHeight = NOBODY,
        answer: Callable[[RecordingAnalysis], Answer] | None = None,
    ) -> None:
        """Show the recording that was on the screen, if `analysis` has it, else its first walk or first recording.

        Parameters
        ----------
        session
            The session's recordings in order, whose conditions are compared; without them every walk is one of its own.
        is_prosthetic
            Whether the affected side of `analysis` wears a prosthesis.
        can_choose
            Whether somebody keeps which strides are left out: see `strides`.
        who
            Whose walks they are, as far as that chooses a band.
        answer
            Gives the sentences that stand over a walk's curves.
        """
        self._analysis, self._can_choose, self._who, self._answer = analysis, can_choose, who, answer
        shown = self.recordings.currentText()
        parts = conditions_of(analysis, session)
        self.compare.show_conditions(analysis, parts, is_prosthetic, who)
        names = [recording.name for recording in analysis.recordings]
        walks = [i for i, recording in enumerate(analysis.recordings) if recording.kind is RecordingKind.WALKING]
        self.recordings.blockSignals(True)
        self.recordings.clear()
        self.recordings.addItems(names)
        first = walks[0] if walks else 0
        self.recordings.setCurrentIndex(names.index(shown) if shown in names else first)
        self.recordings.blockSignals(False)
        self.recordings.updateGeometry()
        self.recordings.setVisible(bool(names))
        self.findings.show_findings(analysis.findings)
        self._on_recording_changed()

    def set_room(self, width: float, height: float) -> None:
        """Fold the page as far as its room, in px of the design, asks for it.

        Where there is little room curves, figures and findings are tabs, and the controls take two rows.
        """
        is_compact = width < COMPACT_BELOW[0] or height < COMPACT_BELOW[1]
        has_two_charts = is_compact and width >= TWO_CHARTS_FROM
        columns = 1 if is_compact else 2 if width < THREE_COLUMNS_FROM else 3
        room = is_compact, width < NARROW_BELOW, has_two_charts, columns, columns > 1 and width >= SPACIOUS_FROM
        if room != (self._is_compact, self._is_narrow, self._has_two_charts, self._columns_wanted, self._is_spacious):
            self._is_compact, self._is_narrow, self._has_two_charts, self._columns_wanted, self._is_spacious = room
            self._place()

    def focus(self) -> None:
        """Give the focus to the first choice of the page."""
        (self.methods if self.view.isHidden() else self.view).focus()

    @property
    def recording(self) -> RecordingAnalysis | None:
        """The recording on the screen; None in a session without any that moves."""
        if self._analysis is None or not self._analysis.recordings:
            return None
        return self._analysis.recordings[self.recordings.currentIndex()]

    @property
    def tab_order(self) -> list[QWidget]:
        """What takes the focus, in the order of reading."""
        choices = [*self.view.segments, self.recordings, self.single_strides, self.band, *self.methods.segments]
        shown = [self.charts, self.whole, *self.strides.tab_order, *self.cycles.tables, *self.compare.tab_order]
        return [*choices, *shown, self.facts, self.findings]

    def _build(self) -> None:
        self._controls = QGridLayout()
        self._toggles = QWidget()
        toggles = QHBoxLayout(self._toggles)
        toggles.setContentsMargins(0, 0, 0, 0)
        toggles.addWidget(self.single_strides)
        toggles.addWidget(self.band)
        self._against = QWidget()
        self._against_row = QHBoxLayout(self._against)
        self._against_row.setContentsMargins(0, 0, 0, 0)
        self._against_row.addWidget(self.compare.kinds)
        self._against_row.addWidget(self.compare.bases)
        self._choices = QWidget()
        choices = QHBoxLayout(self._choices)
        choices.setContentsMargins(0, 0, 0, 0)
        for widget in (self.recordings, self._toggles, self._against):
            choices.addWidget(widget)
        self._curves = QWidget()
        left = QVBoxLayout(self._curves)
        left.setContentsMargins(0, 0, 0, 0)
        left.addWidget(self.charts, 1)
        self._notes = QWidget()
        notes = QVBoxLayout(self._notes)
        notes.setContentsMargins(0, 0, 0, 0)
        notes.setSpacing(2)
        notes.addWidget(self.shown)
        notes.addWidget(self.hint)
        self._foot = QGridLayout()
        self._foot.setColumnStretch(0, 1)
        left.addLayout(self._foot)
        self._beside = QWidget()
        self._right = QVBoxLayout(self._beside)
        self._right.setContentsMargins(0, 0, 0, 0)
        self._joints = Card(self._look)
        self._joints.column.addWidget(Text(self._look, tr("Joints"), size=16, weight=SEMIBOLD))
        self._joints.column.addWidget(self.facts)
        self._joints.column.addStretch(1)
        self._noticed = Card(self._look)
        self._noticed.column.addWidget(Text(self._look, tr("Findings"), size=16, weight=SEMIBOLD))
        self._noticed.column.addWidget(self.findings, 1)
        self._right.addWidget(self.cycles.time_distance)
        self._right.addWidget(self._joints)
        self._right.addWidget(self._noticed, 1)
        self._columns = QHBoxLayout()
        for widget, share in (
            (self._curves, 1),
            (self.cycles, 2),
            (self.strides, 0),
            (self.compare, 1),
            (self.cycles.peaks, 0),
            (self._beside, 0),
        ):
            self._columns.addWidget(widget, share)
        self._page = QVBoxLayout(self)
        self._page.addLayout(self._controls)
        self._page.addWidget(self.answer)
        self._page.addLayout(self._columns, 1)
        policy = self.whole.sizePolicy()
        policy.setRetainSizeWhenHidden(True)  # what comes and goes must not move what stays
        self.whole.setSizePolicy(policy)
        self._place()

    def _connect(self) -> None:
        self.view.chosen.connect(self._on_view_chosen)
        self.methods.chosen.connect(self._on_method_chosen)
        self.recordings.currentIndexChanged.connect(self._on_recording_changed)
        self.charts.view_changed.connect(self._on_view_changed)
        self.whole.clicked.connect(self.charts.show_whole)
        self.strides.chosen.connect(self._on_stride_chosen)
        self.cycles.charts.picked.connect(self._on_stride_picked)
        for toggle, slot in (
            (self.single_strides, self._show_strides),
            (self.band, self._on_band_toggled),
        ):
            toggle.toggled.connect(slot)
            shortcut = QShortcut(QKeySequence(toggle.key), toggle)  # asleep while its toggle is hidden
            shortcut.activated.connect(toggle.toggle)

    def _place(self) -> None:
        """Put the controls into one row, where they fit; the methods go under the curves where they do not."""
        for widget in (self.view, self.methods, self._choices):
            self._controls.removeWidget(widget)
        for widget in (self._notes, self.methods, self.whole):
            self._foot.removeWidget(widget)
        left = Qt.AlignmentFlag.AlignLeft
        self._controls.addWidget(self.view, 0, 0, left)
        self._controls.setColumnStretch(3, 1)
        if self._is_compact:
            self._controls.addWidget(self._choices, 1, 0, 1, 4, left)
            self._against_row.insertWidget(2, self.compare.view)
        else:
            self._controls.addWidget(self._choices, 0, 1)
        if self._is_narrow:
            self._foot.addWidget(self.methods, 0, 0, left)
            self._foot.addWidget(self.whole, 1, 0, left)
            self._foot.addWidget(self._notes, 2, 0)
        elif self._columns_wanted < 3:
            self._foot.addWidget(self.methods, 0, 0, 1, 2, left)
            self._foot.addWidget(self._notes, 1, 0)
            self._foot.addWidget(self.whole, 1, 1)
        else:
            self._controls.addWidget(self.methods, 0, 2)
            self._foot.addWidget(self._notes, 0, 0)
            self._foot.addWidget(self.whole, 0, 1)
        self.compare.set_room(self._is_compact, self._is_spacious)
        self.strides.set_charts_beside(not self._is_narrow)
        self.findings.setMinimumHeight(self._look.theme.px(LEAST_FINDINGS) if self._columns_wanted == 2 else 0)
        for frame in (self.charts.knee, self.charts.ankle):
            frame.set_narrow(self._is_narrow)
        self.charts.phases.set_narrow(self._is_narrow or not self._is_compact)  # facts beside it leave it less room
        self.cycles.set_room(self._columns_wanted < 3, self._has_two_charts)
        self._place_peaks()
        self._offer()

    def _offer(self) -> None:
        """Offer the views that this recording and this room have."""
        recording = self.recording
        is_walk = recording is not None and recording.kind is RecordingKind.WALKING
        has_strides = recording is not None and any(len(gait.strides) for gait in recording.gait.values())
        self.view.blockSignals(True)
        self.view.set_word(WHOLE, tr(WALK if is_walk else RECORDING))
        self.view.set_offered(MEAN, is_walk)
        self.view.set_offered(COMPARE, is_walk)
        self.view.set_offered(STRIDES, is_walk)
        for view in (MEAN, STRIDES, COMPARE):
            self.view.set_reason(view, "" if has_strides else tr("no strides"))
        self.view.set_offered(FIGURES, self._columns_wanted < 3 and has_strides)
        self.view.set_offered(FACTS, self._is_compact)
        if self.view.choice in (MEAN, WHOLE):
            self.view.choose(self._wanted if is_walk and has_strides else WHOLE)
        self.view.blockSignals(False)
        self.view.setVisible(is_walk or self._is_compact)
        self._show_parts()

    def _show_parts(self) -> None:
        """Show what belongs to the view; beside the curves only where there is room."""
        view, is_wide = self.view.choice, not self._is_compact
        has_figures = view == FIGURES or (view == MEAN and is_wide)
        self.methods.setVisible(view == WHOLE)
        self.recordings.setVisible(view != COMPARE and self.recordings.count() > 0)
        self._against.setVisible(view == COMPARE)
        self.compare.setVisible(view == COMPARE)
        has_answer = view == (MEAN if self.view.segments[0].isEnabled() else WHOLE)
        self.answer.setVisible(has_answer and bool(self.answer.text))
        self._toggles.setVisible(view == MEAN or (view == STRIDES and not self._is_narrow))
        self.single_strides.setVisible(view == MEAN)
        self._curves.setVisible(view == WHOLE)
        self.cycles.setVisible(view == MEAN or (view == STRIDES and not self._is_narrow))
        self.cycles.charts.set_side_by_side(self._has_two_charts and view == MEAN)
        self.cycles.set_notes_shown(view == MEAN)
        self.strides.setVisible(view == STRIDES)
        self._show_strides()
        self.cycles.peaks.setVisible(has_figures)
        self.cycles.time_distance.setVisible(has_figures and (self._columns_wanted != 2 or view == FIGURES))
        self._joints.setVisible(view == FACTS or (view == WHOLE and is_wide))
        is_answered = not self.answer.isHidden() and self._columns_wanted == 2  # which takes the findings' room
        has_findings = view == FACTS or (is_wide and view not in (COMPARE, STRIDES, FIGURES) and not is_answered)
        self._noticed.setVisible(has_findings)
        self._beside.setVisible((is_wide and view not in (COMPARE, STRIDES)) or view in (FIGURES, FACTS))
        is_row = (view == FACTS and not self._is_narrow) or (view == FIGURES and self._columns_wanted == 2)
        self._right.setDirection(QBoxLayout.Direction.LeftToRight if is_row else QBoxLayout.Direction.TopToBottom)
        is_stack = view == FIGURES and self._is_narrow
        self._columns.setDirection(QBoxLayout.Direction.TopToBottom if is_stack else QBoxLayout.Direction.LeftToRight)
        self._right.activate()
        self._page.activate()  # now, else the charts would be painted once too small and once right

    def _place_peaks(self) -> None:
        """Put the peaks over the findings where there is room for one column of tables only."""
        for layout in (self._right, self._columns):
            layout.removeWidget(self.cycles.peaks)  # else PySide goes on holding its old item, which Qt deletes
        if self._columns_wanted == 2:
            self._right.insertWidget(0, self.cycles.peaks)
        else:
            self._columns.insertWidget(self._columns.indexOf(self._beside), self.cycles.peaks)

    def _on_view_chosen(self) -> None:
        if self.view.choice in (MEAN, WHOLE) and self.view.segments[0].isEnabled():
            self._wanted = self.view.choice
        self._show_parts()

    def _on_recording_changed(self) -> None:
        recording = self.recording
        self.charts.setEnabled(recording is not None)
        if recording is None or self._analysis is None:
            self.charts.show_recording(tr("no recording"), np.zeros(0), is_simulated=False)
            self.facts.show_joints({})
            self._offer()
            return
        has_orientation = any(angle.orientation_rad is not None for angle in recording.joints.values())
        self.methods.set_reason(ORIENTATION, "" if has_orientation else tr("no magnetometer"))
        calibrated, is_simulated = self._analysis.calibrated_for(recording), self._analysis.is_simulated
        self.charts.show_recording(recording.name, recording.time_s, is_simulated, recording.gait)
        self.cycles.show_walk(recording, is_simulated, self._who, sides_with_band(recording))
        self._tell_answer(recording)
        self.strides.show_walk(recording, self._can_choose)
        self.facts.show_joints(calibrated)
        self._on_method_chosen()
        self._offer()

    def _tell_answer(self, recording: RecordingAnalysis) -> None:
        if self._answer is None or recording.kind is not RecordingKind.WALKING:
            self.answer.tell(None, "")
            return
        answer = self._answer(recording)
        self.answer.tell(ANSWER_ICONS[answer.outcome], answer.first, answer.then)

    def _on_method_chosen(self) -> None:
        recording = self.recording
        if recording is None:
            return
        method = self.methods.choice
        curves = {joint: curve for joint, angle in recording.joints.items() if (curve := _curve(angle, method))}
        self.charts.show_joints(curves)
        self.hint.setText(
            " ".join(filter(None, [tr(HINTS[method]), tr(KEYS), tr(EVENT_KEYS) if recording.gait else ""]))
        )

    def _show_strides(self) -> None:
        """Draw single strides where they are wished, or chosen from; the one in force only there."""
        is_choosing = self.view.choice == STRIDES
        self.cycles.charts.set_strides_shown(is_choosing or self.single_strides.isChecked())
        self.cycles.charts.show_stride(self._stride if is_choosing else {})

    def _on_stride_chosen(self, curves_deg: Mapping[Joint, FloatArray]) -> None:
        self._stride = curves_deg
        self._show_strides()

    def _on_stride_picked(self, is_knee: bool, percent: float, angle_deg: float) -> None:
        if self.view.choice == STRIDES:
            self.strides.choose_nearest(is_knee, percent, angle_deg, self.cycles.charts.heights_deg)

    def _on_band_toggled(self, is_shown: bool) -> None:
        self.cycles.charts.set_band_shown(is_shown)
        self.compare.set_band_shown(is_shown)

    def _on_view_changed(self, is_whole: bool, words: str) -> None:
        self.shown.setText(words)
        if is_whole and self.whole.hasFocus():
            self.charts.setFocus()
        self.whole.setVisible(not is_whole)

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        margin = px(16)
        self._page.setContentsMargins(margin, px(16), margin, px(12))
        self._page.setSpacing(px(12))
        self._controls.setSpacing(px(12))
        self._columns.setSpacing(px(12))
        for side in (self._curves, self._beside, self._toggles, self._against, self._choices):
            layout = side.layout()
            assert layout is not None
            layout.setSpacing(px(12))
        self._foot.setHorizontalSpacing(px(16))
        self._foot.setVerticalSpacing(px(8))


def _curve(angle: JointAngle, method: str) -> Curve | None:
    """Give what `method` draws of one joint, in degrees; None where it has nothing."""
    result, sd, published = (np.rad2deg(values) for values in (angle.angle_rad, angle.sd_rad, angle.published_rad))
    match method:
        case "published":
            return Curve(published)
        case "orientation":
            return None if angle.orientation_rad is None else Curve(np.rad2deg(angle.orientation_rad))
        case "both":
            return Curve(result, sd, published)
        case _:
            return Curve(result, sd)

"""What came of one session: curves at the left, how they were found and what was noticed beside them."""

from collections.abc import Mapping

import numpy as np
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.plots.angle_chart import Curve
from app.plots.joint_charts import JointCharts
from app.theme import Look
from app.widgets.button import Button, Kind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.facts_table import FactsTable
from app.widgets.findings_list import FindingsList
from app.widgets.icons import Icon
from app.widgets.segmented import Segmented
from app.widgets.text import SEMIBOLD, Text
from core.body import Joint
from core.results import Analysis, JointAngle, JointCalibration, RecordingAnalysis
from core.samples import RecordingKind

RESULT, PUBLISHED, ORIENTATION, BOTH = "result", "published", "orientation", "both"

CURVES, FACTS = "curves", "facts"

HINTS = {
    RESULT: "Band: ± 2 SD.",
    PUBLISHED: "Equation 15 of the paper, on the same joint axes. No certainty is known for it.",
    ORIENTATION: "Equation 10 of the paper, from orientations with magnetometer. No certainty is known for it.",
    BOTH: "Bold: the result, with a band of ± 2 SD. Thin: the published method.",
}
KEYS = "Wheel or + \N{MINUS SIGN} zooms, drag or Page Up, Page Down moves, mouse or arrows read."


class ResultPage(QWidget):
    def __init__(self, look: Look) -> None:
        super().__init__()
        self._look = look
        self._analysis: Analysis | None = None
        self._is_compact = False
        self._is_narrow = False
        self.methods = Segmented(
            look,
            "Method",
            [
                (RESULT, "Result", "relative orientation"),
                (PUBLISHED, "Published", "equation 15"),
                (ORIENTATION, "Orientation", "equation 10"),
                (BOTH, "Both", "result and published"),
            ],
        )
        self.recordings = Choice(look, "Recording")
        self.part = Segmented(look, "Part of the page", [(CURVES, "Curves", ""), (FACTS, "Joints, findings", "")])
        self.charts = JointCharts(look)
        self.shown = Text(look, size=14, tone="ink2")
        self.whole = Button(look, "Whole recording", Kind.QUIET, Icon.WHOLE, "Home", height=44)
        self.hint = Text(look, size=12, tone="ink2", wraps=True)
        self.facts = FactsTable(look)
        self.findings = FindingsList(look)
        self._build()
        self.methods.chosen.connect(self._on_method_chosen)
        self.recordings.currentIndexChanged.connect(self._on_recording_changed)
        self.part.chosen.connect(self._on_part_chosen)
        self.charts.view_changed.connect(self._on_view_changed)
        self.whole.clicked.connect(self.charts.show_whole)
        look.changed.connect(self._on_look_changed)
        self._on_look_changed()

    def show_analysis(self, analysis: Analysis) -> None:
        """Show the first walk of `analysis`, or its first recording."""
        self._analysis = analysis
        names = [recording.name for recording in analysis.recordings]
        walks = [i for i, recording in enumerate(analysis.recordings) if recording.kind is RecordingKind.WALKING]
        self.recordings.blockSignals(True)
        self.recordings.clear()
        self.recordings.addItems(names)
        self.recordings.setCurrentIndex(walks[0] if walks else 0)
        self.recordings.blockSignals(False)
        self.recordings.updateGeometry()
        self.recordings.setVisible(bool(names))
        self.findings.show_findings(analysis.findings)
        self._on_recording_changed()

    def set_room(self, is_compact: bool, is_narrow: bool) -> None:
        """Fold curves and facts into two tabs where there is little room, and the controls into two rows."""
        if (is_compact, is_narrow) != (self._is_compact, self._is_narrow):
            self._is_compact, self._is_narrow = is_compact, is_narrow
            self._place()

    @property
    def recording(self) -> RecordingAnalysis | None:
        """The recording on the screen; None in a session without any that moves."""
        if self._analysis is None or not self._analysis.recordings:
            return None
        return self._analysis.recordings[self.recordings.currentIndex()]

    @property
    def tab_order(self) -> list[QWidget]:
        """What takes the focus, in the order of reading."""
        beside = [self.charts, self.whole, self.facts, self.findings]
        return [*self.methods.segments, self.recordings, *self.part.segments, *beside]

    def _build(self) -> None:
        self._controls = QGridLayout()
        self._curves = QWidget()
        self._beside = QWidget()
        left = QVBoxLayout(self._curves)
        left.setContentsMargins(0, 0, 0, 0)
        left.addWidget(self.charts, 1)
        self._foot = QHBoxLayout()
        notes = QVBoxLayout()
        notes.setSpacing(2)
        notes.addWidget(self.shown)
        notes.addWidget(self.hint)
        self._foot.addLayout(notes, 1)
        self._foot.addWidget(self.whole)
        left.addLayout(self._foot)
        self._right = QVBoxLayout(self._beside)
        self._right.setContentsMargins(0, 0, 0, 0)
        facts = Card(self._look)
        facts.column.addWidget(Text(self._look, "Joints", size=16, weight=SEMIBOLD))
        facts.column.addWidget(self.facts)
        facts.column.addStretch(1)
        self._right.addWidget(facts)
        findings = Card(self._look)
        findings.column.addWidget(Text(self._look, "Findings", size=16, weight=SEMIBOLD))
        findings.column.addWidget(self.findings, 1)
        self._right.addWidget(findings, 1)
        self._columns = QHBoxLayout()
        self._columns.addWidget(self._curves, 1)
        self._columns.addWidget(self._beside)
        self._page = QVBoxLayout(self)
        self._page.addLayout(self._controls)
        self._page.addLayout(self._columns, 1)
        policy = self.whole.sizePolicy()
        policy.setRetainSizeWhenHidden(True)  # what comes and goes must not move what stays
        self.whole.setSizePolicy(policy)
        self._place()

    def _place(self) -> None:
        for widget in (self.methods, self.recordings, self.part):
            self._controls.removeWidget(widget)
        row, column = (1, 0) if self._is_narrow else (0, 1)
        self._controls.addWidget(self.methods, 0, 0, 1, 2 if self._is_narrow else 1)
        self._controls.addWidget(self.recordings, row, column)
        self._controls.addWidget(self.part, row, column + 1)
        for i in range(4):
            self._controls.setColumnStretch(i, 1 if i == 3 else 0)
        is_side_by_side = self._is_compact and not self._is_narrow
        way = QHBoxLayout.Direction.LeftToRight if is_side_by_side else QHBoxLayout.Direction.TopToBottom
        self._right.setDirection(way)
        self.part.setVisible(self._is_compact)
        self._on_part_chosen()
        for frame in (self.charts.knee, self.charts.ankle):
            frame.set_narrow(self._is_narrow)

    def _on_part_chosen(self) -> None:
        is_facts = self.part.choice == FACTS
        self._curves.setVisible(not (self._is_compact and is_facts))
        self._beside.setVisible(not self._is_compact or is_facts)

    def _on_recording_changed(self) -> None:
        recording = self.recording
        self.charts.setEnabled(recording is not None)
        if recording is None or self._analysis is None:
            self.charts.show_recording("no recording", np.zeros(0), is_simulated=False)
            self.facts.show_joints({})
            return
        has_orientation = any(angle.orientation_rad is not None for angle in recording.joints.values())
        self.methods.set_reason(ORIENTATION, "" if has_orientation else "no magnetometer")
        self.charts.show_recording(recording.name, recording.time_s, self._analysis.is_simulated)
        self.facts.show_joints(_in_force(self._analysis, recording))
        self._on_method_chosen()

    def _on_method_chosen(self) -> None:
        recording = self.recording
        if recording is None:
            return
        method = self.methods.choice
        curves = {joint: curve for joint, angle in recording.joints.items() if (curve := _curve(angle, method))}
        self.charts.show_joints(curves)
        self.hint.setText(f"{HINTS[method]} {KEYS}")

    def _on_view_changed(self, is_whole: bool, words: str) -> None:
        self.shown.setText(words)
        if is_whole and self.whole.hasFocus():
            self.charts.setFocus()
        self.whole.setVisible(not is_whole)

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        margin = px(16 if self._is_compact else 24)
        self._page.setContentsMargins(margin, px(16), margin, px(12))
        self._page.setSpacing(px(12))
        self._controls.setSpacing(px(12))
        self._columns.setSpacing(px(16))
        for side in (self._curves, self._beside):
            layout = side.layout()
            assert layout is not None
            layout.setSpacing(px(12))
        self._foot.setSpacing(px(16))


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


def _in_force(analysis: Analysis, recording: RecordingAnalysis) -> Mapping[Joint, JointCalibration]:
    """Give the calibrations that `recording` was measured with."""
    for calibration in analysis.calibrations:
        if recording.name in calibration.walks:
            return calibration.joints
    for calibration in analysis.calibrations:  # a free motion is measured with what it gave
        if any(found.free_motion_from == recording.name for found in calibration.joints.values()):
            return calibration.joints
    return analysis.calibrations[-1].joints if analysis.calibrations else {}

"""A recording as a whole: its angles over time by one method or by two, and how much of it is in sight."""

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QVBoxLayout, QWidget

from app.plots.angle_chart import Curve
from app.plots.joint_charts import JointCharts
from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.lay_out import lay_out
from app.widgets.segmented import Segmented
from app.widgets.text import Text
from app.wording.translation import later, tr
from core.hip.results import HipAngle
from core.results import JointAngle, RecordingAnalysis

RESULT, PUBLISHED, ORIENTATION, BOTH = "result", "published", "orientation", "both"

HINTS = {
    RESULT: later("Shaded: uncertainty, ± 2 SD."),
    PUBLISHED: later(
        "This angle follows equation 15 of the paper, with the same joint axes as the result. Its "
        "uncertainty is not known."
    ),
    ORIENTATION: later(
        "This angle follows equation 10 of the paper, from sensor orientations with magnetometer. Its "
        "uncertainty is not known."
    ),
    BOTH: later("Bold: result, with shaded uncertainty (± 2 SD). Thin: published method."),
}
KEYS = later("Zoom: wheel or + −. Move: drag or Page Up, Page Down. Read values: mouse or arrow keys.")
EVENT_KEYS = later("Keys [ and ] step through initial contacts and toe-offs. Pre-swing: heel rise to toe-off.")


class WholePage(QWidget):
    """The curves, and what must be known to read them; the page around may take `methods` into a row of its own."""

    def __init__(self) -> None:
        super().__init__()
        self._recording: RecordingAnalysis | None = None
        self.charts = JointCharts()
        self.methods = Segmented(
            tr("Method"),
            [
                (RESULT, tr("Result"), tr("relative orientation")),
                (PUBLISHED, tr("Published"), tr("equation 15")),
                (ORIENTATION, tr("Orientation"), tr("equation 10")),
                (BOTH, tr("Both"), tr("result and published")),
            ],
        )
        self.shown = Text(size=14, tone="ink2")
        self.to_whole = Button(tr("Whole recording"), ButtonKind.QUIET, Icon.WHOLE, tr("Home"), height=44)
        self.hint = Text(size=12, tone="ink2", wraps=True)
        self._notes = QWidget()
        lay_out(QVBoxLayout(self._notes), self.shown, self.hint, margins=0, spacing=2)
        self._foot = QGridLayout()
        self._foot.setColumnStretch(0, 1)
        lay_out(QVBoxLayout(self), (self.charts, 1), self._foot, margins=0, spacing=12)
        scaled(self._foot.setHorizontalSpacing, 16)
        scaled(self._foot.setVerticalSpacing, 8)
        policy = self.to_whole.sizePolicy()
        policy.setRetainSizeWhenHidden(True)  # what comes and goes must not move what stays
        self.to_whole.setSizePolicy(policy)
        self.methods.chosen.connect(self._show_curves)
        self.charts.view_changed.connect(self._on_view_changed)
        self.to_whole.clicked.connect(self.charts.show_whole)

    @property
    def tab_order(self) -> list[QWidget]:
        """What takes the focus but for the methods, which may stand elsewhere."""
        return [self.charts, self.to_whole]

    def show_recording(self, recording: RecordingAnalysis | None, called: str, *, is_simulated: bool) -> None:
        """Show all of a recording by the method in force, as far as it has one; None: there is none that moves."""
        self._recording = recording
        self.charts.setEnabled(recording is not None)
        if recording is None:
            self.charts.show_recording(tr("no recording"), np.zeros(0), is_simulated=False)
            return
        has_orientation = any(angle.orientation_rad is not None for angle in recording.joints.values())
        self.methods.set_reason(ORIENTATION, "" if has_orientation else tr("no magnetometer"))
        self.charts.show_recording(called, recording.time_s, is_simulated, recording.gait)
        self._show_curves()

    def place(self, *, has_methods: bool, is_narrow: bool, is_wide: bool) -> None:
        """Put notes and `methods` under the curves; not `has_methods`: the page around has them in its own row."""
        for widget in (self._notes, self.methods, self.to_whole):
            self._foot.removeWidget(widget)
        left = Qt.AlignmentFlag.AlignLeft
        if is_narrow:
            self._foot.addWidget(self.to_whole, 1, 0, left)
            self._foot.addWidget(self._notes, 2, 0)
        else:
            self._foot.addWidget(self._notes, 1, 0)
            self._foot.addWidget(self.to_whole, 1, 1)
        if has_methods:
            self._foot.addWidget(self.methods, 0, 0, 1, 1 if is_narrow else 2, left)
        for frame in self.charts.frames:
            frame.set_room(is_narrow=is_narrow, is_wide=is_wide)
        hear_as_laid_out(self)

    def fit_phases(self, width: int, *, is_narrow: bool) -> None:
        """Put the legend of the phases beside their title where `width`, in pixels, has room for both."""
        phases = self.charts.phases
        phases.set_narrow(is_narrow or not phases.does_fit(width))

    def _show_curves(self) -> None:
        recording, method = self._recording, self.methods.choice
        if recording is None:
            return
        curves = {joint: curve for joint, angle in recording.joints.items() if (curve := _curve(angle, method))}
        curves |= {joint: curve for joint, hip in recording.hips.items() if (curve := _hip_curve(hip, method))}
        self.charts.show_joints(curves)
        stated = [tr(HINTS[method]), tr(KEYS), tr(EVENT_KEYS) if recording.gait else ""]
        self.hint.setText(" ".join(filter(None, stated)))

    def _on_view_changed(self, is_whole: bool, words: str) -> None:
        self.shown.setText(words)
        if is_whole and self.to_whole.hasFocus():
            self.charts.setFocus()
        self.to_whole.setVisible(not is_whole)


def _hip_curve(hip: HipAngle, method: str) -> Curve | None:
    """Give a hip's flexion, in degrees; neither the published method nor a magnetometer gives one."""
    is_result = method in (RESULT, BOTH)
    return Curve(np.rad2deg(hip.angle_rad), np.rad2deg(hip.sd_rad)) if is_result else None


def _curve(angle: JointAngle, method: str) -> Curve | None:
    """Give what `method` draws of one joint, in degrees; None where it has nothing."""
    result, sd, published = (np.rad2deg(values) for values in (angle.angle_rad, angle.sd_rad, angle.published_rad))
    if method == PUBLISHED:
        return Curve(published)
    if method == ORIENTATION:
        return None if angle.orientation_rad is None else Curve(np.rad2deg(angle.orientation_rad))
    return Curve(result, sd, published if method == BOTH else None)

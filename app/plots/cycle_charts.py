"""Hip, knee and ankle over one stride: all charts of a walk, with what they share."""

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QBoxLayout, QWidget

from app.charts.cycles import Band, SideCycle
from app.charts.marks import CurveLabel, Deviation, Gap
from app.plots.cycle_chart import CycleChart
from app.plots.cycle_frame import CycleFrame
from app.summary.comparison import Comparison
from app.widgets.lay_out import lay_out
from app.wording.translation import tr
from core.body import Joint, JointKind, Side
from core.samples import FloatArray
from core.verdicts.model import JointVerdicts
from core.verdicts.norms import ReferenceCurves


class CycleCharts(QWidget):
    """All charts, with what they share: the band and the single strides, each on or off.

    The hip's is there where a hip was measured, or should have been.
    """

    picked = Signal(object, float, float)  # JointKind; percent of the stride, degrees

    def __init__(self, reference: ReferenceCurves) -> None:
        super().__init__()
        self.hip, self.knee, self.ankle = (CycleFrame(CycleChart(kind), kind) for kind in JointKind)
        self._frames = (self.hip, self.knee, self.ankle)
        self.hip.hide()
        frames = ((frame, 1) for frame in self._frames)
        self._box = lay_out(QBoxLayout(QBoxLayout.Direction.TopToBottom, self), *frames, margins=0, spacing=12)
        for frame in self._frames:
            frame.chart.picked.connect(self._on_picked)
        self.set_band(reference)

    @property
    def frames(self) -> tuple[CycleFrame, ...]:
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

    def set_band(self, reference: ReferenceCurves | None, names: Sequence[str] | None = None, source: str = "") -> None:
        """Draw a group's band or none; `names`: for the key (first that fits), `source`: for the info button."""
        default = (tr("Reference"),) if reference is not None else ()
        for frame in self._frames:
            frame.chart.band = Band(*reference.mean_and_sd_deg(frame.kind)) if reference is not None else None
            frame.show_reference(names if names is not None else default, source)

    def show_beside(self, found: Comparison | None, words: str = "", thin_sides: frozenset[Side] = frozenset()) -> None:
        """Draw the comparison thin, or state why not, until the next walk; marks and labels must be set again."""
        for frame in self._frames:
            frame.show_beside(found, words, thin_sides)

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
            frame.set_band_shown(is_shown)

    def show_labels(self, labels: Sequence[CurveLabel]) -> None:
        """Write values at points of the curves, degrees as measured; the next walk shown is without."""
        for frame in self._frames:
            frame.show_labels([label for label in labels if label.kind is frame.kind])

    def show_cursor(self, percent: Mapping[Side, float]) -> None:
        """Mark a place on each leg's own stride; none: no cursor."""
        for frame in self._frames:
            frame.chart.readings = percent
            frame.chart.update()

    def set_tight(self, *, is_tight: bool) -> None:
        """Let three charts be small where there is little room."""
        for frame in self._frames:
            frame.chart.set_tight(is_tight)

    def set_side_by_side(self, is_side_by_side: bool) -> None:
        way = QBoxLayout.Direction.LeftToRight if is_side_by_side else QBoxLayout.Direction.TopToBottom
        self._box.setDirection(way)

    def _on_picked(self, percent: float, angle_deg: float) -> None:
        kind = next(frame.kind for frame in self._frames if frame.chart is self.sender())
        self.picked.emit(kind, percent, angle_deg)

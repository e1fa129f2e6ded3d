"""Strides of this walk that count. Each in a line beside the charts, left out and taken in again by hand."""

from collections.abc import Mapping

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QWidget

from app.summary.conditions import by_hand_in_words
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.stride_list import StrideLine, StrideList
from app.widgets.text import SEMIBOLD, Text
from app.wording.findings import NAMES
from app.wording.translation import tr
from core.body import Joint, JointKind, Side
from core.gait.strides import Reason
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.verdicts.quantities import values_of


class StridesPage(Card):
    """`turned` and `all_required` name a walk; nothing is changed here, only by whoever shows the walk again."""

    turned = Signal(str, object, bool)  # StrideLine, and whether it is to be left out
    all_required = Signal(str)
    chosen = Signal(object)  # curves in degrees by joint, of the stride in force

    def __init__(self) -> None:
        super().__init__(padding=12)
        self._recording: RecordingAnalysis | None = None
        self.list = StrideList(tr("Strides"))
        self.turn = Button("", ButtonKind.SECONDARY, key=tr("Space"), height=44)
        self.all = Button(tr("Include all again"), ButtonKind.QUIET, Icon.REPEAT, height=44)
        self.legend = Text(tr("Grey: mean of the same side."), size=12, tone="ink2")
        self.note = Text(size=12, tone="ink2", wraps=True)
        head = lay_out(QHBoxLayout(), Text(tr("Strides"), size=16, weight=SEMIBOLD), 1, self.legend)
        buttons = lay_out(QHBoxLayout(), self.turn, self.all, 1)
        lay_out(self.column, head, (self.list, 1), buttons, self.note)
        self.list.chosen.connect(self._on_chosen)
        self.list.turned.connect(self._on_turned)
        self.turn.clicked.connect(self.list.turn)
        self.all.clicked.connect(self._on_all)

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.list, self.turn, self.all]

    def show_walk(self, recording: RecordingAnalysis, can_choose: bool) -> None:
        """Show the strides of a walk; `can_choose`: there is a library that keeps what is chosen."""
        self._recording = recording
        self.list.show_lines(stride_lines(recording), can_turn=can_choose)
        reported = [by_hand_in_words(recording)]
        if not can_choose:
            reported.append(tr("Strides can be excluded only in the library. Import this session first."))
        stated = " ".join(filter(None, reported))
        self.note.setText(stated or tr("Excluded strides stay in the files with the reason."))
        self.turn.setVisible(can_choose)
        self.all.setVisible(can_choose and any(line.is_by_hand for line in self.list.lines))

    def set_charts_beside(self, are_beside: bool) -> None:
        """Draw the curves in the list itself where no charts have room beside it."""
        self.list.set_shapes_shown(not are_beside)
        self.legend.setVisible(not are_beside)

    def choose_nearest(
        self, kind: JointKind, percent: float, angle_deg: float, heights_deg: Mapping[Joint, float]
    ) -> None:
        """Go to the stride whose curve runs nearest to a point of its chart; `heights_deg`: drawn so much lower."""
        best: tuple[float, int] | None = None
        at = int(np.clip(round(percent), 0, 100))
        for row, line in enumerate(self.list.lines):
            joint = kind.of(line.side)
            curve = self._curves(line).get(joint)
            if curve is not None and line.is_used:
                distance = abs(float(curve[at]) - heights_deg.get(joint, 0.0) - angle_deg)
                best = min(best or (distance, row), (distance, row))
        if best is not None:
            self.list.choose(best[1])

    def _curves(self, line: StrideLine) -> Mapping[Joint, FloatArray]:
        """The joints over one stride, degrees, where they are known over all of it."""
        if self._recording is None or line.side not in self._recording.gait:
            return {}
        cycles = self._recording.gait[line.side].cycles
        curves = {joint: np.rad2deg(curve[line.number - 1]) for joint, curve in cycles.items()}
        return {joint: curve for joint, curve in curves.items() if np.isfinite(curve).all()}

    def _on_chosen(self, line: StrideLine | None) -> None:
        self.turn.setEnabled(line is not None and line.can_be_turned)
        is_out = line is not None and line.is_by_hand
        words = tr("Include this stride") if is_out else tr("Exclude this stride")
        self.turn.setText(words)
        self.turn.setAccessibleName(words)
        self.turn.updateGeometry()
        self.chosen.emit(self._curves(line) if line is not None else {})

    def _on_turned(self, line: StrideLine) -> None:
        if self._recording is not None:
            self.turned.emit(self._recording.name, line, not line.is_by_hand)

    def _on_all(self) -> None:
        if self._recording is not None:
            self.list.setFocus(Qt.FocusReason.OtherFocusReason)  # the button goes
            self.all_required.emit(self._recording.name)


def stride_lines(recording: RecordingAnalysis) -> tuple[StrideLine, ...]:
    """Both sides' strides, the left one's first, as they followed each other."""
    lines = []
    for side in Side:
        if side not in recording.gait:
            continue
        gait = recording.gait[side]
        ranges = {kind: values_of(recording, side, f"{kind}_range_deg") for kind in JointKind}
        curves = {kind: gait.cycles.get(kind.of(side)) for kind in JointKind}
        for k, reason in enumerate(gait.strides.reason):
            known = {kind: np.rad2deg(found[k]) for kind, found in curves.items() if found is not None}
            lines.append(
                StrideLine(
                    side=side,
                    number=k + 1,
                    start_s=float(gait.strides.start_s[k]),
                    end_s=float(gait.strides.end_s[k]),
                    ranges_deg={kind: float(found[k]) for kind, found in ranges.items()},
                    reason=tr(NAMES["reason"][reason]) if reason else "",
                    is_by_hand=reason is Reason.BY_HAND,
                    shapes_deg={kind: curve for kind, curve in known.items() if np.isfinite(curve).all()},
                )
            )
    return tuple(lines)

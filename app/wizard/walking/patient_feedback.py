"""Joins the patient's screen to a walk: values of the live estimator go to its bar and tone as soon as they
are given.

A value does not wait for the next of the thirty looks a second at the estimator: its thread signals it,
and the screen's thread takes it. What was reached is counted while a walk is recorded, for each target that was set.
"""

import contextlib
from collections import deque
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, Signal, Slot

from app.patient_screen.controls import ControlsCard, choices
from app.patient_screen.metronome import Metronome
from app.patient_screen.patient_view import SHOWN_STRIDES, PatientView
from app.patient_screen.window import PatientWindow
from app.system import sounds
from app.system.sounds import Sound
from app.wording.translation import tr
from app.wording.verdicts import gate_sentence
from core.body import LEG_SEGMENTS, Joint, Segment, Side, Site, knee_of
from core.results import JointCalibration
from core.targets import Target, TargetMeasure, TargetTally, shown_value
from core.verdicts.live_targets import assess_target

if TYPE_CHECKING:
    from app.wizard.visit import Visit
    from app.wizard.walking.estimator import WalkingEstimator
    from app.wizard.walking.readout import WalkingReadout


class PatientFeedback(QObject):
    """`run_requested`: Space was pressed on the patient's screen."""

    run_requested = Signal()
    _news = Signal()

    def __init__(self, visit: "Visit", controls: ControlsCard, parent: QObject) -> None:
        super().__init__(parent)
        self._visit, self._controls = visit, controls
        self.window: PatientWindow | None = None
        self.target: Target | None = None
        self.metronome = Metronome(self)
        self._estimator: WalkingEstimator | None = None
        self._seen = 0  # of the estimator's values
        self._last: deque[int] = deque(maxlen=SHOWN_STRIDES)
        self._is_waiting = False
        self._steps: int | None = None  # of the walk that goes on
        self._counted: dict[Target, TargetTally] | None = None  # while a walk is recorded
        self._news.connect(self._on_news, Qt.ConnectionType.QueuedConnection)
        controls.target_set.connect(self._on_target_set)
        controls.metronome_pressed.connect(self._on_metronome_pressed)
        controls.full.clicked.connect(self.toggle_full_screen)
        controls.close_screen.clicked.connect(self.close)
        self.metronome.changed.connect(self._on_metronome_changed)
        controls.setVisible(False)

    @property
    def is_open(self) -> bool:
        return self.window is not None

    @property
    def view(self) -> PatientView:
        """What the patient is shown."""
        return PatientView(self.target, tuple(self._last), self._is_waiting, sounds.is_on(), self._steps)

    def toggle(self) -> None:
        """Open the patient's screen, with its controls on the page; or close both."""
        if self.is_open:
            self.close()
            return
        self.show_reasons()
        window = self.window = PatientWindow()
        window.closed.connect(self.close)
        window.run_requested.connect(self.run_requested)
        self._controls.setVisible(True)
        self._controls.focus()
        window.show_view(self.view)
        window.open_beside(self._controls.window())

    @Slot()
    def close(self) -> None:
        """Close the patient's screen and its controls; the metronome falls silent. The target stays."""
        window, self.window = self.window, None
        self.metronome.stop()
        if window is not None:
            window.close()
            window.deleteLater()
            self._controls.setVisible(False)

    @Slot()
    def toggle_full_screen(self) -> None:
        if self.window is not None:
            self.window.toggle_full_screen()

    def watch(self, estimator: "WalkingEstimator | None") -> None:
        """Take values from here on from `estimator`, which begins to count them again."""
        if self._estimator is not None:
            self._estimator.on_value = None
        self._estimator, self._seen = estimator, 0
        if estimator is not None:
            estimator.on_value = self._show_news
        self.show_reasons()

    def begin_walk(self) -> None:
        """Count from here on, and show the strides of this walk only."""
        self._counted = {}
        worn = self._visit.sensors.site_of.values()
        self._steps = 0 if any(site.segment is Segment.FOOT for site in worn) else None  # else nothing counts them
        self._last.clear()
        self._show()

    def end_walk(self) -> tuple[TargetTally, ...]:
        """How often each target of this walk was reached; none where no walk was begun."""
        counted, self._counted = self._counted or {}, None
        self._steps = None
        self._show()
        return tuple(counted.values())

    def count(self, strides: Mapping[Side, int]) -> None:
        """Show how many steps were counted of the walk that goes on, as the operator sees them."""
        if self._steps is not None and strides:
            self._steps = max(strides.values())
            self._show()

    def show_reasons(self) -> None:
        """Judge again what can be a target; what no longer can is none from here on."""
        sensors = self._visit.sensors
        rested = {site for sensor, site in sensors.site_of.items() if sensor in self._visit.rests}
        reasons = reasons_against(
            tuple(sensors.sensor_at), rested, self._visit.calibration, self._visit.prosthetic_sides
        )
        self._controls.show_reasons(reasons)

    def judge(self, view: "WalkingReadout") -> None:
        """Look whether what is aimed at can be measured at this moment."""
        is_waiting = self.target is not None and _is_gated(self.target, view, self._visit.sensors.site_of.values())
        if is_waiting != self._is_waiting:
            self._is_waiting = is_waiting
            self._last.clear()  # a slip is found later than it happens, so what came before is in doubt too
        self._show()

    def _show_news(self) -> None:
        """Called by the estimator's thread."""
        with contextlib.suppress(RuntimeError):  # the visit was closed meanwhile
            self._news.emit()

    @Slot()
    def _on_news(self) -> None:
        if self._estimator is None:
            return
        state = self._estimator.state
        new, self._seen = state.values_reported - self._seen, state.values_reported
        if not self.is_open or self.target is None or new <= 0:
            return
        self.judge(state)
        required = self.target.measure, self.target.side
        for one in state.stride_values[-new:]:
            if (one.measure, one.side if one.measure.has_side else None) == required and not self._is_waiting:
                self._take(self.target, shown_value(one.value))
        self._show()

    def _take(self, target: Target, shown: int) -> None:
        self._last.append(shown)
        is_reached = target.is_reached(shown)
        if is_reached:
            sounds.play(Sound.REACHED)
        if self._counted is not None:
            so_far = self._counted.get(target, TargetTally(target, 0, 0))
            self._counted[target] = replace(so_far, reached=so_far.reached + is_reached, strides=so_far.strides + 1)

    def _show(self) -> None:
        if self.window is not None:
            self.window.show_view(self.view)

    @Slot(object)
    def _on_target_set(self, target: Target | None) -> None:
        if target != self.target:
            self.target = target
            self._last.clear()
            self._is_waiting = False
            self._show()

    @Slot(int)
    def _on_metronome_pressed(self, beats_per_min: int) -> None:
        if beats_per_min:
            self.metronome.start(beats_per_min)
        else:
            self.metronome.stop()

    @Slot()
    def _on_metronome_changed(self) -> None:
        self._controls.show_metronome(self.metronome.beats_per_min)


def reasons_against(
    worn: tuple[Site, ...],
    rested: Collection[Site],
    calibration: Mapping[Joint, JointCalibration],
    prosthetic_sides: frozenset[Side],
) -> dict[tuple[TargetMeasure, Side | None], str]:
    """Give the reason why each measure cannot be a target; `rested`: sites whose sensor's bias is known."""
    reasons = {}
    for measure, side in choices():
        found = assess_target(measure, side, worn, calibration, prosthetic_sides)
        if not found.is_reported:
            sentences = [gate_sentence(reason) for reason in found.reasons[:1]]
            reasons[measure, side] = sentences[0] if sentences else _not_measured(measure, side, worn)
        elif measure is TargetMeasure.KNEE_SWING_PEAK and side is not None:
            knee = knee_of(side)
            if not {knee.proximal, knee.distal} <= set(rested):
                reasons[measure, side] = tr(
                    "The sensors of this knee have not been still yet. Let the patient stand still first."
                )
    return reasons


def _not_measured(measure: TargetMeasure, side: Side | None, worn: tuple[Site, ...]) -> str:
    feet = {site.side for site in worn if site.segment is Segment.FOOT}
    if measure in (TargetMeasure.CADENCE, TargetMeasure.STANCE_RATIO) and not feet:
        return tr("There is no foot sensor.")
    if measure is TargetMeasure.STANCE_RATIO:
        return tr("Both feet need a sensor.")
    if side not in feet:
        return tr("This foot has no sensor.")
    return tr("The knee angle is not known yet. It needs sensors on thigh and shank, and a free motion.")


def _is_gated(target: Target, view: "WalkingReadout", worn: Collection[Site]) -> bool:
    """Whether a slipped strap, a silent sensor, a doubtful foot or an implausible angle makes the target unmeasured."""
    slipped = {slip.site for slip in view.slips}
    doubtful = slipped | set(view.missing) | set(view.doubtful)
    feet = {Site(f"{side}_{Segment.FOOT}") for side in Side}
    if target.side is None:
        received = {site for site in feet if site in worn} - doubtful
        return not received
    if target.measure is TargetMeasure.KNEE_SWING_PEAK:
        is_silent = bool(doubtful & {Site(f"{target.side}_{segment}") for segment in LEG_SEGMENTS})
        return is_silent or knee_of(target.side) in view.implausible
    if target.measure is TargetMeasure.FOOT_STRIKE:
        return Site(f"{target.side}_{Segment.FOOT}") in doubtful
    return bool(doubtful & feet)

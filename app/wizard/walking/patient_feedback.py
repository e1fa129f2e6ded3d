"""Joins the patient's screen to a walk: values of the live estimator go to its bar and tone as soon as they
are given.

A value does not wait for the next of the thirty looks a second at the estimator: its thread signals it,
and the screen's thread takes it. What was reached is counted while a walk is recorded, for each target that was set.
"""

import contextlib
import math
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, QTimer, Signal, Slot

from app.patient_screen.controls import Choice, ControlsCard, choice_words
from app.patient_screen.metronome import Metronome
from app.patient_screen.patient_view import SHOWN_STRIDES, PatientView
from app.patient_screen.window import PatientWindow, Placing
from app.system import sounds
from app.system.sounds import Sound
from app.wizard.losses import NOTHING, Message
from app.wizard.walking.patient_status import hindrance, is_standing, reasons_against, status_of
from app.wording.translation import tr
from core.body import Segment, Side
from core.targets import Target, TargetTally, shown_value

if TYPE_CHECKING:
    from app.wizard.visit import Visit
    from app.wizard.walking.estimator import WalkingEstimator
    from app.wizard.walking.readout import WalkingReadout


LOOK_MS = 100


class PatientFeedback(QObject):
    """`run_requested`: Space was pressed on the patient's screen.

    Parameters
    ----------
    look
        Gives what the estimator gives now; None where none works.
    """

    run_requested = Signal()
    _news = Signal()

    def __init__(
        self,
        visit: "Visit",
        controls: ControlsCard,
        parent: QObject,
        look: "Callable[[], WalkingReadout | None]" = lambda: None,
    ) -> None:
        super().__init__(parent)
        self._visit, self._controls, self._look_now = visit, controls, look
        self._placing = Placing()
        self.window: PatientWindow | None = None
        self.target: Target | None = None
        self.metronome = Metronome(self)
        self._estimator: WalkingEstimator | None = None
        self._seen = 0  # of the estimator's values
        self._last: deque[int] = deque(maxlen=SHOWN_STRIDES)
        self._has_tone = True
        self._is_waiting = self._is_standing = False
        self._hindered: Message = NOTHING
        self._lost: Choice | None = None  # what was aimed at, and can no longer be
        self._timer = QTimer(self)  # its own: pages over the wizard stop that one's, and the patient looks on
        self._timer.setInterval(LOOK_MS)
        self._timer.timeout.connect(self.look)
        self._steps: int | None = None  # of the walk that goes on
        self._counted: dict[Target, TargetTally] | None = None  # while a walk is recorded
        self._news.connect(self._on_news, Qt.ConnectionType.QueuedConnection)
        controls.target_set.connect(self._on_target_set)
        controls.tone_set.connect(self._on_tone_set)
        controls.metronome_pressed.connect(self._on_metronome_pressed)
        controls.full.clicked.connect(self.toggle_full_screen)
        controls.close_screen.clicked.connect(self.close)
        self.metronome.changed.connect(self._on_metronome_changed)
        controls.offer(False)

    @property
    def is_open(self) -> bool:
        return self.window is not None

    @property
    def view(self) -> PatientView:
        """What the patient is shown."""
        has_sound = self._has_tone and sounds.is_on() and sounds.has_output()
        return PatientView(self.target, tuple(self._last), self._is_waiting, has_sound, self._steps, self._is_standing)

    def toggle(self) -> None:
        """Open the patient's screen, with its controls on the page; or close both."""
        if self.is_open:
            self.close()
            return
        self.show_reasons()
        window = self.window = PatientWindow(self._placing)
        window.closed.connect(self.close)
        window.run_requested.connect(self.run_requested)
        self._controls.offer(True)
        self._controls.focus()
        self.look()
        window.placed.connect(self._controls.show_full)
        window.open_beside(self._controls.window())
        self._timer.start()

    @Slot()
    def close(self) -> None:
        """Close the patient's screen and its controls; the metronome falls silent. The target stays."""
        window, self.window = self.window, None
        self.metronome.stop()
        self._timer.stop()
        if window is not None:
            window.close()
            window.deleteLater()
            self._controls.offer(False)

    @Slot()
    def toggle_full_screen(self) -> None:
        if self.window is None:
            self._placing.ask_for_full()
            self.toggle()
        else:
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
        was = self.target
        self._controls.show_reasons(reasons)
        if was is not None and self.target is None and (was.measure, was.side) in reasons:
            self._lost, self._is_waiting = (was.measure, was.side), True
        elif self._lost is not None and self._lost not in reasons:
            self._lost, self._is_waiting = None, False

    @Slot()
    def look(self) -> None:
        """Look what can be measured at this moment, and say it to the patient and to the clinician."""
        view = self._look_now()
        if view is not None and not math.isnan(view.now_s):
            self.judge(view)
        self._show()
        self._show_status(view)

    def judge(self, view: "WalkingReadout") -> None:
        """Look whether what is aimed at can be measured at this moment, and whether the patient is standing."""
        self._is_standing = is_standing(view)
        if self.target is None:
            return
        self._hindered = hindrance(self.target, view, self._visit.sensors.site_of.values())
        is_waiting = self._hindered != NOTHING
        if is_waiting != self._is_waiting:
            self._is_waiting = is_waiting
            self._last.clear()  # a slip is found later than it happens, so what came before is in doubt too

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
        if is_reached and self._has_tone:
            sounds.play(Sound.REACHED)
        if self._counted is not None:
            so_far = self._counted.get(target, TargetTally(target, 0, 0))
            self._counted[target] = replace(so_far, reached=so_far.reached + is_reached, strides=so_far.strides + 1)

    def _show(self) -> None:
        if self.window is not None:
            self.window.show_view(self.view)

    def _show_status(self, view: "WalkingReadout | None") -> None:
        """Say to the clinician what the patient sees, or why it is nothing."""
        if self._visit.sensors.are_in_memory:
            what = tr("The sensors store the walk themselves.")
            then = tr("The patient sees no values. Press Record walks live to show them.")
        elif view is None or math.isnan(view.now_s):
            what, then = tr("No sensor data."), tr("Values appear when the sensors are connected.")
        elif self._controls.reason:
            what, then = tr("This movement cannot be a target now."), ""
        elif self._lost is not None:
            what = tr("{movement}: no longer a target.").format(movement=choice_words(self._lost))
            then = tr("The patient is asked to wait. Choose another movement, or type a target again.")
        else:
            what, then = status_of(self.view, self._hindered, is_recording=self._counted is not None)
        is_hindered = self._hindered != NOTHING and self._counted is not None
        self._controls.show_status(what, then, is_caution=is_hindered or self._lost is not None)
        self._controls.show_sound(*self._sound_message())

    def _sound_message(self) -> Message:
        if not (self._has_tone or self.metronome.beats_per_min):
            return NOTHING
        if not sounds.is_on():
            return tr("Sounds are off."), tr("Turn them on in Settings, or with the bell while a walk is recorded.")
        if self.metronome.is_silent or not sounds.has_output():
            what = tr("No sound output was found.")
            return what, tr("Tone and metronome are silent. Connect a loudspeaker, then restart Gaitwright.")
        return NOTHING

    @Slot(object)
    def _on_target_set(self, target: Target | None) -> None:
        if target != self.target:
            self.target = target
            self._last.clear()
            self._is_waiting, self._hindered, self._lost = False, NOTHING, None
            self.look()

    @Slot(bool)
    def _on_tone_set(self, has_tone: bool) -> None:
        self._has_tone = has_tone
        self.look()

    @Slot(int)
    def _on_metronome_pressed(self, beats_per_min: int) -> None:
        if beats_per_min:
            self.metronome.start(beats_per_min)
        else:
            self.metronome.stop()

    @Slot()
    def _on_metronome_changed(self) -> None:
        self._controls.show_metronome(self.metronome.beats_per_min)
        self.look()

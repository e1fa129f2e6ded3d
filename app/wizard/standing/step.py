"""Three seconds of standing: each sensor's bias, and the angles of the patient in standing."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer

from app.editing.session_recording import SessionRecording
from app.system import sounds
from app.system.prompts import prompter
from app.system.sounds import Sound
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.rail_row import StepState
from app.wizard.keys import Intent, KeyAction
from app.wizard.standing.estimator import StandingEstimator
from app.wizard.standing.page import StandPhase, StandStillPage, StandStillView
from app.wizard.step import Step, StepId
from app.wording.translation import tr
from core.body import LEG_JOINTS, Joint, Site
from core.live.standing import REQUIRED_S
from core.session import RecordingKind

if TYPE_CHECKING:
    from app.wizard.visit import Visit

SHOWN_MS = 600  # the check mark, before the next step comes by itself
TICKS = 3  # of 30 Hz: ten looks a second
SLACK_S = 0.1


class StandStillStep(Step):
    """The movement is shown from the first moment; the count and its recording begin at a word."""

    id = StepId.STAND_STILL

    def __init__(self, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(visit, parent)
        self._page: StandStillPage | None = None
        self._estimator: StandingEstimator | None = None
        self._phase = StandPhase.READY
        self._moved: tuple[str, ...] = ()
        self._received = 0  # the second that was sounded last
        self._ticks = 0
        self._is_entered = False
        self._shown_zero: dict[Joint, float] = {}  # as the page has it
        self._shown = QTimer(self)
        self._shown.setSingleShot(True)
        self._shown.setInterval(SHOWN_MS)
        self._shown.timeout.connect(self._go_on)
        visit.recordings.begun.connect(self._on_begun)
        visit.recordings.ended.connect(self._on_ended)
        visit.recordings.refused.connect(self._on_refused)
        visit.changed.connect(self._on_visit_changed)

    @property
    def page(self) -> StandStillPage:
        if self._page is None:
            self._page = StandStillPage()
            self._page.zero.edited.connect(self._on_zero_edited)
            self._page.cannot_stand_pressed.connect(self._on_cannot_stand)
            self._page.can_stand_pressed.connect(self._on_can_stand)
        return self._page

    @property
    def title(self) -> str:
        return tr("Stand still")

    @property
    def note(self) -> str:
        if self._visit.has_skipped_standing:
            return tr("skipped, reported")
        if not self._has_stood:
            return ""
        stated = (
            tr("{seconds:.1f} s, reference set") if self._visit.recordings.standing is not None else tr("being loaded")
        )
        return stated.format(seconds=self._stood_s)

    @property
    def state(self) -> StepState:
        if self._visit.has_skipped_standing:
            return StepState.SKIPPED
        is_read = self._has_stood and self._visit.recordings.standing is not None
        return StepState.DONE if is_read else StepState.TODO

    @property
    def cannot_enter(self) -> str:
        return self._visit.cannot_calibrate

    @property
    def topic(self) -> str:
        return "stand-still"

    def enter(self) -> None:
        self._is_entered = True
        self._phase = self._settled_phase()
        if self._phase is StandPhase.READY:
            prompter.speak("stand-still")
        self._watch()
        self._show_zero()
        self._show()

    def _show_zero(self) -> None:
        zero = self._shown_zero = dict(self._visit.details.zero_rad)
        joints = list(LEG_JOINTS) if self._visit.sensors.is_left_to_motion else self._visit.sensors.joints
        self.page.zero.show_zero({joint: math.degrees(zero.get(joint, 0.0)) for joint in joints})

    def leave(self) -> None:
        self._is_entered = False
        prompter.end()
        self._shown.stop()
        if self._is_recording:  # not to its end
            self._visit.recordings.stop(is_kept=False)
        if (acquisition := self._visit.sensors.acquisition) is not None:
            acquisition.set_estimator(None)
        self._estimator = None

    def tick(self) -> None:
        self._ticks += 1
        if self._ticks % TICKS == 0 and self._estimator is not None:
            standing = self._estimator.state.standing
            self._moved = standing.moved or self._moved
            self._sound(standing.required_s - standing.still_s)
            is_counting = self._phase is StandPhase.COUNTING
            if is_counting and standing.is_done and self._is_recording and self._visit.recordings.has_begun:
                self._finish()
            self._show()

    def bar(self) -> BarState:
        space, enter = tr("Space"), tr("Enter")
        again = BarAction(tr("Restart countdown"), self._start, space, Icon.REPEAT, is_requested=False)
        go_on = BarAction(tr("Continue to free motion"), self._go_on, enter, Icon.NEXT)
        if self._phase is StandPhase.COUNTING:
            return BarState(primary=again, note=tr("Continues automatically when done."))
        if self._phase is StandPhase.DONE:
            return BarState(primary=go_on, others=(again,))
        if self._phase is StandPhase.SKIPPED:
            return BarState(primary=go_on)
        return BarState(primary=BarAction(tr("Start countdown"), self._start, space, Icon.PLAY))

    def on_intent(self, intent: Intent) -> bool:
        if intent.action is not KeyAction.RUN or self._phase is StandPhase.SKIPPED:
            return False
        self._start()
        return True

    # what happens

    @property
    def _is_recording(self) -> bool:
        ongoing = self._visit.recordings.ongoing
        return ongoing is not None and ongoing.details.kind is RecordingKind.STANDING

    @property
    def _has_stood(self) -> bool:
        """For as long as it takes, and recorded: what a crash cut short was recovered, and is not enough."""
        recordings = self._visit.recordings
        is_kept = recordings.standing is not None or recordings.awaits(RecordingKind.STANDING)
        return is_kept and self._stood_s > REQUIRED_S - SLACK_S and not recordings.is_restrapped

    @property
    def _stood_s(self) -> float:
        return min((rest.duration_s for rest in self._visit.rests.values()), default=0.0)

    def _settled_phase(self) -> StandPhase:
        if self._visit.has_skipped_standing:
            return StandPhase.SKIPPED
        return StandPhase.DONE if self._has_stood else StandPhase.READY

    def _start(self) -> None:
        """Begin to count, again if need be; what is being recorded goes on."""
        acquisition, recordings = self._visit.sensors.acquisition, self._visit.recordings
        if acquisition is None or self._visit.session is None or recordings.is_stopping:
            return
        if recordings.is_recording and not self._is_recording:
            return  # what another step began is still being closed
        self._shown.stop()
        self._phase = StandPhase.COUNTING
        self._watch()
        if not recordings.is_recording:
            acquisition.ask(RecordingKind.STANDING)
            recordings.begin(acquisition, RecordingKind.STANDING)
        self._show()
        self.changed.emit()

    def _sound(self, left_s: float) -> None:
        """Play a sound for each second of the count."""
        left = math.ceil(left_s)
        if self._phase is StandPhase.COUNTING and self._is_recording and left != self._received:
            self._received = left
            sounds.play(Sound.COUNT)

    def _watch(self) -> None:
        """Look at the movement from now on."""
        self._moved = ()
        acquisition = self._visit.sensors.acquisition
        if acquisition is not None:
            site_of = self._visit.sensors.site_of
            pelvis = frozenset(name for name, site in site_of.items() if site is Site.PELVIS)
            self._estimator = StandingEstimator(site_of or acquisition.sensors, optional=pelvis)
            acquisition.set_estimator(self._estimator)

    def _finish(self) -> None:
        """Three seconds are in the journal."""
        assert self._estimator is not None
        self._visit.rests = dict(self._estimator.state.standing.rest)
        self._phase = StandPhase.DONE
        self._visit.recordings.stop()
        sounds.play(Sound.READY)
        self._shown.start()
        self.changed.emit()

    def _go_on(self) -> None:
        if self._phase in (StandPhase.DONE, StandPhase.SKIPPED) and not self._visit.recordings.is_recording:
            self._shown.stop()
            self.done.emit()

    def _show(self) -> None:
        estimator, site_of = self._estimator, self._visit.sensors.site_of
        if estimator is None or self._page is None:
            return
        standing = estimator.state.standing

        def placed(sensors: tuple[str, ...]) -> tuple[str, ...]:
            return tuple(site_of.get(sensor, sensor) for sensor in sensors)

        is_counting = self._phase is StandPhase.COUNTING
        self._page.show_state(
            StandStillView(
                phase=self._phase,
                still_s=self._stood_s if self._phase is StandPhase.DONE else standing.still_s,
                required_s=standing.required_s,
                movement_deg_s={
                    site_of.get(name, name): value for name, value in estimator.state.movement_deg_s.items()
                },
                moved=placed(self._moved),
                silent=placed(standing.silent),
                restarts=standing.restarts if is_counting else 0,
                is_read_back=self._visit.recordings.standing is not None,
            )
        )

    # slots

    def _on_begun(self) -> None:
        if self._is_recording and self._is_entered:  # one that was left before it had begun ends at once
            self._watch()  # only what is recorded counts

    def _on_ended(self, recording: SessionRecording) -> None:
        if recording.details.kind is not RecordingKind.STANDING:
            return
        if self._phase is StandPhase.DONE and not self._shown.isActive() and self._estimator is not None:
            self._go_on()  # the check mark has been seen while the journal was closed
        self.changed.emit()

    def _on_refused(self, _what: str, _remedy: str) -> None:
        is_given_up = self._phase is StandPhase.DONE and not self._has_stood
        if is_given_up or (self._phase is StandPhase.COUNTING and not self._is_recording):
            self._shown.stop()
            self._phase = self._settled_phase()
            self._show()
            self.changed.emit()

    def _on_zero_edited(self, joint: Joint, degrees: float | None) -> None:
        self._visit.record.set_zero(joint, math.radians(degrees) if degrees else None)
        self._shown_zero = dict(self._visit.details.zero_rad)

    def _on_visit_changed(self) -> None:
        """Show what another station read off the goniometer, so that nobody types over what was not seen."""
        if self._is_entered and self._visit.details.zero_rad != self._shown_zero:
            self._show_zero()

    def _on_cannot_stand(self) -> None:
        """No zero: a standing that was kept does not count either."""
        self._visit.record.set_limits(replace(self._visit.record.limits, cannot_stand=True))
        self._phase = StandPhase.SKIPPED
        if self._is_recording:
            self._visit.recordings.stop(is_kept=False)
        if (standing := self._visit.recordings.standing) is not None:
            self._visit.recordings.keep(standing, is_kept=False)
        self._visit.rests = {}
        self._show()
        self.changed.emit()

    def _on_can_stand(self) -> None:
        self._visit.record.set_limits(replace(self._visit.record.limits, cannot_stand=False))
        self._phase = StandPhase.READY
        self._watch()
        self._show()
        self.changed.emit()

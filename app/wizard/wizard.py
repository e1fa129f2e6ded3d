"""The wizard: seven steps, one at a time, jumped between at will, and what is always in sight round them."""

import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Protocol, runtime_checkable
from uuid import UUID

from PySide6.QtCore import QTimer, Signal, SignalInstance
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.editing.question import EditQuestion
from app.system import sounds
from app.system.prompts import prompter
from app.system.settings import Settings
from app.theme.current import grow
from app.widgets.action_bar import BarAction, BarState
from app.widgets.rail_row import RailRow, StepState
from app.wizard.asked_edits import AskedEdits
from app.wizard.free_motion.step import FreeMotionStep
from app.wizard.keys import Intent, KeyAction, Keys
from app.wizard.losses import NOTHING, Message
from app.wizard.patient.step import PatientStep
from app.wizard.report.step import ReportStep
from app.wizard.results.step import ResultsStep
from app.wizard.sensors.sources import choices
from app.wizard.sensors.step import SensorsStep
from app.wizard.shell import StripMode, WizardShell
from app.wizard.standing.step import StandStillStep
from app.wizard.step import Step, StepId
from app.wizard.visit import DEMO, Visit
from app.wizard.walking.step import WalkingStep
from app.wizard.worn_tiles import worn_tiles
from app.wording.patients import about_and_device
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from app.workers.preload import is_preloaded
from core.session import Patient

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.storage.stored import StoredPatient

TICK_MS = 33
PREPARE_MS = 400  # between one page that is made ahead and the next: what the user does comes first
DEAF_S = 0.4  # after a page turned by itself; a hand that was on its way arrives, one that answers takes longer
SLOW_TICKS = 8  # tiles and stopwatch: four times a second
DEMO_PATIENT = f"{DEMO}-1"


@runtime_checkable
class TurningPage(Protocol):
    """A page with a figure of the patient."""

    def set_from_behind(self, is_from_behind: bool) -> None: ...


class Wizard(QWidget):
    """One visit at a time; beginning another closes the one before."""

    left = Signal()
    help_required = Signal(str)
    settings_required = Signal()

    def __init__(self, controller: LibraryController, settings: Settings) -> None:
        super().__init__()
        self._controller, self._settings = controller, settings
        self._visit: Visit | None = None
        self._demonstration: Visit | None = None  # that waits for its patient
        self._closing: list[Visit] = []  # their threads end by themselves
        self._steps: dict[StepId, Step] = {}
        self._current = self._offering = StepId.PATIENT  # `_offering`: whose offer to undo the toast shows
        self._ticks = 0
        self._is_for_report = False  # as soon as what is resumed is there
        self._to_resume: UUID | None = None  # a session that waits for what visits before still save
        self._deaf_until_s = 0.0
        self._reported_of_recording: Message = NOTHING
        self.shell = WizardShell()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.shell)
        self.asked = AskedEdits(self, self._may_ask)
        self._keys = Keys(self, lambda: self.shell.bar.keys)
        self._timer = QTimer(self)
        self._timer.setInterval(TICK_MS)
        self._to_prepare: list[Step] = []
        self._preparing = QTimer(self)
        self._preparing.setInterval(PREPARE_MS)
        self._connect()

    @property
    def visit(self) -> Visit | None:
        return self._visit

    @property
    def current(self) -> Step | None:
        return self._steps[self._current] if self._steps else None

    @property
    def step_id(self) -> StepId:
        """Of the step that is in sight."""
        return self._current

    @property
    def steps(self) -> Mapping[StepId, Step]:
        """All of the visit, in their order; none while there is no visit."""
        return self._steps

    @property
    def to_prepare(self) -> tuple[Step, ...]:
        """Steps whose pages are still to be made ahead."""
        return tuple(self._to_prepare)

    @property
    def is_recording(self) -> bool:
        return self._visit is not None and self._visit.recordings.is_recording

    def begin(self, patient: "StoredPatient | None") -> None:
        """Begin a session, with a patient of the library or one that is still to be typed."""
        visit = self._begin_visit()
        self.shell.banner.hide()
        visit.begin_stopwatch()
        if patient is not None:
            visit.patient.choose_from_list(patient)
        self._go_to(StepId.PATIENT)

    def show_session(self, session_id: UUID, *, is_for_report: bool = False) -> None:
        """Show a session's results, or resume it where there are none yet; `is_for_report`: go to the report."""
        self._begin_visit()
        self._to_resume, self._is_for_report = session_id, is_for_report
        self._on_resume_due()

    def _on_resume_due(self) -> None:
        """Take up the session once what was entered in visits before is saved, else that would seem to be another's."""
        if self._to_resume is not None and self._visit is not None and not any(one.is_saving for one in self._closing):
            session_id, self._to_resume = self._to_resume, None
            self._visit.resume(session_id)

    def look_for_changes(self) -> None:
        """Find out whether another station changed the session that is in sight, and say so."""
        if self._visit is not None:
            self._visit.look_for_changes()

    def close_visit(self) -> None:
        """Let go of sensors and visit; what was recorded is in the library."""
        self._timer.stop()
        self._preparing.stop()
        self._to_resume = None
        self._forget_closed()
        if self._visit is not None:
            if self._steps:
                self._steps[self._current].leave()
            self._listen_no_more(self._visit)
            self._visit.close()
            self._closing.append(self._visit)
        for step in self._steps.values():
            step.deleteLater()
        self._visit, self._demonstration, self._steps, self._to_prepare = None, None, {}, []
        self.shell.clear_pages()

    def _forget_closed(self) -> None:
        """Let go of earlier visits, with their samples, as far as nothing of them runs any more."""
        for visit in tuple(self._closing):
            if visit.is_idle:
                visit.finish()  # waits for nothing
                self._closing.remove(visit)
                visit.deleteLater()

    def finish(self) -> None:
        """Close the visit and wait for its threads: for the end of the program."""
        self.asked.forget()
        self.close_visit()
        for visit in self._closing:
            visit.finish()

    def _connect(self) -> None:
        shell = self.shell
        shell.rail.step_pressed.connect(self._on_rail_pressed)
        shell.rail.below_pressed.connect(self._on_below_pressed)
        shell.bar.back_pressed.connect(self._on_back)
        shell.bar.pressed.connect(self._on_bar_pressed)
        shell.bar.sound_pressed.connect(self._on_sound_pressed)
        shell.toast.undone.connect(self._on_offer_undone)
        shell.banner.acted.connect(self._on_new_state_requested)
        shell.room_changed.connect(self._on_room_changed)
        self._keys.pressed.connect(self.act_on)
        self._keys.bar_pressed.connect(shell.bar.press)
        self._timer.timeout.connect(self._on_tick)
        self._timer.timeout.connect(self._on_resume_due)
        self._preparing.timeout.connect(self._on_prepare)
        self._settings.changed.connect(self._on_settings_changed)
        self._on_settings_changed()

    def _begin_visit(self) -> Visit:
        self.close_visit()
        visit = Visit(self._controller, choices(), self)
        self._visit = visit
        visit.source_before = self._settings.latest_source
        steps = (
            PatientStep(visit, self),
            SensorsStep(visit, self),
            StandStillStep(visit, self),
            FreeMotionStep(visit, self),
            WalkingStep(visit, self),
            ResultsStep(visit, self),
            ReportStep(visit, self._controller, self),
        )
        self._steps = {step.id: step for step in steps}
        for step in steps:
            step.changed.connect(self._show)
            step.done.connect(self._on_step_done)
            step.jumped.connect(self.go_to)
            step.reported.connect(self._show_message)
            step.offered.connect(self._on_offered)
            step.demonstration_required.connect(self._on_demonstration_required)
        for signal, slot in self._connections_of(visit):
            signal.connect(slot)
        visit.asked.connect(self._on_asked)
        self._current = StepId.PATIENT
        self._timer.start()
        self._to_prepare = [*steps]
        self._preparing.start()
        return visit

    def _connections_of(self, visit: Visit) -> "list[tuple[SignalInstance, Callable[..., object]]]":
        """Signals of a visit that are followed while it is in sight, with their slots, in the order of connecting."""
        changes = (visit.changed, visit.sensors.changed, visit.patient.changed, visit.evaluation.done)
        return [
            (visit.sensors.opened, self._on_source_opened),
            *((signal, self._on_visit_changed) for signal in changes),
            (visit.resumed, self._on_resumed),
            (visit.changed_elsewhere, self._on_changed_elsewhere),
            (visit.deleted_elsewhere, self._show_message),
            (visit.refused, self._on_refused),
            (visit.merged, self._show_message),
            (visit.recordings.troubled, self._on_troubled),
            (visit.recordings.begun, self.shell.banner.hide),
        ]

    def _listen_no_more(self, visit: Visit) -> None:
        """What comes of a visit that was left is not the next one's; a refusal is shown where one is then."""
        for signal, slot in self._connections_of(visit):
            signal.disconnect(slot)
        for signal in (visit.refused, visit.merged):
            signal.connect(self._controller.refused)

    def go_to(self, goal: StepId) -> None:
        """Go to a step, if it can be entered and the current one left; else say why not."""
        if not self._steps or goal is self._current:
            return
        if reason := self._steps[self._current].cannot_leave or self._steps[goal].cannot_enter:
            self._show_message(reason, "")
            return
        self.shell.begin_fade()
        self.shell.banner.hide()
        self._steps[self._current].leave()  # which may have something to say over the next
        self._go_to(goal)

    def _go_to(self, goal: StepId) -> None:
        step = self._steps[goal]
        self._current = goal
        self._turn(step.page)
        self.shell.show_page(goal, step.page)
        step.enter()
        self._show()

    def _show(self) -> None:
        """Show what surrounds the step: rail, header, bar."""
        if self._visit is None or not self._steps:
            return
        rows = []
        for step in self._steps.values():
            state = StepState.CURRENT if step.id is self._current else step.state
            rows.append(RailRow(step.title, step.note, state))
        self.shell.rail.show_rows(tuple(rows))
        folds = self._steps[self._current].folds_sensors
        self.shell.set_strip_mode(StripMode.FOLDED if folds else _STRIP[self._current])
        self.shell.bar.show_state(self._bar())
        self._keys.set_running(self.is_recording)
        self._keys.set_clicker(self._steps[self._current].takes_clicker)
        patient = self._visit.patient.details
        self.shell.header.show_session(
            patient.code or tr("New session"), about_and_device(patient), self._visit.is_simulated
        )
        self._show_slow()

    def _bar(self) -> BarState:
        return self._steps[self._current].bar()

    def _show_slow(self) -> None:
        visit = self._visit
        if visit is None:
            return
        self.shell.header.show_elapsed(visit.elapsed_s)
        self.shell.strip.show_tiles(worn_tiles(visit.sensors))

    def _show_message(self, what: str, then: str) -> None:
        if what:
            self.shell.banner.show_message(what, then)
        else:
            self.shell.banner.hide()

    def _on_tick(self) -> None:
        if not self._steps or not self.isVisible():
            return
        self._steps[self._current].tick()
        self._ticks += 1
        if self._ticks % SLOW_TICKS == 0:
            self._show_slow()
            if self.is_recording:
                self.shell.bar.show_state(self._bar())
            self._watch_recording()

    def _watch_recording(self) -> None:
        """Say what befalls a recording, as the counters have it by now; on its page a walk shows it itself."""
        if self._visit is None or not self.is_recording or self._current is StepId.WALKING:
            self._reported_of_recording = NOTHING
            return
        recordings, sensors = self._visit.recordings, self._visit.sensors
        message = recordings.trouble_message()
        if message == NOTHING:
            message = recordings.standstill_message(sensors.site_of or sensors.status)
        if message != self._reported_of_recording:
            self._reported_of_recording = message
            self._show_message(*message)

    def _on_prepare(self) -> None:
        """Make the next page before somebody comes to it, who would wait for it then; not amid a recording."""
        if self.is_recording or not self.isVisible() or not is_preloaded():
            return
        if not self._to_prepare:
            self._preparing.stop()
            return
        step = self._to_prepare[0]
        self.shell.add_page(step.id, step.page)
        if not step.prepare():
            del self._to_prepare[0]

    def escape(self) -> None:
        """Go back from what the step shows in place of its page; the window has this key for itself."""
        self.act_on(Intent(KeyAction.LEAVE))

    def act_on(self, intent: Intent) -> None:
        """Do what a key asks for: the step that is in sight is asked first."""
        if not self._steps or (intent.action in (KeyAction.RUN, KeyAction.PRIMARY) and self._has_just_turned()):
            return
        step = self._steps[self._current]
        if step.on_intent(intent):
            return
        match intent.action:
            case KeyAction.STEP:
                self.go_to(StepId(intent.number))
            case KeyAction.PRIMARY:
                self.press_primary()
            case KeyAction.BACK:
                self._on_back()
            case KeyAction.NEXT_REGION:
                self.shell.focus_next_region(1)
            case KeyAction.PREVIOUS_REGION:
                self.shell.focus_next_region(-1)
            case KeyAction.UNDO:
                self._on_undo()
            case KeyAction.HELP:
                self.help_required.emit(step.topic)
            case KeyAction.PATIENT_SCREEN:
                self._show_message(tr("The patient screen opens in step 5, Walking."), "")
            case KeyAction.LARGER:
                grow(1)
            case KeyAction.SMALLER:
                grow(-1)
            case KeyAction.USUAL_SIZE:
                grow(0)

    def _has_just_turned(self) -> bool:
        """Whether the page turned by itself a moment ago: what is pressed now was meant for the one before."""
        return time.monotonic() < self._deaf_until_s

    def _on_bar_pressed(self, action: BarAction) -> None:
        if not self._has_just_turned():
            action.run()

    def press_primary(self) -> None:
        """Do what the bar's main button names, where it can be pressed."""
        if self._steps and (action := self._bar().primary) is not None and action.is_enabled:
            action.run()

    def _on_rail_pressed(self, number: int) -> None:
        self.go_to([*StepId][number])

    def _on_sound_pressed(self) -> None:
        self._settings.has_sound = not sounds.is_on()
        self.shell.bar.show_state(self._bar())

    def _on_settings_changed(self) -> None:
        sounds.set_on(self._settings.has_sound)
        prompter.is_on = self._settings.has_prompts
        self.shell.strip.set_from_behind(self._settings.is_from_behind)
        if (page := self.shell.page) is not None:
            self._turn(page)

    def _turn(self, page: QWidget) -> None:
        """Show figures as the settings say."""
        if isinstance(page, TurningPage):
            page.set_from_behind(self._settings.is_from_behind)

    def _on_back(self) -> None:
        if self._current is not StepId.PATIENT:
            self.go_to(StepId(self._current.value - 1))
        else:
            self.leave()

    def leave(self) -> None:
        """Go back to the patients; a walk that is being recorded is stopped first, by whoever walks."""
        if self._steps and (reason := self._steps[self._current].cannot_leave):
            self._show_message(reason, "")
            return
        self.close_visit()
        self.left.emit()

    def _on_undo(self) -> None:
        """Take back what the toast offers, else what the current step can."""
        if self.shell.toast.isVisible():
            self.shell.toast.undo()
        elif self._steps:
            self._steps[self._current].undo()

    def _on_offer_undone(self) -> None:
        """Let the step that offered it take it back, though it may be out of sight by now."""
        if self._offering in self._steps:
            self._steps[self._offering].undo()

    def _on_offered(self, what: str) -> None:
        step = self.sender()
        assert isinstance(step, Step)
        self._offering = step.id
        self.shell.toast.offer(what)

    def _on_demonstration_required(self) -> None:
        """Begin again with the patient whom simulated recordings are kept for, found or made."""
        self.begin(None)
        self._demonstration = self._visit
        self._controller.run(_demonstration_patient, self._on_demonstration_found, self._on_refused, self)

    def _on_demonstration_found(self, stored: "StoredPatient | None") -> None:
        visit = self._demonstration
        if visit is None or visit is not self._visit or visit.patient.details.code:
            return  # it was left, or somebody has typed another meanwhile
        if stored is not None:
            visit.patient.choose(stored)
        else:
            visit.patient.edit(Patient(code=DEMO_PATIENT))
        self._steps[StepId.PATIENT].enter()
        self._show()

    def _on_below_pressed(self, key: str) -> None:
        if key == "patients":
            self.leave()
        elif key == "settings":
            self._want_settings()
        elif key == "help" and self.current is not None:
            self.help_required.emit(self.current.topic)

    def _want_settings(self) -> None:
        """The visit stays as it is meanwhile; what is being recorded is watched to its end first."""
        if reason := self.current.cannot_leave if self.current is not None else "":
            self._show_message(reason, "")
        else:
            self.settings_required.emit()

    def _on_step_done(self) -> None:
        if self.sender() is self.current and self._current is not StepId.REPORT:
            ended = {StepId.STAND_STILL, StepId.FREE_MOTION}  # by themselves
            ended |= {StepId.SENSORS} if self._visit is not None and self._visit.placement_before else set()
            if self._current in ended:
                self._deaf_until_s = time.monotonic() + DEAF_S
            self.go_to(StepId(self._current.value + 1))

    def _on_visit_changed(self) -> None:
        self._show()
        self.asked.go_on()

    def _on_source_opened(self) -> None:
        choice = self._visit.sensors.choice if self._visit is not None else None
        if choice is not None:
            self._settings.latest_source = choice.key

    def _on_asked(self, question: EditQuestion) -> None:
        visit = self.sender()
        if isinstance(visit, Visit):  # also one that was left meanwhile
            self.asked.ask(visit, question)

    def _may_ask(self) -> bool:
        return not self.is_recording

    def _on_refused(self, what: str, then: str) -> None:
        if self._visit is not None and self._visit.session is None and self.shell.page is None:
            self.leave()  # the session that was to be shown is not there
            self._controller.refused.emit(what, then)
        else:
            self._show_message(what, then)

    def _on_changed_elsewhere(self) -> None:
        self.shell.banner.show_message(
            tr("Another workstation changed this session."),
            tr("This page shows the earlier version."),
            tr("Show new version"),
        )

    def _on_new_state_requested(self) -> None:
        self.shell.banner.hide()
        if self._visit is not None:
            self._visit.read_again()

    def _on_troubled(self, what: str, then: str) -> None:
        gone_words = self._controller.gone_words
        is_gone_at_rest = not self.is_recording and gone_words == (what, then)
        is_reported_otherwise = gone_words is None and not self.shell.banner.isHidden()
        is_elsewhere = self._current is not StepId.WALKING  # there a walk's page shows it itself
        if is_elsewhere or is_gone_at_rest or is_reported_otherwise:
            self._show_message(what, then)

    def _on_resumed(self) -> None:
        """Land where something is to be answered or seen, else where it goes on."""
        self.shell.banner.hide()
        walks = self._visit.recordings.walks if self._visit is not None else ()
        if not walks:
            self._go_to(StepId.SENSORS)
        else:
            self._go_to(StepId.RESULTS if all(walk.is_decided for walk in walks) else StepId.WALKING)
            if self._is_for_report and self._current is StepId.RESULTS:
                self.go_to(StepId.REPORT)
        self._is_for_report = False

    def _on_room_changed(self, is_compact: bool, width: float, height: float) -> None:
        page = self.current.page if self.current is not None else None
        if page is None:
            return
        if hasattr(page, "set_compact"):
            page.set_compact(is_compact)
        if hasattr(page, "set_room"):
            page.set_room(width, height)


def _demonstration_patient(opened: "OpenedLibrary") -> "StoredPatient | None":
    return opened.library.patients.find(DEMO_PATIENT)


_STRIP = {
    StepId.PATIENT: StripMode.FOLDED,
    StepId.SENSORS: StripMode.HIDDEN,
    StepId.STAND_STILL: StripMode.SHOWN,
    StepId.FREE_MOTION: StripMode.SHOWN,
    StepId.WALKING: StripMode.SHOWN,
    StepId.RESULTS: StripMode.FOLDED,
    StepId.REPORT: StripMode.FOLDED,
}

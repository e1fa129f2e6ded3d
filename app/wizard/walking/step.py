"""Walks under one condition after the other: Space starts and stops, K and D say whether a walk counts."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Slot

from app.live_output.output import live_output
from app.live_output.words import output_words
from app.system import sounds
from app.system.sounds import Sound
from app.widgets.action_bar import BarState
from app.widgets.rail_row import StepState
from app.wizard.keys import Intent, KeyAction
from app.wizard.losses import NOTHING
from app.wizard.step import Step, StepId
from app.wizard.walk_messages import no_foot_message
from app.wizard.walking.bench_control import Bench
from app.wizard.walking.camera_control import CameraControl
from app.wizard.walking.live_preview import LivePreview
from app.wizard.walking.memory_control import MemoryControl
from app.wizard.walking.page import WalkingPage
from app.wizard.walking.patient_feedback import PatientFeedback
from app.wizard.walking.received import received_of, received_rows
from app.wizard.walking.timed_control import TimedControl
from app.wizard.walking.walk_labels import label_after, labels_for, stored_label
from app.wizard.walking.walk_notice import WalkNotice, asked_walk
from app.wizard.walking.walk_rows import facts_of, ongoing_walk, rows_of
from app.wizard.walking.walk_start import WalkStart
from app.wizard.walking.walking_bar import WalkingBar
from app.wording.received import received_clause
from app.wording.recordings import name_in_words
from app.wording.translation import tr
from core.session import RecordingKind
from core.targets import TargetTally, with_tallies

if TYPE_CHECKING:
    from app.editing.session_recording import Ongoing, SessionRecording
    from app.wizard.visit import Visit
    from app.wizard.walking.readout import WalkingReadout

WATCH_TICKS = 3  # of 30 a second: sensors are looked at ten times a second


class WalkingStep(Step):
    id = StepId.WALKING

    def __init__(self, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(visit, parent)
        self._page: WalkingPage | None = None
        self.feedback: PatientFeedback | None = None  # made with the page
        self._tallies: dict[str, tuple[TargetTally, ...]] = {}  # of walks that are still to be read back
        self._at_stop: WalkingReadout | None = None
        self._label = ""
        self._is_in_sight = False
        self._ticks = 0
        self._were_sensors = (False, False, True)  # as `_are_sensors` was when it was looked at last
        self._notice = WalkNotice(visit)
        self._discarded: UUID | None = None
        self._kept: UUID | None = None  # at the bench, and can be taken back
        self._must_restrap = False
        self.bench = Bench(visit, self)
        self._timed = TimedControl(visit, self)
        self.memory = MemoryControl(visit, self)
        self.memory.lives.connect(self._on_lives)
        self.memory.done.connect(self.done)
        self.camera = CameraControl(visit, self)
        for part in (self.bench, self._timed, self.memory, self.camera):
            part.changed.connect(self._show)
        self._preview = LivePreview(visit, self)
        self._preview.renewed.connect(self._timed.watch)
        self._next = WalkStart(visit, self.memory, self._timed)
        visit.recordings.begun.connect(self._on_begun)
        visit.recordings.ended.connect(self._on_ended)
        visit.recordings.changed.connect(self._show)
        visit.recordings.troubled.connect(self._on_troubled)
        visit.evaluation.done.connect(self._on_evaluated)
        visit.evaluation.refused.connect(self._show)

    # the frame of the wizard

    @property
    def page(self) -> WalkingPage:
        if self._page is None:
            page = self._page = WalkingPage(self.bench.entry)
            page.bench.alignments.chosen.connect(self.bench.choose)
            page.bench.alignments.fields.reported.connect(self._on_change_reported)
            page.label_chosen.connect(self._on_label_chosen)
            page.next.test.chosen.connect(self._timed.on_chosen)
            page.next.course.entered.connect(self._on_course_entered)
            page.timed_result.course_entered.connect(self._on_recorded_course_entered)
            page.keep_pressed.connect(self._on_keep_pressed)
            page.discard_pressed.connect(self._on_discard_pressed)
            page.walks.undo_pressed.connect(self._on_keep_pressed)
            page.walks.renamed.connect(self._on_renamed)
            page.walks.restrapped.clicked.connect(self._on_restrapped_pressed)
            page.memory.stop_pressed.connect(self.memory.stop)
            page.camera.turned.connect(self.camera.turn)
            page.camera.agreed.connect(self.camera.agree)
            page.camera.withdrawn.connect(lambda: self.camera.withdraw(page))
            page.camera.camera_chosen.connect(self.camera.choose_camera)
            page.camera.view_chosen.connect(self.camera.choose_view)
            page.camera.mode_chosen.connect(self.camera.choose_mode)
            self.feedback = PatientFeedback(self._visit, page.patient_controls, self, self._preview.look)
            self.feedback.run_requested.connect(self.run)
            self._preview.renewed.connect(self.feedback.watch)
        return self._page

    @property
    def title(self) -> str:
        return tr("Walking")

    @property
    def note(self) -> str:
        recordings = self._visit.recordings
        if self.memory.fetch.is_fetching:
            return tr("being fetched")
        if (walk := self._ongoing) is not None:
            return tr("Recording {walk}").format(walk=recordings.called(walk.details.name))
        if recordings.is_recording:
            return ""
        if self._asked is not None:
            return tr("include or exclude?")
        kept = sum(one.details.is_kept and one.is_decided for one in recordings.walks)
        return tr("{count} included").format(count=kept) if kept else ""

    @property
    def state(self) -> StepState:
        if self._asked is not None:
            return StepState.ATTENTION
        return StepState.DONE if self._has_kept else StepState.TODO

    @property
    def cannot_enter(self) -> str:
        if self._visit.session is None:
            return tr("Enter the patient's code first.")
        if self._visit.recordings.walks:
            return ""  # they can be kept or discarded whatever is missing for the next
        if self._visit.sensors.detected:
            return tr("Correct the sensor positions first.")
        return self._next.missing

    @property
    def cannot_leave(self) -> str:
        if reason := self.memory.cannot_leave:
            return reason
        if self._ongoing is None:
            return ""
        if self._visit.recordings.is_stopping:
            return tr("The walk is being loaded.")
        return tr("A walk is being recorded. Stop it first.")

    @property
    def folds_sensors(self) -> bool:
        is_bench = self.bench.is_shown and not self._visit.recordings.is_recording
        return self._timed.is_running or self._timed.has_result or is_bench

    @property
    def takes_clicker(self) -> bool:
        return self._timed.is_running

    @property
    def topic(self) -> str:
        return "bench" if self.bench.is_shown and not self._visit.recordings.is_recording else "walking"

    def enter(self) -> None:
        self._is_in_sight = True
        self._timed.earlier.read()
        self.camera.look()
        self.page.set_simulated(self._visit.is_simulated)
        self.page.set_hips(bool(self._visit.sensors.hips))
        self._preview.begin()
        if not self._label:
            self._label = label_after(self._visit.patient.details, self._used)
        if not self._next.missing:
            self.memory.prepare()
        self._show()
        self.page.focus()

    def leave(self) -> None:
        self._is_in_sight = self._must_restrap = False
        if self.feedback is not None:
            self.feedback.close()
        self.camera.leave()
        self._preview.end()

    def tick(self) -> None:
        if self._ticks % WATCH_TICKS == 0:
            self._watch_sensors()
        self._ticks += 1
        self.page.camera.show_now(self.camera.facts, self.camera.pictures())
        self.page.show_test(self._timed.view())
        if self._timed.tick():
            self.stop()
        is_live = self._ongoing is not None and not self._visit.sensors.are_in_memory
        view = self._preview.look() if is_live else None
        if view is not None and self._preview.follow(view) and self._preview.shown is not None:
            self.page.show_view(self._preview.shown)
            if self.feedback is not None:
                self.feedback.count(self._preview.shown.strides)

    def bar(self) -> BarState:
        bar = WalkingBar(self, self._visit, self._next, self.bench, self._timed, self.memory)
        return bar.state(name_in_words(self._label))

    # what its bar does

    def go_on(self) -> None:
        self.done.emit()

    def return_to_first(self) -> None:
        """Say that the prosthesis is put back to where it began."""
        if stated := self.bench.return_to_first():
            self._kept = self._discarded = None
            self._label = self.bench.next_walk()[0]
            self._show()
            self.offered.emit(stated)

    def toggle_patient_screen(self) -> None:
        if self.feedback is not None:
            self.feedback.toggle()

    def discard(self) -> None:
        if self._asked is not None:
            self._keep(self._asked, is_kept=False)

    def keep_at_bench(self) -> None:
        """Keep the latest walk: what is changed next is changed from it. It can be taken back for a while."""
        if (recording := self._asked) is None:
            return
        self.bench.settle_return()
        self._discarded, self._kept = None, recording.id
        self._keep(recording, is_kept=True)
        self.offered.emit(tr("{walk} included.").format(walk=self._visit.recordings.called(recording.details.name)))

    def on_intent(self, intent: Intent) -> bool:
        feedback = self.feedback
        match intent.action:
            case KeyAction.RUN:
                self.run()
            case KeyAction.NEXT_TEST if not self._visit.recordings.is_recording:
                self._timed.choose_next()
            case KeyAction.ENTER_FIELDS if not self._visit.recordings.is_recording and self.page.next.isVisible():
                self.page.enter_course()
            case KeyAction.LEAVE if self._timed.is_running:
                self.stop()
            case KeyAction.KEEP | KeyAction.IDENTIFY if self._asked is not None:
                self._keep(self._asked, is_kept=True)
            case KeyAction.DISCARD if self._asked is not None:
                self.discard()
            case KeyAction.ENTER_FIELDS if self.bench.is_shown and not self._visit.recordings.is_recording:
                self.page.bench.focus_entry()
            case KeyAction.LABEL if self.bench.is_shown and not self._visit.recordings.is_recording:
                self.bench.choose(intent.number - 1, is_beside=False)
            case KeyAction.SECOND_LABEL if self.bench.is_shown and not self._visit.recordings.is_recording:
                self.bench.choose(intent.number - 1, is_beside=True)
            case KeyAction.LABEL:
                self.page.choose_digit(intent.number)
            case KeyAction.PATIENT_SCREEN:
                self.toggle_patient_screen()
            case KeyAction.FULL_SCREEN if feedback is not None:
                feedback.toggle_full_screen()
            case KeyAction.LEAVE if feedback is not None and feedback.is_open:
                feedback.close()
            case KeyAction.LEAVE if self._timed.planned is not None and not self._visit.recordings.is_recording:
                self._timed.choose(None)
            case _:
                return False
        return True

    def undo(self) -> None:
        if self.bench.undo_return():
            self._label = label_after(self._visit.patient.details, self._used)
            self._show()
            return
        if (kept := self._recording(self._kept)) is not None:
            self._kept = None
            self._visit.recordings.ask_again(kept)
            return
        if (recording := self._recording(self._discarded)) is not None:
            self._keep(recording, is_kept=True)
        self._discarded = None

    # recording

    def run(self) -> None:
        """Start, or stop; between walks, keep the last one and start the next."""
        if self._ongoing is not None and not self._visit.recordings.is_stopping:
            if not self._timed.press():
                self.stop()
        elif self._next.is_possible:
            if self._asked is not None:
                self._keep(self._asked, is_kept=True)
            self._start()

    def _start(self) -> None:
        acquisition, recordings = self._visit.sensors.acquisition, self._visit.recordings
        assert acquisition is not None
        self._notice.is_troubled = self._visit.controller.is_gone
        self._at_stop = None
        self.page.count_again()
        label, alignment = self._label, None
        if self.bench.is_shown or self.bench.returns_as(label):
            label, alignment = self.bench.next_walk()
            acquisition.set_up(self.bench.chain.set_so(label, alignment))
        planned = self._timed.planned
        if planned is None:
            acquisition.ask(RecordingKind.WALKING)
        else:
            acquisition.ask_test(planned)
        self.memory.fetch.begun()
        recordings.begin(acquisition, RecordingKind.WALKING, label, alignment, planned)
        if (walk := self._ongoing) is not None:
            self._preview.begin_walk(walk.began_s)
            self._timed.begin(walk.began_s)
        if self.feedback is not None:
            self.feedback.begin_walk()
        self.page.focus()

    def stop(self) -> None:
        view = self._at_stop = self._preview.shown
        self._preview.end_walk()
        self.camera.walk_ended()
        if self.feedback is not None and (walk := self._ongoing) is not None:
            self._tallies[walk.details.name] = self.feedback.end_walk()
        self._visit.recordings.stop(None if view is None else view.strides)
        if (acquisition := self._visit.sensors.acquisition) is not None:
            acquisition.ask(None)
        if not self._timed.end():
            sounds.play(Sound.STOP)

    def _keep(self, recording: "SessionRecording", is_kept: bool) -> None:
        called = self._visit.recordings.called(recording.details.name)
        self._visit.recordings.keep(recording, is_kept)
        if is_kept:
            self.bench.counts_again(recording.details)
        else:
            self.bench.settle_return()
            self.bench.discarded(recording.details)
            self._kept = None
            self._discarded = recording.id
            self.offered.emit(tr("{walk} excluded.").format(walk=called))
        self._show()

    # what is to be shown

    @property
    def _are_sensors(self) -> tuple[bool, bool, bool]:
        """What changes by itself, and what can be done with it: nothing is received, or clocks have drifted apart."""
        sensors = self._visit.sensors
        return sensors.are_silent, sensors.are_loose, sensors.are_ready_for_walks

    @Slot()
    def _on_evaluated(self) -> None:
        if not self._is_in_sight:
            return
        if not self._visit.recordings.is_recording:
            self._visit.evaluate_if_stale()  # a walk may have ended while a part of it was looked at
        self._preview.take_over()
        if self.feedback is not None:
            self.feedback.show_reasons()
        self._show()

    def _watch_sensors(self) -> None:
        sensors, recordings = self._visit.sensors, self._visit.recordings
        if (are := self._are_sensors) != self._were_sensors:
            self._were_sensors = are
            self._show()
        self.camera.watch()
        news = self._notice.look()
        if news and recordings.is_recording:
            sounds.play(Sound.LOSS)
            for site in news:
                recordings.mark(f"{site} silent")
        self.page.show_output(output_words(live_output, is_in_memory=sensors.are_in_memory))
        message = self._notice.message(self._preview.shown)
        if message == NOTHING and recordings.is_recording and sensors.acquisition is not None:
            self.page.show_message(*no_foot_message(sensors.sensor_at), is_caution=False)
        else:
            self.page.show_message(*message)

    # what is shown

    @property
    def _used(self) -> list[str]:
        return [recording.details.condition for recording in self._visit.recordings.walks]

    @property
    def _has_kept(self) -> bool:
        return any(recording.details.is_kept for recording in self._visit.recordings.walks)

    @property
    def _ongoing(self) -> "Ongoing | None":
        return ongoing_walk(self._visit.recordings)

    @property
    def _asked(self) -> "SessionRecording | None":
        return asked_walk(self._visit.recordings)

    def _recording(self, identity: UUID | None) -> "SessionRecording | None":
        return next((recording for recording in self._visit.recordings.walks if recording.id == identity), None)

    @Slot()
    def _show(self) -> None:
        if self._page is None or not self._is_in_sight:
            self.changed.emit()
            return
        asked, ongoing = self._asked, self._ongoing
        conditions = [*self._used, *([ongoing.details.condition] if ongoing is not None else [])]
        cadence = math.nan
        if self._at_stop is not None and asked is not None and not asked.is_decided:
            cadence = self._at_stop.cadence_steps_min
        facts = ""
        if asked is not None:
            clauses = [facts_of(self._visit, asked, cadence), received_clause(received_of(asked))]
            facts = " · ".join(filter(None, clauses))
        self._page.show_received(received_rows(self._visit.recordings) if ongoing is None else ())
        self._page.show_walks(rows_of(self._visit), facts)
        self._page.show_bench(self.bench.state() if self.bench.is_shown and ongoing is None else None)
        self._page.show_labels(labels_for(self._visit.patient.details, conditions), name_in_words(self._label))
        self._page.show_tests(self._timed.planned, self._timed.result(), self._timed.before(self._label))
        self._page.show_memory(self.memory.shown)
        self._page.show_camera(self.camera.shown)
        self.changed.emit()

    # what the page and the visit report

    @Slot()
    def _on_begun(self) -> None:
        if self._ongoing is None:
            return  # of another step, left before it had begun
        self.bench.begun()
        self.camera.walk_begun()
        if self._is_in_sight and not self._visit.recordings.is_stopping:
            sounds.play(Sound.START)

    @Slot(object)
    def _on_ended(self, recording: "SessionRecording") -> None:
        if recording.details.kind is RecordingKind.WALKING:
            self._preview.end_walk()  # also of one that ended by itself
            self.camera.walk_ended()
            self._label = label_after(self._visit.patient.details, self._used)
            self._keep_tallies(recording)
            self._show()

    def _keep_tallies(self, recording: "SessionRecording") -> None:
        """Note with the walk how often its targets were reached."""
        tallies = self._tallies.pop(recording.details.name, ())
        if self.feedback is not None and not self._visit.recordings.is_recording:
            tallies += self.feedback.end_walk()  # of a walk that ended by itself
        if tallies:
            self._visit.recordings.change(
                recording, lambda reported: replace(reported, note=with_tallies(reported.note, tallies))
            )

    @Slot()
    def _on_troubled(self) -> None:
        self._notice.is_troubled = True  # the words change with what the counters give

    @Slot(str)
    def _on_label_chosen(self, label: str) -> None:
        label = self._label = stored_label(label, self._used)
        self.page.next.test.show_before(self._timed.before(label))
        self.changed.emit()

    @Slot()
    def _on_course_entered(self) -> None:
        field = self.page.next.course
        self._timed.is_course_wrong = field.is_wrong
        self._timed.enter_course(field.value)
        self.changed.emit()

    @Slot()
    def _on_recorded_course_entered(self) -> None:
        if (planned := self.page.timed_result.entry.planned) is not None:
            self._timed.correct(planned)

    @Slot()
    def _on_change_reported(self) -> None:
        """Show what was entered for the next change, without drawing anything else again."""
        self.page.bench.alignments.show_entry(self.bench.next_title)
        self.changed.emit()

    @Slot(str)
    def _on_keep_pressed(self, identity: str) -> None:
        if (recording := self._recording(UUID(identity))) is not None:
            self._keep(recording, is_kept=True)

    @Slot(str)
    def _on_discard_pressed(self, identity: str) -> None:
        if (recording := self._recording(UUID(identity))) is not None:
            self._keep(recording, is_kept=False)

    @Slot(str, str)
    def _on_renamed(self, identity: str, condition: str) -> None:
        if (recording := self._recording(UUID(identity))) is not None:
            self._visit.recordings.change(recording, lambda reported: replace(reported, condition=condition))

    @Slot()
    def _on_restrapped_pressed(self) -> None:
        self._visit.recordings.say_restrapped()
        self._must_restrap = self._visit.sensors.are_in_memory
        if self._must_restrap:
            self.memory.go_live()  # standing and free motion are measured live
        else:
            self.jumped.emit(StepId.STAND_STILL)

    @Slot()
    def _on_lives(self) -> None:
        if self._must_restrap:
            self._must_restrap = False
            self.jumped.emit(StepId.STAND_STILL)

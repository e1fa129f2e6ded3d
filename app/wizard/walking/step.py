"""Walks under one condition after the other: Space starts and stops, K and D say whether a walk counts."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Slot

from app import sounds
from app.icons import Icon
from app.sounds import Sound
from app.theme import ThemeNotifier
from app.widgets.action_bar import BarAction, BarState, RecordingNote
from app.widgets.rail_row import StepState
from app.wizard.keys import Intent, KeyAction
from app.wizard.losses import NOTHING
from app.wizard.step import Step
from app.wizard.walk_messages import no_foot_message
from app.wizard.walking.bench_bar import bench_bar
from app.wizard.walking.bench_control import Bench
from app.wizard.walking.estimator import WalkingEstimator
from app.wizard.walking.memory_control import MemoryControl
from app.wizard.walking.patient_feedback import PatientFeedback
from app.wizard.walking.timed_bar import timed_bar
from app.wizard.walking.timed_control import TimedControl
from app.wizard.walking.walk_labels import label_after, labels_for
from app.wizard.walking.walk_notice import WalkNotice, asked_walk
from app.wizard.walking.walk_rows import facts_of, ongoing_walk, rows_of
from app.wording import tr
from core.body import LEG_JOINTS, Side
from core.live.walking import STRIDES_FOR_ANKLE
from core.samples import Recording, RecordingKind
from core.targets import TargetTally, with_tallies

if TYPE_CHECKING:
    from app.wizard.recordings import SessionRecording
    from app.wizard.visit import Visit
    from app.wizard.walking.page import WalkingPage
    from app.wizard.walking.readout import WalkingReadout

STAND_STILL = 2  # the step that sensors strapped anew begin with
WATCH_TICKS = 3  # of 30 a second: sensors are looked at ten times a second
HIPS_AFTER_S = 22.0  # of a walk, with a turn as a rule, that shows them if any does
LOOKED_BACK_S = 29.0  # of a walk that goes on; the ring buffer holds a second more


class WalkingStep(Step):
    def __init__(self, look: ThemeNotifier, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(look, visit, parent)
        self._page: WalkingPage | None = None
        self._feedback: PatientFeedback | None = None  # made with the page
        self._tallies: dict[str, tuple[TargetTally, ...]] = {}  # of walks that are still to be read back
        self._estimator: WalkingEstimator | None = None
        self._shown: WalkingReadout | None = None
        self._at_stop: WalkingReadout | None = None
        self._counted_before: dict[Side, int] = {}
        self._label = ""
        self._is_in_sight = self._is_ankle_asked = self._are_hips_asked = False
        self._ticks = 0
        self._was_silent = False  # all sensors
        self._notice = WalkNotice(visit)
        self._discarded: UUID | None = None
        self._kept: UUID | None = None  # at the bench, and can be taken back
        self._bench = Bench(visit, self)
        self._bench.changed.connect(self._show)
        self._timed = TimedControl(visit, self)
        self._timed.changed.connect(self._show)
        self._memory = MemoryControl(visit, self)
        self._memory.changed.connect(self._show)
        self._memory.lives.connect(self._on_lives)
        self._must_restrap = False
        visit.recordings.begun.connect(self._on_begun)
        visit.recordings.ended.connect(self._on_ended)
        visit.recordings.changed.connect(self._show)
        visit.recordings.troubled.connect(self._on_troubled)
        visit.evaluation.done.connect(self._on_evaluated)
        visit.evaluation.refused.connect(self._show)

    # the frame of the wizard

    @property
    def page(self) -> "WalkingPage":
        if self._page is None:
            from app.wizard.walking.page import WalkingPage

            page = self._page = WalkingPage(self._look, self._bench.entry)
            page.bench.chosen.connect(self._bench.choose)
            page.bench.told.connect(self._on_change_told)
            page.label_chosen.connect(self._on_label_chosen)
            page.next.test.chosen.connect(self._timed.on_chosen)
            page.keep_pressed.connect(self._on_keep_pressed)
            page.discard_pressed.connect(self._on_discard_pressed)
            page.undo_pressed.connect(self._on_undo_pressed)
            page.renamed.connect(self._on_renamed)
            page.restrapped_pressed.connect(self._on_restrapped_pressed)
            page.memory.stop_pressed.connect(self._memory.stop)
            self._feedback = PatientFeedback(self._look, self._visit, page.patient_controls, self)
            self._feedback.run_wished.connect(self._run)
        return self._page

    @property
    def title(self) -> str:
        return tr("Walking")

    @property
    def note(self) -> str:
        if self._memory.fetch.is_fetching:
            return tr("being fetched")
        if self._visit.recordings.is_recording and self._visit.recordings.ongoing is not None:
            if self._visit.recordings.ongoing.details.kind is RecordingKind.WALKING:
                return tr("Recording {walk}").format(walk=self._called(self._visit.recordings.ongoing.details.name))
            return ""
        if self._asked is not None:
            return tr("keep or discard?")
        kept = sum(one.details.is_kept and one.is_decided for one in self._visit.recordings.walks)
        return tr("{count} kept").format(count=kept) if kept else ""

    @property
    def state(self) -> StepState:
        if self._asked is not None:
            return StepState.ATTENTION
        return (
            StepState.DONE
            if any(recording.details.is_kept for recording in self._visit.recordings.walks)
            else StepState.TODO
        )

    @property
    def cannot_enter(self) -> str:
        if self._visit.session is None:
            return tr("Type the patient's code first.")
        if self._visit.recordings.walks:
            return ""  # they can be kept or discarded whatever is missing for the next
        return self._cannot_start

    @property
    def _cannot_start(self) -> str:
        """What is missing for a walk, in a sentence; empty where nothing is."""
        sensors = self._visit.sensors
        if sensors.acquisition is None:
            return tr("Choose the source of the sensors first.")
        if self._visit.cannot_record:
            return self._visit.cannot_record
        if not sensors.site_of:
            return tr("Say first which sensor is worn where.")
        if sensors.are_silent:
            return tr("No sensor is heard. Switch them on, or bring the receiver nearer.")
        if self._visit.recordings.must_move:
            return tr("The sensors were re\N{NON-BREAKING HYPHEN}strapped. Stand still and move freely first.")
        return ""

    @property
    def _cannot_start_now(self) -> str:
        """As `_cannot_start`, and what the sensors' memories are missing still."""
        missing = self._cannot_start or self._memory.cannot_start
        if not missing and self._visit.sensors.are_in_memory and self._timed.planned is not None:
            return tr("Timed tests need what the sensors send live: choose no test, or send walks live.")
        return missing

    @property
    def cannot_leave(self) -> str:
        recordings = self._visit.recordings
        if reason := self._memory.cannot_leave:
            return reason
        if recordings.is_recording or recordings.is_stopping:
            return tr("A walk is being recorded. Stop it first.")
        return ""

    @property
    def folds_sensors(self) -> bool:
        return self._timed.is_running or (self._is_bench and not self._visit.recordings.is_recording)

    @property
    def takes_clicker(self) -> bool:
        return self._timed.is_running

    @property
    def topic(self) -> str:
        return "walking"

    def enter(self) -> None:
        self._is_in_sight = True
        self._timed.earlier.read()
        self._begin_estimator()
        self.page.set_simulated(self._visit.is_simulated)
        self.page.set_hips(bool(self._visit.sensors.hips))
        if not self._label:
            self._label = label_after(self._visit.patient.details, self._used)
        if not self._cannot_start:
            self._memory.prepare()
        self._show()
        self.page.focus()

    def leave(self) -> None:
        self._is_in_sight = False
        if self._feedback is not None:
            self._feedback.close()
            self._feedback.watch(None)
        if (acquisition := self._visit.sensors.acquisition) is not None:
            acquisition.set_estimator(None)
        self._estimator = None

    def tick(self) -> None:
        if self._ticks % WATCH_TICKS == 0:
            self._watch_sensors()
        self._ticks += 1
        self.page.show_test(self._timed.view())
        if self._timed.tick():
            self._stop()
        is_recording = self._visit.recordings.is_recording and not self._visit.sensors.are_in_memory
        is_fed_back = self._feedback is not None and self._feedback.is_open
        if self._estimator is None or not (is_recording or is_fed_back):
            return
        view, sensors = self._estimator.state, self._visit.sensors
        if sensors.are_silent and sensors.acquisition is not None:
            view = view.while_silent(sensors.acquisition.now_s, sensors.site_of.values())
        if self._feedback is not None and is_fed_back:
            self._feedback.judge(view)
        if not is_recording or view is self._shown or math.isnan(view.now_s):
            return
        self._shown = view
        strides = self._strides(view)
        self.page.show_view(replace(view, strides=strides))
        self._ask_for_ankles(strides)
        self._ask_for_hips()

    def bar(self) -> BarState:
        bar = self._bar()
        if self._is_bench:  # which has no room for another; the key is there
            return bar
        return (
            bar if self._timed.is_running else replace(bar, quiet=(*bar.quiet, BarAction(tr("Patient's screen"), "F8")))
        )

    def _bar(self) -> BarState:
        recordings = self._visit.recordings
        if recordings.ongoing is not None and not recordings.is_stopping:
            acquisition = self._visit.sensors.acquisition
            elapsed_s = 0.0 if acquisition is None else max(0.0, acquisition.now_s - recordings.ongoing.began_s)
            if self._timed.is_running:
                return timed_bar(self._timed, elapsed_s)
            return BarState(
                primary=BarAction(tr("Stop walk"), tr("Space"), Icon.STOP),
                recording=RecordingNote(
                    tr("Recording {walk}").format(walk=self._called(recordings.ongoing.details.name)),
                    " ".join(filter(None, [self._saved(), tr("The space bar stops it, with a sound.")])),
                    elapsed_s,
                    sounds.is_on(),
                ),
                has_back=False,
            )
        if self._has_memory_bar:
            return self._memory.bar() or BarState()
        if recordings.is_stopping:
            return BarState(primary=self._start_action, note=tr("The walk is being read back."))
        if self._is_bench:
            return self._bench_bar()
        quiet = (BarAction(tr("Bench")),) if self._bench.is_offered else ()
        if (memory := self._memory_quiet) is not None:
            quiet = (*quiet, memory)
        return replace(self._bar_of_walks(), quiet=quiet)

    def _bar_of_walks(self) -> BarState:
        """What can be done between two walks where there is no bench."""
        recordings, start = self._visit.recordings, self._start_action
        if self._asked is not None:
            both = BarAction(
                tr("Keep, start next"), tr("Space"), Icon.PLAY, is_wished=False, is_enabled=self._can_start
            )
            return BarState(primary=both, note=self._cannot_start_now or self._timed.next_words(self._label))
        if any(recording.details.is_kept for recording in recordings.walks):
            again = BarAction(start.text, start.key, start.icon, is_wished=False, is_enabled=start.is_enabled)
            return BarState(
                primary=BarAction(tr("Results"), "", Icon.NEXT), others=(again,), note=self._cannot_start_now
            )
        note = self._timed.next_words(self._label)
        if not recordings.has_moved:
            note = tr("Without a free motion, angles are poor or missing.")
        return BarState(primary=start, note=self._cannot_start_now or note)

    @property
    def _start_action(self) -> BarAction:
        return BarAction(tr("Start walk"), tr("Space"), Icon.PLAY, is_enabled=self._can_start)

    @property
    def _is_bench(self) -> bool:
        return self._bench.is_wished and self._bench.is_offered

    def _bench_bar(self) -> BarState:
        asked = None if self._asked is None else self._asked.details.condition
        return bench_bar(self._bench, asked, self._cannot_start_now, self._can_start)

    def _saved(self) -> str:
        """Say that what comes in is saved, only while the journal has it so."""
        recordings = self._visit.recordings
        if not recordings.has_begun:
            return tr("It begins in a moment.")
        if recordings.is_in_memory:
            return tr("Kept in the sensors.")
        return tr("Saved as it comes in.") if recordings.is_written else ""

    def on_primary(self) -> None:
        recordings = self._visit.recordings
        if self._has_memory_bar:
            self._memory.on_primary()
            return
        if self._is_bench and self._asked is not None and not recordings.is_recording and not recordings.is_stopping:
            self._keep_at_bench(self._asked)
            return
        is_settled = not recordings.is_recording and not recordings.is_stopping and self._asked is None
        if is_settled and any(recording.details.is_kept for recording in recordings.walks):
            self.done.emit()
        else:
            self._run()

    def on_other(self, number: int) -> None:
        if self._has_memory_bar:
            if self._memory.on_other(number):
                self.done.emit()
        elif self._timed.is_running:
            self._stop()
        elif self._is_bench and number < len(self._bench_bar().others) - 1:
            if said := self._bench.return_to_first():
                self._kept = self._discarded = None
                self.offered.emit(said)
        elif number in (0, 1):
            self._run()

    def on_quiet(self, number: int) -> None:
        own = len(self._bar().quiet)
        if number >= own:
            self._toggle_patient_screen()
        elif self._memory_quiet is not None and number == own - 1:
            self._memory.on_quiet()
        elif number == 0:
            self._bench.is_wished = not self._bench.is_wished
            self._show()
        elif self._asked is not None:
            self._keep(self._asked, is_kept=False)

    @property
    def _memory_quiet(self) -> BarAction | None:
        return self._memory.quiet(wants_live=self._timed.planned is not None)

    @property
    def _has_memory_bar(self) -> bool:
        visit, recordings = self._visit, self._visit.recordings
        is_between = recordings.ongoing is None or recordings.is_stopping
        is_held_up = bool(visit.cannot_record) or recordings.must_move or not visit.sensors.site_of
        return is_between and not is_held_up and self._memory.bar() is not None

    def _toggle_patient_screen(self) -> None:
        if self._feedback is not None:
            self._feedback.toggle()

    def _keep_at_bench(self, recording: "SessionRecording") -> None:
        """Keep it: what is changed next is changed from it. It can be taken back for a while."""
        self._bench.settle_return()
        self._discarded, self._kept = None, recording.id
        self._keep(recording, is_kept=True)
        self.offered.emit(tr("{walk} kept.").format(walk=self._called(recording.details.name)))

    def on_intent(self, intent: Intent) -> bool:
        feedback = self._feedback
        match intent.action:
            case KeyAction.RUN:
                self._run()
            case KeyAction.NEXT_TEST if not self._visit.recordings.is_recording:
                self._timed.choose_next()
            case KeyAction.LEAVE if self._timed.is_running:
                self._stop()
            case KeyAction.KEEP if self._asked is not None:
                self._keep(self._asked, is_kept=True)
            case KeyAction.DISCARD if self._asked is not None:
                self._keep(self._asked, is_kept=False)
            case KeyAction.LABEL if self._is_bench and not self._visit.recordings.is_recording:
                self._bench.choose(intent.number - 1, is_beside=False)
            case KeyAction.SECOND_LABEL if self._is_bench and not self._visit.recordings.is_recording:
                self._bench.choose(intent.number - 1, is_beside=True)
            case KeyAction.LABEL:
                self.page.choose_digit(intent.number)
            case KeyAction.PATIENT_SCREEN:
                self._toggle_patient_screen()
            case KeyAction.FULL_SCREEN if feedback is not None:
                feedback.toggle_full_screen()
            case KeyAction.LEAVE if feedback is not None and feedback.is_open:
                feedback.close()
            case _:
                return False
        return True

    def undo(self) -> None:
        if self._bench.undo_return():
            return
        if (kept := self._recording(self._kept)) is not None:
            self._kept = None
            self._visit.recordings.ask_again(kept)
            return
        if (recording := self._recording(self._discarded)) is not None:
            self._keep(recording, is_kept=True)
        self._discarded = None

    # recording

    @property
    def _can_start(self) -> bool:
        recordings = self._visit.recordings
        is_free = self._visit.session is not None and not recordings.is_recording and not recordings.is_stopping
        return is_free and not self._cannot_start_now

    def _run(self) -> None:
        """Start, or stop; between walks, keep the last one and start the next."""
        if self._visit.recordings.is_recording:
            if not self._timed.press():
                self._stop()
        elif self._can_start:
            if self._asked is not None:
                self._keep(self._asked, is_kept=True)
            self._start()

    def _start(self) -> None:
        acquisition, recordings = self._visit.sensors.acquisition, self._visit.recordings
        assert acquisition is not None
        self._is_ankle_asked = self._are_hips_asked = False
        self._notice.is_troubled = self._visit.controller.is_gone
        self._shown = self._at_stop = None
        self._counted_before = {}
        self.page.count_anew()
        label, alignment = self._label, None
        if self._is_bench:
            label, alignment = self._bench.next_walk()
            acquisition.set_up(self._bench.chain.set_so(label, alignment))
        acquisition.ask(RecordingKind.WALKING)
        self._memory.fetch.begun()
        recordings.begin(acquisition, RecordingKind.WALKING, label, alignment, self._timed.planned)
        self._bench.begun()
        if self._estimator is not None and recordings.ongoing is not None:
            self._estimator.count_from(recordings.ongoing.began_s)
            self._timed.begin(self._estimator, recordings.ongoing.began_s)
        if self._feedback is not None:
            self._feedback.begin_walk()
        self.page.focus()

    def _stop(self) -> None:
        acquisition, view = self._visit.sensors.acquisition, self._shown
        self._at_stop = view
        if self._feedback is not None and self._visit.recordings.ongoing is not None:
            self._tallies[self._visit.recordings.ongoing.details.name] = self._feedback.end_walk()
        self._visit.recordings.stop(None if view is None else self._strides(view))
        if acquisition is not None:
            acquisition.ask(None)
        if not self._timed.end(self._estimator):
            sounds.play(Sound.STOP)

    def _keep(self, recording: "SessionRecording", is_kept: bool) -> None:
        called = self._called(recording.details.name)
        self._visit.recordings.keep(recording, is_kept)
        if not is_kept:
            self._bench.settle_return()
            self._bench.discarded(recording.details.alignment)
            self._kept = None
            self._discarded = recording.id
            self.offered.emit(tr("{walk} discarded.").format(walk=called))
        self._show()

    # what is live

    def _begin_estimator(self) -> None:
        """Let the estimator work on this step, with the calibration as it is now."""
        acquisition = self._visit.sensors.acquisition
        if acquisition is None:
            return
        calibration = self._visit.evaluation.calibration
        live = self._visit.live_sensors()
        hips = self._visit.evaluation.hips
        self._estimator = WalkingEstimator(self._visit.sensors.site_of, live, calibration, hips)
        if self._visit.recordings.ongoing is not None:
            self._estimator.count_from(self._visit.recordings.ongoing.began_s)
        self._timed.watch(self._estimator)
        acquisition.set_estimator(self._estimator)
        if self._feedback is not None:
            self._feedback.watch(self._estimator)

    def _strides(self, view: "WalkingReadout") -> dict[Side, int]:
        """Those of this walk, also where another estimator began amid it."""
        return {side: count + self._counted_before.get(side, 0) for side, count in view.strides.items()}

    def _ask_for_hips(self) -> None:
        """Look once more, where neither the free motion nor the first strides have shown the hips."""
        recordings, acquisition, evaluation = (
            self._visit.recordings,
            self._visit.sensors.acquisition,
            self._visit.evaluation,
        )
        if self._are_hips_asked or recordings.ongoing is None or acquisition is None or evaluation.is_busy:
            return
        if acquisition.now_s - recordings.ongoing.began_s < HIPS_AFTER_S:
            return
        self._are_hips_asked = True
        if set(self._visit.sensors.hips) - evaluation.hips.keys():
            self._evaluate_walk()

    def _ask_for_ankles(self, strides: dict[Side, int]) -> None:
        """Find the ankles' axes anew, once, from free motion and this walk together."""
        recordings, acquisition = self._visit.recordings, self._visit.sensors.acquisition
        if self._is_ankle_asked or recordings.ongoing is None or acquisition is None or not strides:
            return
        if min(strides.values()) < STRIDES_FOR_ANKLE or self._visit.evaluation.is_busy:
            return
        self._is_ankle_asked = True
        self._evaluate_walk()

    def _evaluate_walk(self) -> None:
        """Find out what the walk that goes on has told until now, with what was recorded before."""
        recordings, acquisition = self._visit.recordings, self._visit.sensors.acquisition
        assert recordings.ongoing is not None  # whoever asks has seen to both
        assert acquisition is not None
        seconds = min(acquisition.now_s - recordings.ongoing.began_s, LOOKED_BACK_S)
        worn = self._visit.sensors.site_of
        imu = {site: acquisition.latest(sensor, seconds) for sensor, site in worn.items()}
        told = recordings.ongoing.details
        heard = {site: block for site, block in imu.items() if len(block)}
        self._visit.evaluate(
            Recording(told.name, told.kind, told.folder, heard, condition=told.condition, alignment=told.alignment)
        )

    @Slot()
    def _on_evaluated(self) -> None:
        if not self._is_in_sight:
            return
        if not self._visit.recordings.is_recording:
            self._visit.evaluate_if_stale()  # a walk may have ended while a part of it was looked at
        calibration = self._visit.evaluation.calibration
        known = set(self._shown.joints) if self._shown is not None else set()
        worn = set(self._visit.sensors.joints)
        if self._estimator is None or (set(calibration) & worn) - known:
            if self._shown is not None:
                self._counted_before = self._strides(self._shown)
            self._begin_estimator()
            if self._estimator is not None and self._counted_before and self._visit.sensors.acquisition is not None:
                self._estimator.count_from(self._visit.sensors.acquisition.now_s)
        else:
            for joint in LEG_JOINTS:
                if not joint.is_knee and joint in calibration:
                    self._estimator.recalibrate(joint, calibration[joint])
            self._estimator.find_hips(self._visit.evaluation.hips)
        if self._feedback is not None:
            self._feedback.show_reasons()
        self._show()

    # what is to be said

    def _watch_sensors(self) -> None:
        sensors, recordings = self._visit.sensors, self._visit.recordings
        if sensors.acquisition is not None and sensors.are_silent != self._was_silent:
            self._was_silent = sensors.are_silent
            self.changed.emit()  # a walk can be started again, or no more
        news = self._notice.look()
        if news and recordings.is_recording:
            sounds.play(Sound.LOSS)
            for site in news:
                recordings.mark(f"{site} silent")
        message = self._notice.message(self._shown)
        if message == NOTHING and recordings.is_recording and sensors.acquisition is not None:
            self.page.show_message(*no_foot_message(sensors.sensor_at), is_caution=False)
        else:
            self.page.show_message(*message)

    # what is shown

    @property
    def _used(self) -> list[str]:
        return [recording.details.condition for recording in self._visit.recordings.walks]

    def _called(self, name: str) -> str:
        return str(self._visit.recordings.shown_names[name])

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
        asked, ongoing = self._asked, ongoing_walk(self._visit.recordings)
        conditions = [*self._used, *([ongoing.details.condition] if ongoing is not None else [])]
        cadence = math.nan
        if self._at_stop is not None and asked is not None and not asked.is_decided:
            cadence = self._at_stop.cadence_steps_min
        facts = facts_of(self._visit, asked, cadence) if asked is not None else ""
        self._page.show_walks(rows_of(self._visit), facts)
        self._page.show_bench(self._bench.state() if self._is_bench and ongoing is None else None)
        self._page.show_labels(labels_for(self._visit.patient.details, conditions), self._label)
        self._page.show_tests(self._timed.protocol, self._timed.result(), self._timed.before(self._label))
        self._page.show_memory(self._memory.shown)
        self.changed.emit()

    # what the page and the visit tell

    @Slot()
    def _on_begun(self) -> None:
        if self._is_in_sight:
            sounds.play(Sound.START)

    @Slot(object)
    def _on_ended(self, recording: "SessionRecording") -> None:
        if recording.details.kind is RecordingKind.WALKING:
            self._label = label_after(self._visit.patient.details, self._used)
            self._keep_tallies(recording)
            self._show()

    def _keep_tallies(self, recording: "SessionRecording") -> None:
        """Note with the walk how often its targets were reached."""
        tallies = self._tallies.pop(recording.details.name, ())
        if self._feedback is not None and not self._visit.recordings.is_recording:
            tallies += self._feedback.end_walk()  # of a walk that ended by itself
        if tallies:
            self._visit.recordings.change(recording, lambda told: replace(told, note=with_tallies(told.note, tallies)))

    @Slot()
    def _on_troubled(self) -> None:
        self._notice.is_troubled = True  # the words change with what the counters tell

    @Slot(str)
    def _on_label_chosen(self, label: str) -> None:
        self._label = label
        self.page.next.test.show_before(self._timed.before(label))
        self.changed.emit()

    @Slot()
    def _on_change_told(self) -> None:
        """Show what was told of the next change, without drawing anything else anew."""
        self.page.bench.show_entry(self._bench.next_title)
        self.changed.emit()

    @Slot(str)
    def _on_keep_pressed(self, identity: str) -> None:
        if (recording := self._recording(UUID(identity))) is not None:
            self._keep(recording, is_kept=True)

    @Slot(str)
    def _on_discard_pressed(self, identity: str) -> None:
        if (recording := self._recording(UUID(identity))) is not None:
            self._keep(recording, is_kept=False)

    @Slot(str)
    def _on_undo_pressed(self, identity: str) -> None:
        self._on_keep_pressed(identity)

    @Slot(str, str)
    def _on_renamed(self, identity: str, condition: str) -> None:
        if (recording := self._recording(UUID(identity))) is not None:
            self._visit.recordings.change(recording, lambda told: replace(told, condition=condition))

    @Slot()
    def _on_restrapped_pressed(self) -> None:
        self._visit.recordings.say_restrapped()
        self._must_restrap = self._visit.sensors.are_in_memory
        if self._must_restrap:
            self._memory.go_live()  # standing and free motion are measured live
        else:
            self.jumped.emit(STAND_STILL)

    @Slot()
    def _on_lives(self) -> None:
        if self._must_restrap:
            self._must_restrap = False
            self.jumped.emit(STAND_STILL)

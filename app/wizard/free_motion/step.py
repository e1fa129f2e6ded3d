"""The legs are moved freely until every joint is known well enough. It ends by itself; one leg can be repeated."""

from dataclasses import replace
from enum import Enum, auto
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer

from app.acquisition.live_sensors import live_sensors
from app.editing.session_recording import SessionRecording
from app.storage.stored import RecordingState
from app.system import sounds
from app.system.prompts import prompter
from app.system.sounds import Sound
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.gauge import CLOSED
from app.widgets.hint import Hint
from app.widgets.rail_row import StepState
from app.wizard.free_motion.estimator import FreeMotionEstimator, UnplacedFreeMotionEstimator
from app.wizard.free_motion.hints import (
    Asked,
    HintHold,
    enough_for,
    first_hint,
    judged,
    played_hint,
    price_of_stopping,
    recorded_hint,
    unplaced_hint,
)
from app.wizard.free_motion.motion_shown import gauge_faces, hip_faces, sensor_marks
from app.wizard.free_motion.page import FreeMotionFace, FreeMotionPage, Swapped
from app.wizard.free_motion.side_question import SILENT, SideQuestion
from app.wizard.keys import Intent, KeyAction
from app.wizard.step import Step, StepId
from app.wizard.worn_corrections import opposite
from app.wording.translation import tr
from core.body import Joint, Side, Site
from core.live.free_motion import FreeMotionState
from core.session import RecordingKind

if TYPE_CHECKING:
    from app.wizard.visit import Visit
    from core.placement.chains import Chains

SETTLED_MS = 2000  # enough motion: time to see it, and to say otherwise
TICKS = 3  # of 30 Hz: ten looks a second
KIND = RecordingKind.FREE_MOTION


class AfterRecording(Enum):
    """What follows the recording that goes on or has ended."""

    ITSELF = auto()  # the next begins by itself while none is in force
    NEXT_STEP = auto()  # it was stopped at its end: once it is read back, the wizard goes on
    ANOTHER = auto()  # it was given up for another, which begins once it is closed
    WORD = auto()  # it was refused: the next begins by a word, not by the clock


class FreeMotionStep(Step):
    """Recorded from the moment the step is entered, unless a free motion is in force already.

    Whoever leaves it before its end loses nothing: what has moved counts, unless another is in force already.
    """

    id = StepId.FREE_MOTION

    def __init__(self, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(visit, parent)
        self._page: FreeMotionPage | None = None
        self._estimator: FreeMotionEstimator | UnplacedFreeMotionEstimator | None = None
        self._unplaced: UnplacedFreeMotionEstimator | None = None  # the same, where it has to find the sites
        self._hold = HintHold()
        self._motion = FreeMotionState()
        self._before = FreeMotionState()  # of the leg that is not repeated
        self._repeated: Side | None = None
        self._again_side: Side | None = None  # that was being repeated when it was to begin again
        self._worn_before: dict[str, Site] = {}  # what undoing brings back, and what was in doubt then
        self._doubt_before: dict[Site, Site] = {}
        self._seen_at: dict[str, Site] = {}  # where sensors were when the motion was seen
        self._elapsed_s: float | None = None
        self._enough: frozenset[Joint] = frozenset()  # joints with enough motion, as their gauges say
        self._replaced: FreeMotionState | None = None  # of the free motion that is in force while another is recorded
        self._left = "", ""  # what is to be stated about one that was left before its end
        self._plays_s: float | None = None  # for how long a replayed patient moves
        self._plays_to_s = 0.0
        self._then = AfterRecording.ITSELF
        self._is_in_sight = False
        self.question = SideQuestion()
        self._sides_reported: dict[str, Side] = {}  # in this visit, by the sensor's name
        self._asked_words = SILENT
        self._ticks = 0
        self._settled = QTimer(self)
        self._settled.setSingleShot(True)
        self._settled.setInterval(SETTLED_MS)
        self._settled.timeout.connect(self._on_settled)
        visit.recordings.begun.connect(self._on_begun)
        visit.recordings.ended.connect(self._on_ended)
        visit.recordings.refused.connect(self._on_refused)

    @property
    def page(self) -> FreeMotionPage:
        if self._page is None:
            self._page = FreeMotionPage()
            self._page.question.answered.connect(self._answer)
        return self._page

    @property
    def title(self) -> str:
        return tr("Free motion")

    @property
    def note(self) -> str:
        joints = self._motion.joints
        if self.is_in_doubt:
            return tr("positions look swapped")
        if not self._has_moved:
            return ""
        if not joints:
            return tr("stopped early") if self._is_cut_short else ""
        return enough_for(self._motion, self._visit.prosthetic_joints)

    @property
    def state(self) -> StepState:
        if self.is_in_doubt:
            return StepState.ATTENTION
        if not self._has_moved:
            return StepState.TODO
        is_whole = len(self._with_enough()) == len(self._motion.joints) and not self._is_cut_short
        return StepState.DONE if is_whole else StepState.ATTENTION

    @property
    def cannot_enter(self) -> str:
        return self._visit.cannot_calibrate

    @property
    def topic(self) -> str:
        return "free-motion"

    def enter(self) -> None:
        self._is_in_sight = True
        if self._then is AfterRecording.WORD:
            self._then = AfterRecording.ITSELF
        self._hold = HintHold(self._visit.prosthetic_joints)
        if self._seen_at != self._visit.sensors.site_of and not self._is_recording:
            self._motion = FreeMotionState()  # of other positions
        if not self._has_moved and not self._is_recording:
            self._begin()
        self._show()

    def leave(self) -> None:
        self._is_in_sight, self._worn_before = False, {}
        prompter.end()
        self._settled.stop()
        if self._is_recording and not self._visit.recordings.is_stopping:  # not to its end
            self._break_off()
        if self._then is AfterRecording.ANOTHER:
            self._then = AfterRecording.ITSELF
        if (acquisition := self._visit.sensors.acquisition) is not None:
            acquisition.set_estimator(None)
        self._estimator = None

    def tick(self) -> None:
        self._ticks += 1
        if self._ticks % TICKS or not self._is_in_sight:
            return
        if self._is_recording:
            if self._estimator is not None and self._visit.recordings.has_begun:  # and is not stopped
                self._look_at_motion()
        elif self._may_begin:
            self._begin(self._again_side)  # what was recorded before has been closed by now
        self._show()

    def bar(self) -> BarState:
        enter, space = tr("Enter"), tr("Space")
        again = BarAction(tr("Record again"), self._begin, space, Icon.REPEAT, is_requested=False)
        stop = BarAction(tr("Stop early"), self._stop, space, Icon.STOP, is_requested=False)
        left = BarAction(tr("Repeat left"), self._repeat_left, "L", Icon.REPEAT)
        right = BarAction(tr("Repeat right"), self._repeat_right, "R", Icon.REPEAT)
        repeat = tuple(left if side is Side.LEFT else right for side in self._repeatable)
        if self.is_in_doubt:
            return BarState(
                primary=BarAction(tr("Continue to walking"), self.done.emit, icon=Icon.NEXT, is_enabled=False),
                quiet=(stop if self._is_recording else again,),
                note=tr("Correct the sensor positions first."),
                on_page=(self._use_action, self._check_action),
            )
        if not self._is_recording and not self._has_moved:
            begin = BarAction(tr("Start free motion"), self._begin, space, Icon.PLAY)
            return BarState(primary=begin, quiet=(self._check_action,) if self._is_unplaced else ())
        leave = self._stop if self._is_recording else self.done.emit
        go_on = BarAction(tr("Continue to walking"), leave, enter, Icon.NEXT)
        if not self._is_recording:
            return BarState(primary=go_on, others=(again,), quiet=repeat)
        price = price_of_stopping(self._motion, self._visit.prosthetic_joints, can_move=not self._is_played)
        if self._is_done:
            return BarState(primary=go_on, quiet=repeat, note=price or tr("Continues automatically."))
        if self._is_played and not self._plays_s:
            return BarState(primary=go_on)
        if self._is_played:
            once_more = replace(again, run=self._record_again, key="")
            return BarState(primary=go_on, others=(once_more,), note=price)
        return BarState(primary=stop, quiet=repeat, note=price)

    def undo(self) -> None:
        if self._worn_before:
            self._visit.sensors.assign_all(self._worn_before)
            self._worn_before = {}
            if self._is_recording:
                self._on_relabelled()
                return
            worn, is_walking = self._visit.worn, self._visit.recordings.is_recording
            (worn.place_once_ended if is_walking else worn.place_as_stated_now)()
            self._visit.sensors.doubt(self._doubt_before)
        elif self._is_recording and self.question.reported is not None:
            self._answer(1)

    def on_intent(self, intent: Intent) -> bool:
        if intent.action is KeyAction.RUN:
            if self._is_recording:
                self._stop()
            else:
                self._begin()
            return True
        if intent.action in (KeyAction.LEFT_LEG, KeyAction.RIGHT_LEG):
            self._repeat(Side.LEFT if intent.action is KeyAction.LEFT_LEG else Side.RIGHT)
            return True
        return False

    # the recording

    @property
    def _is_recording(self) -> bool:
        ongoing = self._visit.recordings.ongoing
        return ongoing is not None and ongoing.details.kind is KIND

    @property
    def _has_moved(self) -> bool:
        return self._visit.recordings.has_moved and not self._is_unplaced

    @property
    def _is_unplaced(self) -> bool:
        """Whether a motion is to show where the sensors are, and none has."""
        sensors = self._visit.sensors
        return sensors.is_left_to_motion and not sensors.site_of

    @property
    def _is_cut_short(self) -> bool:
        """Whether the one in force is what was recovered after a crash."""
        moved = self._visit.recordings.free_motion
        return moved is not None and moved.stored.state is RecordingState.RECOVERED

    @property
    def _repeatable(self) -> list[Side]:
        """Legs that the bar offers to repeat: while they move, those whose motion brings no more. The keys do any."""
        joints = self._motion.joints
        if not self._is_recording:
            worn = {site.side for site in self._visit.sensors.site_of.values()}
            return [side for side in Side if side in worn]
        return [side for side in Side if any(one.is_plateau for joint, one in joints.items() if joint.side is side)]

    @property
    def _is_done(self) -> bool:
        return self._motion.is_done

    @property
    def _is_played(self) -> bool:
        """Whether a replayed patient has ended the free motion, and moves no more."""
        acquisition = self._visit.sensors.acquisition
        return acquisition is not None and self._plays_s is not None and acquisition.now_s > self._plays_to_s

    @property
    def _may_begin(self) -> bool:
        """Whether it is time to record by itself: none is in force, or the one before was given up for another."""
        recordings = self._visit.recordings
        if self._then is AfterRecording.ANOTHER:
            return recordings.is_idle and not recordings.every[-1].details.is_kept
        return self._then is AfterRecording.ITSELF and not (self._has_moved or recordings.is_recording)

    def _begin(self, side: Side | None = None) -> None:
        """Record; one leg alone takes only that leg's sensors, so that what the other's motion gave stays in force."""
        acquisition, recordings = self._visit.sensors.acquisition, self._visit.recordings
        if acquisition is None or self._visit.session is None or recordings.is_recording:
            return
        self._replaced = self._motion if self._has_moved else None
        self._before = self._other_leg(side) if side is not None else FreeMotionState()
        self._repeated, self._motion, self._elapsed_s = side, self._before, None
        self._then, self._again_side, self._worn_before = AfterRecording.ITSELF, None, {}
        self.question = SideQuestion()
        self._visit.sensors.doubt({})
        self._enough = self._with_enough()
        if side is not None:
            self._visit.place_sensors(only=side)
        self._plays_s = None
        recordings.begin(acquisition, KIND)
        self.changed.emit()

    def _ask_patient(self) -> None:
        """Let one who is simulated move from now on."""
        if (acquisition := self._visit.sensors.acquisition) is not None:
            self._plays_s = acquisition.ask(KIND)
            self._plays_to_s = acquisition.now_s + (self._plays_s or 0.0)

    def _watch(self) -> None:
        """Follow the motion from now on."""
        visit = self._visit
        acquisition, sensors = visit.sensors.acquisition, visit.sensors
        if acquisition is None:
            return
        standing = {name: rest.acc_m_s2 for name, rest in visit.rests.items()}
        prosthetic, without = visit.prosthetic_joints, visit.without_ankle
        self._hold = HintHold(prosthetic)
        if sensors.is_left_to_motion and not sensors.site_of:
            live = live_sensors(acquisition.sensors, visit.rests, sensors.status)
            self._estimator = self._unplaced = UnplacedFreeMotionEstimator(
                live, Side.LEFT, prosthetic, without, standing
            )
            self._unplaced.name_leg(self.question.reported)
        else:
            self._unplaced = None
            site_of = {
                name: site
                for name, site in sensors.site_of.items()
                if self._repeated is None or site.side is self._repeated
            }
            self._estimator = FreeMotionEstimator(site_of, visit.live_sensors(), prosthetic, without, standing)
        acquisition.set_estimator(self._estimator)

    def _look_at_motion(self) -> None:
        assert self._estimator is not None
        view, sensors = self._estimator.state, self._visit.sensors
        self._elapsed_s = view.elapsed_s
        if view.site_of and not sensors.site_of:  # the motion has shown it
            sensors.assign_all(view.site_of)
            self._visit.worn.place_once_ended()
            self.question.withdraw()
        had_joints, was_done = bool(self._motion.joints), self._is_done
        self._motion = self._joined(view.motion)
        if sensors.site_of:
            self._seen_at = dict(sensors.site_of)
            sensors.doubt(view.detected)
        else:
            self.ask_for_side(view.chains if view.is_side_open else None)
        enough = self._with_enough() | {joint for joint, hip in self._motion.hips.items() if hip.is_sure}
        if enough - self._enough:
            sounds.play(Sound.READY)
        self._enough = enough
        is_whole = self._is_done and all(one.is_closed for one in self._motion.joints.values()) and not self.is_in_doubt
        if is_whole and not self._settled.isActive():
            self._settled.start()
        elif not is_whole:
            self._settled.stop()
        if was_done != self._is_done or had_joints != bool(self._motion.joints) or self._ticks % (5 * TICKS) == 0:
            self.changed.emit()  # what stopping costs is read, not watched

    def _with_enough(self) -> frozenset[Joint]:
        """The joints whose gauge shows that the motion is enough: one that is no hinge is not among them."""
        states = judged(self._motion, self._visit.prosthetic_joints)
        return frozenset(joint for joint, state in states.items() if state in CLOSED)

    def _joined(self, motion: FreeMotionState) -> FreeMotionState:
        """With what the other leg's motion gave before, if one leg alone is repeated."""
        return replace(
            motion,
            joints={**self._before.joints, **motion.joints},
            lags={**self._before.lags, **motion.lags},
            hips={**self._before.hips, **motion.hips},
        )

    def _other_leg(self, side: Side) -> FreeMotionState:
        """What stays while this leg is repeated; its hip too, for the pelvis is left out."""
        joints = {joint: state for joint, state in self._motion.joints.items() if joint.side is not side}
        lags = {joint: lag for joint, lag in self._motion.lags.items() if joint in joints}
        return FreeMotionState(joints, lags, hips=self._motion.hips)

    def _repeat(self, side: Side) -> None:
        """Begin one leg again, and leave the other as it is."""
        if self._is_recording and self._estimator is not None:
            self._settled.stop()
            self._estimator.repeat(side)
            self._ask_patient()
        elif self._has_moved and any(site.side is side for site in self._visit.sensors.site_of.values()):
            self._begin(side)

    def _repeat_left(self) -> None:
        self._repeat(Side.LEFT)

    def _repeat_right(self) -> None:
        self._repeat(Side.RIGHT)

    def _record_again(self) -> None:
        """Give up what is being recorded, for another."""
        self._then, self._again_side = AfterRecording.ANOTHER, self._repeated
        self._motion = self._replaced or FreeMotionState()
        self._visit.recordings.stop(is_kept=False)

    def _stop(self) -> None:
        self._settled.stop()
        self._then = AfterRecording.NEXT_STEP
        joints = self._motion.joints
        is_kept = not joints or any(state.moved_s > 0 for state in joints.values())
        if not is_kept and self._replaced is not None:
            self._left = tr("No leg moved. The previous free motion still applies."), ""
            self._motion = self._replaced
        elif not is_kept:
            then = tr(
                "Joints are calibrated from the walks, with more uncertainty. Go back to free motion to "
                "record it again."
            )
            self._left = tr("No leg moved, so this free motion is not used."), then
        self._visit.recordings.stop(is_kept=is_kept)
        self.changed.emit()

    def _break_off(self) -> None:
        """Stop without having come to an end, and say what it counts for."""
        if self._is_done:
            self._visit.recordings.stop()
            return
        joints = self._motion.joints
        again = tr("Go back to free motion to record it again.")
        is_kept = self._replaced is None and any(state.moved_s > 0 for state in joints.values())
        if self._replaced is not None:
            self._left = tr("Free motion was left early. The previous one still applies."), again
            self._motion = self._replaced
        elif not is_kept:
            self._left = tr("Free motion was left before a leg moved, so it is not used."), again
        else:
            what = tr("Free motion was left early. It is still used: {enough}.")
            self._left = what.format(enough=enough_for(self._motion, self._visit.prosthetic_joints)), again
        self._visit.recordings.stop(is_kept=is_kept)

    # what somebody has to answer

    @property
    def is_in_doubt(self) -> bool:
        """Whether labels are contradicted, and nobody has answered yet."""
        return bool(self._visit.sensors.detected)

    def ask_for_side(self, chains: "Chains | None") -> None:
        """The motion does not distinguish left from right: both legs began together, or one alone wears sensors."""
        if chains is not None:
            session = self._visit.session
            placed = session.placements[-1].site_of if session is not None and session.placements else {}
            earlier = {name: site.side for name, site in placed.items() if site.side is not None}
            self.question.look(chains, earlier | self._sides_reported)
            self._show_question()

    def _show_question(self) -> None:
        """Show what is to be answered, or what was understood; the page is left alone where that is shown already."""
        words = self.question.words if self._is_recording and not self.is_in_doubt else SILENT
        if words != self._asked_words:
            self._asked_words = words
            self.page.question.ask(*words, is_understood=self.question.reported is not None)

    def _answer(self, number: int) -> None:
        """Let the motion be that of the leg that was named; what was placed already changes legs."""
        self.question.answer(number)
        reported, worn = self.question.reported, self._visit.sensors.site_of
        if reported is not None:
            self._sides_reported[reported[0]] = reported[1]
        if not worn:
            if self._unplaced is not None:
                self._unplaced.name_leg(reported)
        elif reported is not None and reported[0] in worn and worn[reported[0]].side is not reported[1]:
            self._visit.sensors.assign_all({name: opposite(site) for name, site in worn.items()})
            self._on_relabelled()
        self._show_question()

    def _on_relabelled(self) -> None:
        self._visit.worn.place_once_ended()
        self._watch()  # what the motion gave was of other sensors

    def _check_positions(self) -> None:
        self.jumped.emit(StepId.SENSORS)

    def _use_detected(self) -> None:
        """Wear the sensors where the motion puts them: what was recorded is derived again, and the step goes on."""
        sensors = self._visit.sensors
        before, self._doubt_before = dict(sensors.site_of), dict(sensors.detected)
        sensors.use_detected()
        if self._is_recording and not self._is_played:
            self._worn_before = before
            self._on_relabelled()
            self.offered.emit(tr("Sensor positions changed."))
        elif self._is_recording:
            self._on_relabelled()
            self._stop()
        else:
            self._motion = FreeMotionState()
            self._visit.worn.place_as_stated_now()
            self.done.emit()
            self._worn_before = before
            self.offered.emit(tr("Sensor positions changed. Standing reference and calibration are calculated again."))

    # the page

    def _show(self) -> None:
        if self._page is None:
            return
        self._show_question()
        asked, sensors = self._asked(), self._visit.sensors
        if self._is_in_sight:
            prompter.speak(asked.hint.phrase)
        self._page.show_state(
            FreeMotionFace(
                gauges=gauge_faces(self._visit, self._motion, asked.joint),
                hips=hip_faces(self._visit, self._motion, asked.joint),
                hint=asked.hint,
                elapsed_s=self._elapsed_s if self._is_recording else None,
                emphasised=asked.site,
                worn=sensor_marks(sensors),
                swapped=self._swapped,
                moves_to=sensors.detected,
            )
        )

    @property
    def _use_action(self) -> BarAction:
        return BarAction(tr("Use detected positions"), self._use_detected, tr("Enter"), Icon.CHECK)

    @property
    def _check_action(self) -> BarAction:
        return BarAction(tr("Check positions"), self._check_positions, "P")

    @property
    def _swapped(self) -> Swapped | None:
        if not self.is_in_doubt:
            return None
        return Swapped(*self._visit.sensors.doubt_in_words(), self._use_action, self._check_action)

    def _asked(self) -> Asked:
        acquisition, sensors = self._visit.sensors.acquisition, self._visit.sensors
        if self.is_in_doubt:
            return Asked(Hint("", phrase="swapped"))  # the banner is in its place
        if not self._is_recording:
            prosthetic = self._visit.prosthetic_joints
            return Asked(recorded_hint(self._motion, prosthetic) if self._has_moved else first_hint())
        if self._is_played and not self._is_done:
            return Asked(played_hint(has_played=bool(self._plays_s)))
        if sensors.is_left_to_motion and not sensors.site_of:
            return Asked(unplaced_hint())
        return self._hold.ask(self._motion, acquisition.now_s if acquisition is not None else 0.0)

    # slots

    def _on_begun(self) -> None:
        if self._is_recording and self._is_in_sight:  # one that was left before it had begun ends at once
            self._ask_patient()  # only what is recorded counts
            self._watch()

    def _on_refused(self, _what: str, _remedy: str) -> None:
        if self._is_in_sight and not self._visit.recordings.is_recording:
            if self._then is not AfterRecording.NEXT_STEP:
                self._then = AfterRecording.ITSELF if self._has_moved else AfterRecording.WORD
            self.changed.emit()

    def _on_settled(self) -> None:
        if self._is_recording and self._is_done:
            self._stop()

    def _on_ended(self, recording: SessionRecording) -> None:
        if recording.details.kind is not KIND:
            return
        if self._repeated is not None:  # the other leg's sensors are worn as before
            self._repeated = None
            self._visit.place_sensors()
        self.changed.emit()
        if self._then is AfterRecording.NEXT_STEP and self._is_in_sight:
            self._then = AfterRecording.WORD if self._is_unplaced else AfterRecording.ITSELF
            if self._is_unplaced:
                then = tr("Move each leg for longer, or assign the sensors by hand.")
                self.reported.emit(tr("Sensor positions could not be detected."), then)
            elif not self.is_in_doubt:
                self.done.emit()
        if self._left[0]:  # over the step that came next
            self.reported.emit(*self._left)
            self._left = "", ""

"""What came of the walks: curves, figures and findings of those that are kept, and what is put right about them."""

from collections.abc import Callable
from dataclasses import replace
from enum import Enum, auto
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QWidget
from shiboken6 import isValid

from app.results.correct_page import CorrectPage, JointLine, WalkLine
from app.results.detail_pages import DetailPages
from app.results.shown_clips import ClipsOfVisit
from app.summary.agreed import agreed_with
from app.summary.course_lanes import CourseVisit
from app.summary.report_dates import date_of, day
from app.summary.request import AnalysedVisit
from app.summary.visits import WalkedVisit, conditions_in_words, parts_of_visits, visits_by_condition
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.page_stack import PageStack
from app.widgets.rail_row import StepState
from app.widgets.sentence_page import SentencePage
from app.widgets.start_pages import WorkingPage
from app.wizard.keys import Intent, KeyAction
from app.wizard.results.figures import saved_from_library
from app.wizard.results.stride_choice import StrideChoice
from app.wizard.results.videos import VideoActions
from app.wizard.resuming import course_to, courses_before
from app.wizard.step import Step, StepId
from app.wording.body import name_of
from app.wording.findings import place
from app.wording.recordings import shown_names, where_shown
from app.wording.translation import capitalised, tr
from core.body import LEG_JOINTS, Joint
from core.session import RecordingKind

if TYPE_CHECKING:
    from app.editing.session_recording import SessionRecording
    from app.results.result_page import ResultPage
    from app.results.result_parts import ResultParts
    from app.wizard.resuming import EarlierVisit
    from app.wizard.visit import Visit
    from core.results import Analysis
    from core.video.clip import Clip


class Shown(Enum):
    """Which part of the step somebody asked for."""

    RESULTS = auto()  # the curves and figures, or why there are none yet
    CORRECTIONS = auto()  # what can be put right about the walks
    BEHIND = auto()  # how a joint was found, or what an optical system measured, of the analysis that is shown


class ResultsStep(Step):
    id = StepId.RESULTS

    def __init__(self, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(visit, parent)
        self._frame: _ResultsFrame | None = None
        self._shown: Analysis | None = None
        self._held: tuple[object, Analysis] | None = None  # by the page of results, which may be out of sight
        self._before: tuple[UUID | None, tuple[CourseVisit, ...]] = None, ()  # a session, and the visits before it
        self._part = Shown.RESULTS
        self._clips: tuple[Clip, ...] = ()
        self._undos: list[Callable[[], object]] = []  # the latest last
        self._strides = StrideChoice(visit.recordings, self)
        self._strides.offered.connect(self._offer)
        self._videos = VideoActions(visit, self)
        self._videos.reported.connect(self.reported)
        visit.clips.opened.connect(self._on_clips_opened)
        visit.clips.changed.connect(self._on_clips_changed)
        visit.recordings.changed.connect(self._on_recordings_changed)
        visit.changed.connect(self._on_visit_changed)
        visit.evaluation.done.connect(self._on_evaluated)
        visit.evaluation.progressed.connect(self._on_progressed)
        visit.earlier_read.connect(self._on_earlier_read)

    @property
    def page(self) -> "_ResultsFrame":
        if self._frame is None:
            self._frame = _ResultsFrame(self._visit)
            self._frame.sentence.pressed.connect(self._on_sentence_pressed)
            self._frame.behind.refused.connect(self.reported)
            self._frame.behind.writing.connect(self._on_figures_requested)
            self._frame.behind.closed.connect(self._on_answered)
        return self._frame

    @property
    def title(self) -> str:
        return tr("Results")

    @property
    def note(self) -> str:
        kept = sum(one.details.is_kept and one.is_decided for one in self._visit.recordings.walks)
        return tr("{count} included").format(count=kept) if kept else ""  # of those that somebody kept

    @property
    def state(self) -> StepState:
        return StepState.DONE if self._shown is not None and self._kept_walks else StepState.TODO

    @property
    def topic(self) -> str:
        return "results"

    @property
    def _kept_walks(self) -> list[object]:
        return [recording for recording in self._visit.recordings.walks if recording.details.is_kept]

    def prepare(self) -> bool:
        return self.page.prepare()

    def enter(self) -> None:
        if self._kept_walks:
            self._visit.end_stopwatch()
        self._visit.evaluate_if_stale()
        self._read_courses()
        self._visit.clips.open()
        self._show()

    def bar(self) -> BarState:
        if self._shown is None or not self._kept_walks:
            return BarState()
        go_on = BarAction(tr("Write report"), self.done.emit, tr("Enter"), Icon.CHEVRON)
        if self._part is not Shown.RESULTS:
            return BarState(primary=go_on, has_back=self._part is not Shown.BEHIND)
        correct = BarAction(tr("Correct"), self._correct, icon=Icon.REPEAT)
        review = BarAction(tr("Review in Rerun"), self._review, icon=Icon.PLAY)
        results = self.page.results()
        walk = self._walk_named(results.recording.name) if results.recording is not None else None
        clip = results.video.shown.clip if results.video.shown is not None else None
        videos = self._videos.actions(clip, walk, results)
        quiet = videos if results.video.isVisible() else (correct, review, *(videos if clip is None else ()))
        return BarState(primary=go_on, quiet=quiet, note=results.band_words)

    def _correct(self) -> None:
        self._part = Shown.CORRECTIONS
        self._show()
        self.page.correct().focus()

    def _review(self) -> None:
        evaluation = self._visit.evaluation
        session, analysis = evaluation.session, evaluation.analysis
        if session is None or analysis is None:
            return
        if timed := tuple(clip for clip in self._clips if clip.is_synchronised):
            self._videos.ask_review(self.page, timed, partial(self._visit.reviewing.show, session, analysis))
        else:
            self._visit.reviewing.show(session, analysis)

    def on_intent(self, intent: Intent) -> bool:
        if intent.action not in (KeyAction.BACK, KeyAction.LEAVE):
            return False
        if self._part is Shown.BEHIND:
            self._on_answered()
            return True
        return self._part is Shown.RESULTS and self.page.has_results and self.page.results().leave_behind()

    def undo(self) -> None:
        """Take back what was put right last; again, what was before that."""
        if self._undos:
            self._undos.pop()()

    def leave(self) -> None:
        self._part = Shown.RESULTS
        self.page.behind.stop()

    def _show(self) -> None:
        page, evaluation = self.page, self._visit.evaluation
        is_of_shown = evaluation.analysis is self._shown and not evaluation.is_busy
        if self._part is Shown.BEHIND and not is_of_shown:
            self._part = Shown.RESULTS
        if self._part is Shown.CORRECTIONS:
            self._show_corrections()
        elif self._part is Shown.BEHIND:
            pass  # its page is there already
        elif evaluation.is_busy:
            page.working.begin(tr("Analysing the walks"))
            page.setCurrentWidget(page.working)
        elif evaluation.analysis is None or not evaluation.analysis.recordings:
            page.sentence.show_sentence(
                tr("No walk is included yet."), tr("Record a walk, or include an excluded walk."), tr("Go to Walking")
            )
            page.setCurrentWidget(page.sentence)
        else:
            is_new = self._shown is None
            results = page.results()
            if is_new:
                results.set_has_visits(True)
                results.reported.connect(self.changed)
                results.quality.how_found.clicked.connect(self._ask)
                results.quality.agreement.clicked.connect(self._compare)
                results.quality.repeat_requested.connect(lambda _side: self.jumped.emit(StepId.FREE_MOTION))
                results.compare.visits_requested.connect(self._visit.read_earlier)
                results.synchronised.connect(self._visit.clips.synchronise)
                results.strides.turned.connect(self._strides.turn)
                results.strides.all_required.connect(self._strides.take_all_in)
            self._shown = evaluation.analysis
            self._hold(results, evaluation.analysis)
            if page.currentWidget() is not results:
                page.setCurrentWidget(results)
                results.focus()
        self.changed.emit()

    def _hold(self, results: "ResultPage", analysis: "Analysis") -> None:
        session = self._visit.evaluation.session
        if session is None or (self._held is not None and self._held[0] is session and self._held[1] is analysis):
            return
        self._held = session, analysis  # of other words for a walk the same analysis may come
        is_live = self._visit.sensors.acquisition is not None
        visit = AnalysedVisit(session, analysis)
        results.show_visit(visit, can_choose=True, is_live=is_live, course=self._course(visit))

    # what is behind the results

    def _ask(self) -> None:
        evaluation, recording = self._visit.evaluation, self.page.results().recording
        if evaluation.session is not None and evaluation.analysis is not None and recording is not None:
            self.page.behind.show_found(evaluation.session, evaluation.analysis, recording)
            self._show_behind()

    def _compare(self) -> None:
        """Put the session beside an optical system."""
        evaluation = self._visit.evaluation
        if evaluation.session is not None and evaluation.analysis is not None:
            self.page.behind.show_agreement(evaluation.session, evaluation.analysis)
            self._show_behind()

    def _show_behind(self) -> None:
        self._part = Shown.BEHIND
        self._show()
        self.page.behind.focus()

    def _on_answered(self) -> None:
        self._part = Shown.RESULTS
        self.page.behind.stop()
        self._show()

    def _on_figures_requested(self, what: str, folder: Path, write: Callable[[], None]) -> None:
        if (session := self._visit.session) is not None:
            session_id = session.id
            self._visit.controller.run(
                lambda opened: saved_from_library(opened, session_id, what, folder, write),
                self._on_figures_saved,
                self._on_figures_not_saved,
                self,
            )

    def _on_figures_saved(self, folder: Path) -> None:
        self.reported.emit("", "")
        self.page.behind.show_saved(folder)

    def _on_figures_not_saved(self, what: str, remedy: str) -> None:
        self.reported.emit(what, remedy)

    # what is put right

    def _show_corrections(self) -> None:
        page = self._correct_page()
        visit = self._visit
        walks, names = [], visit.recordings.shown_names
        for recording in visit.recordings.walks:
            strides = visit.evaluation.strides(recording.details.name)
            counted = ", ".join(f"{side[0].upper()} {count}" for side, count in strides.items())
            reported = tr("strides {counts}").format(counts=counted) if counted else tr("not analysed")
            walks.append(
                WalkLine(
                    str(recording.id),
                    str(names[recording.details.name]),
                    reported,
                    recording.details.condition,
                    recording.details.is_kept,
                )
            )
        page.show_walks(walks)
        found = visit.evaluation.calibration
        joints = []
        for joint in (joint for joint in LEG_JOINTS if joint in found):
            turned = visit.details.turned_sign.get(joint)
            note = tr("reversed by hand") if turned == -1 else tr("confirmed by hand") if turned == 1 else ""
            if not note:
                note = tr("as detected") if found[joint].is_sign_certain else tr("as detected, uncertain")
            joints.append(JointLine(joint, turned == -1, note))
        page.show_joints(joints)
        is_live = visit.sensors.acquisition is not None
        page.show_sides(tr("While sensors are connected, swap the sides on the Sensors page.") if is_live else "")
        self.page.setCurrentWidget(page)

    def _correct_page(self) -> CorrectPage:
        page, is_new = self.page.correct(), not self.page.has_correct
        if is_new:
            self.page.has_correct = True
            page.condition_typed.connect(self._on_condition_typed)
            page.kept_turned.connect(self._on_kept_turned)
            page.sign_turned.connect(self._on_sign_turned)
            page.swap.clicked.connect(self._on_sides_swapped)
            page.back.clicked.connect(self._on_corrected)
        return page

    def _walk_named(self, name: str) -> "SessionRecording | None":
        return next((walk for walk in self._visit.recordings.walks if walk.details.name == name), None)

    def _on_clips_opened(self, clips: "tuple[Clip, ...]") -> None:
        is_news, self._clips = bool(clips or self._clips), clips
        if is_news and (frame := self._living_frame) is not None and frame.has_results:
            if clips:
                frame.results().show_clips(clips)
            else:
                frame.results().clear_clips()
        self.changed.emit()

    def _on_clips_changed(self) -> None:
        """Show what is new of the videos: one that was made, found in time, or deleted."""
        if self._is_in_sight():
            self._visit.clips.open()

    def _recording(self, key: str) -> "SessionRecording | None":
        return next((recording for recording in self._visit.recordings.walks if str(recording.id) == key), None)

    def _on_condition_typed(self, key: str, condition: str) -> None:
        recording = self._recording(key)
        if recording is None or recording.details.condition == condition:
            return
        before, walk = recording.details.condition, self._visit.recordings.shown_names[recording.details.name]
        self._change_condition(key, condition)
        stated = tr("{walk}: condition now {condition}.") if condition else tr("{walk}: condition not recorded.")
        self._offer(
            stated.format(walk=walk, condition=condition),
            lambda: self._change_condition(key, before),
        )

    def _change_condition(self, key: str, condition: str) -> None:
        if (recording := self._recording(key)) is not None:
            self._visit.recordings.change(recording, lambda reported: replace(reported, condition=condition))

    def _on_kept_turned(self, key: str, is_kept: bool) -> None:
        recording = self._recording(key)
        if recording is None or recording.details.is_kept == is_kept:
            return
        name, reported = recording.details.name, self._visit.recordings.reported
        counting = [
            replace(one, is_kept=True) if one.name == name else one for one in reported
        ]  # else it has no letter
        self._keep(key, is_kept)
        stated = tr("{walk} is included.") if is_kept else tr("{walk} is excluded.")
        walk = capitalised(str(shown_names(counting)[name]))
        self._offer(stated.format(walk=walk), lambda: self._keep(key, not is_kept))

    def _keep(self, key: str, is_kept: bool) -> None:
        if (recording := self._recording(key)) is not None:
            self._visit.recordings.keep(recording, is_kept)

    def _on_sign_turned(self, name: str, is_turned: bool) -> None:
        joint = Joint(name)
        before = self._visit.details.turned_sign.get(joint)
        self._visit.record.set_turned(joint, -1 if is_turned else None)
        stated = tr("{joint}: sign reversed.") if is_turned else tr("{joint}: sign as detected.")
        words = stated.format(joint=capitalised(name_of(joint)))
        self._offer(words, lambda: self._visit.record.set_turned(joint, before))

    def _on_sides_swapped(self) -> None:
        self._visit.worn.swap_sides()
        self._offer(tr("Left and right are swapped."), self._visit.worn.swap_sides)

    def _on_corrected(self) -> None:
        self._part = Shown.RESULTS
        self._show()

    def _offer(self, words: str, undo: Callable[[], object]) -> None:
        self._undos.append(undo)
        self.offered.emit(words)

    # earlier visits

    def _course(self, visit: AnalysedVisit) -> tuple[CourseVisit, ...]:
        stored = self._visit.session
        return (
            () if stored is None else course_to(self._visits_before(stored.id), stored, visit.session, visit.analysis)
        )

    def _visits_before(self, session_id: UUID) -> tuple[CourseVisit, ...]:
        """As they were read; none until then."""
        return self._before[1] if self._before[0] == session_id else ()

    def _read_courses(self) -> None:
        """What was kept of the visits before: changes since then are what the answer reports first."""
        if (session := self._visit.session) is not None:
            self._visit.controller.run(
                lambda opened: (session.id, courses_before(opened, session)),
                self._on_courses,
                self._on_no_courses,
                self,
            )

    def _on_courses(self, before: tuple[UUID, tuple[CourseVisit, ...]]) -> None:
        session_id, visits = before
        is_first, is_news = session_id != self._before[0], visits != self._visits_before(session_id)
        self._before = before
        if is_news:
            self._held = None
            if self._shown is not None and (frame := self._living_frame) is not None:
                self._hold(frame.results(), self._shown)
        if is_first and any(visit.course is None for visit in (*visits[:1], *visits[-1:])):
            self._visit.read_earlier()  # an imported visit: its course is kept then

    def _on_no_courses(self, _what: str, _remedy: str) -> None:
        """No harm: the answer is then of this visit alone."""

    def _on_earlier_read(self, found: "list[EarlierVisit]") -> None:
        """Show the visits in the order of time, this one last."""
        if any(visit.course is None for visit in self._before[1]):
            self._read_courses()
        session = self._visit.evaluation.session
        if self._shown is None or self._living_frame is None or session is None:
            return
        visits = [*((one.session, one.analysis) for one in found), (session, self._shown)]
        named = [
            WalkedVisit(
                reported.started[:10], analysis, reported.recordings, date_of(reported.started), agreed_with(reported)
            )
            for reported, analysis in visits
        ]
        results = self.page.results()
        results.show_visits(visits_by_condition(named), conditions_in_words(named), parts_of_visits(named))
        with_clips = [one for one in found if one.clips]
        results.show_clips_of_visits(
            [
                ClipsOfVisit(day(one.session.started), AnalysedVisit(one.session, one.analysis), one.clips)
                for one in with_clips
            ]
        )

    @property
    def _living_frame(self) -> "_ResultsFrame | None":
        """The page, unless its window has gone before what the library still answers."""
        return self._frame if self._frame is not None and isValid(self._frame) else None

    def _is_in_sight(self) -> bool:
        return self._frame is not None and self._frame.isVisible()

    def _on_recordings_changed(self) -> None:
        if self._is_in_sight():
            was_busy = self._visit.evaluation.is_busy
            self._visit.evaluate_if_stale()
            if self._part is Shown.CORRECTIONS:
                self._show_corrections()
            elif self._visit.evaluation.is_busy and not was_busy:
                self._show()
        self.changed.emit()

    def _on_visit_changed(self) -> None:
        if self._part is Shown.CORRECTIONS and self._is_in_sight():
            self._show_corrections()

    def _on_evaluated(self) -> None:
        if self._is_in_sight():
            self._visit.evaluate_if_stale()  # something may have been put right meanwhile
        frame, analysis = self._frame, self._visit.evaluation.analysis
        if frame is None or analysis is None:
            return
        has_walk = any(one.kind is RecordingKind.WALKING for one in analysis.recordings)
        if has_walk and frame.has_results and not self._visit.recordings.is_recording:
            self._hold(frame.results(), analysis)  # before somebody comes, who would wait for it then
        if frame.isVisible() and frame.currentWidget() is frame.working:
            QTimer.singleShot(0, self, self._show)  # filling the page and painting it would hold up the screen together
        elif frame.isVisible():
            self._show()

    def _on_progressed(self, share: float, what: str) -> None:
        if self._is_in_sight():
            words = place(where_shown(what, self._visit.recordings.shown_names))
            self.page.working.show_progress(share, words[:1].upper() + words[1:])

    def _on_sentence_pressed(self) -> None:
        self.jumped.emit(StepId.WALKING)


class _ResultsFrame(PageStack):
    """The results, or what is in their place."""

    def __init__(self, visit: "Visit") -> None:
        super().__init__()
        self.behind = DetailPages(self, visit.looking, visit.comparing, self)
        self.sentence = SentencePage()
        self.working = WorkingPage()
        self.working.stop.hide()  # an analysis takes a second; there is nothing to go back to
        self._parts: ResultParts | None = None
        self._results: ResultPage | None = None
        self._correct: CorrectPage | None = None
        self.has_correct = False
        self._room = (0.0, 0.0)
        for page in (self.sentence, self.working):
            self.addWidget(page)

    def prepare(self) -> bool:
        """Make the next part of the results; whether there was one."""
        if self._results is not None:
            return False
        from app.results.result_parts import ResultParts  # as below

        self._parts = self._parts or ResultParts()
        if not self._parts.make_next():
            self.results()
        return True

    @property
    def has_results(self) -> bool:
        return self._results is not None

    def results(self) -> "ResultPage":
        if self._results is None:
            from app.results.result_page import ResultPage  # its imports take a second

            self._results = ResultPage(self._parts)
            self._results.set_room(*self._room)
            self.addWidget(self._results)
        return self._results

    def correct(self) -> CorrectPage:
        if self._correct is None:
            self._correct = CorrectPage()
            self._correct.set_room(*self._room)
            self.addWidget(self._correct)
        return self._correct

    def set_room(self, width: float, height: float) -> None:
        self._room = width, height
        self.behind.set_room(width, height)
        if self._results is not None:
            self._results.set_room(width, height)
        if self._correct is not None:
            self._correct.set_room(width, height)

    def focus(self) -> None:
        shown: QWidget | None = self.currentWidget()
        if self._results is not None and shown is self._results:
            self._results.focus()
        elif shown is self.sentence:
            self.sentence.button.setFocus()
        else:
            self.behind.focus()

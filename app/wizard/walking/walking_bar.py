"""What can be done on the Walking step, as the bar below it says: while a walk is recorded, and between two walks."""

from dataclasses import replace
from enum import Enum, auto
from typing import TYPE_CHECKING

from app.system import sounds
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState, RecordingNote
from app.wizard.walking.bench_bar import bench_bar
from app.wizard.walking.bench_control import Bench
from app.wizard.walking.memory_control import MemoryControl
from app.wizard.walking.timed_bar import timed_bar
from app.wizard.walking.timed_control import TimedControl
from app.wizard.walking.walk_notice import asked_walk
from app.wizard.walking.walk_rows import ongoing_walk
from app.wizard.walking.walk_start import WalkStart
from app.wording.timed_tests import name_of_test
from app.wording.translation import capitalised, tr, within_sentence

if TYPE_CHECKING:
    from app.editing.session_recording import Ongoing
    from app.wizard.visit import Visit


class QuietAction(Enum):
    """What one of the quiet actions does."""

    BENCH = auto()  # shows the bench, or all walks in its place
    DISCARD = auto()  # the walk that waits to be kept
    MEMORY = auto()  # what the sensors' memories have to offer
    PATIENT_SCREEN = auto()


class WalkingBar:
    """Knows the visit and what is joined to it, and no page."""

    def __init__(
        self, visit: "Visit", start: WalkStart, bench: Bench, timed: TimedControl, memory: MemoryControl
    ) -> None:
        self._visit, self._start = visit, start
        self._bench, self._timed, self._memory = bench, timed, memory

    def state(self, label: str) -> BarState:
        """All of the bar; `label`: what the next walk is called."""
        return replace(self._state(label), quiet=tuple(self.quiet.values()))

    @property
    def quiet(self) -> dict[QuietAction, BarAction]:
        """The quiet actions in their order, by what they do."""
        offered: dict[QuietAction, BarAction] = {}
        is_between = not self._visit.recordings.is_recording and not self.has_memory
        if is_between and self._bench.is_shown:
            offered[QuietAction.BENCH] = BarAction(tr("Walks"))
            if asked_walk(self._visit.recordings) is not None:
                offered[QuietAction.DISCARD] = BarAction(tr("Exclude"), "X")
        elif is_between:
            if self._bench.is_offered:
                offered[QuietAction.BENCH] = BarAction(tr("Alignment"))
            if (memory := self._memory.quiet(wants_live=self._timed.planned is not None)) is not None:
                offered[QuietAction.MEMORY] = memory
        if not self._bench.is_shown and not self._timed.is_running:  # the bench has no room for it; the key is there
            offered[QuietAction.PATIENT_SCREEN] = BarAction(tr("Patient screen"), "F8")
        return offered

    @property
    def has_memory(self) -> bool:
        """Whether the bar is about the sensors' memories: nothing else can be done then."""
        visit, recordings = self._visit, self._visit.recordings
        is_between = not recordings.is_recording or recordings.is_stopping
        is_held_up = bool(visit.cannot_record) or recordings.must_move or not visit.sensors.site_of
        return is_between and not is_held_up and self._memory.bar() is not None

    def _state(self, label: str) -> BarState:
        recordings = self._visit.recordings
        walk = ongoing_walk(recordings)
        if walk is not None and not recordings.is_stopping:
            return self._of_walk(walk)
        if self.has_memory:
            return self._memory.bar() or BarState()
        if walk is not None:
            return BarState(primary=self._start_action, note=tr("The walk is being loaded."))
        if recordings.ongoing is not None:  # of the step before
            said = f"{capitalised(recordings.called(recordings.ongoing.details.name))}: {tr('being loaded')}"
            return BarState(primary=self._start_action, note=said)
        if self._bench.is_shown:
            asked = asked_walk(recordings)
            letter = None if asked is None else recordings.shown_names[asked.details.name].letter
            note = self._start.missing_now or self._armed(self._bench.next_walk()[0])
            return bench_bar(self._bench, letter, self._test_words, note, self._start.is_possible)
        return self._between_walks(label)

    def _of_walk(self, walk: "Ongoing") -> BarState:
        acquisition, recordings = self._visit.sensors.acquisition, self._visit.recordings
        elapsed_s = 0.0 if acquisition is None else max(0.0, acquisition.now_s - walk.began_s)
        if self._timed.is_running:
            return timed_bar(self._timed, elapsed_s)
        return BarState(
            primary=BarAction(tr("Stop walk"), tr("Space"), Icon.STOP),
            recording=RecordingNote(
                tr("Recording {walk}").format(walk=recordings.called(walk.details.name)),
                " ".join(filter(None, [self._saved(), tr("The space bar stops it, with a sound.")])),
                elapsed_s,
                sounds.is_on(),
            ),
            has_back=False,
        )

    def _between_walks(self, label: str) -> BarState:
        """Where there is no bench."""
        recordings, start, missing = self._visit.recordings, self._start_action, self._start.missing_now
        if asked_walk(recordings) is not None:
            words = tr("Include, start next")
            if test := self._timed.planned:
                words = tr("Include, start {test}").format(test=within_sentence(name_of_test(test.protocol)))
            both = replace(start, text=words, is_wished=False)
            return BarState(primary=both, note=missing or self._timed.next_words(label))
        if any(recording.details.is_kept for recording in recordings.walks):
            results = BarAction(tr("Results"), "", Icon.NEXT)
            note = missing or self._armed(label)
            return BarState(primary=results, others=(replace(start, is_wished=False),), note=note)
        note = self._timed.next_words(label)
        if not recordings.has_moved:
            note = tr("Without free motion, joint angles are uncertain or missing.")
        return BarState(primary=start, note=missing or note)

    @property
    def _start_action(self) -> BarAction:
        words = self._test_words or tr("Start walk")
        return BarAction(words, tr("Space"), Icon.PLAY, is_enabled=self._start.is_possible)

    @property
    def _test_words(self) -> str:
        """What the key starts where a timed test is chosen; empty where none is."""
        test = self._timed.planned
        return "" if test is None else tr("Start {test}").format(test=within_sentence(name_of_test(test.protocol)))

    def _armed(self, label: str) -> str:
        """What the next walk is, where it is a timed test: T chooses one also where no chooser is in sight."""
        return "" if self._timed.planned is None else self._timed.next_words(label)

    def _saved(self) -> str:
        """Say that what comes in is saved, only while the journal has it so."""
        recordings = self._visit.recordings
        if not recordings.has_begun:
            return tr("Recording starts in a moment.")
        if recordings.is_in_memory:
            return tr("Stored in the sensors.")
        return tr("Saved continuously.") if recordings.is_written else ""

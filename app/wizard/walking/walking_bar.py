"""What can be done on the Walking step, as the bar below it shows: while a walk is recorded, and between two walks."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from app.system import sounds
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState, RecordingNote
from app.wizard.walking.bench_control import Bench
from app.wizard.walking.memory_control import MemoryControl
from app.wizard.walking.timed_control import TimedControl
from app.wizard.walking.walk_notice import asked_walk
from app.wizard.walking.walk_rows import ongoing_walk
from app.wizard.walking.walk_start import WalkStart
from app.wording.timed_tests import name_of_test, name_within_sentence
from app.wording.translation import capitalised, tr
from core.timed.protocols import DEFINITIONS, course_of

if TYPE_CHECKING:
    from app.editing.session_recording import Ongoing
    from app.wizard.visit import Visit
    from app.wizard.walking.step import WalkingStep


RETURN_KEY = "R"  # at the bench, where it repeats no leg


class WalkingBar:
    """Knows the visit and what is joined to it, and no page."""

    def __init__(
        self,
        walks: "WalkingStep",
        visit: "Visit",
        start: WalkStart,
        bench: Bench,
        timed: TimedControl,
        memory: MemoryControl,
    ) -> None:
        self._walks, self._visit, self._start = walks, visit, start
        self._bench, self._timed, self._memory = bench, timed, memory

    def state(self, label: str) -> BarState:
        """All of the bar; `label`: what the next walk is called."""
        return replace(self._state(label), quiet=tuple(self._quiet()))

    def _quiet(self) -> Iterator[BarAction]:
        is_between = not self._visit.recordings.is_recording and not self._has_memory
        if is_between and self._bench.is_shown:
            yield BarAction(tr("Walks"), self._bench.turn)
            if asked_walk(self._visit.recordings) is not None:
                yield BarAction(tr("Exclude"), self._walks.discard, "X")
        elif is_between:
            if self._bench.is_offered:
                yield BarAction(tr("Alignment"), self._bench.turn)
            if (memory := self._memory.quiet(wants_live=self._timed.planned is not None)) is not None:
                yield memory
        if not self._bench.is_shown and not self._timed.is_running:  # the bench has no room for it; the key is there
            yield BarAction(tr("Patient screen"), self._walks.toggle_patient_screen, "F8")

    @property
    def _has_memory(self) -> bool:
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
        if self._has_memory:
            return self._memory.bar() or BarState()
        if walk is not None:
            return BarState(primary=self._start_action, note=tr("The walk is being loaded."))
        if recordings.ongoing is not None:  # of the step before
            stated = f"{capitalised(recordings.called(recordings.ongoing.details.name))}: {tr('being loaded')}"
            return BarState(primary=self._start_action, note=stated)
        if self._bench.is_shown:
            return self._at_bench()
        return self._between_walks(label)

    def _of_walk(self, walk: "Ongoing") -> BarState:
        acquisition, recordings = self._visit.sensors.acquisition, self._visit.recordings
        elapsed_s = 0.0 if acquisition is None else max(0.0, acquisition.now_s - walk.began_s)
        if self._timed.is_running:
            return self._of_test(elapsed_s)
        return BarState(
            primary=BarAction(tr("Stop walk"), self._walks.run, tr("Space"), Icon.STOP),
            recording=RecordingNote(
                tr("Recording {walk}").format(walk=recordings.called(walk.details.name)),
                " ".join(filter(None, [self._saved(), tr("The space bar stops the walk, with a sound.")])),
                elapsed_s,
                sounds.is_on(),
            ),
            has_back=False,
        )

    def _of_test(self, elapsed_s: float) -> BarState:
        """While a timed test runs: end it, or break it off."""
        readout = self._timed.readout
        assert readout is not None
        definition = DEFINITIONS[readout.planned.protocol]
        if math.isfinite(self._timed.end_s):
            verb = tr("Stop") if readout.planned.end_key_s is not None else tr("End at the tape")
            note = tr("The test is over; recording stops shortly.")
            verb = verb if definition.length_m is not None else tr("Stop")
        elif not readout.has_begun:
            verb, note = (
                tr("Start the clock"),
                tr("The clock starts with the patient's movement. Space or a clicker starts it manually."),
            )
        elif definition.length_m is not None:
            verb = tr("End at the tape")
            stated = tr("Press Space at the end of the tape. The distance then counts as {length:.2f} m.")
            note = stated.format(length=course_of(readout.planned))
        else:
            verb, note = (
                tr("End the test"),
                tr("Space or a clicker ends the test now. Otherwise it ends automatically."),
            )
        return BarState(
            primary=BarAction(verb, self._walks.run, tr("Space"), Icon.STOP),
            others=(BarAction(tr("Cancel"), self._walks.stop, tr("Esc"), is_requested=False),),
            recording=RecordingNote(
                tr("Recording the full test: {test}").format(test=name_of_test(readout.planned.protocol)),
                note,
                elapsed_s,
                sounds.is_on(),
            ),
            has_back=False,
        )

    def _at_bench(self) -> BarState:
        """Between two walks: walk on, keep, return to where it began."""
        chain, is_new = self._bench.chain, bool(self._bench.entry.parts)
        letter = chain.letters.get(chain.base, "")
        if is_new or chain.is_back:
            letter = chain.next_letter if is_new else chain.again_letter
        words = tr("Walk with {letter}") if is_new or chain.is_back else tr("Repeat {letter}")
        words = words.format(letter=letter)
        others = [replace(self._start_action, text=self._test_words or words, is_requested=False)]
        if chain.way_back(chain.first):
            words = tr("Return to {letter}").format(letter=chain.letters.get(chain.first, ""))
            back = BarAction(words, self._walks.return_to_first, RETURN_KEY, Icon.REPEAT, is_requested=False)
            others.insert(0, back)
        primary = self._results_action
        if (asked := asked_walk(self._visit.recordings)) is not None:
            letter = self._visit.recordings.shown_names[asked.details.name].letter
            words = tr("Include {letter}").format(letter=letter)
            primary = BarAction(words, self._walks.keep_at_bench, tr("Enter"), Icon.CHECK)
        note = self._start.missing_now or self._armed(self._bench.next_walk()[0])
        return BarState(primary=primary, others=tuple(others), note=note)

    def _between_walks(self, label: str) -> BarState:
        """Where there is no bench."""
        recordings, start, missing = self._visit.recordings, self._start_action, self._start.missing_now
        if asked_walk(recordings) is not None:
            words = tr("Include, start next")
            if test := self._timed.planned:
                words = tr("Include, start {test}").format(test=name_within_sentence(test.protocol))
            both = replace(start, text=words, is_requested=False)
            return BarState(primary=both, note=missing or self._timed.next_words(label))
        if any(recording.details.is_kept for recording in recordings.walks):
            others = (replace(start, is_requested=False),)
            return BarState(primary=self._results_action, others=others, note=missing or self._armed(label))
        note = self._timed.next_words(label)
        if not recordings.has_moved:
            note = tr("Without free motion, joint angles are uncertain or missing.")
        return BarState(primary=start, note=missing or note)

    @property
    def _start_action(self) -> BarAction:
        words = self._test_words or tr("Start walk")
        return BarAction(words, self._walks.run, tr("Space"), Icon.PLAY, is_enabled=self._start.is_possible)

    @property
    def _results_action(self) -> BarAction:
        return BarAction(tr("Results"), self._walks.go_on, icon=Icon.NEXT)

    @property
    def _test_words(self) -> str:
        """What the key starts where a timed test is chosen; empty where none is."""
        test = self._timed.planned
        return "" if test is None else tr("Start {test}").format(test=name_within_sentence(test.protocol))

    def _armed(self, label: str) -> str:
        """Which test the next walk is, or that it is none: T chooses one also where no chooser is in sight."""
        return tr("No timed test; T chooses one.") if self._timed.planned is None else self._timed.next_words(label)

    def _saved(self) -> str:
        """Say that what comes in is saved, only while the journal has it so."""
        recordings = self._visit.recordings
        if not recordings.has_begun:
            return tr("Recording starts in a moment.")
        if recordings.is_in_memory:
            return tr("Stored in the sensors.")
        return tr("Saved continuously.") if recordings.is_written else ""

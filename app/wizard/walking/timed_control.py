"""What joins timed tests to the visit: which test comes next, its clock, and what a key means while it runs."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal, Slot

from app.storage.journal.payloads import key_text
from app.summary.course_lanes import LaneKind, lanes
from app.summary.numbers_in_words import fixed
from app.summary.timed_words import populations_of, published_sentence
from app.system import sounds
from app.system.sounds import Sound
from app.wizard.evaluation import failure_in_words
from app.wizard.walking.earlier_tests import EarlierTests
from app.wizard.walking.timed_result import TimedAttempt, TimedResult
from app.wizard.walking.timed_view import TimedViewState
from app.wording.dates import short_date
from app.wording.measures import decimals, short_unit
from app.wording.recordings import name_in_words
from app.wording.timed_tests import name_of_test
from app.wording.translation import tr
from core.body import Segment
from core.timed.found import TimedTest
from core.timed.live import RUN_OUT_S, LiveReadout, LiveTest
from core.timed.measures import COLUMNS
from core.timed.protocols import DEFINITIONS, KeyMeaning, PlannedTest, TimedProtocol, with_course

if TYPE_CHECKING:
    from app.editing.session_recording import SessionRecording
    from app.summary.course import Course
    from app.summary.course_lanes import CourseLane, CourseVisit
    from app.wizard.visit import Visit
    from app.wizard.walking.estimator import WalkingEstimator


class TimedControl(QObject):
    """Knows the visit and no page."""

    changed = Signal()  # something else is to be shown

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self.earlier = EarlierTests(visit, self)
        self.earlier.changed.connect(self.changed)
        self.protocol: TimedProtocol | None = None
        self._courses_m: dict[TimedProtocol, float | None] = {}  # as entered
        self._corrected: PlannedTest | None = None  # until it is stored
        self.is_course_wrong = False  # what was typed is no length
        self._estimator: WalkingEstimator | None = None
        self._live: LiveTest | None = None
        self._has_begun = self._is_over = False
        self._pressed_end_s = math.nan
        visit.recordings.changed.connect(self._on_recordings_changed)

    @property
    def planned(self) -> PlannedTest | None:
        """What the next walk is, as its recording names it."""
        if self.protocol is None:
            return None
        return with_course(PlannedTest(self.protocol), self._courses_m.get(self.protocol))

    @property
    def is_running(self) -> bool:
        return self._live is not None

    @property
    def readout(self) -> LiveReadout | None:
        """The state of the test that is recorded; None where none is."""
        return None if self._live is None else self._live.state

    @property
    def now_s(self) -> float:
        acquisition = self._visit.sensors.acquisition
        return math.nan if acquisition is None else acquisition.now_s

    def choose(self, protocol: TimedProtocol | None) -> None:
        if protocol is not self.protocol:
            self.protocol, self.is_course_wrong = protocol, False
            self.changed.emit()

    def choose_next(self) -> None:
        """Choose the test after the one in force; after the last none."""
        every: list[TimedProtocol | None] = [None, *TimedProtocol]
        self.choose(every[(every.index(self.protocol) + 1) % len(every)])

    def enter_course(self, length_m: float | None) -> None:
        """Take the length of the course of the chosen test, as long as it is laid out so."""
        if self.protocol is not None and length_m != self._courses_m.get(self.protocol):
            self._courses_m[self.protocol] = length_m
            self.changed.emit()

    def begin(self, began_s: float) -> None:
        """The recording of the test that was chosen begins, if one was."""
        self._live = None
        self._has_begun = self._is_over = False
        self._pressed_end_s = math.nan
        if (planned := self.planned) is None:
            return
        visit, worn = self._visit, self._visit.sensors.site_of
        upright = {
            site: visit.rests[name].acc_m_s2
            for name, site in worn.items()
            if site.segment is Segment.THIGH and name in visit.rests
        }
        feet = frozenset(site.side for site in worn.values() if site.segment is Segment.FOOT and site.side is not None)
        self._live = LiveTest(planned, upright, visit.prosthetic_sides, feet, began_s)
        self.watch(self._estimator)

    @Slot(object)
    def watch(self, estimator: "WalkingEstimator | None") -> None:
        """Give the samples of this estimator to the test, and to those that follow."""
        self._estimator = estimator
        if estimator is not None:
            estimator.test = self._live

    def press(self) -> bool:
        """Take a key; return whether the test has a use for it. A key for which it has none stops the recording."""
        live = self._live
        if live is None or not self._visit.recordings.has_begun or math.isfinite(self._pressed_end_s):
            return False
        now_s = self.now_s
        meaning = live.press(now_s)
        if meaning is None:
            return False
        self._visit.recordings.mark(key_text(meaning))
        if meaning is KeyMeaning.END:
            self._pressed_end_s = now_s
        self.changed.emit()
        return True

    def tick(self) -> bool:
        """Play the sounds of start and end; return whether the test is over and its run-out too."""
        live = self._live
        if live is None:
            return False
        state, now_s = live.state, self.now_s
        if state.has_begun and not self._has_begun:
            self._has_begun = True
            sounds.play(Sound.START)
            self.changed.emit()
        end_s = self.end_s
        if math.isfinite(end_s) and not self._is_over:
            self._is_over = True
            sounds.play(Sound.STOP)
            self.changed.emit()
        return self._is_over and now_s > end_s + RUN_OUT_S

    @property
    def end_s(self) -> float:
        """When the clock stopped; NaN while it runs. A set time passes whether or not a sensor sends samples."""
        live = self._live
        if live is None:
            return math.nan
        state, duration_s = live.state, DEFINITIONS[live.planned.protocol].duration_s
        if state.is_over or duration_s is None or not state.has_begun:
            return state.end_s
        due_s = state.start_s + duration_s
        return due_s if self.now_s >= due_s else math.nan

    def end(self) -> bool:
        """The recording has ended; return whether the sound of the test's end was played."""
        self._live = None
        self.watch(self._estimator)
        return self._is_over

    def view(self) -> TimedViewState | None:
        """What is shown while a test is recorded."""
        ongoing = self._visit.recordings.ongoing
        if self._live is None or ongoing is None:
            return None
        earlier = sum(one.protocol is self._live.planned.protocol and one.is_kept for one in self.attempts())
        attempt = tr("attempt {number}").format(number=earlier + 1)
        note = ", ".join(filter(None, [name_in_words(ongoing.details.condition), attempt]))
        return TimedViewState(self._live.state, note, self.now_s, self.end_s)

    def result(self) -> TimedResult | None:
        """What is shown of the latest walk if it was a test: every attempt at the same one; None where it was none."""
        recordings = self._visit.recordings
        if not recordings.walks or recordings.walks[-1].details.test is None:
            return None
        every = self.attempts()
        same = [one for one in every if one.protocol is every[-1].protocol]
        names = recordings.shown_names
        return TimedResult(
            same,
            [str(names[one.name]) for one in same],
            *self._course(every[-1].protocol),
            published=published_sentence(every[-1].protocol, populations_of(self._visit.patient.details)),
            failure=failure_in_words() if self._visit.evaluation.has_failed else None,
        )

    def correct(self, planned: PlannedTest) -> None:
        """Take what was entered of the latest test after it."""
        walk = self._visit.recordings.walks[-1]
        self._corrected = planned
        self._visit.recordings.change(walk, lambda reported: replace(reported, test=planned))

    @property
    def has_result(self) -> bool:
        """Whether the latest walk was a test, and none is recorded."""
        recordings = self._visit.recordings
        return bool(recordings.walks) and not recordings.is_recording and recordings.walks[-1].details.test is not None

    def _course(self, protocol: TimedProtocol) -> "tuple[tuple[CourseVisit, ...], CourseLane | None]":
        """The visits, and over them what a test is made for, under the condition of the latest walk."""
        if protocol not in COLUMNS:
            return (), None
        condition, goals = self._visit.recordings.walks[-1].details.returned_to, self._visit.patient.details.goals
        kind = LaneKind(COLUMNS[protocol])
        own = [goal for goal in goals if goal.column == kind.column]
        visits = [one for one in self.earlier.with_this_one() if one.course and _has(one.course, kind, condition)]
        (lane,) = lanes(visits, condition, own, (kind,))
        return tuple(visits), lane if len(visits) > 1 else None

    def before(self, condition: str) -> dict[TimedProtocol, str]:
        """What came of each test at the latest earlier visit under a condition: "3 Oct: 11.4 s"."""
        stated = {}
        for protocol, column in COLUMNS.items():
            if (found := self.earlier.latest(column, condition)) is not None:
                visit, test = found
                value = fixed(test.found.mean, decimals(column)) + short_unit(column)
                stated[protocol] = f"{short_date(visit.day)}: {value}"
        return stated

    def next_words(self, label: str) -> str:
        """What the next walk is."""
        if self.protocol is None:
            return tr("Next: {label}").format(label=label)
        return tr("Next: {test}, {label}").format(test=name_of_test(self.protocol), label=label)

    def attempts(self) -> tuple[TimedAttempt, ...]:
        """Every test of this session in the order of recording."""
        return tuple(
            TimedAttempt(one.details.name, one.details.test, self._found(one), one.details.is_kept)
            for one in self._visit.recordings.walks
            if one.details.test is not None
        )

    def _found(self, recording: "SessionRecording") -> TimedTest | None:
        analysis = self._visit.evaluation.analysis
        walks = () if analysis is None else analysis.recordings
        return next((one.timed for one in walks if one.name == recording.details.name), None)

    @Slot()
    def _on_recordings_changed(self) -> None:
        """A recording that was refused, or that a full disk has ended, ends the test too."""
        recordings = self._visit.recordings
        if self._corrected is not None and recordings.walks and recordings.walks[-1].details.test == self._corrected:
            self._corrected = None
            self._visit.evaluate_if_stale()
        if self._live is not None and (recordings.is_stopping or not recordings.is_recording):
            self.end()
            self.changed.emit()

    @Slot(str)
    def on_chosen(self, value: str) -> None:
        """Of the card: the value of a protocol, or nothing."""
        self.choose(TimedProtocol(value) if value else None)


def _has(course: "Course", kind: LaneKind, condition: str) -> bool:
    walked = course.condition(condition)
    return walked is not None and walked.test(kind.column) is not None

"""The demonstration's patient: standing, moving and walking when asked, and performing every timed test."""

import threading
from collections.abc import Callable, Sequence
from dataclasses import replace

from core.session import RecordingKind
from core.timed.protocols import PlannedTest
from devices.clocks.host_clock import host_time_ns
from devices.simulation.replay import DEMONSTRATION_SESSION, ReplaySource, moved
from devices.simulation.walker import CourseKind, Standing, TimedCourse, Walk, WalkerSettings

SPEED_M_S = 1.19  # as in the demonstration's walks
BESIDE_TAPES_M = 5.0  # 2 m before the first tape, and beyond the second


class DemonstrationPatient(ReplaySource):
    """Plays what `settings` require; a timed test is made when it is asked for.

    That takes some tenths of a second, of six minutes some seconds, in which the patient is standing. No two attempts
    at a test are alike. To make the patient takes a second or two.

    Parameters
    ----------
    now_ns
        As of `ReplaySource`.
    """

    course_speed_m_s = SPEED_M_S

    def __init__(
        self,
        settings: WalkerSettings = DEMONSTRATION_SESSION,
        *,
        speed: float = 1.0,
        now_ns: Callable[[], int] = host_time_ns,
    ) -> None:
        super().__init__(moved(settings), finishes=True, speed=speed, now_ns=now_ns)
        self._settings = settings
        self._asking = threading.Lock()  # of all below
        self._times_asked = self._courses = 0

    def ask(self, kind: RecordingKind | None) -> float | None:
        with self._asking:
            self._times_asked += 1
        return super().ask(kind)

    def perform(self, planned: PlannedTest) -> None:
        """Perform a timed test on a course as it is planned, then stand."""
        with self._asking:
            self._courses += 1
            kind, seed = CourseKind(str(planned.protocol)), self._settings.seed + self._courses
        course = TimedCourse(kind, seed, self.course_speed_m_s, is_joined=True)
        if planned.lap_m is not None:
            course = replace(course, lap_m=planned.lap_m)
        if planned.course_m is not None:
            straight_m = planned.course_m + BESIDE_TAPES_M
            there_and_back = replace(course.up_and_go, cone_m=planned.course_m)
            course = replace(course, straight_m=straight_m, up_and_go=there_and_back)
        self._walk([course])

    def _walk(self, walks: Sequence[Walk | TimedCourse]) -> None:
        """Walk the last of these, which is made beside; not where something else is asked meanwhile."""
        with self._asking:
            self._times_asked += 1
            asked = self._times_asked
        threading.Thread(target=self._make, args=(asked, walks), name="simulated walk", daemon=True).start()

    def _make(self, asked: int, walks: Sequence[Walk | TimedCourse]) -> None:
        made = moved(replace(self._settings, recordings=(Standing(duration_s=1.0), *walks))).recordings[-1]
        with self._asking:
            if asked == self._times_asked:
                self.play(made)

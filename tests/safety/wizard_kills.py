"""Lead a session to a point and leave it there, for whoever kills it. Used to check what can be found again afterwards.

    python -m tests.safety.wizard_kills LIBRARY PASSPHRASE POINT [--pelvis]

The whole window without a display, on a library with one patient coded for simulations, whose time runs twenty times
as fast as ours. When the point is reached it prints one line of JSON, what was stated and recorded until then, and
waits.
"""

import json
import os
import sys
from collections.abc import Callable
from dataclasses import replace
from enum import StrEnum
from pathlib import Path

os.environ["QT_QPA_PLATFORM"] = "offscreen"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.main_window import MainWindow
from app.wizard.keys import Intent, KeyAction
from app.wizard.report.step import ReportStep
from app.wizard.results.step import ResultsStep
from app.wizard.step import StepId
from core.body import LEG_SITES, Joint, Side, Site
from core.session import RecordingKind
from tests.driver import options
from tests.safety.window_material import application, begun_visit, fast_patient, linger, offer, put_on, wait, window_in

SPEED = 20.0
WALKED_S = 14.0
COMMENT = "Walks further than in spring; the left foot drags."
CONDITION = "alignment B"
WAITS_S = 120.0  # for its end, if nobody comes


class Point(StrEnum):
    WALKING = "walking"  # amid a walk
    ASKED = "asked"  # after a walk, which is neither kept nor discarded
    RESULTS = "results"  # when strides, a condition, a sign and a walk's keeping were corrected
    REPORT = "report"  # when a comment was typed
    SAVING = "saving"  # while the report is written


class Guide:
    """Leads the window from point to point."""

    def __init__(self, application: QApplication, window: MainWindow) -> None:
        self._application, self._window = application, window

    def begin(self, library: Path, passphrase: str, sites: tuple[Site, ...]) -> None:
        """Open the library, begin a session with its patient, put the sensors on, stand and move."""
        window = self._window
        window.controller.open(lambda holder: holder.open(library, passphrase))
        self._wait(lambda: window.home is not None and window.home.patients.patient is not None)
        self.wizard, self.visit = begun_visit(self._application, window)
        self._wait(lambda: len(self.visit.sensors.status) == len(sites))
        self.acquisition = put_on(self.visit, sites)
        self.wizard.go_to(StepId.STAND_STILL)
        self._wait(lambda: self.visit.session is not None and bool(self.visit.session.placements))
        self._record(RecordingKind.STANDING, 6.0)
        self._record(RecordingKind.FREE_MOTION, WALKED_S)
        self.wizard.go_to(StepId.WALKING)

    def walk(self) -> None:
        """Record a walk, and answer nothing."""
        self.wizard.act_on(Intent(KeyAction.RUN))
        self._wait(lambda: self.visit.recordings.has_begun)
        self._began_s = self.acquisition.now_s
        linger(self._application, WALKED_S / SPEED)

    def stop(self) -> None:
        count = len(self.visit.recordings.walks)
        self.wizard.act_on(Intent(KeyAction.RUN))
        self._wait(lambda: len(self.visit.recordings.walks) > count and self.visit.recordings.is_idle)

    def keep(self) -> None:
        self.wizard.act_on(Intent(KeyAction.KEEP))
        self._wait(lambda: self.visit.recordings.walks[-1].stored.is_decided)

    def correct(self) -> None:
        """Leave a stride out, name a condition, turn a sign, and let the second walk not count."""
        self.wizard.go_to(StepId.RESULTS)
        self._wait(lambda: self.visit.evaluation.analysis is not None and not self.visit.evaluation.is_busy)
        first, second = self.visit.recordings.walks
        step = self._results
        self.visit.recordings.change(first, lambda reported: replace(reported, left_out_s={Side.LEFT: (4.0,)}))
        step._on_condition_typed(str(first.id), CONDITION)  # before the library has the stride: both hold
        step._on_sign_turned(str(Joint.LEFT_KNEE), True)
        step._on_kept_turned(str(second.id), False)
        self._wait(lambda: bool(self.visit.details.turned_sign) and not self.visit.recordings.walks[1].details.is_kept)
        linger(self._application, 0.5)

    def comment(self) -> None:
        self.wizard.go_to(StepId.REPORT)
        page = self._report.page.report
        self._wait(page.isVisible)
        QTest.keyClicks(page.comment, COMMENT)
        assert self._window.controller.state is not None
        assert self.visit.session is not None
        sessions, session_id = self._window.controller.state.library.library.sessions, self.visit.session.id
        self._wait(lambda: sessions.get(session_id).comment == COMMENT)  # half a second after the last letter

    def save(self) -> None:
        """Begin to write the report, and see that it has begun."""
        assert self._window.controller.state is not None
        out = self._window.controller.state.library.folder.parent / "out"
        self._report.save_in(str(out))
        self._wait(lambda: any(out.parent.glob(f".{out.name}-*/new/*")))

    def show_message(self) -> None:
        """Print what was stated and recorded."""
        assert self.visit.session is not None
        received = self.acquisition.latest(self.acquisition.sensors[0], 29.0)  # as long as it holds
        recordings = {
            recording.details.name: {
                str(site): len(block)
                for site, block in (recording.read_back.imu if recording.read_back else {}).items()
            }
            for recording in self.visit.recordings.every
        }
        reported = {
            "session": str(self.visit.session.id),
            "takes": recordings,
            "heard_s": float(received.time_s[-1]) - self._began_s,
        }
        print(json.dumps(reported), flush=True)

    def _record(self, kind: RecordingKind, seconds: float) -> None:
        recordings, count = self.visit.recordings, len(self.visit.recordings.every)
        self.acquisition.ask(kind)
        recordings.begin(self.acquisition, kind)
        self._wait(lambda: recordings.has_begun)
        linger(self._application, seconds / SPEED)
        recordings.stop()
        self._wait(lambda: len(recordings.every) > count and recordings.is_idle)

    @property
    def _results(self) -> ResultsStep:
        return next(step for step in self.wizard.steps.values() if isinstance(step, ResultsStep))

    @property
    def _report(self) -> ReportStep:
        return next(step for step in self.wizard.steps.values() if isinstance(step, ReportStep))

    def _wait(self, until: Callable[[], bool]) -> None:
        wait(self._application, until)


def lead(guide: Guide, point: Point) -> None:
    """Go as far as `point`."""
    guide.walk()
    if point is Point.WALKING:
        return
    guide.stop()
    if point is Point.ASKED:
        return
    guide.keep()
    guide.walk()
    guide.stop()
    guide.keep()
    guide.correct()
    if point is Point.RESULTS:
        return
    guide.comment()
    if point is Point.SAVING:
        guide.save()


def main() -> int:
    required = options(__doc__, library=Path, passphrase=str, point=Point, pelvis=(False, "with a seventh sensor"))
    sites = tuple(Site) if required.pelvis else LEG_SITES
    offer("fast", fast_patient(sites, SPEED))
    made = application()
    window = window_in(made, required.library)
    guide = Guide(made, window)
    guide.begin(required.library, required.passphrase, sites)
    lead(guide, required.point)
    guide.show_message()
    linger(made, WAITS_S)
    return 1


if __name__ == "__main__":
    sys.exit(main())

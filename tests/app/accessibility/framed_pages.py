"""The pages of a visit in their frame, filled: rail, header, sensors and bar round each, as the wizard has them."""

import math
from collections.abc import Callable
from functools import cache, partial
from typing import cast

from PySide6.QtCore import QBuffer, QByteArray
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QWidget

from app.patient_screen.patient_view import PatientView
from app.patient_screen.window import PatientWindow
from app.results.agreement_page import AgreementPage
from app.results.correct_page import CorrectPage, JointLine, WalkLine
from app.results.found_page import FoundPage
from app.results.result_page import ResultPage
from app.results.tools_row import ANSWER, COMPARE, STRIDES, WHOLE
from app.theme.icons import Icon
from app.widgets.action_bar import BarState, RecordingNote
from app.widgets.rail_row import RailRow, StepState
from app.widgets.sensor_tile import SensorTile
from app.widgets.step_rail import wizard_below
from app.wizard.report.page import ReportPage
from app.wizard.shell import StripMode, WizardShell
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.walking.bench_control import Bench
from app.wizard.walking.page import WalkingPage
from app.wizard.walking.timed_result import TimedAttempt, TimedResult
from app.wizard.walking.timed_view import TimedViewState
from app.wizard.walking.walk_list import WalkRow, WalkState
from app.wording.body import name_of
from app.wording.translation import tr
from core.body import LEG_SITES, Joint, Side
from core.results import Analysis
from core.session import Session
from core.targets import Target, TargetMeasure
from core.timed.found import TimedTest
from core.timed.live import LiveReadout
from core.timed.protocols import PlannedTest, TimedProtocol
from core.verdicts.diagnostics import diagnostics_of
from tests.app.changed_analysis import visit_of
from tests.app.idle_action import idle
from tests.app.results.filled_pages import PAGES
from tests.app.wizard.walking.bench_material import bench_visit
from tests.simulated import TWO_WALKS, analysis_of, session_of

Make = Callable[[], QWidget]
STEPS = ("Patient", "Sensors", "Stand still", "Free motion", "Walking", "Results", "Report")
OVER_TEN_METRES = TimedTest(
    TimedProtocol.TEN_METRES, 3.0, 12.0, False, False, 10.0, 10.0, 105.0, (), (), (), (), (), (), ()
)


@cache
def analysed() -> tuple[Session, Analysis]:
    """Two walks of the simulated patient, under two conditions."""
    session = session_of(TWO_WALKS)
    return session, analysis_of(session)


def results(view: str, *opened: str) -> Make:
    """Results in one of their views; `opened` names the buttons that are pressed then."""

    def make() -> QWidget:
        page = ResultPage()
        session, analysis = analysed()
        page.show_visit(visit_of(analysis, session))
        page.view.choose(view)
        for name in opened:
            buttons = {
                "door": page.door,
                "figures": page.all_figures,
                "legs": page.show_legs,
                "engineering": page.quality.engineering,
            }
            buttons[name].click()
        return page

    return make


def bench() -> QWidget:
    shown = Bench(cast(Visit, bench_visit()))  # which asks of a visit only what is there
    page = WalkingPage(shown.entry)
    page.show_walks(tuple(WalkRow(str(k), one, f"Alignment {one}", WalkState.KEPT, 12) for k, one in enumerate("ABC")))
    page.show_bench(shown.state())
    return page


def timed() -> QWidget:
    page = WalkingPage()
    readout = LiveReadout(PlannedTest(TimedProtocol.TEN_METRES), 8.0, 3.0, distance_m=6.12)
    page.show_walks((WalkRow("1", "A", "Shoes", WalkState.RECORDING),))
    page.show_test(TimedViewState(readout, "Shoes, attempt 1", 8.44, math.nan))
    return page


def timed_result() -> QWidget:
    page = WalkingPage()
    page.show_labels(("Shoes", "Barefoot"), "Shoes")
    planned = PlannedTest(TimedProtocol.TEN_METRES)
    attempts = [TimedAttempt(f"walk {k}", planned, OVER_TEN_METRES, is_kept=True) for k in (1, 2)]
    page.show_walks(tuple(WalkRow(str(k), "A", "Shoes", WalkState.KEPT, 12) for k in (1, 2)))
    page.show_tests(planned, TimedResult(attempts, ["A1 Shoes", "A2 Shoes"]), {})
    return page


def blank_sheet() -> bytes:
    """A picture of an empty page of A4."""
    image = QImage(595, 842, QImage.Format.Format_RGB32)
    image.fill(0xFFFFFFFF)
    content = QByteArray()
    file = QBuffer(content)
    file.open(QBuffer.OpenModeFlag.WriteOnly)
    assert image.save(file, "PNG")  # type: ignore[call-overload]  # the stubs know no device here
    return bytes(content.data())


def report() -> QWidget:
    page = ReportPage()
    page.show_pages([blank_sheet()] * 2)
    return page


def how_it_was_found() -> QWidget:
    page = FoundPage()
    page.show_joints([Joint.LEFT_KNEE, Joint.RIGHT_KNEE], Joint.LEFT_KNEE)
    session, analysis = analysed()
    joint = analysis.calibrations[0].joints[Joint.LEFT_KNEE]
    found = diagnostics_of(session, joint, analysis.recordings[-1].name)
    assert found is not None
    page.show_found(found, (), is_simulated=True)
    return page


def beside_optics() -> QWidget:
    page = AgreementPage()
    page.show_pages([blank_sheet()], ())
    return page


def nothing_beside_optics() -> QWidget:
    page = AgreementPage()
    page.show_nothing()
    return page


def correcting() -> QWidget:
    page = CorrectPage()
    page.show_walks([WalkLine("1", "walk 1", "0:24", "Shoes", is_kept=True)])
    page.show_joints([JointLine(Joint.LEFT_KNEE, is_turned=False, note="")])
    page.show_sides("")
    return page


def patient_screen() -> QWidget:
    window = PatientWindow()
    window.show_view(PatientView(Target(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT, 55), (51, 56, 53)))
    return window


WITH_TILES = (StepId.STAND_STILL, StepId.FREE_MOTION, StepId.WALKING)
# which step a page belongs to, and how it is made
FRAMED: dict[str, tuple[StepId, Make]] = {
    "patient": (StepId.PATIENT, PAGES["patient"]),
    "sensors": (StepId.SENSORS, PAGES["sensors"]),
    "no sensors": (StepId.SENSORS, PAGES["no sensors"]),
    "stored sessions": (StepId.SENSORS, PAGES["stored sessions"]),
    "ready to stand": (StepId.STAND_STILL, PAGES["ready to stand"]),
    "cannot stand": (StepId.STAND_STILL, PAGES["cannot stand"]),
    "free motion": (StepId.FREE_MOTION, PAGES["free motion"]),
    "nothing walked": (StepId.WALKING, PAGES["nothing walked"]),
    "recording": (StepId.WALKING, PAGES["recording"]),
    "asking": (StepId.WALKING, PAGES["asking"]),
    "bench": (StepId.WALKING, bench),
    "timed test": (StepId.WALKING, timed),
    "timed result": (StepId.WALKING, timed_result),
    "answer": (StepId.RESULTS, results(ANSWER)),
    "legs": (StepId.RESULTS, results(ANSWER, "legs")),
    "whole walk": (StepId.RESULTS, results(WHOLE)),
    "strides": (StepId.RESULTS, results(STRIDES)),
    "compare": (StepId.RESULTS, results(COMPARE)),
    "all values": (StepId.RESULTS, results(ANSWER, "figures")),
    "what can be read": (StepId.RESULTS, results(ANSWER, "door")),
    "engineering details": (StepId.RESULTS, results(ANSWER, "door", "engineering")),
    "how it was found": (StepId.RESULTS, how_it_was_found),
    "beside optics": (StepId.RESULTS, beside_optics),
    "nothing beside optics": (StepId.RESULTS, nothing_beside_optics),
    "correcting": (StepId.RESULTS, correcting),
    "report": (StepId.REPORT, report),
}


def framed(name: str) -> WizardShell:
    """Give a page in its frame; it is fitted to its room when the frame is shown."""
    step, make = FRAMED[name]
    shell, page = WizardShell(), make()
    shell.room_changed.connect(partial(_fit, page))
    states = [StepState.DONE if one.value < step.value else StepState.TODO for one in StepId]
    states[[*StepId].index(step)] = StepState.CURRENT
    shell.rail.show_rows(tuple(RailRow(tr(title), "", state) for title, state in zip(STEPS, states, strict=True)))
    shell.rail.show_below(wizard_below())
    shell.header.show_session("P-0147", tr("1968, male · left prosthetic"), is_simulated=True)
    shell.header.show_elapsed(301.0)
    tile = partial(SensorTile, name="0A22", battery=0.84, rate_hz=100.0, lost_share=0.0, silent_s=0.0)
    shell.strip.show_tiles({site: tile(site, is_moving=True, is_worn=True) for site in LEG_SITES})
    shell.set_strip_mode(StripMode.SHOWN if step in WITH_TILES else StripMode.FOLDED)
    note = tr("If you stop now, angles are unreliable for {joints}.").format(joints=name_of(Joint.LEFT_KNEE))
    stop = idle(tr("Stop early"), tr("Space"), Icon.STOP, is_requested=False)
    shell.bar.show_state(BarState(stop, quiet=(idle(tr("Repeat one leg"), icon=Icon.REPEAT),), note=note))
    if name == "recording":
        recorded = RecordingNote(tr("Recording {walk}").format(walk="3"), "", 24.0, has_sound=True)
        shell.bar.show_state(BarState(idle(tr("Stop walk"), tr("Space"), Icon.STOP), recording=recorded))
    shell.show_page(step, page)
    return shell


def _fit(page: QWidget, is_compact: bool, width: float, height: float) -> None:
    if hasattr(page, "set_compact"):
        page.set_compact(is_compact)
    if hasattr(page, "set_room"):
        page.set_room(width, height)

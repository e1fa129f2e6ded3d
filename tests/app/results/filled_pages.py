"""Pages by themselves, filled with what they can have to show: for tests of words, names and sizes."""

import datetime
from collections.abc import Callable
from uuid import UUID

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QScrollArea, QWidget

from app.cohort.study.groups import GroupAnswer, Grouping, GroupQuestion, GroupRow
from app.help.help_page import HelpPage
from app.help.help_topics import Topic
from app.home.cohort.cohort_page import QuestionsPage
from app.home.importing.import_page import ImportPage
from app.home.login.first_start_page import FirstStartPage
from app.home.login.join_page import JoinPage
from app.home.login.log_in_page import LogInPage
from app.home.patients.home_page import PATIENT, HomePage
from app.home.settings.clinic_cards import StationView
from app.home.settings.operators_card import OperatorLine
from app.home.settings.settings_page import SettingsPage
from app.importing.import_drafts import drafts_of
from app.summary.course_lanes import CourseVisit
from app.summary.course_words import NextKind, NextStep
from app.system.allowed_drivers import DriverPackage
from app.widgets.gauge import GaugeFace, GaugeMeasure, GaugeState
from app.widgets.hint import Hint
from app.widgets.line_list import PatientLine, SessionLine
from app.wizard.free_motion.page import FreeMotionFace, FreeMotionPage
from app.wizard.patient.cards import LastVisit
from app.wizard.patient.page import PatientDraft, PatientPage
from app.wizard.sensors.page import SensorsPage, Way
from app.wizard.sensors.sensor_row import SensorRow
from app.wizard.sensors.source_pages import SourceOption
from app.wizard.standing.page import StandPhase, StandStillPage, StandStillView
from app.wizard.walking.page import WalkingPage
from app.wizard.walking.readout import LiveLane, LiveTrace, PhaseSpan, WalkingReadout
from app.wizard.walking.walk_list import WalkRow, WalkState
from app.wording.translation import figure_text, tr
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site
from core.findings import Finding, Severity
from core.gait.phases import Phase
from core.samples import ImuBlock, SensorInfo
from core.session import Patient
from devices.files.refusal import FileRefusedError
from devices.files.table_choices import COUNT, NONE, PreviewedSensor, TableChoices, TablePreview
from devices.files.trial import ImportedSensor, ImportedTrial
from tests.app.home.course_library import VISITS


def first_start() -> QWidget:
    return FirstStartPage(12, lambda _typed, _key: False)


def recovery_key() -> QWidget:
    page = FirstStartPage(12, lambda _typed, _key: False)
    page.show_recovery_key("-".join(["8K3F"] * 14))
    return page


def log_in() -> QWidget:
    page = LogInPage(12)
    page.show_operators(["hk", "mueller"], ["hk"], can_remember=True)
    return page


def joining() -> QWidget:
    page = JoinPage()
    page.refuse(tr("The clinic's server does not respond"), is_place=False)
    return page


def station() -> QWidget:
    page = SettingsPage(12, [("clinician", tr("clinician"))])
    page.show_library(has_access=False, has_backup=False, has_operators=False, is_station=True, may_move=True)
    page.station.show_may(may_copy=True, may_bring_back=True)
    page.station.show_station(StationView("postgresql://station@server/clinic", "/srv/recordings", 2))
    scroll = QScrollArea()  # both cards together never fit
    scroll.setWidgetResizable(True)
    scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    scroll.setWidget(page)
    return scroll


def cover() -> QWidget:
    page = LogInPage(12)
    page.show_cover("mueller", is_recording=True)
    return page


def home() -> QWidget:
    page = HomePage()
    lines = [
        PatientLine(
            UUID(int=k), f"P-01{k:02d}", "1968, male · left prosthetic", "20 Nov 2026", "3 sessions", "", k == 2
        )
        for k in range(12)
    ]
    page.show_patients(lines)
    page.show_patient("P-0100", "1968, male · left prosthetic")
    reason = tr("Not written yet. Measured {when}.").format(when="14 Nov 2026")
    step = NextStep(NextKind.REPORT, tr("Write report of {day}").format(day="14 Nov"), reason, UUID(int=4))
    missing = CourseVisit(UUID(int=9), datetime.date(2026, 11, 20), None)
    line = SessionLine(UUID(int=99), "today 14:20", "Alignment A, B, C", "3 recordings")
    page.show_sessions([line], [*VISITS, missing], step)
    return page


def home_of_a_patient() -> QWidget:
    """Where there is room for the list or the patient only."""
    page = home()
    assert isinstance(page, HomePage)
    page.view.choose(PATIENT)
    return page


def empty_home() -> QWidget:
    page = HomePage()
    page.show_patients([])
    page.show_patient("", "")
    page.show_sessions([])
    return page


def importing() -> QWidget:
    page = ImportPage()
    finding = Finding("gaps", Severity.WARNING, "left_foot", {"count": 3, "missing_percent": 2.5, "longest_s": 0.4})
    page.show_session("session_2026", ["standing", "free motion", "walk 1"], "DEMO-1", [finding], is_simulated=True)
    return page


def importing_files() -> QWidget:
    """A walk of six sensors that gives nothing of them, one of which has a site twice."""
    page = ImportPage()
    time_s = np.arange(500) / 100.0
    block = ImuBlock("A", time_s, np.sin(time_s)[:, None] * np.ones(3), np.tile([0.0, 0.0, 9.81], (500, 1)))
    names = ("Left Foot", "Left Thigh", "00B4227C", "00B4227D", "00B421EF", "00B42279")
    sensors = tuple(ImportedSensor(name, (), "walk.csv", block, SensorInfo(rate_hz=100.0)) for name in names)
    (draft,) = drafts_of([("walk_1", ImportedTrial("apdm", sensors))])
    page.show_draft("session_2026", "APDM Moveo, Mobility Lab or Motion Studio", draft)
    page.code.set_text("P-0300")
    page.show_unread([tr("Stopped.")], can_try_again=True)
    return page


def importing_a_table() -> QWidget:
    """A table of two sensors, whose columns were found by their values."""
    page = ImportPage()
    time_s = np.arange(500) / 100.0
    acc, gyr = np.tile([0.4, 9.7, -1.2], (500, 1)), np.sin(time_s)[:, None] * np.array([1.0, -2.0, 3.0])
    names = ("t", "a_very_long_name_of_a_column [m/s²]", "q", "r", "u", "v", "w")
    found = TableChoices("utf-8", 1, ",", ".", names[1:4], "m/s2", names[4:], "rad/s", "t", COUNT, NONE, 100.0)
    sensors = tuple(PreviewedSensor(name, time_s, acc, gyr, 100.0, 5.0, ()) for name in ("one", "two"))
    rows = (("0.00", "0.4", "9.7", "-1.2", "1.0", "-2.0", "3.0"),) * 3
    lines = (",".join(names), *map(",".join, rows))
    preview = TablePreview("f", lines, names, rows, found, found, sensors, is_by_values=True, is_cut=True, refusal=None)
    page.table.begin(FileRefusedError("walk.csv", "the file has no header line", "Copy the file again"), found)
    page.table.show_preview(preview)
    page.show_table("session_2026/walk.csv")
    return page


class ScrolledQuestions(QScrollArea):
    """The page as home holds it: it is as high as its words and groups need."""

    def __init__(self, page: QuestionsPage) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setWidget(page)
        self.set_room = page.set_room


def questions() -> QWidget:
    """With everything that can have to be stated, and a group of one session."""
    page = QuestionsPage()
    page.show_table("batch of 2026/parameters.parquet", ["knee_range_deg", "speed_m_s"], tuple(Grouping))
    whole = GroupRow("", 120, 80, 240, 58.4, 6.1, 0.56, 1.1, 9.2, 12, 30, 4, 3)
    alone = GroupRow("80", 1, 1, 2, 61.0, np.nan, np.nan, np.nan, 9.2, 1, 0, 0, 0)
    page.show_answer(GroupAnswer(GroupQuestion("knee_range_deg", Grouping.AGE), (alone, whole), 119, 80, 3, 2))
    return ScrolledQuestions(page)


def no_table() -> QWidget:
    page = QuestionsPage()
    page.show_refused(tr("The table cannot be evaluated."), tr("See the log for details."))
    return ScrolledQuestions(page)


def settings() -> QWidget:
    page = SettingsPage(12, [("clinician", tr("clinician")), ("administrator", tr("administrator"))])
    page.show_library(has_access=True, has_backup=True, has_operators=True)
    page.operators.show_operators([OperatorLine("hk", "H. Keller", tr("administrator"), is_active=True, is_self=True)])
    page.drivers.show_packages(
        [
            DriverPackage("gaitwright-sum-sensor", "1.0", ("sum-sensor",), is_allowed=True),
            DriverPackage("laboratory-movement-sensors", "2026.11.1", ("lab-imu", "lab-imu-2"), is_allowed=False),
        ]
    )
    return page


def patient() -> QWidget:
    page = PatientPage()
    known = Patient(
        code="P-0147", birth_year=1968, sex="male", height_m=1.81, prosthetic_side="left", device="C-Leg 4, Triton"
    )
    page.show_draft(PatientDraft(known))
    page.show_code_taken("P-0147")
    page.show_last_visit(LastVisit("20 Nov 2026", (("Device", "C-Leg 4"), ("Aids", "Shoes"))))
    return page


def sensors() -> QWidget:
    page = SensorsPage()
    page.show_sources([SourceOption("serial", tr("Serial ports"), "6"), SourceOption("replay", tr("Replay"))], "serial")
    rows = [SensorRow(f"0A0{k}", "x-IMU3", 100.0, 0.8, site) for k, site in enumerate(LEG_SITES[:4])]
    rows += [SensorRow("0A31", "x-IMU3", 0.0, 0.08, Site.RIGHT_SHANK, silent_s=3.2, can_identify=True)]
    rows += [SensorRow("0A2C", "x-IMU3", 98.0, None, None, lost_share=0.024, can_identify=True)]
    page.show_sensors(rows)
    page.show_way(Way.SHAKE)
    page.show_shaken_together(["0A31", "0A2C"])
    return page


def stored_sessions() -> QWidget:
    page = SensorsPage()
    lines = [
        PatientLine(UUID(int=k), f"P-01{k:02d}", "Alignment A, B, C", "20 Nov 2026", "3 recordings", "")
        for k in range(12)
    ]
    page.stored.show_sessions(lines)
    page.stored.show_message("walk_1/left_thigh.csv", "Write the file as FORMATS says it.")
    page.show_stored()
    return page


def no_stored_session() -> QWidget:
    page = SensorsPage()
    page.show_stored()
    return page


def no_sensors() -> QWidget:
    page = SensorsPage()
    page.show_sources([SourceOption("serial", tr("Serial ports"))])
    page.show_no_source()
    page.nothing.show_left_out(
        tr(
            "Simulated and replayed sensors are offered only for patient codes that begin with DEMO. This "
            "keeps their data apart from real patients."
        )
    )
    return page


def standing(phase: StandPhase, **more: object) -> Callable[[], QWidget]:
    def make() -> QWidget:
        page = StandStillPage()
        page.zero.show_zero({Joint.LEFT_KNEE: 12.0})
        page.show_state(StandStillView(phase, 1.2, movement_deg_s=dict.fromkeys(LEG_SITES, 0.4), **more))  # type: ignore[arg-type]  # of a test
        return page

    return make


def free_motion() -> QWidget:
    page = FreeMotionPage()
    open_face = GaugeFace(
        GaugeState.NOW,
        GaugeMeasure("11", "°", figure_text(1.5, "g") + "°", 0.4, False),
        GaugeMeasure("34", "mm", "10 mm", 0.3, False),
    )
    enough = GaugeFace(
        GaugeState.ENOUGH,
        GaugeMeasure(figure_text(0.8, "g"), "°", figure_text(1.5, "g") + "°", 1.0, True),
        GaugeMeasure("6", "mm", "10 mm", 1.0, True),
    )
    faces = dict.fromkeys(LEG_JOINTS, enough) | {Joint.LEFT_KNEE: open_face}
    hint = Hint(tr("Circle the left lower leg"), tr("Change direction."))
    page.show_state(FreeMotionFace(faces, hint, 7.3, Site.LEFT_SHANK))
    return page


def walking(*rows: WalkRow) -> Callable[[], QWidget]:
    def make() -> QWidget:
        page = WalkingPage()
        page.show_labels(("Barefoot", "Alignment A", "AFO"), "AFO")
        page.show_walks(rows, "L 12, R 11")
        time_s = np.arange(500) / 100
        trace = LiveTrace(time_s, np.full(500, 0.4), is_provisional=True)
        lane = LiveLane((PhaseSpan(Phase.SWING, 1.0, None),))
        page.show_view(
            WalkingReadout(
                5.0, dict.fromkeys(LEG_JOINTS, trace), dict.fromkeys(Side, lane), dict.fromkeys(Side, 14), 101.4
            )
        )
        return page

    return make


def helping() -> QWidget:
    page = HelpPage()
    page.show_topic(Topic.MESSAGES)
    page.search.line_edit.setText("sensor")
    page.search.line_edit.textEdited.emit("sensor")
    return page


KEPT = WalkRow("1", "A", "Barefoot", WalkState.KEPT, 18)
DISCARDED = WalkRow("2", "B", "Alignment A", WalkState.DISCARDED, 17)
PAGES: dict[str, Callable[[], QWidget]] = {
    "first start": first_start,
    "recovery key": recovery_key,
    "log in": log_in,
    "cover": cover,
    "home": home,
    "home of a patient": home_of_a_patient,
    "empty home": empty_home,
    "import": importing,
    "import of files": importing_files,
    "import of a table": importing_a_table,
    "questions": questions,
    "no table": no_table,
    "settings": settings,
    "joining": joining,
    "station": station,
    "patient": patient,
    "sensors": sensors,
    "no sensors": no_sensors,
    "stored sessions": stored_sessions,
    "no stored session": no_stored_session,
    "ready to stand": standing(StandPhase.READY),
    "counting": standing(StandPhase.COUNTING),
    "moved": standing(StandPhase.COUNTING, moved=(Site.LEFT_SHANK, Site.RIGHT_SHANK), restarts=3),
    "cannot stand": standing(StandPhase.SKIPPED),
    "free motion": free_motion,
    "nothing walked": walking(),
    "recording": walking(KEPT, DISCARDED, WalkRow("3", "C", "AFO", WalkState.RECORDING)),
    "asking": walking(KEPT, DISCARDED, WalkRow("3", "C", "AFO", WalkState.ASKING, 12)),
    "help": helping,
}


BELOW_STRIP = {
    "ready to stand",
    "counting",
    "moved",
    "cannot stand",
    "free motion",
    "nothing walked",
    "recording",
    "asking",
}

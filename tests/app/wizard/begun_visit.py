"""A visit whose patient wears all sensors of its first source, and what is recorded of it."""

from collections.abc import Iterator, Sequence

from pytestqt.qtbot import QtBot

from app.acquisition.acquisition import Acquisition
from app.editing.session_recording import SessionRecording
from app.wizard.sensors.step import SensorsStep
from app.wizard.visit import Visit
from app.wizard.worn_sensors import SourceChoice
from core.body import Site
from core.session import Patient, RecordingKind
from tests.app.wizard.present import present

DEMO_PATIENT = Patient(code="DEMO-7", birth_year=1970)


def save_patient(qtbot: QtBot, visit: Visit, patient: Patient) -> None:
    visit.patient.edit(patient)
    with qtbot.waitSignal(visit.patient.changed):
        visit.patient.commit()


def begin(qtbot: QtBot, visit: Visit, worn: dict[str, Site], patient: Patient = DEMO_PATIENT) -> None:
    save_patient(qtbot, visit, patient)
    with qtbot.waitSignal(visit.changed):
        visit.record.begin()
    with qtbot.waitSignal(visit.sensors.opened):
        visit.sensors.search(visit.choices[0])
    qtbot.waitUntil(lambda: set(visit.sensors.status) == set(worn))
    visit.sensors.assign_all(worn)
    with qtbot.waitSignal(visit.changed):
        visit.place_sensors()


def shown(qtbot: QtBot, visit: Visit) -> Iterator[SensorsStep]:
    """The step of the sensors, entered; what a fixture yields from."""
    step = SensorsStep(visit)
    qtbot.addWidget(step.page)
    step.page.resize(1064, 672)
    step.page.show()
    step.enter()
    yield step
    step.leave()
    step.deleteLater()


def start(qtbot: QtBot, visit: Visit, kind: RecordingKind = RecordingKind.WALKING, condition: str = "") -> Acquisition:
    """Begin a recording, and give what receives it."""
    acquisition = present(visit.sensors.acquisition)
    with qtbot.waitSignal(visit.recordings.begun):
        visit.recordings.begin(acquisition, kind, condition)
    return acquisition


def record(qtbot: QtBot, visit: Visit, kind: RecordingKind, seconds: float, condition: str = "") -> SessionRecording:
    acquisition = start(qtbot, visit, kind, condition)
    acquisition.ask(kind)  # by now nothing of it is missed, however busy the computer is
    until_s = acquisition.now_s + seconds
    qtbot.waitUntil(lambda: acquisition.now_s > until_s)
    with qtbot.waitSignal(visit.recordings.ended) as ended:
        visit.recordings.stop()
    recording = ended.args[0]
    assert isinstance(recording, SessionRecording)
    return recording


def resumed(qtbot: QtBot, visit: Visit, choices: Sequence[SourceChoice] = ()) -> Visit:
    """The session of a visit in another, as after a restart; who asks for it finishes it."""
    again = Visit(visit.controller, choices)
    with qtbot.waitSignal(again.resumed):
        again.resume(present(visit.session).id)
    return again

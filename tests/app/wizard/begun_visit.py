"""A visit whose patient wears all sensors of its first source, and what is recorded of it."""

from pytestqt.qtbot import QtBot

from app.editing.session_recording import SessionRecording
from app.wizard.visit import Visit
from core.body import Site
from core.session import Patient, RecordingKind

DEMO_PATIENT = Patient(code="DEMO-7", birth_year=1970)


def begin(qtbot: QtBot, visit: Visit, worn: dict[str, Site], patient: Patient = DEMO_PATIENT) -> None:
    visit.patient.edit(patient)
    with qtbot.waitSignal(visit.patient.changed):
        visit.patient.commit()
    with qtbot.waitSignal(visit.changed):
        visit.record.begin()
    with qtbot.waitSignal(visit.sensors.opened):
        visit.sensors.search(visit.choices[0])
    qtbot.waitUntil(lambda: set(visit.sensors.status) == set(worn))
    visit.sensors.assign_all(worn)
    with qtbot.waitSignal(visit.changed):
        visit.place_sensors()


def record(qtbot: QtBot, visit: Visit, kind: RecordingKind, seconds: float, condition: str = "") -> SessionRecording:
    acquisition = visit.sensors.acquisition
    assert acquisition is not None
    with qtbot.waitSignal(visit.recordings.begun):
        visit.recordings.begin(acquisition, kind, condition)
    acquisition.ask(kind)  # by now nothing of it is missed, however busy the computer is
    until_s = acquisition.now_s + seconds
    qtbot.waitUntil(lambda: acquisition.now_s > until_s)
    with qtbot.waitSignal(visit.recordings.ended) as ended:
        visit.recordings.stop()
    recording = ended.args[0]
    assert isinstance(recording, SessionRecording)
    return recording

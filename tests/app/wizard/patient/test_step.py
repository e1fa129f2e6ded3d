"""The step of the patient: made, found and gone on with, each once the library has answered."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtWidgets import QAbstractButton, QLabel
from pytestqt.qtbot import QtBot

from app.storage.opened import OpenedLibrary
from app.storage.stored import PlacedSensor, StoredPatient
from app.widgets.rail_row import StepState
from app.wizard.patient.page import PatientDraft
from app.wizard.patient.step import PatientStep
from app.wizard.visit import Visit
from app.workers.library_controller import LibraryController
from core.body import Joint, Side, Site
from core.samples import SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press


@pytest.fixture
def step(qtbot: QtBot, visit: Visit) -> Iterator[PatientStep]:
    step = PatientStep(visit)
    qtbot.addWidget(step.page)
    step.page.show()
    step.enter()
    yield step
    step.deleteLater()


def type_in(step: PatientStep, patient: Patient) -> None:
    step.page.show_draft(PatientDraft(patient))
    step.page.edited.emit(step.page.draft)


def test_going_on_waits_until_the_library_has_the_patient(qtbot: QtBot, visit: Visit, step: PatientStep) -> None:
    verb = present(step.bar().primary)
    assert not verb.is_enabled
    type_in(step, Patient(code="DEMO-7", prosthetic_side="left"))
    assert step.note == "Left prosthetic"
    with qtbot.waitSignal(step.done):
        press(step)
    assert visit.patient.stored is not None
    assert step.state is StepState.DONE
    qtbot.waitUntil(lambda: visit.session is not None)


def test_a_code_in_use_stops_and_offers_that_patient(
    qtbot: QtBot, controller: LibraryController, visit: Visit, step: PatientStep
) -> None:
    controller.run(make, None, None, step)
    type_in(step, Patient(code="demo-8"))
    with qtbot.waitSignal(visit.patient.code_taken), qtbot.assertNotEmitted(step.done):
        press(step)
    assert step.page.code.is_wrong
    assert step.bar().note == "Not saved: demo-8 is another patient's code."
    with qtbot.waitSignal(visit.patient.changed):
        step.page.open_pressed.emit("demo-8")
    assert step.page.draft.patient.birth_year == 1950
    qtbot.waitUntil(lambda: not step.page.code.is_wrong)
    with qtbot.waitSignal(step.done):
        press(step)


def test_what_is_typed_of_a_known_patient_is_saved(qtbot: QtBot, visit: Visit, step: PatientStep) -> None:
    type_in(step, Patient(code="DEMO-9"))
    assert step.bar().note == "Not saved yet."  # half a code is nobody's
    with qtbot.waitSignal(visit.patient.changed):
        step.page.code.committed.emit()
    assert step.bar().note == "Saved as you type."
    type_in(step, Patient(code="DEMO-9", mass_kg=82.0, device="knee K2  "))
    assert step.bar().note == "Not saved yet."
    qtbot.waitUntil(lambda: visit.patient.is_saved)
    assert step.bar().note == "Saved as you type."
    assert visit.patient.stored is not None
    assert visit.patient.stored.details.mass_kg == 82.0
    assert visit.patient.stored.details.device == "knee K2"


def test_the_set_up_of_the_last_visit_is_taken_over(
    qtbot: QtBot, controller: LibraryController, visit: Visit, step: PatientStep
) -> None:
    controller.run(make_with_visit, None, None, step)
    step.page.open_pressed.emit("DEMO-10")
    button = next(one for one in step.page.findChildren(QAbstractButton) if one.text() == "Use last visit's set-up")
    qtbot.waitUntil(button.isVisible)
    stated = {label.text() for label in step.page.findChildren(QLabel)}
    assert {"Last visit, 24 Oct 2026", "barefoot", "left knee 15°, others 0°", "0A09, 0A31"} <= stated
    with qtbot.waitSignal(step.done):
        button.click()
    assert visit.placement_before == {"0A09": Site.LEFT_THIGH, "0A31": Site.LEFT_SHANK}
    qtbot.waitUntil(lambda: visit.session is not None and Joint.LEFT_KNEE in visit.session.details.zero_rad)
    assert np.rad2deg(visit.details.zero_rad[Joint.LEFT_KNEE]) == pytest.approx(15.0)


def test_enter_takes_the_set_up_of_the_last_visit_and_without_one_goes_on_to_attach_sensors(
    qtbot: QtBot, controller: LibraryController, visit: Visit, step: PatientStep
) -> None:
    primary = present(step.bar().primary)
    assert (primary.text, primary.key) == ("Attach sensors", "Enter")
    controller.run(make_with_visit, None, None, step)
    step.page.open_pressed.emit("DEMO-10")

    def offered() -> tuple[str, str]:
        primary = present(step.bar().primary)
        return primary.text, primary.key

    qtbot.waitUntil(lambda: offered() == ("Use last visit's set-up", "Enter"))
    assert [(one.text, one.key) for one in step.bar().others] == [("Attach sensors", "")]
    with qtbot.waitSignal(step.done):
        press(step)
    assert visit.placement_before == {"0A09": Site.LEFT_THIGH, "0A31": Site.LEFT_SHANK}


def test_a_foot_without_an_ankle_joint_is_reported_to_the_visit(visit: Visit, step: PatientStep) -> None:
    page = step.page
    page.side.segments[1].click()
    page.limb.segments[1].click()
    page.ankles[Side.LEFT].buttons[0].click()
    assert visit.without_ankle == {Side.LEFT}
    assert visit.prosthetic_sides == {Side.LEFT}


def make(opened: OpenedLibrary) -> None:
    opened.library.patients.create(Patient(code="DEMO-8", birth_year=1950))


def make_with_visit(opened: OpenedLibrary) -> None:
    library = opened.library
    patient = library.patients.create(Patient(code="DEMO-10"))
    reported = Session(recordings=(), started="2026-10-24T10:00:00+02:00", zero_rad={Joint.LEFT_KNEE: np.deg2rad(15)})
    session = library.sessions.create(patient.id, reported)
    placed = {
        Site.LEFT_THIGH: PlacedSensor("0A09", SensorInfo()),
        Site.LEFT_SHANK: PlacedSensor("0A31", SensorInfo()),
    }
    library.sessions.place(session.id, placed)
    walk = Recording("walk 1", RecordingKind.WALKING, "", {}, condition="barefoot")
    library.recordings.start(session.id, walk, is_simulated=True)


def test_a_patient_of_a_list_read_before_a_change_is_read_again(
    qtbot: QtBot, controller: LibraryController, visit: Visit, step: PatientStep
) -> None:
    listed: list[StoredPatient] = []

    def change(opened: OpenedLibrary) -> None:
        patients = opened.library.patients
        stored = patients.create(Patient(code="DEMO-10", birth_year=1966, device="foot, carbon"))
        patients.change(stored, replace(stored.details, birth_year=1982))
        listed.append(stored)

    controller.run(change, None, None, step)
    qtbot.waitUntil(lambda: bool(listed))
    visit.patient.choose_from_list(listed[0])
    step.enter()
    assert step.page.draft.patient.birth_year == 1966
    type_in(step, replace(listed[0].details, mass_kg=70.0))  # before the library has answered
    assert not visit.patient.is_saved
    with qtbot.waitSignal(step.done):
        press(step)
    stored = present(visit.patient.stored)
    assert visit.patient.details == stored.details == step.page.draft.patient
    assert (stored.details.birth_year, stored.details.mass_kg) == (1982, 70.0)


def test_another_patient_chosen_while_the_first_is_read_again_is_the_one(
    qtbot: QtBot, controller: LibraryController, visit: Visit, step: PatientStep
) -> None:
    made: list[StoredPatient] = []

    def make_two(opened: OpenedLibrary) -> None:
        made.extend(opened.library.patients.create(Patient(code=code)) for code in ("DEMO-11", "DEMO-12"))

    controller.run(make_two, None, None, step)
    qtbot.waitUntil(lambda: len(made) == 2)
    visit.patient.choose_from_list(made[0])
    visit.patient.choose(made[1])
    step.enter()
    with qtbot.waitSignal(step.done):
        press(step)
    assert visit.patient.stored == made[1]
    qtbot.waitUntil(lambda: visit.session is not None and visit.session.patient_id == made[1].id)

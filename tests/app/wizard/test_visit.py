"""A visit is begun, recorded, evaluated and taken up again, and loses nothing on the way."""

from dataclasses import replace
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.storage.analysis_content import packed
from app.storage.audit import about
from app.storage.library import Library
from app.storage.opened import open_library
from app.storage.stored import Limits, RecordingState
from app.widgets.rail_row import StepState
from app.wizard.patient.step import PatientStep
from app.wizard.standing.step import StandStillStep
from app.wizard.visit import Visit
from app.workers.library_controller import LibraryController
from core.body import LEG_JOINTS, Joint, Side, Site
from core.prosthesis import AmputationLevel, FootKind, Prosthesis
from core.session import Patient, RecordingKind
from tests.app.wizard.begun_visit import begin, record, resumed, save_patient, start
from tests.app.wizard.conftest import PASSPHRASE, SPEED
from tests.app.wizard.present import present
from tests.simulated import analysis_of


def test_whole_session_is_evaluated_and_stored(
    qtbot: QtBot, controller: LibraryController, visit: Visit, worn: dict[str, Site]
) -> None:
    begin(qtbot, visit, worn)
    record(qtbot, visit, RecordingKind.STANDING, 4.0)
    with qtbot.waitSignal(visit.evaluation.done):
        record(qtbot, visit, RecordingKind.FREE_MOTION, 14.0)
    assert set(visit.evaluation.calibration) == set(LEG_JOINTS)
    with qtbot.waitSignal(visit.evaluation.done):
        walk = record(qtbot, visit, RecordingKind.WALKING, 18.0, "barefoot")
    assert walk.details.condition == "barefoot"
    assert not walk.is_decided
    assert visit.evaluation.strides("walk 1")[Side.LEFT] >= 10
    assert visit.is_simulated

    stored = present(visit.session)
    again = Visit(controller, [])
    computed: list[object] = []
    again.evaluation.computed.connect(lambda _session, analysis: computed.append(analysis))
    with qtbot.waitSignals([again.resumed, again.evaluation.done]):
        again.resume(stored.id)
    assert computed == []  # it was kept
    assert [recording.details.name for recording in again.recordings.every] == ["standing", "free motion", "walk 1"]
    assert set(again.rests) == set(worn)
    one, other = present(visit.evaluation.analysis), present(again.evaluation.analysis)
    assert packed(one) == packed(other)
    for before, after in zip(one.recordings, other.recordings, strict=True):
        for joint in before.joints:
            np.testing.assert_array_equal(before.joints[joint].angle_rad, after.joints[joint].angle_rad)
    assert again.evaluation.session is not None
    assert analysis_of(again.evaluation.session).findings == other.findings
    again.finish()


def test_discarded_walk_is_not_evaluated_and_comes_back(qtbot: QtBot, begun: Visit) -> None:
    walk = record(qtbot, begun, RecordingKind.WALKING, 6.0)
    with qtbot.waitSignal(begun.recordings.changed):
        begun.recordings.keep(walk, is_kept=False)
    qtbot.waitUntil(lambda: not begun.recordings.walks[0].details.is_kept)
    assert begun.recordings.counted() == ()
    begun.recordings.keep(begun.recordings.walks[0], is_kept=True)
    qtbot.waitUntil(lambda: begun.recordings.walks[0].details.is_kept)
    assert [recording.name for recording in begun.recordings.counted()] == ["walk 1"]


def test_code_of_another_patient_is_reported(qtbot: QtBot, visit: Visit) -> None:
    visit.patient.edit(Patient(code="DEMO-1"))
    with qtbot.waitSignal(visit.patient.code_taken) as reported:
        visit.patient.commit()
    assert reported.args == ["DEMO-1"]


def test_patient_is_saved_as_typed(qtbot: QtBot, visit: Visit) -> None:
    save_patient(qtbot, visit, Patient(code="DEMO-8"))
    visit.patient.edit(replace(visit.patient.details, height_m=1.7))
    visit.patient.edit(replace(visit.patient.details, mass_kg=70.0))
    qtbot.waitUntil(lambda: visit.patient.is_saved)
    assert present(visit.patient.stored).details == Patient(code="DEMO-8", height_m=1.7, mass_kg=70.0)


def test_zero_is_stored(qtbot: QtBot, begun: Visit) -> None:
    begun.record.set_zero(Joint.LEFT_KNEE, 0.1)
    begun.record.set_zero(Joint.LEFT_KNEE, 0.2)
    begun.record.set_zero(Joint.RIGHT_KNEE, 0.3)
    required = {Joint.LEFT_KNEE: 0.2, Joint.RIGHT_KNEE: 0.3}
    assert begun.details.zero_rad == required
    qtbot.waitUntil(lambda: begun.session is not None and begun.session.details.zero_rad == required)


def test_a_refused_reading_takes_back_nothing_that_is_being_saved(
    qtbot: QtBot, controller: LibraryController, begun: Visit
) -> None:
    required = Limits(without_ankle=frozenset({Side.LEFT}))
    with qtbot.waitSignal(begun.refused):
        begun.resume(uuid4())  # no session of the library
        begun.record.set_limits(replace(required, cannot_stand=True))  # is being saved when the refusal comes
        begun.record.set_limits(required)  # waits for it
    assert begun.record.limits == required
    qtbot.waitUntil(lambda: begun.session is not None and begun.session.limits == required)


def test_what_the_body_does_not_allow_is_stored_and_taken_up_again(
    qtbot: QtBot, visit: Visit, worn: dict[str, Site]
) -> None:
    """Reported before there is a session, and after; it is on the rows, and shown by whoever resumes."""
    visit.record.set_limits(Limits(without_ankle=frozenset({Side.LEFT})))
    begin(qtbot, visit, worn)
    session = present(visit.session)
    assert session.limits == Limits(without_ankle=frozenset({Side.LEFT}))
    visit.patient.edit(replace(visit.patient.details, prosthetic_side="both"))
    required = Limits(frozenset({Side.LEFT, Side.RIGHT}), cannot_stand=True)
    visit.record.set_limits(replace(required, cannot_stand=False))
    visit.record.set_limits(required)
    qtbot.waitUntil(lambda: visit.session is not None and visit.session.limits == required)
    qtbot.waitUntil(lambda: visit.patient.is_saved)
    again = resumed(qtbot, visit)
    assert again.without_ankle == {Side.LEFT, Side.RIGHT}
    step = StandStillStep(again)
    qtbot.addWidget(step.page)
    step.enter()
    primary = present(step.bar().primary)
    assert (step.state, primary.text) == (StepState.SKIPPED, "Continue to free motion")
    step.leave()
    patient = PatientStep(again)
    qtbot.addWidget(patient.page)
    patient.enter()
    assert patient.page.draft.without_ankle == {Side.LEFT, Side.RIGHT}
    again.finish()


@pytest.mark.parametrize(
    ("worn_left", "joints", "without"),
    [
        ({}, {Joint.LEFT_KNEE, Joint.LEFT_ANKLE}, {Side.LEFT}),
        (Prosthesis(AmputationLevel.TRANSFEMORAL), {Joint.LEFT_KNEE, Joint.LEFT_ANKLE}, {Side.LEFT}),
        (Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.SACH), {Joint.LEFT_ANKLE}, {Side.LEFT}),
        (Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.SINGLE_AXIS), {Joint.LEFT_ANKLE}, set()),
        (Prosthesis(AmputationLevel.PARTIAL_FOOT), set(), {Side.LEFT}),
    ],
)
def test_the_prosthesis_has_the_joints_that_its_level_leaves_it_and_its_foot_is_stated_before_it_is_answered(
    visit: Visit, worn_left: Any, joints: set[Joint], without: set[Side]
) -> None:
    worn = {Side.LEFT: worn_left} if worn_left else {}
    visit.patient.edit(Patient(code="DEMO-7", prosthetic_side="left", prostheses=worn))
    visit.record.set_limits(Limits(without_ankle=frozenset({Side.LEFT})))
    assert visit.prosthetic_sides == {Side.LEFT}
    assert visit.prosthetic_joints == joints
    assert visit.without_ankle == without


def test_who_judged_a_recovered_walk_is_noted_once_for_all(qtbot: QtBot, library: Library, begun: Visit) -> None:
    walk = record(qtbot, begun, RecordingKind.WALKING, 2.0)
    hashes = {journal.segment: journal.sha256 for journal in walk.stored.journals}
    library.recordings.close(walk.id, RecordingState.RECOVERED, hashes)  # as after a crash
    first = resumed(qtbot, begun)
    assert not first.recordings.walks[0].is_decided
    first.recordings.keep(first.recordings.walks[0], is_kept=True)
    qtbot.waitUntil(lambda: first.recordings.walks[0].stored.judged_by == "hk")
    audited = library.audit.entries(about("recording", walk.id))[-1]
    assert (audited.operator, audited.details) == ("hk", '{"is_kept":true,"is_recovered":true}')
    second = resumed(qtbot, begun)
    assert second.recordings.walks[0].is_decided
    assert second.recordings.walks[0].details.is_kept
    first.finish()
    second.finish()


def test_one_sensor_at_one_site(visit: Visit) -> None:
    sensors = visit.sensors
    sensors.assign("a", Site.LEFT_THIGH)
    sensors.assign("b", Site.LEFT_SHANK)
    sensors.assign("a", Site.LEFT_SHANK)
    assert sensors.site_of == {"a": Site.LEFT_SHANK, "b": Site.LEFT_THIGH}
    sensors.assign("c", Site.LEFT_SHANK)
    assert sensors.site_of == {"c": Site.LEFT_SHANK, "b": Site.LEFT_THIGH}


@pytest.mark.endurance
def test_closing_in_mid_walk_loses_nothing(qtbot: QtBot, begun: Visit) -> None:
    start(qtbot, begun)
    qtbot.wait(500)
    begun.close()
    again = resumed(qtbot, begun)
    (walk,) = again.recordings.walks
    assert all(np.ptp(block.time_s) > 0.8 * 0.5 * SPEED for block in present(walk.read_back).imu.values())
    again.finish()


def test_what_has_hardly_begun_when_the_program_ends_is_ended_too(
    qtbot: QtBot, controller: LibraryController, begun: Visit, tmp_path: Path
) -> None:
    acquisition, session = present(begun.sensors.acquisition), present(begun.session)
    begun.recordings.begin(acquisition, RecordingKind.STANDING)
    begun.close()
    controller.finish()  # no event loop runs in between
    with open_library(tmp_path / "library", PASSPHRASE) as opened:
        assert [one.state for one in opened.library.sessions.get(session.id).recordings] == [RecordingState.CLOSED]


def test_another_code_typed_over_a_patient_with_sessions_is_somebody_else(qtbot: QtBot, visit: Visit) -> None:
    save_patient(qtbot, visit, Patient(code="DEMO-7"))
    first = present(visit.patient.stored)
    save_patient(qtbot, visit, Patient(code="DEMO-77"))
    assert visit.patient.stored is not None
    assert visit.patient.stored.id == first.id  # a slip of the pen: nobody has seen DEMO-7
    visit.patient.choose(replace(visit.patient.stored, sessions=1))
    save_patient(qtbot, visit, Patient(code="DEMO-78"))
    assert visit.patient.stored.id != first.id


def test_a_patient_chosen_while_another_is_saved_stays_the_one_of_the_visit(
    qtbot: QtBot, library: Library, visit: Visit
) -> None:
    """The answer to the save comes after the choice; the session would else be begun for who is there no more."""
    save_patient(qtbot, visit, Patient(code="DEMO-8"))
    chosen = present(visit.patient.stored)
    visit.patient.choose(replace(chosen, sessions=1))
    save_patient(qtbot, visit, Patient(code="DEMO-9"))
    visit.patient.edit(replace(visit.patient.details, birth_year=1950))
    visit.patient.commit()  # on its way to the library
    visit.patient.choose(chosen)
    with qtbot.waitSignal(visit.patient.changed):  # the answer to the save
        pass
    assert (present(visit.patient.stored).id, visit.patient.details.code) == (chosen.id, "DEMO-8")
    assert visit.patient.is_saved
    saved = present(library.patients.find("DEMO-9"))
    assert saved.details.birth_year == 1950  # what was typed of the other is kept as theirs
    save_patient(qtbot, visit, replace(visit.patient.details, birth_year=1961))
    assert visit.patient.is_saved

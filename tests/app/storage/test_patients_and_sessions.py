"""What was typed is kept, found, corrected with its history, merged, taken back, and gone when it has to be."""

import datetime
import json
import math
from collections.abc import Iterator
from dataclasses import replace

import pytest
from sqlalchemy import func, select

from app.storage.database.engine import Database
from app.storage.database.ids import uuid7
from app.storage.database.models import Base
from app.storage.library import Library
from app.storage.stored import (
    KEPT_DELETED,
    Action,
    AnalysisInputs,
    ChangedMeanwhileError,
    LibraryError,
    Operator,
    PlacedSensor,
    RecordingState,
    ResultKind,
    Role,
    StoredJournal,
    StoredPatient,
    StoredRecording,
    StoredSession,
)
from app.summary.course import Course
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Joint, Side, Site
from core.findings import Finding, Severity
from core.goals import Goal, GoalOf, held, ordered, with_goal
from core.prosthesis import NOT_STATED, AmputationLevel, FootKind, KneeKind, Prosthesis
from core.samples import RateKind, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session

DATA_KEY = bytes(range(32))
FULL = Patient(
    code="P-001",
    birth_year=1960,
    sex="f",
    height_m=1.68,
    mass_kg=70.1,
    device="Genium X3, \N{GREEK SMALL LETTER ALPHA}",
    aids="cane",
    affected_side="left",
    prosthetic_side="left",
    unknown={"since": datetime.date(2020, 2, 29), "nested": {"list": [1, 2.5, "x"]}},
)
GOAL = Goal("speed_m_s", GoalOf.WALK, 1.2, datetime.date(2026, 1, 5), "H. Keller", note="\N{SNOWMAN}")
WALK = Recording("walk 1", RecordingKind.WALKING, "walk_1", {}, condition="alignment A", note="\N{SNOWMAN}")
SENSORS = {
    Site.LEFT_SHANK: PlacedSensor("S1", SensorInfo(serial="S1", rate_hz=100.0, rate_kind=RateKind.AVERAGED)),
    Site.LEFT_THIGH: PlacedSensor("S2", SensorInfo(model="Dot", clock="receiver 1", unknown={"colour": "red"})),
}
SWAPPED = {Site.LEFT_SHANK: SENSORS[Site.LEFT_THIGH], Site.LEFT_THIGH: SENSORS[Site.LEFT_SHANK]}


class Clock:
    def __init__(self) -> None:
        self.now = datetime.datetime(2026, 1, 1, 8, 30, tzinfo=datetime.UTC)

    def __call__(self) -> datetime.datetime:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def library(tables: Database, clock: Clock) -> Iterator[Library]:
    with Library(tables, DATA_KEY, clock) as library:
        library.begin(Operator("hk", "H. Keller", Role.ADMINISTRATOR))
        yield library


@pytest.fixture
def patient(library: Library) -> StoredPatient:
    return library.patients.create(FULL)


@pytest.fixture
def visit(library: Library, patient: StoredPatient) -> StoredSession:
    return library.sessions.create(patient.id, Session((), started="2026-01-01T08:30:00+01:00"))


@pytest.fixture
def walk(library: Library, visit: StoredSession) -> StoredRecording:
    library.sessions.place(visit.id, SENSORS)
    started = library.recordings.start(visit.id, WALK, is_simulated=False)
    library.recordings.add_journal(started.id, StoredJournal(started.id, 0, b"wrapped"))
    return library.recordings.close(started.id, RecordingState.CLOSED, {0: "ab" * 32})


def test_a_patient_comes_back_as_reported(library: Library, patient: StoredPatient, clock: Clock) -> None:
    assert patient.details == FULL
    assert (patient.version, patient.created_at, patient.sessions, patient.last_session) == (1, clock.now, 0, "")
    assert library.patients.get(patient.id) == patient
    assert library.patients.find(" p-001 ") == patient
    assert library.patients.find("p-00") is None


@pytest.mark.parametrize(
    ("reported", "words"),
    [
        (Patient(code=" "), "needs a code"),
        (Patient(code=" p-001 "), "Another patient has this code"),
        (Patient(code="P-2", height_m=168.0), r"from 0\.3 to 2\.8 m"),
        (Patient(code="P-2", mass_kg=math.nan), "from 1 to 500 kg"),
        (Patient(code="P-2", birth_year=60), "year"),
        (Patient(code="P-2", affected_side="links"), "left, right"),
    ],
)
def test_what_cannot_be_a_patient_is_refused(
    library: Library, patient: StoredPatient, reported: Patient, words: str
) -> None:
    with pytest.raises(LibraryError, match=words):
        library.patients.create(reported)
    with pytest.raises(LibraryError, match=words if "Another" not in words else None):
        library.patients.change(library.patients.create(Patient(code="P-3")), reported)


def test_patients_are_found_by_any_part_of_their_code_latest_first(library: Library) -> None:
    codes = ["A_1", "A%2", "\N{LATIN CAPITAL LETTER A WITH DIAERESIS}B-3", "AB-4"]
    patients = {code: library.patients.create(Patient(code=code)) for code in codes}
    for day, code in enumerate(["AB-4", "A_1"]):
        library.sessions.create(patients[code].id, Session((), started=f"2026-01-0{day + 1}"))

    def found(text: str) -> list[str]:
        return [patient.details.code for patient in library.patients.search(text)]

    assert found("")[:2] == ["A_1", "AB-4"]
    assert sorted(found("")) == sorted(codes)
    assert found("a_") == ["A_1"]
    assert found("%") == ["A%2"]
    assert found("\N{LATIN SMALL LETTER A WITH DIAERESIS}b") == [codes[2]]


def test_changing_a_patient_keeps_what_it_was_and_who_did_it(
    library: Library, patient: StoredPatient, clock: Clock
) -> None:
    clock.now += datetime.timedelta(hours=1)
    changed = library.patients.change(patient, replace(FULL, affected_side="right", mass_kg=None))
    assert changed.details == replace(FULL, affected_side="right", mass_kg=None)
    (correction,) = library.corrections.of_patient(patient.id)
    assert (correction.operator, correction.at, correction.is_undone) == ("hk", clock.now, False)
    assert {(c.field, c.old, c.new) for c in correction.changes} == {
        ("affected_side", "left", "right"),
        ("mass_kg", 70.1, None),
    }
    library.corrections.undo(correction.id)
    assert library.patients.get(patient.id).details == FULL
    again, first = library.corrections.of_patient(patient.id)
    assert (again.undoes, again.is_undone, first.is_undone) == (correction.id, False, True)
    with pytest.raises(LibraryError, match="This correction was already undone"):
        library.corrections.undo(correction.id)
    library.corrections.undo(again.id)
    assert library.patients.get(patient.id).details == changed.details


def test_a_change_that_changes_nothing_is_none(library: Library, patient: StoredPatient) -> None:
    assert library.patients.change(patient, FULL) == patient
    assert library.corrections.of_patient(patient.id) == ()


def test_what_was_changed_again_is_not_undone_over_it(library: Library, patient: StoredPatient) -> None:
    second = library.patients.change(patient, replace(FULL, aids="frame"))
    library.patients.change(second, replace(FULL, aids="none"))
    latest, first = library.corrections.of_patient(patient.id)
    with pytest.raises(ChangedMeanwhileError):
        library.corrections.undo(first.id)
    assert library.patients.get(patient.id).details.aids == "none"
    library.corrections.undo(latest.id)
    library.corrections.undo(first.id)
    assert library.patients.get(patient.id).details.aids == "cane"


def test_of_two_who_change_at_once_the_second_is_reported(
    library: Library, patient: StoredPatient, visit: StoredSession, walk: StoredRecording
) -> None:
    library.patients.change(patient, replace(FULL, aids="frame"))
    visit = library.sessions.get(visit.id)
    library.sessions.change(visit, replace(visit.details, zero_rad={Joint.LEFT_KNEE: 0.1}))
    library.recordings.change(walk, replace(WALK, is_kept=False))
    with pytest.raises(ChangedMeanwhileError):
        library.patients.change(patient, replace(FULL, device="none"))
    with pytest.raises(ChangedMeanwhileError):
        library.sessions.change(visit, replace(visit.details, zero_rad={Joint.LEFT_KNEE: 0.2}))
    with pytest.raises(ChangedMeanwhileError):
        library.recordings.change(walk, replace(WALK, condition="barefoot"))
    with pytest.raises(ChangedMeanwhileError):
        library.patients.delete(patient)
    with pytest.raises(ChangedMeanwhileError):
        library.sessions.delete(visit)


def test_a_session_comes_back_as_reported(library: Library, patient: StoredPatient) -> None:
    reported = Session(
        (),
        patient=FULL,
        zero_rad={Joint.LEFT_KNEE: math.radians(5.3), Joint.RIGHT_ANKLE: -0.0},
        turned_sign={Joint.RIGHT_KNEE: -1, Joint.LEFT_KNEE: 1},
        started="2026-01-01T08:30:00+01:00",
        operator="H. Keller",
        surface="carpet",
        notes="first\nsecond",
        software="0.1",
        findings=(Finding("acc_in_g", Severity.WARNING, "walk 1", {"factor": 9.81}),),
        unknown={"weather": "rain", "zero": {"left_hip": 1.0}},
    )
    visit = library.sessions.create(patient.id, reported)
    assert visit.details == reported
    assert library.sessions.get(visit.id) == visit
    library.sessions.place(visit.id, SENSORS)
    for recording in (WALK, replace(WALK, name="walk 2", is_restrapped_before=True, is_kept=False)):
        library.recordings.start(visit.id, recording, is_simulated=False)
    again = library.sessions.get(visit.id)
    assert again.details.recordings == (WALK, replace(WALK, name="walk 2", is_restrapped_before=True, is_kept=False))
    assert again.details.sensors == {site: sensor.info for site, sensor in SENSORS.items()}
    assert [recording.placement for recording in again.recordings] == [again.placements[0]] * 2


def test_a_session_needs_a_patient_who_is_there(library: Library, patient: StoredPatient) -> None:
    library.patients.delete(patient)
    for patient_id in (patient.id, uuid7()):
        with pytest.raises(LibraryError, match="no longer in the library"):
            library.sessions.create(patient_id, Session(()))


@pytest.mark.parametrize(
    "reported",
    [
        Session((), zero_rad={Joint.LEFT_KNEE: math.nan}),
        Session((), zero_rad={Joint.LEFT_KNEE: 5.3}),
        Session((), turned_sign={Joint.LEFT_KNEE: 0}),
    ],
)
def test_a_zero_or_sign_out_of_range_is_refused(library: Library, visit: StoredSession, reported: Session) -> None:
    with pytest.raises(LibraryError, match="The joint value must be"):
        library.sessions.create(visit.patient_id, reported)
    with pytest.raises(LibraryError, match="The joint value must be"):
        library.sessions.change(visit, reported)


def test_sessions_are_found_by_their_words(library: Library, patient: StoredPatient, walk: StoredRecording) -> None:
    other = library.patients.create(Patient(code="Q-2"))
    notes = "\N{LATIN CAPITAL LETTER U WITH DIAERESIS}bung 100%"
    library.sessions.create(other.id, Session((), started="2026-02-01", notes=notes))

    def found(text: str = "", **which: object) -> list[str]:
        return [line.patient_code for line in library.sessions.list(text=text, **which)]  # type: ignore[arg-type]  # which is one of two words

    assert found() == ["Q-2", "P-001"]
    assert found(patient_id=patient.id) == ["P-001"]
    assert found("\N{LATIN SMALL LETTER U WITH DIAERESIS}BUNG") == ["Q-2"]
    assert found("Alignment a") == ["P-001"]
    assert found("0%") == ["Q-2"]
    assert found("p-0") == ["P-001"]
    (line,) = library.sessions.list(patient.id)
    assert (line.conditions, line.recordings, line.is_simulated) == (("alignment A",), 1, False)


def test_zero_and_sign_are_corrected_and_taken_back(library: Library, visit: StoredSession) -> None:
    reported = replace(visit.details, zero_rad={Joint.LEFT_KNEE: 0.1}, turned_sign={Joint.LEFT_KNEE: -1}, notes="new")
    changed = library.sessions.change(visit, reported, comment="better")
    assert (changed.details, changed.comment) == (reported, "better")
    assert changed.version > visit.version
    (correction,) = library.corrections.of_session(visit.id)
    assert {change.field for change in correction.changes} == {"zero_rad", "turned_sign", "notes", "comment"}
    assert library.audit.entries(f"session:{visit.id}")[-1].action == Action.EDIT
    library.corrections.undo(correction.id)
    back = library.sessions.get(visit.id)
    assert (back.details, back.comment) == (visit.details, "")


def test_a_corrected_placement_leaves_the_old_one_in_the_history(
    library: Library, visit: StoredSession, walk: StoredRecording
) -> None:
    assert walk.placement is not None
    assert walk.placement.site_of == {"S1": Site.LEFT_SHANK, "S2": Site.LEFT_THIGH}
    edited = library.edits.placement(visit.id, {walk.id: walk.placement.id}, [([walk.id], SWAPPED)])
    (corrected,) = edited.stored.recordings
    assert corrected.placement is not None
    assert corrected.placement.sensors == SWAPPED
    again = library.sessions.get(visit.id)
    assert [placement.sensors for placement in again.placements] == [SENSORS, SWAPPED]
    assert again.recordings == (corrected,)
    (correction,) = library.corrections.of_session(visit.id)
    library.corrections.undo(correction.id)
    found = library.recordings.find(walk.id)
    assert found is not None
    assert found.placement == walk.placement


def test_one_sensor_at_two_sites_is_refused(library: Library, visit: StoredSession) -> None:
    with pytest.raises(LibraryError, match="two positions"):
        library.sessions.place(visit.id, {site: PlacedSensor("S1", SensorInfo()) for site in SENSORS})
    assert library.sessions.get(visit.id).placements == ()


def test_a_recording_goes_from_open_to_closed_with_the_hash_of_each_journal(
    library: Library, visit: StoredSession
) -> None:
    own = uuid7()
    started = library.recordings.start(visit.id, WALK, is_simulated=False, recording_id=own)
    assert (started.id, started.state, started.journals) == (own, RecordingState.OPEN, ())
    journals = tuple(StoredJournal(own, k, bytes([k]) * 60) for k in range(2))
    for journal in journals:
        library.recordings.add_journal(own, journal)
    assert [recording.id for recording in library.recordings.still_open()] == [own]
    with pytest.raises(LibraryError, match="The files of the recording do not match the library"):
        library.recordings.close(own, RecordingState.CLOSED, {0: "a"})
    with pytest.raises(LibraryError, match="The recording already has this part"):
        library.recordings.add_journal(own, journals[0])
    closed = library.recordings.close(own, RecordingState.RECOVERED, {0: "a", 1: "b"})
    assert closed.state is RecordingState.RECOVERED
    assert closed.journals == (replace(journals[0], sha256="a"), replace(journals[1], sha256="b"))
    assert library.recordings.still_open() == ()
    assert library.recordings.find(own) == closed
    assert library.recordings.find(uuid7()) is None
    library.recordings.discard(own)
    gone = library.recordings.find(own)
    assert gone is not None
    assert gone.state is RecordingState.DISCARDED
    assert [journal.wrapped_key for journal in gone.journals] == [None, None]


def test_recordings_of_one_session_have_names_of_their_own(
    library: Library, visit: StoredSession, walk: StoredRecording
) -> None:
    with pytest.raises(LibraryError, match="of this name"):
        library.recordings.start(visit.id, WALK, is_simulated=False)
    second = library.recordings.start(visit.id, replace(WALK, name="walk 2"), is_simulated=False)
    with pytest.raises(LibraryError, match="of this name"):
        library.recordings.change(second, WALK)


def test_what_was_reported_of_a_recording_is_corrected_and_taken_back(library: Library, walk: StoredRecording) -> None:
    reported = replace(
        WALK,
        condition="barefoot",
        is_kept=False,
        kind=RecordingKind.FREE_MOTION,
        is_restrapped_before=True,
        left_out_s={Side.LEFT: (1 / 3, 7.25), Side.RIGHT: (4.0,)},
        alignment=AlignmentChange(
            "alignment A", (PartChange(ProsthesisPart.PYLON, height_mm=3.0, text="\N{SNOWMAN}"),)
        ),
    )
    changed = library.recordings.change(walk, reported)
    assert changed.details == reported
    (correction,) = library.corrections.of_session(walk.session_id)
    assert {"left_out", "alignment"} <= {change.field for change in correction.changes}
    assert "left_out" in library.audit.entries(f"session:{walk.session_id}")[-1].details
    library.corrections.undo(correction.id)
    found = library.recordings.find(walk.id)
    assert found is not None
    assert found.details == WALK


def test_a_goal_that_is_replaced_stays_in_the_history_and_comes_back(library: Library, patient: StoredPatient) -> None:
    agreed = library.patients.change(patient, replace(FULL, goals=(GOAL,)))
    assert library.patients.get(patient.id).details.goals == (GOAL,)
    more = replace(GOAL, value=1.3, agreed=GOAL.agreed + datetime.timedelta(days=7))
    replaced = library.patients.change(agreed, replace(FULL, goals=with_goal(agreed.details.goals, more)))
    assert held(replaced.details.goals) == (more,)
    assert [goal.value for goal in replaced.details.goals] == [1.2, 1.3]
    latest, first = library.corrections.of_patient(patient.id)
    assert [change.field for change in (*latest.changes, *first.changes)] == ["goals", "goals"]
    assert json.loads(library.audit.entries(f"patient:{patient.id}")[-1].details)["fields"] == ["goals"]
    library.corrections.undo(latest.id)
    assert library.patients.get(patient.id).details.goals == (GOAL,)
    assert library.patients.search()[0].details.goals == (GOAL,)


def test_a_double_brings_its_goals(library: Library) -> None:
    knee = Goal("knee_range_deg", GoalOf.LEFT, 55.0, GOAL.agreed)
    kept = library.patients.create(Patient(code="P-1", goals=(knee,)))
    double = library.patients.create(Patient(code="P-2", goals=(GOAL,)))
    assert library.patients.merge(kept, double).details.goals == ordered((knee, GOAL))


TRANSTIBIAL = Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING)


def test_what_is_stated_of_a_prosthesis_is_stored_corrected_and_taken_back(library: Library) -> None:
    made = library.patients.create(
        Patient(code="P-3", prosthetic_side="left", prostheses={Side.LEFT: TRANSTIBIAL, Side.RIGHT: NOT_STATED})
    )
    assert made.details.prostheses == {Side.LEFT: TRANSTIBIAL}
    other = {Side.LEFT: Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.MICROPROCESSOR)}
    corrected = library.patients.change(made, replace(made.details, prostheses=other))
    assert library.patients.get(made.id).details.prostheses == other
    (correction,) = library.corrections.of_patient(made.id)
    assert [change.field for change in correction.changes] == ["prostheses"]
    library.corrections.undo(correction.id)
    again = library.patients.get(made.id)
    assert again.details == made.details
    assert again.version > corrected.version


def test_a_double_brings_what_was_stated_of_its_prosthesis_where_the_other_states_nothing(library: Library) -> None:
    transfemoral = Prosthesis(AmputationLevel.TRANSFEMORAL)
    kept = library.patients.create(Patient(code="P-1", prosthetic_side="both", prostheses={Side.LEFT: transfemoral}))
    double = library.patients.create(
        Patient(code="P-2", prosthetic_side="both", prostheses={Side.LEFT: TRANSTIBIAL, Side.RIGHT: TRANSTIBIAL})
    )
    merged = library.patients.merge(kept, double)
    assert merged.details.prostheses == {Side.LEFT: transfemoral, Side.RIGHT: TRANSTIBIAL}


def test_doubles_are_merged_and_parted_again(library: Library, patient: StoredPatient, visit: StoredSession) -> None:
    kept = library.patients.create(Patient(code="P-1", aids="frame"))
    patient = library.patients.get(patient.id)
    merged = library.patients.merge(kept, patient)
    assert merged.details == replace(FULL, code="P-1", aids="frame", unknown={})
    assert merged.sessions == 1
    assert [line.patient_code for line in library.sessions.list()] == ["P-1"]
    assert [found.id for found in library.patients.search()] == [kept.id]
    assert library.patients.find("P-001") == merged
    with pytest.raises(LibraryError, match="was merged with another patient"):
        library.patients.create(FULL)
    (correction,) = library.corrections.of_patient(kept.id)
    library.corrections.undo(correction.id)
    assert library.patients.get(kept.id).details == kept.details
    assert [line.patient_code for line in library.sessions.list()] == ["P-001"]
    assert library.patients.get(patient.id).details == FULL


def test_a_double_of_a_double_is_merged_too(library: Library, patient: StoredPatient, clock: Clock) -> None:
    first = library.patients.create(Patient(code="P-1"))
    second = library.patients.create(Patient(code="P-2"))
    first = library.patients.merge(first, patient)
    second = library.patients.merge(second, first)
    assert library.patients.find("P-001") == second
    library.corrections.undo(library.corrections.of_patient(second.id)[0].id)
    assert library.patients.find("P-001") == library.patients.find("P-1")
    second = library.patients.merge(library.patients.get(second.id), library.patients.get(first.id))
    library.patients.delete(second)
    clock.now += datetime.timedelta(days=30)
    library.patients.destroy(second.id)
    assert [library.patients.find(code) for code in ("P-001", "P-1", "P-2")] == [None, None, None]


def test_a_patient_is_not_merged_with_itself_or_a_deleted_one(library: Library, patient: StoredPatient) -> None:
    gone = library.patients.delete(library.patients.create(Patient(code="P-1")))
    for other in (patient, gone):
        with pytest.raises(LibraryError, match="cannot be merged"):
            library.patients.merge(patient, other)


def test_what_is_deleted_can_be_restored(library: Library, patient: StoredPatient, visit: StoredSession) -> None:
    library.sessions.delete(visit)
    assert library.sessions.list() == ()
    (line,) = library.sessions.list(is_deleted=True)
    assert line.id == visit.id
    library.sessions.restore(library.sessions.get(visit.id))
    assert [line.id for line in library.sessions.list()] == [visit.id]
    library.patients.delete(library.patients.get(patient.id))
    assert library.patients.search() == ()
    assert library.sessions.list() == ()
    with pytest.raises(LibraryError, match="deleted patient has this code"):
        library.patients.create(FULL)
    (gone,) = library.patients.search(is_deleted=True)
    library.patients.restore(gone)
    assert [line.id for line in library.sessions.list()] == [visit.id]


def test_only_what_was_deleted_30_days_ago_is_destroyed_and_then_nothing_is_left(
    library: Library, database: Database, patient: StoredPatient, walk: StoredRecording, clock: Clock
) -> None:
    double = library.patients.create(Patient(code="P-1"))
    library.patients.change(double, Patient(code="P-2"))
    library.patients.merge(library.patients.get(patient.id), library.patients.get(double.id))
    inputs = AnalysisInputs((), {}, {}, {}, "1", {})
    library.results.keep(walk.session_id, ResultKind.ANALYSIS, inputs, "json", b"{}")
    library.courses.keep(walk.session_id, "key", Course(None, ()))
    with pytest.raises(LibraryError, match="30 days"):
        library.patients.destroy(patient.id)
    library.patients.delete(library.patients.get(patient.id))
    clock.now += datetime.timedelta(days=29, hours=23)
    assert library.sessions.deleted_before(clock.now - KEPT_DELETED) == ()
    with pytest.raises(LibraryError, match="30 days"):
        library.patients.destroy(patient.id)
    with pytest.raises(LibraryError, match="30 days"):
        library.sessions.destroy(walk.session_id)
    clock.now += datetime.timedelta(hours=1)
    (overdue,) = library.sessions.deleted_before(clock.now - KEPT_DELETED)
    assert overdue.recordings[0].journals[0].file == f"{walk.id}.0.journal"
    library.patients.destroy(patient.id)
    with database.reading() as session:
        left = {
            name: session.scalar(select(func.count()).select_from(table))
            for name, table in Base.metadata.tables.items()
        }
    assert {name: count for name, count in left.items() if count} == {"operators": 1, "audit": left["audit"]}
    assert library.audit.entries(f"patient:{patient.id}")[-1].action == "delete"


def test_a_deleted_session_is_destroyed_by_itself(library: Library, walk: StoredRecording, clock: Clock) -> None:
    library.sessions.delete(library.sessions.get(walk.session_id))
    clock.now += datetime.timedelta(days=30)
    library.sessions.destroy(walk.session_id)
    assert library.recordings.find(walk.id) is None
    assert len(library.patients.search()) == 1


def test_the_history_of_one_patient_is_of_nobody_else(
    library: Library, patient: StoredPatient, walk: StoredRecording
) -> None:
    stranger = library.patients.create(Patient(code="Q-2"))
    library.patients.change(stranger, Patient(code="Q-3"))
    library.patients.change(library.patients.get(patient.id), replace(FULL, aids="frame"))
    library.recordings.change(walk, replace(WALK, is_kept=False))
    found = library.corrections.of_patient(patient.id)
    assert [correction.changes[0].field for correction in found] == ["is_kept", "aids"]


def test_looking_at_a_session_is_noted(library: Library, visit: StoredSession) -> None:
    library.sessions.get(visit.id)
    library.sessions.view(visit.id)
    assert [entry.action for entry in library.audit.entries(f"session:{visit.id}")] == ["create", "view"]

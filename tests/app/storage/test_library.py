"""A library opens for whom it knows, keeps what it was given, and states in words what it cannot do."""

import datetime
import random
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from app.storage.database.engine import Database, sqlite_engine
from app.storage.layout import DATABASE
from app.storage.library import Library
from app.storage.stored import (
    AnalysedRecording,
    AnalysisInputs,
    ChangedMeanwhileError,
    LibraryError,
    NotAllowedError,
    Operator,
    ResultKind,
    Role,
)
from core.body import Joint, Site
from core.session import Patient, Recording, RecordingKind, Session

DATA_KEY = bytes(range(32))
FIRST = Operator("HK", "H. Keller", Role.VIEWER)
WRITE = """
import itertools
import sys
from pathlib import Path
from app.storage.library import Library
from app.storage.stored import Action
with Library.open(Path(sys.argv[1]), bytes(range(32))) as library:
    library.log_in("hk")
    for k in itertools.count():
        library.audit.note(Action.PRINT, f"kill:{sys.argv[2]}", k=k)
        print(k, flush=True)
"""
INPUTS = AnalysisInputs(
    recordings=(
        AnalysedRecording("walk 1", "walk_1", RecordingKind.WALKING, True, False, ((Site.LEFT_SHANK, "ab" * 32),)),
    ),
    zero_rad={Joint.LEFT_KNEE: 0.1},
    turned_sign={Joint.LEFT_KNEE: -1},
    details={"affected_side": "left"},
    algorithm="1.0",
    parameters={"method": "robust", "tau_s": 5.0},
)


@pytest.fixture
def clinician(library: Library) -> Library:
    library.operators.add(Operator("ab", "A. Berger", Role.CLINICIAN))
    library.log_in("ab")
    return library


def test_a_new_library_has_one_administrator_and_opens_again(tmp_path: Path) -> None:
    with Library.create(tmp_path / "deep" / "library", DATA_KEY, FIRST) as library:
        assert library.operator == replace(FIRST, code="hk", role=Role.ADMINISTRATOR)
        assert not library.is_demonstration
        library.patients.create(Patient(code="P-1"))
    with Library.open(tmp_path / "deep" / "library", DATA_KEY) as library:
        assert library.operator is None
        library.log_in("HK", failed_before=2)
        assert library.patients.find("p-1") is not None
        assert library.audit.entries()[-1].details == '{"failed_before":2}'
        assert library.faults() == ()


def test_a_library_is_not_made_over_another(tmp_path: Path) -> None:
    with Library.create(tmp_path, DATA_KEY, FIRST) as library:
        library.patients.create(Patient(code="P-1"))
    with pytest.raises(LibraryError, match="already has a library"):
        Library.create(tmp_path, DATA_KEY, Operator("xx", "", Role.ADMINISTRATOR))
    with pytest.raises(LibraryError, match="This key does not open the library, or the start of its file is damaged"):
        Library.create(tmp_path, bytes(32), FIRST)
    with Library.open(tmp_path, DATA_KEY) as library:
        library.log_in("hk")
        assert len(library.patients.search()) == 1


def test_making_a_library_that_was_interrupted_is_finished(tmp_path: Path) -> None:
    Library.create(tmp_path, DATA_KEY, FIRST).close()
    (tmp_path / DATABASE).unlink()
    engine = sqlite_engine(tmp_path / DATABASE, DATA_KEY)
    Library(Database(engine), DATA_KEY).close()  # it has tables, and nobody yet
    with Library.create(tmp_path, DATA_KEY, FIRST) as library:
        assert [operator.code for operator in library.operators.list()] == ["hk"]


def test_no_library_and_no_rights_are_stated(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="no library"):
        Library.open(tmp_path, DATA_KEY)
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "file").write_text("")
    with pytest.raises(LibraryError, match="is not writable"):
        Library.create(tmp_path / "file", DATA_KEY, FIRST)


@pytest.mark.parametrize("content", [b"", b"SQLite format 3\0" + bytes(4080), b"x" * 8192])
def test_what_is_no_library_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / DATABASE).write_bytes(content)
    if content:
        with pytest.raises(LibraryError, match="does not open"):
            Library.open(tmp_path, DATA_KEY)
    else:
        with (
            Library.open(tmp_path, DATA_KEY) as library,
            pytest.raises(NotAllowedError, match="This user is not active in this library"),
        ):
            library.log_in("hk")


@pytest.mark.endurance
def test_what_was_stated_to_be_kept_is_there_after_a_kill(tmp_path: Path) -> None:
    Library.create(tmp_path, DATA_KEY, FIRST).close()
    rng = random.Random(1)
    for kill in range(12):
        with subprocess.Popen([sys.executable, "-c", WRITE, tmp_path, str(kill)], stdout=subprocess.PIPE) as writer:
            assert writer.stdout is not None
            stated = [writer.stdout.readline()]
            time.sleep(rng.uniform(0.1, 0.4))
            writer.kill()
            stated += writer.stdout.read().splitlines()
        with Library.open(tmp_path, DATA_KEY) as library:
            library.log_in("hk")
            kept = [entry.details for entry in library.audit.entries(f"kill:{kill}", last=100_000)]
            assert len(stated) <= len(kept) <= len(stated) + 1  # one may be kept and not stated yet
            assert kept == [f'{{"k":{k}}}' for k in range(len(kept))]
            assert library.faults() == ()
            assert library.audit.verify().faults == ()


def test_nothing_works_before_somebody_logs_in(library: Library) -> None:
    library.log_out()
    for call in (library.patients.search, library.sessions.list, library.operators.list, library.recordings.still_open):
        with pytest.raises(NotAllowedError, match="Log in"):
            call()
    with pytest.raises(NotAllowedError, match="Log in"):
        library.patients.create(Patient(code="P-1"))
    with pytest.raises(NotAllowedError, match="This user is not active in this library"):
        library.log_in("xx")


def test_roles_allow_what_they_say(clinician: Library) -> None:
    with pytest.raises(NotAllowedError, match="administrator"):
        clinician.operators.add(Operator("cd", "", Role.VIEWER))
    with pytest.raises(NotAllowedError, match="administrator"):
        clinician.settings.put("clinic", "x")
    patient = clinician.patients.create(Patient(code="P-1"))
    visit = clinician.sessions.create(patient.id, Session(()))
    clinician.log_in("hk")
    clinician.operators.add(Operator("cd", "", Role.VIEWER))
    clinician.log_in("cd")
    assert clinician.patients.search() != ()
    assert clinician.sessions.view(visit.id) == visit
    with pytest.raises(NotAllowedError, match="clinician"):
        clinician.patients.change(patient, replace(patient.details, aids="cane"))
    with pytest.raises(NotAllowedError, match="clinician"):
        clinician.patients.delete(patient)


def test_a_role_that_was_taken_away_counts_at_once(clinician: Library) -> None:
    other = Library(clinician.database, DATA_KEY)
    other.log_in("hk")
    (mine,) = (operator for operator in other.operators.list() if operator.code == "ab")
    other.operators.change(replace(mine, is_active=False))
    with pytest.raises(NotAllowedError, match="clinician"):
        clinician.patients.create(Patient(code="P-1"))
    with pytest.raises(NotAllowedError, match="This user is not active in this library"):
        clinician.log_in("ab")


def test_operators_are_changed_by_who_saw_them_last_and_one_administrator_stays(library: Library) -> None:
    first = library.operators.add(Operator("ab", "A. Berger", Role.CLINICIAN))
    second = library.operators.change(replace(first, name="A. Berger-Graf"))
    with pytest.raises(ChangedMeanwhileError):
        library.operators.change(replace(first, role=Role.VIEWER))
    with pytest.raises(LibraryError, match="has this code"):
        library.operators.add(Operator("AB", "", Role.CLINICIAN))
    (administrator,) = (operator for operator in library.operators.list() if operator.code == "hk")
    with pytest.raises(LibraryError, match="needs an administrator"):
        library.operators.change(replace(administrator, role=Role.CLINICIAN))
    library.operators.change(replace(second, role=Role.ADMINISTRATOR))
    library.operators.change(replace(administrator, role=Role.CLINICIAN))


def test_settings_are_kept(library: Library) -> None:
    assert library.settings.get("clinic", "nowhere") == "nowhere"
    for value in ("Clinic", {"retention": [30, None, 0.5]}, False):
        library.settings.put("clinic", value)
        assert library.settings.get("clinic") == value


def test_simulated_recordings_go_to_demo_patients_only(library: Library) -> None:
    walk = Recording("walk 1", RecordingKind.WALKING, "walk_1", {})
    real = library.patients.create(Patient(code="P-1"))
    demo = library.patients.create(Patient(code="DEMO-1"))
    with pytest.raises(LibraryError, match="DEMO"):
        library.sessions.create(real.id, Session((), is_simulated=True))
    visit = library.sessions.create(real.id, Session(()))
    with pytest.raises(LibraryError, match="DEMO"):
        library.recordings.start(visit.id, walk, is_simulated=True)
    assert library.sessions.get(visit.id) == visit
    shown = library.sessions.create(demo.id, Session(()))
    assert library.recordings.start(shown.id, walk, is_simulated=True).is_simulated
    assert library.sessions.get(shown.id).details.is_simulated
    demo = library.patients.get(demo.id)
    with pytest.raises(LibraryError, match="DEMO"):
        library.patients.change(demo, replace(demo.details, code="P-2"))
    with pytest.raises(LibraryError, match="DEMO"):
        library.patients.merge(library.patients.get(real.id), demo)
    library.recordings.start(visit.id, walk, is_simulated=False)


def test_a_code_that_only_contains_demo_is_a_real_patients(library: Library) -> None:
    for code in ("demo-1", "P-DEMO"):
        patient = library.patients.create(Patient(code=code))
        with pytest.raises(LibraryError, match="DEMO"):
            library.sessions.create(patient.id, Session((), is_simulated=True))


def test_the_demonstration_has_a_library_of_its_own_without_real_recordings() -> None:
    walk = Recording("walk 1", RecordingKind.WALKING, "walk_1", {})
    with Library.demonstration() as library:
        assert library.is_demonstration
        folder = Path(library.database.engine.raw_connection().execute("PRAGMA database_list").fetchone()[2]).parent
        visit = library.sessions.create(library.patients.create(Patient(code="anyone")).id, Session(()))
        library.recordings.start(visit.id, walk, is_simulated=True)
        with pytest.raises(LibraryError, match="simulated recordings only"):
            library.recordings.start(visit.id, replace(walk, name="walk 2"), is_simulated=False)
        assert library.faults() == ()
        assert folder.stat().st_mode & 0o077 == 0
    assert not folder.exists()


def test_a_result_is_found_by_all_that_it_depends_on_and_by_nothing_less(library: Library) -> None:
    visit = library.sessions.create(library.patients.create(Patient(code="P-1")).id, Session(()))
    kept = library.results.keep(visit.id, ResultKind.ANALYSIS, INPUTS, "json", b"{}")
    assert library.results.find(visit.id, ResultKind.ANALYSIS, INPUTS) == kept
    assert library.results.keep(visit.id, ResultKind.ANALYSIS, INPUTS, "json", b"{}") == kept
    (walk,) = INPUTS.recordings
    others = [
        replace(INPUTS, recordings=(replace(walk, samples=((Site.LEFT_SHANK, "cd" * 32),)),)),
        replace(INPUTS, recordings=(replace(walk, samples=((Site.LEFT_FOOT, "ab" * 32),)),)),
        replace(INPUTS, recordings=(replace(walk, kind=RecordingKind.FREE_MOTION),)),
        replace(INPUTS, recordings=(replace(walk, folder="walk"),)),
        replace(INPUTS, recordings=(replace(walk, is_kept=False),)),
        replace(INPUTS, recordings=(replace(walk, is_restrapped_before=True),)),
        replace(INPUTS, recordings=(walk, walk)),
        replace(INPUTS, zero_rad={Joint.LEFT_KNEE: 0.1000000001}),
        replace(INPUTS, zero_rad={Joint.RIGHT_KNEE: 0.1}),
        replace(INPUTS, turned_sign={}),
        replace(INPUTS, algorithm="1.1"),
        replace(INPUTS, parameters={"method": "robust", "tau_s": 6.0}),
        replace(INPUTS, details={"affected_side": "right"}),
    ]
    for other in others:
        assert library.results.find(visit.id, ResultKind.ANALYSIS, other) is None
    assert library.results.find(visit.id, ResultKind.CALIBRATION, INPUTS) is None
    same = replace(INPUTS, parameters={"tau_s": 5.0, "method": "robust"})
    assert library.results.find(visit.id, ResultKind.ANALYSIS, same) == kept


def test_of_the_results_of_a_session_the_latest_two_are_kept_and_one_computed_again_takes_its_place(
    library: Library,
) -> None:
    """What was corrected and is undone is there at once; a long session does not fill the library with the rest."""
    visit = library.sessions.create(library.patients.create(Patient(code="P-1")).id, Session(()))
    versions = [replace(INPUTS, algorithm=name) for name in ("1", "2", "3")]
    for inputs in versions:
        library.results.keep(visit.id, ResultKind.ANALYSIS, inputs, "json", inputs.algorithm.encode())
    found = [library.results.find(visit.id, ResultKind.ANALYSIS, inputs) for inputs in versions]
    assert [None if one is None else one.content for one in found] == [None, b"2", b"3"]
    library.results.keep(visit.id, ResultKind.ANALYSIS, versions[2], "json", b"mended")
    mended = library.results.find(visit.id, ResultKind.ANALYSIS, versions[2])
    assert mended is not None
    assert mended.content == b"mended"


def test_a_result_is_kept_though_the_clock_was_set_back(library: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    visit = library.sessions.create(library.patients.create(Patient(code="P-1")).id, Session(()))
    for name in ("1", "2"):
        library.results.keep(visit.id, ResultKind.ANALYSIS, replace(INPUTS, algorithm=name), "json", b"{}")
    true_ns = time.time_ns
    monkeypatch.setattr(time, "time_ns", lambda: true_ns() - 86_400_000_000_000)
    latest = replace(INPUTS, algorithm="3")
    kept = library.results.keep(visit.id, ResultKind.ANALYSIS, latest, "json", b"{}")
    assert library.results.find(visit.id, ResultKind.ANALYSIS, latest) == kept


def test_the_database_is_loaded_when_a_library_is_opened_and_not_before() -> None:
    look = "import sys, app.cli.main, app.main_window, app.storage.stored; print('sqlalchemy' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", look], capture_output=True, text=True, check=True)
    assert run.stdout == "False\n"


def test_days_are_the_clinics_not_the_machines(database: Database) -> None:
    days = [datetime.datetime(2026, 1, 1, tzinfo=datetime.UTC)]
    with Library(database, DATA_KEY, now=lambda: days[0]) as library:
        library.begin(FIRST)
        patient = library.patients.create(Patient(code="P-1"))
        assert patient.created_at == days[0]
        assert library.audit.entries()[-1].at == "2026-01-01T00:00:00+00:00"

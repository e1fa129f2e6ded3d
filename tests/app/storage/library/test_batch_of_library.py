"""A batch of the library: no key leaves the process, what leaves is noted first, what has not changed is not read."""

import csv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import pytest

from app.cli import main as cli
from app.cohort.batch import library_sessions
from app.storage.exchange import import_session, session_with_samples
from app.storage.journal.decoding import Decoders
from app.storage.journal.disk import Room
from app.storage.opened import OpenedLibrary
from app.storage.pseudonyms import Pseudonyms
from app.storage.stored import Action, StoredSession
from app.system.progress import Report, nobody
from core.session import Patient, Session
from tests.app.batch_material import results_in, swinging_session

ANY_ROOM = Room(start_bytes=0, kept_bytes=0)
BARE = ("--no-report", "--no-rrd", "--workers", "1")

RunBatch = Callable[..., int]


@pytest.fixture
def visits(opened: OpenedLibrary) -> list[UUID]:
    """Two sessions of one patient."""
    patient = Patient(code="MUSTER-7", birth_year=1980)
    reported = [replace(swinging_session(seed, patient), notes="Anna", operator="hk") for seed in (1, 2)]
    return [import_session(opened, one, nobody, room=ANY_ROOM).session_id for one in reported]


@pytest.fixture
def run_batch(opened: OpenedLibrary, tmp_path: Path) -> RunBatch:
    file = tmp_path / "passphrase"
    file.write_text("four short words here\n", encoding="utf-8")

    def run(*more: str, out: Path = tmp_path / "out") -> int:
        key = ["--library", str(opened.folder), "--passphrase-file", str(file)]
        return cli.main(["batch", "library", "--out", str(out), *key, *(more or BARE)])

    return run


def exported(opened: OpenedLibrary) -> list[str]:
    return [entry.subject for entry in opened.library.audit.entries() if entry.action == Action.EXPORT]


def test_each_session_of_the_library_is_analysed_as_analyse_does_it(
    opened: OpenedLibrary, visits: list[UUID], run_batch: RunBatch, tmp_path: Path
) -> None:
    assert run_batch() == 0
    key = ["--library", str(opened.folder), "--passphrase-file", str(tmp_path / "passphrase")]
    alone = tmp_path / "alone"
    assert cli.main(["analyse", f"library:{visits[1]}", "--out", str(alone), *key, *BARE[:2]]) == 0
    assert results_in(tmp_path / "out" / str(visits[1])) == results_in(alone)


@pytest.mark.endurance
def test_the_table_shows_pseudonyms_and_shifted_days_and_nobodys_name(
    opened: OpenedLibrary, visits: list[UUID], run_batch: RunBatch, tmp_path: Path
) -> None:
    assert run_batch() == 0
    written = (tmp_path / "out" / "parameters.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(written.splitlines()))
    patient_id = opened.library.sessions.get(visits[0]).patient_id
    pseudonyms = Pseudonyms(opened.library.pseudonyms_key)
    assert {row["patient"] for row in rows} == {pseudonyms.code(patient_id)}
    assert {row["started"] for row in rows} == {pseudonyms.shifted(patient_id, "2026-05-04T10:00:00")[:10]}
    assert {row["session"] for row in rows} == {str(visit) for visit in visits}
    assert {row["age_years"] for row in rows} == {"46"}
    assert [stated for stated in ("MUSTER", "Anna") if stated in written] == []
    assert not any("1980" in row.values() for row in rows)  # as a cell: digits of figures and ids may be the same


@pytest.mark.endurance
def test_what_leaves_is_noted_before_it_is_read_and_what_has_not_changed_does_not_leave_again(
    opened: OpenedLibrary, visits: list[UUID], run_batch: RunBatch, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    read: list[tuple[UUID, int]] = []

    def noting(opened: OpenedLibrary, visit: StoredSession, decoders: Decoders, report: Report) -> Session:
        read.append((visit.id, len(exported(opened))))
        return session_with_samples(opened, visit, decoders, report)

    monkeypatch.setattr(library_sessions, "session_with_samples", noting)
    assert run_batch() == 0
    assert read == [(visits[0], 1), (visits[1], 2)]
    assert exported(opened) == [f"session:{visit}" for visit in visits]
    before = results_in(tmp_path / "out")
    assert run_batch() == 0
    assert len(read) == len(exported(opened)) == 2
    assert results_in(tmp_path / "out") == before
    stored = opened.library.sessions.get(visits[0])
    opened.library.sessions.change(stored, replace(stored.details, notes="corrected"))
    assert run_batch() == 0
    assert [visit for visit, _ in read[2:]] == [visits[0]]


@pytest.mark.endurance
def test_a_session_whose_recording_is_gone_is_a_failure_and_the_other_is_done(
    opened: OpenedLibrary, visits: list[UUID], run_batch: RunBatch, capsys: pytest.CaptureFixture[str]
) -> None:
    journal = opened.library.sessions.get(visits[0]).recordings[0].journals[0]
    (opened.recordings / journal.file).unlink()
    assert run_batch() == 0
    first, failed = capsys.readouterr().out.splitlines()
    assert "2 sessions, 1 analysed, 1 failed" in first
    assert failed.startswith(f"- {visits[0]}: ")
    assert "missing" in failed


def test_results_do_not_go_into_the_library_and_samples_not_over_a_network_in_the_clear(
    opened: OpenedLibrary, visits: list[UUID], run_batch: RunBatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_batch(out=opened.folder / "out") == 2
    assert "this folder is in the library" in capsys.readouterr().err
    assert run_batch("--dask", "tcp://192.0.2.1:8786") == 2
    assert "for anybody to read on the way" in capsys.readouterr().err
    assert exported(opened) == []


def test_a_library_without_a_recording_is_refused(
    opened: OpenedLibrary, session_id: UUID, run_batch: RunBatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_batch() == 2
    assert "no session in this library has a recording" in capsys.readouterr().err

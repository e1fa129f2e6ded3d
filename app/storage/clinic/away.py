"""Work of a station while the clinic's server does not answer. It gets to the others afterwards, once.

It works in a library of its own, in its folder's `away`, under the clinic's data key: patients and sessions that are
begun there are begun as always. Once the server answers, the folder is renamed, so that a next outage begins another;
all its rows go to the server in one transaction, which leaves a mark; then its journals become the station's own, which
are handed over as any. Killed anywhere in between, the next start goes on, and nothing goes there twice. The mark holds
the end of its audit: a station that was restored from an image brings what it recorded since, under the same mark.

A patient is known again by the code. What the clinic states of a patient holds; what was stated about one here fills
no gaps, but goals that were agreed here are added to those at the clinic.
"""

import hmac
import json
import logging
import shutil
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import Any
from uuid import UUID

from sqlalchemy import Table, func, insert, inspect, select
from sqlalchemy.orm import Session as OrmSession

from app.storage.audit import append, end_of_audit
from app.storage.clinic.server_state import refuse_closed
from app.storage.clinic.station import station_of
from app.storage.data_key import DataKey
from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.models import (
    AuditRow,
    Base,
    CorrectionRow,
    OperatorRow,
    PatientRow,
    RecordingRow,
    SettingRow,
    folded,
)
from app.storage.database.values import reported_patient
from app.storage.derived_keys import derived_keys
from app.storage.files import replace_file, sync_folder
from app.storage.layout import DATABASE, RECORDINGS, SUFFIX
from app.storage.library import Library, now_utc
from app.storage.opened import OpenedLibrary, held_alone
from app.storage.root import read_id
from app.storage.stored import BEGINNING, Action, Checkpoint, LibraryError, NotAllowedError, Operator, Role
from core.goals import brought_together, goals_text

AWAY, COMING_HOME = "away", "away-coming-home"
OPERATORS = "operators.json"  # who works at the clinic, as the station saw it last
MARK = "away {library}"  # the setting that states up to which entry of its audit an away library is on the server
NOT_COVERED = "away-not-covered-{number}"  # a folder that is kept: what was edited in it is not on the server
OWN_TO_EACH = {"settings", "operators", "audit", "patients", "corrections"}  # tables that are not copied row by row

DERIVED = {"results", "courses", "readings"}  # tables that are recomputed from the others, or of a server alone
SERVERS = {"kept_as", "station", "version", "patient_id"}  # columns that change at the server by themselves

_log = logging.getLogger(__name__)


def remember_operators(opened: OpenedLibrary) -> None:
    """Keep who works at the clinic, for when its server does not answer; raises LibraryError or OSError."""
    reported = [asdict(operator) for operator in opened.library.operators.list()]
    replace_file(opened.folder / OPERATORS, json.dumps(reported, indent=1).encode())


def open_away(folder: Path, data_key: DataKey, code: str) -> OpenedLibrary:
    """Open a station's own library while the server is away; raises LibraryError (unknown code, no access)."""
    station, operator = station_of(folder), _remembered(folder, code)
    away = folder / AWAY
    if (away / DATABASE).exists():
        library = Library.open(away, data_key)
    else:
        library = Library.create(away, data_key, operator)
        library.log_out()
    try:
        _let_in(library, operator)
        library.log_in(operator.code)
    except BaseException:
        library.close()
        raise
    return OpenedLibrary(library, away, data_key, away_from=station)


def has_been_away(opened: OpenedLibrary) -> bool:
    """Whether something that was recorded without the server is still on this computer alone."""
    return any((opened.folder / name / DATABASE).exists() for name in (AWAY, COMING_HOME))


def bring_away_home(opened: OpenedLibrary) -> int:
    """Send what was recorded while the server did not answer, and give the number of sessions.
    To be done before interrupted recordings are searched for. Raises LibraryError (it stays here), OSError.
    """
    if opened.shared is None:
        return 0
    sessions = 0
    away, coming = opened.folder / AWAY, opened.folder / COMING_HOME
    for is_from_before in (True, False):
        if not is_from_before and (away / DATABASE).exists():
            with held_alone(away):  # nobody works with it now
                away.rename(coming)
            sync_folder(opened.folder)
        if (coming / DATABASE).exists():
            count, is_covered = _bring_rows(opened, coming)
            sessions += count
            _bring_journals(opened, coming)
            if not is_covered:
                _keep(coming)
        shutil.rmtree(coming, ignore_errors=True)
    return sessions


def _keep(coming: Path) -> None:
    """Put a folder aside that holds other values of rows than the server: neither is thrown away."""
    number = 1
    while (kept := coming.with_name(NOT_COVERED.format(number=number))).exists():
        number += 1
    coming.rename(kept)
    sync_folder(kept.parent)
    _log.error("%s holds edits that are not on the server, whose values differ: it is kept", kept.name)


def _remembered(folder: Path, code: str) -> Operator:
    try:
        reported = json.loads((folder / OPERATORS).read_bytes())
        found = next(one for one in reported if one["code"] == folded(code) and one["is_active"])
        return Operator(found["code"], found["name"], Role(found["role"]))
    except (OSError, ValueError, KeyError, TypeError, StopIteration):
        raise NotAllowedError(
            "This workstation does not know this user yet", "Log in once while the clinic's server is available"
        ) from None


def _let_in(library: Library, operator: Operator) -> None:
    with library.database.writing() as session:
        row = session.get(OperatorRow, operator.code)
        if row is None:
            session.add(
                OperatorRow(
                    code=operator.code, name=operator.name, role=operator.role, is_active=True, created_at=now_utc()
                )
            )
        else:
            row.name, row.role, row.is_active = operator.name, operator.role, True


def _bring_rows(opened: OpenedLibrary, folder: Path) -> tuple[int, bool]:
    """Bring what the mark on the server does not cover; how many sessions, and whether the server then has it all."""
    station = opened.library.station
    assert station is not None  # the caller has asked
    name = MARK.format(library=read_id(folder))
    with (
        closing(Database(sqlite_engine(folder / DATABASE, opened.data_key, creates=False))) as source,
        source.reading() as here,
        opened.library.database.writing() as there,
    ):
        mark, end = SettingRow.of(there, name), end_of_audit(here)
        if mark == str(end):
            return 0, True
        refuse_closed(there)
        covered = _covered(here, mark)
        patients = _bring_patients(here, there)
        count, is_covered = 0, True
        for table in Base.metadata.sorted_tables:
            if table.name not in OWN_TO_EACH:
                added, are_same = _bring_table(here, there, table, patients, station.id)
                count += added if table.name == "sessions" else 0
                is_covered &= are_same or table.name in DERIVED
        _bring_corrections(here, there, patients)
        _bring_audit(here, there, opened, covered)
        SettingRow.put(there, name, str(end))
        return count, is_covered


def _covered(here: OrmSession, mark: object) -> int:
    """Find up to which entry of its own audit a library is on the server; 0 where it went another way since."""
    try:
        end = Checkpoint.parsed(str(mark)) if mark is not None else BEGINNING
    except LibraryError:  # of an earlier version, which kept the time
        return 0
    row = here.get(AuditRow, end.number)
    return end.number if row is not None and hmac.compare_digest(row.hash, end.hash) else 0


def _bring_patients(here: OrmSession, there: OrmSession) -> dict[UUID, UUID]:
    """Whom each patient is at the clinic."""
    known: dict[UUID, UUID] = {}
    rows = {row.id: row for row in here.scalars(select(PatientRow))}
    for row in sorted(rows.values(), key=lambda row: row.merged_into_id is not None):  # doubles last
        if row.merged_into_id is not None:
            known[row.id] = known[row.merged_into_id]
            continue
        found = there.scalars(select(PatientRow).where(PatientRow.code_folded == row.code_folded)).first()
        if found is not None and found.merged_into_id is not None:
            found = there.get_one(PatientRow, found.merged_into_id)
        if found is None:
            found = PatientRow(**{column.key: getattr(row, column.key) for column in inspect(PatientRow).column_attrs})
            there.add(found)
        elif row.deleted_at is None:
            found.deleted_at = None  # who is measured is a patient
            found.goals = goals_text(brought_together(reported_patient(found).goals, reported_patient(row).goals))
        known[row.id] = found.id
    there.flush()
    return known


def _bring_table(
    here: OrmSession, there: OrmSession, table: Table, patients: dict[UUID, UUID], station: str
) -> tuple[int, bool]:
    """Bring the rows that are not there; how many, and whether those that are there are the same."""
    rows = [dict(row) for row in here.execute(select(table)).mappings()]
    for row in rows:
        if "patient_id" in row:
            row["patient_id"] = patients[row["patient_id"]]
        if table.name == RecordingRow.__tablename__:
            row["station"] = station
    key = table.primary_key.columns.keys()
    known = {tuple(row[name] for name in key): row for row in there.execute(select(table)).mappings()} if rows else {}
    seen = [(row, known.get(tuple(row[name] for name in key))) for row in rows]
    fresh = [row for row, other in seen if other is None]
    if fresh:
        there.execute(insert(table), fresh)
    columns = [name for name in (column.name for column in table.columns) if name not in SERVERS]
    are_same = all(other is None or all(row[name] == other[name] for name in columns) for row, other in seen)
    return len(fresh), are_same


def _bring_corrections(here: OrmSession, there: OrmSession, patients: dict[UUID, UUID]) -> None:
    """Their numbers go on from those at the clinic, in the order in which they were made."""
    table = Base.metadata.tables[CorrectionRow.__tablename__]
    number = there.scalar(select(func.max(CorrectionRow.number))) or 0
    known = set(there.scalars(select(CorrectionRow.id)))
    for row in here.execute(select(table).order_by(CorrectionRow.number)).mappings():
        if row["id"] in known:
            continue
        number += 1
        there.execute(insert(table).values(dict(row) | {"number": number, "patient_id": patients[row["patient_id"]]}))


def _bring_audit(here: OrmSession, there: OrmSession, opened: OpenedLibrary, covered: int) -> None:
    """Who did what meanwhile goes on the clinic's chain, each entry with its own time among its details."""
    key = derived_keys(there, opened.data_key).audit
    for entry in here.scalars(select(AuditRow).where(AuditRow.number > covered).order_by(AuditRow.number)):
        details: dict[str, Any] = json.loads(entry.details) | {"was_away_at": entry.at}
        append(there, key, now_utc(), entry.operator, Action(entry.action), entry.subject, details)


def _bring_journals(opened: OpenedLibrary, folder: Path) -> None:
    opened.recordings.mkdir(mode=0o700, exist_ok=True)
    for path in sorted((folder / RECORDINGS).glob(f"*{SUFFIX}")):
        path.replace(opened.recordings / path.name)
    sync_folder(opened.recordings)

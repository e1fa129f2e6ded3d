"""A clinic's library: patients, sessions, recordings, results, and who did what with them.

This is what the application calls. Plain values go in and out (`app.storage.stored`), trouble is a `LibraryError` that
can be shown as it is. Every call may come from any thread and may wait for the disk, so the screen's thread makes none.
"""

import datetime
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

from sqlalchemy import select

from app.storage.audit import Audit, about, append
from app.storage.clinic.server_state import refuse_closed
from app.storage.clinic.station import Station, station_of
from app.storage.corrections import Corrections
from app.storage.data_key import KeyMaterial
from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.models import OperatorRow, folded
from app.storage.database.schema import bring_up_to_date
from app.storage.database.values import operator_of
from app.storage.database.write_ahead_log import is_end_lost
from app.storage.derived_keys import derived_keys
from app.storage.journal_headers import write_headers
from app.storage.layout import DATABASE, MOVING
from app.storage.operators import Operators, OperatorSettings, add_operator
from app.storage.patients import Patients
from app.storage.recordings import Recordings
from app.storage.results import Results
from app.storage.root import LibraryRoot, root_of
from app.storage.sessions import Sessions
from app.storage.shared_edits import SharedEdits
from app.storage.stored import Action, LibraryError, NotAllowedError, Operator, Role
from app.storage.unit_of_work import UnitOfWork
from app.storage.videos.rows import Clips

DEMONSTRATOR = Operator("demo", "Demonstration", Role.ADMINISTRATOR)


def now_utc() -> datetime.datetime:
    return datetime.datetime.now(datetime.UTC)


class Library:
    """An open library. Nothing but `log_in` works until somebody is logged in.

    No `data_key`: it is a demonstration, which is not encrypted and takes simulated recordings only. `is_end_lost`: it
    was not closed well and what was saved last is damaged, so the latest session should be looked through. `station`:
    which one of a clinic's stations opens it; None where the library is in a folder of this computer.
    """

    def __init__(
        self,
        database: Database,
        data_key: KeyMaterial | None,
        now: Callable[[], datetime.datetime] = now_utc,
        is_end_lost: bool = False,
        station: Station | None = None,
    ) -> None:
        from app.storage.courses import Courses  # SciPy comes with it, which a log in does not wait for

        self.is_end_lost, self.station = is_end_lost, station
        self.root: LibraryRoot | None = None  # of a library in a folder
        self.is_to_be_moved = False
        bring_up_to_date(database)
        self.database = database
        with database.reading() as session:
            keys = derived_keys(session, data_key)
        self.pseudonyms_key = keys.pseudonyms
        own = station.id if station is not None else ""
        self.now = now if station is None else database.clock(now)  # stations' own may differ
        self._unit = UnitOfWork(database, keys.audit, self.now, is_demonstration=data_key is None, station=own)
        self.patients = Patients(self._unit)
        self.sessions = Sessions(self._unit)
        self.recordings = Recordings(self._unit)
        self.clips = Clips(self._unit)
        self.results = Results(self._unit)
        self.courses = Courses(self._unit)
        self.corrections = Corrections(self._unit)
        self.edits = SharedEdits(self._unit)
        self.operators = Operators(self._unit)
        self.settings = OperatorSettings(self._unit)
        self.audit = Audit(self._unit)

    @classmethod
    def create(
        cls,
        folder: Path,
        data_key: KeyMaterial | None,
        operator: Operator,
        now: Callable[[], datetime.datetime] = now_utc,
    ) -> Self:
        """Make an empty library, or finish making it, with `operator` as administrator; raises LibraryError."""
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        except OSError as error:
            raise LibraryError("This folder is not writable", "Choose another folder") from error
        library = cls(_database(folder, data_key, creates=True), data_key, now)
        try:
            library._take_root(folder)
            library.begin(operator)
        except BaseException:
            library.close()
            raise
        return library

    @classmethod
    def open(
        cls,
        folder: Path,
        data_key: KeyMaterial | None,
        now: Callable[[], datetime.datetime] = now_utc,
        *,
        is_to_be_moved: bool = False,
    ) -> Self:
        """Open the library, a demonstration without `data_key`; `is_to_be_moved`: also one on its way.
        Raises LibraryError where there is none, the key is wrong, it is damaged or of a later version.
        """
        try:
            station = station_of(folder)
            if station is None and not (folder / DATABASE).exists():
                raise LibraryError(
                    "This folder contains no library", "Choose another folder, or restore the library from a backup"
                )
            if station is None and not is_to_be_moved and (folder / MOVING).exists():
                raise LibraryError(
                    "This library is being moved to the clinic's server",
                    "Continue or cancel the move: gaitwright clinic move --help",
                )
            is_lost = station is None and is_end_lost(folder / f"{DATABASE}-wal")
        except OSError as error:
            raise LibraryError("The library files cannot be read", "Check the permissions of its folder") from error
        database = _database(folder, data_key, creates=False) if station is None else station.database_kept()
        try:
            if station is not None and not is_to_be_moved:
                with database.reading() as session:
                    refuse_closed(session)
            library = cls(database, data_key, now, is_lost, station)
            library.is_to_be_moved = is_to_be_moved
            library._take_root(folder)
            return library
        except BaseException:
            database.close()
            raise

    @classmethod
    @contextmanager
    def demonstration(cls) -> Iterator[Self]:
        """An unencrypted library of simulated recordings in a folder of its own, gone when it is closed."""
        with (
            tempfile.TemporaryDirectory(prefix="gaitwright-demo-") as folder,
            cls.create(Path(folder), None, DEMONSTRATOR) as library,
        ):
            yield library

    @property
    def operator(self) -> Operator | None:
        return self._unit.operator

    @property
    def is_demonstration(self) -> bool:
        return self._unit.is_demonstration

    def begin(self, operator: Operator) -> Operator:
        """Log in the first operator as administrator; raises NotAllowedError where there are operators."""
        first = replace(operator, code=folded(operator.code), role=Role.ADMINISTRATOR, is_active=True)
        with self.database.writing() as session:
            if session.scalars(select(OperatorRow.code).limit(1)).first() is not None:
                raise NotAllowedError("This folder already has a library", "Log in to it, or choose another folder")
            self._unit.operator = first
            add_operator(session, self._unit, first)
        return self.log_in(first.code)

    def log_in(self, code: str, failed_before: int = 0) -> Operator:
        """Log in the operator of the opened slot; `failed_before`: wrong passphrases; raises NotAllowedError."""
        with self.database.writing() as session:
            if self.station is not None and not self.is_to_be_moved:
                refuse_closed(session)
            row = session.get(OperatorRow, folded(code))
            if row is None or not row.is_active:
                raise NotAllowedError("This user is not active in this library", "Ask an administrator of this library")
            operator = operator_of(row)
            details: dict[str, object] = {"failed_before": failed_before}
            if self.is_end_lost:
                details["is_end_lost"] = True
            subject = about("operator", row.code)
            append(session, self._unit.audit_key, self._unit.now(), row.code, Action.LOGIN, subject, details)
        self._unit.note_end(session)
        self._unit.operator = operator
        return operator

    def log_out(self) -> None:
        self._unit.operator = None

    def faults(self) -> tuple[str, ...]:
        """Read every page of the database and check it; what is wrong, for a report. Nothing: it is whole."""
        return self.database.faults()

    def take_back(self) -> None:
        """Go on with the copy of the library that is now in the folder; raises OSError."""
        if self.root is not None:
            self.root.take()
            self.database.close()

    def _take_root(self, folder: Path) -> None:
        """Identify the folder again and from now on write nowhere else; raises LibraryError."""
        try:
            self.root = root_of(folder, self.database)
        except OSError as error:
            raise LibraryError("The library files cannot be read", "Check the permissions of its folder") from error
        self.database.guard = self.root.refuse_gone

    def suspend(self) -> None:
        """Close the file, and the key with it; the next call opens both again, for the operator who is logged in."""
        self.database.close()

    def write_journal_headers(self, folder: Path) -> None:
        """Finish what a change of the data key left to be done; raises OSError."""
        write_headers(self.database, folder)

    def close(self) -> None:
        self.log_out()
        self.database.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _database(folder: Path, data_key: KeyMaterial | None, creates: bool) -> Database:
    return Database(sqlite_engine(folder / DATABASE, data_key, creates=creates))

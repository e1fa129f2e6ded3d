"""One session of a batch: a task that can be sent anywhere, and the one function that does it.

The function depends on nothing but its task and the session that it names: whoever does it, wherever, and however
often, the same bytes come of it.
"""

import errno
import hashlib
import json
import os
import socket
import stat
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Protocol

from app.cohort.batch.analysed_folder import AnalysisChoices, write_analysed
from app.cohort.batch.done import BatchFolder, DoneRecord, read_mark
from app.cohort.batch.rows import ReportedOf, reported_of_folder, rows_of
from app.cohort.batch.software import software
from app.exports.result_folder import SUMMARY, check_place, written_beside
from app.importing.untrusted_files import nobody_waits, read_foreign_session
from app.system.logs import pseudonymised
from app.system.progress import nobody
from core.session import Session
from core.verdicts.sigmas import PUBLISHED, ErrorFigures, using
from devices.files.limited_reader import MOST_FILE_BYTES
from devices.files.refusal import FileRefusedError, one_line

PIECE_BYTES = 1 << 20
FULL = frozenset((errno.ENOSPC, errno.EDQUOT, errno.EROFS))  # what ends every further session, too


@dataclass(frozen=True, slots=True)
class GivenSession:
    """A session that the asking process has read, of which `content` states what is in it."""

    session: Session
    content: str
    reported: ReportedOf


@dataclass(frozen=True, slots=True)
class BatchTask:
    """What it takes to do one session.

    `known`: what was made of it before, if anything; `figures`: what differences are judged by.
    """

    name: str
    source: Path | GivenSession
    batch: BatchFolder
    choices: AnalysisChoices
    software: str
    known: tuple[str, str] | None = None
    figures: ErrorFigures = PUBLISHED


@dataclass(frozen=True, slots=True)
class SessionOutcome:
    """What came of a session: its record, or why there is none. `is_as_before`: nothing had to be done."""

    name: str
    record: DoneRecord | None = None
    is_as_before: bool = False
    failure: str = ""


class _Hash(Protocol):
    def update(self, data: bytes, /) -> None: ...


def analyse_task(task: BatchTask) -> SessionOutcome:
    """Analyse a session into its results folder, unless these are up to date; raises OSError."""
    try:
        with using(task.figures):  # which of a library only the process has that opened it
            return _analysed(task)
    except FileRefusedError as refusal:
        return SessionOutcome(task.name, failure=str(refusal))
    except OSError as problem:
        if problem.errno in FULL:
            raise
        why = one_line(problem.strerror or type(problem).__name__)
        return SessionOutcome(
            task.name, failure=f"This cannot be read or written ({why}). Check the disk and its permissions."
        )
    except MemoryError:
        return SessionOutcome(
            task.name, failure="This takes more memory than there is. Use fewer workers, or more memory."
        )
    except Exception as fault:  # one session's fault is not the others'
        where = "; ".join(line.strip() for line in list(pseudonymised(fault))[:3])
        failure = f"This ended by a fault of the program ({where}). Report it with this line."
        return SessionOutcome(task.name, failure=failure)


def _analysed(task: BatchTask) -> SessionOutcome:
    _check_worker(task)
    source, results = task.source, task.batch.results(task.name)
    content = source.content if isinstance(source, GivenSession) else content_of(source)
    making = making_of(task.choices, task.software, task.figures)
    key = key_of(content, making)
    if task.known == (key, summary_digest(results)):
        return SessionOutcome(task.name, is_as_before=True)
    if isinstance(source, GivenSession):
        check_place(results, task.batch.work)  # the session is no folder that it could lie in
        session, reported = source.session, source.reported
    else:
        check_place(results, source)
        session = read_foreign_session(source, nobody_waits)
        reported = reported_of_folder(session, task.batch.mark)
    with written_beside(results, within=task.batch.work) as folder:
        analysis = write_analysed(session, folder, task.choices, nobody)
        digest = summary_digest(folder)
    rows = rows_of(task.name, session, analysis, reported)
    return SessionOutcome(task.name, DoneRecord(key, making, digest, rows))


def _check_worker(task: BatchTask) -> None:
    """Raise FileRefusedError where this process lacks the caller's software or folders."""
    here = one_line(socket.gethostname())
    if software() != task.software:
        what = "the worker here has another version of Gaitwright"
        raise FileRefusedError(here, what, "Install the same version on all computers")
    remedy = "FOLDER and OUT have to be on a disk that all workers see under the same path"
    if read_mark(task.batch.out) != task.batch.mark:
        raise FileRefusedError(here, "the worker here cannot access OUT", remedy)
    if isinstance(task.source, Path) and not task.source.is_dir():
        raise FileRefusedError(here, "the worker here cannot access the session folder", remedy)


def making_of(choices: AnalysisChoices, with_software: str, figures: ErrorFigures = PUBLISHED) -> str:
    """What results are made with, in one word: the software and every choice that changes them."""
    reported = {one.name: getattr(choices, one.name) for one in fields(choices)}
    if figures.study is not None:
        reported["figures"] = repr(figures)
    return hashlib.sha256(json.dumps([reported, with_software], sort_keys=True).encode()).hexdigest()


def key_of(content: str, making: str) -> str:
    """What results depend on, in one word."""
    return hashlib.sha256(f"{content} {making}".encode()).hexdigest()


def summary_digest(results: Path) -> str:
    """SHA-256 of the summary in a folder of results; empty where there is none."""
    try:
        return hashlib.sha256((results / SUMMARY).read_bytes()).hexdigest()
    except OSError:
        return ""


def content_of(folder: Path) -> str:
    """SHA-256 over all files under a session folder: their paths, and what is in them."""
    digest = hashlib.sha256()
    for path in _files(folder):
        name = path.relative_to(folder).as_posix().encode("utf-8", "surrogateescape")
        digest.update(b"file\0" + name + b"\0")
        _add(path, digest)
    return digest.hexdigest()


def _files(folder: Path) -> Iterator[Path]:
    for at, folders, files in os.walk(folder):
        folders.sort()
        for name in sorted([*files, *(one for one in folders if (Path(at) / one).is_symlink())]):
            yield Path(at) / name


def _add(path: Path, digest: _Hash) -> None:
    """Hash a file; an unreadable one is hashed as such, since only reading the session can refuse it."""
    try:
        if path.is_symlink():
            digest.update(b"link\0" + os.fsencode(path.readlink()) + b"\0")
        found = path.stat()
        if not stat.S_ISREG(found.st_mode) or found.st_size > MOST_FILE_BYTES:  # nothing that is read
            digest.update(f"{found.st_mode} {found.st_size} {found.st_mtime_ns}\0".encode())
            return
        digest.update(f"{found.st_size}\0".encode())
        with path.open("rb") as file:
            while piece := file.read(PIECE_BYTES):
                digest.update(piece)
    except OSError as problem:
        digest.update(f"{problem.errno}\0".encode())

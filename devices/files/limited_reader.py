"""Reading of foreign files without trust: in a process of its own, with limits, that may end at any time.

One process reads all files of this program, one after the other. It is renewed after `FILES_EACH` files and whenever it
ended: a file that takes too much memory or time, or that ends its reader, is refused like any other, in one line.
"""

import contextlib
import logging
import math
import signal
import sys
import threading
import weakref
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from time import monotonic
from typing import Any, TypeVar

from devices.files import child
from devices.files.answers import (
    Array,
    BrokenAnswerError,
    Details,
    details_of,
    document_from,
    receive,
    send,
    value_from,
)
from devices.files.other_formats import offered_formats
from devices.files.references.answers import reference_from
from devices.files.references.trial import ReferenceFile
from devices.files.refusal import FileRefusedError
from devices.files.session_toml import FILE_NAME
from devices.files.site_files import ReadSite, SiteFile
from devices.files.table_choices import NOTHING_STATED, StatedChoices, TableChoices, TablePreview
from devices.files.trial import PROGRAMS, Gathered, ImportedTrial
from devices.files.video_file import MOST_FRAMES, MOST_VIDEO_BYTES, PIECE_S, VideoPiece, piece_from
from devices.other_packages import Offer
from devices.own_process import Process, end_process, start_process

FILES_EACH = 500
MEMORY_BYTES = 4 * 1024**3  # half a gigabyte of text takes 1.9, most of it only reserved, the libraries 0.4 of them
MOST_FILE_BYTES = 1_000_000_000  # some twenty hours of one sensor at 100 Hz as text
MOST_TOML_BYTES = 4_000_000  # a session of ours takes some kilobytes
DEADLINE_S = 60.0  # for any file, with the start of the process
BYTES_A_SECOND = 5_000_000.0  # beyond that; a busy old machine reads four times as fast
IS_LINUX: bool = sys.platform == "linux"
WAIT_S = 0.05  # between two looks at whether somebody still waits

_log = logging.getLogger(__name__)
T = TypeVar("T")

Columns = list[list[Any]]
Waiting = Callable[[], object]
"""Called while a file is being read. What it raises ends the reading."""


TIME, CRASH = "time", "crash"
ENDINGS = {  # refusals that lack only their place
    child.MEMORY: FileRefusedError(
        "",
        "reading the data takes more memory than a recording should need",
        "Export the recording again, or in shorter parts",
    ),
    TIME: FileRefusedError(
        "",
        "reading the data takes longer than a recording should need",
        "Export the recording again, or in shorter parts",
    ),
    CRASH: FileRefusedError(
        "", "reading stopped early; the file may be damaged", "Copy the file again from where it was recorded"
    ),
    child.UNFORESEEN: FileRefusedError(
        "",
        "reading stopped early; the reason is in the log",
        "Copy the file again from where it was recorded",
    ),
}


UNANSWERED = {
    child.MEMORY: FileRefusedError(
        "SQL", "this query was stopped because it needs more memory than allowed", "Query less data at a time"
    ),
    TIME: FileRefusedError("SQL", "this query exceeds the time limit", "Query less data at a time"),
    CRASH: FileRefusedError("SQL", "this query stopped early; the log has the reason", "Query less data at a time"),
}


class ReadingEndedError(FileRefusedError):
    """A file that could not be read to its end within the limits; `cause` is memory, time, crash or unforeseen."""

    def __init__(self, where: str, cause: str) -> None:
        self.cause = cause
        super().__init__(where, ENDINGS[cause].what, ENDINGS[cause].remedy)


class LimitedReader:
    """The process that reads; started when first asked, by whichever thread. After `close` it may be asked again.

    It ends with this program, and when a reading is given up.
    """

    def __init__(self, memory_bytes: int = MEMORY_BYTES) -> None:
        self._memory_bytes = memory_bytes
        self._lock = threading.Lock()
        self.process: Process | None = None
        """That reads; none before the first reading, and none once it is closed."""
        self._ending: Callable[[], object] | None = None
        self._files_left = 0

    def ask(
        self,
        task: Details,
        files: Sequence[Path],
        where: str,
        made_of: Callable[[Any, list[Array]], T],
        waiting: Waiting,
        most_bytes: int = MOST_FILE_BYTES,
        most_s: float = math.inf,
    ) -> T:
        """Make an answer of what the process reports and of its arrays; raises FileRefusedError."""
        sizes = {path: path.stat().st_size for path in files if path.is_file()}
        for path, size in sizes.items():
            if size > most_bytes:
                raise FileRefusedError(
                    where if len(files) == 1 else str(path),
                    "this file has {size} MB, more than a recording should need",
                    "Choose a file of up to {most} MB",
                    size=round(size / 1e6),
                    most=round(most_bytes / 1e6),
                )
        deadline_s = min(most_s, DEADLINE_S + sum(sizes.values()) / BYTES_A_SECOND)
        asked = {**task, "where": where, "cwd": str(Path.cwd()), "processor_s": 2.0 * deadline_s}
        while not self._lock.acquire(timeout=WAIT_S):
            waiting()
        try:
            process = self.process = self._ready()
            self._files_left -= len(files)
            answer, arrays = _exchange(process, asked, monotonic() + deadline_s, waiting)
            return made_of(_details(answer, where), arrays)
        except BrokenAnswerError as problem:
            _log.warning("the reading process gave a broken answer")
            self._files_left = 0
            raise ReadingEndedError(where, CRASH) from problem
        except FileRefusedError as refusal:
            if isinstance(refusal, ReadingEndedError):
                self._files_left = 0  # what took the memory may still hold it
            raise
        except BaseException:
            self._files_left = 0  # nobody waits for its answer
            raise
        finally:
            if task.get("with_others") and not IS_LINUX:
                self._files_left = 0  # there no copy of the process loaded them, but it itself
            if self._files_left <= 0:
                self._end()
            self._lock.release()

    def close(self) -> None:
        """End the process, if there is one; who waits for it gets a refusal."""
        if (process := self.process) is not None:
            process.kill()
        with self._lock:
            self._end()

    def _ready(self) -> "Process":
        if self.process is not None and self.process.poll() is None:
            return self.process
        self._end()
        self._files_left = FILES_EACH
        process = start_process(child.__name__, child.WORD, str(self._memory_bytes))
        self._ending = weakref.finalize(self, end_process, process)  # also when this program ends
        return process

    def _end(self) -> None:
        self.process = None
        if self._ending is not None:
            self._ending()


def _exchange(process: Process, asked: Details, deadline_s: float, waiting: Waiting) -> tuple[Details, list[Array]]:
    """Ask, and wait for the answer until the deadline; half an answer without its end is waited for no longer."""
    answers: list[tuple[Details, list[Array]]] = []
    problems: list[Exception] = []

    def exchange() -> None:
        try:
            assert process.stdin is not None  # it was started with both
            assert process.stdout is not None
            send(process.stdin, asked)
            answers.append(receive(process.stdout))
        except (EOFError, OSError, BrokenAnswerError, MemoryError) as problem:
            problems.append(problem)

    is_late = False
    thread = threading.Thread(target=exchange, name="waiting for a file", daemon=True)
    thread.start()
    try:
        while _is_running(thread):
            waiting()
            if monotonic() > deadline_s:
                is_late = True
                process.kill()
    except BaseException:
        process.kill()
        thread.join()
        raise
    if answers:
        return answers[0]
    process.kill()
    process.wait()
    is_late = is_late or -process.returncode == getattr(signal, "SIGXCPU", 0)
    _log.warning("the reading process ended with %s (%s)", process.returncode, type(problems[0]).__name__)
    raise ReadingEndedError(asked["where"], TIME if is_late else CRASH) from problems[0]


def _is_running(thread: threading.Thread) -> bool:
    """Return whether the thread has not ended within a short while."""
    thread.join(WAIT_S)
    return thread.is_alive()


def _details(answer: Details, where: str) -> Any:
    match answer:
        case {"what": child.READ, "details": details}:
            return details
        case {"what": child.REFUSED, "details": dict(details)}:
            raise value_from(FileRefusedError, details)
        case {"what": child.MEMORY}:
            raise ReadingEndedError(where, child.MEMORY)
        case {"what": child.UNFORESEEN, "details": str(details)}:
            _log.error("a file's reader raised %s", details[:200])
            raise ReadingEndedError(where, child.UNFORESEEN)
    raise BrokenAnswerError("neither read nor refused")


class LimitedReading:
    """One reading of files of others, that `waiting` can end: a `session_folder.SessionReader`, and one of trials."""

    def __init__(self, reader: LimitedReader, waiting: Waiting) -> None:
        self._reader = reader
        self.waiting = waiting

    def read_toml(self, path: Path) -> Mapping[str, object]:
        task = {"task": child.TOML, "path": str(path)}
        return self._reader.ask(task, [path], FILE_NAME, _document, self.waiting, MOST_TOML_BYTES)

    def read_site(self, file: SiteFile) -> ReadSite:
        task = {
            "task": child.SITE,
            "path": str(file.path),
            "place": file.place,
            "sensor": file.sensor,
            "is_rate_derived": file.is_rate_derived,
        }
        return self._reader.ask(task, [file.path], file.where, partial(value_from, ReadSite), self.waiting)

    def read_trial(
        self,
        format_name: str,
        files: Sequence[Path],
        rate_hz: float | None,
        choices: StatedChoices = NOTHING_STATED,
        *,
        splits: bool = False,
    ) -> ImportedTrial:
        """As `formats.read_trial` does."""
        task = {
            "task": child.TRIAL,
            "format": format_name,
            "files": [str(path) for path in files],
            "rate_hz": rate_hz,
            "splits": splits,
            "choices": details_of(choices, []),
            "with_others": format_name not in PROGRAMS,
        }
        where = ", ".join(path.name for path in files)
        return self._reader.ask(task, files, where, partial(value_from, ImportedTrial), self.waiting)

    def read_reference(self, path: Path) -> ReferenceFile:
        """As `references.reading.read_reference` does."""
        task = {"task": child.REFERENCE, "path": str(path)}
        return self._reader.ask(task, [path], path.name, reference_from, self.waiting)

    def read_video(self, path: Path, from_s: float, most_frames: int = MOST_FRAMES) -> VideoPiece:
        """The frames of a video at `from_s` seconds and after it, at most `most_frames`; raises FileRefusedError."""
        task = {"task": child.VIDEO, "path": str(path), "from_s": float(from_s), "most_frames": most_frames}
        return self._reader.ask(task, [path], path.name, piece_from, self.waiting, MOST_VIDEO_BYTES, PIECE_S)

    def ask_parquet(self, path: Path, sql: str, is_typed: bool) -> tuple[tuple[str, ...], list[Columns]]:
        """Answer as `parquet_questions.answer`: names, and columns per batch; raises FileRefusedError."""
        task = {"task": child.QUESTION, "path": str(path), "sql": sql, "is_typed": is_typed}
        try:
            return self._reader.ask(task, [path], path.name, _found_rows, self.waiting)
        except ReadingEndedError as ended:
            raise UNANSWERED.get(ended.cause, UNANSWERED[CRASH]) from ended

    def preview(self, path: Path, stated: TableChoices) -> TablePreview:
        """As `table_preview.preview_of` does."""
        task = {"task": child.PREVIEW, "path": str(path), "choices": details_of(stated, [])}
        return self._reader.ask(task, [path], path.name, partial(value_from, TablePreview), self.waiting)

    def gather(
        self, paths: Sequence[Path], choices: StatedChoices = NOTHING_STATED, *, are_one: bool = False
    ) -> Gathered:
        """As `gathering.gather` does; a file of none of our formats is shown to those of others.

        These see it in a reading of its own: what ours read stays where theirs ends the process.
        """
        found = self._gather(paths, choices, are_one=are_one, with_others=False)
        if found.refused and offered_formats():
            with contextlib.suppress(ReadingEndedError):
                return self._gather(paths, choices, are_one=are_one, with_others=True)
        return found

    def why_unusable(self, offer: Offer) -> str:
        """Why a format of another package cannot be used; empty where it can."""
        task = {"task": child.IMPORTER, "name": offer.name, "package": offer.package, "with_others": True}
        try:
            return self._reader.ask(task, (), offer.name, partial(value_from, str), self.waiting)
        except ReadingEndedError as ended:
            return f"it ended the process that loaded it ({ended.cause})"

    def _gather(self, paths: Sequence[Path], choices: StatedChoices, *, are_one: bool, with_others: bool) -> Gathered:
        task = {
            "task": child.GATHER,
            "files": [str(path) for path in paths],
            "choices": details_of(choices, []),
            "are_one": are_one,
            "with_others": with_others,
        }
        return self._reader.ask(task, (), paths[0].name, partial(value_from, Gathered), self.waiting)


def _found_rows(details: Any, arrays: Sequence[Array]) -> tuple[tuple[str, ...], list[Columns]]:
    import pyarrow as pa  # home starts without it

    try:
        columns = tuple(map(str, details["columns"]))
        with pa.ipc.open_stream(pa.py_buffer(arrays[0])) as stream:
            batches = []
            for batch in stream:
                batch.validate(full=True)
                batches.append([column.to_pylist() for column in batch.columns])
    except (pa.ArrowException, LookupError, TypeError, ValueError) as problem:
        raise BrokenAnswerError("no rows") from problem
    return columns, batches


def _document(details: Any, _arrays: Sequence[Array]) -> dict[str, object]:
    document = document_from(details)
    if not isinstance(document, dict):
        raise BrokenAnswerError("no table")
    return document

"""How the limited process, once it is limited, reads the files of a task and answers."""

import ctypes
import mimetypes
import os
import signal
import sys
from collections.abc import Mapping
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import BinaryIO

import pyarrow as pa
import pyarrow.csv as pcsv

from devices.files.answers import Array, Details, details_of, details_of_document, receive, send, value_from
from devices.files.bids_tables import folders_of_scans, tables_beside
from devices.files.child import (
    GATHER,
    IMPORTER,
    MEMORY,
    PREVIEW,
    QUESTION,
    READ,
    REFERENCE,
    REFUSED,
    SITE,
    TOML,
    TRIAL,
    UNFORESEEN,
    VIDEO,
)
from devices.files.limits import forbid_reading, limit_processor_time
from devices.files.other_formats import offered_formats, usable_format
from devices.files.references.reading import read_reference
from devices.files.refusal import FileRefusedError
from devices.files.session_folder import IN_THIS_PROCESS
from devices.files.site_files import read_site
from devices.files.system_calls import refuse_system_calls
from devices.files.table_choices import TableChoices
from devices.files.trial import BESIDE_INERTIAL, registers_beside
from devices.files.video_file import VideoPiece, details_of_piece
from devices.other_packages import BrokenOfferError

REFERENCE_S, REFERENCE_BYTES_A_SECOND = 10.0, 1_000_000.0  # of processor time; ten times what a text takes
IS_LINUX: bool = sys.platform == "linux"
PR_SET_PDEATHSIG = 1


def serve(asking: BinaryIO, answering: BinaryIO) -> None:
    """Read what is asked for until nobody asks any more."""
    while True:
        try:
            asked, _ = receive(asking)
        except EOFError:
            return
        os.chdir(asked["cwd"])
        if IS_LINUX:
            _in_a_copy(asked, asking, answering)
        else:
            limit_processor_time(asked["processor_s"])
            arrays: list[Array] = []
            send(answering, _answer(asked, arrays), arrays)


def _in_a_copy(asked: Details, asking: BinaryIO, answering: BinaryIO) -> None:
    """Answer in a copy of this process that is confined to the task's files; how it ends, this one ends too."""
    _load_for(asked["task"])
    files, listed = _files_of(asked)
    parent = os.getpid()
    if (copy := os.fork()) == 0:
        # without it the copy would go on when its parent is ended for being late
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        if os.getppid() != parent:
            os._exit(1)
        asking.close()
        limit_processor_time(asked["processor_s"])
        if asked["task"] == REFERENCE:
            _limit_reference(files[0])
        forbid_reading(files, listed)
        refuse_system_calls()
        arrays: list[Array] = []
        send(answering, _answer(asked, arrays), arrays)
        os._exit(0)
    _, status = os.waitpid(copy, 0)
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        if number != signal.SIGKILL:
            signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)
    if status != 0:
        os._exit(1)


def _load_for(task: str) -> None:
    """Import what a task needs before the copy is made, which would import it each time."""
    # imports more when it is first used; no threads, of which a copy has none
    pcsv.read_csv(pa.py_buffer(b"a\n1\n"), pcsv.ReadOptions(use_threads=False)).column(0).to_numpy()
    if task == QUESTION:
        import_module("devices.files.parquet_questions")
    if task in (TRIAL, GATHER, REFERENCE, PREVIEW):
        mimetypes.init()  # reads the system's tables, which a spreadsheet's reader asks for
        import_module("devices.files.formats")
    if task == PREVIEW:
        import_module("devices.files.table_preview")
    if task == VIDEO:
        with suppress(ImportError):
            import_module("devices.files.video_frames")


def _files_of(asked: Details) -> tuple[list[Path], list[Path]]:
    """The files that a task may open, and the folders whose names it may list."""
    if asked["task"] == IMPORTER:
        return [], []
    if asked["task"] not in (TRIAL, GATHER):
        return [Path(asked["path"])], []
    named = list(map(Path, asked["files"]))
    beside = [
        other
        for path in named
        for other in (path.with_name(BESIDE_INERTIAL), *registers_beside(path), *tables_beside(path))
    ]
    return [*named, *beside], [folder for path in named for folder in folders_of_scans(path)]


def _answer(asked: Details, arrays: list[Array]) -> Details:
    try:
        return {"what": READ, "details": _read(asked, arrays)}
    except FileRefusedError as refusal:
        return {"what": REFUSED, "details": details_of(refusal, arrays)}
    except OSError as problem:
        why = problem.strerror or type(problem).__name__
        where = str(problem.filename or asked["where"])
        unread = FileRefusedError(where, "the file or folder cannot be read ({why})", "Check the permissions", why=why)
        return {"what": REFUSED, "details": details_of(unread, arrays)}
    except MemoryError:
        arrays.clear()
        return {"what": MEMORY}
    except Exception as error:  # the edge of the process; what the file contains is not in the words
        arrays.clear()
        return {"what": UNFORESEEN, "details": f"{type(error).__name__}, {_last_line(error)}"}


def _read(asked: Details, arrays: list[Array]) -> object:
    task = asked["task"]
    if task == TOML:
        return details_of_document(IN_THIS_PROCESS.read_toml(Path(asked["path"])))
    if task == SITE:
        site = Path(asked["path"]), asked["where"], asked["place"], asked["sensor"], asked["is_rate_derived"]
        return details_of(read_site(*site), arrays)
    if task == VIDEO:
        return video_piece(asked, arrays)
    if task == QUESTION:
        from devices.files.parquet_questions import answer  # with the half of Arrow that only questions need

        return answer(Path(asked["path"]), asked["sql"], asked["is_typed"], arrays)
    if task == REFERENCE:
        path = Path(asked["path"])
        if not IS_LINUX:
            _limit_reference(path)
        return details_of(read_reference(path), arrays)
    if task == IMPORTER:
        return _why_unusable(asked["name"], asked["package"])
    if task == PREVIEW:
        from devices.files.table_preview import preview_of  # as below

        return details_of(preview_of(Path(asked["path"]), value_from(TableChoices, asked["choices"])), arrays)
    files = list(map(Path, asked["files"]))
    choices = value_from(Mapping[str, TableChoices], asked["choices"])
    if task == GATHER:
        from devices.files.gathering import gather  # as below

        return details_of(gather(files, choices, are_one=asked["are_one"], with_others=asked["with_others"]), arrays)
    from devices.files.formats import read_trial  # here: SciPy takes longer to import than most files

    return details_of(read_trial(asked["format"], files, asked["rate_hz"], choices, splits=asked["splits"]), arrays)


def video_piece(asked: Details, arrays: list[Array]) -> Details:
    """Read a piece of a video; raises FileRefusedError, also where the library is missing."""
    try:
        frames = import_module("devices.files.video_frames")
    except ImportError as problem:
        raise FileRefusedError(
            asked["where"], "videos cannot be read: a software library is missing", "Install gaitwright[video]"
        ) from problem
    piece: VideoPiece = frames.read_piece(Path(asked["path"]), asked["where"], asked["from_s"], asked["most_frames"])
    return details_of_piece(piece, arrays)


def _why_unusable(name: str, package: str) -> str:
    """Why a format of another package cannot be used; empty where it can."""
    for offer in offered_formats():
        if (offer.name, offer.package) == (name, package):
            try:
                usable_format(offer)
            except BrokenOfferError as problem:
                return str(problem)
            return ""
    return "it cannot be found by the reading process"


def _limit_reference(path: Path) -> None:
    """The library that reads C3D may go on for ever, and a reference is a walk or two."""
    limit_processor_time(REFERENCE_S + (path.stat().st_size if path.is_file() else 0) / REFERENCE_BYTES_A_SECOND)


def _last_line(error: Exception) -> str:
    frame = error.__traceback__
    while frame is not None and frame.tb_next is not None:
        frame = frame.tb_next
    return "?" if frame is None else f"{Path(frame.tb_frame.f_code.co_filename).name}:{frame.tb_lineno}"

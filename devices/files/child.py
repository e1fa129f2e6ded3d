"""What runs in the limited process: one foreign file, or the files of one trial, at a time.

It is limited before it imports what reads them, is given its task in JSON, and answers as `answers` describes. On Linux
it reads nothing itself: each task has a copy of the process (a fork), the only one in which bytes of others are parsed,
and as little trusted as they are. It may open the task's own files and no others, and is gone with its answer.
"""

import ctypes
import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from devices.files.limits import forbid_reading, limit_processor_time, limit_this_process
from devices.files.system_calls import refuse_system_calls

if TYPE_CHECKING:
    from devices.files.answers import Array, Details

TOML, SITE, TRIAL, GATHER, REFERENCE, QUESTION = "toml", "site", "trial", "gather", "reference", "question"
REFERENCE_S, REFERENCE_BYTES_A_SECOND = 10.0, 1_000_000.0  # of processor time; ten times what a text takes
WORD = "read-foreign-files"  # the argument of a frozen program that is started as this process
IS_LINUX: bool = sys.platform == "linux"
PR_SET_PDEATHSIG = 1
READ, REFUSED, MEMORY, UNFORESEEN = "read", "refused", "memory", "unforeseen"


def main() -> None:
    """Read what is asked for on the standard input until nobody asks any more; the last argument: memory in bytes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl C reaches all of a terminal; who asks ends this process
    asking, answering = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):  # what a library prints before it aborts is no line for the user
        os.dup2(nowhere, stream)
    limit_this_process(int(sys.argv[-1]))
    from devices.files.answers import receive, send

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


def _in_a_copy(asked: "Details", asking: BinaryIO, answering: BinaryIO) -> None:
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
        from devices.files.answers import send

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
    import pyarrow as pa
    import pyarrow.csv as pcsv

    from devices.files import answers, session_folder, site_files

    _ = answers, session_folder, site_files
    # imports more when it is first used; no threads, of which a copy has none
    pcsv.read_csv(pa.py_buffer(b"a\n1\n"), pcsv.ReadOptions(use_threads=False)).column(0).to_numpy()
    if task == QUESTION:
        from devices.files import parquet_questions

        _ = parquet_questions
    if task in (TRIAL, GATHER, REFERENCE):
        import mimetypes

        from devices.files import formats

        mimetypes.init()  # reads the system's tables, which a spreadsheet's reader asks for
        _ = formats


def _files_of(asked: "Details") -> tuple[list[Path], list[Path]]:
    """The files that a task may open, and the folders whose names it may list."""
    if asked["task"] not in (TRIAL, GATHER):
        return [Path(asked["path"])], []
    from devices.files.bids_tables import folders_of_scans, tables_beside
    from devices.files.ximu3_files import QUATERNION

    named = list(map(Path, asked["files"]))
    beside = [other for path in named for other in (path.with_name(QUATERNION), *tables_beside(path))]
    return [*named, *beside], [folder for path in named for folder in folders_of_scans(path)]


def _answer(asked: "Details", arrays: "list[Array]") -> "Details":
    from devices.files.answers import details_of_refusal
    from devices.files.refusal import FileRefusedError

    try:
        return {"what": READ, "details": _read(asked, arrays)}
    except FileRefusedError as refusal:
        return {"what": REFUSED, "details": details_of_refusal(refusal)}
    except OSError as problem:
        why = problem.strerror or type(problem).__name__
        where = str(problem.filename or asked["where"])
        unread = FileRefusedError(where, "the file or folder cannot be read ({why})", "Check the permissions", why=why)
        return {"what": REFUSED, "details": details_of_refusal(unread)}
    except MemoryError:
        arrays.clear()
        return {"what": MEMORY}
    except Exception as error:  # the edge of the process; what the file contains is not in the words
        arrays.clear()
        return {"what": UNFORESEEN, "details": f"{type(error).__name__}, {_last_line(error)}"}


def _read(asked: "Details", arrays: "list[Array]") -> object:
    from devices.files.answers import (
        details_of_block,
        details_of_document,
        details_of_findings,
        details_of_gathered,
        details_of_trial,
    )
    from devices.files.session_folder import IN_THIS_PROCESS
    from devices.files.site_files import read_site

    task = asked["task"]
    if task == TOML:
        return details_of_document(IN_THIS_PROCESS.read_toml(Path(asked["path"])))
    if task == SITE:
        block, findings = read_site(
            Path(asked["path"]), asked["where"], asked["place"], asked["sensor"], asked["is_rate_derived"]
        )
        return {"block": details_of_block(block, arrays), "findings": details_of_findings(findings)}
    if task == QUESTION:
        from devices.files.parquet_questions import answer

        return answer(Path(asked["path"]), asked["sql"], asked["is_typed"], arrays)
    if task == REFERENCE:
        from devices.files.references.answers import details_of_reference
        from devices.files.references.reading import read_reference

        path = Path(asked["path"])
        if not IS_LINUX:
            _limit_reference(path)
        return details_of_reference(read_reference(path), arrays)
    files = list(map(Path, asked["files"]))
    if task == GATHER:
        from devices.files.gathering import gather

        return details_of_gathered(gather(files))
    from devices.files.formats import read_trial  # here: SciPy takes longer to import than most files

    return details_of_trial(read_trial(asked["format"], files, asked["rate_hz"]), arrays)


def _limit_reference(path: Path) -> None:
    """The library that reads C3D may go on for ever, and a reference is a walk or two."""
    limit_processor_time(REFERENCE_S + (path.stat().st_size if path.is_file() else 0) / REFERENCE_BYTES_A_SECOND)


def _last_line(error: Exception) -> str:
    frame = error.__traceback__
    while frame is not None and frame.tb_next is not None:
        frame = frame.tb_next
    return "?" if frame is None else f"{Path(frame.tb_frame.f_code.co_filename).name}:{frame.tb_lineno}"


if __name__ == "__main__":
    main()

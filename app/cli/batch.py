"""`gaitwright batch`: every session under a folder, or of the library, analysed, and one table over all of them."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from app.cli.library import add_key_arguments, opened_library
from app.cli.progress import one_of, positive
from app.storage.layout import default_folder
from app.system.progress import Report
from devices.files.refusal import FileRefusedError, one_line

if TYPE_CHECKING:
    from app.cohort.batch.run import BatchResult
    from app.cohort.batch.sources import SessionSource
    from app.cohort.batch.spread import Workers

LIBRARY = "library"  # the word, in place of a folder; a folder of this name is ./library
METHODS = ("robust", "published")  # as core.results.Method has them, whose import would cost half a second here
DEFAULT_TAU_S = 2.0
HERE = frozenset(("localhost", "127.0.0.1", "::1"))


def add_batch_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Analyse every session under a folder, each into a folder of its own in OUT, as analyse does, and write "
        "OUT/parameters.csv and .parquet: a row for each walk and side, with the data quality of each figure. Given "
        "again, the same command goes on: what is done and has not changed is not done again, what failed is tried "
        "again. Sessions that fail are listed in OUT/failures.csv."
    )
    parser.add_argument(
        "folder",
        metavar="FOLDER|library",
        type=Path,
        help="the folder that holds session folders, however deep, or the word library: all sessions of the library, "
        "whose results leave it with identity",
    )
    parser.add_argument(
        "--library", metavar="LIBRARY", type=Path, default=default_folder(), help="the folder of the library (your own)"
    )
    add_key_arguments(parser)
    parser.add_argument("--out", metavar="OUT", type=Path, required=True, help="the folder of the batch")
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers", metavar="N", type=_count, help="processes of this computer (as many as it has processors)"
    )
    where.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="the scheduler of a Dask cluster of your own, such as tcp://192.0.2.1:8786. FOLDER and OUT have to be on "
        "a disk that all its workers see under the same path, and all need this version",
    )
    parser.add_argument(
        "--method",
        type=one_of(METHODS),
        default=METHODS[0],
        metavar="{robust,published}",
        help="as of analyse (robust)",
    )
    parser.add_argument("--tau", type=positive, default=DEFAULT_TAU_S, metavar="S", help="as of analyse (2)")
    parser.add_argument("--no-report", action="store_true", help="write no report.pdf, which takes half of the time")
    parser.add_argument("--no-rrd", action="store_true", help="write no session.rrd for Rerun")
    parser.set_defaults(stopped="What is done stays in OUT. Give the same command again to go on.")


def batch(args: argparse.Namespace, report: Report) -> Iterator[str]:
    """Do the batch and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        There is no session, something else is at OUT, the library does not open, or no worker answers.
    OSError
        OUT cannot be written.
    """
    if args.folder == Path(LIBRARY):
        _check_apart(args)
    with _workers(args) as workers:  # first: they import what takes seconds while this process does
        result, notes = _done(args, workers, report)
    yield from _reported(args.out, result)
    yield from (f"- {one_line(note)}" for note in notes)
    yield from (f"- {one_line(name)}: {one_line(reason)}" for name, reason in sorted(result.failures.items()))


def _done(args: argparse.Namespace, workers: "Workers", report: Report) -> "tuple[BatchResult, list[str]]":
    """What came of the batch, and what is to be stated about its sessions; raises as `batch`."""
    from app.cohort.batch.analysed_folder import AnalysisChoices
    from app.cohort.batch.done import batch_at
    from app.cohort.batch.run import Batch
    from app.cohort.batch.spread import ClusterLostError
    from core.results import Method

    choices = AnalysisChoices(Method(args.method), args.tau, not args.no_report, not args.no_rrd)
    with _sessions(args) as sessions, batch_at(args.out) as folder:
        work = Batch(sessions, folder, choices)
        try:
            work.run(workers, report)
        except ClusterLostError as lost:
            what = "the cluster is out of reach; what was done until then stays in OUT"
            raise FileRefusedError(args.dask, what, "Start the cluster, then run the same command again") from lost
        return work.result, list(sessions.notes())


def _check_apart(args: argparse.Namespace) -> None:
    """See that what leaves a library stays out of it, and is not sent in the clear.

    Raises
    ------
    FileRefusedError
        OUT lies in the library, or the cluster is elsewhere and not reached by TLS.
    """
    out, library = args.out.resolve(), args.library.resolve()
    if out == library or library in out.parents:
        raise FileRefusedError(
            str(out), "this folder is in the library", "Choose a folder outside the library for --out"
        )
    address = urlsplit(args.dask or "")
    if args.dask and address.scheme != "tls" and address.hostname not in HERE:
        what = "sessions of a library would be sent to this cluster as they are, for anybody to read on the way"
        raise FileRefusedError(
            one_line(args.dask), what, "Use a cluster on this computer, or one whose address starts with tls://"
        )


@contextmanager
def _sessions(args: argparse.Namespace) -> "Iterator[SessionSource]":
    if args.folder == Path(LIBRARY):
        from app.cohort.batch.library_sessions import LibrarySessions

        with opened_library(args) as opened:
            yield LibrarySessions(opened)
    else:
        from app.cohort.batch.sources import SessionFolders

        yield SessionFolders(args.folder, args.out)


@contextmanager
def _workers(args: argparse.Namespace) -> "Iterator[Workers]":
    from app.cohort.batch.executors import of_a_cluster, of_this_computer, processors

    with of_a_cluster(args.dask) if args.dask else of_this_computer(args.workers or processors()) as workers:
        yield workers


def _reported(out: Path, result: "BatchResult") -> Iterator[str]:
    sessions = "1 session" if result.total == 1 else f"{result.total} sessions"
    parts = [f"{result.analysed} analysed"]
    if result.as_before:
        parts.append(f"{result.as_before} were done before")
    if result.failures:
        parts.append(f"{len(result.failures)} failed")
    yield f"{one_line(str(out))}: {sessions}, {', '.join(parts)}; {result.rows} rows in parameters.csv and .parquet."


def _count(text: str) -> int:
    """An argument that is a number of workers.

    Raises
    ------
    ArgumentTypeError
        It is none.
    """
    if not (text.isascii() and text.isdigit() and 0 < int(text) <= 1000):
        raise argparse.ArgumentTypeError(f"{text} is no number of workers")
    return int(text)

"""`gaitwright batch`: every session under a folder, or of the library, analysed, and one table over all of them."""

import argparse
from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from app.cli.arguments import LIBRARY
from app.cohort.batch.executors import of_this_computer, processors
from app.cohort.batch.spread import Workers
from app.system.progress import Report
from devices.files.refusal import FileRefusedError, one_line

if TYPE_CHECKING:
    from app.cohort.batch.run import BatchResult

HERE = frozenset(("localhost", "127.0.0.1", "::1"))


def run(args: argparse.Namespace, report: Report) -> Iterator[str]:
    """Do the batch and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        There is no session, something else is at OUT, the library does not open, or no worker answers.
    OSError
        OUT cannot be written.
    """
    if args.folder == LIBRARY:
        _check_apart(args)
    with _cluster(args.dask) if args.dask else of_this_computer(args.workers or processors()) as workers:
        from app.cli.batch_work import done  # now: what takes seconds, while the workers do the same

        result, notes = done(args, workers, report)
    yield from _reported(args.out, result)
    yield from (f"- {one_line(note)}" for note in notes)
    yield from (f"- {one_line(name)}: {one_line(reason)}" for name, reason in sorted(result.failures.items()))


def _check_apart(args: argparse.Namespace) -> None:
    """Raise FileRefusedError if OUT lies in the library or the cluster is remote without TLS."""
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


def _cluster(address: str) -> AbstractContextManager[Workers]:
    try:
        from app.cohort.batch.cluster import of_a_cluster  # Dask, which may be missing
    except ImportError as problem:
        what = "this needs Dask, which is not installed"
        raise FileRefusedError("--dask", what, "Install it with pip install .[cluster]") from problem
    return of_a_cluster(address)


def _reported(out: Path, result: "BatchResult") -> Iterator[str]:
    sessions = "1 session" if result.total == 1 else f"{result.total} sessions"
    parts = [f"{result.analysed} analysed"]
    if result.as_before:
        parts.append(f"{result.as_before} were done before")
    if result.failures:
        parts.append(f"{len(result.failures)} failed")
    yield f"{one_line(str(out))}: {sessions}, {', '.join(parts)}; {result.rows} rows in parameters.csv and .parquet."

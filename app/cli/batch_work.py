"""What a batch does once its workers are started, which import meanwhile what is imported here."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager

from app.cli.analyse import choices_of, lines_without_log
from app.cli.arguments import LIBRARY
from app.cli.library import opened_library
from app.cohort.batch.done import batch_at
from app.cohort.batch.library_sessions import LibrarySessions
from app.cohort.batch.run import Batch, BatchResult
from app.cohort.batch.sources import SessionFolders, SessionSource
from app.cohort.batch.spread import ClusterLostError, Workers
from app.system.progress import Report
from devices.files.refusal import FileRefusedError


def done(args: argparse.Namespace, workers: Workers, report: Report) -> tuple[BatchResult, list[str]]:
    """What came of the batch, and what is to be stated about its sessions; raises as `batch.run`."""
    with _sessions(args) as sessions, batch_at(args.out) as folder:
        work = Batch(sessions, folder, choices_of(args))
        try:
            work.run(workers, report)
        except ClusterLostError as lost:
            what = "the cluster is out of reach; what was done until then stays in OUT"
            raise FileRefusedError(args.dask, what, "Start the cluster, then run the same command again") from lost
        return work.result, [*sessions.notes(), *lines_without_log(choices_of(args))]


@contextmanager
def _sessions(args: argparse.Namespace) -> Iterator[SessionSource]:
    if args.folder == LIBRARY:
        with opened_library(args) as opened:
            yield LibrarySessions(opened)
    else:
        yield SessionFolders(args.folder, args.out)

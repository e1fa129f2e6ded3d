"""Sessions of an open library, analysed into a folder of their own each, with a table over all of them."""

from collections.abc import Collection
from pathlib import Path
from uuid import UUID

from app.cohort.batch.analysed_folder import AnalysisChoices
from app.cohort.batch.done import batch_at
from app.cohort.batch.executors import of_this_computer, processors
from app.cohort.batch.library_sessions import LibrarySessions
from app.cohort.batch.run import Batch, BatchResult
from app.storage.opened import OpenedLibrary
from app.system.progress import Report
from core.published.angles import DEFAULT_TAU_S
from core.results import Method


def analysed_into(out: Path, opened: OpenedLibrary, ids: Collection[UUID] | None, report: Report) -> BatchResult:
    """Analyse these sessions, or all, with all processors of this computer."""
    sessions, choices = LibrarySessions(opened, ids), AnalysisChoices(Method.ROBUST, DEFAULT_TAU_S)
    with batch_at(out) as folder, of_this_computer(processors()) as workers:
        batch = Batch(sessions, folder, choices)
        batch.run(workers, report)
    return batch.result

"""Sessions of a library analysed again by several processes, and what came of them kept in the library.

Samples are read here, one session after the other, since the library's key leaves this process for nobody; what the
others are given is a session without names, and what they give back are the bytes that the library keeps.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from uuid import UUID

from app.cohort.batch.spread import SelectionResult, Workers, finished
from app.storage.analysis_content import packed
from app.storage.journal.header import JournalRefusedError
from app.storage.kept_analyses import bare
from app.storage.stored import LibraryError
from app.system.progress import Report
from app.wording.translation import tr
from core.analysis import analyse
from core.session import Session
from devices.files.refusal import FileRefusedError

Keep = Callable[[bytes], None]


@dataclass(frozen=True, slots=True)
class AgainTask:
    """One session to be analysed, as it is described and as `bare` leaves it."""

    session_id: UUID
    session: Session


def again_task(task: AgainTask) -> bytes:
    """Analyse a session; what came of it as the library keeps it."""
    return packed(analyse(task.session))


def analyse_again(
    session_ids: tuple[UUID, ...],
    read: Callable[[UUID], tuple[Session, Keep] | None],
    workers: Workers,
    report: Report,
) -> SelectionResult[UUID]:
    """Analyse sessions that lack an analysis as described now, keeping each when done; `report` may stop it.
    `read` gives a session with its samples and what keeps the result, None: nothing to do.
    """
    result, keeps = SelectionResult[UUID](len(session_ids)), dict[UUID, Keep]()

    def reported() -> None:
        words = tr("{done} of {total} sessions").format(done=result.finished, total=result.total)
        report(result.finished / max(result.total, 1), words)

    def tasks() -> Iterator[AgainTask]:
        for session_id in session_ids:
            try:
                found = read(session_id)
            except (LibraryError, JournalRefusedError, FileRefusedError) as refusal:
                result.failures[session_id] = str(refusal)
                continue
            except OSError as problem:
                result.failures[session_id] = problem.strerror or type(problem).__name__
                continue
            if found is None:
                result.as_before += 1
                reported()
                continue
            session, keeps[session_id] = found
            yield AgainTask(session_id, bare(session))

    reported()
    for task, outcome in finished(again_task, tasks(), workers):
        keep = keeps.pop(task.session_id)
        if isinstance(outcome, Exception):
            result.failures[task.session_id] = f"{type(outcome).__name__}: {outcome}"
        else:
            keep(outcome)
            result.analysed += 1
        reported()
    return result

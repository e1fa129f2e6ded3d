"""A batch from its beginning to its table: what is to do, what is done already, how far it is, what failed."""

import math
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime, timedelta
from time import monotonic

from app.cohort.batch.analysed_folder import AnalysisChoices
from app.cohort.batch.done import BatchFolder
from app.cohort.batch.rows import COLUMNS, HIP_COLUMNS, UNNUMBERED, Row
from app.cohort.batch.software import software
from app.cohort.batch.sources import SessionSource
from app.cohort.batch.spread import SelectionResult, WorkerLostError, Workers, finished
from app.cohort.batch.table import write_tables
from app.cohort.batch.task import BatchTask, SessionOutcome, analyse_task, key_of, making_of, summary_digest
from app.system.progress import Report
from app.system.tables import typed_cell, write_table
from core.verdicts.sigmas import in_use
from devices.files.refusal import FileRefusedError, one_line

FAILURES = "failures.csv"
WATCHED = 50  # sessions that the rate is computed from: it may change within a batch

Work = Callable[[BatchTask], SessionOutcome]


@dataclass(slots=True)
class BatchResult(SelectionResult[str]):
    """What came of a batch, sessions by their names. `rows`: of the table."""

    rows: int = 0


class Batch:
    """One run of `batch`; `result` is what came of it so far."""

    def __init__(
        self, sessions: SessionSource, folder: BatchFolder, choices: AnalysisChoices, work: Work = analyse_task
    ) -> None:
        self._sessions, self._folder, self._choices, self._work = sessions, folder, choices, work
        self._software = software()
        self._figures = in_use()
        self._making = making_of(choices, self._software, self._figures)
        self.result = BatchResult(len(sessions.names))

    def run(self, workers: Workers, report: Report) -> None:
        """Do what is not done, then write the table, also if ended early; raises ClusterLostError or OSError."""
        pace, result = Pace(monotonic()), self.result
        report(0.0, f"0 of {result.total} sessions")
        try:
            for task, outcome in finished(self._work, self._tasks(), workers):
                self._take(task.name, outcome)
                pace.note(monotonic())
                left = result.total - result.finished
                words = progress_words(result, pace.end(left, datetime.now()), pace.per_minute)
                report(result.finished / max(result.total, 1), words)
        finally:
            self._write()

    def _tasks(self) -> Iterator[BatchTask]:
        """What has to be looked at by a worker; of a library's sessions those that are not as they were."""
        for name in self._sessions.names:
            record = self._folder.record(name)
            known = (record.key, record.summary_sha256) if record is not None else None
            try:
                content = self._sessions.content(name)
                digest = summary_digest(self._folder.results(name))
                if content and known == (key_of(content, self._making), digest):
                    self._take(name, SessionOutcome(name, is_as_before=True))
                    continue
                source = self._sessions.session(name)
            except FileRefusedError as refusal:
                self._take(name, SessionOutcome(name, failure=str(refusal)))
                continue
            yield BatchTask(name, source, self._folder, self._choices, self._software, known, self._figures)

    def _take(self, name: str, outcome: SessionOutcome | Exception) -> None:
        """Keep what came of a session; raises OSError where OUT cannot be written."""
        if isinstance(outcome, OSError):
            raise outcome
        if isinstance(outcome, Exception):
            outcome = SessionOutcome(name, failure=_reason(outcome))
        if outcome.is_as_before:
            self.result.as_before += 1
        elif outcome.record is not None:
            self._folder.keep(name, outcome.record)
            self.result.analysed += 1
        else:
            self._folder.forget(name)
            self.result.failures[name] = outcome.failure

    def _write(self) -> None:
        failures = sorted(self.result.failures.items())
        lines = [(typed_cell(one_line(name)), typed_cell(one_line(reason))) for name, reason in failures]
        write_table(("session", "reason"), lines, self._folder.work / FAILURES)
        (self._folder.work / FAILURES).replace(self._folder.out / FAILURES)
        has_hips = any(column in row for row in self._rows() for column in HIP_COLUMNS)
        columns = {**COLUMNS, **(HIP_COLUMNS if has_hips else {})}
        self.result.rows = write_tables(self._rows(), self._folder.work, self._folder.out, columns)

    def _rows(self) -> Iterator[Row]:
        """Of the sessions of this run, those that this software made with these choices: never two kinds in a table."""
        numbers: dict[str, str] = {}
        for name in self._sessions.names:
            record = self._folder.record(name)
            if record is not None and record.making == self._making:
                yield from (_with_patient(row, numbers) for row in record.rows)


class Pace:
    """How fast sessions are finished, from the last ones."""

    def __init__(self, began_s: float) -> None:
        self._finished_s = deque([began_s], WATCHED + 1)

    def note(self, now_s: float) -> None:
        """One more is finished."""
        self._finished_s.append(now_s)

    @property
    def per_minute(self) -> float:
        """Give sessions per minute; NaN while nothing is finished."""
        took_s = self._finished_s[-1] - self._finished_s[0]
        return 60 * (len(self._finished_s) - 1) / took_s if took_s > 0 else math.nan

    def end(self, left: int, now: datetime) -> datetime | None:
        """When `left` more will be finished; None while nothing is known."""
        rate = self.per_minute
        if not math.isfinite(rate):
            return None
        try:
            return now + timedelta(minutes=left / rate)
        except OverflowError:
            return None


def progress_words(result: BatchResult, end: datetime | None, per_minute: float) -> str:
    """How far a batch is: "37 of 100 sessions, 14 a minute, done at about 15:32, 2 failed"."""
    words = [f"{result.finished} of {result.total} sessions"]
    if end is not None and result.finished < result.total:
        is_today = end.date() == datetime.now().date()
        rate = f"{per_minute:.0f} a minute" if per_minute >= 2 else f"{60 * per_minute:.0f} an hour"
        words += [rate, f"done at about {end:%H:%M}" if is_today else f"done at about {end:%Y-%m-%d %H:%M}"]
    if result.failures:
        words.append(f"{len(result.failures)} failed")
    return ", ".join(words)


def _with_patient(row: Row, numbers: dict[str, str]) -> Row:
    """A patient of a folder gets a number in place of what only this batch can resolve; a library gives pseudonyms."""
    patient = row["patient"]
    if not isinstance(patient, str) or not patient.startswith(UNNUMBERED):
        return row
    return {**row, "patient": numbers.setdefault(patient, f"patient {len(numbers) + 1}")}


def _reason(error: Exception) -> str:
    if isinstance(error, WorkerLostError):
        return (
            f"Whoever analysed this was ended each time ({one_line(error.how)}), as a computer does that runs out of "
            "memory. Use fewer workers, or analyse it alone."
        )
    return f"The worker could not do this ({type(error).__name__}). Install the same Gaitwright on all of them."

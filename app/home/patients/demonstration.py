"""The demonstration's visits are recorded and analysed beside the screen; each is in the library once it is ready.

Processes of their own move the patients and analyse what was recorded. Whatever touches the library is done on its
thread, in between what the screen asks, so that nobody waits for a visit but who wants to see that one.
"""

import datetime
import logging
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from functools import partial
from typing import NamedTuple
from uuid import UUID

from PySide6.QtCore import QObject, Signal

from app.cohort.batch.again import AgainTask, again_task
from app.cohort.batch.executors import ProcessExecutor, processors
from app.demonstration import patients
from app.demonstration.patients import SimulatedVisit
from app.demonstration.recording import record_beside, take_in
from app.storage.kept_analyses import bare
from app.storage.opened import OpenedLibrary
from app.widgets.progress_strip import ProgressStrip
from app.wizard.resuming import session_to_analyse
from app.wording.translation import tr, tr_n
from app.workers.library_controller import LibraryController
from app.workers.library_state import OpenedState
from core.session import Session

Keep = Callable[[bytes], None]

# and with them all that computes
PRELOADED = ("app.demonstration.recording", "app.cohort.batch.again", "devices.simulation.replay")

_log = logging.getLogger(__name__)


class _Answer(NamedTuple):
    """What a process gave, and who goes on with it; of which library."""

    number: int
    then: Callable[[object], None]
    future: "Future[object]"


class FillingDemonstration(QObject):
    """One library at a time; another, or `stop`, ends what goes on for the one before."""

    changed = Signal()  # a visit is ready
    reported = Signal(str, str)  # what could not be done, and what follows
    _answered = Signal(object)  # from the threads that wait for the processes

    def __init__(self, controller: LibraryController, parent: QObject) -> None:
        super().__init__(parent)
        self._controller = controller
        self.strip = ProgressStrip()
        self._executor: ProcessExecutor | None = None
        self._number = 0  # of the libraries so far
        self._waiting: deque[SimulatedVisit] = deque()
        self._codes: frozenset[str] = frozenset()
        self._total = self._ready = self._failed = 0
        self._answered.connect(self._on_answered)

    @property
    def is_busy(self) -> bool:
        return self._executor is not None

    def is_awaited(self, code: str) -> bool:
        """Whether visits of a patient are being made."""
        return self.is_busy and code in self._codes

    def begin(self, state: OpenedState) -> None:
        """Fill a library that was just opened, if it is a demonstration."""
        self.stop()
        if not state.is_demonstration:
            return
        simulated = patients.simulated_patients(datetime.datetime.now().astimezone())
        self._waiting.extend(visit for patient in simulated for visit in patient.visits)
        self._codes = frozenset(visit.code for visit in self._waiting)
        self._total, self._ready, self._failed = len(self._waiting), 0, 0
        count = min(processors(), self._total)
        if not count:
            return
        self._executor = ProcessExecutor(count, PRELOADED)
        self._executor.begin()
        self._show()
        for _ in range(count):
            self._begin_visit()

    def stop(self) -> None:
        """End it; what is ready stays."""
        self._number += 1
        self._waiting.clear()
        executor, self._executor = self._executor, None
        if executor is not None:
            executor.stop()
        self.strip.hide()

    def _begin_visit(self) -> None:
        """Have the next visit recorded. Each goes its way alone: as many are under way as there are processes."""
        if self._waiting:
            visit = self._waiting.popleft()
            self._ask(partial(self._take_in, visit), record_beside, visit)

    def _take_in(self, visit: SimulatedVisit, session: Session) -> None:
        """Write what was recorded into the library, and read it back to be analysed."""

        def taken_in(opened: OpenedLibrary) -> tuple[AgainTask, Keep] | None:
            return _taken_in(opened, visit, session)

        self._controller.run(taken_in, self._on_taken_in, self._on_refused, self)

    def _on_taken_in(self, found: tuple[AgainTask, Keep] | None) -> None:
        if found is None:
            self._on_kept(None)
        elif self.is_busy:
            task, keep = found
            self._ask(partial(self._keep, keep), again_task, task)

    def _keep(self, keep: Keep, content: bytes) -> None:
        def kept(_opened: OpenedLibrary) -> None:
            keep(content)

        self._controller.run(kept, self._on_kept, self._on_refused, self)

    def _on_kept(self, _nothing: object) -> None:
        if self.is_busy:
            self._ready += 1
            self._go_on()
            self.changed.emit()

    def _on_refused(self, _what: str, _remedy: str) -> None:
        """The library is gone, or its patient was deleted."""
        if self.is_busy:
            self._failed += 1
            self._go_on()

    def _go_on(self) -> None:
        if self._ready + self._failed < self._total:
            self._begin_visit()
            self._show()
            return
        failed = self._failed
        self.stop()
        if failed:
            stated = tr_n("{count} visit could not be simulated.", "{count} visits could not be simulated.", failed)
            self.reported.emit(
                stated.format(count=failed), tr("The others are available. Reopen the demonstration to get all.")
            )

    def _show(self) -> None:
        words = tr("Simulated visits are being recorded and analysed: {ready} of {total} are ready.")
        self.strip.show_progress(words.format(ready=self._ready, total=self._total), self._ready, self._total)

    def _ask(self, then: Callable[..., None], call: Callable[..., object], *given: object) -> None:
        """Let a process make `call`, and go on with what it gives."""
        assert self._executor is not None  # whoever asks is busy
        number = self._number
        future: Future[object] = self._executor.submit(call, *given)
        future.add_done_callback(lambda done: self._answered.emit(_Answer(number, then, done)))

    def _on_answered(self, answer: _Answer) -> None:
        if answer.number != self._number:
            return  # of a library that was closed
        try:
            given = answer.future.result()
        except CancelledError:
            return
        except Exception as error:  # a process that was ended, or a fault of what it did
            _log.warning("a visit of the demonstration was not made", exc_info=error)
            self._on_refused("", "")
            return
        answer.then(given)


def _taken_in(opened: OpenedLibrary, visit: SimulatedVisit, session: Session) -> tuple[AgainTask, Keep] | None:
    """What is to be analysed of a visit, as it came out of its journals, and what keeps what comes of it."""
    session_id: UUID = take_in(opened, visit, session)
    found = session_to_analyse(opened, session_id)
    if found is None:
        return None
    read, keep = found
    return AgainTask(session_id, bare(read)), keep

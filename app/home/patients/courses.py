"""Visits of a patient that have no figures in the course yet are evaluated, until they are or somebody stops it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import Signal

from app.home.patients.reading import compute_courses
from app.system.progress import Report
from app.wording.translation import tr, tr_n
from app.workers.long_work import LongWork

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary


class ComputingCourses(LongWork):
    """One computation at a time."""

    left = Signal()  # it is over, however it ended
    reported = Signal(str, str)  # what could not be done, and what to do

    def begin(self, missing: Sequence[UUID]) -> None:
        def work(opened: "OpenedLibrary", report: Report) -> int:
            return compute_courses(opened, missing, report)

        self._begin(tr("Calculating visits"))
        self._controller.run_long(work, self._on_computed, self._on_refused, self._on_progressed, self)

    def stop(self) -> None:
        self._controller.stop_long()
        self._leave()
        self.reported.emit(tr("Stopped."), tr("Visits calculated so far stay in Progress."))

    def _leave(self) -> None:
        self.is_working = False
        self.left.emit()

    def _on_computed(self, unread: int) -> None:
        self._leave()
        if unread:
            stated = tr_n("{count} visit could not be calculated.", "{count} visits could not be calculated.", unread)
            self.reported.emit(stated.format(count=unread), tr("Open the visit to see why."))

    def _on_refused(self, what: str, remedy: str) -> None:
        self._leave()
        self.reported.emit(what, remedy)

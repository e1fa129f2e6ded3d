"""What came of a session, kept in the library for whoever opens it next."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.storage.kept_analyses import keep_analysis
from app.storage.kept_courses import course_key, keep_course
from app.summary.course import course_of
from app.wizard.evaluation import Evaluation
from app.wizard.recordings import SessionRecordings
from app.workers.library_controller import LibraryController

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from core.results import Analysis
    from core.session import Session


class KeptResults(QObject):
    """Keeps what `evaluation` finds of recordings that are wholly in the library."""

    def __init__(
        self, controller: LibraryController, evaluation: Evaluation, recordings: SessionRecordings, parent: QObject
    ) -> None:
        super().__init__(parent)
        self._controller, self._evaluation, self._recordings = controller, evaluation, recordings
        self.is_partial = False
        """Whether what is evaluated has a walk that still goes on: of that nothing is kept."""
        evaluation.computed.connect(self._keep_analysis)
        evaluation.done.connect(self._keep_course)

    def _keep_analysis(self, session: "Session", analysis: "Analysis") -> None:
        stored = self._recordings.session
        if stored is None or self.is_partial:
            return

        def keep(opened: "OpenedLibrary") -> None:
            keep_analysis(opened.library.results, stored.id, session, analysis)

        self._controller.run(keep, None, self._on_not_kept, self)

    def _keep_course(self) -> None:
        """Keep what belongs in the patient's course of this visit, so that home need not evaluate it."""
        session, analysis, stored = self._evaluation.session, self._evaluation.analysis, self._recordings.session
        if stored is None or session is None or analysis is None or self.is_partial:
            return
        recordings = [recording.stored for recording in self._recordings.every]

        def keep(opened: "OpenedLibrary") -> None:
            course = course_of(analysis, session.recordings)
            keep_course(opened.library.courses, stored.id, course_key(session, recordings), course)

        self._controller.run(keep, None, self._on_not_kept, self)

    def _on_not_kept(self, _what: str, _remedy: str) -> None:
        """No harm: it is computed again."""

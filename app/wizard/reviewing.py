"""Review of the session in Rerun. Its log is written beside the screen, and shown in a window of its own."""

import logging
from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer, Signal

from app.review.viewer import Viewer, ViewerRefusedError, default_root, viewer_program, why_not
from app.system.progress import Report
from app.wording.translation import tr
from app.workers.background import Background

if TYPE_CHECKING:
    from core.results import Analysis
    from core.session import Session
    from core.video.clip import Clip

LOOK_EVERY_MS = 500
_log = logging.getLogger(__name__)


class Reviewing(QObject):
    """One viewer for a visit; its windows end with the program."""

    refused = Signal(str, str)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._viewer: Viewer | None = None
        self._background = Background(self)
        self._background.failed.connect(self._on_failed)
        self._background.done.connect(self._on_opened)
        self._look = QTimer(self)
        self._look.setInterval(LOOK_EVERY_MS)
        self._look.timeout.connect(self._on_look)

    @property
    def is_idle(self) -> bool:
        """Whether no window is open, nor being made ready."""
        return self._background.is_idle and (self._viewer is None or not self._viewer.is_showing)

    def show(self, session: "Session", analysis: "Analysis", clips: "Sequence[Clip]" = ()) -> None:
        """Open a window on the session, with videos where asked; one at a time is made ready."""
        program = viewer_program()
        if why := why_not(program):
            self.refused.emit(why, "")
            return
        if self._background.is_busy:
            return
        viewer = self._viewer = self._viewer or Viewer(default_root(), program)

        def work(_report: Report) -> None:
            viewer.open(session, analysis, clips)

        self._background.start(work)

    def finish(self) -> None:
        """Wait for what is being made ready, and close all windows."""
        self._background.finish()
        self._look.stop()
        if self._viewer is not None:
            self._viewer.close()

    def _on_opened(self, _nothing: object) -> None:
        self._look.start()

    def _on_look(self) -> None:
        """Say of a viewer that ended with an error, which has shown nothing, what its reason was."""
        if self._viewer is None or not self._background.is_idle:  # else it is used by its thread
            return
        if not self._viewer.is_showing:
            self._look.stop()
        for reason in self._viewer.failures():
            _log.warning("Rerun ended with an error: %s", reason)
            what = tr("Rerun closed with an error: {reason}.") if reason else tr("Rerun closed with an error.")
            then = tr("Open the file session.rrd of the results on another computer.")
            self.refused.emit(what.format(reason=reason), then)

    def _on_failed(self, error: Exception) -> None:
        if isinstance(error, ViewerRefusedError):
            self.refused.emit(str(error), "")
            return
        _log.error("Rerun was not shown", exc_info=error)
        self.refused.emit(tr("Rerun could not be started."), tr("See the log for details."))

"""Results of a visit's recordings so far, computed beside the screen whenever one is added."""

import logging
from collections.abc import Mapping
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.storage.kept_analyses import bare, is_same_question
from app.system.progress import Report
from app.wording.translation import tr
from app.workers.background import Background, Work
from core.analysis import analyse
from core.body import Joint, Side
from core.calibration.validity import spans_of_validity
from core.gait.chosen_strides import leave_out
from core.hip.measure import is_trusted

if TYPE_CHECKING:
    from core.hip.results import HipIdentification
    from core.results import Analysis, JointCalibration
    from core.session import Session

_log = logging.getLogger(__name__)


class Evaluation(QObject):
    """`analysis` is that of `session`, both None before the first; a newer question takes the older one's place.

    `computed`: a session and what was found of it, which nobody knew before; strides left out by hand are still in it.
    `done` follows.
    """

    done = Signal()
    computed = Signal(object, object)
    progressed = Signal(float, str)
    refused = Signal(str, str)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.session: Session | None = None
        self.analysis: Analysis | None = None
        self._asked: Session | None = None
        self._found: Analysis | None = None  # with the strides that were left out by hand
        self.has_failed = False  # what was asked last is not known, and nobody is finding it out
        self._background = Background(self)
        self._background.done.connect(self._on_done)
        self._background.failed.connect(self._on_failed)
        self._background.progressed.connect(self.progressed)

    @property
    def is_busy(self) -> bool:
        return self._background.is_busy

    @property
    def is_idle(self) -> bool:
        """Whether no thread is left, not even one that nobody waits for."""
        return self._background.is_idle

    @property
    def calibration(self) -> "Mapping[Joint, JointCalibration]":
        """The latest of each joint."""
        return {} if self.analysis is None else calibration_of(self.analysis)

    @property
    def hips(self) -> "Mapping[Joint, HipIdentification]":
        """What was found last of each hip since the sensors were strapped on, where it can be relied on."""
        if self.analysis is None or self.session is None:
            return {}
        spans = spans_of_validity(self.session)
        names = {recording.name for recording in spans[-1]} if spans else set()
        found = (recording.hips for recording in self.analysis.recordings if recording.name in names)
        hips = {joint: hip.identification for of_both in found for joint, hip in of_both.items()}
        return {joint: hip for joint, hip in hips.items() if is_trusted(hip)}

    def strides(self, walk: str) -> dict[Side, int]:
        """How many strides of each side a walk holds, by its name; empty where it was not evaluated."""
        if self.analysis is None:
            return {}
        gait = (recording.gait for recording in self.analysis.recordings if recording.name == walk)
        return {side: len(found.strides) for of_both in gait for side, found in of_both.items()}

    def ask(self, session: "Session") -> None:
        """Find out what `session` shows; `done` follows, at once where only words or chosen strides have changed."""
        if self._found is not None and self.session is not None and is_same_question(self.session, session):
            self.take_over(session, self._found)
            return
        self._asked, self.has_failed = session, False
        self._background.start(_analysing(session))

    def take_over(self, session: "Session", found: "Analysis") -> None:
        """Go on with what `computed` emitted for `session` before; `done` follows."""
        self._background.stop()
        self._asked, self.has_failed = session, False
        self._settle(found)

    def finish(self) -> None:
        """Wait for the last thread, at the end of the program."""
        self._background.finish()

    def _on_done(self, found: "Analysis") -> None:
        self.computed.emit(self._asked, found)
        self._settle(found)

    def _settle(self, found: "Analysis") -> None:
        assert self._asked is not None  # what was found was asked for
        self._found, self.session = found, self._asked
        self.analysis = leave_out(found, self._asked.recordings)
        self.done.emit()

    def _on_failed(self, error: Exception) -> None:
        _log.error("an analysis ended early", exc_info=error)
        self.has_failed = True
        self.refused.emit(*failure_in_words())


def failure_in_words() -> tuple[str, str]:
    """That an analysis ended early, and what is left."""
    return tr("The analysis stopped before it finished."), tr("The recordings are safe. See the log for details.")


def calibration_of(analysis: "Analysis") -> "Mapping[Joint, JointCalibration]":
    """The latest calibration of each joint in an analysis."""
    return {joint: found for calibration in analysis.calibrations for joint, found in calibration.joints.items()}


def _analysing(session: "Session") -> Work:
    def work(report: Report) -> object:
        return analyse(bare(session), progress=report)

    return work

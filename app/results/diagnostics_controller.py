"""Controller of "How was this found". One joint at a time, computed beside the screen, shown, and saved as files."""

import logging
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog

from app.exports.proposed_names import free_name, session_name
from app.results.found_page import FoundPage
from app.summary.diagnostics import write_diagnostics
from app.widgets.folder_dialog import ask_for_new_folder
from app.wording.recordings import ShownName, shown_names, with_shown_names
from app.wording.translation import tr
from app.workers.background import Background
from core.body import Joint
from core.results import Analysis, JointCalibration, RecordingAnalysis
from core.verdicts.diagnostics import JointDiagnostics, diagnostics_of

if TYPE_CHECKING:
    from core.findings import Finding
    from core.session import Session

_log = logging.getLogger(__name__)

WHAT = "how-found"  # in the name of the folder that is proposed


class DiagnosticsController(QObject):
    """Works for one page; a newer question takes the older one's place.

    `writing`: the folder that was chosen, and the call that writes the files into it: whoever shows the page knows on
    which thread, and who must be notified of an export.
    """

    refused = Signal(str, str)  # what could not be shown, and what follows
    writing = Signal(object, object)

    def __init__(self, page: FoundPage, background: Background, parent: QObject) -> None:
        super().__init__(parent)
        self._page, self._background = page, background
        self._session: Session | None = None
        self._analysis: Analysis | None = None
        self._recording: RecordingAnalysis | None = None
        self._calibrated: Mapping[Joint, JointCalibration] = {}
        self._joint = Joint.LEFT_KNEE
        self._found: JointDiagnostics | None = None
        self._dialog: QFileDialog | None = None
        self._background.done.connect(self._on_done)
        self._background.failed.connect(self._on_failed)
        page.joints.chosen.connect(self._on_joint_chosen)
        page.save.clicked.connect(self._on_save_requested)

    def show(self, session: "Session", analysis: Analysis, recording: RecordingAnalysis) -> None:
        """Answer for a recording of a session: for the joint that was looked at last, else the first it holds."""
        self._session, self._analysis, self._recording = session, analysis, recording
        calibrated = analysis.calibrated_for(recording)
        self._calibrated = {joint: calibrated[joint] for joint in recording.joints if joint in calibrated}
        if self._joint not in self._calibrated:
            self._joint = next(iter(self._calibrated), self._joint)
        self._page.show_joints(list(self._calibrated), self._joint)
        self._begin()

    def stop(self) -> None:
        """Nobody looks any more."""
        self._background.stop()

    def _begin(self) -> None:
        self._found = None
        calibration = self._calibrated.get(self._joint)
        if calibration is None or self._session is None or self._recording is None:
            self._background.stop()
            self._page.show_nothing(self._joint)
            return
        self._page.show_working(self._joint)
        session, name = self._session, self._recording.name
        self._background.start(lambda _report: diagnostics_of(session, calibration, name))

    def _noticed(self) -> "list[Finding]":
        """What the analysis noticed about the joint and its two sensors: everywhere, or in this recording."""
        assert self._analysis is not None
        assert self._recording is not None
        others = {recording.name for recording in self._analysis.recordings} - {self._recording.name}
        placed = [(finding, set(finding.where.split(", "))) for finding in self._analysis.findings]
        parts = {str(part) for part in (self._joint, self._joint.proximal, self._joint.distal)}
        found = [finding for finding, where in placed if parts & where and not where & others]
        return [with_shown_names(finding, self._names) for finding in found]

    @property
    def _names(self) -> dict[str, ShownName]:
        return shown_names(self._session.recordings) if self._session is not None else {}

    def _on_joint_chosen(self, joint: str) -> None:
        self._joint = Joint(joint)
        self._begin()

    def _on_done(self, found: JointDiagnostics | None) -> None:
        self._found = found
        if found is None:
            self._page.show_nothing(self._joint)
        else:
            assert self._session is not None
            names = self._names
            called = replace(
                found,
                walk=str(names.get(found.walk, found.walk)),
                from_recordings=tuple(str(names.get(name, name)) for name in found.from_recordings),
            )
            self._page.show_found(called, self._noticed(), self._session.is_simulated)

    def _on_failed(self, error: Exception) -> None:
        _log.error("how a joint was found could not be shown", exc_info=error)
        self._page.show_nothing(self._joint)
        self.refused.emit(tr("The calibration of this joint cannot be shown."), tr("See the log for details."))

    def _on_save_requested(self) -> None:
        if self._found is None or self._session is None:
            return
        name = session_name("", "", WHAT)  # its files name no patient, so neither does their folder
        self._dialog = ask_for_new_folder(
            self._page,
            tr("Save these values to a new folder"),
            lambda place: free_name(place, name),
            self._on_folder_selected,
        )

    def _on_folder_selected(self, folder: str) -> None:
        if self._found is not None and self._session is not None:
            out = Path(folder)
            self.writing.emit(out, partial(write_diagnostics, self._found, self._session.is_simulated, out))

"""Controller of comparing a session with an optical system.

References are read in the limited child, beside the screen.
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog

from app.exports.proposed_names import free_name, session_name
from app.importing.untrusted_files import read_foreign_reference
from app.reports.agreement.document import agreement_pages
from app.reports.agreement.folder import write_agreement
from app.reports.agreement.pictures import pictures_of
from app.reports.agreement.study import AgreementStudy, as_shown, study_of
from app.results.agreement_page import AgreementPage
from app.system.logs import version_of
from app.system.progress import Report
from app.widgets.folder_dialog import ask_for_files, ask_for_new_folder
from app.wording.translation import filled, tr
from app.workers.background import Background, Work
from core.results import Analysis
from devices.files.refusal import FileRefusedError

if TYPE_CHECKING:
    from core.session import Session

_log = logging.getLogger(__name__)

WHAT = "agreement"  # in the name of the folder that is proposed


@dataclass(frozen=True, slots=True)
class _ComparedSession:
    """`shown`: the study in the names of the screen."""

    study: AgreementStudy
    shown: AgreementStudy
    pages: list[bytes]


@dataclass(frozen=True, slots=True)
class _SharperAgreement:
    pages: list[bytes]


class AgreementController(QObject):
    """Works for one page; newer references take the older ones' place.

    `writing`: the folder that was chosen, and the call that writes the files into it: whoever shows the page knows on
    which thread, and who must be notified of an export.
    """

    writing = Signal(object, object)

    def __init__(self, page: AgreementPage, background: Background, parent: QObject) -> None:
        super().__init__(parent)
        self._page, self._background = page, background
        self._session: Session | None = None
        self._analysis: Analysis | None = None
        self._study: AgreementStudy | None = None
        self._dialog: QFileDialog | None = None
        self._background.done.connect(self._on_done)
        self._background.failed.connect(self._on_failed)
        for asked in (page.choose.clicked, page.waiting.pressed):
            asked.connect(self._on_reference_requested)
        page.save.clicked.connect(self._on_save_requested)
        page.sheets.sharper_required.connect(self._on_sharper_required)

    def show(self, session: "Session", analysis: Analysis) -> None:
        """Compare this session; what was found of the same analysis stays."""
        if analysis is not self._analysis or (self._study is None and not self._background.is_busy):
            self.stop()
            self._session, self._analysis, self._study = session, analysis, None
            self._page.show_nothing()

    def compare(self, paths: Sequence[Path]) -> None:
        """Compare the session with what these files hold."""
        if self._session is None or self._analysis is None:
            return
        self._study = None
        self._page.show_working([path.name for path in paths])
        self._background.start(_comparing(self._session, self._analysis, paths, self._page.sheets.ppi))

    def stop(self) -> None:
        """Nobody looks any more."""
        self._background.stop()

    def _on_reference_requested(self) -> None:
        title = tr("Choose optical reference files")
        self._dialog = ask_for_files(self._page, title, self._on_files_selected)

    def _on_files_selected(self, names: Sequence[str]) -> None:
        self.compare([Path(name) for name in names])

    def _on_done(self, found: object) -> None:
        if isinstance(found, _ComparedSession):
            self._study = found.study
            self._page.show_pages(found.pages, found.shown.left_over)
        elif isinstance(found, _SharperAgreement):
            self._page.show_sharper(found.pages)

    def _on_sharper_required(self) -> None:
        if self._study is not None and self._session is not None and self._background.is_idle:
            study, session, ppi = self._study, self._session, self._page.sheets.ppi
            self._background.start(
                lambda _report: _SharperAgreement(_pages(as_shown(study, session.recordings), session, ppi))
            )

    def _on_failed(self, error: Exception) -> None:
        if isinstance(error, FileRefusedError):
            what, remedy = filled(error.what, error.values), filled(error.remedy, error.values)
            self._page.show_refused(f"{error.where}: {what}.", f"{remedy}.")
            return
        _log.error("a reference was not compared", exc_info=error)
        self._page.show_refused(tr("The reference could not be compared."), tr("See the log for details."))

    def _on_save_requested(self) -> None:
        if self._study is None or self._session is None:
            return
        name = session_name(self._session.patient.code, self._session.started, WHAT)
        self._dialog = ask_for_new_folder(
            self._page,
            tr("Save the agreement report to a new folder"),
            lambda place: free_name(place, name),
            self._on_folder_selected,
        )

    def _on_folder_selected(self, folder: str) -> None:
        if self._study is not None and self._session is not None:
            self.writing.emit(Path(folder), partial(_write, self._study, self._session, Path(folder)))


def _comparing(session: "Session", analysis: Analysis, paths: Sequence[Path], ppi: float) -> Work:
    def work(report: Report) -> object:
        files = []
        for path in paths:

            def waiting(path: Path = path) -> None:
                report(0.0, path.name)

            files.append((path.name, read_foreign_reference(path, waiting)))
        study = study_of(analysis, files)
        report(0.5, "")
        shown = as_shown(study, session.recordings)
        return _ComparedSession(study, shown, _pages(shown, session, ppi))

    return work


def _pages(shown: AgreementStudy, session: "Session", ppi: float) -> list[bytes]:
    made_at, version = datetime.now().astimezone(), version_of("gaitwright")
    return agreement_pages(shown, session, pictures_of(shown, session.patient), made_at, version, ppi)


def _write(study: AgreementStudy, session: "Session", folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    write_agreement(study, session, folder, datetime.now().astimezone(), version_of("gaitwright"))

"""What lies behind results: how a joint was found, and what an optical system measured. Each has its own page.

The pages and whoever fills them are made at the first time: most visits never ask.
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QStackedWidget

from app.results.agreement_page import AgreementPage
from app.wording.translation import tr
from app.workers.background import Background

if TYPE_CHECKING:  # their imports take a second
    from app.results.agreement_controller import AgreementController
    from app.results.diagnostics_controller import DiagnosticsController
    from app.results.found_page import FoundPage
    from core.results import Analysis, RecordingAnalysis
    from core.session import Session

HOW_FOUND, AGREEMENT = "how-found", "agreement"  # what is exported, as the library's audit calls it


class DetailPages(QObject):
    """Two pages in the stack of whoever shows the results.

    `writing`: which figures are to be saved, the folder that was chosen, and the call that writes them into it. Whoever
    shows the page knows on which thread, and calls `show_saved` when it is done.
    """

    refused = Signal(str, str)  # what could not be shown, and what follows
    closed = Signal()  # somebody is done with the page in sight
    writing = Signal(str, object, object)

    def __init__(
        self,
        stack: QStackedWidget,
        looking: Background,
        comparing: Background,
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._stack = stack
        self._looking, self._comparing = looking, comparing
        self.found: FoundPage | None = None
        self.agreement: AgreementPage | None = None
        self._how_found: DiagnosticsController | None = None
        self._compared: AgreementController | None = None
        self._saved_for: FoundPage | AgreementPage | None = None
        self._room = (0.0, 0.0)

    @property
    def is_in_sight(self) -> bool:
        """Whether one of the two is the page that the stack shows."""
        shown = self._stack.currentWidget()
        return shown is not None and (shown is self.found or shown is self.agreement)

    def show_found(self, session: "Session", analysis: "Analysis", recording: "RecordingAnalysis") -> None:
        """Show how the joints of a recording were found."""
        if self.found is None or self._how_found is None:
            from app.results import diagnostics_controller, found_page  # curves, and what computes them

            self.found = found_page.FoundPage()
            self.found.set_room(*self._room)
            self._stack.addWidget(self.found)
            self._how_found = diagnostics_controller.DiagnosticsController(self.found, self._looking, self)
            self._how_found.refused.connect(self.refused)
            self._how_found.writing.connect(partial(self._on_writing, HOW_FOUND))
            self.found.back.clicked.connect(self.closed)
        self._how_found.show(session, analysis, recording)
        self._stack.setCurrentWidget(self.found)

    def show_agreement(self, session: "Session", analysis: "Analysis") -> None:
        """Put a session beside an optical system."""
        if self.agreement is None or self._compared is None:
            from app.results.agreement_controller import AgreementController  # SciPy, Typst

            self.agreement = AgreementPage()
            self._stack.addWidget(self.agreement)
            self._compared = AgreementController(self.agreement, self._comparing, self)
            self._compared.writing.connect(partial(self._on_writing, AGREEMENT))
            self.agreement.back.clicked.connect(self.closed)
        self._compared.show(session, analysis)
        self._stack.setCurrentWidget(self.agreement)

    def stop(self) -> None:
        """Nobody looks any more."""
        self._looking.stop()
        self._comparing.stop()

    def focus(self) -> None:
        """Take the keyboard, where one of the two is in sight."""
        shown = self._stack.currentWidget()
        for page in (self.found, self.agreement):
            if page is not None and page is shown:
                page.focus()

    def set_room(self, width: float, height: float) -> None:
        """Set how much room there is, in px of the design."""
        self._room = width, height
        if self.found is not None:
            self.found.set_room(width, height)

    def show_saved(self, folder: Path) -> None:
        """Say on the page that asked for it that figures are in `folder`."""
        if self._saved_for is not None:
            self._saved_for.show_saved(folder.name)

    def _on_writing(self, what: str, folder: Path, write: Callable[[], None]) -> None:
        self._saved_for = self.found if what == HOW_FOUND else self.agreement
        self.writing.emit(what, folder, write)


def cannot_write(folder: Path) -> tuple[str, str]:
    """The message about a folder that takes no files."""
    return tr("{folder} is not writable").format(folder=folder.name), tr(
        "Choose another folder; the recordings are unchanged"
    )

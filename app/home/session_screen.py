"""A session of a folder or of the demonstration, with no library needed: it is analysed, and its results are shown."""

import logging
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, Qt, QUrl, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QFileDialog,
    QHBoxLayout,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from app.results.detail_pages import DetailPages, cannot_write
from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.ground import set_ground
from app.theme.icons import Icon
from app.widgets.action_bar import BAR_GROUND
from app.widgets.banner import Banner
from app.widgets.button import Button, ButtonKind
from app.widgets.folder_dialog import ask_for_folder
from app.widgets.header import Header
from app.widgets.lay_out import lay_out
from app.widgets.page_stack import PageStack
from app.widgets.reading_area import scrolled
from app.widgets.start_pages import EmptyPage, WorkingPage
from app.widgets.text import Text
from app.wording.body import side_name
from app.wording.findings import place
from app.wording.prostheses import worn_words
from app.wording.translation import PURPOSE, filled, later, tr
from app.workers.background import Background, Work
from app.workers.opening import opening_demonstration, opening_folder
from core.body import Side
from devices.files.refusal import FileRefusedError

if TYPE_CHECKING:  # their imports take a second; the window must not wait for them
    from app.results.result_page import ResultPage
    from app.summary.request import AnalysedVisit
    from core.session import Patient

_log = logging.getLogger(__name__)

NARROW_BELOW = 800
HEADER, BAR = 56, 72
PURPOSE_WIDTH = 120  # what it was made for, in two lines

STOPPED = (
    later("The analysis was stopped."),
    later("Nothing was changed. Reopen the session to continue."),
)
ENDED_EARLY = (
    later("The analysis stopped before it finished."),
    later("The folder is unchanged. See the log for details."),
)


class SessionScreen(QWidget):
    """A header, a page, an action bar. `set_way_back`: where there is something to go back to."""

    left = Signal()
    demonstration_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._background, self._looking, self._comparing, self._saving = (Background(self) for _ in range(4))
        self._has_way_back = False
        self._results: ResultPage | None = None
        self._opened: AnalysedVisit | None = None
        self._saved_in = Path()
        self._dialog: QFileDialog | None = None
        self.header = Header()
        self.banner = Banner()
        self.empty = EmptyPage()
        self.working = WorkingPage()
        self.pages = PageStack()
        self.behind = DetailPages(self.pages, self._looking, self._comparing, self)
        self.bar = _ActionBar()
        self._build()
        self._connect()
        on_theme(self._fit)
        self._show_page(self.empty)

    @property
    def results(self) -> "ResultPage | None":
        """The page of results; None before the first session was analysed."""
        return self._results

    @property
    def is_working(self) -> bool:
        return self._background.is_busy

    def open_folder(self, folder: Path) -> None:
        """Read and analyse a session folder in the background, and show what comes of it."""
        self._begin(opening_folder(folder), tr("Analysing {folder}").format(folder=folder.name))

    def open_demonstration(self) -> None:
        """Let the simulated patient walk, in the background, and show what comes of it."""
        self._begin(opening_demonstration(), tr("Analysing the demonstration"))

    def stop(self) -> None:
        """End what is running, and go back to what was there before."""
        if self.is_working:
            self._background.stop()
            self._show_page(self._results or self.empty)
            self.banner.show_message(*map(tr, STOPPED))

    def leave(self) -> None:
        """Go back, first to the results where these are looked behind, and end what is running."""
        if self.behind.is_in_sight:
            self.behind.stop()
            self._show_page(self._results or self.empty)
        elif self._results is not None and self._results.isVisible() and self._results.leave_behind():
            return
        elif self._has_way_back:
            self.stop()
            self.left.emit()

    def finish(self) -> None:
        """Wait for the thread of an analysis that was running when the window was closed."""
        self._background.finish()
        self._looking.finish()
        self._comparing.finish()
        self._saving.finish()

    def set_way_back(self, has_way_back: bool) -> None:
        self._has_way_back = has_way_back
        self.bar.back.setVisible(has_way_back)
        self._fit()

    def open_dropped(self, urls: list[QUrl]) -> None:
        """Open the folder that was dropped, also by its session.toml."""
        paths = [Path(url.toLocalFile()) for url in urls if url.isLocalFile()]
        if len(paths) == 1 and paths[0].name == "session.toml":
            paths = [paths[0].parent]
        if len(paths) != 1 or not paths[0].is_dir():
            self.banner.show_message(
                tr("This is not a single folder."), tr("Drop the folder that contains session.toml.")
            )
            return
        self.open_folder(paths[0])

    def choose_folder(self) -> None:
        self._dialog = ask_for_folder(self, tr("Open a session folder"), self._on_folder_selected)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def _build(self) -> None:
        for page in (self.empty, self.working):
            self.pages.addWidget(page)
        banner_row = lay_out(QVBoxLayout(), self.banner, margins=(24, 0, 24, 0))
        pages = scrolled(self.pages, is_upright=False)
        lay_out(QVBoxLayout(self), self.header, banner_row, (pages, 1), self.bar, margins=0, spacing=0)

    def _connect(self) -> None:
        for page in (self.empty, self.bar):
            page.open_folder.clicked.connect(self.choose_folder)
            page.open_demonstration.clicked.connect(self.demonstration_requested)
        self.bar.back.clicked.connect(self.leave)
        self.bar.how_found.clicked.connect(self._on_how_found)
        self.working.stop.clicked.connect(self.stop)
        self._background.progressed.connect(self._on_progressed)
        self._background.done.connect(self._on_done)
        self._background.failed.connect(self._on_failed)
        self.behind.refused.connect(self.banner.show_message)
        self.behind.writing.connect(self._on_figures_requested)
        self.behind.closed.connect(self.leave)
        self._saving.done.connect(self._on_figures_saved)
        self._saving.failed.connect(self._on_figures_not_saved)

    def _begin(self, work: Work, title: str) -> None:
        self.banner.hide()
        self.working.begin(title)
        self._show_page(self.working)
        self._background.start(work)

    def _show_page(self, page: QWidget) -> None:
        self.pages.setCurrentWidget(page)
        self.bar.setVisible(page is self._results)
        if page is self.working:
            self.working.stop.setFocus()
        elif page is self.empty:
            self.empty.open_folder.setFocus()
        elif self._results is not None:
            self._results.focus()
        self._fit()

    def _fit(self) -> None:
        """Pass to the pages how much room there is, in px of the design."""
        scale = current_theme().scale
        width, height = self.width() / scale, self.height() / scale
        is_narrow = width < NARROW_BELOW
        self.empty.set_narrow(is_narrow)
        self.bar.set_narrow(is_narrow)
        if self._results is not None:
            self._results.set_room(width, height - HEADER - BAR)
        self.behind.set_room(width, height - HEADER)

    def _on_folder_selected(self, folder: str) -> None:
        self.open_folder(Path(folder))

    def _on_progressed(self, share: float, what: str) -> None:
        words = place(what)
        self.working.show_progress(share, words[:1].upper() + words[1:])

    def _on_done(self, opened: "AnalysedVisit") -> None:
        if self._results is None:
            from app.results.result_page import ResultPage  # numpy, pyqtgraph

            self._results = ResultPage()
            self.pages.addWidget(self._results)
            self._results.quality.how_found.clicked.connect(self._on_how_found)
            self._results.quality.agreement.clicked.connect(self._on_agreement)
            self._results.reported.connect(self._show_band)
            verbs = (self.bar.back, self.bar.open_folder, self.bar.open_demonstration, self.bar.how_found)
            order = [*self._results.tab_order, *verbs]
            for before, after in pairwise(order):
                self.setTabOrder(before, after)
        self._opened, session = opened, opened.session
        self._results.show_visit(opened)
        self.header.show_session(
            session.patient.code or tr("No code"), _in_words(session.patient), session.is_simulated
        )
        self._show_page(self._results)

    def _show_band(self) -> None:
        self.bar.show_message(self._results.band_words if self._results is not None else "")

    def _on_how_found(self) -> None:
        """Look behind the recording that is shown."""
        recording = self._results.recording if self._results is not None else None
        if self._opened is not None and recording is not None:
            self.behind.show_found(self._opened.session, self._opened.analysis, recording)
            self._show_behind()

    def _on_agreement(self) -> None:
        """Put the session beside an optical system."""
        if self._opened is not None:
            self.behind.show_agreement(self._opened.session, self._opened.analysis)
            self._show_behind()

    def _show_behind(self) -> None:
        self.bar.hide()
        self.behind.focus()
        self._fit()

    def _on_figures_requested(self, _what: str, folder: Path, write: Callable[[], None]) -> None:
        self._saved_in = folder
        self._saving.start(lambda _report: write())

    def _on_figures_saved(self) -> None:
        self.behind.show_saved(self._saved_in)

    def _on_figures_not_saved(self, error: Exception) -> None:
        if not isinstance(error, OSError):
            _log.error("the figures were not saved", exc_info=error)
        self.banner.show_message(*(f"{stated}." for stated in cannot_write(self._saved_in)))

    def _on_failed(self, error: Exception) -> None:
        self._show_page(self._results or self.empty)
        if isinstance(error, FileRefusedError):
            what, remedy = filled(error.what, error.values), filled(error.remedy, error.values)
            self.banner.show_message(f"{error.where}: {what}.", f"{remedy}.")
        else:
            _log.error("the analysis ended early", exc_info=error)
            self.banner.show_message(*map(tr, ENDED_EARLY))


class _ActionBar(QWidget):
    """The ways on from a result. Where they do not all fit, the demonstration, which has its key, is left out."""

    def __init__(self) -> None:
        super().__init__()
        self._is_narrow = False
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.back = Button(tr("Back"), ButtonKind.SECONDARY, Icon.BACK)
        self.back.hide()
        self.open_folder = Button(tr("Open a session folder"), ButtonKind.SECONDARY, Icon.FOLDER, tr("Ctrl O"))
        self.open_demonstration = Button(tr("Open the demonstration"), ButtonKind.QUIET, Icon.PLAY, tr("Ctrl D"))
        self.how_found = Button(tr("Show calibration"), ButtonKind.QUIET, Icon.SEARCH)
        self._purpose = Text(tr(PURPOSE), size=12, tone="ink2", wraps=True)
        self._purpose.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self._row = lay_out(
            QHBoxLayout(self), self.back, self.open_folder, self.open_demonstration, self.how_found, (self._purpose, 1)
        )
        set_ground(self, BAR_GROUND)
        scaled(self.setFixedHeight, BAR)
        self.set_narrow(is_narrow=False)

    def show_message(self, note: str) -> None:
        """Say what must be known of the curves, before what the program is for."""
        self._purpose.setText(" ".join(filter(None, [note, tr(PURPOSE)])))

    def set_narrow(self, is_narrow: bool) -> None:
        self._is_narrow = is_narrow
        self._purpose.setVisible(not is_narrow)
        side = 16 if is_narrow else 24
        scaled(self._row.setContentsMargins, side, 0, side, 0)
        scaled(self._row.setSpacing, 8 if is_narrow else 16)
        self._leave_out()

    def minimumSizeHint(self) -> QSize:
        """Ask for no more than there is without the demonstration, else no window could become that narrow."""
        size, less = super().minimumSizeHint(), self.open_demonstration
        return QSize(size.width() - (0 if less.isHidden() else less.sizeHint().width()), size.height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._leave_out()

    def _leave_out(self) -> None:
        widgets = (self.back, self.open_folder, self.open_demonstration, self.how_found)
        needed = [widget.sizeHint().width() for widget in widgets if widget is not self.back or not widget.isHidden()]
        needed += [] if self._is_narrow else [px(PURPOSE_WIDTH)]
        room = self.width() - 2 * self._row.contentsMargins().left() - self._row.spacing() * (len(needed) - 1)
        self.open_demonstration.setVisible(sum(needed) <= room)


def _in_words(patient: "Patient") -> str:
    """Give what the clinic typed, in one line."""
    person = ", ".join(filter(None, [str(patient.birth_year or ""), patient.sex]))
    side = ""
    if worn := worn_words(patient):
        side = " · ".join(worn)
    elif patient.prosthetic_side and patient.prosthetic_side != "none":
        side = tr("{side} prosthetic").format(side=_side_in_words(patient.prosthetic_side))
    elif patient.affected_side and patient.affected_side != "none":
        side = tr("{side} affected").format(side=_side_in_words(patient.affected_side))
    return " · ".join(filter(None, [person, side, patient.device]))


def _side_in_words(side: str) -> str:
    """Name a side as a session's file does, which also knows "both"."""
    return side_name(Side(side)) if side in set(Side) else tr("both")

"""The report as it will print, the clinician's words, and what is saved beside it."""

from collections.abc import Sequence
from uuid import UUID

from PySide6.QtCore import QEvent, QObject, QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QBoxLayout, QFrame, QHBoxLayout, QPlainTextEdit, QWidget

from app.theme.notifier import ThemeNotifier
from app.widgets.card import Card
from app.widgets.chips import Chips
from app.widgets.choice import Choice
from app.widgets.reading_area import ReadingArea
from app.widgets.segmented import Segmented
from app.widgets.sheets import Sheet, Sheets, SmallSheets
from app.widgets.text import SEMIBOLD, Text
from app.widgets.themed import Themed
from app.wording.translation import tr

WORDS_WIDTH = 320
WORDS_HEIGHT = 100
REBUILT_AFTER_MS = 300  # without a key pressed
NARROW_BELOW = 900
QWIDGETSIZE_MAX = (1 << 24) - 1  # as Qt has it, and does not hand out
FIRST_CHOICE = ("csv", "rrd")


class ReportPage(Themed):
    """Shown pages as pictures.

    Signals
    -------
    comment_edited
        The words, once the typing pauses.
    options_changed
        Another paper, another visit to compare with, or other files beside the report.
    sharper_required
        There is room for finer pictures of the pages than those shown.
    """

    comment_edited = Signal(str)
    options_changed = Signal()
    sharper_required = Signal()

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look, self._is_narrow = look, False
        self.sheets, self.small = Sheets(look), SmallSheets(look)
        self.reading = ReadingArea()
        self.reading.setFrameShape(QFrame.Shape.NoFrame)
        self.reading.setWidgetResizable(True)
        self.reading.setWidget(self.sheets)
        self.reading.setAccessibleName(tr("Report pages"))
        self.comment = QPlainTextEdit()
        self.comment.setAccessibleName(tr("Clinical comment, optional, printed"))
        self.comment.setTabChangesFocus(True)
        self.comment.setPlaceholderText(tr("Printed above the signature."))
        self.comment.installEventFilter(self)
        self.formats = Chips(
            look,
            tr("Also save"),
            [
                ("csv", tr("CSV")),
                ("xlsx", tr("XLSX")),
                ("c3d", tr("C3D")),
                ("mot", tr("OpenSim")),
                ("fhir", tr("FHIR")),
                ("rrd", tr("Rerun")),
            ],
        )
        self.formats.choose(FIRST_CHOICE)
        self.paper = Segmented(look, tr("Paper"), [("a4", tr("A4"), ""), ("letter", tr("Letter"), "")])
        self.earlier = Choice(look, tr("Compare with"))
        self._earlier_title = Text(look, tr("Compare with"), size=16, weight=SEMIBOLD)
        self._title = Text(look, tr("Clinical comment"), size=20, weight=SEMIBOLD)
        self._also = Text(look, tr("Also save"), size=16, weight=SEMIBOLD)
        self._sheet = Text(look, tr("Paper"), size=16, weight=SEMIBOLD)
        self.added = Chips(
            look,
            tr("Extra pages"),
            [
                ("course", tr("Progress so far")),
                ("en", tr("Patient, English")),
                ("de", tr("Patient, German")),
            ],
            rivals=("en", "de"),
        )
        self.added.choose(("course",))
        self._added_title = Text(look, tr("Extra pages"), size=16, weight=SEMIBOLD)
        self._card = Card(look, padding=20, spacing=12)
        for parts in (
            (self._title, self.comment, self._added_title, self.added, self._earlier_title, self.earlier),
            (self._also, self.formats, self._sheet, self.paper),
        ):
            for part in parts:
                self._card.column.addWidget(part)
        self._card.column.addStretch(1)
        self._row = QBoxLayout(QBoxLayout.Direction.LeftToRight, self)
        self._pages = QHBoxLayout()
        self._pages.addWidget(self.small)
        self._pages.addWidget(self.reading, 1)
        self._row.addLayout(self._pages, 1)
        self._row.addWidget(self._card)
        self._pause = QTimer(self)
        self._pause.setSingleShot(True)
        self._pause.setInterval(REBUILT_AFTER_MS)
        self._pause.timeout.connect(self._on_paused)
        self.comment.textChanged.connect(self._pause.start)
        self.formats.turned.connect(self.options_changed)
        self.added.turned.connect(self.options_changed)
        self.small.requested.connect(self._go_to)
        self.reading.verticalScrollBar().valueChanged.connect(self._on_scrolled)
        self.paper.chosen.connect(self.options_changed)
        self.earlier.activated.connect(self.options_changed)
        self.sheets.sharper_required.connect(self.sharper_required)
        self.show_visits([])
        self._on_look_changed()

    @property
    def tab_order(self) -> list[QWidget]:
        choices = [*self.added.buttons, self.earlier]
        return [self.small, self.reading, self.comment, *choices, *self.formats.buttons, *self.paper.segments]

    def focus(self) -> None:
        """Give the focus to the pages: the words are optional, and Enter belongs to the report."""
        self.reading.setFocus()

    def set_room(self, width: float, _height: float) -> None:
        """Put the words under the pages where both do not stand side by side."""
        self._is_narrow = is_narrow = width < NARROW_BELOW
        way = QBoxLayout.Direction.TopToBottom if is_narrow else QBoxLayout.Direction.LeftToRight
        self._row.setDirection(way)
        self.small.setVisible(not is_narrow)
        self.reading.setMinimumHeight(self._look.theme.px(360) if is_narrow else 0)
        self._fit_card()

    def _fit_card(self) -> None:
        words = self._look.theme.px(WORDS_WIDTH)
        self._card.setMinimumWidth(words)
        self._card.setMaximumWidth(QWIDGETSIZE_MAX if self._is_narrow else words)

    def show_comment(self, comment: str) -> None:
        """Show what was typed earlier; the typing goes on where it was if it is the same."""
        if comment != self.comment.toPlainText():
            with QSignalBlocker(self.comment):
                self.comment.setPlainText(comment)

    def show_visits(self, visits: Sequence[tuple[UUID, str]]) -> None:
        """Offer earlier visits, each with its words, to be compared with; what was chosen stays."""
        before = self.chosen_visit
        self.earlier.clear()
        self.earlier.addItem(tr("No earlier visit"))
        for number, words in visits:
            self.earlier.addItem(words, number)
        self.earlier.setCurrentIndex(max(self.earlier.findData(before), 0) if before is not None else 0)
        self.earlier.updateGeometry()
        for part in (self._earlier_title, self.earlier):
            part.setVisible(bool(visits))

    @property
    def chosen_visit(self) -> UUID | None:
        """The earlier visit that is compared with."""
        found = self.earlier.currentData()
        return found if isinstance(found, UUID) else None

    @property
    def pages_ppi(self) -> float:
        """How many points of the screen an inch of paper takes: pictures of pages need no more."""
        return self.sheets.ppi

    def show_pages(self, pages: Sequence[bytes]) -> None:
        """Show pages, each a PNG."""
        sheets = [Sheet(page) for page in pages]
        self.sheets.show_pages(sheets)
        self.small.show_pages(sheets)

    @property
    def patient_language(self) -> str:
        """The language of the page for the patient; empty where none is added."""
        return next((key for key in self.added.chosen if key in ("en", "de")), "")

    def _go_to(self, number: int) -> None:
        self.reading.verticalScrollBar().setValue(round(self.sheets.top_of(number)))
        self.small.mark(number)  # also of the last, which may not come to stand at the top

    def _on_scrolled(self, value: int) -> None:
        """Mark the page that is at the upper third of what is seen."""
        at = value + self.reading.viewport().height() / 3
        begun = [number for number in range(self.sheets.count) if self.sheets.top_of(number) <= at]
        if begun and begun[-1] != self.small.number:
            self.small.mark(begun[-1])

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Let Esc and Ctrl Enter leave the words: Enter then saves the report."""
        if watched is self.comment and isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress:
            is_enter = event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter)
            if event.key() == Qt.Key.Key_Escape or (
                is_enter and event.modifiers() & Qt.KeyboardModifier.ControlModifier
            ):
                self.focus()
                return True
        return super().eventFilter(watched, event)

    @property
    def is_typing(self) -> bool:
        """Whether there are words here that were not passed on yet."""
        return self._pause.isActive()

    def flush(self) -> None:
        """Pass on words that are still being typed."""
        if self._pause.isActive():
            self._pause.stop()
            self._on_paused()

    def _on_paused(self) -> None:
        self.comment_edited.emit(self.comment.toPlainText())

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self._row.setContentsMargins(px(24), px(16), px(24), px(16))
        self._row.setSpacing(px(16))
        self._pages.setSpacing(px(8))
        self._fit_card()
        self.comment.setFixedHeight(px(WORDS_HEIGHT))
        self.comment.setFont(self._look.theme.font(14))

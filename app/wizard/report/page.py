"""The report as it will print, the clinician's words, and what is saved beside it."""

from collections.abc import Sequence
from uuid import UUID

from PySide6.QtCore import QEvent, Signal
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QSizePolicy, QWidget

from app.review.installed import has_rerun
from app.theme.current import on_theme, px, scaled
from app.widgets.card import Card
from app.widgets.chips import Chips
from app.widgets.choice import Choice
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import ReadingArea
from app.widgets.segmented import Segmented
from app.widgets.sheets import Sheet, Sheets, SmallSheets
from app.widgets.text import SEMIBOLD, Text
from app.widgets.toggle import Toggle
from app.wizard.report.comment_editor import CommentEditor
from app.wording.translation import LANGUAGES, spoken_language, tr

ACROSS, DOWN = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom
WORDS_WIDTH = 320
PADDING = 20
CHIP = 44
NARROW_BELOW = 900
QWIDGETSIZE_MAX = (1 << 24) - 1  # as Qt has it, and does not hand out
LETTER = "letter"  # among the files to export
FIRST_CHOICE = ("csv", "rrd")


class ReportPage(QWidget):
    """Shown pages as pictures."""

    options_changed = Signal()  # another paper, another visit to compare with, or other files beside the report
    sharper_required = Signal()  # there is room for finer pictures of the pages than those shown

    def __init__(self) -> None:
        super().__init__()
        self._is_narrow = False
        self.sheets, self.small = Sheets(), SmallSheets()
        self.reading = ReadingArea(self.sheets, tr("Report pages"))
        self.editor = CommentEditor()
        self.comment = self.editor.field
        self.formats = Chips(
            tr("Files to export"),
            [
                ("csv", tr("CSV")),
                ("xlsx", tr("XLSX")),
                ("c3d", tr("C3D")),
                ("mot", tr("OpenSim")),
                ("fhir", tr("FHIR")),
                *([("rrd", tr("Rerun"))] if has_rerun() else []),
                (LETTER, tr("Patient letter")),
            ],
        )
        self.formats.choose(FIRST_CHOICE if has_rerun() else FIRST_CHOICE[:1])
        self.paper = Segmented(tr("Paper"), [("a4", tr("A4"), ""), ("letter", tr("Letter"), "")])
        self.earlier = Choice(tr("Compare with"))
        self.earlier.let_shrink(WORDS_WIDTH - 2 * PADDING, WORDS_WIDTH - 2 * PADDING)  # conditions are typed
        self.earlier.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)  # as wide as its card
        self._earlier_title = _title(tr("Compare with"))
        self.added = Chips(tr("Extra pages"), [("course", tr("Progress so far"))])
        self.added.choose(("course",))
        self.video = Toggle(tr("Pictures of the video"), "", is_on=False)
        self.video.set_face(height=CHIP)
        self._faces = Text(tr("Faces can be recognised in these pictures."), size=14, tone="ink2", wraps=True)
        languages = [(key, name, "") for key, name in LANGUAGES.items()]
        self.language = Segmented(tr("Language of the patient letter"), languages)
        if spoken_language() in LANGUAGES:
            self.language.choose(spoken_language())
        self._card = Card(padding=PADDING, spacing=12)
        rows = [
            lay_out(QHBoxLayout(), (_title(title), 1), control)
            for title, control in (
                (tr("Extra pages"), self.added),
                (tr("Patient letter"), self.language),
                (tr("Paper"), self.paper),
            )
        ]
        above, files = (self.editor, self._earlier_title, self.earlier), _title(tr("Files to export"))
        lay_out(self._card.column, *above, rows[0], self.video, self._faces, *rows[1:], files, self.formats, 1)
        pages = lay_out(QHBoxLayout(), self.small, (self.reading, 1), spacing=8)
        self._row = lay_out(QBoxLayout(ACROSS, self), (pages, 1), self._card, margins=(24, 16, 24, 16), spacing=16)
        self.editor.left.connect(self.focus)
        self.formats.turned.connect(self.options_changed)
        self.added.turned.connect(self.options_changed)
        self.video.toggled.connect(self.options_changed)
        self.small.requested.connect(self._go_to)
        self.reading.verticalScrollBar().valueChanged.connect(self._on_scrolled)
        self.paper.chosen.connect(self.options_changed)
        self.earlier.activated.connect(self.options_changed)
        self.sheets.sharper_required.connect(self.sharper_required)
        self.show_visits([])
        self.offer_video(is_offered=False)
        on_theme(self._fit_card)

    @property
    def tab_order(self) -> list[QWidget]:
        words: list[QWidget] = [self.small, self.reading, self.comment, self.editor.button]
        choices = [self.earlier, *self.added.buttons, self.video, *self.language.segments, *self.paper.segments]
        return [*words, *choices, *self.formats.buttons]

    def focus(self) -> None:
        """Give the focus to the pages: the words are optional, and Enter belongs to the report."""
        self.reading.setFocus()

    def set_room(self, width: float, _height: float) -> None:
        """Put the words under the pages where both do not stand side by side."""
        self._is_narrow = is_narrow = width < NARROW_BELOW
        self._row.setDirection(DOWN if is_narrow else ACROSS)
        self.small.setVisible(not is_narrow)
        scaled(self.reading.setMinimumHeight, 360 if is_narrow else 0)
        self._fit_card()

    def event(self, event: QEvent) -> bool:
        is_done = super().event(event)
        if event.type() == QEvent.Type.LayoutRequest:  # the words beside are wider in another font or language
            self._fit_card()
        return is_done

    def _fit_card(self) -> None:
        words = max(px(WORDS_WIDTH), self._card.minimumSizeHint().width())
        self._card.setMinimumWidth(words)
        self._card.setMaximumWidth(QWIDGETSIZE_MAX if self._is_narrow else words)

    def show_visits(self, visits: Sequence[tuple[UUID, str]]) -> None:
        """Offer earlier visits, each with its words, to be compared with; what was chosen stays."""
        lines: list[tuple[str, object]] = [(tr("No earlier visit"), None)]
        self.earlier.offer(lines + [(words, number) for number, words in visits], self.chosen_visit)
        for part in (self._earlier_title, self.earlier):
            part.setVisible(bool(visits))

    def offer_video(self, *, is_offered: bool) -> None:
        """Offer pictures of the walk's video, where there is one whose times are known."""
        for part in (self.video, self._faces):
            part.setVisible(is_offered)
        if not is_offered:
            self.video.show_on(False)

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

    def _go_to(self, number: int) -> None:
        self.reading.verticalScrollBar().setValue(round(self.sheets.top_of(number)))
        self.small.mark(number)  # also of the last, which may not come to stand at the top

    def _on_scrolled(self, value: int) -> None:
        """Mark the page that is at the upper third of what is seen."""
        at = value + self.reading.viewport().height() / 3
        begun = [number for number in range(self.sheets.count) if self.sheets.top_of(number) <= at]
        if begun and begun[-1] != self.small.number:
            self.small.mark(begun[-1])


def _title(words: str) -> Text:
    return Text(words, size=16, weight=SEMIBOLD)

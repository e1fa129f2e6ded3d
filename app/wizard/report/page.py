"""The report as it will print, the clinician's words, and what is saved beside it."""

from collections.abc import Sequence
from uuid import UUID

from PySide6.QtCore import QBuffer, QEvent, QObject, QRectF, QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QImage, QImageReader, QKeyEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QBoxLayout, QFrame, QPlainTextEdit, QScrollArea, QSizePolicy, QVBoxLayout, QWidget

from app.theme import ThemeNotifier
from app.widgets.card import Card
from app.widgets.chips import Chips
from app.widgets.choice import Choice
from app.widgets.segmented import Segmented
from app.widgets.text import SEMIBOLD, Text
from app.widgets.themed import Themed
from app.wording import tr

WORDS_WIDTH = 320
WORDS_HEIGHT = 176
PAGE_WIDTH = 560  # a page of A4 that can be read
PAPER_INCH = 8.27  # how wide A4 is
LEAST_PPI, MOST_PPI = 60.0, 220.0
SHARP_ENOUGH = 0.9
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
    sharper_wanted
        There is room for finer pictures of the pages than those shown.
    """

    comment_edited = Signal(str)
    options_changed = Signal()
    sharper_wanted = Signal()

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look, self._is_narrow = look, False
        self.sheets = _Sheets(look)
        self._scroll = QScrollArea()
        self._scroll.setFrameShape(QFrame.Shape.NoFrame)
        self._scroll.setWidgetResizable(True)
        self._scroll.setWidget(self.sheets)
        self._scroll.setAccessibleName(tr("The report's pages"))
        self.comment = QPlainTextEdit()
        self.comment.setAccessibleName(tr("Your words, optional, printed"))
        self.comment.setTabChangesFocus(True)
        self.comment.setPlaceholderText(tr("Printed on the last page, above the signature."))
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
        self._title = Text(look, tr("Your words"), size=20, weight=SEMIBOLD)
        self._also = Text(look, tr("Also save"), size=16, weight=SEMIBOLD)
        self._sheet = Text(look, tr("Paper"), size=16, weight=SEMIBOLD)
        self._note = Text(look, tr("Only the code stands on the report, no name."), tone="ink2", wraps=True)
        self._card = Card(look, padding=20, spacing=12)
        for parts in (
            (self._title, self.comment, self._earlier_title, self.earlier),
            (self._also, self.formats, self._sheet, self.paper, self._note),
        ):
            for part in parts:
                self._card.column.addWidget(part)
        self._card.column.addStretch(1)
        self._row = QBoxLayout(QBoxLayout.Direction.LeftToRight, self)
        self._row.addWidget(self._scroll, 1)
        self._row.addWidget(self._card)
        self._pause = QTimer(self)
        self._pause.setSingleShot(True)
        self._pause.setInterval(REBUILT_AFTER_MS)
        self._pause.timeout.connect(self._on_paused)
        self.comment.textChanged.connect(self._pause.start)
        self.formats.turned.connect(self.options_changed)
        self.paper.chosen.connect(self.options_changed)
        self.earlier.activated.connect(self.options_changed)
        self.sheets.sharper_wanted.connect(self.sharper_wanted)
        self.show_visits([])
        self._on_look_changed()

    @property
    def tab_order(self) -> list[QWidget]:
        return [self._scroll, self.comment, self.earlier, *self.formats.buttons, *self.paper.segments]

    def focus(self) -> None:
        """Give the focus to the pages: the words are optional, and Enter belongs to the report."""
        self._scroll.setFocus()

    def set_room(self, width: float, _height: float) -> None:
        """Put the words under the pages where both do not stand side by side."""
        self._is_narrow = is_narrow = width < NARROW_BELOW
        way = QBoxLayout.Direction.TopToBottom if is_narrow else QBoxLayout.Direction.LeftToRight
        self._row.setDirection(way)
        self._scroll.setMinimumHeight(self._look.theme.px(360) if is_narrow else 0)
        self._fit_card()

    def _fit_card(self) -> None:
        words = self._look.theme.px(WORDS_WIDTH)
        self._card.setMinimumWidth(words)
        self._card.setMaximumWidth(QWIDGETSIZE_MAX if self._is_narrow else words)

    def show_comment(self, comment: str) -> None:
        """Show what was said earlier; the typing goes on where it was if it is the same."""
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
        self.sheets.show_pages(pages)

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

    def flush(self) -> None:
        """Tell of words that are still being typed."""
        if self._pause.isActive():
            self._pause.stop()
            self._on_paused()

    def _on_paused(self) -> None:
        self.comment_edited.emit(self.comment.toPlainText())

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self._row.setContentsMargins(px(24), px(16), px(24), px(16))
        self._row.setSpacing(px(16))
        self._fit_card()
        self.comment.setFixedHeight(px(WORDS_HEIGHT))
        self.comment.setFont(self._look.theme.font(14))


class _Sheet:
    """A page as PNG: a picture once it is looked at."""

    def __init__(self, png: bytes) -> None:
        self._png: bytes | None = png
        self._picture = QImage()
        file = QBuffer()
        file.setData(png)
        size = QImageReader(file).size()
        self.width = size.width()
        self.height_per_width = size.height() / max(size.width(), 1)

    def picture(self) -> QImage:
        if self._png is not None:
            self._picture, self._png = QImage.fromData(self._png), None
        return self._picture


class _Sheets(QWidget):
    """The pages under each other, as wide as there is room for."""

    sharper_wanted = Signal()

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self._pages: list[_Sheet] = []
        self._settled = QTimer(self)
        self._settled.setSingleShot(True)
        self._settled.setInterval(REBUILT_AFTER_MS)
        self._settled.timeout.connect(self.sharper_wanted)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.MinimumExpanding)
        self.setAccessibleName(tr("No pages yet"))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)

    @property
    def count(self) -> int:
        return len(self._pages)

    @property
    def ppi(self) -> float:
        return min(max(self._width() * self.devicePixelRatioF() / PAPER_INCH, LEAST_PPI), MOST_PPI)

    def show_pages(self, pages: Sequence[bytes]) -> None:
        self._pages = [_Sheet(page) for page in pages]
        self.setAccessibleName(tr("The report, {count} pages").format(count=len(pages)))
        self._fit()
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(self._look.theme.px(PAGE_WIDTH), self._height())

    def resizeEvent(self, _event: object) -> None:
        self._fit()
        if self._pages and self._pages[0].width < SHARP_ENOUGH * self.ppi * PAPER_INCH:
            self._settled.start()

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        top, width = 0.0, self._width()
        left = (self.width() - width) / 2
        for page in self._pages:
            place = QRectF(left, top, width, width * page.height_per_width)
            if place.intersects(QRectF(self.visibleRegion().boundingRect())):
                painter.drawImage(place, page.picture())
                painter.setPen(theme.pen(theme.colours.control, 1))
                painter.setBrush(Qt.BrushStyle.NoBrush)
                painter.drawRect(place.adjusted(0.5, 0.5, -0.5, -0.5))
            top += place.height() + theme.px(16)

    def _width(self) -> float:
        return min(float(self.width()), 1.5 * self._look.theme.px(PAGE_WIDTH))

    def _height(self) -> int:
        heights = (self._width() * page.height_per_width for page in self._pages)
        return round(sum(height + self._look.theme.px(16) for height in heights))

    def _fit(self) -> None:
        self.setMinimumHeight(self._height())

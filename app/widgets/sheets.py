"""Pages of a document as pictures: all of them to be read, and small ones beside that lead to each."""

from collections.abc import Sequence

from PySide6.QtCore import QBuffer, QPointF, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QAccessible, QColor, QImage, QImageReader, QKeyEvent, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import current_theme, px
from app.widgets.painted import Painted
from app.wording.translation import tr, tr_n

PAGE_WIDTH = 560  # a page of A4 that can be read
PAPER_INCH = 8.27  # how wide A4 is
LEAST_PPI, MOST_PPI = 60.0, 220.0
SHARP_ENOUGH = 0.9
SETTLED_AFTER_MS = 300
GAP = 16
SMALL_WIDTH, LEAST_WIDTH, SMALL_GAP, NUMBER = 64, 36, 10, 16


class Sheet:
    """A page as PNG: a picture once it is looked at."""

    def __init__(self, png: bytes) -> None:
        self._png: bytes | None = png
        self._picture, self._small = QImage(), QImage()
        file = QBuffer()
        file.setData(png)
        size = QImageReader(file).size()
        self.width = size.width()
        self.height_per_width = size.height() / max(size.width(), 1)

    def picture(self) -> QImage:
        if self._png is not None:
            self._picture, self._png = QImage.fromData(self._png), None
        return self._picture

    def small(self, width: int) -> QImage:
        """The same so many pixels wide, made once: smaller by far, it needs more than a painter's smoothing."""
        if self._small.width() != width:
            self._small = self.picture().scaledToWidth(width, Qt.TransformationMode.SmoothTransformation)
        return self._small


class Sheets(QWidget):
    """The pages under each other, as wide as there is room for."""

    accessible_role = QAccessible.Role.Document

    sharper_required = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.pages: list[Sheet] = []
        self._settled = QTimer(self)
        self._settled.setSingleShot(True)
        self._settled.setInterval(SETTLED_AFTER_MS)
        self._settled.timeout.connect(self.sharper_required)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.MinimumExpanding)
        self.setAccessibleName(tr("No pages yet"))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)

    @property
    def count(self) -> int:
        return len(self.pages)

    @property
    def ppi(self) -> float:
        return min(max(self._width() * self.devicePixelRatioF() / PAPER_INCH, LEAST_PPI), MOST_PPI)

    def show_pages(self, pages: Sequence[Sheet]) -> None:
        self.pages = list(pages)
        counted = tr_n("{count} page", "{count} pages", len(pages)).format(count=len(pages))
        self.setAccessibleName(counted if pages else tr("No pages yet"))
        self._fit()
        self.update()

    def top_of(self, number: int) -> float:
        """Where a page begins, its number from 0."""
        gap = px(GAP)
        return sum(self._width() * page.height_per_width + gap for page in self.pages[:number])

    def sizeHint(self) -> QSize:
        return QSize(px(PAGE_WIDTH), round(self.top_of(self.count)))

    def resizeEvent(self, _event: object) -> None:
        self._fit()
        if self.pages and self.pages[0].width < SHARP_ENOUGH * self.ppi * PAPER_INCH:
            self._settled.start()

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        width = self._width()
        left = (self.width() - width) / 2
        for number, page in enumerate(self.pages):
            place = QRectF(left, self.top_of(number), width, width * page.height_per_width)
            if place.intersects(QRectF(self.visibleRegion().boundingRect())):
                _paint_page(painter, place, page.picture())

    def _width(self) -> float:
        return min(float(self.width()), 1.5 * px(PAGE_WIDTH))

    def _fit(self) -> None:
        self.setMinimumHeight(round(self.top_of(self.count)))


class SmallSheets(Painted):
    """A column of small pages. A click, or the arrow keys, go to one; the page that is read has a bar beside it."""

    accessible_role = QAccessible.Role.List

    requested = Signal(int)  # the number of a page, from 0

    def __init__(self) -> None:
        super().__init__()
        self._pages: list[Sheet] = []
        self.number = 0
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        self._show_message()

    def show_pages(self, pages: Sequence[Sheet]) -> None:
        self._pages = list(pages)
        self.mark(min(self.number, max(len(pages) - 1, 0)))

    def mark(self, number: int) -> None:
        """Mark the page that is read."""
        self.number = number
        self._show_message()
        self.update()

    def place_of(self, number: int) -> QRectF:
        """Where a small page is."""
        px, top, width = current_theme().px, 0.0, self._small_width()
        for page in self._pages[:number]:
            top += width * page.height_per_width + px(NUMBER + SMALL_GAP)
        return QRectF(px(8), px(2) + top, width, width * self._pages[number].height_per_width)

    def _small_width(self) -> float:
        """As wide as is usual, or as all pages still find room."""
        px, heights = current_theme().px, sum(page.height_per_width for page in self._pages)
        room = self.height() - px(4) - len(self._pages) * px(NUMBER + SMALL_GAP)
        return max(min(px(SMALL_WIDTH), room / max(heights, 1.0)), px(LEAST_WIDTH))

    def sizeHint(self) -> QSize:
        return QSize(px(SMALL_WIDTH + 16), px(SMALL_WIDTH))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        last = len(self._pages) - 1
        at = {
            Qt.Key.Key_Down: self.number + 1,
            Qt.Key.Key_Up: self.number - 1,
            Qt.Key.Key_Home: 0,
            Qt.Key.Key_End: last,
        }.get(Qt.Key(event.key()))
        if at is None or last < 0:
            super().keyPressEvent(event)
        else:
            self._go_to(min(max(at, 0), last))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        for number in range(len(self._pages)):
            if self.place_of(number).contains(event.position()):
                self._go_to(number)

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.setFont(theme.font(12))
        for number, page in enumerate(self._pages):
            place = self.place_of(number)
            small = page.small(round(place.width() * self.devicePixelRatioF()))
            _paint_page(painter, place, small)
            painter.setPen(QColor(theme.colours.ink2))
            below = QRectF(place.left(), place.bottom(), place.width(), theme.px(NUMBER))
            painter.drawText(below, Qt.AlignmentFlag.AlignCenter, str(number + 1))
            if number == self.number:
                bar = QRectF(QPointF(theme.px(1), place.top()), QPointF(theme.px(4), place.bottom()))
                painter.fillRect(bar, QColor(theme.colours.ink))
        if self.hasFocus() and self._pages:
            painter.setPen(theme.pen(theme.colours.ink, 2))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(self.place_of(self.number).adjusted(-2, -2, 2, 2))

    def _go_to(self, number: int) -> None:
        self.mark(number)
        self.requested.emit(number)

    def _show_message(self) -> None:
        self.setAccessibleName(tr("Pages"))
        stated = tr("Page {page} of {pages}").format(page=self.number + 1, pages=len(self._pages))
        self.setAccessibleDescription(stated if self._pages else "")


def _paint_page(painter: QPainter, place: QRectF, picture: QImage) -> None:
    """A page with its edge."""
    painter.drawImage(place, picture)
    painter.setPen(current_theme().pen(current_theme().colours.control, 1))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawRect(place.adjusted(0.5, 0.5, -0.5, -0.5))

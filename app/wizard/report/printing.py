"""The report's pages on a printer, as they are shown."""

from collections.abc import Sequence

from PySide6.QtCore import QMarginsF, QObject, QRectF, Qt, Signal
from PySide6.QtGui import QImage, QPageLayout, QPageSize, QPainter
from PySide6.QtPrintSupport import QPrintDialog, QPrinter
from PySide6.QtWidgets import QWidget

PRINTED_PPI = 300.0
PAGE_SIZES = {"a4": QPageSize.PageSizeId.A4, "letter": QPageSize.PageSizeId.Letter}


class ReportPrinter(QObject):
    """`confirmed` is emitted once somebody has chosen a printer; `put` then puts the pages of `document` on it."""

    confirmed = Signal()

    def __init__(self, window: QWidget, title: str, document: str) -> None:
        super().__init__(window)
        self._window, self._title, self.document = window, title, document
        self._printer: QPrinter | None = None
        self.dialog: QPrintDialog | None = None

    def ask(self, name: str, paper: str) -> None:
        """Ask for a printer; `name` is the document's."""
        self._printer = make_printer(name, paper)
        self.dialog = QPrintDialog(self._printer, self._window)
        self.dialog.setWindowTitle(self._title)
        self.dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.dialog.setWindowModality(Qt.WindowModality.WindowModal)
        self.dialog.accepted.connect(self.confirmed)
        self.dialog.show()

    def put(self, pages: Sequence[bytes]) -> bool:
        """Put pages, each a PNG, on the printer that was chosen; whether it took them."""
        printer, self._printer = self._printer, None
        return printer is not None and paint_pages(printer, pages)


def make_printer(name: str, paper: str) -> QPrinter:
    """A printer of whole pages: their margins are in the pictures."""
    printer = QPrinter(QPrinter.PrinterMode.HighResolution)
    printer.setDocName(name)
    printer.setPageSize(QPageSize(PAGE_SIZES[paper]))
    printer.setFullPage(True)
    printer.setPageMargins(QMarginsF(0, 0, 0, 0), QPageLayout.Unit.Millimeter)
    return printer


def paint_pages(printer: QPrinter, pages: Sequence[bytes]) -> bool:
    """Paint each page over a whole sheet; False where the printer could not begin."""
    painter = QPainter()
    if not painter.begin(printer):
        return False
    for number, png in enumerate(pages):
        if number:
            printer.newPage()
        picture = QImage.fromData(png)
        sheet = QRectF(painter.viewport())
        size = picture.size().scaled(sheet.size().toSize(), Qt.AspectRatioMode.KeepAspectRatio)
        painter.drawImage(QRectF(0.0, 0.0, size.width(), size.height()), picture)
    return painter.end()

"""The report on a printer: every page over a whole sheet, in order, and the audit reports it."""

from pathlib import Path

import pypdf
import pytest
from PySide6.QtGui import QImage
from PySide6.QtPrintSupport import QPrinter
from pytestqt.qtbot import QtBot

from app.wizard.report.printing import make_printer, paint_pages
from tests.app.wizard.report.test_page import png


@pytest.mark.parametrize(("paper", "width_pt"), [("a4", 595), ("letter", 612)])
def test_each_page_takes_a_whole_sheet(qtbot: QtBot, tmp_path: Path, paper: str, width_pt: float) -> None:
    printer = make_printer("P-1_2026-11-23", paper)
    out = tmp_path / "printed.pdf"
    printer.setOutputFormat(QPrinter.OutputFormat.PdfFormat)
    printer.setOutputFileName(str(out))
    assert paint_pages(printer, [png(72), png(72), png(72)])
    pages = pypdf.PdfReader(out).pages
    assert len(pages) == 3
    assert float(pages[0].mediabox.width) == pytest.approx(width_pt, abs=1)
    (picture,) = pages[0].images
    assert picture.image is not None
    assert min(picture.image.size) == QImage.fromData(png(72)).width()


@pytest.mark.qt_log_ignore(".*QPainter::begin")
def test_a_printer_that_cannot_begin_is_reported_of(qtbot: QtBot, tmp_path: Path) -> None:
    printer = make_printer("P-1", "a4")
    printer.setOutputFormat(QPrinter.OutputFormat.PdfFormat)
    printer.setOutputFileName(str(tmp_path / "nowhere" / "printed.pdf"))
    assert not paint_pages(printer, [png(72)])

"""A page of results that all tests of a module share: it takes longer to make than to show another visit."""

from collections.abc import Iterator

import pytest
from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication

from app.results.result_page import ResultPage


@pytest.fixture(scope="module")
def shared_page(qapp: QApplication) -> Iterator[ResultPage]:
    """Each test begins by showing what it is about; what no `show` undoes is done to a `result_page` of its own."""
    page = ResultPage()
    yield page
    page.close()
    page.deleteLater()
    qapp.sendPostedEvents(None, QEvent.Type.DeferredDelete)  # now: at the end of the run nothing would

"""A page of results that all tests of a module share: it takes longer to make than to show another visit."""

from collections.abc import Iterator

import pytest
from PySide6.QtWidgets import QApplication

from app.results.result_page import ResultPage
from tests.app.shared_page import shared


@pytest.fixture(scope="module")
def shared_page(qapp: QApplication) -> Iterator[ResultPage]:
    """Each test begins by showing what it is about; what no `show` undoes is done to a `result_page` of its own."""
    yield from shared(ResultPage())

"""A page that all tests of a module share."""

from collections.abc import Iterator
from typing import TypeVar

from PySide6.QtCore import QCoreApplication, QEvent
from PySide6.QtWidgets import QWidget

Page = TypeVar("Page", bound=QWidget)


def shared(page: Page) -> Iterator[Page]:
    """Give it, and delete it at once after the last test: at the end of the run nothing would."""
    yield page
    page.close()
    page.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)

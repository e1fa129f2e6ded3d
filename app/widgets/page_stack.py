"""Stack of pages in one place; only the page in sight asks for room."""

from PySide6.QtCore import QSize
from PySide6.QtWidgets import QStackedWidget


class PageStack(QStackedWidget):
    """As large as the page in sight needs to be, not as the largest."""

    def minimumSizeHint(self) -> QSize:
        page = self.currentWidget()
        return page.minimumSizeHint() if page is not None else QSize()

    def sizeHint(self) -> QSize:
        page = self.currentWidget()
        return page.sizeHint() if page is not None else QSize()

    def heightForWidth(self, width: int) -> int:  # noqa: N802  Qt asks it
        """Give what the page in sight needs at least; Qt's own is what the highest of all pages would like."""
        page = self.currentWidget()
        if page is None:
            return 0
        if isinstance(page, PageStack):
            return page.heightForWidth(width)
        layout = page.layout()
        wrapped = layout.minimumHeightForWidth(width) if layout is not None and layout.hasHeightForWidth() else 0
        return max(wrapped, page.minimumSizeHint().height())

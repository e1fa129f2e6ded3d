"""The report, or what is in its place."""

from PySide6.QtWidgets import QStackedWidget

from app.widgets.sentence_page import SentencePage
from app.wizard.report.page import ReportPage


class ReportFrame(QStackedWidget):
    """The report, or what is in its place."""

    def __init__(self) -> None:
        super().__init__()
        self.sentence = SentencePage()
        self.report = ReportPage()
        for page in (self.sentence, self.report):
            self.addWidget(page)

    def set_room(self, width: float, height: float) -> None:
        self.report.set_room(width, height)

    def focus(self) -> None:
        if self.currentWidget() is self.report:
            self.report.focus()

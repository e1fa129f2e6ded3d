"""Differences between the angles of a session and those of an optical system. The pages that are saved, to be read."""

from collections.abc import Sequence

from PySide6.QtWidgets import QHBoxLayout, QStackedWidget, QVBoxLayout, QWidget

from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import ReadingArea
from app.widgets.sentence_page import SentencePage
from app.widgets.sheets import Sheet, Sheets
from app.widgets.text import Text
from app.wording.translation import joined, later, tr

KINDS = later(
    "Accepted files: CSV with time_s and left_knee, left_ankle, right_knee, right_ankle in "
    "degrees, OpenSim .mot, C3D or Visual3D text. Gaitwright detects time offset and signs from "
    "the movement."
)


class AgreementPage(QWidget):
    """It is computed elsewhere; `choose` and `waiting` ask for files of an optical system."""

    def __init__(self) -> None:
        super().__init__()
        self.back = Button(tr("Back to the results"), ButtonKind.SECONDARY, Icon.BACK)
        self.choose = Button(tr("Choose reference file"), ButtonKind.SECONDARY, Icon.FOLDER)
        self.save = Button(tr("Save PDF and CSV"), ButtonKind.SECONDARY, Icon.FOLDER)
        self.note = Text(tone="ink2", wraps=True)
        self.waiting = SentencePage()
        self.sheets = Sheets()
        self.reading = ReadingArea(self.sheets, tr("Agreement report"))
        self._stack = QStackedWidget()
        for page in (self.waiting, self.reading):
            self._stack.addWidget(page)
        head = lay_out(QHBoxLayout(), self.back, (self.note, 1), self.choose, self.save, spacing=12)
        lay_out(QVBoxLayout(self), head, (self._stack, 1), margins=(24, 16, 24, 12), spacing=12)
        self.show_nothing()

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.back, self.choose, self.save, self.waiting.button, self.reading]

    def focus(self) -> None:
        (self.waiting.button if self.waiting.button.isVisibleTo(self) else self.back).setFocus()

    def show_nothing(self) -> None:
        """Ask for what the optical system measured."""
        self._say(tr("Choose the optical system's file"), tr(KINDS), tr("Choose reference file"))

    def show_working(self, names: Sequence[str]) -> None:
        self._say(tr("Searching {files} for the recorded walks.").format(files=joined(list(names))), "", "")

    def show_refused(self, what: str, remedy: str) -> None:
        self._say(what, remedy, tr("Choose another file"))

    def show_pages(self, pages: Sequence[bytes], left_over: Sequence[str]) -> None:
        """Show pages, each a PNG; `left_over` are walks and trials that found no partner."""
        stated = tr("Not compared, no matching recording: {names}.").format(names=", ".join(left_over))
        self.note.setText(stated if left_over else "")
        self.sheets.show_pages([Sheet(page) for page in pages])
        self.choose.show()
        self.save.show()
        self.reading.verticalScrollBar().setValue(0)
        self._stack.setCurrentWidget(self.reading)
        self.reading.setFocus()

    def show_sharper(self, pages: Sequence[bytes]) -> None:
        """Show the same pages drawn finer, where they are being read."""
        self.sheets.show_pages([Sheet(page) for page in pages])

    def show_saved(self, folder: str) -> None:
        self.note.setText(tr("Saved in {folder}.").format(folder=folder))

    def _say(self, what: str, then: str, button: str) -> None:
        """Say a sentence in the place of pages; nothing of another agreement stays in sight."""
        self.note.setText("")
        self.choose.hide()
        self.save.hide()
        self.sheets.show_pages([])
        self.waiting.show_sentence(what, then, button)
        self._stack.setCurrentWidget(self.waiting)

"""Both versions of what two stations changed, side by side, to choose whose is to hold."""

import datetime
from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import QBoxLayout, QButtonGroup, QDialog, QHBoxLayout, QVBoxLayout, QWidget

from app.editing.question import EditQuestion
from app.editing.words import by_words, field_word, value_words
from app.storage.three_way import MergeConflict
from app.theme.current import on_theme, px
from app.theme.ground import Ground, set_ground
from app.widgets.button import Button, ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import scrolled
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.widgets.version_cell import VersionCell
from app.wording.translation import tr

WIDTH, EDGE = 720, 24
STACKED_BELOW = 520  # px of the design: below it yours is over theirs
LOW_BELOW = 420  # of the window: below it what is asked has the room of what explains it
MINE, THEIRS = 0, 1


class EditDialog(QDialog):
    """Nothing is chosen to begin with, so that Enter pressed a moment too late decides nothing.

    `settled`: the fields of which our own value is to hold, a frozenset; closed with Escape, there are none.
    """

    settled = Signal(object)

    def __init__(
        self,
        question: EditQuestion,
        parent: QWidget,
        now: Callable[[], datetime.datetime] = datetime.datetime.now,
    ) -> None:
        super().__init__(parent)
        self._question, self._parent = question, parent
        self.setWindowTitle(tr("Someone else has changed this in the meantime"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._title = Text(tr("Someone else has changed this in the meantime"), size=20, weight=SEMIBOLD, wraps=True)
        self._lead = Text(
            tr(
                "{subject}: this was changed here and on another workstation. Choose the values to keep. The "
                "others stay in the history."
            ).format(subject=question.subject),
            tone="ink2",
            wraps=True,
        )
        self._table = QWidget()
        self._scroll = scrolled(self._table)
        self._note = Text(tr("Choose a value in each line with the arrow keys."), tone="ink2", wraps=True)
        self.save = Button(tr("Save choice"), ButtonKind.PRIMARY, key=tr("Enter"))
        self.leave = Button(tr("Keep theirs"), ButtonKind.SECONDARY, key=tr("Esc"))
        self._pairs: list[QBoxLayout] = []
        self.cells = [self._row(contest, now().astimezone()) for contest in question.contests]
        self._build()
        self.save.clicked.connect(self._on_save_clicked)
        self.leave.clicked.connect(self.reject)
        self.rejected.connect(self._on_rejected)
        self._follow()
        on_theme(self._fit)
        self.cells[0][MINE].setFocus()

    @property
    def chosen(self) -> frozenset[str] | None:
        """The fields of which our own is chosen; None while a line is left to choose in."""
        if not all(mine.isChecked() or theirs.isChecked() for mine, theirs in self.cells):
            return None
        lines = zip(self._question.contests, self.cells, strict=True)
        return frozenset(contest.field for contest, (mine, _) in lines if mine.isChecked())

    def sizeHint(self) -> QSize:
        return self.size()

    def _row(self, contest: MergeConflict, now: datetime.datetime) -> tuple[VersionCell, VersionCell]:
        field = field_word(contest.field)
        whose = tr("Theirs: {who}").format(who=by_words(contest.by, contest.at, now))
        mine = VersionCell(field, value_words(contest.field, contest.mine), tr("Yours"))
        theirs = VersionCell(field, value_words(contest.field, contest.theirs), whose)
        group = QButtonGroup(self)
        for column, cell in enumerate((mine, theirs)):
            group.addButton(cell)
            cell.toggled.connect(self._follow)
            cell.confirmed.connect(self._on_confirmed)
            cell.moved.connect(partial(self._on_moved, len(self._pairs), column))
        self._pairs.append(QBoxLayout(QBoxLayout.Direction.LeftToRight))
        return mine, theirs

    def _build(self) -> None:
        rows = QVBoxLayout(self._table)
        for contest, pair, cells in zip(self._question.contests, self._pairs, self.cells, strict=True):
            lay_out(pair, *((cell, 1) for cell in cells), spacing=8)
            lay_out(rows, Text(field_word(contest.field), weight=MEDIUM, wraps=True), pair)
        lay_out(rows, 1, margins=0, spacing=8)
        self._scroll.setAccessibleName(tr("Conflicting changes"))
        buttons = lay_out(QHBoxLayout(), (self._note, 1), self.leave, self.save)
        column = lay_out(QVBoxLayout(self), self._title, self._lead, (self._scroll, 1), buttons)
        lay_out(column, margins=(EDGE, 20, EDGE, 20), spacing=12)
        set_ground(self, Ground("surface", radius=0, inset=0))

    def _fit(self) -> None:
        """Be as large as the window allows, and no larger than needed; where it is narrow, stack the two versions."""
        window = self._parent.window().size()
        width = min(px(WIDTH), window.width() - px(EDGE))
        inside = width - 2 * px(EDGE)
        self._lead.setVisible(window.height() >= px(LOW_BELOW))
        for button, key in ((self.save, tr("Enter")), (self.leave, tr("Esc"))):
            button.set_face(key=key if inside >= px(STACKED_BELOW) else "")
        is_stacked = inside < px(STACKED_BELOW)
        direction = QBoxLayout.Direction.TopToBottom if is_stacked else QBoxLayout.Direction.LeftToRight
        for pair in self._pairs:
            pair.setDirection(direction)
        rows, column = self._table.layout(), self.layout()
        assert rows is not None
        assert column is not None
        around = column.totalHeightForWidth(width) - self._scroll.sizeHint().height()
        self.resize(width, min(around + rows.totalHeightForWidth(inside) + px(2), window.height() - px(EDGE)))

    def _follow(self) -> None:
        is_whole = self.chosen is not None
        self.save.setEnabled(is_whole)
        self._note.setText("" if is_whole else tr("Choose a value in each line with the arrow keys."))

    def _on_moved(self, row: int, column: int, right: int, down: int) -> None:
        """Left and right choose, up and down go to another line."""
        if right:
            cell = self.cells[row][THEIRS if right > 0 else MINE]
            cell.setChecked(True)
        else:
            mine, theirs = self.cells[min(max(row + down, 0), len(self.cells) - 1)]
            cell = theirs if theirs.isChecked() or (column == THEIRS and not mine.isChecked()) else mine
        cell.setFocus()
        self._scroll.ensureWidgetVisible(cell)

    def _on_confirmed(self) -> None:
        """Save if all is chosen, else go to the first line where it is not."""
        if self.chosen is not None:
            self._on_save_clicked()
            return
        mine = next(mine for mine, theirs in self.cells if not (mine.isChecked() or theirs.isChecked()))
        mine.setFocus()
        self._scroll.ensureWidgetVisible(mine)

    def _on_save_clicked(self) -> None:
        if (chosen := self.chosen) is not None:
            self.accept()
            self.settled.emit(chosen)

    def _on_rejected(self) -> None:
        self.settled.emit(frozenset())

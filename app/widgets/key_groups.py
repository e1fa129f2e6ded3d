"""A recovery key as it is copied by hand: its groups in even columns, and selected, copied and read out as one text."""

from collections.abc import Sequence

from PySide6.QtCore import QMimeData, QSize, Qt
from PySide6.QtGui import QColor, QPalette, QTextBlockFormat, QTextOption
from PySide6.QtWidgets import QFrame, QSizePolicy, QTextEdit

from app.theme.current import current_theme, on_theme, px
from app.widgets.text import SEMIBOLD

COLUMNS = 3
WIDTH = 96  # px of a column: four of the widest letters, and room before the next
SIZE = 20
ROW = 34  # px from one row to the next


class KeyGroups(QTextEdit):
    """`text` is what is shown, a line for each row; what is copied of it is written as on the sheet, in one line.

    No button copies it: it is to be kept away from this computer, and every program reads a clipboard. Who selects it
    and copies means to.
    """

    def __init__(self) -> None:
        super().__init__()
        self._groups: list[str] = []
        self.setReadOnly(True)
        self.setUndoRedoEnabled(False)  # nothing of a key stays where it is taken away
        self.setTextInteractionFlags(
            Qt.TextInteractionFlag.TextSelectableByMouse | Qt.TextInteractionFlag.TextSelectableByKeyboard
        )
        self.setTabChangesFocus(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWordWrapMode(QTextOption.WrapMode.NoWrap)
        for set_policy in (self.setHorizontalScrollBarPolicy, self.setVerticalScrollBarPolicy):
            set_policy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.MinimumExpanding, QSizePolicy.Policy.Fixed)
        self.document().setDocumentMargin(0)
        self.viewport().setAutoFillBackground(False)
        on_theme(self._apply_theme)

    @property
    def text(self) -> str:
        return "\n".join(" ".join(row) for row in self._rows)

    def show_groups(self, groups: Sequence[str]) -> None:
        """Show these; none: nothing of a key stays."""
        self._groups = list(groups)
        self._write()
        self.setAccessibleName(" ".join(groups))

    def createMimeDataFromSelection(self) -> QMimeData:  # noqa: N802  Qt calls it
        """Give what is selected as the sheet has it, so that it is whole wherever it is put: a field has one line."""
        copied = QMimeData()
        copied.setText("-".join(self.textCursor().selectedText().split()))
        return copied

    def sizeHint(self) -> QSize:
        return QSize(px(COLUMNS * WIDTH), px(ROW) * len(self._rows))

    @property
    def _rows(self) -> list[list[str]]:
        return [self._groups[k : k + COLUMNS] for k in range(0, len(self._groups), COLUMNS)]

    def _write(self) -> None:
        self.setPlainText("\n".join("\t".join(row) for row in self._rows))
        cursor = self.textCursor()
        cursor.select(cursor.SelectionType.Document)
        form = cursor.blockFormat()
        form.setLineHeight(px(ROW), QTextBlockFormat.LineHeightTypes.FixedHeight.value)
        cursor.setBlockFormat(form)
        self.updateGeometry()

    def _apply_theme(self) -> None:
        theme = current_theme()
        self.setFont(theme.font(SIZE, SEMIBOLD, is_code=True))
        self.setTabStopDistance(theme.px(WIDTH))
        palette = self.palette()
        palette.setColor(QPalette.ColorRole.Text, QColor(theme.colours.ink))
        self.setPalette(palette)
        self._write()

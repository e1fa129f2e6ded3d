"""A recovery key as it is copied by hand: its groups in even columns, and told as one text."""

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout

from app.theme import ThemeNotifier
from app.widgets.text import SEMIBOLD, Text
from app.widgets.themed import Themed

COLUMNS = 3
WIDTH = 96  # px of a column: four of the widest letters, and room before the next
SIZE = 20


class KeyGroups(Themed):
    """`text` is what is shown, a line for each row."""

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self._texts: list[Text] = []
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setColumnStretch(COLUMNS, 1)
        self._on_look_changed()

    @property
    def text(self) -> str:
        groups = [one.text() for one in self._texts]
        return "\n".join(" ".join(groups[k : k + COLUMNS]) for k in range(0, len(groups), COLUMNS))

    def show_groups(self, groups: Sequence[str]) -> None:
        """Show these; none: nothing of a key stays."""
        for one in self._texts:
            one.setText("")
            self._grid.removeWidget(one)
            one.deleteLater()
        self._texts = [Text(self._look, group, size=SIZE, weight=SEMIBOLD, is_code=True) for group in groups]
        for number, one in enumerate(self._texts):
            one.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
            self._grid.addWidget(one, number // COLUMNS, number % COLUMNS)
        self.setAccessibleName(self.text.replace("\n", " "))

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        for column in range(COLUMNS):
            self._grid.setColumnMinimumWidth(column, px(WIDTH))
        self._grid.setHorizontalSpacing(0)
        self._grid.setVerticalSpacing(px(6))

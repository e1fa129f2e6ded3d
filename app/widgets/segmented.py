"""One choice out of a few, all of them in sight. Arrows move, and each states in a second line what it does."""

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QAbstractButton, QButtonGroup, QHBoxLayout, QSizePolicy, QWidget

from app.theme.ground import Ground, set_ground
from app.widgets.button import Button, ButtonKind

HEIGHT = 52
PLAIN_HEIGHT = 48  # without second lines, as high as a field


class Segmented(QWidget):
    """`options` are key, word and second line of each choice; the first is chosen to begin with."""

    accessible_role = QAccessible.Role.Grouping

    chosen = Signal(str)

    def __init__(self, name: str, options: Sequence[tuple[str, str, str]]) -> None:
        super().__init__()
        self.setAccessibleName(name)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        set_ground(self, Ground("sunken", "line"))
        self._group = QButtonGroup(self)
        height = HEIGHT if any(note for _, _, note in options) else PLAIN_HEIGHT
        self._segments = {key: _Segment(word, note, height, self) for key, word, note in options}
        row = QHBoxLayout(self)
        row.setContentsMargins(2, 2, 2, 2)
        row.setSpacing(0)
        for segment in self._segments.values():
            self._group.addButton(segment)
            row.addWidget(segment, 1)
        next(iter(self._segments.values())).setChecked(True)
        self._group.buttonToggled.connect(self._on_button_toggled)

    @property
    def segments(self) -> list[QAbstractButton]:
        """The choices in the order of reading."""
        return list(self._segments.values())

    @property
    def choice(self) -> str:
        return next(key for key, segment in self._segments.items() if segment.isChecked())

    def focus(self) -> None:
        """Give the focus to the choice in force."""
        self._segments[self.choice].setFocus()

    def choose(self, key: str) -> None:
        self._segments[key].setChecked(True)

    def set_reason(self, key: str, reason: str) -> None:
        """Switch a choice off and say why in its second line; an empty reason switches it on again."""
        self._segments[key].set_reason(reason)
        self._leave(key, bool(reason))

    def set_offered(self, key: str, is_offered: bool) -> None:
        """Take a choice away where it means nothing, or bring it back."""
        self._segments[key].setVisible(is_offered)
        self._leave(key, not is_offered)

    def set_word(self, key: str, word: str) -> None:
        self._segments[key].set_word(word)

    def set_brief(self, is_brief: bool) -> None:
        """Leave the second lines to readers of screens, where there is no room for them; reasons are still shown."""
        for segment in self._segments.values():
            segment.set_brief(is_brief)

    def _leave(self, key: str, must_leave: bool) -> None:
        """Go to the first choice that can be chosen, if `key` was chosen and no longer can be."""
        if must_leave and self.choice == key:
            open_to = (one for one in self._segments.values() if one.isEnabled() and not one.isHidden())
            next(open_to).setChecked(True)

    def _on_button_toggled(self, button: QAbstractButton, is_checked: bool) -> None:
        if is_checked:
            self.chosen.emit(next(key for key, segment in self._segments.items() if segment is button))


class _Segment(Button):
    def __init__(self, word: str, note: str, height: float, parent: QWidget) -> None:
        super().__init__(word, ButtonKind.SEGMENT, height=height, parent=parent)
        self._note, self._reason, self._is_brief = note, "", False
        self.setCheckable(True)
        self.setAutoExclusive(True)
        self._show_message()

    def set_word(self, word: str) -> None:
        self.setText(word)
        self._show_message()

    def set_brief(self, is_brief: bool) -> None:
        self._is_brief = is_brief
        self._show_message()

    def set_reason(self, reason: str) -> None:
        self._reason = reason
        self.setEnabled(not reason)
        self._show_message()

    def _show_message(self) -> None:
        self.set_face(note=self._reason or ("" if self._is_brief else self._note))
        self.setAccessibleName(", ".join(filter(None, [self.text(), self._reason or self._note])))

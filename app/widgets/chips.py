"""As many out of a few as apply: a word each, a check before those that do. Arrows move, the space bar turns."""

from collections.abc import Iterable, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QAbstractButton, QWidget

from app.theme.current import on_theme
from app.widgets.button import ButtonKind
from app.widgets.wrapping import WrappedButton, Wrapping

HEIGHT = 44


class Chips(Wrapping):
    """`options` are key and word of each; they wrap into as many lines as they need.

    Parameters
    ----------
    rivals
        Two keys that exclude each other: turning one on turns the other off.
    """

    accessible_role = QAccessible.Role.Grouping

    turned = Signal()  # by the user

    def __init__(self, name: str, options: Iterable[tuple[str, str]], rivals: tuple[str, str] | None = None) -> None:
        super().__init__(HEIGHT)
        self._rivals = rivals
        self._chips: dict[str, WrappedButton] = {}
        self.setAccessibleName(name)
        for key, word in options:
            self._add(key, word)
        self._let_tab_reach(self.buttons[0])
        on_theme(self.arrange)

    @property
    def chosen(self) -> tuple[str, ...]:
        """The keys that are on, in the order of reading."""
        return tuple(key for key, chip in self._chips.items() if chip.isChecked())

    @property
    def buttons(self) -> list[QAbstractButton]:
        return list(self._chips.values())

    def parts(self) -> list[QAbstractButton]:
        return self.buttons

    def choose(self, keys: Sequence[str]) -> None:
        """Turn exactly these on; one that is not among the options becomes one, in its own word."""
        for key in keys:
            if key not in self._chips:
                self._add(key, key)
        for key, chip in self._chips.items():
            chip.setChecked(key in keys)
        self.arrange()

    def step(self, part: QWidget, by: int) -> None:
        chips: list[QWidget] = [*self._chips.values()]
        to = self.buttons[(chips.index(part) + by) % len(chips)]
        self._let_tab_reach(to)
        to.setFocus(Qt.FocusReason.TabFocusReason)

    def _add(self, key: str, word: str) -> None:
        chip = WrappedButton(word, ButtonKind.CHIP, HEIGHT, self)
        chip.clicked.connect(self._on_clicked)
        chip.show()
        self._chips[key] = chip

    def _let_tab_reach(self, chip: QAbstractButton) -> None:
        """Let the group be one stop of the tabulator, where it was left."""
        for other in self._chips.values():
            other.setFocusPolicy(Qt.FocusPolicy.StrongFocus if other is chip else Qt.FocusPolicy.ClickFocus)

    def _on_clicked(self) -> None:
        clicked = self.sender()
        assert isinstance(clicked, WrappedButton)
        self._let_tab_reach(clicked)
        key = next(key for key, chip in self._chips.items() if chip is clicked)
        if self._rivals and key in self._rivals and clicked.isChecked():
            other = self._rivals[1] if key == self._rivals[0] else self._rivals[0]
            self._chips[other].setChecked(False)
        self.arrange()
        self.turned.emit()

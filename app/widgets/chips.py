"""As many out of a few as apply: a word each, a check before those that do. Arrows move, the space bar turns."""

from collections.abc import Iterable, Sequence

from PySide6.QtCore import QRect, QSize, Qt, Signal
from PySide6.QtGui import QAccessible, QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QAbstractButton, QSizePolicy, QWidget

from app.theme.current import on_theme, px
from app.widgets.button import Button, ButtonKind

HEIGHT = 44
GAP = 8
STEPS = {Qt.Key.Key_Right: 1, Qt.Key.Key_Down: 1, Qt.Key.Key_Left: -1, Qt.Key.Key_Up: -1}


class Chips(QWidget):
    """`options` are key and word of each; they wrap into as many lines as they need.

    Parameters
    ----------
    rivals
        Two keys that exclude each other: turning one on turns the other off.
    """

    accessible_role = QAccessible.Role.Grouping

    turned = Signal()  # by the user

    def __init__(self, name: str, options: Iterable[tuple[str, str]], rivals: tuple[str, str] | None = None) -> None:
        super().__init__()
        self._rivals = rivals
        self._chips: dict[str, _Chip] = {}
        self.setAccessibleName(name)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        for key, word in options:
            self._add(key, word)
        self._let_tab_reach(self.buttons[0])
        on_theme(self._arrange)

    @property
    def chosen(self) -> tuple[str, ...]:
        """The keys that are on, in the order of reading."""
        return tuple(key for key, chip in self._chips.items() if chip.isChecked())

    @property
    def buttons(self) -> list[QAbstractButton]:
        return list(self._chips.values())

    def choose(self, keys: Sequence[str]) -> None:
        """Turn exactly these on; one that is not among the options becomes one, in its own word."""
        for key in keys:
            if key not in self._chips:
                self._add(key, key)
        for key, chip in self._chips.items():
            chip.setChecked(key in keys)
        self._arrange()

    def sizeHint(self) -> QSize:
        width = max(self.width(), self.minimumSizeHint().width())
        return QSize(width, self._height_for(width))

    def minimumSizeHint(self) -> QSize:
        return QSize(max(chip.sizeHint().width() for chip in self._chips.values()), px(HEIGHT))

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._arrange()

    def step(self, chip: "_Chip", by: int) -> None:
        """Go on to the chip before or after, and round at the end."""
        chips = list(self._chips.values())
        to = chips[(chips.index(chip) + by) % len(chips)]
        self._let_tab_reach(to)
        to.setFocus(Qt.FocusReason.TabFocusReason)

    def _add(self, key: str, word: str) -> None:
        chip = _Chip(word, self)
        chip.clicked.connect(self._on_clicked)
        chip.show()
        self._chips[key] = chip

    def _let_tab_reach(self, chip: QAbstractButton) -> None:
        """Let the group be one stop of the tabulator, where it was left."""
        for other in self._chips.values():
            other.setFocusPolicy(Qt.FocusPolicy.StrongFocus if other is chip else Qt.FocusPolicy.ClickFocus)

    def _flow(self, width: int) -> list[QRect]:
        """Where each chip lies in lines of `width`."""
        return flow([chip.sizeHint().width() for chip in self._chips.values()], width, px(GAP), px(HEIGHT))

    def _height_for(self, width: int) -> int:
        return self._flow(width)[-1].bottom() + 1

    def _arrange(self) -> None:
        for chip, place in zip(self._chips.values(), self._flow(self.width()), strict=True):
            chip.setGeometry(place)
        self.setFixedHeight(self._height_for(self.width()))  # layouts in a scroll area ask for no height of a width
        self.updateGeometry()

    def _on_clicked(self) -> None:
        clicked = self.sender()
        assert isinstance(clicked, _Chip)
        self._let_tab_reach(clicked)
        key = next(key for key, chip in self._chips.items() if chip is clicked)
        if self._rivals and key in self._rivals and clicked.isChecked():
            other = self._rivals[1] if key == self._rivals[0] else self._rivals[0]
            self._chips[other].setChecked(False)
        self._arrange()
        self.turned.emit()


def flow(required: Iterable[int], width: int, gap: int, height: int) -> list[QRect]:
    """Where boxes as wide as `required` lie, in lines of `width`; all in pixels."""
    places: list[QRect] = []
    x = y = 0
    for box in required:
        if x and x + box > width:
            x, y = 0, y + height + gap
        places.append(QRect(x, y, box, height))
        x += box + gap
    return places


class _Chip(Button):
    def __init__(self, word: str, group: Chips) -> None:
        super().__init__(word, ButtonKind.CHIP, height=HEIGHT, parent=group)
        self._group = group
        self.setCheckable(True)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        by = STEPS.get(Qt.Key(event.key()))
        if by is None:
            super().keyPressEvent(event)
            return
        self._group.step(self, by)

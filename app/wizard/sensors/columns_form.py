"""Form for the meaning of each column of a sensor that sends lines of numbers.

It is given beside what the sensor sends at the moment.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QBoxLayout, QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.theme.current import px, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr

PADDING = 24
MOST_COLUMNS = 40  # as rows; who sends more sends something else


class Meaning(StrEnum):
    UNUSED = ""
    TIME = "time"
    RATE_X = "rate x"
    RATE_Y = "rate y"
    RATE_Z = "rate z"
    FORCE_X = "force x"
    FORCE_Y = "force y"
    FORCE_Z = "force z"


AXES = tuple(meaning for meaning in Meaning if meaning not in (Meaning.UNUSED, Meaning.TIME))


@dataclass(frozen=True, slots=True)
class ColumnsReported:
    """What is chosen: a meaning for each column, those that are turned round, and units by their names in `UNITS`."""

    meanings: tuple[Meaning, ...]
    turned: frozenset[int] = frozenset()
    time_unit: str = "ms"
    wraps_bits: int = 0
    rate_unit: str = "deg/s"
    force_unit: str = "g"

    @property
    def is_whole(self) -> bool:
        """Whether every meaning but `UNUSED` is entered once."""
        return sorted(meaning for meaning in self.meanings if meaning) == sorted(
            meaning for meaning in Meaning if meaning
        )


class ColumnsForm(QWidget):
    """What each column of an unknown text stream means."""

    changed = Signal()  # something else is entered

    def __init__(self) -> None:
        super().__init__()
        self._where = Text(size=14, tone="ink2", wraps=True)
        self._room = 0
        self.meanings: list[Choice] = []
        self._numbers: list[Text] = []
        self._values: list[Text] = []
        self.time = self._choice(
            tr("Time unit"),
            {
                "s": tr("seconds"),
                "ms": tr("milliseconds"),
                "us": tr("microseconds"),
            },
        )
        self.wraps = self._choice(
            tr("Time restarts"),
            {
                "0": tr("never"),
                "16": tr("after 16 bits"),
                "24": tr("after 24 bits"),
                "32": tr("after 32 bits"),
            },
        )
        self.rate = self._choice(tr("Angular rate in"), {"deg/s": "deg/s", "rad/s": "rad/s", "mdeg/s": "mdeg/s"})
        self.force = self._choice(tr("Acceleration in"), {"g": "g", "m/s2": "m/s²", "mg": "mg"})
        self.notice = Notice(size=16)
        self.back = Button(tr("Other sources"), ButtonKind.QUIET)
        self._build()

    @property
    def reported(self) -> ColumnsReported:
        chosen = [str(choice.currentData()) for choice in self.meanings]
        return ColumnsReported(
            meanings=tuple(Meaning(one.removeprefix("-")) for one in chosen),
            turned=frozenset(number for number, one in enumerate(chosen) if one.startswith("-")),
            time_unit=str(self.time.currentData()),
            wraps_bits=int(self.wraps.currentData()),
            rate_unit=str(self.rate.currentData()),
            force_unit=str(self.force.currentData()),
        )

    @property
    def tab_order(self) -> list[QWidget]:
        return [*self.meanings, self.time, self.wraps, self.rate, self.force, self.back]

    def focus(self) -> None:
        (self.meanings[0] if self.meanings else self.back).setFocus()

    def show_places(self, places: Sequence[str]) -> None:
        """Say at which ports these lines arrive."""
        self._where.setText(tr("Text lines (CSV) at {places}").format(places=", ".join(places)))

    def show_reported(self, reported: ColumnsReported) -> None:
        """Show what is known or guessed; the user's changes follow as `changed`."""
        self._set_count(len(reported.meanings))
        for number, (choice, meaning) in enumerate(zip(self.meanings, reported.meanings, strict=True)):
            _choose(choice, f"-{meaning}" if number in reported.turned else str(meaning))
        for choice, key in (
            (self.time, reported.time_unit),
            (self.wraps, str(reported.wraps_bits)),
            (self.rate, reported.rate_unit),
            (self.force, reported.force_unit),
        ):
            _choose(choice, key)

    def show_values(self, values: Sequence[str]) -> None:
        """Show what each column contains now; four times a second is enough."""
        for shown, value in zip(self._values, values, strict=False):
            if shown.text() != value:
                shown.setText(value)

    def set_room(self, width: int) -> None:
        """Lay columns and units side by side while both have room."""
        self._room = width
        self._fit()

    def show_message(self, what: str, then: str = "", is_right: bool = False) -> None:
        """Say whether the numbers can be so."""
        icon = Icon.CHECK if is_right else Icon.WARNING
        self.notice.show_message(icon if what else None, what, then, is_caution=bool(what) and not is_right)

    def _choice(self, label: str, options: dict[str, str]) -> Choice:
        choice = Choice(label)
        choice.offer(((words, key) for key, words in options.items()), chosen=None)
        choice.activated.connect(self.changed)
        return choice

    def _set_count(self, count: int) -> None:
        """Lay out a row for each column."""
        count = min(count, MOST_COLUMNS)
        if count == len(self.meanings):
            return
        for widget in (*self._numbers, *self._values, *self.meanings):
            self._grid.removeWidget(widget)
            widget.deleteLater()
        self._numbers, self._values, self.meanings = [], [], []
        for number in range(count):
            label = tr("Column {number}").format(number=number + 1)
            name, value = Text(label, 15), Text("", 15, SEMIBOLD)
            choice = self._choice(label, _meanings())
            for place, widget in enumerate((name, value, choice)):
                self._grid.addWidget(widget, number, place)
                widget.show()  # at once: what is not in sight yet has no size
            self._numbers.append(name)
            self._values.append(value)
            self.meanings.append(choice)
        self._fit()
        for before, after in zip(self.tab_order, self.tab_order[1:], strict=False):
            QWidget.setTabOrder(before, after)

    def _fit(self) -> None:
        needed = self._grid.minimumSize().width() + self._units.minimumSize().width() + self._body.spacing()
        is_narrow = needed > self._room - 2 * px(PADDING)
        way = QBoxLayout.Direction.TopToBottom if is_narrow else QBoxLayout.Direction.LeftToRight
        self._body.setDirection(way)

    def _build(self) -> None:
        card, title = Card(), Text(tr("Meaning of the columns"), 20, SEMIBOLD, wraps=True)
        self._grid = QGridLayout()
        self._grid.setColumnStretch(1, 1)
        self._units = QGridLayout()
        for number, choice in enumerate((self.time, self.wraps, self.rate, self.force)):
            self._units.addWidget(Text(choice.accessibleName(), 15), number, 0)
            self._units.addWidget(choice, number, 1)
        self._units.setRowStretch(4, 1)
        self._body = lay_out(
            QBoxLayout(QBoxLayout.Direction.LeftToRight), (self._grid, 3), (self._units, 2), spacing=32
        )
        heading = lay_out(QVBoxLayout(), title, self._where, spacing=4)
        lay_out(card.column, heading, self.notice, self._body, 1)
        verbs = lay_out(QHBoxLayout(), self.back, 1)
        lay_out(QVBoxLayout(self), (card, 1), verbs, margins=0, spacing=12)
        for grid in (self._grid, self._units):
            scaled(grid.setHorizontalSpacing, 16)
            scaled(grid.setVerticalSpacing, 8)


def _choose(choice: Choice, key: str) -> None:
    with QSignalBlocker(choice):
        choice.setCurrentIndex(max(choice.findData(key), 0))
    choice.update()


def _meanings() -> dict[str, str]:
    words: dict[str, str] = {
        Meaning.RATE_X: tr("angular rate x"),
        Meaning.RATE_Y: tr("angular rate y"),
        Meaning.RATE_Z: tr("angular rate z"),
        Meaning.FORCE_X: tr("acceleration x"),
        Meaning.FORCE_Y: tr("acceleration y"),
        Meaning.FORCE_Z: tr("acceleration z"),
    }
    turned = {f"-{meaning}": tr("{quantity}, reversed").format(quantity=word) for meaning, word in words.items()}
    return {Meaning.UNUSED: tr("not needed"), Meaning.TIME: tr("time"), **words, **turned}

"""Chooser of the next walk's name: a label from the list, each with its digit, or words of one's own."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QAbstractButton, QWidget

from app.theme.current import on_theme, scaled
from app.widgets.button import ButtonKind
from app.widgets.field import Field
from app.widgets.wrapping import WrappedButton, Wrapping
from app.wording.translation import tr

HEIGHT = 48  # as high as the field beside them
FIELD_WIDTH = 200
DIGITS = 9


class LabelChooser(Wrapping):
    """The labels wrap into as many lines as they need, the field for other words last. Arrows move and choose."""

    chosen = Signal(str)  # by the user

    def __init__(self) -> None:
        super().__init__(HEIGHT)
        self._options: list[_Option] = []
        self._choice = ""
        self.own = Field(tr("Other condition for the next walk"), placeholder=tr("Other"), has_label=False)
        self.own.setParent(self)
        self.setAccessibleName(tr("Next condition"))
        scaled(self.own.setFixedWidth, FIELD_WIDTH)
        self.own.committed.connect(self._on_own_committed)
        on_theme(self.arrange)

    @property
    def choice(self) -> str:
        return self._choice

    @property
    def buttons(self) -> list[QAbstractButton]:
        return list(self._options)

    def parts(self) -> list[QWidget]:
        return [*self._options, self.own]

    @property
    def stops(self) -> list[QWidget]:
        """Where the tabulator stops among the labels."""
        return [option for option in self._options if option.focusPolicy() is Qt.FocusPolicy.TabFocus]

    def show_labels(self, labels: tuple[str, ...], choice: str) -> None:
        """Offer `labels`; a choice that is none of them is shown in the field."""
        while len(self._options) > len(labels):
            self._options.pop().deleteLater()
        while len(self._options) < len(labels):
            option = _Option("", ButtonKind.LABEL, HEIGHT, self)
            option.clicked.connect(self._on_clicked)
            option.show()
            self._options.append(option)
        for number, (option, label) in enumerate(zip(self._options, labels, strict=True), start=1):
            option.show_label(label, str(number) if number <= DIGITS else "")
        self._choice = choice
        self._mark()
        self.own.set_text("" if choice in labels else choice)
        self.own.raise_()
        self.arrange()

    def choose_digit(self, digit: int) -> bool:
        """Choose the label with this digit on its cap; False where there is none."""
        if not 1 <= digit <= min(len(self._options), DIGITS):
            return False
        self._take(self._options[digit - 1].text())
        return True

    def step(self, part: QWidget, by: int) -> None:
        options: list[QWidget] = [*self._options]
        to = self._options[(options.index(part) + by) % len(options)]
        self._take(to.text())
        to.setFocus(Qt.FocusReason.TabFocusReason)

    def _take(self, label: str) -> None:
        self._choice = label
        self._mark()
        if label in [option.text() for option in self._options]:
            self.own.set_text("")
        self.chosen.emit(label)

    def _mark(self) -> None:
        """Mark the choice and give it the tab stop, without focus: Space must start the walk."""
        chosen = [option for option in self._options if option.text() == self._choice]
        before, stops = self.stops, (chosen or self._options)[:1]
        for stop in stops:
            stop.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            for one in before:
                QWidget.setTabOrder(one, stop)  # in whose place it comes; Qt chains nothing that takes no focus
        for option in self._options:
            option.setChecked(option in chosen)
            if option not in stops:
                option.setFocusPolicy(Qt.FocusPolicy.NoFocus)

    def _on_clicked(self) -> None:
        clicked = self.sender()
        assert isinstance(clicked, _Option)
        self._take(clicked.text())

    def _on_own_committed(self) -> None:
        stated = self.own.text.strip()
        if stated:
            self._take(stated)


class _Option(WrappedButton):
    """A label with the digit that chooses it."""

    def show_label(self, label: str, digit: str) -> None:
        self.setText(label)
        self.setAccessibleName(label)
        self.setAccessibleDescription(tr("Key {key}").format(key=digit) if digit else "")
        self.set_face(key=digit)

    def nextCheckState(self) -> None:  # noqa: N802  Qt calls it
        """Leave it to the chooser, which marks one of all."""

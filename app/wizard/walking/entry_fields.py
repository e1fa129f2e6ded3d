"""The next change as it is entered before its walk: a part's position by steps, or its program and a setting."""

from itertools import pairwise

from PySide6.QtCore import QEvent, QObject, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QGridLayout, QWidget

from app.theme.current import scaled
from app.widgets.choice import Choice
from app.widgets.field import Field, NumberField
from app.widgets.leaving_keys import LeavingKeys
from app.widgets.text import Text
from app.wizard.walking.bench import NAMES, NUMBERS, ChangeEntry, EntryTopic
from app.wizard.walking.stepper import Stepper
from app.wording.alignment import change_in_words, direction_words, part_name, setting_text, turns_words
from app.wording.numbers import MINUS
from app.wording.translation import figure_text, tr
from core.alignment import FIGURES, MOST_NAME, MOST_SETTING, MOST_TEXT

DECIMALS = 2  # of a setting
PLACES = {  # row, column and columns of the chooser, what it asks for, and the line below; by compact and program
    (False, False): ((0, 0, 2), (1, 0, 1), (1, 1, 1), (2, 0, 1), (2, 1, 1), (3, 0, 2), (4, 0, 2)),
    (False, True): ((0, 0, 2), (1, 0, 1), (1, 1, 1), (2, 0, 2), (3, 0, 1), (3, 1, 1), (4, 0, 2)),
    (True, False): ((0, 0, 1), (0, 1, 1), (0, 2, 1), (0, 3, 1), (0, 4, 1), (1, 0, 2), (1, 2, 3)),
    (True, True): ((0, 0, 1), (0, 1, 1), (0, 2, 1), (0, 3, 1), (0, 4, 1), (0, 5, 1), (1, 0, 6)),
}
BY_ONE = {Qt.Key.Key_Up: 1, Qt.Key.Key_Down: -1}


class EntryFields(QWidget):
    """Writes into `entry` and shows what it holds. The chooser decides what is entered: position, or program."""

    reported = Signal()  # something was entered
    left = Signal()  # by Enter or Esc: what was typed is done

    def __init__(self, entry: ChangeEntry) -> None:
        super().__init__()
        self._entry, self._is_compact = entry, False
        self.parts = Choice(tr("Part"))
        self._shown = entry.part, entry.times_loaded
        self._topics: list[EntryTopic] = []
        self._offer()
        self.steppers = {name: Stepper() for name in FIGURES}
        self.words = Field(tr("In words"), has_label=False, placeholder=tr("Free text, optional"), most=MOST_TEXT)
        self.program_before = Field(tr("Program before"), most=MOST_NAME)
        self.program = Field(tr("Program now"), most=MOST_NAME)
        self.setting = Field(tr("Setting, by its name"), most=MOST_NAME)
        before, now = (
            NumberField(label, low=-MOST_SETTING, high=MOST_SETTING, decimals=DECIMALS)
            for label in (tr("Value before"), tr("Value now"))
        )
        self.setting_before, self.setting_value = before, now
        self.names = dict(zip(NAMES, (self.program_before, self.program, self.setting), strict=True))
        self.numbers = dict(zip(NUMBERS, (self.setting_before, self.setting_value), strict=True))
        self.written = Text(size=12, tone="ink2", wraps=True)
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        scaled(self._grid.setSpacing, 8)
        switches: list[QWidget] = [*self.names.values(), *self.numbers.values()]
        for widget in (self.parts, *self.steppers.values(), self.words, *switches):
            widget.setParent(self)  # what is shown without one is a window, and takes the keys
        for one, other in pairwise(self.tab_order):
            QWidget.setTabOrder(one, other)
        self._connect()
        self._arrange()

    @property
    def tab_order(self) -> list[QWidget]:
        """The controls in the order of reading; those of the other topic are hidden, where Tab finds none."""
        typed = (self.words, *self.names.values(), *self.numbers.values())
        return [self.parts, *self.steppers.values(), *(field.line_edit for field in typed)]

    def set_compact(self, is_compact: bool) -> None:
        """Show all in two rows where there is the width of the window, and little height."""
        self._is_compact = is_compact
        self._arrange()

    def show_entry(self) -> None:
        """Show the next change as `entry` holds it."""
        entry = self._entry
        self._offer()
        if self.parts.currentIndex() != self._topics.index(entry.topic):
            self.parts.setCurrentIndex(self._topics.index(entry.topic))
        angle_words, shift_words = direction_words(entry.part)
        shown = {
            "angle_deg": (angle_words, "°"),
            "turns": (tr("Screw turns"), ""),
            "shift_mm": (shift_words, tr(" mm")),
            "height_mm": (tr("Height, longer +"), tr(" mm")),
        }
        for name, stepper in self.steppers.items():
            caption, unit = shown[name]
            value = entry.figure(name)
            sign = "+" if value > 0 else MINUS if value < 0 else ""
            stated = turns_words(value) if name == "turns" and value else sign + figure_text(abs(value), "g") + unit
            stepper.show_value(caption, stated)
            step = figure_text(FIGURES[name].step, "g") + unit
            stepper.setToolTip(
                tr("{what}: plus, minus or an arrow changes it by {step}.").format(what=caption, step=step)
            )
        self.words.set_text(entry.text)
        self._show_switched()
        line = change_in_words(entry.parts)
        self.written.setText(tr("Recorded as: {change}").format(change=line) if line else tr("Nothing changed yet."))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Take the arrows, which step a number here."""
        if event.type() is not QEvent.Type.KeyPress or not isinstance(event, QKeyEvent) or event.key() not in BY_ONE:
            return False
        number = next(name for name, field in self.numbers.items() if field.line_edit is watched)
        self._step_number(number, BY_ONE[Qt.Key(event.key())])
        return True

    def _show_switched(self) -> None:
        entry = self._entry
        shown = entry.part, entry.times_loaded
        for name, field in self.names.items():
            field.set_text(entry.name(name))
        for name, number in self.numbers.items():
            if number.value != entry.number(name) or self._shown != shown:  # else what is no number yet stays
                number.set_value(entry.number(name))
        self._shown = shown
        known = entry.known_setting
        self.program_before.line_edit.setPlaceholderText(entry.known_program)
        self.setting_before.line_edit.setPlaceholderText("" if known is None else setting_text(known))

    def _connect(self) -> None:
        self.parts.currentIndexChanged.connect(self._on_topic_chosen)
        for stepper in self.steppers.values():
            stepper.stepped.connect(self._on_stepped)
        self.words.edited.connect(self._on_words_edited)
        for field in (*self.names.values(), *self.numbers.values()):
            field.edited.connect(self._on_switched)
        for typed in (self.words, *self.names.values(), *self.numbers.values()):
            LeavingKeys(typed).left.connect(self.left)
        for number in self.numbers.values():
            number.line_edit.installEventFilter(self)

    def _offer(self) -> None:
        """Fill the chooser with what can be entered."""
        if self._topics == (topics := self._entry.topics):
            return
        self._topics = topics
        with QSignalBlocker(self.parts):
            self.parts.clear()
            for topic in topics:
                words = tr("{part}, program") if topic.is_program else "{part}"
                self.parts.addItem(words.format(part=part_name(topic.part)))
            self.parts.setCurrentIndex(topics.index(self._entry.topic))

    def _arrange(self) -> None:
        """Put in place what the chosen topic asks for."""
        steppers = [*self.steppers.values()]
        switches: list[QWidget] = [*self.names.values(), *self.numbers.values()]
        for widget in (self.parts, *steppers, self.words, *switches, self.written):
            self._grid.removeWidget(widget)
        shown = switches if self._entry.is_program else [*steppers, self.words]
        for widget in (*steppers, self.words, *switches):
            widget.setVisible(widget in shown)
        places = PLACES[self._is_compact, self._entry.is_program]
        for widget, (row, column, columns) in zip([self.parts, *shown, self.written], places, strict=True):
            self._grid.addWidget(widget, row, column, 1, columns)
        self._grid.setAlignment(self.parts, Qt.AlignmentFlag.AlignBottom)

    def _step_number(self, name: str, by: int) -> None:
        """From what was entered, else from what it was before, else from nothing."""
        before = self._entry.number("setting_before")
        candidates = (self._entry.number(name), before, self._entry.known_setting)
        start = next((one for one in candidates if one is not None), 0.0)
        self._entry.set_number(name, min(max(start + by, -MOST_SETTING), MOST_SETTING))
        self.reported.emit()

    def _on_topic_chosen(self, index: int) -> None:
        self._entry.topic = self._topics[index]
        self._arrange()
        self.reported.emit()

    def _on_stepped(self, by: int) -> None:
        name = next(name for name, stepper in self.steppers.items() if stepper is self.sender())
        self._entry.step(name, by)
        self.reported.emit()

    def _on_words_edited(self, text: str) -> None:
        self._entry.say(text)
        self.reported.emit()

    def _on_switched(self, _text: str) -> None:
        for name, field in self.names.items():
            self._entry.say_name(name, field.text)
        for name, number in self.numbers.items():
            self._entry.set_number(name, number.value)
        self.reported.emit()

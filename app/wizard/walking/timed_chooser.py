"""Chooser of the timed test that the next walk is, if it is one, and the length of its course."""

from collections.abc import Mapping

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QWidget

from app.theme.current import scaled
from app.widgets.choice import Choice
from app.widgets.field import NumberField
from app.widgets.key_cap import KeyCap
from app.widgets.lay_out import lay_out
from app.widgets.leaving_keys import LeavingKeys
from app.widgets.text import Text
from app.wording.timed_tests import course_label, name_of_test
from app.wording.translation import tr, within_sentence
from core.timed.protocols import PlannedTest, TimedProtocol, course_of

LEAST, MOST = 120, 340  # px of the box
SHORTEST_M, LONGEST_M = 1.0, 200.0
FIELD_WIDTH = 104


class TimedChooser(Choice):
    """`chosen` with the value of a protocol, empty for none. T chooses the next."""

    chosen = Signal(str)

    def __init__(self) -> None:
        super().__init__(tr("Timed test"))
        self.addItem(tr("No timed test"), "")
        for protocol in TimedProtocol:
            self.addItem(name_of_test(protocol), str(protocol))
        self.let_shrink(LEAST, MOST)
        self.activated.connect(self._on_activated)

    def show_before(self, before: Mapping[TimedProtocol, str]) -> None:
        """Name with each test what came of it at an earlier visit."""
        for row, protocol in enumerate(TimedProtocol, 1):
            words = " \N{MIDDLE DOT} ".join(filter(None, [name_of_test(protocol), before.get(protocol, "")]))
            if words != self.itemText(row):
                self.setItemText(row, words)

    def show_choice(self, protocol: TimedProtocol | None) -> None:
        self.setCurrentIndex(0 if protocol is None else 1 + list(TimedProtocol).index(protocol))

    def _on_activated(self, _index: int) -> None:
        self.chosen.emit(self.currentData())


class CourseField(QWidget):
    """How long the course of the chosen test is; C leads to it, Enter and Esc lead out again, Space starts the test.

    `entered`: with every change; what the field holds then is in `value` and `is_wrong`. `left`: by a key.
    """

    entered = Signal()
    left = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._protocol: TimedProtocol | None = None
        self._caption = Text(tone="ink2")
        self.field = NumberField(
            "", low=SHORTEST_M, high=LONGEST_M, decimals=2, unit="m", has_label=False, states_wrong=False
        )
        self.setSizePolicy(QSizePolicy.Policy.Maximum, QSizePolicy.Policy.Fixed)
        scaled(self.field.setFixedWidth, FIELD_WIDTH)
        lay_out(QHBoxLayout(self), self._caption, self.field, KeyCap("C"), margins=0, spacing=8)
        self.field.edited.connect(self.entered)
        self.field.committed.connect(self.entered)
        LeavingKeys(self.field).left.connect(self.left)
        self.hide()  # until a test is chosen

    @property
    def value(self) -> float | None:
        return self.field.value

    @property
    def is_wrong(self) -> bool:
        """Whether something was typed that is no length of a course."""
        return bool(self.field.text.strip()) and self.field.value is None

    def show_course(self, planned: PlannedTest | None) -> None:
        """Show the length for a test that has a course, and nothing for others."""
        label = "" if planned is None else course_label(planned.protocol)
        self.setVisible(bool(label))
        self._caption.setText(label)
        self.field.set_label(tr("Next test, {length}").format(length=within_sentence(label)))  # not the one before
        protocol = None if planned is None else planned.protocol
        is_in_hand = protocol is self._protocol and (self.field.line_edit.hasFocus() or self.is_wrong)
        if planned is not None and not is_in_hand:
            self.field.set_value(course_of(planned))
        self._protocol = protocol

    def take_focus(self) -> None:
        self.field.line_edit.setFocus(Qt.FocusReason.ShortcutFocusReason)
        self.field.line_edit.selectAll()

"""Chooser of the timed test that the next walk is, if it is one."""

from collections.abc import Mapping

from PySide6.QtCore import Signal

from app.widgets.choice import Choice
from app.wording.timed_tests import name_of_test
from app.wording.translation import tr
from core.timed.protocols import TimedProtocol

LEAST, MOST = 120, 340  # px of the box


class TimedChooser(Choice):
    """`chosen` with the value of a protocol, empty for none. T chooses the next."""

    chosen = Signal(str)

    def __init__(self) -> None:
        super().__init__(tr("Timed test"))
        self.addItem(tr("No timed test (T)"), "")
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

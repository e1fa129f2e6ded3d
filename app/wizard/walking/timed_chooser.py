"""Chooser of the timed test that the next walk is, if it is one."""

from collections.abc import Mapping

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QWidget

from app.widgets.choice import Choice
from app.wording.timed_tests import name_of_test
from app.wording.translation import tr
from core.timed.protocols import TimedProtocol

LEAST, MOST = 120, 340  # px of the box


class TimedChooser(QWidget):
    """`chosen` with the value of a protocol, empty for none. T chooses the next."""

    chosen = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.box = Choice(tr("Timed test"))
        self.box.addItem(tr("No timed test (T)"), "")
        for protocol in TimedProtocol:
            self.box.addItem(name_of_test(protocol), str(protocol))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.box)
        self.box.let_shrink(LEAST, MOST)
        self.box.activated.connect(self._on_activated)

    def show_before(self, before: Mapping[TimedProtocol, str]) -> None:
        """Name with each test what came of it at an earlier visit."""
        for row, protocol in enumerate(TimedProtocol, 1):
            words = " \N{MIDDLE DOT} ".join(filter(None, [name_of_test(protocol), before.get(protocol, "")]))
            if words != self.box.itemText(row):
                self.box.setItemText(row, words)

    def show_choice(self, protocol: TimedProtocol | None) -> None:
        self.box.setCurrentIndex(0 if protocol is None else 1 + list(TimedProtocol).index(protocol))

    def _on_activated(self, _index: int) -> None:
        self.chosen.emit(self.box.currentData())

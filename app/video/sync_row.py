"""Synchronise a clip by hand: choose a contact in the curves and the frame in which that foot touches the floor."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, Text
from app.wording.body import side_name
from app.wording.translation import figure_text, tr
from core.body import Side

HEIGHT = 44


class SyncRow(QWidget):
    """`stepped` gives -1 or 1 frame. `confirmed` and `cancelled` end it."""

    stepped = Signal(int)
    confirmed = Signal()
    cancelled = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.what = Text(size=13, weight=MEDIUM, wraps=True)
        self.earlier = Button("", ButtonKind.QUIET, Icon.BACK, ",", height=HEIGHT)
        self.later = Button("", ButtonKind.QUIET, Icon.NEXT, ".", height=HEIGHT)
        self.confirm = Button(tr("Synchronise"), ButtonKind.SECONDARY, Icon.CHECK, height=HEIGHT)
        self.cancel = Button(tr("Cancel"), ButtonKind.QUIET, height=HEIGHT)
        self.earlier.setAccessibleName(tr("Earlier frame"))
        self.later.setAccessibleName(tr("Later frame"))
        frame = lay_out(QHBoxLayout(), self.earlier, Text(tr("Frame"), weight=MEDIUM), self.later, margins=0, spacing=4)
        buttons = lay_out(QHBoxLayout(), frame, 1, self.cancel, self.confirm, margins=0, spacing=8)
        lay_out(QVBoxLayout(self), self.what, buttons, margins=0, spacing=4)
        self.earlier.clicked.connect(lambda: self.stepped.emit(-1))
        self.later.clicked.connect(lambda: self.stepped.emit(1))
        self.confirm.clicked.connect(self.confirmed)
        self.cancel.clicked.connect(self.cancelled)

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.earlier, self.later, self.cancel, self.confirm]

    def show_contact(self, side: Side, time_s: float) -> None:
        """State which contact the frame is for."""
        sentence = tr("{time} s: choose the frame in which the {side} foot touches the floor, or another contact.")
        self.what.setText(sentence.format(side=side_name(side), time=figure_text(time_s, ".2f")))

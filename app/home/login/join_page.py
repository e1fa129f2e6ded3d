"""This computer becomes a station of the clinic: its server is named here, or by the computer's environment.

Named by the environment, nothing is typed: the page then only states why the library is not reached, and tries again.
"""

from PySide6.QtCore import Signal
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent
from PySide6.QtWidgets import QHBoxLayout, QWidget

from app.home.login.typed_entry import EntryPage
from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.server_fields import ServerFields
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr


class JoinPage(EntryPage):
    joined = Signal(str, str, str)  # address, password, place
    again_requested = Signal()  # at the server that the environment names
    left = Signal()
    demonstration_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._title = Text(size=26, weight=SEMIBOLD, wraps=True)
        self.lead = Text(tone="ink2", wraps=True)
        self.server = ServerFields(tr("Shared storage, path on this computer"), self, is_place_optional=True)
        self._hint = Text(
            tr(
                "Enter the shared storage only if its path on this computer differs from other workstations. "
                "Log in with your passphrase for the clinic's library."
            ),
            tone="ink2",
            wraps=True,
        )
        self.join = Button(tr("Join"), ButtonKind.PRIMARY, None, tr("Enter"))
        self.again = Button(tr("Try again"), ButtonKind.PRIMARY, None, tr("Enter"))
        self.back = Button(tr("Back"), ButtonKind.QUIET, Icon.BACK, height=44)
        self.demonstration = Button(tr("View the demonstration first"), ButtonKind.QUIET, Icon.PLAY, height=44)
        self._build()
        self._connect()
        self.ask()
        scaled(self._quiet.setSpacing, 12)

    @property
    def tab_order(self) -> list[QWidget]:
        return [*self.server.tab_order, self.join, self.again, self.back, self.demonstration]

    def ask(self) -> None:
        """Let the server be named, with nothing typed yet."""
        self.server.forget_typed()
        self._title.setText(tr("Join the clinic's library"))
        self.lead.setText(
            tr(
                "The workstations of a clinic share one library. Patients and sessions are on the clinic's "
                "server. Recordings made here are transferred to the clinic's shared storage, encrypted."
            )
        )
        self._show(is_asking=True)

    def show_trouble(self, sentence: str) -> None:
        """Say why the library of the server that the environment names cannot be joined."""
        self._title.setText(tr("The clinic's library cannot be reached"))
        self.lead.setText(sentence)
        self._show(is_asking=False)
        QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self.lead, sentence))

    def refuse(self, sentence: str, *, is_place: bool, place: str = "") -> None:
        """Say at its field why the library cannot be joined; `place` is to be confirmed there."""
        self.show_busy(False)
        if place:
            self.server.place.set_text(place)
        self.server.refuse(sentence, is_place=is_place)

    def show_busy(self, is_busy: bool) -> None:
        """Say that the server is being asked."""
        self.join.setText(tr("Joining") if is_busy else tr("Join"))
        for part in (self.join, *self.server.fields, self.back, self.demonstration):
            part.setEnabled(not is_busy)

    def focus(self) -> None:
        (self.server.address if self.again.isHidden() else self.again).setFocus()

    def _build(self) -> None:
        self._card = Card(padding=24, spacing=16)
        lay_out(self._card.column, *self.server.fields, self._hint, self.join)
        self._quiet = lay_out(QHBoxLayout(), self.back, self.demonstration, 1)
        lay_out(self.column, self._title, self.lead, self._card, self.again, self._quiet)

    def _connect(self) -> None:
        self.join.clicked.connect(self._on_join)
        self.server.entered.connect(self._on_join)
        self.again.clicked.connect(self.again_requested)
        self.back.clicked.connect(self.left)
        self.demonstration.clicked.connect(self.demonstration_requested)

    def _show(self, *, is_asking: bool) -> None:
        self.show_busy(False)
        for block in (self._card, self.back):
            block.setVisible(is_asking)
        for way in (self.again, self.demonstration):
            way.setVisible(not is_asking)

    def _on_join(self) -> None:
        if self.join.isEnabled() and self.server.is_complete:
            self.joined.emit(*self.server.reported)

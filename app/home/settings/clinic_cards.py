"""A clinic's stations, in the settings: what this station has to do with its server, and how a library gets there."""

from dataclasses import dataclass

from PySide6.QtCore import Signal
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent
from PySide6.QtWidgets import QWidget

from app.home.settings.settings_card import SettingsCard
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.server_fields import ServerFields
from app.widgets.text import MEDIUM, Text
from app.wording.translation import tr, tr_n


@dataclass(frozen=True, slots=True)
class StationView:
    """What a station knows of itself: its server without password, the recordings' place, and what waits here.

    `waiting`: None while it is not known.
    """

    server: str
    place: str
    waiting: int | None = None


class StationCard(SettingsCard):
    """`copy_requested` also while a copy is made: then `stop_requested` comes instead."""

    copy_requested = Signal()
    stop_requested = Signal()
    back_requested = Signal()

    def __init__(self) -> None:
        super().__init__(tr("Clinic's server"))
        self._is_copying = self._may_bring_back = False
        self.server = Text(wraps=True)
        self.place = Text(wraps=True)
        self.waiting = Text(weight=MEDIUM, wraps=True)
        self._copy_hint = Text(
            tr(
                "The server's administrator backs up the library with the server's own tools. First pg_dump "
                "saves the database. Then the shared storage of the recordings is copied. A copy in a folder "
                "is itself a library, which opens without the server."
            ),
            tone="ink2",
            wraps=True,
        )
        self.copy_stated = Text(weight=MEDIUM, wraps=True)
        self.copy = Button(tr("Copy to a folder"))
        self._back_hint = Text(
            tr(
                "The library can also be moved back from the server. It is then on this computer only, as "
                "before. No other workstation can open it."
            ),
            tone="ink2",
            wraps=True,
        )
        self.back_stated = Text(weight=MEDIUM, wraps=True)
        self.back = Button(tr("Move back to a folder"))
        self.sure = Button(tr("Move library back, close to all others"))
        self.keep = Button(tr("Cancel"), ButtonKind.QUIET)
        self.fill(self.server, self.place, self.waiting, self._copy_hint, self.copy_stated)
        self.add_left(self.copy)
        self.fill(self._back_hint, self.back_stated)
        self.add_left(self.back, self.sure, self.keep)
        self.copy.clicked.connect(self._on_copy)
        self.back.clicked.connect(self._on_back)
        self.sure.clicked.connect(self._on_sure)
        self.keep.clicked.connect(self._on_keep)
        self.show_may(may_copy=False, may_bring_back=False)
        self.show_copy("")
        self.show_back("")

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.copy, self.back, self.sure, self.keep]

    def show_may(self, *, may_copy: bool, may_bring_back: bool) -> None:
        self._may_bring_back = may_bring_back
        self.copy.setVisible(may_copy)
        self._back_hint.setVisible(may_bring_back)
        self._ask(is_asking=False)

    def show_station(self, view: StationView) -> None:
        self.server.setText(tr("This computer is a workstation of {server}.").format(server=view.server))
        self.place.setText(tr("Recordings are stored in {place}.").format(place=view.place))
        self.waiting.setVisible(view.waiting is not None)
        if view.waiting:
            waits = tr_n(
                "{count} recording here is waiting to be transferred.",
                "{count} recordings here are waiting to be transferred.",
                view.waiting,
            )
            self.waiting.setText(waits.format(count=view.waiting))
        else:
            self.waiting.setText(tr("All recordings were transferred."))

    def show_copy(self, sentence: str, *, is_running: bool = False) -> None:
        """Say how far the copy is, or how it went."""
        self._is_copying = is_running
        _say(self.copy_stated, sentence)
        self.copy.setText(tr("Stop") if is_running else tr("Copy to a folder"))
        self.back.setEnabled(not is_running)

    def show_back(self, sentence: str, *, is_running: bool = False) -> None:
        """Say how far bringing back is, or why it did not come to its end."""
        _say(self.back_stated, sentence)
        self._ask(is_asking=False)
        self.setEnabled(not is_running)

    def _ask(self, *, is_asking: bool) -> None:
        for button in (self.sure, self.keep):
            button.setVisible(is_asking and self._may_bring_back)
        self.back.setVisible(not is_asking and self._may_bring_back)

    def _on_copy(self) -> None:
        (self.stop_requested if self._is_copying else self.copy_requested).emit()

    def _on_back(self) -> None:
        self._ask(is_asking=True)
        self.keep.setFocus()

    def _on_sure(self) -> None:
        self.back_requested.emit()

    def _on_keep(self) -> None:
        self._ask(is_asking=False)
        self.back.setFocus()


class MoreStationsCard(SettingsCard):
    """How a library in a folder gets to the server of a clinic."""

    move_requested = Signal(str, str, str)  # address, password, place

    def __init__(self) -> None:
        super().__init__(tr("Several workstations"))
        self._hint = Text(
            tr(
                "Several computers can share this library on your clinic's PostgreSQL server. The server's "
                "administrator can then read patient codes, user names and entered text. Recordings stay "
                "encrypted. Every workstation then needs the server to save data. If the server does not "
                "respond, the workstation keeps recording."
            ),
            tone="ink2",
            wraps=True,
        )
        place = tr("Shared storage that all workstations can reach")
        self.server = ServerFields(place, self, is_place_optional=False)
        self.choose = Button(tr("Choose the folder"), ButtonKind.QUIET, Icon.FOLDER)
        self.stated = Text(weight=MEDIUM, wraps=True)
        self.move_there = Button(tr("Move to the clinic's server"))
        self.fill(self._hint, *self.server.fields)
        self.add_left(self.choose)
        self.fill(self.stated)
        self.add_left(self.move_there)
        self.move_there.clicked.connect(self._on_move)
        self.show_move("")

    @property
    def tab_order(self) -> list[QWidget]:
        return [*self.server.tab_order, self.choose, self.move_there]

    def show_place(self, place: str) -> None:
        self.server.place.set_text(place)
        self.server.place.set_wrong("")

    def show_move(self, sentence: str, *, is_running: bool = False) -> None:
        """Say how far the move is."""
        _say(self.stated, sentence)
        self.setEnabled(not is_running)

    def refuse(self, sentence: str) -> None:
        """Say why the library is not on the server."""
        self.show_move("")
        self.server.refuse(sentence)

    def _on_move(self) -> None:
        if self.server.is_complete:
            self.move_requested.emit(*self.server.reported)


def _say(text: Text, sentence: str) -> None:
    text.setText(sentence)
    text.setVisible(bool(sentence))
    if sentence:
        QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(text, sentence))

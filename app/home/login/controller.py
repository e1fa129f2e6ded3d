"""Controller of opening the library. The pages before it is open and over it, and what the controller answers them."""

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from app.home.login.first_start_page import FirstStartPage
from app.home.login.join_page import JoinPage
from app.home.login.log_in_page import LogInPage
from app.storage.layout import DATABASE_VARIABLE, KEYS
from app.system.settings import Settings
from app.widgets.start_pages import WorkingPage
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from app.workers.library_state import Joined, KeptLogIn, LibraryPlace, OpenedState

if TYPE_CHECKING:
    from app.home.login.recovery_key_sheet import KeySheet
    from app.storage.login_delay import LoginDelay
    from app.storage.opened import OpenedLibrary

ADMINISTRATOR = "administrator"  # as app.storage.stored has it
SHORTEST = 10  # as app.storage.keys has it


class Entry(QObject):
    """`entered` comes when the library is open and, where it is new, its recovery key was confirmed."""

    entered = Signal(object)  # OpenedState
    uncovered = Signal()
    left = Signal()  # from the cover, for another operator
    shown = Signal(object)  # the page that is to be shown now

    def __init__(self, controller: LibraryController, settings: Settings, folder: Path, parent: QObject) -> None:
        super().__init__(parent)
        self._controller, self._settings, self._folder = controller, settings, folder
        self._place: LibraryPlace | None = None
        self._new: OpenedState | None = None  # whose recovery key is shown or asked for
        self._given: OpenedState | None = None  # whose operator has to choose an own passphrase first
        self._key = ""  # as long as it is shown
        self._cover_of = self._tried = ""
        self._refusal: tuple[str, str] | None = None  # of the demonstration, to be shown at home
        self._delay: LoginDelay | None = None
        self._sheet: KeySheet | None = None
        self.first_start = FirstStartPage(SHORTEST, _is_end_of_key)
        self.log_in = LogInPage(SHORTEST)
        self.join = JoinPage()
        self.waiting = WorkingPage()
        self.waiting.stop.hide()
        self._connect()

    @property
    def pages(self) -> tuple[QWidget, ...]:
        return (self.first_start, self.log_in, self.join, self.waiting)

    @property
    def is_covering(self) -> bool:
        return bool(self._cover_of)

    @property
    def is_settling(self) -> bool:
        """Whether a library is open, and something has to be answered before it is entered."""
        return self._new is not None or self._given is not None

    def begin(self) -> None:
        """Show the first page: how to make a library, join the environment's server, or find a missing one."""
        self._new, self._given, self._key, self._cover_of, self._tried = None, None, "", "", ""
        if not (self._folder / KEYS).exists():
            if os.environ.get(DATABASE_VARIABLE):
                self._join_by_itself()
                return
            if self._settings.latest_library == str(self._folder):
                from app.storage.root import count_sheltered  # rarely needed

                self.first_start.show_missing(str(self._folder), count_sheltered())
            else:
                self.first_start.show_missing("")
            self._show(self.first_start)
            return
        self.log_in.forget_typed()
        self.log_in.show_operators(())
        self.log_in.show_library("")
        self._show(self.log_in)
        self._controller.call(lambda holder: holder.look(self._folder), self._on_looked, self._on_look_failed, self)

    def look_again(self) -> None:
        """Go on where a library that was missing is there now."""
        if self.first_start.is_missing and (self._folder / KEYS).exists():
            self.first_start.show_missing("")
            self.begin()

    def cover(self, code: str, is_recording: bool, *, is_asked_for: bool = False) -> None:
        """Cover the screen for the logged-in operator; a recovery key in sight is forgotten."""
        self._cover_of = code
        if self._key:
            self._key = ""
            self.first_start.ask_for_recovery_key()
        if self._delay is None:  # of a library that was just made
            from app.storage.login_delay import LoginDelay  # cryptography

            self._delay = LoginDelay(self._folder, time.monotonic)
        self.log_in.show_cover(code, is_recording, is_asked_for=is_asked_for)
        self._show(self.log_in)

    def show_recording(self, is_recording: bool) -> None:
        """Notify the cover whether a recording goes on."""
        if self.is_covering:
            self.log_in.show_recording(is_recording)

    def open_demonstration(self) -> None:
        self._tried = ""
        self.waiting.begin(tr("Opening the demonstration"))
        self._show(self.waiting)
        self._controller.open_demonstration()

    def go_on(self, kept: KeptLogIn | None = None) -> None:
        """Open the library again for whoever was logged in before the demonstration, or in the window before."""
        self._tried = ""
        self.waiting.begin(tr("Opening the library"))
        self._show(self.waiting)
        self._controller.open(lambda holder: holder.open_kept(kept))

    def focus(self, page: QWidget) -> None:
        if isinstance(page, FirstStartPage | LogInPage | JoinPage):
            page.focus()

    def show_message(self, what: str, remedy: str) -> None:
        for page in (self.first_start, self.log_in, self.join):
            page.banner.show_message(what, remedy)

    def _show(self, page: QWidget) -> None:
        for one in (self.first_start, self.log_in, self.join):
            one.banner.hide()
        self.shown.emit(page)

    def _connect(self) -> None:
        first, log_in, controller = self.first_start, self.log_in, self._controller
        first.made.connect(self._on_made)
        first.look_again.clicked.connect(self._on_look_requested)
        first.done.connect(self._on_key_kept)
        first.typed_back.connect(self._confirm)
        first.renew.clicked.connect(self._on_renew_requested)
        first.later.clicked.connect(self._enter)
        first.print_requested.connect(self._on_print_requested)
        first.save_requested.connect(self._on_save_requested)
        first.join.clicked.connect(self._on_join_requested)
        self.join.joined.connect(self._on_server_named)
        self.join.again_requested.connect(self._join_by_itself)
        self.join.left.connect(self.begin)
        log_in.opened.connect(self._on_open_requested)
        log_in.recovered.connect(self._on_recovery_requested)
        log_in.remembered.connect(self._on_remembered_requested)
        log_in.away_requested.connect(self._on_away_requested)
        log_in.own_chosen.connect(self._on_own_chosen)
        log_in.left.connect(self.left)
        controller.opened.connect(self._on_opened)
        controller.not_opened.connect(self._on_not_opened)
        controller.can_work_away.connect(log_in.offer_away)

    def _on_looked(self, place: LibraryPlace) -> None:
        self._place = place
        latest = self._settings.latest_operator
        self.log_in.show_operators(place.codes, place.remembered, latest, can_remember=place.has_keyring)
        self._delay = place.delay
        self.log_in.show_library(_library_in_words(place.server))
        if (left_s := self._left_s(self.log_in.code)) > 0:
            self.log_in.refuse(_too_many(), left_s)
        self.log_in.focus()

    def _on_look_failed(self, what: str, remedy: str) -> None:
        self.log_in.refuse(f"{what} {remedy}")

    def _on_look_requested(self) -> None:
        self.look_again()
        if self.first_start.is_missing:
            self.show_message(tr("The library is still missing."), tr("Connect its disk, or put its folder back."))

    def _on_join_requested(self) -> None:
        self.join.ask()
        self._show(self.join)

    def _on_server_named(self, address: str, password: str, place: str) -> None:
        self.join.show_busy(True)
        self._controller.call(
            lambda holder: holder.join(self._folder, address, password, place),
            self._on_joined,
            self._on_join_refused,
            self,
        )

    def _on_joined(self, joined: Joined) -> None:
        if joined.refusal is not None:
            self.join.refuse(" ".join(joined.refusal), is_place=joined.is_place, place=joined.place)
            return
        self.join.ask()  # nothing typed is kept
        self.begin()

    def _on_join_refused(self, what: str, remedy: str) -> None:
        self.join.refuse(f"{what} {remedy}", is_place=False)

    def _join_by_itself(self) -> None:
        """Become a station of the library on the server that the environment names."""
        self.waiting.begin(tr("Searching for the clinic's library"))
        self._show(self.waiting)
        self._controller.call(
            lambda holder: holder.join(self._folder, os.environ[DATABASE_VARIABLE], "", ""),
            self._on_joined_by_itself,
            self._on_unreached,
            self,
        )

    def _on_joined_by_itself(self, joined: Joined) -> None:
        if joined.refusal is not None:
            self._on_unreached(*joined.refusal)
        else:
            self.begin()

    def _on_unreached(self, what: str, remedy: str) -> None:
        self.join.show_trouble(f"{what} {remedy}")
        self._show(self.join)

    def _on_made(self, code: str, name: str, passphrase: str) -> None:
        self.first_start.show_busy(True)
        self._controller.open(lambda holder: holder.create(self._folder, code, name, passphrase))

    def _on_open_requested(self, code: str, passphrase: str, must_remember: bool) -> None:
        self._tried = code
        if (left_s := self._left_s(code)) > 0:  # of another operator than the one that the page waited for
            self.log_in.refuse(_too_many(), left_s)
            return
        self.log_in.show_busy(True)
        delay = self._delay
        if not self.is_covering:
            self._controller.open(lambda holder: holder.open(self._folder, passphrase, code, must_remember, delay))
            return
        self._controller.call(
            lambda holder: holder.unlock(code, passphrase, delay), self._on_checked, self._on_check_failed, self
        )

    def _on_remembered_requested(self, code: str) -> None:
        self._tried = code
        self.log_in.show_busy(True)
        self._controller.open(lambda holder: holder.open_remembered(self._folder, code))

    def _on_away_requested(self, code: str, passphrase: str) -> None:
        self._tried = code
        self.log_in.show_busy(True)
        delay = self._delay
        self._controller.open(lambda holder: holder.open_away(self._folder, passphrase, code, delay))

    def _on_recovery_requested(self, code: str, recovery_key: str, passphrase: str) -> None:
        self._tried = code
        self.log_in.show_busy(True)
        self._controller.open(lambda holder: holder.open_recovered(self._folder, recovery_key, code, passphrase))

    def _on_checked(self, _nothing: object) -> None:
        self._cover_of = ""
        self.log_in.forget_typed()
        if self._given is not None:
            self.log_in.ask_for_own(self._given.operator.code)
        self.uncovered.emit()

    def _on_check_failed(self, what: str, remedy: str) -> None:
        self.log_in.refuse(f"{what} {remedy}", self._left_s(self._tried))

    def _on_opened(self, state: OpenedState) -> None:
        self._tried = ""
        self.log_in.forget_typed()
        self.first_start.show_busy(False)
        if not state.is_demonstration:
            self._settings.latest_operator = state.operator.code
            self._settings.latest_library = str(self._folder)
        if state.is_continued:
            self._go_in_again(state)
            return
        if state.is_passphrase_given:
            self._given = state
            self.log_in.ask_for_own(state.operator.code)
            self._show(self.log_in)
            return
        self._go_on(state)

    def _go_in_again(self, state: OpenedState) -> None:
        refusal, self._refusal = self._refusal, None
        self.entered.emit(state)
        if refusal is not None:
            self._controller.refused.emit(*refusal)

    def _on_own_chosen(self, passphrase: str) -> None:
        def change(opened: "OpenedLibrary") -> None:
            operator = opened.library.operator
            assert operator is not None  # whoever opens a library is logged in
            assert opened.data_key is not None  # the demonstration has no passphrase
            opened.slots.set_passphrase(opened.data_key, operator.code, passphrase, (operator.name,))

        self.log_in.show_busy(True)
        self._controller.run(change, self._on_own_set, self._on_own_refused, self)

    def _on_own_set(self, _nothing: object) -> None:
        state, self._given = self._given, None
        self.log_in.forget_typed()
        if state is not None:
            self._go_on(state)

    def _on_own_refused(self, what: str, remedy: str) -> None:
        self.log_in.refuse(f"{what} {remedy}")

    def _go_on(self, state: OpenedState) -> None:
        """See that somebody has the recovery key, then enter."""
        if state.recovery_key:
            self._new = state
            self._on_renewed(state.recovery_key)
            return
        if not state.is_recovery_key_confirmed and state.operator.role.value == ADMINISTRATOR:
            self._new = state
            self.first_start.ask_for_recovery_key()
            self._show(self.first_start)
            return
        self.entered.emit(state)

    def _on_not_opened(self, what: str, remedy: str, _is_key: bool) -> None:
        if self._tried:
            self.log_in.refuse(f"{what} {remedy}", self._left_s(self._tried))
        elif self._controller.kept is not None:  # it was the demonstration that did not open
            self._refusal = what, remedy
            self.go_on()
        elif (self._folder / KEYS).exists():
            self._refusal = None
            self.begin()
            self.show_message(what, remedy)
        else:
            self.first_start.refuse(f"{what} {remedy}")
            self._show(self.first_start)

    def _on_key_kept(self) -> None:
        key, self._key = self._key, ""
        self._controller.run(_confirming(key), None, None, self)  # where that fails it is asked for again
        self._enter()

    def _confirm(self, typed: str) -> None:
        self._controller.run(_confirming(typed), self._on_confirmed, self._on_confirm_failed, self)

    def _on_confirmed(self, _nothing: object) -> None:
        self._enter()

    def _on_confirm_failed(self, what: str, remedy: str) -> None:
        self.first_start.ask_for_recovery_key()
        self.first_start.show_typed_wrong(f"{what} {remedy}")

    def _on_renew_requested(self) -> None:
        def renew(opened: "OpenedLibrary") -> str:
            assert opened.data_key is not None  # the demonstration's is not asked for
            return opened.slots.renew_recovery_key(opened.data_key)

        self._controller.run(renew, self._on_renewed, self._on_confirm_failed, self)

    def _on_renewed(self, key: str) -> None:
        if self.is_covering:  # then it is asked for, or made again
            return
        self._key = key
        self.first_start.show_recovery_key(key)

    def _enter(self) -> None:
        state, self._new = self._new, None
        if state is not None:
            self.entered.emit(state)

    def _on_print_requested(self, key: str) -> None:
        self._key_sheet().print(key, self._folder)

    def _on_save_requested(self, key: str) -> None:
        self._key_sheet().save(key, self._folder)

    def _key_sheet(self) -> "KeySheet":
        if self._sheet is None:
            from app.home.login.recovery_key_sheet import KeySheet  # needed once in a library's life

            self._sheet = KeySheet(self.first_start)
            self._sheet.reported.connect(self.show_message)
        return self._sheet

    def _left_s(self, code: str) -> float:
        return self._delay.left_s(code) if self._delay is not None else 0.0


def _confirming(typed: str) -> "Callable[[OpenedLibrary], None]":
    """What keeps that the recovery key was confirmed; then nobody is asked for it any more."""

    def confirm(opened: "OpenedLibrary") -> None:
        opened.slots.confirm_recovery_key(typed)

    return confirm


def _library_in_words(server: str | None) -> str:
    """Which library a clinic's is, without its user; nothing of one in a folder."""
    if server is None:
        return ""
    if not server:
        return tr("The clinic's library on this computer")
    return tr("The clinic's library on {server}").format(server=server)


def _too_many() -> str:
    return tr("Wrong passphrases were entered before. Wait for the next attempt, or use the recovery key.")


def _is_end_of_key(typed: str, shown: str) -> bool:
    from app.storage.keys import is_end_of_recovery_key  # cryptography

    return is_end_of_recovery_key(typed, shown)

"""What home shows above its pages of the library that was opened: its age, and what was done without its server."""

from PySide6.QtCore import QObject, Signal

from app.home.login.controller import ADMINISTRATOR
from app.widgets.banner import Banner
from app.wording.translation import tr, tr_n
from app.workers.library_controller import LibraryController
from app.workers.library_state import OpenedState
from app.workers.refusals import Refusal


class LibraryNotices(QObject):
    """Two banners: `rollback`, of a library that is older than this computer has seen, and `away`."""

    refused = Signal(str, str)  # why the older state could not be accepted

    def __init__(self, controller: LibraryController, parent: QObject) -> None:
        super().__init__(parent)
        self._controller = controller
        self._state: OpenedState | None = None
        self.rollback, self.away = Banner(), Banner()
        self.rollback.acted.connect(self._on_accepted)
        controller.server_back.connect(self._on_server_back)

    def show(self, state: OpenedState) -> None:
        self._state = state
        self._show_rollback(state)
        self._show_away(state)

    def forget(self) -> None:
        self._state = None
        self.rollback.hide()
        self.away.hide()

    def _show_rollback(self, state: OpenedState) -> None:
        """Say that the library is an older state than this computer has seen, and let an administrator accept it."""
        rollback = state.rollback
        self.rollback.hide()
        if rollback is None:
            return
        is_administrator = state.operator.role.value == ADMINISTRATOR
        missing = tr("Audit entries {first} to {last} are not all present.")
        then = tr("If a backup was restored, accept this state. Otherwise someone put an older copy here.")
        if not is_administrator:
            then = tr("Inform an administrator, who can check this and accept it if a backup was restored.")
        self.rollback.show_message(
            tr("This library is older than the one last opened on this computer."),
            f"{missing.format(first=rollback.first, last=rollback.last)} {then}",
            tr("Accept this state") if is_administrator else "",
        )

    def _on_accepted(self) -> None:
        if self._state is not None and (rollback := self._state.rollback) is not None:
            self._controller.call(
                lambda holder: holder.accept_rollback(rollback), self._on_noted, self._on_refused, self
            )

    def _on_noted(self, _nothing: object) -> None:
        self.rollback.hide()

    def _on_refused(self, what: str, remedy: str) -> None:
        self.refused.emit(what, remedy)

    def _show_away(self, state: OpenedState) -> None:
        """Say that the clinic's server is not there, or what became of what was done when it was not."""
        self.away.hide()
        if state.is_away:
            self.away.show_message(
                tr("You are working offline, without the clinic's server."),
                tr(
                    "New sessions stay on this computer. They move to the server at the first login after it "
                    "responds again. Clinic patients are not shown. The sessions are matched to them later by "
                    "patient code."
                ),
            )
        elif state.still_away is not None:
            self.away.show_message(*still_away_words(state.still_away))
        elif state.brought_from_away:
            stated = tr_n(
                "{count} offline session is now on the clinic's server.",
                "{count} offline sessions are now on the clinic's server.",
                state.brought_from_away,
            )
            self.away.show_message(stated.format(count=state.brought_from_away))

    def _on_server_back(self) -> None:
        self.away.show_message(
            tr("The clinic's server responds again."),
            tr("Log in to make recordings from here available to all workstations."),
            tr("Log in to the server"),
        )


def still_away_words(why: Refusal) -> tuple[str, str]:
    """Give the words about sessions that the clinic's server refused: the reason, then the remedy."""
    what = tr("Offline sessions are still on this computer only.")
    then = tr("No data are lost. Each login tries again to send them to the server.")
    return what, f"{then} {why.what} {why.remedy}"

"""What an open library answers, as the application asks it: on the library's own thread."""

from collections.abc import Callable
from pathlib import Path
from threading import current_thread, main_thread

from PySide6.QtCore import QObject
from pytestqt.qtbot import QtBot

from app.storage.opened import OpenedLibrary
from app.workers.jobs import Failed, Progressed
from app.workers.library_controller import LibraryController
from app.workers.library_holder import LibraryHolder
from app.workers.library_state import NotOpened, OpenedState

Done = Callable[[object], object]
Opening = Callable[[LibraryHolder], OpenedState | NotOpened]


class Asker(QObject):
    """Notes what it is reported, and where."""

    def __init__(self) -> None:
        super().__init__()
        self.results: list[object] = []
        self.refusals: list[tuple[str, str]] = []
        self.shares: list[float] = []
        self.threads = {main_thread()}

    @property
    def ears(self) -> tuple[Done, Failed, QObject]:
        """What a call is given of it."""
        return self.on_done, self.on_failed, self

    @property
    def all_ears(self) -> tuple[Done, Failed, Progressed, QObject]:
        """What long work is given of it."""
        return self.on_done, self.on_failed, self.on_progressed, self

    def on_done(self, result: object) -> None:
        self.threads.add(current_thread())
        self.results.append(result)

    def on_failed(self, what: str, remedy: str) -> None:
        self.threads.add(current_thread())
        self.refusals.append((what, remedy))

    def on_progressed(self, share: float, _what: str) -> None:
        self.shares.append(share)


def opening(folder: Path, passphrase: str, code: str = "") -> Opening:
    return lambda holder: holder.open(folder, passphrase, code)


def opened(qtbot: QtBot, controller: LibraryController, folder: Path, passphrase: str, code: str = "") -> OpenedState:
    return opened_by(qtbot, controller, opening(folder, passphrase, code))


def opened_by(qtbot: QtBot, controller: LibraryController, ask: Opening) -> OpenedState:
    """What comes of asking to open a library that does open."""
    with qtbot.waitSignal(controller.opened):
        controller.open(ask)
    assert controller.state is not None
    return controller.state


def not_opened_by(qtbot: QtBot, controller: LibraryController, ask: Opening) -> tuple[str, str, bool]:
    """The two sentences, and whether it was the key, of one that does not open."""
    with qtbot.waitSignal(controller.not_opened) as reported:
        controller.open(ask)
    what, remedy, is_key = reported.args or []
    return str(what), str(remedy), bool(is_key)


def asked(qtbot: QtBot, controller: LibraryController, call: Callable[[OpenedLibrary], object]) -> object:
    asker = Asker()
    controller.run(call, asker.on_done, None, asker)
    qtbot.waitUntil(lambda: bool(asker.results))
    return asker.results[0]

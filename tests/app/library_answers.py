"""What an open library answers to one question, as the application asks it: on the library's own thread."""

from collections.abc import Callable

from PySide6.QtCore import QObject
from pytestqt.qtbot import QtBot

from app.storage.opened import OpenedLibrary
from app.workers.library_controller import LibraryController


class AnswerKeeper(QObject):
    def __init__(self) -> None:
        super().__init__()
        self.answers: list[object] = []

    def on_done(self, answer: object) -> None:
        self.answers.append(answer)


def asked(qtbot: QtBot, controller: LibraryController, call: Callable[[OpenedLibrary], object]) -> object:
    keeper = AnswerKeeper()
    controller.run(call, keeper.on_done, None, keeper)
    qtbot.waitUntil(lambda: bool(keeper.answers), timeout=10_000)
    return keeper.answers[0]

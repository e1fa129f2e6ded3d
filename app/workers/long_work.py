"""What takes a while in the library, one at a time: home shows its title and how far it is until it ends."""

from PySide6.QtCore import QObject, Signal

from app.workers.library_controller import LibraryController


class LongWork(QObject):
    """Begins work of the library for a page, and passes on its title and progress."""

    working = Signal(str)  # it began: its title
    progressed = Signal(float, str)  # the share that is done, and what is being done

    def __init__(self, controller: LibraryController, parent: QObject) -> None:
        super().__init__(parent)
        self._controller = controller
        self.is_working = False

    def stop(self) -> None:
        """End what runs."""
        raise NotImplementedError

    def _begin(self, title: str) -> None:
        self.is_working = True
        self.working.emit(title)

    def _on_progressed(self, share: float, what: str) -> None:
        self.progressed.emit(share, what)

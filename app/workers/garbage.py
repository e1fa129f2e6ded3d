"""Who collects garbage? The screen's thread alone, between frames: what it holds of Qt must not end on another."""

import gc

from PySide6.QtCore import QObject, QTimer

LOOK_MS = 1000


class GarbageCollector(QObject):
    """From when it is made until the program ends, nothing else collects. As often as Python would, but once a second
    at most.
    """

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        gc.disable()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._on_timeout)
        self._timer.start(LOOK_MS)

    def pass_over_imported(self) -> None:
        """Look no more through what is there now: each time that would take a tenth of a second."""
        gc.freeze()

    def _on_timeout(self) -> None:
        pairs = enumerate(zip(gc.get_count(), gc.get_threshold(), strict=True))
        due = [generation for generation, (count, limit) in pairs if count > limit]
        if due:
            gc.collect(max(due))

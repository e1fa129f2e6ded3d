"""Garbage collection by the screen's thread alone, between frames.

What it holds of Qt must not end on another thread.
"""

import gc
from collections.abc import Callable

from PySide6.QtCore import QObject, QTimer

LOOK_MS = 1000


class GarbageCollector(QObject):
    """From when it is made until the program ends, nothing else collects. As often as Python would, but once a second
    at most, and not while much is imported, which is about to be passed over.
    """

    def __init__(self, parent: QObject, is_importing: Callable[[], bool]) -> None:
        super().__init__(parent)
        self._is_importing = is_importing
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
        if due and not self._is_importing():
            gc.collect(max(due))

"""The walking step as the wizard looks at it."""

from collections.abc import Iterator
from contextlib import contextmanager

from PySide6.QtCore import QTimer
from pytestqt.qtbot import QtBot

from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep

TICK_MS = 10


@contextmanager
def shown_step(qtbot: QtBot, visit: Visit, height: int = 600, *, is_entered: bool = True) -> Iterator[WalkingStep]:
    """On its page, ticking; left at the end. Not `is_entered`: whoever asks enters it."""
    step = WalkingStep(visit)
    qtbot.addWidget(step.page)
    step.page.resize(1064, height)
    step.page.show()
    if is_entered:
        step.enter()
    timer = QTimer()
    timer.setInterval(TICK_MS)
    timer.timeout.connect(step.tick)
    timer.start()
    yield step
    timer.stop()
    step.leave()

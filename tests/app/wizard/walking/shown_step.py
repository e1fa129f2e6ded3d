"""The walking step as the wizard looks at it."""

from collections.abc import Iterator
from contextlib import contextmanager

from PySide6.QtCore import QTimer
from pytestqt.qtbot import QtBot

from app.wizard.keys import Intent, KeyAction
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from core.session import RecordingKind
from tests.app.wizard.begun_visit import record

TICK_MS = 10
RUN = Intent(KeyAction.RUN)


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


def start(qtbot: QtBot, step: WalkingStep, visit: Visit) -> None:
    with qtbot.waitSignal(visit.recordings.begun):
        assert step.on_intent(RUN)


def stop(qtbot: QtBot, step: WalkingStep, visit: Visit) -> None:
    with qtbot.waitSignal(visit.recordings.ended):
        step.on_intent(RUN)


def calibrate(qtbot: QtBot, visit: Visit) -> None:
    """By standing and a free motion, until both are evaluated."""
    with qtbot.waitSignal(visit.evaluation.done):
        record(qtbot, visit, RecordingKind.STANDING, 4.0)
        record(qtbot, visit, RecordingKind.FREE_MOTION, 14.0)

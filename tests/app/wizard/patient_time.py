"""The time of a simulated patient, which goes on only when everybody has received what was before.

A replay by the machine's clock goes on while a busy machine's screen, library or live estimator is late: then a walk is
over before its recording has begun, and strides are never seen. Here nobody misses anything, however long it takes.
"""

from collections.abc import Callable, Iterator, Mapping

import pytest
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.acquisition.acquisition import Acquisition, LiveEstimator
from app.wizard.worn_sensors import SourceChoice
from core.samples import ImuBlock
from core.session import Session
from devices.clocks.host_clock import host_time_ns
from devices.live import LiveSource
from devices.simulation.replay import ReplaySource

TICK_MS = 10
TICK_NS = 50_000_000
BEHIND_S = 0.2  # what a reader and the thread of the live estimator have not passed on yet


class PatientTime:
    """A clock for a replay and for the acquisition that receives it.

    Attributes
    ----------
    is_held
        Whether time is still; asked before each tick.
    """

    def __init__(self) -> None:
        self._now_ns = host_time_ns()
        self._acquisition: _Followed | None = None
        self.is_held: Callable[[], bool] = lambda: False
        self._timer = QTimer()
        self._timer.setInterval(TICK_MS)
        self._timer.timeout.connect(self._pass_on)

    def start(self) -> None:
        self._timer.start()

    def stop(self) -> None:
        self._timer.stop()

    def now_ns(self) -> int:
        return self._now_ns

    def acquisition(self, source: LiveSource) -> Acquisition:
        """What receives a source, and is waited for from now on."""
        self._acquisition = _Followed([source], self.now_ns)
        return self._acquisition

    def wait(self, qtbot: QtBot, seconds: float) -> None:
        """Let the patient go on for so long."""
        until_ns = self._now_ns + round(seconds * 1e9)
        qtbot.waitUntil(lambda: self._now_ns >= until_ns)

    def _pass_on(self) -> None:
        if self.is_held() or (self._acquisition is not None and self._acquisition.behind_s() > BEHIND_S):
            return
        self._now_ns += TICK_NS


class _Followed(Acquisition):
    """An acquisition that knows how far its live estimator has come."""

    _received: "_Received | None" = None

    def behind_s(self) -> float:
        return 0.0 if self._received is None else self.now_s - self._received.received_s

    def set_estimator(self, estimator: LiveEstimator | None) -> None:
        self._received = None if estimator is None else _Received(estimator, self.now_s)
        super().set_estimator(self._received)


class _Received:
    """A live estimator, and the last stamp that it has had."""

    def __init__(self, estimator: LiveEstimator, now_s: float) -> None:
        self._estimator, self.received_s = estimator, now_s

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        self._estimator.update(blocks)
        self.received_s = max(float(block.time_s[-1]) for block in blocks.values())


# fixtures: a room's conftest.py takes them over


@pytest.fixture
def patient_time(qapp: QApplication) -> Iterator[PatientTime]:
    time = PatientTime()
    time.start()
    yield time
    time.stop()


@pytest.fixture
def source(simulated_session: Session, patient_time: PatientTime) -> ReplaySource:
    return ReplaySource(simulated_session, now_ns=patient_time.now_ns)


@pytest.fixture
def choice(source: ReplaySource, patient_time: PatientTime) -> SourceChoice:
    return SourceChoice("fast", "Fast patient", lambda: patient_time.acquisition(source), is_simulated=True)

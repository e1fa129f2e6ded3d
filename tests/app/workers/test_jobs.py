"""What a job holds of Qt ends on the screen's thread, whoever lets go of the job last."""

from collections.abc import Iterator
from threading import Event
from weakref import ref

import pytest
from PySide6.QtCore import QObject, Qt
from pytestqt.qtbot import QtBot

from app.workers.jobs import Job, JobThread
from tests.waiting import PATIENCE_S
from tests.wrappers import Wrappers


@pytest.fixture
def lane(qtbot: QtBot) -> Iterator[JobThread]:
    parent = QObject()
    lane = JobThread(parent)
    yield lane
    lane.finish()


class Asker(QObject):
    """A page that asks, and may be gone before the answer comes."""

    def __init__(self) -> None:
        super().__init__()
        self.go_on = Event()

    def job(self) -> Job:
        return Job(lambda: self.go_on.wait(PATIENCE_S), None, None, ref(self))


def test_who_asked_and_was_closed_meanwhile_ends_on_the_screens_thread(
    qtbot: QtBot, lane: JobThread, wrappers: Wrappers
) -> None:
    asker, is_reported, reported_of = Asker(), Event(), list[object]()
    go_on, gone = asker.go_on, ref(asker)
    lane.reported.connect(lambda _job, outcome: reported_of.append(outcome), Qt.ConnectionType.QueuedConnection)
    # the answer reaches the screen before the thread has let the job go
    lane.reported.connect(lambda _job, _outcome: is_reported.wait(PATIENCE_S), Qt.ConnectionType.DirectConnection)
    lane.ask(asker.job())
    del asker
    go_on.set()
    qtbot.waitUntil(lambda: reported_of == [True])
    is_reported.set()
    qtbot.waitUntil(lambda: gone() is None)
    assert wrappers.taken() == []


def test_a_job_is_kept_no_longer_than_until_its_thread_has_let_it_go(qtbot: QtBot, lane: JobThread) -> None:
    first, second = Asker(), Asker()
    gone, going_on = ref(first), second.go_on
    lane.ask(first.job())
    lane.ask(second.job())
    first.go_on.set()
    del first
    qtbot.waitUntil(lambda: gone() is None)
    going_on.set()

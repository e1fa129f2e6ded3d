"""Tests that the watchdog bites those who hold up the screen, and nobody else."""

import gc
import linecache
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator

import pytest
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.app.watchdog import Watchdog, slowness

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three


@pytest.fixture
def dog(qapp: QApplication) -> Iterator[Watchdog]:
    watching = Watchdog(slowness=lambda: 1.0)  # these work for so long, not so much
    watching.start()
    yield watching
    watching.stop()


def work_for(busy_s: float) -> None:
    end_s = time.thread_time() + busy_s
    while time.thread_time() < end_s:
        sum(range(500))


def run(qtbot: QtBot, held_up_by: Callable[[], None]) -> None:
    done: list[bool] = []

    def hold_up() -> None:
        held_up_by()
        done.append(True)

    QTimer.singleShot(0, hold_up)
    qtbot.waitUntil(lambda: bool(done))
    qtbot.wait(20)


def test_long_work_is_seen_with_its_place(qtbot: QtBot, dog: Watchdog) -> None:
    run(qtbot, lambda: work_for(0.2))
    (late,) = dog.late
    assert late.busy_s > 0.15
    assert "work_for" in str(late)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells how long others had the processor")
def test_a_long_wait_is_seen_with_its_place(qtbot: QtBot, dog: Watchdog) -> None:
    lock = threading.Lock()
    lock.acquire()

    def wait_for_a_lock() -> None:
        lock.acquire(timeout=0.3)

    run(qtbot, wait_for_a_lock)
    (late,) = dog.late
    assert late.waited_s > 0.2
    assert "wait_for_a_lock" in str(late)


def test_short_work_again_and_again_is_no_fault(qtbot: QtBot, dog: Watchdog) -> None:
    timer = QTimer()
    timer.timeout.connect(lambda: work_for(0.02))
    timer.start(0)
    qtbot.wait(400)
    timer.stop()
    assert dog.late == []


def test_a_slower_computer_is_given_more_time(qtbot: QtBot) -> None:
    dog = Watchdog(slowness=lambda: 2.0)
    dog.start()
    run(qtbot, lambda: work_for(0.2))
    assert dog.late == []
    run(qtbot, lambda: work_for(0.4))
    dog.stop()
    (late,) = dog.late
    assert late.busy_s > 0.3


def test_a_computer_is_never_taken_for_faster_than_the_one_of_the_limits() -> None:
    assert 1.0 <= slowness() < 50.0


def test_waiting_for_events_is_no_fault(qtbot: QtBot, dog: Watchdog) -> None:
    qtbot.wait(400)
    assert dog.late == []


def test_what_the_test_does_itself_is_no_fault(qtbot: QtBot, dog: Watchdog) -> None:
    with dog.paused():
        work_for(0.2)
    qtbot.wait(20)
    assert dog.late == []


def test_another_process_that_takes_the_processor_is_no_fault(qtbot: QtBot, dog: Watchdog) -> None:
    with dog.paused():
        loads = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2 * (os.cpu_count() or 2))]
    try:
        timer = QTimer()
        timer.timeout.connect(lambda: work_for(0.03))
        timer.start(0)
        qtbot.wait(1500)
        timer.stop()
    finally:
        for load in loads:
            load.kill()
            load.wait()
    assert dog.late == []


def test_what_lay_in_memory_before_is_kept_from_the_collector(qapp: QApplication) -> None:
    dog = Watchdog()
    dog.start()
    assert gc.get_freeze_count() > 0
    dog.stop()
    assert gc.get_freeze_count() == 0


class _Ended:
    """Notes which thread ends it."""

    def __init__(self, by: list[int]) -> None:
        self._by = by

    def __del__(self) -> None:
        self._by.append(threading.get_ident())


def test_what_a_late_function_holds_is_not_kept_alive(
    qtbot: QtBot, dog: Watchdog, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(linecache, "checkcache", lambda *_: time.sleep(0.3))  # telling a stack takes as long as it may
    by: list[int] = []

    def paint() -> None:
        _painter = _Ended(by)
        work_for(0.4)  # on a busy machine the watchdog looks late, too

    run(qtbot, paint)
    assert by == [threading.get_ident()]
    assert "paint" in str(dog.late[0])

"""Slow work beside the screen: its news arrives, and a stop stops it."""

from collections.abc import Callable, Iterator
from threading import Event

import pytest
from PySide6.QtCore import QThread
from pytestqt.qtbot import QtBot

from app.system.progress import Report
from app.workers.background import Background, Stopped
from tests.waiting import PATIENCE_S


@pytest.fixture
def background(qtbot: QtBot) -> Iterator[Background]:
    background = Background()
    yield background
    background.stop()
    qtbot.waitUntil(lambda: background.is_idle)


def until(event: Event) -> Callable[[Report], object]:
    """Give work that reports until `event`, and reports it when it was stopped instead."""

    def work(report: Report) -> str:
        while not event.wait(0.002):
            report(0.5, "left_knee")
        return "done"

    return work


def test_a_result_arrives_on_the_thread_of_the_screen(qtbot: QtBot, background: Background) -> None:
    threads: list[QThread] = []

    def work(_report: Report) -> int:
        threads.append(QThread.currentThread())
        return 7

    with qtbot.waitSignal(background.done) as got:
        background.start(work)
    assert got.args == [7]
    assert threads[0] is not QThread.currentThread()
    assert not background.is_busy


def test_progress_is_reported_while_the_work_runs(qtbot: QtBot, background: Background) -> None:
    go_on = Event()
    with qtbot.waitSignal(background.progressed) as got:
        background.start(until(go_on))
    assert got.args == [0.5, "left_knee"]
    assert background.is_busy
    with qtbot.waitSignal(background.done):
        go_on.set()


def test_work_that_reports_without_end_leaves_the_screen_in_peace(qtbot: QtBot, background: Background) -> None:
    reported: list[float] = []
    background.progressed.connect(lambda share, _what: reported.append(share))

    def work(report: Report) -> None:
        for count in range(20_000):
            report(count / 20_000, "left_knee")

    with qtbot.waitSignal(background.done):
        background.start(work)
    assert 1 <= len(reported) < 100
    assert reported == sorted(reported)


@pytest.mark.parametrize("is_done", [False, True])
def test_what_was_stopped_shows_once_it_has_ended_whether_it_was_done(
    qtbot: QtBot, background: Background, is_done: bool
) -> None:
    """Work whose last report is behind it comes to its end all the same."""
    go_on = Event()

    def work(report: Report) -> None:
        assert go_on.wait(PATIENCE_S)
        if not is_done:
            report(1.0, "")

    background.start(work)
    background.stop()
    with qtbot.waitSignal(background.stopped) as reported:
        go_on.set()
    assert reported.args == [is_done]


def test_what_comes_to_its_end_is_not_reported_as_stopped(qtbot: QtBot, background: Background) -> None:
    with qtbot.assertNotEmitted(background.stopped), qtbot.waitSignal(background.idle):
        background.start(lambda _report: 7)


def test_a_stop_ends_the_work_at_its_next_report(qtbot: QtBot, background: Background) -> None:
    stopped = Event()

    def work(report: Report) -> None:
        try:
            until(Event())(report)
        except Stopped:
            stopped.set()
            raise

    with qtbot.waitSignal(background.progressed):
        background.start(work)
    with qtbot.waitSignal(background.idle), qtbot.assertNotEmitted(background.done):
        background.stop()
        assert not background.is_busy
    assert stopped.is_set()


def test_nothing_is_received_of_stopped_work_that_ends_well_all_the_same(qtbot: QtBot, background: Background) -> None:
    go_on = Event()

    def work(_report: Report) -> str:
        go_on.wait(PATIENCE_S)  # deaf to the stop, as a long step of an analysis is
        return "late"

    background.start(work)
    with (
        qtbot.waitSignal(background.idle),
        qtbot.assertNotEmitted(background.done),
        qtbot.assertNotEmitted(background.failed),
    ):
        background.stop()
        go_on.set()


def test_newer_work_takes_the_place_of_older(qtbot: QtBot, background: Background) -> None:
    results: list[object] = []
    background.done.connect(results.append)
    with qtbot.waitSignal(background.progressed):
        background.start(until(Event()))
    with qtbot.waitSignal(background.idle):
        background.start(lambda _report: "newer")
    assert results == ["newer"]


def test_what_the_work_raises_arrives_as_it_is(qtbot: QtBot, background: Background) -> None:
    error = ValueError("no samples")

    def work(_report: Report) -> None:
        raise error

    with qtbot.waitSignal(background.failed) as got:
        background.start(work)
    assert got.args == [error]
    assert not background.is_busy


def test_after_the_end_of_the_program_nothing_begins_any_more(background: Background) -> None:
    begun: list[int] = []
    background.start(lambda _report: begun.append(1))
    background.finish()
    assert begun == [1]
    background.start(lambda _report: begun.append(2))
    assert background.is_idle
    assert not background.is_busy
    assert begun == [1]

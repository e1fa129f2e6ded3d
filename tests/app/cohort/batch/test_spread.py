"""Tasks are handed out in groups of a second, each is finished once, and a lost worker costs its own task at most."""

import os
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from itertools import count
from pathlib import Path

import pytest

from app.cohort.batch import executors, spread
from app.cohort.batch.executors import ProcessExecutor, SerialExecutor, of_this_computer
from app.cohort.batch.spread import ClusterLostError, WorkerLostError, Workers, finished, work_group
from tests.app.batch_stand_ins import (
    StandIn,
    begun,
    digest_of,
    ends_its_worker,
    ends_its_worker_once,
    fails,
    sleeps,
)

SERIAL = Workers(SerialExecutor(), lambda: 1, most_tries=1, has_queue=False)


class LosingExecutor(SerialExecutor):
    """Loses its worker at every group with one of these numbers, `times` over, and notes the size of each group."""

    def __init__(self, poison: int, times: int = 1000) -> None:
        self.poison, self.times = poison, times
        self.sizes: list[int] = []

    def submit(self, fn: Callable[..., object], /, *args: object, **kwargs: object) -> Future[object]:  # type: ignore[override]  # it is given groups only
        _, tasks = args
        assert isinstance(tasks, tuple)
        self.sizes.append(len(tasks))
        if self.times and any(task.number == self.poison for task in tasks):
            self.times -= 1
            lost: Future[object] = Future()
            lost.set_exception(WorkerLostError("it was ended by SIGKILL"))
            return lost
        return super().submit(fn, *args, **kwargs)


def tasks(count: int) -> Iterator[StandIn]:
    return (StandIn(number) for number in range(count))


def test_each_task_is_finished_once_with_its_own_result() -> None:
    found = list(finished(digest_of, tasks(500), SERIAL))
    assert Counter(task.number for task, _ in found) == Counter(range(500))
    assert all(result == digest_of(task) for task, result in found)


def test_what_a_task_raises_is_its_result_and_nobody_elses() -> None:
    found = {task.number: result for task, result in finished(fails, tasks(40), SERIAL)}
    assert all(isinstance(found[number], ValueError) for number in range(1, 40, 2))
    assert all(found[number] == digest_of(StandIn(number)) for number in range(0, 40, 2))


def test_short_tasks_go_together_and_long_ones_do_not(monkeypatch: pytest.MonkeyPatch) -> None:
    executor = LosingExecutor(-1)
    list(finished(digest_of, tasks(3000), Workers(executor, lambda: 1, 1, has_queue=False)))
    assert max(executor.sizes) > 500
    assert len(executor.sizes) < 20
    monkeypatch.setattr(spread, "GROUP_S", 0.001)
    executor = LosingExecutor(-1)
    list(finished(sleeps, (StandIn(2) for _ in range(10)), Workers(executor, lambda: 1, 1, has_queue=False)))
    assert set(executor.sizes) == {1}


def test_a_group_that_takes_long_stops_and_its_rest_is_done_later(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spread, "LONGEST_S", 0.004)
    group = work_group(sleeps, tuple(StandIn(3) for _ in range(10)))
    assert 1 <= len(group.results) < 10
    found = list(finished(sleeps, (StandIn(number) for number in range(6)), SERIAL))
    assert sorted(task.number for task, _ in found) == list(range(6))


def test_a_task_that_ends_its_worker_is_found_in_its_group_and_given_up_alone() -> None:
    executor = LosingExecutor(1500)
    found = list(finished(digest_of, tasks(3000), Workers(executor, lambda: 1, most_tries=3, has_queue=False)))
    assert Counter(task.number for task, _ in found) == Counter(range(3000))
    lost = [task.number for task, result in found if isinstance(result, WorkerLostError)]
    assert lost == [1500]


def test_a_task_that_loses_its_worker_now_and_then_is_done_all_the_same() -> None:
    executor = LosingExecutor(5, times=4)
    found = dict(finished(digest_of, tasks(20), Workers(executor, lambda: 1, most_tries=8, has_queue=False)))
    assert {task.number: result for task, result in found.items()} == {n: digest_of(StandIn(n)) for n in range(20)}


def test_only_a_few_tasks_are_ever_asked_for_ahead() -> None:
    asked = count()
    given = (StandIn(next(asked)) for _ in range(1000))
    some = finished(sleeps, given, Workers(SerialExecutor(), lambda: 4, 1))
    next(some)
    assert next(asked) <= 8


def test_a_cluster_that_is_gone_ends_all() -> None:
    class GoneExecutor(SerialExecutor):
        def submit(self, fn: Callable[..., object], /, *args: object, **kwargs: object) -> Future[object]:  # type: ignore[override]  # it takes nothing at all
            raise ConnectionError("closed")

    gone = Workers(GoneExecutor(), lambda: 1, 1, translate=lambda error: ClusterLostError(str(error)))
    with pytest.raises(ClusterLostError):
        list(finished(digest_of, tasks(3), gone))


class Hiccups(SerialExecutor):
    """Fails once with what nobody foresaw, before anything is done."""

    has_failed = False

    def submit(self, fn: Callable[..., object], /, *args: object, **kwargs: object) -> Future[object]:  # type: ignore[override]  # it takes any function, too
        if not self.has_failed:
            self.has_failed = True
            failed: Future[object] = Future()
            failed.set_exception(OSError("the answer was lost on its way"))
            return failed
        return super().submit(fn, *args, **kwargs)


def test_what_was_lost_on_its_way_is_done_again_and_given_up_after_some_tries() -> None:
    found = dict(finished(digest_of, tasks(20), Workers(Hiccups(), lambda: 1, most_tries=2)))
    assert {task.number: result for task, result in found.items()} == {n: digest_of(StandIn(n)) for n in range(20)}
    ((_, lost),) = finished(digest_of, tasks(1), Workers(Hiccups(), lambda: 1, most_tries=1))
    assert str(lost) == "the answer was lost on its way"


@pytest.mark.endurance  # processes take seconds to start; what they are reported is held above
def test_processes_give_what_this_process_gives_and_a_killed_one_costs_its_own_task_only(tmp_path: Path) -> None:
    notes = str(tmp_path)
    given = [StandIn(number, notes) for number in range(30)]
    with of_this_computer(2) as workers:
        found = dict(finished(ends_its_worker_once, iter(given), workers))
    assert {task.number: result for task, result in found.items()} == {n: digest_of(StandIn(n)) for n in range(30)}
    assert begun(given[13]) == 2


@pytest.mark.endurance  # processes take seconds to start; what they are reported is held above
def test_a_task_that_kills_every_worker_ends_as_a_failure_with_its_reason() -> None:
    executor = ProcessExecutor(2)
    found = dict(finished(ends_its_worker, tasks(20), Workers(executor, lambda: 2, most_tries=2)))
    executor.shutdown()
    lost = {task.number: result for task, result in found.items() if isinstance(result, Exception)}
    assert list(lost) == [13]
    assert str(lost[13]) == "it was ended by SIGKILL"
    assert len(found) == 20


@pytest.mark.endurance  # processes take seconds to start
def test_a_process_is_renewed_before_what_libraries_keep_of_each_task_fills_the_memory(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(executors, "CALLS_EACH", 4)
    executor = ProcessExecutor(1)
    found = [executor.submit(os.getpid).result() for _ in range(10)]
    executor.shutdown()
    assert [found.count(pid) for pid in dict.fromkeys(found)] == [4, 4, 2]


def test_processes_that_are_stopped_are_gone() -> None:
    executor = ProcessExecutor(2)
    futures = [executor.submit(work_group, sleeps, (StandIn(60_000),)) for _ in range(3)]
    while len(executor.pids()) < 2:
        assert not futures[2].done()
    executor.stop()
    assert executor.pids() == ()
    assert all(future.cancelled() or isinstance(future.exception(), WorkerLostError) for future in futures)

"""The loop that hands tasks out to workers, in groups of about a second, and again where a worker was lost.

A cluster takes 11 to 15 ms for whatever it is given, so short tasks go together; how many is learned from those that
are finished. A group stops after a while, too, and what is left of it goes out again: a thousand sessions of which
nothing changed take no longer than one, and one that changed among them must not make the others wait.
"""

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass, field
from itertools import islice
from time import perf_counter
from typing import Generic, TypeVar

T = TypeVar("T")
R = TypeVar("R")

GROUP_S = 1.0  # of work, so that handing out costs a hundredth
LONGEST_S = 2.0  # after which a group begins no further task
MOST_TOGETHER = 1000
LOOK_S = 5.0  # between two looks at how many workers there are


class WorkerLostError(Exception):
    """A worker ended before its task did; `how` states what is known of it."""

    def __init__(self, how: str) -> None:
        super().__init__(how)
        self.how = how


class ClusterLostError(Exception):
    """Nobody can be given a task any more."""


@dataclass(slots=True)
class SelectionResult(Generic[T]):
    """What came of a selection of sessions so far. `failures`: reasons by what the sessions are called."""

    total: int
    analysed: int = 0
    as_before: int = 0
    failures: dict[T, str] = field(default_factory=dict)

    @property
    def finished(self) -> int:
        return self.analysed + self.as_before + len(self.failures)


@dataclass(frozen=True, slots=True)
class Workers:
    """Who does the tasks.

    `count`: how many of them there are just now; raises ClusterLostError where there has been none for long.
    `has_queue`: whether a task should lie ready for each worker that is at work. In this process nobody would fetch it.
    `most_together`: how many tasks may go out as one; what is done of a group that is broken off is lost with the rest
    of it.
    `translate`: what an exception of this executor is: a `WorkerLostError`, a `ClusterLostError`, or itself.
    """

    executor: Executor
    count: Callable[[], int]
    most_tries: int  # how often a task may lose its worker until it is given up
    has_queue: bool = True
    most_together: int = MOST_TOGETHER
    translate: Callable[[Exception], Exception] = lambda error: error

    @property
    def most_groups(self) -> int:
        return max(1, self.count()) * (2 if self.has_queue else 1)


@dataclass(frozen=True, slots=True)
class TaskGroup(Generic[T]):
    """Tasks that go out together; `tries`: how often they did and lost their worker."""

    tasks: tuple[T, ...]
    tries: int = 0


@dataclass(frozen=True, slots=True)
class GroupResult(Generic[R]):
    """What came of the first tasks of a group, and how long they took."""

    results: tuple[R | Exception, ...]
    took_s: float


def work_group(work: Callable[[T], R], tasks: tuple[T, ...]) -> GroupResult[R]:
    """Do tasks, one after the other, until the group has taken long enough. Runs where the worker is."""
    began_s = perf_counter()
    results: list[R | Exception] = []
    for task in tasks:
        if results and perf_counter() - began_s > LONGEST_S:
            break
        try:
            results.append(work(task))
        except Exception as error:  # one task's fault is not that of the others
            results.append(error)
    return GroupResult(tuple(results), perf_counter() - began_s)


def finished(work: Callable[[T], R], tasks: Iterator[T], workers: Workers) -> Iterator[tuple[T, R | Exception]]:
    """Yield each task with its result or exception; `tasks` is read only as needed; raises ClusterLostError."""
    again: deque[TaskGroup[T]] = deque()
    running: dict[Future[GroupResult[R]], TaskGroup[T]] = {}
    together = 1
    try:
        while True:
            while len(running) < workers.most_groups:
                group = again.popleft() if again else TaskGroup(tuple(islice(tasks, together)))
                if not group.tasks:
                    break
                running[_given(workers, work, group)] = group
            if not running:
                return
            done, _ = wait(running, LOOK_S, FIRST_COMPLETED)
            for future in done:
                group = running.pop(future)
                result = _result(workers, future)
                if isinstance(result, Exception):  # the worker was lost, or what it was given or gave could not travel
                    if len(group.tasks) == 1 and group.tries + 1 >= workers.most_tries:
                        yield group.tasks[0], result
                    else:
                        again.extend(_parts(group))
                    continue
                count = len(result.results)
                if count < len(group.tasks):
                    again.append(TaskGroup(group.tasks[count:]))
                together = min(_next_size(together, result), workers.most_together)
                yield from zip(group.tasks[:count], result.results, strict=True)
    finally:
        for future in running:
            future.cancel()


def _given(workers: Workers, work: Callable[[T], R], group: TaskGroup[T]) -> "Future[GroupResult[R]]":
    try:
        return workers.executor.submit(work_group, work, group.tasks)
    except Exception as error:
        failed: Future[GroupResult[R]] = Future()
        failed.set_exception(error)
        return failed


def _result(workers: Workers, future: "Future[GroupResult[R]]") -> GroupResult[R] | Exception:
    """Give a group's results or its exception; raises ClusterLostError where workers are out of reach."""
    if future.cancelled():  # we cancel nothing that we wait for
        raise ClusterLostError("it gave up what it was given")
    error = future.exception()
    if error is None:
        return future.result()
    if not isinstance(error, Exception):
        raise error
    reported = workers.translate(error)
    if isinstance(reported, ClusterLostError):
        raise reported from error
    return reported


def _parts(group: TaskGroup[T]) -> tuple[TaskGroup[T], ...]:
    """A group that did not come back goes again in halves: whichever task is the reason is alone in the end."""
    tasks = group.tasks
    if len(tasks) == 1:
        return (TaskGroup(tasks, group.tries + 1),)
    half = len(tasks) // 2
    return TaskGroup(tasks[:half]), TaskGroup(tasks[half:])


def _next_size(together: int, result: GroupResult[R]) -> int:
    each_s = result.took_s / len(result.results)
    return max(1, min(int(GROUP_S / max(each_s, 1e-6)), 2 * together, MOST_TOGETHER))

"""Who does the tasks of a batch: this process, processes of this computer, or the workers of a Dask cluster.

All three are a `concurrent.futures.Executor`. The pool of the standard library gives up as a whole when one of its
processes is killed, with everything that was given to it; ours has a thread for each process, so that a killed one
costs the task that it was at, and nobody else notices.
"""

import logging
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import Connection
from multiprocessing.context import BaseContext
from typing import Any, ParamSpec, TypeVar

from app.cohort.batch.spread import WorkerLostError, Workers

P = ParamSpec("P")
R = TypeVar("R")

Call = tuple[Callable[..., Any], tuple[object, ...], dict[str, object]]

MOST_TRIES = 8  # of a task: where one worker of two is killed every 5 s, one of two seconds loses all in 40 million
MOST_STARTS = 20  # of a process that ends before it does anything
PRELOADED = ("app.cohort.batch.task",)  # and with it all that computes
BEGUN = "begun"
CALLS_EACH = 100  # of a process, which is then renewed: what writes reports and logs keeps 2 to 5 MB of each
ENDING_S = 5.0  # until a process that has nothing to do any more is killed


class SerialExecutor(Executor):
    """Does what it is given at once, here."""

    def submit(self, fn: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        future: Future[R] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # whoever asks for the result gets it
            future.set_exception(error)
        return future


class ProcessExecutor(Executor):
    """Processes of this computer, of which a killed one costs only what it was doing: that raises WorkerLostError."""

    def __init__(self, count: int, preloaded: tuple[str, ...] = ()) -> None:
        """`preloaded`: modules that are imported once for all of them, so that a new one begins at once."""
        self._context = _fresh_processes(preloaded)
        self._threads = ThreadPoolExecutor(count, thread_name_prefix="of a worker")
        self._own = threading.local()
        self._lock = threading.Lock()
        self._processes: set[_WorkerProcess] = set()
        self._is_stopped = False
        self._count = count

    def begin(self) -> None:
        """Start the processes now, so that they import what they need while this one does."""
        at_once = threading.Barrier(self._count)  # of which each thread comes by once, or one would start them all
        for _ in range(self._count):
            self._threads.submit(self._begin, at_once)

    def submit(self, fn: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        return self._threads.submit(self._ask, fn, args, kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self._threads.shutdown(wait, cancel_futures=cancel_futures)
        with self._lock:
            processes, self._processes = self._processes, set()
        for process in processes:
            process.end()

    def stop(self) -> None:
        """End at once; what is being done is lost."""
        with self._lock:
            self._is_stopped = True
            for process in self._processes:
                process.kill()
        self.shutdown(cancel_futures=True)

    def pids(self) -> tuple[int, ...]:
        """The processes that are there now."""
        with self._lock:
            return tuple(process.pid for process in self._processes)

    def _begin(self, at_once: threading.Barrier) -> None:
        at_once.wait()
        self._own.process = self._started(None)

    def _ask(self, fn: Callable[..., R], args: tuple[object, ...], kwargs: dict[str, object]) -> R:
        """Run it in this thread's process; raises WorkerLostError if that ends meanwhile or none starts."""
        for _ in range(MOST_STARTS):
            process: _WorkerProcess | None = getattr(self._own, "process", None)
            if process is None or not process.is_there or process.calls >= CALLS_EACH:
                process = self._own.process = self._started(process)
            has_begun = False
            try:
                process.give((fn, args, kwargs))
                has_begun = True
                answer, error = process.answer()
            except (EOFError, OSError) as problem:
                how = process.end()
                if has_begun or self._is_stopped:
                    raise WorkerLostError(how) from problem
                continue
            if error is not None:
                raise error
            return answer
        raise WorkerLostError(f"{how} before it had begun")

    def _started(self, before: "_WorkerProcess | None") -> "_WorkerProcess":
        if before is not None:
            before.end()
        process = _WorkerProcess(self._context)
        with self._lock:
            self._processes.discard(before) if before is not None else None
            self._processes.add(process)
            if self._is_stopped:
                process.kill()
        return process


class _WorkerProcess:
    """One process and the pipe to it; used by one thread. It ends when nobody holds the other end of the pipe."""

    def __init__(self, context: BaseContext) -> None:
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs,), name="batch worker", daemon=True)  # type: ignore[attr-defined]  # the stubs lack it
        self._process.start()
        theirs.close()
        self.pid, self.calls = self._process.pid or 0, 0

    @property
    def is_there(self) -> bool:
        return self._process.is_alive()

    def give(self, what: Call) -> None:
        """Send the call and wait until it begins (imports take seconds); raises EOFError or OSError if ended."""
        self.calls += 1
        self._pipe.send(what)
        self._pipe.recv()

    def answer(self) -> tuple[Any, Exception | None]:
        """What came of it, and what it raised; raises as `give`."""
        return self._pipe.recv()

    def kill(self) -> None:
        self._process.kill()

    def end(self) -> str:
        """Let it end, and say how it did."""
        self._pipe.close()
        self._process.join(ENDING_S)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        return _how(self._process.exitcode)


def _fresh_processes(preloaded: tuple[str, ...]) -> BaseContext:
    """Give a context that never forks this process with its threads and locks; a preloaded server if possible."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(preloaded))
    return context


def serve(pipe: "Connection[Any, Any]") -> None:
    """Do what comes through the pipe, until it is closed. The beginning of a worker process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl C reaches all of a terminal; who asks ends this process
    logging.getLogger().addHandler(logging.NullHandler())  # the log is the asking process's
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    while True:
        try:
            pipe.send(_answer(pipe.recv_bytes(), pipe))
        except (EOFError, OSError):  # nobody asks any more
            return


def _answer(asked: bytes, pipe: "Connection[Any, Any]") -> tuple[object, Exception | None]:
    """What comes of a call, or what it raised; reports in between that it is begun."""
    try:
        fn, args, kwargs = pickle.loads(asked)  # by the asking process, through a pipe that only it has
    except Exception as error:  # whoever asked gets it
        pipe.send(BEGUN)
        return None, error
    pipe.send(BEGUN)
    try:
        return fn(*args, **kwargs), None
    except Exception as error:  # whoever asked gets it
        return None, error


def _how(code: int | None) -> str:
    if code is not None and code < 0:
        try:
            return f"it was ended by {signal.Signals(-code).name}"
        except ValueError:
            return f"it was ended by signal {-code}"
    return f"it ended with {code}"


@contextmanager
def of_this_computer(count: int) -> Iterator[Workers]:
    """This process itself for one worker, else as many processes."""
    if count == 1:
        yield Workers(SerialExecutor(), lambda: 1, most_tries=1, has_queue=False, most_together=1)
        return
    executor = ProcessExecutor(count, PRELOADED)
    executor.begin()
    try:
        yield Workers(executor, lambda: count, MOST_TRIES)
    except BaseException:
        executor.stop()
        raise
    executor.shutdown()


def processors() -> int:
    """How many processors this program may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1

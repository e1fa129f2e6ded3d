"""T17: a batch whose workers are killed every few seconds. It must give what it gives undisturbed, each result once.

    python -m tests.safety.batch_kills --stand-ins 100000 --sessions 1000

Numbers that stand in for sessions, then sessions, are done in this process, by a pool of processes and by a Dask
cluster of this computer. Of the pool and of the cluster a worker is killed every `--every` seconds. What comes of all
three has to be equal by hash: of the numbers each result, once; of the sessions every file and the table.
"""

import argparse
import hashlib
import os
import random
import signal
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from app.cohort.batch.cluster import of_a_cluster
from app.cohort.batch.executors import MOST_TRIES, PRELOADED, ProcessExecutor, of_this_computer
from app.cohort.batch.spread import Workers, finished
from app.system.progress import nobody
from tests.app.batch_stand_ins import StandIn, digest_of
from tests.driver import Found, drive

WORKERS = 2
PRELOADED_OF_BOTH = (*PRELOADED, "distributed.nanny")  # a killed worker of the cluster is back in no time, too


class Killer:
    """Kills one of the workers every few seconds, until it is let go."""

    def __init__(self, pids: Callable[[], tuple[int, ...]], every_s: float, seed: int) -> None:
        self.kills = 0
        self._pids, self._every_s, self._rng = pids, every_s, random.Random(seed)
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._kill, name="killer")

    def __enter__(self) -> "Killer":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join()

    def _kill(self) -> None:
        while not self._ends.wait(self._every_s):
            if pids := self._pids():
                with suppress(ProcessLookupError):  # it ended by itself just now
                    os.kill(self._rng.choice(pids), signal.SIGKILL)
                    self.kills += 1


@contextmanager
def killed_pool(every_s: float, seed: int) -> Iterator[tuple[Workers, Killer]]:
    executor = ProcessExecutor(WORKERS, PRELOADED_OF_BOTH)
    with Killer(executor.pids, every_s, seed) as killer:
        yield Workers(executor, lambda: WORKERS, MOST_TRIES), killer
    executor.shutdown()


@contextmanager
def killed_cluster(every_s: float, seed: int) -> Iterator[tuple[Workers, Killer]]:
    with local_cluster() as cluster:

        def pids() -> tuple[int, ...]:
            nannies = list(cluster.workers.values())
            return tuple(nanny.process.pid for nanny in nannies if nanny.process is not None and nanny.process.pid)

        with of_a_cluster(cluster.scheduler_address) as workers, Killer(pids, every_s, seed) as killer:
            yield workers, killer


@contextmanager
def local_cluster() -> Iterator[Any]:
    """A Dask cluster of two processes on this computer, which nobody else reaches and which shows no page."""
    import dask
    from distributed import LocalCluster
    from distributed.utils import get_mp_context

    settings = {
        # a cluster on one computer gives up a worker that is not back in 15 s: on a busy machine it is killed before
        "distributed.deploy.lost-worker-timeout": "1 hour",
        "distributed.worker.multiprocessing-method": "forkserver",
    }
    with dask.config.set(settings):
        get_mp_context().set_forkserver_preload(list(PRELOADED_OF_BOTH))  # after it has stated what it would preload
    with (
        dask.config.set(settings),
        LocalCluster(
            n_workers=WORKERS, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1"
        ) as cluster,
    ):
        yield cluster


@contextmanager
def undisturbed() -> Iterator[tuple[Workers, None]]:
    with of_this_computer(1) as workers:
        yield workers, None


def stand_ins(count: int, every_s: float, rounds: int, required: str, found: Found) -> None:
    """Do so many numbers in three ways."""
    hashes = set[str]()
    for name, some in ways(every_s, required).items():
        with some as (workers, killer):
            began_s = time.perf_counter()
            given = (StandIn(number, rounds=rounds) for number in range(count))
            results = [(task.number, result) for task, result in finished(digest_of, given, workers)]
            note(found, f"{count} stand-ins, {name}", began_s, killer)
        times = Counter(Counter(number for number, _ in results).values())
        if times != {1: count}:
            found.faults.append(f"{name}: so many numbers came so often: {dict(times)}")
        failed = [number for number, result in results if isinstance(result, Exception)]
        if failed:
            why = {repr(result) for _, result in results if isinstance(result, Exception)}
            found.faults.append(f"{name}: {len(failed)} numbers failed: {sorted(why)[:3]}")
        hashes.add(hashlib.sha256(repr(sorted(results)).encode()).hexdigest())
    if len(hashes) > 1:
        found.faults.append(f"{count} stand-ins: the ways differ")


def sessions(folder: Path, count: int, every_s: float, required: str, found: Found) -> None:
    """Do so many sessions in three ways; each is another session."""
    # here, not above: each worker begins with this module, and is killed soon
    from app.cohort.batch.analysed_folder import AnalysisChoices
    from app.cohort.batch.done import batch_at
    from app.cohort.batch.run import Batch
    from app.cohort.batch.sources import SessionFolders
    from core.results import Method
    from tests.app.batch_material import results_in, write_swinging

    hashes = set[str]()
    choices = AnalysisChoices(Method.ROBUST, 2.0, has_report=False, has_log=False)
    write_swinging(folder / "in", count, most_patients=max(1, count // 3))
    for name, some in ways(every_s, required).items():
        out = folder / name
        with some as (workers, killer), batch_at(out) as batch:
            began_s = time.perf_counter()
            work = Batch(SessionFolders(folder / "in", out), batch, choices)
            work.run(workers, nobody)
            note(found, f"{count} sessions, {name}", began_s, killer)
        if (work.result.analysed, work.result.rows) != (count, 3 * count):
            found.faults.append(f"{name}: {work.result}")
        hashes.add(digest_in(results_in(out)))
    if len(hashes) > 1:
        found.faults.append(f"{count} sessions: the ways differ")


def ways(every_s: float, required: str) -> dict[str, Any]:
    known = {"serial": undisturbed(), "pool": killed_pool(every_s, 1), "dask": killed_cluster(every_s, 2)}
    return {name: known[name] for name in required.split(",")}


def note(found: Found, name: str, began_s: float, killer: Killer | None) -> None:
    found.figures[f"{name}, s"].append(time.perf_counter() - began_s)
    if killer is not None:
        found.count[f"workers killed of {name}"] = killer.kills


def digest_in(files: Mapping[str, bytes]) -> str:
    """Of all names and contents."""
    whole = hashlib.sha256()
    for name, content in files.items():
        whole.update(f"{name} {len(content)}\0".encode() + content)
    return whole.hexdigest()


def run(asked: argparse.Namespace, folder: Path) -> Found:
    found = Found()
    if asked.stand_ins:
        stand_ins(asked.stand_ins, asked.every, asked.rounds, asked.ways, found)
    if asked.sessions:
        sessions(folder, asked.sessions, asked.every, asked.ways, found)
    return found


if __name__ == "__main__":
    drive(
        __doc__,
        run,
        stand_ins=100_000,
        rounds=(500, "of a stand-in: how much work each is"),
        sessions=1000,
        ways="serial,pool,dask",
        every=(5.0, "seconds between two kills"),
    )

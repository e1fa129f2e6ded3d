"""Check that a batch's memory stays flat over a thousand sessions.

Watched in the process that leads it and in its workers.

    python -m tests.benchmarks.batch_memory --sessions 1000

Prints the resident memory of each, and of the processes that read the files, as the batch goes on. Workers are renewed
now and then, so their memory rises and falls: reported is the most of the first quarter, and of the last.
"""

import os
import tempfile
from collections import defaultdict
from pathlib import Path

from app.cohort.batch.analysed_folder import AnalysisChoices
from app.cohort.batch.done import batch_at
from app.cohort.batch.executors import MOST_TRIES, PRELOADED, ProcessExecutor
from app.cohort.batch.run import Batch
from app.cohort.batch.sources import SessionFolders
from app.cohort.batch.spread import Workers
from core.results import Method
from tests.benchmarks.batch_material import write_walks
from tests.driver import options

WORKERS, LINES = 2, 100


class Watch:
    """Notes the memory of this process, of its workers and of their children, whenever the batch states how far it
    is."""

    def __init__(self, executor: ProcessExecutor, sessions: int) -> None:
        self._executor, self._sessions, self._next = executor, sessions, 0
        self.noted: list[tuple[int, float, float, float]] = []

    def __call__(self, share: float, _what: str) -> None:
        done = round(share * self._sessions)
        if done < self._next:
            return
        self._next = done + max(1, self._sessions // LINES)
        workers = self._executor.pids()
        children = children_of_all()
        readers = [child for worker in workers for child in children[worker]]
        found = (memory_mib([os.getpid()]), memory_mib(workers), memory_mib(readers))
        self.noted.append((done, *found))
        print(
            f"{done:5d} sessions: leads {found[0]:6.1f} MiB, works {found[1]:6.1f}, reads {found[2]:6.1f}", flush=True
        )


def memory_mib(pids: list[int] | tuple[int, ...]) -> float:
    """Resident memory of the largest of some processes; 0 where there is none."""
    return max((resident_mib(pid) for pid in pids), default=0.0)


def resident_mib(pid: int) -> float:
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0.0
    return next((int(line.split()[1]) / 1024 for line in lines if line.startswith("VmRSS:")), 0.0)


def children_of_all() -> dict[int, list[int]]:
    children = defaultdict(list)
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(stat.read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
        children[parent].append(int(stat.parent.name))
    return children


def main() -> None:
    required = options(__doc__, sessions=1000, strides=12, bare=(False, "without report.pdf and session.rrd"))
    choices = AnalysisChoices(Method.ROBUST, 2.0, not required.bare, not required.bare)
    executor = ProcessExecutor(WORKERS, PRELOADED)
    with tempfile.TemporaryDirectory() as place:
        folder, out = Path(place) / "in", Path(place) / "out"
        write_walks(folder, required.sessions, min(required.sessions, 20), required.strides, 1)
        watch = Watch(executor, required.sessions)
        with batch_at(out) as batch:
            work = Batch(SessionFolders(folder, out), batch, choices)
            work.run(Workers(executor, lambda: WORKERS, MOST_TRIES), watch)
        executor.shutdown()
    print(f"{work.result.analysed} analysed, {len(work.result.failures)} failed")
    quarter = required.sessions / 4
    for name, first, last in (("first", 0.0, quarter), ("last", required.sessions - quarter, required.sessions)):
        noted = [one[1:] for one in watch.noted if first <= one[0] <= last]
        most = map(max, zip(*noted, strict=True))
        print("most in the {} quarter, MiB: leads {:.1f}, works {:.1f}, reads {:.1f}".format(name, *most))


if __name__ == "__main__":
    main()

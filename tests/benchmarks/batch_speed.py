"""Speed of a batch with two workers against one. The whole command is timed, from its start to its table.

    python -m tests.benchmarks.batch_speed --sessions 72 --pairs 5

One worker and two take turns on the same sessions, simulated walks with free motion; the ratio of each pair is taken,
then the median. 1.6 is required on two cores.
"""

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from tests.benchmarks.batch_material import write_walks
from tests.driver import options


def took_s(folder: Path, out: Path, workers: int, more: list[str]) -> float:
    command = [sys.executable, "-m", "app", "batch", str(folder), "--out", str(out), "--workers", str(workers), *more]
    began_s = perf_counter()
    subprocess.run(command, check=True, capture_output=True, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
    return perf_counter() - began_s


def main() -> None:
    required = options(
        __doc__,
        sessions=72,
        strides=40,
        walks=3,
        pairs=5,
        workers=2,
        bare=(False, "without report.pdf and session.rrd"),
    )
    more, ratios = ["--no-report", "--no-rrd"] if required.bare else [], []
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "in"
        write_walks(folder, required.sessions, min(required.sessions, 8), required.strides, required.walks)
        for pair in range(required.pairs):
            one_s, many_s = (
                took_s(folder, Path(place) / f"{pair} {workers}", workers, more) for workers in (1, required.workers)
            )
            ratios.append(one_s / many_s)
            each_s = one_s / required.sessions
            print(
                f"one worker {one_s:.1f} s ({each_s:.2f} s a session), {required.workers} workers {many_s:.1f} s: ",
                end="",
            )
            print(f"{ratios[-1]:.2f} times; load {os.getloadavg()[0]:.1f}", flush=True)
    print(f"{required.workers} workers are {statistics.median(ratios):.2f} times as fast (median of {required.pairs})")


if __name__ == "__main__":
    main()

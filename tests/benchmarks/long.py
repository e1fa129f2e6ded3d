"""Memory and time that a recording of hours takes.

    python -m tests.benchmarks.long [--hours 0.25 1]

Writes a session of six sensors at 100 Hz, one simulated minute of walking stated over and over, and runs
`gaitwright analyse` on it in a process of its own. Ten hours need 8 GB of disk for a while.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

from core.samples import ImuBlock
from devices.files.session_folder import write_session
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings, simulate
from tests.driver import options

ROOT = Path(__file__).parents[2]
STRIDES = 54  # about a minute
MAX_GIB = 2.0
ANALYSE = "analyse", "--no-rrd", "--no-report"


def make_session(folder: Path, hours: float) -> None:
    """Standing, circling and `hours` of walking; the walk is at both ends, so that its repetitions fit."""
    made = simulate(WalkerSettings(recordings=(Standing(), FreeMotion(), Walk(strides=STRIDES)))).session
    *calibrating, walk = made.recordings
    long = replace(walk, imu={site: repeated(block, 3600 * hours) for site, block in walk.imu.items()})
    write_session(replace(made, recordings=(*calibrating, long)), folder)


def repeated(block: ImuBlock, duration_s: float) -> ImuBlock:
    """The block's samples over and over until `duration_s` have passed, its clock running on evenly."""
    step_s = float(np.mean(np.diff(block.time_s)))
    count = round(duration_s / step_s)
    index = np.arange(count) % len(block)
    time_s = block.time_s[0] + step_s * np.arange(count)
    return ImuBlock(block.sensor, time_s, block.gyr_rad_s[index], block.acc_m_s2[index])


def analyse_apart(session: Path, out: Path) -> tuple[float, float]:
    """CPU seconds and the highest memory (GiB) of the command."""
    command = [sys.executable, "-m", "app", *ANALYSE, str(session), "--out", str(out)]
    with tempfile.TemporaryFile(mode="w+") as stated:
        process = subprocess.Popen(command, cwd=ROOT, stdout=stated, stderr=stated)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            stated.seek(0)
            raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}: {stated.read()}")
    kib = used.ru_maxrss if sys.platform != "darwin" else used.ru_maxrss / 1024
    return used.ru_utime + used.ru_stime, kib / 1024**2


def run(hours: Sequence[float], place: Path | None) -> None:
    print("| hours | CPU, s | CPU per hour, s | memory, GiB | under 2 GiB |")
    print("|---|---|---|---|---|")
    for h in hours:
        with tempfile.TemporaryDirectory(dir=place) as folder:
            session, out = Path(folder) / "session", Path(folder) / "out"
            # made in a process of its own: a child starts with the highest memory of its parent
            with ProcessPoolExecutor(1) as apart:
                apart.submit(make_session, session, h).result()
            cpu_s, gib = analyse_apart(session, out)
        print(f"| {h:g} | {cpu_s:.1f} | {cpu_s / h:.1f} | {gib:.2f} | {'yes' if gib < MAX_GIB else 'NO'} |", flush=True)


def main() -> None:
    required = options(
        __doc__,
        hours={"type": float, "nargs": "+", "default": [0.25, 1.0]},
        place={"type": Path, "help": "where the sessions are written (the system's temporary folder)"},
    )
    run(required.hours, required.place)


if __name__ == "__main__":
    main()

"""Size of what is installed, time until its window is there, and memory it takes.

    python -m tests.benchmarks.bundle [FOLDER] [--times 5]

FOLDER is what `packaging/build.py` froze (build/folder/gaitwright), or where it is installed. From just before the
program is started until its window is on a display of its own (Xvfb), with all files in the disk's cache: a new user's
first page. Memory is what is resident then, and the most that the demonstration takes from its start to its report.
With each the processor time, for the times grow with what else the machine does; its load is reported.
"""

import argparse
import os
import resource
import statistics
import subprocess
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from tests.benchmarks.own_display import own_display, own_environment

ROOT = Path(__file__).parents[2]
SETTLED_S = 6.0  # until all that is imported beside the screen is there
LONGEST_S = 120.0
LOOK_S = 0.01


def size_mb(folder: Path) -> float:
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file() and not file.is_symlink()) / 1e6


def window_start(program: Path, environment: Mapping[str, str]) -> tuple[float, float, float]:
    """Start the window once.

    Returns
    -------
    there_s, work_s, resident_mb : float
        Until it is on the display; processor time until it has settled; resident memory then.
    """
    began_s = time.monotonic()
    process = subprocess.Popen([program], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    search = ["xdotool", "search", "--onlyvisible", "--name", "^Gaitwright"]
    try:
        while subprocess.run(search, env=environment, stdout=subprocess.DEVNULL).returncode != 0:
            if process.poll() is not None or time.monotonic() - began_s > LONGEST_S:
                raise RuntimeError("no window came")
            time.sleep(LOOK_S)
        there_s = time.monotonic() - began_s
        time.sleep(SETTLED_S)
        place = Path("/proc") / str(process.pid)
        lines = (place / "status").read_text(encoding="ascii").splitlines()
        resident_kb = next(int(line.split()[1]) for line in lines if line.startswith("VmRSS"))
        fields = (place / "stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
        work_s = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    finally:
        process.terminate()
        process.wait()
    return there_s, work_s, resident_kb / 1e3


def demonstration(program: Path) -> tuple[float, float, float]:
    """Make the demonstration once: time and processor time in s, and the most memory in MB."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as folder:
        began_s = time.monotonic()
        subprocess.run([program, "demo", "--out", Path(folder) / "demo"], check=True, capture_output=True)
        took_s = time.monotonic() - began_s
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return took_s, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, after.ru_maxrss / 1e3


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("folder", type=Path, nargs="?", default=ROOT / "build" / "folder" / "gaitwright")
    parser.add_argument("--times", type=int, default=5)
    required = parser.parse_args()
    program = required.folder / "gaitwright"
    took_s, work_s, most_mb = demonstration(program)
    print(f"folder: {size_mb(required.folder):.0f} MB")
    for file in sorted((ROOT / "dist").glob("gaitwright[_-]*")):
        if file.suffix in (".deb", ".zst"):
            print(f"{file.name}: {file.stat().st_size / 1e6:.0f} MB")
    print(f"demo, from its start to its report: {took_s:.1f} s, {work_s:.1f} s of work, {most_mb:.0f} MB at most")
    with own_display() as display, own_environment(display) as environment:
        starts = [window_start(program, environment) for _ in range(required.times + 1)][1:]
    there, work, resident = zip(*starts, strict=True)
    print(f"window: there after {statistics.median(there):.2f} s (median of {len(there)}), longest {max(there):.2f} s;")
    print(f"settled with {statistics.median(work):.1f} s of work and {statistics.median(resident):.0f} MB resident")
    print(f"load {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()

"""Try the README's two commands in a Debian that has only Python: `python3 -m tests.installation.try_readme`.

As a new user would: what is committed here, unpacked; the first command, to the first report; then the second, every
check and every test but the long ones. Reported are the times; recordings of people are not there, so their tests are
skipped. Needs debootstrap and to be root.
"""

import argparse
import os
import re
import resource
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "packaging"))  # its scripts are no package

from setup_environment import ROOT, say

from tests.installation.bare_root import BareRoot, bare_root, enter_own_mounts, why_not

PLACE = ROOT / "build" / "try" / "readme"
FIRST_REPORT_S = 300.0
TESTS_S = 5400.0


def try_start(root: BareRoot) -> None:
    """Run the first command, to the first report."""
    began_s, worked_s = time.monotonic(), work_s()
    root.run("sh", "-c", "cd gaitwright && python3 packaging/start.py", is_root=True)
    took_s, load = time.monotonic() - began_s, os.getloadavg()[0]
    report = root.folder / "root/gaitwright/gaitwright-demo/report.pdf"
    if not report.is_file() or not report.read_bytes().startswith(b"%PDF"):
        raise RuntimeError("There is no report.")
    say(f"start.py, to the first report: {took_s:.0f} s, {work_s() - worked_s:.0f} s of work, load {load:.0f}.")
    if took_s > FIRST_REPORT_S and load <= (os.cpu_count() or 1):  # else others' work is measured
        raise RuntimeError(f"That is more than {FIRST_REPORT_S:.0f} s.")
    size = subprocess.run(
        ["du", "-sm", root.folder / "root/gaitwright/.venv"], stdout=subprocess.PIPE, text=True
    ).stdout
    say(f".venv: {size.split()[0]} MB.")
    began_s = time.monotonic()
    root.run("sh", "-c", "cd gaitwright && python3 packaging/start.py demo --out again", is_root=True)
    say(f"Once more: {time.monotonic() - began_s:.0f} s.")


def work_s() -> float:
    """Processor time of all that was started here and has ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def try_tests(root: BareRoot) -> None:
    began_s = time.monotonic()
    try:
        printed = root.run(
            "sh", "-c", "cd gaitwright && CI=true python3 packaging/test.py", is_root=True, most_s=TESTS_S
        )
    finally:
        say(f"test.py: {time.monotonic() - began_s:.0f} s, load {os.getloadavg()[0]:.0f}.")
    say(next(iter(re.findall(r"=+ (\d+ passed.*?) =+", printed)), printed[-300:]))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--only-start", action="store_true", help="leave the tests out")
    required = parser.parse_args()
    if reason := why_not():
        sys.exit(f"This cannot be tried here: {reason}.")
    enter_own_mounts(__spec__.name)
    with bare_root(PLACE) as root:
        root.apt("update")
        root.apt("install", "--no-install-recommends", "python3")
        target = root.folder / "root/gaitwright"
        target.mkdir()
        packed = subprocess.run(["git", "archive", "HEAD"], cwd=ROOT, check=True, stdout=subprocess.PIPE)
        subprocess.run(["tar", "--extract", "--directory", target], input=packed.stdout, check=True)
        try_start(root)
        if not required.only_start:
            try_tests(root)


if __name__ == "__main__":
    try:
        main()
    except RuntimeError as failure:
        sys.exit(str(failure))

"""Tests that the longest time between two frames is reported with what our threads did in it."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.benchmarks.live_window import KEPT, _Spent, longest_gap

BUSY = "import time\nuntil = time.monotonic() + 5\nwhile time.monotonic() < until: pass"


def test_the_longest_time_between_two_frames_is_reported_with_what_each_thread_did() -> None:
    spent = [{"screen": (0.1 * k, 0.01 * k), "gone": (0.0, 0.0)} for k in range(3)]
    spent.append({"screen": (0.25, 3.0)})
    reported = longest_gap([10.0, 10.03, 10.07, 14.07], spent)
    assert reported == {"ms": 4000.0, "since_s": 10.07, KEPT: {"screen": [50, 2980]}}
    assert longest_gap([10.0], spent[:1]) == {}


@pytest.mark.endurance
@pytest.mark.skipif(not Path("/proc/self/schedstat").exists(), reason="only Linux tells what others kept us from")
def test_work_and_being_kept_from_it_are_reported_apart() -> None:
    one = min(os.sched_getaffinity(0))
    script = f"""
import json, os, subprocess, sys, time
from tests.benchmarks.live_window import _Spent
os.sched_setaffinity(0, {{{one}}})
others = [subprocess.Popen([sys.executable, "-c", {BUSY!r}]) for _ in range(2)]
spent = _Spent()
before, begin = spent.read()["MainThread"], time.monotonic()
while time.monotonic() < begin + 0.5: pass
after = spent.read()["MainThread"]
spent.close()
for other in others: other.kill()
print(json.dumps([b - a for a, b in zip(before, after)]))
"""
    reported = subprocess.run([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, check=True).stdout
    busy_s, kept_s = json.loads(reported)
    assert busy_s + kept_s == pytest.approx(0.5, abs=0.1)
    assert kept_s > 0.1
    spent = _Spent()
    before = spent.read()["MainThread"]
    time.sleep(0.05)
    assert sum(spent.read()["MainThread"]) - sum(before) < 0.05
    spent.close()

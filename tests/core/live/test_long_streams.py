"""Memory stays what it was, however long the stream."""

import subprocess
import sys

import pytest


@pytest.mark.endurance
@pytest.mark.skipif(sys.platform != "linux", reason="reads what the process holds from /proc")
def test_ten_minutes_of_stream_hold_no_more_than_the_second_minute() -> None:
    """In a process of its own: what other tests left to free would count."""
    command = [sys.executable, "-m", "tests.benchmarks.live_speed", "--hours", str(10 / 60)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    held = [(float(line.split()[0]), float(line.split()[2])) for line in printed.splitlines()]
    assert held[-1][0] > 9 / 60
    assert held[-1][1] - held[1][1] < 4, held

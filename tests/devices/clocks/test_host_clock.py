"""The host's clock goes forward, whoever sets the machine's."""

import itertools
import time

from devices.clocks.host_clock import host_time_ns


def test_the_clock_never_goes_back_and_keeps_the_machines_pace() -> None:
    begin_ns, begin_s = host_time_ns(), time.monotonic()
    stamps = [host_time_ns() for _ in range(10_000)]
    passed_s, end_s = (stamps[-1] - begin_ns) / 1e9, time.monotonic()
    assert all(a <= b for a, b in itertools.pairwise(stamps))
    assert 0 < passed_s <= end_s - begin_s + 0.01

"""The clock that arrivals are stamped by: nobody sets it, and it goes on while the machine sleeps."""

import time

# Linux's monotonic clock stops while the machine sleeps, and so does what Python takes on macOS
_CLOCK = getattr(time, "CLOCK_BOOTTIME", getattr(time, "CLOCK_MONOTONIC", None))


def host_time_ns() -> int:
    """Nanoseconds since the machine was started, give or take an unknown constant. One clock for all processes."""
    return time.monotonic_ns() if _CLOCK is None else time.clock_gettime_ns(_CLOCK)

"""Timed tests of which every figure is known."""

from core.timed.found import TimedTest
from core.timed.protocols import TimedProtocol


def built_test(
    protocol: TimedProtocol, *, time_s: float = 10.0, distance_m: float = 10.0, is_end_by_key: bool = False
) -> TimedTest:
    """A test from start to end without a turn, a pause or a rise."""
    return TimedTest(
        protocol,
        start_s=1.0,
        end_s=1.0 + time_s,
        is_start_by_key=False,
        is_end_by_key=is_end_by_key,
        distance_m=distance_m,
        sensor_distance_m=distance_m,
        cadence_steps_min=100.0,
        turns=(),
        pauses_s=(),
        laps=(),
        thirds=(),
        rises=(),
        silences=(),
        missing=(),
    )

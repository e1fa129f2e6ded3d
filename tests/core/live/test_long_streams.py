"""Memory stays what it was, however long the stream."""

import sys

import pytest

from tests.benchmarks.live_speed import long_stream


@pytest.mark.endurance
@pytest.mark.skipif(sys.platform != "linux", reason="reads what the process holds from /proc")
def test_ten_minutes_of_stream_hold_no_more_than_the_second_minute() -> None:
    held = list(long_stream(hours=10 / 60))
    assert held[-1][0] > 9 / 60
    assert held[-1][1] - held[1][1] < 4 * 1024, held

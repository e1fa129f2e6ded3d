"""How times are written."""

import pytest

from app.wording.numbers import clock


@pytest.mark.parametrize(
    ("seconds", "digits", "shown"),
    [
        (0.0, 2, "00:00"),
        (59.99, 2, "00:59"),
        (246.0, 2, "04:06"),
        (-1.0, 2, "00:00"),
        (41.9, 1, "0:41"),
        (605.0, 1, "10:05"),
        (-3.0, 1, "0:00"),
    ],
)
def test_a_time_is_minutes_and_whole_seconds_and_never_negative(seconds: float, digits: int, shown: str) -> None:
    assert clock(seconds, digits) == shown

"""Tests of what a stream's decoder takes from what its source states of itself."""

import pytest

from devices.source import SourceInfo
from devices.stream import _step_s


@pytest.mark.parametrize(
    ("settings", "step_s"),
    [
        ({"rate_hz": 100}, 0.01),
        ({"rate_hz": 0.5}, 2.0),
        ({"rate_hz": 1.0}, 1.0),
        ({"rate_hz": 0}, None),
        ({"rate_hz": -50.0}, None),
        ({"rate_hz": "100"}, None),
        ({}, None),
    ],
)
def test_the_step_is_that_of_the_rate_that_was_set(settings: dict[str, object], step_s: float | None) -> None:
    assert _step_s(SourceInfo("witmotion", "1", settings=settings)) == step_s

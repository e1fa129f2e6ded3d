"""Tests that no level stride is called stairs, on one simulated walk of every kind and on recordings.

In those recordings a stride's own climb states that it is level.
"""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.validation.level_walks import KINDS, RECORDED, WalksSeen, events_of, on_stairs, recorded, simulated

STEEP = {"clipped-at-2g": 4, "free motion": 2}  # strides that climb by more than a step, by themselves


@pytest.mark.parametrize("kind", list(KINDS))
def test_no_level_stride_is_called_stairs(kind: str) -> None:
    count = simulated(kind, 1000, 1)
    assert count.strides >= 6
    assert count.stairs == 0


@pytest.mark.parametrize("name", list(STEEP))
def test_no_stride_of_people_is_called_stairs_though_some_would_be_by_themselves(
    test_data: Callable[[str], Path], name: str
) -> None:
    count = WalksSeen()
    count.add(events_of(RECORDED[name](test_data(""))))
    assert count.by_itself >= STEEP[name]
    assert count.stairs == 0


@pytest.mark.endurance
@pytest.mark.parametrize("name", list(RECORDED))
def test_no_stride_of_anybody_is_called_stairs_in_short_walks_and_with_worse_sensors_too(
    test_data: Callable[[str], Path], name: str
) -> None:
    assert recorded(RECORDED[name](test_data(""))).stairs == 0


@pytest.mark.endurance
def test_stairs_that_nobody_declared_are_found() -> None:
    there, found, level = on_stairs(1000, 2)
    assert (found, level) == (there, 0)
    assert there >= 20

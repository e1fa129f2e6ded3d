"""A block of samples, and parts of it."""

from dataclasses import fields

import numpy as np
import pytest

from core.samples import BoolArray, ImuBlock

KEPT = np.array([1, 2])
OF_SAMPLES = ("time_s", "gyr_rad_s", "acc_m_s2", "q_earth_from_sensor", "mag")


def whole() -> ImuBlock:
    values = np.arange(16.0).reshape(4, 4)
    unknown = {"temperature": np.array([20, 21, 22, 23])}
    return ImuBlock("T1", values[:, 0], values[:, :3], -values[:, :3], values, values[:, 1:], True, unknown)


@pytest.mark.parametrize("rows", [slice(1, 3), KEPT, np.array([False, True, True, False])])
def test_every_column_of_a_part_is_of_the_same_rows(rows: slice | BoolArray) -> None:
    block = whole()
    part = block.select(rows)
    assert {field.name for field in fields(block)} == {*OF_SAMPLES, "sensor", "is_rate_derived", "unknown"}
    assert (part.sensor, part.is_rate_derived, len(part)) == ("T1", True, 2)
    for name in OF_SAMPLES:
        np.testing.assert_array_equal(getattr(part, name), getattr(block, name)[KEPT])
    np.testing.assert_array_equal(part.unknown["temperature"], [21, 22])


def test_a_part_lacks_what_the_block_lacks() -> None:
    block = ImuBlock("T1", np.zeros(4), np.zeros((4, 3)), np.zeros((4, 3)))
    part = block.select(slice(2))
    assert (part.q_earth_from_sensor, part.mag, part.is_rate_derived, dict(part.unknown)) == (None, None, False, {})

"""Tests of which minute of a long recording proposes the axes."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Joint
from core.calibration.joint_axis import _liveliest
from core.signal.datasets import Datasets, gather
from tests.core.hinges import Person

SAMPLES = 200
SPACING_S = 1.0


@pytest.fixture(scope="module")
def moved() -> Datasets:
    pair = Person(seed=3).exact_pair(Joint.LEFT_KNEE, duration_s=25.0, rate_hz=50.0)
    return gather((pair,), [np.arange(10, 10 + 5 * SAMPLES, 5)])


def with_lively(data: Datasets, first: int, rate_rad_s: float = 0.1) -> Datasets:
    """Samples a second apart, of which 61, a minute from end to end, turn at a rate and all others at half of it."""
    speed = np.full(SAMPLES, 0.5 * rate_rad_s)
    speed[first : first + 61] = rate_rad_s
    turning = speed[:, None] * [0.6, 0.0, 0.8]
    return replace(data, time_s=SPACING_S * np.arange(SAMPLES), g1=turning, g2=np.zeros_like(turning))


@pytest.mark.parametrize("first", [0, 1, 70, 139])
def test_the_liveliest_minute_is_looked_at_wherever_it_lies(moved: Datasets, first: int) -> None:
    chosen = _liveliest(with_lively(moved, first), np.arange(SAMPLES))
    assert chosen.tolist() == list(range(first, first + 61))


def test_a_jump_is_not_a_minutes_worth(moved: Datasets) -> None:
    data = with_lively(moved, 100, rate_rad_s=2.0)
    jumping = data.g1.copy()
    jumping[10] *= 100.0
    chosen = _liveliest(replace(data, g1=jumping), np.arange(SAMPLES))
    assert chosen.tolist() == list(range(100, 161))

"""Are the figures of certainty what they are called?"""

from typing import TYPE_CHECKING

import numpy as np
import pytest

from core.body import Joint
from core.calibration.certainty import (
    AXIS_FLOOR_HINGE_RAD,
    AXIS_FLOOR_HUMAN_RAD,
    angle_sd_rad,
    axis_sd_rad,
    hinge_floor_rad,
    looseness,
    sandwich_covariance,
)
from core.datasets import gather
from core.rotations import joint_frame
from core.samples import FloatArray

if TYPE_CHECKING:
    from tests.core.conftest import Person


def line_fit(noise: FloatArray, per_block: int) -> float:
    """Covariance of one unknown that every sample measures directly, as the sandwich sees it."""
    slope, weight = np.ones((len(noise), 1, 1)), np.ones((len(noise), 1))
    return float(sandwich_covariance(slope, noise[:, None], weight, np.arange(len(noise)) // per_block)[0, 0])


def test_the_sandwich_is_the_variance_of_the_mean_also_where_neighbours_hang_together() -> None:
    rng = np.random.default_rng(0)
    white = rng.normal(size=20000)
    assert line_fit(white, 100) == pytest.approx(1 / 20000, rel=0.25)
    together = np.repeat(rng.normal(size=200), 100)
    assert line_fit(together, 100) == pytest.approx(1 / 200, rel=0.3)
    assert line_fit(together, 1) < 0.05 / 200


def test_the_weaker_axis_and_direction_count_and_the_floor_is_added() -> None:
    covariance = np.diag([1e-6, 9e-4, 4e-4, 1e-6])
    assert axis_sd_rad(covariance, 0.04) == pytest.approx(0.05)
    assert axis_sd_rad(np.zeros((4, 4)), float(AXIS_FLOOR_HUMAN_RAD)) == pytest.approx(np.deg2rad(4.0))


@pytest.mark.parametrize(
    ("rate", "distance_deg", "is_knee", "ringing", "expected_deg"),
    [
        (0.0, 60.0, True, None, 0.8),
        (1.0, 0.0, True, None, 2.8),
        (1.0, 30.0, True, None, np.hypot(2.8, 3.6)),
        (0.5, 0.0, False, None, 1.4),
        (0.5, 20.0, False, None, np.hypot(1.4, 1.8)),
        (0.5, 0.0, False, 0.5, 1.4),
        (0.5, 0.0, False, 0.15, 0.7),
        (0.5, 0.0, False, 0.0, 0.56),
        (0.0, 0.0, False, None, 0.2),
    ],
)
def test_an_angle_s_spread_is_as_documented(
    rate: float, distance_deg: float, is_knee: bool, ringing: float | None, expected_deg: float
) -> None:
    distance = np.deg2rad([distance_deg])
    found = angle_sd_rad(distance, rate, 1.0, is_knee, is_hinge=False, ringing_rad_s=ringing)
    assert np.rad2deg(found) == pytest.approx(expected_deg)


def test_on_a_hinge_only_the_range_counts() -> None:
    found = angle_sd_rad(np.deg2rad([0.0, 50.0]), 0.1, 2.0, is_knee=True, is_hinge=True)
    assert found == pytest.approx(2 * [np.deg2rad(0.05) + 0.004])


def test_a_hinge_is_as_loose_as_its_axis_is_off(person: "Person") -> None:
    knee = Joint.LEFT_KNEE
    pair = person.exact_pair(knee, heading_rad=0.5)
    data = gather((pair,), [np.arange(5, 590, 3)])
    heading = np.full(len(data), 0.5)
    axis = person.axis(knee.proximal, knee)
    assert looseness(data, axis, heading) < 1e-3
    for off_rad in (0.03, 0.1):
        tilted = np.cos(off_rad) * axis + np.sin(off_rad) * joint_frame(axis)[0]
        # half of the square, for it goes one of two ways
        assert looseness(data, tilted, heading) == pytest.approx(np.tan(off_rad) / np.sqrt(2), rel=1e-2)
    assert looseness(data, joint_frame(axis)[0], heading) > 1.0


def test_the_floor_of_a_loose_hinge_is_what_it_turns_across_its_axis() -> None:
    assert hinge_floor_rad(0.0) == pytest.approx(AXIS_FLOOR_HINGE_RAD)
    assert hinge_floor_rad(0.05) == pytest.approx(0.05, rel=0.01)

"""Tests that the figures of certainty are what they are called."""

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
from core.prosthesis import JointNature
from core.samples import FloatArray
from core.signal.datasets import gather
from core.signal.rotations import joint_frame
from tests.core.hinges import PERSON


def line_fit(noise: FloatArray, per_block: int) -> float:
    """Covariance of one unknown that every sample measures directly, as the sandwich sees it."""
    slope, weight = np.ones((len(noise), 1, 1)), np.ones((len(noise), 1))
    return float(sandwich_covariance(slope, noise[:, None], weight, np.arange(len(noise)) // per_block)[0, 0])


def test_the_sandwich_is_the_variance_of_the_mean_also_where_adjacent_hang_together() -> None:
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
    ("rate", "distance_deg", "is_knee", "nature", "expected_deg"),
    [
        (0.0, 60.0, True, JointNature.NOT_STATED, 1.1),
        (1.0, 30.0, True, JointNature.NOT_STATED, 4.1),
        (1.0, 30.0, True, JointNature.PROSTHETIC, 4.1),
        (1.0, 30.0, True, JointNature.OWN, 4.1),
        (0.0, 0.0, False, JointNature.NOT_STATED, 0.3),
        (0.5, 0.0, False, JointNature.NOT_STATED, 2.3),
        (0.5, 20.0, False, JointNature.NOT_STATED, np.hypot(2.3, 2.6)),
        (0.5, 20.0, False, JointNature.OWN, np.hypot(2.3, 2.6)),
        (0.5, 20.0, False, JointNature.PROSTHETIC, 0.75),
        (0.5, 20.0, False, JointNature.RIGID, 0.75),
    ],
)
def test_an_angle_s_spread_goes_by_what_is_declared(
    rate: float, distance_deg: float, is_knee: bool, nature: JointNature, expected_deg: float
) -> None:
    distance = np.deg2rad([distance_deg])
    found = angle_sd_rad(distance, rate, 1.0, is_knee, is_hinge=False, nature=nature)
    assert np.rad2deg(found) == pytest.approx(expected_deg)


def test_on_a_hinge_only_the_range_counts() -> None:
    found = angle_sd_rad(np.deg2rad([0.0, 50.0]), 0.03, 2.0, is_knee=True, is_hinge=True, ringing_rad_s=0.02)
    assert found == pytest.approx(2 * [np.deg2rad(0.05) + 0.004])
    small = angle_sd_rad(np.zeros(1), 0.03, 0.1, is_knee=True, is_hinge=True)
    assert np.rad2deg(small) == pytest.approx(0.1)


@pytest.mark.parametrize(("rate", "ringing"), [(0.031, 0.0), (0.0, 0.021)])
def test_a_hinge_that_is_not_declared_and_not_bare_may_be_a_person_s_joint(rate: float, ringing: float) -> None:
    angles = np.deg2rad([0.0, 20.0])
    doubted, declared = (
        angle_sd_rad(angles, rate, 0.1, is_knee=False, is_hinge=True, nature=nature, ringing_rad_s=ringing)
        for nature in (JointNature.NOT_STATED, JointNature.PROSTHETIC)
    )
    assert np.rad2deg(doubted) == pytest.approx([0.9, np.hypot(0.3 + 4.0 * rate, 2.6)])
    assert np.rad2deg(declared) == pytest.approx([0.1, 0.1])


def test_what_is_stated_to_be_the_patient_s_or_no_joint_at_all_is_no_hinge_however_it_looks() -> None:
    angles = np.deg2rad([0.0, 20.0])
    found = {
        (nature, is_knee): np.rad2deg(angle_sd_rad(angles, 0.01, 0.1, is_knee, is_hinge=True, nature=nature))
        for nature in JointNature
        for is_knee in (True, False)
    }
    assert found[JointNature.OWN, True] == pytest.approx([1.13, 1.13])
    assert found[JointNature.OWN, False] == pytest.approx([0.9, np.hypot(0.34, 2.6)])
    assert found[JointNature.RIGID, False] == pytest.approx([0.211, 0.211])
    assert found[JointNature.NOT_STATED, True] == pytest.approx([0.1, 0.1])


def test_a_hinge_is_as_loose_as_its_axis_is_off() -> None:
    knee = Joint.LEFT_KNEE
    pair = PERSON.exact_pair(knee, heading_rad=0.5)
    data = gather((pair,), [np.arange(5, 590, 3)])
    heading = np.full(len(data), 0.5)
    axis = PERSON.axis(knee.proximal, knee)
    assert looseness(data, axis, heading) < 1e-3
    for off_rad in (0.03, 0.1):
        tilted = np.cos(off_rad) * axis + np.sin(off_rad) * joint_frame(axis)[0]
        # half of the square, for it goes one of two ways
        assert looseness(data, tilted, heading) == pytest.approx(np.tan(off_rad) / np.sqrt(2), rel=1e-2)
    assert looseness(data, joint_frame(axis)[0], heading) > 1.0


def test_the_floor_of_a_loose_hinge_is_what_it_turns_across_its_axis() -> None:
    assert hinge_floor_rad(0.0) == pytest.approx(AXIS_FLOOR_HINGE_RAD)
    assert hinge_floor_rad(0.05) == pytest.approx(0.05, rel=0.01)

"""Tests that the robust fit weighs errors and priors as it is written down. Cases that can be solved by hand."""

import numpy as np
import pytest

from core.body import Joint
from core.calibration.coincidence import Coincidence, relative_rotation, solve_robustly
from core.calibration.hinge import hinge_residual, in_plane_difference
from core.calibration.joint_centre import JointCentre
from core.calibration.refinement import refine_on_hinge
from core.samples import FloatArray
from core.session import RecordingKind
from core.signal.datasets import Datasets, gather
from tests.core.hinges import Person

KNEE = Joint.LEFT_KNEE


def fitted(design: FloatArray, target: FloatArray, scale_m_s2: float) -> Coincidence:
    rows = np.concatenate([design, target[..., None]], axis=-1)  # the unknowns last: easier to read
    return solve_robustly(np.moveaxis(rows, (3, 2, 1), (1, 2, 3)).copy(), scale_m_s2)


def test_what_no_sample_shows_is_as_unknown_as_before() -> None:
    """Centres within 0.3 m of the joint, accelerometers' biases of 0.05 m/s2."""
    for scale_m_s2 in (0.5, 0.1):
        found = fitted(np.zeros((1, 4, 3, 12)), np.ones((1, 4, 3)), scale_m_s2)
        np.testing.assert_allclose(found.unknowns, 0.0)
        np.testing.assert_allclose(found.covariance[0], np.diag([0.09] * 6 + [0.0025] * 6))


def test_an_error_costs_its_square_while_it_is_small_and_its_size_when_it_is_large() -> None:
    """2 (sqrt(1 + e2 / s2) - 1) with e = 2 and 0.01 m/s2, s = 0.5 m/s2: 6.2462 and 0.0004."""
    target = np.zeros((2, 5, 3))
    target[0, :, 1], target[1, :, 2] = 2.0, 0.01
    cost = fitted(np.zeros((2, 5, 3, 12)), target, 0.5).cost
    assert cost == pytest.approx([6.24621125, 0.00039996], rel=1e-4)
    target[0, 1:] = 0.0
    assert fitted(np.zeros((2, 5, 3, 12)), target, 0.5).cost[0] == pytest.approx(6.24621125 / 5, rel=1e-4)


def test_one_unknown_is_found_between_its_samples_and_what_was_known_before() -> None:
    """n samples of one bias with the value 0.04: n / (n + s2 / 0.05^2) of it, while errors are small."""
    for samples, share in ((1, 1 / 101), (100, 0.5), (900, 0.9)):
        design = np.zeros((1, samples, 3, 12))
        design[..., 0, 7] = 1.0
        target = np.zeros((1, samples, 3))
        target[..., 0] = 0.04
        found = fitted(design, target, 0.5)
        assert found.unknowns[0, 7] == pytest.approx(0.04 * share, rel=0.01)
        assert found.covariance[0, 7, 7] == pytest.approx(0.25 / (samples + 100), rel=0.01)
        assert np.count_nonzero(found.unknowns) == 1


def test_few_samples_that_are_far_off_hardly_count() -> None:
    """A tenth of 1000 samples is off by 20 m/s2: after three steps their weight is 1 / sqrt(1 + 1600)."""
    design, target = np.zeros((1, 1000, 3, 12)), np.full((1, 1000, 3), 0.0)
    design[..., 0, 0] = 1.0
    target[..., 0] = 0.2
    target[0, :100, 0] = 20.0
    found = float(fitted(design, target, 0.5).unknowns[0, 0])
    assert 0.2 < found < 0.35  # the mean is 2.18


def test_a_rotation_between_both_sensors_goes_through_the_earth() -> None:
    """The proximal sensor's x is north, the distal one's x is west, and its earth is turned by 90 degrees."""
    one = np.eye(3)
    two = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    data = Earths(one[None], two[None])
    found = relative_rotation(data, np.array([[0.0], [np.pi / 2]]))  # type: ignore[arg-type]  # it looks at earths only
    np.testing.assert_allclose(found[0, 0], two, atol=1e-12)
    np.testing.assert_allclose(found[1, 0], [[-1, 0, 0], [0, -1, 0], [0, 0, 1]], atol=1e-12)


class Earths:
    def __init__(self, one: FloatArray, two: FloatArray) -> None:
        self.earth_from_1, self.earth_from_2 = one, two


@pytest.fixture(scope="module")
def standing() -> Datasets:
    """A leg that is still, which shows nothing of its centres."""
    pair = Person(seed=5).exact_pair(KNEE, kind=RecordingKind.STANDING, duration_s=4.0)
    return gather((pair,), [np.arange(5, len(pair) - 5, 2)])


def test_a_hinge_that_does_not_move_leaves_its_centre_as_unknown_as_before(
    standing: Datasets,
) -> None:
    """0.3 m for the centres; of the two biases only the difference shows, so that half of their 0.1 m/s2 is left."""
    person = Person(seed=5)
    axes = [person.axis(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    start = JointCentre(np.array([0.02] * 6 + [0.0] * 6), np.eye(12))
    found = refine_on_hinge(standing, axes[0], axes[1], start)
    assert found is not None
    np.testing.assert_allclose(found.unknowns[:6], 0.0, atol=1e-6)
    np.testing.assert_allclose(found.covariance[:6, :6], 0.09 * np.eye(6), atol=1e-6)
    along = axes[0] @ found.covariance[6:9, 6:9] @ axes[0]
    assert along == pytest.approx(0.005, rel=0.02)
    far = JointCentre(np.array([0.06] * 6 + [0.0] * 6), np.eye(12))
    assert refine_on_hinge(standing, axes[0], axes[1], far) is None


class Rates:
    def __init__(self, one: FloatArray, two: FloatArray) -> None:
        self.g1, self.g2 = one, two


def test_on_a_hinge_both_rates_are_as_long_across_the_axis() -> None:
    """(3, 4, 1) across z is 5; (0, 12, 5) across x is 13: they differ by 8, whose robust sd is 1.4826 of it."""
    data = Rates(np.array([[3.0, 4.0, 1.0]] * 3), np.array([[0.0, 12.0, 5.0]] * 3))
    z, x = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    difference = in_plane_difference(data, z, x)  # type: ignore[arg-type]  # it looks at rates only
    np.testing.assert_allclose(difference, -8.0)
    residual = hinge_residual(data, z, x)  # type: ignore[arg-type]  # it looks at rates only
    assert residual == pytest.approx(11.8608)

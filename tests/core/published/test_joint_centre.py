"""Tests that the paper's own identification of centres follows its slopes, and that eq 9 is kept."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.body import Joint
from core.published import joint_centre
from core.published.joint_centre import identify_centres, shifted_to_sensors
from core.samples import FloatArray
from core.signal.pair import Pair
from core.signal.rotations import joint_frame
from tests.core.hinges import PERSON, Person

STEP = 1e-6
SIGNALS = ("a1", "a2", "g1", "g2", "dg1", "dg2")


def data_sets(pair: Pair, every: int) -> list[FloatArray]:
    return [getattr(pair, name)[5:-5:every] for name in SIGNALS]


def lengths_apart(sets: list[FloatArray], x: FloatArray) -> FloatArray:
    a1, a2, g1, g2, dg1, dg2 = sets
    one = a1 - np.cross(g1, np.cross(g1, x[:3])) - np.cross(dg1, x[:3])
    two = a2 - np.cross(g2, np.cross(g2, x[3:])) - np.cross(dg2, x[3:])
    return np.asarray(np.linalg.norm(one, axis=1) - np.linalg.norm(two, axis=1))


@settings(max_examples=12)
@given(start=st.lists(st.floats(-0.3, 0.3), min_size=6, max_size=6))
def test_the_first_step_uses_slopes_that_are_central_differences(start: list[float]) -> None:
    sets = data_sets(PERSON.exact_pair(Joint.LEFT_KNEE, duration_s=2.0), 20)
    x = np.array(start)
    seen: list[tuple[FloatArray, FloatArray]] = []
    lstsq = np.linalg.lstsq

    def watched(a: Any, b: Any, rcond: float) -> Any:
        seen.append((a.copy(), b.copy()))
        return lstsq(a, b, rcond=rcond)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(np.linalg, "lstsq", watched)
        patch.setattr(joint_centre, "START_M", x)
        identify_centres(*sets)
    slope, error = seen[0]
    steps = STEP * np.eye(6)
    expected = np.stack([(lengths_apart(sets, x + s) - lengths_apart(sets, x - s)) / (2 * STEP) for s in steps], axis=1)
    np.testing.assert_allclose(error, lengths_apart(sets, x), atol=1e-9)
    np.testing.assert_allclose(slope, expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("joint", [Joint.LEFT_KNEE, Joint.RIGHT_ANKLE])
def test_the_centre_of_a_hinge_is_found_in_the_plane_normal_to_its_axis(seed: int, joint: Joint) -> None:
    person = Person(seed=seed)
    o1, o2 = identify_centres(*data_sets(person.exact_pair(joint), 10))
    for site, o in ((joint.proximal, o1), (joint.distal, o2)):
        plane = np.stack(joint_frame(person.axis(site, joint)))
        np.testing.assert_allclose(plane @ (o - person.centre_m(site, joint)), 0.0, atol=0.001)


@given(seed=st.integers(0, 2**31))
def test_eq_9_moves_both_centres_along_the_axis_to_the_point_nearest_to_both_sensors(seed: int) -> None:
    rng = np.random.default_rng(seed)
    o1, o2, v1, v2 = rng.normal(size=(4, 3))
    j1, j2 = v1 / np.linalg.norm(v1), v2 / np.linalg.norm(v2)
    one, two = shifted_to_sensors(o1, o2, j1, j2)
    along = float((o1 - one) @ j1)
    np.testing.assert_allclose(o1 - one, along * j1, atol=1e-12)
    np.testing.assert_allclose(o2 - two, along * j2, atol=1e-12)
    assert one @ j1 + two @ j2 == pytest.approx(0.0, abs=1e-12)

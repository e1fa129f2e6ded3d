"""Tests that the twist is the bend of the poses, whatever the headings and however far it turns."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.angles.twist import off_axis_rate, twist
from core.body import Joint
from core.samples import FloatArray
from core.session import RecordingKind
from core.signal.pair import Pair
from tests.core.hinges import PERSON, Person

KNEE = Joint.LEFT_KNEE


def axes_of(person: Person) -> tuple[FloatArray, FloatArray]:
    return person.axis(KNEE.proximal, KNEE), person.axis(KNEE.distal, KNEE)


@pytest.mark.parametrize("kind", [RecordingKind.FREE_MOTION, RecordingKind.WALKING])
@pytest.mark.parametrize("seed", range(3))
def test_about_clinical_axes_the_twist_rises_with_flexion(seed: int, kind: RecordingKind) -> None:
    person = Person(seed=seed)
    pair = person.exact_pair(KNEE, kind, heading_rad=1.3)
    found = twist(pair, *axes_of(person), np.full(len(pair), 1.3))
    truth = person.truth(kind, KNEE, pair.time_s)
    np.testing.assert_allclose(found - found[0], truth - truth[0], atol=1e-9)


def test_the_twist_is_deaf_to_a_heading_that_it_is_reported() -> None:
    straight, turned = PERSON.exact_pair(KNEE), PERSON.exact_pair(KNEE, heading_rad=1.3)
    reported = twist(turned, *axes_of(PERSON), np.full(len(turned), 1.3))
    np.testing.assert_allclose(reported, twist(straight, *axes_of(PERSON), np.zeros(len(straight))), atol=1e-9)


@pytest.fixture(scope="module")
def turning() -> tuple[Pair, FloatArray]:
    """The same samples, the distal sensor turned on about the axis by three whole turns."""
    pair = PERSON.exact_pair(KNEE)
    more = np.linspace(0, 6 * np.pi, len(pair))
    about = Rotation.from_rotvec(more[:, None] * axes_of(PERSON)[1]).as_matrix()
    return replace(pair, earth_from_2=pair.earth_from_2 @ about), more


def test_a_joint_may_turn_on_and_on_without_a_jump(turning: tuple[Pair, FloatArray]) -> None:
    pair, more = turning
    straight = twist(PERSON.exact_pair(KNEE), *axes_of(PERSON), np.zeros(len(pair)))
    found = twist(pair, *axes_of(PERSON), np.zeros(len(pair)))
    np.testing.assert_allclose(found - found[0], straight - straight[0] + more, atol=1e-9)


def test_the_rate_off_the_axis_is_what_is_added_across_it() -> None:
    pair, (j1, j2) = PERSON.exact_pair(KNEE), axes_of(PERSON)
    added = np.cross(j2, np.eye(3)[np.argmin(np.abs(j2))])
    added *= 0.4 / np.linalg.norm(added)
    across = off_axis_rate(replace(pair, g2=pair.g2 + added), j1, np.zeros(len(pair)))
    np.testing.assert_allclose(np.linalg.norm(across, axis=1), 0.4, atol=1e-5)
    along = off_axis_rate(replace(pair, g2=pair.g2 + 0.4 * j2), j1, np.zeros(len(pair)))
    np.testing.assert_allclose(along, 0.0, atol=1e-5)

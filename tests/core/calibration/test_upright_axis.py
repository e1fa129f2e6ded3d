"""Tests that the heading between both sensors is found where the joint axis is upright. As when lying on the side."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.body import Joint
from core.calibration.heading import heading_over
from core.session import RecordingKind
from core.signal.pair import OrientedTrack, Pair, pair_up
from core.signal.rotations import wrap
from core.signal.tracks import Track
from tests.core.hinges import Person

KNEE = Joint.LEFT_KNEE
GRAVITY_M_S2 = np.array([0.0, 0.0, 9.81])


def lying(person: Person, tilt_rad: float, heading_rad: float) -> Pair:
    """Free motion of a leg in a body that is tilted about its forward axis, the distal earth turned by the heading."""
    t = np.arange(800) / 100.0
    tilt = Rotation.from_rotvec([tilt_rad, 0.0, 0.0])
    tracks = []
    for site in (KNEE.proximal, KNEE.distal):
        gyr, acc = person.samples(RecordingKind.FREE_MOTION, site, t)
        shown = person.pose(RecordingKind.FREE_MOTION, site, t)[0]
        lies = tilt * shown
        acc = acc - shown.inv().apply(GRAVITY_M_S2) + lies.inv().apply(GRAVITY_M_S2)
        turned = Rotation.from_rotvec([0.0, 0.0, -heading_rad]) * lies if site is KNEE.distal else lies
        track = Track(0.0, 0.01, gyr, acc, None, None, np.ones(len(t), dtype=bool))
        tracks.append(OrientedTrack(track, turned.as_quat(scalar_first=True)))
    pair = pair_up(tracks[0], tracks[1], 0.0)
    assert pair is not None
    return pair


@pytest.mark.endurance
@pytest.mark.parametrize("tilt_deg", [0.0, 80.0, -110.0])
@pytest.mark.parametrize("heading", [-0.7, 2.9])
def test_a_heading_is_found_from_the_axes_or_from_what_both_sensors_feel(tilt_deg: float, heading: float) -> None:
    person = Person(seed=5)
    pair = lying(person, np.deg2rad(tilt_deg), heading)
    axes = [person.axis(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    centres_m = [person.centre_m(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    elevation = np.median(np.abs((pair.earth_from_1 @ axes[0])[:, 2]))
    assert (elevation > np.sin(np.deg2rad(58.0))) == (tilt_deg != 0.0)
    found = heading_over(pair, axes[0], axes[1], np.concatenate([*centres_m, np.zeros(6)]))
    np.testing.assert_allclose(wrap(found - heading), 0.0, atol=0.02)


def test_accelerometers_biases_are_taken_off_before_both_are_compared() -> None:
    person = Person(seed=5)
    pair = lying(person, np.deg2rad(80.0), 0.5)
    bias = np.array([0.4, -0.6, 0.5]), np.array([-0.5, 0.3, 0.7])
    biased = replace(pair, a1=pair.a1 + bias[0], a2=pair.a2 + bias[1])
    axes = [person.axis(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    centres_m = [person.centre_m(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    found = heading_over(biased, axes[0], axes[1], np.concatenate([*centres_m, *bias]))
    np.testing.assert_allclose(wrap(found - 0.5), 0.0, atol=0.02)

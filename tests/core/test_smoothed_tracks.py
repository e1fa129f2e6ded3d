"""Tests of missing samples: filled from the samples adjacent in time, or left unknown."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Joint
from core.placement.smoothed_tracks import smoothed_in_steps
from core.placement.steps import at_once
from core.samples import FloatArray
from core.signal.pair import OrientedTrack
from tests.core.hinges import Person


@pytest.fixture(scope="module")
def whole() -> OrientedTrack:
    """A thigh's sensor in twelve seconds of free motion, at 100 Hz."""
    return Person(seed=5).exact_pair(Joint.LEFT_KNEE, duration_s=12.0).tracks[0]


def forces_without(whole: OrientedTrack, lost: slice) -> tuple[FloatArray, FloatArray]:
    """Specific force (n, 3) felt by a sensor with all samples, and by the same one that received nonsense for some."""
    acc, is_measured = whole.track.acc_m_s2.copy(), whole.track.is_measured.copy()
    acc[lost], is_measured[lost] = 1000.0, False
    track = replace(whole.track, acc_m_s2=acc, is_measured=is_measured)
    together = at_once(smoothed_in_steps({"whole": [whole], "lost": [OrientedTrack(track, whole.q_earth_from_sensor)]}))
    assert together is not None
    return together.sensors["whole"].terms[..., 6], together.sensors["lost"].terms[..., 6]


def test_a_short_loss_is_bridged_by_what_was_received_around_it(whole: OrientedTrack) -> None:
    felt, bridged = forces_without(whole, slice(600, 605))
    np.testing.assert_array_equal(np.isnan(bridged), np.isnan(felt))
    assert np.nanmax(np.abs(bridged - felt)) < 0.5


def test_a_long_loss_is_unknown_and_spoils_nothing_beside_it(whole: OrientedTrack) -> None:
    felt, holed = forces_without(whole, slice(600, 660))
    is_new = np.isnan(holed[:, 0]) & ~np.isnan(felt[:, 0])
    assert 0.3 < 0.05 * np.count_nonzero(is_new) < 0.9
    assert np.nanmax(np.abs(holed - felt)) < 1.5

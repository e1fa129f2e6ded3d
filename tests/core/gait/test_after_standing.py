"""Tests that the first step after a long standing is as long as it was. Ordinary walks are followed as before."""

import numpy as np
import pytest

from core.body import Side, Site
from core.gait.foot import follow
from core.samples import RateKind
from core.signal.sensors import SensorTracks
from devices.simulation.walker import Standing, Walk, WalkerSettings
from tests.simulated import simulation_of


@pytest.mark.endurance
@pytest.mark.parametrize("standing_s", [0.8, 6.0, 15.0])
@pytest.mark.parametrize("seed", [0, 1])
def test_the_first_step_after_standing_is_as_long_as_it_was(standing_s: float, seed: int) -> None:
    """By the simulated footholds; before, it was 0.4 to 1.1 of it after 6 s, and metres too long after 15 s."""
    walk = Walk(strides=6, standing_before_s=standing_s)
    made = simulation_of(WalkerSettings(seed=seed, recordings=(Standing(), walk)))
    tracks = SensorTracks(made.session, made.session.recordings, frozenset(), RateKind.INSTANTANEOUS)
    recording = made.session.recordings[-1]
    for side in Side:
        site = Site(f"{side}_foot")
        motion = follow(tracks.oriented(recording, site, tracks.blocks(recording)[0])[0])
        found = np.linalg.norm(motion.travel_m, axis=1)
        required = made.truth.recordings[recording.name].feet[side].stride_lengths_m
        assert found[0] == pytest.approx(required[0], abs=0.04)
        assert len(found) == len(required)

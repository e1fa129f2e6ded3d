"""The simulated patient whom everyone sees first: nothing is stated about it that is not so."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from app.wizard.evaluation import calibration_of
from app.wizard.walking.estimator import WalkingEstimator
from core.body import LEG_SITES, Joint, Site
from core.calibration.rest import rest_of
from core.live.sensors import LiveSensor
from core.samples import ImuBlock, RateKind
from core.session import Recording
from devices.simulation.replay import DEMONSTRATION_SESSION
from devices.simulation.walker import FreeMotion, Standing, Walk
from tests.core.cut_blocks import part_of
from tests.simulated import analysis_of, session_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

PIECE_S = 0.5
PAUSE_S = 3.0
MOST_DEG = 4.5  # 7.2 would be called a slip


def after(recording: Recording, from_s: float) -> dict[Site, ImuBlock]:
    """The recording's samples, as if it began at `from_s`."""
    first_s = min(block.time_s[0] for block in recording.imu.values())
    return {site: replace(block, time_s=block.time_s - first_s + from_s) for site, block in recording.imu.items()}


def test_no_strap_of_it_slips_from_walk_to_walk() -> None:
    free = tuple(FreeMotion(f"free motion {number}", duration_s=6.0) for number in range(1, 7))
    walks = tuple(Walk(f"walk {number}", strides=14, standing_before_s=2.0) for number in range(1, 4))
    settings = replace(DEMONSTRATION_SESSION, recordings=(Standing(), *free, *walks))
    session = session_of(settings)
    standing, first, walked = session.recordings[0], session.recordings[1], session.recordings[-3:]
    calibration = calibration_of(analysis_of(replace(session, recordings=(standing, first))))
    rests = {site: rest_of(block) for site, block in standing.imu.items()}
    sensors = {
        str(site): LiveSensor(100.0, rest.gyr_rad_s, RateKind.INSTANTANEOUS)
        for site, rest in rests.items()
        if rest is not None
    }
    estimator = WalkingEstimator({str(site): site for site in LEG_SITES}, sensors, calibration)
    now_s = 0.0
    for walk in walked:
        imu = after(walk, now_s)
        end_s = max(block.time_s[-1] for block in imu.values())
        for from_s, to_s in pairwise(np.arange(now_s, end_s + PIECE_S, PIECE_S).tolist()):
            estimator.update({str(site): part_of(block, from_s, to_s) for site, block in imu.items()})
        now_s = end_s + PAUSE_S
    assert sum(estimator.state.strides.values()) > 70
    assert estimator.state.slips == ()
    for joint in (Joint.LEFT_KNEE, Joint.RIGHT_KNEE):
        turns = estimator._walking._straps[joint].turns
        assert np.rad2deg(np.ptp(turns.turn_rad)) < MOST_DEG

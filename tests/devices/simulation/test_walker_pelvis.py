"""The simulated pelvis: both hips on one body, and nothing of the legs changed where no sensor is on it."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import LEG_SITES, Side, Site
from devices.simulation.walker import FreeMotion, Motion, Standing, Tissue, Walk, WalkerSettings, simulate
from devices.simulation.walker_pelvis import hip_m

SEVEN = WalkerSettings(
    seed=3, sites=(*LEG_SITES, Site.PELVIS), recordings=(Standing(), FreeMotion(motion=Motion.LUNGES), Walk(strides=5))
)


@pytest.mark.endurance
def test_both_legs_hang_from_one_pelvis() -> None:
    for moved in simulate(SEVEN).moved:
        assert moved.pelvis is not None
        hips = [moved.legs[side].origins_m[0] for side in Side]
        for side, hip in zip(Side, hips, strict=True):
            assert np.allclose(hip, hip_m(moved.pelvis, side))
        assert np.linalg.norm(hips[0] - hips[1], axis=1) == pytest.approx(0.17)


def test_bones_keep_their_lengths() -> None:
    for moved in simulate(SEVEN).moved:
        for leg in moved.legs.values():
            for row in (0, 1):
                length_m = np.linalg.norm(leg.origins_m[row] - leg.origins_m[row + 1], axis=1)
                assert np.ptp(length_m) < 1e-9


def test_the_pelvis_moves_as_a_walking_one() -> None:
    pelvis = simulate(SEVEN).moved[-1].pelvis
    assert pelvis is not None
    obliquity = np.rad2deg(np.arcsin(pelvis.rotations[:, 2, 1]))
    assert np.ptp(obliquity) == pytest.approx(8.0, abs=0.3)


@pytest.mark.endurance
@pytest.mark.parametrize("tissue", Tissue)
def test_a_pelvis_adds_a_sensor_and_its_place_in_the_session(tissue: Tissue) -> None:
    session = simulate(replace(SEVEN, tissue=tissue)).session
    for recording in session.recordings:
        block = recording.imu[Site.PELVIS]
        assert np.isfinite(block.acc_m_s2).all()
        assert len(block) == len(recording.imu[Site.LEFT_FOOT])
    standing = session.recordings[0].imu[Site.PELVIS].acc_m_s2.mean(axis=0)
    assert np.linalg.norm(standing) == pytest.approx(9.81, abs=0.2)

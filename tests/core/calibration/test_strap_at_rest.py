"""Tests that gravity at rest refutes a small slip of a foot's strap, and only where it can."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.body import Site
from core.calibration.strap import Slip, is_refuted
from core.samples import RateKind
from core.session import Session
from core.signal.sensors import SensorTracks
from devices.simulation.walker import Standing, Walk, WalkerSettings
from tests.core.cut_blocks import turned
from tests.simulated import session_of

FOOT, SHANK = Site.LEFT_FOOT, Site.LEFT_SHANK
SLIP_S = 4.0


@pytest.fixture(scope="module")
def session() -> Session:
    walk = Walk(strides=8, standing_before_s=1.5, standing_after_s=2.0)
    return session_of(WalkerSettings(seed=4, recordings=(Standing(), walk), sites=(SHANK, FOOT)))


def refuted(session: Session, site: Site, turn_deg: float) -> bool:
    tracks = SensorTracks(session, session.recordings, frozenset(), RateKind.INSTANTANEOUS)
    return is_refuted(tracks, session.recordings[-1], Slip(site, SLIP_S, np.deg2rad(turn_deg)))


def with_foot_turned(session: Session, turn_deg: float, slope_deg: float) -> Session:
    """The foot's sensor turned about a line that leans by `slope_deg` from the vertical, after the slip."""
    standing, walk = session.recordings
    up = standing.imu[FOOT].acc_m_s2.mean(axis=0)
    up /= np.linalg.norm(up)
    across = np.cross(up, [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    line = np.cos(np.deg2rad(slope_deg)) * up + np.sin(np.deg2rad(slope_deg)) * across
    foot = turned(walk.imu[FOOT], Rotation.from_rotvec(np.deg2rad(turn_deg) * line), SLIP_S)
    imu = {**walk.imu, FOOT: foot}
    return replace(session, recordings=(standing, replace(walk, imu=imu)))


@pytest.mark.parametrize("turn_deg", [10.0, -8.0])
def test_a_foot_whose_gravity_stayed_did_not_slip_a_little(session: Session, turn_deg: float) -> None:
    assert refuted(session, FOOT, turn_deg)


def test_a_foot_that_slipped_over_its_instep_did(session: Session) -> None:
    assert not refuted(with_foot_turned(session, 10.0, slope_deg=25.0), FOOT, 10.0)


@pytest.mark.parametrize(("site", "turn_deg"), [(SHANK, 10.0), (FOOT, 12.0), (FOOT, -20.0)])
def test_gravity_states_nothing_of_a_shank_nor_of_a_large_turn(session: Session, site: Site, turn_deg: float) -> None:
    assert not refuted(session, site, turn_deg)


def test_without_a_rest_afterwards_nothing_is_refuted(session: Session) -> None:
    standing, walk = session.recordings
    block = walk.imu[FOOT]
    cut = block.select(block.time_s < block.time_s[-1] - 2.5)
    short = replace(walk, imu={**walk.imu, FOOT: cut})
    assert not refuted(replace(session, recordings=(standing, short)), FOOT, 10.0)

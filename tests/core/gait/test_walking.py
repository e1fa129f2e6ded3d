"""Tests that a long recording, worked through in blocks, has the gait of a short one. Also of walking backward."""

from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Side, Site
from core.gait.strides import Reason
from core.samples import ImuBlock
from core.signal import tracks
from devices.simulation.walker import Standing, Walk, WalkerSettings
from tests.simulated import session_of


@pytest.mark.endurance
def test_the_seams_between_blocks_cost_no_stride_and_no_phase(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seams within a swing, and on landings, which the two blocks report on either side of it or both on the far
    one."""
    recordings = (Standing(), Walk(strides=30))
    session = session_of(WalkerSettings(seed=4, recordings=recordings, sites=(Site.LEFT_FOOT, Site.RIGHT_SHANK)))
    whole = analyse(session).recordings[0].gait
    monkeypatch.setattr(tracks, "OVERLAP_S", 6.0)
    landings_s = np.concatenate([[10.3, 10.7], *(whole[side].strides.start_s for side in Side)])
    for block_s in landings_s[(landings_s > 10.0) & (landings_s < 15.5)].tolist():
        monkeypatch.setattr(tracks, "BLOCK_S", block_s)
        found = analyse(session).recordings[0].gait
        for side in Side:
            strides, expected = found[side].strides, whole[side].strides
            assert len(strides) == len(expected)
            np.testing.assert_allclose(strides.start_s, expected.start_s, atol=0.02)
            np.testing.assert_allclose(strides.end_s[:-1], strides.start_s[1:])
            assert len(found[side].events) == 1
            assert np.mean(found[side].phase == whole[side].phase) > 0.98


def reversed_in_time(block: ImuBlock) -> ImuBlock:
    return replace(block, gyr_rad_s=-block.gyr_rad_s[::-1], acc_m_s2=block.acc_m_s2[::-1])


@pytest.mark.endurance
@pytest.mark.parametrize(
    "turned_sign", [{}, pytest.param({Joint.LEFT_KNEE: 1, Joint.RIGHT_KNEE: 1}, marks=pytest.mark.endurance)]
)
def test_walking_backward_leaves_every_sign_and_stride_in_doubt(turned_sign: dict[Joint, int]) -> None:
    """The shank swings the other way: knees bend against it, and an ankle that followed it would be mirrored."""
    session = session_of(WalkerSettings(seed=4, recordings=(Standing(), Walk(strides=12))))
    standing, walk = session.recordings
    backward = replace(walk, imu={site: reversed_in_time(block) for site, block in walk.imu.items()})
    found = analyse(replace(session, recordings=(standing, backward), turned_sign=turned_sign))
    certain = {joint for joint, one in found.calibrations[0].joints.items() if one.is_sign_certain}
    assert certain == set(turned_sign)
    for gait in found.recordings[0].gait.values():
        assert set(gait.strides.reason) <= {Reason.DOUBT, Reason.START, Reason.STOP}

"""A whole free motion, live: gauges close, the weakest joint is asked for, late clocks are reported."""

from dataclasses import replace

import pytest

from core.body import LEG_SITES, Joint, Side, Site
from core.live.free_motion import FreeMotionState, LiveFreeMotion
from core.live.lag import LagVerdict
from devices.simulation.walker import FreeMotion as FreeMotionRecording
from devices.simulation.walker import Motion, SimulatedSession, Standing, Tissue, WalkerSettings
from tests.core.cut_blocks import in_blocks
from tests.core.standing import live_sensors
from tests.simulated import simulation_of

LEFT = tuple(site for site in LEG_SITES if site.side is Side.LEFT)


def made(sites: tuple[Site, ...] = LEFT, motion: Motion = Motion.FULL, late_s: float = 0.0) -> SimulatedSession:
    recordings = (Standing(), FreeMotionRecording(duration_s=18.0, motion=motion))
    late = {Site.LEFT_SHANK: late_s} if late_s else {}
    return simulation_of(
        WalkerSettings(seed=3, recordings=recordings, sites=sites, tissue=Tissue.SOFT, clock_late_s=late)
    )


def watched(session: SimulatedSession, block_s: float = 0.033) -> list[FreeMotionState]:
    motion = LiveFreeMotion(live_sensors(session.session))
    return [motion.update(blocks) for blocks in in_blocks(session.session.recordings[1].imu, block_s)]


@pytest.fixture(scope="module")
def circling() -> SimulatedSession:
    return made()


@pytest.fixture(scope="module")
def states(circling: SimulatedSession) -> list[FreeMotionState]:
    return watched(circling)


def test_gauges_close_while_the_leg_circles(states: list[FreeMotionState]) -> None:
    assert set(states[-1].joints) == {Joint.LEFT_KNEE, Joint.LEFT_ANKLE}
    assert not states[30].is_done
    assert states[30].weakest is not None
    assert states[-1].is_done
    assert all(state.moved_s > 10.0 for state in states[-1].joints.values())


def test_no_lag_is_reported_where_there_is_none(states: list[FreeMotionState]) -> None:
    assert states[-1].lags
    assert all(lag.verdict is LagVerdict.NONE for state in states for lag in state.lags.values())
    assert all(abs(lag.lag_s) < 0.005 for lag in states[-1].lags.values())


@pytest.mark.endurance
@pytest.mark.parametrize(("late_s", "verdict"), [(0.03, LagVerdict.LAG), (0.12, LagVerdict.NOT_ONE_JOINT)])
def test_a_late_clock_is_reported_while_the_leg_moves(late_s: float, verdict: LagVerdict) -> None:
    lags = watched(made(late_s=late_s))[-1].lags
    assert {lag.verdict for lag in lags.values()} == {verdict}
    if verdict is LagVerdict.LAG:
        for joint, true_s in ((Joint.LEFT_KNEE, -late_s), (Joint.LEFT_ANKLE, late_s)):
            sd_s = lags[joint].sd_s
            assert sd_s is not None
            assert sd_s < 0.004
            assert abs(lags[joint].lag_s - true_s) < 4 * sd_s


@pytest.mark.parametrize("block_s", [0.3, 60.0])
def test_the_size_of_the_blocks_changes_nothing(
    circling: SimulatedSession, states: list[FreeMotionState], block_s: float
) -> None:
    other = watched(circling, block_s)[-1]
    for joint, state in states[-1].joints.items():
        assert other.joints[joint].axis_sd_rad == pytest.approx(state.axis_sd_rad, rel=1e-9)
        assert other.joints[joint].centre_sd_m == pytest.approx(state.centre_sd_m, rel=1e-9)
        assert other.lags[joint].lag_s == pytest.approx(states[-1].lags[joint].lag_s, abs=1e-12)
        assert other.lags[joint].sd_s == pytest.approx(states[-1].lags[joint].sd_s, rel=1e-6)


def test_a_leg_held_still_stays_open_and_is_asked_for() -> None:
    session = made(sites=(*LEFT, Site.RIGHT_THIGH, Site.RIGHT_SHANK))
    still = session.session.recordings[0].imu
    motion = LiveFreeMotion(live_sensors(session.session))
    imu = {**session.session.recordings[1].imu, **{site: still[site] for site in (Site.RIGHT_THIGH, Site.RIGHT_SHANK)}}
    state = motion.update(imu)
    assert state.weakest is Joint.RIGHT_KNEE
    assert not state.joints[Joint.RIGHT_KNEE].is_closed


def test_a_foot_without_ankle_joint_is_not_asked_for(circling: SimulatedSession) -> None:
    motion = LiveFreeMotion(
        live_sensors(circling.session), frozenset({Joint.LEFT_KNEE}), without_ankle=frozenset({Side.LEFT})
    )
    assert set(motion.update({}).joints) == {Joint.LEFT_KNEE}


def test_a_silent_sensor_keeps_nothing_waiting_for_long(circling: SimulatedSession) -> None:
    motion = LiveFreeMotion(live_sensors(circling.session))
    block = circling.session.recordings[1].imu[Site.LEFT_THIGH]
    for k in range(10):
        motion.update({Site.LEFT_THIGH: replace(block, time_s=block.time_s + 18.01 * k)})
    assert motion.update({}).joints[Joint.LEFT_KNEE].moved_s == 0.0


def test_samples_that_come_twice_are_counted_and_change_nothing(
    circling: SimulatedSession, states: list[FreeMotionState]
) -> None:
    motion = LiveFreeMotion(live_sensors(circling.session))
    site = Site.LEFT_FOOT
    for blocks in in_blocks(circling.session.recordings[1].imu, 0.5):
        motion.update(blocks)
        state = motion.update({site: blocks[site]})
    assert motion.late == {Site.LEFT_THIGH: 0, Site.LEFT_SHANK: 0, site: len(circling.session.recordings[1].imu[site])}
    assert state.joints[Joint.LEFT_ANKLE].centre_sd_m == pytest.approx(
        states[-1].joints[Joint.LEFT_ANKLE].centre_sd_m, rel=1e-9
    )

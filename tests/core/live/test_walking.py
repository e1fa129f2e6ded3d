"""A whole walk, live: the angles, phases and slips of both legs, whatever the blocks."""

from collections.abc import Mapping, Sequence

import numpy as np
import pytest

from core.analysis import analyse
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site
from core.gait.live import FootEvent, LiveEvent
from core.live.sensors import LiveSensor
from core.live.walking import LiveWalk, WalkingState
from core.results import Analysis, JointCalibration
from core.samples import ImuBlock
from core.session import Recording
from devices.simulation.walker import FreeMotion, SimulatedSession, Standing, Tissue, Walk, WalkerSettings
from tests.core.cut_blocks import about_the_vertical, in_blocks, turned
from tests.core.standing import live_sensors
from tests.simulated import simulation_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

WALK = "walk 1"


@pytest.fixture(scope="module")
def made() -> SimulatedSession:
    """Both legs with soft tissue, a walk of half a minute, the right foot's sensor at half the rate, one late clock."""
    recordings = (Standing(), FreeMotion(), Walk(WALK, strides=24, standing_before_s=2.0))
    settings = WalkerSettings(
        seed=8,
        recordings=recordings,
        tissue=Tissue.SOFT,
        site_rates_hz={Site.RIGHT_FOOT: 50.0},
        clock_late_s={Site.LEFT_SHANK: 0.02},
    )
    return simulation_of(settings)


@pytest.fixture(scope="module")
def analysis(made: SimulatedSession) -> Analysis:
    return analyse(made.session)


@pytest.fixture(scope="module")
def calibration(analysis: Analysis) -> Mapping[Joint, JointCalibration]:
    return analysis.calibrations[-1].joints


@pytest.fixture(scope="module")
def sensors(made: SimulatedSession) -> dict[Site, LiveSensor]:
    return live_sensors(made.session)


def walk_of(made: SimulatedSession) -> Recording:
    return made.session.recordings[2]


def joined(states: Sequence[WalkingState], joint: Joint) -> tuple[np.ndarray, np.ndarray]:
    parts = [state.joints[joint].samples for state in states]
    return np.concatenate([p.time_s for p in parts]), np.concatenate([p.angle_rad for p in parts])


def events_of(states: Sequence[WalkingState], side: Side) -> list[LiveEvent]:
    return [event for state in states for event in state.feet[side].events]


@pytest.fixture(scope="module")
def states(
    made: SimulatedSession, sensors: dict[Site, LiveSensor], calibration: Mapping[Joint, JointCalibration]
) -> list[WalkingState]:
    walking = LiveWalk(sensors, calibration)
    return [walking.update(blocks) for blocks in in_blocks(walk_of(made).imu, 0.033)]


def test_live_angles_follow_the_offline_ones(states: list[WalkingState], analysis: Analysis) -> None:
    walk = next(recording for recording in analysis.recordings if recording.name == WALK)
    for joint in LEG_JOINTS:
        time_s, angle = joined(states, joint)
        difference = angle - np.interp(time_s, walk.time_s, walk.joints[joint].angle_rad)
        known = np.isfinite(difference) & (time_s > 3.0)  # the filters settle
        rmse_deg = np.rad2deg(np.sqrt(np.mean(difference[known] ** 2)))
        assert known.mean() > 0.85, joint
        assert rmse_deg < 1.0, joint


def test_events_and_cadence_are_those_of_the_walk(states: list[WalkingState], analysis: Analysis) -> None:
    walk = next(recording for recording in analysis.recordings if recording.name == WALK)
    for side in Side:
        live = [one.time_s for one in events_of(states, side) if one.event is FootEvent.INITIAL_CONTACT]
        offline = np.concatenate([events.initial_contact_s for events in walk.gait[side].events])
        assert len(live) >= len(offline) - 2, side
        assert all(np.min(np.abs(offline - one)) < 0.03 for one in live), side
    halfway = states[len(states) // 2].feet[Side.LEFT]
    stride_s = float(np.median(walk.gait[Side.LEFT].strides.time_s))
    assert halfway.cadence_steps_min == pytest.approx(120.0 / stride_s, rel=0.03)
    assert states[-1].feet[Side.LEFT].strides >= 20


LEFT = tuple(site for site in LEG_SITES if site.side is Side.LEFT)


@pytest.mark.parametrize(
    "block_s", [0.35, pytest.param(0.02, marks=pytest.mark.endurance), pytest.param(100.0, marks=pytest.mark.endurance)]
)
def test_the_size_of_the_blocks_changes_nothing(
    made: SimulatedSession,
    sensors: dict[Site, LiveSensor],
    calibration: Mapping[Joint, JointCalibration],
    states: list[WalkingState],
    block_s: float,
) -> None:
    walking = LiveWalk({site: sensors[site] for site in LEFT}, calibration)
    imu = {site: walk_of(made).imu[site] for site in LEFT}
    other = [walking.update(blocks) for blocks in in_blocks(imu, block_s)]
    for joint in (Joint.LEFT_KNEE, Joint.LEFT_ANKLE):
        for one, two in zip(joined(states, joint), joined(other, joint), strict=True):
            np.testing.assert_allclose(two, one, rtol=0, atol=1e-9, equal_nan=True)
    assert events_of(other, Side.LEFT) == events_of(states, Side.LEFT)


@pytest.mark.endurance
def test_one_late_sensor_delays_its_joints_and_changes_nothing(
    made: SimulatedSession,
    sensors: dict[Site, LiveSensor],
    calibration: Mapping[Joint, JointCalibration],
    states: list[WalkingState],
) -> None:
    walking = LiveWalk({site: sensors[site] for site in LEFT}, calibration)
    imu = {site: walk_of(made).imu[site] for site in LEFT}
    held: list[ImuBlock] = []
    other = []
    for k, blocks in enumerate(in_blocks(imu, 0.033)):
        held.append(blocks.pop(Site.LEFT_SHANK))
        if k % 30 == 29:  # a second late
            other += [walking.update({Site.LEFT_SHANK: block}) for block in held]
            held = []
        other.append(walking.update(dict(reversed(blocks.items()))))
    other += [walking.update({Site.LEFT_SHANK: block}) for block in held]
    for joint in (Joint.LEFT_KNEE, Joint.LEFT_ANKLE):
        for one, two in zip(joined(states, joint), joined(other, joint), strict=True):
            np.testing.assert_allclose(two, one, rtol=0, atol=1e-9, equal_nan=True)


def test_a_strap_that_slips_is_reported_during_the_walk(
    made: SimulatedSession, sensors: dict[Site, LiveSensor], calibration: Mapping[Joint, JointCalibration]
) -> None:
    site, slip_s = Site.LEFT_SHANK, 11.0
    turn = about_the_vertical(made.session.recordings[0].imu[site], np.deg2rad(20.0))
    imu = {one: walk_of(made).imu[one] for one in LEFT}
    imu[site] = turned(imu[site], turn, slip_s)
    walking = LiveWalk({one: sensors[one] for one in LEFT}, calibration)
    reported = [(k * 0.033, walking.update(blocks).slips) for k, blocks in enumerate(in_blocks(imu, 0.033))]
    first_s, (slip,) = next((now_s, slips) for now_s, slips in reported if slips)
    assert slip.site is site
    assert slip.from_s == pytest.approx(slip_s, abs=5.0)
    assert first_s < slip_s + 16.0
    assert reported[-1][1] == (slip,)


def test_without_feet_or_calibration_it_shows_what_it_can(
    made: SimulatedSession, sensors: dict[Site, LiveSensor], calibration: Mapping[Joint, JointCalibration]
) -> None:
    imu = walk_of(made).imu
    knees = {site: sensor for site, sensor in sensors.items() if not site.endswith("foot")}
    state = LiveWalk(knees, calibration).update({site: imu[site] for site in knees})
    assert set(state.joints) == {Joint.LEFT_KNEE, Joint.RIGHT_KNEE}
    assert not state.feet
    foot = {Site.LEFT_FOOT: sensors[Site.LEFT_FOOT]}
    state = LiveWalk(foot, {}).update({Site.LEFT_FOOT: imu[Site.LEFT_FOOT]})
    assert not state.joints
    assert len(state.feet[Side.LEFT].events) > 80

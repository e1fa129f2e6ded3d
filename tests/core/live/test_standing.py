"""Standing still, reported block by block: when it is done, who moved, who is silent."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from core.body import LEG_SITES, Site
from core.calibration.rest import rest_of
from core.live.standing import REQUIRED_S, LiveStanding, StandingState
from core.samples import ImuBlock
from core.session import Recording, RecordingKind
from devices.simulation.walker import Standing as StandingRecording
from devices.simulation.walker import WalkerSettings
from tests.core.cut_blocks import in_blocks
from tests.simulated import session_of

BLOCK_S = 0.033


@pytest.fixture(scope="module")
def stood() -> Recording:
    """Six simulated sensors at 100 Hz, five seconds of standing."""
    settings = WalkerSettings(seed=4, recordings=(StandingRecording(duration_s=5.0),))
    recording = session_of(settings).recordings[0]
    assert recording.kind is RecordingKind.STANDING
    return recording


def watched(imu: Mapping[Site, ImuBlock], block_s: float = BLOCK_S) -> list[StandingState[Site]]:
    standing = LiveStanding(imu)
    return [standing.update(blocks) for blocks in in_blocks(imu, block_s)]


def knocked(block: ImuBlock, at_s: float) -> ImuBlock:
    """The same sensor, turned by 0.6 rad/s for 0.2 s."""
    gyr = block.gyr_rad_s.copy()
    gyr[(block.time_s >= at_s) & (block.time_s < at_s + 0.2), 1] += 0.6
    return replace(block, gyr_rad_s=gyr)


def test_three_still_seconds_are_enough_and_give_what_offline_finds(stood: Recording) -> None:
    states = watched(stood.imu)
    done = next(state for state in states if state.is_done)
    assert done.still_s == pytest.approx(REQUIRED_S)
    assert done.moved == ()
    assert done.silent == ()
    for site, rest in done.rest.items():
        whole = rest_of(stood.imu[site])
        assert whole is not None
        np.testing.assert_allclose(rest.gyr_rad_s, whole.gyr_rad_s, atol=np.deg2rad(0.1))
        np.testing.assert_allclose(rest.acc_m_s2, whole.acc_m_s2, atol=0.05)


def test_the_sensor_that_moved_is_named_and_the_count_begins_again(stood: Recording) -> None:
    imu = {**stood.imu, Site.LEFT_SHANK: knocked(stood.imu[Site.LEFT_SHANK], 1.5)}
    states = watched(imu)
    moved = [state for state in states if state.moved]
    assert {state.moved for state in moved} == {(Site.LEFT_SHANK,)}
    assert max(state.still_s for state in states[: states.index(moved[0])]) == pytest.approx(1.5, abs=0.3)
    assert all(state.still_s == 0.0 for state in moved)
    assert states[-1].is_done
    assert states[-1].still_s == pytest.approx(5.0 - 1.75, abs=0.3)


def test_a_silent_sensor_is_named_and_nothing_counts_until_it_is_back(stood: Recording) -> None:
    silent = stood.imu[Site.RIGHT_FOOT]
    imu = {**stood.imu, Site.RIGHT_FOOT: silent.select((silent.time_s < 1.0) | (silent.time_s > 2.5))}
    states = watched(imu)
    silences = [state for state in states if state.silent]
    assert {state.silent for state in silences} == {(Site.RIGHT_FOOT,)}
    assert all(state.still_s == 0.0 for state in silences)
    assert not states[-1].silent
    assert states[-1].still_s == pytest.approx(2.5, abs=0.3)


def test_a_sensor_that_repeats_itself_is_not_still_but_silent(stood: Recording) -> None:
    block = stood.imu[Site.LEFT_THIGH]
    stuck = replace(block, gyr_rad_s=np.zeros_like(block.gyr_rad_s), acc_m_s2=np.tile([0.0, 0.0, 9.8], (len(block), 1)))
    states = watched({**stood.imu, Site.LEFT_THIGH: stuck})
    assert not any(state.is_done for state in states)
    assert states[-1].silent == (Site.LEFT_THIGH,)


def test_a_sensor_never_received_is_silent(stood: Recording) -> None:
    standing = LiveStanding([Site.LEFT_FOOT, Site.LEFT_SHANK])
    state = standing.update({Site.LEFT_SHANK: stood.imu[Site.LEFT_SHANK]})
    assert state.silent == (Site.LEFT_FOOT,)
    assert not state.is_done


@pytest.mark.parametrize("block_s", [0.01, 0.1, 0.7, 6.0])
def test_the_size_of_the_blocks_changes_nothing(stood: Recording, block_s: float) -> None:
    imu = {**stood.imu, Site.RIGHT_THIGH: knocked(stood.imu[Site.RIGHT_THIGH], 0.6)}
    usual, other = watched(imu)[-1], watched(imu, block_s)[-1]
    assert other.still_s == usual.still_s
    assert other.moved == usual.moved
    for site in LEG_SITES:
        np.testing.assert_array_equal(other.rest[site].gyr_rad_s, usual.rest[site].gyr_rad_s)


def test_a_sensor_moves_just_when_its_movement_reaches_the_limit(stood: Recording) -> None:
    imu = {**stood.imu, Site.LEFT_SHANK: knocked(stood.imu[Site.LEFT_SHANK], 1.5)}
    for state in watched(imu):
        assert state.moved == tuple(site for site in state.movement if state.movement[site] >= 1.0)
    assert set(state.movement) == set(LEG_SITES)
    assert max(state.movement.values()) < 0.8  # the simulated patient is well


@pytest.mark.parametrize("block_s", [0.02, 6.0])
@pytest.mark.parametrize(
    ("knocks_s", "restarts"), [((), 0), ((1.5,), 1), ((1.5, 2.0), 1), ((1.5, 4.0), 2), ((0.0,), 0), ((0.0, 2.5), 1)]
)
def test_movements_close_together_restart_the_count_once_and_the_first_stillness_none(
    stood: Recording, knocks_s: tuple[float, ...], restarts: int, block_s: float
) -> None:
    imu = dict(stood.imu)
    for number, at_s in enumerate(knocks_s):
        site = (Site.LEFT_SHANK, Site.RIGHT_FOOT)[number % 2]
        imu[site] = knocked(imu[site], at_s)
    assert watched(imu, block_s)[-1].restarts == restarts


def test_long_standing_keeps_memory_and_the_latest_seconds(stood: Recording) -> None:
    block = stood.imu[Site.LEFT_SHANK]
    standing = LiveStanding([Site.LEFT_SHANK])
    for k in range(20):
        state = standing.update({Site.LEFT_SHANK: replace(block, time_s=block.time_s + 5.01 * k)})
    assert state.still_s == pytest.approx(100.0, abs=0.5)
    assert state.rest[Site.LEFT_SHANK].duration_s <= 10.5


@pytest.mark.parametrize("is_optional", [True, False])
def test_nobody_waits_for_a_silent_sensor_that_is_optional(stood: Recording, is_optional: bool) -> None:
    silent = stood.imu[Site.RIGHT_FOOT]
    imu = {**stood.imu, Site.RIGHT_FOOT: silent.select(silent.time_s < 1.0)}
    standing = LiveStanding(imu, optional=frozenset({Site.RIGHT_FOOT} if is_optional else ()))
    states = [standing.update(blocks) for blocks in in_blocks(imu, BLOCK_S)]
    assert states[-1].silent == (Site.RIGHT_FOOT,)
    assert states[-1].is_done is is_optional
    assert set(states[-1].rest) == (set(LEG_SITES) - {Site.RIGHT_FOOT} if is_optional else set())


def test_an_optional_sensor_that_moves_restarts_the_count_as_any_other(stood: Recording) -> None:
    imu = {**stood.imu, Site.LEFT_SHANK: knocked(stood.imu[Site.LEFT_SHANK], 2.0)}
    standing = LiveStanding(imu, optional=frozenset({Site.LEFT_SHANK}))
    states = [standing.update(blocks) for blocks in in_blocks(imu, BLOCK_S)]
    assert states[-1].restarts == 1

"""Tests that the simulated patient's steps are reported live, in time, and nothing else.

A glance; `test_live` looks long.
"""

from collections.abc import Sequence

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.body import Side, Site
from core.gait.live import FootEvent, LiveEvent, LiveEvents
from core.gait.phases import Phase
from core.samples import FloatArray, ImuBlock
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from devices.simulation.walker_motion import TrueFootEvents
from tests.core.cut_blocks import turned
from tests.simulated import session_of, simulation_of

SITE = Site.LEFT_FOOT
EVENTS = ("heel_rise", "toe_off", "initial_contact", "full_contact")


def walked(speed_m_s: float, rate_hz: float = 100.0, standing_after_s: float = 0.5) -> tuple[ImuBlock, TrueFootEvents]:
    walk = Walk(speed_m_s=speed_m_s, strides=8, standing_before_s=1.5, standing_after_s=standing_after_s)
    made = simulation_of(WalkerSettings(seed=2, recordings=(walk,), sites=(SITE,), rate_hz=rate_hz))
    return made.session.recordings[0].imu[SITE], made.truth.recordings[walk.name].feet[Side.LEFT].events


@pytest.fixture(scope="module")
def usual() -> tuple[ImuBlock, TrueFootEvents]:
    return walked(1.19)


def reported_of(block: ImuBlock, axis: FloatArray | None = None) -> list[LiveEvent]:
    return LiveEvents(axis).update(block.time_s, block.gyr_rad_s, block.acc_m_s2)


def times_s(reported: Sequence[LiveEvent], event: str) -> FloatArray:
    return np.array([one.time_s for one in reported if one.event == event])


@pytest.mark.parametrize(("speed_m_s", "rate_hz"), [(0.5, 60.0), (1.19, 100.0), (1.8, 200.0)])
def test_every_step_is_reported_once_near_its_true_time(speed_m_s: float, rate_hz: float) -> None:
    block, truth = walked(speed_m_s, rate_hz)
    reported = reported_of(block)
    for event in EVENTS:
        true_s, found_s = getattr(truth, f"{event}_s"), times_s(reported, event)
        assert len(true_s) - 1 <= len(found_s) <= len(true_s), event
        off_s = found_s[: len(true_s) - 1] - true_s[:-1]
        assert np.max(np.abs(off_s)) < 0.08, event
        assert np.std(off_s[1:]) < 0.02, event


@pytest.mark.parametrize(
    "walk",
    [
        Walk(strides=12, speed_m_s=1.6, standing_before_s=1.0),
        Walk(strides=12, standing_before_s=1.0, turn_rad=np.pi),
        Walk(strides=12, standing_before_s=1.0, turn_rad=-np.pi, turn_radius_m=0.3, pivot_share=0.5),
    ],
    ids=["straight", "U-turn", "pivot"],
)
def test_a_body_that_turns_over_its_feet_loses_and_invents_no_contact(walk: Walk) -> None:
    """Legs that hang from one pelvis slide and sway on the floor: no stance is as calm as others are."""
    sites = (Site.LEFT_FOOT, Site.RIGHT_FOOT, Site.PELVIS)
    made = simulation_of(WalkerSettings(seed=0, recordings=(walk,), sites=sites))
    for site in sites[:2]:
        true_s = made.truth.recordings[walk.name].feet[site.leg_side].events.initial_contact_s
        found_s = times_s(reported_of(made.session.recordings[0].imu[site]), "initial_contact")
        assert len(found_s) == len(true_s)
        assert np.max(np.abs(found_s - true_s)) < 0.1


def test_events_are_reported_within_a_tenth_of_a_second_but_for_the_first_step(
    usual: tuple[ImuBlock, TrueFootEvents],
) -> None:
    block, truth = usual
    reported = reported_of(block)
    assert all(one.reported_s >= one.time_s - 1e-9 for one in reported)
    late = [one for one in reported if one.reported_s - one.time_s > 0.095]
    assert late == [one for one in reported if one.is_late]
    inner = [one for one in late if truth.initial_contact_s[0] < one.time_s < truth.toe_off_s[-1]]
    assert inner == []
    assert [one.reported_s for one in reported] == sorted(one.reported_s for one in reported)


def test_events_follow_each_other_and_each_begins_its_phase(usual: tuple[ImuBlock, TrueFootEvents]) -> None:
    block, truth = usual
    live, reported, shown = LiveEvents(), [], []
    for k in range(len(block)):
        reported += live.update(block.time_s[k : k + 1], block.gyr_rad_s[k : k + 1], block.acc_m_s2[k : k + 1])
        shown.append(live.phase)
    assert reported == reported_of(block)
    inner = [str(one.event) for one in reported if truth.initial_contact_s[0] < one.time_s < truth.toe_off_s[-1] - 0.3]
    begin = inner.index("heel_rise")
    assert inner[begin : begin + 16] == list(EVENTS) * 4
    for k in range(1, 6):
        for between, phase in (
            ((truth.toe_off_s[k] + 0.1, truth.initial_contact_s[k]), Phase.SWING),
            ((truth.full_contact_s[k - 1] + 0.12, truth.heel_rise_s[k] - 0.03), Phase.FOOT_FLAT),
        ):
            inside = (block.time_s > between[0]) & (block.time_s < between[1])
            assert {phase} == {shown[i] for i in np.flatnonzero(inside)}
    assert shown[0] is Phase.UNKNOWN
    assert shown[100] is Phase.FOOT_FLAT  # it stood for a second


def test_cadence_is_two_steps_a_stride_and_ends_with_the_walk() -> None:
    block, truth = walked(1.19, standing_after_s=4.5)
    live = LiveEvents()
    assert np.isnan(live.cadence_steps_min)
    is_walking = block.time_s < truth.initial_contact_s[-2]
    live.update(block.time_s[is_walking], block.gyr_rad_s[is_walking], block.acc_m_s2[is_walking])
    stride_s = np.median(np.diff(truth.initial_contact_s)[:-2])
    assert live.cadence_steps_min == pytest.approx(120.0 / stride_s, rel=0.03)
    live.update(block.time_s[~is_walking], block.gyr_rad_s[~is_walking], block.acc_m_s2[~is_walking])
    assert np.isnan(live.cadence_steps_min)
    assert live.phase is Phase.FOOT_FLAT


@pytest.mark.parametrize("rotvec", [(2.0, 0.4, -1.0), (0.0, 0.0, np.pi)])
def test_however_the_sensor_is_mounted_the_events_are_the_same(
    usual: tuple[ImuBlock, TrueFootEvents], rotvec: tuple[float, float, float]
) -> None:
    block, _ = usual
    one, other = reported_of(block), reported_of(turned(block, Rotation.from_rotvec(rotvec)))
    assert [e.event for e in one] == [e.event for e in other]
    np.testing.assert_allclose([e.time_s for e in one], [e.time_s for e in other], atol=1e-6)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axis_that_is_given_helps_whichever_way_it_points(
    usual: tuple[ImuBlock, TrueFootEvents], sign: float
) -> None:
    block, truth = usual
    axis = np.linalg.eigh(block.gyr_rad_s.T @ block.gyr_rad_s)[1][:, -1]
    found_s = times_s(reported_of(block, sign * axis), "toe_off")
    np.testing.assert_allclose(found_s[: len(truth.toe_off_s) - 1], truth.toe_off_s[:-1], atol=0.05)


@pytest.mark.parametrize("how", ["excluded", "NaN"])
@pytest.mark.parametrize(("lost_s", "is_missed"), [(0.03, False), (0.4, True)])
def test_a_gap_costs_the_step_it_lies_in_and_no_other(
    usual: tuple[ImuBlock, TrueFootEvents], how: str, lost_s: float, is_missed: bool
) -> None:
    block, truth = usual
    from_s = truth.toe_off_s[3] + 0.1  # in swing
    is_lost = (block.time_s > from_s) & (block.time_s < from_s + lost_s)
    gyr = np.where(is_lost[:, None], np.nan, block.gyr_rad_s)
    kept = ~is_lost if how == "excluded" else np.ones(len(block), dtype=bool)
    reported = LiveEvents().update(block.time_s[kept], gyr[kept], block.acc_m_s2[kept])
    contacts_s = times_s(reported, "initial_contact")
    apart_s = np.array([np.min(np.abs(contacts_s - at_s)) for at_s in truth.initial_contact_s[:-1]])
    assert (apart_s > 0.06).tolist() == [is_missed and k == 3 for k in range(len(apart_s))]
    assert len(contacts_s) <= len(truth.initial_contact_s)


def test_a_stamp_that_does_not_advance_is_passed_over(usual: tuple[ImuBlock, TrueFootEvents]) -> None:
    block, _ = usual
    twice = np.repeat(np.arange(len(block)), 2)
    reported = LiveEvents().update(block.time_s[twice], block.gyr_rad_s[twice], block.acc_m_s2[twice])
    assert reported == reported_of(block)


def test_standing_and_a_foot_in_the_air_are_not_walking() -> None:
    settings = WalkerSettings(
        seed=1, recordings=(Standing(duration_s=10.0), FreeMotion(duration_s=10.0)), sites=(SITE,)
    )
    standing, free = session_of(settings).recordings
    assert reported_of(standing.imu[SITE]) == []
    assert len(times_s(reported_of(free.imu[SITE]), "initial_contact")) <= 1


def test_a_heel_that_is_lifted_on_the_spot_has_not_stepped() -> None:
    """By 8 degrees about the toes, 12 cm in front of the sensor and 5 cm below, once in three seconds."""
    t = np.arange(2000) / 100.0
    pitch_rad = np.deg2rad(8.0) * np.maximum(np.sin(2 * np.pi * 0.35 * t), 0.0) ** 2
    rotations = Rotation.from_rotvec(np.outer(pitch_rad, [0.0, 1.0, 0.0]))
    place = rotations.apply([-0.12, 0.0, 0.05])
    acceleration = np.gradient(np.gradient(place, t, axis=0), t, axis=0)
    gyr = np.zeros_like(place)
    gyr[:, 1] = np.gradient(pitch_rad, t)
    acc = rotations.inv().apply(acceleration + np.array([0.0, 0.0, 9.81]))
    rng = np.random.default_rng(4)
    live = LiveEvents()
    assert live.update(t, gyr + 0.005 * rng.normal(size=gyr.shape), acc + 0.03 * rng.normal(size=acc.shape)) == []
    assert np.isnan(live.cadence_steps_min)


def test_a_foot_that_slides_flat_steps_late_but_is_reported() -> None:
    """Steps of 0.3 m within 0.48 s, the foot level all the time."""
    t = np.arange(900) / 100.0
    since_s = np.clip(t - 1.5, 0.0, 6.0 - 1e-9)
    u = np.clip((since_s % 1.2 - 0.72) / 0.48, 0.0, 1.0)
    forward = 0.3 * 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / 0.48**2
    acc = np.stack([forward, np.zeros_like(t), np.full_like(t, 9.81)], axis=1)
    rng = np.random.default_rng(5)
    reported = LiveEvents().update(t, 0.002 * rng.normal(size=acc.shape), acc + 0.03 * rng.normal(size=acc.shape))
    off_s = 1.5 + 1.2 * np.arange(5) + 0.72
    np.testing.assert_allclose(times_s(reported, FootEvent.TOE_OFF), off_s, atol=0.1)
    np.testing.assert_allclose(times_s(reported, FootEvent.INITIAL_CONTACT), off_s + 0.48, atol=0.1)
    assert any(one.is_late for one in reported)

"""Tests that a walking foot's events come in time. They are those of the whole walk looked at afterwards."""

import functools
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.body import Side, Site
from core.gait.events import FootEvents, gait_of
from core.gait.foot import follow
from core.gait.live import SETTINGS, FootEvent, LiveEvent, LiveEvents
from core.gait.phases import PHASES, Phase, phases_at
from core.samples import GRAVITY_M_S2, FloatArray, ImuBlock
from core.signal.pair import OrientedTrack
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings
from tests.core.gait.feet import foot_of
from tests.core.standing import bias_of
from tests.simulated import session_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

SITES = (Site.LEFT_FOOT, Site.RIGHT_FOOT)
MAX_DIFFERENCE_S = 0.030
ROLLING = (FootEvent.TOE_OFF, FootEvent.INITIAL_CONTACT)


def walker_feet(settings: WalkerSettings) -> list[OrientedTrack]:
    """The feet in the second recording; the first one is standing."""
    feet = []
    recordings = session_of(settings).recordings
    for site in settings.sites:
        standing, walk = (recording.imu[site] for recording in recordings)
        feet.append(foot_of(walk, bias_of(standing)))
    return feet


@functools.cache
def walking_feet(
    speed_m_s: float = 1.19, rate_hz: float = 100.0, tissue: Tissue = Tissue.SOFT, seed: int = 2
) -> list[OrientedTrack]:
    recordings = (Standing(), Walk(speed_m_s=speed_m_s, strides=9))
    return walker_feet(WalkerSettings(seed=seed, recordings=recordings, sites=SITES, rate_hz=rate_hz, tissue=tissue))


def reported_of(foot: OrientedTrack, pitch_axis: FloatArray | None = None) -> list[LiveEvent]:
    track = foot.track
    return LiveEvents(pitch_axis).update(track.time_s, track.gyr_rad_s, track.acc_m_s2)


def times(reported: Sequence[LiveEvent], event: FootEvent) -> FloatArray:
    return np.array([e.time_s for e in reported if e.event is event])


def differences(reported: Sequence[LiveEvent], offline: FootEvents, event: FootEvent) -> FloatArray:
    """Of every offline event from the nearest live one; infinite where none was reported."""
    at_s = np.append(times(reported, event), np.inf)
    return np.array([np.min(np.abs(at_s - t)) for t in getattr(offline, f"{event}_s")])


@pytest.mark.parametrize("tissue", [Tissue.RIGID, Tissue.SOFT])
@pytest.mark.parametrize(
    ("speed_m_s", "rate_hz"), [(0.3, 50.0), (0.3, 100.0), (0.6, 60.0), (1.19, 100.0), (2.0, 60.0), (2.0, 200.0)]
)
def test_all_steps_from_the_first_on_are_reported_as_offline_and_in_time(
    speed_m_s: float, rate_hz: float, tissue: Tissue
) -> None:
    for foot in walking_feet(speed_m_s, rate_hz, tissue):
        reported, offline = reported_of(foot), gait_of(foot)
        for event in FootEvent:
            # the last step arrives in standing and lands flat, which is known only afterwards
            assert np.max(differences(reported, offline, event)[:-1]) < MAX_DIFFERENCE_S, event
            assert len(times(reported, event)) <= len(offline), event
        assert (
            len(times(reported, FootEvent.TOE_OFF)) == len(times(reported, FootEvent.INITIAL_CONTACT)) == len(offline)
        )
        last_s = offline.toe_off_s[-1]
        late = [e for e in reported if e.is_late and e.time_s < last_s]
        assert [e.event for e in late] in ([FootEvent.HEEL_RISE], [FootEvent.HEEL_RISE, FootEvent.TOE_OFF])
        assert all(e.time_s <= offline.toe_off_s[0] + MAX_DIFFERENCE_S for e in late)  # the first step's, from standing


@pytest.mark.parametrize("speed_m_s", [0.3, 0.8, 2.0])
@pytest.mark.parametrize("seed", [0, 7])
def test_a_prosthesis_and_an_odd_place_of_the_sensor_change_nothing(speed_m_s: float, seed: int) -> None:
    recordings = (Standing(), Walk(speed_m_s=speed_m_s, strides=6))
    settings = WalkerSettings(seed=seed, recordings=recordings, sites=SITES, prosthetic_side=Side.LEFT)
    for foot in walker_feet(settings):
        reported, offline = reported_of(foot), gait_of(foot)
        for event in FootEvent:
            # no usual peak is known in the first step of a foot that lands slowly
            assert np.max(differences(reported, offline, event)[1:-1]) < MAX_DIFFERENCE_S, event
            assert len(times(reported, event)) <= len(offline), event
        assert (
            len(times(reported, FootEvent.TOE_OFF)) == len(times(reported, FootEvent.INITIAL_CONTACT)) == len(offline)
        )


def test_a_wobbling_sensor_loses_and_gains_next_to_no_step() -> None:
    worst, found, gained, expected = [], 0, 0, 0
    for seed in (1, 2, 3):
        for foot in walking_feet(0.8, tissue=Tissue.REAL, seed=seed):
            reported, offline = reported_of(foot), gait_of(foot)
            for event in ROLLING:
                away = differences(reported, offline, event)[:-1]
                worst += away.tolist()
                # offline such a sensor is timed by the mean of all swings, which takes the whole walk
                found += int(np.sum(away < 0.1))
                expected += len(away)
                gained += max(0, len(times(reported, event)) - len(offline))
    assert found >= 0.98 * expected
    assert gained <= 0.02 * expected
    assert np.percentile(worst, 90) < MAX_DIFFERENCE_S


@pytest.mark.parametrize("rotvec", [(2.0, 0.4, -1.0), (0.0, 0.0, np.pi), (-0.3, 1.5, 0.2)])
def test_turning_the_sensor_in_its_mounting_changes_no_live_event(rotvec: tuple[float, float, float]) -> None:
    foot = walking_feet()[0].track
    turn = Rotation.from_rotvec(rotvec)
    one = LiveEvents().update(foot.time_s, foot.gyr_rad_s, foot.acc_m_s2)
    other = LiveEvents().update(foot.time_s, turn.apply(foot.gyr_rad_s), turn.apply(foot.acc_m_s2))
    assert [e.event for e in one] == [e.event for e in other]
    np.testing.assert_allclose([e.time_s for e in one], [e.time_s for e in other], atol=1e-6)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axis_that_is_given_may_point_either_way(sign: float) -> None:
    foot = walking_feet()[0]
    reported, offline = reported_of(foot, sign * follow(foot).pitch_axis), gait_of(foot)
    for event in FootEvent:
        assert np.max(differences(reported, offline, event)[:-1]) < MAX_DIFFERENCE_S, event


@pytest.mark.parametrize("size", [1, 7, 64])
def test_the_size_of_the_blocks_changes_nothing(size: int) -> None:
    track = walking_feet()[0].track
    live = LiveEvents()
    reported = []
    for k in range(0, len(track), size):
        part = slice(k, k + size)
        reported += live.update(track.time_s[part], track.gyr_rad_s[part], track.acc_m_s2[part])
    assert reported == LiveEvents().update(track.time_s, track.gyr_rad_s, track.acc_m_s2)


def test_phases_and_cadence_are_those_of_the_whole_walk() -> None:
    foot = walking_feet()[0]
    track, offline = foot.track, gait_of(foot)
    live = LiveEvents()
    shown = []
    assert np.isnan(live.cadence_steps_min)
    for k in range(len(track)):
        live.update(track.time_s[k : k + 1], track.gyr_rad_s[k : k + 1], track.acc_m_s2[k : k + 1])
        shown.append(PHASES.index(live.phase))
        if track.time_s[k] < offline.initial_contact_s[-1]:
            cadence = live.cadence_steps_min
    assert cadence == pytest.approx(120.0 / np.median(np.diff(offline.initial_contact_s)[-6:-1]), rel=0.02)
    true = phases_at(track.time_s, [offline])
    inside = (true > 0) & (track.time_s > offline.toe_off_s[1])
    # each phase is shown when its event is reported, up to SETTINGS.max_delay_s after it began
    assert np.mean(np.array(shown)[inside] == true[inside]) > 0.7
    late = round(SETTINGS.max_delay_s / track.step_s)
    is_settled = np.array([len(set(true[max(0, k - late) : k + 2].tolist())) == 1 for k in range(len(track))])
    # push-off is seen to begin before its heel rise can be reported
    assert np.mean(np.array(shown)[inside & is_settled] == true[inside & is_settled]) > 0.97


@pytest.mark.parametrize("size", [1, 7, 10_000])
def test_changes_show_every_phase_and_since_when(size: int) -> None:
    foot = walking_feet()[0]
    events, reported, changes, phase = LiveEvents(), [], [], []
    for a in range(0, len(foot.track), size):
        part = slice(a, a + size)
        reported += events.update(foot.track.time_s[part], foot.track.gyr_rad_s[part], foot.track.acc_m_s2[part])
        changes += events.changes
        phase.append((foot.track.time_s[part][-1], events.phase))
    for time_s, shown in phase:
        assert shown is next((c.phase for c in reversed(changes) if c.reported_s <= time_s), Phase.UNKNOWN)
    assert all(change.since_s <= change.reported_s for change in changes)
    contacts = [one.time_s for one in reported if one.event is FootEvent.INITIAL_CONTACT]
    assert [change.since_s for change in changes if change.phase is Phase.LOADING] == contacts
    assert len(contacts) >= 5


def test_cadence_ends_with_the_walk() -> None:
    standing_after = Walk(strides=6, standing_after_s=6.0)
    (foot,) = walker_feet(WalkerSettings(recordings=(Standing(), standing_after), sites=SITES[:1]))
    live = LiveEvents()
    live.update(foot.track.time_s, foot.track.gyr_rad_s, foot.track.acc_m_s2)
    assert np.isnan(live.cadence_steps_min)
    assert live.phase is Phase.FOOT_FLAT


@pytest.mark.parametrize("lost_s", [0.03, 0.2, 0.5, 1.3])
@pytest.mark.parametrize("how", ["excluded", "NaN"])
def test_a_gap_invents_nothing_and_walking_is_reported_again_after_the_next_stance(lost_s: float, how: str) -> None:
    foot = walking_feet()[0]
    track, offline = foot.track, gait_of(foot)
    for from_s in np.linspace(5.0, 6.1, 5):
        is_lost = (track.time_s > from_s) & (track.time_s < from_s + lost_s)
        gyr, acc = track.gyr_rad_s.copy(), track.acc_m_s2.copy()
        gyr[is_lost] = np.nan
        kept = ~is_lost if how == "excluded" else np.ones(len(track), dtype=bool)
        reported = LiveEvents().update(track.time_s[kept], gyr[kept], acc[kept])
        for event in FootEvent:
            expected = getattr(offline, f"{event}_s")
            away = [float(np.min(np.abs(expected - t))) for t in times(reported, event)[:-1]]
            assert max(away) < 0.05, (event, from_s)
            far = (expected < from_s - 0.2) | (expected > from_s + lost_s + 1.2)
            assert np.max(differences(reported, offline, event)[far][:-1]) < MAX_DIFFERENCE_S, (event, from_s)


def lifted(pitch_rad: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rate and specific force of a foot that turns about its toes, its sensor 12 cm behind and 5 cm above them."""
    rotations = Rotation.from_rotvec(np.outer(pitch_rad, [0.0, 1.0, 0.0]))
    place = rotations.apply([-0.12, 0.0, 0.05])
    acceleration = np.gradient(np.gradient(place, t, axis=0), t, axis=0)
    gyr = np.zeros_like(place)
    gyr[:, 1] = np.gradient(pitch_rad, t)
    return gyr, rotations.inv().apply(acceleration + np.array([0.0, 0.0, GRAVITY_M_S2]))


def test_standing_for_a_minute_shows_nothing() -> None:
    recordings = (Standing(), Standing(name="long", duration_s=60.0))
    for foot in walker_feet(WalkerSettings(recordings=recordings, sites=SITES, tissue=Tissue.REAL)):
        assert reported_of(foot) == []


@pytest.mark.parametrize("lift_deg", [2.0, 8.0, 15.0])
def test_shifting_weight_and_lifting_the_heel_on_the_spot_shows_nothing(lift_deg: float) -> None:
    t = np.arange(6000) / 100.0
    rng = np.random.default_rng(4)
    noise = [scale * rng.normal(size=(len(t), 3)) for scale in (0.005, 0.03)]
    heel_up = np.deg2rad(lift_deg) * np.maximum(np.sin(2 * np.pi * 0.35 * t), 0.0) ** 2
    toes_up = np.deg2rad(0.3 * lift_deg) * np.maximum(-np.sin(2 * np.pi * 0.35 * t), 0.0) ** 2
    gyr, acc = lifted(heel_up - toes_up, t)
    live = LiveEvents()
    assert live.update(t, gyr + noise[0], acc + noise[1]) == []
    assert np.isnan(live.cadence_steps_min)


def test_walking_is_reported_after_weight_was_shifted() -> None:
    foot = walking_feet()[0]
    track, offline = foot.track, gait_of(foot)
    t = np.arange(1000) * track.step_s
    gyr, acc = lifted(np.deg2rad(8.0) * np.maximum(np.sin(2 * np.pi * 0.35 * t), 0.0) ** 2, t)
    lies = Rotation.align_vectors([track.acc_m_s2[:20].mean(axis=0)], [[0.0, 0.0, 1.0]])[0]
    live = LiveEvents()
    assert live.update(t - 10.0 + track.start_s, lies.apply(gyr), lies.apply(acc)) == []
    reported = live.update(track.time_s, track.gyr_rad_s, track.acc_m_s2)
    for event in ROLLING:
        assert np.max(differences(reported, offline, event)[:-1]) < MAX_DIFFERENCE_S, event
        assert len(times(reported, event)) == len(offline), event


def test_a_foot_that_slides_flat_makes_every_step_late() -> None:
    t = np.arange(1500) / 100.0
    since = np.clip(t - 1.5, 0.0, 12.0 - 1e-9)
    u = np.clip((since % 1.2 - 0.72) / 0.48, 0.0, 1.0)
    # twice the derivative of a minimum-jerk step of 0.3 m
    forward = 0.3 * 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / 0.48**2
    acc = np.stack([forward, np.zeros_like(t), np.full_like(t, GRAVITY_M_S2)], axis=1)
    rng = np.random.default_rng(5)
    mounting = Rotation.from_rotvec([0.5, -1.1, 2.0])
    reported = LiveEvents().update(
        t, 0.002 * rng.normal(size=acc.shape), mounting.apply(acc) + 0.03 * rng.normal(size=acc.shape)
    )
    off_s = 1.5 + 1.2 * np.arange(10) + 0.72
    np.testing.assert_allclose(times(reported, FootEvent.TOE_OFF), off_s, atol=0.1)
    np.testing.assert_allclose(times(reported, FootEvent.INITIAL_CONTACT), off_s + 0.48, atol=0.1)
    assert {e.event for e in reported if e.is_late} >= {FootEvent.TOE_OFF}


def test_a_foot_in_the_air_is_not_walking_for_long() -> None:
    settings = WalkerSettings(recordings=(Standing(), FreeMotion(duration_s=30.0)), sites=SITES)
    for foot in walker_feet(settings):
        assert len(times(reported_of(foot), FootEvent.INITIAL_CONTACT)) <= 1


def test_a_stamp_that_does_not_advance_is_passed_over() -> None:
    track = walking_feet()[0].track
    twice = np.repeat(np.arange(len(track)), 2)
    assert LiveEvents().update(track.time_s[twice], track.gyr_rad_s[twice], track.acc_m_s2[twice]) == reported_of(
        walking_feet()[0]
    )


@pytest.mark.parametrize(("is_axis_given", "every"), [(False, 1), (True, 1), (False, 2), (False, 4)])
def test_optics_feet_are_reported_as_offline(test_data: Callable[[str], Path], is_axis_given: bool, every: int) -> None:
    with np.load(test_data("feet_mocap_events") / "healthy_feet.npz") as arrays:
        rate_hz = float(arrays["fs"]) / every
        feet = [[arrays[f"{side}_foot_{k}"].astype(np.float64)[2::every] for k in ("gyr", "acc")] for side in Side]
    found = dict.fromkeys(FootEvent, 0)
    for gyr, acc in feet:
        block = ImuBlock("foot", np.arange(len(gyr)) / rate_hz, gyr, acc)
        foot = foot_of(block, bias_of(block))
        reported, offline = reported_of(foot, follow(foot).pitch_axis if is_axis_given else None), gait_of(foot)
        for event in FootEvent:
            found[event] += int(np.sum(differences(reported, offline, event) < MAX_DIFFERENCE_S))
            assert len(times(reported, event)) <= len(offline)
        # flat landings in a turn and the last small step to a halt are reported late
        assert sum(e.is_late for e in reported if e.event in ROLLING) <= (2 if every < 4 else 4)
    least = 64 if every == 1 else 62
    assert found[FootEvent.TOE_OFF] >= least
    assert found[FootEvent.INITIAL_CONTACT] >= least - 3  # steps to a halt land flat: by the sole afterwards
    assert found[FootEvent.HEEL_RISE] >= least - 8  # looked at afterwards, all swings together say where heels rise
    assert found[FootEvent.FULL_CONTACT] >= least - 4

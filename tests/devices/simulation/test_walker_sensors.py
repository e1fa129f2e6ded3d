"""Tests that the simulated samples are what the poses demand. Checked by integrating them, and on known derivatives."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.spatial.transform import Rotation

from core.body import LEG_SITES, Side, Site
from core.samples import FloatArray, ImuBlock, RateKind
from devices.simulation.walker import NO_ERRORS, SensorErrors, Standing, Tissue, Walk, WalkerSettings, simulate
from devices.simulation.walker_body import Leg, make_leg
from devices.simulation.walker_gait import walk_leg
from devices.simulation.walker_motion import LegMotion
from devices.simulation.walker_plan import plan_walk
from devices.simulation.walker_sensors import (
    GRAVITY_M_S2,
    acceleration,
    angular_rate,
    draw_faults,
    draw_mounting,
    draw_ride,
    make_clock,
    record,
    sensor_poses,
)

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

GYRO_NOISE = SensorErrors().gyro_noise_rad_s * np.sqrt(50.0)  # at 100 Hz
ACC_NOISE = SensorErrors().acc_noise_m_s2 * np.sqrt(50.0)
DENSE = WalkerSettings(seed=3, rate_hz=1000.0, errors=NO_ERRORS, tissue=Tissue.SOFT)
WALK_ONLY = (Walk(strides=3),)


def walking_leg(settings: WalkerSettings) -> tuple[Leg, LegMotion]:
    leg = make_leg(settings, Side.LEFT)
    rng = np.random.default_rng(0)
    time_s = np.arange(-250, 6000) / 1000.0
    walk = Walk(strides=3)
    plan = plan_walk(walk, time_s, leg.side, {}, rng)
    return leg, walk_leg(leg, plan, time_s, np.zeros((len(time_s), 2)), rng)


def worn(site: Site, settings: WalkerSettings = DENSE) -> tuple[ImuBlock, tuple[FloatArray, FloatArray], FloatArray]:
    """A sensor's samples at 1000 Hz, and its true poses and times at the same instants."""
    rng = np.random.default_rng(1)
    _, motion = walking_leg(settings)
    poses = sensor_poses(motion, site, draw_mounting(site, 0.025, rng), settings.tissue, draw_ride(rng), rng)
    clock = make_clock(settings, site, 5.0, rng)
    faults = draw_faults(settings.errors, rng)
    block, _ = record(settings, site, clock, motion.time_s, poses, faults, rng)
    here = slice(250, 250 + len(block))
    return block, (poses[0][here], poses[1][here]), motion.time_s[here]


def test_rates_of_an_analytic_motion_are_exact_to_a_tenth_of_the_noise() -> None:
    # as fast as a leg and as shaken as by the heel strike
    t = np.arange(2000) / 1000.0
    turn, tilt = 6.0 * np.sin(2.0 * t), 1.0 * np.sin(5.0 * t) + 0.004 * np.sin(2 * np.pi * 25 * t)
    tilt_rate = 5.0 * np.cos(5.0 * t) + 0.004 * 2 * np.pi * 25 * np.cos(2 * np.pi * 25 * t)
    rotations = (
        Rotation.from_rotvec(np.outer(turn, [0, 0, 1])) * Rotation.from_rotvec(np.outer(tilt, [1, 0, 0]))
    ).as_matrix()
    turn_rate = 12.0 * np.cos(2.0 * t)
    expected = np.stack([tilt_rate, turn_rate * np.sin(tilt), turn_rate * np.cos(tilt)], axis=-1)
    found = angular_rate(rotations, 0.001)
    assert np.abs(found - expected)[2:-2].max() < 0.1 * GYRO_NOISE


def test_acceleration_of_an_analytic_path_is_exact_to_a_tenth_of_the_noise() -> None:
    t = np.arange(2000) / 1000.0
    slow, fast = 2 * np.pi * 1.0, 2 * np.pi * 25.0
    path = np.stack([1.2 * t, 0.2 * np.sin(slow * t), 0.0015 * np.sin(fast * t)], axis=-1)
    expected = np.stack([0 * t, -0.2 * slow**2 * np.sin(slow * t), -0.0015 * fast**2 * np.sin(fast * t)], axis=-1)
    assert np.abs(acceleration(path, 0.001) - expected)[2:-2].max() < 0.1 * ACC_NOISE


@pytest.mark.parametrize("site", [Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT])
def test_integrating_the_rates_gives_the_orientation_back(site: Site) -> None:
    block, (rotations, _), _ = worn(site)
    middle = 0.5 * (block.gyr_rad_s[1:] + block.gyr_rad_s[:-1])
    steps = Rotation.from_rotvec(middle / 1000.0)
    orientation = Rotation.from_matrix(rotations[0])
    for step in steps:
        orientation = orientation * step
    error = (orientation.inv() * Rotation.from_matrix(rotations[-1])).magnitude()
    assert np.rad2deg(error) < 0.01
    assert (Rotation.from_matrix(rotations[0]).inv() * Rotation.from_matrix(rotations[2000])).magnitude() > 0.2


@pytest.mark.parametrize("site", [Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT])
def test_integrating_the_specific_force_twice_gives_the_path_back(site: Site) -> None:
    block, (rotations, place), time_s = worn(site)
    in_earth = np.einsum("nij,nj->ni", rotations, block.acc_m_s2) + GRAVITY_M_S2
    velocity = cumulative_trapezoid(in_earth, time_s, axis=0, initial=0)
    velocity += (place[1] - place[0]) * 1000.0 - 0.0005 * in_earth[0]
    path = cumulative_trapezoid(velocity, time_s, axis=0, initial=0) + place[0]
    assert np.linalg.norm(place[-1] - place[0]) > 2.0
    assert np.abs(path - place).max() < 0.002


def test_a_sensor_at_rest_feels_one_gravity_upwards() -> None:
    still = simulate(WalkerSettings(errors=NO_ERRORS, recordings=(Standing(),)))
    foot = still.session.recordings[0].imu[Site.LEFT_FOOT]
    np.testing.assert_allclose(np.linalg.norm(foot.acc_m_s2, axis=1), 9.81, atol=1e-6)
    np.testing.assert_allclose(foot.gyr_rad_s, 0.0, atol=1e-9)


def test_averaged_rates_are_the_mean_over_the_interval_before() -> None:
    dense = simulate(replace(DENSE, recordings=WALK_ONLY)).session.recordings[0].imu[Site.RIGHT_SHANK]
    averaged = simulate(replace(DENSE, rate_hz=100.0, rate_kind=RateKind.AVERAGED, recordings=WALK_ONLY))
    found = averaged.session.recordings[0].imu[Site.RIGHT_SHANK].gyr_rad_s
    angle = cumulative_trapezoid(dense.gyr_rad_s, dense.time_s, axis=0, initial=0)[::10]
    expected = np.diff(angle, axis=0) * 100.0
    n = min(len(found) - 1, len(expected))
    assert np.abs(found[1 : n + 1] - expected[:n]).max() < 0.002
    assert np.abs(found[1:-1] - dense.gyr_rad_s[10::10][: len(found) - 2]).max() > 0.1


def test_a_late_clock_stamps_the_same_motion_later() -> None:
    on_time = simulate(replace(DENSE, rate_hz=100.0)).session.recordings[-1].imu[Site.LEFT_FOOT]
    late = replace(DENSE, rate_hz=100.0, clock_late_s={Site.LEFT_FOOT: 0.03})
    shifted = simulate(late).session.recordings[-1].imu[Site.LEFT_FOOT]
    np.testing.assert_allclose(shifted.gyr_rad_s[3:], on_time.gyr_rad_s[:-3], atol=1e-9)
    np.testing.assert_array_equal(shifted.time_s, on_time.time_s)


def test_lost_samples_leave_gaps_and_the_rest_untouched() -> None:
    whole = simulate(WalkerSettings()).session.recordings[-1].imu[Site.LEFT_SHANK]
    with_loss = simulate(WalkerSettings(loss_fraction=0.1))
    lossy = with_loss.session.recordings[-1].imu[Site.LEFT_SHANK]
    share = [
        1 - len(r.imu[s]) / (r.imu[s].time_s[-1] * 100 + 1) for r in with_loss.session.recordings for s in LEG_SITES
    ]
    assert 0.07 < np.mean(share) < 0.13
    longest = np.diff(lossy.time_s).max()
    assert longest > 0.025
    kept = np.searchsorted(whole.time_s, lossy.time_s - 1e-6)
    clean = replace(WalkerSettings(errors=NO_ERRORS), loss_fraction=0.0)
    same = simulate(clean).session.recordings[-1].imu[Site.LEFT_SHANK].gyr_rad_s[kept]
    without_noise = simulate(replace(clean, loss_fraction=0.1)).session.recordings[-1].imu[Site.LEFT_SHANK].gyr_rad_s
    np.testing.assert_allclose(without_noise, same, atol=1e-12)


def test_jittered_stamps_ascend_and_scatter_as_reported() -> None:
    jittered = simulate(WalkerSettings(stamp_jitter_s=0.001)).session.recordings[-1].imu[Site.LEFT_SHANK].time_s
    away = jittered - np.arange(len(jittered)) / 100.0
    assert (np.diff(jittered) > 0).all()
    assert 0.0008 < away.std() < 0.0012


def test_every_site_may_have_a_rate_of_its_own() -> None:
    session = simulate(WalkerSettings(rate_hz=100.0, site_rates_hz={Site.LEFT_FOOT: 60.0})).session
    imu = session.recordings[0].imu
    np.testing.assert_allclose(np.diff(imu[Site.LEFT_FOOT].time_s), 1 / 60)
    np.testing.assert_allclose(np.diff(imu[Site.LEFT_SHANK].time_s), 1 / 100)
    assert session.sensors[Site.LEFT_FOOT].rate_hz == 60.0


def test_bias_is_what_the_truth_states_and_noise_what_was_asked() -> None:
    reported = SensorErrors(gyro_scale_sd=0.0, acc_scale_sd=0.0)
    recordings = (Standing(duration_s=60.0),)
    faulty = simulate(WalkerSettings(errors=reported, recordings=recordings))
    clean = simulate(WalkerSettings(errors=NO_ERRORS, recordings=recordings))
    site = Site.RIGHT_THIGH
    block, ideal = (s.session.recordings[0].imu[site] for s in (faulty, clean))
    truth = faulty.truth.recordings["standing"]
    gyr, acc = block.gyr_rad_s - ideal.gyr_rad_s, block.acc_m_s2 - ideal.acc_m_s2
    np.testing.assert_allclose(gyr.mean(axis=0), truth.gyro_bias_rad_s[site], atol=5 * GYRO_NOISE / np.sqrt(len(gyr)))
    np.testing.assert_allclose(
        acc.mean(axis=0), faulty.truth.acc_bias_m_s2[site], atol=5 * ACC_NOISE / np.sqrt(len(acc))
    )
    np.testing.assert_allclose(np.diff(gyr, axis=0).std() / np.sqrt(2), GYRO_NOISE, rtol=0.05)
    np.testing.assert_allclose(np.diff(acc, axis=0).std() / np.sqrt(2), ACC_NOISE, rtol=0.05)


def test_the_bias_wanders_on_from_one_recording_to_the_next() -> None:
    wander = replace(NO_ERRORS, gyro_bias_walk_rad_s=0.001)
    recordings = (Standing("first", 30.0), Standing("second", 30.0))
    simulated = simulate(WalkerSettings(errors=wander, recordings=recordings))
    first, second = (r.imu[Site.LEFT_FOOT].gyr_rad_s for r in simulated.session.recordings)
    assert np.abs(first[0]).max() < 1e-9
    np.testing.assert_allclose(second[0], first[-1], atol=1e-9)
    assert 0.0005 < np.sqrt(np.mean((second[-1] - first[0]) ** 2)) / np.sqrt(60.0) < 0.002


def test_scale_errors_stretch_each_axis() -> None:
    stretched = simulate(WalkerSettings(errors=replace(NO_ERRORS, gyro_scale_sd=0.003))).session.recordings[-1]
    ideal = simulate(WalkerSettings(errors=NO_ERRORS)).session.recordings[-1]
    ratios = np.array(
        [np.median(stretched.imu[s].gyr_rad_s[100:-100] / ideal.imu[s].gyr_rad_s[100:-100], axis=0) for s in LEG_SITES]
    )
    assert 0.0015 < np.std(ratios - 1.0) < 0.0045


def test_mountings_favour_no_direction() -> None:
    rng = np.random.default_rng(0)
    drawn = np.array([draw_mounting(Site.LEFT_SHANK, 0.025, rng).segment_from_sensor for _ in range(2000)])
    np.testing.assert_allclose(drawn @ np.swapaxes(drawn, 1, 2), np.broadcast_to(np.eye(3), drawn.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(drawn), 1.0)
    np.testing.assert_allclose(drawn.mean(axis=0), 0.0, atol=0.06)
    turned = Rotation.from_matrix(drawn).magnitude()
    # uniform on SO(3): the angle's density is (1 - cos a) / pi, its mean pi/2 + 2/pi
    assert abs(turned.mean() - (np.pi / 2 + 2 / np.pi)) < 0.06

"""Tests that gait and sensors vary by the amount given, and not at all where none is given."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from core.body import LEG_JOINTS, Joint, Segment, Side
from core.samples import FloatArray
from devices.simulation.walker import (
    NO_ERRORS,
    PEOPLE,
    GaitChange,
    JointTruth,
    RecordingTruth,
    SimulatedSession,
    Standing,
    Tissue,
    Variation,
    Walk,
    WalkerSettings,
    simulate,
)
from devices.simulation.walker_variation import draw_changes

CLEAN = WalkerSettings(seed=4, errors=NO_ERRORS, rate_hz=50.0)


def truth_of(**settings: object) -> RecordingTruth:
    walk = Walk(strides=8, **settings)  # type: ignore[arg-type]  # any setting of a walk
    return simulate(replace(CLEAN, recordings=(walk,))).truth.recordings["walk 1"]


def ranges_deg(truth: RecordingTruth, joint: Joint) -> FloatArray:
    """Of each whole stride at steady speed."""
    contact_s = truth.feet[joint.side].events.initial_contact_s
    reported = truth.joints[joint]
    strides = pairwise(contact_s[1:-1])
    return np.array(
        [np.rad2deg(np.ptp(reported.angle_rad[(reported.time_s >= a) & (reported.time_s < b)])) for a, b in strides]
    )


def stance_percent(truth: RecordingTruth, side: Side) -> FloatArray:
    events = truth.feet[side].events
    contact_s = events.initial_contact_s
    return np.asarray(100.0 * (events.toe_off_s[2:] - contact_s[1:-1]) / np.diff(contact_s)[1:])


def stride_s(truth: RecordingTruth) -> FloatArray:
    return np.diff(truth.feet[Side.LEFT].events.initial_contact_s)


def lengths_m(truth: RecordingTruth) -> FloatArray:
    return truth.feet[Side.LEFT].stride_lengths_m[2:-2]


def test_a_change_of_a_walk_is_as_large_as_reported_and_on_the_side_reported() -> None:
    plain = truth_of()
    changed = truth_of(change=GaitChange(knee_deg=6.0, ankle_deg=5.0), changed_side=Side.LEFT)
    for joint, expected in ((Joint.LEFT_KNEE, 6.0), (Joint.LEFT_ANKLE, 5.0)):
        difference = ranges_deg(changed, joint) - ranges_deg(plain, joint)
        assert difference.mean() == pytest.approx(expected, abs=0.6)
    for joint in (Joint.RIGHT_KNEE, Joint.RIGHT_ANKLE):
        np.testing.assert_array_equal(changed.joints[joint].angle_rad, plain.joints[joint].angle_rad)


def test_a_longer_stance_is_longer_by_the_points_reported() -> None:
    plain, changed = truth_of(), truth_of(change=GaitChange(stance_percent=3.0), changed_side=Side.LEFT)
    for side, expected in ((Side.LEFT, 3.0), (Side.RIGHT, 0.0)):
        longer = stance_percent(changed, side) - stance_percent(plain, side)
        assert longer.mean() == pytest.approx(expected, abs=0.2)


def test_longer_and_slower_strides_are_so_by_the_share_reported() -> None:
    plain = truth_of()
    changed = truth_of(change=GaitChange(length=0.12, time=0.04))
    assert lengths_m(changed).mean() / lengths_m(plain).mean() == pytest.approx(1.12, abs=0.01)
    assert stride_s(changed).mean() / stride_s(plain).mean() == pytest.approx(1.04, abs=0.003)
    assert stance_percent(changed, Side.LEFT).mean() == pytest.approx(stance_percent(plain, Side.LEFT).mean(), abs=0.3)


@pytest.mark.endurance
def test_a_gait_that_drifts_ends_where_it_was_reported_to() -> None:
    recordings = (Walk("even", strides=20), Walk("drifting", strides=20, drift=GaitChange(knee_deg=8.0, time=0.1)))
    truth = simulate(replace(CLEAN, recordings=recordings)).truth.recordings
    even, drifting = (truth[name] for name in ("even", "drifting"))
    grown = ranges_deg(drifting, Joint.LEFT_KNEE) - ranges_deg(even, Joint.LEFT_KNEE).mean()
    assert np.abs(grown[:2]).max() < 3.0
    assert grown[-2:].mean() == pytest.approx(7.5, abs=2.0)
    slower = stride_s(drifting) / stride_s(even).mean()
    assert slower[-3:].mean() - slower[:3].mean() == pytest.approx(0.085, abs=0.03)


def test_a_random_drift_is_another_in_every_walk() -> None:
    walks = tuple(Walk(f"{k}", strides=8, drift=GaitChange(knee_deg=6.0), is_drift_random=True) for k in range(5))
    truth = simulate(replace(CLEAN, recordings=walks)).truth.recordings
    moved = [ranges_deg(truth[walk.name], Joint.LEFT_KNEE) for walk in walks]
    ends = np.array([m[-1] - m[0] for m in moved])
    assert 1.5 < ends.std() < 12.0
    assert max(np.abs(np.diff(m)).max() for m in moved) < 9.0


def test_strides_vary_and_remember_the_stride_before() -> None:
    varied = Variation(strides=GaitChange(knee_deg=4.0, stance_percent=1.0), correlation=0.6)
    walk = Walk(strides=3000)
    settings = replace(CLEAN, recordings=(walk,), variation=varied)
    changes = draw_changes(settings, 0, 0, walk).feet
    for knee_deg in (changes[side].knee_deg for side in Side):
        assert knee_deg.std() == pytest.approx(4.0, rel=0.1)
        assert np.corrcoef(knee_deg[1:], knee_deg[:-1])[0, 1] == pytest.approx(0.6, abs=0.06)
    assert abs(np.corrcoef(changes[Side.LEFT].knee_deg, changes[Side.RIGHT].knee_deg)[0, 1]) < 0.1
    assert abs(np.corrcoef(changes[Side.LEFT].knee_deg, changes[Side.LEFT].stance_percent)[0, 1]) < 0.1
    assert not changes[Side.LEFT].ankle_deg.any()


@pytest.mark.endurance
def test_people_vary_as_people_do() -> None:
    truth = simulate(replace(CLEAN, recordings=(Walk(strides=60),), variation=PEOPLE)).truth.recordings["walk 1"]
    assert 1.1 < ranges_deg(truth, Joint.LEFT_KNEE).std() < 2.3
    assert 0.7 < ranges_deg(truth, Joint.LEFT_ANKLE).std() < 2.4
    assert 0.6 < stance_percent(truth, Side.LEFT).std() < 1.6
    assert 0.013 < stride_s(truth).std() / stride_s(truth).mean() < 0.028
    assert 0.015 < lengths_m(truth).std() / lengths_m(truth).mean() < 0.045


@pytest.mark.endurance
def test_walks_differ_by_the_spread_reported() -> None:
    varied = Variation(walks=GaitChange(knee_deg=5.0, length=0.05))
    walks = tuple(Walk(f"{k}", strides=6) for k in range(10))
    truth = simulate(replace(CLEAN, recordings=walks, variation=varied)).truth.recordings
    knees = [ranges_deg(truth[walk.name], Joint.LEFT_KNEE).mean() for walk in walks]
    assert 2.5 < np.std(knees) < 8.0
    lengths = [lengths_m(truth[walk.name]).mean() for walk in walks]
    assert 0.025 < np.std(lengths) / np.mean(lengths) < 0.08


def read_range_deg(simulated: SimulatedSession, number: int, joint: Joint) -> tuple[float, JointTruth]:
    """What two sensors report of a hinge's range, by the difference of their rates about its axis."""
    recording = simulated.session.recordings[number]
    truth = simulated.truth.recordings[recording.name].joints[joint]
    proximal, distal = recording.imu[joint.proximal], recording.imu[joint.distal]
    rate = distal.gyr_rad_s @ truth.axis_distal - proximal.gyr_rad_s @ truth.axis_proximal
    angle = np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(proximal.time_s))
    return float(np.rad2deg(np.ptp(angle))), truth


def test_tissue_makes_knees_read_more_and_the_truth_states_by_how_much() -> None:
    settings = replace(CLEAN, rate_hz=200.0, recordings=(Walk(strides=3),), tissue_gain=0.09, tissue_gain_sd=0.04)
    simulated = simulate(settings)
    for joint in (Joint.LEFT_KNEE, Joint.RIGHT_KNEE):
        read, truth = read_range_deg(simulated, 0, joint)
        assert 0.0 < truth.sensor_gain < 0.25
        assert read / np.rad2deg(np.ptp(truth.angle_rad)) == pytest.approx(1.0 + truth.sensor_gain, abs=0.003)
    plain = simulate(replace(settings, tissue_gain=0.0, tissue_gain_sd=0.0))
    one, other = (s.truth.recordings["walk 1"].joints[Joint.LEFT_KNEE].angle_rad for s in (simulated, plain))
    np.testing.assert_array_equal(one, other)
    assert simulated.truth.recordings["walk 1"].joints[Joint.LEFT_ANKLE].sensor_gain == 0.0


def test_every_strapping_reads_a_little_more_or_less_and_one_strapping_alike() -> None:
    varied = Variation(strappings=GaitChange(knee_deg=6.0, ankle_deg=3.0))
    walks = tuple(Walk(f"{k}", strides=3, is_restrapped_before=k % 2 == 0) for k in range(6))
    simulated = simulate(replace(CLEAN, recordings=walks, variation=varied))
    gains = {
        joint: [simulated.truth.recordings[w.name].joints[joint].sensor_gain for w in walks] for joint in LEG_JOINTS
    }
    for of_joint in gains.values():
        assert of_joint[0] == of_joint[1] != of_joint[2] == of_joint[3]
    assert 2.0 < np.std([59.0 * g for j, of in gains.items() if j.is_knee for g in of]) < 12.0
    assert 1.0 < np.std([25.0 * g for j, of in gains.items() if not j.is_knee for g in of]) < 6.0


def test_a_prosthesis_has_no_tissue_below_the_socket() -> None:
    settings = replace(CLEAN, prosthetic_side=Side.LEFT, tissue_gain=0.1, recordings=(Standing(),))
    joints = simulate(settings).truth.recordings["standing"].joints
    assert joints[Joint.LEFT_KNEE].sensor_gain == 0.0
    assert joints[Joint.RIGHT_KNEE].sensor_gain == 0.1


def test_tissue_turns_sensors_about_the_flexion_axis_in_step_and_leaves_the_joints_as_they_are() -> None:
    soft = replace(CLEAN, tissue=Tissue.SOFT, recordings=(Standing(), Walk(strides=4)))
    still, turning = (simulate(replace(soft, tissue_turn_rad=size)) for size in (0.0, np.deg2rad(3.0)))
    for before, after in zip(still.session.recordings, turning.session.recordings, strict=True):
        turned = {site: after.imu[site].gyr_rad_s - before.imu[site].gyr_rad_s for site in after.imu}
        sizes = {site.segment: float(np.sqrt(np.mean(np.sum(rate**2, axis=1)))) for site, rate in turned.items()}
        if after.name == "standing":
            assert max(sizes.values()) < 1e-9
        else:
            assert 0.1 < sizes[Segment.THIGH] < 0.5
            assert sizes[Segment.FOOT] < sizes[Segment.SHANK] < sizes[Segment.THIGH]
        for joint in LEG_JOINTS:
            truths = [made.truth.recordings[after.name].joints[joint] for made in (still, turning)]
            np.testing.assert_array_equal(truths[0].angle_rad, truths[1].angle_rad)

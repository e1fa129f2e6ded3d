"""The live joint angle against the offline one with the same calibration, and what may not change it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as example_settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from core.analysis import analyse
from core.angles.twist import off_axis_rate, twist
from core.body import LEG_SITES, Joint, Side, Site
from core.live.angle import BLEND_S, AngleSamples, LiveAngle
from core.live.joint_frames import JointGeometry
from core.live.orientation import NOTHING, LiveOrientation, OrientedSamples, joined
from core.live.pairing import MAX_WAIT_S, Pairing
from core.live.streams import EvenStream
from core.results import AxisSource, JointCalibration
from core.samples import FloatArray, ImuBlock, RateKind
from core.session import Recording
from core.signal.pair import OrientedTrack, pair_up
from core.signal.rotations import joint_frame, wrap
from core.signal.tracks import Track
from devices.simulation.walker import FreeMotion, JointTruth, Standing, Tissue, Walk, WalkerSettings
from tests.core.recorded_joints import TestData, mechanism, session_of_mechanism
from tests.simulated import simulation_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

KNEE, ANKLE = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
SITES = tuple(site for site in LEG_SITES if site.side is Side.LEFT)
SCORED_FROM_S = 3.0


@dataclass(frozen=True)
class LiveVisit:
    """A walk, what the offline analysis made of it, and the truth."""

    walk: Recording
    rates_hz: Mapping[Site, float]
    calibrations: Mapping[Joint, JointCalibration]
    time_s: FloatArray
    offline_rad: Mapping[Joint, FloatArray]
    truths: Mapping[Joint, JointTruth]


def visit(settings: WalkerSettings) -> LiveVisit:
    made = simulation_of(
        replace(settings, sites=SITES, recordings=(Standing(), FreeMotion(), Walk(strides=10, standing_before_s=2.0)))
    )
    found = analyse(made.session)
    offline = found.recordings[-1]
    return LiveVisit(
        walk=made.session.recordings[-1],
        rates_hz={site: settings.site_rates_hz.get(site, settings.rate_hz) for site in SITES},
        calibrations=found.calibrations[-1].joints,
        time_s=offline.time_s,
        offline_rad={joint: angle.angle_rad for joint, angle in offline.joints.items()},
        truths=made.truth.recordings[offline.name].joints,
    )


@pytest.fixture(scope="module")
def rigid() -> LiveVisit:
    return visit(WalkerSettings(seed=1))


@pytest.fixture(scope="module")
def soft() -> LiveVisit:
    return visit(WalkerSettings(seed=3, tissue=Tissue.SOFT))


def without(recording: Recording, site: Site, from_s: float, to_s: float) -> Recording:
    block = recording.imu[site]
    is_kept = (block.time_s < from_s) | (block.time_s > to_s)
    return replace(recording, imu={**recording.imu, site: block.select(is_kept)})


def sensor(calibration: JointCalibration, site: Site, rate_hz: float, left_rad_s: float = 0.0) -> LiveOrientation:
    """`left_rad_s` of bias about the joint axis stays in the distal rates."""
    is_distal = site is calibration.joint.distal
    known = calibration.gyro_bias_distal_rad_s if is_distal else calibration.gyro_bias_proximal_rad_s
    bias = np.zeros(3) if known is None else known
    left = left_rad_s * calibration.axis_distal if is_distal else 0.0
    return LiveOrientation(bias - left, RateKind.INSTANTANEOUS, 1 / rate_hz)


def oriented(
    recording: Recording, calibration: JointCalibration, rates_hz: Mapping[Site, float], left_rad_s: float = 0.0
) -> list[OrientedSamples]:
    turned = []
    for site in (calibration.joint.proximal, calibration.joint.distal):
        stream = EvenStream(rates_hz[site])
        stream.feed(recording.imu[site])
        turned.append(sensor(calibration, site, rates_hz[site], left_rad_s).update(stream.take()))
    return turned


def started(calibration: JointCalibration, rates_hz: Mapping[Site, float]) -> LiveAngle:
    joint = calibration.joint
    return LiveAngle(calibration, 1 / rates_hz[joint.proximal], 1 / rates_hz[joint.distal])


def followed(one: LiveVisit, joint: Joint, recording: Recording | None = None, left_rad_s: float = 0.0) -> AngleSamples:
    calibration = one.calibrations[joint]
    both = oriented(recording or one.walk, calibration, one.rates_hz, left_rad_s)
    return started(calibration, one.rates_hz).update(*both)


def error_deg(one: LiveVisit, joint: Joint, live: AngleSamples) -> FloatArray:
    """Against the offline angle (n,), on the thigh's clock."""
    late_s = 0.0 if joint.is_knee else one.calibrations[KNEE].lag_s
    offline = np.interp(live.time_s + late_s, one.time_s, one.offline_rad[joint])
    return np.rad2deg(live.angle_rad - offline)


def rmse_deg(one: LiveVisit, joint: Joint, live: AngleSamples) -> float:
    scored = live.time_s > SCORED_FROM_S
    error = error_deg(one, joint, live)[scored]
    assert np.isfinite(live.angle_rad[scored]).all()
    assert np.isfinite(error).mean() > 0.95
    return float(np.sqrt(np.nanmean(error**2)))


def all_of(pieces: list[AngleSamples]) -> AngleSamples:
    return AngleSamples(*(np.concatenate([getattr(p, name) for p in pieces]) for name in AngleSamples.__slots__))


def assert_same(one: AngleSamples, other: AngleSamples) -> None:
    np.testing.assert_array_equal(one.tick, other.tick)
    np.testing.assert_allclose(one.angle_rad, other.angle_rad, atol=1e-9)
    np.testing.assert_allclose(one.sd_rad, other.sd_rad, atol=1e-9)


@pytest.mark.parametrize("left_deg_s", [0.0, 1.5])
@pytest.mark.parametrize(("joint", "limit_deg"), [(KNEE, 0.35), (ANKLE, 1.0)])
def test_a_rigid_leg_is_followed_as_closely_as_promised(
    rigid: LiveVisit, joint: Joint, limit_deg: float, left_deg_s: float
) -> None:
    live = followed(rigid, joint, left_rad_s=np.deg2rad(left_deg_s))
    assert rigid.calibrations[joint].is_hinge == joint.is_knee
    assert rmse_deg(rigid, joint, live) < limit_deg
    assert np.max(np.abs(np.diff(error_deg(rigid, joint, live)))) < 0.5


@pytest.mark.parametrize("left_deg_s", [0.0, 1.5])
@pytest.mark.parametrize("joint", [KNEE, ANKLE])
def test_a_leg_with_soft_tissue_too(soft: LiveVisit, joint: Joint, left_deg_s: float) -> None:
    live = followed(soft, joint, left_rad_s=np.deg2rad(left_deg_s))
    assert not soft.calibrations[joint].is_hinge
    assert rmse_deg(soft, joint, live) < 1.0


@pytest.mark.parametrize("joint", [KNEE, ANKLE])
def test_two_standard_deviations_hold_nine_samples_of_ten_of_the_truth(soft: LiveVisit, joint: Joint) -> None:
    live, truth = followed(soft, joint), soft.truths[joint]
    true = np.interp(live.time_s, truth.time_s, truth.angle_rad) - truth.standing_rad
    assert np.mean(np.abs(live.angle_rad - true) < 2 * live.sd_rad) > 0.9
    assert np.rad2deg(np.median(live.sd_rad)) < 4.0


@pytest.mark.parametrize("name", ["1D_02", "1D_03"])
def test_a_mechanical_hinge_is_followed_to_half_a_degree(test_data: TestData, name: str) -> None:
    data = mechanism(test_data, name)
    session = session_of_mechanism(data)
    found, (recording,) = analyse(session), session.recordings
    rates_hz, time_s = dict.fromkeys(recording.imu, float(data["fs"])), recording.imu[KNEE.proximal].time_s
    offline = {KNEE: found.recordings[0].joints[KNEE].angle_rad}
    one = LiveVisit(recording, rates_hz, found.calibrations[0].joints, time_s, offline, {})
    assert rmse_deg(one, KNEE, followed(one, KNEE)) < 0.5


@example_settings(max_examples=5)
@given(
    edges=st.lists(st.integers(1, 1500), max_size=60),
    later=st.integers(0, 300),
    joint=st.sampled_from([KNEE, ANKLE]),
)
def test_neither_blocks_nor_a_late_sensor_change_anything(
    rigid: LiveVisit, edges: list[int], later: int, joint: Joint
) -> None:
    # with a long gap in each sensor, the second one amid the walk
    recording = without(without(rigid.walk, joint.distal, 5.0, 5.3), joint.proximal, 8.0, 8.2)
    whole = followed(rigid, joint, recording)
    calibration = rigid.calibrations[joint]
    streams = {site: EvenStream(100.0) for site in (joint.proximal, joint.distal)}
    turned = {site: sensor(calibration, site, 100.0) for site in streams}
    angle, pieces = started(calibration, rigid.rates_hz), []
    longest = max(len(recording.imu[site]) for site in streams) + later
    for a, b in pairwise([0, *sorted(edges), longest + 1]):
        new = []
        for site, stream in streams.items():
            shift = later if site is joint.distal else 0
            stream.feed(recording.imu[site].select(slice(max(a - shift, 0), max(b - shift, 0))))
            new.append(turned[site].update(stream.take()))
        pieces.append(angle.update(*new))
    assert_same(all_of(pieces), whole)


@pytest.mark.parametrize(("joint", "limit_deg"), [(KNEE, 2.0), (ANKLE, 3.0)])
@pytest.mark.parametrize("is_distal", [True, False])
def test_after_a_gap_the_angle_goes_on_within_a_second(
    rigid: LiveVisit, joint: Joint, limit_deg: float, is_distal: bool
) -> None:
    site = joint.distal if is_distal else joint.proximal
    live = followed(rigid, joint, without(rigid.walk, site, 5.0, 5.6))
    error, reported = error_deg(rigid, joint, live), np.isfinite(live.angle_rad)
    assert not np.any(reported & (live.time_s > 5.05) & (live.time_s < 5.55))
    after = live.time_s > 6.6
    assert reported[after].all()
    assert np.max(np.abs(error[after])) < limit_deg
    assert np.all(np.abs(error[reported]) < 3 * np.rad2deg(live.sd_rad[reported]))
    assert np.isfinite(live.sd_rad).tolist() == reported.tolist()


@pytest.mark.parametrize("missing_from_s", [2.6, 3.4, 4.0])
@pytest.mark.parametrize("which", ["rigid", "soft"])
def test_after_a_jump_that_no_rate_reported_the_angle_is_right_again_within_six_seconds(
    request: pytest.FixtureRequest, which: str, missing_from_s: float
) -> None:
    """A strap that was knocked, or rates that were cut off: a part of a stride is missing, and no stamp reports."""
    one: LiveVisit = request.getfixturevalue(which)
    missing_s = 0.3
    stamps = next(iter(one.walk.imu.values())).time_s
    from_s = float(stamps[0]) + missing_from_s

    def jumped(block: ImuBlock) -> ImuBlock:
        before, after = block.time_s < from_s, block.time_s >= from_s + missing_s
        kept = block.select(before | after)
        return replace(kept, time_s=np.where(kept.time_s < from_s, kept.time_s, kept.time_s - missing_s))

    imu = {site: jumped(block) for site, block in one.walk.imu.items()}
    live = followed(one, KNEE, replace(one.walk, imu=imu))
    as_recorded = replace(live, time_s=np.where(live.time_s < from_s, live.time_s, live.time_s + missing_s))
    late = as_recorded.time_s > from_s + missing_s + 6.0
    error = error_deg(one, KNEE, as_recorded)[late]
    assert np.count_nonzero(late) > 300
    assert np.nanmax(np.abs(error)) < 12.0  # 16 to 91 degrees on the hinge where it is not noticed


def test_after_a_gap_without_a_known_centre_it_waits_for_the_vertical(rigid: LiveVisit) -> None:
    unknown = replace(rigid.calibrations[ANKLE], centre_proximal_m=None, centre_distal_m=None)
    one = replace(rigid, calibrations={**rigid.calibrations, ANKLE: unknown})
    live = followed(one, ANKLE, without(rigid.walk, ANKLE.distal, 5.0, 5.6))
    error, reported = error_deg(one, ANKLE, live), np.isfinite(live.angle_rad)
    assert not reported[(live.time_s > 5.6) & (live.time_s < 6.6)].any()
    assert reported[live.time_s > 7.5].all()
    assert np.mean(np.abs(error[reported]) < 2 * np.rad2deg(live.sd_rad[reported])) > 0.95


def test_short_gaps_are_left_open_and_change_little(soft: LiveVisit) -> None:
    live = followed(soft, KNEE, without(soft.walk, KNEE.distal, 6.0, 6.08))
    hidden = ~np.isfinite(live.angle_rad)
    assert 5.99 < live.time_s[hidden].min() < live.time_s[hidden].max() < 6.09
    assert np.isfinite(live.angle_rad[live.time_s > 6.09]).all()
    error = np.abs(error_deg(soft, KNEE, live))
    assert np.nanmax(error[live.time_s > SCORED_FROM_S]) < 5.0
    assert np.max(error[live.time_s > 8.0]) < 2.0


def test_a_late_clock_is_put_right_between_the_two_streams() -> None:
    late = visit(WalkerSettings(seed=1, clock_late_s={Site.LEFT_SHANK: 0.03}))
    assert late.calibrations[KNEE].lag_s == pytest.approx(-0.03, abs=0.002)
    for joint, limit_deg in ((KNEE, 0.35), (ANKLE, 1.0)):
        assert rmse_deg(late, joint, followed(late, joint)) < limit_deg


def test_an_ankles_clock_may_be_brought_to_the_thighs(rigid: LiveVisit) -> None:
    both = oriented(rigid.walk, rigid.calibrations[ANKLE], rigid.rates_hz)
    moved = LiveAngle(rigid.calibrations[ANKLE], 0.01, 0.01, clock_offset_s=-0.03).update(*both)
    np.testing.assert_allclose(moved.time_s, followed(rigid, ANKLE).time_s - 0.03)


def test_sensors_of_different_rates_go_together() -> None:
    mixed = visit(WalkerSettings(seed=1, site_rates_hz={Site.LEFT_SHANK: 60.0, Site.LEFT_FOOT: 128.0}))
    for joint, limit_deg in ((KNEE, 0.35), (ANKLE, 1.0)):
        assert rmse_deg(mixed, joint, followed(mixed, joint)) < limit_deg


def recalibrated(one: LiveVisit, joint: Joint, to: JointCalibration, at_s: float) -> AngleSamples:
    both = oriented(one.walk, one.calibrations[joint], one.rates_hz)
    angle = started(one.calibrations[joint], one.rates_hz)
    first, rest = (
        [side.part(which) for side in both] for which in (slice(0, round(at_s * 100)), slice(round(at_s * 100), None))
    )
    before = angle.update(*first)
    angle.recalibrate(to)
    return all_of([before, angle.update(*rest)])


def turned_by(calibration: JointCalibration, degrees: float) -> JointCalibration:
    turn = Rotation.from_rotvec(np.deg2rad(degrees) * joint_frame(calibration.axis_distal)[0])
    return replace(calibration, axis_distal=turn.apply(calibration.axis_distal), zero_rad=calibration.zero_rad + 0.15)


@pytest.mark.parametrize("joint", [KNEE, ANKLE])
def test_another_calibration_comes_without_a_jump(rigid: LiveVisit, joint: Joint) -> None:
    new = turned_by(rigid.calibrations[joint], 5.0)
    live = recalibrated(rigid, joint, new, 6.0)
    both = oriented(rigid.walk, new, rigid.rates_hz)
    as_new, as_old = started(new, rigid.rates_hz).update(*both), followed(rigid, joint)
    step = np.diff(np.rad2deg(wrap(live.angle_rad - as_old.angle_rad)))
    assert abs(np.rad2deg(np.nanmedian(as_new.angle_rad - as_old.angle_rad))) > 4.0
    assert np.nanmax(np.abs(step)) < 0.5
    later = live.time_s > 6.0 + BLEND_S + 2.0
    assert np.rad2deg(np.max(np.abs(live.angle_rad - as_new.angle_rad)[later])) < 1.0


def test_the_same_calibration_written_the_other_way_round_changes_nothing(soft: LiveVisit) -> None:
    old = soft.calibrations[KNEE]
    new = replace(
        old,
        axis_proximal=-old.axis_proximal,
        axis_distal=-old.axis_distal,
        clinical_sign=-old.clinical_sign,
        zero_rad=_zero_about_the_opposite_axes(old),
    )
    live, as_old = recalibrated(soft, KNEE, new, 6.0), followed(soft, KNEE)
    assert np.rad2deg(np.max(np.abs(wrap(live.angle_rad - as_old.angle_rad)))) < 0.2


def _zero_about_the_opposite_axes(old: JointCalibration) -> float:
    """The twist counts from frames that depend on the axes: (x, y, j) becomes (-x, y, -j), which turns its sign."""
    return -old.zero_rad


def test_opposite_pairing_turns_the_heading_with_it(soft: LiveVisit) -> None:
    """An ankle that was paired the wrong way round is put right within the blend, not within minutes."""
    right = soft.calibrations[ANKLE]
    wrong = replace(right, axis_distal=-right.axis_distal)
    both = oriented(soft.walk, right, soft.rates_hz)
    angle = started(wrong, soft.rates_hz)
    angle.update(*(side.part(slice(0, 600)) for side in both))
    angle.recalibrate(right)
    live = angle.update(*(side.part(slice(600, None)) for side in both))
    later = live.time_s > 6.0 + BLEND_S + 0.5
    assert np.max(np.abs(error_deg(soft, ANKLE, live)[later])) < 3.0


def test_an_ankle_is_provisional_until_steps_have_shown_its_axis(soft: LiveVisit) -> None:
    for joint, source, is_provisional in (
        (ANKLE, AxisSource.FREE_MOTION, True),
        (ANKLE, AxisSource.POOLED, False),
        (KNEE, AxisSource.FREE_MOTION, False),
    ):
        calibration = replace(soft.calibrations[joint], axis_source=source)
        assert started(calibration, soft.rates_hz).is_provisional == is_provisional


def test_a_silent_sensor_is_not_waited_for_for_ever(soft: LiveVisit) -> None:
    one, two = oriented(soft.walk, soft.calibrations[KNEE], soft.rates_hz)
    angle = started(soft.calibrations[KNEE], soft.rates_hz)
    live = angle.update(one, NOTHING)
    assert len(live) == len(one) - round(100 * MAX_WAIT_S)
    assert not np.isfinite(live.angle_rad).any()
    live = angle.update(NOTHING, two)
    assert np.isfinite(live.angle_rad).mean() > 0.9


def test_half_of_a_pair_alone_is_forgotten_after_a_while() -> None:
    pairing = Pairing(0.01, 0.01, 0.0)
    for k in range(20):
        tick = np.arange(500 * k, 500 * (k + 1))
        alone = OrientedSamples(tick, 0.01 * tick, np.ones((500, 10)), np.ones(500, dtype=np.bool_))
        assert len(pairing.update(NOTHING, alone)) == 0
    assert len(pairing._two) == round(100 * MAX_WAIT_S)


def test_averaged_rates_come_out_as_instants_one_sample_late() -> None:
    time_s = 0.01 * np.arange(300)
    rate = np.stack([np.sin(5 * time_s), np.cos(3 * time_s), 0.3 * np.sin(7 * time_s)], axis=1)
    mean = rate.copy()
    mean[1:] = 0.5 * (rate[1:] + rate[:-1])
    block = ImuBlock("sensor", time_s, mean, np.tile([0.0, 0.0, 9.81], (300, 1)))
    stream, live = EvenStream(100.0), LiveOrientation(np.zeros(3), RateKind.AVERAGED, 0.01)
    found = []
    for a, b in pairwise([0, 7, 8, 100, 300]):
        stream.feed(block.select(slice(a, b)))
        found.append(live.update(stream.take()))
    turned = joined(found)
    assert len(turned) == 299
    np.testing.assert_allclose(turned.gyr_rad_s[1:], 0.5 * (mean[1:-1] + mean[2:]), atol=1e-12)
    quaternion_steps = np.sum(turned.q_earth_from_sensor[1:] * turned.q_earth_from_sensor[:-1], axis=1)
    assert quaternion_steps.min() > 0.99  # no jump between q and -q


def test_the_quick_algebra_is_that_of_the_twist(soft: LiveVisit) -> None:
    calibration = soft.calibrations[KNEE]
    both = oriented(soft.walk, calibration, soft.rates_hz)
    tracks = [Track(0.0, 0.01, s.gyr_rad_s, s.acc_m_s2, None, None, s.is_measured) for s in both]
    turned = [OrientedTrack(track, s.q_earth_from_sensor) for track, s in zip(tracks, both, strict=True)]
    pair, rows = pair_up(turned[0], turned[1], 0.0), Pairing(0.01, 0.01, 0.0).update(*both)
    assert pair is not None
    geometry, heading = JointGeometry(calibration), np.linspace(-3.0, 3.0, len(pair))
    frames, (rate_1, rate_2) = geometry.frames(rows), geometry.rates(rows)
    j1, j2 = calibration.axis_proximal, calibration.axis_distal
    np.testing.assert_allclose(wrap(frames.twist(heading) - twist(pair, j1, j2, heading)), 0.0, atol=1e-9)
    across = off_axis_rate(pair, j1, heading)
    quick = frames.off_axis_rate(rate_1, rate_2, heading)
    np.testing.assert_allclose(np.stack([quick.real, quick.imag], axis=1), across, atol=1e-9)
    axis_1, axis_2 = pair.earth_from_1 @ j1, pair.earth_from_2 @ j2
    seen = (axis_1[:, 0] + 1j * axis_1[:, 1]) * (axis_2[:, 0] - 1j * axis_2[:, 1])
    np.testing.assert_allclose(frames.heading_seen, seen, atol=1e-9)
    np.testing.assert_allclose(frames.steepness, axis_1[:, 2], atol=1e-9)

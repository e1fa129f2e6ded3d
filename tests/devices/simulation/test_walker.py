"""Tests that the truth reported by the simulated session is the truth of its samples."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import correlate1d
from scipy.signal import butter, sosfiltfilt

from core.body import LEG_JOINTS, LEG_SITES, Joint, Segment, Side, Site
from core.samples import BoolArray, FloatArray, ImuBlock
from core.session import RecordingKind
from devices.simulation.walker import (
    NO_ERRORS,
    CourseKind,
    FreeMotion,
    GaitChange,
    JointTruth,
    Motion,
    SimulatedSession,
    Standing,
    TimedCourse,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
    truth_table,
)
from devices.simulation.walker_body import make_leg

ComplexArray = NDArray[np.complex128]
CLEAN = WalkerSettings(seed=2, errors=NO_ERRORS, recordings=(Standing(), FreeMotion(duration_s=4.0), Walk(strides=4)))
DENSE_HZ = 2000.0


@pytest.fixture(scope="module")
def clean() -> SimulatedSession:
    return simulate(CLEAN)


@pytest.fixture(scope="module")
def dense() -> SimulatedSession:
    """Short recordings on the fine clock, for tests that differentiate or integrate."""
    return simulate(replace(CLEAN, rate_hz=DENSE_HZ, recordings=(FreeMotion(duration_s=4.0), Walk(strides=2))))


def pair(simulated: SimulatedSession, name: str, joint: Joint) -> tuple[ImuBlock, ImuBlock, JointTruth]:
    recording = next(r for r in simulated.session.recordings if r.name == name)
    return recording.imu[joint.proximal], recording.imu[joint.distal], simulated.truth.recordings[name].joints[joint]


def across(axis: FloatArray, v: FloatArray) -> FloatArray:
    """Size of what of v (n, 3) is normal to a unit axis, (n,)."""
    return np.asarray(np.linalg.norm(np.cross(v, axis), axis=1))


def off_axis(proximal: ImuBlock, distal: ImuBlock, truth: JointTruth) -> tuple[ComplexArray, BoolArray]:
    """The relative rate normal to the functional axis, rad/s, its two components as one complex number; and motion."""

    def in_plane(block: ImuBlock, axis: FloatArray) -> FloatArray:
        x = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        x /= np.linalg.norm(x)
        return np.asarray(block.gyr_rad_s @ (x + 1j * np.cross(axis, x)))

    z1, z2 = in_plane(proximal, truth.functional_proximal), in_plane(distal, truth.functional_distal)
    z2 = z2 * np.exp(1j * truth.angle_rad)
    z2 = z2 * np.exp(1j * np.angle(np.sum(z1 * np.conj(z2))))  # the two frames' unknown constant angle
    speed = np.hypot(np.linalg.norm(proximal.gyr_rad_s, axis=1), np.linalg.norm(distal.gyr_rad_s, axis=1))
    moving = np.convolve(speed, np.ones(50) / 50, "same") > 0.3
    return z2 - z1, np.asarray(moving)


def off_axis_rate(proximal: ImuBlock, distal: ImuBlock, truth: JointTruth) -> float:
    """MAD per axis of the relative rate normal to the functional axis, while moving, rad/s."""
    difference, moving = off_axis(proximal, distal, truth)
    difference = difference[moving]
    return float(1.4826 * np.median(np.abs(np.concatenate([difference.real, difference.imag]))))


def fast_off_axis_rate(proximal: ImuBlock, distal: ImuBlock, truth: JointTruth) -> float:
    """Root mean square of the relative rate normal to the functional axis above 3 Hz, while moving, rad/s."""
    difference, moving = off_axis(proximal, distal, truth)
    high = butter(2, 3.0, "high", fs=100.0, output="sos")
    fast = [sosfiltfilt(high, part)[moving] for part in (difference.real, difference.imag)]
    return float(np.sqrt(np.mean(np.square(fast[0]) + np.square(fast[1]))))


@pytest.mark.endurance
def test_the_same_settings_give_the_same_samples() -> None:
    settings = WalkerSettings(seed=7, tissue=Tissue.REAL, loss_fraction=0.05, stamp_jitter_s=0.001)
    for a, b in zip(simulate(settings).session.recordings, simulate(settings).session.recordings, strict=True):
        for site in LEG_SITES:
            np.testing.assert_array_equal(a.imu[site].time_s, b.imu[site].time_s)
            np.testing.assert_array_equal(a.imu[site].gyr_rad_s, b.imu[site].gyr_rad_s)
            np.testing.assert_array_equal(a.imu[site].acc_m_s2, b.imu[site].acc_m_s2)


def test_another_seed_gives_another_patient(clean: SimulatedSession) -> None:
    other = simulate(replace(CLEAN, seed=1))
    axes = [made.truth.recordings["walk 1"].joints[Joint.LEFT_KNEE] for made in (other, clean)]
    assert np.abs(axes[0].axis_proximal - axes[1].axis_proximal).max() > 0.05
    assert axes[0].standing_rad != axes[1].standing_rad


def test_faults_and_losses_leave_body_and_mounting_alone(clean: SimulatedSession) -> None:
    late, errors = {Site.LEFT_FOOT: 0.02}, WalkerSettings().errors
    other = simulate(replace(CLEAN, errors=errors, loss_fraction=0.2, tissue=Tissue.SOFT, clock_late_s=late))
    for joint in LEG_JOINTS:
        a, b = (s.truth.recordings["walk 1"].joints[joint] for s in (clean, other))
        np.testing.assert_array_equal(a.axis_distal, b.axis_distal)
        np.testing.assert_array_equal(a.centre_proximal_m, b.centre_proximal_m)


@pytest.mark.parametrize("name", ["free motion", "walk 1"])
@pytest.mark.parametrize("joint", [Joint.LEFT_KNEE, Joint.RIGHT_KNEE])
def test_a_rigid_knee_turns_about_its_axis_only_and_by_the_true_angle(
    dense: SimulatedSession, name: str, joint: Joint
) -> None:
    proximal, distal, truth = pair(dense, name, joint)
    j1, j2 = truth.axis_proximal, truth.axis_distal
    np.testing.assert_allclose(across(j1, proximal.gyr_rad_s), across(j2, distal.gyr_rad_s), atol=1e-6)
    rate = distal.gyr_rad_s @ j2 - proximal.gyr_rad_s @ j1
    turned = np.cumsum(0.5 * (rate[1:] + rate[:-1])) / DENSE_HZ
    np.testing.assert_allclose(turned, truth.angle_rad[1:] - truth.angle_rad[0], atol=1e-4)
    assert np.ptp(truth.angle_rad) > 0.8


@pytest.mark.parametrize("name", ["free motion", "walk 1"])
@pytest.mark.parametrize("joint", list(LEG_JOINTS))
def test_both_sensors_see_the_same_joint_centre(dense: SimulatedSession, name: str, joint: Joint) -> None:
    proximal, distal, truth = pair(dense, name, joint)

    def at_joint(block: ImuBlock, centre_m: FloatArray) -> FloatArray:
        """Size of the specific force where the joint is, at -o of the sensor."""
        g = block.gyr_rad_s
        turning = correlate1d(g, np.array([1.0, -8.0, 0.0, 8.0, -1.0]) * DENSE_HZ / 12.0, axis=0)
        lever = np.broadcast_to(-centre_m, g.shape)
        force = block.acc_m_s2 + np.cross(g, np.cross(g, lever)) + np.cross(turning, lever)
        return np.asarray(np.linalg.norm(force, axis=1))[5:-5]

    one, other = at_joint(proximal, truth.centre_proximal_m), at_joint(distal, truth.centre_distal_m)
    assert np.sqrt(np.mean((one - other) ** 2)) < 0.005  # half a sensor's noise
    wrong = at_joint(distal, truth.centre_distal_m + 0.02 * np.cross(truth.axis_distal, [0.6, 0.0, 0.8]))
    assert np.sqrt(np.mean((one - wrong) ** 2)) > 0.05


@pytest.mark.parametrize("side", list(Side))
def test_the_clinical_sign_holds_on_both_legs(clean: SimulatedSession, side: Side) -> None:
    """The shank turns forward when the knee extends in late swing: independent of any angle curve."""
    knee, ankle = Joint(f"{side}_knee"), Joint(f"{side}_ankle")
    _, distal, truth = pair(clean, "walk 1", knee)
    rate = np.sort(distal.gyr_rad_s @ truth.axis_distal)
    assert -rate[5] > 1.2 * rate[-5]
    of_ankle = clean.truth.recordings["walk 1"].joints[ankle].axis_proximal
    assert of_ankle @ truth.axis_distal < -0.9
    assert np.rad2deg(truth.angle_rad).max() > 50.0


def test_the_ankle_is_no_hinge_and_a_prosthetic_one_is_and_a_socket_keeps_the_thigh_soft() -> None:
    simulated = simulate(replace(CLEAN, tissue=Tissue.SOFT, prosthetic_side=Side.LEFT))
    for name in ("free motion", "walk 1"):
        sound = off_axis_rate(*pair(simulated, name, Joint.RIGHT_ANKLE))
        prosthetic = off_axis_rate(*pair(simulated, name, Joint.LEFT_ANKLE))
        assert sound > 0.1
        assert prosthetic < 1e-6
    assert off_axis_rate(*pair(simulated, "walk 1", Joint.LEFT_KNEE)) > 0.05
    assert simulated.session.patient.prosthetic_side == "left"


@pytest.mark.endurance
@pytest.mark.parametrize(("tissue", "low", "high"), [(Tissue.SOFT, 0.12, 0.42), (Tissue.REAL, 0.45, 1.1)])
def test_soft_tissue_turns_sensors_off_the_axis_as_much_as_it_should(tissue: Tissue, low: float, high: float) -> None:
    found = [
        off_axis_rate(*pair(walk, "walk 1", joint))
        for walk in (simulate(replace(CLEAN, seed=s, tissue=tissue, recordings=(Walk(strides=5),))) for s in range(4))
        for joint in LEG_JOINTS
    ]
    assert low < np.quantile(found, 0.1)
    assert np.quantile(found, 0.9) < high


@pytest.mark.endurance
def test_real_tissue_moves_above_3_hz_as_that_of_people_does() -> None:
    """0.5-0.7 rad/s on people; of six people after stroke 0.4-2.4; today's soft tissue 0.2-0.5."""
    walks = [simulate(replace(CLEAN, seed=s, tissue=Tissue.REAL, recordings=(Walk(),))) for s in range(3)]
    knees, ankles = (
        [
            fast_off_axis_rate(*pair(walk, "walk 1", joint))
            for walk in walks
            for joint in LEG_JOINTS
            if joint.is_knee is is_knee
        ]
        for is_knee in (True, False)
    )
    assert 0.55 < np.median(knees) < 0.85
    assert 0.45 < np.median(ankles) < 0.75
    assert min(knees + ankles) > 0.35
    assert max(knees + ankles) < 1.2


@pytest.mark.endurance
def test_the_functional_axis_leans_with_the_knees_own_rotation(clean: SimulatedSession) -> None:
    rigid = clean.truth.recordings["walk 1"].joints[Joint.LEFT_KNEE]
    soft = simulate(replace(CLEAN, tissue=Tissue.SOFT)).truth.recordings["walk 1"].joints[Joint.LEFT_KNEE]
    np.testing.assert_allclose(rigid.functional_distal, rigid.axis_distal, atol=1e-6)
    for own, axis in ((soft.functional_proximal, soft.axis_proximal), (soft.functional_distal, soft.axis_distal)):
        # 6 deg per 60 deg about the long axis: atan(0.1)
        assert 4.0 < np.rad2deg(np.arccos(own @ axis)) < 7.0


def test_lag_is_what_brings_the_distal_clock_to_the_proximal_one() -> None:
    late = {Site.LEFT_SHANK: 0.03}
    joints = simulate(replace(CLEAN, clock_late_s=late)).truth.recordings["walk 1"].joints
    assert joints[Joint.LEFT_KNEE].lag_s == -0.03
    assert joints[Joint.LEFT_ANKLE].lag_s == 0.03
    assert joints[Joint.RIGHT_KNEE].lag_s == 0.0


def test_angles_are_reported_at_the_proximal_sensors_stamps(clean: SimulatedSession) -> None:
    plain = clean.truth.recordings["walk 1"].joints[Joint.LEFT_ANKLE]
    late = simulate(replace(CLEAN, clock_late_s={Site.LEFT_SHANK: 0.03})).truth.recordings["walk 1"]
    np.testing.assert_allclose(late.joints[Joint.LEFT_ANKLE].angle_rad[3:], plain.angle_rad[:-3], atol=1e-12)
    lossy = simulate(replace(CLEAN, loss_fraction=0.2))
    block, _, truth = pair(lossy, "walk 1", Joint.LEFT_ANKLE)
    np.testing.assert_array_equal(truth.time_s, block.time_s)
    np.testing.assert_allclose(truth.angle_rad, np.interp(truth.time_s, plain.time_s, plain.angle_rad), atol=1e-9)


def test_standing_is_quiet_and_its_angle_is_reported(clean: SimulatedSession) -> None:
    proximal, _, truth = pair(clean, "standing", Joint.LEFT_KNEE)
    assert abs(truth.angle_rad.mean() - truth.standing_rad) < 1e-3
    assert np.deg2rad(0.3) < truth.standing_rad < np.deg2rad(10.0)
    size = np.linalg.norm(proximal.gyr_rad_s, axis=1)
    assert 1e-4 < size.max() < 0.05
    walk_only = simulate(replace(CLEAN, recordings=(Walk(),))).truth.recordings["walk 1"]
    assert np.isnan(walk_only.joints[Joint.LEFT_KNEE].standing_rad)


def free(motion: Motion, seed: int = 2, **settings: object) -> SimulatedSession:
    recordings = (FreeMotion("free", motion=motion),)
    return simulate(replace(CLEAN, seed=seed, recordings=recordings, **settings))  # type: ignore[arg-type]  # fields of mixed types pass through by name


def spread(block: ImuBlock) -> FloatArray:
    """Root mean square rates along the principal directions (3,), ascending."""
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(block.gyr_rad_s.T @ block.gyr_rad_s / len(block)), 0.0)))


def test_full_circling_turns_every_segment_about_several_axes() -> None:
    for seed in range(4):
        imu = free(Motion.FULL, seed).session.recordings[0].imu
        for site in LEG_SITES:
            assert spread(imu[site])[1] > 0.3, site
            assert 1.0 < np.linalg.norm(imu[site].gyr_rad_s, axis=1).max() < 8.0


def test_weak_circling_is_slower() -> None:
    full, weak = (free(m).session.recordings[0].imu for m in (Motion.FULL, Motion.WEAK))
    for site in LEG_SITES:
        assert spread(weak[site])[-1] < 0.5 * spread(full[site])[-1]


def test_sagittal_motion_turns_about_one_axis() -> None:
    imu = free(Motion.SAGITTAL).session.recordings[0].imu
    for site in LEG_SITES:
        assert spread(imu[site])[1] < 0.15 * spread(imu[site])[2]


def test_knee_only_leaves_the_thigh_still() -> None:
    simulated = free(Motion.KNEE_ONLY)
    imu = simulated.session.recordings[0].imu
    assert spread(imu[Site.LEFT_THIGH])[-1] < 0.1 < 1.0 < spread(imu[Site.LEFT_SHANK])[-1]
    assert np.ptp(simulated.truth.recordings["free"].joints[Joint.LEFT_ANKLE].angle_rad) < 1e-9


@pytest.mark.parametrize("joint", [Joint.LEFT_KNEE, Joint.RIGHT_KNEE])
def test_lying_on_the_side_the_knee_axis_is_ten_degrees_from_vertical(joint: Joint) -> None:
    proximal, _, truth = pair(free(Motion.SIDE_LYING), "free", joint)
    up = proximal.acc_m_s2 / np.linalg.norm(proximal.acc_m_s2, axis=1, keepdims=True)
    from_vertical = np.rad2deg(np.arccos(np.abs(up @ truth.axis_proximal)))
    assert abs(from_vertical[:5].mean() - 10.0) < 0.5
    assert abs(np.median(from_vertical) - 10.0) < 4.0
    assert np.ptp(truth.angle_rad) > 0.8


def test_legs_in_turn_move_one_after_the_other() -> None:
    settings = replace(CLEAN, recordings=(FreeMotion("free", duration_s=6.0, is_in_turn=True),))
    imu = simulate(settings).session.recordings[0].imu
    left, right = imu[Site.LEFT_SHANK], imu[Site.RIGHT_SHANK]
    first = left.time_s < 6.0
    assert np.abs(right.gyr_rad_s[first]).max() < 1e-6 < 1.0 < np.abs(right.gyr_rad_s[~first]).max()
    assert np.abs(left.gyr_rad_s[~first]).max() < 0.01 < 1.0 < np.abs(left.gyr_rad_s[first]).max()


def test_restrapping_mounts_every_sensor_again_and_only_from_then_on() -> None:
    again = Walk("walk 2", strides=3, is_restrapped_before=True)
    recordings = (Standing(), Walk("walk 1", strides=3), again, Walk("walk 3", strides=3))
    simulated = simulate(replace(CLEAN, recordings=recordings))
    axes = {n: r.joints[Joint.LEFT_KNEE].axis_proximal for n, r in simulated.truth.recordings.items()}
    np.testing.assert_array_equal(axes["standing"], axes["walk 1"])
    np.testing.assert_array_equal(axes["walk 2"], axes["walk 3"])
    assert np.abs(axes["walk 1"] - axes["walk 2"]).max() > 0.05
    assert [r.is_restrapped_before for r in simulated.session.recordings] == [False, False, True, False]


def test_a_sensor_rides_on_tissue_alike_in_every_walk_and_otherwise_in_free_motion() -> None:
    """If it rode otherwise in the next walk, its strap would seem to have slipped."""
    recordings = (FreeMotion("free", duration_s=4.0), Walk("walk 1", strides=3), Walk("walk 2", strides=3))
    settings = replace(CLEAN, sites=(Site.LEFT_THIGH, Site.LEFT_SHANK), recordings=recordings)
    soft, rigid = (simulate(replace(settings, tissue=tissue)) for tissue in (Tissue.SOFT, Tissue.RIGID))
    turned = {}  # of the thigh's sensor against its bone, with the knee's flexion
    for name in ("free", "walk 1", "walk 2"):
        (with_tissue, _, knee), (without, _, _) = (pair(made, name, Joint.LEFT_KNEE) for made in (soft, rigid))
        bending = np.gradient(knee.angle_rad, knee.time_s)
        along = bending @ (with_tissue.gyr_rad_s - without.gyr_rad_s)
        turned[name] = along / np.linalg.norm(along)
    assert turned["walk 1"] @ turned["walk 2"] > np.cos(np.deg2rad(5.0))
    assert turned["walk 1"] @ turned["free"] < np.cos(np.deg2rad(20.0))


def test_one_person_comes_twice_with_other_straps() -> None:
    visits = [simulate(replace(CLEAN, seed=seed, body_seed=4)).truth.recordings["walk 1"] for seed in (7, 8)]
    alone = simulate(replace(CLEAN, seed=7)).truth.recordings["walk 1"]
    shank_m = [make_leg(replace(CLEAN, seed=seed, body_seed=4), Side.LEFT).shank_m for seed in (7, 8)]
    assert shank_m[0] == shank_m[1] != make_leg(replace(CLEAN, seed=7), Side.LEFT).shank_m
    axes = [visit.joints[Joint.LEFT_KNEE].axis_distal for visit in visits]
    assert np.abs(axes[0] - axes[1]).max() > 0.05
    standing = [visit.joints[Joint.LEFT_KNEE].standing_rad for visit in (*visits, alone)]
    assert standing[0] == pytest.approx(standing[1], abs=1e-3)
    assert abs(standing[0] - standing[2]) > np.deg2rad(0.3)


def test_one_sensor_may_lose_samples_that_the_others_keep() -> None:
    imu = simulate(replace(CLEAN, site_loss_fractions={Site.LEFT_FOOT: 0.1})).session.recordings[-1].imu
    assert len(imu[Site.LEFT_FOOT]) < 0.97 * len(imu[Site.RIGHT_FOOT])
    assert len(imu[Site.LEFT_SHANK]) == len(imu[Site.RIGHT_FOOT])


def test_a_course_within_a_session_is_worn_as_its_walks_and_changed_as_they_are() -> None:
    less, left = GaitChange(knee_deg=-20.0), Side.LEFT
    kind = CourseKind.TEN_METRES
    course = TimedCourse(kind, seed=3, speed_m_s=1.19, name="walk 2", change=less, changed_side=left)
    recordings = (Standing(), Walk("walk 1", strides=4, change=less, changed_side=left), course)
    simulated = simulate(replace(CLEAN, tissue=Tissue.RIGID, recordings=recordings))
    reported = simulated.truth.recordings
    assert [r.kind for r in simulated.session.recordings] == [RecordingKind.STANDING, *2 * [RecordingKind.WALKING]]
    for joint in (Joint.LEFT_KNEE, Joint.RIGHT_KNEE):
        walk, timed = (reported[name].joints[joint] for name in ("walk 1", "walk 2"))
        np.testing.assert_array_equal(walk.axis_proximal, timed.axis_proximal)
        assert np.rad2deg(walk.angle_rad.max()) == pytest.approx(np.rad2deg(timed.angle_rad.max()), abs=6.0)
    peaks = [np.rad2deg(reported["walk 2"].joints[Joint(f"{side}_knee")].angle_rad.max()) for side in Side]
    assert peaks[1] - peaks[0] == pytest.approx(20.0, abs=6.0)


def test_a_session_states_that_it_is_simulated_and_holds_what_was_asked() -> None:
    sites = (Site.LEFT_SHANK, Site.LEFT_FOOT, Site.RIGHT_FOOT)
    simulated = simulate(replace(CLEAN, sites=sites))
    session = simulated.session
    assert session.is_simulated
    assert session.patient.code == "DEMO-1"
    assert [r.kind for r in session.recordings] == list(RecordingKind)
    assert all(set(r.imu) == set(sites) for r in session.recordings)
    assert set(simulated.truth.recordings["walk 1"].joints) == {Joint.LEFT_ANKLE}
    assert {s.segment for s in session.sensors} == {Segment.SHANK, Segment.FOOT}


def test_what_cannot_be_simulated_is_refused() -> None:
    with pytest.raises(ValueError, match="names of their own"):
        simulate(replace(CLEAN, recordings=(Walk(), Walk())))
    with pytest.raises(ValueError, match="at most"):
        simulate(replace(CLEAN, clock_late_s={Site.LEFT_FOOT: 1.0}))


def test_the_truth_table_holds_every_angle_and_every_event() -> None:
    simulated = simulate(replace(CLEAN, recordings=(Standing(), Walk(strides=3))))
    header, rows = truth_table(simulated.truth)
    assert header[:2] == ["recording", "time_s"]
    assert {len(row) for row in rows} == {len(header)}
    walk = simulated.truth.recordings["walk 1"]
    events = [row for row in rows if row[-1]]
    assert len(events) == 2 * 3 * 4
    assert {row[0] for row in events} == {"walk 1"}
    column = header.index("right_ankle_deg")
    reported = np.array([float(row[column]) for row in rows if row[0] == "walk 1" and row[column]])
    np.testing.assert_allclose(reported, np.rad2deg(walk.joints[Joint.RIGHT_ANKLE].angle_rad), atol=1e-5)

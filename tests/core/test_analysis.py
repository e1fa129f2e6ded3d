"""From a session to angles: right on data whose truth is known, and changed only by what must change them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from core.analysis import analyse
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site
from core.results import Analysis, JointCalibration, Method, ZeroKind
from core.samples import FloatArray
from core.session import Patient, RecordingKind, Session
from core.signal.rotations import angle_between, joint_frame
from devices.simulation.walker import Standing, Tissue, Walk, WalkerSettings
from tests.core.cut_blocks import changed
from tests.core.hinges import PERSON, Person
from tests.simulated import session_of

S, F, W = RecordingKind.STANDING, RecordingKind.FREE_MOTION, RecordingKind.WALKING
LEG = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)
KNEE, ANKLE = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
seeds = st.integers(0, 10**6)


@pytest.fixture(scope="module")
def of_knee(knee_visit: Session) -> dict[Method, Analysis]:
    return {method: analyse(knee_visit, method) for method in Method}


@pytest.fixture(scope="module")
def of_leg(leg_visit: Session) -> Analysis:
    return analyse(leg_visit)


def angle(found: Analysis, name: str, joint: Joint = KNEE) -> FloatArray:
    (recording,) = (r for r in found.recordings if r.name == name)
    return recording.joints[joint].angle_rad


def of(found: Analysis, joint: Joint = KNEE) -> JointCalibration:
    return found.calibrations[-1].joints[joint]


def reported(found: Analysis) -> set[tuple[str, str]]:
    return {(f.key, f.where) for f in found.findings}


@pytest.mark.parametrize("method", list(Method))
@pytest.mark.parametrize(
    "seed", [0, pytest.param(1, marks=pytest.mark.endurance), pytest.param(2, marks=pytest.mark.endurance)]
)
def test_a_person_of_hinges_is_measured_right(seed: int, method: Method) -> None:
    sites = tuple(site for site in LEG_SITES if site.side is (Side.RIGHT if seed % 2 else Side.LEFT))
    person = Person(seed=seed)
    found = analyse(person.visit(sites), method)
    for joint in LEG_JOINTS:
        if joint.proximal not in sites:
            continue
        calibration = of(found, joint)
        for site, axis, centre in (
            (joint.proximal, calibration.axis_proximal, calibration.centre_proximal_m),
            (joint.distal, calibration.axis_distal, calibration.centre_distal_m),
        ):
            assert angle_between(calibration.clinical_sign * axis, person.axis(site, joint)) < np.deg2rad(0.6)
            assert centre is not None
            plane = np.stack(joint_frame(person.axis(site, joint)))
            assert np.linalg.norm(plane @ (centre - person.centre_m(site, joint))) < (
                0.0035 if method is Method.ROBUST else 0.006
            )
        assert (calibration.is_sign_certain, calibration.zero, calibration.lag_s) == (True, ZeroKind.STANDING, 0.0)
        for name in ("free motion", "walk"):
            error = person.error_deg(found, name, joint)
            assert np.sqrt(np.mean(error**2)) < 0.8
            assert np.isfinite(error).all()
            sd_deg = np.rad2deg(found.recordings[0].joints[joint].sd_rad)
            assert np.mean(np.abs(error) < 2 * sd_deg[0]) > 0.9


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.endurance) for seed in range(2, 6))])
@pytest.mark.parametrize("kinds", [(W,), (S, W), (F, W), (S, F, W)])
def test_flexion_is_positive_on_every_leg_whatever_was_recorded(seed: int, kinds: tuple[RecordingKind, ...]) -> None:
    person = Person(seed=100 + seed)
    sites = tuple(site for site in LEG_SITES if site.side is (Side.LEFT if seed % 2 else Side.RIGHT))
    found = analyse(person.visit(sites, kinds=kinds, duration_s=6.0))
    for joint, calibration in found.calibrations[-1].joints.items():
        assert calibration.clinical_sign * calibration.axis_distal @ person.axis(joint.distal, joint) > 0.99
        assert calibration.is_sign_certain


@pytest.mark.parametrize("method", list(Method))
@pytest.mark.parametrize("value_deg", [-8.0, 12.0])
def test_standing_reads_the_goniometer_s_value(
    knee_visit: Session, of_knee: dict[Method, Analysis], value_deg: float, method: Method
) -> None:
    plain = of_knee[method]
    typed = analyse(replace(knee_visit, zero_rad={KNEE: float(np.deg2rad(value_deg))}), method)
    assert (of(plain).zero, of(typed).zero) == (ZeroKind.STANDING, ZeroKind.GONIOMETER)
    difference = np.rad2deg(angle(typed, "walk") - angle(plain, "walk"))
    np.testing.assert_allclose(difference, value_deg, atol=1e-9)
    assert ("zero_from_goniometer", "left_knee") in reported(typed)


@pytest.mark.parametrize("method", list(Method))
def test_a_turned_sign_mirrors_the_angle_about_standing(
    knee_visit: Session, of_knee: dict[Method, Analysis], method: Method
) -> None:
    plain = of_knee[method]
    turned = analyse(replace(knee_visit, turned_sign={KNEE: -1}), method)
    np.testing.assert_allclose(angle(turned, "walk"), -angle(plain, "walk"), atol=1e-12)
    assert of(turned).clinical_sign == -of(plain).clinical_sign
    assert ("sign_turned", "left_knee") in reported(turned)


def test_a_turned_sign_keeps_the_goniometer_s_value_in_standing(knee_visit: Session) -> None:
    typed = replace(knee_visit, zero_rad={KNEE: 0.2})
    plain, turned = analyse(typed), analyse(replace(typed, turned_sign={KNEE: -1}))
    np.testing.assert_allclose(angle(turned, "walk") - 0.2, -(angle(plain, "walk") - 0.2), atol=1e-12)


def test_a_confirmed_sign_changes_nothing_but_its_certainty() -> None:
    visit = PERSON.visit(kinds=(F,))
    plain, confirmed = analyse(visit), analyse(replace(visit, turned_sign={KNEE: 1}))
    np.testing.assert_array_equal(angle(plain, "free motion"), angle(confirmed, "free motion"))
    assert (of(plain).is_sign_certain, of(confirmed).is_sign_certain) == (False, True)
    assert ("clinical_sign_uncertain", "left_knee") in reported(plain) - reported(confirmed)
    assert ("sign_confirmed", "left_knee") in reported(confirmed)


@pytest.mark.parametrize(
    ("affected", "prosthetic", "side"),
    [
        ("left", "none", Side.LEFT),
        ("", "right", Side.RIGHT),
        ("none", "right", Side.RIGHT),
        ("left", "left", Side.LEFT),
        ("both", "left", None),  # there is no sound side
        ("right", "both", None),
        ("none", "", None),
    ],
)
def test_symmetry_needs_one_affected_side_and_a_sound_one(affected: str, prosthetic: str, side: Side | None) -> None:
    patient = Patient(affected_side=affected, prosthetic_side=prosthetic)
    assert analyse(Session(recordings=(), patient=patient)).affected_side is side


def test_turning_the_knee_does_not_turn_the_ankle_s_word(leg_visit: Session, of_leg: Analysis) -> None:
    """The user speaks of the joint that was named: the ankle, whose sign follows the knee's, is turned on its own."""
    turned = analyse(replace(leg_visit, turned_sign={ANKLE: -1}))
    np.testing.assert_allclose(angle(turned, "walk"), angle(of_leg, "walk"), atol=1e-12)
    np.testing.assert_allclose(angle(turned, "walk", ANKLE), -angle(of_leg, "walk", ANKLE), atol=1e-12)


def test_without_standing_range_and_shape_hold() -> None:
    found = analyse(PERSON.visit(kinds=(F, W)))
    assert of(found).zero is ZeroKind.NONE
    assert np.std(PERSON.error_deg(found, "walk")) < 0.6
    assert ("no_standing", "session") in reported(found)


@settings(max_examples=6)
@given(seed=seeds)
@pytest.mark.endurance
def test_turning_the_sensors_turns_what_lies_in_them_and_nothing_else(seed: int) -> None:
    turn = Rotation.random(rng=np.random.default_rng(seed))
    plain = analyse(Person(seed=7).visit(duration_s=6.0))
    turned = analyse(Person(seed=7, extra_turn=turn).visit(duration_s=6.0))
    for name in ("free motion", "walk"):
        assert np.rad2deg(np.abs(angle(plain, name) - angle(turned, name)).max()) < 0.1
    one, other = of(plain), of(turned)
    sign = one.clinical_sign * other.clinical_sign
    for plain_axis, turned_axis in ((one.axis_proximal, other.axis_proximal), (one.axis_distal, other.axis_distal)):
        assert angle_between(turn.inv().apply(plain_axis), sign * turned_axis) < np.deg2rad(0.05)
    assert one.centre_distal_m is not None
    assert other.centre_distal_m is not None
    np.testing.assert_allclose(turn.inv().apply(one.centre_distal_m), other.centre_distal_m, atol=0.001)
    assert one.sign_margin is not None
    assert other.sign_margin is not None
    # margins of many thousands differ by what rounding does to a cost near zero
    assert np.log(one.sign_margin) == pytest.approx(np.log(other.sign_margin), abs=0.5)
    assert reported(plain) == reported(turned)


@settings(max_examples=4)
@given(shift_s=st.floats(-1e6, 1e6))
@pytest.mark.endurance
def test_shifting_all_clocks_shifts_the_stamps_and_nothing_else(shift_s: float) -> None:
    plain, shifted = (analyse(PERSON.visit(duration_s=6.0, start_s=start_s)) for start_s in (0.0, shift_s))
    for one, other in zip(plain.recordings, shifted.recordings, strict=True):
        np.testing.assert_allclose(other.time_s, one.time_s + shift_s, atol=1e-6)
        assert np.rad2deg(np.abs(one.joints[KNEE].angle_rad - other.joints[KNEE].angle_rad).max()) < 0.01
    assert reported(plain) == reported(shifted)


def swapped(session: Session) -> Session:
    """The same samples, stated to be of the other leg."""
    other = {site: Site(f"{'right' if site.side is Side.LEFT else 'left'}_{site.segment}") for site in LEG_SITES}
    recordings = [replace(r, imu={other[s]: b for s, b in r.imu.items()}) for r in session.recordings]
    return replace(session, recordings=tuple(recordings))


@pytest.mark.endurance
def test_swapping_left_and_right_swaps_the_names_and_nothing_else() -> None:
    visit = PERSON.visit(LEG_SITES, duration_s=6.0)
    plain, mirrored = analyse(visit), analyse(swapped(visit))
    for one, other in zip(plain.recordings, mirrored.recordings, strict=True):
        for joint, found in one.joints.items():
            counterpart = Joint(f"{'right' if joint.side is Side.LEFT else 'left'}_{joint.value.split('_')[1]}")
            difference = found.angle_rad - other.joints[counterpart].angle_rad
            assert np.rad2deg(np.abs(difference).max()) < 1e-6


def test_the_order_in_which_sites_are_named_changes_nothing(leg_visit: Session, of_leg: Analysis) -> None:
    turned_round = [replace(r, imu=dict(list(r.imu.items())[::-1])) for r in leg_visit.recordings]
    other = analyse(replace(leg_visit, recordings=tuple(turned_round)))
    for joint in (KNEE, ANKLE):
        np.testing.assert_array_equal(angle(of_leg, "walk", joint), angle(other, "walk", joint))


def test_half_the_rate_gives_the_same_angle(knee_visit: Session, of_knee: dict[Method, Analysis]) -> None:
    plain, slow = of_knee[Method.ROBUST], analyse(changed(knee_visit, lambda b: b.select(slice(None, None, 2))))
    for name in ("free motion", "walk"):
        whole, half = angle(plain, name), angle(slow, name)
        assert len(half) == len(whole) // 2
        assert np.rad2deg(np.sqrt(np.mean((whole[::2] - half) ** 2))) < 0.4
    assert of(plain).zero == of(slow).zero
    assert np.sign(of(plain).axis_distal @ of(slow).axis_distal) == of(plain).clinical_sign * of(slow).clinical_sign


@pytest.mark.parametrize(
    "rate_hz", [60.0, pytest.param(50.0, marks=pytest.mark.endurance), pytest.param(200.0, marks=pytest.mark.endurance)]
)
def test_every_rate_finds_the_same_truth(rate_hz: float) -> None:
    found = analyse(PERSON.visit(rate_hz=rate_hz))
    for name in ("free motion", "walk"):
        assert np.sqrt(np.mean(PERSON.error_deg(found, name) ** 2)) < 0.8


def test_sensors_of_different_rates_meet_on_the_thigh_s_clock() -> None:
    thigh, shank = PERSON.visit(rate_hz=100.0), PERSON.visit(rate_hz=60.0)
    mixed = [
        replace(one, imu={Site.LEFT_THIGH: one.imu[Site.LEFT_THIGH], Site.LEFT_SHANK: two.imu[Site.LEFT_SHANK]})
        for one, two in zip(thigh.recordings, shank.recordings, strict=True)
    ]
    found = analyse(Session(tuple(mixed)))
    (walk,) = (r for r in found.recordings if r.name == "walk")
    np.testing.assert_array_equal(walk.time_s, thigh.recordings[2].imu[Site.LEFT_THIGH].time_s)
    assert np.sqrt(np.nanmean(PERSON.error_deg(found, "walk") ** 2)) < 0.8


@pytest.mark.parametrize("lag_s", [0.03, -0.02])
def test_a_late_shank_is_negative_at_the_knee_and_positive_at_the_ankle(leg_visit: Session, lag_s: float) -> None:
    found = analyse(changed(leg_visit, lambda b: replace(b, time_s=b.time_s + lag_s), (Site.LEFT_SHANK,)))
    assert of(found, KNEE).lag_s == pytest.approx(-lag_s, abs=0.0015)
    assert of(found, ANKLE).lag_s == pytest.approx(lag_s, abs=0.0015)
    for joint in (KNEE, ANKLE):
        assert np.sqrt(np.nanmean(PERSON.error_deg(found, "walk", joint) ** 2)) < 0.8
    assert {("lag_corrected", "left_knee"), ("lag_corrected", "left_ankle")} <= reported(found)


def test_the_device_s_own_orientations_give_eq_10_with_the_same_sign_and_zero(
    knee_visit: Session, of_knee: dict[Method, Analysis]
) -> None:
    recordings = []
    for r in knee_visit.recordings:
        imu = {}
        for site, b in r.imu.items():
            turned = PERSON.pose(r.kind, site, b.time_s - b.time_s[0])[0]
            imu[site] = replace(b, q_earth_from_sensor=turned.as_quat(scalar_first=True))
        recordings.append(replace(r, imu=imu))
    found = analyse(replace(knee_visit, recordings=tuple(recordings)))
    for measured in found.recordings:
        by_device = measured.joints[KNEE].orientation_rad
        assert by_device is not None
        truth = PERSON.truth(measured.kind, KNEE, measured.time_s - measured.time_s[0])
        assert np.rad2deg(np.abs(by_device - truth).max()) < 0.5
    assert of_knee[Method.ROBUST].recordings[0].joints[KNEE].orientation_rad is None


def test_the_same_session_gives_the_same_numbers(leg_visit: Session, of_leg: Analysis) -> None:
    again = analyse(leg_visit)
    for joint in (KNEE, ANKLE):
        np.testing.assert_array_equal(angle(again, "walk", joint), angle(of_leg, "walk", joint))
    assert again.findings == of_leg.findings


def test_several_walks_that_calibrate_themselves_are_analysed() -> None:
    """Each half of what all hold has none of some walks, and so nothing to filter of them."""
    walks = (Walk("walk 1", strides=5), Walk("walk 2", strides=5))
    session = session_of(WalkerSettings(seed=1, sites=LEG, tissue=Tissue.SOFT, recordings=(Standing(), *walks)))
    assert [recording.name for recording in analyse(session).recordings][-2:] == ["walk 1", "walk 2"]

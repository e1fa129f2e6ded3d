"""Samples that no sensor should send, and gaps: what was once believed in silence is now left out, or reported."""

from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import LEG_SITES, Joint, Site
from core.findings import Severity
from core.results import Analysis, Method, ZeroKind
from core.samples import ImuBlock
from core.session import RecordingKind, Session
from core.signal.rotations import angle_between
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.core.cut_blocks import Change, changed, first
from tests.core.hinges import PERSON
from tests.core.recorded_joints import TestData, mechanism, session_of_mechanism
from tests.simulated import simulation_of

S, F, W = RecordingKind.STANDING, RecordingKind.FREE_MOTION, RecordingKind.WALKING
THIGH, SHANK, FOOT = Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT
KNEE = Joint.LEFT_KNEE
methods = pytest.mark.parametrize("method", list(Method))


def with_value(value: float, signal: str = "gyr_rad_s", at: int = 150) -> Change:
    def spoil(b: ImuBlock) -> ImuBlock:
        values = getattr(b, signal).copy()
        values[at] = value
        return replace(b, **{signal: values})

    return spoil


def worst_deg(found: Analysis, joint: Joint = KNEE) -> float:
    """Worst RMSE after removing the mean over the recordings that have this joint; 0 where none has."""
    worst = 0.0
    for r in found.recordings:
        if joint in r.joints and np.isfinite(r.joints[joint].angle_rad).any():
            error = r.joints[joint].angle_rad - PERSON.truth(r.kind, joint, r.time_s - r.time_s[0])
            worst = max(worst, float(np.rad2deg(np.nanstd(error))))
    return worst


def assert_there(found: Analysis) -> None:
    """The knee is still measured, nearly throughout."""
    for r in found.recordings:
        assert np.mean(np.isfinite(r.joints[KNEE].angle_rad)) > 0.8


def is_warned(found: Analysis) -> bool:
    return any(f.severity is not Severity.INFO for f in found.findings)


def assert_right_or_stated(found: Analysis, joint: Joint = KNEE) -> None:
    worst = worst_deg(found, joint)
    assert worst < 3.0 or is_warned(found), f"{worst:.0f} deg wrong, told only {[f.key for f in found.findings]}"


def with_quaternion(value: float) -> Change:
    def spoil(b: ImuBlock) -> ImuBlock:
        q = np.tile([1.0, 0.0, 0.0, 0.0], (len(b), 1))
        q[100:102] = [value, 0.0, 0.0, 0.0]
        return replace(b, q_earth_from_sensor=q)

    return spoil


def in_single_precision(b: ImuBlock) -> ImuBlock:
    return replace(b, gyr_rad_s=b.gyr_rad_s.astype(np.float32), acc_m_s2=b.acc_m_s2.astype(np.float32))


def with_a_repeated_stamp(b: ImuBlock) -> ImuBlock:
    return replace(b, time_s=np.where(np.arange(len(b)) == 120, b.time_s[119], b.time_s))


BORNE = {  # and what else would come of it
    "a huge acceleration overflows where lengths are taken": with_value(1e300, "acc_m_s2"),
    "a huge rate does too": with_value(1e200),
    "a quaternion of zeros raises in SciPy": with_quaternion(0.0),
    "a huge quaternion overflows": with_quaternion(1e300),
    "VQF takes no single precision": in_single_precision,
    "a repeated stamp raises in Akima": with_a_repeated_stamp,
}


@methods
@pytest.mark.parametrize("case", BORNE)
def test_what_no_sensor_should_send_leaves_the_knee_measured(knee_visit: Session, case: str, method: Method) -> None:
    assert_there(analyse(changed(knee_visit, BORNE[case]), method))


@methods
def test_one_impossible_sample_counts_as_missing(knee_visit: Session, method: Method) -> None:
    """One gyr sample of 1e6 rad/s. Same mend: > 100 rad/s or > 1000 m/s2 is a missing sample, with a finding."""
    assert_right_or_stated(analyse(changed(knee_visit, with_value(1e6)), method))


@methods
def test_a_sensor_that_repeats_one_sample_for_seconds_is_reported(knee_visit: Session, method: Method) -> None:
    """From mid-walk on the shank repeats its last sample. Mend: runs of equal rows over 0.25 s are missing,
    reported."""

    def stuck(b: ImuBlock) -> ImuBlock:
        index = np.minimum(np.arange(len(b)), len(b) // 2)
        return replace(b, gyr_rad_s=b.gyr_rad_s[index], acc_m_s2=b.acc_m_s2[index])

    assert_right_or_stated(analyse(changed(knee_visit, stuck, (SHANK,), "walk"), method))


@methods
def test_a_sensor_that_is_constant_throughout_is_left_out(knee_visit: Session, method: Method) -> None:
    """The same for a whole recording: wants a grave finding of its own and no angle."""

    def constant(b: ImuBlock) -> ImuBlock:
        rate, force = np.tile([0.1, 0.2, -0.1], (len(b), 1)), np.tile([0.0, 0.0, 9.81], (len(b), 1))
        return replace(b, gyr_rad_s=rate, acc_m_s2=force)

    found = analyse(changed(knee_visit, constant, (SHANK,)), method)
    assert any(f.severity is Severity.GRAVE for f in found.findings)


@methods
def test_the_same_data_in_two_sensors_is_seen_though_one_lost_its_last_samples(
    knee_visit: Session, method: Method
) -> None:
    """quality._same_data compares whole heads of 2000. Mend: compare the rows of common stamps."""

    def shorter(b: ImuBlock) -> ImuBlock:
        return replace(b.select(slice(-5)), sensor="two")

    twice = [replace(r, imu={THIGH: r.imu[THIGH], SHANK: shorter(r.imu[THIGH])}) for r in knee_visit.recordings]
    found = analyse(replace(knee_visit, recordings=tuple(twice)), method)
    assert "same_data" in {f.key for f in found.findings}


@methods
def test_a_joint_without_zero_states_so_though_another_leg_stood(method: Method) -> None:
    """`no_standing` looks at the session only. Mend: one finding per joint whose zero is NONE."""
    stood = PERSON.recording("standing", S, 3.0, (Site.RIGHT_THIGH, Site.RIGHT_SHANK))
    found = analyse(Session((stood, *PERSON.visit(kinds=(F, W)).recordings)), method)
    assert found.calibrations[0].joints[KNEE].zero is ZeroKind.NONE
    assert any("zero" in f.key or "standing" in f.key for f in found.findings)


@methods
def test_a_typed_goniometer_value_that_cannot_be_used_is_reported(method: Method) -> None:
    """Without standing the value cannot be used; `no_standing` does not report that it was not."""
    found = analyse(replace(PERSON.visit(kinds=(F, W)), zero_rad={KNEE: 0.2}), method)
    assert any("goniometer" in f.key for f in found.findings)


@methods
def test_a_broken_free_motion_leaves_the_walk_s_angles(knee_visit: Session, method: Method) -> None:
    """basis_of asks holds(), not is_usable(): a free motion of five samples is in force. Mend: pass what is usable."""
    found = analyse(changed(knee_visit, first(5), LEG_SITES, "free motion"), method)
    assert any(KNEE in r.joints for r in found.recordings if r.name == "walk")


def test_a_magnetometer_of_zeros_gives_no_angle(knee_visit: Session) -> None:
    """Eq 10 from a field of zero length is a number from nothing. Mend: no field, no orientation to north."""
    found = analyse(changed(knee_visit, lambda b: replace(b, mag=np.zeros((len(b), 3)))))
    assert all(r.joints[KNEE].orientation_rad is None for r in found.recordings)


@methods
@pytest.mark.parametrize("rate_hz", [5.0])
def test_far_too_slow_a_rate_is_reported(rate_hz: float, method: Method) -> None:
    """Mend: a finding under 25 Hz, grave under 10."""
    assert_right_or_stated(analyse(PERSON.visit(rate_hz=rate_hz, duration_s=60.0), method))


@pytest.mark.parametrize("name", ["1D_02", "1D_03"])
def test_the_axis_of_a_real_hinge_lies_within_two_deviations(test_data: TestData, name: str) -> None:
    """0.54 deg off with a claimed sd of 0.15. Mend: a floor of 0.3 deg or more ("the real hinge needs 0.5")."""
    data = mechanism(test_data, name)
    found = analyse(session_of_mechanism(data)).calibrations[0].joints[KNEE]
    sign = np.sign(found.axis_proximal @ data["j1_ref"])
    worst = max(
        angle_between(sign * axis, data[key])
        for axis, key in ((found.axis_proximal, "j1_ref"), (found.axis_distal, "j2_ref"))
    )
    assert found.axis_sd_rad is not None
    assert worst < 2 * found.axis_sd_rad


@pytest.mark.endurance
@pytest.mark.parametrize("rows", [9, 14, 23])
def test_one_gap_does_not_spoil_the_rest_of_a_walk(rows: int) -> None:
    """A gap of 240 ms in one sensor, once: up to 12 deg wrong for the rest of the walk, claimed sd 0.6 deg, nothing
    stated but `gaps`. 50 ms: 0.1 deg; 310 ms, where a new stretch begins: 0.1 deg. Interpolated rates across a step
    turn the sensor by what they miss, and headings and drift, linear between knots 10 s apart, cannot step. Mend: let
    them step at every gap over 50 ms (knots of its own for each side), or bridge no more than 50 to 60 ms."""
    walked = simulation_of(
        WalkerSettings(seed=1, recordings=(Standing(), FreeMotion(), Walk(strides=5)), sites=(THIGH, SHANK))
    )
    (truth,) = walked.truth.recordings["walk 1"].joints.values()
    worst_m, least = 0.0, 1.0
    for at in (265, 280, 295, 310, 325):

        def cut(b: ImuBlock, at: int = at) -> ImuBlock:
            keep = np.ones(len(b), dtype=bool)
            keep[at : at + rows] = False
            return b.select(keep)

        angle = analyse(changed(walked.session, cut, (SHANK,), "walk 1")).recordings[-1].joints[KNEE]
        error = angle.angle_rad - (truth.angle_rad - truth.standing_rad)
        there = np.isfinite(error)
        worst_m = max(worst_m, float(np.rad2deg(np.std(error[there]))))
        least = min(least, float(np.mean(np.abs(error[there]) < 2 * angle.sd_rad[there])))
    assert least > 0.9, f"two sd hold {100 * least:.0f} % of the samples; {worst_m:.1f} deg wrong"


@pytest.mark.parametrize(
    "seed", [3, pytest.param(1, marks=pytest.mark.endurance), pytest.param(11, marks=pytest.mark.endurance)]
)
def test_what_lost_samples_cost_is_within_two_deviations(seed: int) -> None:
    """The same by the walker's own loss; in free motion it turns the axis, in the walk the angle."""
    settings = WalkerSettings(
        seed=seed,
        recordings=(Standing(), FreeMotion(), Walk(strides=5)),
        sites=(THIGH, SHANK, FOOT),
        loss_fraction=0.02,
    )
    walked = simulation_of(settings)
    found = analyse(walked.session).recordings[-1]
    for joint, truth in walked.truth.recordings["walk 1"].joints.items():
        expected = np.interp(found.time_s, truth.time_s, truth.angle_rad - truth.standing_rad)
        error = found.joints[joint].angle_rad - expected
        there = np.isfinite(error)
        assert np.mean(np.abs(error[there]) < 2 * found.joints[joint].sd_rad[there]) > 0.9

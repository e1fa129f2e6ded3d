"""Real sensors: mechanical joints against optics, and a person who jumps."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.analysis import analyse
from core.body import LEG_JOINTS, Joint
from core.findings import Severity
from core.results import Analysis, JointAngle, JointCalibration
from core.samples import FloatArray
from core.signal.rotations import angle_between, joint_frame
from tests.core.recorded_joints import UNTURNED, TestData, jumping_person, mechanism, session_of_mechanism

KNEE = Joint.LEFT_KNEE


def calibration_of(found: Analysis) -> JointCalibration:
    return found.calibrations[0].joints[KNEE]


def angle_of(found: Analysis) -> JointAngle:
    return found.recordings[0].joints[KNEE]


@dataclass(frozen=True)
class Hinge:
    data: dict[str, FloatArray]
    found: Analysis

    @property
    def sign(self) -> float:
        """1 where the angle rises with the reference's, whose rate is g2.j2 - g1.j1."""
        calibration = calibration_of(self.found)
        return float(np.sign(calibration.clinical_sign * calibration.axis_proximal @ self.data["j1_ref"]))

    def error_rad(self) -> FloatArray:
        """Of the angle against optics (n,), the mean removed, at the time offset that fits best, NaN without optics."""
        angle = self.sign * angle_of(self.found).angle_rad
        n = np.arange(len(angle))
        is_ok, reference = self.data["ref_ok"] > 0, np.unwrap(self.data["angle_ref_rad"])
        best: FloatArray = np.full(len(angle), np.inf)
        for offset in np.arange(-20, 21) / 10:  # the sensors lag the optics by 0.7 to 0.9 sample
            at = n - offset
            error = angle - np.interp(at, n, reference)
            inside = (at >= 0) & (at <= n[-1])
            for whole in (np.floor(at), np.ceil(at)):
                inside &= is_ok[np.clip(whole.astype(int), 0, len(n) - 1)]
            error = np.where(inside, error - np.nanmean(error[inside]), np.nan)
            if np.nanmean(error**2) < np.nanmean(best**2):
                best = error
        return best


@pytest.fixture(scope="module", params=["1D_02", "1D_03"])
def hinge(test_data: TestData, request: pytest.FixtureRequest) -> Hinge:
    data = mechanism(test_data, request.param)
    return Hinge(data, analyse(session_of_mechanism(data)))


def test_a_mechanical_hinge_is_called_one(hinge: Hinge) -> None:
    assert calibration_of(hinge.found).is_hinge
    assert "is_a_hinge" in {f.key for f in hinge.found.findings}


def test_its_axes_are_found_to_six_tenths_of_a_degree_and_paired(hinge: Hinge) -> None:
    calibration = calibration_of(hinge.found)
    one, two = calibration.axis_proximal, calibration.axis_distal
    sign = np.sign(one @ hinge.data["j1_ref"])
    errors = [angle_between(sign * one, hinge.data["j1_ref"]), angle_between(sign * two, hinge.data["j2_ref"])]
    assert np.rad2deg(max(errors)) < 0.6
    assert calibration.sign_margin is not None
    assert calibration.sign_margin > 1.3


def test_its_centre_is_found_to_two_and_a_half_millimetres_across_the_axis(hinge: Hinge) -> None:
    calibration = calibration_of(hinge.found)
    for found, j, r in (
        (calibration.centre_proximal_m, hinge.data["j1_ref"], hinge.data["r1_optical_m"]),
        (calibration.centre_distal_m, hinge.data["j2_ref"], hinge.data["r2_optical_m"]),
    ):
        assert found is not None
        assert np.linalg.norm(np.stack(joint_frame(j)) @ (found + r)) < 0.0025


def test_its_angle_is_within_seven_tenths_of_a_degree_of_optics(hinge: Hinge) -> None:
    error = hinge.error_rad()
    assert np.count_nonzero(np.isfinite(error)) > 0.9 * len(error)
    assert np.rad2deg(np.sqrt(np.nanmean(error**2))) < 0.7


def test_two_standard_deviations_hold_nine_samples_of_ten(hinge: Hinge) -> None:
    error, sd = hinge.error_rad(), angle_of(hinge.found).sd_rad
    there = np.isfinite(error)
    assert np.mean(np.abs(error[there]) < 2 * sd[there]) > 0.9
    assert np.rad2deg(np.nanmedian(sd)) < 2.5 * 0.7


@pytest.mark.endurance
@pytest.mark.parametrize("seed", range(4))
def test_turning_either_sensor_leaves_the_angle_as_it_was(hinge: Hinge, seed: int) -> None:
    turns = list(Rotation.random(2, rng=np.random.default_rng(seed)))
    turn_1, turn_2 = turns[0] if seed != 1 else UNTURNED, turns[1] if seed != 2 else UNTURNED
    turned = analyse(session_of_mechanism(hinge.data, turn_1, turn_2))
    # free motion alone does not report the clinical sign, which may fall either way
    axes = turn_1.apply(calibration_of(turned).axis_proximal), calibration_of(hinge.found).axis_proximal
    signs = calibration_of(turned).clinical_sign * calibration_of(hinge.found).clinical_sign
    same = signs * float(np.sign(axes[0] @ axes[1]))
    difference = same * angle_of(turned).angle_rad - angle_of(hinge.found).angle_rad
    difference -= np.nanmean(difference)
    assert np.rad2deg(np.nanmax(np.abs(difference))) < 0.01


@pytest.mark.parametrize("name", ["2D_02", "3D_02"])
def test_two_and_three_axes_are_called_not_a_hinge(test_data: TestData, name: str) -> None:
    found = analyse(session_of_mechanism(mechanism(test_data, name)))
    calibration = calibration_of(found)
    assert not calibration.is_hinge
    assert calibration.hinge_residual_rad_s is not None
    assert calibration.hinge_residual_rad_s > 0.2
    assert ("not_a_hinge", "left_knee") in {(f.key, f.where) for f in found.findings}


@pytest.fixture(scope="module")
def jumps(test_data: TestData) -> Analysis:
    return analyse(jumping_person(test_data, has_orientations=True))


def test_jumps_run_through_with_an_angle_for_every_joint(jumps: Analysis) -> None:
    (recording,) = jumps.recordings
    assert set(recording.joints) == set(LEG_JOINTS)
    for angle in recording.joints.values():
        assert np.mean(np.isfinite(angle.angle_rad)) > 0.95


def test_jumps_do_not_claim_a_sure_flexion_of_the_ankles(jumps: Analysis) -> None:
    doubts = {f.where for f in jumps.findings if f.severity is not Severity.INFO}
    for joint in (Joint.LEFT_ANKLE, Joint.RIGHT_ANKLE):
        calibration = jumps.calibrations[0].joints[joint]
        assert not calibration.is_sign_certain
        assert not calibration.is_hinge
        assert str(joint) in doubts

"""Tests that a patient with every truth known is recovered, whatever is done to the sensors on the way."""

from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import LEG_SITES, Joint, Side, Site
from core.results import Analysis
from core.samples import FloatArray, RateKind, SensorInfo
from core.session import Session
from devices.simulation.walker import FreeMotion, SimulatedSession, Standing, Tissue, Walk, WalkerSettings
from tests.simulated import session_of, simulation_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

LEFT = tuple(site for site in LEG_SITES if site.side is Side.LEFT)
KNEE, ANKLE = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
SHORT = (Standing(), FreeMotion(), Walk(strides=5))


def left_leg(**changes: object) -> WalkerSettings:
    return replace(WalkerSettings(seed=11, recordings=SHORT, sites=LEFT), **changes)  # type: ignore[arg-type] # names of fields


def error_rad(walked: SimulatedSession, found: Analysis, joint: Joint) -> FloatArray:
    """Of the last walk's angle against the truth, both since standing."""
    walk = found.recordings[-1]
    truth = walked.truth.recordings[walk.name].joints[joint]
    zero_rad = 0.0 if np.isnan(truth.standing_rad) else truth.standing_rad
    # the truth of an ankle is at the shank's stamps, its angle at the thigh's
    late_s = 0.0 if joint is KNEE else walked.truth.recordings[walk.name].joints[KNEE].lag_s
    expected = np.interp(walk.time_s, truth.time_s + late_s, truth.angle_rad - zero_rad)
    return walk.joints[joint].angle_rad - expected


def rms_deg(error: FloatArray) -> float:
    return float(np.rad2deg(np.sqrt(np.nanmean((error - np.nanmean(error)) ** 2))))


def without_word(session: Session) -> Session:
    """The sensors do not report what their rates stand for."""
    return replace(session, sensors=dict.fromkeys(session.sensors, SensorInfo()))


@pytest.mark.parametrize(
    "settings",
    [
        left_leg(),
        left_leg(rate_hz=60.0),
        left_leg(rate_hz=200.0),
        left_leg(stamp_jitter_s=0.001),
        left_leg(clock_late_s={Site.LEFT_SHANK: 0.02}),
        left_leg(rate_kind=RateKind.AVERAGED),
        left_leg(recordings=SHORT[::2]),
    ],
    ids=["plain", "60 Hz", "200 Hz", "jitter", "late", "averaged", "walk only"],
)
def test_a_rigid_leg_is_measured_whatever_the_sensors_do(settings: WalkerSettings) -> None:
    walked = simulation_of(settings)
    found = analyse(walked.session)
    for joint in (KNEE, ANKLE):
        assert rms_deg(error_rad(walked, found, joint)) < 0.8
        assert found.calibrations[0].joints[joint].is_sign_certain


@pytest.mark.endurance
def test_averaged_rates_are_found_where_no_sensor_shows() -> None:
    walked = simulation_of(left_leg(rate_kind=RateKind.AVERAGED))
    found = analyse(without_word(walked.session))
    assert "rate_kind_found" in {f.key for f in found.findings}
    assert rms_deg(error_rad(walked, found, KNEE)) < 0.8
    instants = analyse(without_word(session_of(left_leg())))
    assert "rate_kind_found" not in {f.key for f in instants.findings}


@pytest.mark.parametrize("tissue", [Tissue.SOFT, Tissue.REAL])
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.endurance)])
def test_on_soft_tissue_the_sign_is_right_and_two_deviations_hold_nine_samples_of_ten(
    tissue: Tissue, seed: int
) -> None:
    walked = simulation_of(left_leg(seed=seed, tissue=tissue))
    found = analyse(walked.session)
    for joint in (KNEE, ANKLE):
        error, angle = error_rad(walked, found, joint), found.recordings[-1].joints[joint]
        truth = walked.truth.recordings[found.recordings[-1].name]
        calibration = found.calibrations[0].joints[joint]
        towards = calibration.clinical_sign * calibration.axis_distal @ truth.joints[joint].axis_distal
        assert towards > 0.8
        centred = np.abs(error - np.nanmean(error))
        assert np.nanmean(centred < 2 * angle.sd_rad) > 0.9


def test_a_stiff_knee_is_right_or_uncertain() -> None:
    walked = simulation_of(left_leg(stiff_knee_side=Side.LEFT))
    found = analyse(walked.session)
    calibration = found.calibrations[0].joints[KNEE]
    truth = walked.truth.recordings[found.recordings[-1].name].joints[KNEE]
    is_right = calibration.clinical_sign * calibration.axis_distal @ truth.axis_distal > 0
    assert is_right or not calibration.is_sign_certain


def test_lags_are_found_on_both_sides_of_a_late_shank() -> None:
    found = analyse(session_of(left_leg(clock_late_s={Site.LEFT_SHANK: 0.03})))
    joints = found.calibrations[0].joints
    assert joints[KNEE].lag_s == pytest.approx(-0.03, abs=0.0015)
    assert joints[ANKLE].lag_s == pytest.approx(0.03, abs=0.0015)


def test_new_straps_are_a_new_calibration() -> None:
    walked = simulation_of(
        left_leg(
            recordings=(
                Standing(),
                FreeMotion(),
                Walk(strides=4),
                replace(Standing("standing 2"), is_restrapped_before=True),
                replace(Walk(strides=4), name="walk 2"),
            )
        )
    )
    found = analyse(walked.session)
    assert len(found.calibrations) == 2
    assert [c.joints[KNEE].free_motion_from is None for c in found.calibrations] == [False, True]
    assert rms_deg(error_rad(walked, found, KNEE)) < 1.0


def test_a_clock_that_is_late_in_one_walk_only_is_corrected_and_reported() -> None:
    walked = simulation_of(WalkerSettings(seed=3))
    standing, free, walk = walked.session.recordings
    late = {s: replace(b, time_s=b.time_s + 0.03) if s is Site.LEFT_SHANK else b for s, b in walk.imu.items()}
    found = analyse(replace(walked.session, recordings=(standing, free, replace(walk, imu=late))))
    reported = {f.where: f.numbers["lag_ms"] for f in found.findings if f.key == "clock_moved"}
    assert set(reported) == {"walk 1, left_knee", "walk 1, left_ankle"}
    assert reported["walk 1, left_knee"] == pytest.approx(-30.0, abs=1.5)
    for joint in (Joint.LEFT_KNEE, Joint.LEFT_ANKLE):
        assert rms_deg(error_rad(walked, found, joint)) < 0.8


def test_sensors_on_loose_tissue_agree_about_a_knee_nearly_as_those_on_people() -> None:
    """Worn by people they disagree about the joint's force by 8 to 13 % of what they feel."""
    settings = WalkerSettings(recordings=(Standing(), Walk(strides=12)), tissue=Tissue.REAL)
    found = analyse(session_of(settings)).calibrations[0].joints
    apart = [found[joint].disagreement or 0.0 for joint in (Joint.LEFT_KNEE, Joint.RIGHT_KNEE)]
    assert 0.08 < np.mean(apart) < 0.19

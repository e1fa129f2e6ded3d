"""The drift of a hinge: what is left of biases and scales is taken out, and what remains is stated."""

from collections.abc import Callable

import numpy as np
import pytest

from core.analysis import analyse
from core.angles import hinge_angle as drifting
from core.angles.hinge_angle import hinge_angle, hinge_angle_and_sd
from core.body import Joint, Site
from core.samples import FloatArray
from core.session import RecordingKind
from core.signal.pair import pair_of
from devices.simulation.walker import FreeMotion, Motion, SensorErrors, WalkerSettings
from tests.core.hinges import PERSON
from tests.simulated import simulation_of

KNEE = Joint.LEFT_KNEE
SITES = (Site.LEFT_THIGH, Site.LEFT_SHANK)
BIASED = SensorErrors(gyro_bias_sd_rad_s=np.deg2rad(1.0))
LYING = (FreeMotion(duration_s=6.0), FreeMotion("measured", duration_s=30.0, motion=Motion.SIDE_LYING))


@pytest.mark.parametrize(
    ("seed", "recordings"),
    [(3, (FreeMotion("measured", duration_s=20.0),)), (2, LYING)],
    ids=["level", "upright"],
)
def test_biases_that_no_rest_has_shown_leave_no_drift(seed: int, recordings: tuple[FreeMotion, ...]) -> None:
    """The angle was off by 5 to 17 deg, and 6 to 9 samples of a hundred lay within two standard deviations."""
    made = simulation_of(WalkerSettings(seed, recordings, SITES, errors=BIASED))
    found = next(r for r in analyse(made.session).recordings if r.name == "measured")
    truth = made.truth.recordings["measured"].joints[KNEE]
    angle, true = found.joints[KNEE], np.interp(found.time_s, truth.time_s, truth.angle_rad)
    # free motion alone does not report the clinical sign
    error = min((sign * angle.angle_rad - true for sign in (1, -1)), key=lambda e: float(np.std(e)))
    error -= np.mean(error)
    assert np.rad2deg(np.std(error)) < 0.2
    assert np.mean(np.abs(error) < 2 * angle.sd_rad) > 0.9


def error_with(change: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Error (n,) of a hinge's angle, the mean removed, where both gyroscopes read what `change` makes of the rates."""
    pair = PERSON.exact_pair(KNEE, duration_s=12.0)
    rates, forces = (change(pair.g1), change(pair.g2)), (pair.a1, pair.a2)
    orientations = pair.tracks[0].q_earth_from_sensor, pair.tracks[1].q_earth_from_sensor
    changed = pair_of(pair.time_s, pair.step_s, rates, forces, orientations, pair.is_measured)
    axes = [PERSON.axis(site, KNEE) for site in SITES]
    centres = np.concatenate([*(PERSON.centre_m(site, KNEE) for site in SITES), np.zeros(6)])
    error = hinge_angle(changed, axes[0], axes[1], centres)
    error = error - PERSON.truth(RecordingKind.FREE_MOTION, KNEE, pair.time_s)
    return np.asarray(error - np.mean(error))


def test_a_scale_of_the_gyroscopes_is_found_on_a_level_axis(monkeypatch: pytest.MonkeyPatch) -> None:
    found = np.std(error_with(lambda rates: 1.01 * rates))
    monkeypatch.setattr(drifting, "SCALE", 1e-6)
    assert found < 0.5 * np.std(error_with(lambda rates: 1.01 * rates))


def test_what_a_gyroscope_at_its_end_has_lost_is_found_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Why eq 15 was the better one in a fast roll: it forgets in seconds what a line between knots keeps."""

    def clipped(rates: FloatArray) -> FloatArray:
        return np.clip(rates, -0.85 * np.max(np.abs(rates)), 0.85 * np.max(np.abs(rates)))

    found = np.std(error_with(clipped))
    monkeypatch.setattr(drifting, "CLIPPED_BEYOND_RAD_S", np.inf)
    assert found < 0.5 * np.std(error_with(clipped))


def test_of_gyroscopes_within_their_range_nothing_is_taken_for_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    found = error_with(lambda rates: rates)
    monkeypatch.setattr(drifting, "CLIPPED_BEYOND_RAD_S", np.inf)
    np.testing.assert_array_equal(found, error_with(lambda rates: rates))


def test_a_drift_is_less_sure_where_the_accelerations_agree_less() -> None:
    pair = PERSON.exact_pair(KNEE, duration_s=12.0)
    axes = [PERSON.axis(site, KNEE) for site in SITES]
    centres = np.concatenate([*(PERSON.centre_m(site, KNEE) for site in SITES), np.zeros(6)])
    _, sure = hinge_angle_and_sd(pair, axes[0], axes[1], centres)
    _, unsure = hinge_angle_and_sd(pair, axes[0], axes[1], centres + np.repeat([0.0, 1.0], 6))
    assert np.all(sure > 0.0)
    assert np.median(unsure) > 3 * np.median(sure)

"""An angle that wanders slowly, and what is seen of it."""

import numpy as np

from core.live.drift import UNKNOWN_RAD, ObservationModel, SlowDrift, Wandering

WANDERING = Wandering(np.deg2rad(0.3), np.deg2rad(1.5), np.deg2rad(0.02))
LOOKS = ObservationModel(first_scale=np.deg2rad(5.0), min_scale=np.deg2rad(0.3), correlation_s=0.5)


def followed(drift: SlowDrift, angle_rad: np.ndarray, step_s: float = 0.1) -> np.ndarray:
    """What is expected after each look at `angle_rad` (n,)."""
    found = []
    for k, angle in enumerate(angle_rad, start=1):
        drift.look(complex(np.exp(1j * angle)), k * step_s, step_s)
        found.append(float(drift.at(np.array([k * step_s]))[0]))
    return np.array(found)


def test_a_slope_is_followed_without_falling_behind() -> None:
    drift = SlowDrift(WANDERING, LOOKS)
    drift.restart(0.0, 0.0, np.deg2rad(10.0))
    angle = np.deg2rad(1.5) * 0.1 * np.arange(1, 601)
    noise = np.deg2rad(2.0) * np.random.default_rng(0).normal(size=600)
    error = followed(drift, angle + noise) - angle
    assert np.rad2deg(np.abs(error[200:]).max()) < 1.5


def test_an_angle_that_was_lost_is_found_again_and_its_looks_stay_worth_what_they_are() -> None:
    drift = SlowDrift(WANDERING, LOOKS)
    drift.restart(0.0, 0.0, np.deg2rad(1.0))
    noise = np.deg2rad(0.5) * np.random.default_rng(1).normal(size=900)
    angle = np.where(np.arange(900) < 300, 0.0, 1.0)
    error = followed(drift, angle + noise) - angle
    assert np.rad2deg(np.abs(error[-30:]).max()) < 2.0


def test_what_jumped_unseen_is_found_within_two_seconds_and_makes_no_slope() -> None:
    drift = SlowDrift(WANDERING, LOOKS)
    drift.restart(0.0, 0.0, np.deg2rad(5.0))
    angle = np.where(np.arange(60) < 5, 0.0, 1.0)  # at a time when the slope is not known yet
    error = followed(drift, angle) - angle
    assert np.rad2deg(np.abs(error[30:]).max()) < 1.0


def test_what_sways_with_each_stride_is_not_taken_for_lost() -> None:
    drift = SlowDrift(WANDERING, LOOKS)
    drift.restart(0.0, 0.0, np.deg2rad(1.0))
    swaying = np.deg2rad(25.0) * np.sin(2 * np.pi * 0.1 * np.arange(300) / 2.0)  # strides of two seconds
    assert np.rad2deg(np.abs(followed(drift, swaying)).max()) < 8.0


def test_a_shock_at_the_start_is_outvoted() -> None:
    drift = SlowDrift(WANDERING, ObservationModel(0.5, 0.3, 0.3, begins_with=5))
    drift.restart(0.0, 0.0, UNKNOWN_RAD)
    looks = [60.0 * np.exp(2.0j), *(100.0 * np.exp(-0.7j + 0.02j * k) for k in range(4))]
    for k, seen in enumerate(looks):
        drift.look(complex(seen), 0.1 * k, 0.1)
    assert abs(float(drift.at(np.array([0.4]))[0]) + 0.67) < 0.05

"""Tests that offset, clock rate and sign of a reference are found. What cannot be compared is refused."""

from dataclasses import replace

import numpy as np
import pytest

from core.agreement.clock import Alignment, FoundOffset, Misfit, align, find_offset
from core.agreement.curves import ComparedTrial, TimedAngle, angle_at, rates_of, stretches_of
from core.body import Joint
from core.samples import FloatArray

KNEE, ANKLE = Joint.RIGHT_KNEE, Joint.RIGHT_ANKLE


def walked(time_s: FloatArray, joint: Joint = KNEE) -> FloatArray:
    """A leg that walks, in closed form: strides of 1.1 s whose length and size wander a little, as a person's do."""
    turn = 2 * np.pi * (time_s / 1.1 + 0.06 * np.sin(0.43 * time_s + 0.4) + 0.04 * np.sin(0.9 * time_s))
    size = 1.0 + 0.05 * np.sin(0.7 * time_s) + 0.03 * np.sin(1.3 * time_s + 1.0)
    if joint is KNEE:
        return size * np.deg2rad(25 - 22 * np.cos(turn + 0.3) + 12 * np.sin(2 * turn) + 3 * np.cos(3 * turn))
    return size * np.deg2rad(2 + 9 * np.sin(turn) - 7 * np.cos(2 * turn + 0.5))


def trial(
    offset_s: float = 0.0,
    ppm: float = 0.0,
    seconds: float = 10.0,
    signs: tuple[int, int] = (1, 1),
    noise_deg: float = 0.2,
    seed: int = 0,
    hz: float = 120.0,
) -> ComparedTrial:
    """Sensors at 60 Hz from 0 on; a reference that shows `offset_s` more at 0 and runs `ppm` fast."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(0.0, seconds, 1 / 60)
    shown_s = offset_s + np.arange(-1.0, seconds + 1.0, 1 / hz)
    true_s = (shown_s - offset_s) / (1 + 1e-6 * ppm)
    measured = {joint: TimedAngle(time_s, walked(time_s, joint)) for joint in (KNEE, ANKLE)}
    reference = {
        joint: TimedAngle(shown_s, sign * (walked(true_s, joint) + rng.normal(0, np.deg2rad(noise_deg), len(true_s))))
        for joint, sign in zip((KNEE, ANKLE), signs, strict=True)
    }
    return ComparedTrial(measured, reference)


def aligned(*trials: ComparedTrial) -> tuple[Alignment, ...]:
    found = [find_offset(one) for one in trials]
    assert all(isinstance(one, FoundOffset) for one in found)
    return align(trials, [one for one in found if isinstance(one, FoundOffset)])


def shown_at(found: Alignment, time_s: float) -> float:
    return float(found.clock.at(np.array([time_s]))[0])


@pytest.mark.parametrize("offset_s", [0.0, 3.7123, -2.4567, 86_400.013, 1.7e9 + 0.25])
def test_an_offset_of_any_size_is_found_to_a_tenth_of_a_sample(offset_s: float) -> None:
    (found,) = aligned(trial(offset_s))
    assert shown_at(found, 5.0) - 5.0 == pytest.approx(offset_s, abs=0.1 / 120)
    assert found.is_offset_certain


@pytest.mark.parametrize("ppm", [150.0, -150.0, 400.0])
def test_a_clock_that_runs_fast_is_found_over_a_minute(ppm: float) -> None:
    (found,) = aligned(trial(2.0, ppm, seconds=60.0))
    assert found.is_offset_certain
    assert 1e6 * found.clock.rate == pytest.approx(ppm, abs=15)
    for time_s in (1.0, 30.0, 59.0):
        assert shown_at(found, time_s) == pytest.approx(2.0 + time_s * (1 + 1e-6 * ppm), abs=0.001)


def test_six_short_walks_share_one_clock_rate_which_each_alone_hardly_shows() -> None:
    walks = [trial(10.0 * k, 150.0, seconds=10.0, seed=k) for k in range(6)]
    together = aligned(*walks)
    assert len({one.clock.rate for one in together}) == 1
    assert 1e6 * together[0].clock.rate == pytest.approx(150, abs=40)
    assert together[0].rate_sd < 0.6 * aligned(walks[0])[0].rate_sd
    for k, found in enumerate(together):
        assert shown_at(found, 5.0) == pytest.approx(10.0 * k + 5.0 * (1 + 150e-6), abs=0.1 / 120)


def test_the_stated_sd_of_offset_and_rate_hold() -> None:
    found = [aligned(trial(1.0, 150.0, seconds=20.0, noise_deg=0.5, seed=seed))[0] for seed in range(12)]
    rate_z = [(one.clock.rate - 150e-6) / one.rate_sd for one in found]
    offset_z = [
        (shown_at(one, one.clock.at_s) - 1.0 - one.clock.at_s * (1 + 150e-6)) / one.offset_sd_s for one in found
    ]
    assert np.mean(np.abs(rate_z) < 2) > 0.8
    assert np.mean(np.abs(offset_z) < 2) > 0.8


@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_a_wrong_sign_is_found_by_joint(signs: tuple[int, int]) -> None:
    (found,) = aligned(trial(4.0, signs=signs))
    assert (found.sign[KNEE], found.sign[ANKLE]) == signs
    assert shown_at(found, 0.0) == pytest.approx(4.0, abs=0.001)
    assert min(found.likeness.values()) > 0.98


def test_a_reference_that_reads_less_has_a_gain() -> None:
    one = trial(1.0)
    smaller = {joint: replace(curve, angle_rad=0.9 * curve.angle_rad) for joint, curve in one.reference.items()}
    (found,) = aligned(replace(one, reference=smaller))
    assert found.gain[KNEE] == pytest.approx(1 / 0.9, rel=0.01)


def test_gaps_in_either_are_no_motion_and_stay_gaps() -> None:
    one = trial(2.5)
    rng = np.random.default_rng(3)
    measured = {joint: with_gaps(curve, rng) for joint, curve in one.measured.items()}
    reference = {joint: with_gaps(curve, rng) for joint, curve in one.reference.items()}
    (found,) = aligned(ComparedTrial(measured, reference))
    assert shown_at(found, 5.0) - 5.0 == pytest.approx(2.5, abs=0.002)
    curve = reference[KNEE]
    missing = np.nonzero(np.isnan(curve.angle_rad))[0]
    middle = missing[np.isin(missing - 10, missing) & np.isin(missing + 10, missing)]
    assert len(middle)
    assert np.isnan(angle_at(curve, curve.time_s[middle])).all()


def with_gaps(curve: TimedAngle, rng: np.random.Generator) -> TimedAngle:
    angle_rad = curve.angle_rad.copy()
    for start in rng.integers(0, len(angle_rad) - 60, 3):
        angle_rad[start : start + 40] = np.nan
    return replace(curve, angle_rad=angle_rad)


def test_a_short_gap_is_bridged_and_a_long_one_is_not() -> None:
    time_s = np.delete(np.arange(0.0, 4.0, 0.01), [100, 101, *range(200, 210)])
    curve = TimedAngle(time_s, walked(time_s))
    assert len(list(stretches_of(curve))) == 2
    at_s = np.array([1.005, 2.05])
    read = angle_at(curve, at_s)
    assert read[0] == pytest.approx(walked(at_s[:1])[0], abs=1e-3)
    assert np.isnan(read[1])


def test_angles_that_jump_by_a_turn_are_one_curve() -> None:
    time_s = np.arange(0.0, 5.0, 0.01)
    angle_rad = walked(time_s) + np.deg2rad(160)
    wrapped = TimedAngle(time_s, np.angle(np.exp(1j * angle_rad)))
    assert np.abs(np.diff(wrapped.angle_rad)).max() > 6
    assert np.ptp(angle_at(wrapped, time_s) - angle_rad) < 1e-9


def test_the_rate_of_a_sine_is_a_cosine() -> None:
    time_s = np.arange(0.0, 6.0, 1 / 75)
    (found,) = rates_of(TimedAngle(time_s, np.sin(2 * np.pi * time_s)))
    at = slice(50, -50)
    truth = 2 * np.pi * np.cos(2 * np.pi * found.time_s)
    assert np.abs(found.rate_rad_s - truth)[at].max() < 0.02 * 2 * np.pi


def test_a_reference_of_the_middle_of_a_walk_is_found_in_it() -> None:
    one = trial(7.0)
    part = {
        joint: TimedAngle(curve.time_s[480:960], curve.angle_rad[480:960]) for joint, curve in one.reference.items()
    }
    (found,) = aligned(replace(one, reference=part))
    assert shown_at(found, 5.0) == pytest.approx(12.0, abs=0.002)


def test_standing_is_too_little_motion() -> None:
    time_s = np.arange(0.0, 10.0, 0.01)
    sway = TimedAngle(time_s, np.deg2rad(0.5) * np.sin(2 * np.pi * 0.4 * time_s))
    assert find_offset(ComparedTrial({KNEE: sway}, {KNEE: sway})) is Misfit.TOO_LITTLE_MOTION


def test_another_motion_is_not_alike() -> None:
    time_s = np.arange(0.0, 20.0, 0.01)
    rng = np.random.default_rng(1)
    other = np.cumsum(np.convolve(rng.normal(0, 0.05, len(time_s)), np.ones(30) / 5, "same"))
    pair = ComparedTrial({KNEE: TimedAngle(time_s, walked(time_s))}, {KNEE: TimedAngle(time_s, other)})
    assert find_offset(pair) is Misfit.NOT_ALIKE


def test_a_second_of_motion_is_too_short_and_other_joints_have_nothing_in_common() -> None:
    one = trial()
    short = {joint: TimedAngle(curve.time_s[:130], curve.angle_rad[:130]) for joint, curve in one.reference.items()}
    assert find_offset(replace(one, reference=short)) is Misfit.TOO_SHORT
    others = {Joint.LEFT_KNEE: one.reference[KNEE]}
    assert find_offset(replace(one, reference=others)) is Misfit.NO_JOINT_IN_COMMON
    nothing = {
        joint: replace(curve, angle_rad=np.full_like(curve.angle_rad, np.nan)) for joint, curve in one.reference.items()
    }
    assert find_offset(replace(one, reference=nothing)) is Misfit.TOO_SHORT


def test_ten_minutes_are_certain_though_each_stride_is_like_the_next() -> None:
    (found,) = aligned(trial(2.0, 170.0, seconds=600.0, hz=60.0))
    assert found.is_offset_certain
    assert 1e6 * found.clock.rate == pytest.approx(170.0, abs=2)


def test_a_machine_that_repeats_itself_exactly_leaves_the_offset_in_doubt() -> None:
    time_s = np.arange(0.0, 12.0, 0.01)
    machine = TimedAngle(time_s, np.sin(2 * np.pi * time_s))
    middle = TimedAngle(time_s[400:800], machine.angle_rad[400:800])
    (found,) = aligned(ComparedTrial({KNEE: machine}, {KNEE: middle}))
    assert not found.is_offset_certain

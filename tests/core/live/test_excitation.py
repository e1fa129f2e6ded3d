"""Tests of the gauge.

It falls with what the motion reports and stays open without it. It names the motion that is missing.

A leg below a fixed hip with exact sensors, whose truth is known: what a motion adds is tried by adding it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.body import Joint, Site
from core.live.excitation import HUMAN, PROSTHESIS, Excitation, ExcitationState, Missing, Movement
from core.live.orientation import OrientedSamples
from core.live.sample_sets import MAX_SETS, matrices_of
from core.samples import FloatArray
from core.signal.rotations import matrix_from_quaternion
from tests.benchmarks.excitation import QUANTITIES, stopped_calibrations

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

KNEE, ANKLE = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
SITES = {
    Site.LEFT_THIGH: np.array([0.03, 0.08, -0.22]),
    Site.LEFT_SHANK: np.array([0.05, 0.03, -0.20]),
    Site.LEFT_FOOT: np.array([0.09, 0.01, -0.04]),
}
LENGTH_M = 0.43
DIFFERENCE_S = 1e-3
ANGLES = ("flexion", "abduction", "turn", "knee", "ankle", "inversion")
# degrees of sine and cosine, Hz and a constant, of each angle that moves; all start and end at rest
Motion = dict[str, tuple[float, float, float, float]]
STILL: Motion = {}
BEND_KNEE: Motion = {"knee": (25.0, 0.0, 0.7, 25.0)}
BEND_ANKLE: Motion = {"ankle": (20.0, 0.0, 0.8, 0.0)}
CIRCLE_THIGH: Motion = {"flexion": (20.0, 0.0, 0.55, 0.0), "abduction": (0.0, 18.0, 0.55, 0.0)}
CIRCLE_SHANK: Motion = {"turn": (0.0, 20.0, 0.6, 0.0), "knee": (25.0, 0.0, 0.6, 45.0)}
CIRCLE_FOOT: Motion = {"ankle": (15.0, 0.0, 0.7, 0.0), "inversion": (0.0, 12.0, 0.7, 0.0)}
SWING_STIFF_LEG: Motion = {"flexion": (25.0, 0.0, 0.6, 0.0)}
ALL_AT_ONCE: Motion = {
    "flexion": (18.0, 0.0, 0.6, 10.0),
    "abduction": (0.0, 15.0, 0.6, 5.0),
    "turn": (8.0, 0.0, 0.8, 0.0),
    "knee": (28.0, 0.0, 0.75, 40.0),
    "ankle": (15.0, 0.0, 0.9, 0.0),
    "inversion": (0.0, 8.0, 0.7, 0.0),
}
ADDED = {
    Missing(Site.LEFT_THIGH, Movement.CIRCLE): CIRCLE_THIGH,
    Missing(Site.LEFT_SHANK, Movement.CIRCLE): CIRCLE_SHANK,
    Missing(Site.LEFT_SHANK, Movement.BEND): BEND_KNEE,
    Missing(Site.LEFT_FOOT, Movement.CIRCLE): CIRCLE_FOOT,
    Missing(Site.LEFT_FOOT, Movement.BEND): BEND_ANKLE,
}
Part = tuple[Motion, float]
Samples = dict[Site, OrientedSamples]


def ease(t: FloatArray, duration_s: float) -> FloatArray:
    rise, fall = np.clip(t / 0.5, 0.0, 1.0), np.clip((duration_s - t) / 0.5, 0.0, 1.0)
    return np.asarray(rise**2 * (3 - 2 * rise) * fall**2 * (3 - 2 * fall))


def angles_at(parts: Sequence[Part], t: FloatArray) -> dict[str, FloatArray]:
    """Radians (n,) of each angle; the knee hangs at 8 degrees."""
    angles = {name: np.full_like(t, 8.0 if name == "knee" else 0.0) for name in ANGLES}
    start_s = 0.0
    for motion, duration_s in parts:
        since = t - start_s
        for name, (sine, cosine, hz, constant) in motion.items():
            phase = 2 * np.pi * hz * since
            angles[name] += ease(since, duration_s) * (sine * np.sin(phase) + cosine * np.cos(phase) + constant)
        start_s += duration_s
    return {name: np.deg2rad(angle) for name, angle in angles.items()}


def poses_at(parts: Sequence[Part], t: FloatArray) -> dict[Site, tuple[Rotation, FloatArray]]:
    """Earth from segment, and the place of the segment's near joint (n, 3)."""
    about_x, about_y, about_z = np.eye(3)
    a = angles_at(parts, t)
    hip_m = np.outer(0.01 * np.sin(2 * np.pi * 0.4 * t), about_x)
    abducted = Rotation.from_rotvec(np.outer(a["abduction"], about_x))
    thigh = abducted * Rotation.from_rotvec(np.outer(-a["flexion"], about_y))
    thigh = thigh * Rotation.from_rotvec(np.outer(a["turn"], about_z))
    shank = thigh * Rotation.from_rotvec(np.outer(a["knee"], about_y))
    foot = shank * Rotation.from_rotvec(np.outer(-a["ankle"], about_y))
    foot = foot * Rotation.from_rotvec(np.outer(a["inversion"], about_x))
    knee_m = hip_m + thigh.apply([0.0, 0.0, -LENGTH_M])
    ankle_m = knee_m + shank.apply([0.0, 0.0, -LENGTH_M])
    return {Site.LEFT_THIGH: (thigh, hip_m), Site.LEFT_SHANK: (shank, knee_m), Site.LEFT_FOOT: (foot, ankle_m)}


def moved(*parts: Part, seed: int = 0, rate_hz: float = 100.0, late_s: float = 0.0) -> Samples:
    """Sensors of any mounting and heading, with noise and accelerometer bias; the distal ones late by `late_s`."""
    rng = np.random.default_rng(seed)
    stamp_s = np.arange(round(sum(duration_s for _, duration_s in parts) * rate_hz)) / rate_hz
    steps = (-2, -1, 0, 1, 2)
    clocks = {late: {k: poses_at(parts, stamp_s - late + k * DIFFERENCE_S) for k in steps} for late in {0.0, late_s}}
    samples = {}
    for site, place_m in SITES.items():
        mounting = Rotation.random(rng=rng)
        poses = clocks[0.0 if site is Site.LEFT_THIGH else late_s]
        turned = {k: poses[k][site][0] * mounting for k in steps}
        place = {k: poses[k][site][1] + poses[k][site][0].apply(place_m) for k in steps}
        rates = [(turned[-k].inv() * turned[k]).as_rotvec() / (2 * k * DIFFERENCE_S) for k in (1, 2)]
        accelerations = [(place[k] - 2 * place[0] + place[-k]) / (k * DIFFERENCE_S) ** 2 for k in (1, 2)]
        gyr = (4 * rates[0] - rates[1]) / 3 + 0.0012 * rng.normal(size=(len(stamp_s), 3))
        force = turned[0].inv().apply((4 * accelerations[0] - accelerations[1]) / 3 + [0.0, 0.0, 9.81])
        force += 0.03 * rng.normal(size=3) + 0.01 * rng.normal(size=(len(stamp_s), 3))
        heading = Rotation.from_rotvec([0.0, 0.0, rng.uniform(0.0, 6.0)])
        q = (heading * turned[0]).as_quat(scalar_first=True)
        q[1:] *= np.cumprod(np.where(np.sum(q[1:] * q[:-1], axis=1) < 0, -1.0, 1.0))[:, None]
        signals = np.concatenate([q, gyr, force], axis=1)
        samples[site] = OrientedSamples(np.arange(len(q)), stamp_s, signals, np.ones(len(q), dtype=np.bool_))
    return samples


def excited(joint: Joint, samples: Samples) -> ExcitationState:
    return Excitation(joint).update(samples[joint.proximal], samples[joint.distal])


def history(joint: Joint, samples: Samples) -> list[ExcitationState]:
    return list(Excitation(joint).states(samples[joint.proximal], samples[joint.distal]))


def wanting(joint: Joint, state: ExcitationState) -> float:
    """The gauge over what closes it."""
    axis = state.axis_sd_rad / HUMAN.axis_rad if joint.is_knee else 0.0
    return max(axis, state.centre_sd_m / HUMAN.centre_m)


@pytest.mark.parametrize("joint", [KNEE, ANKLE])
def test_an_all_round_motion_falls_steadily_and_closes(joint: Joint) -> None:
    states = history(joint, moved((STILL, 1.0), (ALL_AT_ONCE, 12.0)))
    gauge = np.array([wanting(joint, state) for state in states])
    each_second = gauge[19::10]
    assert np.all(each_second[1:] < 1.15 * each_second[:-1])
    assert gauge[-1] < 0.3 * gauge[19]
    assert states[-1].is_closed
    assert states[-1].missing is None
    assert not states[20].is_closed
    assert states[-1].sign_margin > 10.0


def test_the_floor_is_in_the_honest_figures_and_not_on_the_gauge() -> None:
    state = excited(KNEE, moved((STILL, 1.0), (ALL_AT_ONCE, 12.0)))
    assert state.axis_sd_rad < HUMAN.axis_floor_rad < state.axis_sd_with_floor_rad
    assert state.centre_sd_m < HUMAN.centre_floor_m < state.centre_sd_with_floor_m


@pytest.mark.parametrize("joint", [KNEE, ANKLE])
def test_who_holds_still_is_reported_nothing_but_to_move(joint: Joint) -> None:
    state = excited(joint, moved((STILL, 15.0)))
    assert state.moved_s == 0.0
    assert not state.is_closed
    assert not state.is_plateau
    assert state.missing == Missing(Site.LEFT_SHANK, Movement.CIRCLE)
    assert state.sign_margin == 1.0


LONG = pytest.mark.endurance


@pytest.mark.parametrize(
    ("joint", "before"),
    [
        pytest.param(KNEE, STILL, id="a knee held still", marks=LONG),
        pytest.param(KNEE, BEND_KNEE, id="a knee bent in one plane, the thigh still"),
        pytest.param(KNEE, CIRCLE_SHANK, id="a lower leg circling, the thigh in place", marks=LONG),
        pytest.param(KNEE, CIRCLE_THIGH, id="a stiff leg circling", marks=LONG),
        pytest.param(KNEE, SWING_STIFF_LEG, id="a stiff leg swinging in one plane"),
        pytest.param(ANKLE, STILL, id="an ankle held still", marks=LONG),
        pytest.param(ANKLE, BEND_ANKLE, id="a foot bending alone"),
        pytest.param(ANKLE, CIRCLE_FOOT, id="a foot circling alone", marks=LONG),
        pytest.param(ANKLE, CIRCLE_SHANK, id="a lower leg circling, the foot stiff", marks=LONG),
        pytest.param(ANKLE, BEND_KNEE, id="a lower leg swinging, the foot stiff", marks=LONG),
    ],
)
def test_the_motion_that_is_asked_for_is_the_one_that_shows_most(joint: Joint, before: Motion) -> None:
    so_far: tuple[Part, ...] = ((STILL, 1.0), (before, 6.0))
    asked = excited(joint, moved(*so_far, rate_hz=60.0)).missing
    left = {
        missing: wanting(joint, excited(joint, moved(*so_far, (motion, 5.0), rate_hz=60.0)))
        for missing, motion in ADDED.items()
        if missing.site in (joint.proximal, joint.distal)
        and not (missing.movement is Movement.BEND and missing.site is joint.proximal)
    }
    assert asked is not None
    assert left[asked] < 1.25 * min(left.values())  # where several are alike, any of them


def test_bending_a_knee_in_one_plane_for_long_is_a_plateau() -> None:
    states = history(KNEE, moved((STILL, 1.0), (BEND_KNEE, 17.0)))
    assert states[-1].is_plateau
    assert not states[-1].is_closed
    assert states[-1].trend < 0.1
    assert not any(state.is_plateau for state in states if state.moved_s < 10.0)


def test_a_plateau_ends_when_another_motion_brings_more() -> None:
    states = history(KNEE, moved((STILL, 1.0), (BEND_KNEE, 15.0), (ALL_AT_ONCE, 8.0)))
    assert any(state.is_plateau for state in states)
    assert not states[-1].is_plateau
    assert states[-1].is_closed


def test_a_prosthetic_joint_has_to_close_tighter_and_shows_nothing_along_its_axis() -> None:
    hinge = {name: value for name, value in ALL_AT_ONCE.items() if name != "inversion"}
    samples = moved((STILL, 1.0), (hinge, 12.0))
    one, two = samples[ANKLE.proximal], samples[ANKLE.distal]
    human, prosthetic = Excitation(ANKLE).update(one, two), Excitation(ANKLE, PROSTHESIS).update(one, two)
    assert prosthetic.centre_sd_m < PROSTHESIS.centre_m < 0.1 * human.centre_sd_m
    assert prosthetic.is_closed
    assert not human.is_closed


def test_what_turns_across_a_prosthetic_joint_is_its_floor() -> None:
    hinge = {name: value for name, value in ALL_AT_ONCE.items() if name != "inversion"}
    tight, loose = (moved((STILL, 1.0), (motion, 10.0)) for motion in (hinge, ALL_AT_ONCE))
    floors = [
        Excitation(ANKLE, PROSTHESIS).update(one[ANKLE.proximal], one[ANKLE.distal]).axis_sd_with_floor_rad
        for one in (tight, loose)
    ]
    assert floors[1] > 3 * floors[0]


def test_a_stiff_joint_states_nothing_of_its_axis() -> None:
    state = excited(KNEE, moved((STILL, 1.0), (CIRCLE_THIGH, 10.0)))
    assert np.rad2deg(state.axis_sd_rad) > 45.0
    assert state.centre_sd_m > 0.1


@pytest.mark.parametrize("size", [1, 7, 64])
def test_the_size_of_the_blocks_changes_nothing(size: int) -> None:
    samples = moved((STILL, 1.0), (ALL_AT_ONCE, 4.0))
    whole, pieces = Excitation(KNEE), Excitation(KNEE)
    one, two = samples[Site.LEFT_THIGH], samples[Site.LEFT_SHANK]
    at_once = whole.update(one, two)
    for k in range(0, len(one), size):
        pieces.update(one.part(slice(k, k + size)), two.part(slice(0, 0)))
        pieces.update(one.part(slice(0, 0)), two.part(slice(k, k + size)))
    assert pieces.state == at_once


def test_turned_sensors_are_as_good() -> None:
    motion = (STILL, 1.0), (ALL_AT_ONCE, 8.0)
    gauges = [wanting(KNEE, excited(KNEE, moved(*motion, seed=seed))) for seed in range(4)]
    assert max(gauges) < 1.3 * min(gauges)


def test_sensors_of_different_rates_go_together() -> None:
    motion = (STILL, 1.0), (ALL_AT_ONCE, 8.0)
    fast, slow = moved(*motion, rate_hz=200.0), moved(*motion, rate_hz=60.0)
    alike = wanting(KNEE, excited(KNEE, fast))
    mixed = wanting(KNEE, excited(KNEE, {**fast, Site.LEFT_SHANK: slow[Site.LEFT_SHANK]}))
    assert mixed == pytest.approx(alike, rel=0.3)


@pytest.mark.parametrize("late_s", [-0.03, 0.02])
def test_a_late_clock_is_among_the_unknowns(late_s: float) -> None:
    motion = (STILL, 1.0), (ALL_AT_ONCE, 10.0)
    on_time, late = excited(KNEE, moved(*motion)), excited(KNEE, moved(*motion, late_s=late_s))
    assert late.is_closed
    assert wanting(KNEE, late) < 1.5 * wanting(KNEE, on_time)


def test_a_gap_after_which_the_heading_starts_again_costs_little() -> None:
    samples = moved((STILL, 1.0), (ALL_AT_ONCE, 12.0))
    shank = samples[Site.LEFT_SHANK]
    turned = shank.signals.copy()
    after = Rotation.from_rotvec([0.0, 0.0, 2.0]) * Rotation.from_quat(turned[600:, :4], scalar_first=True)
    turned[600:, :4] = after.as_quat(scalar_first=True)
    broken = replace(shank, signals=turned)
    with_gap = Excitation(KNEE)
    for part in (slice(0, 580), slice(600, None)):
        with_gap.update(samples[Site.LEFT_THIGH].part(part), broken.part(part))
    assert with_gap.state.is_closed
    assert with_gap.state.sign_margin > 10.0


def test_a_sensor_that_was_silent_for_long_goes_on_with_another_heading() -> None:
    samples = moved((STILL, 1.0), (ALL_AT_ONCE, 29.0), rate_hz=60.0)
    thigh, shank = samples[Site.LEFT_THIGH], samples[Site.LEFT_SHANK]
    silent = slice(360, 1200)  # longer than samples wait
    turned = shank.signals.copy()
    after = Rotation.from_rotvec([0.0, 0.0, 2.0]) * Rotation.from_quat(turned[1200:, :4], scalar_first=True)
    turned[1200:, :4] = after.as_quat(scalar_first=True)
    broken = replace(shank, signals=turned)
    reported = Excitation(KNEE)
    for k in range(0, len(thigh), 6):
        is_there = not silent.start <= k < silent.stop
        reported.update(thigh.part(slice(k, k + 6)), broken.part(slice(k, k + 6 if is_there else k)))
        assert len(reported._collector._ends[0]._samples) < 620
    assert reported.state.is_closed
    assert reported.state.sign_margin > 10.0
    assert 14.0 < reported.state.moved_s < 16.0


def test_a_bridged_gap_is_not_used() -> None:
    samples = moved((STILL, 1.0), (ALL_AT_ONCE, 5.0))
    is_measured = np.ones(600, dtype=np.bool_)
    is_measured[300:310] = False
    bridged = {**samples, Site.LEFT_SHANK: replace(samples[Site.LEFT_SHANK], is_measured=is_measured)}
    lost_s = excited(KNEE, samples).moved_s - excited(KNEE, bridged).moved_s
    assert 0.1 <= lost_s <= 0.4


def test_the_sets_of_the_last_forty_seconds_count() -> None:
    samples = moved((ALL_AT_ONCE, 55.0), rate_hz=60.0)
    collected = Excitation(KNEE)
    state = collected.update(samples[Site.LEFT_THIGH], samples[Site.LEFT_SHANK])
    assert state.moved_s > 50.0
    assert state.centre_sd_m < 0.02
    assert len(collected._collector.sets) <= MAX_SETS


def test_matrices_are_those_of_the_quaternions() -> None:
    q = Rotation.random(20, rng=np.random.default_rng(0)).as_quat(scalar_first=True)
    assert matrices_of(1.1 * q) == pytest.approx(matrix_from_quaternion(q))


@pytest.mark.endurance
def test_nine_of_ten_calibrations_lie_within_twice_what_was_predicted() -> None:
    reported = [one for seed in range(36) for one in stopped_calibrations(seed)]
    for quantity in QUANTITIES:
        mine = [one for one in reported if one.quantity == quantity]
        assert len(mine) > 30
        assert np.mean([one.is_covered for one in mine]) >= 0.9
    # one of 36 does not: a knee's centre is 41 mm off where 39 were predicted
    assert np.mean([one.is_covered for one in reported if one.is_closed]) >= 0.95
    # the findings hardly ever take back what the gauge has stated: 2 of 120, ankles whose clocks lie apart
    assert np.mean([one.is_reported for one in reported if one.is_closed]) >= 0.95

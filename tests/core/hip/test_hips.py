"""Hips, pelvis and the clock of both legs, against a body whose truth is known."""

from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Side, Site, hip_of
from core.gait.clocks import ClockTie
from core.hip.measure import with_sd
from core.hip.results import ClockStatus
from core.results import RecordingAnalysis
from core.session import Recording, RecordingKind, Session
from core.verdicts.model import Verdict
from devices.simulation.walker import SimulatedSession, Standing, Tissue, Walk, simulate
from devices.simulation.walker_pelvis import pelvis_truth
from tests.core.hip.hip_sessions import abduction_error_deg, analysed, flexion_error_deg, settings, truth


@pytest.mark.parametrize("side", Side)
def test_a_rigid_hip_reads_what_its_bones_do(side: Side) -> None:
    made, analysis = analysed()
    walk, known = analysis.recordings[-1], truth(made, side)
    assert walk.hips[hip_of(side)].identification.is_3d
    assert np.sqrt(np.mean(flexion_error_deg(walk, known, side) ** 2)) < 0.4
    assert np.std(abduction_error_deg(walk, known, side)) < 0.6
    centre = walk.hips[hip_of(side)].identification
    assert np.linalg.norm(centre.centre_proximal_m - known.centre_proximal_m) < 0.01
    assert np.linalg.norm(centre.centre_distal_m - known.centre_distal_m) < 0.01


def test_flexion_is_less_sure_far_from_its_median_and_beyond_80_degrees_whatever_turns_it_counts() -> None:
    flexion_deg = np.array([10.0, 10.0, 10.0, 0.0, 79.0, 81.0, np.nan])
    for turns in (-1, 0, 2):
        found_rad, sd_rad = with_sd(np.deg2rad(flexion_deg + 360.0 * turns))
        np.testing.assert_allclose(np.rad2deg(found_rad), flexion_deg, atol=1e-9)
        np.testing.assert_allclose(np.rad2deg(sd_rad), [2.0, 2.0, 2.0, 3.0, 8.9, 13.1, np.nan], atol=1e-9)


@pytest.mark.endurance
def test_real_tissue_leaves_most_hips_within_three_degrees() -> None:
    errors_deg, held = [], []
    for seed in (2, 3, 5):
        made, analysis = analysed(seed=seed, tissue=Tissue.REAL)
        walk = analysis.recordings[-1]
        for side in Side:
            error = flexion_error_deg(walk, truth(made, side), side)
            hip = walk.hips[hip_of(side)]
            sd_deg = np.rad2deg(hip.sd_rad[np.isfinite(hip.angle_rad)])
            errors_deg.append(np.std(error))
            held.append(np.mean(np.abs(error - error.mean()) < 2 * sd_deg))
            assert walk.verdicts.joint(hip_of(side)).shape.is_reported
    assert np.median(errors_deg) < 3.0
    assert max(errors_deg) < 5.0
    assert np.mean(held) > 0.9


def test_one_clock_is_found_for_both_legs_and_used() -> None:
    made, analysis = analysed(late_s=0.04)
    _, on_time = analysed()
    walk, expected = analysis.recordings[-1], on_time.recordings[-1]
    assert walk.leg_clock is not None
    assert walk.leg_clock.status is ClockStatus.FOUND
    assert walk.leg_clock.offset_s == pytest.approx(0.04, abs=0.001)
    assert walk.clocks is not None
    assert walk.clocks.tie is ClockTie.PELVIS
    assert walk.verdicts.between.verdict is Verdict.READ
    for side in Side:
        steps = (np.nanmedian(one.gait[side].parameters["step_time_s"]) for one in (walk, expected))
        assert np.diff(list(steps)) == pytest.approx(0.0, abs=0.004)
        assert np.std(flexion_error_deg(walk, truth(made, side, late_s=0.04), side)) < 0.4
    knee = Joint.RIGHT_KNEE
    apart = walk.joints[knee].angle_rad - expected.joints[knee].angle_rad
    assert np.rad2deg(np.nanstd(apart[200:-200])) < 0.5


def test_clocks_that_are_reported_to_be_one_are_not_moved() -> None:
    _, analysis = analysed()
    clock = analysis.recordings[-1].leg_clock
    assert clock is not None
    assert clock.status is ClockStatus.PROVEN
    assert clock.applied_s == 0.0
    assert abs(clock.offset_s) < 0.001


@pytest.fixture(scope="module")
def short() -> tuple[SimulatedSession, RecordingAnalysis]:
    """A walk that is too short to show how far apart the clocks of both legs are."""
    made = simulate(replace(settings(late_s=0.04), recordings=(Standing(), Walk(strides=8))))
    return made, analyse(made.session).recordings[-1]


def test_a_short_walk_leaves_the_clocks_unknown(short: tuple[SimulatedSession, RecordingAnalysis]) -> None:
    _, walk = short
    assert walk.leg_clock is not None
    assert walk.leg_clock.status is ClockStatus.NOT_REPORTED
    assert walk.leg_clock.applied_s == 0.0
    assert walk.verdicts.between.verdict is Verdict.NOT_REPORTED


def test_where_clocks_are_unknown_each_hip_stays_on_its_own_leg_s(
    short: tuple[SimulatedSession, RecordingAnalysis],
) -> None:
    """As its knee and its strides do: on the other leg's it would be 40 ms beside them."""
    made, walk = short
    assert walk.hips[Joint.RIGHT_HIP].identification.lag_s == pytest.approx(-0.04, abs=0.002)
    late = truth(made, Side.RIGHT, late_s=0.04)
    own_clock = replace(late, time_s=late.time_s + 0.04)
    assert np.std(flexion_error_deg(walk, own_clock, Side.RIGHT)) < 0.4
    assert np.std(flexion_error_deg(walk, truth(made, Side.LEFT), Side.LEFT)) < 0.4


def test_the_pelvis_shows_its_obliquity_rotation_and_the_turn() -> None:
    made, analysis = analysed()
    walk = analysis.recordings[-1]
    pelvis, moved = walk.pelvis, made.moved[-1]
    assert pelvis is not None
    assert moved.pelvis is not None
    known = pelvis_truth(moved.pelvis, moved.clocks[Site.PELVIS])
    (turn,) = walk.turns
    assert np.rad2deg(turn.angle_rad) == pytest.approx(180.0, abs=10.0)
    straight = np.abs(walk.time_s - 0.5 * (turn.start_s + turn.end_s)) > 3.0
    error = np.rad2deg(pelvis.obliquity_rad - np.interp(walk.time_s, known.time_s, known.obliquity_rad))
    assert np.std(error[straight]) < 0.5
    for side in Side:
        strides = walk.gait[side].strides.is_used
        figures = {name: np.rad2deg(values[strides]) for name, values in walk.gait[side].parameters.items()}
        assert np.nanmedian(figures["pelvis_obliquity_range_rad"]) == pytest.approx(8.0, abs=0.5)
        assert np.nanmedian(figures["pelvis_rotation_range_rad"]) == pytest.approx(12.0, abs=1.0)
        assert np.nanmedian(figures["pelvis_drop_rad"]) == pytest.approx(4.0, abs=0.8)


@pytest.mark.endurance
def test_a_straight_walk_has_no_turn() -> None:
    required = replace(settings(), recordings=(Standing(), Walk(strides=8)))
    assert analyse(simulate(required).session).recordings[-1].turns == ()


def only(session: Session, *sites: Site) -> Session:
    recordings = [replace(one, imu={s: one.imu[s] for s in one.imu if s in sites}) for one in session.recordings]
    return replace(session, recordings=tuple(recordings))


def test_without_a_pelvis_nothing_is_reported_of_it() -> None:
    made, _ = analysed()
    walk = analyse(only(made.session, *(s for s in made.session.sensors if s is not Site.PELVIS))).recordings[-1]
    assert (walk.hips, walk.pelvis, walk.turns, walk.leg_clock) == ({}, None, (), None)
    assert walk.verdicts.pelvis.verdict is Verdict.NOT_MEASURED
    assert "hip_range_rad" not in walk.gait[Side.LEFT].parameters


@pytest.mark.endurance
def test_without_standing_there_is_no_hip() -> None:
    made, _ = analysed()
    moving = tuple(one for one in made.session.recordings if one.kind is not RecordingKind.STANDING)
    walk = analyse(replace(made.session, recordings=moving)).recordings[-1]
    assert walk.hips == {}


def swapped(recording: Recording, one: Site, other: Site) -> Recording:
    turned = {one: other, other: one}
    return replace(recording, imu={turned.get(site, site): block for site, block in recording.imu.items()})


@pytest.mark.endurance
def test_legs_that_are_swapped_are_reported_by_their_hips() -> None:
    made, _ = analysed()
    recordings = made.session.recordings
    for segment in ("thigh", "shank", "foot"):
        recordings = tuple(swapped(one, Site(f"left_{segment}"), Site(f"right_{segment}")) for one in recordings)
    walk = analyse(replace(made.session, recordings=recordings)).recordings[-1]
    for side in Side:
        shape = walk.verdicts.joint(hip_of(side)).shape
        assert shape.verdict is Verdict.NOT_REPORTED
        assert "hips_apart" in {reason.gate for reason in shape.reasons}


@pytest.mark.endurance
def test_a_sensor_that_is_not_on_the_pelvis_is_reported() -> None:
    made, _ = analysed()
    recordings = tuple(swapped(one, Site.PELVIS, Site.LEFT_FOOT) for one in made.session.recordings)
    walk = analyse(replace(made.session, recordings=recordings)).recordings[-1]
    for side in Side:
        if (hip := walk.hips.get(hip_of(side))) is not None:
            assert walk.verdicts.joint(hip_of(side)).shape.verdict is Verdict.NOT_REPORTED
            assert hip.identification.is_3d == np.isfinite(hip.abduction_rad).any()
    assert walk.leg_clock is None or walk.leg_clock.status is not ClockStatus.FOUND


@pytest.mark.endurance
def test_turning_the_pelvis_sensor_changes_no_angle() -> None:
    made, analysis = analysed()
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))

    def turned(recording: Recording) -> Recording:
        block = recording.imu[Site.PELVIS]
        block = replace(block, gyr_rad_s=block.gyr_rad_s @ turn.T, acc_m_s2=block.acc_m_s2 @ turn.T)
        return replace(recording, imu={**recording.imu, Site.PELVIS: block})

    again = analyse(replace(made.session, recordings=tuple(map(turned, made.session.recordings))))
    for joint, hip in analysis.recordings[-1].hips.items():
        apart = np.rad2deg(again.recordings[-1].hips[joint].angle_rad - hip.angle_rad)
        assert np.nanmax(np.abs(apart)) < 0.2

"""Does the comparison score what it says it scores?"""

from dataclasses import replace

import numpy as np
import pytest

from core.samples import FloatArray
from tests.benchmarks.peers import vqf_angle
from tests.benchmarks.scoring import Estimate, Score, score
from tests.benchmarks.speed import Contender, Outcome, accuracy_table, compete, speed_table
from tests.benchmarks.trials import Trial, Truth, simulated_trials

STANDING_RAD = np.deg2rad(5.0)
TIME_S = np.arange(2000) / 100.0
TRUTH = Truth(
    axis_1=np.array([0.0, 1.0, 0.0]),
    axis_2=np.array([1.0, 0.0, 0.0]),
    time_s=TIME_S,
    angle_rad=0.5 + 0.4 * np.sin(6.0 * TIME_S),
    standing_rad=STANDING_RAD,
    is_clock_shared=True,
)
PERFECT = Estimate(TRUTH.axis_1, TRUTH.axis_2, TIME_S, TRUTH.angle_rad - STANDING_RAD, cpu_s=1.0)


def tilted(axis: FloatArray, degrees: float) -> FloatArray:
    return np.cos(np.deg2rad(degrees)) * axis + np.sin(np.deg2rad(degrees)) * np.array([0.0, 0.0, 1.0])


def test_a_perfect_estimate_has_no_error() -> None:
    found = score(PERFECT, TRUTH)
    assert found.is_paired
    assert [found.axis_1_deg, found.axis_2_deg, found.m_deg, found.z_deg] == pytest.approx([0, 0, 0, 0], abs=1e-9)


def test_each_axis_is_scored_for_itself_whichever_way_it_points() -> None:
    found = score(replace(PERFECT, axis_1=tilted(TRUTH.axis_1, 3.0), axis_2=-tilted(TRUTH.axis_2, 7.0)), TRUTH)
    assert [found.axis_1_deg, found.axis_2_deg] == pytest.approx([3.0, 7.0])
    assert not found.is_paired


def test_the_common_sign_of_axes_and_angle_is_free() -> None:
    turned = Estimate(-PERFECT.axis_1, -PERFECT.axis_2, TIME_S, -PERFECT.angle_rad, cpu_s=1.0)
    assert score(turned, TRUTH) == score(PERFECT, TRUTH)


def test_an_angle_of_the_wrong_sign_is_wrong() -> None:
    found = score(replace(PERFECT, angle_rad=-PERFECT.angle_rad), TRUTH)
    assert found.m_deg == pytest.approx(2 * np.rad2deg(0.4) / np.sqrt(2), rel=0.02)


def test_a_constant_offset_counts_in_z_and_not_in_m() -> None:
    found = score(replace(PERFECT, angle_rad=PERFECT.angle_rad + np.deg2rad(2.0)), TRUTH)
    assert found.m_deg == pytest.approx(0.0, abs=1e-9)
    assert found.z_deg == pytest.approx(2.0)


def test_whole_turns_do_not_count() -> None:
    slips = 2 * np.pi * np.floor(TIME_S / 4.0)
    found = score(replace(PERFECT, angle_rad=PERFECT.angle_rad + slips), TRUTH)
    assert [found.m_deg, found.z_deg] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_the_time_in_which_filters_settle_is_not_scored() -> None:
    unsettled = np.where(TIME_S < 2.9, 1.0, 0.0)
    assert score(replace(PERFECT, angle_rad=PERFECT.angle_rad + unsettled), TRUTH).m_deg == pytest.approx(0.0, abs=1e-9)


def test_only_another_systems_clock_is_fitted() -> None:
    late = 0.5 + 0.4 * np.sin(6.0 * (TIME_S - 0.012)) - STANDING_RAD
    assert score(replace(PERFECT, angle_rad=late), TRUTH).m_deg > 1.0
    assert score(replace(PERFECT, angle_rad=late), replace(TRUTH, is_clock_shared=False)).m_deg < 0.05


def test_where_the_reference_was_not_seen_nothing_is_scored() -> None:
    hidden = np.where((TIME_S > 8.0) & (TIME_S < 9.0), np.nan, TRUTH.angle_rad)
    wrong_there = PERFECT.angle_rad + np.where((TIME_S > 8.0) & (TIME_S < 9.0), 1.0, 0.0)
    found = score(replace(PERFECT, angle_rad=wrong_there), replace(TRUTH, angle_rad=hidden))
    assert found.m_deg == pytest.approx(0.0, abs=1e-9)


def test_a_method_without_an_angle_has_no_error_of_it() -> None:
    found = score(replace(PERFECT, time_s=np.empty(0), angle_rad=np.empty(0)), TRUTH)
    assert np.isnan([found.m_deg, found.z_deg]).all()


def test_the_fitted_heading_lays_one_axis_on_the_other() -> None:
    drifting = np.deg2rad(20.0) + np.deg2rad(0.5) * TIME_S
    one = np.tile([0.6, 0.8, 0.0], (len(TIME_S), 1))
    turned = (0.6 + 0.8j) * np.exp(-1j * drifting)
    two = np.stack([turned.real, turned.imag, np.zeros_like(drifting)], axis=1)
    inside = (TIME_S > 5.0) & (TIME_S < 15.0)  # between the middles of two windows of ten seconds
    found = vqf_angle.fitted_heading(one, two, 0.01)
    assert found[inside] == pytest.approx(drifting[inside], abs=np.deg2rad(0.05))


@pytest.fixture(scope="module")
def knee() -> Trial:
    return next(trial for trial in simulated_trials(range(1), minutes=0.25) if trial.group == "walking, rigid")


def test_vqf_with_the_true_axes_gives_the_true_knee(knee: Trial) -> None:
    for run, limit_deg in ((vqf_angle.offline, 0.5), (vqf_angle.online, 1.5)):
        angle = vqf_angle.angle(knee, run, knee.truth.axis_1, knee.truth.axis_2)
        time_s = knee.step_s * np.arange(len(angle))
        found = score(Estimate(knee.truth.axis_1, knee.truth.axis_2, time_s, angle, 0.0), knee.truth)
        assert found.z_deg < limit_deg


def test_every_method_meets_every_recording_and_ratios_are_taken_turn_by_turn(knee: Trial) -> None:
    def costing(*cpu_s: float) -> Contender:
        costs = iter(cpu_s)
        return Contender(lambda trial: replace(PERFECT, cpu_s=next(costs)))

    methods = {"slow": costing(1.0, 8.0, 3.0), "fast": costing(0.5, 2.0, 1.0)}
    outcomes = compete([knee], methods, repeats=3)
    assert outcomes["slow"][0].cpu_s.tolist() == [1.0, 8.0, 3.0]
    named = {"Gaitwright robust, whole analysis": outcomes["fast"], "slow": outcomes["slow"]}
    rows = list(accuracy_table([knee], named, {"slow": methods["slow"]}))
    assert "| walking, rigid (1) | knee | slow | 3000.0 | 3.00 |" in rows[-1]


def test_a_further_minute_is_what_the_longer_recording_costs_more() -> None:
    def of(*cpu_s: float) -> list[Outcome]:
        return [Outcome(np.array(cpu_s), Score(0.0, 0.0, True, 0.0, 0.0))]

    names = ("Gaitwright robust, whole analysis", "Gaitwright as published, its stages")
    rows = list(speed_table({n: of(0.1) for n in names}, {n: of(0.1) for n in names}, {n: of(0.2) for n in names}))
    assert rows[-1] == f"| {names[1]} | 100.0 | 1.00 | 1.00 | 20.0 |"

"""Tests that the comparison scores what it states it scores."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.samples import FloatArray
from tests.benchmarks.foot_scoring import (
    FoundEvents,
    FoundStrides,
    OpticalFoot,
    OpticalStride,
    Stretch,
    StrideScore,
    score_events,
    score_strides,
)
from tests.benchmarks.gait import gaitmap_costs
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
    pytest.importorskip("vqf", reason="it has no wheel here")
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


STRIDE_S = 1.2  # standing 0.5, toe-off, swing 0.4, contact, standing 0.3


def pitched(time_s: FloatArray, share: float = 1.0) -> Rotation:
    """A foot that turns about its y axis, once up and down in every stride."""
    angle_rad = share * 0.8 * (1.0 - np.cos(2 * np.pi * time_s / STRIDE_S))
    return Rotation.from_rotvec(angle_rad[:, None] * [0.0, 1.0, 0.0])


def optical_stride(start_s: float, swing_s: float = 0.4) -> OpticalStride:
    time_s = start_s + np.arange(0.0, STRIDE_S, 0.01)
    contact_s = start_s + 0.9
    return OpticalStride(
        start_s, start_s + STRIDE_S, contact_s, contact_s - swing_s, 1.3, Stretch(time_s, pitched(time_s))
    )


STARTS_S = STRIDE_S * np.arange(1, 6)
HEEL_S = np.arange(0.0, 12.0, 0.01)  # the heel travels 1.3 m in each swing, and rests from 7.2 s on
SWINGS = np.interp(HEEL_S % STRIDE_S, [0.5, 0.9], [0.0, 1.0]) + HEEL_S // STRIDE_S
WALKED = OpticalFoot(
    strides=[optical_stride(start_s) for start_s in STARTS_S.tolist()],
    time_s=HEEL_S,
    heel_m=np.stack([1.3 * np.minimum(SWINGS, 6.0), np.zeros_like(HEEL_S)], axis=1),
)
SEEN = FoundEvents(toe_off_s=STARTS_S + 0.5, initial_contact_s=STARTS_S + 0.9)


def measured(error_m: float = 0.0, share: float = 1.0, late_s: float = 0.0, until_s: float = 12.0) -> StrideScore:
    time_s = np.arange(0.0, until_s, 0.005)
    stretch = Stretch(time_s, Rotation.from_euler("x", 0.3) * pitched(time_s - late_s, share))
    return score_strides(FoundStrides(SEEN.initial_contact_s, np.full(5, 1.3 + error_m), (stretch,)), WALKED)


def test_events_found_have_no_error_and_none_is_invented() -> None:
    found = score_events(SEEN, WALKED)
    assert found.contact_s == pytest.approx(np.zeros(5))
    assert found.off_s == pytest.approx(np.zeros(5))
    assert [found.more, found.invented] == [0, 0]


def test_who_calls_an_event_later_loses_none() -> None:
    wavering_s = 0.14 + 0.03 * np.array([-1.0, 1.0, 0.0, 1.0, -1.0])
    found = score_events(replace(SEEN, initial_contact_s=SEEN.initial_contact_s + wavering_s), WALKED)
    assert found.contact_s == pytest.approx(wavering_s)


def test_an_event_elsewhere_is_missed_and_another_one_found() -> None:
    elsewhere_s = SEEN.initial_contact_s + np.array([0.0, 0.0, 0.2, 0.0, 0.0])
    found = score_events(replace(SEEN, initial_contact_s=elsewhere_s), WALKED)
    assert found.is_found.tolist() == [True, True, False, True, True]
    assert [found.more, found.invented] == [1, 0]


def test_a_swing_beside_the_list_is_invented_if_the_heel_did_not_travel_or_it_was_found_before() -> None:
    def with_swing(off_s: float, contact_s: float) -> list[int]:
        events = FoundEvents(np.append(SEEN.toe_off_s, off_s), np.append(SEEN.initial_contact_s, contact_s))
        found = score_events(events, WALKED)
        assert found.is_found.all()
        return [found.more, found.invented]

    assert with_swing(0.5, 0.9) == [1, 0]  # made before the first stride of the list
    assert with_swing(8.0, 8.4) == [1, 1]
    assert with_swing(STARTS_S[2] + 0.6, STARTS_S[2] + 1.1) == [1, 1]


def test_no_events_at_all_are_all_missed() -> None:
    found = score_events(FoundEvents(np.empty(0), np.empty(0)), WALKED)
    assert not found.is_found.any()
    assert [found.more, found.invented] == [0, 0]


def test_a_length_is_scored_by_its_error_but_not_where_optics_run_two_swings_together() -> None:
    assert measured(error_m=0.02).error_m == pytest.approx(np.full(5, 0.02))
    strides = [*WALKED.strides[:4], optical_stride(float(STARTS_S[4]), swing_s=1.5)]
    found = FoundStrides(SEEN.initial_contact_s, np.full(5, 1.3), ())
    assert score_strides(found, replace(WALKED, strides=strides)).has_length.tolist() == [True] * 4 + [False]


def test_pitch_is_scored_in_any_mounting_and_on_any_clock() -> None:
    everywhere = np.ones(5, dtype=bool)
    assert measured().pooled_pitch_rad(everywhere) == pytest.approx((0.0, 0.0), abs=1e-4)
    assert measured(late_s=0.005).pooled_pitch_rad(everywhere) == pytest.approx((0.0, -0.005), abs=1e-4)
    small, _ = measured(share=0.9).pooled_pitch_rad(everywhere)
    assert small == pytest.approx(0.1 * 0.8 / np.sqrt(2), rel=0.02)


def test_a_stride_whose_orientation_is_not_known_has_no_pitch() -> None:
    found = measured(until_s=float(STARTS_S[4]) + 0.3)
    assert found.has_pitch.tolist() == [True] * 4 + [False]
    assert found.has_length.all()


def test_gaitmaps_wholes_are_the_sums_of_their_stages() -> None:
    stages = {"gravity": 100.0, "heading": 200.0, "heading|body": 1.0, "heading|BarthDtw": 2.0}
    stages |= {"heading|ConstrainedBarthDtw": 7.0, "heading|BarthDtw|Rampp": 4.0, "heading|BarthDtw|Herzer": 5.0}
    for name in ("stride, gyroscope", "stride, Madgwick", "stride, RtsKalman", "region, RtsKalman"):
        stages |= {f"heading|BarthDtw|{name}": 8.0, f"heading|BarthDtw|{name}|parameters": 16.0}
    costs = gaitmap_costs(stages)
    assert costs["gaitmap, BarthDtw, Rampp, no trajectory"] == 7.0
    assert costs["gaitmap, BarthDtw, Rampp, in one piece, RtsKalman"] == 31.0
    assert costs["gaitmap, alignment to gravity and heading"] == 300.0

"""Tests that strides show how a patient walks. Each that does not is left out with its reason."""

from dataclasses import replace

import numpy as np
import pytest

from core.gait.events import FootEvents
from core.gait.phases import PHASES, Phase, phases_at
from core.gait.spatiotemporal import both_feet, mean_and_sd, parameters_of
from core.gait.strides import Reason, Strides, strides_of
from core.samples import FloatArray

STRIDE_S, SWING_S = 1.1, 0.42


def events_at(contact: FloatArray, length_m: FloatArray) -> FootEvents:
    """The events of a foot that makes contact at these instants, s."""
    contacts = len(contact)
    return FootEvents(
        heel_rise_s=contact - 0.7,
        toe_off_s=contact - SWING_S,
        initial_contact_s=contact,
        full_contact_s=contact + 0.1,
        length_m=length_m,
        height_m=np.full(contacts, 0.1),
        climb_m=np.zeros(contacts),
        turn_rad=np.zeros(contacts),
        is_certain=np.ones(contacts, dtype=bool),
        is_measured=np.ones(contacts, dtype=bool),
        source=np.ones((contacts, 4), dtype=np.int64),
        sd_s=np.full((contacts, 4), 0.01),
    )


def feet_events(contacts: int = 12, first_s: float = 1.0, length_m: float = 1.3) -> FootEvents:
    return events_at(first_s + STRIDE_S * np.arange(contacts), np.full(contacts, length_m))


def later(events: FootEvents, from_row: int, by_s: float) -> FootEvents:
    """The same walk with every event of the rows from `from_row` on later."""
    shift = np.where(np.arange(len(events)) >= from_row, by_s, 0.0)
    return replace(
        events,
        heel_rise_s=events.heel_rise_s + shift,
        toe_off_s=events.toe_off_s + shift,
        initial_contact_s=events.initial_contact_s + shift,
        full_contact_s=events.full_contact_s + shift,
    )


def reasons(strides: Strides) -> dict[int, Reason]:
    return {k: reason for k, reason in enumerate(strides.reason) if reason is not Reason.USED}


def test_even_strides_are_all_used() -> None:
    strides = strides_of([feet_events()])
    assert len(strides) == 11
    assert strides.is_used.all()
    np.testing.assert_allclose(strides.time_s, STRIDE_S)
    np.testing.assert_allclose(strides.stance_percent, 100.0 * (STRIDE_S - SWING_S) / STRIDE_S)
    np.testing.assert_allclose(strides.speed_m_s, 1.3 / STRIDE_S)


def test_no_events_are_no_strides() -> None:
    assert len(strides_of([])) == 0
    assert len(strides_of([feet_events(contacts=1)])) == 0
    assert np.isnan(both_feet(strides_of([]), strides_of([])).cadence_steps_min)


def with_rows(**rows: dict[int, float]) -> FootEvents:
    """The walk with some rows of some columns changed, the last one's number being -1."""
    events = feet_events()
    columns = {name: getattr(events, name).copy() for name in rows}
    for name, values in rows.items():
        columns[name][list(values)] = list(values.values())
    return replace(events, **columns)


LEFT_OUT = {
    "a turn and doubtful events drop their strides only": (
        with_rows(turn_rad={4: np.deg2rad(-35.0)}, is_certain={8: False}),
        {3: Reason.TURN, 7: Reason.DOUBT, 8: Reason.DOUBT},
    ),
    "missing samples drop the strides they touch": (
        with_rows(is_measured={5: False}),
        {4: Reason.GAP, 5: Reason.GAP},
    ),
    "the first and last strides where they are slower": (
        with_rows(length_m={1: 0.9, -1: 0.7}),
        {0: Reason.START, 10: Reason.STOP},
    ),
    "a last step that hardly rolls is a stop and no doubt": (
        with_rows(length_m={-1: 0.7}, is_certain={-1: False, 5: False}),
        {4: Reason.DOUBT, 5: Reason.DOUBT, 10: Reason.STOP},
    ),
    "a stride unlike the others is an outlier": (with_rows(length_m={6: 1.8}), {5: Reason.OUTLIER}),
}


@pytest.mark.parametrize("case", LEFT_OUT)
def test_a_stride_that_shows_no_walking_is_left_out_with_its_reason(case: str) -> None:
    events, expected = LEFT_OUT[case]
    assert reasons(strides_of([events])) == expected


def test_standing_ends_a_bout_and_a_short_pause_is_a_pause() -> None:
    stood = strides_of([later(feet_events(), 6, 5.0)])
    assert len(stood) == 10
    assert stood.bout.tolist() == [0] * 5 + [1] * 5
    assert reasons(strides_of([later(feet_events(), 6, 0.8)])) == {5: Reason.PAUSE}


def test_an_unknown_heel_rise_costs_its_phases_and_no_stride() -> None:
    reported = with_rows(heel_rise_s={4: np.nan}, full_contact_s={6: np.nan})
    strides = strides_of([reported])
    assert strides.is_used.all()
    assert np.flatnonzero(np.isnan(strides.heel_rise_s)).tolist() == [3]
    assert np.flatnonzero(np.isnan(strides.full_contact_s)).tolist() == [6]
    values = parameters_of(strides, None)
    assert mean_and_sd(values["stance_percent"]).n == mean_and_sd(values["stride_time_s"]).n == len(strides)
    # in the stride without heel rise: loading, then unknown until swing; in that without full contact: unknown first
    at_s = reported.initial_contact_s[[3, 3, 3, 6, 6, 6]] + [0.05, 0.3, 0.8, 0.05, 0.5, 0.8]
    expected = [Phase.LOADING, Phase.UNKNOWN, Phase.SWING, Phase.UNKNOWN, Phase.PRE_SWING, Phase.SWING]
    assert [PHASES[k] for k in phases_at(at_s, [reported])] == expected


def test_strides_do_not_reach_over_a_gap_between_stretches() -> None:
    strides = strides_of([feet_events(4), feet_events(4, first_s=1.0 + 4 * STRIDE_S)])
    assert len(strides) == 6
    assert strides.bout.tolist() == [0, 0, 0, 1, 1, 1]


def test_times_of_both_feet() -> None:
    left, right = strides_of([feet_events()]), strides_of([feet_events(first_s=1.0 + 0.5)])
    both = both_feet(left, right)
    assert both.cadence_steps_min == pytest.approx(120.0 / STRIDE_S)
    assert both.speed_m_s == pytest.approx(1.3 / STRIDE_S)
    assert both.double_support_percent == pytest.approx(100.0 * (STRIDE_S - 2 * SWING_S) / STRIDE_S)
    # the left foot's step follows the right contact by 0.6 s, the right one's follows the left by 0.5 s
    np.testing.assert_allclose(parameters_of(left, right)["step_time_s"], 0.6)
    np.testing.assert_allclose(parameters_of(right, left)["step_time_s"], 0.5)


def test_a_side_without_distances_costs_no_speed() -> None:
    left, shank = strides_of([feet_events()]), strides_of([replace(feet_events(), length_m=np.full(12, np.nan))])
    assert both_feet(left, shank).speed_m_s == pytest.approx(1.3 / STRIDE_S)
    assert np.isnan(both_feet(shank, shank).speed_m_s)


def test_a_step_needs_the_other_foot() -> None:
    assert np.isnan(parameters_of(strides_of([feet_events()]), None)["step_time_s"]).all()


def test_mean_and_sd_leave_out_what_is_not_known() -> None:
    reported = mean_and_sd(np.array([1.0, np.nan, 3.0]))
    assert (reported.mean, reported.n) == (2.0, 2)
    assert reported.sd == pytest.approx(np.sqrt(2.0))
    assert np.isnan(mean_and_sd(np.array([1.0])).sd)


def test_phases_follow_each_other() -> None:
    events = feet_events(contacts=2)
    rise, off, on, full = (
        float(v[1]) for v in (events.heel_rise_s, events.toe_off_s, events.initial_contact_s, events.full_contact_s)
    )
    asked = np.array([rise - 0.01, rise + 0.01, off + 0.01, on + 0.01, full + 0.01])
    named = [PHASES[k] for k in phases_at(asked, [events])]
    assert named == [Phase.FOOT_FLAT, Phase.PRE_SWING, Phase.SWING, Phase.LOADING, Phase.UNKNOWN]
    assert PHASES[phases_at(np.array([0.0]), [events])[0]] is Phase.UNKNOWN

"""Tests that events and strides are paired with the reference's own, whatever its definitions and its clock."""

import numpy as np
import pytest

from core.agreement.events import compare_events, compare_lengths, event_offset, joined
from core.body import Side
from core.gait.strides import Reason, Strides
from core.samples import FloatArray

CONTACT, OFF = (Side.LEFT, "initial_contact"), (Side.LEFT, "toe_off")
TRUE_S = np.array([1.0, 2.1, 3.3, 4.4, 5.4, 6.6])


def test_lateness_bias_and_sd_are_those_of_the_pairs() -> None:
    late = np.array([0.030, 0.020, 0.035, 0.025, 0.030, 0.040])
    found = compare_events({CONTACT: TRUE_S + late}, {CONTACT: TRUE_S})[CONTACT]
    assert (found.count, found.found, found.more) == (6, 6, 0)
    assert found.bias_s == pytest.approx(late.sum() / 6)
    assert found.sd_s == pytest.approx(np.sqrt(((late - late.mean()) ** 2).sum() / 5))


def test_a_missed_event_is_counted_and_so_is_one_that_the_reference_has_not() -> None:
    seen = np.sort(np.append(np.delete(TRUE_S, 2), [4.0, 9.0]))  # 9 s is after the reference's end
    found = compare_events({CONTACT: seen}, {CONTACT: TRUE_S, OFF: TRUE_S})
    assert (found[CONTACT].found, found[CONTACT].more) == (5, 1)
    assert np.isnan(found[CONTACT].late_s[2])
    assert (found[OFF].found, found[OFF].count, found[OFF].more) == (0, 6, 0)
    assert np.isnan(found[OFF].bias_s)


def test_one_event_is_never_found_for_two() -> None:
    found = compare_events({CONTACT: np.array([1.05])}, {CONTACT: np.array([1.0, 1.1])})[CONTACT]
    assert found.found == 1


def test_another_definition_that_is_always_early_loses_none() -> None:
    found = compare_events({CONTACT: TRUE_S - 0.12}, {CONTACT: TRUE_S})[CONTACT]
    assert found.found == 6
    assert found.bias_s == pytest.approx(-0.12)
    assert found.sd_s == pytest.approx(0.0, abs=1e-12)


def test_the_clock_of_events_is_found_and_a_shared_one_stays() -> None:
    found = {CONTACT: TRUE_S, OFF: TRUE_S[:-1] + 0.7}
    late = {key: time_s + 0.02 for key, time_s in found.items()}
    assert event_offset(found, late) == 0.0
    away = {key: time_s + 123.45 for key, time_s in found.items()}
    assert event_offset(found, away) == pytest.approx(123.45, abs=0.03)
    regular = np.arange(1.0, 11.0)  # a treadmill: a stride later it fits all but one
    assert event_offset({CONTACT: regular}, {CONTACT: regular}) == 0.0
    assert event_offset({CONTACT: TRUE_S}, {OFF: TRUE_S}) == 0.0


def test_feet_are_taken_together() -> None:
    one = compare_events({CONTACT: TRUE_S + 0.01}, {CONTACT: TRUE_S})[CONTACT]
    other = compare_events({CONTACT: np.append(TRUE_S[:4] + 0.03, 6.0)}, {CONTACT: TRUE_S})[CONTACT]
    both = joined([one, other])
    assert (both.count, both.found, both.more) == (12, 10, 1)
    assert both.bias_s == pytest.approx((6 * 0.01 + 4 * 0.03) / 10)


def strides(length_m: FloatArray, reasons: list[Reason]) -> Strides:
    start = np.arange(len(length_m)) * 1.1
    nothing = np.full(len(length_m), np.nan)
    bout = np.zeros(len(length_m), dtype=np.int64)
    return Strides(
        *(start, start + 0.1, start + 0.5, start + 0.7, start + 1.1, length_m),
        *(nothing, nothing, nothing, bout, tuple(reasons)),
    )


@pytest.mark.parametrize("shift_s", [0.0, 0.35])
def test_strides_are_paired_by_their_swing_however_the_reference_counts_them(shift_s: float) -> None:
    measured = strides(np.array([1.2, 1.3, np.nan, 1.5]), [Reason.USED, Reason.TURN, Reason.USED, Reason.USED])
    start = np.arange(4) * 1.1 + shift_s
    reference = np.stack([start, start + 1.1, np.array([1.1, 1.2, 1.3, 1.4])], axis=1)
    np.testing.assert_allclose(compare_lengths(measured, reference), [[1.2, 1.1], [1.5, 1.4]])


def test_no_stride_of_the_reference_is_no_pair() -> None:
    assert compare_lengths(strides(np.array([1.2]), [Reason.USED]), np.empty((0, 3))).shape == (0, 2)

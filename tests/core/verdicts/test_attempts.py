"""Of timed tests speed alone is judged between visits, by 0.18 m/s; everything else is reported and not judged."""

import math

import pytest

from core.timed.measures import COLUMNS, MeanOfAttempts
from core.timed.protocols import TimedProtocol
from core.verdicts.attempts import compare_attempts, error_between_visits
from core.verdicts.measurement_error import Difference, Judgement, Mark
from core.verdicts.model import READ, Assessment, Verdict

SPEED = COLUMNS[TimedProtocol.TEN_METRES]


def compared(
    one: float, other: float, column: str = SPEED, stated: Assessment = READ, *, is_chosen_before: bool = False
) -> Difference:
    means = MeanOfAttempts(one, 1), MeanOfAttempts(other, 2)
    return compare_attempts(column, *means, (READ, stated), is_chosen_before=is_chosen_before)


def test_speed_is_judged_by_the_figure_between_visits() -> None:
    """1.96 x sqrt(2) x 0.065 = 0.18017."""
    assert error_between_visits(SPEED) == pytest.approx(0.18017, abs=1e-5)
    more, less = compared(1.0, 0.81), compared(1.0, 0.83)
    assert (more.judgement, less.judgement) == (Judgement.EXCEEDS_ERROR, Judgement.INSIDE_ERROR)
    assert (more.mark, less.mark) == (Mark.ERROR, Mark.NONE)
    assert more.difference == pytest.approx(0.19)
    assert not more.is_unverified  # people who came twice gave it


def test_a_sentence_needs_three_tenths_more_but_for_what_was_chosen_before() -> None:
    """1.3 x 0.18017 = 0.23422."""
    assert not compared(1.0, 0.77).is_worth_a_sentence
    assert compared(1.0, 0.76).is_worth_a_sentence
    assert compared(1.0, 0.81, is_chosen_before=True).is_worth_a_sentence
    assert not compared(1.0, 0.85, is_chosen_before=True).is_worth_a_sentence


@pytest.mark.parametrize("protocol", [one for one in COLUMNS if one is not TimedProtocol.TEN_METRES])
def test_distances_and_times_from_a_chair_are_reported_and_not_judged(protocol: TimedProtocol) -> None:
    found = compared(30.0, 10.0, COLUMNS[protocol])
    assert (found.difference, found.judgement) == (20.0, Judgement.NO_PUBLISHED_FIGURE)
    assert not math.isfinite(found.error)
    assert not found.is_worth_a_sentence


def test_what_is_not_reported_or_was_not_measured_has_no_difference() -> None:
    for found in (compared(1.0, 0.5, stated=Assessment(Verdict.NOT_REPORTED)), compared(1.0, math.nan)):
        assert found.judgement is Judgement.NOT_REPORTED
        assert not found.is_reported

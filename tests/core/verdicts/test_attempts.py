"""Of timed tests speed alone is judged between visits, by 0.20 m/s; everything else is reported and not judged."""

import math

import pytest

from core.timed.measures import COLUMNS, MeanOfAttempts
from core.timed.protocols import TimedProtocol
from core.verdicts.attempts import compare_attempts, error_between_visits
from core.verdicts.measurement_error import Difference, Judgement
from core.verdicts.model import READ, Assessment, Verdict

SPEED = COLUMNS[TimedProtocol.TEN_METRES]


def compared(
    one: float, other: float, column: str = SPEED, stated: Assessment = READ, *, is_chosen_before: bool = False
) -> Difference:
    means = MeanOfAttempts(one, 1), MeanOfAttempts(other, 2)
    return compare_attempts(column, *means, (READ, stated), is_chosen_before=is_chosen_before)


def test_speed_is_judged_by_the_figure_between_visits_and_prints_its_dagger() -> None:
    assert error_between_visits(SPEED) == pytest.approx(0.20)
    more, less = compared(1.0, 0.79), compared(1.0, 0.81)
    assert (more.judgement, less.judgement) == (Judgement.EXCEEDS_ERROR, Judgement.INSIDE_ERROR)
    assert more.difference == pytest.approx(0.21)
    assert more.is_unverified


def test_a_sentence_needs_half_as_much_again_but_for_what_was_chosen_before() -> None:
    assert not compared(1.0, 0.75).is_worth_a_sentence
    assert compared(1.0, 0.69).is_worth_a_sentence
    assert compared(1.0, 0.75, is_chosen_before=True).is_worth_a_sentence
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

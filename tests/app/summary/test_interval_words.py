"""What is stated beside a difference: each word has a difference for which it must come, and one for which it must not.

Figures by hand: an error is 1.96 sqrt(2) sigma, as nothing but attachment lies between two means that are sure.
"""

import math
from dataclasses import replace

import pytest

from app.summary.interval_words import (
    evidence,
    healthy_sentence,
    interval_in_figures,
    interval_words,
    may_be_error_sentence,
    speed_sentence,
)
from app.summary.numbers_in_words import MARKS, in_brief, in_words, judged_in_words
from core.parameters import KNEE, SPEED, STANCE, STRIDE_LENGTH
from core.verdicts.measurement_error import Difference, Judgement, Mark, SpeedPart

BEYOND, INSIDE = Judgement.EXCEEDS_ERROR, Judgement.INSIDE_ERROR


def plain(words: str) -> str:
    return words.replace("\N{NO-BREAK SPACE}", " ").replace("\N{MINUS SIGN}", "-")


@pytest.mark.parametrize(
    ("column", "difference", "error", "stated"),
    [
        ("foot_pitch_at_contact_deg", -9.0, 6.0, "likely between 3° and 15°"),
        ("foot_pitch_at_contact_deg", 9.0, 6.0, "likely between 3° and 15°"),
        (STANCE, -4.1, 3.2, "likely between 0.9 and 7.3 % of the gait cycle"),
        (SPEED, 0.41, 0.18, "likely between 0.23 and 0.59 m/s"),
        (KNEE, 6.9, 6.6, "likely between 0.3° and 13.5°"),  # of whole degrees the first were 0
        (KNEE, 1.9, 0.3, "likely between 1.6° and 2.2°"),  # both were 2
    ],
)
def test_beyond_its_error_a_difference_has_an_interval_by_size(
    column: str, difference: float, error: float, stated: str
) -> None:
    assert plain(interval_words(column, Difference(difference, error, BEYOND))) == stated


@pytest.mark.parametrize("judgement", [one for one in Judgement if one is not BEYOND])
def test_inside_its_error_no_difference_is_likely_between_two_sizes(judgement: Judgement) -> None:
    assert interval_words(KNEE, Difference(3.0, 6.0, judgement)) == ""


@pytest.mark.parametrize(
    ("difference", "error", "stated"),
    [
        (-4.7, 8.7, "Difference 4.7°, which may be measurement error: anything from -13° to +4° fits."),
        (4.7, 8.7, "Difference 4.7°, which may be measurement error: anything from -4° to +13° fits."),
        (0.0, 7.2, "Difference 0.0°, which may be measurement error: anything from -7° to +7° fits."),
    ],
)
def test_an_interval_that_holds_zero_is_stated_with_both_signs(difference: float, error: float, stated: str) -> None:
    found = Difference(difference, error, INSIDE)
    assert plain(may_be_error_sentence(KNEE, found)) == stated
    assert plain(evidence(KNEE, found)) == stated


@pytest.mark.parametrize(
    ("difference", "error", "stated"), [(-4.7, 8.7, "-13 to +4"), (9.0, 6.0, "+3 to +15"), (-9.0, 6.0, "-15 to -3")]
)
def test_in_a_table_an_interval_runs_from_the_least_to_the_most(difference: float, error: float, stated: str) -> None:
    assert plain(interval_in_figures(KNEE, Difference(difference, error, BEYOND))) == stated
    unsure = Difference(difference, error, BEYOND, is_unverified=True)
    assert plain(interval_in_figures(KNEE, unsure)) == f"{stated}†"


@pytest.mark.parametrize("found", [Difference(math.nan, math.nan, one) for one in Judgement if one is not BEYOND])
def test_what_is_not_judged_has_no_interval_and_no_number_is_written(found: Difference) -> None:
    assert interval_in_figures(KNEE, found) == "–"
    assert evidence(KNEE, found) == ""
    assert found.ratio == 0.0
    assert math.isnan(found.share_of_at_least(5.0))


@pytest.mark.parametrize(
    ("mark", "judgement", "healthy", "stated"),
    [
        (Mark.HEALTHY, BEYOND, 4.0, "95 of 100 healthy people differ by less."),
        (Mark.ERROR, BEYOND, 4.0, "Many healthy people differ as much."),
        (Mark.ERROR, BEYOND, math.nan, ""),  # of visits, and of what no healthy legs are known
        (Mark.NONE, INSIDE, 4.0, ""),
    ],
)
def test_healthy_people_are_named_where_their_legs_are_known(
    mark: Mark, judgement: Judgement, healthy: float, stated: str
) -> None:
    found = Difference(3.6, 3.0, judgement, mark=mark, healthy=healthy)
    assert healthy_sentence(found) == stated
    assert ("healthy" in evidence(STANCE, found)) is bool(stated)


@pytest.mark.parametrize(
    ("of_speed", "change_m_s", "stated"),
    [
        (-0.5, 0.1, "Of this, about 0.5 % of the gait cycle goes with walking 0.10 m/s faster."),
        (-1.8, -0.1, "Of this, about 1.8 % of the gait cycle goes with walking 0.10 m/s slower."),
        (-4.5, 0.9, "All of it may go with walking 0.90 m/s faster."),
        (-4.1, -0.9, "All of it may go with walking 0.90 m/s slower."),
        (0.5, -0.1, ""),  # the other way
        (-0.04, 0.01, ""),  # nothing, as written
    ],
)
def test_what_goes_with_speed_is_stated_and_what_goes_the_other_way_is_not(
    of_speed: float, change_m_s: float, stated: str
) -> None:
    part = SpeedPart(of_speed, -4.1 - of_speed, 3.2, change_m_s)
    found = Difference(-4.1, 3.2, BEYOND, by_speed=part)
    assert plain(speed_sentence(STANCE, found)) == stated
    assert plain(evidence(STANCE, found)).endswith(stated or "7.3 % of the gait cycle.")


def test_a_dagger_follows_a_slope_whose_source_was_not_read() -> None:
    part = SpeedPart(-1.8, -2.3, 3.2, 0.1, is_unverified=True)
    found = Difference(-4.1, 3.2, BEYOND, by_speed=part)
    assert speed_sentence(STANCE, found).endswith("m/s faster. †")
    assert "†" not in speed_sentence(STANCE, replace(found, by_speed=replace(part, is_unverified=False)))


def test_without_a_slope_or_another_speed_nothing_is_stated_of_it() -> None:
    assert speed_sentence(STRIDE_LENGTH, Difference(0.2, 0.1, BEYOND)) == ""


def test_a_dagger_follows_an_interval_that_rests_on_a_source_that_was_not_read() -> None:
    assert evidence("ankle_range_deg", Difference(30.0, 9.0, BEYOND, is_unverified=True)).endswith("39°. †")
    assert "†" not in evidence("ankle_range_deg", Difference(30.0, 9.0, BEYOND))


@pytest.mark.parametrize(
    ("mark", "judgement", "circle", "words"),
    [
        (Mark.HEALTHY, BEYOND, "●", "● beyond healthy range"),
        (Mark.ERROR, BEYOND, "○", "○ beyond error"),
        (Mark.NONE, INSIDE, "", "may be error"),
    ],
)
def test_a_circle_states_what_a_difference_is_beyond(mark: Mark, judgement: Judgement, circle: str, words: str) -> None:
    found = Difference(5.0, 3.0, judgement, mark=mark)
    assert MARKS[mark] == circle
    assert plain(in_words(found)) == words
    assert in_brief(found) == (circle or words)
    assert judged_in_words(found) == in_words(found)
    unsure = Difference(5.0, 3.0, judgement, mark=mark, is_unverified=True)
    assert plain(judged_in_words(unsure)) == f"{words} †"

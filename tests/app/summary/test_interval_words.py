"""What is stated beside a difference: each word has a difference for which it must come, and one for which it must not.

Figures by hand: an error is 1.96 sqrt(2) sigma, as nothing but attachment lies between two means that are sure.
"""

import math

import pytest
from syrupy.assertion import SnapshotAssertion

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


def stated(column: str, found: Difference) -> dict[str, str]:
    """Whatever is stated of a difference, and nothing that is empty."""
    words = {
        "evidence": evidence(column, found),
        "interval": interval_words(column, found),
        "in a table": interval_in_figures(column, found),
        "may be error": may_be_error_sentence(column, found) if found.judgement is INSIDE else "",
        "healthy people": healthy_sentence(found),
        "speed": speed_sentence(column, found),
        "in words": in_words(found),
        "in brief": in_brief(found),
        "judged": judged_in_words(found),
        "mark": MARKS[found.mark],
    }
    return {name: plain(one) for name, one in words.items() if one}


def by_speed(of_speed: float, change_m_s: float, *, is_unverified: bool = False) -> Difference:
    part = SpeedPart(of_speed, -4.1 - of_speed, 3.2, change_m_s, is_unverified=is_unverified)
    return Difference(-4.1, 3.2, BEYOND, by_speed=part)


PITCH, ANKLE = "foot_pitch_at_contact_deg", "ankle_range_deg"
DIFFERENCES = {
    "beyond, less": (PITCH, Difference(-9.0, 6.0, BEYOND)),
    "beyond, more": (PITCH, Difference(9.0, 6.0, BEYOND)),
    "beyond, in percent": (STANCE, Difference(-4.1, 3.2, BEYOND)),
    "beyond, a speed": (SPEED, Difference(0.41, 0.18, BEYOND)),
    "beyond: of whole degrees the first were 0": (KNEE, Difference(6.9, 6.6, BEYOND)),
    "beyond: of whole degrees both were 2": (KNEE, Difference(1.9, 0.3, BEYOND)),
    "within, less": (KNEE, Difference(-4.7, 8.7, INSIDE)),
    "within, more": (KNEE, Difference(4.7, 8.7, INSIDE)),
    "within, none": (KNEE, Difference(0.0, 7.2, INSIDE)),
    "not verified": (ANKLE, Difference(30.0, 9.0, BEYOND, is_unverified=True)),
    "verified": (ANKLE, Difference(30.0, 9.0, BEYOND)),
    "beyond healthy people": (STANCE, Difference(3.6, 3.0, BEYOND, mark=Mark.HEALTHY, healthy=4.0)),
    "beyond error alone": (STANCE, Difference(3.6, 3.0, BEYOND, mark=Mark.ERROR, healthy=4.0)),
    "of visits, or where no healthy legs are known": (STANCE, Difference(3.6, 3.0, BEYOND, mark=Mark.ERROR)),
    "within error, healthy legs are known": (STANCE, Difference(3.6, 4.0, INSIDE, healthy=4.0)),
    "a mark, not verified": (STANCE, Difference(5.0, 3.0, BEYOND, mark=Mark.HEALTHY, is_unverified=True)),
    "another mark, not verified": (STANCE, Difference(5.0, 3.0, BEYOND, mark=Mark.ERROR, is_unverified=True)),
    "no mark, not verified": (STANCE, Difference(5.0, 6.0, INSIDE, is_unverified=True)),
    "a part goes with walking faster": (STANCE, by_speed(-0.5, 0.1)),
    "a part goes with walking slower": (STANCE, by_speed(-1.8, -0.1)),
    "all may go with walking faster": (STANCE, by_speed(-4.5, 0.9)),
    "all may go with walking slower": (STANCE, by_speed(-4.1, -0.9)),
    "speed went the other way": (STANCE, by_speed(0.5, -0.1)),
    "of speed nothing, as written": (STANCE, by_speed(-0.04, 0.01)),
    "a slope that was not read": (STANCE, by_speed(-1.8, 0.1, is_unverified=True)),
    "without a slope or another speed": (STRIDE_LENGTH, Difference(0.2, 0.1, BEYOND)),
}


def test_a_difference_is_stated_by_size_mark_and_speed_and_by_nothing_that_it_has_not(
    snapshot: SnapshotAssertion,
) -> None:
    assert {case: stated(column, found) for case, (column, found) in DIFFERENCES.items()} == snapshot


@pytest.mark.parametrize("judgement", [one for one in Judgement if one is not BEYOND])
def test_inside_its_error_no_difference_is_likely_between_two_sizes(judgement: Judgement) -> None:
    assert interval_words(KNEE, Difference(3.0, 6.0, judgement)) == ""


@pytest.mark.parametrize("found", [Difference(math.nan, math.nan, one) for one in Judgement if one is not BEYOND])
def test_what_is_not_judged_has_no_interval_and_no_number_is_written(found: Difference) -> None:
    assert interval_in_figures(KNEE, found) == "–"
    assert evidence(KNEE, found) == ""
    assert found.ratio == 0.0
    assert math.isnan(found.share_of_at_least(5.0))

"""Published changes stand beside a test for the people they were found in, with a dagger where not verified."""

import pytest

from app.summary.timed_words import populations_of, published_rows, published_sentence, span_in_words
from core.session import Patient
from core.timed.protocols import TimedProtocol
from core.verdicts.published_changes import PUBLISHED, ChangeKind, Population, PublishedChange

UP = TimedProtocol.UP_AND_GO


def change(low: float, high: float, *read: str) -> PublishedChange:
    return PublishedChange("up_and_go_time_s", Population.STROKE, ChangeKind.DETECTABLE, low, high, read)


def test_a_figure_of_fewer_than_two_sources_has_a_dagger() -> None:
    assert span_in_words(change(2.9, 3.2, "one", "other")) == "2.9\N{EN DASH}3.2"
    assert span_in_words(change(2.9, 3.2, "one")) == "2.9\N{EN DASH}3.2\N{DAGGER}"
    assert span_in_words(change(3.5, 3.5, "one", "other")) == "3.5"
    assert span_in_words(None) == "\N{EN DASH}"


@pytest.mark.parametrize(("side", "has_loss"), [("left", True), ("both", True), ("none", False), ("", False)])
def test_who_wears_a_prosthesis_is_compared_with_people_who_do(side: str, has_loss: bool) -> None:
    populations = populations_of(Patient(prosthetic_side=side))
    assert (Population.LIMB_LOSS in populations) is has_loss
    assert len(populations) == (1 if has_loss else len(Population) - 1)


@pytest.mark.parametrize("protocol", TimedProtocol)
def test_every_published_figure_of_a_test_is_stated_with_its_people(protocol: TimedProtocol) -> None:
    rows = published_rows(protocol, tuple(Population))
    stated = [one for _, *found in rows for one in found if one is not None]
    sentence = published_sentence(protocol, tuple(Population))
    assert all(span_in_words(one) in sentence for one in stated)
    assert bool(sentence) is bool(stated)
    assert ("could be read" in sentence) is any(not one.is_verified for one in stated)


def test_none_of_the_table_is_left_out() -> None:
    stated = [
        one for protocol in TimedProtocol for _, *found in published_rows(protocol, tuple(Population)) for one in found
    ]
    assert {one for one in stated if one is not None} == set(PUBLISHED)


def test_of_stairs_nothing_is_published() -> None:
    assert published_sentence(TimedProtocol.STAIRS, tuple(Population)) == ""
    assert published_sentence(UP, (Population.LIMB_LOSS,)).startswith(
        "Published least changes, s. Lower limb loss: MDC "
    )

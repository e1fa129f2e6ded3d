"""Walk-to-walk variation is of the walks of one alignment, stated with their values, and only where there are two."""

from dataclasses import replace
from typing import Any

import pytest
from syrupy.assertion import SnapshotAssertion

from app.summary.comparison import Compared, Comparison, Contrast
from app.summary.conditions import Part
from app.summary.walk_to_walk import WalkVariation, variation_in_words, variation_of
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Side
from core.results import RecordingAnalysis
from tests.core.verdicts.built_walk import calibrations, judged_walk, leg, walk

AGAIN = AlignmentChange("Alignment B", (PartChange(ProsthesisPart.PYLON, height_mm=-3.0),), "Alignment A")


def walked(range_deg: float, strides: int = 12) -> RecordingAnalysis:
    return judged_walk(walk(left=leg(Side.LEFT, strides, knee_range_deg=range_deg)), calibrations())


def part(letter: str, *walks: RecordingAnalysis, **reported: Any) -> Part:
    return Part(letter, f"Alignment {letter}", walks, calibrations(), **reported)


def row_of(shown: Part, base: Part) -> Compared:
    (row,) = (
        row
        for row in Comparison(Contrast.CONDITIONS, (base, shown)).rows
        if (row.measure.column, row.side) == ("knee_range_deg", Side.LEFT)
    )
    return row


A, B = part("A", walked(60.0)), part("B", walked(63.0))
A2 = part("A2", walked(61.2), alignment=AGAIN)


def test_two_walks_of_the_base_vary_by_what_they_differ() -> None:
    found = variation_of(row_of(B, A), (A, B, A2))
    assert found is not None
    assert found.letter == "A"
    assert found.values == pytest.approx((60.0, 61.2))
    assert found.size == pytest.approx(1.2)
    both = part("A", walked(60.0), walked(62.5))  # repeated without a return between
    found = variation_of(row_of(B, both), (both, B))
    assert found is not None
    assert found.values == pytest.approx((60.0, 62.5))


@pytest.mark.parametrize(
    "others",
    [
        (),
        (part("C", walked(61.2)),),  # another alignment
        (part("A2", walked(61.2, strides=9), alignment=AGAIN),),
        (part("A2", walked(61.2), alignment=AGAIN, is_apart=True),),  # a timed test, or towards a target
        (part("A2", walked(61.2), alignment=AGAIN, attachment=1),),  # the sensors were attached again
    ],
)
def test_of_one_walk_no_variation_is_known(others: tuple[Part, ...]) -> None:
    assert variation_of(row_of(B, A), (A, B, *others)) is None


def test_of_a_return_beside_its_first_the_difference_is_the_variation_itself() -> None:
    assert variation_of(row_of(A2, A), (A, B, A2)) is None


def test_what_is_not_reported_of_a_walk_does_not_vary() -> None:
    biased = leg(Side.LEFT, is_toe_off_biased=True)
    stance = part("A", *(judged_walk(walk(left=biased), calibrations()) for _ in range(2)))
    row = replace(row_of(B, stance), measure=replace(row_of(B, stance).measure, column="speed_m_s"))
    assert variation_of(row, (stance, B)) is None  # of both legs


def test_it_is_stated_with_numbers_that_agree_and_is_no_error(snapshot: SnapshotAssertion) -> None:
    def stated(difference: float, *values: float) -> str:
        return variation_in_words(WalkVariation("knee_range_deg", "A", values), difference)

    found = {
        "more": stated(3.0, 60.0, 61.2),
        "within": stated(-1.2, 61.2, 60.0),
        "three walks": stated(1.0, 60.0, 61.2, 60.5),
        "rounded once they would not give their difference": stated(3.0, 60.04, 61.26),
    }
    assert found == snapshot
    assert "error" not in "".join(found.values())

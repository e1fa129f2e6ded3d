"""Tests that a change is judged by what lies between the two walks it is of."""

from dataclasses import replace

from app.summary.comparison import Comparison, Contrast
from app.summary.conditions import Part
from app.summary.measures import MEASURES
from core.body import Joint, Side
from core.verdicts.measurement_error import compare
from core.verdicts.sigmas import ComparisonKind
from tests.app.course_material import analysis, unsure, walked

KNEE = next(measure for measure in MEASURES if measure.column == "knee_stance_to_swing_deg")


def part(letter: str, visit: int, knee_deg: float, *, is_readable: bool = True) -> Part:
    reported = None if is_readable else unsure(Joint.LEFT_KNEE)
    walk = walked(f"walk {letter}", knee_deg=knee_deg, reported=reported)
    return Part(letter, letter, (walk,), analysis(walk, reported=reported).calibrated_for(walk), visit=visit)


def test_a_change_from_the_next_visit_that_can_be_read_has_the_error_of_visits() -> None:
    """The chosen base cannot be read, so that a walk of its own visit is reported against another visit."""
    parts = (part("1A", 1, 50.0), part("1B", 1, 50.0, is_readable=False), part("2A", 2, 44.0))
    comparison = Comparison(Contrast.CHOSEN, parts, base=1)
    (row,) = (
        row for row in comparison.rows if row.measure is KNEE and row.side is Side.LEFT and row.part.letter == "1A"
    )
    assert row.against.letter == "2A"
    one, other = (found.mean(Side.LEFT, KNEE.column, ComparisonKind.VISITS) for found in (row.part, row.against))
    assessments = tuple(found.assessment(Side.LEFT, KNEE.column) for found in (row.part, row.against))
    judged = compare(KNEE.column, ComparisonKind.VISITS, one, other, assessments)
    assert (row.difference.difference, row.difference.error) == (judged.difference, judged.error)
    attached = compare(KNEE.column, ComparisonKind.ATTACHED, one, other, assessments)
    assert attached.error < row.difference.error  # which would have stated more than can be known


def test_walks_of_one_strapping_have_the_error_of_one() -> None:
    parts = (part("1A", 1, 50.0), part("1B", 1, 46.0), part("2A", 2, 44.0))
    comparison = Comparison(Contrast.CHOSEN, parts)
    kinds = [comparison.error_kind(row.part, row.against) for row in comparison.rows if row.measure is KNEE]
    assert set(kinds[:: len(comparison.others)]) == {ComparisonKind.ATTACHED}
    assert set(kinds[1 :: len(comparison.others)]) == {ComparisonKind.VISITS}
    again = Comparison(Contrast.CHOSEN, (parts[0], replace(parts[1], attachment=1)))
    assert again.error_kind(again.parts[1]) is ComparisonKind.STRAPPINGS

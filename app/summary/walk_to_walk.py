"""Walk-to-walk variation: how much walks of one alignment differ among themselves, measured in this session.

It is no measurement error, though a part of it: nobody walks alike twice, and no prosthesis is put back exactly.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from app.summary.comparison import Compared
from app.summary.conditions import Part
from app.summary.measure_sentences import agreeing_decimals, unit_in_sentence
from app.summary.numbers_in_words import fixed
from app.wording.translation import tr
from core.verdicts.norms import MIN_STRIDES_FOR_SD

LEAST_WALKS = 2


@dataclass(frozen=True, slots=True)
class WalkVariation:
    """The means of a measure in walks of one alignment, in its unit, and the alignment's letter."""

    column: str
    letter: str
    values: tuple[float, ...]

    @property
    def size(self) -> float:
        """By how much the two walks differ that differ most."""
        return max(self.values) - min(self.values)


def variation_of(row: Compared, parts: Sequence[Part]) -> WalkVariation | None:
    """Give what the base of a difference varies by from walk to walk; None with fewer than two walks of ten strides.

    `parts`: of the session. Walks after the prosthesis was put back to the base count; the part shown does not.
    """
    own = [part for part in parts if not part.is_apart and (part is row.against or part.is_again(row.against))]
    if row.measure.is_of_walk or row.part.is_again(row.against):
        return None
    each = [_value(row, replace(part, walks=(walk,))) for part in own for walk in part.walks]
    values = [value for value in each if value is not None]
    return WalkVariation(row.measure.column, row.against.letter, tuple(values)) if len(values) >= LEAST_WALKS else None


def variation_in_words(found: WalkVariation, difference: float) -> str:
    """State whether a difference is within what the walks of its base differ by, with their values."""
    low, high = min(found.values), max(found.values)
    decimals = agreeing_decimals(found.column, high, low, found.size)
    size, one, other = (fixed(value, decimals) + unit_in_sentence(found.column) for value in (found.size, low, high))
    is_within = round(abs(difference), decimals) <= round(found.size, decimals)
    if len(found.values) == LEAST_WALKS:
        walks = tr("Its two walks, {one} and {other}, differ by {size}.")
    else:
        walks = tr("Its {count} walks, from {one} to {other}, differ by up to {size}.")
    stated = (
        tr("Within the walk-to-walk variation of {letter}.")
        if is_within
        else tr("More than the walk-to-walk variation of {letter}.")
    )
    return f"{stated} {walks}".format(letter=found.letter, count=len(found.values), one=one, other=other, size=size)


def _value(row: Compared, alone: Part) -> float | None:
    """Of one walk; None where it is not reported, or from too few strides."""
    found = alone.value(row.side, row.measure.column)  # without values where it is not reported
    return found.mean if found.n >= MIN_STRIDES_FOR_SD else None

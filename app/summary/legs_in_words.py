"""One measure of both legs in a sentence: by how much they differ, that they are similar, or what both are."""

import math
from collections.abc import Sequence

from app.summary.measure_sentences import CLAUSES, unit_and_decimals, who_in_sentence
from app.summary.numbers_in_words import fixed
from app.wording.body import side_name
from app.wording.measures import name_in_sentence
from app.wording.translation import capitalised, tr
from core.body import Side
from core.parameters import KNEE, STANCE, Unit, unit_of


def legs_differ(
    column: str, side: Side, values: tuple[float, float], difference: float, *, is_usual: bool = False
) -> str:
    """State one leg's value and its difference from the other; `is_usual`: many healthy people differ so."""
    value, other = values
    _, now, size = rounded(column, (other, value, abs(difference)), is_other_shown=False)
    unit = unit_and_decimals(column)[0]
    size = tr("{size} points").format(size=size) if unit_of(column) is Unit.PERCENT else size + unit
    stated = _pattern(is_less=difference < 0, is_usual=is_usual)
    return stated.format(clause=clause_of(column, side, now + unit), size=size, other=side_name(side.other))


def legs_similar(column: str, values: tuple[float, float], difference: float) -> str:
    """Left and right, whose difference may be error."""
    unit = unit_and_decimals(column)[0]
    left, right, _ = rounded(column, (*values, abs(difference)), is_other_shown=False)
    if column == KNEE:
        stated = tr("Left and right are similar: knee {left} and {right} from stance to swing.")
    else:
        stated = tr("Left and right are similar: {measure} {left} and {right}.")
    return stated.format(measure=name_in_sentence(column), left=left + unit, right=right + unit)


def both_knees(left_deg: float, right_deg: float) -> str:
    """Both values, where nothing is known of their difference."""
    stated = tr("Knee from stance to swing: left {left}, right {right}.")
    return stated.format(left=f"{fixed(left_deg, 0)}°", right=f"{fixed(right_deg, 0)}°")


def clause_of(column: str, side: Side | None, value: str) -> str:
    """What a measure is, as a main clause: "Left knee flexes 53° from stance to swing"."""
    if side is None:
        return capitalised(tr("{measure} is {value}").format(measure=name_in_sentence(column), value=value))
    pattern = CLAUSES.get(column) if column != STANCE else None
    if pattern is not None:
        return tr(pattern).format(who=who_in_sentence(column, side), value=value)
    stated = tr("{side} {measure} is {value}")
    return stated.format(side=capitalised(side_name(side)), measure=name_in_sentence(column), value=value)


def rounded(column: str, values: Sequence[float], *, is_other_shown: bool = True) -> tuple[str, ...]:
    """Round two values and their difference once; all get a decimal more where the difference disagrees."""
    is_angle = unit_of(column) is Unit.DEGREES
    decimals = 0 if is_angle else unit_and_decimals(column)[1]
    before, now, size = values
    shown = abs(round(now, decimals) - round(before, decimals))
    if (is_angle or is_other_shown) and not math.isclose(shown, round(size, decimals), abs_tol=0.1 * 10.0**-decimals):
        decimals += 1
    return tuple(fixed(value, decimals) for value in values)


def _pattern(*, is_less: bool, is_usual: bool) -> str:
    """`is_usual`: many healthy people differ as much; of some measures nobody knows."""
    if not is_usual:
        return (
            tr("{clause}, {size} less than the {other}.") if is_less else tr("{clause}, {size} more than the {other}.")
        )
    if is_less:
        return tr("{clause}, {size} less than the {other}; many healthy people differ as much.")
    return tr("{clause}, {size} more than the {other}; many healthy people differ as much.")

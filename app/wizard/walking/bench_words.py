"""What the bench says of two alignments: one sentence of the prosthetic side, and what must be known to read it."""

import math

from app.results.compared_words import error_in_sentence, is_judged, unit_behind
from app.summary.answer import Answer, Outcome
from app.summary.comparison import Compared, Comparison
from app.summary.conditions import Part
from app.summary.numbers_in_words import fixed, signed
from app.summary.what_stands_out import FAMILIES
from app.wording.translation import tr, within_sentence
from core.body import Side
from core.verdicts.norms import MIN_STRIDES_FOR_SD

SPEED = "speed_m_s"


def bench_answer(found: Comparison, prosthetic: Side) -> Answer:
    """Tell what of the prosthetic side changed most errors from the other alignment, with its error."""
    shown, other = found.parts[1], found.against
    few = [part for part in (shown, other) if part.strides(prosthetic) < MIN_STRIDES_FOR_SD]
    if few:
        counts = tr("{letter} has {count}").format(letter=few[0].letter, count=few[0].strides(prosthetic))
        first = tr("{one} and {other}: too few strides to assess a change.").format(
            one=shown.letter, other=other.letter
        )
        wanted = tr(
            "Provisional: {counts} strides on the prosthetic side; {wanted} are needed for a measurement error."
        )
        return Answer(Outcome.OPEN, first, wanted.format(counts=counts, wanted=MIN_STRIDES_FOR_SD))
    own = [row for row in found.rows if _is_told_of(row) and row.side is prosthetic]
    if not own:
        first = tr("Prosthetic side: nothing can be compared between {one} and {other}.")
        return Answer(Outcome.OPEN, first.format(one=shown.letter, other=other.letter), _beside(found, prosthetic))
    worth = [row for row in own if row.difference.is_worth_a_sentence]
    beyond = [row for row in own if row.exceeds]  # as the table marks them
    most = max(_without_family(worth or beyond or own), key=lambda row: row.difference.ratio)
    if beyond:
        error = tr("Beyond measurement error (±{error}).") if worth else tr("Just beyond measurement error (±{error}).")
        error = error.format(error=error_in_sentence(most))
        return Answer(Outcome.DIFFERS, _sentence(most), f"{error} {_beside(found, prosthetic)}")
    return Answer(Outcome.NOTHING, _similar(most), f"{_what_fits(most)} {_beside(found, prosthetic)}")


def speeds_in_words(shown: Part, other: Part) -> str:
    """Both speeds, since speed explains much; that they are not known, where one is not."""
    values = [part.of_both(SPEED) for part in (other, shown)]
    if not all(map(math.isfinite, values)):
        return tr("Walking speeds are not known.")
    return tr("Walking speed {first} and {second} m/s.").format(first=fixed(values[0], 2), second=fixed(values[1], 2))


def _is_told_of(row: Compared) -> bool:
    """Whether a sentence may tell of it: judged, of one leg, and no height, which the standing zero is in."""
    return is_judged(row) and not row.measure.is_of_walk and not row.measure.needs_height


def _without_family(rows: list[Compared]) -> list[Compared]:
    """A range and the excursion that makes most of it are one movement: the excursion is told."""
    told = {(row.measure.column, row.difference.difference > 0) for row in rows}
    return [row for row in rows if (FAMILIES.get(row.measure.column), row.difference.difference > 0) not in told]


def _sentence(row: Compared) -> str:
    name, unit, decimals = _name(row), _unit(row), _decimals(row)
    pattern = (
        tr("Prosthetic side, {measure}: {value} with {letter}, {size} less than with {other} ({before}).")
        if row.difference.difference < 0
        else tr("Prosthetic side, {measure}: {value} with {letter}, {size} more than with {other} ({before}).")
    )
    return pattern.format(
        letter=row.part.letter,
        other=row.against.letter,
        size=fixed(abs(row.difference.difference), decimals) + unit,
        measure=within_sentence(name),
        value=fixed(row.value.mean, decimals) + unit,
        before=fixed(row.other.mean, decimals) + unit,
    )


def _similar(row: Compared) -> str:
    """What changed most, where it may be error."""
    unit, decimals = _unit(row), _decimals(row)
    said = tr("The prosthetic side is similar with {other} and {one}: {measure} {before} and {value}.")
    return said.format(
        one=row.part.letter,
        other=row.against.letter,
        measure=within_sentence(_name(row)),
        value=fixed(row.value.mean, decimals) + unit,
        before=fixed(row.other.mean, decimals) + unit,
    )


def _what_fits(row: Compared) -> str:
    found, unit, decimals = row.difference, _unit(row), _decimals(row)
    said = tr("The change of {size} may be measurement error: likely between {low} and {high}.")
    edges = (found.difference, found.difference - found.error, found.difference + found.error)
    size, low, high = (signed(edge, decimals) + unit for edge in edges)
    return said.format(size=size, low=low, high=high)


def _name(row: Compared) -> str:
    """Of the measure; the unit is with the figure."""
    name = tr(row.measure.name)
    return name if row.measure.kind else name.rpartition(",")[0]


def _unit(row: Compared) -> str:
    return unit_behind(row.measure) or "\N{NO-BREAK SPACE}%"


def _decimals(row: Compared) -> int:
    """Subtracted before rounding; where rounded figures disagree with that, all have a decimal more."""
    decimals, value, other = row.measure.decimals, row.value.mean, row.other.mean
    difference = row.difference.difference
    disagree = round(round(value, decimals) - round(other, decimals), decimals) != round(difference, decimals)
    return decimals + disagree


def _beside(found: Comparison, prosthetic: Side) -> str:
    """What the sound side does, whether the sensors stayed on, and the speeds."""
    sound = [row for row in found.rows if _is_told_of(row) and row.side is not prosthetic]
    beyond = [row for row in sound if row.exceeds]
    said = tr("The sound side could not be compared.")
    if beyond:
        said = tr("The sound side also changes beyond measurement error.")
    elif sound:
        said = tr("The sound side does not change beyond measurement error.")
    straps = tr("Sensors stayed on.") if found.is_one_attachment else tr("Sensors were reattached in between.")
    return " ".join([said, straps, speeds_in_words(found.parts[1], found.against)])

"""What the bench shows of two alignments: one sentence of the prosthetic side, and what must be known to read it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from app.results.compared_words import evidence_of
from app.summary.comparison import Compared, Comparison
from app.summary.conditions import Part
from app.summary.measure_sentences import Reported, change_sentence, similar_sentence
from app.summary.numbers_in_words import fixed
from app.summary.walk_to_walk import variation_in_words, variation_of
from app.wizard.walking.bench_rows import may_be_stated, reported_row
from app.wording.translation import tr
from core.body import Side
from core.verdicts.norms import MIN_STRIDES_FOR_SD

SPEED = "speed_m_s"


class Outcome(StrEnum):
    """What kind of answer there is.

    DIFFERS: something exceeds its error. NOTHING: differences were judged, and none exceeds its error. OPEN: nothing
    could be judged.
    """

    DIFFERS = "differs"
    NOTHING = "nothing"
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class Answer:
    """`first` is the sentence that is read from afar, `then` what belongs to it; `then` may be empty."""

    outcome: Outcome
    first: str
    then: str = ""


def bench_answer(found: Comparison, prosthetic: Side) -> Answer:
    """Return what of the prosthetic side changed by the most errors from the other alignment, with its error."""
    shown, other = found.parts[1], found.against
    few = [part for part in (shown, other) if part.strides(prosthetic) < MIN_STRIDES_FOR_SD]
    if few:
        first = tr("{one} and {other}: too few strides to assess a change.").format(
            one=shown.letter, other=other.letter
        )
        then = tr(
            "Provisional: {letter} has {count} strides on the prosthetic side; {required} are needed to "
            "determine measurement error."
        )
        count = few[0].strides(prosthetic)
        then = then.format(letter=few[0].letter, count=count, required=MIN_STRIDES_FOR_SD)
        return Answer(Outcome.OPEN, first, then)
    most = reported_row(found, prosthetic)
    if most is None:
        first = tr("Prosthetic side: nothing can be compared between {one} and {other}.")
        return Answer(Outcome.OPEN, first.format(one=shown.letter, other=other.letter), _beside(found, prosthetic))
    if most.exceeds:
        stated = change_sentence(*_of_side(most))
        return Answer(Outcome.DIFFERS, stated, f"{evidence_of(most)} {_beside(found, prosthetic)}")
    column, _, size, *reported = _of_side(most)
    similar = similar_sentence(column, tr("Prosthetic side"), size, *reported)
    return Answer(Outcome.NOTHING, similar, f"{evidence_of(most)} {_beside(found, prosthetic)}")


def variation_sentence(found: Comparison, prosthetic: Side, parts: Sequence[Part]) -> str:
    """How the change compares with the walks of its base among themselves, `parts` being all; empty: not known."""
    shown, other = found.parts[1], found.against
    if shown.is_again(other):
        stated = tr("{one} is {other} again: this is walk-to-walk variation, or the return is not exact.")
        return stated.format(one=shown.letter, other=other.letter)
    row = reported_row(found, prosthetic)
    variation = variation_of(row, parts) if row is not None else None
    return variation_in_words(variation, row.difference.difference) if row is not None and variation is not None else ""


def speeds_in_words(shown: Part, other: Part) -> str:
    """Both speeds, since speed explains much; that they are not known, where one is not."""
    values = [part.of_both(SPEED) for part in (other, shown)]
    if not all(map(math.isfinite, values)):
        return tr("Walking speeds are not known.")
    return tr("Walking speeds: {first} and {second} m/s.").format(first=fixed(values[0], 2), second=fixed(values[1], 2))


def _of_side(row: Compared) -> tuple[str, str, float, Reported, Reported]:
    """The prosthetic side's measure, whose it is, its difference, and both values with their alignments."""
    joint = row.measure.joint(row.side)
    who = tr("Prosthetic side")
    if joint is not None:
        who = tr("Prosthetic-side {joint}").format(joint=tr(joint.kind))
    now, before = (tr("with {part}").format(part=part.letter) for part in (row.part, row.against))
    reported = Reported(now, row.value.mean), Reported(before, row.other.mean)
    return row.measure.column, who, row.difference.difference, *reported


def _beside(found: Comparison, prosthetic: Side) -> str:
    """What the sound side does, whether the sensors stayed on, and the speeds."""
    sound = [row for row in found.rows if may_be_stated(row) and row.side is not prosthetic]
    beyond = [row for row in sound if row.exceeds]
    stated = tr("The sound side could not be compared.")
    if beyond:
        stated = tr("The sound side also changes beyond measurement error.")
    elif sound:
        stated = tr("The sound side does not change beyond measurement error.")
    straps = tr("Sensors stayed attached.") if found.is_one_attachment else tr("Sensors were reattached in between.")
    return " ".join([stated, straps, speeds_in_words(found.parts[1], found.against)])

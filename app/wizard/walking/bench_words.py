"""What the bench shows of two alignments: one sentence of the prosthetic side, and what must be known to read it."""

import math
from dataclasses import dataclass
from enum import StrEnum

from app.results.compared_words import evidence_of, is_judged
from app.summary.comparison import Compared, Comparison
from app.summary.conditions import Part
from app.summary.measure_sentences import Reported, change_sentence, similar_sentence
from app.summary.numbers_in_words import fixed
from app.summary.what_stands_out import FAMILIES
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
    own = [row for row in found.rows if _is_reported_of(row) and row.side is prosthetic]
    if not own:
        first = tr("Prosthetic side: nothing can be compared between {one} and {other}.")
        return Answer(Outcome.OPEN, first.format(one=shown.letter, other=other.letter), _beside(found, prosthetic))
    worth = [row for row in own if row.difference.is_worth_a_sentence]
    beyond = [row for row in own if row.exceeds]  # as the table marks them
    most = max(_without_family(worth or beyond or own), key=lambda row: row.difference.ratio)
    if beyond:
        stated = change_sentence(*_of_side(most))
        return Answer(Outcome.DIFFERS, stated, f"{evidence_of(most)} {_beside(found, prosthetic)}")
    column, _, size, *reported = _of_side(most)
    similar = similar_sentence(column, tr("Prosthetic side"), size, *reported)
    return Answer(Outcome.NOTHING, similar, f"{evidence_of(most)} {_beside(found, prosthetic)}")


def speeds_in_words(shown: Part, other: Part) -> str:
    """Both speeds, since speed explains much; that they are not known, where one is not."""
    values = [part.of_both(SPEED) for part in (other, shown)]
    if not all(map(math.isfinite, values)):
        return tr("Walking speeds are not known.")
    return tr("Walking speeds: {first} and {second} m/s.").format(first=fixed(values[0], 2), second=fixed(values[1], 2))


def _is_reported_of(row: Compared) -> bool:
    """Whether a sentence may name it: judged, of one leg, and no height, which the standing zero is in."""
    return is_judged(row) and not row.measure.is_of_walk and not row.measure.needs_height


def _without_family(rows: list[Compared]) -> list[Compared]:
    """A range and the excursion that makes most of it are one movement: the excursion is reported."""
    reported = {(row.measure.column, row.difference.difference > 0) for row in rows}
    return [row for row in rows if (FAMILIES.get(row.measure.column), row.difference.difference > 0) not in reported]


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
    sound = [row for row in found.rows if _is_reported_of(row) and row.side is not prosthetic]
    beyond = [row for row in sound if row.exceeds]
    stated = tr("The sound side could not be compared.")
    if beyond:
        stated = tr("The sound side also changes beyond measurement error.")
    elif sound:
        stated = tr("The sound side does not change beyond measurement error.")
    straps = tr("Sensors stayed attached.") if found.is_one_attachment else tr("Sensors were reattached in between.")
    return " ".join([stated, straps, speeds_in_words(found.parts[1], found.against)])

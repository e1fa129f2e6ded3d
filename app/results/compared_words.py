"""Words of a comparison. Its parts, its figures, a sentence for what lies beyond the error, and what that holds."""

from collections.abc import Callable, Sequence

from app.summary.comparison import Compared, Comparison, Reservation, SideRow
from app.summary.conditions import Part
from app.summary.error_sources import sources_in_words
from app.summary.interval_words import evidence, interval_in_figures
from app.summary.measure_sentences import Reported, change_sentence, legs_sentence, who_in_sentence
from app.summary.measures import Measure
from app.summary.numbers_in_words import NOTHING, signed
from app.summary.walk_figures import reason_in_words
from app.wording.body import side_name
from app.wording.dates import day_in_words
from app.wording.measures import name_in_sentence
from app.wording.recordings import name_in_words
from app.wording.translation import later, tr
from app.wording.verdicts import verdict_word
from core.body import Joint, Side
from core.verdicts.measurement_error import Difference, Judgement
from core.verdicts.model import Verdict

BRIEF = ("knee_stance_to_swing_deg", "knee_while_loading_deg", "ankle_push_off_deg", "stance_percent")
MOST_STATED = 3  # sentences about differences; the table has all of them

ERROR = later("Grey: measurement error. It includes {sources}.")
UNVERIFIED = later("† based on a value whose source could not be verified.")


def part_in_words(part: Part, name: str) -> str:
    """A part's letter and name, and how many strides it has of each leg."""
    strides = ", ".join(f"{side.letter} {part.strides(side)}" for side in part.sides)
    called = f"{part.letter} {name_in_words(name)}"
    return f"{called} · {strides}" if strides else called


def days_of(parts: Sequence[Part]) -> list[str]:
    """The day of each visit, or its name where the day is not known."""
    days = [part.day for part in parts if part.day is not None]
    return [name_in_words(part.name) if part.day is None else day_in_words(part.day, days) for part in parts]


def change_in_words(value: float, measure: Measure) -> str:
    """A difference with its sign; the unit is in the measure's name or the title."""
    return signed(value, measure.decimals) + (measure.unit if measure.unit == "°" else "")


def unit_behind(measure: Measure) -> str:
    """As it is shown behind a figure."""
    return measure.unit if measure.unit == "°" else f"\N{NO-BREAK SPACE}{tr(measure.unit)}"


def is_judged(row: Compared | SideRow) -> bool:
    """Whether it is known to be larger than its error or inside it."""
    return row.is_reported and row.difference.is_judged


def interval_of(row: Compared | SideRow) -> str:
    """Where a difference is likely to be, as in a table, whose names have the units; a dash where none was judged."""
    return interval_in_figures(row.measure.column, row.difference) if is_judged(row) else NOTHING


def why_not_reported(row: Compared | SideRow) -> str:
    """Why a difference has no figure."""
    if isinstance(row, Compared) and row.reservation is Reservation.OTHER_ZERO:
        return tr("no standing reference")
    not_reported = isinstance(row, Compared) and row.reservation is Reservation.NOT_REPORTED
    is_not_reported = not_reported or row.difference.judgement is Judgement.NOT_REPORTED
    if not is_not_reported and row.difference.judgement is Judgement.NO_PUBLISHED_FIGURE:
        return tr("not compared")
    return verdict_word(Verdict.NOT_REPORTED) if is_not_reported else tr("no value")


def not_reported_in_words(part: Part, joint: Joint) -> str:
    """Why a part's curve is not drawn."""
    pattern = tr("{letter}: not reported. {reason}")
    return pattern.format(letter=part.letter, reason=reason_in_words(part.verdicts.joint(joint)))


def weight_in(found: Comparison) -> Callable[[Compared], tuple[int, float]]:
    """What is stated first: of the latest part what lies furthest beyond the error."""
    return lambda row: (-found.parts.index(row.part), -row.difference.ratio)


def side_weight(row: SideRow) -> float:
    return -row.difference.ratio


def sentence(row: Compared) -> str:
    """A difference that lies beyond the measurement error."""
    return f"{difference_sentence(row, _where(row.part), _where(row.against))} {evidence_of(row)}"


def difference_sentence(row: Compared, now: str, before: str) -> str:
    """What a measure is in a part, and by how much it differs; `now` and `before` say where, as "in B"."""
    who = who_in_sentence(row.measure.column, row.side)
    reported = Reported(now, row.value.mean), Reported(before, row.other.mean)
    return change_sentence(row.measure.column, who, row.difference.difference, *reported)


def _where(part: Part) -> str:
    if part.letter.isdigit():
        return tr("at visit {visit}").format(visit=part.letter)
    return tr("in {part}").format(part=part.letter)


def evidence_of(row: Compared | SideRow) -> str:
    """Where a difference is likely to be, and what else is known of it."""
    return evidence(row.measure.column, row.difference)


def side_sentence(row: SideRow, first: Side, second: Side) -> str:
    """A difference between the legs that lies beyond the measurement error."""
    legs, values = (side_name(first), side_name(second)), (row.first.mean, row.second.mean)
    return f"{legs_sentence(row.measure.column, row.difference, legs, values)} {evidence_of(row)}"


def conclusion(worth: Sequence[str], reported: Sequence[Compared | SideRow], latest: Part | None = None) -> list[str]:
    """Give the sentences worth it, else whether any difference exceeds its error, and the largest."""
    if len(worth) > MOST_STATED:
        return [*worth[:MOST_STATED], tr("The table shows all differences.")]
    if worth:
        return list(worth)
    judged = [row for row in reported if is_judged(row)]
    most = max(judged, key=lambda row: row.difference.ratio, default=None)
    if most is None:
        none = tr("The differences could not be judged.")
        of_visit = tr("The changes up to visit {visit} could not be judged.")
    elif not any(row.exceeds for row in judged):
        none = tr("All judged differences are within measurement error.")
        of_visit = tr("All judged changes up to visit {visit} are within measurement error.")
    else:
        none = tr(
            "Some differences are beyond measurement error, but none clearly so. The table marks these differences."
        )
        of_visit = tr(
            "Some changes up to visit {visit} are beyond measurement error, but none clearly so. The "
            "table marks these changes."
        )
    stated = none if latest is None else of_visit.format(visit=latest.letter)
    return [stated] if most is None else [stated, largest_sentence(most)]


def largest_sentence(row: Compared | SideRow) -> str:
    """The difference of most errors with its interval: "Largest: left knee range of motion +4.7° (−4 to +13)."."""
    measure = name_in_sentence(row.measure.column)
    if isinstance(row, Compared) and not row.measure.is_of_walk:
        measure = tr("{side} {measure}").format(side=side_name(row.side), measure=measure)
    change = signed(row.difference.difference, row.measure.decimals) + unit_behind(row.measure)
    stated = tr("Largest: {measure} {change}, likely {interval}.")
    return stated.format(
        measure=measure, change=change, interval=interval_in_figures(row.measure.column, row.difference)
    )


def error_in_words(reported: Sequence[Difference]) -> str:
    """What the error contains, and what of it is not to be relied on."""
    judged = [found for found in reported if found.is_judged]
    if not judged:
        return ""
    stated = [tr(ERROR).format(sources=sources_in_words(judged))]
    stated += [tr(UNVERIFIED)] if any(found.is_unverified for found in judged) else []
    return " ".join(stated)

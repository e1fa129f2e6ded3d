"""What a change of a timed test is worth: since earlier visits, and beside what others published about changes."""

from collections.abc import Sequence

from app.summary.numbers_in_words import DAGGER, NOTHING
from app.wording.measures import short_unit
from app.wording.translation import capitalised, short_figure, tr
from core.session import Patient
from core.timed.measures import COLUMNS
from core.timed.protocols import TimedProtocol
from core.verdicts.published_changes import ChangeKind, Population, PublishedChange, published_changes

MDC, MCID = "MDC", "MCID"  # in every language


def populations_of(patient: Patient) -> tuple[Population, ...]:
    """Whose published changes stand beside a patient's: those of limb loss with a prosthesis, else the others'."""
    if patient.prosthetic_sides:
        return (Population.LIMB_LOSS,)
    return tuple(one for one in Population if one is not Population.LIMB_LOSS)


def name_of_population(population: Population) -> str:
    return {
        Population.LIMB_LOSS: tr("lower limb loss"),
        Population.STROKE: tr("stroke"),
        Population.OSTEOARTHRITIS: tr("hip or knee osteoarthritis or replacement"),
        Population.PARKINSON: tr("Parkinson's disease"),
    }[population]


def span_in_words(found: PublishedChange | None) -> str:
    """The least change as it is published, with a dagger where it is not verified; a dash where there is none."""
    if found is None:
        return NOTHING
    ends = dict.fromkeys(short_figure(value, 2) for value in (found.low, found.high))
    return "\N{EN DASH}".join(ends) + ("" if found.is_verified else DAGGER)


def published_rows(
    protocol: TimedProtocol, populations: Sequence[Population]
) -> list[tuple[Population, PublishedChange | None, PublishedChange | None]]:
    """What is published of a test's figure for each of these people: the detectable and the important change."""
    rows = []
    for population in populations:
        of_kind = {one.kind: one for one in published_changes(COLUMNS.get(protocol, ""), population)}
        if of_kind:
            rows.append((population, of_kind.get(ChangeKind.DETECTABLE), of_kind.get(ChangeKind.IMPORTANT)))
    return rows


def published_sentence(protocol: TimedProtocol, populations: Sequence[Population]) -> str:
    """The same in one line; empty where nothing is published."""
    stated = []
    for population, detectable, important in published_rows(protocol, populations):
        of_kind = ((MDC, detectable), (MCID, important))
        figures = ", ".join(f"{word} {span_in_words(found)}" for word, found in of_kind if found is not None)
        stated.append(f"{name_of_population(population)}: {figures}")
    if not stated:
        return ""
    unit, figures = short_unit(COLUMNS[protocol]).strip(), capitalised("; ".join(stated))
    sentence = tr("Published least changes, {unit}. {figures}.").format(unit=unit, figures=figures)
    return f"{sentence} {unread_note()}" if DAGGER in figures else sentence


def unread_note() -> str:
    """What the dagger means beside a published figure."""
    return tr("{dagger}: fewer than two sources could be read.").format(dagger=DAGGER)

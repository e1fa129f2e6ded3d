"""A walk compared with what is shown beside it, in the answer's table and key figures."""

from collections.abc import Sequence
from dataclasses import replace

from app.results.compared_table import head_cell, value_cell
from app.results.compared_words import (
    change_in_words,
    difference_sentence,
    evidence_of,
    interval_of,
    is_judged,
    largest_sentence,
    why_not_reported,
)
from app.summary.answer import Answer, Outcome
from app.summary.comparison import Compared, Comparison
from app.summary.numbers_in_words import NOTHING, in_words, judged_in_words
from app.summary.plain_text import shortened
from app.widgets.fact_strip import KeyFigure
from app.widgets.table import TableColumn, TableRow
from app.widgets.table_cells import CENTRE, EMPTY, RIGHT, ErrorStrip, TableCell, TextCell
from app.widgets.text import REGULAR, SEMIBOLD
from app.wording.body import side_name
from app.wording.translation import tr
from core.verdicts.measurement_error import Judgement

LONGEST_TITLE, LONGEST_HEAD = 28, 20  # letters of a walk's name, over the measures and over its figures
SCALE = 1.8  # errors, to either edge of a strip


def beside_columns(found: Comparison) -> list[TableColumn]:
    """The leg, the measure, this walk, the other, and what their difference is worth.

    A name that somebody typed at length is cut here; the sentence over the curves has it whole.
    """
    heads, beside = (tr("this walk"), found.against.name, tr("change")), tr("Versus {walk}")
    title = TextCell(
        beside.format(walk=shortened(found.against.name, LONGEST_TITLE)),
        weight=SEMIBOLD,
        spoken=beside.format(walk=found.against.name),
    )
    return [
        TableColumn(),
        TableColumn(title, share=3),
        *(TableColumn(head_cell(shortened(head, LONGEST_HEAD), spoken=head), share=1) for head in heads),
        TableColumn(TextCell(tr("grey: error"), align=CENTRE, size=12, tone="ink2"), share=2),
        TableColumn(head_cell(tr("likely between")), share=1),
        TableColumn(TextCell(tr("result"), size=12, tone="ink2"), share=1),
    ]


def beside_rows(found: Comparison) -> list[TableRow]:
    """What differs by most errors first, then what is not judged, then what may not be reported."""
    ordered = sorted(found.rows, key=lambda row: (not row.is_reported, not is_judged(row), -row.difference.ratio))
    return [_row(row) for row in ordered]


def key_figures_beside(figures: Sequence[KeyFigure], found: Comparison) -> list[KeyFigure]:
    """The walk's key figures, each with its change and what that is worth in place of its band."""
    reported = []
    for figure in figures:
        rows = [row for row in found.rows if row.measure.column == figure.key]
        if figure.value == NOTHING or not rows:
            reported.append(figure)
            continue
        note = ", ".join(_in_short(row) for row in rows)
        words = tr("{name}: {value}, {change} versus {walk}.").format(
            name=figure.name, value=f"{figure.value} {figure.unit}".strip(), change=note, walk=found.against.name
        )
        reported.append(replace(figure, note=note, words=words))
    return reported


def answer_beside(found: Comparison) -> Answer:
    """What differs by most errors as a sentence, or that nothing does; the legs' answer is of this walk alone."""
    walk = found.against.name
    reported = [row for row in found.rows if is_judged(row)]
    worth = [row for row in reported if row.difference.is_worth_a_sentence]
    if worth:
        most = max(worth, key=lambda row: row.difference.ratio)
        first = difference_sentence(most, tr("in this walk"), tr("in {part}").format(part=walk))
        return Answer(Outcome.DIFFERS, first, evidence_of(most))
    if not reported:
        return Answer(Outcome.OPEN, tr("Nothing can be compared with {walk}.").format(walk=walk), "")
    most = max(reported, key=lambda row: row.difference.ratio)
    if any(row.exceeds for row in reported):
        first = tr("Some changes from {walk} are beyond measurement error, but none clearly so.")
        then = f"{tr('The table marks these changes.')} {largest_sentence(most)}"
        return Answer(Outcome.OPEN, first.format(walk=walk), then)
    first = tr("All judged changes from {walk} are within measurement error.").format(walk=walk)
    return Answer(Outcome.NOTHING, first, largest_sentence(most))


def _in_short(row: Compared) -> str:
    """The change of the walk with its verdict; of one leg, which has two beside one another, without it."""
    if not row.is_reported:
        return why_not_reported(row)
    change = change_in_words(row.difference.difference, row.measure)
    leg = "" if row.measure.is_of_walk else row.side.letter
    return " ".join(filter(None, [leg, change, "" if leg else in_words(row.difference)]))


def _row(row: Compared) -> TableRow:
    found, measure = row.difference, row.measure
    weight = SEMIBOLD if row.exceeds else REGULAR
    name = tr(measure.name)
    who = name if measure.is_of_walk else f"{row.side.letter} {name}"
    values = [value_cell(*part.figure(measure, row.side), measure.decimals) for part in (row.part, row.against)]
    heads = (tr("this walk"), row.against.name)
    change = change_in_words(found.difference, measure) if row.is_reported else ""
    return TableRow(
        (
            EMPTY if measure.is_of_walk else TextCell(side=row.side, spoken=side_name(row.side)),
            TextCell(name, weight=weight),
            *(replace(cell, spoken=f"{who}, {head}: {cell.words}") for head, cell in zip(heads, values, strict=True)),
            TextCell(
                change,
                align=RIGHT,
                weight=weight,
                spoken=f"{who}, {tr('change')}: {change}" if change else "",
            ),
            _strip(row),
            TextCell(interval_of(row), align=RIGHT, tone="ink2"),
            TextCell(
                in_words(found) if row.is_reported else why_not_reported(row),
                size=12,
                weight=weight,
                tone="ink" if row.exceeds else "ink2",
            ),
        )
    )


def _strip(row: Compared) -> TableCell:
    found = row.difference
    if not row.is_reported:
        return TextCell(tr("difference not reported"), align=CENTRE, size=12, tone="ink2")
    if not is_judged(row):
        word = tr("too few strides") if found.judgement is Judgement.TOO_FEW_STRIDES else tr("no published error")
        return TextCell(word, align=CENTRE, size=12, tone="ink2")
    return ErrorStrip(found.difference, found.error, SCALE * found.error, is_judged=True, spoken=judged_in_words(found))

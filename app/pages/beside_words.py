"""A walk against what stands beside it, in the answer's table and key figures."""

from collections.abc import Sequence
from dataclasses import replace

from app.icons import Icon
from app.pages.compared_words import change_in_words, value_cell, why_not_told
from app.reports.comparison import CADENCE, Compared, Comparison
from app.reports.patient_report.numbers_in_words import DAGGER, NOTHING, fixed, in_words, judged_in_words
from app.widgets.chip import LETTERS
from app.widgets.fact_strip import KeyFigure
from app.widgets.table import TableColumn, TableRow
from app.widgets.table_cells import CENTRE, EMPTY, RIGHT, ErrorStrip, TableCell, TextCell
from app.widgets.text import REGULAR, SEMIBOLD
from app.wording import side_name, tr
from core.verdicts.measurement_error import Judgement

SCALE = 1.8  # errors, to either edge of a strip
JUDGED = (Judgement.EXCEEDS_ERROR, Judgement.INSIDE_ERROR)


def beside_columns(found: Comparison) -> list[TableColumn]:
    """The leg, the measure, this walk, the other, and what their difference is worth."""
    heads = (tr("this walk"), found.against.name, tr("change"))
    return [
        TableColumn(),
        TableColumn(TextCell(tr("Beside {walk}").format(walk=found.against.name), weight=SEMIBOLD), share=3),
        *(TableColumn(TextCell(head, align=RIGHT, size=12, tone="ink2"), share=1) for head in heads),
        TableColumn(TextCell(tr("grey: error"), align=CENTRE, size=12, tone="ink2"), share=2),
        TableColumn(TextCell(tr("error"), align=RIGHT, size=12, tone="ink2"), share=1),
        TableColumn(TextCell(tr("in words"), size=12, tone="ink2"), share=1),
    ]


def beside_rows(found: Comparison) -> list[TableRow]:
    """What differs by most errors first, then what is not judged, then what may not be told."""
    ordered = sorted(found.rows, key=lambda row: (not row.is_told, not _is_judged(row), -row.difference.ratio))
    return [_row(row) for row in ordered]


def key_figures_beside(figures: Sequence[KeyFigure], found: Comparison) -> list[KeyFigure]:
    """The walk's key figures, each with its change and what that is worth in place of its band."""
    columns = {
        tr("Walking speed"): "speed_m_s",
        tr("Cadence"): CADENCE,
        tr("Stride length"): "stride_length_m",
    }
    told = []
    for figure in figures:
        rows = [row for row in found.rows if row.measure.column == columns.get(figure.name)]
        if figure.value == NOTHING or not rows:
            told.append(figure)
            continue
        note = ", ".join(_in_short(row) for row in rows)
        words = tr("{name}: {value}, {change} beside {walk}.").format(
            name=figure.name, value=f"{figure.value} {figure.unit}".strip(), change=note, walk=found.against.name
        )
        told.append(replace(figure, note=note, words=words))
    return told


def _in_short(row: Compared) -> str:
    """The change of the walk with its verdict; of one leg, which has two beside one another, without it."""
    if not row.is_told:
        return why_not_told(row)
    change = change_in_words(row.difference.difference, row.measure)
    leg = "" if row.measure.is_of_walk else LETTERS[row.side]
    return " ".join(filter(None, [leg, change, "" if leg else in_words(row.difference.judgement)]))


def _is_judged(row: Compared) -> bool:
    return row.difference.judgement in JUDGED


def _row(row: Compared) -> TableRow:
    found, measure = row.difference, row.measure
    weight = SEMIBOLD if row.exceeds else REGULAR
    name = tr(measure.name)
    who = name if measure.is_of_walk else f"{LETTERS[row.side]} {name}"
    values = [value_cell(*part.figure(measure, row.side), measure.decimals) for part in (row.part, row.against)]
    heads = (tr("this walk"), row.against.name)
    change = change_in_words(found.difference, measure) if row.is_told else ""
    return TableRow(
        (
            EMPTY if measure.is_of_walk else TextCell(side=row.side, spoken=side_name(row.side)),
            TextCell(name, weight=weight),
            *(replace(cell, spoken=f"{who}, {head}: {cell.words}") for head, cell in zip(heads, values, strict=True)),
            TextCell(
                change,
                align=RIGHT,
                weight=weight,
                mark=Icon.WARNING if row.exceeds else None,
                spoken=f"{who}, {tr('change')}: {change}" if change else "",
            ),
            _strip(row),
            TextCell(_error(row), align=RIGHT, tone="ink2"),
            TextCell(
                in_words(found.judgement) if row.is_told else why_not_told(row),
                size=12,
                weight=weight,
                tone="ink" if row.exceeds else "ink2",
            ),
        )
    )


def _strip(row: Compared) -> TableCell:
    found = row.difference
    if not row.is_told:
        return TextCell(tr("no difference is given"), align=CENTRE, size=12, tone="ink2")
    if not _is_judged(row):
        word = tr("too few strides") if found.judgement is Judgement.TOO_FEW_STRIDES else tr("no published error")
        return TextCell(word, align=CENTRE, size=12, tone="ink2")
    return ErrorStrip(found.difference, found.error, SCALE * found.error, is_judged=True, spoken=judged_in_words(found))


def _error(row: Compared) -> str:
    if not row.is_told or not _is_judged(row):
        return NOTHING
    unit = row.measure.unit if row.measure.unit == "°" else ""
    return fixed(row.difference.error, row.measure.decimals) + unit + (DAGGER if row.difference.is_unverified else "")

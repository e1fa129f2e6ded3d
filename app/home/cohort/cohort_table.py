"""The groups of a question as a table; what has no room on a narrow page is in the file."""

from app.cohort.study.groups import GroupAnswer, GroupRow
from app.cohort.study.measures import MeasureWords, measure_words
from app.home.cohort.cohort_text import figure, group_name, grouping_word, interval_in_words
from app.widgets.table import TableColumn, TableRow
from app.widgets.table_cells import RIGHT, TableCell, TextCell
from app.wording.translation import tr

MOST_ROWS = 100  # who has more groups reads the file
LONGEST_NAME, LONGEST_IF_NARROW = 44, 24  # letters; the whole is under the mouse
FIGURE = 15


def groups_table(found: GroupAnswer, *, is_narrow: bool) -> tuple[list[TableColumn], list[TableRow]]:
    """The columns, and a row for each of the first groups."""
    words = measure_words(found.question.measure)
    longest = LONGEST_IF_NARROW if is_narrow else LONGEST_NAME
    heads = (
        (tr("Sessions"), False),
        (tr("Walks"), True),
        (_with_unit(tr("Mean"), words.unit), False),
        (tr("SD"), True),
        (tr("95 % interval"), False),
        (tr("Measurement error"), True),
        (tr("Excluded"), False),
    )
    columns = [TableColumn(_head(grouping_word(found.question.grouping), is_first=True), share=1)]
    columns += [TableColumn(_head(head), is_hidden=is_narrow and is_extra) for head, is_extra in heads]
    return columns, [_row(found, row, words, longest) for row in found.rows[:MOST_ROWS]]


def _row(found: GroupAnswer, row: GroupRow, words: MeasureWords, longest: int) -> TableRow:
    name, decimals = group_name(found.question.grouping, row.group), words.decimals
    out = row.withheld + row.with_care + row.not_measured
    shown = name if len(name) <= longest else f"{name[: longest - 1]}…"
    cells = (
        (tr("Sessions"), str(row.sessions)),
        (tr("Walks"), str(row.walks)),
        (tr("Mean"), figure(row.mean, decimals)),
        (tr("SD"), figure(row.sd, decimals)),
        (tr("95 % interval"), interval_in_words(row, decimals)),
        (tr("Measurement error"), figure(row.value_error, decimals)),
        (tr("Excluded"), str(out)),
    )
    reported = tr(
        "{group}. Excluded (counted per leg and walk): {withheld} not reported, {care} rated caution, "
        "{missing} not measured. Sessions without a value: {sessions}."
    )
    hint = reported.format(
        group=name,
        withheld=row.withheld,
        care=row.with_care,
        missing=row.not_measured,
        sessions=row.sessions_without,
    )
    described = [TextCell(shown, spoken=name), *(_cell(value, f"{name}, {head}") for head, value in cells)]
    return TableRow(tuple(described), hint=hint)


def _cell(value: str, whose: str) -> TableCell:
    stated = value or tr("no value")
    return TextCell(
        value or "–", align=RIGHT, size=FIGURE, spoken=f"{whose}: {stated}", tone="ink" if value else "ink3"
    )


def _head(words: str, *, is_first: bool = False) -> TextCell:
    return TextCell(words, size=12, tone="ink2") if is_first else TextCell(words, size=12, tone="ink2", align=RIGHT)


def _with_unit(words: str, unit: str) -> str:
    return f"{words}, {unit}" if unit else words

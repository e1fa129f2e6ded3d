"""How does a comparison stand on the screen? Its rows, its dots, and a sentence for what lies beyond the error."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from app.charts.cycles import is_mean_enough, is_spread_enough
from app.gates_in_words import verdict_word
from app.icons import Icon
from app.plots.difference_plot import DifferenceRow, Dot
from app.recording_names import name_in_words
from app.reports.comparison import Compared, Comparison, Measure, Part, Reservation, SideRow
from app.reports.patient_report.numbers_in_words import fixed, signed
from app.reports.walk_figures import reason_in_words
from app.widgets.chip import LETTERS
from app.widgets.figures_table import CARE_MARK, FIGURE
from app.widgets.table import TableColumn, TableRow
from app.widgets.table_cells import EMPTY, RIGHT, TextCell
from app.widgets.text import REGULAR, SEMIBOLD
from app.wording import capitalised, side_name, tr
from core.body import Joint, Side
from core.gait.spatiotemporal import MeanAndSd
from core.verdicts.measurement_error import Difference, Judgement
from core.verdicts.model import Verdict

MINUS = "\N{MINUS SIGN}"
LONGEST_LETTER = 4  # of parts: "C", "12", "12A"
DASH = "\N{EN DASH}"
DAGGER = "\N{DAGGER}"
NO_DAYS: Mapping[str, str] = {}
WALK_FIRST = {"speed_m_s": 0, "cadence_steps_min": 1, "stride_length_m": 2}  # the rows of a table


def part_in_words(part: Part) -> str:
    """A part's letter and name, and how many strides it has of each leg."""
    strides = ", ".join(f"{LETTERS[side]} {part.strides(side)}" for side in part.sides)
    name = f"{part.letter} {name_in_words(part.name)}"
    return f"{name} · {strides}" if strides else name


def change_in_words(value: float, measure: Measure) -> str:
    """A difference with its sign; the unit is in the measure's name or the title."""
    return signed(value, measure.decimals) + (measure.unit if measure.unit == "°" else "")


def plot_row(side: Side, rows: Sequence[Compared]) -> DifferenceRow:
    """One measure of one leg, a dot for each part."""
    told = [row for row in rows if row.is_told]
    dots = tuple(Dot(row.part.letter, row.difference.difference, row.exceeds) for row in told)
    if not told:
        return DifferenceRow(side, why_not_told(rows[-1]), (), math.nan)
    last = told[-1]
    words = f"{last.part.letter} {change_in_words(last.difference.difference, last.measure)}"
    return DifferenceRow(side, words, dots, last.difference.error)


def comparison_heads(found: Comparison) -> list[str]:
    """What stands over the values of all parts, their differences, and the error of the last of these."""
    others = [part.letter for part in found.others]
    changes = [f"{letter} {MINUS} {found.against.letter}" for letter in others]
    error = tr("error") if len(others) < 2 else tr("error of {letter}").format(letter=others[-1])
    return [*(part.letter for part in found.parts), *changes, error]


def table_columns(heads: Sequence[str], *, has_sides: bool, days: Mapping[str, str] = NO_DAYS) -> list[TableColumn]:
    """The legs where rows are of one of them, the names, and `heads` over values, differences and errors.

    `days`: which day a head stands for.
    """
    columns = [TableColumn(TextCell(head, days.get(head, ""), align=RIGHT, size=12, tone="ink2")) for head in heads]
    return [TableColumn(is_hidden=not has_sides), TableColumn(share=1), *columns]


def table_rows(found: Comparison, heads: Sequence[str]) -> list[TableRow]:
    """Every measure of each leg: the values of all parts, their differences, and the error of the last of these."""
    rows: dict[tuple[str, Side], list[Compared]] = {}
    for row in sorted(found.rows, key=lambda row: WALK_FIRST.get(row.measure.column, len(WALK_FIRST))):
        rows.setdefault((row.measure.column, row.side), []).append(row)
    lines = []
    for (_, side), compared in rows.items():
        measure = compared[0].measure
        values = [value_cell(*part.figure(measure, side), measure.decimals) for part in found.parts]
        changes = [*(_changed(row, found.against) for row in compared), _error_cell(compared[-1])]
        lines.append(_table_row(tr(measure.name), None if measure.is_of_walk else side, heads, (*values, *changes)))
    return lines


def why_not_told(row: Compared | SideRow) -> str:
    """Why a difference has no figure."""
    if isinstance(row, Compared) and row.reservation is Reservation.OTHER_ZERO:
        return tr("no zero")
    withheld = isinstance(row, Compared) and row.reservation is Reservation.WITHHELD
    is_withheld = withheld or row.difference.judgement is Judgement.WITHHELD
    return verdict_word(Verdict.WITHHELD) if is_withheld else tr("no value")


def withheld_in_words(part: Part, joint: Joint) -> str:
    """Why a part's curve is not drawn."""
    pattern = tr("{letter}: withheld. {reason}")
    return pattern.format(letter=part.letter, reason=reason_in_words(part.verdicts.joint(joint)))


def side_table_row(row: SideRow, heads: Sequence[str]) -> TableRow:
    """One measure of both legs, their difference with its error, and symmetry."""
    symmetry = f"{row.symmetry_percent:+.1f}".replace("-", MINUS) if math.isfinite(row.symmetry_percent) else DASH
    each = zip((row.first, row.second), row.verdicts, strict=True)
    values = [value_cell(value, verdict, row.measure.decimals) for value, verdict in each]
    return _table_row(tr(row.measure.name), None, heads, (*values, _changed(row), _error_cell(row), _figure(symmetry)))


def _table_row(name: str, side: Side | None, heads: Sequence[str], cells: Sequence[TextCell]) -> TableRow:
    """A row whose cells say which leg, measure and part they are of, for who hears one cell at a time."""
    chip = EMPTY if side is None else TextCell(side=side, spoken=side_name(side))
    who = name if side is None else f"{LETTERS[side]} {name}"
    said = (replace(cell, spoken=f"{who}, {head}: {cell.words}") for head, cell in zip(heads, cells, strict=True))
    return TableRow((chip, TextCell(name), *said))


def _figure(value: str, small: str = "", *, is_marked: bool = False, is_grey: bool = False) -> TextCell:
    """A value and what stands smaller behind it; marked: beyond the error; grey: not to be relied on."""
    return TextCell(
        value,
        small,
        align=RIGHT,
        size=FIGURE,
        weight=SEMIBOLD if is_marked else REGULAR,
        tone="ink3" if is_grey else "ink",
        mark=Icon.WARNING if is_marked else None,
    )


def value_cell(value: MeanAndSd, verdict: Verdict, decimals: int) -> TextCell:
    """A mean with its spread, grey from few strides; where it may not be told, that alone."""
    if verdict is Verdict.WITHHELD:
        return TextCell(small=verdict_word(verdict), align=RIGHT, mark=Icon.WITHHELD)
    if not value.n:
        return _figure(DASH, is_grey=True)
    spread = f"± {fixed(value.sd, decimals)}" if is_spread_enough(value.n) else ""
    spread = f"{spread} {CARE_MARK}".lstrip() if verdict is Verdict.CARE else spread
    return _figure(fixed(value.mean, decimals), spread, is_grey=not is_mean_enough(value.n))


def _changed(row: Compared | SideRow, against: Part | None = None) -> TextCell:
    """A difference; where it is not told against the part that the others are, that is said beside it."""
    if not row.is_told:
        return _figure(DASH, is_grey=True)  # the values beside it say why
    words = change_in_words(row.difference.difference, row.measure)
    doubt = _doubt(row.difference)
    if against is not None and isinstance(row, Compared) and row.against is not against:
        doubt = " ".join(filter(None, [tr("from {letter}").format(letter=row.against.letter), doubt]))
    return _figure(words, doubt, is_marked=row.exceeds)


def _error_cell(row: Compared | SideRow) -> TextCell:
    """What a difference must exceed; nothing where none was judged."""
    is_judged = row.is_told and row.difference.error > 0
    degree = "°" if row.measure.unit == "°" else ""  # as its difference: other units are in the measure's name
    words = fixed(row.difference.error, row.measure.decimals) + degree
    return replace(_figure(words if is_judged else DASH), tone="ink2")


def _doubt(found: Difference) -> str:
    if found.judgement is Judgement.TOO_FEW_STRIDES:
        return tr("few strides")
    if found.judgement is Judgement.NO_PUBLISHED_FIGURE:
        return tr("not judged")
    return DAGGER if found.is_unverified else ""


def weight(row: Compared) -> tuple[list[int], float]:
    """What is said first: of the latest part what lies furthest beyond the error."""
    return [-ord(one) for one in row.part.letter.rjust(LONGEST_LETTER)], -row.difference.ratio


def side_weight(row: SideRow) -> float:
    return -row.difference.ratio


def sentence(row: Compared) -> str:
    """A difference that lies beyond the measurement error."""
    pattern = tr("{measure} {change} from {first} to {last}: larger than its error ({error}).")
    if not row.measure.is_of_walk:
        pattern = tr("{side} {measure} {change} from {first} to {last}: larger than its error ({error}).")
    measure = tr(row.measure.name)
    return pattern.format(
        side=capitalised(side_name(row.side)),
        measure=measure if row.measure.is_of_walk else measure[0].lower() + measure[1:],
        change=change_in_words(row.difference.difference, row.measure),
        first=row.against.letter,
        last=row.part.letter,
        error=_error(row.difference.error, row.measure),
    )


def side_sentence(row: SideRow, first: Side, second: Side) -> str:
    """A difference between the legs that lies beyond the measurement error."""
    pattern = tr("{measure} {change}, {first} against {second}: larger than its error ({error}).")
    return pattern.format(
        measure=tr(row.measure.name),
        change=change_in_words(row.difference.difference, row.measure),
        first=LETTERS[first],
        second=LETTERS[second],
        error=_error(row.difference.error, row.measure),
    )


def _error(value: float, measure: Measure) -> str:
    return fixed(value, measure.decimals) + (
        measure.unit if measure.unit == "°" else f"\N{NO-BREAK SPACE}{measure.unit}"
    )

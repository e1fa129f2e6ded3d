"""How does a comparison stand on the screen? Its rows, its dots, and a sentence for what lies beyond the error."""

import math
from collections.abc import Sequence

from app.plots.difference_plot import DifferenceRow, Dot
from app.reports.comparison import Compared, Comparison, Measure, Part, Reservation, SideRow
from app.reports.walk_figures import is_mean_enough, is_spread_enough
from app.widgets.chip import LETTERS
from app.widgets.difference_table import Cell, DifferenceTableRow
from app.wording import capitalised, side_name, tr
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.verdicts.measurement_error import Judgement

MINUS = "\N{MINUS SIGN}"
DASH = "\N{EN DASH}"


def part_in_words(part: Part) -> str:
    """A part's letter and name, and how many strides it has of each leg."""
    strides = ", ".join(f"{LETTERS[side]} {part.strides(side)}" for side in part.sides)
    return f"{part.letter} {part.name} · {strides}" if strides else f"{part.letter} {part.name}"


def change_in_words(value: float, measure: Measure) -> str:
    """A difference with its sign; the unit is in the measure's name or the title."""
    said = f"{value:+.1f}"
    unit = measure.unit if measure.unit == "°" else ""
    return ("0.0" if float(said) == 0 else said.replace("-", MINUS)) + unit


def plot_row(side: Side, rows: Sequence[Compared]) -> DifferenceRow:
    """One measure of one leg, a dot for each part."""
    told = [row for row in rows if row.is_told]
    dots = tuple(Dot(row.part.letter, row.difference.difference, row.exceeds) for row in told)
    if not told:
        is_height = any(row.reservation is Reservation.OTHER_ZERO for row in rows)
        return DifferenceRow(side, tr("no zero") if is_height else tr("no value"), (), math.nan)
    last = told[-1]
    words = f"{last.part.letter} {change_in_words(last.difference.difference, last.measure)}"
    return DifferenceRow(side, words, dots, last.difference.error)


def table_rows(found: Comparison) -> list[DifferenceTableRow]:
    """Every measure of each leg: the values of all parts, then their differences."""
    rows: dict[tuple[str, Side], list[Compared]] = {}
    for row in found.rows:
        rows.setdefault((row.measure.column, row.side), []).append(row)
    lines = []
    for (_, side), compared in rows.items():
        measure = compared[0].measure
        values = [_value(part.value(side, measure.column)) for part in found.parts]
        changes = [_changed(row) for row in compared]
        lines.append(DifferenceTableRow(tr(measure.name), side, (*values, *changes)))
    return lines


def side_table_row(row: SideRow) -> DifferenceTableRow:
    """One measure of both legs, their difference and symmetry."""
    symmetry = f"{row.symmetry_percent:+.1f}".replace("-", MINUS) if math.isfinite(row.symmetry_percent) else DASH
    return DifferenceTableRow(
        tr(row.measure.name), None, (_value(row.first), _value(row.second), _changed(row), Cell(symmetry))
    )


def _value(value: MeanAndSd) -> Cell:
    if not value.n:
        return Cell(DASH, is_grey=True)
    spread = f"± {value.sd:.1f}" if is_spread_enough(value.n) else ""
    mean = f"{value.mean:.1f}"
    return Cell("0.0" if float(mean) == 0 else mean.replace("-", MINUS), spread, is_grey=not is_mean_enough(value.n))


def _changed(row: Compared | SideRow) -> Cell:
    if not row.is_told:
        return Cell(DASH, is_grey=True)
    words = change_in_words(row.difference.difference, row.measure)
    return Cell(words, _doubt(row.difference.judgement), row.exceeds)


def _doubt(verdict: Judgement) -> str:
    if verdict is Judgement.TOO_FEW_STRIDES:
        return tr("few strides")
    return tr("not judged") if verdict is Judgement.NO_PUBLISHED_FIGURE else ""


def weight(row: Compared) -> tuple[int, float]:
    """What is said first: of the latest part what lies furthest beyond the error."""
    return -ord(row.part.letter), -abs(row.difference.difference) / row.difference.error


def sentence(row: Compared) -> str:
    """A difference that lies beyond the measurement error."""
    pattern = tr("{side} {measure} {change} from {first} to {last}: beyond measurement error ({error}).")
    measure = tr(row.measure.name)
    return pattern.format(
        side=capitalised(side_name(row.side)),
        measure=measure[0].lower() + measure[1:],
        change=change_in_words(row.difference.difference, row.measure),
        first=row.against.letter,
        last=row.part.letter,
        error=_error(row.difference.error, row.measure),
    )


def side_sentence(row: SideRow, first: Side, second: Side) -> str:
    """A difference between the legs that lies beyond the measurement error."""
    pattern = tr("{measure} {change}, {first} against {second}: beyond measurement error ({error}).")
    return pattern.format(
        measure=tr(row.measure.name),
        change=change_in_words(row.difference.difference, row.measure),
        first=LETTERS[first],
        second=LETTERS[second],
        error=_error(row.difference.error, row.measure),
    )


def _error(value: float, measure: Measure) -> str:
    return f"{value:.1f}" + ("°" if measure.unit == "°" else "\N{NO-BREAK SPACE}%")

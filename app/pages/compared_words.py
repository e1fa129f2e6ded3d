"""How does a comparison stand on the screen? Its rows, its dots, and a sentence for what lies beyond the error."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.gates_in_words import verdict_word
from app.plots.compared_chart import Line
from app.plots.difference_plot import DifferenceRow, Dot
from app.reports.comparison import Compared, Comparison, Measure, Part, Reservation, SideRow
from app.reports.walk_figures import is_mean_enough, is_spread_enough, reason_in_words
from app.widgets.chip import LETTERS
from app.widgets.difference_table import Cell, DifferenceTableRow
from app.widgets.figures_table import CARE_MARK
from app.wording import capitalised, side_name, tr
from core.body import Joint, Side
from core.gait.spatiotemporal import MeanAndSd
from core.verdicts.measurement_error import Difference, Judgement
from core.verdicts.model import Verdict

MINUS = "\N{MINUS SIGN}"
DASH = "\N{EN DASH}"
DAGGER = "\N{DAGGER}"


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
        return DifferenceRow(side, why_not_told(rows[-1]), (), math.nan)
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
        values = [_value(part.value(side, measure.column), _verdict(part, side, measure)) for part in found.parts]
        changes = [_changed(row) for row in compared]
        lines.append(DifferenceTableRow(tr(measure.name), side, (*values, *changes)))
    return lines


def why_not_told(row: Compared | SideRow) -> str:
    """Why a difference has no figure."""
    if isinstance(row, Compared) and row.reservation is Reservation.OTHER_ZERO:
        return tr("no zero")
    withheld = isinstance(row, Compared) and row.reservation is Reservation.WITHHELD
    is_withheld = withheld or row.difference.judgement is Judgement.WITHHELD
    return verdict_word(Verdict.WITHHELD) if is_withheld else tr("no value")


def line_of(part: Part, joint: Joint, *, is_about_mean: bool) -> Line:
    """A part's mean cycle; without its height where that says nothing beside the others'."""
    found = part.cycle(joint)
    mean = replace(found, mean=found.mean - np.mean(found.mean)) if is_about_mean and found.n else found
    return Line(part.letter, mean, part.stance_percent(joint.side))


def withheld_in_words(part: Part, joint: Joint) -> str:
    """Why a part's curve is not drawn."""
    pattern = tr("{letter}: withheld. {reason}")
    return pattern.format(letter=part.letter, reason=reason_in_words(part.verdicts.joint(joint)))


def side_table_row(row: SideRow) -> DifferenceTableRow:
    """One measure of both legs, their difference and symmetry."""
    symmetry = f"{row.symmetry_percent:+.1f}".replace("-", MINUS) if math.isfinite(row.symmetry_percent) else DASH
    return DifferenceTableRow(
        tr(row.measure.name),
        None,
        (_value(row.first, row.verdicts[0]), _value(row.second, row.verdicts[1]), _changed(row), Cell(symmetry)),
    )


def _verdict(part: Part, side: Side, measure: Measure) -> Verdict:
    is_measured = part.is_measured(side, measure)
    return part.assessment(side, measure.column).verdict if is_measured else Verdict.NOT_MEASURED


def _value(value: MeanAndSd, verdict: Verdict = Verdict.READ) -> Cell:
    if verdict is Verdict.WITHHELD:
        return Cell(verdict_word(verdict), is_grey=True)
    if not value.n:
        return Cell(DASH, is_grey=True)
    spread = f"± {value.sd:.1f}" if is_spread_enough(value.n) else ""
    spread = f"{spread} {CARE_MARK}".lstrip() if verdict is Verdict.CARE else spread
    mean = f"{value.mean:.1f}"
    return Cell("0.0" if float(mean) == 0 else mean.replace("-", MINUS), spread, is_grey=not is_mean_enough(value.n))


def _changed(row: Compared | SideRow) -> Cell:
    if not row.is_told:
        return Cell(DASH, is_grey=True)  # the values beside it say why
    words = change_in_words(row.difference.difference, row.measure)
    return Cell(words, _doubt(row.difference), row.exceeds)


def _doubt(found: Difference) -> str:
    if found.judgement is Judgement.TOO_FEW_STRIDES:
        return tr("few strides")
    if found.judgement is Judgement.NO_PUBLISHED_FIGURE:
        return tr("not judged")
    return DAGGER if found.is_unverified else ""


def weight(row: Compared) -> tuple[int, float]:
    """What is said first: of the latest part what lies furthest beyond the error."""
    return -ord(row.part.letter), -row.difference.ratio


def side_weight(row: SideRow) -> float:
    return -row.difference.ratio


def sentence(row: Compared) -> str:
    """A difference that lies beyond the measurement error."""
    pattern = tr("{side} {measure} {change} from {first} to {last}: larger than its error ({error}).")
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
    pattern = tr("{measure} {change}, {first} against {second}: larger than its error ({error}).")
    return pattern.format(
        measure=tr(row.measure.name),
        change=change_in_words(row.difference.difference, row.measure),
        first=LETTERS[first],
        second=LETTERS[second],
        error=_error(row.difference.error, row.measure),
    )


def _error(value: float, measure: Measure) -> str:
    return f"{value:.1f}" + ("°" if measure.unit == "°" else "\N{NO-BREAK SPACE}%")

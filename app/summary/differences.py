"""Tables of how much conditions, visits or legs differ, and whether that is more than the measurement error.

`rows_of` reports every figure of a stride, those of both legs, and how far the mean curves lie apart; screen and
report show some of them.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from app.summary.agreed import agreed_with
from app.summary.comparison import Comparison, Contrast, Reservation, compare_legs
from app.summary.conditions import Part, conditions_of
from app.summary.measures import MEASURES, Measure
from app.summary.visits import by_condition
from app.system.tables import figure_cell, typed_cell, write_table
from core.body import Joint, Side
from core.gait.cycles import POINTS
from core.gait.spatiotemporal import MeanAndSd
from core.gait.symmetry import curve_difference, symmetry_index_percent
from core.parameters import BY_COLUMN, ParameterFile, QuantityClass, columns_of
from core.results import Analysis
from core.session import Session
from core.verdicts.measurement_error import Difference, Judgement
from core.verdicts.model import Verdict, together
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN
from core.verdicts.quantities import OF_BOTH, assessment_of_both
from core.verdicts.status import status_of

DIFFERENCES = "differences.csv"
COMPARED_CYCLES = "compared_cycles.csv"
SIDES = "sides.csv"
OF_PART = ("part", "name", "walks")
JUDGED = ("difference", "error", "error_sources", "status", "verdict")
LIKELY = ("low", "high", "beyond_speed", "beyond_speed_low", "beyond_speed_high", "mark", "healthy_limit")
OF_CURVE = ("mean_deg", "stride_sd_deg", "n", "shape_deg", "status")
HEADER = (
    *OF_PART,
    *(f"against_{what}" for what in OF_PART),
    *("side", "parameter", "n", "mean", "sd", "against_n", "against_mean", "against_sd"),
    *JUDGED,
    *("left_out_by_hand", "against_left_out_by_hand", "chosen_before"),
    *LIKELY,
)

OF_WALKS = {measure.column: measure for measure in MEASURES if measure.is_of_walk}

# of hips and pelvis no error of a difference is known: none is judged
COMPARED = columns_of(ParameterFile.STRIDES, ParameterFile.PEAKS, ParameterFile.FITTING, ParameterFile.PELVIS)
SIGNED = ("foot_pitch_at_contact_deg",)  # 0 is not the least of it: a share of it means nothing

NOT_REPORTED = Difference(math.nan, math.nan, Judgement.NOT_REPORTED)


@dataclass(frozen=True, slots=True)
class Row:
    """One figure of `part` and of the one it is compared with. `side` None: of both. NaN where it is not known.

    `status` is the worse of what may be stated about the two.
    """

    part: Part
    against: Part
    side: Side | None
    parameter: str
    value: MeanAndSd
    other: MeanAndSd
    difference: Difference
    status: Verdict


def comparisons_of(visits: Sequence[tuple[Session, Analysis]]) -> list[Comparison]:
    """Compare conditions within each visit, then each later visit with the first, in the same condition only."""
    of_visits = []
    for number, (session, analysis) in enumerate(visits, start=1):
        prefix = str(number) if len(visits) > 1 else ""
        of_visits.append(conditions_of(analysis, session.recordings, prefix, agreed_with(session)))
    are_simulated = [analysis.is_simulated for _, analysis in visits]
    found = [
        Comparison(Contrast.CONDITIONS, parts, is_simulated=is_simulated)
        for parts, is_simulated in zip(of_visits, are_simulated, strict=True)
        if len(parts) > 1
    ]
    walked = _by_condition(visits)
    for of_visit, is_simulated in list(zip(walked, are_simulated, strict=True))[1:]:
        for condition in [condition for condition in of_visit if condition in walked[0]]:
            pair = (walked[0][condition], of_visit[condition])
            found.append(Comparison(Contrast.VISITS, pair, is_simulated=is_simulated or are_simulated[0]))
    return found


def without_common_condition(visits: Sequence[tuple[Session, Analysis]]) -> list[int]:
    """Numbers, from 1, of the later visits that have strides, but under no condition of the first."""
    walked = _by_condition(visits)
    return [
        number
        for number, of_visit in enumerate(walked, start=1)
        if number > 1 and of_visit and not of_visit.keys() & walked[0].keys()
    ]


def _by_condition(visits: Sequence[tuple[Session, Analysis]]) -> list[Mapping[str, Part]]:
    return [
        by_condition(analysis, session.recordings, str(number), agreed_with(session))
        for number, (session, analysis) in enumerate(visits, start=1)
    ]


def rows_of(comparison: Comparison) -> Iterator[Row]:
    """Every figure measured both of a part and of the one it is compared with; without figures if not reported."""
    against = comparison.against
    for part in comparison.others:
        for side in Side:
            for column in COMPARED:
                found = comparison.compare(Measure(column), side, part)
                if found.reservation is Reservation.NOT_MEASURED:
                    continue
                status = together(one.assessment(side, column) for one in (part, against)).verdict
                if found.reservation is Reservation.NONE:
                    yield Row(part, against, side, column, found.value, found.other, found.difference, status)
                else:
                    yield Row(part, against, side, column, found.value, found.other, NOT_REPORTED, Verdict.NOT_REPORTED)
            yield from _curves(comparison, part, side)
        yield from _of_both(comparison, part)


def rows_along_chain(comparison: Comparison) -> Iterator[Row]:
    """The same, then each part against the one that its alignment was changed from, where that is another."""
    yield from rows_of(comparison)
    for part in comparison.others:
        if (base := comparison.base_of(part)) is not comparison.against:
            yield from rows_of(replace(comparison, parts=(base, part), base=0))


def write_differences(found: Iterable[Row], path: Path) -> None:
    """Write the table of differences as CSV; raises OSError."""
    write_table(HEADER, map(difference_cells, found), path)


def write_compared_cycles(parts: Sequence[Part], path: Path) -> None:
    """Write the mean cycles that are overlaid in the chart as CSV; raises OSError."""
    curves = [(part, joint) for joint in Joint for part in parts if joint in part.joints]
    cells = [list(_curve(part, joint)) for part, joint in curves]
    heads = [f"{part.letter}_{joint}_{of}" for part, joint in curves for of in OF_CURVE]
    lines = [[str(percent), *(cell for curve in cells for cell in curve[percent])] for percent in range(POINTS)]
    write_table(["percent", *heads], lines, path)


def _curve(part: Part, joint: Joint) -> Iterator[tuple[str, ...]]:
    """The cells of one mean curve, as in cycles.csv: of a joint without a height its shape alone."""
    stated, cycle = part.verdicts.joint(joint), part.cycle(joint)
    shape = cycle.mean - cycle.mean.mean()
    for percent in range(POINTS):
        height = float(cycle.mean[percent]) if stated.height.is_reported else math.nan
        known = (
            figure_cell(height),
            figure_cell(float(cycle.sd[percent])),
            str(cycle.n),
            figure_cell(float(shape[percent])),
        )
        yield (*known, status_of(stated))


def write_sides(parts: Sequence[Part], sides: tuple[Side, Side], path: Path) -> None:
    """Write each part's legs side by side, first of `sides` less second; nothing for one leg. Raises OSError."""
    header, lines = legs_table(parts, sides)
    if lines:
        write_table(header, lines, path)


def legs_table(parts: Sequence[Part], sides: tuple[Side, Side]) -> tuple[list[str], list[list[str]]]:
    """Header and rows of sides.csv."""
    each = [f"{side}_{what}" for side in sides for what in ("n", "mean", "sd")]
    by_hand = [f"{side}_left_out_by_hand" for side in sides]
    lines = []
    for part in parts:
        left_out = [str(part.left_out_by_hand(side)) for side in sides]
        for column in COMPARED:
            one, other = (part.value(side, column) for side in sides)
            if not all(part.is_measured(side, column) for side in sides):
                continue
            status = together(part.assessment(side, column) for side in sides).verdict
            is_size = BY_COLUMN[column].rests_on is not QuantityClass.HEIGHT and column not in SIGNED
            difference = compare_legs(part, column, sides)
            has_index = is_size and difference.is_reported and min(one.n, other.n) >= MIN_STRIDES_FOR_MEAN
            symmetry = symmetry_index_percent(one.mean, other.mean) if has_index else math.nan
            cells = [*_named(part), column, *_mean(one), *_mean(other)]
            judged = _judged(difference, status)
            lines.append([*cells, *judged, figure_cell(symmetry), *left_out, *_likely(difference)])
    return [*OF_PART, "parameter", *each, *JUDGED, "symmetry_index_percent", *by_hand, *LIKELY], lines


def _curves(comparison: Comparison, part: Part, side: Side) -> Iterator[Row]:
    """How far apart the mean curves lie on average, where both heights are from the same kind of zero."""
    nothing = MeanAndSd(math.nan, math.nan, 0)
    for joint in comparison.joints:
        if joint.side is not side or not comparison.has_one_zero(joint):
            continue
        stated = together(of.verdicts.joint(joint).height for of in (part, comparison.against))
        if not stated.is_reported:
            continue
        cycles = part.cycle(joint), comparison.against.cycle(joint)
        difference = curve_difference(cycles[0].mean, cycles[1].mean)
        if min(cycle.n for cycle in cycles) >= MIN_STRIDES_FOR_MEAN and math.isfinite(difference):
            name = f"{joint.kind}_curve_difference_deg"
            found = Difference(difference, math.nan, Judgement.NO_PUBLISHED_FIGURE)
            yield Row(part, comparison.against, side, name, nothing, nothing, found, stated.verdict)


def _of_both(comparison: Comparison, part: Part) -> Iterator[Row]:
    against = comparison.against
    for name in OF_BOTH:
        value, other = (MeanAndSd(one.of_both(name), math.nan, 0) for one in (part, against))
        status = together(assessment_of_both(one.verdicts, name) for one in (part, against)).verdict
        if status is Verdict.NOT_REPORTED:
            yield Row(part, against, None, name, value, other, NOT_REPORTED, status)
        elif math.isfinite(difference := value.mean - other.mean):
            found = Difference(difference, math.nan, Judgement.NO_PUBLISHED_FIGURE)
            if name in OF_WALKS:
                found = comparison.compare_walks(OF_WALKS[name], part, against).difference
            yield Row(part, against, None, name, value, other, found, status)


def difference_cells(row: Row) -> list[str]:
    """One row of differences.csv, by HEADER."""
    parts = [*_named(row.part), *_named(row.against)]
    side = "both" if row.side is None else str(row.side)
    judged = _judged(row.difference, row.status)
    by_hand = [str(part.left_out_by_hand(row.side)) for part in (row.part, row.against)]
    is_chosen = row.part.agreed.is_chosen(row.parameter, Side if row.side is None else (row.side,))
    figures = [*_mean(row.value), *_mean(row.other), *judged, *by_hand]
    return [*parts, side, row.parameter, *figures, str(is_chosen).lower(), *_likely(row.difference)]


def _named(part: Part) -> list[str]:
    return [part.letter, typed_cell(part.name), typed_cell("; ".join(walk.name for walk in part.walks))]


def _mean(value: MeanAndSd) -> list[str]:
    return [str(value.n) if value.n else "", figure_cell(value.mean), figure_cell(value.sd)]


def _judged(found: Difference, status: Verdict) -> list[str]:
    sources = " ".join(found.sources)
    return [figure_cell(found.difference), figure_cell(found.error), sources, str(status), str(found.judgement)]


def likely_figures(found: Difference) -> dict[str, float]:
    """Where a difference is likely to be, with what goes with speed and without, and the healthy limit; NaN unknown."""
    low, high = found.interval
    beyond, error = (found.by_speed.beyond, found.by_speed.error) if found.by_speed else (math.nan, math.nan)
    edges = (low, high, beyond, beyond - error, beyond + error, found.healthy)
    return dict(zip((name for name in LIKELY if name != "mark"), edges, strict=True))


def _likely(found: Difference) -> list[str]:
    figures = likely_figures(found)
    return [str(found.mark) if name == "mark" else figure_cell(figures[name]) for name in LIKELY]

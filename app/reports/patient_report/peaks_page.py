"""What are the excursions, ranges and peaks, how do the legs differ, and where do both lie against the band?"""

import math
from collections.abc import Sequence

from app.charts.cycles import is_mean_enough, is_spread_enough
from app.charts.drawing import MM, Picture
from app.charts.on_paper import draw
from app.charts.stride_chart import StrideChart
from app.gates_in_words import verdict_word
from app.reports.comparison import compare_legs
from app.reports.patient_report import panels, quality
from app.reports.patient_report.blocks import Block, Cell, Column, Row, figures, heading, if_room, legend, note, table
from app.reports.patient_report.facts import KINDS, Facts, joint_of
from app.reports.patient_report.numbers_in_words import (
    NOTHING,
    away_in_words,
    band_in_figures,
    care_note,
    dagger_note,
    each_side,
    fixed,
    judged_in_words,
    marked,
    signed,
    signed_error,
    spread,
)
from app.reports.patient_report.panels import excursion_name, peak_name
from app.reports.walk_figures import by_hand_in_words
from app.wording import capitalised, tr
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.norms import KNEE_OVERREAD
from core.verdicts.measurement_error import ComparisonKind, sigma_of
from core.verdicts.model import Verdict
from core.verdicts.quantities import EXCURSIONS_BY_COLUMN, WINDOWS

SHAPES = {  # what needs no zero
    "knee": (
        "knee_stance_to_swing_deg",
        "knee_while_loading_deg",
        "knee_straightening_deg",
        "knee_range_deg",
    ),
    "ankle": (
        "ankle_push_off_deg",
        "ankle_rocker_deg",
        "ankle_heel_rocker_deg",
        "ankle_toes_lifted_deg",
        "ankle_range_deg",
    ),
}
HEIGHTS = {
    "knee": (
        "knee_at_initial_contact_deg",
        "knee_loading_peak_deg",
        "knee_stance_minimum_deg",
        "knee_swing_peak_deg",
    ),
    "ankle": (
        "ankle_at_initial_contact_deg",
        "ankle_loading_plantarflexion_deg",
        "ankle_stance_dorsiflexion_deg",
        "ankle_push_off_plantarflexion_deg",
        "ankle_swing_dorsiflexion_deg",
    ),
}
PLOT_WIDTH = 60 * MM  # below the table this fills a Letter page


def peaks_page(facts: Facts) -> list[Block]:
    one, other = facts.first_and_second
    columns = [
        Column(tr("Measure, °"), "1fr", is_number=False),
        *_side_columns(facts, Side.LEFT),
        *_side_columns(facts, Side.RIGHT),
        Column(f"{one[0].upper()} − {other[0].upper()}"),
        Column(tr("In words"), is_number=False),
        Column(tr("Band [1]")),
        Column(tr("Against the band"), "29mm", is_number=False),
    ]
    rows: list[Row] = []
    has_score = False
    for kind in KINDS:
        if not facts.has_joint(kind):
            continue
        rows.append(tr("Knee: how far it moves") if kind == "knee" else tr("Ankle: how far it moves"))
        rows += [_row(facts, column) for column in SHAPES[kind]]
        rows.append(tr("Knee: angles (flexion +)") if kind == "knee" else tr("Ankle: angles (dorsiflexion +)"))
        rows += [_row(facts, column) for column in HEIGHTS[kind] if _is_any_told(facts, kind, column)]
        if facts.curves_group is not None and _is_any_told(facts, kind, f"{kind}_at_initial_contact_deg"):
            rows.append(_score_row(facts, kind))
            has_score = True
    said = [_movements(kinds)] if (kinds := [kind for kind in KINDS if facts.has_joint(kind)]) else []
    said += quality.caveats(facts, (Verdict.WITHHELD,), is_of_joints=True)[: quality.MAX_SENTENCES]
    if len(facts.gait) == len(Side):
        judged = tr(
            "Differences are formed before rounding; in words: against the measurement error between legs, at least "
            "{error}°."
        )
        said.append(judged.format(error=signed_error(sigma_of("knee_range_deg", ComparisonKind.LEGS))))
        said.append(tr("For the ankle the knee's figure is borrowed.") + " " + dagger_note())
    if has_score:
        said.append(
            tr("GVS: root mean square distance of the mean curve from the band's mean; it contains any error of zero.")
        )
    shown = [(side, column) for side in facts.gait for kind in KINDS for column in (*SHAPES[kind], *HEIGHTS[kind])]
    if any(math.isfinite(facts.away_sd(side, column)) for side, column in shown):
        judged = tr("Against the band: after laying it at each curve's height; knees as measured and divided by {by}.")
        said.append(judged.format(by=fixed(KNEE_OVERREAD, 2)))
    if any(_verdict(facts, side, column) is Verdict.CARE for side, column in shown):
        said.append(care_note())
    if by_hand := by_hand_in_words(facts.walk):
        said.append(by_hand)
    opening = tr(
        "The strides of page 2. Degrees, mean ± SD over strides. “at %” is the mean time of the peak in the stride. "
        "Windows in brackets are % of the stride."
    )
    found = [note(" ".join(said))] if said else []
    return [
        heading(tr("Peaks and range")),
        note(opening),
        table(columns, rows, is_dense=True),
        *found,
        *_where_found(facts),
    ]


def _where_found(facts: Facts) -> list[Block]:
    """The windows over the curves: what the table's rows mean is seen, not only read; where the page has room."""
    kinds = [kind for kind in KINDS if facts.has_joint(kind)]
    if not kinds:
        return []
    said = [
        tr("In every stride the highest (max) or lowest (min) angle inside each box is taken."),
        tr("Range: a stride's highest angle less its lowest."),
    ]
    items = panels.leg_swatches(facts)
    if any(not facts.has_no_zero(kind) for kind in kinds):
        said.append(tr("At initial contact: at 0 %."))
        items.append(panels.peak_swatch())
    drawn = figures([_windows(facts, kind) for kind in kinds], columns=2)
    title = heading(tr("Where each peak is looked for"), level=2)
    return [if_room([title, note(" ".join(said)), legend(items), drawn])]


def _windows(facts: Facts, kind: str) -> Picture:
    sides, spans = [side for side in Side if facts.is_measured(joint_of(kind, side))], panels.spans_of(kind)
    curves = (panels.curve_of(facts, side, kind, peaks=list(spans), is_fine=True) for side in sides)
    each = [f"{panels.peak_name(column)} {span.first}–{span.last} %" for column, span in spans.items()]
    chart = StrideChart(
        title=capitalised(panels.small_title(facts, kind)),
        axis=panels.axis_of(facts, kind),
        curves=tuple(curves),
        band=None,
        is_simulated=facts.is_simulated,
        spans=tuple(spans.values()),
        alt=" ".join([panels.curve_alt(facts, kind, sides), tr("Windows: {windows}.").format(windows=", ".join(each))]),
    )
    return draw(chart, PLOT_WIDTH)


def _side_columns(facts: Facts, side: Side) -> list[Column]:
    said = tr("Left") if side is Side.LEFT else tr("Right")
    count = f"n = {facts.strides(side)}" if side in facts.gait else ""
    return [Column(f"{said}\n{count}".strip()), Column(tr("at %"))]


def measure(column: str) -> str:
    """Name a row, with the window its peak is looked for in."""
    if column.endswith("_at_initial_contact_deg"):
        return tr("At initial contact")
    if column.endswith("_range_deg"):
        return tr("Range over the stride")
    if column in EXCURSIONS_BY_COLUMN:
        return capitalised(excursion_name(column))
    window = WINDOWS[column]
    name = capitalised(peak_name(column)).replace(", ", ",\n")  # else a line ends within the window
    return f"{name} ({window.first}–{window.last}\u00a0%)"


def _movements(kinds: Sequence[str]) -> str:
    """Between which parts of the stride each movement is measured."""
    each = []
    for column in (column for kind in kinds for column in SHAPES[kind] if column in EXCURSIONS_BY_COLUMN):
        excursion = EXCURSIONS_BY_COLUMN[column]
        ends = [f"{end.first}–{end.last}" if end is not None else "0" for end in (excursion.high, excursion.low)]
        each.append(
            tr("{movement} {high} less {low}").format(movement=excursion_name(column), high=ends[0], low=ends[1])
        )
    said = tr(
        "How far a joint moves is the highest angle of one part of the stride less the lowest of another, in %: {each}."
    )
    return said.format(each=", ".join(each))


def _verdict(facts: Facts, side: Side, column: str) -> Verdict:
    if not facts.is_measured(joint_of(column.split("_")[0], side)):
        return Verdict.NOT_MEASURED
    return facts.assessment(side, column).verdict


def _is_any_told(facts: Facts, kind: str, column: str) -> bool:
    """Whether a row has anything to tell: at initial contact there is nothing but a height."""
    return "initial_contact" not in column or any(
        _verdict(facts, side, column) in (Verdict.READ, Verdict.CARE) for side in Side
    )


def _row(facts: Facts, column: str) -> list[Cell | str]:
    cells: list[Cell | str] = [measure(column)]
    for side in Side:
        cells += [value_cell(facts, side, column), fixed(_percent(facts, side, column), 0)]
    is_any = any(facts.value(side, column).n for side in facts.sides_with_band)
    band, kind = facts.band(column) if is_any else None, column.split("_")[0]
    group_range = facts.group_range_deg(kind) if is_any and column.endswith("_range_deg") else None
    if band is not None:
        in_band = band_in_figures(band, 1)
        away = {side: facts.away_sd(side, column) for side in Side}
        against = each_side({side: away_in_words(sd) for side, sd in away.items() if math.isfinite(sd)})
    else:
        in_band = fixed(group_range, 1) if group_range is not None else tr("no band")
        against = tr("band has no SD") if group_range is not None else NOTHING
    return [*cells, *_difference_cells(facts, column), in_band, against]


def value_cell(facts: Facts, side: Side, column: str) -> Cell | str:
    """Give mean ± SD, or why there is none."""
    verdict = _verdict(facts, side, column)
    if verdict in (Verdict.WITHHELD, Verdict.NOT_MEASURED):
        return verdict_word(verdict)
    if facts.is_no_peak(side, column):
        return NOTHING if column in EXCURSIONS_BY_COLUMN else tr("no peak")
    value = facts.value(side, column)
    return Cell(marked(spread(value, 1), verdict), is_grey=not is_spread_enough(value.n))


def _percent(facts: Facts, side: Side, column: str) -> float:
    at: MeanAndSd = facts.peak_percent(side, column)
    return at.mean if is_mean_enough(at.n) else math.nan


def _difference_cells(facts: Facts, column: str) -> list[Cell | str]:
    """Of what is withheld on either leg there is no difference."""
    if not all(facts.value(side, column).n for side in Side):
        return [NOTHING, NOTHING]
    found = compare_legs(facts.alone, column, facts.first_and_second)
    if not found.is_told:
        return [NOTHING, NOTHING]
    return [signed(found.difference, 1), Cell(judged_in_words(found), is_bold=found.exceeds)]


def _score_row(facts: Facts, kind: str) -> list[Cell | str]:
    cells: list[Cell | str] = [tr("Distance from band mean (GVS)")]
    for side in Side:
        scores = facts.summary[str(side)].get("gait_variable_score_deg") or {}
        is_shown = side in facts.sides_with_band and is_mean_enough(facts.strides(side))
        cells += [fixed(scores.get(kind) if is_shown else None, 1), NOTHING]
    return [*cells, NOTHING, NOTHING, NOTHING, NOTHING]

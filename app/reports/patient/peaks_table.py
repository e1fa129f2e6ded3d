"""The table of excursions, ranges and peaks: how the legs differ, and where both lie against the band."""

import math
from collections.abc import Sequence

from app.charts.cycles import is_spread_enough
from app.reports.blocks import Block, Cell, Column, Row, note, table
from app.summary import quality
from app.summary.comparison import compare_legs
from app.summary.conditions import by_hand_in_words
from app.summary.facts import Facts
from app.summary.interval_words import interval_in_figures
from app.summary.numbers_in_words import (
    MARKS,
    NOTHING,
    away_in_words,
    band_in_figures,
    care_note,
    each_side,
    fixed,
    marked,
    marks_note,
    signed,
    spread,
)
from app.summary.panels import HEIGHTS, excursion_name, peak_name
from app.wording.translation import capitalised, later, tr
from app.wording.verdicts import verdict_word
from core.body import JointKind, Side
from core.parameters import MOVEMENTS
from core.verdicts.model import Verdict
from core.verdicts.norms import KNEE_OVERREAD
from core.verdicts.quantities import ABDUCTION, EXCURSIONS_BY_COLUMN, WINDOWS

TIMES = {"hip": (), "knee": ("knee_swing_peak_percent",), "ankle": ()}
HOW_FAR = {
    JointKind.HIP: later("Hip: movement ranges"),
    JointKind.KNEE: later("Knee: movement ranges"),
    JointKind.ANKLE: later("Ankle: movement ranges"),
}
ANGLES = {
    JointKind.HIP: later("Hip: absolute angles from standing"),
    JointKind.KNEE: later("Knee: absolute angles (flexion +)"),
    JointKind.ANKLE: later("Ankle: absolute angles (dorsiflexion +)"),
}


def peaks_table(facts: Facts) -> list[Block]:
    """Of each joint how far it moves, then its angles; below it what the words and marks mean."""
    one, other = facts.first_and_second
    kinds = [kind for kind in facts.kinds if facts.has_joint(kind)]
    if not kinds:
        return []
    columns = [
        Column(tr("Measure, °"), "1fr", is_number=False),
        *(_side_column(facts, side) for side in Side),
        Column(f"{one.letter} − {other.letter}"),
        Column(tr("likely between")),
        Column(tr("Ref. [1]")),
        Column(tr("Against reference"), "27mm", is_number=False),
    ]
    rows: list[Row] = []
    for kind in kinds:
        rows.append(tr(HOW_FAR[kind]))
        rows += [
            _row(facts, column) for column in (*MOVEMENTS[kind], *TIMES[kind]) if _is_any_reported(facts, kind, column)
        ]
        rows.append(_head_of_heights(facts, kind))
        rows += [_row(facts, column) for column in HEIGHTS[kind] if _is_any_reported(facts, kind, column)]
    return [table(columns, rows, is_dense=True), note(" ".join(_notes(facts, kinds)))]


def _head_of_heights(facts: Facts, kind: JointKind) -> str:
    """With how far each leg's whole curve lies from the band."""
    title = tr(ANGLES[kind])
    offsets = [
        f"{side.letter}\u00a0{signed(offset, 1)}°"
        for side in Side
        if math.isfinite(offset := facts.offset_deg(side, kind))
    ]
    if not offsets:
        return title
    stated = tr("{title}; whole curve vs reference: {offsets}; laboratories differ by 7°")
    return stated.format(title=title, offsets=", ".join(offsets))


def hips_note() -> str:
    """What hips and pelvis cannot say."""
    return tr(
        "For hips and pelvis the measurement error of a difference is not known: differences are "
        "given but not judged. Hip rotation is not reported."
    )


def _notes(facts: Facts, kinds: Sequence[JointKind]) -> list[str]:
    stated = [
        tr("Mean ± SD of strides; each value is found stride by stride. Windows in brackets are % of the gait cycle."),
        _movements(kinds),
        *quality.caveats(facts, (Verdict.NOT_REPORTED,), is_of_joints=True)[: quality.MAX_SENTENCES],
    ]
    if len(facts.gait) == len(Side):
        stated.append(marks_note())
    if JointKind.HIP in kinds:
        stated.append(hips_note())
    shown = [
        (side, column) for side in facts.gait for kind in facts.kinds for column in (*MOVEMENTS[kind], *HEIGHTS[kind])
    ]
    if any(math.isfinite(facts.away_sd(side, column)) for side, column in shown):
        judged = tr(
            "Against reference: the reference is shifted to the level of each curve. Knees are compared "
            "both as measured and divided by {by}."
        )
        stated.append(judged.format(by=fixed(KNEE_OVERREAD, 2)))
    if any(_verdict(facts, side, column) is Verdict.CARE for side, column in shown):
        stated.append(care_note())
    return [*stated, by_hand_in_words(*facts.part.walks)]


def _side_column(facts: Facts, side: Side) -> Column:
    stated = tr("Left") if side is Side.LEFT else tr("Right")
    count = f"n = {facts.strides(side)}" if side in facts.gait else ""
    return Column(f"{stated}\n{count}".strip())


def measure(column: str) -> str:
    """Name a row, with the window its peak is looked for in."""
    if column == "hip_abduction_range_deg":
        return tr("Abduction range of motion")
    if column.startswith("hip") and column.endswith("_peak_deg"):
        return capitalised(peak_name(column))
    if column.endswith("_at_initial_contact_deg"):
        return tr("At initial contact")
    if column.endswith("_range_deg"):
        return tr("Range of motion")
    if column.endswith("_percent"):
        return tr("Time of peak flexion in swing, %")
    if column in EXCURSIONS_BY_COLUMN:
        return capitalised(excursion_name(column))
    window = WINDOWS[column]
    return f"{capitalised(peak_name(column))} ({window.first}–{window.last}\u00a0%)"


def _movements(kinds: Sequence[JointKind]) -> str:
    """Between which parts of the stride each movement is measured."""
    each = []
    for column in (column for kind in kinds for column in MOVEMENTS[kind] if column in EXCURSIONS_BY_COLUMN):
        excursion = EXCURSIONS_BY_COLUMN[column]
        ends = [f"{end.first}–{end.last}" if end is not None else "0" for end in (excursion.high, excursion.low)]
        each.append(
            tr("{movement} ({high} minus {low})").format(movement=excursion_name(column), high=ends[0], low=ends[1])
        )
    stated = tr(
        "Movement range: highest angle in one part of the gait cycle minus the lowest in another (parts in %): {each}."
    )
    return stated.format(each=", ".join(each))


def _verdict(facts: Facts, side: Side, column: str) -> Verdict:
    if not facts.is_worn(side, column):
        return Verdict.NOT_MEASURED
    return facts.assessment(side, column).verdict


def _is_any_reported(facts: Facts, kind: JointKind, column: str) -> bool:
    """Whether a row has anything to report: at initial contact, and of a hip outwards, there is only a height."""
    return ("initial_contact" not in column and not column.startswith(ABDUCTION)) or any(
        _verdict(facts, side, column) in (Verdict.READ, Verdict.CARE) for side in Side
    )


def _row(facts: Facts, column: str) -> list[Cell | str]:
    cells: list[Cell | str] = [measure(column)]
    cells += [value_cell(facts, side, column) for side in Side]
    is_any = any(facts.value(side, column).n for side in facts.sides_with_band)
    band, kind = facts.band(column) if is_any else None, column.split("_")[0]
    group_range = facts.group_range_deg(kind) if is_any and column == f"{kind}_range_deg" else None
    if band is not None:
        in_band = band_in_figures(band, 1)
        away = {side: facts.away_sd(side, column) for side in Side}
        against = each_side({side: away_in_words(sd) for side, sd in away.items() if math.isfinite(sd)})
    else:
        in_band = fixed(group_range, 1) if group_range is not None else tr("no reference")
        against = tr("no reference SD") if group_range is not None else NOTHING
    return [*cells, *difference_cells(facts, column, 1), in_band, against]


def value_cell(facts: Facts, side: Side, column: str) -> Cell | str:
    """Give mean ± SD, or why there is none."""
    verdict = _verdict(facts, side, column)
    if verdict in (Verdict.NOT_REPORTED, Verdict.NOT_MEASURED):
        return verdict_word(verdict)
    if facts.is_no_peak(side, column):
        return NOTHING if column in EXCURSIONS_BY_COLUMN else tr("no peak")
    value = facts.value(side, column)
    return Cell(marked(spread(value, 1), verdict), is_grey=not is_spread_enough(value.n))


def difference_cells(facts: Facts, column: str, decimals: int) -> list[Cell | str]:
    """What the legs differ by, bold and marked beyond its error, and where it is likely to be; none without both."""
    is_known = all(facts.value(side, column).n for side in Side)
    found = compare_legs(facts.part, column, facts.first_and_second) if is_known else None
    if found is None or not found.is_reported:
        return [NOTHING, NOTHING]
    apart = f"{MARKS[found.mark]} {signed(found.difference, decimals)}".strip()
    return [Cell(apart, is_bold=found.exceeds), interval_in_figures(column, found)]

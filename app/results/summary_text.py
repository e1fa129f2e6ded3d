"""What is shown around a walk's curves: its key figures, and in one line how far all of it can be trusted."""

import math
from collections.abc import Sequence
from statistics import fmean

from app.charts.cycles import is_mean_enough
from app.summary.data_quality import DataQuality
from app.summary.facts import Facts
from app.summary.goals import goal_mark
from app.summary.numbers_in_words import NOTHING, fixed
from app.summary.walk_figures import Figure
from app.widgets.detail_button import DetailText
from app.widgets.fact_strip import KeyFigure
from app.wording.translation import tr, tr_n
from app.wording.verdicts import verdict_word
from core.gait.strides import Reason
from core.goals import Goal
from core.verdicts.model import Verdict

KEY_COLUMNS = ("speed_m_s", "cadence_steps_min", "stride_length_m")


def door_words(found: DataQuality) -> DetailText:
    """The verdict of the gravest remark, where it holds, what to do or why, and how many there are."""
    if not found.lines:
        is_judged = bool(found.in_order)
        first = tr("Good data quality throughout.") if is_judged else found.first
        return DetailText(Verdict.READ, first, found.in_order)
    line = found.lines[0]
    pattern = tr("{where}: {verdict}.") if line.where else tr("Data quality: {verdict}.")
    first = pattern.format(where=line.where, verdict=verdict_word(line.verdict))
    then = line.to_do or line.why if line.is_grave else line.why
    count = len(found.lines)
    remarks = tr_n("{count} finding", "{count} findings", count).format(count=count)
    return DetailText(line.verdict, first, then, remarks, is_caution=line.is_grave)


def key_figures(facts: Facts) -> list[KeyFigure]:
    """Speed, cadence and stride length of a walk whose legs were measured."""
    return [_of_row(facts.time_distance[column], facts.part.agreed.of(column)) for column in KEY_COLUMNS]


def _of_row(row: Figure, goals: Sequence[Goal]) -> KeyFigure:
    reported = {side: value.mean for side, value in row.sides.items() if is_mean_enough(value.n)}
    value = row.both if row.both is not None else fmean(reported.values()) if reported else math.nan
    is_known = math.isfinite(value)
    not_reported = row.unknown_both or next(iter(row.unknown.values()), "")
    note = spoken = ""
    if not is_known:
        note = tr(not_reported) if not_reported else tr("not measured")
    elif row.with_care:
        note = verdict_word(Verdict.CARE)
    elif reported:
        note = ", ".join(f"{side.letter} {fixed(mean, row.decimals)}" for side, mean in reported.items())
    elif row.band is not None:
        low, high = (fixed(edge, row.decimals) for edge in row.band)
        note = tr("ref. {low} to {high}").format(low=low, high=high)
        spoken = tr("reference {low} to {high}").format(low=low, high=high)
    if is_known and goals:  # in place of the legs' values or the band, but not of a doubt
        doubt = [note] if row.with_care else []
        note, spoken = ", ".join([*doubt, *map(goal_mark, goals)]), ""
    shown = fixed(value, row.decimals) if is_known else NOTHING
    unit = row.unit if is_known else ""
    words = tr("{name}: {value}.").format(name=row.name, value=" ".join(filter(None, [shown, unit, spoken or note])))
    return KeyFigure(row.column, row.name, shown, unit, note, words)


def figures_in_short(facts: Facts) -> str:
    """The same in one line, of those that are known."""
    reported = [
        f"{one.name} {one.value}\N{NO-BREAK SPACE}{one.unit}".strip()
        for one in key_figures(facts)
        if one.value != NOTHING
    ]
    return " · ".join(reported)


def strides_in_short(facts: Facts) -> str:
    """How many strides of each leg were used and left out, and for which reasons."""
    sides = facts.part.sides
    used = ", ".join(f"{side.letter} {facts.strides(side)}" for side in sides)
    if not used:
        return tr("No strides found.")
    out = {side: facts.part.reasons(side) for side in sides}
    left_out = ", ".join(f"{side.letter} {out[side].total() - out[side][Reason.USED]}" for side in sides)
    return tr("Strides used: {used}. Excluded: {left_out}.").format(used=used, left_out=left_out)

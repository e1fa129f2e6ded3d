"""How alike are the strides? Every one that was used, drawn; the swing peak of each in the order walked."""

import math
from dataclasses import replace

import numpy as np

from app.charts.cycles import is_mean_enough, is_spread_enough
from app.charts.drawing import MM, Picture
from app.charts.on_paper import draw
from app.charts.stride_chart import StrideChart
from app.gates_in_words import verdict_word
from app.reports.patient_report import panels
from app.reports.patient_report.blocks import Block, Cell, Column, Row, figures, heading, legend, note, table
from app.reports.patient_report.facts import KINDS, Facts, joint_of
from app.reports.patient_report.numbers_in_words import fixed, marked
from app.reports.patient_report.small_charts import StrideValues, stride_strip
from app.reports.walk_figures import by_hand_in_words
from app.wording import side_name, tr
from core.body import Side
from core.verdicts.model import Verdict
from core.verdicts.quantities import values_of

PLOT_WIDTH = 70 * MM


def consistency_page(facts: Facts) -> list[Block]:
    sides = [side for side in Side if side in facts.gait]
    kinds = [kind for kind in KINDS if facts.has_joint(kind)]
    pictures = [
        _panel(facts, side, kind) for kind in kinds for side in sides if facts.is_measured(joint_of(kind, side))
    ]
    has_band = any(panels.band_of(facts, kind, sides) is not None for kind in kinds)
    items = [
        *panels.leg_swatches(facts),
        (panels.stride_swatch(), tr("Single strides (thin)")),
        *(panels.band_swatches() if has_band else []),
        (panels.cross_swatch(), tr("Stride left out, with its side")),
    ]
    strip = [figures([_strip(facts)])] if facts.has_joint("knee") else []
    opening = tr(
        "The strides of page 2, every one that was used. Means are printed from 3 strides on, spreads from 10."
    )
    return [
        heading(tr("Consistency from stride to stride")),
        note(" ".join(filter(None, [opening, by_hand_in_words(facts.walk)]))),
        legend(items),
        figures(pictures, columns=2),
        *strip,
        _table(facts, kinds),
    ]


def _panel(facts: Facts, side: Side, kind: str) -> Picture:
    own = panels.curve_of(facts, side, kind)
    chart = StrideChart(
        title=panels.title_with_side(facts, kind, side),
        axis=panels.axis_of(facts, kind),
        curves=(replace(own, strides_deg=facts.strides_deg(side, kind)),),
        band=panels.band_of(facts, kind, [side]),
        is_simulated=facts.is_simulated,
        alt=tr("Single strides and their mean.") + " " + panels.curve_alt(facts, kind, [side]),
    )
    return draw(chart, PLOT_WIDTH)


def _strip(facts: Facts) -> Picture:
    has_zero = not facts.has_no_zero("knee")
    band = facts.band("knee_swing_peak_deg") if has_zero and facts.sides_with_band.issuperset(facts.gait) else None
    column = "knee_swing_peak_deg" if has_zero else "knee_range_deg"
    title = (
        tr("Peak knee flexion in swing, degrees, every stride") if has_zero else tr("Knee range, degrees, every stride")
    )
    sides, numbers = {}, []
    for side, gait in facts.gait.items():
        found = facts.value(side, column)
        mean = found.mean if is_mean_enough(found.n) else math.nan
        values = values_of(facts.walk, side, column)
        sides[side] = StrideValues(values.tolist(), gait.strides.is_used.tolist(), mean)
        used = values[gait.strides.is_used]
        if np.isfinite(used).any():
            said = tr("{side}: {count} strides, {low}° to {high}°.")
            low, high = float(np.nanmin(used)), float(np.nanmax(used))
            count = facts.strides(side)
            numbers.append(
                said.format(side=side_name(side).capitalize(), count=count, low=fixed(low, 0), high=fixed(high, 0))
            )
    alt = " ".join([tr("SIMULATED.")] * facts.is_simulated + [f"{title}.", *numbers])
    return stride_strip(title, sides, 20, 80, band, facts.is_simulated, alt)


def _table(facts: Facts, kinds: list[str]) -> Block:
    columns = [
        Column(tr("Measure"), "1fr", is_number=False),
        *(Column(facts.counted(side), "30mm") for side in Side),
    ]
    names = {
        "knee": tr("Knee: SD between strides, mean over the stride, °"),
        "ankle": tr("Ankle: SD between strides, mean over the stride, °"),
    }
    rows: list[Row] = []
    for kind in kinds:
        found = {side: facts.mean_stride_sd_deg(side, kind) for side in Side}
        rows.append([names[kind], *(_cell(facts, s, f"{kind}_range_deg", found[s].mean, found[s].n) for s in Side)])
    for label, column in (
        (tr("Time of peak knee flexion: SD, % of stride"), "knee_swing_peak_percent"),
        (tr("Toe\u2011off: SD, % of stride"), "stance_percent"),
    ):
        found = {side: facts.value(side, column) for side in Side}
        rows.append([label, *(_cell(facts, s, column, found[s].sd, found[s].n) for s in Side)])
    return table(columns, rows, is_dense=True)


def _cell(facts: Facts, side: Side, column: str, sd: float, n: int) -> Cell | str:
    """A spread, under the verdict of a column of strides.csv that needs the same."""
    if side not in facts.gait or not facts.is_worn(side, column):
        return tr("not measured")
    verdict = facts.assessment(side, column).verdict
    if verdict is Verdict.WITHHELD:
        return verdict_word(verdict)
    return marked(fixed(sd if is_spread_enough(n) else None, 1), verdict)

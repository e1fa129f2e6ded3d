"""How do knee and ankle move over the stride? Both legs in one picture, large, with a read-out beside it."""

import math

from app.charts.cycles import is_mean_enough
from app.charts.drawing import MM
from app.charts.on_paper import draw
from app.charts.stride_chart import StrideChart
from app.reports.patient_report import panels
from app.reports.patient_report.blocks import Block, figure_with_words, heading, note, paragraph
from app.reports.patient_report.facts import KINDS, Facts, joint_of
from app.reports.patient_report.first_page import why_no_band
from app.reports.patient_report.numbers_in_words import fixed, signed
from app.reports.reference_bands import OTHER_AGES
from app.reports.walk_figures import by_hand_in_words
from app.wording import capitalised, joined, side_name, tr
from core.body import Side

PLOT_WIDTH = 112 * MM


def curves_page(facts: Facts, condition: str) -> list[Block]:
    counts = {side[0].upper(): facts.strides(side) for side in facts.gait}
    said = [
        tr("Shown: {condition}. Mean over strides, {counts}; each leg on its own stride.").format(
            condition=condition, counts=", ".join(f"{letter} n = {n}" for letter, n in counts.items())
        ),
        tr("Axes are the same in every report."),
        _band_in_words(facts),
        by_hand_in_words(facts.walk),
    ]
    blocks = [heading(tr("Joint angles over the stride")), note(" ".join(filter(None, said)))]
    for kind in KINDS:
        blocks.append(_figure(facts, kind) if facts.has_joint(kind) else paragraph(_why_missing(facts, kind)))
    return blocks


def _figure(facts: Facts, kind: str) -> Block:
    sides = [side for side in Side if facts.is_measured(joint_of(kind, side))]
    chart = StrideChart(
        title=panels.title_of(facts, kind),
        axis=panels.axis_of(facts, kind),
        curves=tuple(panels.curve_of(facts, side, kind, peaks=panels.PEAK_COLUMNS[kind]) for side in sides),
        band=panels.band_of(facts, kind, sides),
        is_simulated=facts.is_simulated,
        ticks=panels.other_foot(facts),
        alt=panels.curve_alt(facts, kind, sides),
    )
    legend = []
    if kind == next(k for k in KINDS if facts.has_joint(k)):
        band = panels.band_swatches() if chart.band is not None else []
        events = panels.event_swatches(has_other_foot=bool(chart.ticks), has_peaks=not facts.has_no_zero(kind))
        legend = [*panels.leg_swatches(facts), *band, *events]
    title = tr("Knee") if kind == "knee" else tr("Ankle")
    return figure_with_words(
        draw(chart, PLOT_WIDTH), legend, title, [*_read_out(facts, kind), *panels.not_drawn(facts, kind)]
    )


def _read_out(facts: Facts, kind: str) -> list[str]:
    said = []
    for column in panels.PEAK_COLUMNS[kind]:
        parts = []
        for side in Side:
            value, at = facts.value(side, column), facts.peak_percent(side, column)
            letter = side[0].upper()
            if is_mean_enough(value.n):
                shown = tr("{side}\u00a0{value}° at\u00a0{percent}\u00a0%")
                parts.append(shown.format(side=letter, value=fixed(value.mean, 0), percent=fixed(at.mean, 0)))
            elif facts.is_no_peak(side, column):
                parts.append(tr("{side}\u00a0no\u00a0peak").format(side=letter))
        if parts:
            said.append(f"{capitalised(panels.peak_name(column))}: {'; '.join(parts)}.")
    ranges = [
        f"{side[0].upper()}\u00a0{fixed(value.mean, 0)}°"
        for side in Side
        if is_mean_enough((value := facts.value(side, f"{kind}_range_deg")).n)
    ]
    if ranges:
        said.append(tr("Range over the stride: {values}.").format(values="; ".join(ranges)))
    offsets = [
        f"{side[0].upper()}\u00a0{signed(offset, 1)}°"
        for side in Side
        if math.isfinite(offset := facts.offset_deg(side, kind))
    ]
    if offsets:
        said.append(tr("Height against the band: {values}.").format(values="; ".join(offsets)))
    return said


def _band_in_words(facts: Facts) -> str:
    group = facts.curves_group
    if group is None:
        return why_no_band(facts, facts.bands.why_no_curves)
    if all(facts.has_no_zero(kind) for kind in KINDS if facts.has_joint(kind)):
        return tr("No band: without a zero there is no height to compare.")
    said = [
        tr("Band [1]: young adults, barefoot, on a treadmill at {speed} m/s; this walk: {walk} m/s.").format(
            speed=fixed(group.speed_m_s, 2), walk=fixed(facts.feet.speed_m_s, 2)
        )
    ]
    if facts.bands.are_curves_of_other_ages:
        said.append(tr(OTHER_AGES))
    if not facts.sides_with_band.issuperset(facts.gait):
        sides = joined([side_name(side) for side in Side if side in facts.sides_with_band])
        said.append(tr("It is for the {side} leg alone.").format(side=sides))
    return " ".join(said)


def _why_missing(facts: Facts, kind: str) -> str:
    worn = facts.visit.recording(facts.walk.name).imu
    without = [side_name(side) for side in Side if (joint := joint_of(kind, side)) and joint.distal not in worn]
    if kind == "ankle":
        if without:
            said = tr("Ankle not measured: no sensor on the {sides} foot.")
            return said.format(sides=joined(without))
        return tr("Ankle not measured.")
    return tr("Knee not measured.")

"""The mean cycle of a condition, and its figures: the charts here, the tables beside them where the page puts them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.plots.cycle_charts import CycleCharts
from app.summary.conditions import Part, by_hand_in_words
from app.summary.reference_bands import OTHER_AGES, WHY_NO_BAND, bands_of, reference_curves, sides_with_band
from app.summary.walk_figures import (
    Figure,
    few_strides_in_words,
    peak_figures,
    pelvis_figures,
    pelvis_in_words,
    reason_in_words,
    side_cycle,
    strides_in_words,
    time_distance_figures,
)
from app.theme.current import scaled
from app.widgets.card import Card
from app.widgets.figures_table import CARE_MARK, figure_columns, figure_rows
from app.widgets.lay_out import lay_out
from app.widgets.table import CellTable
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.body import name_of, side_name
from app.wording.translation import capitalised, joined, later, tr
from core.body import Joint, Side
from core.gait.cycles import POINTS
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.verdicts.model import Verdict
from core.verdicts.norms import AgeAndHeight, Bands, NoBand, ReferenceValues

# whose bands the program brings along, as the core names them
GROUPS = (
    later("young adults, barefoot, treadmill"),
    later("42 adults, 24 young and 18 older, barefoot, overground"),
)
SPEED_WORDS = {"slow": later("slow"), "comfortable": later("comfortable"), "fast": later("fast")}
KIND_WORDS = {"hip": later("Hip"), "pelvis": later("Pelvis"), "knee": later("Knee"), "ankle": later("Ankle")}
LEG_KINDS, HIP_KINDS = ("knee", "ankle"), ("hip", "pelvis")
NO_SPEED = later("This walk: speed not known or not reported.")
NO_SIDE = later("No reference: a prosthetic leg is not compared with other people.")
CARE = later("{mark}: caution.")
HIP_BAND = later("At the hip, the reference is shifted to the level of the curves: compare the shape only.")


class CyclePage(QWidget):
    """The charts, and whose band it is; `peaks`, `time_distance` and `hips` are cards that the page places."""

    def __init__(self) -> None:
        super().__init__()
        self.band_words = ""
        self.charts = CycleCharts(reference_curves())
        self.by_hand = Text(size=12, weight=MEDIUM, wraps=True)
        lay_out(QVBoxLayout(self), (self.charts, 1), self.by_hand, margins=0)
        self.peaks = FiguresCard(tr("Peaks and ranges"), tr("mean ± SD (°)"))
        self.time_distance = FiguresCard(tr("Time and distance"), tr("mean ± SD"))
        self.hips = FiguresCard(tr("Hip and pelvis"), tr("mean ± SD (°)"))
        for card in (self.peaks, self.time_distance, self.hips):
            card.column.addStretch(1)

    @property
    def tables(self) -> list[QWidget]:
        return [self.peaks.table, self.time_distance.table, self.hips.table]

    def set_notes_shown(self, is_shown: bool) -> None:
        """Say under the charts what was left out by hand, where nothing beside them does."""
        self.by_hand.setVisible(is_shown and bool(self.by_hand.text()))

    def show_walk(self, part: Part, walk: RecordingAnalysis, is_simulated: bool, who: AgeAndHeight) -> None:
        """Show a condition's strides, each side on its own stride; `walk`: single ones, `who`: for the band."""
        bands, sides_of_band = bands_of(part, who), sides_with_band(part)
        curves, values = (bands.curves, bands.values) if sides_of_band else (None, None)
        joints = [joint for side in part.sides for joint in part.joints if joint.side is side]
        own = replace(part, walks=(walk,))
        cycles = {joint: replace(side_cycle(part, joint), strides_deg=_strides_deg(own, joint)) for joint in joints}
        self.charts.show_cycles(cycles, {joint: part.verdicts.joint(joint) for joint in joints}, is_simulated)
        strides = {side: part.strides(side) for side in part.sides}
        of_joints = peak_figures(part, curves)
        of_hips = _under_heads({**of_joints, **pelvis_figures(part)}, HIP_KINDS)
        rows = _under_heads(of_joints, LEG_KINDS)
        reported = " ".join(strides_in_words(part, side) for side in part.sides)
        reasons = [reported, few_strides_in_words(part), *_why_not_reported(part, joints)]
        reasons += _care_in_words(rows)
        self.peaks.show_figures(rows, strides, " ".join(filter(None, reasons)))
        self.hips.show_figures(of_hips, strides, " ".join([*pelvis_in_words(part), *_care_in_words(of_hips)]))
        self.hips.setVisible(bool(of_hips))
        figures = time_distance_figures(part, values, sides_of_band)
        by_hand, count = by_hand_in_words(*part.walks), len(part.walks)
        of_walks = tr("Mean over {count} walks of this condition.").format(count=count) if count > 1 else ""
        self.by_hand.setText(" ".join(filter(None, [of_walks, by_hand])))
        only = _only_for(sides_of_band, part)
        group = _group_in_words(values, bands.why_no_values if sides_of_band else None)
        stated = [by_hand, group, only, *_care_in_words(figures)]
        self.time_distance.show_figures(figures, strides, " ".join(filter(None, stated)))
        if curves is not None and any(joint.is_hip for joint in joints):
            only = " ".join(filter(None, [only, tr(HIP_BAND)]))
        self.band_words = band_in_words(bands, part.of_both("speed_m_s"), sides_of_band, only)
        self.charts.set_band(curves, _names_of_band(bands, sides_of_band), self.band_words)


def _names_of_band(bands: Bands, sides_of_band: frozenset[Side]) -> tuple[str, ...]:
    """What a chart's key calls the band, or that there is none; the longest first."""
    if not sides_of_band or (bands.curves is None and bands.why_no_curves is not NoBand.OTHER_SPEED):
        return (tr("No reference"),)
    if bands.curves is None:
        return tr("No reference at this speed"), tr("No reference")
    of_others = (tr("Reference: young adults"),) if bands.are_curves_of_other_ages else ()
    return *of_others, tr("Reference")


def _under_heads(figures: Mapping[str, Sequence[Figure]], kinds: Sequence[str]) -> list[str | Figure]:
    """The rows of these kinds that there are, each under its name."""
    rows: list[str | Figure] = []
    for kind in kinds:
        rows += [tr(KIND_WORDS[kind]), *figures[kind]] if kind in figures else []
    return rows


def _strides_deg(walk: Part, joint: Joint) -> FloatArray:
    """The single strides of one walk (k, 101), degrees, that are known throughout."""
    return side_cycle(walk, joint).strides_deg if joint.side in walk.sides else np.empty((0, POINTS))


def _why_not_reported(part: Part, joints: Sequence[Joint]) -> list[str]:
    """Why figures of the table are not reported, with what to do; what holds alike of several joints once."""
    places: dict[str, list[str]] = {}
    for joint in joints:
        found = part.verdicts.joint(joint)
        if found.height.verdict is Verdict.NOT_REPORTED:
            places.setdefault(reason_in_words(found), []).append(name_of(joint))
    return [f"{capitalised(joined(names))}: {stated}" for stated, names in places.items()]


def _care_in_words(rows: Sequence[str | Figure]) -> list[str]:
    has_care = any(row.with_care for row in rows if not isinstance(row, str))
    return [tr(CARE).format(mark=CARE_MARK)] if has_care else []


def _only_for(sides_of_band: frozenset[Side], part: Part) -> str:
    """Say which leg the band is for, where it is not for both."""
    if not sides_of_band or sides_of_band.issuperset(part.sides):
        return ""
    sides = joined([side_name(side) for side in Side if side in sides_of_band])
    return tr("The reference applies to the {side} leg only.").format(side=sides)


class FiguresCard(Card):
    """A table under its title, with what must be known to read it."""

    def __init__(self, title: str, what: str) -> None:
        super().__init__(padding=12)
        head = lay_out(QHBoxLayout(), Text(title, size=16, weight=SEMIBOLD), Text(what, size=12, tone="ink2"), 1)
        scaled(head.setSpacing, 8)
        self.table = CellTable(title)
        self.note = Text(size=12, tone="ink2", wraps=True)
        lay_out(self.column, head, self.table, self.note)

    def show_figures(self, rows: Sequence[str | Figure], strides: Mapping[Side, int], note: str) -> None:
        self.table.show_rows(figure_columns(strides), figure_rows(rows))
        self.table.setAccessibleDescription(note)
        self.note.setText(note)


def band_in_words(bands: Bands, speed_m_s: float, sides_of_band: frozenset[Side], only: str) -> str:
    """Whose band it is and how fast they walked, or why there is none; how fast this walk was."""
    whose = _whose(bands, only) if sides_of_band else tr(NO_SIDE)
    is_known = bool(np.isfinite(speed_m_s))
    speed = tr("This walk: {speed_m_s:.2f} m/s.").format(speed_m_s=speed_m_s) if is_known else tr(NO_SPEED)
    return f"{whose} {speed}"


def _whose(bands: Bands, only: str) -> str:
    band = bands.curves
    if band is None:
        return tr(WHY_NO_BAND[bands.why_no_curves or NoBand.OTHER_SPEED])
    whose = tr("Reference: {count} {group}, {speed_m_s:.2f} m/s, {source}.")
    first, year = _authors(band.source).partition(",")[0], _authors(band.source).rpartition(" ")[2]
    stated = whose.format(count=band.n, group=tr(band.group), speed_m_s=band.speed_m_s, source=f"{first} {year}")
    others = tr(OTHER_AGES) if bands.are_curves_of_other_ages else ""
    return " ".join(filter(None, [stated, others, only]))


def _group_in_words(group: ReferenceValues | None, why_none: NoBand | None) -> str:
    """Whose figures stand in the column of the band, or why there are none."""
    if group is None:
        return tr(WHY_NO_BAND[why_none]) if why_none is not None else tr(NO_SIDE)
    reported = tr("Reference: {count} of {group}; {speed_class} for leg length, {speed_m_s:.2f} m/s.")
    stated = reported.format(
        count=group.n,
        group=tr(group.group),
        speed_class=tr(SPEED_WORDS[group.speed_class]),
        speed_m_s=group.speed_m_s,
    )
    return f"{stated} {_authors(group.source)}."


def _authors(source: str) -> str:
    """Give the beginning of a source, as far as it fits a line: who and when."""
    return source.split(", PeerJ")[0]

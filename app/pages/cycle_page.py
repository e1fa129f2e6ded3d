"""The mean cycle of one walk, and its figures: the charts here, the tables beside them where the page puts them."""

from collections.abc import Mapping, Sequence

import numpy as np
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.plots.cycle_chart import CycleCharts
from app.reports.reference_bands import reference_curves, time_distance_classes
from app.reports.walk_figures import (
    Figure,
    by_hand_in_words,
    doubt_of,
    few_strides_in_words,
    peak_figures,
    side_cycle,
    strides_in_words,
    strides_used,
    time_distance_figures,
)
from app.theme import Look
from app.widgets.card import Card
from app.widgets.figures_table import FiguresTable
from app.widgets.icons import Icon, IconMark
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording import later, tr
from core.body import Side
from core.norms import ReferenceCurves, ReferenceValues
from core.results import RecordingAnalysis
from core.verdicts.quantities import both_sides

# whose bands the program brings along, as the core names them
GROUPS = (
    later("young adults, barefoot, treadmill"),
    later("42 adults, 24 young and 18 older, barefoot, overground"),
)
SPEED_WORDS = {"slow": later("slow"), "comfortable": later("comfortable"), "fast": later("fast")}
KIND_WORDS = {"knee": later("Knee"), "ankle": later("Ankle")}
SLOWER = later("Slower than the band: slower walking lowers knee peaks.")
FASTER = later("Faster than the band: faster walking raises knee peaks.")
NO_SPEED = later("This walk: speed not known, for it needs a foot sensor and usable strides.")


class CyclePage(QWidget):
    """Charts with the note on the band under them; `peaks` and `time_distance` are cards that the page places."""

    def __init__(self, look: Look) -> None:
        super().__init__()
        self._look = look
        self._reference = reference_curves()
        self._is_tight = False
        self.charts = CycleCharts(look, self._reference)
        self.note = BandNote(look)
        self.by_hand = Text(look, size=12, weight=MEDIUM, wraps=True)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.charts, 1)
        column.addWidget(self.note)
        column.addWidget(self.by_hand)
        self.peaks = FiguresCard(look, tr("Peaks and ranges"), tr("mean ± SD (°)"))
        self.peaks_note = BandNote(look)
        self.peaks.column.addWidget(self.peaks_note)
        self.time_distance = FiguresCard(look, tr("Time and distance"), tr("mean ± SD"))
        for card in (self.peaks, self.time_distance):
            card.column.addStretch(1)

    @property
    def tables(self) -> list[QWidget]:
        return [self.peaks.table, self.time_distance.table]

    def set_room(self, is_tight: bool, has_two_charts: bool) -> None:
        """Put the charts side by side where that is the better use of the page, and the note on the band under them."""
        self.charts.set_side_by_side(has_two_charts)
        self._is_tight = is_tight
        self.peaks_note.setVisible(not is_tight)

    def set_notes_shown(self, is_shown: bool) -> None:
        """Say under the charts whose band it is, where no table beside them does, and what was left out by hand."""
        self.note.setVisible(is_shown and self._is_tight)
        self.by_hand.setVisible(is_shown and bool(self.by_hand.text()))

    def show_walk(self, recording: RecordingAnalysis, is_simulated: bool) -> None:
        """Show the strides of `recording`, each side on its own stride; nothing where it has none."""
        joints = [joint for gait in recording.gait.values() for joint in gait.cycles]
        doubts = {joint: why for joint in joints if (why := doubt_of(recording, joint))}
        cycles = {joint: side_cycle(recording, joint) for joint in joints}
        self.charts.show_cycles(cycles, doubts, is_simulated)
        strides = {side: strides_used(gait) for side, gait in recording.gait.items()}
        rows: list[str | Figure] = []
        for kind, figures in peak_figures(recording, self._reference).items():
            rows += [tr(KIND_WORDS[kind]), *figures]
        told = " ".join(strides_in_words(side, gait) for side, gait in recording.gait.items())
        self.peaks.show_figures(rows, strides, " ".join(filter(None, [told, few_strides_in_words(recording)])))
        feet = both_sides(recording)
        figures, group = time_distance_figures(recording, feet, time_distance_classes())
        by_hand = by_hand_in_words(recording)
        self.by_hand.setText(by_hand)
        self.time_distance.show_figures(figures, strides, " ".join(filter(None, [by_hand, _group_in_words(group)])))
        for note in (self.note, self.peaks_note):
            note.show_band(self._reference, feet.speed_m_s)


class FiguresCard(Card):
    """A table under its title, with what must be known to read it."""

    def __init__(self, look: Look, title: str, what: str) -> None:
        super().__init__(look, padding=12)
        head = QHBoxLayout()
        head.setSpacing(8)
        head.addWidget(Text(look, title, size=16, weight=SEMIBOLD))
        head.addWidget(Text(look, what, size=12, tone="ink2"))
        head.addStretch(1)
        self.table = FiguresTable(look, title)
        self.note = Text(look, size=12, tone="ink2", wraps=True)
        self.column.addLayout(head)
        self.column.addWidget(self.table)
        self.column.addWidget(self.note)

    def show_figures(self, rows: Sequence[str | Figure], strides: Mapping[Side, int], note: str) -> None:
        self.table.show_figures(rows, strides)
        self.table.setAccessibleDescription(note)
        self.note.setText(note)


class BandNote(QWidget):
    """Whose band it is, how fast they walked, how fast this walk was; and whether that makes a difference."""

    def __init__(self, look: Look) -> None:
        super().__init__()
        self._source = Text(look, size=12, tone="ink2", wraps=True)
        self._speed = Text(look, size=12, weight=MEDIUM, wraps=True)
        self._mark = IconMark(look, Icon.WARNING, size=18)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(2)
        column.addWidget(self._source)
        row = QHBoxLayout()
        row.setSpacing(8)
        row.addWidget(self._mark)
        row.addWidget(self._speed, 1)
        column.addLayout(row)

    @property
    def text(self) -> str:
        return f"{self._source.text()} {self._speed.text()}"

    def show_band(self, band: ReferenceCurves, speed_m_s: float) -> None:
        sds = tr("inner 1 SD, outer 2 SD").replace(" SD", "\N{NO-BREAK SPACE}SD")
        whose = tr("Band: {count} {group}, {speed_m_s:.2f} m/s; {sds}.")
        said = whose.format(count=band.n, group=tr(band.group), speed_m_s=band.speed_m_s, sds=sds)
        self._source.setText(f"{said} {_authors(band.source)}.")
        is_known = bool(np.isfinite(speed_m_s))
        words = [tr("This walk: {speed_m_s:.2f} m/s.").format(speed_m_s=speed_m_s) if is_known else tr(NO_SPEED)]
        is_other = is_known and not band.fits(speed_m_s)
        if is_other:
            words.append(tr(SLOWER if speed_m_s < band.speed_m_s else FASTER))
        self._mark.setVisible(is_other)
        self._speed.setText(" ".join(words))


def _group_in_words(group: ReferenceValues | None) -> str:
    """Whose figures stand in the column of the band."""
    if group is None:
        return " ".join([tr("No band: it is chosen by walking speed."), tr(NO_SPEED)])
    told = tr("Band: {count} of {group}; {speed_class} speed, {speed_m_s:.2f} m/s.")
    said = told.format(
        count=group.n,
        group=tr(group.group),
        speed_class=tr(SPEED_WORDS[group.speed_class]),
        speed_m_s=group.speed_m_s,
    )
    return f"{said} {_authors(group.source)}."


def _authors(source: str) -> str:
    """Give the beginning of a source, as far as it fits a line: who and when."""
    return source.split(", PeerJ")[0]

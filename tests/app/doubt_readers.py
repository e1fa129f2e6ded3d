"""Readers of the status of each figure in the report and in the results on the screen.

A figure is reported, to be read with care, or not reported.

Read from the words alone, as a reader has them: the text of the PDF and the cells of the tables. Figures are named as
in strides.csv; what is not reported for want of a zero or of a sign is not reported here.
"""

import io
import re
from collections.abc import Iterator, Mapping
from enum import StrEnum

import pypdf

from app.results.result_page import ResultPage
from app.summary.walk_figures import MAY_BE_MIRRORED, NO_HEIGHT, NO_ZERO, NOT_REPORTED
from app.widgets.figures_table import CARE_MARK
from app.widgets.table import CellTable
from app.widgets.table_cells import EMPTY, TextCell
from core.body import Side


class Stated(StrEnum):
    """What a reader learns of one figure."""

    REPORTED = "told"
    CARE = "care"
    NOT_REPORTED = "withheld"
    NOT_MEASURED = "not_measured"


Doubts = dict[tuple[Side, str], Stated]

NUMBER = r"\u2212?\d+\.\d+(?: ± \d+\.\d+)?(?: \*)?"
CELL = rf"({NUMBER}|not reported|not measured|no peak|–)"
PEAKS = {  # rows of the table on page two by the beginning of their names, in each group
    "knee": {
        "Peak flexion, loading (5–30 %)": "knee_loading_peak_deg",
        "Least flexion, stance (25–60 %)": "knee_stance_minimum_deg",
        "Peak flexion, swing (55–90 %)": "knee_swing_peak_deg",
        "Range of motion": "knee_range_deg",
    },
    "ankle": {
        "Peak plantarflexion, loading (0–20 %)": "ankle_loading_plantarflexion_deg",
        "Peak dorsiflexion, stance (20–60 %)": "ankle_stance_dorsiflexion_deg",
        "Peak plantarflexion, push-off (50–80 %)": "ankle_push_off_plantarflexion_deg",
        "Peak dorsiflexion, swing (70–95 %)": "ankle_swing_dorsiflexion_deg",
        "Range of motion": "ankle_range_deg",
    },
}
TIMES = {  # rows of the table on page three
    "Stride time, s": "stride_time_s",
    "Stride length, m": "stride_length_m",
    "Stance (% gait cycle)": "stance_percent",
}
OF_BOTH = {
    "Walking speed, m/s": "speed_m_s",
    "Cadence, steps/min": "cadence_steps_min",
    "Double support (% gait cycle)": "double_support_percent",
}


def stated_in_report(pdf: bytes) -> Doubts:
    """Of the figures in the tables on pages two and three; those of both legs stand at each."""
    pages = [" ".join(page.extract_text().split()) for page in pypdf.PdfReader(io.BytesIO(pdf)).pages]
    found: Doubts = {}
    times = pages[2].split("Time, distance and strides", 1)[1]
    for name, column in TIMES.items():
        found |= _row(times, rf"{re.escape(name)} {CELL} {CELL} ", column)
    for name, column in OF_BOTH.items():
        match = re.search(rf"{re.escape(name)} (\d+(?:\.\d+)?(?: \*)?|not reported|not measured) ", times)
        assert match is not None, f"page three has no row {name}"
        found |= {(side, column): _in_report(match[1]) for side in Side}
    knee, _, ankle = pages[1].partition("Ankle: movement ranges")
    for kind, group in (("knee", knee), ("ankle", ankle)):
        for name, column in PEAKS[kind].items() if group else ():
            words = re.sub(r"(\\-|–)", r"\1 ?", re.escape(name))  # a narrow column breaks a name at its dashes
            found |= _row(group, rf"{words} {CELL} {CELL} ", column)
    return found


def _row(text: str, pattern: str, column: str) -> Doubts:
    match = re.search(pattern, text)
    assert match is not None, f"the report has no row of {column}"
    return {(side, column): _in_report(cell) for side, cell in zip(Side, match.groups(), strict=True)}


def _in_report(cell: str) -> Stated:
    if cell == "not reported":
        return Stated.NOT_REPORTED
    if cell in ("not measured", "–"):
        return Stated.NOT_MEASURED
    return Stated.CARE if cell.endswith("*") else Stated.REPORTED


ON_SCREEN = {  # rows of the tables beside the charts, peaks with the heading above them
    "Knee, Peak flexion, loading": "knee_loading_peak_deg",
    "Knee, Least flexion, stance": "knee_stance_minimum_deg",
    "Knee, Peak flexion, swing": "knee_swing_peak_deg",
    "Knee, Range of motion": "knee_range_deg",
    "Ankle, Peak dorsiflexion, stance": "ankle_stance_dorsiflexion_deg",
    "Ankle, Peak plantarflexion, push-off": "ankle_push_off_plantarflexion_deg",
    "Ankle, Peak dorsiflexion, swing": "ankle_swing_dorsiflexion_deg",
    "Ankle, Range of motion": "ankle_range_deg",
    "Walking speed": "speed_m_s",
    "Cadence": "cadence_steps_min",
    "Stride time": "stride_time_s",
    "Stride length": "stride_length_m",
    "Stance": "stance_percent",
    "Double support": "double_support_percent",
}
UNKNOWN: Mapping[str, Stated] = {
    NOT_REPORTED: Stated.NOT_REPORTED,
    NO_ZERO: Stated.NOT_REPORTED,
    NO_HEIGHT: Stated.NOT_REPORTED,
    MAY_BE_MIRRORED: Stated.NOT_REPORTED,
    "none": Stated.NOT_MEASURED,
    "": Stated.NOT_MEASURED,
}


def stated_on_screen(page: ResultPage) -> Doubts:
    """Of the figures in the tables of the walk that is shown; those of both legs stand at each."""
    tables = (page.cycles.peaks.table, page.cycles.time_distance.table)
    return {key: stated for table in tables for key, stated in _of_table(table)}


def _of_table(table: CellTable) -> Iterator[tuple[tuple[Side, str], Stated]]:
    heading = ""
    for row in table.cells.rows:
        name, *sides, _band = row.cells
        assert isinstance(name, TextCell)
        if row.is_heading:
            heading = f"{name.text}, "
            continue
        column = ON_SCREEN.get(heading + name.text)
        if column is None:
            continue
        for side, of_side in zip(Side, sides, strict=True):
            cell = sides[0] if of_side is EMPTY else of_side
            assert isinstance(cell, TextCell)
            yield (side, column), _on_screen(cell.text, cell.small)


def _on_screen(value: str, addition: str) -> Stated:
    if not value:
        return UNKNOWN[addition]
    return Stated.CARE if f"{value} {addition}".rstrip().endswith(CARE_MARK) else Stated.REPORTED

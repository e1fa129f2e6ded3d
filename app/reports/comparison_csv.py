"""Which numbers stand behind a comparison? Every difference, and the mean cycles that are laid over one another."""

import math
from pathlib import Path

from app.reports.comparison import MEASURES, Comparison, SideRow
from app.reports.csv_report import write_table
from core.body import Joint, Side
from core.gait.cycles import POINTS
from core.norms import Difference

DIFFERENCES = "differences.csv"
COMPARED_CYCLES = "compared_cycles.csv"
SIDES = "sides.csv"
JUDGED = ("difference", "error", "verdict")


def write_comparison(comparison: Comparison, folder: Path) -> None:
    """Write `differences.csv` and `compared_cycles.csv`: what each part is, its figures, and how far from the base.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    header = ("measure", "unit", "side", "part", "name", "n", "mean", "sd", "against", *JUDGED, "not_compared")
    rows = []
    for measure in MEASURES:
        for side in comparison.sides:
            for part in comparison.parts:
                value = part.value(side, measure.column)
                cells = [measure.column, _unit(measure.unit), str(side), part.letter, part.name]
                cells += [str(value.n), _cell(value.mean), _cell(value.sd)]
                if part is comparison.against:
                    rows.append([*cells, "", "", "", "", ""])
                    continue
                row = comparison.compare(measure, side, part)
                judged = _judged(row.difference) if row.is_told else ["", "", ""]
                rows.append([*cells, row.against.letter, *judged, str(row.reservation)])
    write_table(header, rows, folder / DIFFERENCES)
    curves = [(part, joint) for joint in Joint for part in comparison.parts if joint in part.joints]
    cycles = [part.cycle(joint) for part, joint in curves]
    names = [f"{part.letter}_{joint}" for part, joint in curves]
    heads = [f"{name}_{what}" for name in names for what in ("mean_deg", "stride_sd_deg", "n")]
    lines = [
        [str(percent)]
        + [
            cell
            for cycle in cycles
            for cell in (_cell(float(cycle.mean[percent])), _cell(float(cycle.sd[percent])), str(cycle.n))
        ]
        for percent in range(POINTS)
    ]
    write_table(["percent", *heads], lines, folder / COMPARED_CYCLES)


def write_sides(rows: tuple[SideRow, ...], first: Side, second: Side, path: Path) -> None:
    """Write one walk's legs side by side, the first less the second.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    each = [f"{side}_{what}" for side in (first, second) for what in ("n", "mean", "sd")]
    header = ["measure", "unit", *each, *JUDGED, "symmetry_index_percent"]
    lines = []
    for row in rows:
        cells = [row.measure.column, _unit(row.measure.unit)]
        for value in (row.first, row.second):
            cells += [str(value.n), _cell(value.mean), _cell(value.sd)]
        lines.append([*cells, *_judged(row.difference), _cell(row.symmetry_percent)])
    write_table(header, lines, path)


def _judged(difference: Difference) -> list[str]:
    return [_cell(difference.difference_deg), _cell(difference.error_deg), str(difference.verdict)]


def _unit(unit: str) -> str:
    return "deg" if unit == "°" else "percent"


def _cell(value: float) -> str:
    return f"{value:.5f}" if math.isfinite(value) else ""

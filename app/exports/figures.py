"""Which numbers leave, and in what unit? Those of summary.json and of the CSV files, to their last digit."""

from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from app.reports.csv_report import DECIMALS
from app.reports.summary import summarise
from core.body import Side
from core.results import Analysis
from core.samples import FloatArray
from core.verdicts.quantities import PARAMETERS

RESEARCH = "Research use. Not a medical device."
SIMULATED = "SIMULATED: nobody was measured."
UNITS = {  # by the end of a name, longer ends first
    "_steps_min": "steps/min",
    "_m_s": "m/s",
    "percent": "%",
    "_deg": "°",
    "_s": "s",
    "_m": "m",
}
OF_BOTH = ("cadence_steps_min", "double_support_percent", "speed_m_s")


@dataclass(frozen=True, slots=True)
class WalkFigure:
    """One average of one walk, as summary.json has it; `side` None: of both sides together. SD None: there is none."""

    walk: str
    side: Side | None
    name: str
    mean: float
    sd: float | None
    strides: int | None


def software() -> str:
    """What made the file; without a version where it is not installed."""
    try:
        return f"gaitwright {version('gaitwright')}"
    except PackageNotFoundError:
        return "gaitwright"


def unit_of(name: str) -> str:
    """The unit that a column's name ends with; empty for counts, words and ratios."""
    return next((unit for end, unit in UNITS.items() if name.endswith(end)), "")


def walk_figures(analysis: Analysis) -> Iterator[WalkFigure]:
    """Every average over strides that is known, walk by walk."""
    walks: dict[str, dict[str, Any]] = summarise(analysis)["walks"]
    for walk, figures in walks.items():
        for side in Side:
            of_side = figures[side]
            for name in PARAMETERS:
                if of_side.get(f"{name}_mean") is not None:
                    mean, sd = of_side[f"{name}_mean"], of_side[f"{name}_sd"]
                    yield WalkFigure(walk, side, name, mean, sd, of_side["strides_used"])
        for name in OF_BOTH:
            if figures["both"][name] is not None:
                yield WalkFigure(walk, None, name, figures["both"][name], None, None)


def as_in_csv_deg(angle_rad: FloatArray) -> FloatArray:
    """Degrees with the decimals of angles.csv; NaN in gaps."""
    return np.round(np.rad2deg(angle_rad), DECIMALS) + 0.0  # no minus before zero

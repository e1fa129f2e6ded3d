"""Which numbers leave, and in what unit? Those of summary.json and of the CSV files, to their last digit."""

import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from app.exports.csv_report import DECIMALS
from app.exports.summary import summarise
from app.summary.status import is_slipped, joint_status, why, why_status
from core import parameters
from core.body import Joint, Side
from core.results import Analysis, RecordingAnalysis
from core.samples import FloatArray
from core.verdicts.model import Assessment, Verdict
from core.verdicts.quantities import OF_BOTH, OF_HIPS, PARAMETERS, assessment_of, assessment_of_both

SIMULATED = "SIMULATED: nobody was measured."


@dataclass(frozen=True, slots=True)
class WalkFigure:
    """One average of one walk, as summary.json has it; `side` None: of both sides together.

    Attributes
    ----------
    mean
        None where it is withheld or was not measured.
    sd, strides, error
        None where there is none; `error` is half of what a difference of two walks has to exceed.
    assessment
        What may be said of it.
    """

    walk: str
    side: Side | None
    name: str
    mean: float | None
    sd: float | None
    strides: int | None
    error: float | None
    assessment: Assessment


def software() -> str:
    """What made the file; without a version where it is not installed."""
    try:
        return f"gaitwright {version('gaitwright')}"
    except PackageNotFoundError:
        return "gaitwright"


def unit_of(name: str) -> str:
    """The unit that a column's name ends with; empty for counts, words and ratios."""
    unit = parameters.unit_of(name)
    return unit.symbol if unit is not None else ""


def walk_figures(analysis: Analysis) -> Iterator[WalkFigure]:
    """Every average over strides, walk by walk: those that are known, withheld, or were not measured.

    What can be read and has no figure all the same, as a peak that no stride has, is no figure.
    """
    walks: dict[str, dict[str, Any]] = summarise(analysis)["walks"]
    said = {recording.name: recording.verdicts for recording in analysis.recordings}
    for walk, figures in walks.items():
        for side in Side:
            of_side = figures[side]
            for name in (*PARAMETERS, *(OF_HIPS if any(joint.is_hip for joint in said[walk].joints) else ())):
                mean, sd, error = (of_side.get(f"{name}_{what}") for what in ("mean", "sd", "error"))
                found = assessment_of(said[walk], side, name)
                if mean is not None or not found.is_told:
                    yield WalkFigure(walk, side, name, mean, sd, of_side.get("strides_used"), error, found)
        for name in OF_BOTH:
            mean, found = figures["both"][name], assessment_of_both(said[walk], name)
            if mean is not None or not found.is_told:
                yield WalkFigure(walk, None, name, mean, None, None, None, found)


def reason_of(found: Assessment) -> str:
    """Why a figure is no better than it is, in sentences; empty where it can be read."""
    if found.verdict is Verdict.NOT_MEASURED:
        return why(found) or "Not measured."
    return why(found)


def as_in_csv_deg(angle_rad: FloatArray) -> FloatArray:
    """Degrees with the decimals of angles.csv; NaN in gaps."""
    return np.round(np.rad2deg(angle_rad), DECIMALS) + 0.0  # no minus before zero


def told_deg(recording: RecordingAnalysis, joint: Joint) -> FloatArray:
    """The joint's angle as in angles.csv (n,), for formats whose samples have no status: NaN once a strap slipped."""
    found = as_in_csv_deg(recording.measured[joint].angle_rad)
    return np.where(is_slipped(recording, joint.side), np.nan, found)


def told_abduction_deg(recording: RecordingAnalysis, joint: Joint) -> FloatArray | None:
    """A hip's abduction as in angles.csv (n,), NaN once a strap slipped; None where it may not be told."""
    if not assessment_of(recording.verdicts, joint.side, "hip_abduction_peak_deg").is_told:
        return None
    found = as_in_csv_deg(recording.hips[joint].abduction_rad)
    return np.where(is_slipped(recording, joint.side), np.nan, found)


def status_in_ascii(recording: RecordingAnalysis, joint: Joint) -> str:
    """A joint's status and why, in letters that every format takes."""
    status, reasons = joint_status(recording, joint) or "not_measured", why_status(recording, joint)
    told = f"{status}: {reasons}" if reasons else status
    plain = unicodedata.normalize("NFKD", told.replace("\N{DEGREE SIGN}", " deg"))
    return plain.encode("ascii", "ignore").decode("ascii")

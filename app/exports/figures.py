"""Numbers that leave, and their units. Those of summary.json and of the CSV files, to their last digit."""

import math
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from app.exports.csv_report import DECIMALS
from app.summary.averages import Average, averages_of
from app.summary.status import why, why_status
from app.system.tables import finite
from core import parameters
from core.body import Joint, Side
from core.results import Analysis, RecordingAnalysis
from core.samples import FloatArray
from core.session import RecordingKind
from core.verdicts.model import Assessment, Verdict
from core.verdicts.quantities import OF_HIPS, PARAMETERS, assessment_of
from core.verdicts.status import is_slipped, joint_status

SIMULATED = "SIMULATED: nobody was measured."
DECIMALS_OF = {"°": 1, "%": 1, "s": 3, "m": 3, "m/s": 3, "steps/min": 1, "mm": 1}  # below the error of each figure
IN_ASCII = str.maketrans({"\N{DEGREE SIGN}": " deg", "\N{PLUS-MINUS SIGN}": "+/-", "\N{MINUS SIGN}": "-"})


@dataclass(frozen=True, slots=True)
class WalkFigure:
    """One average of one walk; `side` None: of both sides together, `strides` None: not over strides of a side."""

    walk: str
    side: Side | None
    name: str
    average: Average
    strides: int | None = None

    @property
    def assessment(self) -> Assessment:
        return self.average.assessment

    @property
    def mean(self) -> float | None:
        """None where it is not reported or was not measured."""
        return finite(self.average.mean)


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
    """Yield every mean over strides by walk, reported or not; without peaks that no stride has."""
    for recording in analysis.recordings:
        if recording.kind is RecordingKind.WALKING:
            yield from (one for one in _of_walk(recording) if one.mean is not None or not one.assessment.is_reported)


def _of_walk(recording: RecordingAnalysis) -> Iterator[WalkFigure]:
    found, has_hips = averages_of(recording), any(joint.is_hip for joint in recording.verdicts.joints)
    for side in Side:
        leg = found.legs.get(side)
        for name in (*PARAMETERS, *(OF_HIPS if has_hips else ())):
            if leg is not None and name in leg.of:
                yield WalkFigure(recording.name, side, name, leg.of[name], leg.used)
            else:
                nothing = Average(math.nan, math.nan, math.nan, assessment_of(recording.verdicts, side, name))
                yield WalkFigure(recording.name, side, name, nothing, leg.used if leg is not None else None)
    for name, average in found.both.items():
        yield WalkFigure(recording.name, None, name, average)


def reason_of(found: Assessment) -> str:
    """Why a figure is no better than it is, in sentences; empty where it can be read."""
    if found.verdict is Verdict.NOT_MEASURED:
        return why(found) or "Not measured."
    return why(found)


def as_in_csv_deg(angle_rad: FloatArray) -> FloatArray:
    """Degrees with the decimals of angles.csv; NaN in gaps."""
    return np.round(np.rad2deg(angle_rad), DECIMALS) + 0.0  # no minus before zero


def reported_deg(recording: RecordingAnalysis, joint: Joint) -> FloatArray:
    """The joint's angle as in angles.csv (n,), for formats whose samples have no status: NaN once a strap slipped."""
    found = as_in_csv_deg(recording.measured[joint].angle_rad)
    return np.where(is_slipped(recording, joint.side), np.nan, found)


def reported_abduction_deg(recording: RecordingAnalysis, joint: Joint) -> FloatArray | None:
    """A hip's abduction as in angles.csv (n,), NaN once a strap slipped; None where it may not be reported."""
    if not assessment_of(recording.verdicts, joint.side, "hip_abduction_peak_deg").is_reported:
        return None
    found = as_in_csv_deg(recording.hips[joint].abduction_rad)
    return np.where(is_slipped(recording, joint.side), np.nan, found)


def status_in_ascii(recording: RecordingAnalysis, joint: Joint) -> str:
    """A joint's status and why, in letters that every format takes."""
    status, reasons = joint_status(recording, joint) or "not_measured", why_status(recording, joint)
    return in_ascii(f"{status}: {reasons}" if reasons else status)


def in_ascii(text: str) -> str:
    """The letters of a text without their accents."""
    plain = unicodedata.normalize("NFKD", text.translate(IN_ASCII))
    return plain.encode("ascii", "ignore").decode("ascii")

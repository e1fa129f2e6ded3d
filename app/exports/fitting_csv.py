"""Tables of a walk for a prosthetist. The measures for fitting per stride, and their means with error and limits.

As in the other tables the cells of what is not reported are empty, and its status reports it.
"""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from app.system.tables import figure_cell, finite, write_table
from core.body import Side
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.verdicts.fitting import MEASURES, FittingMeasure
from core.verdicts.measurement_error import whisker
from core.verdicts.quantities import FITTING, assessment_of, joint_of, values_of
from core.verdicts.sigmas import ComparisonKind, sigma_of
from core.verdicts.stride_means import mean_of_strides

PER_STRIDE, MEANS = "fitting.csv", "fitting_means.csv"
STATUS_OF = {  # a column that represents all of its kind
    "knee_height_status": "knee_terminal_extension_deg",
    "knee_timing_status": "knee_extended_before_contact_percent",
    "foot_timing_status": "foot_flat_percent",
    "foot_pitch_status": "foot_heel_rise_deg",
    "segment_turn_status": "shank_over_flat_foot_deg",
    "segment_inclination_status": "shank_at_mid_stance_deg",
}
OF_MEAN = ("recording", "side", "measure", "n", "mean", "sd", "error", "unverified", "status", "source", "cannot_say")


def write_fitting_strides(recording: RecordingAnalysis, folder: Path) -> None:
    """Write `fitting.csv`; without gait, its heading only; raises OSError."""
    header = ["side", "start_s", *FITTING, "used", *STATUS_OF]
    write_table(header, _strides(recording), folder / PER_STRIDE)


def fitting_means(recordings: Sequence[RecordingAnalysis]) -> tuple[list[str], Iterator[list[str]]]:
    """Give heading and rows of `fitting_means.csv`: one row per recording, leg and measure."""
    return list(OF_MEAN), (
        _row(recording, side, measure)
        for recording in recordings
        for side in Side
        if side in recording.gait
        for measure in MEASURES
        if _is_measured(recording, side, measure)
    )


def fitting_of_side(recording: RecordingAnalysis, side: Side) -> dict[str, dict[str, Any]]:
    """Give what `summary.json` holds of each measure of fitting.csv: mean, sd, n, error, status; None: not known."""
    found = {}
    for name in FITTING:
        mean = mean_of_strides(_used(recording, side, name))
        found[name] = {
            "mean": finite(mean.mean),
            "sd": finite(mean.sd),
            "error": finite(whisker(name, ComparisonKind.ATTACHED, mean)),
            "n": mean.n,
            "status": str(assessment_of(recording.verdicts, side, name).verdict),
        }
    return found


def _strides(recording: RecordingAnalysis) -> Iterator[list[str]]:
    for side in Side:
        if side not in recording.gait:
            continue
        strides = recording.gait[side].strides
        columns = [strides.start_s, *(values_of(recording, side, name) for name in FITTING)]
        status = [str(assessment_of(recording.verdicts, side, name).verdict) for name in STATUS_OF.values()]
        for k, reason in enumerate(strides.reason):
            cells = [figure_cell(float(column[k])) for column in columns]
            yield [str(side), *cells, "false" if reason else "true", *status]


def _row(recording: RecordingAnalysis, side: Side, measure: FittingMeasure) -> list[str]:
    name = measure.column
    mean, sigma = mean_of_strides(_used(recording, side, name)), sigma_of(name, ComparisonKind.ATTACHED)
    error = whisker(name, ComparisonKind.ATTACHED, mean)
    is_unverified = not measure.is_source_read or (math.isfinite(error) and sigma is not None and not sigma.is_verified)
    status = assessment_of(recording.verdicts, side, name)
    figures = [figure_cell(mean.mean), figure_cell(mean.sd), figure_cell(error)]
    words = ["true" if is_unverified else "false", str(status.verdict), measure.source, measure.cannot_say]
    return [recording.folder, str(side), name, str(mean.n), *figures, *words]


def _used(recording: RecordingAnalysis, side: Side, name: str) -> FloatArray:
    return values_of(recording, side, name)[recording.gait[side].strides.is_used]


def _is_measured(recording: RecordingAnalysis, side: Side, measure: FittingMeasure) -> bool:
    joint = joint_of(measure.column, side)
    return joint is None or joint in recording.joints

"""What was found, in one file that other programs read? Joints, calibrations, walks and findings as JSON."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from app.reports.gait_csv import PARAMETERS, mean_of_used, parameter
from app.reports.reference_bands import reference_curves
from app.reports.walk_figures import both_sides
from app.wording import sentence
from core.body import Joint, Side
from core.chosen_strides import left_out_by_hand
from core.findings import Finding
from core.gait.spatiotemporal import MeanAndSd, mean_and_sd
from core.gait.symmetry import curve_difference, gait_variable_score, symmetry_index_percent
from core.norms import compare_new_attachment
from core.results import Analysis, JointCalibration, RecordingAnalysis, SideGait, ZeroKind
from core.samples import FloatArray, RecordingKind

FORMAT = "gaitwright-analysis/1"
BOTH = (
    "cadence_steps_min",
    "double_support_percent",
    "speed_m_s",
    "symmetry_index_percent",
    "curve_difference_deg",
    "side_difference",
)
KINDS = ("knee", "ankle")
# positive figures only: the index means nothing for signed angles
SYMMETRIC = (
    "stride_time_s",
    "step_time_s",
    "stance_percent",
    "swing_percent",
    "stride_length_m",
    "knee_range_deg",
    "ankle_range_deg",
)


def write_summary(analysis: Analysis, path: Path) -> None:
    """Write `summary.json`.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    text = json.dumps(summarise(analysis), indent=2, ensure_ascii=False, allow_nan=False)
    # a file's name may hold bytes that are no text: what replaces them is an escape of JSON too
    path.write_text(text + "\n", encoding="utf-8", errors="backslashreplace", newline="\n")


def read_summary(path: Path) -> dict[str, Any] | None:
    """Read what `write_summary` wrote; None when there is no such file, or one of another program."""
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):  # ValueError: no JSON, or not even UTF-8
        return None
    is_ours = isinstance(summary, dict) and summary.get("format") == FORMAT
    return summary if is_ours else None


def summarise(analysis: Analysis) -> dict[str, Any]:
    """Give the content of `summary.json`; `joints` holds each joint's last calibration."""
    calibrations = [{"walks": list(span.walks), "joints": _joints(span.joints)} for span in analysis.calibrations]
    last = {joint: found for span in analysis.calibrations for joint, found in span.joints.items()}
    walks = [recording for recording in analysis.recordings if recording.kind is RecordingKind.WALKING]
    return {
        "format": FORMAT,
        "simulated": analysis.is_simulated,
        "joints": _joints(last),
        "calibrations": calibrations,
        "walks": {walk.name: _walk(walk, _calibrated(analysis, walk), analysis.affected_side) for walk in walks},
        "reference_group": _reference_group(),
        "findings": [_finding(finding) for finding in analysis.findings],
    }


def _reference_group() -> dict[str, Any]:
    """Say whom the gait variable score compares with."""
    group = reference_curves()
    return {"group": group.group, "n": group.n, "speed_m_s": group.speed_m_s, "source": group.source}


def _calibrated(analysis: Analysis, walk: RecordingAnalysis) -> dict[Joint, JointCalibration]:
    """Give the calibrations that one walk was measured with."""
    return {j: found for span in analysis.calibrations if walk.name in span.walks for j, found in span.joints.items()}


def _walk(
    recording: RecordingAnalysis, calibrated: Mapping[Joint, JointCalibration], affected: Side | None
) -> dict[str, Any]:
    """Give each side's averages over the strides used, and what compares both sides."""
    has_zero = {joint for joint, found in calibrated.items() if found.zero is not ZeroKind.NONE}
    sides = {str(side): _side(side, recording.gait[side], has_zero) if side in recording.gait else {} for side in Side}
    feet = both_sides(recording)
    both: dict[str, Any] = {
        **dict.fromkeys(BOTH),
        "cadence_steps_min": _number(feet.cadence_steps_min),
        "double_support_percent": _number(feet.double_support_percent),
        "speed_m_s": _number(feet.speed_m_s),
    }
    if len(recording.gait) < len(Side):
        return {**sides, "both": both}
    left, right = recording.gait[Side.LEFT], recording.gait[Side.RIGHT]
    one, other = (right, left) if affected is Side.RIGHT else (left, right)
    both |= {
        "symmetry_index_percent": {
            name: _number(symmetry_index_percent(_mean(one, name).mean, _mean(other, name).mean)) for name in SYMMETRIC
        },
        "curve_difference_deg": {kind: _number(_difference_deg(left, right, kind, has_zero)) for kind in KINDS},
        "side_difference": {
            name: _side_difference(one, other, name, has_zero) for name in PARAMETERS if name.endswith("_deg")
        },
    }
    return {**sides, "both": both}


def _side(side: Side, gait: SideGait, has_zero: set[Joint]) -> dict[str, Any]:
    used = int(np.count_nonzero(gait.strides.is_used))
    figures: dict[str, Any] = {
        "strides_used": used,
        "strides_left_out": len(gait.strides) - used,
        "strides_left_out_by_hand": left_out_by_hand(gait),
    }
    for name in PARAMETERS:
        found = _mean(gait, name)
        figures[f"{name}_mean"], figures[f"{name}_sd"] = _number(found.mean), _number(found.sd)
    joints = {kind: Joint(f"{side}_{kind}") for kind in KINDS}
    scores = {kind: _number(_score_deg(gait, j)) if j in has_zero else None for kind, j in joints.items()}
    return {**figures, "gait_variable_score_deg": scores}


def _score_deg(gait: SideGait, joint: Joint) -> float:
    """Give the distance from the mean curve of a group that walked at one speed, so another speed counts as well."""
    group = reference_curves()
    group_deg = group.knee_mean_deg if joint.is_knee else group.ankle_mean_deg
    return gait_variable_score(np.rad2deg(mean_of_used(gait, joint).mean), group_deg)


def _mean(gait: SideGait, name: str) -> MeanAndSd:
    return mean_and_sd(parameter(gait, name)[gait.strides.is_used])


def _difference_deg(left: SideGait, right: SideGait, kind: str, has_zero: set[Joint]) -> float:
    joints = [Joint(f"{side}_{kind}") for side in Side]
    if not has_zero.issuperset(joints):  # each would be told from a zero of its own
        return math.nan
    means = [mean_of_used(gait, joint).mean for gait, joint in zip((left, right), joints, strict=True)]
    return math.degrees(curve_difference(means[0], means[1]))


def _side_difference(one: SideGait, other: SideGait, name: str, has_zero: set[Joint]) -> dict[str, Any] | None:
    """Give by how much an angle differs between the sides, and whether that exceeds the measurement error.

    None where either side has no such angle, or no zero to tell it from.
    """
    joints = [Joint(f"{side}_{name.split('_')[0]}") for side in Side]
    if not name.endswith("_range_deg") and not has_zero.issuperset(joints):
        return None
    means = _mean(one, name), _mean(other, name)
    if not all(mean.n for mean in means):
        return None
    found = compare_new_attachment(joints[0], *means)
    return {
        "difference_deg": _number(found.difference_deg),
        "error_deg": _number(found.error_deg),
        "verdict": str(found.verdict),
    }


def _joints(joints: Mapping[Joint, JointCalibration]) -> dict[str, Any]:
    return {str(joint): _joint(joints[joint]) for joint in Joint if joint in joints}


def _joint(found: JointCalibration) -> dict[str, Any]:
    return {
        "axis_proximal": _vector(found.axis_proximal),
        "axis_distal": _vector(found.axis_distal),
        "centre_proximal_m": _vector(found.centre_proximal_m),
        "centre_distal_m": _vector(found.centre_distal_m),
        "axis_sd_deg": _number(found.axis_sd_rad, math.degrees(1)),
        "centre_sd_mm": _number(found.centre_sd_m, 1000),
        "sign_margin": _number(found.sign_margin),
        "clinical_sign": int(found.clinical_sign),
        "is_sign_certain": bool(found.is_sign_certain),
        "clinical_sign_margin": _number(found.clinical_sign_margin),
        "lag_s": _number(found.lag_s),
        "lag_sd_s": _number(found.lag_sd_s),
        "hinge_residual_rad_s": _number(found.hinge_residual_rad_s),
        "is_hinge": bool(found.is_hinge),
        "gyro_bias_proximal_rad_s": _vector(found.gyro_bias_proximal_rad_s),
        "gyro_bias_distal_rad_s": _vector(found.gyro_bias_distal_rad_s),
        "zero": str(found.zero),
        "axis_source": str(found.axis_source),
        "method": str(found.method),
        "from": {
            "standing": found.standing_from,
            "free_motion": found.free_motion_from,
            "walks": list(found.walks_from),
        },
    }


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        "key": finding.key,
        "severity": str(finding.severity),
        "where": finding.where,
        "text": sentence(finding),
        "numbers": {name: _plain(value) for name, value in finding.numbers.items()},
    }


def _vector(vector: FloatArray | None) -> list[float] | None:
    """Give a vector as a list; None where any part of it is unknown."""
    if vector is None or not np.isfinite(vector).all():
        return None
    return [float(part) for part in vector]


def _number(value: float | None, factor: float = 1.0) -> float | None:
    """Give a figure as JSON can hold it: None where it could not be found or has no bound."""
    if value is None or not math.isfinite(value):
        return None
    return float(value) * factor


def _plain(value: float | int | str) -> float | int | str | None:
    """Give a finding's figure as JSON can hold it, also where it came out of an array."""
    if isinstance(value, str):
        return str(value)
    if isinstance(value, int | np.integer):
        return int(value)
    return _number(value)

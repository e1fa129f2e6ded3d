"""What was found, in one file that other programs read? Joints, calibrations, walks and findings as JSON."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from app.wording import sentence
from core.body import Joint
from core.findings import Finding
from core.results import Analysis, JointCalibration
from core.samples import FloatArray, RecordingKind

FORMAT = "gaitwright-analysis/1"


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
    walks = [recording.name for recording in analysis.recordings if recording.kind is RecordingKind.WALKING]
    return {
        "format": FORMAT,
        "simulated": analysis.is_simulated,
        "joints": _joints(last),
        "calibrations": calibrations,
        "walks": {walk: {"left": {}, "right": {}, "both": {}} for walk in walks},
        "findings": [_finding(finding) for finding in analysis.findings],
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

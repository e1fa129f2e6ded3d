"""Findings in one file that other programs read. Joints, calibrations, walks and findings as JSON."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from app.exports.fitting_csv import fitting_of_side
from app.exports.goals_csv import goal_figures, goals_of_walk
from app.exports.timed_csv import timed_summary
from app.summary.averages import LegAverages, averages_of
from app.summary.comparison import compare_legs, first_and_second
from app.summary.condition_figures import summarise_conditions
from app.summary.conditions import Part
from app.summary.differences import likely_figures
from app.summary.error_figures import error_figures_in_json
from app.summary.reference_bands import reference_curves
from app.system.tables import finite
from app.wording.findings import sentence
from app.wording.verdicts import gate_sentence
from core.alignment import alignment_table
from core.body import Joint, Side, hip_of
from core.findings import Finding
from core.gait.symmetry import curve_difference, gait_variable_score, symmetry_index_percent
from core.goals import NO_GOALS, AgreedGoals
from core.hip.results import HipIdentification
from core.parameters import REGISTRY
from core.prosthesis import prostheses_tables
from core.results import Analysis, JointCalibration, RecordingAnalysis
from core.samples import FloatArray
from core.session import Recording, RecordingKind
from core.verdicts.model import Assessment, JointVerdicts, LegVerdicts, Verdict, Verdicts
from core.verdicts.quantities import (
    OF_BOTH,
    OF_HIPS,
    PARAMETERS,
    mean_curve,
)

FORMAT = "gaitwright-analysis/1"
BOTH = (*OF_BOTH, "symmetry_index_percent", "curve_difference_deg", "side_difference")
KINDS = ("knee", "ankle")
OF_JOINT = (
    *("axis_proximal", "axis_distal", "centre_proximal_m", "centre_distal_m", "axis_sd_deg", "centre_sd_mm"),
    *("sign_margin", "clinical_sign", "is_sign_certain", "clinical_sign_margin", "lag_s", "lag_sd_s"),
    *("hinge_residual_rad_s", "is_hinge", "gyro_bias_proximal_rad_s", "gyro_bias_distal_rad_s"),
    *("zero", "axis_source", "method"),
)
SYMMETRIC = tuple(quantity.column for quantity in REGISTRY if quantity.has_index)


def write_summary(
    analysis: Analysis, path: Path, recordings: Sequence[Recording] = (), agreed: AgreedGoals = NO_GOALS
) -> None:
    """Write `summary.json`; `recordings` are the session's, for alignments; raises OSError."""
    text = json.dumps(summarise(analysis, recordings, agreed), indent=2, ensure_ascii=False, allow_nan=False)
    # a file's name may hold bytes that are no text: what replaces them is an escape of JSON too
    path.write_text(text + "\n", encoding="utf-8", errors="backslashreplace", newline="\n")


def summarise(
    analysis: Analysis, recordings: Sequence[Recording] = (), agreed: AgreedGoals = NO_GOALS
) -> dict[str, Any]:
    """Give the content of `summary.json`; `joints` holds each joint's last calibration.
    Walks have `alignment` after a prosthesis change, `timed_test`, `goals` if agreed by the session's day.
    With `recordings`, `conditions` has the report's figures over the strides of all walks of a condition. `prostheses`
    is what was stated of them, where something was.
    """
    changed = {one.name: alignment_table(one.alignment) for one in recordings if one.alignment is not None}
    calibrations = [{"walks": list(span.walks), "joints": _joints(span.joints)} for span in analysis.calibrations]
    last = {joint: found for span in analysis.calibrations for joint, found in span.joints.items()}
    walks = [recording for recording in analysis.recordings if recording.kind is RecordingKind.WALKING]
    return {
        "format": FORMAT,
        "simulated": analysis.is_simulated,
        "joints": _joints(last),
        "calibrations": calibrations,
        "walks": {
            walk.name: _walk(analysis, walk)
            | ({"alignment": changed[walk.name]} if walk.name in changed else {})
            | ({"goals": _goals(analysis, walk, agreed)} if agreed.held else {})
            for walk in walks
        },
        **({"conditions": summarise_conditions(analysis, recordings, agreed)} if recordings else {}),
        "reference_group": _reference_group(),
        "error_figures": error_figures_in_json(),
        "findings": [_finding(finding) for finding in analysis.findings],
        **({"prostheses": prostheses_tables(analysis.prostheses)} if analysis.prostheses else {}),
    }


def _goals(analysis: Analysis, walk: RecordingAnalysis, agreed: AgreedGoals) -> list[dict[str, Any]]:
    return [dict(goal_figures(one, agreed)) for one in goals_of_walk(analysis, walk, agreed)] if walk.gait else []


def _reference_group() -> dict[str, Any]:
    """Say whom the gait variable score compares with."""
    group = reference_curves()
    return {"group": group.group, "n": group.n, "speed_m_s": group.speed_m_s, "source": group.source}


def _walk(analysis: Analysis, recording: RecordingAnalysis) -> dict[str, Any]:
    """Give each side's averages over the strides used, what compares both sides, and what may be stated about each."""
    found = averages_of(recording)
    sides = {str(side): _side(side, recording, found.legs[side]) if side in found.legs else {} for side in Side}
    both: dict[str, Any] = dict.fromkeys(BOTH)
    for name, average in found.both.items():
        both[name], both[f"{name}_status"] = finite(average.mean), str(average.assessment.verdict)
    walk = {**sides, "both": both, "verdicts": _verdicts(recording.verdicts), **_of_pelvis(recording)}
    if recording.timed is not None:
        walk["timed_test"] = timed_summary(recording.timed)
    if len(recording.gait) < len(Side):
        return walk
    one, other = pair = first_and_second(analysis.affected_side)
    part = Part("", recording.name, (recording,), analysis.calibrated_for(recording))
    both |= {
        "symmetry_index_percent": {
            name: finite(symmetry_index_percent(*(found.legs[side].of[name].mean for side in (one, other))))
            for name in SYMMETRIC
        },
        "curve_difference_deg": {kind: finite(_difference_deg(recording, kind)) for kind in KINDS},
        "side_difference": {name: _side_difference(part, name, pair) for name in PARAMETERS if name.endswith("_deg")},
    }
    return walk


def _side(side: Side, recording: RecordingAnalysis, found: LegAverages) -> dict[str, Any]:
    figures: dict[str, Any] = {
        "strides_used": found.used,
        "strides_left_out": found.left_out,
        "strides_left_out_by_hand": found.left_out_by_hand,
    }
    of_hips: dict[str, Any] = {}
    for name, average in found.of.items():
        into = of_hips if name in OF_HIPS else figures
        into[f"{name}_mean"], into[f"{name}_sd"] = finite(average.mean), finite(average.sd)
        if name not in OF_HIPS:
            into[f"{name}_error"] = finite(average.error)
        into[f"{name}_status"] = str(average.assessment.verdict)
    joints = {kind: Joint(f"{side}_{kind}") for kind in KINDS}
    scores = {kind: finite(_score_deg(recording, joint)) for kind, joint in joints.items()}
    fitting = fitting_of_side(recording, side)
    return {**figures, "gait_variable_score_deg": scores, "fitting": fitting, **of_hips}


def _score_deg(recording: RecordingAnalysis, joint: Joint) -> float:
    """Give the distance from the mean curve of a group that walked at one speed, so another speed counts as well."""
    if not recording.verdicts.joint(joint).height.is_reported:
        return math.nan
    group = reference_curves()
    group_deg = group.knee_mean_deg if joint.is_knee else group.ankle_mean_deg
    return gait_variable_score(np.rad2deg(mean_curve(recording, joint).mean), group_deg)


def _difference_deg(recording: RecordingAnalysis, kind: str) -> float:
    joints = [Joint(f"{side}_{kind}") for side in Side]
    if not all(recording.verdicts.joint(joint).height.is_reported for joint in joints):
        return math.nan  # each would be measured from a zero of its own
    means = [mean_curve(recording, joint).mean for joint in joints]
    return math.degrees(curve_difference(means[0], means[1]))


def _side_difference(part: Part, name: str, sides: tuple[Side, Side]) -> dict[str, Any] | None:
    """Give an angle's difference of the sides and whether it exceeds the error; None if one has no figure."""
    if not all(part.value(side, name).n for side in sides):
        return None
    found = compare_legs(part, name, sides)
    return {
        "difference_deg": finite(found.difference),
        "error_deg": finite(found.error),
        "verdict": str(found.judgement),
        "error_sources": [str(source) for source in found.sources],
        **{f"{key}_deg": finite(value) for key, value in likely_figures(found).items()},
        "mark": str(found.mark),
    }


def _verdicts(found: Verdicts) -> dict[str, Any]:
    """Give every verdict of a walk with its reasons in words; a joint or leg that was not worn is marked so."""
    joints = {str(joint): _parts(found.joint(joint), ("shape", "height", "sign")) for joint in found.reported_joints}
    legs = {str(side): _parts(found.leg(side), ("timing", "distance")) for side in Side}
    more = {}
    if found.pelvis.verdict is not Verdict.NOT_MEASURED:
        more = {"pelvis": _assessment(found.pelvis), "pelvis_tilt": _assessment(found.pelvis_tilt)}
        more |= {f"{hip_of(side)}_abduction": _assessment(one) for side, one in found.abduction.items()}
    return {**joints, **legs, "between": _assessment(found.between), **more}


def _parts(found: JointVerdicts | LegVerdicts, names: tuple[str, ...]) -> dict[str, Any]:
    return {name: _assessment(getattr(found, name)) for name in names}


def _assessment(found: Assessment) -> dict[str, Any]:
    reasons = [
        {
            "gate": reason.gate,
            "value": finite(reason.value),
            "limit": finite(reason.limit),
            "unit": reason.unit,
            "text": gate_sentence(reason),
        }
        for reason in found.reasons
    ]
    return {"verdict": str(found.verdict), "reasons": reasons}


def _joints(joints: Mapping[Joint, JointCalibration]) -> dict[str, Any]:
    return {str(joint): _joint(joints[joint]) for joint in Joint if joint in joints}


def _joint(found: JointCalibration) -> dict[str, Any]:
    axis_sd, centre_sd = found.axis_sd_rad, found.centre_sd_m
    scaled = {
        "axis_sd_deg": None if axis_sd is None else finite(math.degrees(axis_sd)),
        "centre_sd_mm": None if centre_sd is None else finite(1000 * centre_sd),
    }
    return {
        **{name: scaled[name] if name in scaled else _known(getattr(found, name)) for name in OF_JOINT},
        "from": {
            "standing": found.standing_from,
            "free_motion": found.free_motion_from,
            "walks": list(found.walks_from),
        },
    }


def _of_pelvis(recording: RecordingAnalysis) -> dict[str, Any]:
    """Give the hips' identification, the clock of both legs, turns, and the pelvis's lean; nothing without a pelvis."""
    reported: dict[str, Any] = {}
    if recording.leg_clock is not None:
        clock = recording.leg_clock
        reported["leg_clock_offset_s"], reported["leg_clock_sd_s"] = finite(clock.offset_s), finite(clock.sd_s)
        reported["leg_clock_status"] = str(clock.status)
    if recording.pelvis is not None:
        tilt, is_reported = recording.pelvis.tilt_rad, recording.verdicts.pelvis.is_reported
        known = tilt[np.isfinite(tilt)]
        reported["pelvis_lean_deg"] = finite(math.degrees(float(known.mean()))) if is_reported and len(known) else None
        reported["hips"] = {str(joint): _hip(hip.identification) for joint, hip in recording.hips.items()}
        reported["turns"] = [
            {"start_s": turn.start_s, "end_s": turn.end_s, "angle_deg": math.degrees(turn.angle_rad)}
            for turn in recording.turns
        ]
    return reported


def _hip(found: HipIdentification) -> dict[str, Any]:
    return {
        "centre_proximal_m": [float(part) for part in found.centre_proximal_m],
        "centre_distal_m": [float(part) for part in found.centre_distal_m],
        "sign_margin": finite(found.margin),
        "disagreement": finite(found.disagreement),
        "heading_sd_deg": finite(math.degrees(found.heading_sd_rad)),
        "is_3d": bool(found.is_3d),
        "moving_s": finite(found.moving_s),
        "lag_s": finite(found.lag_s),
        "centres_apart_m": finite(found.centres_apart_m),
        "from": {"standing": found.standing_from},
    }


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        "key": finding.key,
        "severity": str(finding.severity),
        "where": finding.where,
        "text": sentence(finding),
        "numbers": {name: _plain(value) for name, value in finding.numbers.items()},
    }


def _known(value: FloatArray | bool | float | int | str | None) -> list[float] | float | int | str | None:
    """What is known of a joint, as JSON can hold it: a vector whole, or not at all."""
    if isinstance(value, np.ndarray):
        return [float(part) for part in value] if np.isfinite(value).all() else None
    return bool(value) if isinstance(value, bool | np.bool_) else _plain(value)


def _plain(value: float | int | str | None) -> float | int | str | None:
    """Give a figure as JSON can hold it, also where it came out of an array."""
    if isinstance(value, str):
        return str(value)
    return int(value) if isinstance(value, int | np.integer) else finite(value)

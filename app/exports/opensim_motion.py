"""Angles for OpenSim: a motion file (.mot) per recording, in degrees, named as a model's coordinates.

The names and signs are those of models whose knee flexion is positive, as Rajagopal et al. 2016, doi
10.1109/TBME.2016.2586891; in gait2392 the knee has the other sign, hips and pelvis the same one. There x points
forward, y up and z to the right: `pelvis_tilt` turns about z and is negative forward, `pelvis_list` about x and is
positive where the left side is the higher one. A model takes a coordinate for a pose, so one whose height or sign is
not known is left out, and a comment states why.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from app.exports.figures import SIMULATED, as_in_csv_deg, reported_abduction_deg, reported_deg, status_in_ascii
from app.exports.parts import part_paths
from app.summary.status import WITH_HEIGHT, joint_status, why_status
from app.wording.translation import PURPOSE, tr
from core.body import Joint
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.signal.tracks import nominal_step_s

COORDINATES = {
    Joint.RIGHT_KNEE: "knee_angle_r",
    Joint.LEFT_KNEE: "knee_angle_l",
    Joint.RIGHT_ANKLE: "ankle_angle_r",
    Joint.LEFT_ANKLE: "ankle_angle_l",
    Joint.RIGHT_HIP: "hip_flexion_r",
    Joint.LEFT_HIP: "hip_flexion_l",
}
BRIDGED_S = 0.1  # a joint's angle goes straight on for so long
SHORTEST_S = 0.5  # of what is worth a file
ADDUCTION = {Joint.RIGHT_HIP: "hip_adduction_r", Joint.LEFT_HIP: "hip_adduction_l"}
OF_HIPS = (
    "Hip flexion and adduction are positive; pelvis_tilt is negative forward, pelvis_list positive with the left side "
    "up. They start from standing, which is not the zero of a model. hip_rotation and pelvis_rotation are left out: "
    "the one is not readable, of the other the heading is not known."
)


@dataclass(frozen=True, slots=True)
class MotionPart:
    """Rows in which the same coordinates are known throughout."""

    rows: slice
    names: tuple[str, ...]


def write_motion(recording: RecordingAnalysis, is_simulated: bool, path: Path) -> str:
    """Write one recording's known angles as .mot files; give why there is none (translated), else "".
    OpenSim stops at NaN, so short gaps are bridged; at others another file begins (`angles_1.mot`).
    """
    measured = [joint for joint in COORDINATES if joint in recording.measured]
    joints = [joint for joint in measured if joint_status(recording, joint) in WITH_HEIGHT]
    bending = {COORDINATES[joint]: reported_deg(recording, joint) for joint in joints}
    found = {**bending, **_of_hips_and_pelvis(recording)}
    columns = {name: _bridged(recording.time_s, values) for name, values in found.items()}
    parts = _parts(recording.time_s, columns)
    if not parts:
        reasons = [why_status(recording, joint) for joint in measured if joint not in joints]
        return " ".join([tr("This recording has no angle to export as a pose."), *dict.fromkeys(filter(None, reasons))])
    header = [
        "",
        *([SIMULATED] if is_simulated else []),
        f"Made by gaitwright. {PURPOSE}",
        "Knee flexion and ankle dorsiflexion are positive. What is named nowhere in this file was not measured.",
        *([OF_HIPS] if recording.hips else []),
        *(f"{COORDINATES[joint]} is {_stated(recording, joint, joint in joints)}" for joint in measured),
    ]
    for number, (part, place) in enumerate(zip(parts, part_paths(path, len(parts)), strict=True), start=1):
        time_s = recording.time_s[part.rows]
        about = [f"Part {number} of {len(parts)}, {time_s[0]:.3f} to {time_s[-1]:.3f} s."] if len(parts) > 1 else []
        about += [f"{name} is not known in this part." for name in columns if name not in part.names]
        for name in part.names:
            count = int(np.count_nonzero(~np.isfinite(found[name][part.rows])))
            about += [f"{name} is interpolated over gaps of up to {BRIDGED_S:g} s, {count} rows."] if count else []
        _write_part(place, time_s, {name: columns[name][part.rows] for name in part.names}, [*header, *about])
    return ""


def _write_part(path: Path, time_s: FloatArray, columns: Mapping[str, FloatArray], about: Sequence[str]) -> None:
    header = [
        "Coordinates",
        "version=1",
        f"nRows={len(time_s)}",
        f"nColumns={1 + len(columns)}",
        "inDegrees=yes",
        *about,
        "endheader",
        "\t".join(["time", *columns]),
    ]
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write("\n".join(header) + "\n")
        for k, at_s in enumerate(time_s):
            cells = (f"{column[k]:.5f}" for column in columns.values())
            file.write("\t".join([repr(float(at_s)), *cells]) + "\n")


def _bridged(time_s: FloatArray, values: FloatArray) -> FloatArray:
    """The same (n,), straight over what is missing for no longer than `BRIDGED_S`."""
    known = np.flatnonzero(np.isfinite(values))
    ends_s = time_s[known]
    gap = np.flatnonzero((np.diff(known) > 1) & (np.diff(ends_s) <= BRIDGED_S + 1e-9))
    bridged = values.copy()
    for first, last in zip(known[gap], known[gap + 1], strict=True):
        rows = slice(first + 1, last)
        bridged[rows] = np.interp(time_s[rows], time_s[[first, last]], values[[first, last]])
    return bridged


def _parts(time_s: FloatArray, columns: Mapping[str, FloatArray]) -> list[MotionPart]:
    """Where the same coordinates are known, without a gap, for as long as is worth a file."""
    if not columns or len(time_s) < 2:
        return []
    is_known = np.isfinite(np.stack(list(columns.values()), axis=1))
    is_cut = np.any(is_known[1:] != is_known[:-1], axis=1)
    is_cut |= np.diff(time_s) > max(BRIDGED_S, 1.5 * nominal_step_s(time_s))
    edges = [0, *(np.flatnonzero(is_cut) + 1).tolist(), len(time_s)]
    parts = []
    for first, end in pairwise(edges):
        names = tuple(name for name, known in zip(columns, is_known[first], strict=True) if known)
        if names and time_s[end - 1] - time_s[first] >= SHORTEST_S:
            parts.append(MotionPart(slice(first, end), names))
    return parts


def _of_hips_and_pelvis(recording: RecordingAnalysis) -> Mapping[str, FloatArray]:
    """What else may be given for hips and pelvis, by the model's names and signs; none without a pelvis sensor."""
    found = {
        name: reported_abduction_deg(recording, joint) for joint, name in ADDUCTION.items() if joint in recording.hips
    }
    columns = {name: 0.0 - abduction_deg for name, abduction_deg in found.items() if abduction_deg is not None}
    if recording.pelvis is not None and recording.verdicts.pelvis.is_reported:
        columns["pelvis_tilt"] = 0.0 - as_in_csv_deg(recording.pelvis.tilt_rad)
        columns["pelvis_list"] = as_in_csv_deg(recording.pelvis.obliquity_rad)
    return columns


def _stated(recording: RecordingAnalysis, joint: Joint, is_reported: bool) -> str:
    """Whether a coordinate is here, what holds of it and why."""
    stated = status_in_ascii(recording, joint)
    return f"here, {stated}" if is_reported else f"left out, {stated}"

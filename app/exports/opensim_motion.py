"""Angles for OpenSim: a motion file (.mot) per recording, in degrees, named as a model's coordinates.

Names, signs and limits are those of one model, which the head names: Rajagopal et al. 2016, doi
10.1109/TBME.2016.2586891, or gait2392 of Delp et al. 1990, doi 10.1109/10.102791, where knee flexion is negative; hips
and pelvis have the same signs in both. There x points forward, y up and z to the right: `pelvis_tilt` turns about z and
is negative forward, `pelvis_list` about x and is positive where the left side is the higher one. A model takes a
coordinate for a pose, so one whose height or sign is not known is left out, and a comment states why. What lies beyond
a coordinate's range is kept at its limit, and a comment states how far it was beyond.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from pathlib import Path

import numpy as np

from app.exports.figures import SIMULATED, as_in_csv_deg, reported_abduction_deg, reported_deg, status_in_ascii
from app.exports.parts import part_paths
from app.summary.status import why_status
from app.wording.translation import PURPOSE, tr
from core.body import Joint
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.signal.tracks import nominal_step_s
from core.verdicts.status import WITH_HEIGHT, joint_status

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


class Model(StrEnum):
    """A model whose coordinates a motion file is for."""

    RAJAGOPAL2016 = "rajagopal2016"
    GAIT2392 = "gait2392"


@dataclass(frozen=True, slots=True)
class Coordinates:
    """What a model's coordinates mean. `knee`: 1 where flexion is positive; `limits_deg`: by name without side."""

    words: str
    knee: float
    limits_deg: Mapping[str, tuple[float, float]]


# the ranges of Rajagopal2016.osim and gait2392_thelen2003muscle.osim, as OpenSim's collection of models has them
OF_PELVIS = {"pelvis_tilt": (-90.0, 90.0), "pelvis_list": (-90.0, 90.0)}
MODELS = {
    Model.RAJAGOPAL2016: Coordinates(
        "Rajagopal 2016 (Rajagopal2016.osim): knee flexion is positive",
        1.0,
        {
            "knee_angle": (0.0, 120.0),
            "ankle_angle": (-40.0, 30.0),
            "hip_flexion": (-30.0, 120.0),
            "hip_adduction": (-50.0, 30.0),
            **OF_PELVIS,
        },
    ),
    Model.GAIT2392: Coordinates(
        "gait2392 (gait2392_thelen2003muscle.osim and others of this name): knee flexion is negative",
        -1.0,
        {
            "knee_angle": (-120.0, 10.0),
            "ankle_angle": (-90.0, 90.0),
            "hip_flexion": (-120.0, 120.0),
            "hip_adduction": (-120.0, 120.0),
            **OF_PELVIS,
        },
    ),
}
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


def write_motion(
    recording: RecordingAnalysis, is_simulated: bool, path: Path, model: Model = Model.RAJAGOPAL2016
) -> str:
    """Write one recording's known angles as .mot files; give why there is none (translated), else "".
    OpenSim stops at NaN, so short gaps are bridged; at others another file begins (`angles_1.mot`).
    """
    of_model = MODELS[model]
    measured = [joint for joint in COORDINATES if joint in recording.measured]
    joints = [joint for joint in measured if joint_status(recording, joint) in WITH_HEIGHT]
    bending = {
        COORDINATES[joint]: (of_model.knee if joint.is_knee else 1.0) * reported_deg(recording, joint) + 0.0
        for joint in joints
    }
    found = {**bending, **_of_hips_and_pelvis(recording)}
    limits_deg = {name: of_model.limits_deg[name.removesuffix("_r").removesuffix("_l")] for name in found}
    columns = {name: _bridged(recording.time_s, np.clip(values, *limits_deg[name])) for name, values in found.items()}
    parts = known_parts(recording.time_s, columns)
    if not parts:
        reasons = [why_status(recording, joint) for joint in measured if joint not in joints]
        return " ".join([tr("This recording has no angle to export as a pose."), *dict.fromkeys(filter(None, reasons))])
    header = [
        "",
        *([SIMULATED] if is_simulated else []),
        f"Made by gaitwright. {PURPOSE}",
        f"For models with the coordinates of {of_model.words}, ankle dorsiflexion positive.",
        "What is named nowhere in this file was not measured.",
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
            about += _beyond_limits(name, found[name][part.rows], limits_deg[name])
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


def _beyond_limits(name: str, values_deg: FloatArray, limits_deg: tuple[float, float]) -> list[str]:
    """How often and how far a coordinate was beyond each of the model's limits, at which it is kept."""
    lines = []
    for limit_deg, beyond_deg in zip(limits_deg, (limits_deg[0] - values_deg, values_deg - limits_deg[1]), strict=True):
        if count := int(np.count_nonzero(beyond_deg > 0)):
            beyond = f"{count} rows, up to {float(np.nanmax(beyond_deg)):.1f} deg beyond."
            lines.append(f"Kept at the model's limit of {limit_deg:g} deg: {name}, {beyond}")
    return lines


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


def known_parts(time_s: FloatArray, columns: Mapping[str, FloatArray]) -> list[MotionPart]:
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

"""How does OpenSim read the angles? One motion file (.mot) per recording, in degrees, named as a model's coordinates.

The names and signs are those of models whose knee flexion is positive, as Rajagopal et al. 2016, doi
10.1109/TBME.2016.2586891; in gait2392 the knee has the other sign, hips and pelvis the same one. There x points
forward, y up and z to the right: `pelvis_tilt` turns about z and is negative forward, `pelvis_list` about x and is
positive where the left side is the higher one. A model takes a coordinate for a pose, so one whose height or sign is
not known is left out, and a comment says why.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from app.exports.figures import SIMULATED, as_in_csv_deg, status_in_ascii, told_abduction_deg, told_deg
from app.reports.status import WITH_HEIGHT, joint_status
from app.wording import PURPOSE
from core.body import Joint
from core.results import RecordingAnalysis
from core.samples import FloatArray

COORDINATES = {
    Joint.RIGHT_KNEE: "knee_angle_r",
    Joint.LEFT_KNEE: "knee_angle_l",
    Joint.RIGHT_ANKLE: "ankle_angle_r",
    Joint.LEFT_ANKLE: "ankle_angle_l",
    Joint.RIGHT_HIP: "hip_flexion_r",
    Joint.LEFT_HIP: "hip_flexion_l",
}
ADDUCTION = {Joint.RIGHT_HIP: "hip_adduction_r", Joint.LEFT_HIP: "hip_adduction_l"}
OF_HIPS = (
    "Hip flexion and adduction are positive; pelvis_tilt is negative forward, pelvis_list positive with the left side "
    "up. They are told from standing, which is not the zero of a model. hip_rotation and pelvis_rotation are left out: "
    "the one is not readable, of the other the heading is not known."
)


def write_motion(recording: RecordingAnalysis, is_simulated: bool, path: Path) -> None:
    """Write one recording's angles, a row per row of angles.csv; NaN in gaps and once a strap has slipped.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    measured = [joint for joint in COORDINATES if joint in recording.measured]
    joints = [joint for joint in measured if joint_status(recording, joint) in WITH_HEIGHT]
    bending = {COORDINATES[joint]: told_deg(recording, joint) for joint in joints}
    columns = {**bending, **_of_hips_and_pelvis(recording)}
    n = len(recording.time_s)
    header = [
        "Coordinates",
        "version=1",
        f"nRows={n}",
        f"nColumns={1 + len(columns)}",
        "inDegrees=yes",
        "",
        *([SIMULATED] if is_simulated else []),
        f"Made by gaitwright. {PURPOSE}",
        "Knee flexion and ankle dorsiflexion are positive. What is named nowhere in this file was not measured.",
        *([OF_HIPS] if recording.hips else []),
        *(f"{COORDINATES[joint]} is {_said(recording, joint, joint in joints)}" for joint in measured),
        "endheader",
        "\t".join(["time", *columns]),
    ]
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write("\n".join(header) + "\n")
        for k in range(n):
            cells = [f"{column[k]:.5f}" if np.isfinite(column[k]) else "NaN" for column in columns.values()]
            file.write("\t".join([repr(float(recording.time_s[k])), *cells]) + "\n")


def _of_hips_and_pelvis(recording: RecordingAnalysis) -> Mapping[str, FloatArray]:
    """What else may be told of hips and pelvis, by the model's names and signs; nothing without a pelvis sensor."""
    found = {name: told_abduction_deg(recording, joint) for joint, name in ADDUCTION.items() if joint in recording.hips}
    columns = {name: 0.0 - abduction_deg for name, abduction_deg in found.items() if abduction_deg is not None}
    if recording.pelvis is not None and recording.verdicts.pelvis.is_told:
        columns["pelvis_tilt"] = 0.0 - as_in_csv_deg(recording.pelvis.tilt_rad)
        columns["pelvis_list"] = as_in_csv_deg(recording.pelvis.obliquity_rad)
    return columns


def _said(recording: RecordingAnalysis, joint: Joint, is_told: bool) -> str:
    """Whether a coordinate is here, what holds of it and why."""
    said = status_in_ascii(recording, joint)
    return f"here, {said}" if is_told else f"left out, {said}"

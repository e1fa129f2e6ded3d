"""How does OpenSim read the angles? One motion file (.mot) per recording, in degrees, named as a model's coordinates.

The names and signs are those of models whose knee flexion is positive, as Rajagopal et al. 2016, doi
10.1109/TBME.2016.2586891; in gait2392 the knee has the other sign. A model takes a coordinate for a pose, so one whose
height or sign is not known is left out, and a comment says why.
"""

from pathlib import Path

import numpy as np

from app.exports.figures import SIMULATED, status_in_ascii, told_deg
from app.reports.status import WITH_HEIGHT, joint_status
from app.wording import PURPOSE
from core.body import Joint
from core.results import RecordingAnalysis

COORDINATES = {
    Joint.RIGHT_KNEE: "knee_angle_r",
    Joint.LEFT_KNEE: "knee_angle_l",
    Joint.RIGHT_ANKLE: "ankle_angle_r",
    Joint.LEFT_ANKLE: "ankle_angle_l",
}


def write_motion(recording: RecordingAnalysis, is_simulated: bool, path: Path) -> None:
    """Write one recording's angles, a row per row of angles.csv; NaN in gaps and once a strap has slipped.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    measured = [joint for joint in COORDINATES if joint in recording.joints]
    joints = [joint for joint in measured if joint_status(recording, joint) in WITH_HEIGHT]
    columns = [told_deg(recording, joint) for joint in joints]
    n = len(recording.time_s)
    header = [
        "Coordinates",
        "version=1",
        f"nRows={n}",
        f"nColumns={1 + len(joints)}",
        "inDegrees=yes",
        "",
        *([SIMULATED] if is_simulated else []),
        f"Made by gaitwright. {PURPOSE}",
        "Knee flexion and ankle dorsiflexion are positive. What is named nowhere in this file was not measured.",
        *(f"{COORDINATES[joint]} is {_said(recording, joint, joint in joints)}" for joint in measured),
        "endheader",
        "\t".join(["time", *(COORDINATES[joint] for joint in joints)]),
    ]
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write("\n".join(header) + "\n")
        for k in range(n):
            cells = [f"{column[k]:.5f}" if np.isfinite(column[k]) else "NaN" for column in columns]
            file.write("\t".join([repr(float(recording.time_s[k])), *cells]) + "\n")


def _said(recording: RecordingAnalysis, joint: Joint, is_told: bool) -> str:
    """Whether a coordinate is here, what holds of it and why."""
    said = status_in_ascii(recording, joint)
    return f"here, {said}" if is_told else f"left out, {said}"

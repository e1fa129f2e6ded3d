"""References as OpenSim motions and states: `knee_angle_r`, `ankle_angle_l`, `hip_flexion_r` and so on."""

import re
from pathlib import Path

import numpy as np

from core.body import Joint
from core.samples import FloatArray
from devices.files.references.numbers import check_ascending, lines_of, numbers_below
from devices.files.references.trial import ReferenceFile, ReferenceTrial
from devices.files.refusal import FileRefusedError
from devices.files.table_header import COPY_AGAIN

END = "endheader"
IN_DEGREES = re.compile(r"inDegrees\s*=\s*(yes|no)", re.IGNORECASE)
JOINTS = {
    "knee_angle_l": Joint.LEFT_KNEE,
    "knee_angle_r": Joint.RIGHT_KNEE,
    "ankle_angle_l": Joint.LEFT_ANKLE,
    "ankle_angle_r": Joint.RIGHT_ANKLE,
    "hip_flexion_l": Joint.LEFT_HIP,
    "hip_flexion_r": Joint.RIGHT_HIP,
}
FORMAT, SOURCE = "opensim", "angles"
SIMULATED = "SIMULATED"  # the mark of our own exports
QUATERNION = re.compile(r"DataType\s*=\s*Quaternion", re.IGNORECASE)


def is_opensim(_path: Path, head: bytes) -> bool:
    """Whether a header ends as those of OpenSim do."""
    return any(line.strip().lower() == END.encode() for line in head.splitlines())


def read_opensim(path: Path) -> ReferenceFile:
    """Read the hips, knees and ankles among a motion's coordinates; raises FileRefusedError where none."""
    lines = lines_of(path)
    end = next((k for k, line in enumerate(lines) if line.strip().lower() == END), None)
    if end is None or end + 1 >= len(lines):
        raise FileRefusedError(path.name, "there are no columns below the header", COPY_AGAIN)
    header = "\n".join(lines[:end])
    if QUATERNION.search(header):
        raise FileRefusedError(
            path.name,
            "this file contains sensor orientations, not joint angles",
            "Run inverse kinematics and give the resulting .mot file",
        )
    names = lines[end + 1].split()
    found = {JOINTS[short]: k for k, name in enumerate(names) if (short := _coordinate(name)) in JOINTS}
    if not found or names[:1] != ["time"]:
        raise FileRefusedError(
            f"{path.name}, line {end + 2}",
            "column time is missing, or none of {names} is present",
            "Export coordinates of a model whose joints have these names",
            names=", ".join(JOINTS),
        )
    values = numbers_below(lines, end + 2, [0, *found.values()], len(names), path.name)
    time_s = values[:, 0]
    check_ascending(time_s, path.name)
    stated = IN_DEGREES.search(header)
    to_rad = np.deg2rad(1.0) if stated and stated[1].lower() == "yes" else 1.0  # OpenSim's own default is radians
    angles = {joint: (time_s, _rad(values[:, k], to_rad)) for k, joint in enumerate(found, 1)}
    is_simulated = any(line.startswith(SIMULATED) for line in lines[:end])
    return ReferenceFile(FORMAT, SOURCE, (ReferenceTrial(angles=angles),), is_simulated)


def _coordinate(name: str) -> str:
    """The coordinate in a state's path, /jointset/walker_knee_r/knee_angle_r/value."""
    parts = name.strip("/").split("/")
    return parts[-2] if len(parts) > 1 and parts[-1] == "value" else parts[-1]


def _rad(values: FloatArray, to_rad: float) -> FloatArray:
    return values * to_rad

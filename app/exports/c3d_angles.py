"""How does a motion laboratory's program read the angles? One C3D file per recording, angles as points, with events.

Angles stand where such programs look for them: as points of the kind ANGLES, LKneeAngles and so on, of which the first
component bends; the two others were not measured and are 0. Of a hip the second one is adduction, where that is told.
A C3D has one rate and no stamps, so each frame holds the row of angles.csv nearest to it, at most half a frame away; a
frame without one, or in a gap, has residual -1.

A joint that is withheld, or whose sign is not known, is left out. One without a zero is named as its shape, such as
LKneeAngles_SHAPE, and its mean is taken away, so that nothing reads a height from it. PROCESSING:STATUS says why.
"""

from pathlib import Path
from textwrap import shorten

import ezc3d
import numpy as np

from app.exports.figures import SIMULATED, status_in_ascii, told_abduction_deg, told_deg
from app.reports.gait_csv import events_of
from app.reports.status import NO_ZERO, WITH_HEIGHT, joint_status
from app.wording import PURPOSE
from core.body import Joint, JointKind
from core.results import RecordingAnalysis
from core.samples import FloatArray, IntArray
from core.tracks import nominal_step_s
from devices.files.refusal import FileRefusedError

POINTS = {
    Joint.LEFT_KNEE: "LKneeAngles",
    Joint.RIGHT_KNEE: "RKneeAngles",
    Joint.LEFT_ANKLE: "LAnkleAngles",
    Joint.RIGHT_ANKLE: "RAnkleAngles",
    Joint.LEFT_HIP: "LHipAngles",
    Joint.RIGHT_HIP: "RHipAngles",
}
BENDS = {JointKind.HIP: "hip flexion", JointKind.KNEE: "knee flexion", JointKind.ANKLE: "ankle dorsiflexion"}
# what other programs call the two that bound stance; the rest have no name of their own there
EVENTS = {
    "initial_contact": "Foot Strike",
    "toe_off": "Foot Off",
    "full_contact": "Full Contact",
    "heel_rise": "Heel Rise",
}
SHAPE = "_SHAPE"  # behind the name of an angle whose mean was taken away
TOLD = (*WITH_HEIGHT, NO_ZERO)
LONGEST_TEXT = 250  # the format counts a text's letters in 8 bits
MOST_FRAMES = 65535  # the format counts them in 16 bits
MOST_ENTRIES = 255  # and the entries of a list in 8, so a longer one goes on in LABELS2 and so on
HALF_A_FRAME = 0.5 + 1e-6


def write_c3d(recording: RecordingAnalysis, is_simulated: bool, path: Path) -> None:
    """Write one recording's angles and events; time starts at its first row.

    Raises
    ------
    FileRefusedError
        It is longer than a C3D can hold.
    OSError
        The file cannot be written.
    """
    status = {joint: joint_status(recording, joint) for joint in POINTS if joint in recording.measured}
    joints = [joint for joint, said in status.items() if said in TOLD]
    found = {joint: told_abduction_deg(recording, joint) for joint in joints if joint.is_hip}
    abductions = {joint: abduction_deg for joint, abduction_deg in found.items() if abduction_deg is not None}
    rows, step_s = _rows_of_frames(recording)
    if len(rows) > MOST_FRAMES:
        raise FileRefusedError(
            recording.name,
            "{count} frames are more than a C3D can hold ({most})",
            "Take the CSV or the OpenSim file of this recording",
            count=len(rows),
            most=MOST_FRAMES,
        )
    values = np.zeros((4, len(joints), len(rows)))
    values[3] = 1.0
    for k, joint in enumerate(joints):
        angle_deg = told_deg(recording, joint)
        if status[joint] == NO_ZERO and np.isfinite(angle_deg).any():
            angle_deg = angle_deg - np.nanmean(angle_deg)
        values[0, k] = np.append(angle_deg, np.nan)[rows]  # a frame without a row is the last, which is missing
        if joint in abductions:
            values[1, k] = np.append(-abductions[joint], np.nan)[rows]
    is_missing = ~np.isfinite(values[0])
    values[:3, is_missing] = np.nan
    c3d = ezc3d.c3d()
    point = c3d["parameters"]["POINT"]
    point["RATE"]["value"] = [1.0 / step_s]
    labels = [POINTS[joint] + (SHAPE if status[joint] == NO_ZERO else "") for joint in joints]
    point["LABELS"]["value"] = labels
    point["DESCRIPTIONS"]["value"] = [
        _description(joint, status[joint], has_adduction=joint in abductions) for joint in joints
    ]
    point["UNITS"]["value"] = ["deg"] * len(joints)
    c3d.add_parameter("POINT", "TYPE_GROUPS", ["ANGLES"])
    c3d.add_parameter("POINT", "ANGLES", labels)
    c3d.add_parameter("POINT", "ANGLE_UNITS", ["deg"])
    c3d.add_parameter("MANUFACTURER", "SOFTWARE", ["gaitwright"])
    said = [f"{joint}: {status_in_ascii(recording, joint)}" for joint in status]
    c3d.add_parameter("PROCESSING", "STATUS", [shorten(text, LONGEST_TEXT, placeholder=" ...") for text in said])
    c3d.add_parameter("PROCESSING", "USE", [PURPOSE])
    c3d.add_parameter("SUBJECTS", "IS_SIMULATED", [int(is_simulated)])
    if is_simulated:
        c3d.add_parameter("SUBJECTS", "NOTE", [SIMULATED])
    c3d["data"]["points"] = values
    c3d["data"]["meta_points"]["residuals"] = np.where(is_missing, -1.0, 0.0)[None]
    _add_events(c3d, recording)
    path.touch()  # ezc3d reports an unwritable file in its own words
    c3d.write(str(path))


def _rows_of_frames(recording: RecordingAnalysis) -> tuple[IntArray, float]:
    """The row of angles.csv nearest to each frame (n,), -1 where there is none; and the time from frame to frame."""
    time_s = recording.time_s
    step_s = nominal_step_s(time_s) if len(time_s) > 1 else 0.01
    if not len(time_s):
        return np.array([-1]), step_s  # ezc3d writes no file without a frame
    frame_s: FloatArray = time_s[0] + step_s * np.arange(round((time_s[-1] - time_s[0]) / step_s) + 1)
    after = np.clip(np.searchsorted(time_s, frame_s), 1, max(len(time_s) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(time_s) - 1)
    is_before = np.abs(time_s[before] - frame_s) <= np.abs(time_s[after] - frame_s)
    nearest = np.where(is_before, before, after)
    is_near = np.abs(time_s[nearest] - frame_s) <= HALF_A_FRAME * step_s
    return np.where(is_near, nearest, -1), step_s


def _description(joint: Joint, status: str, *, has_adduction: bool) -> str:
    shape = " less its mean, for there is no zero" if status == NO_ZERO else ""
    rest = "y: adduction; z not measured" if has_adduction else "y, z not measured"
    return f"x: {BENDS[joint.kind]}{shape}{', from standing' if joint.is_hip else ''}; {rest}"


def _add_events(c3d: ezc3d.c3d, recording: RecordingAnalysis) -> None:
    start_s = float(recording.time_s[0]) if len(recording.time_s) else 0.0
    events = events_of(recording)
    c3d.add_parameter("EVENT", "USED", [len(events)])
    for number, first in enumerate(range(0, len(events), MOST_ENTRIES), start=1):
        some = events[first : first + MOST_ENTRIES]
        end = str(number) if number > 1 else ""
        c3d.add_parameter("EVENT", f"CONTEXTS{end}", [side.capitalize() for _, side, _ in some])
        c3d.add_parameter("EVENT", f"LABELS{end}", [EVENTS[event] for _, _, event in some])
        minutes_seconds = np.array([divmod(time_s - start_s, 60.0) for time_s, _, _ in some]).T
        c3d.add_parameter("EVENT", f"TIMES{end}", minutes_seconds)

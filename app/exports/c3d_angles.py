"""Angles and events for programs of motion laboratories: a C3D file per recording, angles as points.

Angles stand where such programs look for them: as points of the kind ANGLES, LKneeAngles and so on, of which the first
component bends; the two others were not measured and are 0. Of a hip the second one is adduction, where that is
reported. A C3D has one rate and no stamps, so each frame holds the row of angles.csv nearest to it, at most half a
frame away; a frame without one, or in a gap, has residual -1. The format counts frames in 16 bits; TRIAL and
POINT:LONG_FRAMES hold the count for programs that take them as signed. Beyond, programs differ (the one used here to
write reads 65 535 frames back), so a longer recording goes on in another file.

Many programs read only the first 255 events, so foot strikes and foot offs are before all others, each in order of
time; the rest of a long list is in LABELS2 and so on.

A joint that is not reported, or whose sign is not known, is left out. One without a zero is named as its shape, such as
LKneeAngles_SHAPE, and its mean is taken away, so that nothing reads a height from it. PROCESSING:STATUS states why.
"""

from collections.abc import Sequence
from pathlib import Path
from textwrap import shorten
from typing import NamedTuple

import ezc3d
import numpy as np

from app.exports.figures import SIMULATED, in_ascii, reported_abduction_deg, reported_deg, status_in_ascii
from app.exports.parts import part_paths
from app.summary.events import events_of
from app.summary.status import why_status
from app.wording.translation import PURPOSE, tr
from core.body import Joint, JointKind, Side
from core.results import RecordingAnalysis
from core.samples import FloatArray, IntArray
from core.signal.tracks import nominal_step_s
from core.verdicts.status import NO_ZERO, WITH_HEIGHT, joint_status

POINTS = {
    Joint.LEFT_KNEE: "LKneeAngles",
    Joint.RIGHT_KNEE: "RKneeAngles",
    Joint.LEFT_ANKLE: "LAnkleAngles",
    Joint.RIGHT_ANKLE: "RAnkleAngles",
    Joint.LEFT_HIP: "LHipAngles",
    Joint.RIGHT_HIP: "RHipAngles",
}
BENDS = {JointKind.HIP: "hip flexion", JointKind.KNEE: "knee flexion", JointKind.ANKLE: "ankle dorsiflexion"}


class Event(NamedTuple):
    """What an event is called in a C3D. The two that bound stance have names and icons that all programs know."""

    label: str
    description: str
    icon: int = 0


EVENTS = {
    "initial_contact": Event("Foot Strike", "The instant the heel strikes the ground", 1),
    "toe_off": Event("Foot Off", "The instant the toe leaves the ground", 2),
    "full_contact": Event("Full Contact", "The instant the whole foot is on the ground"),
    "heel_rise": Event("Heel Rise", "The instant the heel leaves the ground"),
}
NO_CODE = "Subject"
SHAPE = "_SHAPE"  # behind the name of an angle whose mean was taken away
REPORTED = (*WITH_HEIGHT, NO_ZERO)
LONGEST_TEXT = 250  # the format counts a text's letters in 8 bits
MOST_FRAMES = 65535  # the format counts them in 16 bits
MOST_ENTRIES = 255  # and the entries of a list in 8, so a longer one goes on in LABELS2 and so on
HALF_A_FRAME = 0.5 + 1e-6


def write_c3d(recording: RecordingAnalysis, is_simulated: bool, path: Path, code: str = "") -> str:
    """Write angles and events of a patient of this code, time from each file's first row.
    Give why there is no file (translated), or "".
    """
    subject = shorten(in_ascii(code), LONGEST_TEXT, placeholder=" ...") or NO_CODE
    status = {joint: joint_status(recording, joint) for joint in POINTS if joint in recording.measured}
    joints = [joint for joint, stated in status.items() if stated in REPORTED]
    if not joints and not events_of(recording):
        reasons = [why_status(recording, joint) for joint in status]
        return " ".join(
            [tr("This recording has neither angles nor events to export."), *dict.fromkeys(filter(None, reasons))]
        )
    found = {joint: reported_abduction_deg(recording, joint) for joint in joints if joint.is_hip}
    abductions = {joint: abduction_deg for joint, abduction_deg in found.items() if abduction_deg is not None}
    rows, step_s = _rows_of_frames(recording)
    values = np.zeros((4, len(joints), len(rows)))
    values[3] = 1.0
    for k, joint in enumerate(joints):
        angle_deg = reported_deg(recording, joint)
        if status[joint] == NO_ZERO and np.isfinite(angle_deg).any():
            angle_deg = angle_deg - np.nanmean(angle_deg)
        values[0, k] = np.append(angle_deg, np.nan)[rows]  # a frame without a row is the last, which is missing
        if joint in abductions:
            values[1, k] = np.append(-abductions[joint], np.nan)[rows]
    values[:3, ~np.isfinite(values[0])] = np.nan
    labels = [POINTS[joint] + (SHAPE if status[joint] == NO_ZERO else "") for joint in joints]
    descriptions = [_description(joint, status[joint], has_adduction=joint in abductions) for joint in joints]
    firsts, events = range(0, len(rows), MOST_FRAMES), events_of(recording)
    start_s = float(recording.time_s[0]) if len(recording.time_s) else 0.0
    part_of = [min(max(int((one[0] - start_s) / (step_s * MOST_FRAMES)), 0), len(firsts) - 1) for one in events]
    for first, place in zip(firsts, part_paths(path, len(firsts)), strict=True):
        c3d = _angles_in_c3d(values[:, :, first : first + MOST_FRAMES], step_s, labels, descriptions)
        stated = [f"{joint}: {status_in_ascii(recording, joint)}" for joint in status]
        c3d.add_parameter("PROCESSING", "STATUS", [shorten(text, LONGEST_TEXT, placeholder=" ...") for text in stated])
        c3d.add_parameter("PROCESSING", "USE", [PURPOSE])
        _add_subject(c3d, subject)
        _add_integers(c3d, "SUBJECTS", "IS_SIMULATED", [int(is_simulated)])
        if is_simulated:
            c3d.add_parameter("SUBJECTS", "NOTE", [SIMULATED])
        number = first // MOST_FRAMES
        if len(firsts) > 1:
            c3d.add_parameter("PROCESSING", "PART", [1.0 + number, float(len(firsts))])
            c3d.add_parameter("PROCESSING", "PART_STARTS_S", [step_s * first])
        here = [one for one, part in zip(events, part_of, strict=True) if part == number]
        _add_events(c3d, here, start_s + step_s * first, subject)
        place.touch()  # ezc3d reports an unwritable file in its own words
        c3d.write(str(place))
    return ""


def _angles_in_c3d(values: FloatArray, step_s: float, labels: Sequence[str], descriptions: Sequence[str]) -> ezc3d.c3d:
    """A C3D with the angles (4, joints, frames) as points."""
    c3d = ezc3d.c3d()
    point = c3d["parameters"]["POINT"]
    point["RATE"]["value"] = [1.0 / step_s]
    point["LABELS"]["value"] = list(labels)
    point["DESCRIPTIONS"]["value"] = list(descriptions)
    point["UNITS"]["value"] = ["deg"] * len(labels)
    c3d.add_parameter("POINT", "TYPE_GROUPS", ["ANGLES"])
    c3d.add_parameter("POINT", "ANGLES", list(labels))
    c3d.add_parameter("POINT", "ANGLE_UNITS", ["deg"])
    c3d.add_parameter("MANUFACTURER", "SOFTWARE", ["gaitwright"])
    frames = values.shape[2]
    c3d.add_parameter("POINT", "LONG_FRAMES", [float(frames)])
    _add_integers(c3d, "TRIAL", "ACTUAL_START_FIELD", [1, 0])
    _add_integers(c3d, "TRIAL", "ACTUAL_END_FIELD", [frames, 0])  # two words of 16 bits, the low one first
    c3d["data"]["points"] = values
    c3d["data"]["meta_points"]["residuals"] = np.where(np.isfinite(values[0]), 0.0, -1.0)[None]
    return c3d


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


def _add_subject(c3d: ezc3d.c3d, subject: str) -> None:
    """Who the file is of, and what the sides of its events are."""
    for name, number in (("IS_STATIC", 0), ("USES_PREFIXES", 0), ("USED", 1)):
        _add_integers(c3d, "SUBJECTS", name, [number])
    c3d.add_parameter("SUBJECTS", "NAMES", [subject])
    sides = [side.capitalize() for side in Side]
    _add_integers(c3d, "EVENT_CONTEXT", "USED", [len(sides)])
    _add_integers(c3d, "EVENT_CONTEXT", "ICON_IDS", [0] * len(sides))
    c3d.add_parameter("EVENT_CONTEXT", "LABELS", sides)
    c3d.add_parameter("EVENT_CONTEXT", "DESCRIPTIONS", [f"{side} side" for side in sides])
    c3d.add_parameter("EVENT_CONTEXT", "COLOURS", np.array([[1.0, 0.0], [0.0, 0.5], [0.0, 0.0]]))  # red and green


def _add_events(c3d: ezc3d.c3d, events: Sequence[tuple[float, Side, str]], from_s: float, subject: str) -> None:
    """Add the events of a file that begins at `from_s` on their clock; strikes and offs first."""
    events = sorted(events, key=lambda one: (EVENTS[one[2]].icon == 0, one[0]))
    _add_integers(c3d, "EVENT", "USED", [len(events)])
    for number, first in enumerate(range(0, len(events), MOST_ENTRIES), start=1):
        some = events[first : first + MOST_ENTRIES]
        known, end = [EVENTS[event] for _, _, event in some], str(number) if number > 1 else ""
        c3d.add_parameter("EVENT", f"CONTEXTS{end}", [side.capitalize() for _, side, _ in some])
        c3d.add_parameter("EVENT", f"LABELS{end}", [one.label for one in known])
        c3d.add_parameter("EVENT", f"DESCRIPTIONS{end}", [one.description for one in known])
        c3d.add_parameter("EVENT", f"SUBJECTS{end}", [subject] * len(some))
        minutes_seconds = np.array([divmod(time_s - from_s, 60.0) for time_s, _, _ in some]).T
        c3d.add_parameter("EVENT", f"TIMES{end}", minutes_seconds)
        _add_integers(c3d, "EVENT", f"ICON_IDS{end}", [one.icon for one in known])
        _add_integers(c3d, "EVENT", f"GENERIC_FLAGS{end}", [0] * len(known))  # not from force plates


def _add_integers(c3d: ezc3d.c3d, group: str, name: str, values: Sequence[int]) -> None:
    """Add whole numbers as such: the library makes numbers with a fraction of a list of them."""
    c3d.add_parameter(group, name, list(values))
    c3d["parameters"][group][name]["type"] = ezc3d.ezc3d.INT

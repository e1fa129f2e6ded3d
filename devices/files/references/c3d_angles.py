"""References as C3D: angles as points (LKneeAngles ...), else markers of hip, knee, ankle, heel and toe; and events."""

from pathlib import Path

import numpy as np

from core.body import Side
from core.samples import FloatArray
from devices.files.references.c3d_files import BLOCK, KEY, C3dFile, read_c3d_file
from devices.files.references.markers import angles_of_markers, landmark_of
from devices.files.references.trial import ReferenceFile, ReferenceTrial, joint_of_name
from devices.files.refusal import FileRefusedError
from devices.files.table_header import COPY_AGAIN

EVENTS = {  # what programs call those that we know; "General" and forces' own events have no side
    "foot strike": "initial_contact",
    "foot off": "toe_off",
    "full contact": "full_contact",
    "heel rise": "heel_rise",
}
FORMAT, ANGLES, MARKERS = "c3d", "angles", "markers"


def is_c3d(_path: Path, head: bytes) -> bool:
    """Whether the first block is the header of a C3D."""
    return len(head) >= BLOCK and head[1] == KEY and 1 <= head[0] <= 16


def read_c3d(path: Path) -> ReferenceFile:
    """Read joint angles, else make them of markers; raises FileRefusedError with neither."""
    c3d = read_c3d_file(path)
    rate_hz = c3d.number("POINT", "RATE")
    used = c3d.number("POINT", "USED")
    labels = c3d.texts("POINT", "LABELS")[: int(used) if 0 <= used <= c3d.points.shape[1] else None]
    if not 0 < rate_hz < np.inf or c3d.points.shape[1] < len(labels):
        raise FileRefusedError(path.name, "this C3D file has no rate, or fewer points than names", COPY_AGAIN)
    time_s = (c3d.first_frame + np.arange(len(c3d.points))) / rate_hz
    values = {label: c3d.points[:, k] for k, label in enumerate(labels)}
    angles = {
        j: (time_s, np.deg2rad(v[:, 0])) for label, v in values.items() if (j := joint_of_name(label)) is not None
    }
    source = ANGLES
    if not angles:
        marked = {at: v for label, v in values.items() if (at := landmark_of(label)) is not None}
        angles = {joint: (time_s, angle) for joint, angle in angles_of_markers(marked).items()}
        source = MARKERS
    if not angles:
        raise FileRefusedError(
            path.name,
            "the file contains neither hip, knee or ankle angles nor the markers to compute them",
            "Include LKneeAngles and so on in the export, or name the markers LHIP, LKNE, LANK, LHEE, LTOE and R...",
        )
    trial = ReferenceTrial(angles=angles, events=_events(c3d))
    return ReferenceFile(FORMAT, source, (trial,), _is_simulated(c3d))


def _is_simulated(c3d: C3dFile) -> bool:
    """Whether it is one of our own exports of a simulated patient."""
    stated = c3d.parameters.get("SUBJECTS", {}).get("IS_SIMULATED")
    return isinstance(stated, np.ndarray) and bool(np.any(stated == 1))


def _events(c3d: C3dFile) -> dict[Side, dict[str, FloatArray]]:
    """Instants by side and event. Times are stored as minutes and seconds."""
    group = c3d.parameters.get("EVENT", {})
    found: dict[Side, dict[str, list[float]]] = {}
    for end in ("", *map(str, range(2, 20))):
        sides, labels, times = (group.get(f"{name}{end}") for name in ("CONTEXTS", "LABELS", "TIMES"))
        if not isinstance(sides, list) or not isinstance(labels, list) or not isinstance(times, np.ndarray):
            continue
        if times.ndim != 2 or len(times) != 2:
            continue
        for side, label, (minutes, seconds) in zip(sides, labels, times.T, strict=False):
            event, name = EVENTS.get(label.strip().lower()), side.strip().lower()
            if event is not None and name in set(Side):
                found.setdefault(Side(name), {}).setdefault(event, []).append(60.0 * minutes + seconds)
    return {side: {event: np.sort(np.array(t)) for event, t in by_event.items()} for side, by_event in found.items()}

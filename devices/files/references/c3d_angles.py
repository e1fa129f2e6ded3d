"""References as C3D: angles as points (LKneeAngles ...), else markers of hip, knee, ankle, heel and toe; and events."""

import struct
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from core.body import Side
from core.samples import FloatArray
from devices.files.references.markers import angles_of_markers, landmark_of
from devices.files.references.trial import ReferenceFile, ReferenceTrial, joint_of_name
from devices.files.refusal import FileRefusedError
from devices.files.tables import COPY_AGAIN

BLOCK = 512  # bytes
INTEL = 84
C3D_KEY = 0x50  # the second byte of every C3D
EVENTS = {  # what programs call those that we know; "General" and forces' own events have no side
    "foot strike": "initial_contact",
    "foot off": "toe_off",
    "full contact": "full_contact",
    "heel rise": "heel_rise",
}
FORMAT, ANGLES, MARKERS = "c3d", "angles", "markers"


def is_c3d(_path: Path, head: bytes) -> bool:
    """Whether the first block is the header of a C3D."""
    return len(head) >= 512 and head[1] == C3D_KEY and 1 <= head[0] <= 16


def read_c3d(path: Path) -> ReferenceFile:
    """Read joint angles, else make them of markers; raises FileRefusedError with neither or no library."""
    if find_spec("ezc3d") is None:
        raise FileRefusedError(
            path.name,
            "reading C3D needs a component that is not installed",
            "Install gaitwright[imports], or give a CSV file",
        )
    _refuse_cut(path)
    import ezc3d  # an extra

    try:
        c3d = ezc3d.c3d(str(path))
        rate_hz = float(c3d["parameters"]["POINT"]["RATE"]["value"][0])
        labels = _labels(c3d["parameters"]["POINT"])
        points = np.asarray(c3d["data"]["points"], dtype=np.float64)
        residuals = np.asarray(c3d["data"]["meta_points"]["residuals"], dtype=np.float64)[0]
    except MemoryError:
        raise
    except Exception as error:  # the library raises whatever its C++ threw
        raise FileRefusedError(path.name, "this C3D file cannot be read ({why})", COPY_AGAIN, why=error) from error
    if not rate_hz > 0 or points.shape[1] < len(labels):
        raise FileRefusedError(path.name, "this C3D file has no rate, or fewer points than names", COPY_AGAIN)
    first = int(c3d["header"]["points"]["first_frame"])
    time_s = (first + np.arange(points.shape[2])) / rate_hz
    values = {label: _seen(points[:3, k], residuals[k]) for k, label in enumerate(labels)}
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
    trial = ReferenceTrial(angles=angles, events=_events(c3d["parameters"]))
    return ReferenceFile(FORMAT, source, (trial,), _is_simulated(c3d["parameters"]))


def _is_simulated(parameters: Mapping[str, Any]) -> bool:
    """Whether it is one of our own exports of a simulated patient."""
    stated = parameters.get("SUBJECTS", {}).get("IS_SIMULATED", {}).get("value", ())
    return len(stated) > 0 and bool(stated[0] == 1)


def _refuse_cut(path: Path) -> None:
    """Refuse a file shorter than its own header requires: the library reads beyond its end for ever."""
    # of the two other processors that the format knows, whose numbers stand otherwise, the deadline alone is the guard
    size = path.stat().st_size
    with path.open("rb") as file:
        header = file.read(BLOCK)
        file.seek(BLOCK * (header[0] - 1))
        parameters = file.read(4)
    cut = FileRefusedError(
        path.name, "this C3D file ends before the end of its data; it may have been cut off", COPY_AGAIN
    )
    if len(parameters) < 4 or size < BLOCK * (header[0] - 1 + parameters[2]):
        raise cut
    if parameters[3] != INTEL:
        return
    points, analogs, first, last, _, data_start = struct.unpack("<2x5H4xH", header[:18])
    (scale,) = struct.unpack("<f", header[12:16])
    frame = (4 * points + analogs) * (4 if scale < 0 else 2)  # integers where the scale is positive
    if size < BLOCK * (data_start - 1) + max(0, last - first + 1) * frame:
        raise cut


def _labels(group: Mapping[str, Any]) -> list[str]:
    """Names of the points; a list over 255 goes on in LABELS2 and so on."""
    names = list(group["LABELS"]["value"])
    number = 2
    while f"LABELS{number}" in group:
        names += group[f"LABELS{number}"]["value"]
        number += 1
    return [str(name).strip() for name in names][: int(group["USED"]["value"][0])]


def _seen(point: FloatArray, residual: FloatArray) -> FloatArray:
    """(n, 3) of a point (3, n); NaN where it was not seen, which some programs mark by three zeros alone."""
    is_seen = (residual >= 0) & np.any(point != 0, axis=0)
    return np.where(is_seen, point, np.nan).T


def _events(parameters: Mapping[str, Any]) -> dict[Side, dict[str, FloatArray]]:
    """Instants by side and event. Times are stored as minutes and seconds."""
    group = parameters.get("EVENT", {})
    found: dict[Side, dict[str, list[float]]] = {}
    for end in ("", *map(str, range(2, 20))):
        if not all(f"{name}{end}" in group for name in ("CONTEXTS", "LABELS", "TIMES")):
            continue
        times = np.asarray(group[f"TIMES{end}"]["value"], dtype=np.float64)
        sides, labels = group[f"CONTEXTS{end}"]["value"], group[f"LABELS{end}"]["value"]
        if times.ndim != 2 or len(times) != 2:
            continue
        for side, label, (minutes, seconds) in zip(sides, labels, times.T, strict=False):
            event, name = EVENTS.get(str(label).strip().lower()), str(side).strip().lower()
            if event is not None and name in set(Side):
                found.setdefault(Side(name), {}).setdefault(event, []).append(60.0 * minutes + seconds)
    return {side: {event: np.sort(np.array(t)) for event, t in by_event.items()} for side, by_event in found.items()}

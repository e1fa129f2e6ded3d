"""References as Visual3D's text: five lines of header (file, signal, type, folder, component), then a line per frame.

One file holds the signals of several trials beside one another, so each name of the first line is a trial. Joint angles
bend about their first component. The frames' instants come with the signal TIME, which has to be exported with them.
"""

from pathlib import Path, PureWindowsPath

import numpy as np

from core.body import Joint
from core.samples import FloatArray
from devices.files.references.numbers import check_ascending, lines_of, numbers_below
from devices.files.references.trial import ReferenceFile, ReferenceTrial, joint_of_name
from devices.files.refusal import FileRefusedError
from devices.files.table_header import COPY_AGAIN

HEADER_LINES = 5
ITEM = "ITEM"
BENDS = ("X", "0")
TIME = "TIME"
FORMAT, SOURCE = "visual3d", "angles"


def is_visual3d(_path: Path, head: bytes) -> bool:
    """Whether the fifth line begins with ITEM, or names components under as many signals."""
    lines = head.decode("utf-8-sig", errors="replace").splitlines()[:HEADER_LINES]
    if len(lines) < HEADER_LINES or "\t" not in lines[-1]:
        return False
    cells = [line.rstrip("\r").split("\t") for line in lines]
    components = {cell.strip().upper() for cell in cells[-1][1:] if cell.strip()}
    return cells[-1][0].strip().upper() in (ITEM, "") and bool(components) and components <= {"X", "Y", "Z", "0"}


def read_visual3d(path: Path) -> ReferenceFile:
    """Read the hips, knees and ankles of every trial; raises FileRefusedError without angles or TIME."""
    lines = lines_of(path)
    header = [[cell.strip() for cell in line.split("\t")] for line in lines[:HEADER_LINES]]
    count = max(map(len, header))
    files, signals, _, _, components = ([*row, *[""] * (count - len(row))] for row in header)
    while count > 1 and not (signals[count - 1] or components[count - 1]):
        count -= 1
    required: dict[str, dict[Joint | str, int]] = {}
    for k in range(1, count):
        what = TIME if signals[k].upper() == TIME else joint_of_name(signals[k])
        if what is not None and (components[k].upper() in BENDS or what == TIME):
            required.setdefault(files[k], {}).setdefault(what, k)
    trials = {name: columns for name, columns in required.items() if any(what != TIME for what in columns)}
    if not trials:
        raise FileRefusedError(
            f"{path.name}, line 2",
            "no signal is a hip, knee or ankle angle",
            "Export joint angles with such names, as in LKneeAngle, with all components",
        )
    shared = next((columns[TIME] for columns in required.values() if TIME in columns), None)
    if shared is None:
        raise FileRefusedError(
            f"{path.name}, line 2", "signal TIME is missing, so the frames have no times", "Include TIME in the export"
        )
    columns = sorted({k for found in trials.values() for k in found.values()} | {shared})
    values = dict(zip(columns, numbers_below(lines, HEADER_LINES, columns, count, path.name, "\t").T, strict=True))
    read = [_trial(name, found, values, shared, path.name) for name, found in trials.items()]
    if not any(trial.angles for trial in read):
        raise FileRefusedError(path.name, "there are no rows below the header", COPY_AGAIN)
    return ReferenceFile(FORMAT, SOURCE, tuple(read))


def _trial(
    file: str, found: dict[Joint | str, int], values: dict[int, FloatArray], shared: int, where: str
) -> ReferenceTrial:
    """One trial; shorter ones end with empty cells."""
    time_s = values[found.get(TIME, shared)]
    is_there = np.isfinite(time_s)
    check_ascending(time_s[is_there], where)
    angles = {
        what: (time_s[is_there], np.deg2rad(values[k][is_there]))
        for what, k in found.items()
        if isinstance(what, Joint)
    }
    return ReferenceTrial(PureWindowsPath(file).stem, angles)

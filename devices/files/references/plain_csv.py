"""References as CSV: angles by `time_s`, events as in events.csv, strides as in strides.csv.

`time_s, left_knee, right_knee, left_ankle, right_ankle, left_hip, right_hip` in degrees, any of the joints, with or
without `_deg`, so that an angles.csv is a reference too. A column `recording` divides a file into trials. Other columns
are passed over.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.body import Joint, Side
from core.samples import FloatArray
from devices.files.references.numbers import check_ascending
from devices.files.references.trial import EVENTS, ReferenceFile, ReferenceTrial
from devices.files.refusal import FileRefusedError, quoted
from devices.files.table_header import CORRECT_IT, SEPARATOR_LINE
from devices.files.tables import Table, header_of, read_csv

DELIMITERS = ",;\t"
COMMENT = "#"
TIME, RECORDING, SIDE, EVENT = "time_s", "recording", "side", "event"
ENDS_AND_LENGTH = ("start_s", "end_s", "stride_length_m")
FORMAT, SOURCE = "csv", "angles"


def is_csv(_path: Path, head: bytes) -> bool:
    """Whether the first line that is no comment names columns of ours."""
    for line in head.decode("utf-8-sig", errors="replace").splitlines():
        if line.strip() and not line.startswith(COMMENT) and not SEPARATOR_LINE.fullmatch(line.encode()):
            names = {name.strip().strip('"') for d in DELIMITERS for name in line.split(d)}
            return bool({TIME, *ENDS_AND_LENGTH} & names)
    return False


def read_plain_csv(path: Path) -> ReferenceFile:
    """Read angles, events or strides by their columns; raises FileRefusedError where it is none of them."""
    _, names = header_of(path, path.name, comment=COMMENT, delimiters=DELIMITERS)
    joints = {joint: name for joint in Joint for name in (str(joint), f"{joint}_deg") if name in names}
    if TIME in names and joints:
        return ReferenceFile(FORMAT, SOURCE, _angles(path, joints))
    if {TIME, SIDE, EVENT} <= set(names):
        return ReferenceFile(FORMAT, "events", _events(path))
    if {SIDE, *ENDS_AND_LENGTH} <= set(names):
        return ReferenceFile(FORMAT, "strides", _strides(path))
    raise FileRefusedError(
        path.name,
        "the file's columns are neither angles nor events nor strides ({names})",
        "Name the columns time_s and left_knee, left_ankle, left_hip, right_knee, right_ankle, "
        "right_hip in degrees; time_s, side, event; or side, start_s, end_s, stride_length_m",
        names=quoted(", ".join(names), 200),
    )


def _angles(path: Path, joints: dict[Joint, str]) -> tuple[ReferenceTrial, ...]:
    table = _table(path, [TIME, *joints.values()])
    values = np.deg2rad(table.matrix(list(joints.values())))
    time_s = table.matrix([TIME])[:, 0]
    trials = []
    for name, rows in _trials(table):
        where = f"{path.name}, {name}" if name else path.name
        check_ascending(time_s[rows], where)
        angles = {joint: (time_s[rows], values[rows, k]) for k, joint in enumerate(joints)}
        trials.append(ReferenceTrial(name, angles))
    return tuple(trials)


def _events(path: Path) -> tuple[ReferenceTrial, ...]:
    table = _table(path, [TIME])
    time_s = table.matrix([TIME])[:, 0]
    sides, events = _words(table, SIDE, set(Side), path.name), _words(table, EVENT, set(EVENTS), path.name)
    trials = []
    for name, rows in _trials(table):
        found: dict[Side, dict[str, FloatArray]] = {}
        for row in rows[np.argsort(time_s[rows])]:
            if np.isfinite(time_s[row]):
                by_event = found.setdefault(Side(sides[row]), {})
                by_event[str(events[row])] = np.append(by_event.get(str(events[row]), []), time_s[row])
        trials.append(ReferenceTrial(name, events=found))
    return tuple(trials)


def _strides(path: Path) -> tuple[ReferenceTrial, ...]:
    table = _table(path, ENDS_AND_LENGTH)
    values = table.matrix(ENDS_AND_LENGTH)
    sides = _words(table, SIDE, set(Side), path.name)
    trials = []
    for name, rows in _trials(table):
        known = [row for row in rows if np.isfinite(values[row]).all()]
        of_side = {side: [row for row in known if sides[row] == side] for side in Side}
        trials.append(ReferenceTrial(name, strides={side: values[found] for side, found in of_side.items() if found}))
    return tuple(trials)


def _table(path: Path, numeric: list[str] | tuple[str, ...]) -> Table:
    return read_csv(path, path.name, numeric, comment=COMMENT, delimiters=DELIMITERS)


def _trials(table: Table) -> list[tuple[str, NDArray[np.intp]]]:
    """Names of the trials, in their order, and their rows; one without a name where no column names them."""
    if RECORDING not in table.texts:
        return [("", np.arange(table.rows))]
    names = np.array([str(name).strip() for name in table.texts[RECORDING]])
    return [(name, np.nonzero(names == name)[0]) for name in dict.fromkeys(names.tolist())]


def _words(table: Table, column: str, known: set[str] | set[Side], where: str) -> NDArray[np.str_]:
    words = np.array([str(word).strip() for word in table.texts[column]])
    for row, word in enumerate(words.tolist()):
        if word not in known:
            raise FileRefusedError(
                f"{where}, {table.place(row)}",
                "{word} is not a valid {column}",
                CORRECT_IT,
                word=quoted(word),
                column=column,
            )
    return words

"""Orientations of OpenSim (OpenSense), `.sto`: one table with the quaternions of all sensors of a trial.

Lines of a head up to `endheader`, a line of names, then a time in seconds and for each sensor four numbers with commas
between, scalar first: earth from sensor, earth z up, as OpenSim's own readers of sensors write them. Rates are derived
from them. There is no acceleration: gravity takes its place, which shows the shape of angles and no landing of a foot.

A line of the head that begins with SIMULATED, as `gaitwright export` writes it, states that nobody was measured.
Held against tables that OpenSim itself wrote and read, and against our own exports.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.findings import Finding, Severity
from core.samples import FloatArray, ImuBlock, RateKind, SensorInfo
from devices.files.clock_repair import FileClock, whole_clock
from devices.files.orientation_rates import Numbers, derive_rates, with_gravity
from devices.files.refusal import FileRefusedError, quoted
from devices.files.tables import CutEnd, number_in
from devices.files.text_files import open_text
from devices.files.trial import ImportedSensor, ImportedTrial

END_OF_HEAD = b"endheader"
KIND = re.compile(rb"^\s*DataType\s*=\s*Quaternion\s*$", re.MULTILINE | re.IGNORECASE)
TIME = "time"
SIMULATED = "SIMULATED"
LONGEST_LINE = 100_000  # bytes
HEAD_WITHIN = 100  # lines
ROTATION_ERROR = 0.01
UNEVEN = 0.2  # of a step: rates derived over uneven steps would be wrong by as much
EXPORT_AGAIN = "Export the file again from OpenSim"


@dataclass(frozen=True, slots=True)
class OrientationTable:
    """Times (n,) and earth from sensor (n, sensors, 4), NaN where a cell is empty; what was found about times."""

    time_s: FloatArray
    sensors: tuple[str, ...]
    q_earth_from_sensor: FloatArray
    of_clock: tuple[Finding, ...]
    is_simulated: bool = False


def is_opensim_orientations(_path: Path, head: bytes) -> bool:
    """Whether a file that begins so is one of these, and not one of OpenSim's other tables."""
    before, end, _ = head.partition(END_OF_HEAD)
    return bool(end) and KIND.search(before) is not None


def read_opensim_orientations(path: Path) -> OrientationTable:
    """Read one file; raises FileRefusedError for invalid tables, sensors twice or times that step back."""
    where = path.name
    names: list[str] = []
    rows: list[list[float]] = []
    lines: list[int] = []
    has_head, is_simulated = False, False
    cut = CutEnd()
    with open_text(path) as file:
        for number, raw in enumerate(iter(lambda: file.readline(LONGEST_LINE), b""), 1):
            here = f"{where}, line {number}"
            try:
                text = raw.decode("utf-8-sig" if number == 1 else "utf-8").strip()
            except UnicodeDecodeError as error:
                raise FileRefusedError(here, "the file is not UTF-8 text", EXPORT_AGAIN) from error
            if not has_head:
                has_head = text == END_OF_HEAD.decode()
                is_simulated |= text.startswith(SIMULATED)
                if number > HEAD_WITHIN:
                    break
            elif text in ("", END_OF_HEAD.decode()):  # which some writers repeat
                continue
            elif not names:
                names = _names(text, here)
            else:
                cells = [cell.strip() for cell in (text.split("\t") if "\t" in text else text.split())]
                if len(cells) < len(names):
                    cut.note_cut(_of_other_width(len(cells), len(names), here))
                    continue
                cut.note_whole()
                rows.append(_row(cells, len(names), here))
                lines.append(number)
    if not names:
        raise FileRefusedError(where, "there is no header line after {name}", EXPORT_AGAIN, name="endheader")
    values = np.array(rows, dtype=np.float64).reshape(len(rows), 1 + 4 * (len(names) - 1))
    values[~np.isfinite(values)] = np.nan
    time_s, q = values[:, 0], values[:, 1:].reshape(len(rows), len(names) - 1, 4)
    clock = whole_clock(time_s, FileClock(where, lambda row: f"line {lines[row]}", TIME), EXPORT_AGAIN)
    is_wrong = (np.abs(np.linalg.norm(q, axis=2) - 1.0) > ROTATION_ERROR).any(axis=1)
    if is_wrong.any():
        line = lines[int(np.argmax(is_wrong))]
        raise FileRefusedError(f"{where}, line {line}", "the orientation is not a valid rotation", EXPORT_AGAIN)
    stamps_s = clock.stamps[clock.is_new]
    findings = (*cut.findings(path), *clock.findings)
    return OrientationTable(stamps_s - stamps_s[:1], tuple(names[1:]), q[clock.is_new], findings, is_simulated)


def opensim_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """Read one trial's sensors, all in one file; raises FileRefusedError, also where times are uneven."""
    if len(files) != 1:
        raise FileRefusedError(
            ", ".join(path.name for path in files),
            "an orientation table contains all sensors of a trial",
            "Import one file at a time",
        )
    table = read_opensim_orientations(files[0])
    steps_s = np.diff(table.time_s)
    rate_hz = round(1.0 / float(np.median(steps_s)), 2) if len(steps_s) else rate_hz
    counter = _counter(table.time_s, rate_hz or 1.0, files[0].name)
    findings = [
        *table.of_clock,
        Finding("rate_from_orientation", Severity.INFO, ""),
        Finding("gravity_for_acceleration", Severity.WARNING, ""),
    ]
    sensors = []
    for k, name in enumerate(table.sensors):
        q = table.q_earth_from_sensor[:, k]
        block = ImuBlock(
            sensor=name,
            time_s=table.time_s,
            gyr_rad_s=derive_rates(q, counter, rate_hz or 1.0),
            acc_m_s2=with_gravity(np.zeros((len(q), 3)), q),
            q_earth_from_sensor=q,
            is_rate_derived=True,
        )
        info = SensorInfo(serial=name, rate_hz=rate_hz, rate_kind=RateKind.INSTANTANEOUS)
        sensors.append(ImportedSensor(name, (), str(files[0]), block, info, tuple(findings)))
    return ImportedTrial("opensim", tuple(sensors), is_simulated=table.is_simulated)


def _names(text: str, here: str) -> list[str]:
    names = text.split()
    if names[0].casefold() != TIME or len(names) < 2:
        raise FileRefusedError(here, "the header line does not begin with {name}", EXPORT_AGAIN, name=TIME)
    for name in names:
        if names.count(name) > 1:
            raise FileRefusedError(here, "column {name} appears twice", EXPORT_AGAIN, name=quoted(name))
    return names


def _of_other_width(count: int, width: int, here: str) -> FileRefusedError:
    return FileRefusedError(
        here,
        "the line has {count} cells, but the header has {width}",
        EXPORT_AGAIN,
        count=count,
        width=width,
    )


def _row(cells: Sequence[str], columns: int, here: str) -> list[float]:
    if len(cells) != columns:
        raise _of_other_width(len(cells), columns, here)
    try:
        row = [number_in(cells[0])]
        for cell in cells[1:]:
            four = [float(part) for part in _parts(cell)] if cell else [np.nan] * 4
            if len(four) != 4:
                raise FileRefusedError(
                    here, "{cell} is not an orientation of four numbers", EXPORT_AGAIN, cell=quoted(cell)
                )
            row += four
    except ValueError as error:
        raise FileRefusedError(here, "a value is not a number ({why})", EXPORT_AGAIN, why=quoted(error)) from error
    return row


def _parts(cell: str) -> list[str]:
    """The four numbers of an orientation; of eight parts two make one, with a decimal comma."""
    parts = cell.split(",")
    return [".".join(two) for two in zip(parts[::2], parts[1::2], strict=True)] if len(parts) == 8 else parts


def _counter(time_s: FloatArray, rate_hz: float, where: str) -> Numbers:
    """(n,) the even steps since the first row."""
    steps = np.diff(time_s) * rate_hz
    whole = np.rint(steps)
    is_uneven = (np.abs(steps - whole) > UNEVEN) & (steps < 10.0)
    if is_uneven.any() or np.any(steps > 1e9):
        raise FileRefusedError(
            where,
            "the times in the file are not evenly spaced, so angular rates cannot be derived from the orientation",
            "Export the file again at a constant rate",
        )
    counter: Numbers = np.concatenate([np.zeros(len(time_s[:1])), np.cumsum(whole)]).astype(np.int64)
    return counter

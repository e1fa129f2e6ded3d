"""Exports of APDM's Opal sensors, all sensors of a trial in one file: HDF5 (`apdm_hdf5`), or CSV.

CSV has the sensors' columns side by side, in two dialects. "Format=7" of Motion Studio: three lines of heads, sensors
by number and name, time in microseconds since 1970, no units stated. That of Moveo and Mobility Lab: a test's name and
rate, columns called `Sensor/Quantity/Axis`, a line of units. In both the orientation is earth from sensor, scalar
first, earth z up, and rates are of the instants of their stamps, as files of both show: the orientation turns the
specific force of a sensor at rest to earth z, and its slope is the rate.
"""

import csv
import io
import re
from collections.abc import Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from core.samples import FloatArray, ImuBlock, RateKind, SensorInfo
from devices.files.apdm_hdf5 import RecordedOpal, is_apdm_hdf5, read_apdm_hdf5
from devices.files.clock_repair import FileClock, usual_rate, whole_clock
from devices.files.hdf5 import is_hdf5
from devices.files.magnitudes import check_magnitudes
from devices.files.refusal import FileRefusedError, quoted
from devices.files.tables import CutEnd, number_in
from devices.files.text_files import open_text
from devices.files.trial import ImportedSensor, ImportedTrial

MONITORS, TEST_NAME, TIME = "Format=", "Test Name:", "Time"
HEAD_LINES = 5  # at most, of either dialect
HEAD_LETTERS = 40  # of the first cell and the sign after it
DELIMITER = re.compile(r"(?:Format=\d+|Test Name:) *([,;\t])", re.ASCII)  # decimal commas may outnumber any delimiter
EXPORT_AGAIN = "Export the file again as CSV, from Moveo, Mobility Lab or Motion Studio"
WITH_IT = "Export the file again, including the missing data"
PER_MONITOR = {"Accelerometer": 3, "Gyroscope": 3, "Magnetometer": 3, "Orientation": 4}
NAMED = {"Acceleration": "XYZ", "Angular Velocity": "XYZ", "Magnetic Field": "XYZ", "Orientation": "SXYZ"}
UNITS = {"Acceleration": ("m/s^2", "m/s²"), "Angular Velocity": ("rad/s",)}
ACC, GYR, MAG, ORIENTATION = 0, 1, 2, 3  # both dialects name the same four quantities in this order
Columns = tuple[tuple[int, ...], ...]


def is_apdm(path: Path, head: bytes) -> bool:
    """Give whether a file that begins so is such an export; raises FileRefusedError for unreadable HDF5."""
    if is_hdf5(head):
        return is_apdm_hdf5(path)
    lines = head.decode("utf-8", "replace").lstrip("\ufeff").splitlines()
    if not lines:
        return False
    return bool(re.match(r"Format=\d+[,;\t]", lines[0])) or (
        lines[0].startswith(TEST_NAME) and any("/Acceleration/" in line for line in lines[:HEAD_LINES])
    )


def read_apdm(path: Path) -> tuple[RecordedOpal, ...]:
    """Read one CSV; raises FileRefusedError where it cannot be read or its times step back."""
    where = path.name
    with io.TextIOWrapper(open_text(path), encoding="utf-8-sig", newline="") as file:
        try:
            stated = DELIMITER.match(file.read(HEAD_LETTERS))
            file.seek(0)
            reader = csv.reader(file, delimiter=stated[1] if stated else ",")
            head = list(islice(reader, HEAD_LINES))
            first = head[0][0].strip() if head and head[0] else ""
            if first.startswith(MONITORS):
                columns, ids = _monitors(head, where)
                first_row, tick_s, rate_hz = 3, 1e-6, None
            elif first == TEST_NAME:
                columns, first_row, rate_hz = _named(head, where)
                ids, tick_s = {}, 1.0
            else:
                raise FileRefusedError(where, "the file is not an export from APDM software", EXPORT_AGAIN)
            cut = CutEnd()
            rows = _numbers([*head[first_row:], *reader], len(head[first_row - 1]), first_row, where, cut)
        except (csv.Error, UnicodeDecodeError) as error:
            raise FileRefusedError(where, "the file is not comma-separated text", EXPORT_AGAIN) from error
    last = max((place for found in columns.values() for places in found for place in places), default=0)
    if last >= rows.shape[1]:
        raise FileRefusedError(where, "the header lines of the file differ in length", EXPORT_AGAIN)
    name_of_clock = FileClock(where, lambda row: f"line {row + first_row + 1}", TIME, tick_s)
    clock = whole_clock(rows[:, 0], name_of_clock, EXPORT_AGAIN)
    stamps, rows = clock.stamps[clock.is_new], rows[clock.is_new]
    opals, findings = [], (*cut.findings(path), *clock.findings)
    for name, places in columns.items():
        acc, gyr, mag, q = (rows[:, list(found)] if found else None for found in places)
        assert acc is not None  # `_found` refuses a sensor without
        assert gyr is not None
        known = tuple(filter(None, [ids.get(name)]))
        called = ids.get(name, name)
        opals.append(RecordedOpal(name, called, known, stamps, tick_s, acc, gyr, q, mag, rate_hz, findings))
    return tuple(opals)


def apdm_trial(files: Sequence[Path], _rate_hz: float | None = None) -> ImportedTrial:
    """Read one trial's sensors from its one file; shared stamps give the rate; raises FileRefusedError."""
    if len(files) != 1:
        raise FileRefusedError(
            ", ".join(path.name for path in files),
            "an APDM export contains all sensors of a trial in one file",
            "Import one file at a time",
        )
    with files[0].open("rb") as opened:
        has_hdf5 = is_hdf5(opened.read(16))
    opals = read_apdm_hdf5(files[0]) if has_hdf5 else read_apdm(files[0])
    start = min((opal.stamps[0] for opal in opals if len(opal.stamps)), default=0.0)
    return ImportedTrial("apdm", tuple(_sensor(opal, start, files[0]) for opal in opals))


def _sensor(opal: RecordedOpal, start: float, path: Path) -> ImportedSensor:
    check_magnitudes(opal.acc_m_s2, opal.gyr_rad_s, opal.name, path.name)  # one dialect states no units
    block = ImuBlock(
        sensor=opal.called,
        time_s=(opal.stamps - start) * opal.tick_s,
        gyr_rad_s=opal.gyr_rad_s,
        acc_m_s2=opal.acc_m_s2,
        q_earth_from_sensor=opal.q_earth_from_sensor,
        mag=opal.mag,
    )
    rate_hz = opal.rate_hz or usual_rate(block.time_s)
    info = SensorInfo(serial=opal.called, rate_hz=rate_hz, rate_kind=RateKind.INSTANTANEOUS)
    return ImportedSensor(opal.name, opal.ids, str(path), block, info, opal.of_clock)


def _monitors(head: list[list[str]], where: str) -> tuple[dict[str, Columns], dict[str, str]]:
    """Columns and numbers of the sensors of "Format=7", by their names."""
    if len(head) < 3:
        raise FileRefusedError(where, "the file header is cut off", EXPORT_AGAIN)
    sensors, quantities = head[0], head[1]
    cells = [k for k in range(1, len(sensors)) if sensors[k].strip()]
    columns: dict[str, Columns] = {}
    ids: dict[str, str] = {}
    for number, name in zip(cells[::2], cells[1::2], strict=False):
        nxt = next((k for k in cells[::2] if k > number), len(sensors))
        starts = {quantities[k].strip(): k for k in range(number, min(nxt, len(quantities))) if quantities[k].strip()}
        called = sensors[name].strip()
        columns[called] = _found(
            [tuple(range(starts[one], starts[one] + n)) if one in starts else () for one, n in PER_MONITOR.items()],
            called,
            where,
        )
        ids[called] = sensors[number].strip()
    if not columns:
        raise FileRefusedError(where, "the file lists no sensors", EXPORT_AGAIN)
    return columns, ids


def _named(head: list[list[str]], where: str) -> tuple[dict[str, Columns], int, float | None]:
    """Columns of the sensors of the other dialect, the first line with numbers, and the rate."""
    at = next((k for k, line in enumerate(head) if line and line[0].strip() == TIME), None)
    if at is None or at + 1 >= len(head):
        raise FileRefusedError(where, "there is no header line that begins with {name}", EXPORT_AGAIN, name=TIME)
    names, units = [cell.strip() for cell in head[at]], [cell.strip() for cell in head[at + 1]]
    places = {name: k for k, name in enumerate(names)}
    columns = {}
    for sensor in dict.fromkeys(name.split("/")[0] for name in names if name.count("/") == 2):
        found = []
        for quantity, axes in NAMED.items():
            parts = [f"{sensor}/{quantity}/{'Scalar' if axis == 'S' else axis}" for axis in axes]
            found.append(tuple(places[part] for part in parts) if all(part in places for part in parts) else ())
            for part in parts if found[-1] and quantity in UNITS else ():
                unit = units[places[part]] if places[part] < len(units) else ""
                if unit not in UNITS[quantity]:
                    raise FileRefusedError(
                        where,
                        "{name} is in {unit}, expected {required}",
                        "Export the file again in SI units",
                        name=quoted(part),
                        unit=quoted(unit),
                        required=UNITS[quantity][0],
                    )
        columns[sensor] = _found(found, sensor, where)
    rate = next((line[1] for line in head[:at] if line and line[0].startswith("Sample Rate") and len(line) > 1), "")
    try:
        rate_hz = float(rate)
    except ValueError:
        rate_hz = 0.0
    return columns, at + 2, rate_hz if rate_hz > 0 else None


def _found(columns: Sequence[tuple[int, ...]], sensor: str, where: str) -> Columns:
    if not columns[ACC]:
        raise FileRefusedError(where, "the file contains no acceleration of {sensor}", WITH_IT, sensor=quoted(sensor))
    if not columns[GYR]:
        raise FileRefusedError(where, "the file contains no angular rates of {sensor}", WITH_IT, sensor=quoted(sensor))
    return tuple(columns)


def _numbers(lines: list[list[str]], width: int, first_row: int, where: str, cut: CutEnd) -> FloatArray:
    """(n, width) cells as numbers, NaN where one is empty."""
    lines = [line for line in lines if any(cell.strip() for cell in line)]
    if not lines:
        return np.empty((0, width))
    for number, line in enumerate(lines, start=first_row + 1):
        if len(line) == width:
            cut.note_whole()
            continue
        refusal = FileRefusedError(
            f"{where}, line {number}",
            "the line has {count} cells, but the header has {width}",
            "The file is cut off or damaged; export it again",
            count=len(line),
            width=width,
        )
        if len(line) > width:
            raise refusal
        cut.note_cut(refusal)
    lines = lines[: len(lines) - len(cut.refusals)]
    try:
        return np.array([[number_in(cell) for cell in line] for line in lines], dtype=np.float64).reshape(-1, width)
    except ValueError:
        for number, line in enumerate(lines, start=first_row + 1):
            for cell in line:
                try:
                    number_in(cell)
                except ValueError:
                    raise FileRefusedError(
                        f"{where}, line {number}", "{cell} is not a number", EXPORT_AGAIN, cell=quoted(cell)
                    ) from None
        raise

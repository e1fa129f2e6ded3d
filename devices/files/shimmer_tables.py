"""Recordings of Shimmer sensors: of their cards (`shimmer_card`), or CSV of Consensys.

CSV holds calibrated data of one sensor, or of several side by side.

A line `sep=`, a line of names such as `Shimmer_40AC_Accel_LN_X_CAL`, a line of units, as public files show them; a
delimiter follows the last column. Times are milliseconds since 1970. Sensors that were synchronised by their
base report `TimestampSync`, and share its clock. Of two accelerometers that of the wide range is taken: a foot's
landing is beyond the 2 g of the other.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

from core.samples import ImuBlock, SensorInfo
from devices.drivers.csv_serial import FORCE_UNITS, RATE_UNITS
from devices.files.clock_repair import FileClock, repaired, usual_rate
from devices.files.column_names import Quantity, unit_of
from devices.files.magnitudes import check_magnitudes
from devices.files.own_clocks import from_zero, with_own_clocks
from devices.files.refusal import FileRefusedError, quoted
from devices.files.shimmer_card import card_recording, is_card, is_synchronised, read_card
from devices.files.tables import Table, header_of, read_csv
from devices.files.text_files import as_utf8, open_text
from devices.files.trial import ImportedSensor, ImportedTrial, read_each

FORMAT = "shimmer"
CLOCK = "Consensys"
NAME = re.compile(
    r"(?P<sensor>.+?)_(?P<what>TimestampSync_Unix|Timestamp_Unix|Accel_WR|Accel_LN|Gyro|Mag)(?:_(?P<axis>[XYZ]))?_CAL"
)
RAW = re.compile(r".+_(Accel_(WR|LN)|Gyro)_[XYZ]_(RAW|UNCAL)")
SYNCED, UNIX, WIDE, NARROW, GYR, MAG = "TimestampSync_Unix", "Timestamp_Unix", "Accel_WR", "Accel_LN", "Gyro", "Mag"
HEAD_LINES = 3
CALIBRATED = "_CAL"  # in every name of a header that can be read
MS_PER_S = 1000.0
DELIMITERS = ",;\t"
MOST_HEAD = 1 << 16  # bytes
NOT_CALIBRATED = "no sensor has calibrated acceleration, angular rates and Unix time"
EXPORT_AGAIN = (
    "Export the file again from Consensys, calibrated, with Unix time in milliseconds, accelerometer and gyroscope"
)


@dataclass(slots=True)
class ShimmerColumns:
    """The columns of one sensor, by what they hold; three axes each, and one of time."""

    columns: dict[str, dict[str, str]] = field(default_factory=dict)

    def axes(self, what: str) -> list[str]:
        """The columns of three axes; none where one is missing."""
        found = self.columns.get(what, {})
        return [found[axis] for axis in "XYZ"] if set(found) >= set("XYZ") else []

    def time(self) -> tuple[str, bool]:
        """The column of time, empty where there is none, and whether the base synchronised it."""
        for what in (SYNCED, UNIX):
            if name := self.columns.get(what, {}).get(""):
                return name, what == SYNCED
        return "", False


def is_shimmer(path: Path, head: bytes) -> bool:
    """Whether a file is of a Shimmer3's card, or a table of Consensys, uncalibrated ones included."""
    if b"\0" in head:
        return is_card(head)
    names = _names(head.decode("utf-8", "replace").lstrip("\ufeff").splitlines()[:HEAD_LINES])
    return any(NAME.fullmatch(name) or RAW.fullmatch(name) for name in names)


def shimmer_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """Read one trial's sensors from files, rate by stamps; raises FileRefusedError, or OSError if unreadable."""
    tables: list[Path] = []
    of_cards: dict[tuple[Path, str], list[Path]] = {}
    for path in files:
        with path.open("rb") as file:
            is_binary = b"\0" in as_utf8(file.read(MOST_HEAD))
        (of_cards.setdefault((path.parent, card_recording(path)), []) if is_binary else tables).append(path)
    parts_of = {path: [path] for path in tables} | {parts[0]: parts for parts in of_cards.values()}
    read, refused = read_each(
        list(parts_of), lambda path: _sensors(path) if path in tables else [_of_card(parts_of[path])]
    )
    sensors = [one for found in read for one in found]
    unread = [replace(one, file=str(part)) for one in refused for part in parts_of[Path(one.file)]]
    is_shared = all(one.info.clock == CLOCK for one in sensors)
    found = from_zero(sensors) if is_shared else with_own_clocks(sensors)
    return ImportedTrial(FORMAT, tuple(found), tuple(unread))


def _of_card(parts: Sequence[Path]) -> ImportedSensor:
    one = read_card(parts)
    return replace(one, info=replace(one.info, clock=CLOCK if is_synchronised(parts[0]) else ""))


def _names(lines: Sequence[str]) -> list[str]:
    """The names of a head: in the line after that of the delimiter, or in the first."""
    for line in lines[:2]:
        delimiter = max(DELIMITERS, key=line.count)
        names = [name.strip().strip('"') for name in line.split(delimiter)]
        if any(NAME.fullmatch(name) or RAW.fullmatch(name) for name in names):
            return names
    return []


def _sensors(path: Path) -> list[ImportedSensor]:
    where = path.name
    with open_text(path) as file:
        is_calibrated = CALIBRATED.encode() in file.read(MOST_HEAD)
    if not is_calibrated:
        raise FileRefusedError(where, NOT_CALIBRATED, EXPORT_AGAIN)
    before, names = header_of(path, where, delimiters=DELIMITERS, header_names=CALIBRATED)
    with open_text(path) as file:
        line = next(islice(file, len(before) + 1, None), b"").decode("utf-8", "replace").rstrip("\r\n")
    reported = [one.strip() for one in line.split(max(DELIMITERS, key=line.count))]
    units = dict(zip(names, reported, strict=False))  # a delimiter more or less follows the last
    found: dict[str, ShimmerColumns] = {}
    for name in names:
        if parts := NAME.fullmatch(name):
            sensor = found.setdefault(parts["sensor"], ShimmerColumns())
            sensor.columns.setdefault(parts["what"], {})[parts["axis"] or ""] = name
    whole = {
        sensor: columns
        for sensor, columns in found.items()
        if columns.time()[0] and columns.axes(GYR) and (columns.axes(WIDE) or columns.axes(NARROW))
    }
    if not whole:
        raise FileRefusedError(where, NOT_CALIBRATED, EXPORT_AGAIN)
    required = {name for one in whole.values() for axes in one.columns.values() for name in axes.values()}
    table = read_csv(
        path, where, required, delimiters=DELIMITERS, keep_others=False, has_units=True, header_names=CALIBRATED
    )
    return [_sensor(path, table, units, sensor, columns) for sensor, columns in whole.items()]


def _sensor(path: Path, table: Table, units: Mapping[str, str], name: str, columns: ShimmerColumns) -> ImportedSensor:
    force, (time, is_synced) = columns.axes(WIDE) or columns.axes(NARROW), columns.time()
    if units.get(time, "ms") != "ms":
        raise FileRefusedError(
            path.name, "{name} is in {unit}, expected ms", EXPORT_AGAIN, name=quoted(time), unit=quoted(units[time])
        )
    clock = repaired(table.numbers[time], FileClock(path.name, table.place, time, 1.0 / MS_PER_S))
    time_s, is_new = clock.stamps / MS_PER_S, clock.is_new
    if not is_new.any():
        raise FileRefusedError(path.name, "no sample has a time", EXPORT_AGAIN)
    mag = columns.axes(MAG)
    block = ImuBlock(
        sensor=name,
        time_s=time_s[is_new],
        gyr_rad_s=table.matrix(columns.axes(GYR))[is_new] * _scale(path, units, columns.axes(GYR), Quantity.GYR),
        acc_m_s2=table.matrix(force)[is_new] * _scale(path, units, force, Quantity.ACC),
        mag=table.matrix(mag)[is_new] if mag else None,
    )
    check_magnitudes(block.acc_m_s2, block.gyr_rad_s, name, path.name, gyr_unit=units[columns.axes(GYR)[0]])
    rate_hz, clock_name = usual_rate(block.time_s), CLOCK if is_synced else ""
    info = SensorInfo(serial=name, model="Shimmer3", rate_hz=rate_hz, clock=clock_name)
    ids = (name.rpartition("_")[2],)
    return ImportedSensor(name, ids, str(path), block, info, (*table.findings, *clock.findings))


def _scale(path: Path, units: Mapping[str, str], names: Sequence[str], quantity: Quantity) -> float:
    """What makes SI units of three columns."""
    reported = {unit_of(quantity, units.get(name, "")) for name in names}
    unit = reported.pop() if len(reported) == 1 else ""
    if not unit:
        raise FileRefusedError(
            path.name,
            "{name} is in {unit}, which is not a known unit",
            EXPORT_AGAIN,
            name=quoted(names[0]),
            unit=quoted(units.get(names[0], "")),
        )
    return (FORCE_UNITS if quantity is Quantity.ACC else RATE_UNITS)[unit]

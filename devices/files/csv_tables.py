"""CSV of any program: columns that say by their names and units what they are, see `named_columns`.

One sensor in each file, several side by side, several one after the other with a column that names them, or
accelerometer and gyroscope in two files. How the text is laid out is found by `table_layout`; what neither names nor
values show can be stated (`table_choices`). Our own session's columns are among those that are understood. It is asked
last of all formats.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.samples import FloatArray
from devices.files.column_names import (
    SENSOR_NAMES,
    SensorColumns,
    half_columns,
    listed,
    plain_name,
    quantity_of_file,
    sensor_columns,
    time_among,
    without_quantity,
)
from devices.files.named_columns import NAME_THEM, trial_of_tables
from devices.files.named_table import NamedTable
from devices.files.refusal import FileRefusedError, quoted
from devices.files.site_names import without_site
from devices.files.table_choices import (
    ALL_TABLES,
    CLOCK,
    NO_CHOICES,
    NONE,
    NOTHING_STATED,
    StatedChoices,
    TableChoices,
    column_named,
)
from devices.files.table_layout import TableLayout, fingerprint_of, layout_of, refuse_twice
from devices.files.tables import NO_VALUE, Table, is_value, read_rows
from devices.files.text_times import is_time, seconds_of
from devices.files.trial import CSV, ImportedTrial

OF_OTHERS = frozenset({"packetcounter", "sampletimefine"})  # Xsens and Movella: what their ticks are differs by program
MOST_SENSORS = 20  # of a column that names them


def is_csv(path: Path, head: bytes) -> bool:
    """Give whether a table has acceleration or rates about three axes; strict, so as to claim no other files."""
    try:
        return bool(head) and why_no_csv(path) is None
    except OSError:
        return False


def why_no_csv(path: Path) -> FileRefusedError | None:
    """Why a file is no table of a sensor that can be read without asking; None where it is one; raises OSError."""
    try:
        layout = layout_of(path, path.name)
        refuse_twice(layout, path.name)
        columns = _sensors_in(layout, path)
    except FileRefusedError as refusal:
        return refusal
    if any(name.strip().lower() in OF_OTHERS for name in layout.names):
        return FileRefusedError(
            path.name,
            "the file format is not recognised; its columns are those of Xsens or Movella sensors: {names}",
            "Choose the format with --as, or export the file again from the manufacturer's program",
            names=listed(layout.names),
        )
    if columns:
        return None
    if layout.header_line == 0:
        return FileRefusedError(
            path.name,
            "the file format is not recognised; the table has no header with the names of its columns",
            NAME_THEM,
        )
    return FileRefusedError(
        path.name,
        "the file format is not recognised; its columns do not identify acceleration and angular rates on three axes: "
        "{names}",
        NAME_THEM,
        names=listed(layout.names),
    )


def csv_recording(path: Path) -> str:
    """What the names of a recording's files have in common: all but the sensor's site and the quantity."""
    return without_site(without_quantity(path.stem))


def csv_trial(
    files: Sequence[Path], rate_hz: float | None = None, choices: StatedChoices = NOTHING_STATED
) -> ImportedTrial:
    """Read one trial's sensors; raises FileRefusedError if none can be read.

    `choices`: what is stated of tables by their paths or fingerprints, or of all by "".
    """

    def read(path: Path) -> list[NamedTable]:
        return tables_of(path, choices_for(path, choices) or NO_CHOICES)

    return trial_of_tables(CSV, read, files, rate_hz, may_be_halves=True)


def choices_for(path: Path, choices: StatedChoices) -> TableChoices | None:
    """What is stated of a file; None where nothing is; raises OSError where it cannot be opened."""
    if not choices or not path.is_file():
        return None
    return choices.get(str(path)) or choices.get(fingerprint_of(path)) or choices.get(ALL_TABLES)


def tables_of(path: Path, choices: TableChoices = NO_CHOICES, most_bytes: int = 0) -> list[NamedTable]:
    """Read a file's tables, one for each sensor that a column names; raises FileRefusedError.

    `most_bytes`: of the beginning; 0: all of it.
    """
    where = path.name
    layout = layout_of(path, where, choices, most_bytes)
    if not choices.acc and not choices.gyr:
        refuse_twice(layout, where)
    found = columns_in(layout, choices)
    time = time_column(layout, choices, found)
    is_text = bool(time) and is_text_time(layout, time, choices)
    sensor = sensor_column(layout, choices)
    found = _apart(found, time, sensor, where)
    if choices.time:
        found = tuple(replace(one, time=time, counter="") for one in found)
    numeric = {name for one in found for name in one.names()}
    numeric = (numeric | {time} if time and not is_text else numeric - {time}) - {sensor}
    texts = {name for name in (time if is_text else "", sensor) if name}
    table = read_rows(layout.opened, where, layout.header, numeric, kept=texts)
    units = {**layout.units, **_stated_units(found, time, choices)}
    named = NamedTable(
        columns={name: table.numbers[name] for name in layout.names if name in numeric},
        where=where,
        file=str(path),
        called=path.stem,
        place=table.place,
        units=units,
        rate_hz=choices.rate_hz or (None if time else layout.rate_hz),
        time_s=seconds_of(_texts(table, time), time, where, table.place) if is_text else None,
        time=time or "time",
        left_out=[name for name in layout.names if name not in numeric and name != sensor],
        findings=table.findings,
        stated=found,
    )
    return _by_sensor(named, table, sensor, is_stated=bool(choices.sensor)) if sensor else [named]


def _sensors_in(layout: TableLayout, path: Path) -> tuple[SensorColumns, ...]:
    """The sensors by the names of the columns, else their halves; raises FileRefusedError for two columns alike."""
    try:
        whole = sensor_columns(layout.names, layout.units)
        return whole or half_columns(layout.names, layout.units, quantity_of_file(path.stem))
    except FileRefusedError as refusal:
        raise FileRefusedError.stated_elsewhere(path.name, refusal.what, refusal.remedy, refusal.values) from None


def columns_in(layout: TableLayout, choices: TableChoices) -> tuple[SensorColumns, ...]:
    """The sensors of a table, as somebody states them or by the names of the columns; raises FileRefusedError."""
    stated = _stated_columns(layout, choices, layout.path.name)
    return _sensors_in(layout, layout.path) if stated is None else (stated,)


def _stated_columns(layout: TableLayout, choices: TableChoices, where: str) -> SensorColumns | None:
    """The columns of the one sensor that somebody states; None where nobody does."""
    if not choices.acc and not choices.gyr:
        return None
    by_name = SensorColumns("", (), ())
    try:
        by_name = next(iter(_sensors_in(layout, layout.path)), by_name)
    except FileRefusedError:  # of two columns alike, between which somebody chooses
        if not choices.acc or not choices.gyr:
            raise
        by_name = replace(by_name, time=time_among(layout.names, layout.units))
    acc, gyr = (
        () if stated == (NONE,) else _three(layout, stated, where) if stated else named
        for stated, named in ((choices.acc, by_name.acc), (choices.gyr, by_name.gyr))
    )
    if not acc and not gyr:
        raise FileRefusedError(where, "neither acceleration nor angular rates are chosen", NAME_THEM)
    return SensorColumns("", acc, gyr, time=by_name.time, counter=by_name.counter)


def _three(layout: TableLayout, stated: Sequence[str], where: str) -> tuple[str, ...]:
    names = tuple(_column(layout, one, where) for one in stated)
    if len(names) != 3 or len(set(names)) != 3:
        raise FileRefusedError(
            where,
            "{count} columns are chosen for the three axes: {names}",
            "Choose a column each for x, y and z",
            count=len(set(names)),
            names=listed(names),
        )
    return names


def _column(layout: TableLayout, stated: str, where: str) -> str:
    name = column_named(stated, layout.names)
    if name is None:
        raise FileRefusedError(
            where,
            "the table has no column {name}; its columns are {names}",
            "Choose one of these columns, by name or by number from 1",
            name=quoted(stated),
            names=listed(layout.names),
        )
    return name


def time_column(layout: TableLayout, choices: TableChoices, found: Sequence[SensorColumns]) -> str:
    """The column of times of all sensors; empty where there is none, or each has its own."""
    if choices.time:
        return "" if choices.time == NONE else _column(layout, choices.time, layout.path.name)
    times = {one.time for one in found}
    return times.pop() if len(times) == 1 else ""


def _apart(found: Sequence[SensorColumns], time: str, sensor: str, where: str) -> tuple[SensorColumns, ...]:
    """The sensors without what is stated to be something else; raises FileRefusedError for one column as two."""
    used = [name for one in found for name in (*one.acc, *one.gyr)] + [name for name in (time, sensor) if name]
    twice = next((name for name in used if used.count(name) > 1), None)
    if twice is not None:
        raise FileRefusedError(
            where,
            "the column {name} is chosen for two quantities",
            "Choose another column for one of them",
            name=quoted(twice),
        )
    others = {time, sensor}
    return tuple(
        replace(
            one,
            mag=() if others & set(one.mag) else one.mag,
            quat=() if others & set(one.quat) else one.quat,
            time="" if one.time == sensor else one.time,
            counter="" if one.counter in others else one.counter,
        )
        for one in found
    )


def is_text_time(layout: TableLayout, time: str, choices: TableChoices) -> bool:
    """Whether a column of times holds texts such as 23:59:59.990."""
    if choices.time_unit:
        return choices.time_unit == CLOCK
    cells = [cell for cell in layout.cells(time) if cell and cell.lower() not in NO_VALUE]
    return bool(cells) and any(is_time(cell) for cell in cells) and not all(map(is_value, cells))


def sensor_column(layout: TableLayout, choices: TableChoices) -> str:
    """The column that names the sensor of each row; empty where there is none."""
    if choices.sensor:
        return "" if choices.sensor == NONE else _column(layout, choices.sensor, layout.path.name)
    return next((name for name in layout.names if plain_name(name) in SENSOR_NAMES), "")


def _stated_units(found: Sequence[SensorColumns], time: str, choices: TableChoices) -> Mapping[str, str]:
    """Units that somebody states, by column."""
    units = {time: choices.time_unit} if time and choices.time_unit not in ("", CLOCK) else {}
    for one in found:
        for names, unit in ((one.acc, choices.acc_unit), (one.gyr, choices.gyr_unit)):
            units |= dict.fromkeys(names, unit) if unit else {}
    return units


def _by_sensor(table: NamedTable, read: Table, column: str, *, is_stated: bool) -> list[NamedTable]:
    """The rows of each sensor as a table of its own, where the column names a few; raises FileRefusedError."""
    names = np.array([str(text).strip() for text in _texts(read, column)])
    known = [str(name) for name in dict.fromkeys(names.tolist()) if name and name.lower() not in NO_VALUE]
    if not 0 < len(known) <= MOST_SENSORS:
        if is_stated:
            raise FileRefusedError(
                table.where,
                "the column {name} holds {count} different names of sensors",
                "Choose the column that names a few sensors, or none",
                name=quoted(column),
                count=len(known),
            )
        return [table]
    return [_rows_of(table, np.flatnonzero(names == name), name) for name in known]


def _texts(table: Table, column: str) -> list[str]:
    """The cells of a column, of which `read_rows` leaves out one without name and content."""
    return list(table.texts[column]) if column in table.texts else [""] * table.rows


def _rows_of(table: NamedTable, rows: NDArray[np.intp], name: str) -> NamedTable:
    def place(row: int, of_all: Callable[[int], str] = table.place) -> str:
        return of_all(int(rows[row]))

    time_s: FloatArray | None = None if table.time_s is None else table.time_s[rows]
    columns = {column: values[rows] for column, values in table.columns.items()}
    return replace(table, columns=columns, called=name, place=place, time_s=time_s)

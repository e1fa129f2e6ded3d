"""What a table of no known program looks like when it is read as somebody states, for them to confirm or change.

Every choice that nobody states is found: by the names of the columns, else by their values. Only the beginning of the
file is read.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from core.findings import Finding
from core.samples import FloatArray, ImuBlock
from devices.drivers.csv_serial import FORCE_UNITS
from devices.files.column_names import SensorColumns, meaning_of
from devices.files.csv_tables import columns_in, is_text_time, sensor_column, tables_of, time_column
from devices.files.magnitudes import middle_size
from devices.files.named_columns import GRAVITY_RANGE_M_S2, LEAST_DOWN, halves_of_table, sensors_of_table
from devices.files.refusal import FileRefusedError
from devices.files.table_choices import CLOCK, COUNT, NONE, PreviewedSensor, TableChoices, TablePreview
from devices.files.table_layout import TableLayout, fingerprint_of, layout_of, lines_of_head
from devices.files.tables import number_in
from devices.files.text_times import is_time

PREVIEW_BYTES = 2_000_000
SHOWN_S, SHOWN_SAMPLES = 10.0, 2000  # of each sensor
SHOWN_ROWS, SHOWN_LINES, LONGEST_LINE = 6, 40, 80
MOSTLY = 0.9  # of the rows of a column
MOST_SENSORS = 20
AXES = "xyz"


def preview_of(path: Path, stated: TableChoices) -> TablePreview:
    """Read the beginning of a table as somebody states; raises OSError where it cannot be opened."""
    where = path.name
    lines = tuple(line[:LONGEST_LINE] for line in lines_of_head(path, stated.encoding)[:SHOWN_LINES])
    fingerprint = fingerprint_of(path)  # as it is without being stated: what others of its program have in common
    try:
        layout = layout_of(path, where, stated, PREVIEW_BYTES)
    except FileRefusedError as refusal:
        return TablePreview(
            fingerprint, lines, (), (), stated, stated, (), is_by_values=False, is_cut=False, refusal=refusal
        )
    choices = _with_guesses(layout, stated)
    sensors: list[PreviewedSensor] = []
    unread: list[FileRefusedError] = []
    why: FileRefusedError | None = None
    try:
        for table in tables_of(path, choices, PREVIEW_BYTES):
            halves = [half.sensor for half in halves_of_table(table, choices.rate_hz)]
            read, refused = (halves, []) if halves else sensors_of_table(table, choices.rate_hz)
            unread += [one.refusal for one in refused]
            sensors += [_beginning(one.name, one.block, one.info.rate_hz, one.findings) for one in read]
    except FileRefusedError as refusal:
        why, sensors = refusal, []
    shown = tuple(tuple(row) for row in layout.rows[:SHOWN_ROWS])
    return TablePreview(
        fingerprint=fingerprint,
        lines=lines,
        columns=layout.names,
        rows=shown,
        choices=choices,
        found=_found(layout, choices, sensors),
        sensors=tuple(sensors[:MOST_SENSORS]),
        is_by_values=(choices.acc, choices.gyr) != (stated.acc, stated.gyr),
        is_cut=layout.is_cut,
        refusal=why,
        unread=() if why is not None else tuple(unread),
    )


def _beginning(name: str, block: ImuBlock, rate_hz: float | None, findings: Sequence[Finding]) -> PreviewedSensor:
    shown = slice(0, min(int(np.searchsorted(block.time_s, block.time_s[:1].sum() + SHOWN_S)), SHOWN_SAMPLES))
    length_s = float(block.time_s[-1] - block.time_s[0]) if len(block) else 0.0
    first = block.select(shown)
    return PreviewedSensor(name, first.time_s, first.acc_m_s2, first.gyr_rad_s, rate_hz, length_s, tuple(findings))


def _found(layout: TableLayout, choices: TableChoices, sensors: Sequence[PreviewedSensor]) -> TableChoices:
    """Every choice as it is in force."""
    try:
        known = columns_in(layout, choices)
    except FileRefusedError:
        known = ()
    one = known[0] if len(known) == 1 else SensorColumns("", (), ())
    numbers = _understood(sensors)
    try:
        time = time_column(layout, choices, known)
    except FileRefusedError:
        time = ""
    try:
        sensor = sensor_column(layout, choices)
    except FileRefusedError:
        sensor = choices.sensor
    unit = CLOCK if time and is_text_time(layout, time, choices) else choices.time_unit
    stated = str(numbers.get("time", ""))
    if not unit and time:
        unit = (
            stated[stated.rfind("[") + 1 : -1]
            if stated.endswith("]")
            else COUNT
            if sensors
            else _named_unit(layout, time)
        )
    return TableChoices(
        encoding=layout.encoding.removesuffix("-le").removesuffix("-be"),
        header_line=layout.header_line,
        separator=layout.header.delimiter,
        decimal=layout.header.decimal,
        acc=one.acc or choices.acc,
        acc_unit=choices.acc_unit
        or (str(numbers.get("acc_unit") or _named_unit(layout, one.acc[0])) if one.acc else ""),
        gyr=one.gyr or choices.gyr,
        gyr_unit=choices.gyr_unit
        or (str(numbers.get("gyr_unit") or _named_unit(layout, one.gyr[0])) if one.gyr else ""),
        time=time or NONE,
        time_unit=unit,
        sensor=sensor or NONE,
        rate_hz=choices.rate_hz or layout.rate_hz,
    )


def _named_unit(layout: TableLayout, name: str) -> str:
    """The unit in a column's name or below it, also where the table is refused."""
    meaning = meaning_of(name, layout.units.get(name, ""))
    return meaning.unit if meaning is not None else ""


def _understood(sensors: Sequence[PreviewedSensor]) -> Mapping[str, float | int | str]:
    """What was made of the columns of the first sensor."""
    findings = sensors[0].findings if sensors else ()
    return next((one.numbers for one in findings if one.key == "columns_understood"), {})


def _with_guesses(layout: TableLayout, stated: TableChoices) -> TableChoices:
    """What somebody states, and what values show of columns that no name explains."""
    try:
        sensor = sensor_column(layout, stated)
        if stated.acc or stated.gyr or columns_in(layout, stated):
            return stated
    except FileRefusedError:
        return stated
    values = _numbers(layout)
    is_number = np.isfinite(values).mean(axis=0) >= MOSTLY if len(values) else np.zeros(len(layout.names), dtype=bool)
    time = stated.time or next((name for name in layout.names if _is_time_text(layout, name)), "")
    if not time:
        rising = [k for k in np.flatnonzero(is_number) if _rises(values[:, k])]
        time = layout.names[rising[0]] if rising else ""
    taken = {time, sensor}
    free = [k for k, name in enumerate(layout.names) if is_number[k] and name not in taken and not _rises(values[:, k])]
    triples = [(k, k + 1, k + 2) for k in free if {k + 1, k + 2} <= set(free)]
    acc = next((places for places in triples if _is_force(values[:, places])), None)
    if acc is None and len(free) == len(AXES) and triples:  # a gyroscope in a file of its own
        rates = tuple(layout.names[k] for k in free)
        return replace(stated, time=stated.time or time, acc=(NONE,), gyr=rates)
    if acc is None:
        return replace(stated, time=stated.time or time)
    apart = [places for places in triples if not set(places) & set(acc)]
    gyr = min(apart, key=lambda places: (abs(places[0] - acc[2] - 1), places[0]), default=None)
    return replace(
        stated,
        time=stated.time or time,
        acc=tuple(layout.names[k] for k in acc),
        gyr=tuple(layout.names[k] for k in gyr) if gyr else (NONE,),
    )


def _numbers(layout: TableLayout) -> FloatArray:
    """(n, columns) numbers of the first rows, NaN where a cell is none."""

    def number(cell: str) -> float:
        try:
            return number_in(cell)
        except ValueError:
            return np.nan

    width = len(layout.names)
    rows = [[number(cell) for cell in row[:width]] + [np.nan] * (width - len(row)) for row in layout.rows]
    return np.array(rows, dtype=float).reshape(-1, width)


def _is_time_text(layout: TableLayout, name: str) -> bool:
    cells = [cell for cell in layout.cells(name) if cell]
    return bool(cells) and sum(map(is_time, cells)) >= MOSTLY * len(cells)


def _rises(values: FloatArray) -> bool:
    """Whether a column counts or is a clock."""
    steps = np.diff(values[np.isfinite(values)])
    return len(steps) > 1 and bool((steps >= 0).all()) and float(np.mean(steps > 0)) > 0.2


def _is_force(vectors: FloatArray) -> bool:
    """Whether three columns hold gravity in a known unit."""
    middle = middle_size(vectors)
    if np.isnan(middle) or float(np.linalg.norm(np.nanmean(vectors, axis=0))) < LEAST_DOWN * middle:
        return False
    least, most = GRAVITY_RANGE_M_S2
    return any(least < middle * scale < most for scale in FORCE_UNITS.values())

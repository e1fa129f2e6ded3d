"""CSV of any program: columns that say by their names and units what they are, see `named_columns`.

One sensor in each file, or all side by side. The header is the first line that is no comment (#); a line of units may
follow. Our own session's columns are among those that are understood. It is asked last of all formats.
"""

from collections.abc import Collection
from functools import partial
from pathlib import Path

from devices.files.column_names import is_unit, sensor_columns
from devices.files.named_columns import trial_of_tables
from devices.files.named_table import NamedTable, named_table_of
from devices.files.refusal import FileRefusedError
from devices.files.tables import Table, TextShape, read_csv, shape_of

COMMENT, DELIMITERS = "#", ",;\t"
OF_OTHERS = frozenset({"packetcounter", "sampletimefine"})  # Xsens and Movella: what their ticks are differs by program


def is_csv(path: Path, head: bytes) -> bool:
    """Give whether a table has acceleration and rates about three axes; strict, so as to claim no other files."""
    if not head or b"\0" in head:
        return False
    try:
        shape = _shape(path)
        sensors = sensor_columns(shape.names, shape.units)
    except FileRefusedError:
        return False
    has_others = any(name.strip().lower() in OF_OTHERS for name in shape.names)
    return bool(sensors) and not has_others and (not shape.first or len(shape.first) == len(shape.names))


def _tables(path: Path) -> list[NamedTable]:
    shape = _shape(path)

    def read(required: Collection[str]) -> Table:
        return read_csv(
            path,
            path.name,
            required,
            comment=COMMENT,
            delimiters=DELIMITERS,
            keep_others=False,
            has_units=bool(shape.units),
            decimal=shape.decimal,
        )

    return [named_table_of(path, shape.names, shape.units, read)]


csv_trial = partial(trial_of_tables, "csv", _tables)


def _shape(path: Path) -> TextShape:
    return shape_of(path, path.name, is_unit, comment=COMMENT, delimiters=DELIMITERS)

"""Parquet of any program: columns that say by their names and units what they are, see `named_columns`.

One sensor in each file, or all side by side. A unit may stand in a column's name or in its metadata ("unit", "units").
"""

from functools import partial
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from devices.files.column_names import sensor_columns
from devices.files.named_columns import trial_of_tables
from devices.files.named_table import NamedTable, named_table_of
from devices.files.refusal import FileRefusedError
from devices.files.table_header import COPY_AGAIN
from devices.files.tables import read_parquet

SIGNATURE = b"PAR1"
UNIT_KEYS = (b"unit", b"units")


def is_parquet(path: Path, head: bytes) -> bool:
    """Whether a file is Parquet with acceleration and angular rates about three axes of one sensor or more."""
    if not head.startswith(SIGNATURE):
        return False
    try:
        units = _columns(path)
        return bool(sensor_columns(list(units), units))
    except FileRefusedError:
        return False


def _tables(path: Path) -> list[NamedTable]:
    units = _columns(path)
    reported = {name: unit for name, unit in units.items() if unit}
    return [named_table_of(path, list(units), reported, lambda required: read_parquet(path, path.name, required))]


parquet_trial = partial(trial_of_tables, "parquet", _tables)


def _columns(path: Path) -> dict[str, str]:
    """The units of the columns by their names; empty where none is given."""
    try:
        with path.open("rb") as file:
            schema = pq.read_schema(file)
        return {field.name.strip(): _unit(field.metadata or {}) for field in schema}
    except pa.ArrowMemoryError:
        raise
    except (pa.ArrowException, OSError, ValueError, OverflowError) as error:
        raise FileRefusedError(
            path.name, "the file is not a readable Parquet file ({why})", COPY_AGAIN, why=error
        ) from error


def _unit(metadata: dict[bytes, bytes]) -> str:
    return next((metadata[key].decode("utf-8", "replace")[:40] for key in UNIT_KEYS if key in metadata), "")

"""The one table of a batch: `parameters.csv` for people, `parameters.parquet` for questions over many sessions.

Rows come one session after the other and leave in blocks, so that a million of them are never in memory. In Parquet
words are kept as dictionaries and a row group is what a database takes at a time, so that a question reads only the
columns that it names. Equal rows give equal bytes.
"""

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from types import MappingProxyType

import pyarrow as pa
import pyarrow.parquet as pq

from app.cohort.batch.rows import COLUMNS, CellKind, Row
from app.system.tables import csv_cell

CSV, PARQUET = "parameters.csv", "parameters.parquet"
BLOCK_ROWS = 1024
GROUP_ROWS = 122_880  # what DuckDB gives to one of its threads; some 90 MB of ours
TYPES = {
    CellKind.TEXT: pa.string(),
    CellKind.NUMBER: pa.float64(),
    CellKind.COUNT: pa.int64(),
    CellKind.FLAG: pa.bool_(),
}


def write_tables(
    rows: Iterable[Row], beside: Path, folder: Path, columns: Mapping[str, CellKind] = MappingProxyType(dict(COLUMNS))
) -> int:
    """Write both files into `beside`, rename them into `folder`, give the number of rows; raises OSError."""
    count = 0
    schema = pa.schema([(name, TYPES[kind]) for name, kind in columns.items()])
    words = [name for name, kind in columns.items() if kind is CellKind.TEXT]
    with (
        (beside / CSV).open("w", encoding="utf-8", newline="") as file,
        pq.ParquetWriter(beside / PARQUET, schema, compression="zstd", use_dictionary=words) as parquet,
    ):
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(columns)
        group: list[pa.RecordBatch] = []
        for block in _blocks(rows):
            count += len(block)
            lines.writerows([csv_cell(row.get(name)) for name in columns] for row in block)
            group.append(_batch(block, schema))
            if sum(len(batch) for batch in group) >= GROUP_ROWS:
                parquet.write_table(pa.Table.from_batches(group), row_group_size=GROUP_ROWS)
                group.clear()
        if group:
            parquet.write_table(pa.Table.from_batches(group), row_group_size=GROUP_ROWS)
    for name in (CSV, PARQUET):
        (beside / name).replace(folder / name)
    return count


def _blocks(rows: Iterable[Row]) -> Iterator[list[Row]]:
    rows = iter(rows)
    while block := list(islice(rows, BLOCK_ROWS)):
        yield block


def _batch(block: Sequence[Row], schema: pa.Schema) -> pa.RecordBatch:
    arrays = [pa.array([row.get(field.name) for row in block], field.type) for field in schema]
    return pa.RecordBatch.from_arrays(arrays, schema=schema)

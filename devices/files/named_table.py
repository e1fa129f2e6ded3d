"""A table of no particular program, as its readers hand it on to `named_columns`."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from core.findings import Finding
from core.samples import FloatArray
from devices.files.column_names import SensorColumns, sensor_columns
from devices.files.tables import Table


@dataclass(frozen=True, slots=True)
class NamedTable:
    """Columns of one table or file, all that is known about them, and where they are.

    `where`, `file`: the file's name in refusals, and its path.
    """

    columns: Mapping[str, FloatArray]  # name -> (n,): numbers, NaN where empty; of one sensor all of one length
    where: str
    file: str
    called: str  # the sensor's name where the columns name none
    place: Callable[[int], str]  # where a row is in the file ("line 12")
    units: Mapping[str, str] = field(default_factory=dict)  # of columns whose unit is not in their name
    rate_hz: float | None = None  # samples per second as the file gives it; None where it does not
    time_s: FloatArray | None = None  # (n,) or None: stamps in seconds that the file keeps beside its columns
    time: str = "time"  # what these stamps are called
    left_out: Sequence[str] = ()  # columns that were not even read as numbers
    findings: Sequence[Finding] = ()  # what its reader noticed, without a place
    stated: tuple[SensorColumns, ...] | None = None  # its sensors, or halves of them; None: by the columns' names


def named_table_of(
    path: Path, names: Sequence[str], units: Mapping[str, str], read: Callable[[Collection[str]], Table]
) -> NamedTable:
    """Read the sensors' columns of a file that is one table; raises FileRefusedError for two alike."""
    required = {name for one in sensor_columns(list(names), units) for name in one.names()}
    table = read(required)
    return NamedTable(
        columns={name: table.numbers[name] for name in names if name in required},
        where=path.name,
        file=str(path),
        called=path.stem,
        place=table.place,
        units=units,
        left_out=[name for name in names if name not in required],
    )

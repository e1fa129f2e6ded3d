"""A table of no particular program, as its readers hand it on to `named_columns`."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from core.findings import Finding
from core.samples import FloatArray
from devices.files.column_names import sensor_columns
from devices.files.tables import Table


@dataclass(frozen=True, slots=True)
class NamedTable:
    """Columns of one table or file, all that is known about them, and where they are.

    Attributes
    ----------
    columns : name -> (n,)
        Numbers, NaN where empty; of one sensor all of one length.
    units
        Of columns whose unit is not in their name.
    where, file
        The file's name in refusals, and its path.
    called
        The sensor's name where the columns name none.
    place
        Where a row is in the file ("line 12").
    rate_hz
        Samples per second as the file gives it; None where it does not.
    time_s : (n,) or None
        Stamps in seconds that the file keeps beside its columns.
    left_out
        Columns that were not even read as numbers.
    findings
        What its reader noticed, without a place.
    """

    columns: Mapping[str, FloatArray]
    where: str
    file: str
    called: str
    place: Callable[[int], str]
    units: Mapping[str, str] = field(default_factory=dict)
    rate_hz: float | None = None
    time_s: FloatArray | None = None
    left_out: Sequence[str] = ()
    findings: Sequence[Finding] = ()


def named_table_of(
    path: Path, names: Sequence[str], units: Mapping[str, str], read: Callable[[Collection[str]], Table]
) -> NamedTable:
    """The columns of sensors in a file that is one table.

    Parameters
    ----------
    names, units
        Of all its columns; units of those whose unit is not in their name.
    read
        Reads the columns of these names as numbers.

    Raises
    ------
    FileRefusedError
        What `read` refuses, two columns that mean the same.
    """
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

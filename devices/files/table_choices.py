"""What somebody states about a table whose names and values leave it open, and what it looks like when it is read so.

What is not stated is found.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from types import MappingProxyType

from core.findings import Finding
from core.samples import FloatArray
from devices.files.refusal import FileRefusedError

NONE = "none"  # in place of a column: the table has no such one
COUNT, CLOCK = "count", "clock"  # units of times: samples counted, and texts such as 23:59:59.990
TIME_UNITS = ("s", "ms", "us", "ns", "min", "h", "d", COUNT, CLOCK)
SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t", "bar": "|", "space": " "}


@dataclass(frozen=True, slots=True)
class TableChoices:
    """Each empty, or None, where nobody states it. Columns are given by name, or by place from 1."""

    encoding: str = ""
    header_line: int | None = None  # 0: there is none
    separator: str = ""
    decimal: str = ""
    acc: tuple[str, ...] = ()  # three columns in the order of the sensor's axes, or (NONE,)
    acc_unit: str = ""
    gyr: tuple[str, ...] = ()
    gyr_unit: str = ""
    time: str = ""  # a column, or NONE: samples are evenly spaced
    time_unit: str = ""  # one of TIME_UNITS
    sensor: str = ""  # the column that states which sensor a row is from, or NONE
    rate_hz: float | None = None

    @property
    def are_any(self) -> bool:
        """Whether anything is stated."""
        return any(getattr(self, one.name) not in ("", (), None) for one in fields(self))


NO_CHOICES = TableChoices()
ALL_TABLES = ""  # in place of a fingerprint
StatedChoices = Mapping[str, TableChoices]
"""What is stated of tables, by their paths, by their fingerprints, or of `ALL_TABLES`."""
NOTHING_STATED: StatedChoices = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class PreviewedSensor:
    """The beginning of one sensor, SI units; what its file lacks is NaN."""

    name: str
    time_s: FloatArray
    acc_m_s2: FloatArray
    gyr_rad_s: FloatArray
    rate_hz: float | None
    length_s: float
    findings: tuple[Finding, ...]


@dataclass(frozen=True, slots=True)
class TablePreview:
    """`fingerprint`: what tables of one program have in common, empty where there is no table.

    `lines`: the first of the file. `choices`: what has to be stated for the file to be read so: what somebody stated,
    and what was found by values alone. `found`: every choice as it is in force. `refusal`: why it cannot be read so.
    `unread`: why some of its sensors cannot.
    """

    fingerprint: str
    lines: tuple[str, ...]
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    choices: TableChoices
    found: TableChoices
    sensors: tuple[PreviewedSensor, ...]
    is_by_values: bool
    is_cut: bool
    refusal: FileRefusedError | None
    unread: tuple[FileRefusedError, ...] = ()


def by_place(choices: TableChoices, names: Sequence[str]) -> TableChoices:
    """The same choices with columns by their places from 1; raises ValueError where a place would name another one."""

    def place(column: str) -> str:
        if column in ("", NONE):
            return column
        name = column_named(column, names)
        found = str(names.index(name) + 1) if name is not None else ""
        if not found or column_named(found, names) != name:
            raise ValueError("the column has no place that names it")
        return found

    acc, gyr = (tuple(map(place, columns)) for columns in (choices.acc, choices.gyr))
    return replace(choices, acc=acc, gyr=gyr, time=place(choices.time), sensor=place(choices.sensor))


def column_named(stated: str, names: Sequence[str]) -> str | None:
    """The column that is called so, else the one at that place from 1; None where there is none."""
    for name in names:
        if name == stated:
            return name
    folded = [name for name in names if name.casefold() == stated.casefold()]
    if len(folded) == 1:
        return folded[0]
    if stated.isascii() and stated.isdigit() and 1 <= int(stated) <= len(names):
        return names[int(stated) - 1]
    return None

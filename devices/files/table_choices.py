"""What somebody states about a table whose names and values leave it open; what is not stated is found."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

NONE = "none"  # in place of a column: the table has no such one
COUNT, CLOCK = "count", "clock"  # units of times: samples counted, and texts such as 23:59:59.990
TIME_UNITS = ("s", "ms", "us", "ns", "d", COUNT, CLOCK)
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

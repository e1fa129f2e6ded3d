"""Times that are written as texts, as seconds: ISO 8601, dates of other forms, and times of day over midnight."""

import re
from collections.abc import Callable, Sequence
from datetime import date

import numpy as np

from core.samples import FloatArray
from devices.files.refusal import FileRefusedError, quoted
from devices.files.tables import NO_VALUE

DAY_S, HOUR_S = 86_400.0, 3600.0
FIRST_DAY = date(2020, 1, 1).toordinal()  # a recent one: numbers are finer
# a date of any form or none; hours, minutes and seconds, whose fraction follows a point, a comma or a colon
TIME = re.compile(
    r"(?:(?P<date>\d{1,4}[-./]\d{1,2}[-./]\d{1,4})[T\s,_]{1,4})?"
    r"(?:(?P<hour>\d{1,2}):)?(?P<minute>\d{1,2}):(?P<second>\d{1,2})(?:[.,:](?P<part>\d{1,9}))?"
    r"\s{0,4}(?P<half>[ap]\.?m\.?)?\s{0,4}(?:Z|UTC|[+-]\d{2}:?\d{2})?",
    re.IGNORECASE | re.ASCII,
)
ISO_DATE = re.compile(r"(\d{4})[-./](\d{1,2})[-./](\d{1,2})", re.ASCII)


def is_time(cell: str) -> bool:
    """Whether a cell is a time as a text."""
    return TIME.fullmatch(cell.strip()) is not None


def seconds_of(cells: Sequence[str], name: str, where: str, place: Callable[[int], str]) -> FloatArray:
    """Seconds (n,) of a column of times, NaN where empty, going on over midnight; raises FileRefusedError."""
    found = np.full(len(cells), np.nan)
    parts = [""] * len(cells)
    turn_s, is_dated = DAY_S, False
    for row, cell in enumerate(map(str, cells)):
        text = cell.strip()
        if not text or text.lower() in NO_VALUE:
            continue
        time = TIME.fullmatch(text)
        if time is None:
            raise FileRefusedError(
                f"{where}, {place(row)}",
                "{cell} in column {name} is not a time",
                "Correct the file or export it again",
                cell=quoted(cell),
                name=quoted(name),
            )
        days = _days(time["date"] or "")
        is_dated = is_dated or days is not None
        found[row] = (days or 0) * DAY_S + _whole_seconds(time)
        parts[row] = time["part"] or ""
        if time["hour"] is None:
            turn_s = HOUR_S  # a spreadsheet shows no hours
    found += _fractions(parts, found)
    if is_dated:
        return found
    known = np.flatnonzero(np.isfinite(found))
    turns = np.cumsum(np.diff(found[known], prepend=found[known[:1]]) < -0.5 * turn_s)
    found[known] += turns * turn_s
    return found


def _days(text: str) -> int | None:
    """Days since `FIRST_DAY`; None where no form of date is certain, and the time of day has to do."""
    found = ISO_DATE.fullmatch(text)
    try:
        return date(*map(int, found.groups())).toordinal() - FIRST_DAY if found else None
    except ValueError:
        return None


def _fractions(parts: Sequence[str], whole_s: FloatArray) -> FloatArray:
    """Fractions of seconds (n,): decimals, or a count of thousandths without zeros before it, where these run on."""
    decimal = np.array([int(part) / 10 ** len(part) if part else 0.0 for part in parts])
    widths = {len(part) for part in parts if part}
    if len(widths) < 2:
        return decimal
    digits = 3 * -(-max(widths) // 3)  # milliseconds, microseconds, nanoseconds
    counted = np.array([int(part) / 10**digits if part else 0.0 for part in parts])
    back, back_counted = (_steps_back(whole_s + fraction) for fraction in (decimal, counted))
    return counted if back_counted < back else decimal


def _steps_back(time_s: FloatArray) -> int:
    return int(np.sum(np.diff(time_s[np.isfinite(time_s)]) < 0.0))


def _whole_seconds(time: re.Match[str]) -> float:
    hour = int(time["hour"] or 0)
    if time["half"]:
        hour = hour % 12 + (12 if time["half"][0].lower() == "p" else 0)
    return hour * HOUR_S + int(time["minute"]) * 60.0 + int(time["second"])

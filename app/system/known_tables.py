"""What somebody stated about tables of other programs: kept on this computer by what tables of one program share.

Columns are kept by their places, never by their names: those are a file's, and may be anybody's.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from typing import Any

from app.system.kept_json import keep, read_kept
from devices.drivers.csv_serial import FORCE_UNITS, RATE_UNITS
from devices.files.table_choices import ALL_TABLES, NONE, SEPARATORS, TIME_UNITS, StatedChoices, TableChoices, by_place
from devices.files.text_files import ENCODINGS

FILE = "tables.json"
MOST_COLUMN = 10_000


def known_tables() -> StatedChoices:
    """By the fingerprints of tables; what cannot be read is left out, and has to be stated again."""
    kept, found = read_kept(FILE), {}
    for fingerprint, stated in kept.items() if isinstance(kept, dict) else ():
        if fingerprint == ALL_TABLES:
            continue
        with suppress(ValueError, TypeError, AttributeError, LookupError):
            found[fingerprint] = _choices(stated)
    return found


def keep_table(fingerprint: str, choices: TableChoices, columns: Sequence[str]) -> None:
    """Keep what is stated of tables with these columns, or that nothing is; raises OSError where it cannot be written.

    What cannot be kept by places alone is not kept.
    """
    kept = {**known_tables()}
    kept.pop(fingerprint, None)
    if choices.are_any:
        with suppress(ValueError):
            kept[fingerprint] = by_place(choices, columns)
    keep(FILE, {key: asdict(one) for key, one in kept.items()})


def _choices(stated: Mapping[str, Any]) -> TableChoices:
    """What was kept; raises ValueError, TypeError or LookupError for what this program never keeps."""
    acc, gyr = tuple(stated["acc"]), tuple(stated["gyr"])
    choices = TableChoices(**{**stated, "acc": acc, "gyr": gyr})
    for value, known in (
        (choices.encoding, ENCODINGS),
        (choices.separator, SEPARATORS.values()),
        (choices.decimal, (".", ",")),
        (choices.acc_unit, FORCE_UNITS),
        (choices.gyr_unit, RATE_UNITS),
        (choices.time_unit, TIME_UNITS),
    ):
        if value != "" and value not in known:
            raise ValueError(f"no such choice: {value}")
    for columns in (acc, gyr):
        if columns not in ((), (NONE,)) and not (len(columns) == 3 and all(map(_is_place, columns))):
            raise ValueError("three places of columns are kept")
    for column in (choices.time, choices.sensor):
        if column not in ("", NONE) and not _is_place(column):
            raise ValueError("the place of a column is kept")
    if choices.header_line is not None and not 0 <= int(choices.header_line) <= MOST_COLUMN:
        raise ValueError("no line of a header")
    if choices.rate_hz is not None and not 0.0 < float(choices.rate_hz) < MOST_COLUMN:
        raise ValueError("no rate")
    return choices


def _is_place(column: str) -> bool:
    return column.isascii() and column.isdigit() and 1 <= int(column) <= MOST_COLUMN

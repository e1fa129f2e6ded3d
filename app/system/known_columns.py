"""Meaning of the columns of sensors that send lines of numbers; given once for each, and kept on this computer."""

from collections.abc import Mapping, Sequence
from contextlib import suppress

from app.system.kept_json import keep, read_kept
from devices.drivers.csv_serial import Columns

FILE = "columns.json"


def known_columns() -> dict[str, Columns]:
    """By the port's `key`; what cannot be read is left out, and has to be entered again."""
    kept, found = read_kept(FILE), {}
    for key, settings in kept.items() if isinstance(kept, dict) else ():
        with suppress(ValueError, TypeError, AttributeError):
            found[key] = Columns.parsed(settings)
    return found


def keep_columns(keys: Sequence[str], columns: Columns) -> None:
    """Store what the columns sent at these ports mean; raises OSError where it cannot be written."""
    kept: Mapping[str, Columns] = known_columns() | dict.fromkeys(keys, columns)
    keep(FILE, {key: one.settings() for key, one in kept.items()})

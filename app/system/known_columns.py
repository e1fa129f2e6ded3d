"""Meaning of the columns of sensors that send lines of numbers; given once for each, and kept on this computer."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from app.system.kept_json import keep, place_of, read_kept
from devices.drivers.csv_serial import Columns

FILE = "columns.json"


def _place() -> Path:
    return place_of(FILE)


def known_columns() -> dict[str, Columns]:
    """By the port's `key`; what cannot be read is left out, and has to be entered again."""
    kept, found = read_kept(_place()), {}
    for key, settings in kept.items() if isinstance(kept, dict) else ():
        with suppress(ValueError, TypeError, AttributeError):
            found[key] = Columns.parsed(settings)
    return found


def keep_columns(keys: Sequence[str], columns: Columns) -> None:
    """Store what the columns sent at these ports mean; raises OSError where it cannot be written."""
    kept: Mapping[str, Columns] = known_columns() | dict.fromkeys(keys, columns)
    keep(_place(), {key: one.settings() for key, one in kept.items()})

"""Meaning of the columns of sensors that send lines of numbers; given once for each, and kept on this computer."""

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import platformdirs

from devices.drivers.csv_serial import Columns

FILE = "columns.json"


def _place() -> Path:
    return platformdirs.user_config_path("gaitwright", appauthor=False) / FILE


def known_columns() -> dict[str, Columns]:
    """By the port's `key`; what cannot be read is left out, and has to be entered again."""
    try:
        kept = json.loads(_place().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    found = {}
    for key, settings in kept.items() if isinstance(kept, dict) else ():
        with suppress(ValueError, TypeError, AttributeError):
            found[key] = Columns.parsed(settings)
    return found


def keep_columns(keys: Sequence[str], columns: Columns) -> None:
    """Store what the columns sent at these ports mean; raises OSError where it cannot be written."""
    kept: Mapping[str, Columns] = known_columns() | dict.fromkeys(keys, columns)
    place = _place()
    place.parent.mkdir(parents=True, exist_ok=True)
    beside = place.with_suffix(".new")
    beside.write_text(json.dumps({key: one.settings() for key, one in kept.items()}, indent=1), encoding="utf-8")
    beside.replace(place)

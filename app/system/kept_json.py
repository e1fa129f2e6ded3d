"""Small JSON files that this computer keeps beside the settings."""

import json
from pathlib import Path
from typing import Any

import platformdirs


def place_of(name: str) -> Path:
    """Where a file of this name is kept."""
    return platformdirs.user_config_path("gaitwright", appauthor=False) / name


def read_kept(name: str) -> Any:
    """What is kept in the file of this name; None where it cannot be read."""
    try:
        return json.loads(place_of(name).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def keep(name: str, content: object) -> None:
    """Replace what is kept in it, whole or not at all; raises OSError where it cannot be written."""
    place = place_of(name)
    place.parent.mkdir(parents=True, exist_ok=True)
    beside = place.with_suffix(".new")
    beside.write_text(json.dumps(content, indent=1), encoding="utf-8")
    beside.replace(place)

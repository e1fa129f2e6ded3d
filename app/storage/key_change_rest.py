"""An interrupted change of a library's data key (`app.storage.key_change`) is finished or taken back."""

import json
from pathlib import Path

from app.storage.files import held, sync_folder
from app.storage.keys import KeyRefusedError
from app.storage.layout import DATABASE, KEYS, NEW_DATABASE, NEW_KEYS


def settle(folder: Path) -> None:
    """Finish or undo an interrupted key change, before slots are read; raises KeyRefusedError or OSError."""
    keys, new_keys, beside = folder / KEYS, folder / NEW_KEYS, folder / NEW_DATABASE
    if not (new_keys.exists() or beside.exists()):
        return
    try:
        with held(keys.with_name(f"{KEYS}.lock")):
            if new_keys.exists():
                if json.loads(new_keys.read_bytes())["database"] == salt_of(folder / DATABASE):
                    new_keys.replace(keys)
                else:
                    new_keys.unlink()
            remove_database(beside)
            sync_folder(folder)
    except BlockingIOError:
        raise KeyRefusedError("Someone else is changing the keys", "Try again in a moment") from None


def salt_of(database: Path) -> str | None:
    """What distinguishes one database of SQLCipher from another: random, in the open, drawn when it was made."""
    try:
        with database.open("rb") as file:
            return file.read(16).hex()
    except FileNotFoundError:
        return None


def remove_database(database: Path) -> None:
    for ending in ("", "-wal", "-shm", "-journal"):
        database.with_name(database.name + ending).unlink(missing_ok=True)

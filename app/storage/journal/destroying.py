"""A sealed file is made unreadable, then removed. Killed in between, it is unreadable, and can be destroyed again."""

import os
from pathlib import Path

from app.storage.files import sync_folder
from app.storage.journal.header import HEADER_BYTES, JournalRefusedError, destroy_key


def destroy_file(path: Path) -> None:
    """Overwrite a journal's key, then remove the file, if it is there; raises OSError."""
    if not path.exists():
        return  # an earlier try came as far
    try:
        destroy_key(path)
    except JournalRefusedError:  # not sealed, or its beginning is damaged, which may still hold the key
        with path.open("r+b", buffering=0) as file:
            file.write(bytes(HEADER_BYTES))
            os.fsync(file.fileno())
    path.unlink()
    sync_folder(path.parent)

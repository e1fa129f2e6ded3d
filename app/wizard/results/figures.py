"""Figures of what is behind the results, saved from a library."""

from collections.abc import Callable
from pathlib import Path
from uuid import UUID

from app.results.detail_pages import cannot_write
from app.storage.audit import about
from app.storage.opened import OpenedLibrary
from app.storage.stored import Action, LibraryError


def saved_from_library(
    opened: OpenedLibrary, session_id: UUID, what: str, folder: Path, write: Callable[[], None]
) -> Path:
    """Note an export of figures `what`, then make it, on the library's thread; raises LibraryError."""
    opened.library.audit.note(Action.EXPORT, about("session", session_id), format=what)
    try:
        write()
    except OSError as problem:
        raise LibraryError(*cannot_write(folder)) from problem
    return folder

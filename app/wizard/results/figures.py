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
    """Note an export of figures of a session and make it, on the library's thread; `what` is one of the WHATs.

    Raises
    ------
    LibraryError
        It cannot be noted, or the folder cannot be written.
    """
    opened.library.audit.note(Action.EXPORT, about("session", session_id), format=what)
    try:
        write()
    except OSError as problem:
        raise LibraryError(*cannot_write(folder)) from problem
    return folder

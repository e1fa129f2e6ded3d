"""Sessions that the command line names, read."""

import argparse
from pathlib import Path

from app.cli.arguments import LibrarySession
from app.exports.result_folder import session_of
from app.importing.untrusted_files import read_foreign_session
from app.system.progress import Report
from core.session import Session


def read_session(args: argparse.Namespace, place: Path | LibrarySession, report: Report) -> Session:
    """A session of the library, or of its own folder.

    Raises
    ------
    FileRefusedError
        There is no such session, or it cannot be read.
    """
    if isinstance(place, LibrarySession):
        from app.cli.library import read_library_session  # the database, which folders do without

        return read_library_session(args, place, report)
    return read_foreign_session(place, lambda: report(0.0, str(place)))


def read_place(args: argparse.Namespace, place: Path | LibrarySession, report: Report) -> Session:
    """A session as `read_session` reads it, or the one inside a folder of results."""
    if isinstance(place, LibrarySession):
        return read_session(args, place, report)
    return read_foreign_session(session_of(place), lambda: report(0.0, str(place)))

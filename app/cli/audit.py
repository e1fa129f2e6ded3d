"""`gaitwright audit`: whether a library's audit is as it was written."""

import argparse
from collections.abc import Iterator

from app.cli.library import opened_library
from app.storage.stored import BEGINNING, Checkpoint, LibraryError
from app.system.progress import Report
from devices.files.refusal import FileRefusedError, one_line


def run(args: argparse.Namespace, _report: Report) -> Iterator[str]:
    """Follow the audit from its beginning; gives what is wrong, then how far it goes, to be kept elsewhere.

    Raises
    ------
    FileRefusedError
        The library does not open, `--since` is no checkpoint, or an entry is not as it was written.
    """
    try:
        since = Checkpoint.parsed(args.since) if args.since else BEGINNING
    except LibraryError:
        what = f"{one_line(args.since)} is no line of an earlier audit"
        raise FileRefusedError(
            "--since", what, "Give the last line that an earlier run of this command printed"
        ) from None
    with opened_library(args) as opened:
        checked = opened.library.audit.verify(since)
    for fault in checked.faults:
        yield f"- entry {fault.number} {fault.what}."
    yield str(checked.end)
    if checked.faults:
        what = f"{len(checked.faults)} faults in the audit" if len(checked.faults) > 1 else "a fault in the audit"
        raise FileRefusedError(str(args.library), what, "Compare the library with a backup")

"""`gaitwright recover`: recordings of a library that nobody stopped, closed and made whole."""

import argparse
from collections.abc import Iterator
from contextlib import suppress

from app.cli.arguments import PREFIX, LibrarySession
from app.cli.library import opened_library
from app.storage.bringing_home import bring_home
from app.storage.opened import OpenedLibrary, held_alone
from app.storage.recovery import Interrupted, adopt, adopt_home, find_interrupted, recover
from app.storage.stored import LibraryError
from app.system.progress import Report
from app.wording.numbers import clock
from core.session import Recording, RecordingKind
from devices.files.imports import folder_for, free_name


def run(args: argparse.Namespace, report: Report) -> Iterator[str]:
    """Close what was not stopped; gives a line for each recording.

    Raises
    ------
    FileRefusedError
        The library does not open, or another program is using it.
    """
    with opened_library(args) as opened, held_alone(opened.folder):
        bring_home(opened)
        interrupted = find_interrupted(opened)
        if not interrupted:
            yield "Every recording was stopped. Nothing had to be recovered."
        for number, one in enumerate(interrupted):

            def reported(share: float, what: str, number: int = number) -> None:
                report((number + share) / len(interrupted), what)

            yield _recover_one(opened, one, args.into, reported)


def _recover_one(opened: OpenedLibrary, one: Interrupted, into: LibrarySession | None, report: Report) -> str:
    if one.problem:
        name = one.stored.details.name if one.stored else f"recording {one.recording_id}"
        return f"- {name}: {one.problem}. {one.remedy}."
    if one.stored is None:
        return _adopt(opened, one, into, report)
    recovered = recover(opened, one, report)
    reported = recovered.stored.details.name
    if not recovered.recorded_s:
        return f"{reported}: it was ended before anything was recorded."
    where = f"{PREFIX}{recovered.stored.session_id}"
    return (
        f"{reported}: {clock(recovered.recorded_s, 2)} was recovered. Review it in {where}, then include or exclude it."
    )


def _adopt(opened: OpenedLibrary, one: Interrupted, into: LibrarySession | None, report: Report) -> str:
    when = f"{one.began_at:%Y-%m-%d %H:%M} UTC" if one.began_at else "an unknown time"
    if into is None and one.belonging is not None:
        with suppress(LibraryError):  # the session that it names is gone
            recovered = adopt_home(opened, one, report)
            where = f"{PREFIX}{recovered.stored.session_id}"
            return f"{recovered.stored.details.name}: {clock(recovered.recorded_s, 2)} was recovered into {where}."
    if into is None:
        length = clock(one.recorded_s, 2)
        return f"- {length} recorded at {when} belongs to no session. Say to which with --into {PREFIX}ID."
    visit = opened.library.sessions.get(into.id)
    name = free_name(visit.details, RecordingKind.WALKING)
    reported = Recording(name, RecordingKind.WALKING, folder_for(name), {})
    recovered = adopt(opened, one, into.id, reported, report)
    return f"{name}: {clock(recovered.recorded_s, 2)} recorded at {when} was recovered into {into}."

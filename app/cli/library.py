"""Command line for a library. It opens one, reads a session and recovers what was left.

A passphrase is typed or read from a file; the command line itself would be seen by other programs. A library's own
refusals leave here as the one line that the command line prints.
"""

import argparse
import getpass
import math
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

from app.system.progress import Report
from app.wording.numbers import clock
from devices.decoders import DECODERS
from devices.files.refusal import FileRefusedError, one_line

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.storage.recovery import Interrupted
    from core.session import Session

PREFIX = "library:"
WHO = "--operator"
PASSPHRASE_FILE = "--passphrase-file"


@dataclass(frozen=True, slots=True)
class LibrarySession:
    """`library:ID`: a session of a library, in place of a session folder."""

    id: UUID

    def __str__(self) -> str:
        return f"{PREFIX}{self.id}"

    @classmethod
    def parsed(cls, text: str) -> "LibrarySession":
        """Read an id, with its prefix or without.

        Raises
        ------
        ArgumentTypeError
            It is none.
        """
        try:
            return cls(UUID(text.removeprefix(PREFIX)))
        except ValueError:
            raise argparse.ArgumentTypeError(f"{one_line(text)} is not {PREFIX}ID with the id of a session") from None


def session_place(text: str) -> Path | LibrarySession:
    """An argument that names a session: its folder, or library:ID."""
    return LibrarySession.parsed(text) if text.startswith(PREFIX) else Path(text)


def add_key_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(WHO, metavar="CODE", default="", help="who opens the library, if there are several operators")
    parser.add_argument(
        PASSPHRASE_FILE, metavar="FILE", type=Path, help="the passphrase is its first line; else it is asked for"
    )


@contextmanager
def opened_library(args: argparse.Namespace, *, is_to_be_moved: bool = False) -> Iterator["OpenedLibrary"]:
    """Open `required.library` for as long as is needed; `is_to_be_moved`: to a clinic's server, or back.

    Raises
    ------
    FileRefusedError
        It does not open, or it refused what was done with it.
    """
    from app.storage.error_figures import figures_of
    from app.storage.journal.header import JournalRefusedError
    from app.storage.keys import KeyRefusedError
    from app.storage.opened import open_library
    from app.storage.stored import LibraryError
    from core.verdicts.sigmas import using

    folder: Path = args.library
    try:
        passphrase = _passphrase(args.passphrase_file, folder)
        with _counted(folder, args.operator):
            opening = open_library(folder, passphrase, args.operator, is_to_be_moved=is_to_be_moved)
        with opening as opened, using(figures_of(opened.library)):
            yield opened
    except (LibraryError, KeyRefusedError) as refusal:
        remedy = f"{refusal.remedy} ({WHO} CODE)" if refusal.remedy == "Enter your user code" else refusal.remedy
        raise FileRefusedError(str(folder), refusal.what, remedy) from refusal
    except JournalRefusedError as refusal:
        raise FileRefusedError(refusal.where, refusal.what, refusal.remedy) from refusal
    except OSError as problem:
        what = f"this cannot be read or written ({problem.strerror})"
        raise FileRefusedError(str(folder), what, "Check the disk and the permissions of this folder") from problem


def read_library_session(args: argparse.Namespace, session: LibrarySession, report: Report) -> "Session":
    """A session with its samples; that it was read is noted in the library's audit.

    Raises
    ------
    FileRefusedError
        The library does not open, there is no such session, or a recording cannot be read.
    """
    from app.storage.exchange import session_with_samples

    with opened_library(args) as opened:
        visit = opened.library.sessions.view(session.id)
        read = session_with_samples(opened, visit, DECODERS, report)
    if not read.recordings:
        raise FileRefusedError(str(session), "this session has no recording", "Choose another session")
    return read


def read_place(args: argparse.Namespace, place: Path | LibrarySession, report: Report) -> "Session":
    """A session of the library, or of a folder: its own, or results with it inside.

    Raises
    ------
    FileRefusedError
        There is no such session, or it cannot be read.
    """
    if isinstance(place, LibrarySession):
        return read_library_session(args, place, report)
    from app.importing.untrusted_files import read_foreign_session
    from app.reports.patient.report_file import session_of

    return read_foreign_session(session_of(place), lambda: report(0.0, str(place)))


def recover(args: argparse.Namespace, report: Report) -> Iterator[str]:
    """Close what was not stopped; gives a line for each recording.

    Raises
    ------
    FileRefusedError
        The library does not open, or another program is using it.
    """
    from app.storage.bringing_home import bring_home
    from app.storage.opened import held_alone
    from app.storage.recovery import find_interrupted

    with opened_library(args) as opened, held_alone(opened.folder):
        bring_home(opened)
        interrupted = find_interrupted(opened)
        if not interrupted:
            yield "Every recording was stopped. Nothing had to be recovered."
        for number, one in enumerate(interrupted):

            def reported(share: float, what: str, number: int = number) -> None:
                report((number + share) / len(interrupted), what)

            yield _recover_one(opened, one, args.into, reported)


def verify_audit(args: argparse.Namespace) -> Iterator[str]:
    """Follow the audit from its beginning; gives what is wrong, then how far it goes, to be kept elsewhere.

    Raises
    ------
    FileRefusedError
        The library does not open, `required.since` is no checkpoint, or an entry is not as it was written.
    """
    from app.storage.stored import BEGINNING, Checkpoint, LibraryError

    try:
        since = Checkpoint.parsed(args.since) if args.since else BEGINNING
    except LibraryError:
        what = f"{one_line(args.since)} is no line of an earlier audit"
        raise FileRefusedError(
            "--since", what, "Give the last line that an earlier run of this command printed"
        ) from None
    with opened_library(args) as opened:
        report = opened.library.audit.verify(since)
    for fault in report.faults:
        yield f"- entry {fault.number} {fault.what}."
    yield str(report.end)
    if report.faults:
        what = f"{len(report.faults)} faults in the audit" if len(report.faults) > 1 else "a fault in the audit"
        raise FileRefusedError(str(args.library), what, "Compare the library with a backup")


def _recover_one(opened: "OpenedLibrary", one: "Interrupted", into: LibrarySession | None, report: Report) -> str:
    from app.storage.recovery import recover

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


def _adopt(opened: "OpenedLibrary", one: "Interrupted", into: LibrarySession | None, report: Report) -> str:
    from app.storage.recovery import adopt, adopt_home
    from app.storage.stored import LibraryError
    from core.session import Recording, RecordingKind
    from devices.files.imports import folder_for, free_name

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


@contextmanager
def _counted(folder: Path, code: str) -> Iterator[None]:
    """Try a passphrase when it is time for the next try."""
    from app.storage.keys import KeySlots
    from app.storage.layout import KEYS
    from app.storage.login_delay import LoginDelay

    slots, delay = KeySlots(folder / KEYS), LoginDelay(folder, time.monotonic)
    if not slots.exists or not (code or len(slots.codes) == 1):
        yield  # which is refused, and reveals nothing of a passphrase
        return
    code = code or slots.codes[0]
    delay.read()
    if (left_s := delay.left_s(code)) > 0:
        print(f"Wrong passphrases were typed before: this waits for {math.ceil(left_s)} s.", file=sys.stderr)
        time.sleep(left_s)
    with delay.trying(code):
        yield


def _passphrase(file: Path | None, library: Path) -> str:
    if file is not None:
        try:
            return file.read_text(encoding="utf-8").partition("\n")[0].rstrip("\r")
        except (OSError, UnicodeDecodeError) as problem:
            what = "the passphrase cannot be read from this file"
            raise FileRefusedError(
                str(file), what, "Give a text file with the passphrase as its first line"
            ) from problem
    if not sys.stdin.isatty():
        what = "there is no terminal to type the passphrase on"
        raise FileRefusedError(str(library), what, f"Name a file that holds it with {PASSPHRASE_FILE}")
    return getpass.getpass(f"Passphrase of {one_line(str(library))}: ")

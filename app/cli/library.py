"""A library that the command line names: opened, and a session of it read.

A passphrase is typed or read from a file; the command line itself would be seen by other programs. A library's own
refusals leave here as the one line that the command line prints.
"""

import argparse
import getpass
import math
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from app.cli.arguments import PASSPHRASE_FILE, WHO, LibrarySession
from app.storage.error_figures import figures_of
from app.storage.exchange import session_with_samples
from app.storage.journal.header import JournalRefusedError
from app.storage.keys import KeyRefusedError, KeySlots
from app.storage.layout import KEYS
from app.storage.login_delay import LoginDelay
from app.storage.opened import OpenedLibrary, open_library
from app.storage.stored import LibraryError
from app.system.progress import Report
from core.session import Session
from core.verdicts.sigmas import using
from devices.decoders import DECODERS
from devices.files.refusal import FileRefusedError, one_line


@contextmanager
def opened_library(args: argparse.Namespace, *, is_to_be_moved: bool = False) -> Iterator[OpenedLibrary]:
    """Open the library, its refusals as FileRefusedError; `is_to_be_moved`: to a clinic's server, or back."""
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


def read_library_session(args: argparse.Namespace, session: LibrarySession, report: Report) -> Session:
    """Read a session with its samples, noting that in the audit; raises FileRefusedError."""
    with opened_library(args) as opened:
        visit = opened.library.sessions.view(session.id)
        read = session_with_samples(opened, visit, DECODERS, report)
    if not read.recordings:
        raise FileRefusedError(str(session), "this session has no recording", "Choose another session")
    return read


@contextmanager
def _counted(folder: Path, code: str) -> Iterator[None]:
    """Try a passphrase when it is time for the next try."""
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

"""`gaitwright clinic`: a library goes to a server that a clinic's stations share, stations join it, and it comes back.

The server's address comes from `--database` or the environment variable GAITWRIGHT_DATABASE_URL. A password is not
taken from the command line, which other programs can see.
"""

import argparse
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

from app.cli.arguments import ADDRESS
from app.cli.library import opened_library
from app.storage.clinic.handing_over import count_waiting
from app.storage.clinic.joining import join, new_station, prepare_server
from app.storage.clinic.moving import (
    BEFORE,
    Moved,
    bring_back,
    give_up_bringing_back,
    give_up_moving,
    move_to_server,
)
from app.storage.clinic.station import driver_url, shown_address
from app.storage.layout import DATABASE_VARIABLE
from app.storage.opened import OpenedLibrary, held_alone
from app.storage.stored import LibraryError
from app.system.progress import Report
from devices.files.refusal import FileRefusedError


def run(args: argparse.Namespace, progress: Report) -> Iterable[str]:
    """Do one of these and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        The server, the shared place or the library refuses.
    """
    return {"prepare": _prepare, "move": _move, "join": _join, "back": _back, "status": _status}[args.action](
        args, progress
    )


def _prepare(args: argparse.Namespace, _progress: Report) -> list[str]:
    with _refusing(DATABASE_VARIABLE):
        address = _address(args)
        prepare_server(address)
    return [
        f"{shown_address(address)} is ready.",
        "Give each station a login: CREATE ROLE station_1 LOGIN PASSWORD '...' IN ROLE gaitwright_app;",
        "and a screen that only looks one IN ROLE gaitwright_reader.",
    ]


def _move(args: argparse.Namespace, progress: Report) -> list[str]:
    if args.give_up:
        with _refusing(str(args.library)):
            give_up_moving(args.library)
        return [f"{args.library} is worked with as before. What is on the server of it is never opened."]
    with _refusing(str(args.library)):
        station = new_station(_address(args), _place(args))
    with _held(args) as opened:
        moved = move_to_server(opened, station, progress)
    return [
        f"{_counted(moved)} are on {shown_address(station.database)}, compared row by row.",
        f"{args.library} is a station now.",
        f"{args.library / BEFORE} is the database as it was: remove it once you are sure.",
    ]


def _join(args: argparse.Namespace, _progress: Report) -> list[str]:
    with _refusing(str(args.library)):
        station = join(args.library, _address(args), args.journals)
    return [f"{args.library} is a station of {shown_address(station.database)}. Open Gaitwright and log in as always."]


def _back(args: argparse.Namespace, progress: Report) -> list[str]:
    if args.give_up:
        with _held(args) as opened, _refusing(str(args.library)):
            give_up_bringing_back(opened.library.database)
        return ["The library on the server is open to its stations."]
    if args.out is None:
        _refuse("--out", "no folder is named for the library", "Name an empty or new one with --out FOLDER")
    with _held(args) as opened:
        moved = bring_back(opened, args.out, progress, is_copy=args.copy)
    stated = f"{_counted(moved)} are in {args.out}, opened by the same passphrases."
    if args.copy:
        return [stated, "The clinic goes on with the library on the server."]
    return [
        stated,
        "The one on the server is closed to all stations: remove its database and recordings once you are sure.",
    ]


def _status(args: argparse.Namespace, _progress: Report) -> list[str]:
    with opened_library(args) as opened:
        station = opened.library.station
        if station is None or opened.shared is None:
            return [f"{args.library} holds a library of its own."]
        waiting = count_waiting(opened)
        return [
            f"{args.library} is a station of {shown_address(station.database)}.",
            f"Recordings are kept in {opened.shared.place}.",
            f"{waiting} recordings wait here for transfer." if waiting else "All recordings were transferred.",
        ]


@contextmanager
def _held(args: argparse.Namespace) -> Iterator[OpenedLibrary]:
    """Open the library for being moved, and nobody else meanwhile."""
    with opened_library(args, is_to_be_moved=True) as opened, held_alone(opened.folder):
        yield opened


def _address(args: argparse.Namespace) -> str:
    address = args.database or os.environ.get(DATABASE_VARIABLE, "")
    if not address:
        _refuse("--database", "no server is named", f"Give --database {ADDRESS}, or set {DATABASE_VARIABLE}")
    if args.database and "***" in shown_address(driver_url(args.database)):
        what = "the command line is seen by other programs, and holds a password"
        _refuse("--database", what, f"Put it into {DATABASE_VARIABLE} or into your file of passwords, .pgpass")
    return str(address)


def _place(args: argparse.Namespace) -> str:
    if not args.journals:
        _refuse(
            "--journals",
            "no place is named for the recordings",
            "Name a folder that all stations reach, or s3://BUCKET/FOLDER",
        )
    return args.journals if "://" in args.journals else str(Path(args.journals).resolve())


def _counted(moved: Moved) -> str:
    missing = f" ({moved.missing} were missing before)" if moved.missing else ""
    counts = (("patient", moved.patients), ("session", moved.sessions), ("recording", moved.recordings))
    patients, sessions, recordings = (f"{count} {name}{'' if count == 1 else 's'}" for name, count in counts)
    return f"{patients}, {sessions} and {recordings}{missing}"


def _refuse(where: str, what: str, remedy: str) -> NoReturn:
    raise FileRefusedError(where, what, remedy)


@contextmanager
def _refusing(where: str) -> Iterator[None]:
    """Turn a library's refusals into the one line that the command line prints."""
    try:
        yield
    except LibraryError as refusal:
        raise FileRefusedError(where, refusal.what, refusal.remedy) from refusal

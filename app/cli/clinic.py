"""`gaitwright clinic`: a library goes to a server that a clinic's stations share, stations join it, and it comes back.

The server's address comes from `--database` or the environment variable GAITWRIGHT_DATABASE_URL. A password is not
taken from the command line, which other programs can see.
"""

import argparse
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from app.cli.library import add_key_arguments, opened_library
from app.storage.layout import DATABASE_VARIABLE, default_folder, own_folder
from app.system.progress import Report

if TYPE_CHECKING:
    from app.storage.clinic.moving import Moved
    from app.storage.opened import OpenedLibrary

ADDRESS = "postgresql://USER@SERVER/DATABASE"


def add_clinic_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Share one library between the stations of a clinic: rows on PostgreSQL, recordings in a place all reach."
    )
    actions = parser.add_subparsers(title="what to do", metavar="ACTION", dest="action", required=True)
    prepare = actions.add_parser("prepare", help="make or update tables and roles on the server, as its owner")
    _add_database(prepare)
    move = actions.add_parser("move", help="take a library from its folder to the server; the folder becomes a station")
    _add_library(move, own_folder())
    _add_database(move)
    move.add_argument(
        "--journals", metavar="PLACE", help="the place of the recordings: a folder, or s3://BUCKET/FOLDER"
    )
    move.add_argument("--give-up", action="store_true", help="work on with a folder whose move was broken off")
    join = actions.add_parser("join", help="make this computer a station of the library on the server")
    join.add_argument(
        "library", metavar="FOLDER", type=Path, nargs="?", default=default_folder(), help="the station's folder, new"
    )
    _add_database(join)
    join.add_argument("--journals", metavar="PLACE", default="", help="the place, where it has another name here")
    back = actions.add_parser("back", help="bring the library back into a folder, or copy it there")
    _add_library(back)
    back.add_argument("--out", metavar="FOLDER", type=Path, help="the library's new folder")
    back.add_argument(
        "--copy", action="store_true", help="leave the library on the server: a backup that opens by itself"
    )
    back.add_argument("--give-up", action="store_true", help="open the server again after bringing back was broken off")
    status = actions.add_parser("status", help="say where the library is, and what waits here to be handed over")
    _add_library(status)


def clinic(args: argparse.Namespace, progress: Report) -> Iterable[str]:
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
    from app.storage.clinic.joining import prepare_server
    from app.storage.clinic.station import shown_address

    with _refusing(DATABASE_VARIABLE):
        address = _address(args)
        prepare_server(address)
    return [
        f"{shown_address(address)} is ready.",
        "Give each station a login: CREATE ROLE station_1 LOGIN PASSWORD '...' IN ROLE gaitwright_app;",
        "and a screen that only looks one IN ROLE gaitwright_reader.",
    ]


def _move(args: argparse.Namespace, progress: Report) -> list[str]:
    from app.storage.clinic.joining import new_station
    from app.storage.clinic.moving import BEFORE, give_up_moving, move_to_server
    from app.storage.clinic.station import shown_address

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
    from app.storage.clinic.joining import join
    from app.storage.clinic.station import shown_address

    with _refusing(str(args.library)):
        station = join(args.library, _address(args), args.journals)
    return [f"{args.library} is a station of {shown_address(station.database)}. Open Gaitwright and log in as always."]


def _back(args: argparse.Namespace, progress: Report) -> list[str]:
    from app.storage.clinic.moving import bring_back, give_up_bringing_back

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
    from app.storage.clinic.handing_over import count_waiting
    from app.storage.clinic.station import shown_address

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
def _held(args: argparse.Namespace) -> Iterator["OpenedLibrary"]:
    """Open the library for being moved, and nobody else meanwhile."""
    from app.storage.opened import held_alone

    with opened_library(args, is_to_be_moved=True) as opened, held_alone(opened.folder):
        yield opened


def _add_library(parser: argparse.ArgumentParser, folder: Path | None = None) -> None:
    parser.add_argument(
        "library",
        metavar="LIBRARY",
        type=Path,
        nargs="?",
        default=folder or default_folder(),
        help="the library's folder (your own)",
    )
    add_key_arguments(parser)


def _add_database(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--database", metavar="ADDRESS", default="", help=f"{ADDRESS}, else {DATABASE_VARIABLE}")


def _address(args: argparse.Namespace) -> str:
    from app.storage.clinic.station import driver_url, shown_address

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


def _counted(moved: "Moved") -> str:
    missing = f" ({moved.missing} were missing before)" if moved.missing else ""
    counts = (("patient", moved.patients), ("session", moved.sessions), ("recording", moved.recordings))
    patients, sessions, recordings = (f"{count} {name}{'' if count == 1 else 's'}" for name, count in counts)
    return f"{patients}, {sessions} and {recordings}{missing}"


def _refuse(where: str, what: str, remedy: str) -> NoReturn:
    from devices.files.refusal import FileRefusedError

    raise FileRefusedError(where, what, remedy)


@contextmanager
def _refusing(where: str) -> Iterator[None]:
    """Turn a library's refusals into the one line that the command line prints."""
    from app.storage.stored import LibraryError
    from devices.files.refusal import FileRefusedError

    try:
        yield
    except LibraryError as refusal:
        raise FileRefusedError(where, refusal.what, refusal.remedy) from refusal

"""What each subcommand takes from the command line. Nothing here imports what computes; see `arguments`."""

import argparse
import math
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from app.cli.arguments import (
    ADDRESS,
    AGREEMENT,
    DECIMALS,
    DEFAULT_TAU_S,
    DIFFERENCES,
    EMULATED,
    ENCODINGS,
    EXAMPLE,
    EXPORTED,
    FORCE_UNITS,
    IMPORTED,
    KINDS,
    LOCALES,
    METHODS,
    MODELS,
    OF_LIBRARY,
    ON_TERMINAL,
    ONE_SESSION,
    PAPERS,
    PASSPHRASE_FILE,
    RATE_UNITS,
    SEPARATORS,
    TIME_UNITS,
    TYPED,
    WHO,
    LibrarySession,
    imported_format,
    limit_of,
    line_number,
    one_of,
    positive,
    separator,
    session_place,
    three_columns,
    worker_count,
)
from app.storage.layout import DATABASE_VARIABLE, default_folder, own_folder
from app.system.logs import version_of
from app.wording.translation import languages

REFUSED = 2


class Parser(argparse.ArgumentParser):
    """The command line's, and each subcommand's."""

    def error(self, message: str) -> NoReturn:
        """Refuse in one line, as everything else is refused."""
        plain = message.removeprefix("argument : ")  # the list of subcommands has no name
        self.exit(REFUSED, f"{self.prog}: {plain}. See {self.prog} --help.\n")


def parser() -> Parser:
    """Everything that the command line takes; `args.subcommand` is one of `SUBCOMMANDS`."""
    whole = Parser(
        prog="gaitwright",
        description="Knee and ankle angles from inertial sensors worn in any orientation. "
        "Without a subcommand the window opens, with a session folder if one is named.",
        epilog="Research use. Not a medical device.",
    )
    whole.add_argument("--version", action="version", version=f"gaitwright {version_of('gaitwright')}")
    add_language(whole)
    commands = whole.add_subparsers(title="subcommands", metavar="", dest="subcommand", required=True)
    for name, (what, add_arguments) in SUBCOMMANDS.items():
        add_arguments(commands.add_parser(name, help=what))
    return whole


def add_language(parser: argparse.ArgumentParser) -> None:
    """The one option that comes before a subcommand."""
    parser.add_argument(
        "--lang",
        choices=languages(),
        default="",
        help="the language of the window, kept for its next start, and of reports and findings",
    )


def _add_analyse(parser: argparse.ArgumentParser) -> None:
    parser.description = "Compute knee and ankle angles of a session and write them as a folder of results."
    _add_session(parser, "the session folder, or library:ID for one of the library")
    parser.add_argument("--out", metavar="OUT", type=Path, required=True, help="the folder of results to write")
    _add_choices(
        parser,
        method="how joints are identified and which angle is the result (robust)",
        tau="time constant of the published fusion in seconds (2)",
        no_report="write neither report.pdf nor results.xlsx",
    )
    _add_form(parser)


def _add_form(parser: argparse.ArgumentParser) -> None:
    """How the tables are written for a spreadsheet; without them as ever."""
    parser.add_argument(
        "--sep",
        type=separator,
        metavar="SEP",
        help=f"what separates the cells of CSV tables: {', '.join(SEPARATORS)} (comma; with --locale de, semicolon)",
    )
    parser.add_argument(
        "--locale",
        type=one_of(tuple(LOCALES)),
        default="en",
        metavar="LOCALE",
        help="whose decimal sign CSV tables have: en, a point (the default), or de, a comma",
    )


def _add_choices(parser: argparse.ArgumentParser, *, method: str, tau: str, no_report: str) -> None:
    """How a session is analysed and what is written of it, with the help on three of them."""
    words = f"{{{','.join(METHODS)}}}"
    parser.add_argument("--method", type=one_of(METHODS), default=METHODS[0], metavar=words, help=method)
    parser.add_argument("--tau", type=positive, default=DEFAULT_TAU_S, metavar="S", help=tau)
    parser.add_argument("--no-report", action="store_true", help=no_report)
    parser.add_argument("--no-rrd", action="store_true", help="write no session.rrd for Rerun")


def _add_demo(parser: argparse.ArgumentParser) -> None:
    parser.description = "Simulate a patient with known angles, write the session and analyse it. The data are marked."
    parser.add_argument(
        "--out",
        metavar="OUT",
        type=Path,
        default=Path("gaitwright-demo"),
        help="the folder to write: OUT/session and its results in OUT (./gaitwright-demo)",
    )


def _add_report(parser: argparse.ArgumentParser) -> None:
    parser.description = "Analyse a session and make its report: one walk, or up to three conditions beside each other."
    _add_session(parser, ONE_SESSION, metavar="SESSION|OUT")
    parser.add_argument("--out", metavar="FILE.pdf", type=Path, required=True, help="the report to write")
    parser.add_argument(
        "--walk",
        metavar="NAME",
        action="append",
        default=[],
        help="a walk to show; up to three are compared, the last is shown (of each condition, most strides)",
    )
    parser.add_argument("--earlier", metavar="SESSION", type=session_place, help="a visit to compare with")
    parser.add_argument("--comment", metavar="FILE", type=Path, help="the clinician's words, a text in UTF-8")
    parser.add_argument("--paper", type=one_of(PAPERS), default=PAPERS[0], metavar="PAPER", help=" | ".join(PAPERS))


def _add_compare(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "List the differences between the conditions of a session, or between sessions, and which of them are inside "
        "the measurement error."
    )
    help_text = (
        "session folders, results with their session inside, or library:ID; the first is what others differ from"
    )
    parser.add_argument("sessions", metavar="SESSION", type=session_place, nargs="+", help=help_text)
    _add_library(parser)
    parser.add_argument(
        "--limit",
        metavar="COLUMN=VALUE",
        type=limit_of,
        action="append",
        default=[],
        help="a change that matters, such as knee_range_deg=5: in how many of 10 such measurements it is as large",
    )
    parser.add_argument("--out", metavar="OUT", type=Path, required=True, help=f"the folder for {DIFFERENCES}")
    _add_form(parser)


def _add_agree(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Compare the angles, events and stride lengths of a session with an optical system. Its clock and signs are "
        "found from the rates."
    )
    parser.add_argument("session", metavar="SESSION", type=session_place, help=ONE_SESSION)
    parser.add_argument(
        "--reference",
        metavar="FILE",
        type=Path,
        action="append",
        required=True,
        help="CSV with time_s and left_knee ... in degrees, OpenSim .mot, C3D, or Visual3D's text; to be given again "
        "for each further file",
    )
    _add_library(parser)
    parser.add_argument("--out", metavar="OUT", type=Path, required=True, help="the folder of the agreement to write")
    parser.add_argument("--no-report", action="store_true", help=f"write no {AGREEMENT}")


def _add_export(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Analyse a session and write its results for other programs: a spreadsheet, C3D, OpenSim's mot, a FHIR R4 "
        "bundle; or what its sensors measured, as BIDS-Motion. Names are taken away unless identity is asked for."
    )
    _add_session(parser, ONE_SESSION)
    parser.add_argument("--as", dest="formats", metavar="FORMAT,...", required=True, help=", ".join(EXPORTED))
    parser.add_argument(
        "--keep",
        metavar="WHAT,...",
        default="",
        help=f"without identity, what was typed freely and leaves all the same: {', '.join(TYPED)}",
    )
    parser.add_argument(
        "--model",
        type=one_of(MODELS),
        default=MODELS[0],
        metavar="MODEL",
        help=f"whose coordinates a mot has: {' | '.join(MODELS)}, whose knee flexion is negative ({MODELS[0]})",
    )
    parser.add_argument("--identified", action="store_true", help="leave code, notes, operator and dates as they are")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--out", metavar="OUT", type=Path, help="an empty or new folder")
    where.add_argument(
        "--preview", action="store_true", help="write nothing; say all that would leave without identity"
    )


def _add_import(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Make one recording of files of another program and add it to a session folder. What a table does not show by "
        "its names and values can be stated: the options from --encoding on, for all files alike. Columns are given by "
        "name or by number from 1. --preview shows how tables are read."
    )
    parser.add_argument("files", metavar="FILES", type=Path, nargs="+", help="the files of one recording")
    parser.add_argument(
        "--as",
        dest="format",
        type=imported_format,
        metavar="FORMAT",
        help=f"{', '.join(IMPORTED)}, or one that another package brings; without it, recognised by the content",
    )
    parser.add_argument(
        "--map",
        metavar="SITE=FILE_OR_SENSOR_ID,...",
        help="where each sensor was worn: left_thigh, left_shank, left_foot, right_thigh, right_shank, right_foot, "
        "pelvis; or a mapping file of OpenSense (myIMUMappings.xml), whose names state it",
    )
    parser.add_argument(
        "--one-receiver",
        action="store_true",
        help="the sensors shared one receiver, which gave all their times, though the files do not state it",
    )
    parser.add_argument(
        "--split-at",
        type=positive,
        action="append",
        metavar="SECONDS",
        help="make two recordings: split so long after the first sample, or where a clock restarts or jumps, or all "
        "sensors pause, within half a second of it; may be given several times",
    )
    parser.add_argument("--kind", type=one_of(KINDS), default="walking", metavar="KIND", help=" | ".join(KINDS))
    parser.add_argument("--recording", metavar="NAME", help='the name of the recording ("walk 1" and so on)')
    parser.add_argument("--rate", type=positive, metavar="HZ", help="samples per second, if not in the files")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--out", metavar="SESSION", type=Path, help="the session folder, new or not; --map is needed")
    where.add_argument("--preview", action="store_true", help="write nothing; show how each table is read, and why not")
    _add_table(parser)


def _add_table(parser: argparse.ArgumentParser) -> None:
    """What may be stated of a table."""
    parser.add_argument("--encoding", type=one_of(ENCODINGS), metavar="NAME", help=" | ".join(ENCODINGS))
    parser.add_argument(
        "--header-line", type=line_number, metavar="N", help="the line with the names of the columns, from 1; 0: none"
    )
    parser.add_argument("--separator", type=one_of(tuple(SEPARATORS)), metavar="NAME", help=" | ".join(SEPARATORS))
    parser.add_argument("--decimal", type=one_of(tuple(DECIMALS)), metavar="SIGN", help=" | ".join(DECIMALS))
    parser.add_argument("--acc", type=three_columns, metavar="X,Y,Z", help="the columns of acceleration, or none")
    parser.add_argument("--acc-unit", type=one_of(FORCE_UNITS), metavar="UNIT", help=" | ".join(FORCE_UNITS))
    parser.add_argument("--gyr", type=three_columns, metavar="X,Y,Z", help="the columns of angular rate, or none")
    parser.add_argument("--gyr-unit", type=one_of(RATE_UNITS), metavar="UNIT", help=" | ".join(RATE_UNITS))
    parser.add_argument("--time", metavar="COLUMN", help="the column of times; none: samples are even, see --rate")
    parser.add_argument(
        "--time-unit",
        type=one_of(TIME_UNITS),
        metavar="UNIT",
        help=f"{' | '.join(TIME_UNITS)}; count: samples are counted, clock: texts such as 23:59:59.990 or ISO 8601",
    )
    parser.add_argument(
        "--sensor-column", metavar="COLUMN", help="the column that names the sensor of each row, or none"
    )


def _add_batch(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Analyse every session under a folder, each into a folder of its own in OUT, as analyse does, and write "
        "OUT/parameters.csv and .parquet: a row for each walk and side, with the data quality of each figure. Given "
        "again, the same command goes on: what is done and has not changed is not done again, what failed is tried "
        "again. Sessions that fail are listed in OUT/failures.csv."
    )
    parser.add_argument(
        "folder",
        metavar="FOLDER|library",
        type=Path,
        help="the folder that holds session folders, however deep, or the word library: all sessions of the library, "
        "whose results leave it with identity",
    )
    _add_library(parser)
    parser.add_argument("--out", metavar="OUT", type=Path, required=True, help="the folder of the batch")
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers", metavar="N", type=worker_count, help="processes of this computer (as many as it has processors)"
    )
    where.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="the scheduler of a Dask cluster of your own, such as tcp://192.0.2.1:8786. FOLDER and OUT have to be on "
        "a disk that all its workers see under the same path, and all need this version",
    )
    _add_choices(
        parser,
        method="as of analyse (robust)",
        tau="as of analyse (2)",
        no_report="write neither report.pdf nor results.xlsx, which take half of the time",
    )
    parser.set_defaults(stopped="What is done stays in OUT. Give the same command again to go on.")


def _add_repeatability(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Find by how much repeated measurements of healthy people differ in your clinic, from people whose sensors "
        "were attached twice: in two sessions of one patient code, or in one session (attached again before a "
        "recording). Prints each figure with 95 % limits beside the published one. Needs 5 people, 20 are recommended."
    )
    parser.add_argument(
        "folder",
        metavar="FOLDER|library",
        type=Path,
        help="the folder that holds session folders, however deep, or the word library: of the library's sessions "
        "the walks with the condition repeatability",
    )
    _add_library(parser)
    parser.add_argument(
        "--out",
        metavar="OUT",
        type=Path,
        help="the folder for repeatability.json, which the application can use in place of the published figures, and "
        "repeatability.csv",
    )
    parser.set_defaults(stopped="Nothing was written.")


def _add_clinic(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Share one library between the stations of a clinic: rows on PostgreSQL, recordings in a place all reach."
    )
    parser.set_defaults(library=default_folder(), out="What was on the way")
    actions = parser.add_subparsers(title="what to do", metavar="ACTION", dest="action", required=True)
    prepare = actions.add_parser("prepare", help="make or update tables and roles on the server, as its owner")
    _add_database(prepare)
    move = actions.add_parser("move", help="take a library from its folder to the server; the folder becomes a station")
    _add_station(move, own_folder())
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
    _add_station(back)
    back.add_argument("--out", metavar="FOLDER", type=Path, help="the library's new folder")
    back.add_argument(
        "--copy", action="store_true", help="leave the library on the server: a backup that opens by itself"
    )
    back.add_argument("--give-up", action="store_true", help="open the server again after bringing back was broken off")
    status = actions.add_parser("status", help="say where the library is, and what waits here to be handed over")
    _add_station(status)


def _add_query(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Answer a question in SQL (that of DuckDB) over the table of a batch, which is called parameters. It is only "
        f'read, and nothing else can be. For example: "{EXAMPLE}".'
    )
    parser.add_argument("sql", metavar="SQL", nargs="?", default="", help="one SELECT")
    parser.add_argument(
        "--in",
        dest="table",
        metavar="PARQUET",
        type=Path,
        required=True,
        help="the parameters.parquet of a batch, or the folder that holds it",
    )
    parser.add_argument("--out", dest="csv", metavar="CSV", type=Path, help="the CSV file to write (the terminal)")
    parser.add_argument("--columns", action="store_true", help="list the columns of the table instead")
    parser.set_defaults(out=ON_TERMINAL)


def _add_recover(parser: argparse.ArgumentParser) -> None:
    parser.description = "Find recordings that ended without being stopped, close them, and say what is in them."
    parser.add_argument("library", metavar="LIBRARY", type=Path, nargs="?", default=default_folder(), help=OF_LIBRARY)
    _add_key(parser)
    parser.add_argument(
        "--into",
        type=LibrarySession.parsed,
        metavar="SESSION",
        help="the session (library:ID) for recordings that belong to none",
    )
    parser.set_defaults(out="What was not yet recovered")


def _add_audit(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Follow the audit of a library from its beginning, and print how far it goes. That line, kept elsewhere, shows "
        "later whether the end is missing."
    )
    parser.add_argument("library", metavar="LIBRARY", type=Path, nargs="?", default=default_folder(), help=OF_LIBRARY)
    _add_key(parser)
    parser.add_argument("--since", metavar="LINE", default="", help="what this command printed an earlier time")
    parser.set_defaults(out="The audit")


def _add_devices(parser: argparse.ArgumentParser) -> None:
    parser.description = "List the sensors found at ports and on the network, and how each driver was tested."
    parser.add_argument(
        "--emulate",
        type=one_of(EMULATED),
        metavar="{" + ",".join(EMULATED) + "}",
        help="play sensors that are not there instead, and print their ports",
    )
    parser.add_argument(
        "--streams",
        nargs="?",
        const="127.0.0.1",
        default="",
        metavar="ADDRESS",
        help="ask for streams, too: on this computer, or in the network where it has this address",
    )
    parser.add_argument(
        "--count", type=int, default=6, metavar="N", help="how many are played (6); the seventh is on the pelvis"
    )
    parser.add_argument(
        "--seconds", type=positive, default=math.inf, metavar="S", help="for how long they are played (until Ctrl C)"
    )
    parser.set_defaults(out="The port of an emulated sensor")


SUBCOMMANDS: dict[str, tuple[str, Callable[[argparse.ArgumentParser], None]]] = {
    "analyse": ("compute the angles of a session", _add_analyse),
    "demo": ("simulate a patient and analyse the session", _add_demo),
    "report": ("make the report of a session as a PDF", _add_report),
    "compare": ("list what differs between conditions or sessions", _add_compare),
    "agree": ("compare the angles of a session with an optical system", _add_agree),
    "export": ("write results for other programs", _add_export),
    "import": ("add recordings of another program to a session", _add_import),
    "batch": ("analyse all sessions of a folder or of the library", _add_batch),
    "repeatability": ("find your clinic's own error figures", _add_repeatability),
    "clinic": ("share a library between the stations of a clinic", _add_clinic),
    "query": ("ask the table of a batch in SQL", _add_query),
    "recover": ("close recordings that were interrupted", _add_recover),
    "audit": ("see whether a library's audit was changed", _add_audit),
    "devices": ("list the sensors found, and how drivers were tested", _add_devices),
}


def _add_session(parser: argparse.ArgumentParser, help_text: str, metavar: str = "SESSION") -> None:
    parser.add_argument("session", metavar=metavar, type=session_place, help=help_text)
    _add_library(parser)


def _add_library(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--library", metavar="LIBRARY", type=Path, default=default_folder(), help=OF_LIBRARY)
    _add_key(parser)


def _add_key(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(WHO, metavar="CODE", default="", help="who opens the library, if there are several operators")
    parser.add_argument(
        PASSPHRASE_FILE, metavar="FILE", type=Path, help="the passphrase is its first line; else it is asked for"
    )


def _add_station(parser: argparse.ArgumentParser, folder: Path | None = None) -> None:
    parser.add_argument(
        "library",
        metavar="LIBRARY",
        type=Path,
        nargs="?",
        default=folder or default_folder(),
        help="the library's folder (your own)",
    )
    _add_key(parser)


def _add_database(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--database", metavar="ADDRESS", default="", help=f"{ADDRESS}, else {DATABASE_VARIABLE}")

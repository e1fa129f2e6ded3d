"""`gaitwright import`: a recording of another program, added to a session folder."""

import argparse
from pathlib import Path

from app.cli.progress import finding_lines, one_of, positive
from app.system.progress import Report

# as core.session.RecordingKind and devices.files.formats have them, whose imports would cost half a second here
KINDS = ("standing", "free_motion", "walking")
FORMATS = (
    *("xsens-mtmanager", "movella-dot", "xsens-mti", "ximu3", "shimmer", "mvnx", "apdm", "opensim", "bids-motion"),
    *("xdf", "matlab", "parquet", "csv"),
)


def add_import_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = "Make one recording of files of another program and add it to a session folder."
    parser.add_argument("files", metavar="FILES", type=Path, nargs="+", help="the files of one recording")
    parser.add_argument(
        "--as",
        dest="format",
        type=one_of(FORMATS),
        metavar="FORMAT",
        help=f"{', '.join(FORMATS)}; without it, recognised by the content",
    )
    parser.add_argument(
        "--map",
        required=True,
        metavar="SITE=FILE_OR_SENSOR_ID,...",
        help="where each sensor was worn: left_thigh, left_shank, left_foot, right_thigh, right_shank, right_foot",
    )
    parser.add_argument("--kind", type=one_of(KINDS), default="walking", metavar="KIND", help=" | ".join(KINDS))
    parser.add_argument("--recording", metavar="NAME", help='the name of the recording ("walk 1" and so on)')
    parser.add_argument("--rate", type=positive, metavar="HZ", help="samples per second, if not in the files")
    parser.add_argument("--out", metavar="SESSION", type=Path, required=True, help="the session folder, new or not")


def import_files(args: argparse.Namespace, progress: Report) -> list[str]:
    """Add the recording and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        The files are not what they should be, or do not fit the session.
    OSError
        The session cannot be written.
    """
    from app.importing.untrusted_files import read_foreign_session, read_foreign_trial, write_over_session
    from core.session import Recording, RecordingKind, Session
    from devices.files.imports import add_recording, folder_for, free_name, parse_map, place_trial

    kind = RecordingKind(args.kind)
    placement = parse_map(args.map)
    is_new = not args.out.exists() or (args.out.is_dir() and not any(args.out.iterdir()))
    session = Session(()) if is_new else read_foreign_session(args.out, lambda: progress(0.0, str(args.out)))
    name = args.recording or free_name(session, kind)
    progress(0.0, name)
    trial = read_foreign_trial(args.format or "", args.files, args.rate, lambda: progress(0.0, name))
    imported = place_trial(trial, placement, name)
    recording = Recording(name, kind, folder_for(name), imported.imu)
    session = add_recording(session, recording, imported.sensors, imported.findings, imported.is_simulated)
    progress(0.5, str(args.out))
    write_over_session(session, args.out)
    held = f"{args.out} now holds {name}, with {len(imported.imu)} of 6 sites."
    return [held, *finding_lines(imported.findings, lowest="info")]

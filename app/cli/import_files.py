"""`gaitwright import`: a recording of another program, added to a session folder."""

import argparse
from pathlib import Path

from app.cli.progress import finding_lines
from app.importing.untrusted_files import read_foreign_session, read_foreign_trial, write_over_session
from app.system.progress import Report
from app.system.tables import is_free
from core.body import LEG_SITES, Site
from core.session import Recording, RecordingKind, Session
from devices.files.imports import add_recording, folder_for, free_name, mapped_sites, parse_map, place_trial


def run(args: argparse.Namespace, progress: Report) -> list[str]:
    """Add the recording and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        The files are not what they should be, or do not fit the session.
    OSError
        The session cannot be written.
    """
    kind = RecordingKind(args.kind)
    mapping = Path(args.map) if "=" not in args.map and args.map.lower().endswith(".xml") else None
    placement = parse_map(args.map) if mapping is None else {}
    files = args.files if mapping is None else [*args.files, mapping]
    session = Session(()) if is_free(args.out) else read_foreign_session(args.out, lambda: progress(0.0, str(args.out)))
    name = args.recording or free_name(session, kind)
    progress(0.0, name)
    trial = read_foreign_trial(args.format or "", files, args.rate, lambda: progress(0.0, name))
    imported = place_trial(trial, placement or mapped_sites(trial), name, is_one_receiver=args.one_receiver)
    recording = Recording(name, kind, folder_for(name), imported.imu)
    session = add_recording(session, recording, imported.sensors, imported.findings, imported.is_simulated)
    progress(0.5, str(args.out))
    write_over_session(session, args.out)
    sites = len(Site) if Site.PELVIS in imported.imu else len(LEG_SITES)
    held = f"{args.out} now holds {name}, with {len(imported.imu)} of {sites} sites."
    return [held, *finding_lines(imported.findings, lowest="info")]

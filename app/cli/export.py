"""`gaitwright export`: the results of a session for other programs, without names unless identity is asked for."""

import argparse
from collections.abc import Sequence

from app.cli.arguments import LibrarySession
from app.cli.library import opened_library
from app.exports.exports import (
    Format,
    export_from_folder,
    export_from_library,
    preview_from_folder,
    preview_from_library,
)
from app.exports.opensim_motion import Model
from app.exports.result_folder import session_of, written_beside
from app.importing.untrusted_files import read_foreign_session
from app.storage.pseudonyms import Typed
from app.system.progress import Report
from app.system.tables import is_free
from core.analysis import analyse
from devices.decoders import DECODERS
from devices.files.refusal import FileRefusedError, one_line


def run(args: argparse.Namespace, report: Report) -> list[str]:
    """Write the formats asked for and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        No such format, nothing that could be kept, a session that cannot be read, or something is at OUT.
    OSError
        The files cannot be written.
    """
    formats = [Format(name) for name in _chosen("--as", args.formats, tuple(Format), "is no format")]
    kept = [Typed(name) for name in _chosen("--keep", args.keep, tuple(Typed), "is not among what is typed")]
    if args.identified and (kept or args.preview):
        raise FileRefusedError(
            "--identified", "data that identify the patient are exported unchanged", "Omit --keep and --preview"
        )
    if args.preview:
        return _preview(args, kept)
    if not is_free(args.out):
        raise FileRefusedError(
            str(args.out), "this already exists and is not an empty folder", "Choose an empty folder or a new one"
        )
    identified, model = args.identified, Model(args.model)
    with written_beside(args.out) as folder:
        if isinstance(args.session, LibrarySession):
            with opened_library(args) as opened:
                lines = export_from_library(
                    *(opened, args.session.id, formats, folder, DECODERS, report),
                    kept=kept,
                    is_identified=identified,
                    model=model,
                )
        else:
            session = read_foreign_session(session_of(args.session), lambda: report(0.0, str(args.session)))
            analysis = analyse(session, progress=report)
            lines = export_from_folder(
                session, analysis, formats, folder, kept=kept, is_identified=identified, model=model
            )
        count = sum(path.is_file() for path in folder.rglob("*"))
    whose = "with identity" if args.identified else "pseudonymised"
    return [f"{args.out}: {count} {'file' if count == 1 else 'files'}, {whose}.", *lines]


def _chosen(option: str, stated: str, known: Sequence[str], what: str) -> list[str]:
    """Split an option into its words, each once; raises FileRefusedError for an unknown one."""
    names = list(dict.fromkeys(filter(None, stated.split(","))))
    for name in names:
        if name not in known:
            raise FileRefusedError(option, f"{one_line(name)} {what}", f"Choose of: {', '.join(known)}")
    return names


def _preview(args: argparse.Namespace, kept: Sequence[Typed]) -> list[str]:
    """Lines with all that would leave beside the figures; raises as `export`."""
    if isinstance(args.session, LibrarySession):
        with opened_library(args) as opened:
            rows = preview_from_library(opened, args.session.id, kept)
    else:
        rows = preview_from_folder(read_foreign_session(session_of(args.session), lambda: None), kept)
    reported = [f"{name}: {one_line(str(value))}" for name, value in rows]
    return [*reported, "And angles, events, strides and averages of these recordings. Nothing was written."]

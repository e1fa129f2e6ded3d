"""How do results leave for another program? In the formats asked for, without names unless identity is asked for."""

import shutil
import tempfile
from collections.abc import Callable, Sequence
from enum import StrEnum
from importlib.util import find_spec
from pathlib import Path
from uuid import UUID

from app.exports.nameless import nameless, nameless_once
from app.storage.audit import about
from app.storage.exchange import session_with_samples
from app.storage.journal.decoding import Decoders
from app.storage.opened import OpenedLibrary, Report
from app.storage.pseudonyms import Pseudonyms
from app.storage.stored import Action
from core.analysis import analyse
from core.results import Analysis, RecordingAnalysis
from core.samples import Session
from devices.files.refusal import FileRefusedError


class Format(StrEnum):
    XLSX = "xlsx"
    C3D = "c3d"
    MOT = "mot"
    FHIR = "fhir"


SPREADSHEET, BUNDLE = "gaitwright.xlsx", "fhir_bundle.json"
NEEDED = {Format.XLSX: "openpyxl", Format.C3D: "ezc3d"}  # libraries of the extra `exports`


def check_formats(formats: Sequence[Format]) -> None:
    """See whether the libraries that these formats need are there.

    Raises
    ------
    FileRefusedError
        One is not installed.
    """
    for wanted in formats:
        if wanted in NEEDED and find_spec(NEEDED[wanted]) is None:
            raise FileRefusedError(
                wanted,
                "this format needs {library}, which is not installed",
                "Install gaitwright[exports]",
                library=NEEDED[wanted],
            )


def export_from_folder(
    session: Session, analysis: Analysis, formats: Sequence[Format], folder: Path, *, is_identified: bool = False
) -> None:
    """Write a session that is in no library into `folder`, which is there: whole, or not at all.

    Raises
    ------
    FileRefusedError
        A library is missing, a recording is too long for a format, or a folder stands where a file should.
    OSError
        The files cannot be written.
    """
    check_formats(formats)
    if not is_identified:
        session, analysis = nameless_once(session, analysis)
    _write(session, analysis, formats, folder)


def export_from_library(
    opened: OpenedLibrary,
    session_id: UUID,
    formats: Sequence[Format],
    folder: Path,
    decoders: Decoders,
    report: Report,
    *,
    analysed: Callable[[Session], Analysis] = analyse,
    is_identified: bool = False,
) -> None:
    """Analyse a session of a library and write it; the audit says which formats before anything is written.

    Raises
    ------
    LibraryError
        There is no such session, or the export cannot be noted.
    JournalRefusedError
        A recording cannot be read.
    FileRefusedError, OSError
        As in `export_from_folder`.
    """
    check_formats(formats)
    visit = opened.library.sessions.get(session_id)
    for wanted in formats:
        opened.library.audit.note(
            Action.EXPORT, about("session", session_id), format=str(wanted), is_identified=is_identified
        )
    session = session_with_samples(opened, visit, decoders, report)
    report(0.5, "analysing")
    analysis = analysed(session)
    if not is_identified:
        session, analysis = nameless(Pseudonyms(opened.library.pseudonyms_key), visit.patient_id, session, analysis)
    report(1.0, "writing")
    _write(session, analysis, formats, folder)


def _write(session: Session, analysis: Analysis, formats: Sequence[Format], folder: Path) -> None:
    """Write beside, then move each file into its place, so that none is half there."""
    with tempfile.TemporaryDirectory(prefix=".export-", dir=folder) as beside:
        for wanted in formats:
            _write_format(session, analysis, wanted, Path(beside))
        for file in sorted(path for path in Path(beside).rglob("*") if path.is_file()):
            place = folder / file.relative_to(beside)
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.move(file, place)


def _write_format(session: Session, analysis: Analysis, wanted: Format, folder: Path) -> None:
    # here, not above: two of them need libraries that may be missing
    if wanted is Format.XLSX:
        from app.exports.spreadsheet import write_spreadsheet

        write_spreadsheet(session, analysis, folder / SPREADSHEET)
    elif wanted is Format.FHIR:
        from app.exports.fhir_bundle import write_bundle

        write_bundle(session, analysis, folder / BUNDLE)
    elif wanted is Format.C3D:
        from app.exports.c3d_angles import write_c3d

        for recording in analysis.recordings:
            write_c3d(recording, analysis.is_simulated, _place(recording, folder, "angles.c3d"))
    else:
        from app.exports.opensim_motion import write_motion

        for recording in analysis.recordings:
            write_motion(recording, analysis.is_simulated, _place(recording, folder, "angles.mot"))


def _place(recording: RecordingAnalysis, folder: Path, name: str) -> Path:
    (folder / recording.folder).mkdir(parents=True, exist_ok=True)
    return folder / recording.folder / name

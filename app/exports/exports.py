"""How do results leave for another program? In the formats asked for, without names unless identity is asked for."""

import shutil
import tempfile
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from enum import StrEnum
from importlib.util import find_spec
from pathlib import Path
from uuid import UUID

from app.exports.folder_pseudonyms import pseudonyms_of_folder
from app.exports.pseudonymised import Row, pseudonymised, what_leaves
from app.storage.audit import about
from app.storage.exchange import READ_BACK, session_with_samples
from app.storage.journal.decoding import Decoders
from app.storage.opened import OpenedLibrary, Report
from app.storage.pseudonyms import Pseudonyms, Typed
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
    BIDS = "bids-motion"


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
    session: Session,
    analysis: Analysis,
    formats: Sequence[Format],
    folder: Path,
    *,
    kept: Collection[Typed] = (),
    is_identified: bool = False,
) -> None:
    """Write a session that is in no library into `folder`, which is there: whole, or not at all.

    Without identity, of what was typed freely only what is `kept` leaves.

    Raises
    ------
    FileRefusedError
        A library is missing, a recording is too long for a format, or a folder stands where a file should.
    OSError
        The files cannot be written.
    """
    check_formats(formats)
    if not is_identified:
        session, analysis = pseudonymised(*pseudonyms_of_folder(session), session, analysis, kept)
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
    kept: Collection[Typed] = (),
    is_identified: bool = False,
) -> None:
    """Analyse a session of a library and write it; the audit says which formats before anything is written.

    Without identity, of what was typed freely only what is `kept` leaves, and the audit names it.

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
        typed = "all" if is_identified else ", ".join(sorted(kept))
        opened.library.audit.note(
            Action.EXPORT, about("session", session_id), format=str(wanted), is_identified=is_identified, typed=typed
        )
    session = session_with_samples(opened, visit, decoders, report)
    report(0.5, "analysing")
    analysis = analysed(session)
    if not is_identified:
        pseudonyms = Pseudonyms(opened.library.pseudonyms_key)
        session, analysis = pseudonymised(pseudonyms, visit.patient_id, session, analysis, kept)
    report(1.0, "writing")
    _write(session, analysis, formats, folder)


def preview_from_folder(session: Session, kept: Collection[Typed] = ()) -> list[Row]:
    """All that `export_from_folder` would tell beside the figures."""
    pseudonyms, patient_id = pseudonyms_of_folder(session)
    return what_leaves(pseudonyms.session(patient_id, session, kept))


def preview_from_library(opened: OpenedLibrary, session_id: UUID, kept: Collection[Typed] = ()) -> list[Row]:
    """All that `export_from_library` would tell beside the figures.

    Raises
    ------
    LibraryError
        There is no such session.
    """
    visit = opened.library.sessions.get(session_id)
    told = replace(visit.details, recordings=tuple(one.details for one in visit.recordings if one.state in READ_BACK))
    return what_leaves(Pseudonyms(opened.library.pseudonyms_key).session(visit.patient_id, told, kept))


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
    elif wanted is Format.BIDS:
        from app.exports.bids_motion import FOLDER, write_bids

        write_bids(session, folder / FOLDER)
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

"""Results for other programs: in the formats asked for, without names unless identity is asked for."""

import logging
import shutil
import tempfile
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from enum import StrEnum
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from uuid import UUID

from app.exports.bids_motion import FOLDER, write_bids
from app.exports.fhir_bundle import write_bundle
from app.exports.folder_pseudonyms import pseudonyms_of_folder
from app.exports.opensim_motion import Model, write_motion
from app.exports.opensim_orientations import write_orientations
from app.exports.pseudonymised import Row, pseudonymised, what_leaves
from app.exports.spreadsheet import write_spreadsheet
from app.storage.audit import about
from app.storage.exchange import READ_BACK, session_with_samples
from app.storage.journal.decoding import Decoders
from app.storage.opened import OpenedLibrary
from app.storage.pseudonyms import Pseudonyms, Typed
from app.storage.stored import Action
from app.system.progress import Report
from app.wording.translation import filled
from core.analysis import analyse
from core.results import Analysis, RecordingAnalysis
from core.session import Session
from devices.files.refusal import FileRefusedError


class Format(StrEnum):
    XLSX = "xlsx"
    C3D = "c3d"
    MOT = "mot"
    STO = "sto"
    FHIR = "fhir"
    BIDS = "bids-motion"


_log = logging.getLogger(__name__)
SPREADSHEET, BUNDLE = "gaitwright.xlsx", "fhir_bundle.json"
NEEDED = {Format.C3D: "ezc3d"}  # libraries of the extra `exports`


def check_formats(formats: Sequence[Format]) -> None:
    """Raise FileRefusedError where a library that one of these formats needs is not installed."""
    for required in formats:
        if required in NEEDED and find_spec(NEEDED[required]) is None:
            raise FileRefusedError(
                required,
                "this format needs {library}, which is not installed",
                "Install gaitwright[exports]",
                library=NEEDED[required],
            )


def export_from_folder(
    session: Session,
    analysis: Analysis,
    formats: Sequence[Format],
    folder: Path,
    *,
    kept: Collection[Typed] = (),
    is_identified: bool = False,
    model: Model = Model.RAJAGOPAL2016,
) -> list[str]:
    """Write an unstored session into an existing folder, each format whole or not at all; give what failed.
    Without identity, only freely typed words in `kept` leave. Raises FileRefusedError, OSError.
    """
    check_formats(formats)
    if not is_identified:
        session, analysis = pseudonymised(*pseudonyms_of_folder(session), session, analysis, kept)
    return _write(session, analysis, formats, folder, model)


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
    model: Model = Model.RAJAGOPAL2016,
) -> list[str]:
    """Analyse and write a session of the library, noted in the audit first; give what failed and why.
    Without identity, only freely typed words in `kept` leave, and the audit names them.
    Raises LibraryError, JournalRefusedError, FileRefusedError or OSError.
    """
    check_formats(formats)
    visit = opened.library.sessions.get(session_id)
    for required in formats:
        typed = "all" if is_identified else ", ".join(sorted(kept))
        opened.library.audit.note(
            Action.EXPORT, about("session", session_id), format=str(required), is_identified=is_identified, typed=typed
        )
    session = session_with_samples(opened, visit, decoders, report)
    report(0.5, "analysing")
    analysis = analysed(session)
    if not is_identified:
        pseudonyms = Pseudonyms(opened.library.pseudonyms_key)
        session, analysis = pseudonymised(pseudonyms, visit.patient_id, session, analysis, kept)
    report(1.0, "writing")
    return _write(session, analysis, formats, folder, model)


def preview_from_folder(session: Session, kept: Collection[Typed] = ()) -> list[Row]:
    """All that `export_from_folder` would disclose beside the figures."""
    pseudonyms, patient_id = pseudonyms_of_folder(session)
    return what_leaves(pseudonyms.session(patient_id, session, kept))


def preview_from_library(opened: OpenedLibrary, session_id: UUID, kept: Collection[Typed] = ()) -> list[Row]:
    """Give all that `export_from_library` discloses besides figures; raises LibraryError."""
    visit = opened.library.sessions.get(session_id)
    reported = replace(
        visit.details, recordings=tuple(one.details for one in visit.recordings if one.state in READ_BACK)
    )
    return what_leaves(Pseudonyms(opened.library.pseudonyms_key).session(visit.patient_id, reported, kept))


def _write(session: Session, analysis: Analysis, formats: Sequence[Format], folder: Path, model: Model) -> list[str]:
    """Write each format beside, then move its files into their places, so that none is half there."""
    lines, failed = list[str](), list[FileRefusedError]()
    for required in formats:
        with tempfile.TemporaryDirectory(prefix=".export-", dir=folder) as beside:
            try:
                lines += _write_format(session, analysis, required, Path(beside), model)
            except (OSError, MemoryError):
                raise
            except Exception as error:  # a format's edge: whatever its library raises, the other formats are written
                _log.warning("an export failed", exc_info=error)
                failed.append(
                    FileRefusedError(
                        required,
                        "this format could not be written ({why})",
                        "Choose another format. The log has the details.",
                        why=error,
                    )
                )
                continue
            for file in sorted(path for path in Path(beside).rglob("*") if path.is_file()):
                place = folder / file.relative_to(beside)
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.move(file, place)
    if failed and len(failed) == len(formats):
        raise failed[0]
    return [*(f"{one.where}: {filled(one.what, one.values)}" for one in failed), *lines]


def _write_format(session: Session, analysis: Analysis, required: Format, folder: Path, model: Model) -> list[str]:
    """Write one format, and give a line for each file that is not written."""
    if required is Format.XLSX:
        write_spreadsheet(session, analysis, folder / SPREADSHEET)
    elif required is Format.FHIR:
        write_bundle(session, analysis, folder / BUNDLE)
    elif required is Format.STO:
        lines = write_orientations(session, analysis, folder, f"orientations.{required}")
        return [f"{required}, {line}" for line in lines]
    elif required is Format.BIDS:
        why = write_bids(session, analysis, folder / FOLDER)
        return [f"{required}: {why}"] if why else []
    else:
        if required is Format.C3D:
            from app.exports.c3d_angles import write_c3d  # ezc3d, which may be missing

            write = partial(write_c3d, code=session.patient.code)
        else:
            write = partial(write_motion, model=model)

        found = {
            one.name: write(one, analysis.is_simulated, _place(one, folder, f"angles.{required}"))
            for one in analysis.recordings
        }
        return [f"{name}, {required}: {why}" for name, why in found.items() if why]
    return []


def _place(recording: RecordingAnalysis, folder: Path, name: str) -> Path:
    (folder / recording.folder).mkdir(parents=True, exist_ok=True)
    return folder / recording.folder / name

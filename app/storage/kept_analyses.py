"""Analyses of these very samples that were computed before. They are read, not computed again.

The key is over all that an analysis is given: the samples themselves, what was stated about them, and the program's own
code. An analysis is given nothing else (`bare`), so nothing else can change it.
"""

import hashlib
import logging
from dataclasses import fields, replace
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from uuid import UUID

import numpy as np

from app.storage.analysis_content import FORMAT, DamagedContentError, packed, unpacked
from app.storage.results import Results
from app.storage.stored import AnalysedRecording, AnalysisInputs, LibraryError, ResultKind
from core.body import Site
from core.prosthesis import prostheses_text
from core.results import Analysis
from core.samples import ImuBlock, SensorInfo
from core.session import Patient, Recording, Session
from core.signal.filters import FILTER
from core.timed.protocols import planned_text

_log = logging.getLogger(__name__)

CODE = Path(__file__).parents[2] / "core"
FIGURES_FROM = ("gaitwright", "numpy", "scipy")  # and the filter: another version may give another last bit


def bare(session: Session) -> Session:
    """Give what an analysis reads: no names, notes, conditions, left-out strides (`core.gait.chosen_strides`)."""
    patient, reported = session.patient, session.sensors
    return Session(
        recordings=tuple(
            Recording(
                name=recording.name,
                kind=recording.kind,
                folder=recording.folder,
                imu={site: replace(block, sensor="", unknown={}) for site, block in recording.imu.items()},
                is_kept=recording.is_kept,
                is_restrapped_before=recording.is_restrapped_before,
                test=recording.test,
            )
            for recording in session.recordings
        ),
        patient=Patient(
            affected_side=patient.affected_side,
            prosthetic_side=patient.prosthetic_side,
            prostheses=patient.worn,
        ),
        sensors={
            site: SensorInfo(rate_hz=info.rate_hz, rate_kind=info.rate_kind, clock=info.clock)
            for site, info in reported.items()
        },
        zero_rad=session.zero_rad,
        turned_sign=session.turned_sign,
        is_simulated=session.is_simulated,
        findings=session.findings,
    )


def is_same_question(one: Session, other: Session) -> bool:
    """Whether both give an analysis the very same samples, not only equal ones, and the same details about them."""
    both = (one, other)
    blocks = [[block for recording in session.recordings for block in recording.imu.values()] for session in both]
    if len(blocks[0]) != len(blocks[1]) or any(a is not b for a, b in zip(*blocks, strict=True)):
        return False
    reported = [_reported(session) for session in both]
    return reported[0] == reported[1]


def find_analysis(results: Results, session_id: UUID, session: Session) -> Analysis | None:
    """Give what `analyse(bare(session))` gave, None if not kept or damaged; raises LibraryError."""
    kept = results.find(session_id, ResultKind.ANALYSIS, inputs_of(session))
    if kept is None or kept.format != FORMAT:
        return None
    try:
        return unpacked(kept.content)
    except DamagedContentError:
        _log.warning("a kept analysis is damaged; it is computed again")
        return None


def keep_analysis(results: Results, session_id: UUID, session: Session, analysis: Analysis) -> None:
    """Keep what `analyse(bare(session))` gave. That it cannot be kept is no harm: it is computed again."""
    try:
        results.keep(session_id, ResultKind.ANALYSIS, inputs_of(session), FORMAT, packed(analysis))
    except LibraryError as error:
        _log.info("an analysis was not kept", exc_info=error)


def _reported(session: Session) -> tuple[Session, list[list[Site]]]:
    """What an analysis is given besides the samples, and at which sites they were measured."""
    given = bare(session)
    without_samples = tuple(replace(recording, imu={}) for recording in given.recordings)
    return replace(given, recordings=without_samples), [list(recording.imu) for recording in session.recordings]


def inputs_of(session: Session) -> AnalysisInputs:
    """All that `analyse(bare(session))` depends on."""
    patient = session.patient
    reported: dict[str, str | float | bool | None] = {
        "affected_side": patient.affected_side,
        "prosthetic_side": patient.prosthetic_side,
        "prostheses": prostheses_text(patient.worn),
        "is_simulated": session.is_simulated,
    }
    for site, info in session.sensors.items():
        reported[f"{site} rate_hz"] = info.rate_hz
        reported[f"{site} rate_kind"] = info.rate_kind
        reported[f"{site} clock"] = info.clock
    for number, finding in enumerate(session.findings):
        reported[f"finding {number}"] = repr(finding)
    return AnalysisInputs(
        recordings=tuple(
            AnalysedRecording(
                recording.name,
                recording.folder,
                recording.kind,
                recording.is_kept,
                recording.is_restrapped_before,
                tuple((site, _digest(block)) for site, block in recording.imu.items()),
                planned_text(recording.test),
            )
            for recording in session.recordings
        ),
        zero_rad=session.zero_rad,
        turned_sign=session.turned_sign,
        details=reported,
        algorithm=algorithm(),
        parameters={},
    )


@cache
def algorithm() -> str:
    """Which code computes: versions, and a digest of the core's own source, which changes between versions, too."""
    source = hashlib.sha256()
    for path in sorted(CODE.rglob("*.py")):
        source.update(str(path.relative_to(CODE)).encode() + b"\0" + path.read_bytes() + b"\0")
    versions = [f"{name} {_version(name)}" for name in FIGURES_FROM]
    return ", ".join([*versions, FILTER, f"core {source.hexdigest()}"])


def _version(distribution: str) -> str:
    try:
        return version(distribution)
    except PackageNotFoundError:  # run from its source
        return "not installed"


def _digest(block: ImuBlock) -> str:
    """SHA-256 of all of a block that is measured."""
    digest = hashlib.sha256()
    for field in fields(block):
        value = getattr(block, field.name)
        if isinstance(value, np.ndarray):
            digest.update(f"{field.name} {value.dtype.str} {value.shape}\0".encode())
            digest.update(np.ascontiguousarray(value).data)
    digest.update(f"{block.is_rate_derived}".encode())
    return digest.hexdigest()

"""The rows of a session in the table of a batch: one for each walk and side, figures and what may be stated about each.

Figures, errors and verdicts are those of `summary.json` to the last bit; nothing is judged or rounded here. Nobody's
name is in a row: a patient is a pseudonym, of notes and operators there is nothing, and an age of 90 or more is 90.
"""

import hmac
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum

from app.storage.pseudonyms import SEXES, age_in_words
from app.summary.averages import LegAverages, WalkAverages, averages_of
from app.system.logs import version_of
from app.system.tables import finite
from core.body import Side
from core.parameters import SPEED
from core.results import Analysis
from core.session import Recording, RecordingKind, Session
from core.verdicts.quantities import OF_BOTH, OF_HIPS, PARAMETERS

Row = dict[str, str | float | int | bool | None]

BOTH = "both"
UNNUMBERED = "#"  # before what distinguishes a batch's patients until the table numbers them
WALK_SPEED = "walk_speed_m_s"


class CellKind(StrEnum):
    """What the cells of a column hold."""

    TEXT = "text"
    NUMBER = "number"
    COUNT = "count"
    FLAG = "flag"


GROUPS: Mapping[str, CellKind] = {
    "session": CellKind.TEXT,
    "patient": CellKind.TEXT,
    "walk": CellKind.TEXT,
    "condition": CellKind.TEXT,
    "side": CellKind.TEXT,
    "is_affected": CellKind.FLAG,
    "is_prosthetic": CellKind.FLAG,
    "device": CellKind.TEXT,
    "aids": CellKind.TEXT,
    "sex": CellKind.TEXT,
    "age_years": CellKind.COUNT,
    "height_m": CellKind.NUMBER,
    "mass_kg": CellKind.NUMBER,
    "started": CellKind.TEXT,
    "is_simulated": CellKind.FLAG,
    "software": CellKind.TEXT,
    WALK_SPEED: CellKind.NUMBER,
    f"{WALK_SPEED}_status": CellKind.TEXT,
    "strides_used": CellKind.COUNT,
    "strides_left_out": CellKind.COUNT,
}
OF_BOTH_ONLY = tuple(name for name in OF_BOTH if name not in PARAMETERS)  # a leg alone has no such figure


def _of(names: Iterable[str], *more: str) -> dict[str, CellKind]:
    """Of each figure its own column and those beside it."""
    ends = ("", *more)
    return {name + end: CellKind.TEXT if end == "_status" else CellKind.NUMBER for name in names for end in ends}


COLUMNS: Mapping[str, CellKind] = {
    **GROUPS,
    **_of(PARAMETERS, "_sd", "_error", "_status"),
    **_of(OF_BOTH_ONLY, "_status"),
}
HIP_COLUMNS: Mapping[str, CellKind] = _of(OF_HIPS, "_sd", "_status")  # of a table with a sensor on some pelvis


@dataclass(frozen=True, slots=True)
class ReportedOf:
    """Whose session it is, and of when, as the table reports it: a pseudonym and a date."""

    patient: str
    started: str


def reported_of_folder(session: Session, mark: str) -> ReportedOf:
    """Give what identifies a patient within the batch, keyed with its mark, and the session's day."""
    code = session.patient.code
    if not code:
        return ReportedOf("", session.started[:10])
    digest = hmac.digest(mark.encode(), code.encode("utf-8", "surrogatepass"), "sha256").hex()
    return ReportedOf(f"{UNNUMBERED}{digest}", session.started[:10])


def rows_of(name: str, session: Session, analysis: Analysis, reported: ReportedOf) -> tuple[Row, ...]:
    """The rows of a session: its walks in their order, left, right and both."""
    recordings = {recording.name: recording for recording in session.recordings}
    rows = []
    for walk in (one for one in analysis.recordings if one.kind is RecordingKind.WALKING):
        found = averages_of(walk)
        speed = found.both[SPEED]
        of_walk = {WALK_SPEED: finite(speed.mean), f"{WALK_SPEED}_status": str(speed.assessment.verdict)}
        for side in Side:
            figures = _of_leg(found.legs[side]) if side in found.legs else ()
            rows.append(_groups(name, session, recordings[walk.name], side, reported) | of_walk | dict(figures))
        rows.append(_groups(name, session, recordings[walk.name], BOTH, reported) | of_walk | dict(_of_both(found)))
    return tuple(rows)


def _groups(name: str, session: Session, recording: Recording, part: str, reported: ReportedOf) -> Row:
    patient, is_leg = session.patient, part != BOTH
    age = age_in_words(session)
    return {
        "session": text(name),
        "patient": reported.patient or None,
        "walk": text(recording.name),
        "condition": text(recording.condition),
        "side": part,
        "is_affected": _is_among(part, patient.affected_side) if is_leg else None,
        "is_prosthetic": _is_among(part, patient.prosthetic_side) if is_leg else None,
        "device": text(patient.device),
        "aids": text(patient.aids),
        "sex": patient.sex if patient.sex in SEXES else None,
        "age_years": int(age.removesuffix("+")) if age else None,
        "height_m": patient.height_m,
        "mass_kg": patient.mass_kg,
        "started": text(reported.started),
        "is_simulated": session.is_simulated,
        "software": version_of("gaitwright"),
    }


def _of_both(found: WalkAverages) -> Iterator[tuple[str, str | float | int | None]]:
    for name, average in found.both.items():
        yield name, finite(average.mean)
        yield f"{name}_status", str(average.assessment.verdict)


def _of_leg(found: LegAverages) -> Iterator[tuple[str, str | float | int | None]]:
    yield "strides_used", found.used
    yield "strides_left_out", found.left_out
    for name, average in found.of.items():
        yield name, finite(average.mean)
        yield f"{name}_sd", finite(average.sd)
        if name not in OF_HIPS:
            yield f"{name}_error", finite(average.error)
        yield f"{name}_status", str(average.assessment.verdict)


def _is_among(side: str, reported: str) -> bool | None:
    """Whether a side is meant by left, right, both or none; None where nothing was stated."""
    return reported in (side, BOTH) if reported else None


def text(typed: str) -> str | None:
    """A text as any file can hold it; None where there is none. A file's name may hold bytes that are no text."""
    return typed.encode("utf-8", "backslashreplace").decode() or None

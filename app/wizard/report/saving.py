"""What is to be written from the report step: the report alone, or the results as other programs read them."""

from dataclasses import dataclass

from app.exports.proposed_names import session_name
from app.storage.stored import StoredSession
from app.summary.request import ReportRequest
from core.results import Analysis
from core.session import Session

OTHERS = ("xlsx", "c3d", "mot", "fhir")  # without the patient's name


@dataclass(frozen=True, slots=True)
class Export:
    """What is exported of a session: files by their keys on the page; `kept` of what was typed freely."""

    session: Session
    analysis: Analysis
    request: ReportRequest | None
    chosen: tuple[str, ...]
    kept: frozenset[str]
    letter_language: str


def file_name(stored: StoredSession, what: str = "") -> str:
    """A document's name: the patient's code and the day, and what it is where it is not the report."""
    return f"{session_name(stored.details.patient.code, stored.details.started, what)}.pdf"

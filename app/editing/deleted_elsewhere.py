"""Who deleted a patient or session that is in sight here, and the word to whoever looks at it."""

from typing import TYPE_CHECKING
from uuid import UUID

from app.storage.audit import about
from app.wording.translation import tr

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary


def deleted_by(opened: "OpenedLibrary", patient_id: UUID, session_id: UUID | None = None) -> str:
    """The operator who deleted a patient, or this one session; empty where nobody did."""
    library = opened.library
    if library.patients.get(patient_id).deleted_at is not None:
        subject = about("patient", patient_id)
    elif session_id is not None and library.sessions.get(session_id).deleted_at is not None:
        subject = about("session", session_id)
    else:
        return ""
    entry = library.audit.deletions([subject]).get(subject)
    return entry.operator if entry is not None else tr("another user")


def deletion_message(what: str, by: str) -> tuple[str, str]:
    """Say at this station that what is in sight was deleted at another: what happened, and what to do."""
    return (
        tr("At another workstation, {user} deleted {what}.").format(user=by, what=what),
        tr("To continue, restore the deleted data in Settings within 30 days."),
    )

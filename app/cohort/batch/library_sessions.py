"""The sessions of a library for a batch: read here one after the other, since its key leaves this process for nobody.

A session's samples and words leave the library with its results, so the audit notes it before they are read. Whether a
session is as it was is determined from the library's rows and the digests of its recordings, without opening any of
them.
"""

import hashlib
from collections.abc import Collection, Iterator, Sequence
from uuid import UUID

from app.cohort.batch.rows import ReportedOf
from app.cohort.batch.task import GivenSession
from app.storage.audit import about
from app.storage.exchange import READ_BACK, session_with_samples
from app.storage.journal.header import JournalRefusedError
from app.storage.opened import OpenedLibrary
from app.storage.pseudonyms import Pseudonyms
from app.storage.stored import Action, LibraryError, StoredSession
from app.system.progress import nobody
from devices.decoders import DECODERS
from devices.files.refusal import FileRefusedError


class LibrarySessions:
    """The sessions of an opened library that hold a recording, by their ids."""

    def __init__(self, opened: OpenedLibrary, chosen: Collection[UUID] | None = None) -> None:
        """Only those that are `chosen`, if some are; raises FileRefusedError where there is none."""
        self._opened = opened
        listed = [one for one in opened.library.sessions.list() if chosen is None or one.id in chosen]
        self._ids = {str(one.id): one.id for one in sorted(listed, key=lambda one: one.id) if one.recordings}
        self._without = len(listed) - len(self._ids)
        if not self._ids:
            raise FileRefusedError(
                str(opened.folder), "no session in this library has a recording", "Choose another library"
            )

    @property
    def names(self) -> Sequence[str]:
        return tuple(self._ids)

    def content(self, name: str) -> str:
        """Give a digest of what the library holds of a session; raises FileRefusedError if it is gone."""
        return _content(self._visit(name))

    def session(self, name: str) -> GivenSession:
        """Note in the audit that a session leaves, then read it with samples; raises FileRefusedError."""
        visit, opened = self._visit(name), self._opened
        try:
            opened.library.audit.note(
                Action.EXPORT, about("session", visit.id), format="batch", is_identified=True, typed="all"
            )
            session = session_with_samples(opened, visit, DECODERS, nobody)
        except LibraryError as refusal:
            raise FileRefusedError(name, refusal.what, refusal.remedy) from refusal
        except JournalRefusedError as refusal:
            raise FileRefusedError(refusal.where, refusal.what, refusal.remedy) from refusal
        if not session.recordings:
            raise FileRefusedError(
                name, "no recording of this session can be read", "Recover the recordings of the library first"
            )
        pseudonyms = Pseudonyms(opened.library.pseudonyms_key)
        reported = ReportedOf(
            pseudonyms.code(visit.patient_id, session.is_simulated),
            pseudonyms.shifted(visit.patient_id, session.started)[:10],
        )
        return GivenSession(session, _content(visit), reported)

    def notes(self) -> Iterator[str]:
        if self._without:
            count = f"{self._without} session" if self._without == 1 else f"{self._without} sessions"
            yield f"{count} without a recording left out."

    def _visit(self, name: str) -> StoredSession:
        try:
            return self._opened.library.sessions.get(UUID(name))
        except LibraryError as refusal:
            raise FileRefusedError(name, refusal.what, refusal.remedy) from refusal


def _content(visit: StoredSession) -> str:
    recordings = [
        (one.id, one.details, one.placement, one.state, [(part.file, part.sha256) for part in one.journals])
        for one in visit.recordings
        if one.state in READ_BACK
    ]
    return hashlib.sha256(
        repr((visit.patient_id, visit.details, recordings)).encode("utf-8", "surrogatepass")
    ).hexdigest()

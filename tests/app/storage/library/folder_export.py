"""A session of a library as a session folder, without names or as it is: what is in it can be compared."""

from pathlib import Path
from uuid import UUID

from app.storage.exchange import session_with_samples
from app.storage.journal.decoding import Decoders
from app.storage.opened import OpenedLibrary
from app.storage.pseudonyms import Pseudonyms
from devices.files.session_folder import write_session


def write_folder(
    opened: OpenedLibrary, session_id: UUID, folder: Path, decoders: Decoders, *, is_identified: bool = False
) -> None:
    visit = opened.library.sessions.get(session_id)
    session = session_with_samples(opened, visit, decoders, lambda *_: None)
    if not is_identified:
        session = Pseudonyms(opened.library.pseudonyms_key).session(visit.patient_id, session)
    write_session(session, folder)

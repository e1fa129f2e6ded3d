"""What the storage, a file or a source raised, in two sentences: its classes come with what takes long to load."""

import logging

from app.storage.journal.header import JournalRefusedError
from app.storage.keys import KeyRefusedError
from app.storage.stored import LibraryError
from app.wording.translation import capitalised, filled, tr
from app.workers.refusals import NothingOpenError, Refusal, nothing_open
from devices.files.refusal import FileRefusedError
from devices.live import SourceRefusedError

_log = logging.getLogger(__name__)


def in_two_sentences(error: Exception) -> Refusal:
    """As `refusals.refusal_of`, which is called before any of these classes is loaded, too."""
    if isinstance(error, SourceRefusedError):
        return Refusal(f"{filled(error.what, error.values)}.", f"{filled(error.remedy, error.values)}.")
    if isinstance(error, LibraryError | KeyRefusedError):
        return Refusal(f"{tr(error.what)}.", f"{tr(error.remedy)}.")
    if isinstance(error, JournalRefusedError | FileRefusedError):
        values = error.values if isinstance(error, FileRefusedError) else {}
        where = tr("Where: {place}.").format(place=error.where)  # last: a path is long, and helps the fewest
        return Refusal(f"{capitalised(filled(error.what, values))}.", f"{filled(error.remedy, values)}. {where}")
    if isinstance(error, NothingOpenError):
        return nothing_open()
    _log.error("a call of the library ended early", exc_info=error)
    if isinstance(error, OSError):
        what = tr("A file could not be read or written ({why}).").format(why=error.strerror or type(error).__name__)
        return Refusal(what, tr("Check the disk and the folder's permissions, then try again."))
    return Refusal(tr("The task stopped before it was finished."), tr("Try again. See the log for details."))

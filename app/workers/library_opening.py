"""Steps between a key and an open library: somebody logged in, what is overdue, a demonstration's patients."""

import logging
from datetime import datetime
from pathlib import Path

from app.storage.backup import remove_old_backups
from app.storage.keyring_slot import remember
from app.storage.keys import KeyRefusedError
from app.storage.library import DEMONSTRATOR, Library
from app.storage.opened import OpenedLibrary, slots_of
from app.storage.retention import destroy_overdue
from app.storage.stored import Role
from app.storage.videos.destroying import finish_destroying
from app.storage.videos.recovery import recover_clips
from app.storage.videos.retention import destroy_overdue_clips

BACKUP_FOLDER = "backup_folder"  # the library's setting that names where its backups are

_log = logging.getLogger(__name__)


def let_keyring_remember(library: OpenedLibrary) -> None:
    """Let the keyring open the library next time; where it does not take the key, the passphrase goes on doing so."""
    operator = library.library.operator
    if library.data_key is None or operator is None:
        return
    try:
        remember(slots_of(library.folder), library.data_key, operator.code)
    except KeyRefusedError as refusal:
        _log.warning("the keyring takes no key", exc_info=refusal)


def demonstration(folder: Path) -> OpenedLibrary:
    """The demonstration's library with its patients, whose visits are recorded once it is open."""
    from app.demonstration import patients, recording  # SciPy comes with them, which a log in does not wait for

    library = OpenedLibrary(Library.create(folder, None, DEMONSTRATOR), folder, None)
    try:
        recording.add_patients(library, patients.simulated_patients(datetime.now().astimezone()))
    except BaseException:
        library.library.close()
        raise
    return library


def tidy(library: OpenedLibrary) -> None:
    operator = library.library.operator
    if operator is None or operator.role is Role.VIEWER:
        return
    library.library.write_journal_headers(library.folder)
    destroyed = destroy_overdue(library)
    folder = library.library.settings.get(BACKUP_FOLDER, "")
    removed = remove_old_backups(Path(folder)) if folder and Path(folder).is_dir() else ()
    _log.info("sessions destroyed: %d, old backups removed: %d", destroyed, len(removed))
    for step in (finish_destroying, recover_clips, destroy_overdue_clips):
        try:
            step(library)
        except OSError as error:  # another program holds a file: the videos of others are not kept by it
            _log.warning("%s is tried again at the next start", step.__name__, exc_info=error)

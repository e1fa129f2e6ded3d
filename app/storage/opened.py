"""Open a library with a passphrase, and hold it while it is open."""

import glob
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import TracebackType
from typing import Self

from app.storage.clinic.journal_store import JournalStore
from app.storage.clinic.key_slots import SharedKeySlots
from app.storage.clinic.shared_journals import SharedJournals
from app.storage.clinic.station import JOURNALS_SETTING, Station, station_of
from app.storage.data_key import DataKey
from app.storage.files import held, sync_folder
from app.storage.journal.shelter import Shelter
from app.storage.key_change_rest import settle
from app.storage.keys import KeyRefusedError, KeySlots
from app.storage.layout import IN_USE, KEYS, RECORDINGS, VIDEOS
from app.storage.library import Library
from app.storage.stored import LibraryError, Operator, StoredJournal
from app.wording.translation import tr


@dataclass(frozen=True, slots=True)
class OpenedLibrary:
    """A library with somebody logged in, and its folder. No `data_key`: a demonstration.

    `shared`: of a clinic's station, its way to the journals that are in the place which all stations reach.
    `away_from`: of what a station works with while the server does not answer, the station.
    """

    library: Library
    folder: Path
    data_key: DataKey | None = field(repr=False)  # whatever prints this must not print the key
    shared: SharedJournals | None = None
    away_from: Station | None = None

    @property
    def recordings(self) -> Path:
        """The folder of the journals; it is there once something was recorded."""
        return self.folder / RECORDINGS

    @property
    def videos(self) -> Path:
        """The folder of the videos; it is there once one was made."""
        return self.folder / VIDEOS

    @property
    def slots(self) -> KeySlots:
        """What opens it, as `slots_of` gives it."""
        return slots_of(self.folder)

    @property
    def keys_folder(self) -> Path:
        """Where the slots are that open it: what a station works with without its server has the station's."""
        return self.folder if self.away_from is None else self.folder.parent

    def journal_path(self, journal: StoredJournal) -> Path:
        """Give where a journal can be read, another station's fetched first; the path need not exist.
        Raises JournalRefusedError (still at its station), LibraryError (no answer) or OSError.
        """
        path = self.recordings / journal.file
        return path if self.shared is None or path.exists() else self.shared.path(journal)

    @property
    def shelter(self) -> Shelter | None:
        """Where its recordings go while it is gone; None for a demonstration, which ends with the program."""
        root = self.library.root
        return Shelter(root.shelter, root.is_there) if root is not None and self.data_key is not None else None

    @property
    def is_there(self) -> bool:
        """Whether its folder is where it was opened. May wait for the disk."""
        return self.library.root is None or self.library.root.is_there()

    def refuse_gone(self) -> None:
        """Raise LibraryGoneError where the folder is not in place, before its files are reported missing."""
        if self.library.root is not None:
            self.library.root.refuse_gone()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.library.close()


def slots_of(folder: Path) -> KeySlots:
    """Give the folder's slots, ending an interrupted key change; raises KeyRefusedError or LibraryError."""
    station = station_of(folder)
    if station is not None:
        return SharedKeySlots(folder / KEYS, station.database_once())
    settle(folder)
    return KeySlots(folder / KEYS)


def open_library(folder: Path, passphrase: str, code: str = "", *, is_to_be_moved: bool = False) -> OpenedLibrary:
    """Open the library for an operator, by default the only one; raises KeyRefusedError or LibraryError."""
    slots = slots_of(folder)
    if not slots.exists:
        raise LibraryError(
            "This folder contains no library", "Choose another folder, or restore the library from a backup"
        )
    if not code:
        if len(slots.codes) > 1:
            raise KeyRefusedError("This library has several users", "Enter your user code")
        (code,) = slots.codes
    return logged_in(folder, slots.open(code, passphrase), code, is_to_be_moved=is_to_be_moved)


def logged_in(folder: Path, data_key: DataKey, code: str, *, is_to_be_moved: bool = False) -> OpenedLibrary:
    """Open the library with its key; `is_to_be_moved`: see `Library.open`; raises LibraryError."""
    library = Library.open(folder, data_key, is_to_be_moved=is_to_be_moved)
    try:
        library.log_in(code)
    except BaseException:
        library.close()
        raise
    return OpenedLibrary(library, folder, data_key, _shared_journals(library, folder, data_key))


def _shared_journals(library: Library, folder: Path, data_key: DataKey) -> SharedJournals | None:
    """A station's way to the journals' shared place; None where the library has none."""
    if library.station is None:
        return None
    place = library.station.journals
    if not place:  # a station of an earlier version: from now on the place is its own, whatever the server names later
        place = str(library.settings.get(JOURNALS_SETTING, ""))
        JournalStore(place)  # refuses what is neither a folder nor a bucket
        replace(library.station, journals=place).write(folder)
    return SharedJournals(folder, place, data_key)


def create_library(folder: Path, operator: Operator, passphrase: str) -> tuple[OpenedLibrary, str]:
    """Make a library, whole or not at all, and its recovery key; raises KeyRefusedError or LibraryError."""
    with made_beside(folder) as beside:
        data_key, recovery_key = KeySlots(beside / KEYS).create(operator.code, passphrase, (operator.name,))
        Library.create(beside, data_key, operator).close()
    return open_library(folder, passphrase, operator.code), recovery_key


@contextmanager
def made_beside(folder: Path) -> Iterator[Path]:
    """Yield an owner-only folder that replaces an empty `folder` at the end or vanishes; raises LibraryError."""
    folder = folder.resolve()
    try:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise LibraryError("This folder is not empty", "Choose an empty or new folder")
        folder.parent.mkdir(parents=True, exist_ok=True)
        _remove_unfinished(folder)
        beside = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
        try:
            with held(beside / IN_USE):
                yield beside
            (beside / IN_USE).unlink()
            if folder.exists():
                folder.rmdir()  # Windows renames onto nothing only
            beside.rename(folder)
            sync_folder(folder.parent)
        finally:
            shutil.rmtree(beside, ignore_errors=True)
    except OSError as error:
        raise LibraryError(
            tr("This folder is not writable ({why})").format(why=error.strerror), "Choose another folder"
        ) from error


def _remove_unfinished(folder: Path) -> None:
    """Remove what a kill left of a library that was being made or restored, which its own passphrases still open."""
    drawn = re.compile(rf"\.{re.escape(folder.name)}-[a-z0-9_]{{8}}")  # as `tempfile` draws names
    for left in folder.parent.glob(f".{glob.escape(folder.name)}-*"):
        if drawn.fullmatch(left.name) and (left / IN_USE).exists():
            with suppress(BlockingIOError, FileNotFoundError):  # another program may just be making or removing it
                with held(left / IN_USE):
                    pass
                shutil.rmtree(left)  # not while its file is open: on a disk of the network it would not go


@contextmanager
def held_alone(folder: Path) -> Iterator[None]:
    """Be the one program recording here, so open recordings are left-overs; raises LibraryError if taken."""
    try:
        with held(folder / IN_USE):
            _remove_unfinished(folder)
            yield
    except BlockingIOError as error:
        raise LibraryError(
            "This library is already open in Gaitwright", "Use the open Gaitwright window, or close it"
        ) from error

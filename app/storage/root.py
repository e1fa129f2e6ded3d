"""Check that the library's folder is still where it was opened, and still that library's.

A folder is renamed, or its disk taken out, while the program runs: at its path there is then nothing, an empty mount
point, or another library. So a library has an id, in its database and, for whoever has no key, in a file of its own
beside it; and as long as it is open, the folder has to be the very one that was opened.
"""

import secrets
from pathlib import Path
from typing import TYPE_CHECKING

import platformdirs

from app.storage.files import replace_file
from app.storage.stored import LibraryFaultError
from app.wording.translation import later, tr

if TYPE_CHECKING:
    from app.storage.database.engine import Database

ID_FILE = "library-id"
ID_BYTES = 16
ID_SETTING = "library id"
SHELTERS = "sheltered recordings"
GONE = later("The library is no longer in {folder}")
BRING_BACK = later("Put its folder back, or connect its disk")


class LibraryGoneError(LibraryFaultError):
    """The folder is not there, or it is another library's: nothing was written."""


class LibraryRoot:
    """The folder of an open library. Every method may be called from any thread, and may wait for the disk.

    Raises
    ------
    OSError
        The folder cannot be read.
    """

    def __init__(self, folder: Path, library_id: str) -> None:
        self.folder, self.id = folder.absolute(), library_id
        self._identity = _identity(self.folder)

    @property
    def shelter(self) -> Path:
        """Where its recordings are kept while it is gone, on this computer."""
        return shelters() / self.id

    def is_there(self) -> bool:
        """Whether it is the folder that was opened, where it was opened."""
        try:
            return _identity(self.folder) == self._identity and read_id(self.folder) == self.id
        except OSError:
            return False

    def is_another(self) -> bool:
        """Whether the same library is there again, but not in the folder that was opened: mounted again, or copied."""
        try:
            return _identity(self.folder) != self._identity and read_id(self.folder) == self.id
        except OSError:
            return False

    def take(self) -> None:
        """From now on the folder that is there is the one."""
        self._identity = _identity(self.folder)

    def refuse_gone(self) -> None:
        """Raise LibraryGoneError where the folder is not there."""
        if not self.is_there():
            raise LibraryGoneError(tr(GONE).format(folder=self.folder), BRING_BACK)


def shelters() -> Path:
    """The folder of all shelters on this computer, of whichever libraries."""
    return platformdirs.user_data_path("gaitwright", appauthor=False) / SHELTERS


def count_sheltered() -> int:
    """How many recordings wait on this computer for their libraries, by the names of their files."""
    return len({path.name.partition(".")[0] for path in shelters().glob("*/*.journal")})


def read_id(folder: Path) -> str:
    """Give the library id that the folder states, empty where none; raises OSError."""
    try:
        return (folder / ID_FILE).read_text(encoding="ascii", errors="replace").strip()
    except FileNotFoundError:
        return ""


def root_of(folder: Path, database: "Database") -> LibraryRoot:
    """Give the root of an open library, writing an id where an earlier version made it; LibraryError, OSError."""
    from app.storage.database.models import SettingRow  # the page of a missing library opens none

    with database.reading() as session:
        library_id = str(SettingRow.of(session, ID_SETTING, ""))
    if not library_id:
        with database.writing() as session:  # another program may have been quicker
            library_id = str(SettingRow.of(session, ID_SETTING, secrets.token_hex(ID_BYTES)))
            SettingRow.put(session, ID_SETTING, library_id)
    if read_id(folder) != library_id:
        replace_file(folder / ID_FILE, library_id.encode())
    return LibraryRoot(folder, library_id)


def _identity(folder: Path) -> tuple[int, int]:
    found = folder.stat()
    return found.st_dev, found.st_ino

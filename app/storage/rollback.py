"""Check whether this library is older than when this computer saw it last.

How far the audit had come is in a folder of this computer, outside of the library, by the library's own id: that of
its first entry, which a copy and a backup share. A library that was put back to an older state, whole and sound, shows
by that alone. A computer that never saw a library gives nothing of it. Who may write to that folder can remove what
is there; the last line of `gaitwright audit`, or a backup's, kept elsewhere, does the same service.
"""

import json
import logging
from dataclasses import dataclass
from pathlib import Path

from app.storage.files import replace_file
from app.storage.library import Library
from app.storage.stored import Checkpoint, LibraryError

FORMAT = "gaitwright-seen/1"
MOST_KEPT = 100  # checkpoints, to show from where on entries are missing

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Rollback:
    """Entries of the audit, `first` to `last`, that this computer has seen and the library does not hold all of.

    `first` follows the last one that is known to be in both.
    """

    first: int
    last: int


class SeenLibraries:
    """What this computer remembers of libraries, in `folder`, which is made when there is something to be kept."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._latest: dict[Path, Checkpoint] = {}

    def look(self, library: Library) -> Rollback | None:
        """What the library has lost since it was seen last; None where nothing is missing or nothing was seen."""
        path = self._path(library)
        seen, noticed = _read(path)
        if not seen:
            return None
        last = seen[-1].number
        if noticed:  # entries were added since, which have taken the numbers of those that are missing
            return Rollback(noticed, last)
        if library.audit.holds(seen[-1]):
            return None
        common = next((one.number for one in reversed(seen) if library.audit.holds(one)), 0)
        _write(path, seen, common + 1)
        return Rollback(common + 1, last)

    def remember(self, library: Library) -> None:
        """Keep how far the audit has come; not while an older state was noticed and nobody has accepted it."""
        path, end = self._path(library), library.audit.end
        if self._latest.get(path) == end:
            return
        seen, noticed = _read(path)
        if not noticed:
            _write(path, [*seen, end])
            self._latest[path] = end

    def accept(self, library: Library, rollback: Rollback) -> None:
        """Accept the library's older state, noted in its audit; raises NotAllowedError or LibraryError."""
        library.audit.note_rollback(rollback.first, rollback.last)
        _write(self._path(library), [library.audit.end])

    def _path(self, library: Library) -> Path:
        return self._folder / f"{library.audit.library_id}.json"


def _read(path: Path) -> tuple[list[Checkpoint], int]:
    """What was seen, the last at the end, and from which number on entries are missing; 0 while none are."""
    try:
        kept = json.loads(path.read_bytes())
        if kept["format"] != FORMAT:
            raise ValueError(kept["format"])
        return [Checkpoint.parsed(text) for text in kept["seen"]], max(0, int(kept["missing_from"]))
    except FileNotFoundError:
        return [], 0
    except (OSError, ValueError, KeyError, TypeError, AttributeError, LibraryError):
        _log.warning("what was seen of this library cannot be read: %s", path)
        return [], 0


def _write(path: Path, seen: list[Checkpoint], missing_from: int = 0) -> None:
    content = {"format": FORMAT, "seen": [str(one) for one in seen[-MOST_KEPT:]], "missing_from": missing_from}
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        replace_file(path, json.dumps(content).encode())
    except OSError:
        _log.warning("what was seen of this library is not kept: %s", path, exc_info=True)

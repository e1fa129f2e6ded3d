"""Which session folders there are under a folder, and what the results of each are called."""

import hashlib
import os
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from app.exports.result_folder import OWN_SESSION, SUMMARY
from devices.files.refusal import FileRefusedError
from devices.files.session_toml import FILE_NAME

OURS = frozenset(("parameters.csv", "parameters.parquet", "failures.csv"))  # what is beside the results
LETTERS = 8  # of a name that nothing else distinguishes


@dataclass(frozen=True, slots=True)
class FoundSession:
    """A session folder and the name of its results; `shares_name`: others have the same, so its path is in it."""

    name: str
    folder: Path
    shares_name: bool = False


def find_sessions(folder: Path, out: Path) -> tuple[FoundSession, ...]:
    """Give session folders in `folder`, not in `out`, by name or else path; raises FileRefusedError for none."""
    folder = folder.resolve()
    if not folder.is_dir():
        raise FileRefusedError(str(folder), "this folder does not exist", "Choose the folder with the sessions")
    places = {place: _own_name(place) for place in _session_folders(folder, out.resolve())}
    if not places:
        remedy = f"Choose a folder that holds folders with {FILE_NAME}"
        raise FileRefusedError(str(folder), "there is no session folder in it", remedy)
    by_name = defaultdict(list)
    for place, (name, _) in places.items():
        by_name[name.casefold()].append(place)  # some disks do not distinguish large letters from small ones
    found = []
    for place, (name, named_after) in places.items():
        shares_name = len(by_name[name.casefold()]) > 1
        found.append(FoundSession(_path_name(named_after, folder) if shares_name else name, place, shares_name))
    return tuple(sorted(_reported_apart(found, folder), key=lambda one: one.name))


def _session_folders(folder: Path, out: Path) -> Iterator[Path]:
    for at, folders, files in os.walk(folder, onerror=_refuse):
        here = Path(at)
        if FILE_NAME in files:
            folders.clear()
            yield here
        else:
            folders[:] = sorted(name for name in folders if not name.startswith(".") and here / name != out)


def _refuse(problem: OSError) -> None:
    what = f"this folder cannot be looked into ({problem.strerror})"
    raise FileRefusedError(
        str(problem.filename), what, "Check the permissions of this folder, or move it elsewhere"
    ) from problem


def _own_name(place: Path) -> tuple[str, Path]:
    """What a session is called, and the folder that it is called after."""
    after = place.parent if place.name == OWN_SESSION and (place.parent / SUMMARY).is_file() else place
    return after.name or OWN_SESSION, after


def _path_name(named_after: Path, folder: Path) -> str:
    parts = named_after.relative_to(folder).parts if named_after.is_relative_to(folder) else ()
    return "-".join(parts) or named_after.name


def _reported_apart(found: Sequence[FoundSession], folder: Path) -> Iterator[FoundSession]:
    """Names that are still not one session's alone, or that stand for something else, with a digest of the path."""
    count: defaultdict[str, int] = defaultdict(int)
    for one in found:
        count[one.name.casefold()] += 1
    for one in found:
        if count[one.name.casefold()] > 1 or one.name in OURS or one.name.startswith("."):
            path = one.folder.relative_to(folder).as_posix()
            letters = hashlib.sha256(path.encode("utf-8", "surrogateescape")).hexdigest()[:LETTERS]
            yield FoundSession(f"{one.name.lstrip('.')}-{letters}", one.folder, shares_name=True)
        else:
            yield one

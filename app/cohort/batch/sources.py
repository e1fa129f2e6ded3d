"""Where the sessions of a batch come from, one after the other: a folder of session folders, or the user's library."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Protocol

from app.cohort.batch.found import FoundSession, find_sessions
from app.cohort.batch.task import GivenSession


class SessionSource(Protocol):
    """Sessions by the names of their results."""

    @property
    def names(self) -> Sequence[str]: ...

    def content(self, name: str) -> str:
        """Give a digest of a session's content, empty if only reading shows it; raises FileRefusedError."""

    def session(self, name: str) -> Path | GivenSession:
        """The session, for whoever analyses it; raises as `content`."""

    def notes(self) -> Iterator[str]:
        """What is to be stated about these sessions at the end, a line each."""


class SessionFolders:
    """The session folders under a folder. Workers read them: they may lie on another computer's disk."""

    def __init__(self, folder: Path, out: Path) -> None:
        self._found = {one.name: one for one in find_sessions(folder, out)}
        self._folder = folder.resolve()

    @property
    def names(self) -> Sequence[str]:
        return tuple(self._found)

    def content(self, name: str) -> str:
        return ""

    def session(self, name: str) -> Path:
        return self._found[name].folder

    def notes(self) -> Iterator[str]:
        for one in self._found.values():
            if one.shares_name:
                yield f"The results of {self._path(one)} are in {one.name}, since others have its name."

    def _path(self, one: FoundSession) -> str:
        return str(one.folder.relative_to(self._folder))

"""Place where a recording goes on when its library's folder is gone."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from app.storage.data_key import KeyMaterial
from app.storage.journal.disk import JournalFile
from app.storage.journal.header import JournalHeader, segment_path


@dataclass(frozen=True, slots=True)
class Shelter:
    """A place of safety on this computer, one folder for each library; it is there once something had to go into it.

    `is_home` states whether the library is where it was opened.
    """

    folder: Path
    is_home: Callable[[], bool]

    def made(self) -> Path:
        """Make the shelter's folder, its owner's alone, if need be; raises OSError."""
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        return self.folder


@dataclass(frozen=True, slots=True)
class DrawnSegment:
    """A segment with its key, whose file is begun when it is needed."""

    path: Path
    header: JournalHeader
    key: bytes | None

    @classmethod
    def of(cls, folder: Path, header: JournalHeader, data_key: KeyMaterial | None) -> Self:
        path, key = segment_path(folder, header.recording_id, header.segment), None
        if data_key is not None:
            header, key = header.with_new_key(data_key)
        return cls(path, header, key)

    def begun(self, is_held: bool) -> JournalFile:
        """The file with its header; raises as `JournalFile`."""
        return JournalFile(self.path, self.header.packed(), is_held=is_held)

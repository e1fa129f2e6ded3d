"""Read files that others made. One limited process reads all of them, whatever asks for them.

A file can at most end that process. Folders that this program has just written may be read directly.
`waiting` is called while something is read, twenty times a second; what it raises ends the reading at once.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from core.session import Session
from devices.files.limited_reader import Columns, LimitedReader, LimitedReading, Waiting
from devices.files.references.trial import ReferenceFile
from devices.files.session_folder import read_session, write_session
from devices.files.table_choices import NOTHING_STATED, StatedChoices, TableChoices, TablePreview
from devices.files.trial import Gathered, ImportedTrial
from devices.files.video_file import VideoPiece
from devices.other_packages import Offer


def nobody_waits() -> None:
    """Let what is read end in its own time: it has a deadline."""


def read_foreign_session(folder: Path, waiting: Waiting) -> Session:
    """Read as `devices.files.session_folder.read_session`, within limits; raises FileRefusedError."""
    reading = LimitedReading(the_reader(), waiting)
    try:
        return read_session(folder, reading)
    finally:
        reading.waiting = nobody_waits  # a large session is read again later, when this is over


def write_over_session(session: Session, folder: Path) -> None:
    """Write as `devices.files.session_folder.write_session` over an untrusted folder; raises FileRefusedError."""
    write_session(session, folder, LimitedReading(the_reader(), nobody_waits))


def read_foreign_trial(
    format_name: str,
    files: Sequence[Path],
    rate_hz: float | None,
    waiting: Waiting,
    choices: StatedChoices = NOTHING_STATED,
    *,
    splits: bool = False,
) -> ImportedTrial:
    """Read a trial as `devices.files.formats.read_trial`, within limits; raises FileRefusedError."""
    return LimitedReading(the_reader(), waiting).read_trial(format_name, files, rate_hz, choices, splits=splits)


def preview_foreign_table(path: Path, stated: TableChoices, waiting: Waiting) -> TablePreview:
    """Preview a table as `devices.files.table_preview.preview_of`, within limits; raises FileRefusedError."""
    return LimitedReading(the_reader(), waiting).preview(path, stated)


def read_foreign_video(path: Path, from_s: float, most_frames: int, waiting: Waiting) -> VideoPiece:
    """Read a piece of a video as `devices.files.video_file.read_piece`, within limits; raises FileRefusedError."""
    return LimitedReading(the_reader(), waiting).read_video(path, from_s, most_frames)


def read_foreign_reference(path: Path, waiting: Waiting) -> ReferenceFile:
    """Read as `devices.files.references.reading.read_reference`, within limits; raises FileRefusedError."""
    return LimitedReading(the_reader(), waiting).read_reference(path)


def gather_foreign(
    paths: Sequence[Path], waiting: Waiting, choices: StatedChoices = NOTHING_STATED, *, are_one: bool = False
) -> Gathered:
    """Group files and folders as `devices.files.gathering.gather`, within limits; raises FileRefusedError."""
    return LimitedReading(the_reader(), waiting).gather(paths, choices, are_one=are_one)


def ask_foreign_parquet(path: Path, sql: str, is_typed: bool) -> tuple[tuple[str, ...], list[Columns]]:
    """Query as `devices.files.parquet_questions.answer`, within limits; raises FileRefusedError."""
    return LimitedReading(the_reader(), nobody_waits).ask_parquet(path, sql, is_typed)


def why_format_unusable(offer: Offer) -> str:
    """Why a format that another package offers cannot be used, tried within limits; empty where it can."""
    return LimitedReading(the_reader(), nobody_waits).why_unusable(offer)


@cache
def the_reader() -> LimitedReader:
    """The one process of this program that reads foreign files."""
    return LimitedReader()

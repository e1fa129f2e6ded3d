"""Recordings of a program or machine that ended without stopping. Found at the next start, and closed.

Two kinds are found: rows that nobody closed, and orphans, journals that no row reports because the database did not
answer when they were begun. An orphan states itself which session it is of, unless its beginning is damaged. Nothing is
changed in a journal: whatever is proved in it is there, and is read in the same way as after a clean stop. Only the
program that holds the library alone may ask (`opened.held_alone`), for what another program is recording is open, too.

A third kind comes home late (`app.storage.bringing_home`): segments of a recording whose row was closed without them.
"""

import datetime
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from uuid import UUID

from app.storage.journal.header import (
    HEADER_BYTES,
    RESTORE,
    JournalHeader,
    JournalRefusedError,
    find_segments,
    read_header,
)
from app.storage.journal.payloads import Belonging, SourceEntry
from app.storage.journal.reader import Damage, JournalReader, ReadReport
from app.storage.journal.records import RECORD_MAGIC, Record, RecordKind, Seal
from app.storage.opened import OpenedLibrary
from app.storage.stored import LibraryError, RecordingState, StoredJournal, StoredRecording
from app.system.progress import Report
from app.wording.translation import tr
from core.session import Recording, RecordingKind
from devices.files.imports import folder_for, free_name

LAST_BYTES = (1 << 16, 1 << 22)  # where the last record is looked for: the longest has 1 MiB, most have far less
EVERY_BYTES = 1 << 22  # between two reports
FIRST_RECORDS = 100  # among which is the mark that states whose a recording is


@dataclass(frozen=True, slots=True)
class Interrupted:
    """A recording that nobody stopped, as its files' beginnings and ends show.

    `problem`, `remedy`: what keeps it from being recovered, and what to do; empty where nothing does.
    `belonging`: of an orphan: which session it was begun in, and what was noted about it; None where that is not known.
    """

    recording_id: UUID
    stored: StoredRecording | None  # its row; None: an orphan
    segments: Mapping[int, Path]  # its journals, by segment
    began_at: datetime.datetime | None  # None: it was ended before a journal was begun
    recorded_s: float  # how much there is, up to the last record that was written
    problem: str = ""
    remedy: str = ""
    belonging: Belonging | None = None

    @property
    def is_orphan(self) -> bool:
        return self.stored is None


@dataclass(frozen=True, slots=True)
class Recovered:
    """A recording that is closed now. `recorded_s` as all its records show; one report for each segment."""

    stored: StoredRecording
    recorded_s: float
    reports: tuple[ReadReport, ...]


def find_interrupted(opened: OpenedLibrary) -> tuple[Interrupted, ...]:
    """Give all recordings that nobody stopped, oldest first, from file ends; raises LibraryError or OSError."""
    opened.refuse_gone()  # else all its parts would seem to be missing
    files, recordings = find_segments(opened.recordings), opened.library.recordings
    known = recordings.known()
    rows = {recording.id: recording for recording in recordings.still_open()}
    for recording_id, segments in files.items():
        if recording_id in known and recording_id not in rows and not segments.keys() <= known[recording_id]:
            late = recordings.find(recording_id)
            if late is not None and late.state is not RecordingState.DISCARDED:
                rows[recording_id] = late
                if opened.shared is not None:  # those before it are in the clinic's shared place
                    known_to_all = {one.segment: one for one in late.journals if one.kept_as}
                    files[recording_id] = {n: opened.journal_path(one) for n, one in known_to_all.items()} | segments
    orphans = [recording_id for recording_id in files if recording_id not in known]
    required = [*rows, *orphans]
    return tuple(_look(opened, one, rows.get(one), files.get(one, {})) for one in sorted(required, key=str))


def recover(opened: OpenedLibrary, interrupted: Interrupted, report: Report) -> Recovered:
    """Read all there is and close the row; raises JournalRefusedError (it stays open), LibraryError, OSError."""
    if interrupted.stored is None:
        raise ValueError("an orphan has no row to close: adopt it")
    if interrupted.problem:
        raise JournalRefusedError(interrupted.stored.details.name, interrupted.problem, interrupted.remedy)
    return _close(opened, interrupted.stored, _Contents(opened, interrupted, report))


def adopt(
    opened: OpenedLibrary, orphan: Interrupted, session_id: UUID, reported: Recording, report: Report
) -> Recovered:
    """Make an orphan a session's recording, worn as placed last; raises JournalRefusedError or LibraryError."""
    if orphan.problem:
        raise JournalRefusedError(str(orphan.recording_id), orphan.problem, orphan.remedy)
    contents = _Contents(opened, orphan, report)
    stored = opened.library.recordings.start(
        session_id,
        reported,
        contents.is_simulated,
        orphan.recording_id,
        is_decided=reported.kind is not RecordingKind.WALKING,
        began_at=orphan.began_at,
    )
    return _close(opened, stored, contents)


def adopt_home(opened: OpenedLibrary, orphan: Interrupted, report: Report) -> Recovered:
    """Put an orphan into its own session, under a free name; raises as `adopt`, LibraryError if unknown."""
    if orphan.belonging is None:
        raise LibraryError("The session of this recording is unknown", "Export the recording")
    reported, visit = orphan.belonging.details, opened.library.sessions.get(orphan.belonging.session_id)
    if any(other.name == reported.name for other in visit.details.recordings):
        name = free_name(visit.details, reported.kind)
        reported = replace(reported, name=name, folder=folder_for(name))
    return adopt(opened, orphan, visit.id, reported, report)


def _look(
    opened: OpenedLibrary, recording_id: UUID, stored: StoredRecording | None, segments: Mapping[int, Path]
) -> Interrupted:
    keys = _row_keys(stored)
    if missing := sorted(keys.keys() - segments.keys()):
        problem = tr("part {number} of this recording is missing").format(number=missing[0])
        return Interrupted(recording_id, stored, segments, None, 0.0, problem, RESTORE)
    began_at, length = None, _Length()
    try:
        for number, path in segments.items():
            header = read_header(path, keys.get(number))
            last = _last_record(path, Seal(header, header.key(opened.data_key, path.name)))
            length.add(header, last.time_ns if last else header.opened_ns)
            began_at = began_at or datetime.datetime.fromtimestamp(header.opened_wall_ns / 1e9, datetime.UTC)
    except JournalRefusedError as refusal:
        return Interrupted(recording_id, stored, segments, began_at, length.seconds, refusal.what, refusal.remedy)
    belonging = None if stored else _belonging(opened, segments)
    return Interrupted(recording_id, stored, segments, began_at, length.seconds, belonging=belonging)


class _Length:
    """How long a recording is, by its segments in order: those that continue one have its beginning."""

    def __init__(self) -> None:
        self._done_s = self._present_s = 0.0
        self.before: JournalHeader | None = None

    def add(self, header: JournalHeader, last_ns: int) -> None:
        if self.before is None or not header.continues(self.before):
            self._done_s, self._present_s = self.seconds, 0.0
        self._present_s = max(self._present_s, (last_ns - header.opened_ns) / 1e9)
        self.before = header

    @property
    def seconds(self) -> float:
        return self._done_s + self._present_s


def _belonging(opened: OpenedLibrary, segments: Mapping[int, Path]) -> Belonging | None:
    """What one of the first marks states about whose it is."""
    for path in segments.values():
        first = islice(JournalReader(path, opened.data_key).records(), FIRST_RECORDS)
        for record in first:
            if isinstance(record, Damage) or record.kind is not RecordKind.MARK:
                continue
            if (found := Belonging.parsed(json.loads(record.payload))) is not None:
                return found
    return None


def _last_record(path: Path, seal: Seal) -> Record | None:
    """The last record that is proved, where it is near the end of the file."""
    with path.open("rb") as file:
        size = path.stat().st_size
        for count in LAST_BYTES:
            file.seek(max(HEADER_BYTES, size - count))
            if last := _last_of(file.read(), seal):
                return last
    return None


def _last_of(content: bytes, seal: Seal) -> Record | None:
    last, place = None, content.find(RECORD_MAGIC)
    while place >= 0:
        found = seal.opened(memoryview(content)[place:], last)
        if found:
            last, size = found
            place += size - 1
        place = content.find(RECORD_MAGIC, place + 1)
    return last


class _Contents:
    """What reading all segments completely shows."""

    def __init__(self, opened: OpenedLibrary, interrupted: Interrupted, report: Report) -> None:
        self.is_simulated, self._length = False, _Length()
        self.reports: list[ReadReport] = []
        self._are_whole: list[bool] = []
        self.journals: list[StoredJournal] = []
        keys = _row_keys(interrupted.stored)
        self._total = max(sum(path.stat().st_size for path in interrupted.segments.values()), 1)
        self._read = self._reported = 0
        for number, path in interrupted.segments.items():
            reader = JournalReader(path, opened.data_key, keys.get(number))
            self._note_continued(reader.header)
            self._read_segment(reader, report)
            self.reports.append(reader.report)
            self._are_whole.append(reader.report.is_whole)
            wrapped_key = reader.header.wrapped_key or None
            journal = StoredJournal(reader.header.recording_id, number, wrapped_key, reader.report.sha256)
            self.journals.append(journal)

    @property
    def recorded_s(self) -> float:
        return self._length.seconds

    @property
    def is_whole(self) -> bool:
        """Whether it was stopped, and all is there but what a disk that was taken out had not yet written."""
        return bool(self._are_whole) and all(self._are_whole)

    def _note_continued(self, header: JournalHeader) -> None:
        """A segment that was gone on with needs no footer: what its end lacks is a gap, and counted as one."""
        if self._length.before is not None and header.continues(self._length.before):
            self._are_whole[-1] = not self.reports[-1].missing_records

    def _read_segment(self, reader: JournalReader, report: Report) -> None:
        last_ns = reader.header.opened_ns
        for record in reader.records():
            if isinstance(record, Damage):
                self._read += record.size
                continue
            last_ns = record.time_ns
            self._read += len(record.payload)
            if record.kind is RecordKind.SOURCE:
                self.is_simulated |= SourceEntry.parsed(record.payload).info.is_simulated
            if self._read - self._reported >= EVERY_BYTES:
                self._reported = self._read
                report(min(self._read / self._total, 1.0), "recovering")
        self._length.add(reader.header, last_ns)


def _close(opened: OpenedLibrary, stored: StoredRecording, contents: _Contents) -> Recovered:
    reported = {journal.segment for journal in stored.journals}
    for journal in contents.journals:
        if journal.segment not in reported:
            opened.library.recordings.add_journal(stored.id, journal)
    # whole: only its row was left over
    state = RecordingState.CLOSED if contents.is_whole else RecordingState.RECOVERED
    hashes = {journal.segment: journal.sha256 for journal in contents.journals}
    closed = opened.library.recordings.close(stored.id, state, hashes)
    return Recovered(closed, contents.recorded_s, tuple(contents.reports))


def _row_keys(stored: StoredRecording | None) -> Mapping[int, bytes | None]:
    journals: Sequence[StoredJournal] = stored.journals if stored else ()
    return {journal.segment: journal.wrapped_key for journal in journals}

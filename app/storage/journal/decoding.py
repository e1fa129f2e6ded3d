"""Samples that a journal holds. The same way from a journal to a Recording at every stop and after every crash.

What is missing stays a gap. Times are seconds since the recording's first segment was opened; a later segment's are
moved by how long after it that segment was opened. A segment that states it was opened when the one before was is that
one's continuation, in another file: the writer went on in it, and so does the decoder.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.storage.data_key import KeyMaterial
from app.storage.journal.header import JournalHeader
from app.storage.journal.payloads import FLOAT, ROWS, STREAM, Rows, SampleLayout, SourceEntry, block_of
from app.storage.journal.reader import Damage, JournalReader, ReadReport
from app.storage.journal.records import Record, RecordKind
from core.body import Site
from core.samples import BoolArray, FloatArray, ImuBlock
from core.session import Recording
from core.signal.tracks import nominal_step_s
from devices.clocks.shared_clock import tied
from devices.source import DecodedSensor, SensorCounts, SourceInfo, StreamDecoder

Decoders = Mapping[str, Callable[[], StreamDecoder]]
"""A new decoder by the driver's name."""


@dataclass(frozen=True, slots=True)
class JournalMark:
    time_s: float
    text: str


@dataclass(frozen=True, slots=True)
class DecodedJournal:
    """Everything that a recording's segments hold.

    `sensors`: samples and counts by the sensor's name. What lies between two segments was not recorded, so it is not
    lost.
    """

    sensors: Mapping[str, DecodedSensor]
    marks: tuple[JournalMark, ...]
    sources: tuple[SourceInfo, ...]  # every source, as it was described last
    undecoded: tuple[str, ...]  # those of them whose driver is not known here, or which no record describes any more
    dropped_records: int  # records that the disk was too slow for
    reports: tuple[ReadReport, ...]  # one for each segment

    @property
    def is_simulated(self) -> bool:
        return any(source.is_simulated for source in self.sources)

    def recording(self, reported: Recording, placement: Mapping[str, Site]) -> Recording:
        """The recording that `reported` describes, with the samples of the sensors that were worn."""
        imu = {site: self.sensors[name].block for name, site in placement.items() if name in self.sensors}
        return replace(reported, imu=imu)


def decode(
    segments: Sequence[Path],
    data_key: KeyMaterial | None,
    decoders: Decoders,
    wrapped_keys: Sequence[bytes | None] | None = None,
) -> DecodedJournal:
    """Read a recording's segments, in order; raises JournalRefusedError or OSError."""
    parts, offset_s = [], 0.0
    before: _JournalSegment | None = None
    for path, wrapped_key in zip(segments, wrapped_keys or [None] * len(segments), strict=True):
        reader = JournalReader(path, data_key, wrapped_key)
        if before is not None and reader.header.continues(before.header):
            before.go_on(reader)
            continue
        segment = _JournalSegment(reader, decoders)
        segment.read()
        if before is not None:
            offset_s += _opened_later_s(before, segment.header)
        parts.append((segment, offset_s))
        before = segment
    pieces: dict[str, list[DecodedSensor]] = {}
    for segment, offset_s in parts:
        for sensor, piece in segment.decoded():
            pieces.setdefault(sensor, []).append(_moved(piece, offset_s))
    every = [segment for segment, _ in parts]
    return DecodedJournal(
        sensors={sensor: _joined(same) for sensor, same in pieces.items()},
        marks=tuple(
            JournalMark(mark.time_s + offset_s, mark.text) for segment, offset_s in parts for mark in segment.marks
        ),
        sources=tuple(entry.info for segment in every for entry in segment.sources.values()),
        undecoded=tuple(name for segment in every for name in segment.undecoded),
        dropped_records=sum(segment.dropped_records for segment in every),
        reports=tuple(reader.report for segment in every for reader in segment.readers),
    )


class _JournalSegment:
    """What the records of one journal come to, and of those that continue it."""

    def __init__(self, reader: JournalReader, decoders: Decoders) -> None:
        self.readers, self.header = [reader], reader.header
        self._known = decoders
        self.sources: dict[int, SourceEntry] = {}
        self.marks: list[JournalMark] = []
        self.undecoded: list[str] = []
        self.last_ns = self.header.opened_ns
        self._reported_dropped = self._dropped_before = 0
        self._is_reported_again: set[int] = set()  # sources that a continuation describes as they were: nothing was cut
        self._decoders: dict[int, StreamDecoder] = {}
        self._samples: dict[str, list[_SampleRows]] = {}

    @property
    def dropped_records(self) -> int:
        footer = self.readers[-1].report.footer
        return self._dropped_before + (footer.dropped_records if footer else self._reported_dropped)

    def go_on(self, reader: JournalReader) -> None:
        """Read a continuation, too; where all of the file before is there, bytes join across the two."""
        is_joined = self.readers[-1].report.is_whole
        self._is_reported_again = set(self.sources) if is_joined else set()
        self._dropped_before, self._reported_dropped = self.dropped_records, 0
        self.readers.append(reader)
        self.read()

    def read(self) -> None:
        for record in self.readers[-1].records():
            if isinstance(record, Damage):
                for number, decoder in self._decoders.items():
                    decoder.begin(self.sources[number].info)  # some of its bytes may be missing here
                continue
            self.last_ns = record.time_ns
            match record.kind:
                case RecordKind.SOURCE:
                    self._begin(SourceEntry.parsed(record.payload))
                case RecordKind.BYTES:
                    self._feed(record)
                case RecordKind.SAMPLES:
                    self._take(record)
                case RecordKind.MARK:
                    self.marks.append(JournalMark(self._since_opening_s(record), json.loads(record.payload)))

    def decoded(self) -> list[tuple[str, DecodedSensor]]:
        found = [piece for decoder in self._decoders.values() for piece in decoder.finish().items()]
        return tied(found) + [(sensor, rows.decoded()) for sensor, every in self._samples.items() for rows in every]

    def _begin(self, entry: SourceEntry) -> None:
        driver = entry.info.driver
        self._reported_dropped += entry.dropped_records
        if entry.number in self._is_reported_again:
            self._is_reported_again.remove(entry.number)
            return
        self.sources[entry.number] = entry
        if entry.layout is None and driver in self._known:
            if entry.number not in self._decoders:
                self._decoders[entry.number] = self._known[driver]()
            self._decoders[entry.number].begin(entry.info)

    def _feed(self, record: Record) -> None:
        (number,) = STREAM.unpack_from(record.payload)
        if number in self._decoders:
            self._decoders[number].feed(record.payload[STREAM.size :], self._since_opening_s(record))
        else:
            self._note_undecoded(number)

    def _take(self, record: Record) -> None:
        number, sensor, _ = ROWS.unpack_from(record.payload)
        entry = self.sources.get(number)
        if entry is None or entry.layout is None:
            self._note_undecoded(number)
            return
        name = entry.info.sensors[sensor]
        pieces = self._samples.setdefault(name, [])  # by name: a sensor that comes back as another source goes on
        if not pieces or pieces[-1].layout != entry.layout:
            pieces.append(_SampleRows(name, entry.layout))
        pieces[-1].add(Rows.parsed(record.payload, entry.layout))

    def _note_undecoded(self, number: int) -> None:
        name = self.sources[number].info.driver if number in self.sources else f"source {number}"
        if name not in self.undecoded:
            self.undecoded.append(name)

    def _since_opening_s(self, record: Record) -> float:
        return (record.time_ns - self.header.opened_ns) / 1e9


@dataclass(slots=True)
class _SampleRows:
    """One sensor's rows as they came, under one layout."""

    sensor: str
    layout: SampleLayout
    numbers: bytearray = field(default_factory=bytearray)
    texts: list[list[str]] = field(default_factory=list)

    def add(self, rows: Rows) -> None:
        self.numbers += rows.numbers.tobytes()
        self.texts = self.texts or [[] for _ in rows.texts]
        for column, more in zip(self.texts, rows.texts, strict=True):
            column.extend(more)

    def decoded(self) -> DecodedSensor:
        numbers = np.frombuffer(self.numbers, FLOAT).reshape(-1, len(self.layout.columns))
        block = block_of(self.sensor, numbers, self.texts, self.layout)
        return _put_in_order(block, self.layout.rate_hz)


def _put_in_order(block: ImuBlock, rate_hz: float | None) -> DecodedSensor:
    """Samples in order of time, each once; doubled and late ones are counted, and those missing by the clock."""
    is_timed = np.isfinite(block.time_s)
    order = np.argsort(block.time_s[is_timed], kind="stable")  # of two with one stamp, the first comes first
    time_s = block.time_s[is_timed][order]
    is_new = np.ones(len(order), dtype=bool)
    is_new[1:] = np.diff(time_s) > 0
    kept = np.flatnonzero(is_timed)[order[is_new]]
    arrived_s = block.time_s[np.sort(kept)]
    late = int(np.count_nonzero(arrived_s[1:] < np.maximum.accumulate(arrived_s)[:-1])) if len(kept) else 0
    in_order = block if _is_all(kept, len(block)) else block.select(kept)
    has_data = np.any(~np.isnan(np.hstack([in_order.gyr_rad_s, in_order.acc_m_s2])), axis=1)
    return DecodedSensor(
        in_order,
        SensorCounts(
            received=int(np.count_nonzero(has_data)),
            lost=_lost(in_order.time_s, has_data, rate_hz),
            damaged=int(np.count_nonzero(~is_timed)),
            doubled=int(np.count_nonzero(~is_new)),
            late=late,
        ),
    )


def _lost(time_s: FloatArray, has_data: BoolArray, rate_hz: float | None) -> int:
    """Samples that are missing between the first and the last row: by the clock, and rows without a value."""
    empty = int(np.count_nonzero(~has_data))
    if len(time_s) < 3:
        return empty
    step_s = 1 / rate_hz if rate_hz else nominal_step_s(time_s)
    return empty + int(np.sum(np.maximum(np.round(np.diff(time_s) / step_s) - 1, 0)))


def _is_all(kept: NDArray[np.intp], count: int) -> bool:
    return len(kept) == count and bool(np.all(kept == np.arange(count)))


def _moved(piece: DecodedSensor, offset_s: float) -> DecodedSensor:
    if offset_s == 0.0:
        return piece  # bit for bit
    return replace(piece, block=replace(piece.block, time_s=piece.block.time_s + offset_s))


def _joined(pieces: Sequence[DecodedSensor]) -> DecodedSensor:
    """One sensor's pieces, from several segments or layouts, as one."""
    if len(pieces) == 1:
        return pieces[0]
    blocks = [piece.block for piece in pieces]
    names = list(dict.fromkeys(name for block in blocks for name in block.unknown))
    block = ImuBlock(
        sensor=blocks[0].sensor,
        time_s=np.concatenate([block.time_s for block in blocks]),
        gyr_rad_s=np.concatenate([block.gyr_rad_s for block in blocks]),
        acc_m_s2=np.concatenate([block.acc_m_s2 for block in blocks]),
        q_earth_from_sensor=_joined_or_nan([(block.q_earth_from_sensor, len(block)) for block in blocks], 4),
        mag=_joined_or_nan([(block.mag, len(block)) for block in blocks], 3),
        is_rate_derived=any(block.is_rate_derived for block in blocks),
        unknown={name: _joined_unknown(name, blocks) for name in names},
    )
    joined = _put_in_order(block, None)
    counts = sum((piece.counts for piece in pieces), SensorCounts())
    overlap = joined.counts.doubled
    return DecodedSensor(
        joined.block,
        replace(
            counts,
            received=joined.counts.received,
            doubled=counts.doubled + overlap,
            late=counts.late + joined.counts.late,
        ),
    )


def _joined_or_nan(parts: Sequence[tuple[FloatArray | None, int]], columns: int) -> FloatArray | None:
    if all(part is None for part, _ in parts):
        return None
    return np.concatenate([np.full((count, columns), np.nan) if part is None else part for part, count in parts])


def _joined_unknown(name: str, blocks: Sequence[ImuBlock]) -> NDArray[np.generic]:
    """A column that some blocks have: numbers if it is numbers in all of these, else texts."""
    have = [block.unknown[name] for block in blocks if name in block.unknown]
    is_number = all(np.issubdtype(column.dtype, np.floating) for column in have)
    if is_number:
        return np.concatenate([block.unknown.get(name, np.full(len(block), np.nan)) for block in blocks])
    texts = [str(value) for block in blocks for value in block.unknown.get(name, np.full(len(block), ""))]
    return np.array(texts, dtype=np.dtypes.StringDType())


def _opened_later_s(before: _JournalSegment, header: JournalHeader) -> float:
    """Give how much later the next segment was opened: by the monotonic clock, after a restart the wall clock."""
    recorded_ns = before.last_ns - before.header.opened_ns
    passed_ns = header.opened_ns - before.header.opened_ns
    if passed_ns < recorded_ns:
        passed_ns = max(header.opened_wall_ns - before.header.opened_wall_ns, recorded_ns)
    return passed_ns / 1e9

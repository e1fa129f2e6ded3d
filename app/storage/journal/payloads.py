"""Content of the records. Sources and marks as JSON, samples as rows of float64, bytes as they came."""

import json
import struct
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, NamedTuple
from uuid import UUID

import numpy as np
from numpy.typing import NDArray

from core.alignment import alignment_of_table, alignment_table
from core.samples import FloatArray, ImuBlock
from core.session import Recording, RecordingKind
from core.timed.protocols import TABLE_KEYS, KeyMeaning, PlannedTest, planned_of_table, planned_table
from devices.files.site_files import ACC, GYR, MAG, QUAT, TIME
from devices.source import SourceInfo

STREAM = struct.Struct("<H")  # the source's number, before its bytes
ROWS = struct.Struct("<HHI")  # the source's number, the sensor's, and how many rows follow
FLOAT = np.dtype("<f8")
BELONGING = "gaitwright-recording/1 "  # how the mark begins that states whose a recording is
BELONGING_FIELDS = ("name", "kind", "folder", "condition", "started", "is_restrapped_before")
ALIGNMENT = "alignment"  # among what that mark states, where something was changed
KEY_PRESSED = "gaitwright-test-key/1 "  # how the mark begins that states what a key amid a timed test meant
OWN_COLUMNS = {
    (has_orientation, has_field): (TIME, *GYR, *ACC, *(QUAT if has_orientation else ()), *(MAG if has_field else ()))
    for has_orientation in (False, True)
    for has_field in (False, True)
}


@dataclass(frozen=True, slots=True)
class SampleLayout:
    """The columns of a source that gives samples: `columns` numbers, `texts` texts, by the session folder's names.

    `rate_hz` None: not reported, so that losses are counted by the usual interval.
    """

    columns: tuple[str, ...]
    texts: tuple[str, ...] = ()
    is_rate_derived: bool = False
    rate_hz: float | None = None


@dataclass(frozen=True, slots=True)
class SourceEntry:
    """A source as a journal describes it: when it begins, after a change, and after records of it were dropped."""

    number: int
    info: SourceInfo
    layout: SampleLayout | None = None
    dropped_records: int = 0
    dropped_bytes: int = 0

    def packed(self) -> bytes:
        return json.dumps(asdict(self), allow_nan=False).encode()

    @classmethod
    def parsed(cls, payload: bytes) -> "SourceEntry":
        reported: dict[str, Any] = json.loads(payload)
        info, layout = reported.pop("info"), reported.pop("layout")
        info["sensors"] = tuple(info["sensors"])
        if layout is not None:
            layout |= {"columns": tuple(layout["columns"]), "texts": tuple(layout["texts"])}
        return cls(**reported, info=SourceInfo(**info), layout=SampleLayout(**layout) if layout is not None else None)


@dataclass(frozen=True, slots=True)
class Belonging:
    """Of which session a recording is, and what was stated of it, in a mark's text: its row may not exist yet."""

    session_id: UUID
    details: Recording

    def text(self) -> str:
        reported = {name: getattr(self.details, name) for name in BELONGING_FIELDS}
        if self.details.alignment is not None:  # left out otherwise: earlier versions read no other keys
            reported[ALIGNMENT] = alignment_table(self.details.alignment)
        reported |= planned_table(self.details.test)  # likewise
        return BELONGING + json.dumps({"session": str(self.session_id), **reported})

    @classmethod
    def parsed(cls, text: str) -> "Belonging | None":
        """What `text` has written; None of any other mark."""
        if not text.startswith(BELONGING):
            return None
        reported: dict[str, Any] = json.loads(text.removeprefix(BELONGING))
        session_id = UUID(reported.pop("session"))
        reported[ALIGNMENT] = alignment_of_table(reported.get(ALIGNMENT))
        test = planned_of_table(reported)
        reported = {key: value for key, value in reported.items() if key not in TABLE_KEYS} | {"test": test}
        return cls(session_id, Recording(imu={}, **(reported | {"kind": RecordingKind(reported["kind"])})))


@dataclass(frozen=True, slots=True)
class Footer:
    """Why the journal ends, and what had to be dropped over all."""

    reason: str
    dropped_records: int
    dropped_bytes: int

    def packed(self) -> bytes:
        return json.dumps(asdict(self)).encode()

    @classmethod
    def parsed(cls, payload: bytes) -> "Footer":
        return cls(**json.loads(payload))


class Rows(NamedTuple):
    """A piece of one sensor's samples: `numbers` (n, columns) of `FLOAT`, `texts` one list of n per column of texts."""

    source: int
    sensor: int
    numbers: FloatArray
    texts: Sequence[Sequence[str]]

    def packed(self) -> bytes:
        packed = ROWS.pack(self.source, self.sensor, len(self.numbers)) + self.numbers.tobytes()
        return packed + json.dumps(self.texts).encode() if self.texts else packed

    def halves(self) -> "tuple[Rows, Rows]":
        k = len(self.numbers) // 2
        head, tail = [column[:k] for column in self.texts], [column[k:] for column in self.texts]
        return self._replace(numbers=self.numbers[:k], texts=head), self._replace(numbers=self.numbers[k:], texts=tail)

    @classmethod
    def parsed(cls, payload: bytes, layout: SampleLayout) -> "Rows":
        source, sensor, count = ROWS.unpack_from(payload)
        size = count * len(layout.columns)
        numbers = np.frombuffer(payload, FLOAT, size, ROWS.size).reshape(count, len(layout.columns))
        texts = json.loads(payload[ROWS.size + size * FLOAT.itemsize :]) if layout.texts else []
        return cls(source, sensor, numbers, texts)


def layout_of(block: ImuBlock, rate_hz: float | None = None) -> SampleLayout:
    """Give the columns of `block`; raises ValueError where an unknown one has a known name."""
    return SampleLayout(*_columns_of(block), block.is_rate_derived, rate_hz)


def rows_of(block: ImuBlock, layout: SampleLayout) -> tuple[FloatArray, list[list[str]]]:
    """Give the block's samples as `layout` has them; raises ValueError for other columns or order."""
    columns, texts = _columns_of(block)
    if (columns, texts) != (layout.columns, layout.texts):
        raise ValueError("the block has other columns than its source's layout")  # which may be somebody's words
    numbers = np.empty((len(block), len(columns)), FLOAT)
    numbers[:, 0], numbers[:, 1:4], numbers[:, 4:7] = block.time_s, block.gyr_rad_s, block.acc_m_s2
    k = 7
    for part in (block.q_earth_from_sensor, block.mag):
        if part is not None:
            numbers[:, k : k + part.shape[1]] = part
            k += part.shape[1]
    for column, name in enumerate(columns[k:], k):
        numbers[:, column] = block.unknown[name]
    return numbers, [[str(value) for value in block.unknown[name]] for name in texts]


def _columns_of(block: ImuBlock) -> tuple[tuple[str, ...], tuple[str, ...]]:
    own = OWN_COLUMNS[block.q_earth_from_sensor is not None, block.mag is not None]
    if not block.unknown:
        return own, ()  # a live sensor's block, a thousand times a second
    if taken := [name for name in block.unknown if name in own]:
        raise ValueError(f"unknown columns bear our own names: {taken}")
    numbers = [name for name, column in block.unknown.items() if np.issubdtype(column.dtype, np.floating)]
    return (*own, *numbers), tuple(name for name in block.unknown if name not in numbers)


def block_of(sensor: str, numbers: FloatArray, texts: Sequence[Sequence[str]], layout: SampleLayout) -> ImuBlock:
    """The samples (n, columns) that `rows_of` took apart."""
    place = {name: k for k, name in enumerate(layout.columns)}

    def columns(names: Sequence[str]) -> FloatArray:
        return np.ascontiguousarray(numbers[:, [place[name] for name in names]])

    known = {TIME, *GYR, *ACC}
    known |= {name for group in (QUAT, MAG) if place.keys() >= {*group} for name in group}
    unknown: dict[str, NDArray[np.generic]] = {
        name: numbers[:, k].copy() for name, k in place.items() if name not in known
    }
    for name, values in zip(layout.texts, texts, strict=True):
        unknown[name] = np.array(values, dtype=np.dtypes.StringDType())
    return ImuBlock(
        sensor=sensor,
        time_s=numbers[:, place[TIME]].copy(),
        gyr_rad_s=columns(GYR),
        acc_m_s2=columns(ACC),
        q_earth_from_sensor=columns(QUAT) if QUAT[0] in known else None,
        mag=columns(MAG) if MAG[0] in known else None,
        is_rate_derived=layout.is_rate_derived,
        unknown=unknown,
    )


def key_text(meaning: KeyMeaning) -> str:
    """The text of the mark of a key that was pressed amid a timed test, at its instant."""
    return KEY_PRESSED + str(meaning)


def with_keys(planned: PlannedTest | None, marks: Iterable[tuple[float, str]]) -> PlannedTest | None:
    """The test with the keys that a journal's marks contain, seconds and text; what it already has stays."""
    if planned is None or planned.start_key_s is not None or planned.end_key_s is not None:
        return planned
    at_s = {text: time_s for time_s, text in marks if text.startswith(KEY_PRESSED)}
    return replace(
        planned,
        start_key_s=at_s.get(key_text(KeyMeaning.START)),
        end_key_s=at_s.get(key_text(KeyMeaning.END)),
    )

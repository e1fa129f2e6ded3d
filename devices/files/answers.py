"""Answers of a limited process, written so that nothing in them has to be trusted.

An answer is JSON, then the arrays that it names by number, as raw bytes. Nothing is unpickled: whoever receives it
builds every object itself, and refuses with `BrokenAnswerError` what has not the shape it should have.
"""

import datetime
import json
import math
import re
import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from string import Formatter
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from core.findings import Finding, Severity
from core.samples import ImuBlock, RateKind, SensorInfo
from devices.files.refusal import FileRefusedError
from devices.files.trial import FilesOfTrial, Gathered, ImportedSensor, ImportedTrial, UnreadFile

Array = NDArray[np.generic]
Details = dict[str, Any]

LENGTH = struct.Struct("<Q")  # of the JSON; the arrays' lengths stand in it
PLAIN_NUMBERS = re.compile(r"[<>|][fiu][1248]")
MOST_ANSWER_BYTES = 2_000_000_000  # of JSON, and of arrays: more than any file that is let through can hold
MOST_REFUSAL = 20_000  # letters of each part
TIMES: Mapping[str, Any] = {"datetime": datetime.datetime, "date": datetime.date, "time": datetime.time}
OF_BLOCK = ("time_s", "gyr_rad_s", "acc_m_s2", "q_earth_from_sensor", "mag")
TEXTS_OF_SENSOR = ("serial", "model", "firmware", "clock")


class BrokenAnswerError(Exception):
    """An answer that no reader of ours gives."""


def send(stream: IO[bytes], details: Details, arrays: Sequence[Array] = ()) -> None:
    """Write one message: its length, its content as JSON, then the bytes of its arrays."""
    shapes = [[array.dtype.str, list(array.shape)] for array in arrays]
    message = json.dumps({"details": details, "arrays": shapes}).encode()
    stream.write(LENGTH.pack(len(message)))
    stream.write(message)
    for array in arrays:
        stream.write(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
    stream.flush()


def receive(stream: IO[bytes]) -> tuple[Details, list[Array]]:
    """What `send` sent.

    Raises
    ------
    BrokenAnswerError
        It is of another shape, or larger than any answer.
    EOFError, OSError
        Nobody is there any more.
    """
    (length,) = LENGTH.unpack(_exactly(stream, LENGTH.size))
    if length > MOST_ANSWER_BYTES:
        raise BrokenAnswerError(f"an answer of {length} bytes")
    with _whatever_is_wrong():
        message = json.loads(_exactly(stream, length))
        details, shapes = message["details"], message["arrays"]
        sizes = [_bytes_of(kind, shape) for kind, shape in shapes]
        if not isinstance(details, dict) or sum(sizes) > MOST_ANSWER_BYTES:
            raise BrokenAnswerError("an answer of another shape, or too large")
        arrays = [np.empty(shape, kind) for kind, shape in shapes]
    for array in arrays:
        _fill(stream, array.reshape(-1).view(np.uint8).data)
    return details, arrays


def details_of_block(block: ImuBlock, arrays: list[Array]) -> Details:
    """The block, its samples put into `arrays`."""

    def put(array: Array) -> int:
        arrays.append(array)
        return len(arrays) - 1

    values = {name: getattr(block, name) for name in OF_BLOCK}
    columns = {
        name: put(column) if PLAIN_NUMBERS.fullmatch(column.dtype.str) else [str(text) for text in column]
        for name, column in block.unknown.items()
    }
    return {
        **{name: None if value is None else put(value) for name, value in values.items()},
        "sensor": block.sensor,
        "is_rate_derived": block.is_rate_derived,
        "unknown": columns,
    }


def block_from(details: Details, arrays: Sequence[Array]) -> ImuBlock:
    """The block that `details_of_block` wrote.

    Raises
    ------
    BrokenAnswerError
        It is something else.
    """
    with _whatever_is_wrong():
        samples = {name: _samples(arrays[details[name]]) for name in OF_BLOCK if details[name] is not None}
        columns = {
            str(name): arrays[value] if isinstance(value, int) else np.array(value, dtype=np.dtypes.StringDType())
            for name, value in details["unknown"].items()
        }
        n = len(arrays[details["time_s"]])
        if any(column.shape != (n,) for column in columns.values()):
            raise BrokenAnswerError("columns of different lengths")
        return ImuBlock(
            sensor=_text(details["sensor"]),
            is_rate_derived=details["is_rate_derived"] is True,
            unknown=columns,
            **samples,
        )


def details_of_findings(findings: Sequence[Finding]) -> list[Details]:
    """Findings as what JSON can hold."""
    return [{"key": f.key, "severity": f.severity, "where": f.where, "numbers": dict(f.numbers)} for f in findings]


def findings_from(details: list[Details]) -> tuple[Finding, ...]:
    """What `details_of_findings` wrote, checked.

    Raises
    ------
    BrokenAnswerError
        It is something else.
    """
    with _whatever_is_wrong():
        return tuple(_finding(one) for one in details)


def details_of_trial(trial: ImportedTrial, arrays: list[Array]) -> Details:
    """What a reader found in the files of a trial; what it gives about sensors is in the keys of `SensorInfo`."""
    return {
        "format": trial.format,
        "started": trial.started,
        "is_simulated": trial.is_simulated,
        "sensors": [
            {
                "name": sensor.name,
                "ids": list(sensor.ids),
                "file": sensor.file,
                "block": details_of_block(sensor.block, arrays),
                "info": {name: getattr(sensor.info, name) for name in (*TEXTS_OF_SENSOR, "rate_hz", "rate_kind")},
                "findings": details_of_findings(sensor.findings),
            }
            for sensor in trial.sensors
        ],
        "unread": [
            {"file": one.file, "ids": list(one.ids), "refusal": details_of_refusal(one.refusal)} for one in trial.unread
        ],
    }


def trial_from(details: Details, arrays: Sequence[Array]) -> ImportedTrial:
    """What `details_of_trial` wrote, checked.

    Raises
    ------
    BrokenAnswerError
        It is something else.
    """
    with _whatever_is_wrong():
        sensors = tuple(
            ImportedSensor(
                _text(one["name"]),
                tuple(map(_text, one["ids"])),
                _text(one["file"]),
                block_from(one["block"], arrays),
                _sensor(one["info"]),
                findings_from(one["findings"]),
            )
            for one in details["sensors"]
        )
        unread = tuple(
            UnreadFile(_text(one["file"]), tuple(map(_text, one["ids"])), refusal_from(one["refusal"]))
            for one in details["unread"]
        )
        is_simulated = details["is_simulated"] is True
        return ImportedTrial(_text(details["format"]), sensors, unread, _text(details["started"]), is_simulated)


def details_of_gathered(gathered: Gathered) -> Details:
    """Which files belong together."""
    return {
        "trials": [{"format": one.format, "name": one.name, "files": list(one.files)} for one in gathered.trials],
        "refused": list(map(details_of_refusal, gathered.refused)),
    }


def gathered_from(details: Details) -> Gathered:
    """What `details_of_gathered` wrote, checked.

    Raises
    ------
    BrokenAnswerError
        It is something else.
    """
    with _whatever_is_wrong():
        trials = tuple(
            FilesOfTrial(_text(one["format"]), _text(one["name"]), tuple(map(_text, one["files"])))
            for one in details["trials"]
        )
        return Gathered(trials, tuple(map(refusal_from, details["refused"])))


def details_of_document(value: object) -> object:
    """A TOML document in JSON's own kinds, its times named as such."""
    if isinstance(value, dict):
        return ["table", {key: details_of_document(inner) for key, inner in value.items()}]
    if isinstance(value, list):
        return ["list", [details_of_document(inner) for inner in value]]
    for kind, type_ in TIMES.items():
        if isinstance(value, type_):
            return [kind, value.isoformat()]
    return value


def document_from(details: object) -> object:
    """What `details_of_document` wrote, checked.

    Raises
    ------
    BrokenAnswerError
        It is something else.
    """
    with _whatever_is_wrong():
        match details:
            case ["table", dict(inner)]:
                return {key: document_from(value) for key, value in inner.items()}
            case ["list", list(inner)]:
                return [document_from(value) for value in inner]
            case [str(kind), str(text)]:
                return TIMES[kind].fromisoformat(text)
            case str() | int() | float():
                return details
    raise BrokenAnswerError("no TOML")


def details_of_refusal(refusal: FileRefusedError) -> Details:
    """A refusal as what JSON can hold."""
    return {"where": refusal.where, "what": refusal.what, "remedy": refusal.remedy, "values": refusal.values}


def refusal_from(details: Details) -> FileRefusedError:
    """The refusal as it was raised; only plain names stand in its braces, so that filling them can do nothing else.

    Raises
    ------
    BrokenAnswerError
        It is something else.
    """
    with _whatever_is_wrong():
        where, what, remedy = (_text(details[name]) for name in ("where", "what", "remedy"))
        values = {str(name): _text(value) for name, value in details["values"].items()}
        if any(len(text) > MOST_REFUSAL for text in (where, what, remedy, *values.values())):
            raise BrokenAnswerError("a refusal without end")
        if values:
            for _, name, form, conversion in Formatter().parse(f"{what}{remedy}"):
                if name is not None and (name not in values or form or conversion):
                    raise BrokenAnswerError("a refusal with strange braces")
        return FileRefusedError.stated_elsewhere(where, what, remedy, values)


@contextmanager
def _whatever_is_wrong() -> Iterator[None]:
    try:
        yield
    except (LookupError, TypeError, ValueError, AttributeError, RecursionError, MemoryError) as error:
        raise BrokenAnswerError(f"an answer of another shape ({error})") from error


def _exactly(stream: IO[bytes], length: int) -> bytearray:
    content = bytearray(length)
    _fill(stream, memoryview(content))
    return content


def _fill(stream: IO[bytes], content: memoryview) -> None:
    while content:
        got = stream.readinto(content)  # type: ignore[attr-defined]  # every binary stream has it, its type has not
        if not got:
            raise EOFError
        content = content[got:]


def _bytes_of(kind: str, shape: Sequence[int]) -> float:
    is_plain = isinstance(kind, str) and PLAIN_NUMBERS.fullmatch(kind)
    if not is_plain or not 1 <= len(shape) <= 2 or not all(type(size) is int and size >= 0 for size in shape):
        raise BrokenAnswerError("an array of no numbers, or of no shape")
    return math.prod(shape) * int(kind[-1])


def _samples(array: Array) -> NDArray[np.float64]:
    if array.dtype != np.float64:
        raise BrokenAnswerError(f"samples of {array.dtype}")
    return array.astype(np.float64, copy=False)


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise BrokenAnswerError(f"{type(value)}, expected a text")
    return value


def _finding(details: Details) -> Finding:
    numbers: Mapping[str, object] = details["numbers"]
    kept = {str(name): value for name, value in numbers.items() if isinstance(value, str | int | float)}
    return Finding(_text(details["key"]), Severity(details["severity"]), _text(details["where"]), kept)


def _sensor(details: Details) -> SensorInfo:
    rate_hz, kind = details["rate_hz"], details["rate_kind"]
    serial, model, firmware, clock = (_text(details[name]) for name in TEXTS_OF_SENSOR)
    return SensorInfo(
        serial=serial,
        model=model,
        firmware=firmware,
        rate_hz=None if rate_hz is None else float(rate_hz),
        rate_kind=None if kind is None else RateKind(kind),
        clock=clock,
    )

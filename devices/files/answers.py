"""Answers of a limited process, written so that nothing in them has to be trusted.

An answer is JSON, then the arrays that it names by number, as raw bytes. Nothing is unpickled: who receives it names
the class that it is to be, builds it by the types of that class's fields, and refuses with `BrokenAnswerError` whatever
is of another shape. Only questions are answered in Arrow's own format: loading it costs the window 0.15 s and 25 MB.
"""

import builtins
import datetime
import json
import math
import re
import struct
import types
from collections import abc
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import is_dataclass
from enum import StrEnum
from functools import cache
from itertools import repeat
from string import Formatter
from typing import IO, Any, cast, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from core.samples import ImuBlock
from devices.files.refusal import FileRefusedError

Array = NDArray[np.generic]
Details = dict[str, Any]

LENGTH = struct.Struct("<Q")  # of the JSON; the arrays' lengths stand in it
PLAIN_NUMBERS = re.compile(r"[<>|][fiu][1248]")
MOST_ANSWER_BYTES = 2_000_000_000  # of JSON, and of arrays: more than any file that is let through can hold
MOST_REFUSAL = 20_000  # letters of each part
TIMES: Mapping[str, Any] = {"datetime": datetime.datetime, "date": datetime.date, "time": datetime.time}
TEXTS_OF_REFUSAL = ("where", "what", "remedy")
ANY_COLUMN = NDArray[np.generic]
PLAIN = (str, bool, int, float, types.NoneType)
ANYTHING = Mapping[str, object]


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
    """Receive what `send` sent; raises BrokenAnswerError, or EOFError and OSError where nobody is there."""
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


def details_of(value: Any, arrays: list[Array]) -> Any:
    """A value as JSON can hold it, its arrays put into `arrays` and named by their number."""
    match value:
        case np.ndarray() if PLAIN_NUMBERS.fullmatch(value.dtype.str):
            arrays.append(value)
            return len(arrays) - 1
        case np.ndarray():
            return [str(text) for text in value]
        case FileRefusedError():
            return {name: getattr(value, name) for name in (*TEXTS_OF_REFUSAL, "values")}
        case Mapping():
            return {key: details_of(one, arrays) for key, one in value.items()}
        case list() | tuple():
            return [details_of(one, arrays) for one in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {name: details_of(getattr(value, name), arrays) for name in _fields_of(type(value))}
    return value


def value_from(kind: Any, details: Any, arrays: Sequence[Array] = ()) -> Any:
    """The value of this type that `details_of` wrote, every part of it of the type that its class names.

    Raises
    ------
    BrokenAnswerError
        It is something else.
    """
    with _whatever_is_wrong():
        return _value(kind, details, arrays)


def _value(kind: Any, details: Any, arrays: Sequence[Array]) -> Any:
    parts = get_args(kind)
    match get_origin(kind) or kind:
        case types.UnionType:
            return _one_of(parts, details, arrays)
        case np.ndarray:
            return _column(details, arrays) if kind == ANY_COLUMN else _samples(arrays[details])
        case builtins.tuple if isinstance(details, list):
            each = repeat(parts[0], len(details)) if parts[-1] is ... else parts
            return tuple(_value(part, one, arrays) for part, one in zip(each, details, strict=True))
        case abc.Mapping:
            return {_value(parts[0], key, ()): _value(parts[1], one, arrays) for key, one in details.items()}
        case builtins.type() if issubclass(kind, FileRefusedError):
            return _refusal(details)
        case builtins.type() if issubclass(kind, StrEnum):
            return kind(details)
        case builtins.type() as of if is_dataclass(of):
            kinds = _fields_of(of)
            if details.keys() != kinds.keys():
                raise BrokenAnswerError(f"other fields than {of.__name__} has")
            made = cast(Any, of)(**{name: _value(kinds[name], one, arrays) for name, one in details.items()})
            if isinstance(made, ImuBlock) and any(column.shape != (len(made),) for column in made.unknown.values()):
                raise BrokenAnswerError("columns of different lengths")
            return made
        case builtins.float if type(details) in (int, float):
            return float(details)
        case plain if plain in PLAIN and type(details) is plain:
            return details
    raise BrokenAnswerError(f"{type(details)}, expected {kind}")


def _one_of(kinds: Sequence[Any], details: Any, arrays: Sequence[Array]) -> Any:
    if type(details) in PLAIN and type(details) in kinds:
        return details
    rest = [kind for kind in kinds if kind is not types.NoneType]
    for kind in rest[:-1]:
        with suppress(BrokenAnswerError):
            return value_from(kind, details, arrays)
    return _value(rest[-1], details, arrays)  # whose refusal says why


@cache
def _fields_of(of: type) -> dict[str, Any]:
    """The fields of a class with their types, but what may be of any: no reader fills it."""
    return {name: kind for name, kind in get_type_hints(of).items() if kind != ANYTHING}


def _column(details: Any, arrays: Sequence[Array]) -> Array:
    """A column of a block that means nothing to us: numbers, or texts."""
    if not isinstance(details, list):
        return arrays[details]
    return np.array([_text(text) for text in details], dtype=np.dtypes.StringDType())


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
    """Give what `details_of_document` wrote, checked; raises BrokenAnswerError where it is something else."""
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


def _refusal(details: Details) -> FileRefusedError:
    """The refusal as it was raised; only plain names stand in its braces, so that filling them can do nothing else."""
    where, what, remedy = (_text(details[name]) for name in TEXTS_OF_REFUSAL)
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
    except (LookupError, TypeError, ValueError, AttributeError, OverflowError, RecursionError, MemoryError) as error:
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

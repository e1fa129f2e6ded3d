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
from functools import cache
from itertools import repeat
from string import Formatter
from types import NoneType
from typing import IO, Any, TypeVar, cast, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from core.samples import FloatArray, ImuBlock
from devices.files.refusal import FileRefusedError

Array = NDArray[np.generic]
Details = dict[str, Any]
T = TypeVar("T")

LENGTH = struct.Struct("<Q")  # of the JSON; the arrays' lengths stand in it
PLAIN_NUMBERS = re.compile(r"[<>|][fiu][1248]")
MOST_ANSWER_BYTES = 2_000_000_000  # of JSON, and of arrays: more than any file that is let through can hold
MOST_REFUSAL = 20_000  # letters of each part
TIMES: Mapping[str, Any] = {"datetime": datetime.datetime, "date": datetime.date, "time": datetime.time}


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


def packed(value: object, arrays: list[Array]) -> Any:
    """A value of any dataclass of ours in JSON's own kinds, its arrays put into `arrays`."""
    match value:
        case FileRefusedError():
            return details_of_refusal(value)
        case np.ndarray() if PLAIN_NUMBERS.fullmatch(value.dtype.str):
            arrays.append(value)
            return len(arrays) - 1
        case np.ndarray():
            return [str(text) for text in value]
        case Mapping():
            return {key: packed(inner, arrays) for key, inner in value.items()}
        case tuple() | list():
            return [packed(inner, arrays) for inner in value]
        case str() | int() | float() | None:
            return value
    kind: Any = type(value)
    return {name: packed(getattr(value, name), arrays) for name in _fields_of(kind)}


def unpacked(kind: type[T], details: Any, arrays: Sequence[Array]) -> T:
    """What `packed` wrote, checked against the kinds that its dataclass states.

    Raises
    ------
    BrokenAnswerError
        Something else.
    """
    with _whatever_is_wrong():
        return cast(T, _of_kind(kind, details, arrays))


def _of_kind(kind: Any, details: Any, arrays: Sequence[Array]) -> object:
    origin, of = get_origin(kind), get_args(kind)
    if kind == FloatArray:
        return _samples(arrays[details])
    if origin is np.ndarray:  # of any numbers, else of texts
        return arrays[details] if isinstance(details, int) else np.array(details, dtype=np.dtypes.StringDType())
    if origin is tuple:
        kinds = repeat(of[0], len(details)) if of[-1] is Ellipsis else of
        return tuple(_of_kind(inner, one, arrays) for inner, one in zip(kinds, details, strict=True))
    if origin is Mapping:
        return {_of_kind(of[0], key, arrays): _of_kind(of[1], value, arrays) for key, value in details.items()}
    if NoneType in of:
        return None if details is None else _of_kind(of[0], details, arrays)
    if hasattr(kind, "__dataclass_fields__"):
        fields = _fields_of(kind)
        made = kind(**{name: _of_kind(inner, details[name], arrays) for name, inner in fields.items()})
        if isinstance(made, ImuBlock) and any(column.shape != made.time_s.shape for column in made.unknown.values()):
            raise BrokenAnswerError("columns of different lengths")
        return made
    if kind is FileRefusedError:
        return refusal_from(details)
    if kind is bool:
        return details is True
    if not isinstance(details, of or (str, int, float)):
        raise BrokenAnswerError(f"{type(details)}, expected {kind}")
    if kind is str and not isinstance(details, str):
        raise BrokenAnswerError(f"{type(details)}, expected a text")
    return details if of or kind is str else kind(details)


@cache
def _fields_of(kind: Any) -> dict[str, Any]:
    """The kinds of a dataclass's fields by their names, without what may be of any kind."""
    return {name: inner for name, inner in get_type_hints(kind).items() if inner != Mapping[str, object]}


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
        where, what, remedy = (details[name] for name in ("where", "what", "remedy"))
        values = {str(name): value for name, value in details["values"].items()}
        texts = (where, what, remedy, *values.values())
        if not all(isinstance(text, str) and len(text) <= MOST_REFUSAL for text in texts):
            raise BrokenAnswerError("a refusal of something else, or without end")
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

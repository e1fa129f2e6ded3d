"""The points, parameters and first frame of a C3D file, of any of the three processors that the format knows.

Layout: a header of 512 bytes, groups of parameters, then frames of points (x, y, z, and a residual that is negative
where the point was not seen) and analog samples. By the format's user guide (c3d.org); integers of points are scaled.
"""

import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from core.samples import FloatArray
from devices.files.refusal import FileRefusedError
from devices.files.table_header import COPY_AGAIN

BLOCK = 512  # bytes
KEY = 0x50  # the second byte of every C3D, and of its parameters
INTEL, DEC, MIPS = 84, 85, 86
SIZES = {-1: 1, 1: 1, 2: 2, 4: 4}  # bytes of each type of parameter: letters, bytes, integers, floats
MOST_PARAMETERS = 20_000
FULL_COUNT = 65_535  # of 16 bits: there are as many frames, or more

Value = list[str] | FloatArray
"""A parameter: texts, or numbers in the shape that the file gives."""


@dataclass(frozen=True, slots=True)
class C3dFile:
    """`parameters`: by group and name, in capitals. `points` (n, k, 3): NaN where one was not seen.

    `first_frame`: from 0.
    """

    parameters: Mapping[str, Mapping[str, Value]]
    first_frame: int
    points: FloatArray

    def texts(self, group: str, name: str) -> list[str]:
        """The texts of a parameter; a list over 255 goes on in NAME2 and so on."""
        found: list[str] = []
        number = 1
        while isinstance(value := self.parameters.get(group, {}).get(name if number == 1 else f"{name}{number}"), list):
            found += value
            number += 1
        return found

    def number(self, group: str, name: str) -> float:
        """The first number of a parameter; NaN where there is none."""
        return _number(self.parameters, group, name)


def read_c3d_file(path: Path) -> C3dFile:
    """Read a file; raises FileRefusedError where it is cut off or damaged."""
    size = path.stat().st_size
    try:
        with path.open("rb") as file:
            header = file.read(BLOCK)
            parameters, processor = _parameters(file, header, size, path.name)
            order = ">" if processor == MIPS else "<"
            points, analogs, first, last, _, start = struct.unpack(f"{order}2x5H4xH", header[:18])
            scale = _number(parameters, "POINT", "SCALE")
            scale = scale if math.isfinite(scale) else float(_floats(header[12:16], processor)[0])
            start = int(_number(parameters, "POINT", "DATA_START", float(start)))
            width = 2 if scale > 0 else 4
            frame = (4 * points + analogs) * width
            data_at = BLOCK * (start - 1)
            frames = _frame_count(parameters, first, last, (size - data_at) // frame if frame else 0)
            if not 0 < data_at <= size or size - data_at < frames * frame:
                raise _cut(path.name)
            file.seek(data_at)
            raw = file.read(frames * frame)
    except (struct.error, ValueError, IndexError, OverflowError, ZeroDivisionError) as error:
        raise FileRefusedError(path.name, "this C3D file cannot be read ({why})", COPY_AGAIN, why=error) from error
    if points == 0 or frames == 0:
        return C3dFile(parameters, first - 1, np.empty((frames, points, 3)))
    words = _integers(raw, order) * scale if width == 2 else _floats(raw, processor)
    values = words.reshape(frames, -1)[:, : 4 * points].reshape(frames, points, 4)
    found = values[:, :, :3].copy()
    is_seen = (values[:, :, 3] >= 0) & np.any(found != 0, axis=2)  # some programs write zeros alone
    found[~is_seen | ~np.isfinite(found).all(axis=2)] = np.nan
    return C3dFile(parameters, first - 1, found)


def _cut(where: str) -> FileRefusedError:
    return FileRefusedError(
        where, "this C3D file ends before the end of its data; it may have been cut off", COPY_AGAIN
    )


def _parameters(file: BinaryIO, header: bytes, size: int, where: str) -> tuple[dict[str, dict[str, Value]], int]:
    """The parameters by group and name, and the processor."""
    if len(header) < BLOCK:
        raise _cut(where)
    at = BLOCK * (header[0] - 1)
    file.seek(at)
    head = file.read(4)
    if len(head) < 4 or size < at + BLOCK * head[2]:
        raise _cut(where)
    processor = head[3]
    content = file.read(BLOCK * max(head[2], 1) - 4)
    order = ">" if processor == MIPS else "<"
    names: dict[int, str] = {}
    found: dict[int, dict[str, Value]] = {}
    place = 0
    for _ in range(MOST_PARAMETERS):
        if place + 2 > len(content) or content[place] == 0:
            break
        length, group = struct.unpack_from("bb", content, place)
        name = content[place + 2 : place + 2 + abs(length)].decode("latin-1").strip().upper()
        after = place + 2 + abs(length)
        (offset,) = struct.unpack_from(f"{order}h", content, after)
        if group < 0:
            names[-group] = name
        else:
            found.setdefault(group, {})[name] = _value(content, after + 2, processor)
        if offset <= 0:
            break
        place = after + offset
    return {names.get(group, ""): values for group, values in found.items()}, processor


def _value(content: bytes, at: int, processor: int) -> Value:
    kind, count = struct.unpack_from("bB", content, at)
    shape = tuple(content[at + 2 : at + 2 + count])
    if kind not in SIZES or len(shape) != count:
        raise ValueError("a parameter of no known type")
    many = math.prod(shape)
    raw = content[at + 2 + count : at + 2 + count + many * SIZES[kind]]
    if len(raw) < many * SIZES[kind]:
        raise ValueError("a parameter that is cut off")
    if kind == -1:
        length = shape[0] if shape else 1
        rows = [raw[k : k + length] for k in range(0, len(raw), length)] if length else []
        return [row.decode("utf-8", "replace").rstrip("\0").strip() for row in rows]
    if kind == 4:
        numbers = _floats(raw, processor)
    elif kind == 2:
        numbers = _integers(raw, ">" if processor == MIPS else "<")
    else:
        numbers = np.frombuffer(raw, np.int8).astype(np.float64)
    return numbers.reshape(shape, order="F")


def _number(parameters: Mapping[str, Mapping[str, Value]], group: str, name: str, otherwise: float = math.nan) -> float:
    value = parameters.get(group, {}).get(name)
    return float(value.flat[0]) if isinstance(value, np.ndarray) and value.size else otherwise


def _frame_count(parameters: Mapping[str, Mapping[str, Value]], first: int, last: int, in_file: int) -> int:
    """How many frames there are: some programs write them as a float, and 16 bits hold no long recording."""
    start, end = (parameters.get("TRIAL", {}).get(f"ACTUAL_{name}_FIELD") for name in ("START", "END"))
    if isinstance(start, np.ndarray) and isinstance(end, np.ndarray) and start.size == end.size == 2:
        one, other = (int(field.flat[0]) % 65_536 + 65_536 * (int(field.flat[1]) % 65_536) for field in (start, end))
        if other >= one > 0:
            return other - one + 1
    long = _number(parameters, "POINT", "LONG_FRAMES")
    count = long if long > 0 else _number(parameters, "POINT", "FRAMES", float(last - first + 1))
    count = count + 65_536 if count < 0 else count  # 16 bits without a sign
    if not math.isfinite(count):
        raise ValueError("no number of frames")
    return in_file if FULL_COUNT in (round(count), last) else round(count)


def _integers(raw: bytes, order: str) -> FloatArray:
    return np.frombuffer(raw, f"{order}i2").astype(np.float64)


def _floats(raw: bytes, processor: int) -> FloatArray:
    if processor != DEC:
        return np.frombuffer(raw, ">f4" if processor == MIPS else "<f4").astype(np.float64)
    words: NDArray[np.uint16] = np.frombuffer(raw, "<u2").reshape(-1, 2)[:, ::-1].astype("<u2")
    return words.copy().view("<f4").ravel().astype(np.float64) / 4.0  # its exponents count from another zero

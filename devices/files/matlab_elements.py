"""The elements of a MATLAB file of version 5, looked through before SciPy reads them.

SciPy looks types of elements up without asking whether there are such, so a damaged file ends the process. Here a file
is refused whose elements are of other types than MATLAB's description of the format has them at their place.
"""

import struct
import zlib
from collections.abc import Iterator

HEAD_BYTES = 128
BIG_ENDIAN = b"MI"
MATRIX, COMPRESSED, UINT32 = 14, 15, 6
SIZES, NAMES = frozenset({5, 6}), frozenset({1, 16})  # some programs write sizes without sign, names as UTF-8
NUMBERS = frozenset({1, 2, 3, 4, 5, 6, 7, 9, 12, 13})
LETTERS = frozenset({1, 2, 3, 4, 16, 17, 18})
CELL, STRUCTURE, OBJECT, TEXT, SPARSE, LARGEST_NUMBER, OPAQUE = 1, 2, 3, 4, 5, 15, 17  # classes of arrays
MOST_DEPTH = 40  # of matrices in matrices; SciPy goes down as deep without asking
MOST_UNPACKED = 1 << 31

Content = memoryview


class BrokenElementsError(ValueError):
    """Elements that the format does not have."""


def check_elements(content: bytes) -> None:
    """Check all elements of a file; raises BrokenElementsError for a wrong type or place, or zlib.error."""
    order = ">" if content[HEAD_BYTES - 2 : HEAD_BYTES] == BIG_ENDIAN else "<"
    for kind, element in _elements(memoryview(content)[HEAD_BYTES:], order):
        _check_variable(kind, element, order)


def _check_variable(kind: int, element: Content, order: str) -> None:
    if kind == COMPRESSED:
        unpacked = zlib.decompressobj().decompress(element, MOST_UNPACKED)
        for inner, matrix in _elements(memoryview(unpacked), order):
            _check_kind(inner, frozenset({MATRIX}))
            _check_matrix(matrix, order, 0)
    else:
        _check_kind(kind, frozenset({MATRIX}))
        _check_matrix(element, order, 0)


def _check_matrix(content: Content, order: str, depth: int) -> None:
    """Flags, size and name, then what its class holds."""
    if depth > MOST_DEPTH:
        raise BrokenElementsError("too deep")
    if not content:
        return  # an empty one in a cell is written so
    elements = _elements(content, order)
    kind, flags = next(elements, (0, content))
    _check_kind(kind, frozenset({UINT32}))
    if len(flags) != 8:
        raise BrokenElementsError("flags of another length")
    of_class = struct.unpack(f"{order}I", flags[:4])[0] & 0xFF
    if not CELL <= of_class <= OPAQUE:
        raise BrokenElementsError(f"class {of_class}")
    expected = [NAMES] * 3 if of_class == OPAQUE else [SIZES, NAMES]
    expected += [NAMES] if of_class == OBJECT else []
    expected += [SIZES, NAMES] if of_class in (STRUCTURE, OBJECT) else []
    then = {TEXT: LETTERS, **dict.fromkeys(range(SPARSE, LARGEST_NUMBER + 1), NUMBERS)}.get(
        of_class, frozenset({MATRIX})
    )
    for number, (kind, element) in enumerate(elements):
        _check_kind(kind, expected[number] if number < len(expected) else then)
        if kind == MATRIX:
            _check_matrix(element, order, depth + 1)


def _elements(content: Content, order: str) -> Iterator[tuple[int, Content]]:
    """Type and content of each element; a short one holds up to four bytes in its own head."""
    at = 0
    while at < len(content):
        if len(content) - at < 8:
            raise BrokenElementsError("an element without its head")
        kind, size = struct.unpack(f"{order}II", content[at : at + 8])
        if kind >> 16:
            kind, size = kind & 0xFFFF, kind >> 16
            if size > 4:
                raise BrokenElementsError("a short element that is too long")
            start, following = at + 4, at + 8
        else:
            start = at + 8
            following = start + size + (0 if kind == COMPRESSED else -size % 8)
        if start + size > len(content):
            raise BrokenElementsError("an element that is cut off")
        yield kind, content[start : start + size]
        at = following


def _check_kind(kind: int, expected: frozenset[int]) -> None:
    if kind not in expected:
        raise BrokenElementsError(f"type {kind}")

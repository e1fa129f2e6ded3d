"""The streams of numbers in an XDF file, as LabRecorder writes them: labels, units, samples and stamps.

The file is looked through first: its chunks have to fit into it, and only streams of numbers are read. Stamps are
brought to the recording computer's clock by the offsets that stand in the file; they are made even elsewhere.
"""

import logging
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from importlib.util import find_spec
from pathlib import Path
from typing import Any, BinaryIO
from xml.etree.ElementTree import Element, ParseError, fromstring

import numpy as np

from core.samples import FloatArray
from devices.files.hdf5 import INSTALL_IT
from devices.files.refusal import FileRefusedError

SIGNATURE = b"XDF:"
LIBRARY = "pyxdf"
COPY_AGAIN = "Copy the file again from the computer that runs LabRecorder"
FILE_HEADER, STREAM_HEADER, STREAM_FOOTER = 1, 2, 6  # tags of chunks
LENGTHS = {1: "<B", 4: "<I", 8: "<Q"}
NUMBERS = frozenset({"float32", "double64", "int8", "int16", "int32", "int64"})
MOST_STREAMS, MOST_CHANNELS = 200, 1000
DAMAGES = (
    ValueError,
    TypeError,
    LookupError,
    EOFError,
    ArithmeticError,
    AttributeError,
    RuntimeError,
    struct.error,
    ParseError,
)


@dataclass(frozen=True, slots=True, eq=False)
class XdfStream:
    """One stream of numbers.

    `labels`, `units`: of its channels; empty where they are not given.
    """

    name: str
    source: str
    host: str
    labels: Sequence[str]
    units: Sequence[str]
    rate_hz: float | None  # as the sender gives it; None: it gives none
    samples: FloatArray  # (n, channels)
    stamp_s: FloatArray  # (n,): on the recording computer's clock where `has_clock`, else on the sender's
    has_clock: bool  # the distance of the two clocks was measured
    is_whole: bool  # it ends as LabRecorder ends streams, with all samples that it counted


@dataclass(frozen=True, slots=True)
class XdfRecording:
    """`others`: names of the streams of texts. `started`: as the file gives it, empty where it does not."""

    streams: tuple[XdfStream, ...]
    others: tuple[str, ...]
    started: str


def read_xdf(path: Path) -> XdfRecording:
    """Read a file's streams of numbers; raises FileRefusedError without library or for a damaged file."""
    if find_spec(LIBRARY) is None:
        raise FileRefusedError(
            path.name, "reading the file needs {library}, which is not installed", INSTALL_IT, library=LIBRARY
        )
    import pyxdf  # an extra

    logging.getLogger("pyxdf").setLevel(logging.CRITICAL)  # what is lost is found by what streams count of themselves
    try:
        with path.open("rb") as file:
            heads, ends, started = _looked_through(file, path.stat().st_size)
            of_numbers = [number for number, head in heads.items() if _text(head, "channel_format") in NUMBERS]
            if not of_numbers:
                return XdfRecording((), tuple(_text(head, "name") for head in heads.values()), started)
            damaged: set[int] = set()

            def check(values: Any, stamps: Any, info: Any, number: int) -> tuple[Any, Any, Any]:
                """Samples that do not end where their chunk does are none; what is raised makes pyxdf go on behind."""
                if file.tell() not in ends:
                    damaged.add(number)
                    raise ValueError("a chunk of another length")
                return values, stamps, info

            file.seek(0)
            read, _ = pyxdf.load_xdf(file, of_numbers, on_chunk=check, dejitter_timestamps=False)
            return XdfRecording(
                tuple(_stream(one, heads[number := one["info"]["stream_id"]], number in damaged) for one in read),
                tuple(_text(head, "name") for number, head in heads.items() if number not in of_numbers),
                started,
            )
    except DAMAGES as error:
        raise FileRefusedError(path.name, "the file cannot be read as XDF and may be damaged", COPY_AGAIN) from error


def _looked_through(file: BinaryIO, size: int) -> tuple[dict[int, Element], set[int], str]:
    """The heads of the streams by their numbers, where chunks end, and when the recording started."""
    heads: dict[int, Element] = {}
    ends: set[int] = set()
    started = ""
    if file.read(len(SIGNATURE)) != SIGNATURE:
        raise ValueError("no XDF")
    for tag, start, end in _chunks(file, size):
        ends.add(end)
        if tag not in (FILE_HEADER, STREAM_HEADER):
            continue
        file.seek(start)
        if tag == FILE_HEADER:
            started = _moment(_text(fromstring(file.read(end - start)), "datetime"))
            continue
        (number,) = struct.unpack("<I", file.read(4))
        head = fromstring(file.read(end - start - 4).decode("utf-8", "replace"))
        if number in heads or len(heads) == MOST_STREAMS or not 0 < int(_text(head, "channel_count")) <= MOST_CHANNELS:
            raise ValueError("streams that there cannot be")
        heads[number] = head
    return heads, ends, started


def _chunks(file: BinaryIO, size: int) -> Iterator[tuple[int, int, int]]:
    """The tag of each chunk, and where its content starts and ends; the last may be cut off."""
    at = file.tell()
    while at < size:
        file.seek(at)
        width = file.read(1)[0]
        content = file.read(width)
        if width not in LENGTHS:
            raise ValueError("a length of no known size")
        if len(content) < width:
            return
        (length,) = struct.unpack(LENGTHS[width], content)
        start = at + 1 + width
        at = start + length
        if length < 2:
            raise ValueError("a chunk without its tag")
        if at <= size:
            yield struct.unpack("<H", file.read(2))[0], start + 2, at


def _stream(read: Mapping[str, Any], head: Element, is_damaged: bool) -> XdfStream:
    samples = np.asarray(read["time_series"], dtype=np.float64)
    stamps = np.asarray(read["time_stamps"], dtype=np.float64)
    channels = list(head.iterfind("desc/channels/channel"))[:MOST_CHANNELS]
    counted = str(((read.get("footer") or {}).get("info") or {}).get("sample_count", [""])[0])
    rate_hz = float(_text(head, "nominal_srate"))
    return XdfStream(
        name=_text(head, "name"),
        source=_text(head, "source_id"),
        host=_text(head, "hostname"),
        labels=[_text(one, "label") for one in channels],
        units=[_text(one, "unit") for one in channels],
        rate_hz=rate_hz if 0.0 < rate_hz < np.inf else None,
        samples=samples,
        stamp_s=stamps,
        has_clock=bool(read["clock_times"]),
        is_whole=not is_damaged and counted.isdecimal() and int(counted[:18]) <= len(stamps),
    )


def _text(element: Element, name: str) -> str:
    return " ".join((element.findtext(name) or "").split())[:200]


def _moment(text: str) -> str:
    try:
        return datetime.fromisoformat(text).isoformat()
    except ValueError:
        return ""

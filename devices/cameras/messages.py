"""What the process of a camera writes, one message after the other: its mode, its frames, its end, a list of cameras.

A message is its kind, the length of its content, and that. Who receives it trusts none of it.
"""

import json
import math
import struct
from collections.abc import Mapping
from typing import IO, Any

from devices.cameras.camera import CameraMode, CapturedFrame

MODE, FRAME, ENDED, CAMERAS = b"M", b"F", b"E", b"C"
HEAD = struct.Struct("<cI")
FRAME_HEAD = struct.Struct("<qqq")  # number, arrival, pts
NO_PTS = -(2**63)
MOST_BYTES = 20_000_000  # a JPEG of 1280 x 720 takes 0.1 million
MOST_PIXELS, MOST_RATE_HZ = 10_000, 1000.0
JPEG_BEGINS, JPEG_ENDS = b"\xff\xd8", b"\xff\xd9"


class BrokenMessageError(Exception):
    """A message that no process of ours writes."""


def send_frame(stream: IO[bytes], frame: CapturedFrame) -> None:
    """Write one frame."""
    pts_ns = NO_PTS if frame.pts_ns is None else frame.pts_ns
    _send(stream, FRAME, FRAME_HEAD.pack(frame.number, frame.arrival_ns, pts_ns) + frame.jpeg)


def send_details(stream: IO[bytes], kind: bytes, details: object) -> None:
    """Write a message of another kind, in JSON."""
    _send(stream, kind, json.dumps(details).encode())


def _send(stream: IO[bytes], kind: bytes, content: bytes) -> None:
    stream.write(HEAD.pack(kind, len(content)) + content)
    stream.flush()


def receive(stream: IO[bytes]) -> tuple[bytes, bytes]:
    """Kind and content of the next message; raises BrokenMessageError, or EOFError where nobody is there."""
    kind, length = HEAD.unpack(_exactly(stream, HEAD.size))
    if length > MOST_BYTES:
        raise BrokenMessageError(f"a message of {length} bytes")
    return kind, _exactly(stream, length)


def _exactly(stream: IO[bytes], length: int) -> bytes:
    content = stream.read(length)
    if len(content) < length:
        raise EOFError
    return content


def frame_of(content: bytes, last: int) -> CapturedFrame:
    """The frame that a message holds; `last` is the number of the one before it."""
    if len(content) < FRAME_HEAD.size:
        raise BrokenMessageError("half a frame")
    number, arrival_ns, pts_ns = FRAME_HEAD.unpack_from(content)
    jpeg = content[FRAME_HEAD.size :]
    if number <= last or not jpeg.startswith(JPEG_BEGINS) or not jpeg.endswith(JPEG_ENDS):
        raise BrokenMessageError("no frame")
    return CapturedFrame(number, arrival_ns, None if pts_ns == NO_PTS else pts_ns, jpeg)


def details_of(content: bytes) -> Any:
    """What a message in JSON holds."""
    try:
        return json.loads(content)
    except (ValueError, RecursionError) as problem:
        raise BrokenMessageError("no JSON") from problem


def mode_of(content: bytes) -> CameraMode:
    """The mode that a message holds."""
    match details_of(content):
        case {"width": int(width), "height": int(height), "rate_hz": float(rate_hz)} if (
            0 < width <= MOST_PIXELS
            and 0 < height <= MOST_PIXELS
            and math.isfinite(rate_hz)
            and 0.0 < rate_hz <= MOST_RATE_HZ
        ):
            return CameraMode(width, height, rate_hz)
    raise BrokenMessageError("no mode")


def cause_of(content: bytes) -> tuple[str, str]:
    """Why it ended, and the same in the words of the system, for the log."""
    details = details_of(content)
    if isinstance(details, Mapping) and isinstance(details.get("cause"), str):
        return details["cause"], str(details.get("detail", ""))[:200]
    raise BrokenMessageError("no end")

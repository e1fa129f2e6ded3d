"""A video that was made elsewhere, as the limited process hands it over: piece by piece, each frame a JPEG."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from core.samples import FloatArray
from devices.files.answers import Array, BrokenAnswerError

MOST_SIDE = 1280  # of a frame, as a camera's here
MOST_FRAMES = 300  # of one piece: some 20 MB
MOST_VIDEO_BYTES = 4_000_000_000
MOST_VIDEO_S = 1800.0
PIECE_S = 60.0  # that decoding one piece may take; a slow machine decodes 300 frames of 4K in 20
MOST_RATE_HZ = 1000.0


@dataclass(frozen=True, slots=True)
class VideoPiece:
    """Consecutive frames of a video.

    Attributes
    ----------
    time_s : (n,)
        Seconds from the video's first frame, as the file states them, ascending.
    jpegs
        The n frames, upright, at most 1280 pixels wide and high.
    is_end
        No frame comes after these.
    is_damaged
        It ends here because what comes after cannot be read, and not because the video does.
    width, height, rate_hz, length_s
        Of the frames here; the mean rate and the length as the file states them, NaN where it does not.
    """

    time_s: FloatArray
    jpegs: tuple[bytes, ...]
    is_end: bool
    is_damaged: bool
    width: int
    height: int
    rate_hz: float
    length_s: float


def details_of_piece(piece: VideoPiece, arrays: list[Array]) -> dict[str, object]:
    """The piece as the limited process sends it."""
    lengths = np.array([len(jpeg) for jpeg in piece.jpegs], np.int64)
    arrays += [piece.time_s, lengths, np.frombuffer(b"".join(piece.jpegs), np.uint8)]
    return {
        "is_end": piece.is_end,
        "is_damaged": piece.is_damaged,
        "width": piece.width,
        "height": piece.height,
        "rate_hz": None if math.isnan(piece.rate_hz) else piece.rate_hz,
        "length_s": None if math.isnan(piece.length_s) else piece.length_s,
    }


def piece_from(details: Any, arrays: Sequence[Array]) -> VideoPiece:
    """The piece that was sent, checked; raises BrokenAnswerError."""
    match details, arrays:
        case (
            {
                "is_end": bool(is_end),
                "is_damaged": bool(is_damaged),
                "width": int(width),
                "height": int(height),
                "rate_hz": rate_hz,
                "length_s": length_s,
            },
            [time_s, lengths, content],
        ) if (
            0 < width <= MOST_SIDE
            and 0 < height <= MOST_SIDE
            and [array.dtype.str for array in (time_s, lengths, content)] == ["<f8", "<i8", "|u1"]
            and time_s.shape == lengths.shape == (len(time_s),)
            and len(time_s) <= MOST_FRAMES
            and content.shape == (sum(map(int, lengths)),)
            and all(int(length) > 0 for length in lengths)
        ):
            times = np.asarray(time_s, np.float64)
            ends = np.cumsum(np.asarray(lengths, np.int64))
            jpegs = tuple(content[end - length : end].tobytes() for end, length in zip(ends, lengths, strict=True))
            is_in_order = np.all(np.isfinite(times)) and np.all(np.diff(times) > 0.0)
            if is_in_order and all(one.startswith(b"\xff\xd8") and one.endswith(b"\xff\xd9") for one in jpegs):
                return VideoPiece(times, jpegs, is_end, is_damaged, width, height, _number(rate_hz), _number(length_s))
    raise BrokenAnswerError("no piece of a video")


def _number(stated: object) -> float:
    if stated is None:
        return math.nan
    if isinstance(stated, float) and math.isfinite(stated) and stated > 0.0:
        return stated
    raise BrokenAnswerError("no number")

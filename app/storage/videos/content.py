"""Records of a video's file: it is a journal with one source, whose bytes are frames.

Its first mark states whose it is. Each frame is one record: `FRAME`, when it arrived and when the camera states that it
was taken, in nanoseconds, then the JPEG.
"""

import json
import struct
from dataclasses import asdict, dataclass
from typing import Any, Self
from uuid import UUID

from app.storage.journal.payloads import STREAM
from app.storage.journal.records import MAX_PAYLOAD

FRAME = struct.Struct("<qq")
NO_PTS = -1  # the camera states no time of its own
BEGINNING = "gaitwright-video/1 "  # how the mark begins
MOST_BYTES = MAX_PAYLOAD - STREAM.size - FRAME.size  # of one picture; at 1280 x 720 a tenth of it is usual


@dataclass(frozen=True, slots=True)
class ClipMark:
    """What a video states of itself: `recording_opened_ns` is where the times of its walk's samples begin."""

    recording: UUID
    recording_opened_ns: int
    camera: int
    view: str
    width: int
    height: int
    rate_hz: float
    is_imported: bool

    def text(self) -> str:
        return BEGINNING + json.dumps({**asdict(self), "recording": str(self.recording)})

    @classmethod
    def parsed(cls, payload: bytes) -> Self | None:
        """What `text` has written into a mark; None of any other mark."""
        text: str = json.loads(payload)
        if not text.startswith(BEGINNING):
            return None
        reported: dict[str, Any] = json.loads(text.removeprefix(BEGINNING))
        return cls(**{**reported, "recording": UUID(reported["recording"])})

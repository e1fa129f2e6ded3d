"""One clip: a walk as one camera saw it, frame by frame, and how its times become those of the samples."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol
from uuid import UUID

import numpy as np

from core.samples import FloatArray

MOST_APART = 2.0  # of the time between two frames: further away, a frame is of another moment


class SyncBy(StrEnum):
    """What a clip's times were brought to those of the samples by."""

    CLOCK = "clock"  # of the computer alone, with the camera's delay unknown
    MOTION = "motion"
    HAND = "hand"


@dataclass(frozen=True, slots=True)
class Sync:
    """`offset_s` is added to a frame's time; `sd_s` is its standard deviation, NaN where it is not known."""

    offset_s: float
    sd_s: float
    by: SyncBy


class Pictures(Protocol):
    """The frames of a clip, each a JPEG of its own. May be asked by any thread; a damaged one raises OSError."""

    def __len__(self) -> int: ...

    def jpeg(self, number: int) -> bytes: ...


@dataclass(frozen=True, slots=True)
class Clip:
    """`recording` names the walk, `view` is where the camera is, as it was entered.

    `stamped_s`, shape (frames,): when each frame was taken, on the recording's clock, as the camera's frames came.
    `sync`: None for a clip made elsewhere whose times are not known yet.
    """

    id: UUID
    recording: str
    camera: int
    view: str
    width: int
    height: int
    rate_hz: float
    stamped_s: FloatArray
    sync: Sync | None
    pictures: Pictures

    @property
    def time_s(self) -> FloatArray:
        """Time of each frame among the samples, shape (frames,)."""
        return self.stamped_s + (self.sync.offset_s if self.sync is not None else 0.0)

    @property
    def is_synchronised(self) -> bool:
        """Whether it is known how far its times may be off; else no value is shown for a frame."""
        return self.sync is not None and math.isfinite(self.sync.sd_s)

    def frame_at(self, time_s: float) -> int | None:
        """Number of the frame at a time of the samples; None where the nearest is of another moment."""
        if not len(self.stamped_s):
            return None
        number = self.nearest(time_s)
        return number if abs(float(self.time_s[number]) - time_s) <= MOST_APART / self.rate_hz else None

    def nearest(self, time_s: float) -> int:
        """Number of the frame that was taken nearest to a time of the samples."""
        return int(np.argmin(np.abs(self.time_s - time_s)))

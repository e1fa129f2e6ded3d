"""What has to be known of a source so that its bytes can be read again, and what that brings.

A driver's decoder makes samples of bytes; it is the same one live and when a journal is read, so it may use nothing but
what a `SourceInfo` holds and the bytes themselves.
"""

from collections.abc import Mapping
from dataclasses import astuple, dataclass, field
from typing import Protocol

from core.samples import FloatArray, ImuBlock


@dataclass(frozen=True, slots=True)
class SourceInfo:
    """One stream of bytes or samples: a port, a socket, an inlet, the walker, a file.

    Attributes
    ----------
    driver, version
        Which decoder understands the stream, and the version of it that recorded.
    sensors
        Serial numbers or names, where they are known before the first byte.
    settings
        Everything decoding needs besides: rates, ranges, units, mappings. What JSON can hold.
    """

    driver: str
    version: str
    serial: str = ""
    sensors: tuple[str, ...] = ()
    settings: Mapping[str, object] = field(default_factory=dict)
    is_simulated: bool = False


@dataclass(frozen=True, slots=True)
class SensorCounts:
    """What became of one sensor's samples."""

    received: int = 0  # samples that are there, each counted once
    lost: int = 0  # missing by the device's counter, or by the clock where there is none
    damaged: int = 0  # frames that failed their check, samples without a time
    doubled: int = 0  # samples that came again; the first was kept
    late: int = 0  # samples that came after a younger one; put back in their place

    def __add__(self, other: "SensorCounts") -> "SensorCounts":
        return SensorCounts(*(a + b for a, b in zip(astuple(self), astuple(other), strict=True)))


@dataclass(frozen=True, slots=True)
class SharedClock:
    """A sensor's samples by a clock that it shares with others; what puts them right together: `clocks.shared_clock`.

    `arrived_s`: (n,): when it arrived, in seconds since the journal was opened; of what was fetched from a memory (0,).
    `ahead_s`: of what was fetched from a memory: between what bounds the journal's seconds are ahead of this clock's,
    by when its beginning and its end were ordered.
    """

    name: str  # of the clock; the same for all that share it
    device_s: FloatArray  # (n,): when each sample of the block was taken, by that clock
    arrived_s: FloatArray
    turn_s: float = 0.0  # after how long the clock begins again; 0: never
    ahead_s: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class DecodedSensor:
    """One sensor's samples in order of time, and what was missing. `clock` None: it has one of its own."""

    block: ImuBlock
    counts: SensorCounts
    clock: SharedClock | None = None


class StreamDecoder(Protocol):
    """A driver's understanding of one stream. Damaged bytes are counted, never raised."""

    def begin(self, source: SourceInfo) -> None:
        """What follows was sent under `source` and does not join the bytes before: a start, a change, or a loss."""

    def feed(self, data: bytes, host_time_s: float) -> None:
        """Take the next bytes, in pieces of any size, read at `host_time_s` after the journal was opened."""

    def finish(self) -> Mapping[str, DecodedSensor]:
        """All samples by sensor, their time in seconds since the journal was opened."""

"""Samples of a Movella DOT out of a journal: what it streamed, or the file that was fetched from its memory.

How the host's clock follows from a file's is known by its orders alone, for nothing arrived as it was taken: its first
sample came after it was asked to begin, its last before it stated that it had ended. Sensors on one clock bound it
together, to some hundredths of a second (`clocks/shared_clock.py`); to one another they are as exact as their clock.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from devices.dot.messages import RecordedFile
from devices.dot.samples import DRIVER, TURN_S, VERSION, DotFramer, FileFramer
from devices.source import DecodedSensor, SourceInfo
from devices.stream import Decoder, Received, decoded

BEGINS_WITHIN_S = 0.25  # of when it first states that it records, the first sample is taken
BEGUN_TOGETHER_S = 6.0  # memories whose orders nobody knows were begun within this, one after the other


@dataclass(frozen=True, slots=True)
class FileOrders:
    """When a file was ordered, in seconds since the journal was opened."""

    begun_s: tuple[float, float]  # when it was first asked to begin, and when it stated that it records
    ended_s: float  # when it stated that it had ended


def file_settings(
    file: RecordedFile, rate_hz: float | None, clock: str = "", orders: FileOrders | None = None
) -> dict[str, object]:
    """Give what a `SourceInfo` holds of a fetched file, for JSON; `orders` None: only the second in its name."""
    settings: dict[str, object] = {"file": [file.number, file.started_utc_s]}
    if rate_hz is not None:
        settings["rate_hz"] = rate_hz
    if clock:
        settings |= {"clock": clock, "turn_s": TURN_S}
    if orders is not None:
        settings["ordered_s"] = [*orders.begun_s, orders.ended_s]
    return settings


class _Streamed:
    """See `devices.stream.Framing`."""

    driver, version = DRIVER, VERSION

    def framer(self, info: SourceInfo) -> DotFramer:
        return DotFramer(info)


class DotDecoder:
    """See `devices.source.StreamDecoder`. A file is one however often its link was lost while it was fetched."""

    def __init__(self) -> None:
        self._streamed = Decoder(_Streamed())
        self._file: FileFramer | None = None
        self._info: SourceInfo | None = None

    def begin(self, source: SourceInfo) -> None:
        if "file" not in source.settings:
            self._streamed.begin(source)
        elif self._file is None or self._info is None or self._info.settings["file"] != source.settings["file"]:
            self._file, self._info = FileFramer(), source
        else:
            self._file.cut()

    def feed(self, data: bytes, host_time_s: float) -> None:
        if self._file is not None:
            self._file.feed(data)
        else:
            self._streamed.feed(data, host_time_s)

    def finish(self) -> Mapping[str, DecodedSensor]:
        if self._file is None or self._info is None:
            return self._streamed.finish()
        return {self._info.sensors[0]: _fetched(self._info, self._file)}


def _fetched(info: SourceInfo, file: FileFramer) -> DecodedSensor:
    rows, orientations = file.rows()
    ahead_s = _ahead_s(info.settings, rows[0][0], rows[-1][0]) if rows else (0.0, 0.0)
    host_s = [row[0] + sum(ahead_s) / 2 for row in rows]
    name = info.settings.get("clock")
    shared = (name, TURN_S) if isinstance(name, str) else None
    one = decoded(info.sensors[0], Received(rows, orientations, file.damaged), host_s, clock=shared)
    lost = sum(map(len, file.missing()))
    clock = None if one.clock is None else replace(one.clock, arrived_s=one.clock.arrived_s[:0], ahead_s=ahead_s)
    return replace(one, counts=replace(one.counts, lost=lost), clock=clock)


def _ahead_s(settings: Mapping[str, object], first_s: float, last_s: float) -> tuple[float, float]:
    """Between what bounds the journal's seconds are ahead of the sensor's."""
    ordered_s = settings.get("ordered_s")
    if not isinstance(ordered_s, list) or len(ordered_s) != 3:
        return -first_s, BEGUN_TOGETHER_S - first_s
    reported_s, recording_s, ended_s = map(float, ordered_s)
    low_s, high_s = reported_s - first_s, min(recording_s + BEGINS_WITHIN_S - first_s, ended_s - last_s)
    return low_s, max(low_s, high_s)

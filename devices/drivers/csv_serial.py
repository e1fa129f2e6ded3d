"""Lines of numbers over a serial port, as home-made sensors send them: somebody states what the columns mean."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from core.samples import G_M_S2
from devices.clocks.clock import Unwrapping
from devices.live import SensorDetails, SourceRefusedError
from devices.source import SourceInfo
from devices.stream import Framer, Received, listen
from devices.transport.channels import Channel

DRIVER, VERSION, MODEL = "csv", "1", "CSV over serial"
MOST_LINE = 1024
RATE_UNITS = {"rad/s": 1.0, "deg/s": math.pi / 180.0, "mdeg/s": math.pi / 180e3}
FORCE_UNITS = {"m/s2": 1.0, "g": G_M_S2, "mg": G_M_S2 / 1000}
MOST_RAD_S, MOST_M_S2 = 100.0, 500.0  # no sensor worn by a person measures more
SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t", "space": " "}
WRAPS = (0, 16, 24, 32)
STATES_S, ENOUGH_ROWS = 2.0, 3


@dataclass(frozen=True, slots=True)
class Columns:
    """What the columns of a line mean, counted from 0.

    Attributes
    ----------
    time
        The column of the sensor's clock, in ticks of `tick_hz` (1: seconds, 1000: milliseconds, or the rate where
        samples are counted).
    rate, force
        Three columns each, in the order of the sensor's axes; `signs` of all six turns an axis round.
    wraps_bits
        After so many bits the clock begins again; 0: never.
    count
        How many columns a line has, so that one that was cut or ran into the next is no sample; 0: not given.
    rate_hz
        Where it is known, losses are counted by it.

    Raises
    ------
    ValueError
        A unit or separator is not known, or columns are not as they must be.
    """

    time: int
    rate: tuple[int, ...]
    force: tuple[int, ...]
    tick_hz: float = 1000.0
    wraps_bits: int = 0
    rate_unit: str = "deg/s"
    force_unit: str = "g"
    separator: str = "comma"
    signs: tuple[int, ...] = (1, 1, 1, 1, 1, 1)
    count: int = 0
    rate_hz: float | None = None

    def __post_init__(self) -> None:
        every = (self.time, *self.rate, *self.force)
        if len(self.rate) != 3 or len(self.force) != 3 or len(set(every)) != 7 or min(every) < 0:
            raise ValueError(f"seven columns of their own are needed, got {every}")
        if self.rate_unit not in RATE_UNITS or self.force_unit not in FORCE_UNITS:
            raise ValueError(f"no such unit: {self.rate_unit}, {self.force_unit}")
        if self.separator not in SEPARATORS or self.wraps_bits not in WRAPS or not self.tick_hz > 0:
            raise ValueError(f"expected one of {[*SEPARATORS]}, one of {WRAPS} bits and ticks per second")
        if len(self.signs) != 6 or not set(self.signs) <= {1, -1}:
            raise ValueError(f"six signs are needed, got {self.signs}")

    def settings(self) -> dict[str, object]:
        """As a journal keeps it."""
        settings: dict[str, object] = {"columns": asdict(self)}
        if self.rate_hz:
            settings["rate_hz"] = self.rate_hz
        return settings

    @classmethod
    def parsed(cls, settings: Mapping[str, object]) -> "Columns":
        """Read what `settings` wrote.

        Raises
        ------
        ValueError, TypeError
            It is something else.
        """
        columns = settings.get("columns")
        if not isinstance(columns, Mapping):
            raise ValueError("the journal does not say what the columns mean")
        lists = {key: tuple(columns[key]) for key in ("rate", "force", "signs") if key in columns}
        return cls(**{**columns, **lists})


class CsvFramer:
    """The `Framer` of lines. A heading, or another line that is no row of numbers, is skipped before the first row."""

    def __init__(self, columns: Columns) -> None:
        self.received = Received()
        self._columns, self._rest, self._is_cut, self._has_begun = columns, b"", True, False
        self._separator = SEPARATORS[columns.separator].encode()
        self._last = max(columns.time, *columns.rate, *columns.force)
        units = [RATE_UNITS[columns.rate_unit]] * 3 + [FORCE_UNITS[columns.force_unit]] * 3
        places = [*columns.rate, *columns.force]
        self._scales = [(place, unit * sign) for place, unit, sign in zip(places, units, columns.signs, strict=True)]
        self._unwrapping = Unwrapping(columns.wraps_bits, columns.tick_hz) if columns.wraps_bits else None

    def feed(self, data: bytes, host_s: float) -> None:
        lines = (self._rest + data).split(b"\n")
        self._rest = lines.pop()
        for line in lines:
            if self._is_cut:  # half a number looks like one
                self._is_cut = False
            elif not self._take(line.strip(), host_s):
                self.received.damaged += self._has_begun
                self.received.skipped += not self._has_begun
        if len(self._rest) > MOST_LINE:
            self.received.damaged += self._has_begun and not self._is_cut
            self._rest, self._is_cut = b"", True

    def flush(self) -> None:
        """Nothing was held back: the rest is half a line."""

    def _take(self, line: bytes, host_s: float) -> bool:
        if len(line) > MOST_LINE:
            return False
        parts = line.split() if self._separator == b" " else line.split(self._separator)
        if len(parts) <= self._last or len(parts) != (self._columns.count or len(parts)):
            return False
        try:
            time = float(parts[self._columns.time])
            values = [float(parts[place]) * scale for place, scale in self._scales]
        except ValueError:
            return False
        gx, gy, gz, ax, ay, az = values
        is_meant = (
            -MOST_RAD_S < gx < MOST_RAD_S
            and -MOST_RAD_S < gy < MOST_RAD_S
            and -MOST_RAD_S < gz < MOST_RAD_S
            and -MOST_M_S2 < ax < MOST_M_S2
            and -MOST_M_S2 < ay < MOST_M_S2
            and -MOST_M_S2 < az < MOST_M_S2
            and math.isfinite(time / self._columns.tick_hz)
        )
        if not is_meant:
            return False
        if self._unwrapping is not None:
            if not 0 <= time < 1 << self._columns.wraps_bits:
                return False
            time = self._unwrapping.ticks(int(time), host_s)
        self._has_begun = True
        self.received.rows.append((time / self._columns.tick_hz, gx, gy, gz, ax, ay, az))
        return True


class CsvSerial:
    """The `SensorProtocol` of lines of numbers. Without `columns` it reads journals only, which contain them."""

    driver, version = DRIVER, VERSION

    def __init__(self, columns: Columns | None = None, name: str = "") -> None:
        self._columns, self._name = columns, name

    def framer(self, info: SourceInfo) -> Framer:
        return CsvFramer(self._columns or Columns.parsed(info.settings))

    def identifying(self) -> bytes:
        return b""

    def greet(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        if self._columns is None:
            raise ValueError("nobody stated what the columns mean")
        framer = CsvFramer(self._columns)
        listen(channel, framer, lambda received: b"enough" if len(received.rows) >= ENOUGH_ROWS else b"", STATES_S)
        if not framer.received.rows:
            raise SourceRefusedError(
                "{place} sends no text lines (CSV) in the expected format",
                "Compare its columns, separator and baud rate with what the sensor sends",
                place=channel.place,
            )
        sensor = self._name or channel.serial or channel.place
        info = SourceInfo(DRIVER, VERSION, channel.serial, (sensor,), self._columns.settings())
        return info, SensorDetails(MODEL, channel.serial, "", self._columns.rate_hz)

"""A home-made sensor that is not there: a line of numbers for every sample, and deaf."""

from collections.abc import Callable

from devices.clocks.host_clock import host_time_ns
from devices.drivers.csv_serial import Columns
from devices.emulators.evenly import EvenVoice, Motion

COLUMNS = Columns(time=0, rate=(1, 2, 3), force=(4, 5, 6), count=7)
"""What its columns are: milliseconds, deg/s, g."""


class LineVoice(EvenVoice):
    """The `Voice` of one sensor."""

    def __init__(self, motion: Motion, *, rate_hz: float = 100.0, now_ns: Callable[[], int] = host_time_ns) -> None:
        super().__init__(motion, now_ns)
        self._rate_hz = rate_hz

    @property
    def rate_hz(self) -> float:
        return self._rate_hz

    def sample(self, number: int) -> bytes:
        """The line of one sample."""
        gx, gy, gz, ax, ay, az = self._motion(number)
        ms = round(number * 1000 / self.rate_hz)
        return f"{ms},{gx:.3f},{gy:.3f},{gz:.3f},{ax:.4f},{ay:.4f},{az:.4f}\r\n".encode()

    def hear(self, data: bytes) -> bytes:
        return b""

"""A home-made sensor that is not there: a line of numbers for every sample, and deaf."""

from collections.abc import Callable, Sequence

from devices.clocks.host_clock import host_time_ns
from devices.drivers.csv_serial import Columns

Motion = Callable[[int], Sequence[float]]
"""Rate in deg/s (3) and force in g (3) of the sample of this number."""

COLUMNS = Columns(time=0, rate=(1, 2, 3), force=(4, 5, 6), count=7)
"""What its columns are: milliseconds, deg/s, g."""


class LineVoice:
    """The `Voice` of one sensor."""

    def __init__(self, motion: Motion, *, rate_hz: float = 100.0, now_ns: Callable[[], int] = host_time_ns) -> None:
        self._motion, self._now_ns, self._begin_ns = motion, now_ns, now_ns()
        self._sent = 0
        self.rate_hz = rate_hz

    def sampled_ns(self, number: int) -> float:
        """When the sample of this number is taken, by the host's clock."""
        return self._begin_ns + (number + 1) * 1e9 / self.rate_hz

    def say(self) -> bytes:
        due = int((self._now_ns() - self._begin_ns) / 1e9 * self.rate_hz)
        stated = b"".join(self.sample(number) for number in range(self._sent, due))
        self._sent = max(self._sent, due)
        return stated

    def sample(self, number: int) -> bytes:
        """The line of one sample."""
        gx, gy, gz, ax, ay, az = self._motion(number)
        ms = round(number * 1000 / self.rate_hz)
        return f"{ms},{gx:.3f},{gy:.3f},{gz:.3f},{ax:.4f},{ay:.4f},{az:.4f}\r\n".encode()

    def hear(self, data: bytes) -> bytes:
        return b""

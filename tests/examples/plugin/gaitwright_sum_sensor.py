"""A driver in a package of its own: the sum sensor at a serial port.

The sensor sends frames of 16 bytes: 0xA5, a counter of one byte at 100 Hz, three rates and three forces as
little-endian int16 (0.01 rad/s, 0.01 m/s2), the sum of all before, and 0x5A. Its entry point names `DRIVER`, whose key
is the entry point's own name.
"""

import struct

from gaitwright.devices import Channel, Driver, Framer, Received, SensorDetails, SourceInfo

KEY, RATE_HZ, UNIT = "sum-sensor", 100.0, 0.01
FRAME = struct.Struct("<BB6hBB")


class PackagedFramer:
    """Finds frames however the bytes are cut; what is no frame is skipped byte by byte."""

    def __init__(self) -> None:
        self.received = Received()
        self._held, self._ticks, self._is_in_step = b"", -1, True

    def feed(self, data: bytes, host_s: float) -> None:
        held = self._held + data
        while len(held) >= FRAME.size:
            head, counter, *values, total, tail = FRAME.unpack_from(held)
            is_frame = (head, tail, total) == (0xA5, 0x5A, sum(held[: FRAME.size - 2]) % 256)
            self.received.damaged += self._is_in_step and not is_frame
            self._is_in_step = is_frame
            if is_frame:  # the counter starts again after 255
                self._ticks += (counter - self._ticks) % 256
                self.received.rows.append((self._ticks / RATE_HZ, *(UNIT * value for value in values)))
            held = held[FRAME.size if is_frame else 1 :]
        self._held = held

    def flush(self) -> None:
        """The rest is half a frame."""


class PackagedSensor:
    """It sends from the moment it is switched on, and cannot be asked."""

    driver, version = KEY, "1"

    def framer(self, info: SourceInfo) -> Framer:
        return PackagedFramer()

    def greet(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        name = channel.serial or channel.place  # by which two of them are told apart
        info = SourceInfo(KEY, self.version, sensors=(name,), settings={"rate_hz": RATE_HZ})
        return info, SensorDetails("sum sensor", rate_hz=RATE_HZ)

    def identifying(self) -> bytes:
        return b""


DRIVER = Driver(KEY, "Sum sensor", "By frames made for it. No hardware was at hand.", None, PackagedSensor, (115200,))

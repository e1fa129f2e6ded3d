"""Understand a sensor that is not known yet: decode what it sent from a file of its bytes.

    python -m tests.examples.new_sensor BYTES

The sensor sends frames of 16 bytes: 0xA5, a counter of one byte at 100 Hz, three rates and three forces as
little-endian int16 (0.01 rad/s, 0.01 m/s2), the sum of all before, and 0x5A. A driver is a `Framer`, which finds frames
in bytes however they are cut, and a `SensorProtocol`, which states who is there. `Decoder` puts samples in order and
counts losses; with `ByteSource` the same two serve a port. Printed is what was received, lost and damaged.
"""

import struct
import sys
from pathlib import Path

from devices import Channel, Decoder, Framer, Received, SensorDetails, SourceInfo

FRAME = struct.Struct("<BB6hBB")
RATE_HZ, UNIT = 100.0, 0.01


class SumFramer:
    """Finds frames; what is no frame is skipped byte by byte and counted once per stretch."""

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


class SumSensor:
    """The `SensorProtocol` of this sensor, which talks from the moment it is switched on and cannot be asked."""

    driver, version = "sum-sensor", "1"

    def framer(self, info: SourceInfo) -> Framer:
        return SumFramer()

    def greet(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        info = SourceInfo(self.driver, self.version, sensors=("one",), settings={"rate_hz": RATE_HZ})
        return info, SensorDetails("sum sensor", rate_hz=RATE_HZ)

    def identifying(self) -> bytes:
        return b""


def main(file: Path) -> None:
    decoder = Decoder(SumSensor())
    decoder.begin(SourceInfo(SumSensor.driver, "1", sensors=("one",), settings={"rate_hz": RATE_HZ}))
    decoder.feed(file.read_bytes(), host_time_s=0.0)
    sensor = decoder.finish()["one"]
    print(f"{sensor.counts.received} received, {sensor.counts.lost} lost, {sensor.counts.damaged} damaged")
    print(f"last sample: rate {sensor.block.gyr_rad_s[-1]} rad/s, force {sensor.block.acc_m_s2[-1]} m/s2")


if __name__ == "__main__":
    main(Path(sys.argv[1]))

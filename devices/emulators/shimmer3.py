"""A Shimmer3 that is not there: LogAndStream commands and packets."""

import struct
from collections.abc import Callable, Sequence

from devices.clocks.host_clock import host_time_ns
from devices.drivers.shimmer3 import (
    ACC,
    BATTERY,
    CALIBRATION_SHAPE,
    CHECKSUM_SINCE,
    EMULATED,
    GYR,
    TICK_HZ,
    TURN,
    Command,
    checksum,
)

Motion = Callable[[int], Sequence[int]]
"""Raw rate (3) and raw force (3) of the sample of this number."""

CHANNELS = bytes([BATTERY, *ACC, *GYR])
BATTERY_RAW = 2600  # 3.79 V
FIRST_TICKS = TURN - 4096  # its clock begins again an eighth of a second after it was switched on
ARGUMENTS = {  # bytes behind a command
    Command.SET_RATE: 2,
    Command.SET_SENSORS: 3,
    Command.SET_GYR_RANGE: 1,
    Command.SET_GYR_RATE: 1,
    Command.SET_ACC_RANGE: 1,
    Command.SET_ACC_RATE: 1,
    Command.SET_ACC_LOW_POWER: 1,
    Command.SET_ACC_FINE: 1,
    Command.SET_CHECKSUM: 1,
}
# offset, sensitivity, alignment: of 2000 deg/s and 8 g as they leave the works, a little askew
GYR_CALIBRATION = CALIBRATION_SHAPE.pack(12, -7, 3, 1640, 1642, 1638, 0, -100, 0, -100, 0, 0, 0, 0, -100)
ACC_CALIBRATION = CALIBRATION_SHAPE.pack(5, -3, 8, 418, 417, 419, 0, -100, 0, 100, 1, 0, 0, 0, -100)


def still(number: int) -> Sequence[int]:
    """It lies on a table, and its rate counts."""
    return (number % 1000, -7, 3, 5, -3, -4092)


class Shimmer3Voice:
    """The `Voice` of one sensor. `period` is how many ticks its samples are apart, until it is set to another."""

    def __init__(
        self,
        motion: Motion = still,
        *,
        period: int = 640,
        name: str = EMULATED,
        firmware: tuple[int, int, int] = CHECKSUM_SINCE,
        has_calibration: bool = True,
        now_ns: Callable[[], int] = host_time_ns,
    ) -> None:
        self._motion, self._now_ns = motion, now_ns
        self._name, self._firmware, self._has_calibration = name, firmware, has_calibration
        self._begin_ns, self._sent = now_ns(), 0
        self.is_streaming = self.has_checksum = False
        self.toggled = 0
        self.period = period
        self._rest = b""

    @property
    def rate_hz(self) -> float:
        return TICK_HZ / self.period

    def sampled_ns(self, number: int) -> float:
        """When the sample of this number is taken, by the host's clock."""
        return self._begin_ns + (number + 1) * 1e9 * self.period / TICK_HZ

    def say(self) -> bytes:
        if not self.is_streaming:
            return b""
        due = int((self._now_ns() - self._begin_ns) / 1e9 * TICK_HZ / self.period)
        stated = b"".join(self.sample(number) for number in range(self._sent, due))
        self._sent = max(self._sent, due)
        return stated

    def sample(self, number: int) -> bytes:
        """The packet of one sample."""
        raw = self._motion(number)
        packet = bytes([Command.PACKET]) + ((FIRST_TICKS + number * self.period) % TURN).to_bytes(3, "little")
        packet += struct.pack("<H3h", BATTERY_RAW, *raw[3:]) + struct.pack(">3h", *raw[:3])
        return self._checked(packet)

    def hear(self, data: bytes) -> bytes:
        self._rest += data
        stated = b""
        while self._rest:
            command, count = self._rest[0], ARGUMENTS.get(self._rest[0], 0)
            if len(self._rest) <= count:
                break
            arguments, self._rest = self._rest[1 : 1 + count], self._rest[1 + count :]
            stated += self._answer(command, arguments)
        return stated

    def _checked(self, stated: bytes) -> bytes:
        return stated + checksum(stated) if self.has_checksum else stated

    def _answer(self, command: int, arguments: bytes) -> bytes:
        answer = b""
        match command:
            case Command.SET_RATE:
                self.period = int.from_bytes(arguments, "little")
            case Command.RATE:
                answer = bytes([Command.RATE_ANSWER]) + self.period.to_bytes(2, "little")
            case Command.SET_CHECKSUM:
                self.has_checksum = arguments[0] == 2
            case Command.TOGGLE_LED:
                self.toggled += 1
            case Command.START:
                self._begin_ns, self._sent, self.is_streaming = self._now_ns(), 0, True
            case Command.STOP:
                self.is_streaming = False
            case Command.FIRMWARE:
                answer = bytes([Command.FIRMWARE_ANSWER]) + struct.pack("<HHBB", 3, *self._firmware)
            case Command.NAME:
                answer = bytes([Command.NAME_ANSWER, len(self._name)]) + self._name.encode()
            case Command.CALIBRATION:
                stored = [bytes(21), GYR_CALIBRATION, bytes(21), ACC_CALIBRATION]
                if not self._has_calibration:
                    stored = [b"\xff" * 21] * 4
                answer = bytes([Command.CALIBRATION_ANSWER]) + b"".join(stored)
            case Command.INQUIRY:
                settings = struct.pack("<HIBB", self.period, 0, len(CHANNELS), 1)
                answer = bytes([Command.INQUIRY_ANSWER]) + settings + CHANNELS
            case _ if command not in ARGUMENTS:
                return bytes([Command.REFUSED])
        return self._checked(bytes([Command.DONE]) + answer)

"""A WitMotion sensor that is not there: registers, and bursts of frames."""

from collections.abc import Callable
from datetime import datetime, timedelta

from devices.clocks.host_clock import host_time_ns
from devices.drivers.witmotion import (
    ANGLES,
    AXES,
    CLOCK,
    CONTENT_AT,
    EMULATED,
    FORCE,
    NUMBER_AT,
    ORIENTATION,
    RATE,
    RATE_AT,
    RATES,
    READ_AT,
    REGISTERS,
    TIME,
    UNLOCK,
    frame,
)
from devices.emulators.evenly import EvenVoice, Motion

SWITCHED_ON = datetime(2026, 1, 1)
COMMAND = 5  # bytes
USUAL_CONTENT = 0b1110  # force, rate, angles; no time


class WitVoice(EvenVoice):
    """The `Voice` of one sensor; `number` has up to four characters and follows `name`."""

    def __init__(
        self,
        number: str,
        motion: Motion,
        *,
        rate_hz: float = 100.0,
        content: int = USUAL_CONTENT,
        name: str = EMULATED,
        now_ns: Callable[[], int] = host_time_ns,
    ) -> None:
        super().__init__(motion, now_ns)
        self._is_unlocked, self._rest = False, b""
        self.number = f"{name}{number}"[:12]
        padded = self.number.encode().ljust(16, b"\0")
        self.registers = {NUMBER_AT + k: int.from_bytes(padded[2 * k : 2 * k + 2], "little") for k in range(8)}
        self.registers |= {
            CONTENT_AT: content,
            RATE_AT: next(code for code, known_hz in RATES.items() if known_hz == rate_hz),
        }

    @property
    def rate_hz(self) -> float:
        return RATES[self.registers[RATE_AT]]

    def sample(self, number: int) -> bytes:
        """The burst of one sample."""
        at = SWITCHED_ON + timedelta(seconds=number / self.rate_hz)
        gx, gy, gz, ax, ay, az = self._motion(number)
        temperature = 2500
        frames = {
            TIME: CLOCK.pack(at.year - 2000, at.month, at.day, at.hour, at.minute, at.second, at.microsecond // 1000),
            FORCE: AXES.pack(*(round(value / 16 * 32768) for value in (ax, ay, az)), temperature),
            RATE: AXES.pack(*(round(value / 2000 * 32768) for value in (gx, gy, gz)), temperature),
            ANGLES: AXES.pack(0, 0, 0, 0),
            ORIENTATION: AXES.pack(32767, 0, 0, 0),
        }
        content = self.registers[CONTENT_AT]
        return b"".join(frame(kind, payload) for kind, payload in frames.items() if content >> (kind - TIME) & 1)

    def hear(self, data: bytes) -> bytes:
        self._rest += data
        answer = b""
        while len(self._rest) >= COMMAND:
            command, self._rest = self._rest[:COMMAND], self._rest[COMMAND:]
            answer += self._answer(command)
        return answer

    def _answer(self, command: bytes) -> bytes:
        register, value = command[2], int.from_bytes(command[3:], "little")
        if command == UNLOCK:
            self._is_unlocked = True
        elif register == READ_AT:
            words = (self.registers.get(value + k, 0) for k in range(4))
            return frame(REGISTERS, b"".join(one.to_bytes(2, "little") for one in words))
        elif self._is_unlocked:
            self.registers[register] = value
        return b""

"""An x-IMU3 that is not there: commands, inertial and other messages, as text or binary."""

import json
from collections.abc import Callable, Sequence
from struct import pack

from devices.clocks.host_clock import host_time_ns
from devices.drivers.ximu3 import BASE_HZ, EMULATED, END, stuffed
from devices.emulators.evenly import EvenVoice, Motion

BATTERY_EVERY = 400  # samples
FIRST_US = 1_000_000


def message(letter: str, us: int, numbers: Sequence[float], is_binary: bool) -> bytes:
    """Give a message of numbers as it is sent, with its end, stuffed where binary."""
    if is_binary:
        return stuffed(bytes([0x80 | ord(letter)]) + pack(f"<Q{len(numbers)}f", us, *numbers))
    return f"{letter},{us},{','.join(f'{number:.4f}' for number in numbers)}\r\n".encode()


def text_message(letter: str, us: int, text: str, is_binary: bool) -> bytes:
    """A notification or an error as it is sent."""
    if is_binary:
        return stuffed(bytes([0x80 | ord(letter)]) + pack("<Q", us) + text.encode())
    return f"{letter},{us},{text}\r\n".encode()


class Ximu3Voice(EvenVoice):
    """The `Voice` of one sensor.

    `strobed`: how often its LED was asked for.
    """

    def __init__(
        self,
        serial: str,
        motion: Motion,
        *,
        rate_hz: int = 100,
        is_binary: bool = True,
        name: str = EMULATED,
        now_ns: Callable[[], int] = host_time_ns,
    ) -> None:
        super().__init__(motion, now_ns)
        self._first_us = FIRST_US
        self._rest = b""
        self.strobed = 0
        self.settings: dict[str, object] = {
            "ping": {"interface": "USB", "name": name, "sn": serial},
            "inertial_message_rate_divisor": BASE_HZ // rate_hz,
            "ahrs_message_rate_divisor": 0,
            "binary_mode_enabled": is_binary,
            "firmware_version": "v1.0.0",
        }

    @property
    def serial(self) -> str:
        ping = self.settings["ping"]
        assert isinstance(ping, dict)
        return str(ping["sn"])

    @property
    def rate_hz(self) -> float:
        divisor = self.settings["inertial_message_rate_divisor"]
        return BASE_HZ / divisor if isinstance(divisor, int) and divisor else 0.0

    def say(self) -> bytes:
        return super().say() if self.rate_hz else b""

    def sample(self, number: int) -> bytes:
        """What is sent of one sample."""
        us, is_binary = self._first_us + round(number * 1e6 / self.rate_hz), bool(self.settings["binary_mode_enabled"])
        stated = message("I", us, self._motion(number), is_binary)
        if number % BATTERY_EVERY == 0:
            stated += message("B", us, (84.0, 3.9, 0.0), is_binary)
        return stated

    def hear(self, data: bytes) -> bytes:
        *commands, self._rest = (self._rest + data).split(END)
        return b"".join(self._answer(command) for command in commands)

    def _answer(self, command: bytes) -> bytes:
        try:
            asked = json.loads(command)
        except ValueError:
            return b""
        if not isinstance(asked, dict) or not asked:
            return b""
        key, value = next(iter(asked.items()))
        if key == "strobe":
            self.strobed += 1
        elif key not in self.settings:
            value = None if key == "apply" else {"error": "Unknown command"}
        elif value is not None:
            if key == "inertial_message_rate_divisor":  # its clock goes on
                now_ns = self._now_ns()
                self._first_us += (now_ns - self._begin_ns) // 1000
                self._begin_ns, self._sent = now_ns, 0
            self.settings[key] = value
        return json.dumps({key: self.settings.get(key, value)}, separators=(",", ":")).encode() + b"\r\n"

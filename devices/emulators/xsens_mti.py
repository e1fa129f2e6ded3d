"""An Xsens MTi that is not there: Xbus requests and MTData2 messages."""

import struct
from collections.abc import Callable, Sequence

from devices.clocks.host_clock import host_time_ns
from devices.drivers.xbus import REQUESTS, Item, Message, Mid, XbusFramer, item, message
from devices.drivers.xsens_mti import ALWAYS, EMULATED, FINE_HZ, SETTING
from devices.emulators.evenly import EvenVoice, Motion

FASTEST_HZ = 400
FIRST_TICKS = 0xFFFF_FC00  # its fine time begins again a tenth of a second after it was switched on
FIRMWARE = bytes([1, 8, 2])
CANNOT = b"\x03"  # the answer to what it does not do


def still(number: int) -> Sequence[float]:
    """Give a still sensor's sample: rate in rad/s (3), force in m/s2 (3) and orientation (4), scalar first."""
    return (1e-3 * (number % 7), 0.0, 0.0, 0.0, 0.0, 9.81, 1.0, 0.0, 0.0, 0.0)


class MtiVoice(EvenVoice):
    """The `Voice` of one sensor. It measures from the start, as a sensor does that was plugged in.

    Parameters
    ----------
    motion
        Rate in rad/s (3), force in m/s2 (3) and orientation (4) of the sample of a number.
    rate_hz
        As its owner set it, until it is set to another.
    has_orientation
        Some models have none, and refuse to be asked for it.
    """

    def __init__(
        self,
        serial: str = "0280A1B2",
        motion: Motion = still,
        *,
        rate_hz: int = 100,
        has_orientation: bool = True,
        product: str = EMULATED,
        now_ns: Callable[[], int] = host_time_ns,
    ) -> None:
        super().__init__(motion, now_ns)
        self._has_orientation = has_orientation
        self._serial, self._product = serial, product
        self._framer = XbusFramer(REQUESTS)
        self.is_measuring = True
        self.settings: dict[int, int] = {
            Item.COUNTER: ALWAYS,
            Item.FINE_TIME: ALWAYS,
            Item.ACCELERATION: rate_hz,
            Item.RATE: rate_hz,
        }
        if has_orientation:
            self.settings[Item.QUATERNION] = rate_hz

    @property
    def rate_hz(self) -> int:
        return self.settings.get(Item.RATE, 0)

    def say(self) -> bytes:
        stated = super().say()
        return stated if self.is_measuring else b""

    def sample(self, number: int) -> bytes:
        moved = self._motion(number)
        ticks = (FIRST_TICKS + round(number * FINE_HZ / self.rate_hz)) & 0xFFFF_FFFF
        data = item(Item.COUNTER, struct.pack(">H", number & 0xFFFF))
        data += item(Item.FINE_TIME, struct.pack(">I", ticks))
        if Item.QUATERNION in self.settings:
            data += item(Item.QUATERNION, struct.pack(">4f", *moved[6:10]))
        data += item(Item.ACCELERATION, struct.pack(">3f", *moved[3:6]))
        data += item(Item.RATE, struct.pack(">3f", *moved[:3]))
        return message(Mid.MT_DATA2, data)

    def hear(self, data: bytes) -> bytes:
        return b"".join(self._answer(one) for one in self._framer.feed(data))

    def _answer(self, one: Message) -> bytes:
        answer = b""
        match one.mid:
            case Mid.GO_TO_CONFIG:
                self.is_measuring = False
            case Mid.GO_TO_MEASUREMENT:
                self.is_measuring = True
            case Mid.DEVICE_ID:
                answer = bytes.fromhex(self._serial)
            case Mid.PRODUCT:
                answer = self._product.ljust(20).encode()
            case Mid.FIRMWARE:
                answer = FIRMWARE + bytes(8)
            case Mid.OUTPUT if not self.is_measuring:
                required = dict(SETTING.iter_unpack(one.data))
                if Item.QUATERNION in required and not self._has_orientation:
                    return message(Mid.ERROR, CANNOT)
                if required:  # else it is asked only
                    self.settings = {k: hz if hz == ALWAYS else min(hz, FASTEST_HZ) for k, hz in required.items()}
                    self._begin_ns, self._sent = self._now_ns(), 0
                answer = b"".join(SETTING.pack(*setting) for setting in self.settings.items())
            case _:
                return message(Mid.ERROR, CANNOT)
        return message(one.mid + 1, answer)

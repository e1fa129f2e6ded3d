"""A WitMotion sensor with Bluetooth LE that is not there: frames of twenty bytes, as many as its rate states."""

from collections.abc import Callable, Sequence
from struct import Struct

import numpy as np

from devices.emulators.bluetooth import EmulatedCharacteristic, Notification

Motion = Callable[[float], Sequence[float]]
"""Rate in deg/s (3) and force in g (3) at an instant of the host's clock, ns."""

BASE = "0000{:04x}-0000-1000-8000-00805f9a34fb"
CHARACTERISTICS = [
    EmulatedCharacteristic(0xFFE4, BASE.format(0xFFE4), BASE.format(0xFFE5), ("notify",)),
    EmulatedCharacteristic(0xFFE9, BASE.format(0xFFE9), BASE.format(0xFFE5), ("write", "write-without-response")),
]
RATES_HZ = {0x06: 10.0, 0x08: 50.0, 0x09: 100.0, 0x0B: 200.0}
FRAME = Struct("<BB9h")


class EmulatedWitBle:
    """An `EmulatedPeripheral`. It begins at 10 Hz, as they are sold.

    Attributes
    ----------
    sent
        Rate and force (6) of every sample that it took while it was received, and when, ns of the host's clock.

    Parameters
    ----------
    loss
        Share of its notifications that is lost.
    skew
        How much faster than it states its quartz runs.
    """

    def __init__(
        self,
        number: int,
        motion: Motion,
        now_ns: Callable[[], int],
        *,
        loss: float = 0.0,
        skew: float = 0.0,
        states_so: bool = True,
    ) -> None:
        self.mac = bytes([0xE2, 0x10, 0x00, 0x00, 0x01, number + 1])
        self.local_name = "WT00 EMULATED" if states_so else "WT901BLE68"
        self.companies: tuple[int, ...] = ()
        self.characteristics: Sequence[EmulatedCharacteristic] = CHARACTERISTICS
        self.chance = np.random.default_rng(number)
        self.subscribed: set[int] = set()
        self.is_up, self.is_away = False, False
        self.sent: list[tuple[tuple[float, ...], float]] = []
        self.received: list[bytes] = []
        self._motion, self._now_ns, self._loss, self._skew = motion, now_ns, loss, skew
        self._rate_hz, self._is_unlocked = 10.0, False
        self._next_ns = float(now_ns())

    def may_connect(self) -> bool:
        return not self.is_away

    def connected(self) -> None:
        self.is_up = True

    def disconnected(self) -> None:
        self.is_up = False
        self.subscribed.clear()

    def drops_at(self, operations: int) -> bool:
        return False

    def drops_after(self, notification: Notification) -> bool:
        return False

    def read(self, characteristic: int) -> bytes:
        raise KeyError(characteristic)

    def write(self, characteristic: int, data: bytes) -> None:
        self.received.append(data)
        if data == bytes.fromhex("FFAA6988B5"):
            self._is_unlocked = True
        elif data[:3] == b"\xff\xaa\x03" and self._is_unlocked and data[3] in RATES_HZ:
            self._rate_hz = RATES_HZ[data[3]]

    def notifications(self) -> Sequence[Notification]:
        now_ns, stated = self._now_ns(), []
        while self._next_ns <= now_ns:
            at_ns = self._next_ns
            self._next_ns += 1e9 / (self._rate_hz * (1.0 + self._skew))
            if 0xFFE4 not in self.subscribed:
                continue
            rate, force = np.array(self._motion(at_ns)).reshape(2, 3)
            numbers = [*np.round(force / 16 * 32768), *np.round(rate / 2000 * 32768), 0, 0, 0]
            values = [int(np.clip(number, -32768, 32767)) for number in numbers]
            self.sent.append(((*(value * 2000 / 32768 for value in values[3:6]), *values[:3]), at_ns))
            if self.chance.random() >= self._loss:
                stated.append((0xFFE4, FRAME.pack(0x55, 0x61, *values)))
        return stated

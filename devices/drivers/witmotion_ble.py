"""WitMotion's sensors with Bluetooth LE 5: frames of twenty bytes in notifications, without time, counter or checksum.

Source: WIT's manual of its Bluetooth 5.0 protocol: `55 61`, then acceleration, angular rate and angles, three numbers
each, scaled as by cable (`witmotion.py`). Nothing shows when a sample was taken: `clocks/arrival_clock.py`.
Samples that are lost singly are not seen, and every recording mentions it. Not tried on hardware.
"""

import re
import threading
from collections import deque
from collections.abc import Mapping, Sequence
from contextlib import suppress
from struct import Struct

import numpy as np

from core.samples import ImuBlock
from core.session import RecordingKind
from devices.clocks.arrival_clock import ArrivalClock
from devices.clocks.live_clock import LiveClock
from devices.drivers.witmotion import FORCE_UNIT, RATE_AT, RATE_UNIT, RATES, UNLOCK, scaled, writing
from devices.live import Keep, SensorDetails, SourceLostError, SourceRefusedError
from devices.source import SourceInfo
from devices.stream import Received
from devices.transport.bluetooth import Announced, BluetoothLink, Radio
from devices.transport.channels import READ_S
from devices.transport.notifications import NotificationFrames, framed

DRIVER, VERSION = "witmotion-ble", "1"
MODEL = "WitMotion BLE, losses not seen"  # as shown with every recording and in every report
UUID = "0000{:04x}-0000-1000-8000-00805f9a34fb"  # its own base: not the Bluetooth SIG's, which ends in 9b34fb
SERVICE, MEASURED, COMMANDS = 0xFFE5, 0xFFE4, 0xFFE9
NAME = re.compile(r"B?WT\d{2}")  # WT901BLE68, WT9011DCL-BT50, BWT901BLE5.0
EMULATED = "WT00 EMULATED"  # the name of our own emulator
FRAME = Struct("<BB9h")
HEAD, DATA = 0x55, 0x61
RATE_HZ = 100.0
STATES_S = 3.0
MOST_WAITING = 6000  # notifications that nobody fetched: a minute


def is_wit(one: Announced) -> bool:
    """Whether what announces itself is one of WitMotion's."""
    return NAME.match(one.name) is not None


def wit_name(one: Announced) -> str:
    """By the end of its address, which is unlike that of any other."""
    return f"WT {one.address.replace(':', '')[-4:].upper()}"


class WitBleFramer:
    """See `devices.stream.Framer`. A notification holds whole frames."""

    def __init__(self, info: SourceInfo) -> None:
        self.received = Received()
        self._frames = NotificationFrames({MEASURED})
        rate_hz = info.settings.get("rate_hz")
        self._clock = ArrivalClock(rate_hz if isinstance(rate_hz, float) and rate_hz > 0 else RATE_HZ)

    def feed(self, data: bytes, host_s: float) -> None:
        for _, payload in self._frames.feed(data):
            self._take(payload, host_s)
        self.received.damaged += self._frames.newly_damaged()

    def flush(self) -> None:
        self._frames.flush()
        self.received.damaged += self._frames.newly_damaged()

    def _take(self, payload: bytes, host_s: float) -> None:
        for at in range(0, len(payload), FRAME.size):
            if len(payload) - at < FRAME.size or payload[at] != HEAD:
                self.received.damaged += 1
                return
            _, kind, *numbers = FRAME.unpack_from(payload, at)
            if kind != DATA:
                self.received.skipped += 1
                continue
            rate, force = scaled(numbers[3:6], RATE_UNIT), scaled(numbers[:3], FORCE_UNIT)
            self.received.rows.append((self._clock.take(host_s), *rate, *force))


class WitBle:
    """See `devices.stream.Framing`."""

    driver, version = DRIVER, VERSION

    def framer(self, info: SourceInfo) -> WitBleFramer:
        return WitBleFramer(info)


class WitBleSource:
    """The `LiveSource` of one sensor.

    Parameters
    ----------
    rate_hz
        One of `devices.drivers.witmotion.RATES`; what it was set to is forgotten when it is switched off.

    Raises
    ------
    ValueError
        There is no such rate.
    """

    has_bytes = True

    def __init__(self, radio: Radio, announced: Announced, rate_hz: float = RATE_HZ) -> None:
        if rate_hz not in RATES.values():
            raise ValueError(f"rate_hz is {rate_hz}, expected one of {sorted(RATES.values())}")
        self.name = wit_name(announced)
        self._radio, self._rate_hz = radio, rate_hz
        self._link = BluetoothLink(radio, announced, self._hear)
        self._arrived = threading.Event()
        self._notified: deque[bytes] = deque(maxlen=MOST_WAITING)
        self._sent: list[bytes] = []
        self._framer: WitBleFramer | None = None
        self._clock = LiveClock()
        settings = {"rate_hz": rate_hz}
        is_simulated = announced.name == EMULATED
        self.info = SourceInfo(DRIVER, VERSION, announced.address, (self.name,), settings, is_simulated=is_simulated)
        self._details = SensorDetails(MODEL, announced.address, "", rate_hz, is_loss_seen=False)

    @property
    def sent(self) -> Sequence[bytes]:
        return tuple(self._sent)

    def open(self) -> None:
        self._sent.clear()
        try:
            self._radio.run(self._opened())
        except SourceLostError as problem:
            raise SourceRefusedError(
                "{sensor} does not respond", "Switch it on, and bring it closer", sensor=self.name
            ) from problem
        self._arrived.clear()
        self._radio.wait(self._arrived, STATES_S)
        if not self._notified:
            self.close()
            raise SourceRefusedError(
                "{sensor} sends no measurements", "Switch it off and on, then search again", sensor=self.name
            )
        self._notified.clear()
        self._framer = WitBleFramer(self.info)
        self._clock.begin()

    async def _opened(self) -> None:
        await self._link.connect()
        await self._link.subscribe(MEASURED, UUID.format(MEASURED))
        code = next(code for code, known_hz in RATES.items() if known_hz == self._rate_hz)
        for command in (UNLOCK, writing(RATE_AT, code)):
            await self._link.write(UUID.format(COMMANDS), command, is_answered=False)
            self._sent.append(framed(COMMANDS, command))

    def _hear(self, characteristic: int, payload: bytes) -> None:
        self._notified.append(framed(characteristic, payload))
        self._arrived.set()

    def read(self, keep: Keep) -> Sequence[ImuBlock]:
        framer = self._framer
        if framer is None:
            raise SourceLostError(f"{self.name} is closed")
        self._radio.wait(self._arrived, READ_S)
        self._arrived.clear()
        data = b"".join(self._notified.popleft() for _ in range(len(self._notified)))
        if not data:
            if not self._link.is_up:
                raise SourceLostError(f"{self.name} was lost")
            return ()
        keep(data)
        now_s = self._radio.now_ns() / 1e9
        framer.feed(data, now_s)
        rows, framer.received.rows = np.array(framer.received.rows, dtype=float), []
        if not len(rows):
            return ()
        stamps_s = self._clock.stamp(rows[:, 0], now_s)
        return (ImuBlock(self.name, stamps_s, rows[:, 1:4], rows[:, 4:7]),)

    def close(self) -> None:
        self._framer = None
        with suppress(Exception):
            self._radio.run(self._link.disconnect())

    def details(self) -> Mapping[str, SensorDetails]:
        return {self.name: self._details}

    def identify(self, sensor: str) -> bool:
        """It has no light that can be lit."""
        return False

    def ask(self, kind: RecordingKind | None) -> None:
        """Only simulated patients listen."""

"""Air that is not there: links to emulated sensors, behind the interface that bleak has for backends.

What a sensor is to its link is written here once; Bumble's virtual radio (tests) carries the same sensors.
"""

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from bleak.args import SizedBuffer
from bleak.assigned_numbers import CharacteristicPropertyName
from bleak.backends.characteristic import BleakGATTCharacteristic
from bleak.backends.client import BaseBleakClient
from bleak.backends.descriptor import BleakGATTDescriptor
from bleak.backends.service import BleakGATTService, BleakGATTServiceCollection
from bleak.exc import BleakError

from devices.transport.bluetooth import Announced

INTERVAL_S = 0.015  # of a connection
CONNECTS_S = 0.3
OPERATION_S = 0.03
APART_S = 1e-6  # of two notifications at least: timers of one instant ring in any order
MTU = 247  # what both sides of a link carry at once, and three bytes less of a value

Notification = tuple[int, bytes]


@dataclass(frozen=True, slots=True)
class EmulatedCharacteristic:
    """Part of a peripheral's table; its number is the sensor's own affair."""

    number: int
    uuid: str
    service_uuid: str
    properties: tuple[CharacteristicPropertyName, ...]


class EmulatedPeripheral(Protocol):
    """A sensor that is not there, as its link sees it. `notifications` is asked every few milliseconds."""

    mac: bytes
    local_name: str
    companies: tuple[int, ...]
    characteristics: Sequence[EmulatedCharacteristic]
    subscribed: set[int]
    is_up: bool
    chance: np.random.Generator

    def may_connect(self) -> bool: ...

    def connected(self) -> None: ...

    def disconnected(self) -> None: ...

    def read(self, characteristic: int) -> bytes: ...

    def write(self, characteristic: int, data: bytes) -> None: ...

    def notifications(self) -> Sequence[Notification]: ...

    def drops_at(self, operations: int) -> bool:
        """Whether the link is to be lost at this operation."""

    def drops_after(self, notification: Notification) -> bool:
        """Whether the link is to be lost before this is sent."""


class Air:
    """Sensors in reach. `backend` is what bleak is given; a notification is `latency_s` late at least, each its own."""

    def __init__(self, sensors: Sequence[EmulatedPeripheral], latency_s: Sequence[float] = ()) -> None:
        self.sensors = {address_of(sensor): sensor for sensor in sensors}
        self.latency_s = dict(zip(self.sensors, latency_s or [0.005] * len(sensors), strict=True))
        self.clients: dict[str, FakeClient] = {}
        air = self

        class ThisAir(FakeClient):
            AIR = air

        self.backend: type[BaseBleakClient] = ThisAir

    def announced(self) -> list[Announced]:
        """Who announces itself."""
        free = {address: one for address, one in self.sensors.items() if one.may_connect() and not one.is_up}
        return [
            Announced(one.local_name, address, one.companies, address, rssi_dbm=-50 - 4 * place)
            for place, (address, one) in enumerate(free.items())
        ]

    def drop(self, sensor: EmulatedPeripheral) -> None:
        """Let the link be lost, if there is one."""
        if (client := self.clients.get(address_of(sensor))) is not None:
            client.lose()


def address_of(sensor: EmulatedPeripheral) -> str:
    """A sensor's address as it is written."""
    return ":".join(f"{byte:02X}" for byte in sensor.mac)


class UnpairedClient(BaseBleakClient):
    """A link without what no sensor of ours asks for: descriptors and pairing."""

    async def read_gatt_descriptor(
        self, descriptor: BleakGATTDescriptor, *, use_cached: bool = False, **kwargs: Any
    ) -> bytearray:
        raise NotImplementedError

    async def write_gatt_descriptor(self, descriptor: BleakGATTDescriptor, data: SizedBuffer) -> None:
        raise NotImplementedError

    async def pair(self, *args: Any, **kwargs: Any) -> None:
        raise NotImplementedError

    async def unpair(self) -> None:
        raise NotImplementedError


class FakeClient(UnpairedClient):
    """A link to one sensor of the air."""

    AIR: ClassVar[Air]

    def __init__(self, address_or_ble_device: Any, **more: Any) -> None:
        super().__init__(
            address_or_ble_device,
            disconnected_callback=more.get("disconnected_callback"),
            timeout=more.get("timeout", 10.0),
        )
        self._sensor = self.AIR.sensors[self.address]
        self._received: dict[int, Callable[[bytearray], None]] = {}
        self._is_connected = False
        self._task: asyncio.Task[None] | None = None
        self._operations = 0
        self._last_s = 0.0  # nothing overtakes what was sent before

    @property
    def name(self) -> str:
        return self._sensor.local_name

    @property
    def mtu_size(self) -> int:
        return MTU

    @property
    def is_connected(self) -> bool:
        return self._is_connected

    async def connect(self, pair: bool, **kwargs: Any) -> None:
        await asyncio.sleep(CONNECTS_S)
        if not self._sensor.may_connect() or self._sensor.is_up:
            raise BleakError("the device was not found")
        self._sensor.connected()
        self._is_connected = True
        self.AIR.clients[self.address] = self
        self.services = _services(self._sensor)
        self._task = asyncio.get_running_loop().create_task(self._hear())

    async def disconnect(self) -> None:
        self.lose()

    def lose(self) -> None:
        """The link is no more, whoever ended it."""
        if not self._is_connected:
            return
        self._is_connected = False
        self._sensor.disconnected()
        if self._task is not None:
            self._task.cancel()
        if self._disconnected_callback is not None:
            self._disconnected_callback()

    async def _hear(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            await asyncio.sleep(INTERVAL_S)
            for characteristic, data in self._sensor.notifications():
                if self._sensor.drops_after((characteristic, data)):
                    self.lose()
                    return
                late_s = self.AIR.latency_s[self.address] + self._sensor.chance.exponential(0.002)
                self._last_s = max(self._last_s + APART_S, loop.time() + late_s)
                loop.call_at(self._last_s, self._arrive, characteristic, bytearray(data))

    def _arrive(self, characteristic: int, data: bytearray) -> None:
        if self._is_connected and characteristic in self._received:
            self._received[characteristic](data)

    async def _operate(self) -> None:
        await asyncio.sleep(OPERATION_S)
        self._operations += 1
        if self._is_connected and self._sensor.drops_at(self._operations):
            self.lose()
        if not self._is_connected:
            raise BleakError("not connected")

    async def read_gatt_char(
        self, characteristic: BleakGATTCharacteristic, *, use_cached: bool = False, **kwargs: Any
    ) -> bytearray:
        await self._operate()
        return bytearray(self._sensor.read(characteristic.handle))

    async def write_gatt_char(self, characteristic: BleakGATTCharacteristic, data: SizedBuffer, response: bool) -> None:
        await self._operate()
        self._sensor.write(characteristic.handle, bytes(data))

    async def start_notify(
        self, characteristic: BleakGATTCharacteristic, callback: Callable[[bytearray], None], **kwargs: Any
    ) -> None:
        await self._operate()
        self._received[characteristic.handle] = callback
        self._sensor.subscribed.add(characteristic.handle)

    async def stop_notify(self, characteristic: BleakGATTCharacteristic) -> None:
        await self._operate()
        self._received.pop(characteristic.handle, None)
        self._sensor.subscribed.discard(characteristic.handle)


def _services(sensor: EmulatedPeripheral) -> BleakGATTServiceCollection:
    """As a sensor has them; a characteristic's handle is the number that the sensor knows it by."""
    services = BleakGATTServiceCollection()
    by_uuid: dict[str, BleakGATTService] = {}
    for one in sensor.characteristics:
        if one.service_uuid not in by_uuid:
            by_uuid[one.service_uuid] = BleakGATTService(None, -len(by_uuid) - 1, one.service_uuid)
            services.add_service(by_uuid[one.service_uuid])
        properties = list(one.properties)
        service = by_uuid[one.service_uuid]
        services.add_characteristic(
            BleakGATTCharacteristic(None, one.number, one.uuid, properties, lambda: MTU - 3, service)
        )
    return services

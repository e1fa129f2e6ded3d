"""Air that is not there: links to emulated sensors, behind the interface that bleak has for backends."""

import asyncio
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from bleak.args import SizedBuffer
from bleak.assigned_numbers import CharacteristicPropertyName
from bleak.backends.characteristic import BleakGATTCharacteristic
from bleak.backends.client import BaseBleakClient
from bleak.backends.descriptor import BleakGATTDescriptor
from bleak.backends.service import BleakGATTService, BleakGATTServiceCollection
from bleak.exc import BleakError

from devices.bluetooth import Announced
from devices.emulators.dot import EmulatedDot

BASE = "1517{:04x}-4947-11e9-8646-d663bd873d93"
NOTIFYING = (0x1004, 0x2002, 0x2003, 0x2004, 0x3001, 0x7003)
CHARACTERISTICS = (0x1001, 0x1002, 0x2001, 0x2006, 0x7001, 0x7002, *NOTIFYING)
INTERVAL_S = 0.015  # of a connection
CONNECTS_S = 0.3
OPERATION_S = 0.03
APART_S = 1e-6  # of two notifications at least: timers of one instant ring in any order


class Air:
    """Sensors in reach. `backend` is what bleak is given; a notification is `latency_s` late at least, each its own."""

    def __init__(self, sensors: Sequence[EmulatedDot], latency_s: Sequence[float] = ()) -> None:
        self.sensors = {_address(sensor): sensor for sensor in sensors}
        self.latency_s = dict(zip(self.sensors, latency_s or [0.005] * len(sensors), strict=True))
        for sensor in sensors:
            sensor.meet(sensors)
        self.clients: dict[str, FakeClient] = {}
        air = self

        class Backend(FakeClient):
            AIR = air

        self.backend: type[BaseBleakClient] = Backend

    def announced(self) -> list[Announced]:
        """Who announces itself."""
        free = [address for address, one in self.sensors.items() if one.may_connect() and not one.is_up]
        return [Announced("Movella DOT", address, (0x0886,), address) for address in free]

    def drop(self, sensor: EmulatedDot) -> None:
        """Let the link be lost, if there is one."""
        if (client := self.clients.get(_address(sensor))) is not None:
            client.lose()


def _address(sensor: EmulatedDot) -> str:
    return ":".join(f"{byte:02X}" for byte in sensor.mac)


class FakeClient(BaseBleakClient):
    """A link to one sensor of the air."""

    AIR: ClassVar[Air]

    def __init__(self, address_or_ble_device: Any, **more: Any) -> None:
        super().__init__(
            address_or_ble_device,
            disconnected_callback=more.get("disconnected_callback"),
            timeout=more.get("timeout", 10.0),
        )
        self._sensor = self.AIR.sensors[self.address]
        self._heard: dict[int, Callable[[bytearray], None]] = {}
        self._is_connected = False
        self._task: asyncio.Task[None] | None = None
        self._operations = 0
        self._last_s = 0.0  # nothing overtakes what was sent before

    @property
    def name(self) -> str:
        return "Movella DOT"

    @property
    def mtu_size(self) -> int:
        return 247

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
        self.services = _services()
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
        sent_of_file = 0
        while True:
            await asyncio.sleep(INTERVAL_S)
            drops = self._sensor.faults.drops_export_after
            for characteristic, data in self._sensor.notifications():
                sent_of_file += characteristic == 0x7003 and data[2] == 0x71
                if drops and sent_of_file >= drops[0]:
                    drops.pop(0)
                    self._sensor.stay_away(self._sensor.faults.unreachable_after_drop_s)
                    self.lose()
                    return
                late_s = self.AIR.latency_s[self.address] + self._sensor.chance.exponential(0.002)
                self._last_s = max(self._last_s + APART_S, loop.time() + late_s)
                loop.call_at(self._last_s, self._arrive, characteristic, bytearray(data))

    def _arrive(self, characteristic: int, data: bytearray) -> None:
        if self._is_connected and characteristic in self._heard:
            self._heard[characteristic](data)

    async def _operate(self) -> None:
        await asyncio.sleep(OPERATION_S)
        drops = self._sensor.faults.drops_after
        self._operations += 1
        if drops and self._is_connected and self._operations >= drops[0]:
            drops.pop(0)
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
        self._heard[characteristic.handle] = callback
        self._sensor.subscribed.add(characteristic.handle)

    async def stop_notify(self, characteristic: BleakGATTCharacteristic) -> None:
        await self._operate()
        self._heard.pop(characteristic.handle, None)
        self._sensor.subscribed.discard(characteristic.handle)

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


def _services() -> BleakGATTServiceCollection:
    """As a DOT has them; a characteristic's handle is the part of its identifier that differs."""
    services = BleakGATTServiceCollection()
    for number in sorted({one >> 8 << 8 for one in CHARACTERISTICS}):
        service = BleakGATTService(None, number, BASE.format(number))
        services.add_service(service)
        for one in (each for each in CHARACTERISTICS if each >> 8 << 8 == number):
            properties: list[CharacteristicPropertyName] = ["notify"] if one in NOTIFYING else ["read", "write"]
            characteristic = BleakGATTCharacteristic(None, one, BASE.format(one), properties, lambda: 244, service)
            services.add_characteristic(characteristic)
    return services

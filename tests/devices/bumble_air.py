"""Emulated sensors through Bumble's virtual radio: real advertisements, ATT, subscriptions, and an MTU that cuts.

Between `bleak` and them stand two whole stacks: the host's central, behind bleak's interface for backends, and one
peripheral for each sensor, each with a controller of its own on one link. What passes between two controllers is late
by what the link is stated to be, in its order.
"""

import asyncio
import logging
from collections.abc import Callable, Coroutine, Sequence
from functools import partial
from typing import Any, ClassVar

from bleak.args import SizedBuffer
from bleak.assigned_numbers import CharacteristicPropertyName
from bleak.backends.characteristic import BleakGATTCharacteristic
from bleak.backends.client import BaseBleakClient
from bleak.backends.service import BleakGATTService, BleakGATTServiceCollection
from bleak.exc import BleakError
from bumble.controller import Controller
from bumble.core import AdvertisingData, BaseBumbleError, PhysicalTransport
from bumble.device import Advertisement, Connection, Device, Peer
from bumble.gatt import Characteristic, CharacteristicValue, Service
from bumble.gatt_client import CharacteristicProxy
from bumble.hci import Address
from bumble.host import Host
from bumble.link import LocalLink

from devices.emulators.bluetooth import INTERVAL_S, MTU, EmulatedPeripheral, UnpairedClient, address_of
from devices.transport.bluetooth import Announced, Radio

CENTRAL = "F0:F1:F2:F3:F4:F5"
CONNECTS_S = 8.0
logging.getLogger("bumble").setLevel(logging.ERROR)  # it warns of every packet that a lost link leaves over
BITS = {
    "read": Characteristic.Properties.READ,
    "write": Characteristic.Properties.WRITE,
    "write-without-response": Characteristic.Properties.WRITE_WITHOUT_RESPONSE,
    "notify": Characteristic.Properties.NOTIFY,
}


class SlowLink(LocalLink):
    """What is sent to an address arrives later, each in its order."""

    def __init__(self) -> None:
        super().__init__()  # type: ignore[no-untyped-call]  # bumble has no types there
        self.latency_s: dict[str, float] = {}
        self._last_s: dict[str, float] = {}

    def send_acl_data(
        self, sender_controller: Controller, destination_address: Address, transport: PhysicalTransport, data: bytes
    ) -> None:
        destination = self.find_le_controller(destination_address)
        if destination is None:
            return
        source = sender_controller.random_address
        between = str(source) if str(destination_address) == CENTRAL else str(destination_address)
        loop = asyncio.get_running_loop()
        due_s = max(self._last_s.get(str(source), 0.0) + 1e-6, loop.time() + self.latency_s.get(between, 0.0) / 2)
        self._last_s[str(source)] = due_s
        loop.call_at(due_s, destination.on_link_acl_data, source, transport, data)


class _Peripheral:
    """One sensor's stack: its table, its advertisements, and a task that sends what it notifies."""

    def __init__(self, sensor: EmulatedPeripheral, link: SlowLink) -> None:
        self.sensor, self.address = sensor, address_of(sensor)
        controller = Controller(self.address, link=link, public_address=self.address)
        self.device = Device(sensor.local_name, address=Address(self.address), host=Host(controller, controller))
        self._by_number: dict[int, Characteristic[bytes]] = {}
        self._connection: Connection | None = None
        self._operations = 0
        self._add_services()
        self.device.on("connection", self._on_connection)

    async def start(self) -> None:
        await self.device.power_on()
        self._task = asyncio.create_task(self._run())

    def stop(self) -> None:
        self._task.cancel()

    async def drop(self) -> None:
        if self._connection is not None:
            await self._connection.disconnect()

    def _add_services(self) -> None:
        uuids = dict.fromkeys(one.service_uuid for one in self.sensor.characteristics)
        for uuid in uuids:
            own = []
            for one in (each for each in self.sensor.characteristics if each.service_uuid == uuid):
                bits = Characteristic.Properties(0)
                for name in one.properties:
                    bits |= BITS[name]
                value = CharacteristicValue(partial(self._read, one.number), partial(self._write, one.number))
                characteristic: Characteristic[bytes] = Characteristic(
                    one.uuid, bits, Characteristic.READABLE | Characteristic.WRITEABLE, value
                )
                characteristic.on("subscription", partial(self._on_subscription, one.number))
                self._by_number[one.number] = characteristic
                own.append(characteristic)
            self.device.add_service(Service(uuid, own))

    async def _read(self, number: int, _connection: Connection) -> bytes:
        await self._operate()
        return self.sensor.read(number)

    async def _write(self, number: int, _connection: Connection, data: bytes) -> None:
        await self._operate()
        self.sensor.write(number, data)

    async def _operate(self) -> None:
        self._operations += 1
        if self.sensor.drops_at(self._operations):
            await self.drop()

    def _on_subscription(self, number: int, _connection: Connection, is_notified: bool, _is_indicated: bool) -> None:
        (self.sensor.subscribed.add if is_notified else self.sensor.subscribed.discard)(number)

    def _on_connection(self, connection: Connection) -> None:
        self._connection, self._operations = connection, 0
        self.sensor.connected()
        connection.on("disconnection", self._on_disconnection)

    def _on_disconnection(self, _reason: int) -> None:
        self._connection = None
        self.sensor.disconnected()

    async def _run(self) -> None:
        """Advertise while it can be reached, and send what is due while a link is up."""
        while True:
            connection = self._connection
            is_free = connection is None and self.sensor.may_connect()
            if is_free is not self.device.is_advertising:
                await (self._advertise() if is_free else self.device.stop_advertising())
            if connection is not None:
                await self._send(connection)
            await asyncio.sleep(INTERVAL_S)

    async def _send(self, connection: Connection) -> None:
        for number, data in self.sensor.notifications():
            if self.sensor.drops_after((number, data)):
                await self.drop()
                return
            await self.device.notify_subscriber(connection, self._by_number[number], data)

    async def _advertise(self) -> None:
        name = (AdvertisingData.Type.COMPLETE_LOCAL_NAME, self.sensor.local_name.encode())
        made_by = [
            (AdvertisingData.Type.MANUFACTURER_SPECIFIC_DATA, company.to_bytes(2, "little") + b"\x01")
            for company in self.sensor.companies
        ]
        await self.device.start_advertising(advertising_data=bytes(AdvertisingData([name, *made_by])))


class BumbleAir:
    """Sensors in reach of one central. `backend` is what bleak is given; `start` is called in the loop of the links."""

    def __init__(self, sensors: Sequence[EmulatedPeripheral], latency_s: Sequence[float] = (), mtu: int = MTU) -> None:
        self.mtu, self._sensors = mtu, sensors
        self._latency_s = latency_s or [0.005] * len(sensors)
        self.central: Device
        self.peripherals: dict[str, _Peripheral] = {}
        air = self

        class Backend(BumbleClient):
            AIR = air

        self.backend: type[BaseBleakClient] = Backend

    async def start(self) -> None:
        link = SlowLink()
        controller = Controller("central", link=link, public_address=CENTRAL)
        self.central = Device("central", address=Address(CENTRAL), host=Host(controller, controller))
        await self.central.power_on()
        for sensor, latency_s in zip(self._sensors, self._latency_s, strict=True):
            link.latency_s[address_of(sensor)] = latency_s
            one = self.peripherals[address_of(sensor)] = _Peripheral(sensor, link)
            await one.start()

    async def stop(self) -> None:
        for one in self.peripherals.values():
            one.stop()

    async def scanned(self, seconds: float) -> list[Announced]:
        """Who advertises within so long."""
        found: dict[str, Announced] = {}

        def received(one: Advertisement) -> None:
            address = str(one.address).partition("/")[0]
            name = one.data.get(AdvertisingData.Type.COMPLETE_LOCAL_NAME) or ""
            made_by = one.data.get_all(AdvertisingData.Type.MANUFACTURER_SPECIFIC_DATA)
            found[address] = Announced(name, address, tuple({company for company, _ in made_by}), address, (), one.rssi)

        self.central.on("advertisement", received)
        await self.central.start_scanning(filter_duplicates=False)
        await asyncio.sleep(seconds)
        await self.central.stop_scanning()
        self.central.remove_listener("advertisement", received)
        return sorted(found.values(), key=lambda one: one.address)

    def drop(self, sensor: EmulatedPeripheral) -> Coroutine[Any, Any, None]:
        """Let the link be lost, if there is one."""
        return self.peripherals[address_of(sensor)].drop()


class BumbleRadio(Radio):
    """The application's own radio, whose adapter is Bumble's."""

    def __init__(self, air: BumbleAir) -> None:
        super().__init__(air.backend)
        self._air = air

    async def announced(self, seconds: float = 1.0) -> list[Announced]:
        async with self.connecting:
            return await self._air.scanned(min(seconds, 3.0))


class BumbleClient(UnpairedClient):
    """bleak's interface for backends, over Bumble's central."""

    AIR: ClassVar[BumbleAir]

    def __init__(self, address_or_ble_device: Any, **more: Any) -> None:
        super().__init__(
            address_or_ble_device,
            disconnected_callback=more.get("disconnected_callback"),
            timeout=more.get("timeout", 10.0),
        )
        self._connection: Connection | None = None
        self._peer: Peer | None = None

    @property
    def name(self) -> str:
        return self.address

    @property
    def mtu_size(self) -> int:
        return int(self._connection.att_mtu) if self._connection is not None else 23

    @property
    def is_connected(self) -> bool:
        return self._connection is not None

    async def connect(self, pair: bool, **kwargs: Any) -> None:
        try:
            connection = await self.AIR.central.connect(Address(self.address), timeout=CONNECTS_S)
            connection.on("disconnection", self._on_disconnection)
            self._connection, self._peer = connection, Peer(connection)
            await self._peer.request_mtu(self.AIR.mtu)
            await self._peer.discover_services()
            self.services = await _services(self._peer, self.AIR.mtu)
        except (BaseBumbleError, TimeoutError) as problem:
            raise BleakError(f"{self.address} was not reached") from problem

    async def disconnect(self) -> None:
        if self._connection is not None:
            await self._connection.disconnect()

    def _on_disconnection(self, _reason: int) -> None:
        self._connection = self._peer = None
        if self._disconnected_callback is not None:
            self._disconnected_callback()

    def _proxy(self, characteristic: BleakGATTCharacteristic) -> CharacteristicProxy[bytes]:
        if self._connection is None:
            raise BleakError("not connected")
        proxy: CharacteristicProxy[bytes] = characteristic.obj
        return proxy

    async def _done(self, work: Coroutine[Any, Any, Any]) -> Any:
        """What this gives; a link that is lost meanwhile is an error at once."""
        connection = self._connection
        if connection is None:
            work.close()
            raise BleakError("not connected")
        try:
            return await connection.cancel_on_disconnection(work)
        except (BaseBumbleError, TimeoutError) as problem:
            raise BleakError("the link was lost") from problem
        except asyncio.CancelledError as problem:
            if self._connection is connection:
                raise  # by who waits for it
            raise BleakError("the link was lost") from problem

    async def read_gatt_char(
        self, characteristic: BleakGATTCharacteristic, *, use_cached: bool = False, **kwargs: Any
    ) -> bytearray:
        return bytearray(await self._done(self._proxy(characteristic).read_value()))

    async def write_gatt_char(self, characteristic: BleakGATTCharacteristic, data: SizedBuffer, response: bool) -> None:
        await self._done(self._proxy(characteristic).write_value(bytes(data), with_response=response))

    async def start_notify(
        self, characteristic: BleakGATTCharacteristic, callback: Callable[[bytearray], None], **kwargs: Any
    ) -> None:
        def received(value: bytes) -> None:
            callback(bytearray(value))

        await self._done(self._proxy(characteristic).subscribe(received))

    async def stop_notify(self, characteristic: BleakGATTCharacteristic) -> None:
        await self._done(self._proxy(characteristic).unsubscribe())


async def _services(peer: Peer, mtu: int) -> BleakGATTServiceCollection:
    """The table that was discovered, as bleak has it."""
    services = BleakGATTServiceCollection()
    for found in peer.services:
        service = BleakGATTService(found, found.handle, str(found.uuid).lower())
        services.add_service(service)
        for one in await found.discover_characteristics():
            names: list[CharacteristicPropertyName] = [
                name for name in ("read", "write", "notify", "write-without-response") if one.properties & BITS[name]
            ]
            services.add_characteristic(
                BleakGATTCharacteristic(one, one.handle, str(one.uuid).lower(), names, lambda: mtu - 3, service)
            )
    return services


class ReachedByBumble:
    """Sensors in the air of a radio whose loop runs when it is asked to."""

    def __init__(self, radio: Radio, sensors: Sequence[EmulatedPeripheral], mtu: int = MTU) -> None:
        self._radio = radio
        self.air = BumbleAir(sensors, [0.004 + 0.003 * number for number in range(len(sensors))], mtu)
        radio.backend = self.air.backend
        radio.run(self.air.start())

    def announced(self) -> Sequence[Announced]:
        return self._radio.run(self.air.scanned(3.0))

    def drop(self, sensor: EmulatedPeripheral) -> None:
        self._radio.run(self.air.drop(sensor))

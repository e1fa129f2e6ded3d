"""Bluetooth LE: what announces itself, and links to it. Beside the emulators the only file that knows bleak.

The library is an extra (`bluetooth`): without it no sensor is found this way, and all else goes on. All links live in
one thread with one event loop, for adapters take one connection at a time. Nothing is paired.
"""

import asyncio
import threading
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, TypeVar

from devices.clocks.host_clock import host_time_ns
from devices.live import SourceLostError, SourceRefusedError

if TYPE_CHECKING:
    from bleak import BleakClient
    from bleak.backends.client import BaseBleakClient
    from bleak.backends.device import BLEDevice

SCAN_S = 4.0
CONNECT_S = 10.0
OPERATION_S = 5.0
LEAVES_S = 5.0

TICK_S = 0.2

Tick = Callable[[], None]
Notified = Callable[[int, bytes], None]
"""Takes a characteristic and what it notified, in the thread of the links."""
Result = TypeVar("Result")


class BluetoothMissingError(SourceRefusedError):
    """The library is not installed."""


@dataclass(frozen=True, slots=True)
class Announced:
    """Something that announces itself."""

    name: str
    address: str
    companies: tuple[int, ...] = ()  # who made it, by what it announces besides its name
    device: "BLEDevice | str" = ""  # as the library wants it for a link
    services: tuple[str, ...] = ()  # the UUIDs that it announces, in small letters
    rssi_dbm: int | None = None  # how strongly it was received; None: that was not reported


class Radio:
    """This computer's adapter, and the thread that everything with it happens in. Methods from any thread.

    Parameters
    ----------
    backend
        What makes links, if it is not this computer's own Bluetooth.
    received
        Who announces itself to that backend.
    """

    def __init__(
        self,
        backend: "type[BaseBleakClient] | None" = None,
        received: Callable[[], Sequence[Announced]] | None = None,
    ) -> None:
        self.backend = backend
        self.received = received
        self.connecting = asyncio.Lock()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._starting = threading.Lock()

    def now_ns(self) -> int:
        """The clock that arrivals are noted by."""
        return host_time_ns()

    def run(self, work: Coroutine[Any, Any, Result], tick: Tick | None = None) -> Result:
        """Run the work in the links' thread and wait; an error of `tick` ends the work, then is raised."""
        loop = self._running()
        if tick is None:
            return asyncio.run_coroutine_threadsafe(work, loop).result()
        ended = threading.Event()
        doing = asyncio.run_coroutine_threadsafe(_begun(work, ended), loop).result()
        while not ended.wait(TICK_S):
            try:
                tick()
            except BaseException:
                loop.call_soon_threadsafe(doing.cancel)
                ended.wait()
                raise
        return doing.result()

    def wait(self, event: threading.Event, seconds: float) -> None:
        """Wait for something that is set in the thread of the links."""
        event.wait(seconds)

    async def announced(self, seconds: float = SCAN_S) -> list[Announced]:
        """Scan for announcements; raises SourceRefusedError without Bluetooth or where it is off."""
        if self.received is not None:
            return list(self.received())
        if find_spec("bleak") is None:
            raise BluetoothMissingError(
                "Bluetooth LE sensors cannot connect: a software library is missing",
                "Install gaitwright[bluetooth]",
            )
        bleak = _bleak()
        async with self.connecting:
            try:
                found = await bleak.BleakScanner.discover(timeout=seconds, return_adv=True)
            except (bleak.exc.BleakError, OSError, EOFError) as problem:
                raise SourceRefusedError(
                    "Bluetooth does not respond on this computer",
                    "Switch it on, or plug in an adapter, then search again",
                ) from problem
        return [
            Announced(
                reported.local_name or device.name or "",
                device.address,
                tuple(reported.manufacturer_data),
                device,
                tuple(map(str.lower, reported.service_uuids)),
                reported.rssi,
            )
            for device, reported in found.values()
        ]

    def _running(self) -> asyncio.AbstractEventLoop:
        with self._starting:
            if self._loop is None:
                self._loop = asyncio.new_event_loop()
                threading.Thread(target=self._loop.run_forever, name="bluetooth", daemon=True).start()
            return self._loop


class BluetoothLink:
    """One peripheral. Every operation takes its turn, ends within seconds, and raises SourceLostError where it fails.

    Parameters
    ----------
    notified
        Called for what was subscribed to.
    """

    def __init__(self, radio: Radio, to: Announced, notified: Notified) -> None:
        self._radio, self._to, self._notified = radio, to, notified
        self._client: BleakClient | None = None
        self._turn = asyncio.Lock()

    @property
    def is_up(self) -> bool:
        return self._client is not None and self._client.is_connected

    async def connect(self) -> None:
        """Connect, one at a time with all other links of the adapter."""
        if self.is_up:
            return
        await self.disconnect()
        client = _bleak().BleakClient(
            self._to.device or self._to.address, timeout=CONNECT_S, backend=self._radio.backend
        )
        async with self._radio.connecting:
            try:
                async with self._lost_within(CONNECT_S):
                    await client.connect()
            except SourceLostError:
                await _left(client)
                raise
        self._client = client

    async def disconnect(self) -> None:
        """Never raises."""
        client, self._client = self._client, None
        if client is not None:
            await _left(client)

    async def read(self, uuid: str) -> bytes:
        async with self._turn, self._lost_within(OPERATION_S):
            return bytes(await self._up().read_gatt_char(uuid))

    async def write(self, uuid: str, data: bytes, *, is_answered: bool = True) -> None:
        """Write, and wait until that is answered; else as the characteristic is made for."""
        async with self._turn, self._lost_within(OPERATION_S):
            await self._up().write_gatt_char(uuid, data, response=True if is_answered else None)

    async def subscribe(self, characteristic: int, uuid: str) -> None:
        """Receive what this characteristic notifies."""

        def received(_sender: object, data: bytearray) -> None:
            self._notified(characteristic, bytes(data))

        async with self._turn, self._lost_within(OPERATION_S):
            await self._up().start_notify(uuid, received)

    def _up(self) -> "BleakClient":
        if self._client is None or not self._client.is_connected:
            raise SourceLostError(f"{self._to.name} is not connected")
        return self._client

    @asynccontextmanager
    async def _lost_within(self, seconds: float) -> AsyncIterator[None]:
        try:
            async with asyncio.timeout(seconds):
                yield
        except (_bleak().exc.BleakError, OSError, EOFError) as problem:  # TimeoutError is an OSError
            raise SourceLostError(f"{self._to.name} was lost") from problem


def _bleak() -> Any:
    import bleak  # an extra

    return bleak


async def _begun(work: Coroutine[Any, Any, Result], ended: threading.Event) -> "asyncio.Task[Result]":
    task = asyncio.get_running_loop().create_task(work)
    task.add_done_callback(lambda _task: ended.set())
    return task


async def _left(client: "BleakClient") -> None:
    with suppress(Exception):  # it is gone, whatever its adapter answers to that
        await _within(client.disconnect(), LEAVES_S)


async def _within(work: Awaitable[None], seconds: float) -> None:
    async with asyncio.timeout(seconds):
        await work


@cache
def own_radio() -> Radio:
    """This computer's Bluetooth: one for the process, for an adapter is no two programs' and no two loops'."""
    return Radio()

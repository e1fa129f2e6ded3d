"""One Movella DOT and its link: what it is asked and ordered, each thing after the other.

Everything here is a coroutine of the links' thread, waits a bounded time, and raises `SourceLostError` where the link
is gone. To a sensor that records only its state is asked: a rate or a mode written then cuts the file.
"""

import asyncio
import threading
from collections import deque
from collections.abc import Callable
from typing import TypeVar

from devices.dot.messages import (
    COMPANY,
    HEADING_RESET,
    NAMES,
    RECORDING_GROUP,
    Characteristic,
    DotAnswer,
    DotInfo,
    DotMessage,
    DotMessageError,
    DotNotice,
    DotSettings,
    Order,
    RecordedFile,
    StreamControl,
    answered,
    identifying,
    recording_order,
    setting_profile,
    setting_rate,
    switching,
)
from devices.dot.samples import FULL, MODES, PLAIN, StreamMode
from devices.live import SourceLostError, SourceRefusedError
from devices.transport.bluetooth import Announced, BluetoothLink, Radio
from devices.transport.notifications import framed

Stated = TypeVar("Stated")

NOTICE_S = 2.0
BUSY_S, BUSY_TRIES = 0.5, 6
ANSWER_S, ANSWER_TRIES = 0.1, 12  # what is read may still be the answer to the order before
FULL_NOTICE = bytes([RECORDING_GROUP, DotNotice.FULL])
MOST_WAITING = 20_000  # notifications that nobody fetched: five minutes


class DotRefusedError(SourceRefusedError):
    """A sensor that does not do what it was asked to."""


def is_dot(one: Announced) -> bool:
    """Whether what announces itself is a DOT."""
    is_named = one.name.casefold() in map(str.casefold, NAMES)  # printed both ways
    return is_named and (not one.companies or COMPANY in one.companies)


class DotSensor:
    """A sensor that announces itself. Coroutines are for the links' thread; `taken` may be called from any.

    `info`, `battery`: as it reported last; None and nothing before it was connected.
    `has_heading_reset`: whether some program turned the headings of its orientations, which lasts until it is switched
    off.
    `cut_notices`: how many notices arrived shorter than they say that they are: the link may carry too little.
    `is_full`: whether it has reported that its memory is full since it was last asked to record.
    `fetched_last`: the file whose sending was ordered last.
    """

    def __init__(self, radio: Radio, announced: Announced) -> None:
        self.radio = radio
        self.info: DotInfo | None = None
        self.battery: float | None = None
        self.has_heading_reset = self.is_full = False
        self.cut_notices = 0
        self.fetched_last: RecordedFile | None = None
        self.sent: list[bytes] = []
        self.arrived = threading.Event()
        self._announced = announced
        self._link = BluetoothLink(radio, announced, self._hear)
        self._frames: deque[tuple[int, bytes]] = deque(maxlen=MOST_WAITING)
        self._notices: asyncio.Queue[bytes] = asyncio.Queue(MOST_WAITING)

    @property
    def name(self) -> str:
        """By the end of its address, as its label has it; by what the computer calls it, until it was asked."""
        address = self.info.mac if self.info is not None else self._announced.address
        return f"DOT {address.replace(':', '')[-4:].upper()}"

    @property
    def is_up(self) -> bool:
        return self._link.is_up

    # the link

    async def connect(self) -> None:
        """Connect, ask who it is, and listen: before anything is started, or its beginning is missed."""
        await self._link.connect()
        if self.info is None:
            self.info = await self._reported(Characteristic.DEVICE_INFO, DotInfo.parsed)
            self.has_heading_reset = await self._read(Characteristic.HEADING) == HEADING_RESET
        for characteristic in (
            Characteristic.NOTICE,
            Characteristic.BATTERY,
            *(mode.characteristic for mode in MODES.values()),
        ):
            await self._link.subscribe(characteristic, characteristic.uuid)
        self._hear(Characteristic.BATTERY, await self._read(Characteristic.BATTERY))

    async def connect_barely(self) -> None:
        """Connect and do nothing else."""
        await self._link.connect()

    async def disconnect(self) -> None:
        await self._link.disconnect()

    def taken(self) -> list[tuple[int, bytes]]:
        """When each notification arrived, by the radio's clock, and it as it is kept."""
        frames = []
        self.arrived.clear()
        while self._frames:
            frames.append(self._frames.popleft())
        return frames

    def _hear(self, characteristic: int, payload: bytes) -> None:
        if characteristic == Characteristic.BATTERY and payload:
            self.battery = min(payload[0], 100) / 100
        if characteristic == Characteristic.NOTICE:
            self.is_full |= payload[:1] + payload[2:3] == FULL_NOTICE
            if self._notices.full():
                self._notices.get_nowait()
            self._notices.put_nowait(payload)
        else:
            self._frames.append((self.radio.now_ns(), framed(characteristic, payload)))
            self.arrived.set()

    async def _read(self, characteristic: Characteristic) -> bytes:
        return await self._link.read(characteristic.uuid)

    async def _reported(self, characteristic: Characteristic, parsed: Callable[[bytes], Stated]) -> Stated:
        """What it reports there; one that reports less than it has to is taken for lost, and tried again as such."""
        try:
            return parsed(await self._read(characteristic))
        except DotMessageError as problem:
            raise SourceLostError(f"{self.name} holds too little") from problem

    async def _write(self, characteristic: Characteristic, data: bytes) -> None:
        await self._link.write(characteristic.uuid, data)
        self.sent.append(framed(characteristic, data))

    # settings and streams

    async def set_up(self, rate_hz: int, profile: int) -> None:
        """Set rate and profile and confirm; raises DotRefusedError where they are not set."""
        required = DotSettings(rate_hz, profile)
        if await self.settings() == required:
            return
        await self._write(Characteristic.SETTINGS, setting_rate(rate_hz))
        await self._write(Characteristic.SETTINGS, setting_profile(profile))
        if await self.settings() != required:
            raise DotRefusedError(
                "{sensor} did not accept its sample rate", "Switch it off and on, then search again", sensor=self.name
            )

    async def settings(self) -> DotSettings:
        return await self._reported(Characteristic.SETTINGS, DotSettings.parsed)

    async def control(self) -> StreamControl:
        return await self._reported(Characteristic.CONTROL, StreamControl.parsed)

    async def streaming(self) -> StreamMode | None:
        """The mode in which it streams already; None where it does not, or in one that is not read here."""
        control = await self.control()
        return MODES.get(control.mode) if control.is_on else None

    async def start_stream(self) -> StreamMode:
        """Stream, with orientations where it can; raises DotRefusedError where it does not begin."""
        for mode in (FULL, PLAIN):
            await self._write(Characteristic.CONTROL, switching(mode.number, is_on=True))
            if await self.control() == StreamControl(is_on=True, mode=mode.number):
                return mode
        raise DotRefusedError(
            "{sensor} does not start measuring", "Switch it off and on, then search again", sensor=self.name
        )

    async def stop_stream(self) -> None:
        control = await self.control()
        if control.is_on:
            await self._write(Characteristic.CONTROL, switching(control.mode, is_on=False))

    async def identify(self) -> None:
        await self._write(Characteristic.SETTINGS, identifying())

    # messages

    async def show_message(self, message: DotMessage) -> None:
        """Send a message; what was noticed before is no answer to it."""
        self.forget()
        await self._write(Characteristic.MESSAGE, message.packed())

    async def answer(self) -> DotMessage | None:
        """What the last message was answered with; None where that cannot be read."""
        try:
            return DotMessage.parsed(await self._read(Characteristic.ANSWER))
        except DotMessageError:
            return None

    async def order(self, order: Order, data: bytes = b"") -> DotAnswer:
        """Give an order of the memory, again while the sensor is busy."""
        reported = DotAnswer.UNKNOWN
        for attempt in range(BUSY_TRIES):
            if attempt:
                await asyncio.sleep(BUSY_S)
            await self.show_message(recording_order(order, data))
            reported = await self._answered(order)
            if reported is not DotAnswer.BUSY:
                break
        return reported

    async def _answered(self, order: Order) -> DotAnswer:
        for attempt in range(ANSWER_TRIES):
            if attempt:
                await asyncio.sleep(ANSWER_S)
            answer = await self.answer()
            reported = DotAnswer.UNKNOWN if answer is None else answered(order, answer)
            if reported is not DotAnswer.UNKNOWN:
                return reported
        return DotAnswer.UNKNOWN

    async def state(self) -> DotAnswer:
        """What its memory does; harmless whatever that is."""
        return await self.order(Order.GET_STATE)

    def forget(self) -> None:
        """What was noticed and not taken is not waited for any more."""
        while not self._notices.empty():
            self._notices.get_nowait()

    async def notice(self, within_s: float = NOTICE_S) -> bytes:
        """Give the next notice as it came, empty on timeout; raises SourceLostError where the link is gone."""
        try:
            async with asyncio.timeout(within_s):
                return await self._notices.get()
        except TimeoutError:
            if not self.is_up:
                raise SourceLostError(f"{self.name} was lost") from None
            return b""

    def understood(self, payload: bytes) -> DotMessage | None:
        """What a notice contains; None where it arrived damaged."""
        try:
            return DotMessage.parsed(payload)
        except DotMessageError:
            self.cut_notices += len(payload) < 3 or len(payload) < payload[1] + 3
            return None

    async def expect(self, is_meant: Callable[[DotMessage], bool], within_s: float = NOTICE_S) -> DotMessage | None:
        """The first notice of a kind; None where none comes in time."""
        loop = asyncio.get_running_loop()
        until_s = loop.time() + within_s
        while (left_s := until_s - loop.time()) > 0:
            payload = await self.notice(left_s)
            message = self.understood(payload) if payload else None
            if message is not None and is_meant(message):
                return message
        return None

"""Driver of Xsens MTi sensors: how they are set up, and what their messages hold.

Samples are put in order and stamped by the sensor's fine clock, of messages with rate and acceleration only: those with
what the satellites reported come late and carry an earlier time. A rate is the mean over the interval before its
stamp, for it is the rotation of that interval (item 8030) divided by its length, as recorded streams show.
"""

import struct
from collections.abc import Sequence
from typing import NamedTuple

from core.samples import RateKind
from devices.clocks.clock import Unwrapping
from devices.drivers.xbus import (
    AXES_MASK,
    ITEM_MASK,
    NORTH_EAST_DOWN,
    Item,
    Items,
    Message,
    Mid,
    XbusFramer,
    message,
    values,
)
from devices.live import SensorDetails, SourceRefusedError
from devices.source import SourceInfo
from devices.stream import Received, Row, ask
from devices.transport.channels import Channel

DRIVER, VERSION = "xsens-mti", "1"
EMULATED = "emulated MTi"  # what our own emulator calls itself
RATE_HZ, FASTEST_HZ = 100, 200  # within them its owner's rate is kept, and fits 115200 baud: 9.4 of 11.5 kB/s
ORIENTED_HZ = 170  # so far the orientation fits beside it, 66 bytes in all
FINE_HZ, FINE_BITS, COUNTER_BITS = 10_000.0, 32, 16
FINE_TURN_S = 2**FINE_BITS / FINE_HZ
ANSWERS_S = 0.5
TRIES = 4  # a sensor that is measuring receives the first request late
# one that was left in its configuration is silent; this asks for its number
KNOCK = message(Mid.DEVICE_ID, b""), bytes([0xFA, 0xFF, Mid.DEVICE_ID + 1])
ALWAYS = 0xFFFF  # in place of a frequency: with every message
SETTING = struct.Struct(">HH")  # an item's identifier and its frequency
MOTION = frozenset({Item.RATE, Item.ACCELERATION, Item.ROTATION_CHANGE, Item.VELOCITY_CHANGE, Item.QUATERNION})
MOST_LAYOUTS = 64  # of messages; a sensor has a handful, noise any
HALF_TURN = 0.5**0.5
MOST_RAD_S, MOST_M_S2 = 100.0, 500.0  # no sensor worn by a person measures more


class MtiFramer:
    """See `devices.stream.Framer`. `replies` are the other messages: identifier and data."""

    def __init__(self, info: SourceInfo) -> None:
        self.received = Received()
        self._framer = XbusFramer()
        self._damaged = 0
        self._host_s = 0.0
        rate_hz = info.settings.get("rate_hz")
        self._rate_hz = float(rate_hz) if isinstance(rate_hz, int | float) else 0.0
        self._fine = Unwrapping(FINE_BITS, FINE_HZ)
        self._turns_s: float | None = None
        self._counter = Unwrapping(COUNTER_BITS, self._rate_hz)
        self._layouts: dict[tuple[int, ...], _Where] = {}

    def feed(self, data: bytes, host_s: float) -> None:
        self._host_s = host_s
        self._take(self._framer.feed(data))

    def flush(self) -> None:
        self._take(self._framer.flush())

    def _take(self, messages: Sequence[Message]) -> None:
        received = self.received
        for one in messages:
            if one.mid == Mid.MT_DATA2:
                self._sample(one.items)
            else:
                received.replies.append(bytes([one.mid]) + one.data)
        received.damaged += self._framer.damaged - self._damaged
        self._damaged = self._framer.damaged

    def _sample(self, items: Items) -> None:
        here = self._where(items)
        rate, force = _values(items, here.rate), _values(items, here.acceleration)
        if not rate or not force:
            self.received.skipped += 1  # what the satellites reported
            return
        if not _is_meant(rate, MOST_RAD_S) or not _is_meant(force, MOST_M_S2):
            self.received.damaged += 1  # a checksum of 8 bits is right by chance one time in 256
            return
        if fine := _values(items, here.fine):
            device_s = self._fine.ticks(int(fine[0]), self._host_s) / FINE_HZ
            if self._turns_s is None:  # so that the clock goes on after a cut, although it may have begun again
                self._turns_s = round((self._host_s - device_s) / FINE_TURN_S) * FINE_TURN_S
            device_s += self._turns_s
        elif (counter := _values(items, here.counter)) and self._rate_hz:
            device_s = self._counter.ticks(int(counter[0]), self._host_s) / self._rate_hz
        else:
            self.received.damaged += 1
            return
        self.received.rows.append((device_s, *rate, *force))
        if q := _values(items, here.orientation):
            is_down = here.orientation & AXES_MASK == NORTH_EAST_DOWN
            self.received.orientations.append((device_s, *(upward(q) if is_down else q)))

    def _where(self, items: Items) -> "_Where":
        """Under which identifiers a message carries what is required; most messages carry the same."""
        here = self._layouts.get(key := tuple(items))
        if here is None:
            if len(self._layouts) > MOST_LAYOUTS:
                self._layouts.clear()
            here = self._layouts[key] = _Where(*(_whole(items, kind) for kind in REQUIRED))
        return here


class _Where(NamedTuple):
    """Whole identifiers of what a message carries, 0 of what it does not."""

    fine: int
    counter: int
    rate: int
    acceleration: int
    orientation: int


REQUIRED = (Item.FINE_TIME, Item.COUNTER, Item.RATE, Item.ACCELERATION, Item.QUATERNION)


def _whole(items: Items, kind: int) -> int:
    return next((identifier for identifier in items if identifier & ITEM_MASK == kind), 0)


def _values(items: Items, identifier: int) -> tuple[float, ...]:
    return values(identifier, items[identifier]) if identifier else ()


def _is_meant(values: tuple[float, ...], most: float) -> bool:
    x, y, z = values
    return -most < x < most and -most < y < most and -most < z < most


def upward(q: Row) -> Row:
    """An orientation (4) to an earth with z down, as one to an earth with z up: x and y change places."""
    w, x, y, z = q
    return -HALF_TURN * (x + y), HALF_TURN * (w + z), HALF_TURN * (w - z), HALF_TURN * (y - x)


class XsensMti:
    """MTi 1, 10, 100 and 600 series, by USB or another serial cable.

    Parameters
    ----------
    rate_hz
        Of all that is required; None: as its owner set it, but `RATE_HZ` at least and `FASTEST_HZ` at most.
    """

    driver, version = DRIVER, VERSION

    def __init__(self, rate_hz: float | None = None) -> None:
        self._required_hz = rate_hz

    def framer(self, info: SourceInfo) -> MtiFramer:
        return MtiFramer(info)

    def greet(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        framer = MtiFramer(SourceInfo(DRIVER, VERSION))
        if not any(_asked(channel, framer, Mid.GO_TO_CONFIG) for _ in range(TRIES)):
            raise SourceRefusedError(
                "No Xsens sensor responds at {place}",
                "Check that it is plugged in there, and that MT Manager is closed",
                place=channel.place,
            )
        serial = _asked(channel, framer, Mid.DEVICE_ID)[1:].hex().upper()
        model = _asked(channel, framer, Mid.PRODUCT)[1:].decode("ascii", "replace").strip("\0 ")
        firmware = ".".join(str(part) for part in _asked(channel, framer, Mid.FIRMWARE)[1:4])
        rate_hz = self._set_up(channel, framer)
        if not serial or not rate_hz or not _asked(channel, framer, Mid.GO_TO_MEASUREMENT):
            raise SourceRefusedError(
                "The Xsens sensor at {place} did not accept its settings",
                "Plug it in again, then search again",
                place=channel.place,
            )
        settings = {"rate_hz": rate_hz}
        info = SourceInfo(DRIVER, VERSION, serial, (f"MTi {serial}",), settings, is_simulated=model == EMULATED)
        return info, SensorDetails(model, serial, firmware, rate_hz, RateKind.AVERAGED)

    def identifying(self) -> bytes:
        return b""

    def _set_up(self, channel: Channel, framer: MtiFramer) -> float:
        """Ask for what is needed, with the orientation where there is one; the rate that the sensor chose, or 0."""
        rate = round(self._required_hz or _owned_hz(channel, framer))
        for hz in dict.fromkeys((rate, RATE_HZ)):  # some models have no other
            needed = [(Item.COUNTER, ALWAYS), (Item.FINE_TIME, ALWAYS), (Item.ACCELERATION, hz), (Item.RATE, hz)]
            for orientation in ([(Item.QUATERNION, hz)], []) if hz <= ORIENTED_HZ else ([],):
                chosen = _settings(channel, framer, [*needed, *orientation])
                if chosen.get(Item.RATE) and chosen.get(Item.ACCELERATION) == chosen[Item.RATE]:
                    return float(chosen[Item.RATE])
        return 0.0


def _owned_hz(channel: Channel, framer: MtiFramer) -> int:
    """At what rate its owner let it report how it moves, where that is of use; else the nearest that is."""
    motion = [hz for identifier, hz in _settings(channel, framer, ()).items() if identifier & ITEM_MASK in MOTION]
    return min(max([RATE_HZ, *motion]), FASTEST_HZ)


def _settings(channel: Channel, framer: MtiFramer, required: Sequence[tuple[int, int]]) -> dict[int, int]:
    """What it sends, and how often, once it was asked for what is required; as it is where that is nothing."""
    framer.received.replies.clear()
    answer = _asked(channel, framer, Mid.OUTPUT, b"".join(SETTING.pack(*setting) for setting in required))[1:]
    return dict(SETTING.iter_unpack(answer[: len(answer) // SETTING.size * SETTING.size]))


def _asked(channel: Channel, framer: MtiFramer, mid: int, data: bytes = b"") -> bytes:
    """The answer to a request, identifier first; empty where none comes."""
    return ask(channel, framer, message(mid, data), lambda reply: reply[0] in (mid + 1, Mid.ERROR), ANSWERS_S)

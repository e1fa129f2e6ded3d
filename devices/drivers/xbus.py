"""Messages of Xsens' Xbus protocol, which MTi sensors speak.

    FA FF identifier length [length of 16 bits, if FF] data checksum

All bytes behind FA sum to 0. The data of an MTData2 message are items: an identifier of 16 bits, a length, and values,
all big-endian (Xsens, MT Low Level Communication Protocol Documentation, MT0101P).
"""

import struct
from collections.abc import Mapping
from typing import NamedTuple

PREAMBLE = b"\xfa\xff"  # and the address of a sensor that is the only one on its cable
BEGIN = PREAMBLE + b"\x36"  # of what a sensor measured
LONG = 0xFF  # in place of a length: the length follows
MOST_DATA = 2048  # bytes; what announces more is no message
HEADER = struct.Struct(">HB")  # of an item: identifier and length


class Mid:
    """Identifiers of messages. The answer to a request is the next number."""

    DEVICE_ID = 0x00
    GO_TO_MEASUREMENT = 0x10
    FIRMWARE = 0x12
    PRODUCT = 0x1C
    GO_TO_CONFIG = 0x30
    MT_DATA2 = 0x36
    ERROR = 0x42
    OUTPUT = 0xC0


REQUESTS = frozenset({Mid.DEVICE_ID, Mid.GO_TO_MEASUREMENT, Mid.FIRMWARE, Mid.PRODUCT, Mid.GO_TO_CONFIG, Mid.OUTPUT})
ANSWERS = frozenset({Mid.ERROR, *(mid + 1 for mid in REQUESTS)})  # all else is noise that looks like a message


class Item:
    """Identifiers of items, without the bits that give the numbers' format and the earth's axes."""

    COUNTER = 0x1020
    FINE_TIME = 0x1060  # ticks of 100 us
    QUATERNION = 0x2010
    VELOCITY_CHANGE = 0x4010
    ACCELERATION = 0x4020
    ROTATION_CHANGE = 0x8030
    RATE = 0x8020
    MAGNETIC_FIELD = 0xC020
    STATUS = 0xE020


ITEM_MASK = 0xF8F0
AXES_MASK, NORTH_EAST_DOWN = 0x000C, 0x0004
FORMAT_MASK = 0x0003  # float32, fixed point 12.20, fixed point 16.32, float64
REALS = {  # items of real numbers in the format that their identifier gives, and how many
    0x0810: 1,  # temperature
    Item.QUATERNION: 4,
    0x2020: 9,  # rotation matrix
    0x2030: 3,  # Euler angles
    Item.VELOCITY_CHANGE: 3,
    Item.ACCELERATION: 3,
    0x4030: 3,  # free acceleration
    0x5020: 1,  # altitude
    0x5030: 3,  # position
    0x5040: 2,  # latitude and longitude
    Item.RATE: 3,
    Item.ROTATION_CHANGE: 4,
    Item.MAGNETIC_FIELD: 3,
    0xD010: 3,  # velocity
}
WHOLES = {  # items of whole numbers
    0x1010: struct.Struct(">IHBBBBBB"),  # UTC: ns, year, month, day, hour, minute, second, flags
    Item.COUNTER: struct.Struct(">H"),
    Item.FINE_TIME: struct.Struct(">I"),
    0x1070: struct.Struct(">I"),  # coarse time
    0x3010: struct.Struct(">I"),  # pressure
    0x7010: struct.Struct(">IH6BIi4B4i2I5i2Ii7H"),  # GNSS: position, velocity, time
    0xE010: struct.Struct(">B"),  # status
    Item.STATUS: struct.Struct(">I"),
}
SATELLITES, SATELLITES_HEAD = 0x7020, struct.Struct(">I4B")  # and four bytes for each satellite
FLOAT32 = {count: struct.Struct(f">{count}f") for count in range(1, 10)}
FIXED_12_20 = {count: struct.Struct(f">{count}i") for count in range(1, 10)}
FIXED_16_32 = {count: struct.Struct(">" + count * "Ih") for count in range(1, 10)}  # the fraction first
FLOAT64 = {count: struct.Struct(f">{count}d") for count in range(1, 10)}
BYTES = (4, 4, 6, 8)  # of one number, by format

Items = Mapping[int, bytes]


class Message(NamedTuple):
    """A message whose checksum is right; `items` by their whole identifiers, of MTData2 only."""

    mid: int
    data: bytes
    items: Items


def message(mid: int, data: bytes = b"") -> bytes:
    """The bytes of a message."""
    length = bytes([len(data)]) if len(data) < LONG else bytes([LONG]) + len(data).to_bytes(2, "big")
    body = PREAMBLE[1:] + bytes([mid]) + length + data
    return PREAMBLE[:1] + body + bytes([-sum(body) & 0xFF])


def item(identifier: int, data: bytes) -> bytes:
    """One item as it is in a message: identifier, length, data."""
    return HEADER.pack(identifier, len(data)) + data


def values(identifier: int, data: bytes) -> tuple[float, ...]:
    """Give the numbers of one item in its unit; none of an unknown item or one of the wrong length."""
    kind = identifier & ITEM_MASK
    if count := REALS.get(kind):
        return _reals(identifier & FORMAT_MASK, count, data)
    if shape := WHOLES.get(kind):
        return shape.unpack(data) if len(data) == shape.size else ()
    if kind == SATELLITES and len(data) >= SATELLITES_HEAD.size:
        return (*SATELLITES_HEAD.unpack_from(data), *data[SATELLITES_HEAD.size :])
    return ()


def _reals(number_format: int, count: int, data: bytes) -> tuple[float, ...]:
    if len(data) != count * BYTES[number_format]:
        return ()
    if number_format == 0:
        return FLOAT32[count].unpack(data)
    if number_format == 1:
        return tuple(number / 2**20 for number in FIXED_12_20[count].unpack(data))
    if number_format == 2:
        parts = FIXED_16_32[count].unpack(data)
        return tuple(whole + fraction / 2**32 for fraction, whole in zip(parts[::2], parts[1::2], strict=True))
    return FLOAT64[count].unpack(data)


class XbusFramer:
    """Cuts a stream into messages, in pieces of any size; never raises and holds one message at most.

    Whatever does not begin a message is passed over byte by byte, so that a message inside it is still found.
    `damaged` counts the stretches that were passed over; `others` are the messages besides MTData2 that are meant.
    """

    def __init__(self, others: frozenset[int] = ANSWERS) -> None:
        self.damaged = 0
        self._others = others
        self._held = b""
        self._is_lost = False

    def feed(self, data: bytes) -> list[Message]:
        """Take the next bytes and give the messages that end in them."""
        return self._cut(self._held + data, is_end=False)

    def flush(self) -> list[Message]:
        """Nothing follows: what still waits for its end will not have it, but may hold whole messages."""
        found = self._cut(self._held, is_end=True)
        self._held, self._is_lost = b"", False
        return found

    def _cut(self, held: bytes, is_end: bool) -> list[Message]:
        found = []
        at = 0
        while True:
            start = held.find(PREAMBLE, at)
            if start < 0:
                rest = len(held) - held.endswith(PREAMBLE[:1])
                self._pass_over(rest - at)
                at = max(at, rest)
                break
            self._pass_over(start - at)
            at = start
            one, end = self._message(held, start, is_end)
            inner = held.find(BEGIN, start + 1, end + 2) if one is not None else -1
            while inner >= 0 and one is not None and end <= len(held):
                # bytes were lost, so that its end was found in the next one, and its checksum is right by chance
                following, until = self._message(held, inner, is_end)
                if until > len(held):
                    end = until  # whose rest is on the way
                elif following is not None:
                    one, end = None, start + 1
                inner = held.find(BEGIN, inner + 1, end + 2)
            is_doubtful = held.endswith((PREAMBLE, PREAMBLE[:1])) and end <= len(held) < end + 2 and not is_end
            if end > len(held) or is_doubtful:
                break  # its rest is on the way, or what shows whether the next one begins within it
            if one is None:
                self._pass_over(1)
            else:
                found.append(one)
                self._is_lost = False
            at = end
        self._held = held[at:]
        return found

    def _message(self, held: bytes, start: int, is_end: bool) -> tuple[Message | None, int]:
        """The message that begins at `start` and its end; or none, and where to look next: behind all, to wait."""
        body, end = _body(held, start)
        if end > len(held):
            return None, end if end - body <= MOST_DATA and not is_end else start + 1
        one = _checked(held, start, body, end, self._others)
        return one, end if one is not None else start + 1

    def _pass_over(self, count: int) -> None:
        if count > 0:
            self.damaged += not self._is_lost
            self._is_lost = True


def _body(held: bytes, start: int) -> tuple[int, int]:
    """Where the data of the message at `start` begin, and where it ends; behind all bytes, if that is not yet known."""
    if len(held) < start + 4:
        return start + 4, len(held) + 1
    length = held[start + 3]
    if length < LONG:
        return start + 4, start + 5 + length
    if len(held) < start + 6:
        return start + 6, len(held) + 1
    return start + 6, start + 7 + int.from_bytes(held[start + 4 : start + 6], "big")


def _checked(held: bytes, start: int, body: int, end: int, others: frozenset[int]) -> Message | None:
    if sum(held[start + 1 : end]) & 0xFF:
        return None
    mid, data = held[start + 2], held[body : end - 1]
    if mid != Mid.MT_DATA2:
        return Message(mid, data, {}) if mid in others else None
    items = _items(data)
    return None if items is None else Message(mid, data, items)


def _items(data: bytes) -> Items | None:
    """The items of MTData2; None if they do not fill the message, which no checksum of 8 bits shows for certain."""
    items, at, length = {}, 0, len(data)
    unpack = HEADER.unpack_from
    while at < length - 2:
        identifier, size = unpack(data, at)
        at += 3 + size
        items[identifier] = data[at - size : at]
    return items if at == length else None

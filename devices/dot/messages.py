"""Messages of a Movella DOT: what is written to it, and what it answers, byte by byte.

After the Bluetooth LE service specification XD0506P, revision F (Xsens 2021), with the corrections of Movella's
revision C (2023). All numbers are little-endian. Nothing was held against a sensor: numbers stand as they were printed.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum

BASE = "1517{:04x}-4947-11e9-8646-d663bd873d93"
COMPANY = 0x0886  # in what it announces, beside its name
NAMES = ("Xsens DOT", "Movella DOT")


class Characteristic(IntEnum):
    """The part of a characteristic's identifier that differs."""

    DEVICE_INFO = 0x1001
    SETTINGS = 0x1002
    REPORT = 0x1004
    CONTROL = 0x2001
    LONG, MEDIUM, SHORT = 0x2002, 0x2003, 0x2004
    HEADING = 0x2006
    BATTERY = 0x3001
    MESSAGE = 0x7001
    ANSWER = 0x7002
    NOTICE = 0x7003

    @property
    def uuid(self) -> str:
        return BASE.format(self.value)


RECORDING_GROUP, SYNC_GROUP = 0x01, 0x02
RATES_HZ = (1, 4, 10, 12, 15, 20, 30, 60)  # while it streams
RECORDED_HZ = (*RATES_HZ, 120)
SETTINGS_SIZE, INFO_SIZE, MAC_SIZE = 32, 34, 6
IDENTIFY, RATE, PROFILE = 0x01, 0x10, 0x20  # bits of the first byte of what is set
HEADING_RESET = b"\x01\x00"
EMULATED = "emulated DOT"
MODELS = {"XS-T01": "DOT v1", "XS-T02": "DOT v2", "EMUDOT": EMULATED}  # the last one is our own emulator


class DotMessageError(ValueError):
    """Bytes that are no whole message: too few, or with a sum that is not theirs."""


@dataclass(frozen=True, slots=True)
class DotMessage:
    """A message of one of the groups: `group length data sum`; all its bytes add up to 0."""

    group: int
    data: bytes

    def packed(self) -> bytes:
        body = bytes([self.group, len(self.data)]) + self.data
        return body + bytes([-sum(body) & 0xFF])

    @classmethod
    def parsed(cls, padded: bytes) -> "DotMessage":
        """Parse a characteristic, whose end may be padding; raises DotMessageError where cut or sum wrong."""
        if len(padded) < 3 or len(padded) < padded[1] + 3:
            raise DotMessageError(f"a message of {len(padded)} bytes is cut")
        whole = bytes(padded[: padded[1] + 3])
        if sum(whole) & 0xFF:
            raise DotMessageError(f"the sum of {whole.hex()} is wrong")
        return cls(whole[0], whole[2:-1])


@dataclass(frozen=True, slots=True)
class DotInfo:
    """What a sensor reports about itself. `mac` as it is written, most significant byte first."""

    mac: str
    firmware: tuple[int, int, int]
    serial: str
    model: str

    @classmethod
    def parsed(cls, data: bytes) -> "DotInfo":
        """Parse characteristic 1001; raises DotMessageError where it is too short."""
        if len(data) < INFO_SIZE:
            raise DotMessageError(f"device information has {len(data)} bytes, expected {INFO_SIZE}")
        mac = ":".join(f"{byte:02X}" for byte in reversed(data[:MAC_SIZE]))
        (serial,) = struct.unpack_from("<Q", data, 20)
        code = data[28:34].rstrip(b"\0").decode("ascii", "replace")
        return cls(mac, (data[6], data[7], data[8]), f"{serial:X}", MODELS.get(code, code))

    @property
    def can_synchronise(self) -> bool:
        return self.firmware >= (1, 4, 0)


@dataclass(frozen=True, slots=True)
class DotSettings:
    """Rate and filter profile (0 General, 1 Dynamic), which stay until they are set again."""

    rate_hz: int
    profile: int

    @classmethod
    def parsed(cls, data: bytes) -> "DotSettings":
        """Parse characteristic 1002; raises DotMessageError where it is too short."""
        if len(data) < 27:
            raise DotMessageError(f"settings have {len(data)} bytes, expected {SETTINGS_SIZE}")
        return cls(*struct.unpack_from("<HB", data, 24))


def setting_rate(rate_hz: int) -> bytes:
    """What sets the rate of outputs."""
    if rate_hz not in RECORDED_HZ:
        raise ValueError(f"{rate_hz} Hz is none of {RECORDED_HZ}")
    return _setting(RATE, 24, struct.pack("<H", rate_hz))


def setting_profile(profile: int) -> bytes:
    """What sets the filter profile."""
    return _setting(PROFILE, 26, bytes([profile]))


def identifying() -> bytes:
    """What lets the light blink red for ten seconds."""
    return _setting(IDENTIFY, 1, b"\x01")


def _setting(mask: int, at: int, value: bytes) -> bytes:
    data = bytearray(SETTINGS_SIZE)
    data[0] = mask
    data[at : at + len(value)] = value
    return bytes(data)


def switching(mode: int, *, is_on: bool) -> bytes:
    """What starts or stops the stream of a mode."""
    return bytes([1, is_on, mode])


@dataclass(frozen=True, slots=True)
class StreamControl:
    """Whether it streams, and in which mode."""

    is_on: bool
    mode: int

    @classmethod
    def parsed(cls, data: bytes) -> "StreamControl":
        """Parse characteristic 2001; raises DotMessageError where it is too short."""
        if len(data) < 3:
            raise DotMessageError(f"the stream's control has {len(data)} bytes, expected 3")
        return cls(data[1] == 1, data[2])


# synchronising

SYNC_STATUS = DotMessage(SYNC_GROUP, b"\x08")
STOP_SYNC = DotMessage(SYNC_GROUP, b"\x02")
IS_NOT_SYNCHRONISED = DotMessage(SYNC_GROUP, b"\x51\x09")
IS_SYNCHRONISED = DotMessage(SYNC_GROUP, b"\x51\x04")
SYNC_STOPPED = DotMessage(SYNC_GROUP, b"\x50\x00")


def start_sync(root: str) -> DotMessage:
    """What every sensor is sent, the root among them, with the root's `DotInfo.mac`."""
    return DotMessage(SYNC_GROUP, b"\x01" + bytes.fromhex(root.replace(":", ""))[::-1])


class SyncResult(IntEnum):
    """What a sensor answers once synchronising is over."""

    GOOD = 0x00
    FEW_SAMPLES = 0x05
    SKEW_TOO_LARGE = 0x07
    START_FAILED = 0x08
    NOT_STARTED = 0x09
    UNKNOWN = 0xFF

    @classmethod
    def of(cls, answer: DotMessage) -> "SyncResult":
        """Of an answer, which may repeat after its result what it answers to."""
        if answer.group != SYNC_GROUP or len(answer.data) < 2 or answer.data[0] != 0x03:
            return cls.UNKNOWN
        return cls(answer.data[1]) if answer.data[1] in set(cls) else cls.UNKNOWN


# recording in the sensor


class DotAnswer(IntEnum):
    """What an order was answered with; those of `GET_STATE` say what the sensor does."""

    DONE = 0x00
    INVALID = 0x02  # not in the state that the sensor is in
    BUSY = 0x03
    IDLE = 0x06
    ERASING = 0x30
    FULL = 0x34
    RECORDING = 0x40
    EXPORTING_LIST, EXPORTING_INFO, EXPORTING = 0x50, 0x60, 0x70
    UNKNOWN = 0xFF


class Order(IntEnum):
    """What a sensor is asked to do with its memory; the first byte of a message's data."""

    GET_STATE = 0x02
    ERASE = 0x30
    START = 0x40
    STOP = 0x41
    LIST = 0x50
    FILE_INFO = 0x60
    FETCH = 0x70
    BREAK_OFF = 0x73
    CHOOSE = 0x74
    FETCH_FROM = 0x75


class DotNotice(IntEnum):
    """What a sensor reports about its memory; the first byte of a message's data."""

    BUSY = 0x03
    ERASED = 0x33
    FULL, FOREIGN_FORMAT = 0x34, 0x35
    STOPPED = 0x41
    LIST, LIST_END = 0x51, 0x52
    FILE_INFO, FILE_INFO_END, NO_FILE = 0x61, 0x62, 0x63
    DATA, DATA_END, DATA_BROKEN_OFF, DATA_DAMAGED = 0x71, 0x72, 0x73, 0x76


NO_TIMER = b"\xff\xff"
FLASH_MAGIC = struct.pack("<I", 0x466C6173)
FILE_MAGIC = struct.pack("<I", 0x5265636F)
FLASH_HEADER = struct.Struct("<4sI")  # and how many bytes it has in all, 128
FILE_BEGINS, FILE_GOES_ON = 0xEE, 0xCC  # one byte for each piece of the memory; 0xFF: it is free
PIECE_BYTES = 228_000  # of a piece that goes on
FILE_INFO = struct.Struct("<4sIHIH")


def recording_order(order: Order, data: bytes = b"") -> DotMessage:
    """An order with what belongs to it."""
    return DotMessage(RECORDING_GROUP, bytes([order]) + data)


def start_recording(utc_s: int) -> DotMessage:
    """Record until asked to stop; `utc_s` names the file."""
    return recording_order(Order.START, struct.pack("<I", utc_s) + NO_TIMER)


def erase(utc_s: int) -> DotMessage:
    """Erase the whole memory; every file in it is gone."""
    return recording_order(Order.ERASE, struct.pack("<I", utc_s))


def fetch_from(number: int) -> DotMessage:
    """Send what was chosen of the file that was fetched last again, from this sample on."""
    return recording_order(Order.FETCH_FROM, struct.pack("<I", number))


def answered(order: Order, answer: DotMessage) -> DotAnswer:
    """What `order` was answered with; UNKNOWN where the answer is to something else."""
    if answer.group != RECORDING_GROUP or len(answer.data) < 3 or answer.data[0] != 1 or answer.data[2] != order:
        return DotAnswer.UNKNOWN
    return DotAnswer(answer.data[1]) if answer.data[1] in set(DotAnswer) else DotAnswer.UNKNOWN


@dataclass(frozen=True, slots=True)
class RecordedFile:
    """A recording in a sensor's memory."""

    number: int  # counted from 1
    started_utc_s: int  # what `start_recording` was given
    most_bytes: int = 0  # about: as many pieces of the memory as it takes

    @classmethod
    def parsed(cls, number: int, data: bytes, pieces: int = 0) -> "RecordedFile":
        """Parse FILE_INFO less its first byte; its length field is a timer, unused (revision C, 5.2.4.9)."""
        if len(data) < FILE_INFO.size:
            raise DotMessageError(f"a file's information has {len(data)} bytes, expected {FILE_INFO.size}")
        magic, _, _, started, _ = FILE_INFO.unpack_from(data)
        if magic != FILE_MAGIC:
            raise DotMessageError(f"a file's information begins with {data[:4].hex()}")
        return cls(number, started, pieces * PIECE_BYTES)


def files_listed(notices: bytes) -> tuple[int, ...]:
    """Give each file's memory pieces from joined LIST notices less first bytes; raises DotMessageError."""
    if len(notices) < FLASH_HEADER.size or not notices.startswith(FLASH_MAGIC):
        raise DotMessageError(f"a list begins with {notices[:4].hex()}")
    _, header_size = FLASH_HEADER.unpack_from(notices)
    if not FLASH_HEADER.size <= header_size <= len(notices):
        raise DotMessageError(f"a list of {len(notices)} bytes has a header of {header_size}")
    files: list[int] = []
    for piece in notices[header_size:]:
        if piece == FILE_BEGINS:
            files.append(0)
        elif piece == FILE_GOES_ON and files:
            files[-1] += 1
    return tuple(files)

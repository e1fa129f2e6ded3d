"""x-io x-IMU3: messages end with a line feed; JSON, text or binary, distinguished by their first byte.

Source: x-IMU3 User Manual, x-io Technologies, chapters on commands and data messages. There is no checksum, so what no
sensor of this kind can measure counts as damaged.
"""

import json
import math
from pathlib import Path
from struct import Struct

from core.samples import G_M_S2
from devices.live import SensorDetails, SourceRefusedError
from devices.source import DecodedSensor, SourceInfo
from devices.stream import Framer, Received, ask, decoded
from devices.transport.channels import Channel

DRIVER, VERSION, MODEL = "ximu3", "1", "x-IMU3"
EMULATED = "emulated x-IMU3"  # what our own emulator calls itself
BASE_HZ = 400  # divided by the message rate divisor
RAD = math.pi / 180.0
MOST_DEG_S, MOST_G = 2400.0, 20.0  # ranges of 2000 deg/s and 16 g, and what calibration adds
MOST_MESSAGE = 4096  # bytes; the maker's own decoder holds as many
MOST_REPLIES = 64
PIECE = 1 << 20
END, ESC, ESC_END, ESC_ESC = b"\n", b"\xdb", b"\xdb\xdc", b"\xdb\xdd"
INERTIAL, QUATERNION, BATTERY = Struct("<BQ6f"), Struct("<BQ4f"), Struct("<BQ3f")
PING_S, PINGS = 0.5, 3
ASK_S = 0.3


class DamagedError(ValueError):
    """A message that was cut or changed on its way."""


def unstuffed(message: bytes) -> bytes:
    """Undo a message's escapes, without its end; raises DamagedError where something else is escaped."""
    if ESC not in message:
        return message
    if message.count(ESC) != message.count(ESC_END) + message.count(ESC_ESC):
        raise DamagedError
    return message.replace(ESC_END, END).replace(ESC_ESC, ESC)


def stuffed(message: bytes) -> bytes:
    """A message as it is sent, its end included."""
    return message.replace(ESC, ESC_ESC).replace(END, ESC_END) + END


def numbers_of(message: bytes, shape: Struct, count: int) -> tuple[float, ...]:
    """Give microseconds and `count` arguments of an unstuffed message; raises DamagedError where invalid."""
    if message[0] & 0x80:
        if len(message) != shape.size:
            raise DamagedError
        return shape.unpack(message)[1:]
    parts = message.split(b",")
    if len(parts) != count + 2:
        raise DamagedError
    try:
        us, *numbers = int(parts[1]), *map(float, parts[2:])
    except ValueError as problem:
        raise DamagedError from problem
    if not 0 <= us < 1 << 64:
        raise DamagedError
    return us, *numbers


class Ximu3Framer:
    """The `Framer` of a stream of messages."""

    def __init__(self) -> None:
        self.received = Received()
        self._rest = b""
        self._is_cut = True  # whoever joins a stream receives the end of a message first
        self._letters = {ord("I"): self._inertial, ord("Q"): self._quaternion, ord("B"): self._battery}

    def feed(self, data: bytes, host_s: float) -> None:
        messages = (self._rest + data).split(END)
        self._rest = messages.pop()
        for message in messages:
            try:
                self._take(message)
            except DamagedError:
                if not self._is_cut:
                    self.received.damaged += 1
            self._is_cut = False
        if len(self._rest) > MOST_MESSAGE:
            self.received.damaged += not self._is_cut
            self._rest, self._is_cut = b"", True

    def flush(self) -> None:
        """Nothing was held back: the rest is half a message."""

    def _take(self, message: bytes) -> None:
        if not message or len(message) > MOST_MESSAGE:
            raise DamagedError
        first = message[0]
        if first == ord("{"):
            self._reply(message)
            return
        letter = first & 0x7F
        if not ord("A") <= letter <= ord("Z"):
            if message[:1] == b"^":  # of a sensor behind this one
                self.received.skipped += 1
                return
            raise DamagedError
        if take := self._letters.get(letter):
            take(unstuffed(message))
        elif first & 0x80 or message[1:2] == b",":
            self.received.skipped += 1
        else:
            raise DamagedError

    def _inertial(self, message: bytes) -> None:
        us, gx, gy, gz, ax, ay, az = numbers_of(message, INERTIAL, 6)
        most, heavy = MOST_DEG_S, MOST_G
        if not (-most < gx < most and -most < gy < most and -most < gz < most):
            raise DamagedError
        if not (-heavy < ax < heavy and -heavy < ay < heavy and -heavy < az < heavy):
            raise DamagedError
        self.received.rows.append((us / 1e6, gx * RAD, gy * RAD, gz * RAD, ax * G_M_S2, ay * G_M_S2, az * G_M_S2))

    def _quaternion(self, message: bytes) -> None:
        us, w, x, y, z = numbers_of(message, QUATERNION, 4)
        if not 0.9 < w * w + x * x + y * y + z * z < 1.1:
            raise DamagedError
        self.received.orientations.append((us / 1e6, w, x, y, z))

    def _battery(self, message: bytes) -> None:
        percent = numbers_of(message, BATTERY, 3)[1]
        if not 0.0 <= percent <= 101.0:
            raise DamagedError
        self.received.battery = min(percent / 100.0, 1.0)

    def _reply(self, message: bytes) -> None:
        try:
            json.loads(message)
        except (ValueError, RecursionError) as problem:
            raise DamagedError from problem
        if len(self.received.replies) < MOST_REPLIES:
            self.received.replies.append(message.strip())


def read_file(path: Path) -> DecodedSensor:
    """Read a maker's log of one sensor (`.ximu3`), stamped by the sensor's clock."""
    received = received_in(path)
    return decoded(path.stem, received, [row[0] for row in received.rows])


def received_in(path: Path) -> Received:
    """Give all messages of such a file, in its order."""
    framer = Ximu3Framer()
    with path.open("rb") as file:
        while data := file.read(PIECE):
            framer.feed(data, 0.0)
    return framer.received


class Ximu3:
    """The `SensorProtocol` of an x-IMU3. It is left as its owner set it up, unless a rate is chosen.

    Parameters
    ----------
    rate_hz
        Of inertial messages, a divisor of 400 Hz; then what we do not need is switched off. 115200 baud carry 200 Hz.
    """

    driver, version = DRIVER, VERSION

    def __init__(self, rate_hz: float | None = None) -> None:
        self._required_hz = rate_hz

    def framer(self, info: SourceInfo) -> Framer:
        return Ximu3Framer()

    def identifying(self) -> bytes:
        return command("strobe")

    def greet(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        framer = Ximu3Framer()
        ping = self._ping(channel, framer)
        if self._required_hz is not None:
            self._set_up(channel, framer, self._required_hz)
        divisor = _asked(channel, framer, "inertial_message_rate_divisor")
        rate_hz = BASE_HZ / divisor if isinstance(divisor, int | float) and divisor >= 1 else None
        firmware = _asked(channel, framer, "firmware_version")
        name, serial = _text(ping, "name", "deviceName"), _text(ping, "sn", "serialNumber")
        sensor = serial or channel.serial or channel.place
        info = SourceInfo(
            DRIVER,
            VERSION,
            serial,
            (sensor,),
            {"rate_hz": rate_hz} if rate_hz else {},
            is_simulated=name == EMULATED,
        )
        details = SensorDetails(MODEL, serial, firmware if isinstance(firmware, str) else "", rate_hz)
        return info, details

    def _ping(self, channel: Channel, framer: Ximu3Framer) -> object:
        for _ in range(PINGS):
            if answer := ask(channel, framer, command("ping"), _answers("ping"), PING_S):
                return json.loads(answer)["ping"]
        if not framer.received.rows:
            raise SourceRefusedError(
                "No x-IMU3 responds at {place}", "Check that it is switched on, then search again", place=channel.place
            )
        return {}  # it cannot hear us: a line that goes one way only

    def _set_up(self, channel: Channel, framer: Ximu3Framer, rate_hz: float) -> None:
        divisor = round(BASE_HZ / rate_hz)
        required = {
            "inertial_message_rate_divisor": divisor,
            "ahrs_message_rate_divisor": 0,
            "binary_mode_enabled": True,
        }
        for key, value in required.items():
            ask(channel, framer, command(key, value), _answers(key), ASK_S)
        ask(channel, framer, command("apply"), _answers("apply"), ASK_S)


def command(key: str, value: object = None) -> bytes:
    """A command as it is sent, with its end."""
    return json.dumps({key: value}, separators=(",", ":")).encode() + END


def _answers(key: str) -> "_Answers":
    return _Answers(key)


class _Answers:
    """Whether a reply is the answer to a command of this name."""

    def __init__(self, key: str) -> None:
        self._key = key

    def __call__(self, reply: bytes) -> bool:
        details = json.loads(reply)
        return isinstance(details, dict) and self._key in details


def _asked(channel: Channel, framer: Ximu3Framer, key: str) -> object:
    framer.received.replies.clear()
    answer = ask(channel, framer, command(key), _answers(key), ASK_S)
    return json.loads(answer)[key] if answer else None


def _text(details: object, *keys: str) -> str:
    """The first of these entries that is a text."""
    entries = details if isinstance(details, dict) else {}
    return next((entries[key] for key in keys if isinstance(entries.get(key), str)), "")

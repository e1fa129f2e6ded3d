"""What carries a sensor's bytes, a port or a socket: opened, read and closed alike."""

import select
import socket
import threading
from collections import deque
from contextlib import suppress
from typing import ClassVar, Protocol

from devices.live import SourceLostError, SourceRefusedError

READ_S = 0.015  # several samples come together, and none waits for long
MOST_BYTES = 65536
CONNECT_S = 2.0

Address = tuple[str, int]


class Channel(Protocol):
    """Opened again after it was lost. `write` may be called from any thread, all else from one at a time."""

    @property
    def place(self) -> str:
        """Where it is, as a person would name it."""

    @property
    def serial(self) -> str:
        """The number of what is plugged in there, where it has one."""

    def open(self) -> None:
        """Begin to listen.

        Raises
        ------
        SourceRefusedError
            It is not there, another program has it, or it may not be used.
        """

    def read(self) -> bytes:
        """What has arrived, waiting for it some 15 ms; nothing where nothing came.

        Raises
        ------
        SourceLostError
            It is not there any more.
        """

    def write(self, data: bytes) -> None:
        """Send; raises as `read` does."""

    def close(self) -> None:
        """Never raises, and may be called of what is closed."""


class TcpChannel:
    """A connection to a sensor that listens on the network."""

    serial = ""

    def __init__(self, address: str, port: int) -> None:
        self._address = address, port
        self._socket: socket.socket | None = None

    @property
    def place(self) -> str:
        return f"TCP {self._address[0]}:{self._address[1]}"

    def open(self) -> None:
        try:
            self._socket = socket.create_connection(self._address, CONNECT_S)
        except OSError as problem:
            raise _unreachable(self.place) from problem
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        # a sensor that is switched off does not close its connection
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        self._socket.settimeout(READ_S)

    def read(self) -> bytes:
        try:
            data = _opened(self._socket).recv(MOST_BYTES)
        except TimeoutError:
            return b""
        except OSError as problem:
            raise SourceLostError(f"{self.place} was lost") from problem
        if not data:
            raise SourceLostError(f"{self.place} closed the connection")
        return data

    def write(self, data: bytes) -> None:
        try:
            _opened(self._socket).sendall(data)
        except OSError as problem:
            raise SourceLostError(f"{self.place} was lost") from problem

    def close(self) -> None:
        _close(self._socket)
        self._socket = None


class UdpChannel:
    """Datagrams of one sensor; others that come to the same port have channels of their own, or are left out.

    A datagram that is lost takes whole messages with it. Nothing shows when the sensor is gone: it is silent then.
    """

    serial = ""

    def __init__(self, address: str, send_port: int, receive_port: int) -> None:
        self._address, self._receive_port = (address, send_port), receive_port
        self._port: _UdpPort | None = None

    @property
    def place(self) -> str:
        return f"UDP {self._address[0]}:{self._receive_port}"

    def open(self) -> None:
        try:
            self._port = _UdpPort.shared(self._receive_port, self._address)
        except OSError as problem:
            raise SourceRefusedError(
                "Port {number} of this computer is in use by another program",
                "Close that program",
                number=self._receive_port,
            ) from problem

    def read(self) -> bytes:
        try:
            return self._opened().read(self._address)
        except OSError as problem:
            raise SourceLostError(f"{self.place} was lost") from problem

    def write(self, data: bytes) -> None:
        try:
            self._opened().send(data, self._address)
        except OSError as problem:
            raise SourceLostError(f"{self.place} was lost") from problem

    def close(self) -> None:
        port, self._port = self._port, None
        if port is not None:
            port.leave(self._address)

    def _opened(self) -> "_UdpPort":
        if self._port is None:
            raise SourceLostError("it is closed")
        return self._port


class _UdpPort:
    """A port of this computer and its senders, by address; of one address, by the sensor's own port."""

    # whoever reads takes what has come for all

    _known: ClassVar[dict[int, "_UdpPort"]] = {}
    _changing: ClassVar[threading.Lock] = threading.Lock()

    def __init__(self, number: int) -> None:
        self._number = number
        self._waiting: dict[Address, deque[bytes]] = {}
        self._reading = threading.Lock()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind(("", number))
        except OSError:
            self._socket.close()
            raise
        self._socket.settimeout(READ_S)

    @classmethod
    def shared(cls, number: int, sensor: Address) -> "_UdpPort":
        """Join the port, which is opened by the first."""
        with cls._changing:
            port = cls._known.get(number) or cls(number)
            cls._known[number] = port
            port._waiting[sensor] = deque()
            return port

    def leave(self, sensor: Address) -> None:
        """The last one closes it."""
        with self._changing:
            self._waiting.pop(sensor, None)
            if not self._waiting and self._known.get(self._number) is self:
                del self._known[self._number]
                _close(self._socket)

    def read(self, sensor: Address) -> bytes:
        mine = self._waiting[sensor]
        if not mine and self._reading.acquire(timeout=READ_S):
            try:
                if not mine:  # who read before may have got it
                    self._receive()
            finally:
                self._reading.release()
        return b"".join(mine.popleft() for _ in range(len(mine)))

    def send(self, data: bytes, sensor: Address) -> None:
        self._socket.sendto(data, sensor)

    def _receive(self) -> None:
        """Wait for a datagram, and hand on all that are there."""
        is_more = True
        while is_more:
            try:
                data, sender = self._socket.recvfrom(MOST_BYTES)
            except TimeoutError:
                return
            except ConnectionResetError:  # Windows: what was sent before found nobody
                return
            if (waiting := self._waiting.get(self._owner(sender))) is not None:
                waiting.append(data)
            is_more = bool(select.select([self._socket], [], [], 0.0)[0])

    def _owner(self, sender: Address) -> Address:
        """Whose datagram it is; the sender itself where that is nobody's."""
        near = [sensor for sensor in tuple(self._waiting) if sensor[0] == sender[0]]
        return near[0] if len(near) == 1 else sender


def _opened(one: socket.socket | None) -> socket.socket:
    if one is None:
        raise SourceLostError("it is closed")
    return one


def _close(one: socket.socket | None) -> None:
    if one is not None:
        with suppress(OSError):
            one.close()


def _unreachable(place: str) -> SourceRefusedError:
    return SourceRefusedError(
        "Nothing responds at {place}", "Check that the sensor is switched on and on the same network", place=place
    )

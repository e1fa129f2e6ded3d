"""What carries a sensor's bytes? A port or a socket: opened, read and closed alike."""

import socket
from contextlib import suppress
from typing import Protocol

from devices.live import SourceLostError, SourceRefusedError

READ_S = 0.015  # several samples come together, and none waits for long
MOST_BYTES = 65536
CONNECT_S = 2.0


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
        # a sensor that is switched off says no goodbye
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
    """Datagrams of one sensor; those of others that come to the same port are left out.

    A datagram that is lost takes whole messages with it. Nobody says when the sensor is gone: it is silent then.
    """

    serial = ""

    def __init__(self, address: str, send_port: int, receive_port: int) -> None:
        self._address, self._receive_port = (address, send_port), receive_port
        self._socket: socket.socket | None = None

    @property
    def place(self) -> str:
        return f"UDP {self._address[0]}:{self._receive_port}"

    def open(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind(("", self._receive_port))
        except OSError as problem:
            self.close()
            raise SourceRefusedError(
                f"Port {self._receive_port} of this computer is used by another program or sensor",
                "Close that program, or give each sensor a port of its own",
            ) from problem
        self._socket.settimeout(READ_S)

    def read(self) -> bytes:
        try:
            data, (address, _) = _opened(self._socket).recvfrom(MOST_BYTES)
        except TimeoutError:
            return b""
        except ConnectionResetError:  # Windows tells so that what was sent found nobody
            return b""
        except OSError as problem:
            raise SourceLostError(f"{self.place} was lost") from problem
        return data if address == self._address[0] else b""

    def write(self, data: bytes) -> None:
        try:
            _opened(self._socket).sendto(data, self._address)
        except OSError as problem:
            raise SourceLostError(f"{self.place} was lost") from problem

    def close(self) -> None:
        _close(self._socket)
        self._socket = None


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
        f"Nothing answers at {place}", "Check that the sensor is switched on and in the same network"
    )

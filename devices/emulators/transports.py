"""Far ends where an emulated sensor speaks: of a pseudo-terminal, a TCP connection, a UDP port."""

import contextlib
import os
import select
import socket
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

if sys.platform != "win32":
    import tty

POLL_S = 0.005
PIECE = 4096


class Voice(Protocol):
    """What an emulated sensor sends and receives."""

    def say(self) -> bytes:
        """All that is due by now."""

    def hear(self, data: bytes) -> bytes:
        """Take what was sent to it; give what it answers."""


class Transport(Protocol):
    """One way out. `place` is what a program opens."""

    place: str

    def exchange(self, data: bytes) -> bytes:
        """Send, and give what has come; waits a moment for it. What does not fit is lost, as on a wire."""

    def close(self) -> None: ...


class PseudoTerminal:
    """A pseudo-terminal under a name that stays when it vanishes and comes back."""

    def __init__(self, link: Path) -> None:
        if sys.platform == "win32":
            raise OSError("there are no pseudo-terminals here")
        self.place = str(link)
        self._link = link
        self._own, self._theirs = os.openpty()
        tty.setraw(self._theirs)
        os.set_blocking(self._own, False)
        link.unlink(missing_ok=True)
        link.symlink_to(os.ttyname(self._theirs))

    def exchange(self, data: bytes) -> bytes:
        with contextlib.suppress(BlockingIOError):
            while data:
                data = data[os.write(self._own, data) :]
        if not select.select([self._own], [], [], POLL_S)[0]:
            return b""
        with contextlib.suppress(OSError):
            return os.read(self._own, PIECE)
        return b""

    def close(self) -> None:
        self._link.unlink(missing_ok=True)
        for end in (self._own, self._theirs):
            with contextlib.suppress(OSError):
                os.close(end)


class TcpServer:
    """A sensor on the network that one program at a time connects to."""

    def __init__(self, address: str = "127.0.0.1", port: int = 0) -> None:
        self._listening = socket.create_server((address, port))
        self._listening.settimeout(POLL_S)
        self.address, self.port = self._listening.getsockname()[:2]
        self.place = f"TCP {self.address}:{self.port}"
        self._connection: socket.socket | None = None

    def exchange(self, data: bytes) -> bytes:
        if self._connection is None:
            with contextlib.suppress(TimeoutError):
                self._connection, _ = self._listening.accept()
                self._connection.settimeout(POLL_S)
            return b""
        try:
            self._connection.sendall(data)
            came = self._connection.recv(PIECE)
        except TimeoutError:
            return b""
        except OSError:
            came = b""
        if not came:
            self._connection.close()
            self._connection = None
        return came

    def close(self) -> None:
        if self._connection is not None:
            self._connection.close()
        self._listening.close()


class UdpSender:
    """A sensor that sends datagrams to a port of this machine, and receives at one of its own."""

    def __init__(self, to_port: int, address: str = "127.0.0.1") -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((address, 0))
        self._socket.settimeout(POLL_S)
        self._to = address, to_port
        self.address, self.port = self._socket.getsockname()[:2]
        self.to_port = to_port
        self.place = f"UDP {address}:{to_port}"

    def exchange(self, data: bytes) -> bytes:
        with contextlib.suppress(OSError):
            if data:
                self._socket.sendto(data, self._to)
        with contextlib.suppress(OSError):
            return self._socket.recvfrom(PIECE)[0]
        return b""

    def close(self) -> None:
        self._socket.close()


class Emulation:
    """A voice at the end of a transport, in a thread of its own. It may vanish and come back."""

    def __init__(self, voice: Voice, make: Callable[[], Transport]) -> None:
        self.voice, self._make = voice, make
        self.transport = make()
        self._lock = threading.Lock()
        self._is_away = False
        self._is_closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="emulated sensor", daemon=True)
        self._thread.start()

    @property
    def place(self) -> str:
        return self.transport.place

    def vanish(self) -> None:
        with self._lock:
            self._is_away = True
            self.transport.close()

    def come_back(self) -> None:
        with self._lock:
            self.transport = self._make()
            self._is_away = False

    def close(self) -> None:
        self._is_closing.set()
        self._thread.join()
        if not self._is_away:
            self.transport.close()

    def _run(self) -> None:
        answer = b""
        while not self._is_closing.is_set():
            with self._lock:
                stated = self.voice.say()  # also what nobody receives: its clock goes on
                came = b"" if self._is_away else self.transport.exchange(answer + stated)
            answer = self.voice.hear(came) if came else b""
            if self._is_away:
                self._is_closing.wait(POLL_S)

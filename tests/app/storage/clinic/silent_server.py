"""A way to a server that can fall nobody: connections stay, and nothing comes any more."""

import socket
import threading
from contextlib import suppress


class SilentServer:
    """Listens on this computer and passes bytes on to `target`, a socket's path, until `is_silent`."""

    def __init__(self, target: str) -> None:
        self.is_silent = threading.Event()
        self._target = target
        self._listening = socket.create_server(("127.0.0.1", 0))
        self._open = [self._listening]
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def port(self) -> int:
        return int(self._listening.getsockname()[1])

    def close(self) -> None:
        for one in self._open:
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
            one.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                here, _ = self._listening.accept()
                there = socket.socket(socket.AF_UNIX)
                self._open += [here, there]
                there.connect(self._target)
                for one, other in ((here, there), (there, here)):
                    threading.Thread(target=self._pass_on, args=(one, other), daemon=True).start()

    def _pass_on(self, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):
            while piece := one.recv(65536):
                if not self.is_silent.is_set():
                    other.sendall(piece)

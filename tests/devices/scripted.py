"""A channel that states what a test has written down and notes what it is reported; what a source gives in seconds."""

import socket
import time
from collections import deque
from collections.abc import Callable, Sequence

from core.samples import ImuBlock
from devices.live import SourceLostError
from devices.stream import ByteSource


class ScriptedChannel:
    """States `stated` piece by piece, then what `answers` gives to what was written; lost where a piece is None."""

    serial = ""
    place = "script"

    def __init__(
        self, stated: Sequence[bytes | None] = (), answers: Callable[[bytes], bytes] = lambda _data: b""
    ) -> None:
        self.stated, self._answers = deque(stated), answers
        self.written: list[bytes] = []
        self.is_open = False

    def open(self) -> None:
        self.is_open = True

    def read(self) -> bytes:
        piece = self.stated.popleft() if self.stated else b""
        if piece is None:
            raise SourceLostError("the script says so")
        return piece

    def write(self, data: bytes) -> None:
        self.written.append(data)
        if answer := self._answers(data):
            self.stated.append(answer)

    def close(self) -> None:
        self.is_open = False


class SilentVoice:
    """An emulated sensor that gives nothing, whatever it receives."""

    def say(self) -> bytes:
        return b""

    def hear(self, data: bytes) -> bytes:
        return b""


def received_for(source: ByteSource, seconds: float) -> tuple[list[ImuBlock], list[bytes]]:
    """The samples of so many seconds, and the bytes that were kept of them."""
    blocks: list[ImuBlock] = []
    kept: list[bytes] = []
    until_s = time.monotonic() + seconds
    while time.monotonic() < until_s:
        blocks += source.read(kept.append)
    return blocks, kept


def free_port() -> int:
    """One of UDP, on this computer."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])

"""Bluetooth LE notifications as a journal keeps them: each as it came, `u16 characteristic, u16 length, payload`."""

import struct
from collections.abc import Collection

HEAD = struct.Struct("<HH")
MOST_PAYLOAD = 512  # of an attribute, by the Bluetooth specification


def framed(characteristic: int, payload: bytes) -> bytes:
    """A notification as it is kept; of its characteristic the part of the identifier that differs."""
    return HEAD.pack(characteristic, len(payload)) + payload


class NotificationFrames:
    """Notifications in what was kept, in pieces of any size; of a kind of sensor that has `known` characteristics."""

    def __init__(self, known: Collection[int]) -> None:
        self.damaged = 0
        self._known = known
        self._held = b""
        self._is_lost = False

    def feed(self, data: bytes) -> list[tuple[int, bytes]]:
        """Characteristic and payload of those that are whole now."""
        found, held, at = [], self._held + data, 0
        while len(held) - at >= HEAD.size:
            characteristic, length = HEAD.unpack_from(held, at)
            if characteristic not in self._known or length > MOST_PAYLOAD:
                self.damaged += not self._is_lost
                self._is_lost = True
                at += 1
                continue
            end = at + HEAD.size + length
            if end > len(held):
                break
            found.append((characteristic, held[at + HEAD.size : end]))
            self._is_lost = False
            at = end
        self._held = held[at:]
        return found

    def newly_damaged(self) -> int:
        """How many were damaged since this was asked last."""
        found, self.damaged = self.damaged, 0
        return found

    def flush(self) -> None:
        """Nothing follows: what was held back was cut."""
        self.damaged += bool(self._held)
        self._held = b""

"""The memory of an emulated Movella DOT: what it records, lists, sends and erases, and how it answers to that."""

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from devices.emulators.dot_faults import DotFaults

Sample = tuple[int, tuple[float, ...], float]
"""Ticks without turns, values (10) in single precision, and when it was taken by the host's clock, ns."""

IDLE, RECORDING, EXPORTING = 0x06, 0x40, 0x70
SENT_AT_ONCE = 8  # notices of a file in one step
MEMORY = 16_000_000  # bytes
MOST_SAMPLES = MEMORY // 62
TURN_US = 1 << 32


@dataclass
class EmulatedFile:
    """A recording in its memory: ticks and values (10) of each sample, and when it was taken by the host's clock."""

    utc_s: int
    timer_s: int
    ticks: list[int]
    values: Sequence[Sequence[float]]
    taken_s: list[float]


class EmulatedMemory:
    """Files by number from 1, and what is done with them; it goes on whether or not a link is up.

    Parameters
    ----------
    grid
        The number of the last sample at an instant of the host's clock, ns.
    measured
        The sample of a number.

    Attributes
    ----------
    room
        So many samples it holds.
    unreadable, unheard
        Numbers of a file's samples that it never sends, and of some that are lost on their way, once each.
    exported
        How many samples of files it ever sent.
    cut_recordings
        So many recordings were ended by settings that were written meanwhile.
    """

    def __init__(
        self,
        grid: Callable[[int], int],
        measured: Callable[[int], Sample],
        now_ns: Callable[[], int],
        faults: DotFaults,
        chance: np.random.Generator,
    ) -> None:
        self._grid, self._measured, self._now_ns = grid, measured, now_ns
        self._faults, self._chance = faults, chance
        self.state = IDLE
        self.files: list[EmulatedFile] = []
        self.erased: list[EmulatedFile] = []
        self.room = MOST_SAMPLES
        self.unreadable: set[int] = set()
        self.not_received: list[int] = []
        self.exported = self.cut_recordings = 0
        self._notices: list[bytes] = []
        self._record_utc_s = self._record_from = self._timer_s = 0
        self._ends_ns: int | None = None
        self._reported_end_ns = 0
        self._export: list[bytes] = []
        self._exported: EmulatedFile | None = None

    def answered(self, data: bytes, *, is_streaming: bool) -> bytes:
        """What an order is answered with, once it is done."""
        order = data[0]
        self._look_for_room()
        self._look_for_end()
        if order == 0x02:
            return message(1, bytes([1, self.state, order]))
        if self._faults.busy:
            self._faults.busy -= 1
            return message(1, bytes([1, 0x03, order]))
        result = self._done(order, data[1:], is_streaming=is_streaming)
        return message(1, bytes([1, result, order]) + data[1:])

    def due(self) -> list[bytes]:
        """The notices that it sends now."""
        self._look_for_room()
        self._look_for_end()
        export, self._export = self._export[:SENT_AT_ONCE], self._export[SENT_AT_ONCE:]
        if self.state == EXPORTING and not self._export:
            self.state = IDLE
        self.exported += len(export)
        notices, self._notices = self._notices, []
        return [*notices, *(one for one in export if self._chance.random() >= self._faults.silent)]

    def break_off(self) -> None:
        """The link is gone: what it was to send is not sent."""
        self._notices.clear()
        self._export.clear()
        if self.state == EXPORTING:
            self.state = IDLE

    def cut_recording(self) -> None:
        """A setting that is written while it records ends the file."""
        if self.state == RECORDING:
            self.cut_recordings += 1
            self.end_recording()

    def _done(self, order: int, data: bytes, *, is_streaming: bool) -> int:
        if self.state == RECORDING and order != 0x41:
            return 0x03
        match order:
            case 0x40:
                if is_streaming:
                    return 0x03
                if self._used() >= self.room:
                    self._notices.append(message(1, b"\x34"))
                    return 0x00 if self._faults.full_by_notice else 0x34
                self._record_utc_s, self._timer_s = struct.unpack("<IH", data)
                self._record_from, self.state = self._grid(self._now_ns()) + 1, RECORDING
            case 0x41 if self._ends_ns is None and self.state == RECORDING:
                self._reported_end_ns = self._now_ns()
                self._ends_ns = self._reported_end_ns + round(self._faults.ends_after_s * 1e9)
                self._look_for_end()
            case 0x41:
                pass
            case 0x50:
                whole = self._flash()
                self._notices += [message(1, b"\x51" + whole[at : at + 128]) for at in range(0, len(whole), 128)]
                self._notices.append(message(1, b"\x52"))
            case 0x60:
                self._notices += self._reported_of(data[0])
            case 0x74:
                return 0 if data == bytes([0, 1, 7, 8, 10]) else 0x03
            case 0x70:
                if not 0 < data[0] <= len(self.files):
                    return 0x03
                self._exported = self.files[data[0] - 1]
                self._send_from(0)
            case 0x75:
                if self._exported is None or not (self._faults.again or self.state == EXPORTING):
                    return 0x02
                self._send_from(*struct.unpack("<I", data))
            case 0x73:
                self._export.clear()
                self.state = IDLE
                self._notices.append(message(1, b"\x73"))
            case 0x30:
                self.erased += self.files
                self.files, self._exported = [], None
                self._notices.append(message(1, b"\x33"))
            case _:
                return 0x03
        return 0

    def _reported_of(self, number: int) -> list[bytes]:
        if not 0 < number <= len(self.files):
            return [message(1, b"\x63")]
        file = self.files[number - 1]
        reported = struct.pack("<4sIHIH112x", bytes.fromhex("6F636552"), 128, 0x0100, file.utc_s, file.timer_s)
        return [message(1, b"\x61" + reported), message(1, b"\x62")]

    def _flash(self) -> bytes:
        """Its header, whose bytes may look like the beginnings of files, and a byte for each piece of its memory."""
        pieces = b"".join(b"\xee" + b"\xcc" * -(-len(file.ticks) * 62 // 228_000) for file in self.files)
        used = len(pieces)
        return struct.pack("<4sIHIII106x", bytes.fromhex("73616C46"), 128, 0x0200, 0x5EEEEE00, MEMORY, used) + pieces

    def _send_from(self, first: int) -> None:
        assert self._exported is not None
        file = self._exported
        self._export = []
        for number in range(first, len(file.ticks)):
            if number in self.not_received:
                self.not_received.remove(number)
                continue
            if number in self.unreadable or self._chance.random() < self._faults.damaged:
                self._export.append(message(1, b"\x76" + struct.pack("<I", number) + bytes(46)))
                continue
            sample = struct.pack("<I10fH", file.ticks[number] % TURN_US, *file.values[number], 0)
            self._export.append(message(1, b"\x71" + struct.pack("<I", number) + sample))
        self._export.append(message(1, b"\x72"))
        self.state = EXPORTING

    def _look_for_room(self) -> None:
        if self.state == RECORDING and self._recorded() > self.room:
            self.end_recording()
            self._notices.append(message(1, b"\x34"))

    def _used(self) -> int:
        return sum(len(file.ticks) for file in self.files)

    def _recorded(self) -> int:
        return self._used() + self._grid(self._now_ns()) - self._record_from + 1

    def _look_for_end(self) -> None:
        if self._ends_ns is not None and self._now_ns() >= self._ends_ns:
            self.end_recording()
            self._notices.append(message(1, b"\x41"))

    def end_recording(self) -> None:
        """What was recorded is a file, up to now or to when it was asked to end."""
        if self.state != RECORDING:
            return
        end_ns = self._now_ns() if self._ends_ns is None else self._reported_end_ns
        last = min(self._grid(end_ns), self._record_from + self.room - self._used())
        samples = [self._measured(number) for number in range(self._record_from, last + 1)]
        ticks, values, taken_s = (
            [one[0] for one in samples],
            [one[1] for one in samples],
            [one[2] / 1e9 for one in samples],
        )
        self.files.append(EmulatedFile(self._record_utc_s, self._timer_s, ticks, values, taken_s))
        self.state, self._ends_ns = IDLE, None


def message(group: int, data: bytes) -> bytes:
    """A message of a group, as it is printed: `group length data sum`."""
    body = bytes([group, len(data)]) + data
    return body + bytes([-sum(body) % 256])

"""A Movella DOT that is not there: what it answers, streams, and how its clock finds those of others.

What it records is in `dot_memory.py`, what may go wrong with it in `dot_faults.py`. Its messages are laid out there and
here once more, from the printed specification and not from the driver, which is held to them.
"""

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from bleak.assigned_numbers import CharacteristicPropertyName

from devices.emulators.bluetooth import EmulatedCharacteristic, Notification
from devices.emulators.dot_faults import DotFaults
from devices.emulators.dot_memory import TURN_US, EmulatedMemory, Sample, message

Motion = Callable[[float], Sequence[float]]
"""Orientation (4), force in m/s2 (3) and rate in deg/s (3) at an instant of the host's clock, ns."""

BASE = "1517{:04x}-4947-11e9-8646-d663bd873d93"
PROPERTIES: dict[int, tuple[CharacteristicPropertyName, ...]] = {
    0x1001: ("read",),
    0x1002: ("read", "write"),
    0x1004: ("notify",),
    0x2001: ("read", "write"),
    0x2002: ("notify",),
    0x2003: ("notify",),
    0x2004: ("notify",),
    0x2006: ("read", "write"),
    0x3001: ("read", "notify"),
    0x7001: ("write",),
    0x7002: ("read",),
    0x7003: ("notify",),
}
CHARACTERISTICS = [
    EmulatedCharacteristic(number, BASE.format(number), BASE.format(number & 0xFF00), properties)
    for number, properties in PROPERTIES.items()
]
MODE_SIZES = {26: (0x2002, 63), 21: (0x2003, 40)}
STEPS_US = {60: 16667, 30: 33333, 120: 8333}
SYNC_TAKES_NS = 12_000_000_000
TOGETHER_NS = 1_500_000_000


@dataclass(frozen=True, slots=True)
class DotClock:
    """Microseconds since power-on, by a quartz that is off by its skew."""

    power_on_ns: float
    skew: float
    drift_us: float = 0.0

    def us(self, at_ns: float) -> float:
        return (at_ns - self.power_on_ns) * (1.0 + self.skew) / 1e3 + self.drift_us

    def when_ns(self, clock_us: float) -> float:
        return self.power_on_ns + (clock_us - self.drift_us) * 1e3 / (1.0 + self.skew)


class EmulatedDot:
    """An `EmulatedPeripheral` whose clocks run by `now_ns`; it measures whether or not a link is up.

    `sent`: of every sample that it took while it streamed, lost or not: ticks without turns, values (10) in single
    precision, and when it was taken by the host's clock, ns.
    """

    def __init__(
        self,
        number: int,
        motion: Motion,
        now_ns: Callable[[], int],
        faults: DotFaults | None = None,
        *,
        skew: float = 0.0,
        states_so: bool = True,
    ) -> None:
        self.mac = bytes([0xD4, 0x22, 0xCD, 0x00, 0x00, number + 1])
        self.local_name = "Movella DOT"
        self.companies: tuple[int, ...] = (0x0886,)
        self.characteristics: Sequence[EmulatedCharacteristic] = CHARACTERISTICS
        self.faults = faults or DotFaults()
        self.chance = np.random.default_rng(number)
        self._motion, self._now_ns = motion, now_ns
        self._code = b"EMUDOT" if states_so else b"XS-T02"
        self._own = DotClock(now_ns() - int(self.chance.integers(10**9, 4 * 10**12)), skew)
        self._common: DotClock | None = None  # the root's as it was when they were synchronised
        self.settings = bytearray(struct.pack("<24xHB5x", 30, 0))
        self.is_streaming, self.mode = False, 26
        self._next = 0
        self.sent: list[Sample] = []
        self.is_up = False
        self.subscribed: set[int] = set()
        self.blinked = 0
        self.battery = 85
        self._answer = self._answer_before = b""
        self._notices: list[bytes] = []
        self._sync_root: bytes | None = None
        self.began_ns = 0
        """When it was asked to synchronise."""
        self._peers: Sequence[EmulatedDot] = ()
        self._must_read_first = False
        self.memory = EmulatedMemory(self._grid, self._measured, now_ns, self.faults, self.chance)
        self._sent_of_file = 0  # samples since it was connected

    @staticmethod
    def meet(dots: "Sequence[EmulatedDot]") -> None:
        """Let these sensors be synchronised with one another."""
        for dot in dots:
            dot._peers = dots

    def restart(self) -> None:
        """It was switched off and on: it does nothing, and its clock begins again. What it recorded is there."""
        self.memory.end_recording()
        self.is_streaming, self._common, self._sync_root = False, None, None
        self._own = replace(self._own, power_on_ns=self._now_ns())

    def stay_away(self, seconds: float) -> None:
        """It is out of reach from now on."""
        self.faults.unreachable_until_ns = self._now_ns() + round(seconds * 1e9)

    # its clock

    def begin_clock_at(self, ticks: int) -> None:
        """Let its clock show this now."""
        self._own = replace(self._own, power_on_ns=self._now_ns() - ticks * 1000)

    def _clock_us(self, at_ns: float) -> float:
        return (self._common or self._own).us(at_ns)

    def _taken_ns(self, clock_us: float) -> float:
        clock = self._common or self._own
        return clock.when_ns(clock_us)

    @property
    def rate_hz(self) -> int:
        return int(struct.unpack_from("<H", self.settings, 24)[0])

    # what comes through the air

    def may_connect(self) -> bool:
        is_synchronising = self._sync_root is not None and self._now_ns() - self.began_ns < SYNC_TAKES_NS
        return not is_synchronising and self._now_ns() >= self.faults.unreachable_until_ns

    def drops_at(self, operations: int) -> bool:
        drops = self.faults.drops_after
        is_due = bool(drops) and operations >= drops[0]
        if is_due:
            drops.pop(0)
        return is_due

    def drops_after(self, notification: Notification) -> bool:
        self._sent_of_file += notification[0] == 0x7003 and notification[1][2] == 0x71
        drops = self.faults.drops_export_after
        is_due = bool(drops) and self._sent_of_file >= drops[0]
        if is_due:
            drops.pop(0)
            self.stay_away(self.faults.unreachable_after_drop_s)
        return is_due

    def connected(self) -> None:
        self._sent_of_file = 0
        self._end_synchronising()
        if self.is_streaming:
            self._streamed()  # what was sent meanwhile nobody received
        self.is_up = True

    def disconnected(self) -> None:
        self.is_up = False
        self.subscribed.clear()
        self._notices.clear()
        self.memory.break_off()

    def read(self, characteristic: int) -> bytes:
        if characteristic != 0x7002 and self._must_read_first:
            self._common = None  # anything else first breaks it
        self._must_read_first = False
        match characteristic:
            case 0x1001:
                info = self.mac[::-1] + bytes([2, 4, 0]) + bytes(7) + struct.pack("<I", 1)
                return info + struct.pack("<Q", 0x4244030023B00100 + self.mac[5]) + self._code
            case 0x1002:
                return bytes(self.settings)
            case 0x2001:
                return bytes([1, self.is_streaming, self.mode])
            case 0x2006:
                return b"\x08\x00"
            case 0x3001:
                return bytes([self.battery, 0])
            case 0x7002:
                answer = self._answer
                if self.faults.stale_answers and self._answer_before:
                    self.faults.stale_answers -= 1
                    answer = self._answer_before
                return answer + bytes(160 - len(answer))
        raise KeyError(characteristic)

    def write(self, characteristic: int, data: bytes) -> None:
        if self._must_read_first:
            self._common, self._must_read_first = None, False
        if characteristic == 0x1002:
            self._set(data)
        elif characteristic == 0x2001:
            self._switch(data)
        elif characteristic == 0x7001:
            if sum(data) % 256 or len(data) != data[1] + 3:
                return
            if data[0] == 2:
                self._synchronise(data[2:-1])
            else:
                self._show_answer(self.memory.answered(data[2:-1], is_streaming=self.is_streaming))

    def notifications(self) -> list[Notification]:
        """What is due now."""
        stated = self._streamed() if self.is_streaming else []
        stated += [(0x7003, notice + bytes(160 - len(notice))) for notice in [*self._notices, *self.memory.due()]]
        self._notices.clear()
        return [one for one in stated if one[0] in self.subscribed] if self.is_up else []

    def _set(self, data: bytes) -> None:
        if data[0] & 0x01:
            self.blinked += 1
        if data[0] & 0x30:
            self.memory.cut_recording()
        if self._common is not None or self.is_streaming:
            return  # neither can be changed after that was started
        if data[0] & 0x10:
            self.settings[24:26] = data[24:26]
        if data[0] & 0x20:
            self.settings[26] = data[26]

    def _switch(self, data: bytes) -> None:
        self.memory.cut_recording()
        if data[2] not in MODE_SIZES or (data[2] == 26 and not self.faults.has_26) or self.rate_hz == 120:
            return
        self.is_streaming, self.mode = bool(data[1]), data[2]
        self._next = self._grid(self._now_ns()) + 1

    # streaming

    @property
    def step_us(self) -> int:
        return STEPS_US.get(self.rate_hz, round(1e6 / self.rate_hz))

    def _grid(self, at_ns: int) -> int:
        return int(self._clock_us(at_ns) // self.step_us)

    def _measured(self, number: int) -> Sample:
        ticks = number * self.step_us
        taken_ns = self._taken_ns(ticks)
        return ticks, tuple(np.array(self._motion(taken_ns), dtype=np.float32).tolist()), taken_ns

    def _streamed(self) -> list[Notification]:
        stated: list[Notification] = []
        characteristic, size = MODE_SIZES[self.mode]
        last = self._grid(self._now_ns())
        for number in range(self._next, last + 1):
            one = self._measured(number)
            self.sent.append(one)
            values = one[1] if self.mode == 26 else one[1][4:]
            payload = struct.pack(f"<I{len(values)}f", one[0] % TURN_US, *values)
            payload += bytes(size - len(payload))
            if self.chance.random() < self.faults.cut:
                payload = payload[:20]
            if self.chance.random() < self.faults.loss:
                continue
            stated += [(characteristic, payload)] * (1 + (self.chance.random() < self.faults.doubles))
        self._next = max(self._next, last + 1)
        return stated

    # synchronising

    def _synchronise(self, data: bytes) -> None:
        match data[0]:
            case 0x08:
                self._notices.append(message(2, b"\x51\x04" if self._common else b"\x51\x09"))
            case 0x02:
                self._common, self._sync_root = None, None
                self._notices.append(message(2, b"\x50\x00"))
            case 0x01:
                self._sync_root, self.began_ns = data[1:7][::-1], self._now_ns()

    def _end_synchronising(self) -> None:
        if self._sync_root is None:
            return
        root = next((one for one in self._peers if one.mac == self._sync_root), None)
        was_together = root is not None and abs(self.began_ns - root.began_ns) < TOGETHER_NS
        result = self.faults.sync_results.pop(0) if self.faults.sync_results else 0
        if not was_together:
            result = 0x09
        self._show_answer(message(2, bytes([3, result, 1, *self._sync_root] if self.faults.echoes else [3, result])))
        self._sync_root = None
        if result == 0 and root is not None:
            drift_us = float(self.chance.uniform(-100, 100)) + self.faults.stale_s * 1e6
            self._common = replace(root._own, drift_us=drift_us)
            self._must_read_first = True

    def _show_answer(self, answer: bytes) -> None:
        self._answer_before, self._answer = self._answer, answer

    @property
    def is_synchronised(self) -> bool:
        return self._common is not None

    def taken_ns(self, ticks: int) -> float:
        """When the sample of these ticks was taken, by the host's clock."""
        return self._taken_ns(ticks)

"""Detect whether this process stood still.

Stopped, starved or asleep with the machine, it receives no sensor meanwhile.

A thread that does nothing but sleep for a moment, again and again, sleeps longer only where nobody let it run. So a
late beat reports a standstill of the process from a disk or a port that is late: those hold up their own threads only.
"""

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from devices.clocks.host_clock import host_time_ns

BEAT_S = 0.1
STOOD_S = 0.5  # a beat so late counts as no time at all: shorter than what makes a disk late
REPORTED_S = 1.0  # so long a standstill is reported: it may cost samples


@dataclass(frozen=True, slots=True)
class ProcessStall:
    """One standstill.

    `began_s`, `ended_s`: on the acquisition's clock.
    `lasted_s`, `asleep_s`: on the machine's; how much of it the machine slept, as far as its clocks distinguish the
    two.
    """

    began_s: float
    ended_s: float
    lasted_s: float
    asleep_s: float
    lost_before: Mapping[str, int] = field(default_factory=dict)  # how many samples each sensor lacked when it began

    @property
    def was_asleep(self) -> bool:
        return self.asleep_s > self.lasted_s / 2


class _Clocks(NamedTuple):
    now_s: float
    clock_s: float
    running_s: float


def host_time_s() -> float:
    return host_time_ns() / 1e9


class Heartbeat:
    """Beats from `start` to `close`.

    Parameters
    ----------
    now_s
        The acquisition's clock; simulated patients may live faster than we do.
    lost
        How many samples each sensor lacks now.
    clock_s, running_s
        The machine's clocks: one goes on while it sleeps, the other stops then, where there is one that does.
    """

    def __init__(
        self,
        now_s: Callable[[], float],
        lost: Callable[[], Mapping[str, int]],
        clock_s: Callable[[], float] = host_time_s,
        running_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self._now_s, self._lost, self._clock_s, self._running_s = now_s, lost, clock_s, running_s
        self._last = self._look()
        self._awake_s = 0.0
        self._lost_before: Mapping[str, int] = {}
        self.standstills: tuple[ProcessStall, ...] = ()
        self._is_closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="heartbeat", daemon=True)

    def start(self) -> None:
        self._last = self._look()
        self._thread.start()

    def close(self) -> None:
        self._is_closing.set()
        if self._thread.is_alive():
            self._thread.join()

    def awake_s(self) -> float:
        """For how long the process has run: a standstill adds half a second at most. From any thread."""
        last, awake_s = self._last, self._awake_s
        return awake_s + min(max(self._clock_s() - last.clock_s, 0.0), STOOD_S)

    def beat(self) -> None:
        """Look at the clocks; called by the thread only, ten times a second."""
        last, now = self._last, self._look()
        step_s = now.clock_s - last.clock_s
        if step_s > REPORTED_S:
            asleep_s = max(step_s - (now.running_s - last.running_s), 0.0)
            self.standstills += (ProcessStall(last.now_s, now.now_s, step_s, asleep_s, self._lost_before),)
        else:
            self._lost_before = self._lost()
        self._awake_s += min(max(step_s, 0.0), STOOD_S)
        self._last = now

    def _look(self) -> "_Clocks":
        return _Clocks(self._now_s(), self._clock_s(), self._running_s())

    def _run(self) -> None:
        while not self._is_closing.wait(BEAT_S):
            self.beat()

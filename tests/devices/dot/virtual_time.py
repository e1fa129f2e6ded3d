"""A radio whose seconds pass at once: waits cost nothing, and what would wait for ever is an error."""

import asyncio
import selectors
import threading
from collections.abc import Coroutine, Sequence
from typing import Any, TypeVar

from devices.emulators.bluetooth import Air
from devices.emulators.dot import EmulatedDot, Motion
from devices.emulators.dot_faults import DotFaults
from devices.transport.bluetooth import Radio, Tick

Result = TypeVar("Result")
BEGIN_S = 5000.0


class DeadEndError(AssertionError):
    """Somebody waits for what will never come."""


class JumpingSelector(selectors.SelectSelector):
    """Instead of waiting it sets the clock on."""

    now_s = BEGIN_S

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        if timeout is None:
            raise DeadEndError
        self.now_s += max(timeout, 0.0)
        return super().select(0)


class VirtualLoop(asyncio.SelectorEventLoop):
    def __init__(self) -> None:
        self.jumping = JumpingSelector()
        super().__init__(self.jumping)

    def time(self) -> float:
        return self.jumping.now_s


class VirtualRadio(Radio):
    """Everything happens in the thread that asks for it."""

    def __init__(self) -> None:
        super().__init__()
        self.loop = VirtualLoop()

    def reach(self, air: Air) -> None:
        self.backend = air.backend

    def now_ns(self) -> int:
        return round(self.loop.time() * 1e9)

    def run(self, work: Coroutine[Any, Any, Result], tick: Tick | None = None) -> Result:
        return self.loop.run_until_complete(work)

    def wait(self, event: threading.Event, seconds: float) -> None:
        self.pass_s(0.0 if event.is_set() else seconds)

    def pass_s(self, seconds: float) -> None:
        """Let so many seconds go by."""
        self.run(asyncio.sleep(seconds))

    def close(self) -> None:
        tasks = asyncio.all_tasks(self.loop)
        for task in tasks:
            task.cancel()
        if tasks:
            self.run(_ended(tasks))
        self.loop.close()


async def _ended(tasks: set[asyncio.Task[Any]]) -> None:
    await asyncio.gather(*tasks, return_exceptions=True)


def turning(at_ns: float) -> Sequence[float]:
    """Something that reports instants apart: a force of a leg, rates that grow."""
    second = at_ns / 1e9
    return (1.0, 0.0, 0.0, 0.0, 0.25, second % 7, 9.75, second % 300, -second % 200, 3.5)


def worn(
    radio: VirtualRadio, faults: Sequence[DotFaults], motion: Motion = turning, latency_s: Sequence[float] = ()
) -> tuple[Air, list[EmulatedDot]]:
    """So many sensors in reach, their clocks askew."""
    dots = [
        EmulatedDot(number, motion, radio.now_ns, fault, skew=(-1) ** number * 20e-6 * number)
        for number, fault in enumerate(faults)
    ]
    EmulatedDot.meet(dots)
    air = Air(dots, latency_s or [0.004 + 0.003 * number for number in range(len(dots))])
    radio.reach(air)
    return air, dots

"""A radio whose seconds pass faster than ours, in a thread of its own, for what is waited for beside the screen."""

import asyncio
import selectors
import threading
import time
from collections.abc import Sequence

from devices.bluetooth import Radio
from devices.emulators.bluetooth import Air
from devices.emulators.dot import DotFaults, EmulatedDot, Motion
from tests.devices.dot.virtual_time import turning

SPEED = 50.0
BEGIN_NS = time.monotonic_ns()


def fast_ns() -> int:
    return BEGIN_NS + round((time.monotonic_ns() - BEGIN_NS) * SPEED)


class HurryingSelector(selectors.DefaultSelector):
    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        return super().select(None if timeout is None else timeout / SPEED)


class HurryingLoop(asyncio.SelectorEventLoop):
    def __init__(self) -> None:
        super().__init__(HurryingSelector())

    def time(self) -> float:
        return fast_ns() / 1e9


class FastRadio(Radio):
    """Reaches emulated DOTs with these faults; `dots` and `air` are where they live."""

    def __init__(self, faults: Sequence[DotFaults], motion: Motion = turning) -> None:
        self.dots = [
            EmulatedDot(number, motion, fast_ns, fault, skew=(-1) ** number * 20e-6 * number, says_so=True)
            for number, fault in enumerate(faults)
        ]
        EmulatedDot.meet(self.dots)
        self.air = Air(self.dots, [0.004 + 0.003 * number for number in range(len(faults))])
        super().__init__(self.air.backend, self.air.announced)

    def now_ns(self) -> int:
        return fast_ns()

    def wait(self, event: threading.Event, seconds: float) -> None:
        event.wait(seconds / SPEED)

    def _running(self) -> asyncio.AbstractEventLoop:
        with self._starting:
            if self._loop is None:
                self._loop = HurryingLoop()
                threading.Thread(target=self._loop.run_forever, name="fast bluetooth", daemon=True).start()
            return self._loop

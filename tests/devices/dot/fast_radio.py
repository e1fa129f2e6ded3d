"""A radio whose seconds pass faster than ours, in a thread of its own, for what is waited for beside the screen.

Its seconds pass while nothing is to be done, and no sensor answers late because the machine is busy.
"""

import asyncio
import selectors
import threading
import time
from collections.abc import Sequence

from devices.emulators.bluetooth import Air
from devices.emulators.dot import EmulatedDot, Motion
from devices.emulators.dot_faults import DotFaults
from devices.transport.bluetooth import Radio
from tests.devices.dot.virtual_time import turning

SPEED = 50.0
IDLE_S = 0.01  # of ours, after which the radio's clock is read again


class HurryingSelector(selectors.DefaultSelector):
    """The clock goes on by what is waited here, and by no more than was asked for."""

    def __init__(self) -> None:
        super().__init__()
        self.now_ns = time.monotonic_ns()

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        left_s = IDLE_S * SPEED if timeout is None else min(timeout, IDLE_S * SPEED)
        begin_ns = time.monotonic_ns()
        ready = super().select(max(left_s, 0.0) / SPEED)
        self.now_ns += round(min((time.monotonic_ns() - begin_ns) * SPEED, max(left_s, 0.0) * 1e9))
        return ready


class HurryingLoop(asyncio.SelectorEventLoop):
    def __init__(self) -> None:
        self.hurrying = HurryingSelector()
        super().__init__(self.hurrying)

    def time(self) -> float:
        return self.hurrying.now_ns / 1e9


class FastRadio(Radio):
    """Reaches emulated DOTs with these faults; `dots` and `air` are where they live."""

    def __init__(self, faults: Sequence[DotFaults], motion: Motion = turning) -> None:
        self._hurrying = HurryingLoop()
        self._thread = threading.Thread(target=self._hurrying.run_forever, name="fast bluetooth", daemon=True)
        self.dots = [
            EmulatedDot(number, motion, self.now_ns, fault, skew=(-1) ** number * 20e-6 * number, states_so=True)
            for number, fault in enumerate(faults)
        ]
        EmulatedDot.meet(self.dots)
        self.air = Air(self.dots, [0.004 + 0.003 * number for number in range(len(faults))])
        super().__init__(self.air.backend, self.air.announced)

    def now_ns(self) -> int:
        return self._hurrying.hurrying.now_ns

    def wait(self, event: threading.Event, seconds: float) -> None:
        until_ns = self.now_ns() + round(seconds * 1e9)
        while self.now_ns() < until_ns and not event.wait(IDLE_S / 10):
            pass

    def _running(self) -> asyncio.AbstractEventLoop:
        with self._starting:
            if self._loop is None:
                self._loop = self._hurrying
                self._thread.start()
            return self._loop

    def close(self) -> None:
        """End what still goes on in the thread, then the thread."""
        if self._thread.is_alive():
            asyncio.run_coroutine_threadsafe(_ended(), self._hurrying).result()
            self._hurrying.call_soon_threadsafe(self._hurrying.stop)
            self._thread.join()
        self._hurrying.close()


async def _ended() -> None:
    """Cancel all other tasks of this loop, and wait until they are."""
    others = asyncio.all_tasks() - {asyncio.current_task()}
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)

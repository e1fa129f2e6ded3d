"""What the machine adds to a latency by itself."""

import threading
import time

BEAT_S = 0.01


class Beat(threading.Thread):
    """Sleeps for BEAT_S again and again: how late it wakes is what the machine adds by itself, busy as it is."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.late_s: list[float] = []
        self._is_over = threading.Event()

    def run(self) -> None:
        while not self._is_over.is_set():
            begin_s = time.perf_counter()
            time.sleep(BEAT_S)
            self.late_s.append(time.perf_counter() - begin_s - BEAT_S)

    def end(self) -> None:
        self._is_over.set()
        self.join()

"""What tests wait for."""

import time
from collections.abc import Callable

PATIENCE_S = 60.0  # on a busy machine


def wait_for(is_so: Callable[[], bool], patience_s: float = PATIENCE_S, every_s: float = 0.002) -> None:
    """Give other threads and processes time, for as long as a busy machine may need."""
    give_up_s = time.monotonic() + patience_s
    while not is_so():
        assert time.monotonic() < give_up_s, "waited in vain"
        time.sleep(every_s)

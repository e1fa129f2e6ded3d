"""What tests wait for, and how long: as long as a busy machine may need."""

import time
from collections.abc import Callable
from functools import wraps
from typing import Any

from pytestqt.qtbot import QtBot

PATIENCE_S = 120.0  # on a busy machine
PATIENCE_MS = int(1000 * PATIENCE_S)
QTBOTS = ("waitUntil", "waitSignal", "waitSignals", "waitExposed", "waitActive", "waitCallback")


def wait_patiently() -> None:
    """Let no wait of pytest-qt end early: it ends as soon as what is waited for is there."""
    for name in QTBOTS:
        setattr(QtBot, name, _patient(getattr(QtBot, name)))


def _patient(wait: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(wait)
    def waits(*arguments: Any, timeout: int = 0, **others: Any) -> Any:
        is_refuted = others.get("raising") is False  # by `assertNotEmitted`: that nothing comes, which takes its time
        return wait(*arguments, timeout=timeout if is_refuted else max(timeout, PATIENCE_MS), **others)

    return waits


def wait_for(is_so: Callable[[], bool], patience_s: float = PATIENCE_S, every_s: float = 0.002) -> None:
    """Give other threads and processes time, for as long as a busy machine may need."""
    give_up_s = time.monotonic() + patience_s
    while not is_so():
        assert time.monotonic() < give_up_s, "waited in vain"
        time.sleep(every_s)

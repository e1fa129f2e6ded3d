"""Thread that works on new samples, about thirty times a second, as far as it keeps up."""

import logging
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from app.acquisition.reader import Reader
from core.samples import ImuBlock

EVERY_S = 0.03
LEAST_PAUSE_S = 0.005  # for the readers, where the estimator takes all there is
MOST_BEHIND_S = 5.0
CLOSE_S = 5.0  # an update takes no longer

_log = logging.getLogger(__name__)


class LiveEstimator(Protocol):
    """What is done with new samples. Results are attributes that are replaced whole: the screen reads them any time."""

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        """Take the samples each sensor sent since the last call, on the acquisition's clock; one thread only."""


@dataclass(slots=True)
class _Task:
    estimator: LiveEstimator
    taken: dict[str, int] = field(default_factory=dict)  # how many of a sensor's samples it has had
    has_failed: bool = False


class Preview:
    """The thread that runs the live estimator. It may fail or fall behind: the recording goes on.

    `trouble`: what the present estimator failed with first.
    `dropped`: how many samples the estimator was too slow for, and never saw.
    """

    def __init__(self, readers: Sequence[Reader]) -> None:
        self._readers = readers
        self._task: _Task | None = None
        self.trouble: Exception | None = None
        self.dropped = 0
        self._is_closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="preview", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def set_estimator(self, estimator: LiveEstimator | None) -> None:
        """From now on run this; an update of the former estimator may still be going on."""
        self.trouble = None
        taken = {name: total for reader in self._readers for name, total in reader.totals().items()}
        self._task = None if estimator is None else _Task(estimator, taken)

    def close(self) -> None:
        self._is_closing.set()
        if self._thread.is_alive():
            self._thread.join(CLOSE_S)

    def _run(self) -> None:
        pause_s = EVERY_S
        while not self._is_closing.wait(pause_s):
            begin_s = time.monotonic()
            task = self._task
            if task:
                self._update(task)
            pause_s = max(EVERY_S - (time.monotonic() - begin_s), LEAST_PAUSE_S)

    def _update(self, task: _Task) -> None:
        blocks = {name: block for reader in self._readers for name, block in self._new(reader, task) if len(block)}
        if not blocks:
            return
        try:
            task.estimator.update(blocks)
        except Exception as error:  # the thread's edge: it is only a preview
            if not task.has_failed:
                _log.exception("the live work failed")
                task.has_failed = True
                if task is self._task:
                    self.trouble = error

    def _new(self, reader: Reader, task: _Task) -> Sequence[tuple[str, ImuBlock]]:
        new = []
        for name in reader.sensors:
            block, task.taken[name], skipped = reader.newest(name, task.taken.get(name, 0), MOST_BEHIND_S)
            self.dropped += skipped
            new.append((name, block))
        return new

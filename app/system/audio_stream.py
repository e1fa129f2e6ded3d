"""Sound without a break: samples are made while they are played, for what has to keep time.

A player that is started for each click is late by tens of milliseconds, each time by others. Here one player takes all
samples, and the sound card paces it. On Linux it is PulseAudio's or ALSA's own, fed through a pipe; on Windows the
system's `waveOut`. macOS has no player that takes samples from a pipe: there nothing is played, and `failed` is called.
"""

import contextlib
import logging
import subprocess
import sys
from collections.abc import Callable, Sequence
from functools import partial
from threading import Event, Thread
from typing import Protocol

from app.system.wave_out import WaveOut

RATE_HZ = 48_000
BLOCK = 960  # samples, 20 ms
# What is handed over but not played yet, half a second in all: a busy computer is later than that by chance only.
# A sound comes so much later; closing is at once.
PIPE_BYTES = 16_384
_RAW = ("--raw", "--format=s16le", f"--rate={RATE_HZ}", "--channels=1", "--latency-msec=300")
_ALSA = ("-q", "-t", "raw", "-f", "S16_LE", "-r", str(RATE_HZ), "-c", "1", "--buffer-time=300000", "-")
PIPED_PLAYERS: Sequence[Sequence[str]] = (("paplay", *_RAW), ("aplay", *_ALSA)) if sys.platform == "linux" else ()
CLOSE_S = 1.0  # no player takes longer to end

_log = logging.getLogger(__name__)


class SoundOutlet(Protocol):
    """What takes samples and plays them."""

    def write(self, samples: bytes) -> None:
        """Take them, waiting until there is room; OSError where nothing plays them."""

    def fall_silent(self) -> None:
        """Play no more, at once. From any thread."""

    def close(self) -> None:
        """Let go of it; by the thread that writes."""


class PipedPlayer:
    """A player in a process of its own. OSError where there is none of this name."""

    def __init__(self, command: Sequence[str]) -> None:
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pipesize=PIPE_BYTES,
        )

    def write(self, samples: bytes) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(samples)
        self._process.stdin.flush()

    def fall_silent(self) -> None:
        self._process.kill()

    def close(self) -> None:
        self._process.kill()
        with contextlib.suppress(OSError), self._process:  # samples that it took no more
            pass


def outlets(players: Sequence[Sequence[str]] = PIPED_PLAYERS) -> list[Callable[[], SoundOutlet]]:
    """Give what may play here, the best first; each makes an outlet."""
    if sys.platform == "win32":
        return [lambda: WaveOut(RATE_HZ)]
    return [partial(PipedPlayer, player) for player in players]


class AudioStream:
    """Plays what `read` gives, one channel of 16 bits at RATE_HZ, from its making until it is closed.

    `read` is given a number of samples and gives as many, little-endian; `failed` is called when nothing plays
    them, or no longer. Both are called on a thread of the stream's own.
    """

    def __init__(
        self,
        read: Callable[[int], bytes],
        failed: Callable[[], None],
        ways: Sequence[Callable[[], SoundOutlet]] | None = None,
    ) -> None:
        self._read, self._failed = read, failed
        self._ways = outlets() if ways is None else ways
        self._outlet: SoundOutlet | None = None
        self._is_closing = Event()
        # a daemon: the end of the program waits for no sound
        self._thread = Thread(target=self._run, name="audio stream", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Fall silent, at once."""
        self._is_closing.set()
        if (outlet := self._outlet) is not None:
            outlet.fall_silent()
        self._thread.join(CLOSE_S)

    def _run(self) -> None:
        for way in self._ways:
            try:
                self._play(way())
            except OSError as problem:
                if not self._is_closing.is_set():
                    _log.info("nothing played: %s", problem)
            if self._is_closing.is_set():
                return
        self._failed()

    def _play(self, outlet: SoundOutlet) -> None:
        self._outlet = outlet
        try:
            while not self._is_closing.is_set():
                outlet.write(self._read(BLOCK))
        finally:
            outlet.close()

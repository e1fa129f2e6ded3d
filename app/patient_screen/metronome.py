"""A metronome that keeps time to the sample: its clicks are one stream of sound, paced by the sound card.

Where no such stream can be played it ticks one by one, by a timer; where nothing can play at all `is_silent` holds.
"""

import contextlib
import wave
from collections.abc import Callable
from importlib.resources import files

import numpy as np
from PySide6.QtCore import QObject, Qt, Signal, Slot

from app.patient_screen.click_track import ClickTrack, Samples
from app.patient_screen.tick_timer import TickTimer
from app.system import sounds
from app.system.audio_stream import RATE_HZ, AudioStream
from app.system.sounds import Sound

LEAST, MOST = 30, 200  # steps per minute
Play = Callable[[Callable[[int], bytes], Callable[[], None]], AudioStream]


class Metronome(QObject):
    """`beats_per_min` is 0 while it is off."""

    changed = Signal()
    _stream_failed = Signal(int)  # which of the streams: one that was stopped meanwhile is no news

    def __init__(self, parent: QObject | None = None, play: Play = AudioStream) -> None:
        super().__init__(parent)
        self._play = play
        self.beats_per_min = 0
        self._track: ClickTrack | None = None
        self._stream: AudioStream | None = None
        self._streams = 0  # so many were begun
        self._ticks = TickTimer(self)
        self._stream_failed.connect(self._on_stream_failed, Qt.ConnectionType.QueuedConnection)

    @property
    def is_silent(self) -> bool:
        """Whether it is on and nothing can play it."""
        return bool(self.beats_per_min) and self._stream is None and not sounds.has_output()

    def start(self, beats_per_min: int) -> None:
        """Click now and at this rate, or go over to it; raises ValueError outside LEAST to MOST."""
        if not LEAST <= beats_per_min <= MOST:
            raise ValueError(f"beats_per_min is {beats_per_min}, expected {LEAST} to {MOST}")
        if beats_per_min == self.beats_per_min:
            return
        was_off, self.beats_per_min = not self.beats_per_min, beats_per_min
        if was_off:
            self._begin(beats_per_min)
        elif self._stream is not None and self._track is not None:
            self._track.set_rate(beats_per_min)
        else:
            self._ticks.start(beats_per_min)
        self.changed.emit()

    def stop(self) -> None:
        """Fall silent."""
        if self.beats_per_min:
            self.beats_per_min = 0
            self._ticks.stop()
            self._end_stream()
            self.changed.emit()

    def _begin(self, beats_per_min: int) -> None:
        track, number = ClickTrack(_click(), RATE_HZ), self._streams + 1
        track.set_rate(beats_per_min)

        def read(count: int) -> bytes:
            samples = track.read(count)
            return (samples if sounds.is_on() else np.zeros_like(samples)).astype("<i2").tobytes()

        self._track, self._streams = track, number

        def fail() -> None:
            with contextlib.suppress(RuntimeError):  # the visit was closed meanwhile
                self._stream_failed.emit(number)

        self._stream = self._play(read, fail)

    def _end_stream(self) -> None:
        stream, self._stream, self._track = self._stream, None, None
        if stream is not None:
            stream.close()

    @Slot(int)
    def _on_stream_failed(self, number: int) -> None:
        if number == self._streams and self._stream is not None:
            self._end_stream()
            self._ticks.start(self.beats_per_min)
            self.changed.emit()


def _click() -> Samples:
    with wave.open(str(files("resources") / "sounds" / f"{Sound.TICK}.wav")) as file:
        return np.frombuffer(file.readframes(file.getnframes()), "<i2").astype(np.int16)

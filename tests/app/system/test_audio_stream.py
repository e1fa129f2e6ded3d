"""Samples that are made while they are played: who takes them, and Windows' own functions, given a fake of them."""

import ctypes
import struct
import sys
import threading
from typing import Any

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.system import audio_stream
from app.system.audio_stream import BLOCK, RATE_HZ, AudioStream, PipedPlayer, outlets
from app.system.wave_out import BLOCKS, WaveOut

DONE, HEADER_BYTES = 1, 48  # of WAVEHDR, on 64 bits


class Winmm:
    """Takes memory as Windows reads it, by offsets and not by names; the first of more than a few blocks is played."""

    def __init__(self, refuses: str = "") -> None:
        self.refuses = refuses
        self.form: tuple[int, ...] = ()
        self.played = bytearray()
        self.queue: list[int] = []
        self.prepared: set[int] = set()
        self.most_queued = 0
        self.is_open = self.is_stalled = False

    def waveOutOpen(self, device: Any, mapper: int, form: Any, *_nobody: Any) -> int:  # noqa: N802  Windows names it
        assert mapper == 0xFFFFFFFF
        self.form = struct.unpack("<HHIIHHH", ctypes.string_at(ctypes.addressof(form.contents), 18))
        self.is_open = self.refuses != "waveOutOpen"
        return 0 if self.is_open else 6

    def waveOutPrepareHeader(self, device: Any, header: Any, size: int) -> int:  # noqa: N802  Windows names it
        assert size == HEADER_BYTES
        self.prepared.add(ctypes.addressof(header.contents))
        return 0

    def waveOutWrite(self, device: Any, header: Any, size: int) -> int:  # noqa: N802  Windows names it
        at = ctypes.addressof(header.contents)
        assert at in self.prepared
        self.queue.append(at)
        self.most_queued = max(self.most_queued, len(self.queue))
        if len(self.queue) > 3 and not self.is_stalled:
            self._play()
        return 0

    def waveOutUnprepareHeader(self, device: Any, header: Any, size: int) -> int:  # noqa: N802  Windows names it
        at = ctypes.addressof(header.contents)
        assert struct.unpack("<I", ctypes.string_at(at + 24, 4))[0] & DONE  # never while it is played
        self.prepared.remove(at)
        return 0

    def waveOutReset(self, device: Any) -> int:  # noqa: N802  Windows names it
        while self.queue:
            ctypes.memmove(self.queue.pop(0) + 24, struct.pack("<I", DONE), 4)
        return 0

    def waveOutClose(self, device: Any) -> int:  # noqa: N802  Windows names it
        assert self.prepared == set()
        self.is_open = False
        return 0

    def _play(self) -> None:
        at = self.queue.pop(0)
        data, length = struct.unpack("<QI", ctypes.string_at(at, 12))
        self.played += ctypes.string_at(data, length)
        ctypes.memmove(at + 24, struct.pack("<I", DONE), 4)


def test_windows_is_given_the_samples_in_order_and_its_memory_back() -> None:
    winmm = Winmm()
    wave = WaveOut(RATE_HZ, winmm)
    assert winmm.form == (1, 1, RATE_HZ, 2 * RATE_HZ, 2, 16, 0)
    blocks = [np.full(BLOCK, k, dtype="<i2").tobytes() for k in range(50)]
    for block in blocks:
        wave.write(block)
    assert bytes(winmm.played) == b"".join(blocks)[: len(winmm.played)]
    assert len(winmm.played) >= 2 * BLOCK * (50 - BLOCKS)
    wave.close()
    assert not winmm.is_open


def test_windows_without_a_device_and_one_that_stalls_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(OSError, match="waveOutOpen answered 6"):
        WaveOut(RATE_HZ, Winmm(refuses="waveOutOpen"))
    monkeypatch.setattr("app.system.wave_out.STALLED_S", 0.01)
    winmm = Winmm()
    winmm.is_stalled = True
    wave = WaveOut(RATE_HZ, winmm)
    for _ in range(BLOCKS):
        wave.write(bytes(2 * BLOCK))
    with pytest.raises(OSError, match="stopped"):
        wave.write(bytes(2 * BLOCK))
    assert winmm.most_queued == BLOCKS
    wave.close()


def test_windows_that_waits_for_room_is_silenced() -> None:
    winmm = Winmm()
    winmm.is_stalled = True
    wave = WaveOut(RATE_HZ, winmm)
    for _ in range(BLOCKS):
        wave.write(bytes(2 * BLOCK))
    threading.Timer(0.02, wave.fall_silent).start()
    wave.write(bytes(2 * BLOCK))  # comes back though there is no room
    assert winmm.most_queued == BLOCKS
    wave.close()
    assert not winmm.is_open


@pytest.fixture
def failed() -> list[str]:
    return []


def test_the_first_way_that_plays_is_taken_and_one_that_ends_is_left_for_the_next(
    qtbot: QtBot, failed: list[str]
) -> None:
    def refuse() -> PipedPlayer:
        raise OSError("not there")

    taken: list[int] = []
    done = threading.Event()

    class Taking:
        def write(self, samples: bytes) -> None:
            taken.append(len(samples))
            if len(taken) == 5:
                done.set()
            if len(taken) >= 5:
                raise OSError("unplugged")

        def fall_silent(self) -> None:
            pass

        def close(self) -> None:
            taken.append(0)

    ends = [sys.executable, "-c", "import sys; sys.stdin.buffer.read(2)"]
    stream = AudioStream(
        lambda count: bytes(2 * count), lambda: failed.append("failed"), (refuse, lambda: PipedPlayer(ends), Taking)
    )
    qtbot.waitUntil(done.is_set)
    qtbot.waitUntil(lambda: failed == ["failed"])
    assert taken == [2 * BLOCK] * 5 + [0]
    stream.close()
    assert failed == ["failed"]


def test_one_that_is_closed_has_not_failed(qtbot: QtBot, failed: list[str]) -> None:
    waits = [sys.executable, "-c", "import time; time.sleep(600)"]
    stream = AudioStream(lambda count: bytes(2 * count), lambda: failed.append("failed"), [lambda: PipedPlayer(waits)])
    stream.close()
    assert failed == []


def test_each_system_has_its_ways(monkeypatch: pytest.MonkeyPatch) -> None:
    assert outlets(()) == []
    assert len(outlets([["a"], ["b"]])) == 2
    monkeypatch.setattr(sys, "platform", "win32")
    made: list[int] = []
    monkeypatch.setattr(audio_stream, "WaveOut", made.append)
    (way,) = outlets()
    way()
    assert made == [RATE_HZ]

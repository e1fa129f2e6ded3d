"""Sound by Windows' own `waveOut` functions (winmm), block by block.

Structures and constants: mmeapi.h of the Windows SDK. Every field has the width that it has on Windows, whatever
system reads this.
"""

import ctypes
import sys
import time
from collections import deque
from typing import Any

BLOCKS = 10  # handed over at once; of 20 ms each
LOOK_S = 0.004
STALLED_S = 1.0  # nothing was played for so long: the device is gone
MAPPER, NO_CALLBACK, PCM, DONE = 0xFFFFFFFF, 0, 1, 1
_NOBODY = ctypes.c_size_t(0), ctypes.c_size_t(0)  # who would be called back, and what with


class WaveFormat(ctypes.Structure):
    """WAVEFORMATEX."""

    _pack_ = 1
    _fields_ = (
        ("wFormatTag", ctypes.c_uint16),
        ("nChannels", ctypes.c_uint16),
        ("nSamplesPerSec", ctypes.c_uint32),
        ("nAvgBytesPerSec", ctypes.c_uint32),
        ("nBlockAlign", ctypes.c_uint16),
        ("wBitsPerSample", ctypes.c_uint16),
        ("cbSize", ctypes.c_uint16),
    )


class WaveHeader(ctypes.Structure):
    """WAVEHDR."""

    _fields_ = (
        ("lpData", ctypes.c_void_p),
        ("dwBufferLength", ctypes.c_uint32),
        ("dwBytesRecorded", ctypes.c_uint32),
        ("dwUser", ctypes.c_size_t),
        ("dwFlags", ctypes.c_uint32),
        ("dwLoops", ctypes.c_uint32),
        ("lpNext", ctypes.c_void_p),
        ("reserved", ctypes.c_size_t),
    )


class WaveOut:
    """One channel of 16 bits. OSError where there is no device, or it goes."""

    def __init__(self, rate_hz: int, winmm: Any = None) -> None:
        self._winmm = _winmm() if winmm is None else winmm
        self._device = ctypes.c_void_p()
        self._playing: deque[tuple[WaveHeader, Any]] = deque()  # Windows reads them until they are done
        self._is_silent = False
        form = WaveFormat(PCM, 1, rate_hz, 2 * rate_hz, 2, 16, 0)
        self._ask("waveOutOpen", ctypes.pointer(self._device), MAPPER, ctypes.pointer(form), *_NOBODY, NO_CALLBACK)

    def write(self, samples: bytes) -> None:
        """Take a block; waits while BLOCKS of them are not played yet."""
        until_s = time.monotonic() + STALLED_S
        self._let_go()
        while len(self._playing) >= BLOCKS and not self._is_silent:
            if time.monotonic() > until_s:
                raise OSError("The sound device has stopped.")
            time.sleep(LOOK_S)
            self._let_go()
        if self._is_silent:
            return
        data = ctypes.create_string_buffer(samples, len(samples))
        header = WaveHeader(ctypes.addressof(data), len(samples))
        self._ask("waveOutPrepareHeader", self._device, ctypes.pointer(header), ctypes.sizeof(header))
        self._playing.append((header, data))
        self._ask("waveOutWrite", self._device, ctypes.pointer(header), ctypes.sizeof(header))

    def fall_silent(self) -> None:
        """Play no more; `close` follows on the thread that writes."""
        self._is_silent = True

    def close(self) -> None:
        self._winmm.waveOutReset(self._device)  # every block is done then
        while self._playing:
            header, _data = self._playing.popleft()
            self._winmm.waveOutUnprepareHeader(self._device, ctypes.pointer(header), ctypes.sizeof(header))
        self._winmm.waveOutClose(self._device)

    def _let_go(self) -> None:
        while self._playing and self._playing[0][0].dwFlags & DONE:
            header, _data = self._playing.popleft()
            self._ask("waveOutUnprepareHeader", self._device, ctypes.pointer(header), ctypes.sizeof(header))

    def _ask(self, function: str, *arguments: object) -> None:
        if answer := getattr(self._winmm, function)(*arguments):
            raise OSError(f"{function} answered {answer}")


def _winmm() -> Any:
    if sys.platform == "win32":
        return ctypes.WinDLL("winmm")
    raise OSError("Only Windows has winmm.")

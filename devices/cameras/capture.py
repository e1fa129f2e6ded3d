"""Frames of one camera, taken by a process of its own. What happens there can end the capture, never this program."""

import contextlib
import json
import logging
import subprocess
import threading
import weakref
from collections.abc import Callable
from dataclasses import asdict
from time import monotonic

from devices.cameras import child
from devices.cameras.camera import CameraInfo, CameraLostError, CameraMode, CapturedFrame
from devices.cameras.causes import CRASHED, SILENT, lost
from devices.cameras.messages import (
    ENDED,
    FRAME,
    MODE,
    BrokenMessageError,
    cause_of,
    frame_of,
    mode_of,
    receive,
)
from devices.own_process import Process, end_process, start_process

OPENS_S = 10.0  # until the first frame: some webcams take four seconds, and the process has to start
SILENT_S = 1.5  # between two frames; in the dark cameras slow down to five a second
WATCHES_S = 0.1
LEAVES_S = 0.7  # in which the process may let its camera go
ENDS_S, JOINS_S = 0.3, 0.5

_log = logging.getLogger(__name__)

OnFrame = Callable[[CapturedFrame], object]
OnEnded = Callable[[CameraLostError], object]
OnChange = Callable[[CameraMode], object]


class Capture:
    """Takes frames from when it is made until `stop`, or until the camera ends.

    Parameters
    ----------
    info, mode
        The camera, and what is asked of it. It may give another mode.
    on_frame
        Called with each frame, in this capture's own thread. While it takes its time, frames are left out: nothing
        is kept for it.
    on_ended
        Called once, in the same thread, where the camera ends before `stop`.
    on_change
        Called in the same thread with the mode in force: before the first frame, and where the computer is too slow.
    """

    def __init__(
        self,
        info: CameraInfo,
        mode: CameraMode,
        on_frame: OnFrame,
        on_ended: OnEnded,
        on_change: OnChange | None = None,
        *,
        opens_s: float = OPENS_S,
        silent_s: float = SILENT_S,
    ) -> None:
        self.info = info
        self._on_frame, self._on_ended, self._on_change = on_frame, on_ended, on_change
        self._silent_s = silent_s
        self._mode = mode
        self._cause = CRASHED
        self._stopping = threading.Event()
        self._over = threading.Event()
        self._waiting_since_s: float | None = monotonic()
        self._may_wait_s = opens_s
        asked = json.dumps({child.CAMERA: asdict(info), child.MODE_ASKED: asdict(mode)})
        self.process: Process = start_process(child.__name__, child.WORD, asked)
        weakref.finalize(self, end_process, self.process)  # also when this program ends
        self._thread = threading.Thread(target=self._read, name=f"camera {info.name}", daemon=True)
        self._watching = threading.Thread(target=self._watch, name="camera watch", daemon=True)
        self._thread.start()
        self._watching.start()

    @property
    def mode(self) -> CameraMode:
        """In force; what was asked for, until the camera has answered."""
        return self._mode

    def stop(self) -> None:
        """Let the camera go, within two seconds. `on_ended` is not called any more; may be called again."""
        self._stopping.set()
        if (asking := self.process.stdin) is not None:
            with contextlib.suppress(OSError):
                asking.close()
        if not self._is_gone(LEAVES_S):
            self.process.kill()
            self._is_gone(ENDS_S)
        if threading.current_thread() is not self._thread:
            self._thread.join(JOINS_S)

    def _is_gone(self, within_s: float) -> bool:
        """Return whether the process ends; one that is inside of a driver may not even when it is killed."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(within_s)
        return self.process.returncode is not None

    def _read(self) -> None:
        """Read what the process sends, until it ends."""
        assert self.process.stdout is not None  # it was started with it
        last = -1
        try:
            while True:
                self._waiting_since_s = monotonic()
                kind, content = receive(self.process.stdout)
                self._waiting_since_s = None
                if self._stopping.is_set():
                    continue  # until it has let its camera go
                if kind == FRAME:
                    self._may_wait_s = self._silent_s
                    frame = frame_of(content, last)
                    last = frame.number
                    self._on_frame(frame)
                elif kind == MODE:
                    self._mode = mode_of(content)
                    if self._on_change is not None:
                        self._on_change(self._mode)
                elif kind == ENDED:
                    self._cause, detail = cause_of(content)
                    _log.warning("a camera ended: %s (%s)", self._cause, detail)
                    break
                else:
                    raise BrokenMessageError("of no kind")
        except (EOFError, OSError, ValueError) as problem:  # ValueError: the pipe is closed
            _log.info("the process of a camera ended (%s)", type(problem).__name__)
        except BrokenMessageError as problem:
            _log.warning("the process of a camera sent %s", problem)
        except Exception:  # of who was called: the edge of the thread
            _log.exception("a frame could not be passed on")
        self._over.set()
        self.process.kill()
        self._is_gone(ENDS_S)
        self.process.stdout.close()
        if not self._stopping.is_set():
            self._on_ended(lost(self._cause, self.info))

    def _watch(self) -> None:
        """End a process that sends nothing while it is waited for."""
        while not self._over.wait(WATCHES_S):
            since_s = self._waiting_since_s
            if since_s is not None and monotonic() - since_s > self._may_wait_s:
                self._cause = SILENT
                self.process.kill()
                return
